"""Two known cameras: how they stand to each other, and where one sees the other."""

import numpy as np

from cvnotes.base import Array, DegenerateError
from cvnotes.camera import Camera, chain, inverse
from cvnotes.camera.model import is_camera


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
