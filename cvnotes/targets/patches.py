"""Grey pictures, and the square patches of pixels around points in them."""

from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, Image, ShapeError, checked_image, luma

Mask = npt.NDArray[np.bool_]

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


def patches(image: Image, m: Array, half: int) -> tuple[Array, Array, Array, Mask]:
    """Take the (2 half + 1)² pixels around each point of m (n, 2), each as a row.

    Returns
    -------
    u, v, grey : ndarray, shape (n, (2 half + 1)²)
        The pixels' places and grey levels.
    inside : ndarray of bool, same shape
        False for pixels beyond the picture, whose grey levels repeat its border.

    Examples
    --------
    >>> patches(np.arange(12.0).reshape(3, 4), np.array([[2.2, 0.9]]), 1)[2]
    array([[ 1.,  2.,  3.,  5.,  6.,  7.,  9., 10., 11.]])
    """
    n, k, (height, width) = len(m), 2 * half + 1, image.shape
    far = max(height, width) + half + 1.0  # how far outside does not matter
    centre = np.rint(np.clip(m, -far, far + max(height, width))).astype(np.intp)
    u, v = (centre + np.arange(-half, half + 1)[:, None, None]).T  # of each column and each row
    u, v = u[:, None], v[:, :, None]
    grey = image[v.clip(0, height - 1), u.clip(0, width - 1)]
    inside = ((v >= 0) & (v < height)) & ((u >= 0) & (u < width))
    every = [np.broadcast_to(x, (n, k, k)).reshape(n, k * k) for x in (u, v, grey)]
    u, v, grey = (x.astype(np.float64) for x in every)
    return u, v, grey, inside.reshape(n, k * k)


def patch_gradients(image: Image, m: Array, half: int) -> tuple[Array, Array, Array, Array]:
    """Return u, v and central differences g_u, g_v of the patches' pixels, (n, (2 half + 1)²).

    Where a difference would reach beyond the picture, it is 0.

    Examples
    --------
    >>> u, v, g_u, g_v = patch_gradients(np.arange(25.0).reshape(5, 5), np.array([[2.0, 2.0]]), 1)
    >>> g_u[0, 0], g_v[0, 0]
    (np.float64(1.0), np.float64(5.0))
    """
    square = (len(m), 2 * half + 3, 2 * half + 3)
    u, v, pixels, within = patches(image, m, half + 1)
    grey, inside = pixels.reshape(square), within.reshape(square)
    g_u = (grey[:, 1:-1, 2:] - grey[:, 1:-1, :-2]) / 2
    g_v = (grey[:, 2:, 1:-1] - grey[:, :-2, 1:-1]) / 2
    if not inside.all():
        g_u[~(inside[:, 1:-1, 2:] & inside[:, 1:-1, :-2])] = 0.0
        g_v[~(inside[:, 2:, 1:-1] & inside[:, :-2, 1:-1])] = 0.0
    flat = (len(m), (2 * half + 1) ** 2)
    u, v = (x.reshape(square)[:, 1:-1, 1:-1].reshape(flat) for x in (u, v))
    return u, v, g_u.reshape(flat), g_v.reshape(flat)
