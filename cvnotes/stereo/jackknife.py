"""Error bars of a rig that ask the pairs themselves: what happens when some are left out."""

import warnings
from collections.abc import Sequence

import numpy as np

from cvnotes.base import Array, CalibrationWarning
from cvnotes.camera import vector_from_rotation
from cvnotes.stereo.calibration import calibrate_stereo
from cvnotes.stereo.result import StereoCalibration

_GROUPS = 16


def std_of_pairs(
    result: StereoCalibration,
    board_points: Array | Sequence[Array],
    left_points: Sequence[Array],
    right_points: Sequence[Array],
    *,
    lens: str,
    skew: bool = False,
) -> dict[str, float]:
    """Return standard deviations by the jackknife over pairs: their disagreement counts too.

    Parameters
    ----------
    result : StereoCalibration
        What `calibrate_stereo` made of all pairs.
    board_points, left_points, right_points, lens, skew
        What it was given.

    Returns
    -------
    dict
        The deviation of each parameter by its name, as in ``result.std``, and of the distance
        between the cameras, as ``baseline``.

    Raises
    ------
    DegenerateError
        Without some of the pairs the rig is not determined.

    Notes
    -----
    The rig is calibrated g times, each time without one group of pairs: σ² = (g − 1)/g Σ (θᵢ − θ̄)².
    ``result.std`` takes the noise of all corners for independent; a board that is not flat, or a
    lens that the model does not quite meet, moves all corners of a picture together. A camera by
    itself has `cvnotes.calibration.jackknife`.

    References
    ----------
    .. [1] B. Efron and C. Stein, The jackknife estimate of variance, Annals of Statistics 9
       (1981) 586-596.
    """
    n = len(result.poses)
    groups = np.array_split(np.arange(n), min(n, _GROUPS))
    # Neighbours are often alike: a group takes pairs from all over the series.
    order = np.argsort(np.arange(n) % len(groups), kind="stable")
    board = [board_points] * n if isinstance(board_points, np.ndarray) else board_points
    found = []
    for group in groups:
        kept = np.delete(np.arange(n), order[group]).tolist()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", CalibrationWarning)
            one = calibrate_stereo(
                [board[i] for i in kept],
                [left_points[i] for i in kept],
                [right_points[i] for i in kept],
                result.left.size,
                lens=lens,
                skew=skew,
            )
        found.append(_parameters(one, result))
    spread = np.var(found, axis=0) * (len(groups) - 1)
    return dict(zip((*result.names, "baseline"), np.sqrt(spread).tolist(), strict=True))


def _parameters(one: StereoCalibration, among: StereoCalibration) -> Array:
    """Return what `names` names, with ω as the rotation from that of `among`, and the base line."""
    cameras = [
        camera.parameters.get(name.removeprefix(side), 0.0)
        for side, camera in (("left.", one.left), ("right.", one.right))
        for name in one.names
        if name.startswith(side)
    ]
    omega = vector_from_rotation(one.R @ among.R.T)
    return np.array([*cameras, *omega, *one.T, np.linalg.norm(one.T)])
