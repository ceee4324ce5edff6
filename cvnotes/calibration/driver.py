"""Calibration: from corners seen in several views to a camera with error bars (notes 2b.4)."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any
from warnings import warn

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CalibrationWarning,
    ConvergenceError,
    CvnotesError,
    DegenerateError,
    Minimum,
    image_size,
)
from cvnotes.calibration.arrow import Arrow, covariance, pose_covariance
from cvnotes.calibration.correspondences import Correspondences, PointSets
from cvnotes.calibration.refinement import Problem, State, minimise
from cvnotes.calibration.reliability import Evidence, judge, likeness
from cvnotes.calibration.result import Calibration
from cvnotes.calibration.steps import Steps
from cvnotes.calibration.zhang import extrinsics, radial_distortion
from cvnotes.homography import dlt

__all__ = ["LENSES", "Calibration", "calibrate"]

# What `lens=` may name: how many radial terms, and whether the tangential ones too.
LENSES = {
    "none": (0, False),
    "k1": (1, False),
    "k1 k2": (2, False),
    "k1 k2 k3": (3, False),
    "k1 k2 p1 p2": (2, True),
    "k1 k2 p1 p2 k3": (3, True),
}
# Of many views, some say where the camera is; the others only sharpen it.
_MANY_VIEWS, _VIEWS_FOR_START = 150, 16
# RMS over the picture's longer side: a start that leaves more than this is not trusted before the
# others were tried.
_SUSPICIOUS = 0.002

_Minimum = Minimum[State, Arrow]


def calibrate(
    board_points: PointSets,
    image_points: PointSets,
    size: tuple[int, int],
    *,
    lens: str = "k1 k2",
    skew: bool = False,
    homography: Callable[..., Any] = dlt,
    intrinsics: Callable[..., Any] | None = None,
    extrinsics: Callable[..., Any] = extrinsics,
    distortion: Callable[..., Any] = radial_distortion,
) -> Calibration:
    """Calibrate a camera from the corners of a planar board seen in several views.

    Parameters
    ----------
    board_points : array_like, shape (n, 2) or (n, 3), or a list of such
        The corners on the board, Z = 0; one set for all views, or one for each.
    image_points : array_like, shape (n_views, n, 2), or a list of (n_i, 2)
        The same corners in the pictures, in pixels.
    size : (width, height)
        Size of the pictures.
    lens : {"none", "k1", "k1 k2", "k1 k2 k3", "k1 k2 p1 p2", "k1 k2 p1 p2 k3"}
        Which lens coefficients are estimated; the others are zero.
    skew : bool
        Estimate the skew too; three views are then needed, else two.
    homography : callable
        Step 1, (src (n, 2), dst (n, 2)) → H (3, 3).
    intrinsics : callable
        Step 2, H (n_views, 3, 3) → A (3, 3). By default the closed form competes with the same
        constraints solved for the focal lengths alone.
    extrinsics : callable
        Step 3, (A, H (n_views, 3, 3)) → G (n_views, 4, 4).
    distortion : callable
        Step 4, (A, G, W, m, terms=…) → k (terms,).

    Returns
    -------
    Calibration
        With error bars, and with sentences about what is doubtful.

    Raises
    ------
    DegenerateError
        Too few views or points, or views that say nothing about the camera.
    ConvergenceError
        The refinement left the space of cameras; the corners are probably wrong.

    Warns
    -----
    CalibrationWarning
        The answer is doubtful; the sentences are also in ``warnings`` of the result.

    Notes
    -----
    Steps 1 to 4 see the board centred and scaled to unit size and the picture centred and scaled
    to [−1, 1], which keeps their systems well conditioned. Each H stays the one of step 1: the
    notes refine it by itself, but step 5 refines everything at once. The homographies were fitted
    to distorted corners, so steps 2 to 4 are biased (erratum E35); they are only a start.

    References
    ----------
    .. [1] Notes 2b.4, "Zhang's Method".
    .. [2] Z. Zhang, A flexible new technique for camera calibration, PAMI 22 (2000) 1330-1334.

    Examples
    --------
    >>> from cvnotes.camera import Camera, intrinsics
    >>> from cvnotes.camera import Lens
    >>> from cvnotes.camera import pose, rotation_from_vector
    >>> from cvnotes.targets import Chessboard
    >>> board = Chessboard((9, 6), 25.0)
    >>> camera = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.1)))
    >>> tilts = [(0.5, 0, 0), (0, 0.5, 0), (-0.4, 0.3, 0.1)]
    >>> views = [camera.moved(pose(rotation_from_vector(w), [-90, -60, 450])) for w in tilts]
    >>> seen = [view.project(board.points) for view in views]
    >>> calibrate(board.points, seen, camera.size).A.round(6) + 0.0
    array([[800.,   0., 325.],
           [  0., 804., 238.],
           [  0.,   0.,   1.]])
    """
    if not isinstance(lens, str) or lens not in LENSES:
        raise CvnotesError(f"lens: expected one of {', '.join(map(repr, LENSES))}, got {lens!r}")
    n_radial, tangential = LENSES[lens]
    size = image_size(size)
    data = Correspondences.of(board_points, image_points)
    problem = Problem(data.W, data.m, data.seen, skew, n_radial, tangential)
    _enough(data, problem, 3 if skew else 2)
    steps = Steps(size, homography, intrinsics, extrinsics, distortion)
    return _result(problem, data, size, _best_minimum(problem, steps))


def _enough(data: Correspondences, problem: Problem, n_views: int) -> None:
    """Refuse fewer views, or fewer measured coordinates, than the unknowns need."""
    if len(data) < n_views:
        raise DegenerateError(
            f"need at least {n_views} views of the board, got {len(data)}: each gives two "
            f"constraints on A, which has {2 * n_views - 1 + (n_views == 2)} unknowns"
        )
    unknowns = len(problem.names) + 6 * len(data)
    if 2 * problem.n_seen <= unknowns:
        raise DegenerateError(
            f"{2 * problem.n_seen} measured coordinates cannot determine {unknowns} parameters; "
            "add views or points, or estimate a simpler lens"
        )


def _spread(n: int, kept: int) -> npt.NDArray[np.intp]:
    """Choose `kept` of n views, evenly; all of them when there are no more."""
    return np.unique(np.linspace(0, n - 1, min(n, kept)).astype(np.intp))


def _starts(problem: Problem, steps: Steps) -> Iterator[State]:
    """Give the starts of all views, before which a few of many views may say more, and sooner."""
    if len(problem.m) > _MANY_VIEWS:
        with suppress(ConvergenceError, DegenerateError):
            few = problem.some(_spread(len(problem.m), _VIEWS_FOR_START))
            camera = _best_minimum(few, steps, tolerance=1e-6).x.shared
            yield steps.resumed(problem, camera)
    yield from steps.starts(problem)


def _best_minimum(problem: Problem, steps: Steps, tolerance: float = 1e-12) -> _Minimum:
    """Step 5, from the first start, and from the others if that leads nowhere."""
    found: list[_Minimum] = []
    good = (_SUSPICIOUS * max(steps.size)) ** 2 * problem.n_seen
    for start in _starts(problem, steps):
        with suppress(ConvergenceError, DegenerateError):
            found.append(minimise(problem, start, tolerance=tolerance))
            if found[-1].converged and found[-1].cost < good:
                break
    if not found:
        yours = f", or your {' and '.join(steps.own)} start far from it" if steps.own else ""
        raise ConvergenceError(
            "no start leads to a camera: the corners are probably paired with the wrong points "
            f"of the board, or the views do not determine the camera{yours}"
        )
    return min(found, key=lambda minimum: minimum.cost)


def _result(
    problem: Problem,
    data: Correspondences,
    size: tuple[int, int],
    best: _Minimum,
) -> Calibration:
    """Undo the scaling, add the error bars, and judge."""
    A, lens = problem.camera_of(best.x.shared)
    freedom = 2 * problem.n_seen - len(problem.names) - 6 * len(data)
    variance = best.cost / freedom
    unit = covariance(best.system)

    def poses() -> Array:
        J = data.pose_jacobian(best.x.R)
        return J @ (variance * pose_covariance(best.system, unit)) @ J.mT

    residuals = problem.m - problem.predicted(A, lens, best.x)
    if problem.seen is not None:
        residuals = residuals * problem.seen[..., None]
    evidence = Evidence(
        A=A,
        lens=lens,
        size=size,
        poses=data.pose_in_given_units(best.x.R, best.x.T),
        std=dict(zip(problem.names, np.sqrt(variance * np.diagonal(unit)).tolist(), strict=True)),
        view_rms=np.sqrt(best.system.view_costs / problem.n_seen_by_view),
        distances=np.sqrt(residuals[..., 0] ** 2 + residuals[..., 1] ** 2),
        corners=problem.m,
        converged=best.converged,
        likeness=likeness(residuals, freedom),
    )
    sentences, reliable = judge(evidence)
    for sentence in sentences:
        warn(sentence, CalibrationWarning, stacklevel=3)
    return Calibration(
        A=A,
        lens=lens,
        size=size,
        poses=evidence.poses,
        rms=float(np.sqrt(best.cost / problem.n_seen)),
        view_rms=evidence.view_rms,
        names=problem.names,
        covariance=variance * unit,
        warnings=sentences,
        reliable=reliable,
        converged=best.converged,
        _data=data,
        _pose_covariance=poses,
    )
