"""The guards of pictures, of grey values and of positions in a picture."""

from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base.errors import CvnotesError, InputTypeError, ShapeError
from cvnotes.base.guards import Array, numbers, real

Image = npt.NDArray[np.uint8 | np.uint16 | np.float32 | np.float64]


def checked_image(x: Any, name: str = "image") -> Image:
    """Guard a picture, (height, width) or (height, width, channels); it is not copied.

    Examples
    --------
    >>> checked_image(np.zeros((4, 6), np.uint8)).shape
    (4, 6)
    """
    if not isinstance(x, np.ndarray):
        x = numbers(x, name)
    if isinstance(x, np.ma.MaskedArray):
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
