"""The exact mean over every pixel of a picture that is given by its edges.

A picture of flat colours is known completely by the curves across which it jumps. By Green's
theorem its integral over a pixel is a sum over the pieces of these curves: a short piece that
crosses du columns adds its jump times du times the part of the pixel below it. Edges, corners
and squares smaller than a pixel are then all alike, and nothing is sampled.
"""

import math

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CvnotesError,
    DegenerateError,
    blur_width,
    chunks,
    points,
    target_size,
)

Indices = npt.NDArray[np.intp]

_REACH = 5.0  # standard deviations beyond which a Gaussian counts as zero (6e-7 of it is lost)
_FARTHEST = 1e6  # pixels; a piece of edge is cut up pixel by pixel
_DEPOSITS = 100_000  # made at a time when blurring, so that they stay in the cache


def edge_means(
    start: Array, end: Array, jump: Array, size: tuple[int, int], *, blur: float = 0.0
) -> Array:
    """Average a picture of flat colours, given by its edges, over the area of each pixel.

    Parameters
    ----------
    start, end : ndarray, shape (n, 2)
        Ends of straight pieces of edge, in pixels; together they must bound whole regions.
    jump : ndarray, shape (n, k)
        By how much each of k channels is larger on one side of a piece than on the other: on the
        side of larger u if it runs towards larger v, of smaller v if it runs towards larger u.
    size : (width, height)
        Size of the picture.
    blur : float
        Standard deviation in pixels of a Gaussian that blurs the picture before it is averaged.

    Returns
    -------
    ndarray, shape (k, height, width)
        Means over the squares [u − ½, u + ½] × [v − ½, v + ½] of a picture that is 0 outside
        of all edges.

    Notes
    -----
    Without blur a piece inside one pixel deposits −jump·du·(1 − y) there and −jump·du·y in the
    next one below, y being its mean distance from the pixel's upper side; a running sum down the
    rows does the rest. With blur the deposit is spread over the pixels that the blur reaches.

    Examples
    --------
    >>> corners = np.array([[0.5, 0.5], [0.5, 1.0], [2.0, 1.0], [2.0, 0.5]])
    >>> edge_means(corners, np.roll(corners, -1, axis=0), np.ones((4, 1)), (3, 2))[0]
    array([[0.  , 0.  , 0.  ],
           [0.  , 0.5 , 0.25]])
    """
    width, height = size
    # Two rows more: what lies below the picture ends up there.
    picture = np.zeros((jump.shape[1], height + 2, width))
    reach = 2 + int(_REACH * blur) if blur else 0
    # Pixel (u, v) now covers [u, u + 1] × [v, v + 1]. Pieces beyond the lower, left or right
    # border change nothing; those beyond the upper border fill their columns.
    ends = np.array([*start.T, *end.T]) + 0.5
    low, high = np.minimum(ends[:2], ends[2:]) - reach, np.maximum(ends[:2], ends[2:]) + reach
    near = (high[0] > 0) & (low[0] < width) & (low[1] < height)
    if near.any():
        ends, jump = _shortened(ends[:, near], jump[near], max(blur, 0.05) if blur else 1.0)
        if blur:
            _deposit_blurred(picture, ends, jump, blur, reach)
        else:
            _deposit(picture, ends, jump)
        # All that is not zero lies between these columns and rows; pieces below the picture may
        # be missing from `near` but not here, for they end what others began.
        left, top = (max(int(x[near].min()), 0) for x in low)
        right, bottom = (
            int(min(high[0, near].max() + 2, width)),
            int(min(high[1].max() + 2, height)),
        )
        for row in range(top + 1, bottom):
            picture[:, row, left:right] += picture[:, row - 1, left:right]
    return picture[:, :height]


def polygon_means(outline: npt.ArrayLike, size: tuple[int, int], *, blur: float = 0.0) -> Array:
    """Return the part of each pixel that a polygon covers, (height, width), between 0 and 1.

    Parameters
    ----------
    outline : array_like, shape (n, 2)
        Corners in pixels, in order around the polygon, either way round; it may leave the
        picture but must not cross itself.
    size : (width, height)
        Size of the picture.
    blur : float
        Standard deviation in pixels of a Gaussian that blurs it.

    Raises
    ------
    DegenerateError
        The polygon has fewer than three corners or no area.

    Examples
    --------
    >>> polygon_means([[-0.5, -0.5], [1.5, -0.5], [-0.5, 1.5]], (2, 2))
    array([[1. , 0.5],
           [0.5, 0. ]])
    """
    outline, size = points(outline, "outline", 2), target_size(size)
    sigma = blur_width(blur, "blur")
    if outline.ndim != 2 or len(outline) < 3:
        raise DegenerateError(f"outline: a polygon has at least 3 corners, got {outline.shape}")
    if np.abs(outline).max() > _FARTHEST:
        raise CvnotesError(f"outline: cut off what is more than {_FARTHEST:g} pixels away")
    following = np.roll(outline, -1, axis=0)
    area = float((following[:, 0] - outline[:, 0]) @ (following[:, 1] + outline[:, 1])) / 2
    if area == 0:
        raise DegenerateError("outline: the polygon has no area; its corners lie on one line")
    jump = np.full((len(outline), 1), np.sign(area))
    covered = edge_means(outline, following, jump, size, blur=sigma)[0]
    return np.asarray(covered.clip(0.0, 1.0, out=covered))


def subdivide(start: Array, end: Array, length: float) -> tuple[Array, Indices]:
    """Lay points along straight pieces (n, d), no further than `length` apart, ends included.

    Returns the points, piece after piece, and for each the number of its piece.

    Examples
    --------
    >>> points, piece = subdivide(np.zeros((1, 2)), np.array([[3.0, 0.0]]), 1.0)
    >>> points[:, 0], piece
    (array([0., 1., 2., 3.]), array([0, 0, 0, 0]))
    """
    n = np.maximum(np.ceil(np.linalg.norm(end - start, axis=1) / length), 1).astype(int)
    piece = np.repeat(np.arange(len(n)), n + 1)
    k = np.arange(len(piece)) - np.repeat(np.cumsum(n + 1) - (n + 1), n + 1)
    a = k / n[piece]
    start, end = np.take(start.T, piece, axis=1), np.take(end.T, piece, axis=1)
    return ((1 - a) * start + a * end).T, piece


def _shortened(ends: Array, jump: Array, longest: float) -> tuple[Array, Array]:
    """Cut pieces (4, n) = (u0, v0, u1, v1) that are longer than `longest` along u or v."""
    if np.abs(ends[2:] - ends[:2]).max() <= longest:
        return ends, jump
    m, piece = subdivide(ends[:2].T, ends[2:].T, longest)
    first = np.flatnonzero(piece[1:] == piece[:-1])
    return np.array([*m.T.take(first, 1), *m.T.take(first + 1, 1)]), jump.take(piece[first], 0)


def _deposit(picture: Array, ends: Array, jump: Array) -> None:
    """Add to a picture (k, height + 2, width) what sharp pieces change from row to row."""
    height, width = picture.shape[1] - 2, picture.shape[2]
    # 1. walk each piece from end to end, with a stop at the borders of pixels
    u0, v0, u1, v1 = ends
    a, b = _crossing(u0, u1), _crossing(v0, v1)
    t = np.stack([np.zeros_like(a), np.minimum(a, b), np.maximum(a, b), np.ones_like(a)])
    u, v = u0 + t * (u1 - u0), v0 + t * (v1 - v0)
    # 2. each part lies in one pixel; above the picture everything is below the part
    du = u[1:] - u[:-1]
    v = np.clip((v[1:] + v[:-1]) / 2, 0, height)
    row, column = v.astype(int), np.floor((u[1:] + u[:-1]) / 2).astype(int)
    du[(column < 0) | (column >= width)] = 0
    at = (row * width + np.clip(column, 0, width - 1)).ravel()
    # 3. this pixel gets the part below, the next one the rest
    for channel, j in zip(picture, jump.T, strict=True):
        whole = -j * du
        rest = whole * (v - row)
        np.add.at(channel.reshape(-1), at, (whole - rest).ravel())
        np.add.at(channel.reshape(-1), at + width, rest.ravel())


def _crossing(a: Array, b: Array) -> Array:
    """Where on the way from a (0) to b (1), at most 1 apart, an integer is crossed; or an end."""
    t = np.divide(np.floor(np.maximum(a, b)) - a, b - a, out=np.zeros_like(a), where=a != b)
    return np.clip(t, 0.0, 1.0)


def _deposit_blurred(picture: Array, ends: Array, jump: Array, blur: float, reach: int) -> None:
    """Add to a picture (k, height + 2, width) what blurred pieces change from row to row.

    Two points stand for each piece (Gauss–Legendre quadrature).
    """
    height, width = picture.shape[1] - 2, picture.shape[2]
    step = ends[2:] - ends[:2]
    u, v = np.concatenate([ends[:2] + (0.5 + s * np.sqrt(1 / 12)) * step for s in (-1, 1)], axis=1)
    weight = np.tile(-jump.T * step[0] / 2, 2)
    offsets = np.arange(-reach, reach + 1)
    n = max(_DEPOSITS // len(offsets) ** 2, 1)
    for part in chunks(len(u), n):
        row = np.floor(v[part, None]).astype(int) + offsets
        column = np.floor(u[part, None]).astype(int) + offsets
        rows, columns = _spread(row - v[part, None], column - u[part, None], blur)
        columns[(column < 0) | (column >= width)] = 0
        at = np.clip(row, 0, height)[:, :, None] * width
        at = (at + np.clip(column, 0, width - 1)[:, None, :]).ravel()
        spread = rows[:, :, None] * columns[:, None, :]
        for channel, w in zip(picture, weight[:, part], strict=True):
            np.add.at(channel.reshape(-1), at, (w[:, None, None] * spread).ravel())


def _spread(y: Array, x: Array, sigma: float) -> tuple[Array, Array]:
    """How a point of an edge at 0 spreads over rows from y to y + 1, columns from x to x + 1.

    The blur is separable. A column gets the part of the Gaussian that lies in it. A row gets what
    its mean of a blurred step exceeds that of the row above by: a second difference of the
    twofold integral of the Gaussian, z Φ(z) + φ(z).
    """
    x = np.append(x, x[:, -1:] + 1, axis=1) / sigma
    y = np.concatenate([y[:, :1] - 1, y, y[:, -1:] + 1], axis=1) / sigma
    twofold = y * _below(y) + np.exp(-y * y / 2) / np.sqrt(2 * np.pi)
    return sigma * np.diff(twofold, n=2, axis=1), np.diff(_below(x), axis=1)


def _below(z: Array) -> Array:
    """Φ(z), the part of a Gaussian below z.

    SciPy's takes a third of the time of Python's own, which gives the same digits and is there
    without SciPy too: on a page.
    """
    try:
        from scipy.special import ndtr
    except ImportError:
        erfc = np.frompyfunc(math.erfc, 1, 1)
        return 0.5 * np.asarray(erfc(z * -math.sqrt(0.5)), dtype=np.float64)
    return np.asarray(ndtr(z))
