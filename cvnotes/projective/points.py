"""Points of projective space, at infinity too (notes 2b.1).

A homogeneous coordinate vector stands for a whole class of vectors that differ by a factor;
nothing here depends on that factor. A last coordinate of exactly zero is a point at infinity:
it has a direction but no place, so dropping back to Euclidean coordinates gives NaN.

Last in this file is Hartley's normalisation of point sets, which all linear estimates need first.
"""

from functools import partial, reduce

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    LARGEST_ENTRY,
    Array,
    CvnotesError,
    DegenerateError,
    ShapeError,
    equally_many,
    guarded,
    number,
    numbers,
    points,
)

# Spreads of points between 1/_HUGE and _HUGE keep every product below finite.
_HUGE = 1e70


def coordinates(x: npt.ArrayLike, name: str) -> Array:
    """Guard Euclidean coordinates (..., d)."""
    array = numbers(x, name)
    if array.ndim == 0 or array.shape[-1] == 0:
        got = "a single number" if array.ndim == 0 else "none"
        raise ShapeError(f"expected coordinates (..., d), got {got}")
    return array


def homogeneous(x: npt.ArrayLike, name: str) -> Array:
    """Guard homogeneous coordinates (..., d + 1), of any size."""
    array = numbers(x, name, largest=np.inf)
    if array.ndim == 0 or array.shape[-1] < 2:
        raise ShapeError(
            f"{name}: expected homogeneous coordinates (..., d + 1), got {array.shape}"
        )
    return array


@guarded(x=coordinates)
def to_homogeneous(x: Array) -> Array:
    """Lift points (..., d) to homogeneous coordinates (..., d + 1) by appending a 1.

    Examples
    --------
    >>> to_homogeneous([2, 3])
    array([2., 3., 1.])
    """
    return np.concatenate([x, np.ones_like(x[..., :1])], axis=-1)


@guarded(d=coordinates)
def direction_to_homogeneous(d: Array) -> Array:
    """Lift directions (..., d) to points at infinity (..., d + 1) by appending a 0.

    Examples
    --------
    >>> direction_to_homogeneous([0, 0, 1])
    array([0., 0., 1., 0.])
    """
    return np.concatenate([d, np.zeros_like(d[..., :1])], axis=-1)


@guarded(x_h=homogeneous)
@np.errstate(over="ignore")
def from_homogeneous(x_h: Array) -> Array:
    """Drop homogeneous coordinates (..., d + 1) to Euclidean ones (..., d).

    Points at infinity have no Euclidean coordinates: their rows are NaN, and so is the row of
    the zero vector, which is no point at all.

    Examples
    --------
    >>> from_homogeneous([[4, 6, 2], [1, 0, 0]])
    array([[ 2.,  3.],
           [nan, nan]])
    """
    w = x_h[..., -1:]
    return np.asarray(x_h[..., :-1] / np.where(w == 0, np.nan, w))


def _fit(H: Array, x: Array) -> None:
    if H.ndim < 2 or H.shape[-2] < 2 or x.ndim < 1 or H.shape[-1] != x.shape[-1] + 1:
        raise ShapeError(
            f"H {H.shape} cannot map points x {x.shape}: it needs one column more than a point "
            "has coordinates"
        )
    equally_many("the maps H and the sets of points x", H.shape[:-2], x.shape[:-2])


@guarded(H=partial(numbers, largest=LARGEST_ENTRY), x=numbers, also=_fit)
def apply(H: Array, x: Array) -> Array:
    """Map points (..., d) by a projective transformation H of shape (..., e + 1, d + 1).

    Lift, multiply, drop. A stack of matrices (..., e + 1, d + 1) maps a stack of point sets
    (..., n, d). Rows whose image lies at infinity are NaN.

    Examples
    --------
    >>> apply([[1, 0, 5], [0, 1, 0], [0, 0, 1]], [[1, 2], [3, 4]])
    array([[6., 2.],
           [8., 4.]])
    """
    x_h = to_homogeneous.inside(x)
    return from_homogeneous.inside(x_h @ H.mT if x.ndim > 1 else H @ x_h)


def same_up_to_scale(a: npt.ArrayLike, b: npt.ArrayLike, atol: float = 1e-9) -> bool:
    """Return whether two vectors or matrices differ only by a factor (the sign ≈ of the notes).

    Both are scaled to unit norm, so `atol` is relative to the size of the whole array. The zero
    vector stands for nothing, so it equals nothing.

    Examples
    --------
    >>> same_up_to_scale([1, 2, 3], [-2, -4, -6])
    True
    """
    a, b = (numbers(x, name, largest=np.inf) for x, name in ((a, "a"), (b, "b")))
    atol = number(atol, "atol", at_least=0)
    if a.shape != b.shape:
        raise ShapeError(f"a has shape {a.shape} but b has {b.shape}")
    if not a.any() or not b.any():
        raise CvnotesError("the zero vector stands for no point; equality is not defined for it")
    a, b = a / np.abs(a).max(), b / np.abs(b).max()
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    return bool(min(np.abs(a - b).max(), np.abs(a + b).max()) <= atol)


_ROUNDING = 2e-15  # relative size of what is left of a product that should be 0


def vectors(x: npt.ArrayLike, name: str, what: str, d: int | None = None) -> Array:
    """Guard homogeneous vectors; factors that would make products overflow are taken out."""
    x = numbers(x, name, largest=np.inf)
    wanted = "(..., 3) or (..., 4)" if d is None else f"(..., {d})"
    if x.ndim == 0 or x.shape[-1] not in ((3, 4) if d is None else (d,)):
        raise ShapeError(f"{name}: expected homogeneous coordinates {wanted}, got {x.shape}")
    largest = np.abs(x).max(axis=-1, keepdims=True, initial=0.0)
    if (largest == 0).any():
        raise CvnotesError(f"{name}: the zero vector is not a {what}")
    exponent = np.frexp(largest)[1]
    return np.asarray(np.ldexp(x, np.where(np.abs(exponent) > 200, -exponent, 0)))


def refuse_zero(product: Array, factors: tuple[Array, ...], why: str) -> None:
    """Refuse products (..., d) that are nothing but rounding beside their factors (..., d)."""
    size = reduce(np.multiply, (np.linalg.norm(x, axis=-1) for x in factors))
    if (np.linalg.norm(product, axis=-1) <= _ROUNDING * size).any():
        raise DegenerateError(why)


def _set_of_points(x: npt.ArrayLike, name: str) -> Array:
    x = points(x, name, 2, 3)
    if x.size == 0:
        raise DegenerateError(f"{name}: expected at least one point (..., n, d), got {x.shape}")
    if x.ndim < 2:
        raise ShapeError(f"{name}: expected several points (..., n, d), got a single one")
    return x


@guarded(x=_set_of_points)
def normaliser(x: Array) -> Array:
    """Return Hartley's similarity N: N x has centroid 0 and mean distance √d from it.

    Parameters
    ----------
    x : array_like, shape (..., n, d)
        Sets of points, d = 2 or 3.

    Returns
    -------
    ndarray, shape (..., d + 1, d + 1)
        Without rotation: N x̃ = s (x − centroid), with s = √d / mean distance.

    Raises
    ------
    DegenerateError
        All points of a set coincide.

    References
    ----------
    .. [1] Absent from the notes; see erratum E26.
    .. [2] R. Hartley, In defense of the eight-point algorithm, PAMI 19 (1997) 580-593.

    Examples
    --------
    >>> normaliser([[0, 0], [2, 0], [0, 2], [2, 2]])
    array([[ 1.,  0., -1.],
           [ 0.,  1., -1.],
           [ 0.,  0.,  1.]])
    """
    d = x.shape[-1]
    centroid = x.mean(axis=-2)
    from_it = x - centroid[..., None, :]
    distance = np.sqrt(np.vecdot(from_it, from_it)).mean(axis=-1)
    _refuse_extremes(centroid, distance)
    s = np.sqrt(d) / distance
    N = np.zeros((*x.shape[:-2], d + 1, d + 1))
    N[..., range(d), range(d)] = s[..., None]
    N[..., :d, d] = -s[..., None] * centroid
    N[..., d, d] = 1
    return N


def _refuse_extremes(centroid: Array, distance: Array) -> None:
    smallest = 1e-12 * np.abs(centroid).max(-1) + 1 / _HUGE
    if (distance <= smallest).any():
        d = centroid.shape[-1]
        needed = "a homography needs four" if d == 2 else "the PPM needs six"
        raise DegenerateError(f"all points coincide; {needed} that do not")
    if not (distance < _HUGE).all():
        raise CvnotesError(f"points more than {_HUGE:g} apart cannot be computed with")


def apply_similarity(N: Array, x: Array) -> Array:
    """Apply similarities without rotation to sets of points (..., n, d)."""
    return np.asarray(N[..., 0, 0, None, None] * x + N[..., None, :-1, -1])


def inverse_similarity(N: Array) -> Array:
    """Invert similarities (..., d + 1, d + 1) without rotation."""
    inverse = np.zeros_like(N)
    d = range(N.shape[-1] - 1)
    inverse[..., d, d] = 1 / N[..., d, d]
    inverse[..., :-1, -1] = -N[..., :-1, -1] / N[..., 0, 0, None]
    inverse[..., -1, -1] = 1
    return inverse
