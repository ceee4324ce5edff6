"""The pose of a known camera from one picture of known points (notes 2b.4, extrinsics)."""

from contextlib import suppress

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    ConvergenceError,
    CvnotesError,
    DegenerateError,
    Minimum,
    ShapeError,
    levenberg_marquardt,
    paired,
    points,
    solve_dense,
)
from cvnotes.calibration.ppm import ppm_dlt
from cvnotes.calibration.reserve import flipped_pose
from cvnotes.calibration.zhang import extrinsics
from cvnotes.camera import Camera, nearest_rotation, pose, rotation_from_vector, skew_matrix
from cvnotes.camera.model import is_camera, project_with_derivative
from cvnotes.homography import dlt

# Thickness over size. A target that is nearly flat has the two poses of a plane, and noise decides
# what its PPM says about depth; below _FLAT the PPM is not asked.
_NEARLY_FLAT, _FLAT = 0.1, 0.01

Pose = tuple[Array, Array]  # R (3, 3) and T (3,) while the target is scaled to unit size


def pose_from_view(
    camera: Camera, target_points: npt.ArrayLike, image_points: npt.ArrayLike
) -> Array:
    """Estimate where a target stands in the frame of a camera that is known.

    Parameters
    ----------
    camera : Camera
        Its A and lens are used; its own pose is not.
    target_points : array_like, shape (n, 2) or (n, 3)
        At least 4 points of a flat target (a board's ``points``), or 6 points in space.
    image_points : array_like, shape (n, 2)
        Where the picture shows them, in pixels.

    Returns
    -------
    ndarray, shape (4, 4)
        G, CRF ← target: the pose with the smallest reprojection error.

    Raises
    ------
    DegenerateError
        The points do not determine the pose.
    CvnotesError
        A pixel lies where the lens model ends.

    Notes
    -----
    1. Sensor and lens are undone; 2. the homography of the ideal points (or, in space, their
    PPM) gives a first pose; 3. Levenberg–Marquardt on its six parameters. A flat target that is
    small or far has a second pose with nearly the same picture, tilted to the other side of the
    line of sight; both are refined and the better one is taken. So they are when the target is flat
    but for a hundredth of its size, like a bent board; up to a tenth the PPM competes with them.

    References
    ----------
    .. [1] Notes 2b.4, "Estimation of extrinsic parameters".
    .. [2] G. Schweighofer and A. Pinz, Robust pose estimation from a planar target, PAMI 28
       (2006) 2024-2030, on the two minima.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> from cvnotes.camera import Lens
    >>> from cvnotes.targets import Chessboard
    >>> board = Chessboard((9, 6), 25.0)
    >>> camera = Camera(intrinsics(800, 800, 320, 240), lens=Lens(k=(-0.2,)))
    >>> G = pose([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]], [-100, -60, 500])
    >>> seen = camera.moved(G).project(board.points)
    >>> np.allclose(pose_from_view(camera, board.points, seen), G)
    True
    """
    camera = is_camera(camera, "camera")
    W, m = points(target_points, "target_points", 2, 3), points(image_points, "image_points", 2)
    if W.ndim != 2 or m.ndim != 2:
        raise ShapeError(
            f"one picture has points (n, 3) and pixels (n, 2), got {W.shape} and {m.shape}"
        )
    paired(W, m, ("target_points", "image_points"), at_least=4)
    if W.shape[1] == 2:
        W = np.column_stack([W, np.zeros(len(W))])
    xy = _ideal(camera, m)
    # The target centred and of unit size, so that ω and T count alike.
    centre = W.mean(0)
    scale = float(np.linalg.norm(W - centre, axis=-1).max())
    if scale <= 1e-12 * np.abs(centre).max(initial=0.0):
        raise DegenerateError("all points of the target coincide")
    W = (W - centre) / scale
    R, T = _best(camera, W, m, xy)
    return pose(nearest_rotation(R), scale * T - R @ centre)


def _ideal(camera: Camera, m: Array) -> Array:
    """Undo sensor and lens, or say which pixel no ideal point is shown at."""
    xy = camera.ideal(m)
    bad = np.isnan(xy).any(-1)
    if bad.any():
        i = int(np.argmax(bad))
        raise CvnotesError(
            f"image_points: pixel {i}, {m[i].round(1).tolist()}, lies where the lens model of the "
            "camera ends; leave it out"
        )
    return xy


def _best(camera: Camera, W: Array, m: Array, xy: Array) -> Pose:
    """Refine every start that the target's shape allows, and take what fits best."""
    flatness, F = _plane(W)
    minima, why = [], None
    try:
        if flatness <= _NEARLY_FLAT:
            x = _start_in_plane(W, xy, F)
            minima.append(_refine(camera, x, W, m))
            x = minima[0].x
            turned = flipped_pose(x[0], x[1], F[:, 2])
            with suppress(ConvergenceError, DegenerateError):  # the other pose may lead nowhere
                minima.append(_refine(camera, (turned, x[1]), W, m))
    except (ConvergenceError, DegenerateError) as error:
        why = error
    try:
        if flatness > _FLAT:
            minima.append(_refine(camera, _start_in_space(W, xy), W, m))
    except (ConvergenceError, DegenerateError) as error:
        why = error
    if why and not minima:
        raise why
    return min(minima, key=lambda minimum: minimum.cost).x


def _plane(W: Array) -> tuple[float, Array]:
    """Return how flat centred points are (0: entirely), and give a frame (3, 3) on their plane.

    Its axes are the columns: two in the plane, and the normal.
    """
    _, s, Vt = np.linalg.svd(W, full_matrices=False)
    return float(s[2] / s[0]), Vt.T * np.linalg.det(Vt)


def _start_in_plane(W: Array, xy: Array, F: Array) -> Pose:
    """Return a pose of a target that is flat, or taken for flat, from its homography."""
    G = extrinsics(np.eye(3), dlt((W @ F)[:, :2], xy))
    return G[:3, :3] @ F.T, G[:3, 3]


def _start_in_space(W: Array, xy: Array) -> Pose:
    """Return a pose of a target in space from its perspective projection matrix."""
    P = ppm_dlt(W, xy)
    s = np.cbrt(np.linalg.det(P[:, :3]))
    if s <= 0:
        raise DegenerateError(
            "the points would lie behind the camera: is the picture mirrored, or (v, u) given for "
            "(u, v)?"
        )
    return nearest_rotation(P[:, :3] / s), P[:, 3] / s


def _refine(camera: Camera, start: Pose, W: Array, m: Array) -> Minimum[Pose, Array]:
    """Minimise the reprojection error on ω of R ← exp(ω) R and on T."""

    def linearise(x: Pose) -> tuple[float, Array]:
        R, T = x
        RW = W @ R.T
        predicted, by_M = project_with_derivative(camera, RW + T)
        r = predicted - m
        J = np.concatenate([-by_M @ skew_matrix(RW), by_M, r[:, :, None]], axis=-1).reshape(-1, 7)
        return float((r * r).sum()), J.T @ J

    def take_step(x: Pose, step: Array) -> Pose:
        return rotation_from_vector.inside(step[:3]) @ x[0], x[1] + step[3:]

    floor = 1e-25 * m.size
    return levenberg_marquardt(start, linearise, solve_dense, take_step, floor=floor)
