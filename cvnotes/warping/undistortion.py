"""Maps that take the lens out of a picture, or put it in (notes 2b.5)."""

import warnings
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CalibrationWarning,
    Image,
    ShapeError,
    checked_image,
    chunks,
    intrinsic_matrix,
    rotation,
    target_size,
)
from cvnotes.camera import Camera
from cvnotes.warping.interpolation import Border, Method, Sampler
from cvnotes.warping.pixel_map import PixelMap, factored
from cvnotes.warping.warp import backward_warp


def undistortion_map(
    camera: Camera, new_A: npt.ArrayLike | None = None, *, R: npt.ArrayLike | None = None
) -> PixelMap:
    """Map the pixels of an ideal camera's picture to those of the real camera's picture.

    Parameters
    ----------
    camera : Camera
        The camera that took the picture.
    new_A : array_like, shape (3, 3), optional
        Intrinsic matrix of the ideal camera; by default the camera's own.
    R : array_like, shape (3, 3), optional
        Rotation ideal ← real camera about their common centre, as rectification asks for.

    Returns
    -------
    PixelMap
        For a backward warp: ideal target ↦ observed source. Pixels that the real camera cannot
        see, or that its lens model does not reach, have no image.

    Notes
    -----
    A backward warp needs the direction in which the lens model is written, so nothing has to be
    inverted: u' = ũ + (k1 r² + k2 r⁴)(ũ − u0) and alike for v, with r² from the ideal pixel,
    r² = ((ũ − u0)/α_u)² + ((ṽ − v0)/α_v)² (errata E34, E44).

    References
    ----------
    .. [1] Notes 2b.5, "Warping to compensate lens distortion".

    Examples
    --------
    >>> from cvnotes.camera import Lens, intrinsics
    >>> camera = Camera(intrinsics(800, 800, 320, 240), lens=Lens(k=(-0.25,)))
    >>> undistortion_map(camera)([720, 240])  # x = 1/2: 320 + 400 (1 − 1/16)
    array([695., 240.])
    """
    new_A = camera.A if new_A is None else intrinsic_matrix(new_A, "new_A")
    # What moves nothing must not move it by rounding either.
    if R is None and camera.lens.is_ideal and (new_A == camera.A).all():
        return PixelMap(lambda m_h: m_h[:2])
    to_real = np.eye(3) if R is None else _one_rotation(R).T
    ray, A = to_real @ np.linalg.inv(new_A), camera.A

    def columns(m_h: Array) -> Array:
        xy = ray[:2] @ m_h
        if R is not None:
            z = ray[2] @ m_h
            z[z <= 0] = np.nan  # behind the real camera
            xy /= z
        seen = camera.lens.distort.inside(camera.lens, xy.T)
        return A[:2, :2] @ seen.T + A[:2, 2:]

    return PixelMap(columns)


def undistort_image(
    image: npt.ArrayLike,
    camera: Camera,
    new_A: npt.ArrayLike | None = None,
    *,
    size: tuple[int, int] | None = None,
    method: Method = "bilinear",
    border: Border = "constant",
    fill: npt.ArrayLike = 0,
) -> Image:
    """Take the lens out of a picture, by a backward warp.

    Parameters
    ----------
    image : ndarray, shape (height, width) or (height, width, channels)
        A picture of ``camera.size``.
    camera : Camera
        The camera that took it.
    new_A : array_like, shape (3, 3), optional
        Intrinsic matrix of the ideal camera; by default the camera's own.
    size : (width, height), optional
        Size of the new picture; by default that of the old one.
    method, border, fill
        As in `interpolate`.

    Returns
    -------
    ndarray, of the image's dtype
        What ``Camera(new_A, size=size)`` would have taken.

    Warns
    -----
    CalibrationWarning
        The lens model folds inside of the picture, or this spans 180°, which no ideal camera does:
        what lies beyond is not shown.

    Notes
    -----
    What the ideal camera does not show is lost, and what is stretched near the border gets no
    sharper; `new_A` and `size` choose what is shown.

    Where pixels come from is computed at some hundred of them, and by polynomials in between,
    which agree to a millionth of a pixel. Pictures of 8 bits are looked up by OpenCV 5, where it is
    installed: it takes positions in single precision, one or two thousandths of a pixel off.

    References
    ----------
    .. [1] Notes 2b.5, "Warping to compensate lens distortion".

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> camera = Camera(intrinsics(80, 80, 31.5, 23.5), size=(64, 48))
    >>> image = np.arange(64 * 48, dtype=np.uint16).reshape(48, 64)
    >>> bool((undistort_image(image, camera) == image).all())
    True
    """
    image = np.ascontiguousarray(checked_image(image))
    if image.shape[1::-1] != camera.size:
        raise ShapeError(
            f"the picture is {image.shape[1]} × {image.shape[0]} but the camera's pictures are "
            f"{camera.size[0]} × {camera.size[1]} (scaled, cropped, or turned on its side?)"
        )
    if not camera.is_invertible:
        why = (
            "the lens model folds inside of the picture: it was fitted to points nearer to the "
            "middle, and what lies beyond the fold is not shown"
            if camera.lens.max_angle < np.pi / 2
            else "this picture reaches 90° from the axis, and a perspective picture cannot hold "
            "180°: what lies so far from the axis is not shown"
        )
        warnings.warn(why, CalibrationWarning, stacklevel=2)
    mapping = undistortion_map(camera, new_A)
    size = camera.size if size is None else target_size(size)
    sampler = Sampler(image, method, border, fill)
    factors = None if camera.lens.is_ideal else factored(mapping, size)
    if factors is None:
        return backward_warp(image, mapping, size=size, method=method, border=border, fill=fill)
    by_opencv = (
        image.dtype == np.uint8
        and (method, border) == ("bilinear", "constant")
        and sampler.fill.size in (1, 3, 4)
        and max(size + camera.size) < 2**15
        and _opencv_is_exact()
    )
    rows, columns = factors if not by_opencv else [each.astype(np.float32) for each in factors]
    target = np.empty((size[1], size[0], *sampler.channels), sampler.dtype)
    some = max(1, _ONE_THREAD // columns[0].size)
    positions = np.empty((2, some, size[0]), columns.dtype)  # once, as fresh memory takes longer
    for part in chunks(size[1], some):
        m: Any = positions[:, : part.stop - part.start]
        np.matmul(rows[part], columns, out=m)
        if by_opencv:
            from cv2 import BORDER_CONSTANT, INTER_LINEAR, remap

            outside = sampler.fill.tolist()
            remap(image, m[0], m[1], INTER_LINEAR, target[part], BORDER_CONSTANT, outside)
        else:
            sampler.look_up(m.reshape(2, -1), target[part].reshape(-1, sampler.fill.size))
    return target


# Products from which on OpenBLAS calls on threads, which cost more here than they do.
_ONE_THREAD = 250_000


@cache
def _opencv_is_exact() -> bool:
    """Return whether OpenCV looks up where it is asked to; before 5 it rounds to 1/32 pixel."""
    try:
        from cv2 import INTER_LINEAR, remap
    except ImportError:  # a browser has only a place where it would be
        return False
    u = np.linspace(0, 1, 129, dtype=np.float32)[None]
    ramp = np.tile(np.array([0, 128], np.uint8), (2, 1))
    return bool((remap(ramp, u, 0 * u, INTER_LINEAR) == np.floor(128 * u + 0.5)).all())


def _one_rotation(R: npt.ArrayLike) -> Array:
    R = rotation(R)
    if R.ndim != 2:
        raise ShapeError(f"R: expected one rotation (3, 3), got {R.shape}")
    return R
