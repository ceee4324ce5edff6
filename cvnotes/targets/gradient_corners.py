"""The textbooks' sub-pixel corner: where all gradients are perpendicular to the way there."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, Image, number, points
from cvnotes.targets.patches import grey_picture, patch_gradients

_ITERATIONS = 30
_CLOSE = 1e-4  # pixels


def refine_subpixel(image: npt.ArrayLike, m: npt.ArrayLike, *, window: int = 5) -> Array:
    """Move corners to where the gradients around them say that the edges cross.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3 or 4)
        The picture.
    m : array_like, shape (n, 2)
        Corners to about a pixel.
    window : int
        Half the side of the window, in pixels: it is (2 window + 1)² large. No other corner
        should lie in it.

    Returns
    -------
    ndarray, shape (n, 2)
        The refined corners; NaN in the rows of those that left their window or have no two
        edges in it.

    Notes
    -----
    A pixel p on an edge has its gradient g across the edge, so gᵀ (p − m) = 0 if the edge runs
    through the corner m; in flat parts g = 0. Least squares over the window,
    Σ w g gᵀ (p − m) = 0, gives m = (Σ w g gᵀ)⁻¹ Σ w g gᵀ p: the structure tensor of `harris`
    again. The weight w is a Gaussian around m, so that the step is repeated until m stays.

    A gradient taken over two pixels is not that of the point between them, which biases m by a
    few hundredths of a pixel; `refine_edges` models the pixels instead.

    References
    ----------
    .. [1] Notes 2b.4, "sub-pixel refinement".
    .. [2] W. Förstner and E. Gülch, A fast operator for detection and precise location of
       distinct points, corners and centres of circular features, ISPRS Intercommission
       Conference (1987) 281-305.

    Examples
    --------
    >>> image = np.zeros((21, 21))
    >>> image[:10, :10] = image[10:, 10:] = 255
    >>> refine_subpixel(image, [[11.0, 9.0]]).round(3)
    array([[9.5, 9.5]])
    """
    grey, start = grey_picture(image), points(m, "m", 2)
    led = led_by_gradients(grey, start.reshape(-1, 2), whole(window, "window"), _CLOSE)
    return led.reshape(start.shape)


def led_by_gradients(grey: Image, start: Array, half: int, close: float) -> Array:
    """Do what `refine_subpixel` does, until steps (n, 2) are shorter than `close` pixels."""
    out = np.full(start.shape, np.nan)
    where, at = np.arange(len(start)), start.copy()
    middle = np.rint(at)
    for _ in range(_ITERATIONS):
        # The window follows by whole pixels, but not to and fro between two of them.
        far = np.abs(at - middle).max(-1) > 0.75
        middle[far] = np.rint(at[far])
        moved = _crossing(grey, at, middle, half)
        arrived = np.abs(moved - at).max(-1) < close
        out[where[arrived]] = moved[arrived]
        stays = np.abs(moved - start[where]).max(-1) <= half
        goes_on = stays & ~arrived
        where, at, middle = where[goes_on], moved[goes_on], middle[goes_on]
        if not where.size:
            break
    return out


def whole(x: float, name: str) -> int:
    """Guard a positive whole number.

    Examples
    --------
    >>> whole(5, "window")
    5
    """
    value = number(x, name)
    if value < 1 or value != int(value):
        raise CvnotesError(f"{name}: expected a positive whole number, got {x!r}")
    return int(value)


def _crossing(grey: Image, m: Array, middle: Array, half: int) -> Array:
    """One step: the least-squares crossing of the edges around m (n, 2), NaN if there is none."""
    u, v, g_u, g_v = patch_gradients(grey, middle, half)
    du, dv = u - m[:, :1], v - m[:, 1:]
    w = np.exp(-(du * du + dv * dv) * (2 / half**2))
    uu, uv, vv = w * g_u * g_u, w * g_u * g_v, w * g_v * g_v
    S_uu, S_uv, S_vv = uu.sum(-1), uv.sum(-1), vv.sum(-1)
    b_u, b_v = (uu * du + uv * dv).sum(-1), (uv * du + vv * dv).sum(-1)
    det = S_uu * S_vv - S_uv * S_uv
    det = np.where(det > 1e-6 * (S_uu + S_vv) ** 2, det, np.nan)
    return m + np.stack([S_vv * b_u - S_uv * b_v, S_uu * b_v - S_uv * b_u], -1) / det[:, None]
