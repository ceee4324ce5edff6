"""From pictures back to space: triangulation, and depth from the disparity of a rectified pair."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CvnotesError,
    DegenerateError,
    InputTypeError,
    ShapeError,
    levenberg_marquardt,
    numbers,
    points,
)
from cvnotes.camera import Camera
from cvnotes.camera.model import is_camera, project_with_derivative

# Rays that meet at less than about this angle (radians) are parallel to within rounding.
_PARALLEL = 1e-12


def triangulate(
    cameras: Sequence[Camera], image_points: npt.ArrayLike, *, refine: bool = True
) -> Array:
    """Find the points in space that two or more cameras see.

    Parameters
    ----------
    cameras : sequence of k Camera
        At least two, not all in one place.
    image_points : array_like, shape (k, ..., 2)
        Where each camera shows the points, in pixels, as seen through its lens.
    refine : bool
        Minimise the reprojection error; otherwise the linear solution is given.

    Returns
    -------
    ndarray, shape (..., 3)
        Points in the WRF. Rows are NaN where the rays are parallel, where the point would lie
        behind a camera, and where a pixel is out of the lens model's reach.

    Raises
    ------
    DegenerateError
        All cameras stand in one place: the baseline is zero.

    Notes
    -----
    Each camera gives two linear equations in W̃, x (r3ᵀ W̃) = r1ᵀ W̃ and y (r3ᵀ W̃) = r2ᵀ W̃, with
    the ideal point (x, y) and the rows r of [R|T]; W̃ is their null vector. They are written in a
    frame at the cameras' centroid, with their distance as the unit. The linear solution weighs
    the equations by depth; the refinement minimises pixels, as the notes do for homographies.

    Pixels that do not belong together give a point all the same; project it to see how far off.

    References
    ----------
    .. [1] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 12.2 and 12.3.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, pose
    >>> left = Camera(intrinsics(800, 800, 320, 240))
    >>> right = left.moved(pose(np.eye(3), [-100, 0, 0]))
    >>> W = [[30, 40, 500], [0, 0, 700]]
    >>> triangulate([left, right], [left.project(W), right.project(W)]).round(9) + 0.0
    array([[ 30.,  40., 500.],
           [  0.,   0., 700.]])
    """
    cameras, m = _guard(cameras, image_points)
    shape = m.shape[1:-1]
    m = m.reshape(len(cameras), -1, 2)
    xy = np.stack([camera.ideal(m_i) for camera, m_i in zip(cameras, m, strict=True)])
    origin, unit = _frame(cameras)
    # [R|T] of each camera in the new frame, W = origin + unit W'.
    RT = np.stack([np.column_stack([c.R, (c.R @ origin + c.T) / unit]) for c in cameras])
    W = np.full((m.shape[1], 3), np.nan)
    known = ~np.isnan(xy).any((0, 2))
    if known.any():
        W[known] = _linear(RT, xy[:, known])
    W[_behind(RT, W)] = np.nan
    known = ~np.isnan(W).any(-1)
    if refine and known.any():
        W[known] = _refined(cameras, RT, W[known], m[:, known])
        W[_behind(RT, W)] = np.nan
    return np.asarray(origin + unit * W).reshape(*shape, 3)


def disparity_to_depth(disparity: npt.ArrayLike, left: Camera, right: Camera) -> Array:
    """Turn disparities of a rectified pair into depths Z, same shape, in the unit of T.

    Z = α b / d, with the disparity d = u_left − u_right and the baseline b (from cameras one
    above the other, d = v_left − v_right). d = 0 is infinitely far away: inf. Where d has the
    wrong sign, no point in front of the cameras is seen: NaN.

    Raises
    ------
    CvnotesError
        The cameras are not a rectified pair; see `rectify`.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, pose
    >>> left = Camera(intrinsics(800, 800, 320, 240))
    >>> right = left.moved(pose(np.eye(3), [-100, 0, 0]))
    >>> disparity_to_depth([160, 80, 0], left, right)
    array([ 500., 1000.,   inf])
    """
    d = numbers(disparity, "disparity")
    axis, b = rectified_baseline(left, right)
    scaled = left.A[axis, axis] * b
    with np.errstate(over="ignore"):
        depth = np.divide(scaled, d, out=np.full_like(d, np.inf), where=d != 0)
    return np.asarray(np.where(depth > 0, depth, np.nan))


def rectified_baseline(left: Camera, right: Camera) -> tuple[int, float]:
    """Return the axis (0: side by side, 1: one above the other) and the signed baseline along it.

    Raises
    ------
    CvnotesError
        The cameras differ in more than their position along that axis.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, pose
    >>> left = Camera(intrinsics(800, 800, 320, 240))
    >>> rectified_baseline(left, left.moved(pose(np.eye(3), [-100, 0, 0])))
    (0, 100.0)
    """
    left, right = is_camera(left, "left"), is_camera(right, "right")
    b = left.R @ (right.centre - left.centre)
    axis = int(np.argmax(np.abs(b[:2])))
    length = np.linalg.norm(b)
    same = np.abs(left.A - right.A).max() <= 1e-9 * left.A.max()
    parallel = np.abs(left.R - right.R).max() <= 1e-9
    ideal = left.lens.is_ideal and right.lens.is_ideal
    if not (same and parallel and ideal and length > 0 and abs(b[axis]) >= (1 - 1e-15) * length):
        raise CvnotesError(
            "the cameras are not a rectified pair (equal A and R, no lens, centres on one of "
            "their axes); rectify gives such a pair"
        )
    return axis, float(b[axis])


def _guard(cameras: Sequence[Camera], image_points: npt.ArrayLike) -> tuple[list[Camera], Array]:
    try:
        cameras = [is_camera(camera, f"cameras[{i}]") for i, camera in enumerate(cameras)]
    except TypeError as error:
        raise InputTypeError(f"cameras: expected several cameras; {error}") from error
    if len(cameras) < 2:
        raise DegenerateError(f"need at least 2 cameras, got {len(cameras)}")
    m = points(image_points, "image_points", 2)
    if m.ndim < 2 or len(m) != len(cameras):
        raise ShapeError(
            f"image_points: expected ({len(cameras)}, ..., 2), the pixels of each of the "
            f"{len(cameras)} cameras, got {m.shape}"
        )
    return cameras, m


def _frame(cameras: list[Camera]) -> tuple[Array, float]:
    """Return the centroid of the camera centres and how far they stand apart."""
    centres = np.stack([camera.centre for camera in cameras])
    origin = centres.mean(0)
    unit = float(np.linalg.norm(centres - origin, axis=-1).max())
    if unit <= 1e-12 * max(float(np.abs(camera.T).max()) for camera in cameras):
        raise DegenerateError(
            "the baseline is zero: cameras in one place see no depth; move one of them"
        )
    return origin, unit


def _linear(RT: Array, xy: Array) -> Array:
    """Null vectors of the equations of all points: (n, 3) from (k, 3, 4) and (k, n, 2)."""
    D = xy[..., None] * RT[:, None, 2:] - RT[:, None, :2]  # (k, n, 2, 4)
    D = D.transpose(1, 0, 2, 3).reshape(xy.shape[1], -1, 4)
    W_h = np.linalg.svd(D, full_matrices=False)[2][:, 3]
    w = np.where(np.abs(W_h[:, 3:]) > _PARALLEL, W_h[:, 3:], np.nan)
    return np.asarray(W_h[:, :3] / w)


def _behind(RT: Array, W: Array) -> npt.NDArray[np.bool_]:
    """Return which points (n, 3) are not in front of every camera."""
    depths = W @ RT[:, 2, :3].T + RT[:, 2, 3]
    return np.asarray(~(depths > 0).all(-1))


def _refined(cameras: list[Camera], RT: Array, W: Array, m: Array) -> Array:
    """Minimise the reprojection error of all points, each by its own three coordinates."""
    D = _moves(W)

    def linearise(W: Array) -> tuple[float, tuple[Array, Array]]:
        cost, normal, gradient = 0.0, np.zeros((len(W), 3, 3)), np.zeros((len(W), 3))
        for camera, rt, seen in zip(cameras, RT, m, strict=True):
            predicted, by_M = project_with_derivative(camera, W @ rt[:, :3].T + rt[:, 3])
            r, J = predicted - seen, by_M @ rt[:, :3] @ D
            cost += float((r * r).sum())
            normal += J.mT @ J
            gradient += (J.mT @ r[:, :, None])[:, :, 0]
        return cost, (normal, gradient)

    def solve(system: tuple[Array, Array], damping: float) -> tuple[Array, float]:
        normal, gradient = system
        damped = normal * (1 + damping * np.eye(3))
        still = np.linalg.det(damped) == 0  # seen along a line; the others are not kept waiting
        damped[still], gradient = np.eye(3), np.where(still[:, None], 0.0, gradient)
        step = np.asarray(-np.linalg.solve(damped, gradient[:, :, None])[:, :, 0])
        return step, -float((gradient * step).sum())

    def take_step(W: Array, step: Array) -> Array:
        return np.asarray(W + (D @ step[:, :, None])[:, :, 0])

    return levenberg_marquardt(W, linearise, solve, take_step, floor=1e-25 * m.size).x


def _moves(W: Array) -> Array:
    """Return three moves (n, 3, 3) of each point that change its images about equally.

    Across the line of sight that is the distance, along it the distance squared (in baselines):
    without these units the equations of far points are singular.
    """
    distance = np.linalg.norm(W, axis=-1)[:, None, None]
    D = np.linalg.qr(W[:, :, None], mode="complete")[0] * distance
    D[:, :, :1] *= np.maximum(distance, 1)
    return np.asarray(D)
