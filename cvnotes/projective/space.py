"""Points, lines and planes of projective space P³."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, equally_many, matrix
from cvnotes.projective.points import refuse_zero, vectors

PLANE_AT_INFINITY = np.array([0.0, 0.0, 0.0, 1.0])
PLANE_AT_INFINITY.setflags(write=False)


def plane_through(a: npt.ArrayLike, b: npt.ArrayLike, c: npt.ArrayLike) -> Array:
    """Give the plane (..., 4) through three points of P³, (..., 4) each.

    Raises
    ------
    DegenerateError
        The points lie on a line: many planes pass through them.

    Examples
    --------
    >>> plane_through([1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1])  # x + y + z = 1
    array([ 1.,  1.,  1., -1.])
    """
    why = "the points lie on a line: many planes pass through them"
    return _wedge((a, b, c), ("a", "b", "c"), "point", why)


def point_of_planes(p: npt.ArrayLike, q: npt.ArrayLike, r: npt.ArrayLike) -> Array:
    """Give the point (..., 4) that three planes of P³ share.

    Raises
    ------
    DegenerateError
        The planes share a whole line.

    Examples
    --------
    >>> point_of_planes([1, 0, 0, -2], [0, 1, 0, -3], [0, 0, 1, -4])  # x = 2, y = 3, z = 4
    array([2., 3., 4., 1.])
    """
    return -_wedge((p, q, r), ("p", "q", "r"), "plane", "the planes share a whole line") + 0.0


def line_through(a: npt.ArrayLike, b: npt.ArrayLike) -> Array:
    """Give the line of P³ through two points (..., 4), as L = a bᵀ − b aᵀ of shape (..., 4, 4).

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
    why = "the points coincide: many lines pass through them"
    return _plucker(a, b, ("a", "b"), "point", why)


def line_of_planes(p: npt.ArrayLike, q: npt.ArrayLike) -> Array:
    """Give the line of P³ that two planes (..., 4) share, as a matrix L (..., 4, 4).

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
    why = "the planes coincide: they share all their points"
    return dual(_plucker(p, q, ("p", "q"), "plane", why))


def dual(L: npt.ArrayLike) -> Array:
    """Turn a line given by points into the same line given by planes, and back.

    Examples
    --------
    >>> L = line_through([0, 0, 0, 1], [0, 0, 5, 1])
    >>> bool((dual(dual(L)) == L).all())
    True
    """
    L = _line(L)
    D = np.zeros_like(L)
    for (i, j), (k, m) in (((0, 1), (2, 3)), ((0, 2), (3, 1)), ((0, 3), (1, 2))):
        D[..., i, j], D[..., k, m] = L[..., k, m], L[..., i, j]
    return D - D.mT


def meet_plane(L: npt.ArrayLike, p: npt.ArrayLike) -> Array:
    """Give the point (..., 4) where a line L of P³ meets a plane (..., 4): x = L p.

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
    return _apply(_line(L), p, ("p", "plane"), "the line lies in the plane")


def join_point(L: npt.ArrayLike, x: npt.ArrayLike) -> Array:
    """Give the plane (..., 4) through a line L of P³ and a point (..., 4): p = L* x.

    Raises
    ------
    DegenerateError
        The point lies on the line.

    Examples
    --------
    >>> z_axis = line_through([0, 0, 0, 1], [0, 0, 1, 1])
    >>> join_point(z_axis, [3, 0, 0, 1])  # y = 0
    array([0., 3., 0., 0.])
    """
    return _apply(
        dual(L), x, ("x", "point"), "the point lies on the line: many planes contain both"
    )


def _plucker(
    a: npt.ArrayLike, b: npt.ArrayLike, names: tuple[str, str], what: str, why: str
) -> Array:
    a, b = (vectors(x, name, what, 4) for x, name in zip((a, b), names, strict=True))
    equally_many(" and ".join(names), a.shape[:-1], b.shape[:-1])
    L = a[..., :, None] * b[..., None, :]
    L = L - L.mT
    size = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
    refuse_zero(L.reshape(*L.shape[:-2], 16), size, why)
    return np.asarray(L)


def _wedge(three: tuple[npt.ArrayLike, ...], names: tuple[str, ...], what: str, why: str) -> Array:
    """Give the vector (..., 4) that is orthogonal to three: the cross product of P³."""
    given = [vectors(x, name, what, 4) for x, name in zip(three, names, strict=True)]
    equally_many(", ".join(names), *(x.shape[:-1] for x in given))
    M = np.stack(np.broadcast_arrays(*given), axis=-2)
    with np.errstate(divide="ignore"):  # factors so small that their logarithm is infinite
        minors = [(-1) ** i * np.linalg.det(np.delete(M, i, axis=-1)) for i in range(4)]
    product = np.stack(minors, axis=-1)
    refuse_zero(product, np.prod(np.linalg.norm(M, axis=-1), axis=-1), why)
    return product + 0.0


def _line(L: npt.ArrayLike) -> Array:
    """Guard lines of P³ (..., 4, 4): L = −Lᵀ, and not zero."""
    L = matrix(L, "L", 4, 4)
    largest = np.abs(L).max(axis=(-2, -1), initial=0.0, keepdims=True)
    if (largest == 0).any() or (np.abs(L + L.mT) > 1e-9 * largest).any():
        raise CvnotesError(
            "L: a line of P³ is a matrix that is not zero, with L = −Lᵀ; line_through gives it"
        )
    return L


def _apply(L: Array, x: npt.ArrayLike, names: tuple[str, str], why: str) -> Array:
    x = vectors(x, *names, 4)
    equally_many("lines L and " + names[0], L.shape[:-2], x.shape[:-1])
    product = (L @ x[..., None])[..., 0]
    refuse_zero(product, np.linalg.norm(L, axis=(-2, -1)) * np.linalg.norm(x, axis=-1), why)
    return np.asarray(product) + 0.0
