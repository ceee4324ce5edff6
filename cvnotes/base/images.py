"""Pictures: their guards, their grey levels, and positions in them."""

from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base.errors import CvnotesError, InputTypeError, ShapeError
from cvnotes.base.guards import Array, is_masked, numbers, real
from cvnotes.base.numerics import chunks

Image = npt.NDArray[np.uint8 | np.uint16 | np.float32 | np.float64]

_ENOUGH_PIXELS = 1_000_000  # to tell a picture's darkest and brightest parts
_PIXELS_AT_A_TIME = 30_000
_RGB = np.array([0.299, 0.587, 0.114], np.float32)
_FLAT = 1e-100  # contrast between grey levels that is none


def checked_image(x: Any, name: str = "image") -> Image:
    """Guard a picture, (height, width) or (height, width, channels); it is not copied.

    Examples
    --------
    >>> checked_image(np.zeros((4, 6), np.uint8)).shape
    (4, 6)
    """
    if not isinstance(x, np.ndarray):
        x = numbers(x, name)
    if is_masked(x):
        raise InputTypeError(f"{name}: masked arrays are not read; put NaN where nothing is known")
    x = x.view(np.ndarray)
    if x.dtype.kind + str(x.dtype.itemsize) not in ("u1", "u2", "f4", "f8"):
        raise InputTypeError(
            f"{name}: expected uint8, uint16, float32 or float64, got {x.dtype}; "
            "convert it, minding its range"
        )
    if x.ndim not in (2, 3) or x.size == 0 or (x.ndim == 3 and x.shape[2] > 4):
        raise ShapeError(
            f"{name}: expected (height, width) or (height, width, channels) with at most four "
            f"channels, got {x.shape}"
        )
    return x


def checked_fill(fill: npt.ArrayLike, image: Image) -> Image:
    """Guard a grey value, or one per channel, that the image's dtype can hold.

    Examples
    --------
    >>> checked_fill(7, np.zeros((4, 6, 3), np.uint8))
    array([7, 7, 7], dtype=uint8)
    """
    channels = image.shape[2:] or (1,)
    try:
        with np.errstate(invalid="ignore", over="ignore"):
            given = np.broadcast_to(np.asarray(fill, dtype=np.float64), channels)
            value = given.astype(image.dtype)
    except (TypeError, ValueError):
        raise CvnotesError(f"fill: expected a number, or {channels[0]}, got {fill!r}") from None
    if image.dtype.kind == "u" and not (value == given).all():
        raise CvnotesError(f"fill: {fill!r} is not a value of {image.dtype}")
    return value


def positions(x: Any, name: str) -> Array:
    """Guard positions (..., 2) in pixels, among which NaN and infinity mean nowhere.

    Examples
    --------
    >>> positions([3, np.nan], "m")
    array([ 3., nan])
    """
    array = real(x, name)
    if array.ndim == 0 or array.shape[-1] != 2:
        raise ShapeError(f"{name}: expected positions (u, v) of shape (..., 2), got {array.shape}")
    with np.errstate(over="ignore"):  # of long doubles
        return array.astype(np.float64, copy=False)


def luma(image: Image) -> Image:
    """Weigh the colours of (height, width, 3 or 4) to grey (height, width); alpha is dropped.

    Notes
    -----
    Y = 0.299 R + 0.587 G + 0.114 B (ITU-R BT.601); of 8-bit colours, 8-bit grey.

    Examples
    --------
    >>> luma(np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255]]], np.uint8))
    array([[ 76, 150,  29]], dtype=uint8)
    """
    height, width = image.shape[:2]
    eight_bits = image.dtype == np.uint8
    kind = image.dtype if eight_bits else np.result_type(image.dtype, np.float32)
    grey = np.empty((height, width), kind)
    for rows in chunks(height, max(1, _PIXELS_AT_A_TIME // width)):
        Y = image[rows, :, :3] @ _RGB
        grey[rows] = np.rint(Y) if eight_bits else Y
    return grey


def stretched(grey: Image) -> npt.NDArray[np.uint8]:
    """Stretch grey levels from their darkest to their brightest thousandth over 0 to 255.

    Many pictures of 16 bits hold 10 or 12 only. Those of 8 bits come back as they are, uncopied.

    Examples
    --------
    >>> stretched(np.array([[100, 4195]], np.uint16))
    array([[  0, 255]], dtype=uint8)
    """
    if grey.dtype == np.uint8:
        return grey.astype(np.uint8, copy=False)
    step = int(np.ceil(np.sqrt(grey.size / _ENOUGH_PIXELS)))
    low, high = np.percentile(grey[::step, ::step], (0.1, 99.9))
    contrast = high - low if high - low > _FLAT else 1.0
    eight_bits = np.empty(grey.shape, np.uint8)
    for rows in chunks(len(grey), max(1, _PIXELS_AT_A_TIME // grey[0].size)):
        scaled = (grey[rows] - low) * (255 / contrast)
        eight_bits[rows] = scaled.round().clip(0, 255)
    return eight_bits
