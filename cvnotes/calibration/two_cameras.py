"""Views that two cameras took, or one that was zoomed or focused anew in between."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.parting import NearBy, freedom, guesses, settled
from cvnotes.calibration.refinement import Problem, State, minimise, refit_poses
from cvnotes.calibration.result import Calibration
from cvnotes.calibration.thresholds import NEGLIGIBLE, PARTED, ROUNDS

_FEWEST = 3  # views of a camera: one more than determine it
_NEARLY = 0.5  # of the F that counts, from which on two cameras are refined


@dataclass(frozen=True, eq=False)
class TwoCameras:
    """Two cameras that explain views far better than one.

    Attributes
    ----------
    second : ndarray of bool, shape (n_views,)
        The views of the second camera: the fewer; of halves, that without the first view.
    rms, of_one : float
        Root mean square reprojection distance with the two, and with one camera, px.
    told : bool
        Whether the views tell which belong together: not where those of one are again those of two,
        as of a camera that changes all the time.
    """

    second: npt.NDArray[np.bool_]
    rms: float
    of_one: float
    told: bool


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
    What each view costs with a camera that differs a little is known at once (`NearBy`). Of many
    guesses which views the second camera took, each is mended until every view is with the camera
    that fits it better; then the best two cameras are refined. The board is that of the one camera.

    What counts is the F of the second camera, (c₁ − c₂)/q · freedom/c₂, with sums of squares c and
    q parameters.
    """
    if one.rms < NEGLIGIBLE:  # of exact corners rounding is left, in which there may be anything
        return None
    data = Correspondences.of(one.board_points, one.image_points, flat=False)
    problem = Problem.at(one.camera, one.names, data)
    x = problem.state(one.camera, data.pose_in_scaled_units(one.poses))
    if (parted := _in_two(problem, x)) is None:
        return None
    second, rms = parted
    again = (_alone_in_two(problem, x, np.flatnonzero(own)) for own in (~second, second))
    return TwoCameras(second, rms, one.rms, not any(again))


def _in_two(problem: Problem, x: State) -> tuple[npt.NDArray[np.bool_], float] | None:
    """Tell which views are a second camera's, and the RMS then, where two explain far more."""
    n_views, q = len(problem.m), len(problem.names)
    if n_views < 2 * _FEWEST:
        return None

    def costs_of(parts: npt.NDArray[np.intp]) -> Array:
        return near.at(near.camera_of(np.stack([parts == 0, parts == 1], axis=1).astype(float)))

    def explain(two: float, f: float) -> bool:
        return bool((near.c.sum() - two) * (freedom(problem) - 2 * q) > f * q * two)

    try:
        near = NearBy.of(problem, x)
        parts, costs = settled(guesses(n_views, _FEWEST), costs_of)
        second = parts.astype(bool)
        costs[np.minimum(second.sum(1), (~second).sum(1)) < _FEWEST] = np.inf
        best = costs.argmin()
        if not explain(costs[best], _NEARLY * PARTED):
            return None
        found = _parted(problem, x, second[best])
    except (CvnotesError, np.linalg.LinAlgError):  # they, or one part, do not determine a camera
        return None
    return found if found and explain(found[1] ** 2 * problem.n_seen, PARTED) else None


def _alone_in_two(problem: Problem, x: State, part: npt.NDArray[np.intp]) -> bool:
    """Tell whether some of the views, with a camera of their own, are again those of two."""
    some = problem.some(part)
    try:
        return _in_two(some, minimise(some, x.some(part)).x) is not None
    except CvnotesError:
        return False


def _parted(
    problem: Problem, x: State, second: npt.NDArray[np.bool_]
) -> tuple[npt.NDArray[np.bool_], float] | None:
    """Refine two cameras from a first guess which views the second one took."""
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
    if min(second.sum(), (~second).sum()) < _FEWEST:
        return None
    if 2 * second.sum() + second[0] > len(second):
        second = ~second
    return second, float(np.sqrt(costs.min(0).sum() / problem.n_seen))
