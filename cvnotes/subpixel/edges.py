"""Corners where two blurred edges cross, fitted to the pixels themselves (notes 2b.4)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, ShapeError, points
from cvnotes.subpixel.gradient import whole
from cvnotes.subpixel.model import (
    PARAMETERS,
    SLOPES,
    Mask,
    Window,
    crossing,
    crossing_jacobian,
    minimise,
)
from cvnotes.subpixel.patches import grey_picture
from cvnotes.subpixel.windows import board_axes, cut_out, gradient_axes, normals, sharp_crossing

_VERY_BLURRED = 0.2  # of half a window


@dataclass(frozen=True, eq=False)
class EdgeFit:
    """The two-edge model of n corners.

    Attributes
    ----------
    m : ndarray, shape (n, 2)
        The corners, px; NaN where the fit found none.
    blur : ndarray, shape (n, 2)
        Standard deviation of the blur across each edge, the pixel's own width included, px.
    contrast, level : ndarray, shape (n,)
        Half the difference, and the mean, of light and dark, grey levels. The contrast is positive
        if the quadrant between both directions is light.
    residual : ndarray, shape (n,)
        Standard deviation of what the model leaves unexplained, grey levels.
    covariance : ndarray, shape (n, 2, 2)
        Cramér–Rao bound of m for noise of one grey level, px².
    """

    m: Array
    blur: Array
    contrast: Array
    level: Array
    residual: Array
    covariance: Array


def refine_edges(
    image: npt.ArrayLike,
    m: npt.ArrayLike,
    *,
    window: int = 8,
    grid: tuple[int, int] | None = None,
) -> Array:
    """Move corners to where two blurred edges cross that explain the pixels best.

    Parameters, and what they mean, are those of `fit_edges`; this gives its ``m`` alone.

    Examples
    --------
    >>> from scipy.special import erf
    >>> v, u = np.indices((41, 41))
    >>> image = 128 + 100 * erf(u - 20.25) * erf(v - 19.5)
    >>> refine_edges(image, [[20.0, 20.0]]).round(3)
    array([[20.25, 19.5 ]])
    """
    return fit_edges(image, m, window=window, grid=grid).m


def fit_edges(
    image: npt.ArrayLike,
    m: npt.ArrayLike,
    *,
    window: int = 8,
    grid: tuple[int, int] | None = None,
) -> EdgeFit:
    """Fit the model of two crossing blurred edges around each corner.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3 or 4)
        The picture.
    m : array_like, shape (n, 2)
        Corners to about a pixel.
    window : int
        Half the side of the window, px.
    grid : (columns, rows), optional
        Says that m are the inner corners of a board, row by row. The windows then end before the
        neighbouring corners and hardly reach beyond the outermost ones; without it, the window
        must be small enough for that.

    Returns
    -------
    EdgeFit
        Its ``m`` is NaN for corners that did not converge, left the middle of their window, or
        have no two edges there.

    Notes
    -----
    The model is that of `cvnotes.subpixel.model`. Its ten parameters are fitted by least squares
    on the grey levels, first in a window of half the size. With white noise that is the maximum
    likelihood estimate: no unbiased method that sees the same pixels spreads less. The quadrants
    of a crossing are point-symmetric, so that an unknown response curve, clipping or an
    elongated blur do not move it.

    References
    ----------
    .. [1] Notes 2b.4, "sub-pixel refinement".

    Examples
    --------
    >>> from scipy.special import erf
    >>> v, u = np.indices((41, 41))
    >>> fit = fit_edges(128 + 100 * erf(u - 20.25) * erf(v - 19.5), [[20.0, 20.0]])
    >>> fit.m.round(3), fit.level.round(1), fit.blur.round(2)  # 1 / √2
    (array([[20.25, 19.5 ]]), array([128.]), array([[0.71, 0.71]]))
    """
    grey, m, half = grey_picture(image), points(m, "m", 2), whole(window, "window")
    if m.ndim != 2:
        raise ShapeError(f"m: expected corners (n, 2), got {m.shape}")
    near = (half + 1) // 2
    axes, reach = board_axes(m, grid) if grid else (gradient_axes(grey, m, near), None)
    middle, small = cut_out(grey, m, near, axes, reach)
    start = sharp_crossing(m - middle, axes, small)
    # So few pixels do not tell the lighting's slope from the rest: it stays 0 for now.
    p, _, _ = minimise(start, small, tolerance=0.03, free=SLOPES)
    lost = ~(np.abs(middle + crossing(p) - m).max(-1) <= near)
    p[lost] = start[lost]
    # The large window goes where the small one led, so that the start does not matter.
    found, blur = middle + crossing(p), _typical(_blur(p))
    if grid:
        axes, reach = board_axes(found, grid, blur)
    again, large = cut_out(grey, found, half, axes, reach)
    # A slope of the lighting looks like an edge as blurred as this: then there shall be none.
    free = SLOPES if blur > _VERY_BLURRED * half else PARAMETERS
    p, system, good = minimise(_shifted(p, again - middle), large, tolerance=0.01, free=free)
    good &= ~lost & (np.abs(again + crossing(p) - m).max(-1) <= near)
    return _result(again, _facing(p, axes), system[:, [*range(free), -1]], large, good)


def _shifted(p: Array, by: Array) -> Array:
    """Give the same edges seen from the middle of another window."""
    p = p.copy()
    for a in (0, 3):
        p[:, a + 2] += (p[:, a : a + 2] * by).sum(-1)
    return p


def _facing(p: Array, axes: Array) -> Array:
    """Turn edges over, and the contrast with them, that face away from how they started."""
    p = p.copy()
    for a, normal in zip((0, 3), normals(axes).swapaxes(0, 1), strict=True):
        away = (p[:, a : a + 2] * normal).sum(-1) < 0
        p[away, a : a + 3] *= -1
        p[away, 6] *= -1
    return p


def _result(middle: Array, p: Array, system: Array, window: Window, good: Mask) -> EdgeFit:
    free = system.shape[1] - 1
    system = system[..., [*range(free), -1]]
    residual = np.sqrt(system[:, free, free] / np.maximum(window.weight.sum(-1) - free, 1))
    blur, half = _blur(p), window.place[0].max()
    good = good & (np.abs(p[:, 6]) > 2 * residual) & (blur.max(-1) < half)
    D = crossing_jacobian(p[good])[..., :free]
    covariance = np.full((len(p), 2, 2), np.nan)
    covariance[good] = D @ np.linalg.solve(system[good, :free, :free], D.mT)
    return EdgeFit(
        m=np.where(good[:, None], middle + crossing(p), np.nan),
        blur=blur,
        contrast=p[:, 6],
        level=p[:, 7],
        residual=residual,
        covariance=covariance,
    )


def _blur(p: Array) -> Array:
    """Blur across both edges (n, 2)."""
    sharpness = np.sqrt(2) * np.hypot(p[:, [0, 3]], p[:, [1, 4]])
    blur = np.full_like(sharpness, np.inf)
    return np.asarray(np.divide(1.0, sharpness, out=blur, where=sharpness > 0))


def _typical(blur: Array) -> float:
    """Blur of most corners, across the more blurred edge."""
    return float(np.median(blur.max(-1))) if len(blur) else 0.0
