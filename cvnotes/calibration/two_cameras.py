"""Views that two cameras took, or one that was zoomed or focused anew in between."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.jackknife import Influence
from cvnotes.calibration.refinement import Problem, State, minimise, refit_poses
from cvnotes.calibration.result import Calibration
from cvnotes.calibration.thresholds import CORNERS_THAT_TELL, NEGLIGIBLE, PARTED, ROUNDS

DIRECTIONS = 4  # in which views are parted at first
_FEWEST = 3  # views of a camera: one more than determine it


@dataclass(frozen=True, eq=False)
class TwoCameras:
    """Two cameras that explain views far better than one.

    Attributes
    ----------
    second : ndarray of bool, shape (n_views,)
        The views of the second camera: the fewer, if it took not as many as the first.
    rms, of_one : float
        Root mean square reprojection distance with the two, and with one camera, px.
    """

    second: npt.NDArray[np.bool_]
    rms: float
    of_one: float


def two_cameras(one: Calibration) -> TwoCameras | None:
    """Part views into those of two cameras, if these explain far more than one, and chance.

    Parameters
    ----------
    one : Calibration
        With its corners.

    Returns
    -------
    TwoCameras or None
        None also if one of them had fewer than three views: any two fit a camera of their own.

    Notes
    -----
    Views are parted by the side to which they pull the one camera, in each of the four directions
    in which they pull it apart the most. Then each camera is refined with its views, and each view
    goes to the camera that fits it better, until all stay. The board is that of the one camera.

    What counts is the F of the second camera, (c₁ − c₂)/q · freedom/c₂, with sums of squares c and
    q parameters. Corners of a view miss their places together: of more than 40 in a view the rest
    says little new, and adds no freedom.
    """
    if one.rms < NEGLIGIBLE:  # of exact corners rounding is left, in which there may be anything
        return None
    data = Correspondences.of(one.board_points, one.image_points, flat=False)
    problem = Problem.at(one.camera, one.names, data)
    x = problem.state(one.camera, data.pose_in_scaled_units(one.poses))
    try:
        sides = Influence.of(problem, x).sides[:DIRECTIONS]
    except (CvnotesError, np.linalg.LinAlgError):  # the views hardly determine one camera
        return None
    parted = [two for second in sides if (two := _parted(problem, x, second, one.rms))]
    best = min(parted, key=lambda two: two.rms, default=None)
    n_views, q = len(one.poses), len(one.names)
    freedom = n_views * (2 * min(problem.n_seen / n_views, CORNERS_THAT_TELL) - 6) - 2 * q
    if best is None or ((one.rms / best.rms) ** 2 - 1) * freedom < PARTED * q:
        return None
    return best


def _parted(
    problem: Problem, x: State, second: npt.NDArray[np.bool_], of_one: float
) -> TwoCameras | None:
    """Refine two cameras from a first guess which views the second one took."""
    try:
        for _ in range(ROUNDS):
            if min(second.sum(), (~second).sum()) < _FEWEST:
                return None
            shared = [
                minimise(problem.some(part), x.some(part)).x.shared
                for part in (np.flatnonzero(~second), np.flatnonzero(second))
            ]
            costs = np.array([refit_poses(problem, State(s, x.R, x.T))[1] for s in shared])
            before, second = second, costs[1] < costs[0]
            if (second == before).all():
                break
    except CvnotesError:  # one of them has no camera
        return None
    if min(second.sum(), (~second).sum()) < _FEWEST:
        return None
    if 2 * second.sum() > len(second):
        second = ~second
    return TwoCameras(second, float(np.sqrt(costs.min(0).sum() / problem.n_seen)), of_one)
