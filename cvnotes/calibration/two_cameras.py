"""Views that two cameras took, or one that was zoomed or focused anew in between."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.jackknife import Influence
from cvnotes.calibration.refinement import Problem, State, minimise, refit_poses
from cvnotes.calibration.result import Calibration
from cvnotes.calibration.thresholds import FEWEST_KEPT, PARTED, ROUNDS
from cvnotes.camera import Camera

_DIRECTIONS = 4  # in which views are parted at first


@dataclass(frozen=True, eq=False)
class TwoCameras:
    """Two cameras that explain views much better than one.

    Attributes
    ----------
    second : ndarray of bool, shape (n_views,)
        The views of the second camera: the fewer, if it took not as many as the first.
    cameras : (Camera, Camera)
        The first and the second.
    view_rms : ndarray, shape (n_views,)
        Root mean square reprojection distance of each view from where its camera puts it, px.
    """

    second: npt.NDArray[np.bool_]
    cameras: tuple[Camera, Camera]
    view_rms: Array

    @property
    def rms(self) -> float:
        """Root mean square of `view_rms`, px."""
        return float(np.sqrt((self.view_rms**2).mean()))


def two_cameras(one: Calibration) -> TwoCameras | None:
    """Part views into those of two cameras, if these lower the RMS of one by a third.

    Parameters
    ----------
    one : Calibration
        With its corners.

    Returns
    -------
    TwoCameras or None
        None also if one of them had fewer than four views: any few fit a camera of their own.

    Notes
    -----
    Views are parted by the side to which they pull the one camera, in each of the four directions
    in which they pull it apart the most. Then each camera is refined with its views, and each view
    goes to the camera that fits it better, until all stay; the first direction that leads to two
    cameras counts. The board is that of the one camera.
    """
    data = Correspondences.of(one.board_points, one.image_points, flat=False)
    problem = Problem.at(one.camera, one.names, data)
    x = problem.state(one.camera, data.pose_in_scaled_units(one.poses))
    try:
        sides = Influence.of(problem, x).sides[:_DIRECTIONS]
    except (CvnotesError, np.linalg.LinAlgError):  # the views hardly determine one camera
        return None
    parted = (_parted(problem, x, second) for second in sides)
    return next((two for two in parted if two and two.rms <= PARTED * one.rms), None)


def _parted(problem: Problem, x: State, second: npt.NDArray[np.bool_]) -> TwoCameras | None:
    """Refine two cameras from a first guess which views the second one took."""
    try:
        for _ in range(ROUNDS):
            if min(second.sum(), (~second).sum()) < FEWEST_KEPT:
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
    if min(second.sum(), (~second).sum()) < FEWEST_KEPT:
        return None
    cameras = problem.camera_of(shared[0]), problem.camera_of(shared[1])
    if 2 * second.sum() > len(second):
        second, cameras = ~second, cameras[::-1]
    return TwoCameras(second, cameras, np.sqrt(costs.min(0) / problem.n_seen_by_view))
