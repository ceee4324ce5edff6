"""Where a picture has corners: the detector of Harris and Stephens (notes 2b.4)."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    MOST_BLUR,
    MOST_PIXELS,
    Array,
    CvnotesError,
    ShapeError,
    number,
    numbers,
    whole,
)
from cvnotes.targets.grey import grey_picture


def harris(image: npt.ArrayLike, *, sigma: float = 1.5, k: float = 0.04) -> Array:
    """Measure how much each pixel looks like a corner.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3 or 4)
        The picture.
    sigma : float
        Standard deviation in pixels of the Gaussian window.
    k : float
        Weight of the trace, 0.04 to 0.06.

    Returns
    -------
    ndarray, shape (height, width)
        det S − k (tr S)², with S = Σ w g gᵀ the structure tensor, the sum of g gᵀ of the
        gradients g within the window. Positive at corners (g points in all directions), negative
        on edges (in one direction only), about 0 where the picture is flat.

    References
    ----------
    .. [1] Notes 2b.4, "Corner detection".
    .. [2] C. Harris and M. Stephens, A combined corner and edge detector, Alvey Vision
       Conference (1988) 147-151.

    Examples
    --------
    >>> image = np.zeros((21, 21))
    >>> image[:10, :10] = image[10:, 10:] = 255
    >>> v, u = np.unravel_index(harris(image).argmax(), image.shape)
    >>> int(u), int(v)  # the four squares meet at (9.5, 9.5)
    (9, 9)
    """
    from scipy.ndimage import gaussian_filter

    grey = grey_picture(image).astype(np.float64)
    sigma = number(sigma, "sigma", at_most=MOST_BLUR)
    if sigma <= 0:
        raise CvnotesError(f"sigma must be positive, got {sigma:g}")
    g_v, g_u = (_differences(grey, axis) for axis in (0, 1))
    S_uu, S_uv, S_vv = (gaussian_filter(g, sigma) for g in (g_u * g_u, g_u * g_v, g_v * g_v))
    return np.asarray(S_uu * S_vv - S_uv**2 - number(k, "k") * (S_uu + S_vv) ** 2)


def local_maxima(
    response: npt.ArrayLike, *, radius: int = 5, threshold: float = 0.01, count: int | None = None
) -> Array:
    """Keep the pixels that no stronger pixel is near to (non-maximum suppression).

    Parameters
    ----------
    response : array_like, shape (height, width)
        What is to be largest, for example from `harris`.
    radius : int
        Two maxima are farther apart than this, in pixels along u or along v.
    threshold : float
        Fraction of the largest response below which nothing counts.
    count : int, optional
        Keep the strongest `count` only.

    Returns
    -------
    ndarray, shape (n, 2)
        Pixels (u, v), the strongest first.

    Examples
    --------
    >>> local_maxima([[0, 0, 0, 0], [0, 9, 8, 0], [0, 0, 0, 0]], radius=1)
    array([[1., 1.]])
    """
    response, size = numbers(response, "response"), 2 * whole(radius, "radius") + 1
    if response.ndim != 2:
        raise ShapeError(f"response: expected one value per pixel, got shape {response.shape}")
    threshold = number(threshold, "threshold")
    high = response > max(threshold * response.max(initial=0.0), 0.0)
    v, u = np.nonzero(high & (response == largest_around(response, size)))
    # Equal responses side by side are all maxima; of these, the first row counts.
    order = np.argsort(-response[v, u], kind="stable")
    rank = np.zeros(response.shape)
    rank[v[order], u[order]] = np.arange(len(order), 0, -1)
    strongest = rank[v[order], u[order]] == largest_around(rank, size)[v[order], u[order]]
    m: Array = np.stack([u[order], v[order]], axis=-1)[strongest].astype(np.float64)
    return m if count is None else m[: whole(count, "count", at_most=MOST_PIXELS)]


def largest_around(x: Array, size: int) -> Array:
    """Return the largest number in a square of size × size pixels around each.

    Examples
    --------
    >>> largest_around(np.array([[0.0, 3, 0, 0, 1]]), 3)
    array([[3., 3., 3., 1., 1.]])
    """
    if not x.size:
        return x
    try:
        from cv2 import dilate
    except ImportError:
        from scipy.ndimage import maximum_filter

        return np.asarray(maximum_filter(x, size), dtype=np.float64)
    largest = dilate(x, np.ones((size, size), np.uint8))
    return np.asarray(largest, dtype=np.float64).reshape(x.shape)


def _differences(grey: Array, axis: int) -> Array:
    """Central differences; a picture one pixel wide has none."""
    if grey.shape[axis] == 1:
        return np.zeros_like(grey)
    return np.asarray(np.gradient(grey, axis=axis))
