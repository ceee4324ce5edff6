"""Points, lines and planes of projective space P³."""

from functools import partial

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, equally_many, guarded, matrix
from cvnotes.projective.points import refuse_zero, vectors

PLANE_AT_INFINITY = np.array([0.0, 0.0, 0.0, 1.0])
PLANE_AT_INFINITY.setflags(write=False)

_point, _plane = partial(vectors, what="point", d=4), partial(vectors, what="plane", d=4)


def _line(L: npt.ArrayLike, name: str) -> Array:
    """Guard lines of P³ (..., 4, 4): L = −Lᵀ, and not zero."""
    L = matrix(L, name, 4, 4)
    largest = np.abs(L).max(axis=(-2, -1), initial=0.0, keepdims=True)
    if (largest == 0).any() or (np.abs(L + L.mT) > 1e-9 * largest).any():
        raise CvnotesError(
            f"{name}: a line of P³ is a matrix that is not zero, with L = −Lᵀ; "
            "line_through gives it"
        )
    return L


def _as_many(**given: Array) -> None:
    names = " and ".join(given) if len(given) == 2 else ", ".join(given)
    equally_many(names, *(x.shape[:-1] for x in given.values()))


def _one_each(L: Array, **other: Array) -> None:
    ((name, x),) = other.items()
    equally_many(f"lines L and {name}", L.shape[:-2], x.shape[:-1])


@guarded(a=_point, b=_point, c=_point, also=_as_many)
def plane_through(a: Array, b: Array, c: Array) -> Array:
    """Return the plane (..., 4) through three points of P³, (..., 4) each.

    Raises
    ------
    DegenerateError
        The points lie on a line: many planes pass through them.

    Examples
    --------
    >>> plane_through([1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1])  # x + y + z = 1
    array([ 1.,  1.,  1., -1.])
    """
    plane = _wedge(a, b, c)
    refuse_zero(plane, (a, b, c), "the points lie on a line: many planes pass through them")
    return plane + 0.0


@guarded(a=_point, b=_point, also=_as_many)
def line_through(a: Array, b: Array) -> Array:
    """Return the line of P³ through two points (..., 4), as L = a bᵀ − b aᵀ of shape (..., 4, 4).

    Raises
    ------
    DegenerateError
        The points coincide.

    References
    ----------
    .. [1] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 3.2.2.

    Examples
    --------
    >>> z_axis = line_through([0, 0, 0, 1], [0, 0, 5, 1])
    >>> meet_plane(z_axis, PLANE_AT_INFINITY)  # its direction
    array([ 0.,  0., -5.,  0.])
    """
    return _of_two(a, b, "the points coincide: many lines pass through them")


@guarded(p=_plane, q=_plane, also=_as_many)
def line_of_planes(p: Array, q: Array) -> Array:
    """Return the line of P³ that two planes (..., 4) share, as a matrix L (..., 4, 4).

    Parallel planes share a line at infinity.

    Raises
    ------
    DegenerateError
        The planes coincide.

    Examples
    --------
    >>> z_axis = line_of_planes([1, 0, 0, 0], [0, 1, 0, 0])
    >>> meet_plane(z_axis, [0, 0, 1, -7])
    array([ 0.,  0., -7., -1.])
    """
    return dual.inside(_of_two(p, q, "the planes coincide: they share all their points"))


@guarded(L=_line)
def dual(L: Array) -> Array:
    """Turn a line given by points into the same line given by planes, and back.

    Examples
    --------
    >>> L = line_through([0, 0, 0, 1], [0, 0, 5, 1])
    >>> bool((dual(dual(L)) == L).all())
    True
    """
    D = np.zeros_like(L)
    for (i, j), (k, m) in (((0, 1), (2, 3)), ((0, 2), (3, 1)), ((0, 3), (1, 2))):
        D[..., i, j], D[..., k, m] = L[..., k, m], L[..., i, j]
    return D - D.mT


@guarded(L=_line, p=_plane, also=_one_each)
def meet_plane(L: Array, p: Array) -> Array:
    """Return the point (..., 4) where a line L of P³ meets a plane (..., 4): x = L p.

    Raises
    ------
    DegenerateError
        The line lies in the plane.

    Examples
    --------
    >>> L = line_through([1, 2, 0, 1], [1, 2, 1, 1])
    >>> meet_plane(L, [0, 0, 1, -9])
    array([1., 2., 9., 1.])
    """
    point = (L @ p[..., None])[..., 0]
    refuse_zero(point, (_flat(L), p), "the line lies in the plane")
    return np.asarray(point) + 0.0


def _wedge(*three: Array) -> Array:
    """Return the vector (..., 4) that is orthogonal to three: the cross product of P³."""
    M = np.stack(np.broadcast_arrays(*three), axis=-2)
    with np.errstate(divide="ignore"):  # factors so small that their logarithm is infinite
        minors = [(-1) ** i * np.linalg.det(np.delete(M, i, axis=-1)) for i in range(4)]
    return np.stack(minors, axis=-1)


def _of_two(a: Array, b: Array, words: str) -> Array:
    """Return a bᵀ − b aᵀ, of shape (..., 4, 4); the words say what is wrong where it is zero."""
    abT = a[..., :, None] * b[..., None, :]
    L = abT - abT.mT
    refuse_zero(_flat(L), (a, b), words)
    return np.asarray(L)


def _flat(L: Array) -> Array:
    return L.reshape(*L.shape[:-2], 16)
