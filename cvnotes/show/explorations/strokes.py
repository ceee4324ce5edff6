"""Strokes, cut to a rectangle and into dashes; and polygons, cut by a plane."""

import numpy as np

from cvnotes.base import Array, clipped_segments


def clipped(a: Array, b: Array, limits: tuple[Array, Array]) -> Array:
    """Cut segments a to b (n, 2) to a rectangle: (m, 2, 2), without what lies outside."""
    ends = np.stack([a, b], axis=1)
    return clipped_segments(ends, np.concatenate([ends - limits[0], limits[1] - ends], axis=-1))


def dashed(pairs: Array, length: float) -> Array:
    """Cut segments (n, 2, 2) into dashes and keep every other one, along the whole curve."""
    pairs = pairs[(pairs[:, 0] != pairs[:, 1]).any(axis=-1)]  # a point has no dashes
    way = pairs[:, 1] - pairs[:, 0]
    reach = np.linalg.norm(way, axis=-1)
    done = np.cumsum(reach) - reach  # where along the curve each segment begins
    first = 2 * np.floor(done / length / 2)  # dashes begin at even multiples of their length
    count = np.ceil((done + reach - first * length) / length / 2).clip(0).astype(int)
    which = np.repeat(np.arange(len(pairs)), count)
    nth = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    start = (first[which] + 2 * nth) * length - done[which]
    part = (np.stack([start, start + length], -1) / reach[which, None]).clip(0, 1)
    part, which = part[part[:, 1] > part[:, 0]], which[part[:, 1] > part[:, 0]]
    return np.asarray(pairs[which, :1] + part[..., None] * way[which, None])


def cut(corners: Array, inside: Array) -> Array:
    """Cut a polygon (n, d) by a plane: what lies inside, as deep as is said of each corner (n,).

    Examples
    --------
    >>> triangle = np.array([[0.0, 0], [4, 0], [0, 4]])
    >>> cut(triangle, 1 - triangle[:, 0])  # where x is at most 1
    array([[0., 0.],
           [1., 0.],
           [1., 3.],
           [0., 4.]])
    """
    kept: list[Array] = []
    for i in range(len(corners)):
        a, b = corners[i - 1], corners[i]
        if (inside[i - 1] >= 0) != (inside[i] >= 0):
            kept += [a + inside[i - 1] / (inside[i - 1] - inside[i]) * (b - a)]
        kept += [b] * bool(inside[i] >= 0)
    return np.array(kept).reshape(-1, corners.shape[-1])
