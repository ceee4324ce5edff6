"""Calibration: from corners seen in several views to a camera with error bars (notes 2b.4)."""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any
from warnings import warn

import numpy as np
import numpy.typing as npt

from cvnotes.camera import xy_from_px
from cvnotes.correspondences import Correspondences, PointSets
from cvnotes.errors import (
    Array,
    CalibrationWarning,
    ConvergenceError,
    CvnotesError,
    DegenerateError,
    image_size,
    intrinsic_matrix,
    matrix,
    numbers,
    rigid_motion,
)
from cvnotes.homography import dlt
from cvnotes.lens import Lens
from cvnotes.optimise import Minimum
from cvnotes.refine import Arrow, Problem, State, covariance, minimise, pose_covariance
from cvnotes.reliability import Evidence, judge
from cvnotes.result import Calibration
from cvnotes.zhang import (
    constraints,
    extrinsics,
    focal_lengths_from_homographies,
    intrinsics_from_b,
    radial_distortion,
    solve_b,
)

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
# Views among which the start is sought; what they agree on, the others only sharpen.
_VIEWS_FOR_START = 10
# Strong lenses bend the boards so much that homographies mislead. In reserve, the corners are
# first straightened: x ← x (1 + bend r²), with r = 1 at the ends of the picture's longer axis.
_BENDS = (0.0, 0.2, -0.2)
# px per point: a start that leaves more than this is not trusted before the others were tried.
_SUSPICIOUS_RMS = 2.0


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
    >>> from cvnotes.rigid import pose, rotation_from_vector
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
    if lens not in LENSES:
        raise CvnotesError(f"lens: expected one of {', '.join(map(repr, LENSES))}, got {lens!r}")
    n_radial, tangential = LENSES[lens]
    size = image_size(size)
    data = Correspondences.of(board_points, image_points)
    problem = Problem(data.W, data.m, data.seen, skew, n_radial, tangential)
    _enough(data, problem, 3 if skew else 2)
    steps = _Steps(size, homography, intrinsics, extrinsics, distortion)

    if len(data) <= 2 * _VIEWS_FOR_START:
        best = _first_minimum(problem, steps)
    else:
        # a few views give the camera, from which all of them need fewer iterations
        few = problem.some(_spread(len(data), _VIEWS_FOR_START))
        camera = _first_minimum(few, steps, tolerance=1e-6).x.shared
        best = minimise(problem, steps.resumed(problem, camera))
    return _result(problem, data, size, best)


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


def _picture_normaliser(size: tuple[int, int]) -> Array:
    """Similarity that takes the picture's middle to 0 and its longer side to [−1, 1]."""
    w, h = size
    s = 2 / max(w, h)
    return np.array([[s, 0, -s * (w - 1) / 2], [0, s, -s * (h - 1) / 2], [0, 0, 1]])


@dataclass(frozen=True)
class _Steps:
    """Steps 1 to 4, the library's own or the student's."""

    size: tuple[int, int]
    homography: Callable[..., Any]
    intrinsics: Callable[..., Any] | None
    extrinsics: Callable[..., Any]
    distortion: Callable[..., Any]

    def homographies(self, problem: Problem, m: Array) -> Array:
        """1. One homography for each view."""
        src = problem.W[..., :2]
        if self.homography is dlt and problem.seen is None:
            return dlt(src, m)
        H = []
        for i in range(len(m)):
            seen = slice(None) if problem.seen is None else problem.seen[i]
            try:
                given = self.homography((src if src.ndim == 2 else src[i])[seen], m[i][seen])
            except DegenerateError as error:
                raise DegenerateError(f"view {i}: {error}") from error
            H.append(matrix(given, f"the homography of view {i}", 3, 3))
        return np.array(H)

    def candidates(self, H: Array, skew: bool) -> Iterator[Array]:
        """2. Intrinsics: the focal lengths alone, then, in reserve, the full closed form."""
        if self.intrinsics is not None:
            yield intrinsic_matrix(self.intrinsics(H), "the A of your intrinsics")
            return
        b = solve_b(constraints(H), skew=skew)
        with suppress(DegenerateError):
            yield focal_lengths_from_homographies(H)
        with suppress(DegenerateError):
            yield intrinsics_from_b(b)
        # Noise can leave neither; then a few usual fields of view, from 90° to 28°, are tried.
        for f in (1.0, 2.0, 4.0):
            yield np.diag([f, f, 1.0])

    def starts(self, problem: Problem) -> Iterator[State]:
        """Run steps 1 to 4; gives a state for each candidate, the most robust first."""
        N = _picture_normaliser(self.size)
        m = problem.m * N[0, 0] + N[:2, 2]
        to_px = np.linalg.inv(N)
        for bend in _BENDS if problem.n_radial else _BENDS[:1]:
            H = self.homographies(problem, m * (1 + bend * (m * m).sum(-1, keepdims=True)))
            for A in self.candidates(H, problem.skew):
                with suppress(DegenerateError):
                    yield self.with_lens(problem, to_px @ A, self.poses(A, H))

    def poses(self, A: Array, H: Array) -> Array:
        """3. The pose of each view."""
        return rigid_motion(self.extrinsics(A, H), "the poses of your extrinsics")

    def with_lens(self, problem: Problem, A: Array, G: Array) -> State:
        """4. The lens by linear least squares."""
        k: Array = np.zeros(0)
        if problem.n_radial:
            given = self.distortion(A, G, problem.W, problem.m, terms=problem.n_radial)
            k = numbers(given, "the k of your distortion")
        return problem.state(A, Lens(k=tuple(k)), G)

    def resumed(self, problem: Problem, shared: Array) -> State:
        """Give the state of all views, from what a few of them say about the camera."""
        A, lens = problem.camera_of(shared)
        ideal = lens.undistort(xy_from_px(A, problem.m))
        as_seen = xy_from_px(A, problem.m)
        H = self.homographies(problem, np.where(np.isnan(ideal), as_seen, ideal))
        G = self.poses(np.eye(3), H)
        return State(shared, G[:, :3, :3], G[:, :3, 3])


def _first_minimum(
    problem: Problem, steps: _Steps, tolerance: float = 1e-12
) -> Minimum[State, Arrow]:
    """Step 5, from the best start, and from the others if that leads nowhere."""
    found: list[Minimum[State, Arrow]] = []
    for start in steps.starts(problem):
        with suppress(ConvergenceError, DegenerateError):
            found.append(minimise(problem, start, tolerance=tolerance))
            if found[-1].converged and found[-1].cost < _SUSPICIOUS_RMS**2 * problem.n_seen:
                break
    if not found:
        raise ConvergenceError(
            "no start leads to a camera: the corners are probably paired with the wrong points "
            "of the board, or the views do not determine the camera"
        )
    return min(found, key=lambda minimum: minimum.cost)


def _result(
    problem: Problem,
    data: Correspondences,
    size: tuple[int, int],
    best: Minimum[State, Arrow],
) -> Calibration:
    """Undo the scaling, add the error bars, and judge."""
    A, lens = problem.camera_of(best.x.shared)
    freedom = 2 * problem.n_seen - len(problem.names) - 6 * len(data)
    variance = best.cost / freedom
    cov = variance * covariance(best.system)

    def poses() -> Array:
        J = data.pose_jacobian(best.x.R)
        return J @ (pose_covariance(best.system, cov / variance) * variance) @ J.mT

    result = Calibration(
        A=A,
        lens=lens,
        size=size,
        poses=data.pose_in_given_units(best.x.R, best.x.T),
        rms=float(np.sqrt(best.cost / problem.n_seen)),
        view_rms=np.sqrt(best.system.view_costs / problem.n_seen_by_view),
        names=problem.names,
        covariance=cov,
        converged=best.converged,
        _data=data,
        _pose_covariance=poses,
    )
    distances = np.linalg.norm(problem.m - problem.predicted(A, lens, best.x), axis=-1)
    if problem.seen is not None:
        distances = distances * problem.seen
    return _judged(result, distances, problem.m)


def _judged(result: Calibration, distances: Array, corners: Array) -> Calibration:
    """Add what is doubtful to the result, and warn of it."""
    sentences, reliable = judge(
        Evidence(
            result.A,
            result.lens,
            result.size,
            result.poses,
            result.std,
            result.view_rms,
            distances,
            corners,
            result.converged,
        )
    )
    for sentence in sentences:
        warn(sentence, CalibrationWarning, stacklevel=4)
    return replace(result, warnings=sentences, reliable=reliable)
