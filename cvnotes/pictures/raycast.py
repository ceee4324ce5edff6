"""Which triangle does a ray meet first? The projection of notes 2b.1, read backwards.

Everything happens in the CRF: the camera is the origin and a ray is the direction d = (x, y, 1)
of an ideal image point. With the corners V0, V1, V2 of a triangle and

    e0 = (V1 × V2)·d,    e1 = (V2 × V0)·d,    e2 = (V0 × V1)·d,    det = V0·(V1 × V2)

the ray meets the triangle's plane at depth z = det / (e0 + e1 + e2), in the point of barycentric
weights e_i / (e0 + e1 + e2): within the triangle, and in front of the camera, if all e_i have the
sign of det. Nothing needs clipping at the camera's plane; and neighbours compute the e of their
common edge with opposite signs, so that no ray slips through between them.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, ShapeError, chunks, numbers, real

Indices = npt.NDArray[np.int32]

_CHUNK = 32  # triangles at a time
_GROUPS = 64  # of rays at a time, so that they stay in the cache


class Hits(NamedTuple):
    """What rays (...) meet: the triangle's number, −1 where none, and the depth, NaN there."""

    triangle: Indices
    depth: Array


def edge_functions(corners: Array) -> tuple[Array, Array]:
    """Return rows n_i (m, 3, 3) with e_i = n_i·d, and det (m,), signed so that det > 0.

    `corners` (m, 3, 3) in the CRF. Triangles that are seen edge-on, as a line without width,
    are NaN: no ray meets them.

    Examples
    --------
    >>> n, det = edge_functions(np.array([[[0.0, 0, 2], [1, 0, 2], [0, 1, 2]]]))
    >>> det / n.sum(axis=1)[:, 2]  # the depth along d = (0, 0, 1)
    array([2.])
    """
    V0, V1, V2 = np.moveaxis(corners, 1, 0)
    n = np.stack([np.cross(V1, V2), np.cross(V2, V0), np.cross(V0, V1)], axis=1)
    det = np.einsum("ij,ij->i", V0, n[:, 0])
    rounding = 1e-14 * np.abs(n).max(axis=(1, 2), initial=0.0) ** 1.5
    # Only signs are applied to n: a division would round, and neighbours would no longer agree.
    sign = np.where(np.abs(det) > rounding, np.sign(det), np.nan)
    return n * sign[:, None, None], det * sign


def first_hits(corners: npt.ArrayLike, xy: npt.ArrayLike) -> Hits:
    """Find the triangle that each ray meets first.

    Parameters
    ----------
    corners : array_like, shape (m, 3, 3)
        Triangles by their three corners, in the CRF. Both sides are visible.
    xy : array_like, shape (groups, k, 2)
        Rays as ideal image points. Those of a group should lie close together in the image: a
        triangle is tried on the groups that it may touch. NaN rays meet nothing.

    Returns
    -------
    Hits
        ``triangle`` and ``depth``, both (groups, k).

    References
    ----------
    .. [1] M. Olano and T. Greer, Triangle scan conversion using 2D homogeneous coordinates,
       SIGGRAPH/Eurographics Workshop on Graphics Hardware (1997).

    Examples
    --------
    >>> hits = first_hits([[[0, 0, 2], [1, 0, 2], [0, 1, 2]]], [[[0.1, 0.1], [0.4, 0.4]]])
    >>> hits.triangle
    array([[ 0, -1]], dtype=int32)
    """
    corners = numbers(corners, "corners")
    with np.errstate(over="ignore"):  # of long doubles
        xy = np.asarray(real(xy, "xy"), dtype=np.float64)
    if corners.ndim != 3 or corners.shape[1:] != (3, 3):
        raise ShapeError(f"corners: expected triangles (m, 3, 3), got {corners.shape}")
    if xy.ndim != 3 or xy.shape[-1] != 2:
        raise ShapeError(f"xy: expected groups of rays (groups, k, 2), got {xy.shape}")
    triangle = search(corners, xy)
    return Hits(triangle, depth_along(corners, triangle, xy))


@np.errstate(over="ignore", invalid="ignore")  # of rays along the picture's plane, nearly
def search(corners: Array, xy: Array) -> Indices:
    """Return the number of the triangle that each ray meets first, as `first_hits` does.

    It goes through the triangles, and keeps for each ray the nearest so far.
    """
    n, det = edge_functions(corners)
    x, y = np.moveaxis(xy, -1, 0).copy()
    touched = _may_be_seen(n, det, x, y)
    first = np.full(x.shape, -1, dtype=np.int32)
    nearness = np.zeros(x.shape)  # 1 / z
    for i in np.flatnonzero(touched.any(axis=1)):
        every = np.flatnonzero(touched[i])
        for part in chunks(len(every), _GROUPS):
            groups = every[part]
            there, near = (x[groups], y[groups]), nearness[groups]
            e0, e1, e2 = (a * there[0] + b * there[1] + c for a, b, c in n[i])
            seen = (e0 >= 0) & (e1 >= 0) & (e2 >= 0)
            inverse_z = (e0 + e1 + e2) / det[i]
            seen &= inverse_z > near
            if seen.any():
                nearness[groups] = np.where(seen, inverse_z, near)
                first[groups] = np.where(seen, np.int32(i), first[groups])
    return first


def _may_be_seen(n: Array, det: Array, x: Array, y: Array) -> npt.NDArray[np.bool_]:
    """Return which triangles (rows) may be what a ray of which group (columns) meets first.

    A triangle is out of the question if one e_i is negative all over the rectangle around a
    group's rays, or if another triangle fills the rectangle and is nearer throughout.
    """
    rectangle = np.stack([f.reduce(m, axis=1) for m in (x, y) for f in (np.fmin, np.fmax)])
    seeing = ~np.isnan(rectangle[0])
    forms, size = n.reshape(-1, 3), np.abs(n)
    inverse_z, size_z = n.sum(axis=1) / det[:, None], size.sum(axis=1) / det[:, None]
    touched = np.empty((len(n), len(x)), dtype=bool)
    filled = np.zeros(len(x))  # 1 / z of the nearest that fills a rectangle, where it is farthest
    for some in chunks(len(n), _CHUNK):
        e = slice(3 * some.start, 3 * some.stop)
        low, high = _range_of(forms[e], size.reshape(-1, 3)[e], rectangle)
        touched[some] = ~(high < 0).reshape(some.stop - some.start, 3, -1).any(axis=1)
        fills = (low >= 0).reshape(some.stop - some.start, 3, -1).all(axis=1)
        least, _ = _range_of(inverse_z[some], size_z[some], rectangle)
        filled = np.maximum(filled, np.where(fills, least, 0).max(axis=0))
    for some in chunks(len(n), _CHUNK):
        _, most = _range_of(inverse_z[some], size_z[some], rectangle)
        touched[some] &= seeing & ~(most < filled)
    return touched & np.isfinite(det)[:, None]


def _range_of(forms: Array, size: Array, rectangle: Array) -> tuple[Array, Array]:
    """Bound forms (k, 3), a x + b y + c, over rectangles (4, groups) = (x0, x1, y0, y1).

    By more than what rounding does to numbers of their size (k, 3) the bounds are too wide.
    """
    x0, x1, y0, y1 = rectangle
    middle = np.stack([(x0 + x1) / 2, (y0 + y1) / 2, np.ones_like(x0)])
    half = np.stack([(x1 - x0) / 2, (y1 - y0) / 2, np.zeros_like(x0)])
    reach = np.abs(forms) @ half + 1e-12 * size @ (np.abs(middle) + half)
    value = forms @ middle
    return value - reach, value + reach


def depth_along(corners: Array, triangle: Indices, xy: Array) -> Array:
    """Return z of the triangles' planes along the rays, NaN where there is no triangle."""
    n, det = edge_functions(corners)
    z = np.full(triangle.shape, np.nan)
    hit = triangle >= 0
    inverse = (n.sum(axis=1) / det[:, None]).T.copy()
    a, b, c = inverse[:, triangle[hit]]
    z[hit] = 1 / (a * xy[hit, 0] + b * xy[hit, 1] + c)
    return z
