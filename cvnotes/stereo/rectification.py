"""Rectification: a stereo pair turned so that partners share their row (notes 2b.5)."""

from typing import NamedTuple
from warnings import warn

import numpy as np

from cvnotes.base import Array, CalibrationWarning, CvnotesError, DegenerateError, image_size
from cvnotes.camera import Camera, pose, rotation_from_vector, vector_from_rotation
from cvnotes.camera.model import is_camera
from cvnotes.stereo.epipolar import baseline, relative_pose
from cvnotes.stereo.triangulation import rectified_baseline
from cvnotes.warping import map_array, undistortion_map
from cvnotes.warping.framing import border, framing

# How far from where the rectified cameras look a camera may look (a cosine): two that are to be
# turned by more see each other, or nearly so.
_TURNED = np.cos(np.deg2rad(50))
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
        return rectified_baseline(self.left, self.right)[0]

    @property
    def baseline(self) -> float:
        """Distance between the cameras, negative when left stands to the right of right."""
        return rectified_baseline(self.left, self.right)[1]


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
        either photograph is lost. A photograph ends where its lens model does, and 70° away from
        where the rectified cameras look.

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
    for camera in (left, right):
        if R[2] @ camera.R[2] < _TURNED:
            raise DegenerateError(
                "the cameras stand one behind the other, or look in too different directions: "
                "their pictures cannot be turned to share rows. Move one camera sideways"
            )
    A = framing(
        [border(camera, R @ camera.R.T) for camera in (left, right)], size, full=keep == "valid"
    )
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
