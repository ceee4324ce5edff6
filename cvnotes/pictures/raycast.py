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
from cvnotes.pictures.antialiasing import Mask

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
    return search(corners, xy)


@np.errstate(over="ignore", invalid="ignore")  # of rays along the picture's plane, nearly
def search(corners: Array, xy: Array) -> Hits:
    """Return what each ray meets first, as `first_hits` does, of numbers that are in order.

    A triangle that alone is left for a group, and fills it, is met by all of its rays. For the
    other groups it goes through the triangles, and keeps for each ray the nearest so far.
    """
    n, det = edge_functions(corners)
    forms = np.concatenate([n, (n.sum(axis=1) / det[:, None])[:, None]], axis=1)  # e_i, and 1 / z
    x, y = np.moveaxis(xy, -1, 0).copy()
    touched, fills = _may_be_seen(forms, det, x, y)
    first = np.full(x.shape, -1, dtype=np.int32)
    nearness = np.zeros(x.shape)  # 1 / z
    alone = np.flatnonzero((touched.sum(axis=0) == 1) & (touched & fills).any(axis=0))
    if len(alone):
        triangle = touched[:, alone].argmax(axis=0)
        first[alone] = triangle[:, None]
        nearness[alone] = _value(forms[triangle, 3].T[..., None], x[alone], y[alone])
        touched[:, alone] = False
    for i in np.flatnonzero(touched.any(axis=1)):
        every = np.flatnonzero(touched[i])
        for part in chunks(len(every), _GROUPS):
            groups = every[part]
            there, near = (x[groups], y[groups]), nearness[groups]
            e0, e1, e2, inverse_z = (_value(form, *there) for form in forms[i])
            seen = (e0 >= 0) & (e1 >= 0) & (e2 >= 0) & (inverse_z > near)
            if seen.any():
                nearness[groups] = np.where(seen, inverse_z, near)
                first[groups] = np.where(seen, np.int32(i), first[groups])
    first[np.isnan(x)] = -1
    depth = np.full(x.shape, np.nan)
    np.divide(1, nearness, out=depth, where=first >= 0)
    return Hits(first, depth)


def _value(form: Array, x: Array, y: Array) -> Array:
    a, b, c = form
    return np.asarray(a * x + b * y + c)


def _may_be_seen(forms: Array, det: Array, x: Array, y: Array) -> tuple[Mask, Mask]:
    """Return which triangles (rows) may be what a ray of which group (columns) meets first.

    A triangle is out of the question if one e_i is negative all over the rectangle around a
    group's rays, or if it is behind one that fills the rectangle. Which ones fill it is returned
    as well. Bounds are wider by more than what rounding does to the numbers in the e_i.
    """
    (x0, x1), (y0, y1) = ([f.reduce(m, axis=1) for f in (np.fmin, np.fmax)] for m in (x, y))
    middle = np.stack([(x0 + x1) / 2, (y0 + y1) / 2, np.ones_like(x0)])
    half = np.stack([(x1 - x0) / 2, (y1 - y0) / 2, np.zeros_like(x0)])
    size = np.abs(forms)
    size[:, 3] = size[:, :3].sum(axis=1) / det[:, None]
    rounding = 1e-12 * (np.abs(middle) + half)
    touched, fills = np.empty((2, len(det), len(x)), dtype=bool)
    nearest = np.full(len(x), -1)  # of those that fill a rectangle
    filled = np.zeros(len(x))  # its 1 / z where it is farthest
    for some in chunks(len(det), _CHUNK):
        value = forms[some] @ middle
        reach = np.abs(forms[some]) @ half + size[some] @ rounding
        touched[some] = ~(value + reach < 0)[:, :3].any(axis=1) & ~np.isnan(x0)
        least = np.where((value >= reach).all(axis=1), value[:, 3] - reach[:, 3], 0)
        fills[some] = least > 0
        most = least.max(axis=0)
        nearest = np.where(most > filled, some.start + least.argmax(axis=0), nearest)
        filled = np.maximum(filled, most)
    touched &= np.isfinite(det)[:, None]
    i, g = np.nonzero(touched & (nearest >= 0))
    ahead = forms[nearest[g], 3] - forms[i, 3]
    reach = (np.abs(ahead) * half.T[g]).sum(axis=1)
    reach += ((size[nearest[g], 3] + size[i, 3]) * rounding.T[g]).sum(axis=1)
    touched[i, g] = (ahead * middle.T[g]).sum(axis=1) <= reach
    return touched, fills
