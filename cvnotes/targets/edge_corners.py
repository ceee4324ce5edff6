"""Corners to a hundredth of a pixel, by the two edges that cross there; the finder ends with it."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, Image, ShapeError, image_size, points
from cvnotes.targets.edge_model import (
    PARAMETERS,
    SLOPES,
    Mask,
    Window,
    crossing,
    crossing_jacobian,
    minimise,
)
from cvnotes.targets.gradient_corners import whole
from cvnotes.targets.patches import grey_picture, patch_gradients, patches

# How far a window reaches towards the neighbouring corner, and beyond the outermost corners, as
# fractions of a square; what comes after those (narrow squares, paper, stray light) is unknown.
_TOWARDS_NEIGHBOUR, _BEYOND_BOARD = 0.7, 0.1
_BEYOND_PX, _BEYOND_BLUR = 2.0, 1.5  # but at least so many pixels, and widths of the blur


def board_axes(m: Array, grid: tuple[int, int], blur: float = 0.0) -> tuple[Array, Array]:
    """Give each corner's two steps to the next ones (n, 2, 2), and its reach (n, 2, 2) in them.

    Of the reach, the last index is that of backward and forward.
    """
    columns, rows = image_size(grid, "grid")
    if len(m) != columns * rows or min(columns, rows) < 2:
        raise ShapeError(f"grid: {columns}×{rows} corners cannot be {len(m)} points")
    lattice = m.reshape(rows, columns, 2)
    axes = np.stack([np.gradient(lattice, axis=1), np.gradient(lattice, axis=0)], axis=-2)
    area, sides = np.abs(_cross(axes[..., 0, :], axes[..., 1, :])), np.linalg.norm(axes, axis=-1)
    if not (area > 0.01 * sides.prod(-1)).all():
        raise DegenerateError(
            f"m: neighbours on the {columns}×{rows} grid lie on a line; are the corners row by row?"
        )
    height = area[..., None] / sides[..., ::-1]
    outside = max(_BEYOND_PX, _BEYOND_BLUR * blur) / height
    beyond = outside.clip(_BEYOND_BOARD, _TOWARDS_NEIGHBOUR)
    reach = np.full((rows, columns, 2, 2), _TOWARDS_NEIGHBOUR)
    reach[:, 0, 0, 0], reach[:, -1, 0, 1] = beyond[:, 0, 0], beyond[:, -1, 0]
    reach[0, :, 1, 0], reach[-1, :, 1, 1] = beyond[0, :, 1], beyond[-1, :, 1]
    return axes.reshape(-1, 2, 2), reach.reshape(-1, 2, 2)


def gradient_axes(grey: Image, m: Array, half: int) -> Array:
    """Give the directions of the two edges (n, 2, 2) that the gradients around m show.

    Gradients point across one edge or the other, so that (t1ᵀ g)(t2ᵀ g) = gᵀ Q g is 0 for all of
    them. The three coefficients of Q are the null vector of the sum of fourth powers of g.
    """
    _, _, g_u, g_v = patch_gradients(grey, m, half)
    powers = np.stack([g_u * g_u, g_u * g_v, g_v * g_v], axis=1)
    a, b, c = np.linalg.eigh(powers @ powers.mT)[1][:, :, 0].T
    values, vectors = np.linalg.eigh(np.stack([2 * a, b, b, 2 * c], -1).reshape(-1, 2, 2))
    # λ2 (e2ᵀ g)² − |λ1| (e1ᵀ g)² is the product of a sum and a difference.
    e1, e2 = (np.sqrt(np.abs(values))[:, None] * vectors).transpose(2, 0, 1)
    axes = np.stack([e2 + e1, e2 - e1], axis=1)
    axes /= np.maximum(np.linalg.norm(axes, axis=-1, keepdims=True), 1e-300)
    axes[np.abs(_cross(axes[:, 0], axes[:, 1])) < 0.1] = np.eye(2)  # there are no two edges
    return np.asarray(axes)


def cut_out(
    grey: Image,
    m: Array,
    half: int,
    axes: Array,
    reach: Array | None,
    strip: Array | None = None,
) -> tuple[Array, Window]:
    """Cut windows out around the pixels next to m, which are given too.

    In steps to the neighbours, pixels count that lie within the `reach`, and no farther from one of
    the edges than half the width (n, 2) of its `strip`.
    """
    u, v, pixels, counts = patches(grey, m, half)
    if reach is not None:
        q = np.stack([u - m[:, :1], v - m[:, 1:]], axis=1)
        along = np.linalg.inv(axes).mT @ q  # in steps to the neighbours
        counts &= ((along >= -reach[..., :1]) & (along <= reach[..., 1:])).all(1)
        if strip is not None:
            counts &= (np.abs(along) <= strip[..., None]).any(1)
    y, x = np.indices((2 * half + 1, 2 * half + 1)).reshape(2, -1) - half
    single = [z.astype(np.float32) for z in (np.stack([x, y, np.ones_like(x)]), pixels, counts)]
    return np.rint(m), Window(*single)


def sharp_crossing(offset: Array, axes: Array, window: Window) -> Array:
    """Give parameters to start from: the crossing of both axes, with a blur of 0.7 px."""
    p = np.zeros((len(offset), PARAMETERS))
    across = normals(axes)
    p[:, 0:2], p[:, 3:5] = across[:, 0], across[:, 1]
    p[:, [2, 5]] = -(across @ offset[:, :, None])[..., 0]
    quadrant = np.sign((p[:, 0:3] @ window.place) * (p[:, 3:6] @ window.place)) * window.weight
    count = np.maximum(window.weight.sum(-1), 1)
    p[:, 7] = (window.weight * window.grey).sum(-1) / count
    p[:, 6] = (quadrant * (window.grey - p[:, 7:8])).sum(-1) / count
    return p


def normals(axes: Array) -> Array:
    """Give unit normals (n, 2, 2) of both edges that point into the quadrant between the axes."""
    across = np.stack([-axes[..., 1], axes[..., 0]], axis=-1) * [[1.0], [-1.0]]
    turned = np.where(_cross(axes[:, 0], axes[:, 1]) < 0, -1.0, 1.0)[:, None, None]
    return np.asarray(turned * across / np.linalg.norm(across, axis=-1, keepdims=True))


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


_VERY_BLURRED = 0.2  # of half a window
_SINGULAR = 1e-30  # determinant of the parameters' correlations; on a board it is above 1e-6


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
    clear: float | None = None,
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
    clear : float, optional
        How far from the edges something else is printed, such as a marker, in squares; needs
        `grid`. Only pixels nearer to an edge than that, less the blur, then count.

    Returns
    -------
    EdgeFit
        Its ``m`` is NaN for corners that did not converge, left the middle of their window, or
        have no two edges there.

    Notes
    -----
    The model is that of `cvnotes.targets.edge_model`. Its ten parameters are fitted by least
    squares on the grey levels, first in a window of half the size. With white noise that is the
    maximum likelihood estimate: no unbiased method that sees the same pixels spreads less. The
    quadrants of a crossing are point-symmetric, so that an unknown response curve, clipping or
    an elongated blur do not move it.

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
    middle, small = cut_out(grey, m, near, axes, reach, _strip(axes, clear, 0.0))
    start = sharp_crossing(m - middle, axes, small)
    # So few pixels do not tell the lighting's slope from the rest: it stays 0 for now.
    p, _, _ = minimise(start, small, tolerance=0.03, free=SLOPES)
    lost = ~(np.abs(middle + crossing(p) - m).max(-1) <= near)
    p[lost] = start[lost]
    # The large window goes where the small one led, so that the start does not matter.
    found, blur = middle + crossing(p), _typical(_blur(p))
    if grid:
        axes, reach = board_axes(found, grid, blur)
    again, large = cut_out(grey, found, half, axes, reach, _strip(axes, clear, blur))
    # A slope of the lighting looks like an edge as blurred as this: then there shall be none.
    free = SLOPES if blur > _VERY_BLURRED * half else PARAMETERS
    p, system, good = minimise(_shifted(p, again - middle), large, tolerance=0.01, free=free)
    good &= ~lost & (np.abs(again + crossing(p) - m).max(-1) <= near)
    return _result(again, _facing(p, axes), system[:, [*range(free), -1]], large, good)


def _strip(axes: Array, clear: float | None, blur: float) -> Array | None:
    """Give half the width (n, 2) of the strips along the edges that show nothing but them."""
    if clear is None:
        return None
    height = (
        np.abs(_cross(axes[:, 0], axes[:, 1]))[:, None] / np.linalg.norm(axes, axis=-1)[:, ::-1]
    )
    return np.asarray(clear - np.maximum(1.0, _BEYOND_BLUR * blur) / height)


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
    good &= _determined(system[:, :free, :free])
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


def _determined(normal: Array) -> Mask:
    """Tell which normal matrices (n, free, free) are regular: the pixels tell all parameters."""
    scale = np.sqrt(np.diagonal(normal, axis1=1, axis2=2))
    scale = np.where(scale > 0, scale, np.inf)
    correlation = normal / (scale[:, :, None] * scale[:, None, :])
    return np.asarray(np.linalg.det(correlation) > _SINGULAR)


def _blur(p: Array) -> Array:
    """Blur across both edges (n, 2)."""
    sharpness = np.sqrt(2) * np.hypot(p[:, [0, 3]], p[:, [1, 4]])
    blur = np.full_like(sharpness, np.inf)
    return np.asarray(np.divide(1.0, sharpness, out=blur, where=sharpness > 0))


def _typical(blur: Array) -> float:
    """Blur of most corners, across the more blurred edge."""
    return float(np.median(blur.max(-1))) if len(blur) else 0.0
