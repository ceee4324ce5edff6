"""The grey levels of a picture, as they are and in eight bits."""

from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, Image, ShapeError, checked_image, luma, stretched

Grey8 = npt.NDArray[np.uint8]

_BRIGHTEST = 1e9  # fourth powers of grey levels fit into single precision


def grey_picture(x: Any, name: str = "image") -> Image:
    """Return a picture's grey levels (height, width); an alpha channel is dropped.

    Grey pictures come back as they are, uncopied. Colours are taken as red, green, blue.

    Examples
    --------
    >>> grey_picture(np.full((4, 6, 3), 100, np.uint8))[0, 0]
    np.uint8(100)
    """
    image = checked_image(x, name)
    if image.ndim == 3 and image.shape[2] == 2:
        raise ShapeError(f"{name}: expected grey, RGB or RGBA, got {image.shape}; pass grey alone")
    if image.ndim == 3:
        image = image[..., 0] if image.shape[2] == 1 else luma(image)
    if image.dtype.kind == "f" and not np.isfinite(image).all():
        raise CvnotesError(f"{name} contains NaN or infinite grey levels; give them a number")
    if image.dtype.kind == "f" and np.abs(image).max() > _BRIGHTEST:
        raise CvnotesError(f"{name}: no picture has grey levels beyond {_BRIGHTEST:g}")
    return image


def eight_bits(picture: Image) -> Grey8:
    """Return what OpenCV reads: 8-bit pictures as they are, whatever type holds them.

    Examples
    --------
    >>> eight_bits(np.array([[0.0, 9.0]])), eight_bits(np.array([[0.0, 0.5]]))
    (array([[0, 9]], dtype=uint8), array([[  0, 255]], dtype=uint8))
    """
    if picture.dtype == np.uint8:
        return picture.astype(np.uint8, copy=False)
    if picture.min() >= 0 and picture.max() <= 255:
        whole = picture.astype(np.uint8)
        if np.array_equal(whole, picture):
            return whole
    return stretched(picture)
