"""Two known cameras: how they stand to each other, and the lines on which partners lie.

A point, its two images and the two camera centres lie in one plane, the epipolar plane. So the
partner of a pixel is found on a line, the image of the other camera's ray. Pixels here are ideal:
with a lens, undistort them first, ``px_from_xy(camera.A, camera.ideal(m))``.
"""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, ShapeError, matrix, points
from cvnotes.camera import Camera, chain, inverse, skew_matrix
from cvnotes.camera.model import is_camera
from cvnotes.projective import to_homogeneous


def relative_pose(left: Camera, right: Camera) -> Array:
    """Return the rigid motion (4, 4) from the left camera's frame into the right one's.

    right ← left = (right ← world) (world ← left).

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, pose
    >>> left = Camera(intrinsics(800, 800, 320, 240))
    >>> relative_pose(left, left.moved(pose(np.eye(3), [-100, 0, 0])))[:3, 3]
    array([-100.,    0.,    0.])
    """
    return chain(is_camera(right, "right").G, inverse(is_camera(left, "left").G))


def baseline(left: Camera, right: Camera) -> Array:
    """Return the vector (3,) from the left centre to the right one, in the WRF.

    Raises
    ------
    DegenerateError
        The baseline is zero: both cameras stand in one place, which shows no depth.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, pose
    >>> left = Camera(intrinsics(800, 800, 320, 240))
    >>> baseline(left, left.moved(pose(np.eye(3), [-100, 0, 0])))
    array([100.,   0.,   0.])
    """
    b = is_camera(right, "right").centre - is_camera(left, "left").centre
    reach = max(np.abs(left.T).max(), np.abs(right.T).max())
    if np.linalg.norm(b) <= 1e-12 * reach:
        raise DegenerateError(
            "the baseline is zero: two cameras in one place see no depth; move one of them"
        )
    return np.asarray(b)


def essential_matrix(left: Camera, right: Camera) -> Array:
    """Return E (3, 3) with (x, y, 1)_right E (x, y, 1)_leftᵀ = 0 on the planes z = 1: E = [T]× R.

    R and T are those of `relative_pose`; its singular values are ‖T‖, ‖T‖ and 0.

    Raises
    ------
    DegenerateError
        The baseline is zero.

    References
    ----------
    .. [1] H. C. Longuet-Higgins, Nature 293 (1981) 133-135.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, pose
    >>> left = Camera(intrinsics(800, 800, 320, 240))
    >>> essential_matrix(left, left.moved(pose(np.eye(3), [-100, 0, 0]))) + 0.0
    array([[   0.,    0.,    0.],
           [   0.,    0.,  100.],
           [   0., -100.,    0.]])
    """
    baseline(left, right)
    G = relative_pose(left, right)
    return np.asarray(skew_matrix(G[:3, 3]) @ G[:3, :3])


def fundamental_matrix(left: Camera, right: Camera) -> Array:
    """Return F (3, 3), ‖F‖ = 1, with m̃_rightᵀ F m̃_left = 0 for ideal pixels: F ≈ A_r⁻ᵀ E A_l⁻¹.

    Raises
    ------
    DegenerateError
        The baseline is zero.

    References
    ----------
    .. [1] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 9.2 and 9.6.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, pose
    >>> left = Camera(intrinsics(800, 800, 320, 240))
    >>> right = left.moved(pose(np.eye(3), [-100, 0, 0]))
    >>> F = fundamental_matrix(left, right)
    >>> m_left, m_right = left.project([30, 40, 500]), right.project([30, 40, 500])
    >>> bool(abs(np.append(m_right, 1) @ F @ np.append(m_left, 1)) < 1e-12)
    True
    """
    E = essential_matrix(left, right)
    F = np.linalg.solve(right.A.T, E) @ np.linalg.inv(left.A)
    return np.asarray(F / np.linalg.norm(F))


def epipolar_lines(F: npt.ArrayLike, m: npt.ArrayLike) -> Array:
    """Return the lines (..., 3) in the right picture on which partners of left pixels lie.

    l = F m̃, scaled to a² + b² = 1, so that l · m̃ is a distance in pixels. With ``F.T`` the
    lines in the left picture. The epipole itself has no line: NaN.

    Examples
    --------
    >>> F = [[0, 0, 0], [0, 0, 1], [0, -1, 0]]  # a rectified pair: equal rows
    >>> epipolar_lines(F, [320, 100])
    array([   0.,    1., -100.])
    """
    F = matrix(F, "F", 3, 3)
    if F.ndim != 2:
        raise ShapeError(f"F: expected one (3, 3) matrix, got {F.shape}")
    with np.errstate(over="ignore", invalid="ignore"):  # what overflows has no line either
        line = to_homogeneous(points(m, "m", 2)) @ F.T
    length = np.hypot(line[..., :1], line[..., 1:2])
    has_line = (length > 0) & np.isfinite(length)
    scaled = np.divide(line, length, out=np.full_like(line, np.nan), where=has_line)
    return np.asarray(scaled + 0.0)


def epipole(left: Camera, right: Camera) -> Array:
    """Return where the left picture shows the right camera's centre, homogeneous (3,).

    All epipolar lines of the left picture meet there. A last coordinate of 0 is a point at
    infinity: the lines are parallel, as in a rectified pair.

    Raises
    ------
    DegenerateError
        The baseline is zero.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics, pose
    >>> left = Camera(intrinsics(800, 800, 320, 240))
    >>> epipole(left, left.moved(pose(np.eye(3), [0, 0, -100])))
    array([320., 240.,   1.])
    """
    b = baseline(left, right)
    e = left.A @ left.R @ b
    return np.asarray(e / e[2] if abs(e[2]) > 1e-15 * np.abs(e).max() else [e[0], e[1], 0.0])
