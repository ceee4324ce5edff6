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


def _of_two(a: Array, b: Array, words: str) -> Array:
    """Return a bᵀ − b aᵀ, of shape (..., 4, 4); the words say what is wrong where it is zero."""
    abT = a[..., :, None] * b[..., None, :]
    L = abT - abT.mT
    refuse_zero(_flat(L), (a, b), words)
    return np.asarray(L)


def _flat(L: Array) -> Array:
    return L.reshape(*L.shape[:-2], 16)
