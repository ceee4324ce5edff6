"""Corners to a fraction of a pixel: by the gradients around them, and by a model of the pixels.

The textbooks' corner (`refine_subpixel`) is where all gradients are perpendicular to the way there.
It is good to a few hundredths of a pixel.

To a hundredth leads a model of the pixels themselves (`refine_edges`). What a camera shows where
two edges cross is

    I(x, y) = (1 + sx x + sy y) (level + contrast · erf(t1) · erf(t2)),   t_i = a_i x + b_i y + c_i

x and y count pixels from the middle of a window. Edge i is the line t_i = 0; its step is seen
through a Gaussian blur of 1 / (√2 ‖(a_i, b_i)‖) pixels, which may differ from edge to edge. The
pixel's own width belongs to it: a variance of 1/12 px² adds to that of the lens. (sx, sy) is a
slight slope of the lighting. The model is fitted to many windows at once; the finder ends with it.
"""

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    DegenerateError,
    Image,
    Points,
    ShapeError,
    chunks,
    guarded,
    image_size,
    points,
    whole,
)
from cvnotes.targets.grey import grey_picture

Mask = npt.NDArray[np.bool_]
Single = npt.NDArray[np.float32]

_ITERATIONS = 30  # of steps that gradients lead
_CLOSE = 1e-4  # px

# Parameters, in this order: a1, b1, c1, a2, b2, c2, contrast, level, sx, sy.
PARAMETERS = 10
SLOPES = 8  # where the slopes of the lighting begin
_TOGETHER = 6000  # pixels differentiated at a time: their numbers then stay in the cache
_SHARPEST = 1 / (np.sqrt(2) * 0.25)  # of a pixel's own width remain 0.29 px
# How far a window reaches towards the neighbouring corner, and beyond the outermost corners, as
# fractions of a square; what comes after those (narrow squares, paper, stray light) is unknown.
_TOWARDS_NEIGHBOUR, _BEYOND_BOARD = 0.7, 0.1
_BEYOND_PX, _BEYOND_BLUR = 2.0, 1.5  # but at least so many pixels, and widths of the blur
_VERY_BLURRED = 0.2  # of half a window
# Sum of squares, in grey levels, that single precision leaves in a window.
_ROUNDING = 3.0
_window = partial(whole, at_most=250)  # half a side: its pixels grow with the square
_SIGNIFICANT = 5.0  # deviations of its own that a contrast must be
_MEDIAN = 0.6745  # of absolute Gaussian noise, over its deviation
_SINGULAR = 1e-30  # determinant of the parameters' correlations; on a board it is above 1e-6


# --- by gradients


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
    led = led_by_gradients(grey, start.reshape(-1, 2), _window(window, "window"), _CLOSE)
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
        moved = _gradient_step(grey, at, middle, half)
        arrived = np.abs(moved - at).max(-1) < close
        out[where[arrived]] = moved[arrived]
        stays = np.abs(moved - start[where]).max(-1) <= half
        goes_on = stays & ~arrived
        where, at, middle = where[goes_on], moved[goes_on], middle[goes_on]
        if not where.size:
            break
    return out


def _gradient_step(grey: Image, m: Array, middle: Array, half: int) -> Array:
    """Cross the edges around m (n, 2) by least squares; NaN if they do not cross."""
    u, v, g_u, g_v = patch_gradients(grey, middle, half)
    du, dv = u - m[:, :1], v - m[:, 1:]
    w = np.exp(-(du * du + dv * dv) * (2 / half**2))
    uu, uv, vv = w * g_u * g_u, w * g_u * g_v, w * g_v * g_v
    S_uu, S_uv, S_vv = uu.sum(-1), uv.sum(-1), vv.sum(-1)
    b_u, b_v = (uu * du + uv * dv).sum(-1), (uv * du + vv * dv).sum(-1)
    det = S_uu * S_vv - S_uv * S_uv
    det = np.where(det > 1e-6 * (S_uu + S_vv) ** 2, det, np.nan)
    return m + np.stack([S_vv * b_u - S_uv * b_v, S_uu * b_v - S_uv * b_u], -1) / det[:, None]


# --- by a model of two blurred edges


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


@dataclass(frozen=True)
class Window:
    """The pixels to be explained: as many for every corner, but not all of them count.

    Attributes
    ----------
    place : ndarray, shape (3, pixels)
        x, y and 1 of the pixels, seen from the middle one.
    grey, weight : ndarray, shape (n, pixels)
        Grey levels, and 1 where a pixel counts, 0 elsewhere. Single precision: twice as quick, and
        still 16 bits finer than the grey levels.
    """

    place: Single
    grey: Single
    weight: Single

    def rows(self, k: slice | npt.NDArray[np.intp]) -> "Window":
        """Return the same for some of the corners."""
        return Window(self.place, self.grey[k], self.weight[k])


def refine_edges(
    image: npt.ArrayLike, m: npt.ArrayLike, *, window: int = 8, grid: tuple[int, int] | None = None
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


@guarded(image=grey_picture, m=Points(2), window=_window)
def fit_edges(
    image: Image,
    m: Array,
    *,
    window: int = 8,
    grid: tuple[int, int] | None = None,
    clear: float | None = None,
    only: npt.NDArray[np.integer[Any]] | None = None,
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
    only : ndarray of int, optional
        Numbers of the corners that are fitted, if not all; of the others of a `grid` it matters
        only where they are.

    Returns
    -------
    EdgeFit
        Of the corners that are fitted. Its ``m`` is NaN for those that did not converge, left the
        middle of their window, or have no two edges there.

    Notes
    -----
    The model is written at the top of `cvnotes.targets.subpixel`. Its ten parameters are fitted
    by least squares on the grey levels, first in a window of half the size. With white noise that
    is the maximum likelihood estimate: no unbiased method that sees the same pixels spreads less.
    The quadrants of a crossing are point-symmetric, so that an unknown response curve, clipping or
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
    if m.ndim != 2:
        raise ShapeError(f"m: expected corners (n, 2), got {m.shape}")
    near, every, which = (window + 1) // 2, m.copy(), slice(None) if only is None else only
    m = m[which]
    axes, reach = (
        board_axes(every, grid, which=which) if grid else (gradient_axes(image, m, near), None)
    )
    middle, small = cut_out(image, m, near, axes, reach, _strip(axes, clear, 0.0))
    start = sharp_crossing(m - middle, axes, small)
    # So few pixels do not tell the lighting's slope from the rest: it stays 0 for now.
    p, _, _ = minimise(start, small, tolerance=0.03, free=SLOPES)
    lost = ~(np.abs(middle + crossing(p) - m).max(-1) <= near)
    p[lost] = start[lost]
    # The large window goes where the small one led, so that the start does not matter.
    found, blur = middle + crossing(p), _typical(_blur(p))
    if grid:
        every[which] = found
        axes, reach = board_axes(every, grid, blur, which)
    again, large = cut_out(image, found, window, axes, reach, _strip(axes, clear, blur))
    # A slope of the lighting looks like an edge as blurred as this: then there shall be none.
    free = SLOPES if blur > _VERY_BLURRED * window else PARAMETERS
    p, system, good = minimise(_shifted(p, again - middle), large, tolerance=0.01, free=free)
    good &= ~lost & (np.abs(again + crossing(p) - m).max(-1) <= near)
    return _result(again, _facing(p, axes), system[:, [*range(free), -1]], large, good)


def _strip(axes: Array, clear: float | None, blur: float) -> Array | None:
    """Return half the width (n, 2) of the strips along the edges that show nothing but them."""
    if clear is None:
        return None
    height = (
        np.abs(_cross(axes[:, 0], axes[:, 1]))[:, None] / np.linalg.norm(axes, axis=-1)[:, ::-1]
    )
    return np.asarray(clear - np.maximum(1.0, _BEYOND_BLUR * blur) / height)


def _shifted(p: Array, by: Array) -> Array:
    """Return the same edges seen from the middle of another window."""
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
    told = np.maximum(window.weight.sum(-1) - free, 1)
    variance = system[:, free, free] / told
    beside_noise = np.sqrt(np.maximum(variance - _noise(window) ** 2, 0))
    residual, blur, half = np.sqrt(variance), _blur(p), window.place[0].max()
    least = np.maximum(2 * beside_noise, _SIGNIFICANT * residual / np.sqrt(told))
    good = good & (np.abs(p[:, 6]) > least) & (blur.max(-1) < half)
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


def _noise(window: Window) -> float:
    """Return the deviation of white noise, by second differences both ways: edges hardly have any.

    After J. Immerkær, Computer Vision and Image Understanding 64 (1996) 300-302; the median, as
    corners have some.
    """
    side = round(np.sqrt(window.place.shape[1]))
    twice = np.diff(np.diff(window.grey.reshape(-1, side, side), 2, axis=1), 2, axis=2)
    return float(np.median(np.abs(twice))) / (6 * _MEDIAN) if twice.size else 0.0


def _determined(normal: Array) -> Mask:
    """Return which normal matrices (n, free, free) are regular: the pixels tell all parameters."""
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


# --- where to look, and where to start


def board_axes(
    m: Array,
    grid: tuple[int, int],
    blur: float = 0.0,
    which: slice | npt.NDArray[np.integer[Any]] = slice(None),
) -> tuple[Array, Array]:
    """Return each corner's two steps to the next ones (n, 2, 2), and its reach (n, 2, 2) in them.

    Of the reach, the last index is that of backward and forward. Only those are given, and looked
    at, that are asked for.
    """
    columns, rows = image_size(grid, "grid")
    if len(m) != columns * rows or min(columns, rows) < 2:
        raise ShapeError(f"grid: {columns}×{rows} corners cannot be {len(m)} points")
    lattice = m.reshape(rows, columns, 2)
    steps = np.stack([np.gradient(lattice, axis=1), np.gradient(lattice, axis=0)], axis=-2)
    axes = steps.reshape(-1, 2, 2)[which]
    area, sides = np.abs(_cross(axes[..., 0, :], axes[..., 1, :])), np.linalg.norm(axes, axis=-1)
    if not (area > 0.01 * sides.prod(-1)).all():
        raise DegenerateError(
            f"m: neighbours on the {columns}×{rows} grid lie on a line; are the corners row by row?"
        )
    height = area[..., None] / sides[..., ::-1]
    outside = max(_BEYOND_PX, _BEYOND_BLUR * blur) / height
    beyond = outside.clip(_BEYOND_BOARD, _TOWARDS_NEIGHBOUR)
    row, column = (i.ravel()[which] for i in np.indices((rows, columns)))
    ends = np.stack([[column == 0, column == columns - 1], [row == 0, row == rows - 1]])
    reach = np.where(ends.transpose(2, 0, 1), beyond[..., None], _TOWARDS_NEIGHBOUR)
    return axes, reach


def gradient_axes(grey: Image, m: Array, half: int) -> Array:
    """Return the directions of the two edges (n, 2, 2) that the gradients around m show.

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
    grey: Image, m: Array, half: int, axes: Array, reach: Array | None, strip: Array | None = None
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
    """Return parameters to start from: the crossing of both axes, with a blur of 0.7 px."""
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
    """Return unit normals (n, 2, 2) of both edges that point into the quadrant between the axes."""
    across = np.stack([-axes[..., 1], axes[..., 0]], axis=-1) * [[1.0], [-1.0]]
    turned = np.where(_cross(axes[:, 0], axes[:, 1]) < 0, -1.0, 1.0)[:, None, None]
    return np.asarray(turned * across / np.linalg.norm(across, axis=-1, keepdims=True))


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


# --- the model and its least squares


def jacobian(p: Array, window: Window) -> Single:
    """Differentiate the model by its parameters p (n, 10).

    Returns
    -------
    ndarray, shape (n, 11, pixels)
        The derivatives, and in the last row the pixels minus the model; all times the weight.
    """
    q = p.astype(np.float32)
    contrast, level = q[:, 6:7], q[:, 7:8]
    t1, t2 = q[:, 0:3] @ window.place, q[:, 3:6] @ window.place
    (S1, E1), (S2, E2) = _erf(t1), _erf(t2)
    light = (1 + q[:, 8:10] @ window.place[:2]) * window.weight
    M = light * S1 * S2
    slope = np.float32(2 / np.sqrt(np.pi)) * contrast * light  # d(erf t)/dt = 2/√π exp(−t²)
    A1, A2 = slope * S2 * E1, slope * S1 * E2
    shade = window.weight * (level + contrast * S1 * S2)
    J = np.empty((len(p), PARAMETERS + 1, window.place.shape[1]), dtype=np.float32)
    np.multiply(A1[:, None], window.place, out=J[:, 0:3])
    np.multiply(A2[:, None], window.place, out=J[:, 3:6])
    J[:, 6], J[:, 7] = M, light
    np.multiply(shade[:, None], window.place[:2], out=J[:, 8:10])
    J[:, 10] = window.weight * window.grey - (level * light + contrast * M)
    return J


def crossing(p: Array) -> Array:
    """Return where the two edges cross, (n, 2), from the middle of the window.

    Examples
    --------
    >>> crossing(np.array([[1.0, 0, -2, 0, 1, -3, 1, 0, 0, 0]]))
    array([[2., 3.]])
    """
    a1, b1, c1, a2, b2, c2 = p.T[:6]
    m = np.empty((len(p), 2))
    with np.errstate(divide="ignore", invalid="ignore"):  # parallel edges cross nowhere
        area = a1 * b2 - a2 * b1
        m[:, 0] = (b1 * c2 - b2 * c1) / area
        m[:, 1] = (a2 * c1 - a1 * c2) / area
    return m


def crossing_jacobian(p: Array) -> Array:
    """Differentiate `crossing` by the parameters, (n, 2, 10).

    N m + c = 0 with the rows of N the (a_i, b_i), so that N dm = −(x da_i + y db_i + dc_i).
    """
    m_h = np.concatenate([crossing(p), np.ones((len(p), 1))], axis=-1)
    inverse = np.linalg.inv(p[:, [[0, 1], [3, 4]]])
    D = np.zeros((len(p), 2, PARAMETERS))
    D[:, :, 0:3] = -inverse[:, :, :1] * m_h[:, None]
    D[:, :, 3:6] = -inverse[:, :, 1:] * m_h[:, None]
    return D


def minimise(
    p: Array, window: Window, *, tolerance: float, free: int = PARAMETERS, iterations: int = 15
) -> tuple[Array, Array, Mask]:
    """Fit the model to every window, each by a Levenberg–Marquardt of its own, all at once.

    Only the first `free` parameters change.

    Returns
    -------
    p : ndarray, shape (n, 10)
        The parameters found.
    system : ndarray, shape (n, 11, 11)
        [J r]ᵀ [J r] before the last step: the normal matrix, the gradient, the sum of squares.
    converged : ndarray of bool, shape (n,)
        Whether the crossing came to rest: to about `tolerance` pixels.
    """
    p, moved, damping = p.copy(), np.full(len(p), np.inf), np.zeros(len(p))
    system = _system(p, window)
    k, part = np.arange(len(p)), window
    for _ in range(iterations):
        step = _solve(system[k], damping[k], free)
        gain, cost = (system[k, :PARAMETERS, -1] * step).sum(-1), system[k, -1, -1]
        p_new = _limited(p[k] + step)
        moved[k] = np.abs(crossing(p_new) - crossing(p[k])).max(-1)
        # A step this small needs no proof that it leads downhill, unless it promises much: at a
        # symmetric start the crossing rests while everything else may go astray. Nor may an edge
        # turn over unproved: as sharp as it may be, it does so with its crossing at rest.
        close = (moved[k] < tolerance) & (gain < 0.1 * cost + _ROUNDING) & ~_overturned(p[k], p_new)
        p[k[close]] = p_new[close]
        if close.any():
            k, p_new = k[~close], p_new[~close]
            part = window.rows(k)
        if not k.size:
            break
        system_new = _system(p_new, part)
        better = system_new[:, -1, -1] < system[k, -1, -1]
        p[k[better]], system[k[better]] = p_new[better], system_new[better]
        damping[k] = np.where(better, 0.1 * damping[k], np.maximum(10 * damping[k], 1e-2))
        damping[damping < 1e-4] = 0.0
    # Edges that would be sharper than they may be keep swaying by a little.
    return p, system, moved < 10 * tolerance


def _system(p: Array, window: Window) -> Array:
    system = np.empty((len(p), PARAMETERS + 1, PARAMETERS + 1))
    for part in chunks(len(p), max(1, _TOGETHER // window.place.shape[1])):
        J = jacobian(p[part], window.rows(part))
        system[part] = J @ J.mT
    return system


def _erf(t: Single) -> tuple[Single, Single]:
    """Return erf t and exp(−t²) at once, to single precision, in a third of the usual time.

    Formula 7.1.26 of Abramowitz and Stegun, Handbook of Mathematical Functions (1964).
    """
    bell = np.exp(-t * t)
    k = 1 / (1 + np.float32(0.3275911) * np.abs(t))
    tail = np.float32(1.061405429) * k
    for coefficient in (-1.453152027, 1.421413741, -0.284496736, 0.254829592):
        tail += np.float32(coefficient)
        tail *= k
    return np.copysign(1 - tail * bell, t), bell


def _overturned(p: Array, p_new: Array) -> Mask:
    """Mark for which windows (n,) an edge's normal turns by more than 90°."""
    along = p[:, [0, 1, 3, 4]] * p_new[:, [0, 1, 3, 4]]
    return np.asarray(along.reshape(-1, 2, 2).sum(-1).min(-1) <= 0)


def _limited(p: Array) -> Array:
    """Keep edges from becoming sharper than pixels are wide."""
    for line in (slice(0, 3), slice(3, 6)):
        sharpness = np.hypot(p[:, line.start], p[:, line.start + 1])
        p[:, line] /= np.maximum(sharpness / _SHARPEST, 1)[:, None]
    return p


def _solve(system: Array, damping: Array, free: int) -> Array:
    """Solve the damped normal equations of each window for its first `free` parameters."""
    normal = system[:, :free, :free]
    scale = np.sqrt(np.diagonal(normal, axis1=1, axis2=2))
    scale[scale == 0] = 1.0
    scaled = normal / (scale[:, :, None] * scale[:, None, :])
    scaled += (damping[:, None, None] + 1e-6) * np.eye(free)
    gradient = system[:, :free, PARAMETERS] / scale
    step = np.zeros((len(system), PARAMETERS))
    step[:, :free] = np.linalg.solve(scaled, gradient[..., None])[..., 0] / scale
    return step


# --- pixels around points


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
