"""Rectification: a stereo pair turned so that partners share their row (notes 2b.5)."""

from typing import NamedTuple
from warnings import warn

import numpy as np

from cvnotes.base import Array, CalibrationWarning, CvnotesError, DegenerateError, image_size
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_vector, vector_from_rotation
from cvnotes.camera.model import is_camera
from cvnotes.stereo.epipolar import baseline, relative_pose
from cvnotes.warping import map_array, undistortion_map

# Smallest z, on rays of unit z in their own camera, that a rectified camera may see them at.
_SIDEWAYS = 0.1
_MOST_PIXELS = 80_000_000


class RectifiedPair(NamedTuple):
    """Two ideal cameras side by side, and where their pictures come from.

    Attributes
    ----------
    left, right : Camera
        The rectified cameras, in the same WRF as the given ones: one A, one R, no lens.
    left_map, right_map : ndarray, shape (height, width, 2)
        For each pixel of the rectified picture the pixel (u, v) of the photograph it shows, for a
        backward warp. NaN where the photograph has none.
    """

    left: Camera
    right: Camera
    left_map: Array
    right_map: Array

    @property
    def axis(self) -> int:
        """Axis of the disparity: 0, partners share their row; 1, they share their column."""
        return int(np.argmax(np.abs(self._baseline[:2])))

    @property
    def baseline(self) -> float:
        """Distance between the cameras, negative when left stands to the right of right."""
        return float(self._baseline[self.axis])

    @property
    def _baseline(self) -> Array:
        return np.asarray(self.left.R @ (self.right.centre - self.left.centre))


def rectify(
    left: Camera, right: Camera, *, size: tuple[int, int] | None = None, keep: str = "valid"
) -> RectifiedPair:
    """Turn two cameras about their centres until their pictures share their rows.

    Parameters
    ----------
    left, right : Camera
        Two calibrated cameras with their poses in one WRF. Cameras that stand one above the
        other rather than side by side share their columns instead.
    size : (width, height), optional
        Size of the rectified pictures; by default that of the left camera.
    keep : {"valid", "all"}
        "valid": both rectified pictures are full, without empty borders; "all": nothing of
        either photograph is lost. A photograph ends where its lens model does.

    Returns
    -------
    RectifiedPair
        Two cameras and two maps.

    Raises
    ------
    DegenerateError
        The baseline is zero, or the cameras stand one behind the other, so that one sees the
        other (the epipole) in or near its picture; or, with ``keep="valid"``, no common part is
        left.

    Warns
    -----
    CalibrationWarning
        Left stands to the right of right (or below it): all disparities will be negative.

    Notes
    -----
    1. Both cameras are turned by half of the rotation between them, which bends either picture as
    little as the other; 2. both by the smallest rotation that brings the baseline to their x axis
    (or y axis, if it is nearer); 3. they share an A with square pixels, so that v = v' and
    Z = α b / (u − u'); 4. each rectified pixel's ray is looked up in the photograph, through its
    lens, which therefore is undone too.

    Partners are not searched for: that is stereo matching, which this package leaves to others.

    References
    ----------
    .. [1] Notes 2b.5, which name stereo rectification only.
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 11.12, in general; the
       rotation is split as in J.-Y. Bouguet's calibration toolbox.

    Examples
    --------
    >>> from cvnotes.camera import Lens, intrinsics, rotation_from_vector
    >>> left = Camera(intrinsics(800, 800, 320, 240), lens=Lens(k=(-0.2,)))
    >>> right = left.moved(pose(rotation_from_vector([0.01, -0.05, 0.02]), [-99, 3, 5]))
    >>> pair = rectify(left, right)
    >>> v = pair.left.project([30, 40, 500])[1], pair.right.project([30, 40, 500])[1]
    >>> bool(abs(v[0] - v[1]) < 1e-9)
    True
    """
    if not isinstance(keep, str) or keep not in ("valid", "all"):
        raise CvnotesError(f"keep: expected 'valid' or 'all', got {keep!r}")
    size = image_size(is_camera(left, "left").size if size is None else size)
    if min(size) < 2 or size[0] * size[1] > _MOST_PIXELS:
        raise CvnotesError(f"size: cannot make rectified pictures of {size[0]}×{size[1]} pixels")
    R = _rectifying_rotation(left, right)
    A = _common_intrinsics([_border(camera, R) for camera in (left, right)], size, keep)
    cameras = [Camera(A, pose(R, -R @ camera.centre), size=size) for camera in (left, right)]
    maps = [map_array(undistortion_map(old, A, R=R @ old.R.T), size) for old in (left, right)]
    pair = RectifiedPair(cameras[0], cameras[1], maps[0], maps[1])
    if pair.baseline < 0:
        place = ("to the right of", "below")[pair.axis]
        warn(
            f"the camera given as left stands {place} the other, so all disparities are negative; "
            "swap the two",
            CalibrationWarning,
            stacklevel=2,
        )
    return pair


def _rectifying_rotation(left: Camera, right: Camera) -> Array:
    """Return the rotation (3, 3) from the WRF to the frame that both cameras are turned to."""
    # 1. halfway between the two cameras
    between = vector_from_rotation(relative_pose(left, right)[:3, :3])
    R = rotation_from_vector.inside(between / 2) @ left.R
    # 2. the baseline, seen from there, to the nearest axis
    b = R @ baseline(left, right)
    axis = int(np.argmax(np.abs(b[:2])))
    e = np.zeros(3)
    e[axis] = 1.0 if b[axis] >= 0 else -1.0
    n = np.cross(b, e)
    sine = np.linalg.norm(n)
    turn = n * (np.arctan2(sine, b @ e) / sine) if sine > 0 else n
    return np.asarray(rotation_from_vector.inside(turn) @ R)


def _border(camera: Camera, R: Array) -> list[Array]:
    """Return the picture's left, right, top and bottom pixels on the plane z = 1 of the frame R."""
    w, h = camera.size
    u, v = np.arange(w, dtype=float), np.arange(h, dtype=float)
    edges = [
        np.column_stack([np.zeros(h), v]),
        np.column_stack([np.full(h, w - 1.0), v]),
        np.column_stack([u, np.zeros(w)]),
        np.column_stack([u, np.full(w, h - 1.0)]),
    ]
    seen = []
    for edge in edges:
        xy = _ideal_within_reach(camera, edge)
        rays = np.column_stack([xy, np.ones(len(xy))]) @ (R @ camera.R.T).T
        if not (rays[:, 2] > _SIDEWAYS).all():
            raise DegenerateError(
                "the cameras stand one behind the other, or look in too different directions: "
                "their pictures cannot be turned to share rows. Move one camera sideways"
            )
        seen.append(rays[:, :2] / rays[:, 2:])
    return seen


def _ideal_within_reach(camera: Camera, edge: Array) -> Array:
    """Undo sensor and lens; what the lens model does not reach is moved inwards until it does."""
    xy = camera.ideal(edge)
    lost = np.isnan(xy).any(-1)
    if lost.any():
        centre = camera.A[:2, 2] + camera.A[:2, :2] @ camera.lens.centre
        inside, outside = np.zeros((lost.sum(), 1)), np.ones((lost.sum(), 1))
        for _ in range(30):
            middle = (inside + outside) / 2
            reached = np.isfinite(camera.ideal(centre + middle * (edge[lost] - centre)))[:, :1]
            inside, outside = np.where(reached, middle, inside), np.where(reached, outside, middle)
        xy[lost] = camera.ideal(centre + inside * (edge[lost] - centre))
    return xy


def _common_intrinsics(borders: list[list[Array]], size: tuple[int, int], keep: str) -> Array:
    """Choose α and (u0, v0) such that the wanted part of both pictures fills `size`."""
    inner, outer = (np.max, np.min), (np.min, np.max)
    low_of, high_of = inner if keep == "valid" else outer
    low, high = np.empty(2), np.empty(2)
    for axis in range(2):
        low[axis] = low_of([low_of(border[2 * axis][:, axis]) for border in borders])
        high[axis] = high_of([high_of(border[2 * axis + 1][:, axis]) for border in borders])
    if not (low < high).all():
        raise DegenerateError(
            "the rectified pictures have no common full part, the cameras are turned too far from "
            "each other; try keep='all'"
        )
    steps = np.array(size) - 1.0  # from the first pixel centre to the last
    scales = steps / (high - low)
    # A few thousandths of a pixel closer: the border was looked at in whole pixels only.
    alpha = max(scales) * (1 + 1e-5) if keep == "valid" else min(scales) * (1 - 1e-5)
    u0, v0 = steps / 2 - alpha * (low + high) / 2
    return intrinsics(alpha, alpha, u0, v0)
