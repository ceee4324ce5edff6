"""Error bars of a rig that ask the pairs themselves: what happens when one is left out."""

from dataclasses import replace

import numpy as np

from cvnotes.base import Array, DegenerateError
from cvnotes.calibration.jackknife import Influence, undetermined
from cvnotes.stereo.refinement import StereoProblem, StereoState


def covariance_over_pairs(problem: StereoProblem, x: StereoState) -> Array:
    """Estimate the covariance of the shared parameters from the scatter between pairs.

    Parameters
    ----------
    problem : StereoProblem
        The rig and its pairs.
    x : StereoState
        Their minimum.

    Returns
    -------
    ndarray, shape (q, q)
        Infinite on its diagonal where the other pairs do not determine the rig.

    Notes
    -----
    The covariance that takes the noise of all corners for independent promises too much: a board
    that is bent differently each time, or a lens that the model does not quite meet, moves all
    corners of a picture together. A camera by itself has `cvnotes.calibration.jackknife`, which
    also says what is worked out here.
    """
    of_shape = problem.left.held[len(problem.left.names) :]
    held = np.concatenate([np.zeros(len(problem.names)), of_shape])
    free = replace(
        problem, left=replace(problem.left, hold=None), right=replace(problem.right, hold=None)
    )
    S, g = [], []
    try:
        for i in range(len(x.left.R)):
            pair = slice(i, i + 1)
            _, one = free.some(pair).linearise(x.some(pair))
            from_pose = one.eliminated[1]
            S.append(one.shared - from_pose[:, :-1])
            g.append(one.g_shared - from_pose[:, -1])
        return Influence.between(np.array(S), np.array(g), held).covariance
    except DegenerateError:
        return undetermined(len(held))
