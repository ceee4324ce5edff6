"""The grey levels of a picture: as they are, in eight bits, and in reduced copies."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, Image, ShapeError, checked_image, luma, stretched

Grey8 = npt.NDArray[np.uint8]

# Pixels of the smallest copy of a picture in which a board is looked for, and of the largest. In
# the smallest, its squares are 10 px wide if it fills a quarter of the picture.
_SMALLEST, _LARGEST = 80_000, 12_000_000
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


def reduced(grey: Grey8, k: int) -> Grey8:
    """Reduce a picture to 1/k of its width and height, each pixel the mean of k×k.

    What is left over on the right and below is cut off, so that pixel u of the copy lies at
    k (u + ½) − ½.

    Examples
    --------
    >>> reduced(np.array([[0, 100, 8], [0, 100, 8]], np.uint8), 2)
    array([[50]], dtype=uint8)
    """
    if k == 1:
        return grey
    height, width = grey.shape[0] // k, grey.shape[1] // k
    total = np.zeros((height, width), dtype=np.uint32)
    for i in range(k):
        for j in range(k):
            total += grey[i : height * k : k, j : width * k : k]
    return ((total + k * k // 2) // (k * k)).astype(np.uint8)


def copies(grey: Grey8, largest: int = _LARGEST) -> Iterator[tuple[int, Grey8]]:
    """Yield reduced copies of a picture, and by how much they are, the smallest first."""
    k = max(round(np.sqrt(grey.size / _SMALLEST)), 1)
    while k:
        if grey.size <= largest * k * k:
            yield k, reduced(grey, k)
        k //= 2
