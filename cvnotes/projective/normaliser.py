"""Hartley's normalisation: points of about unit size around the origin."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, DegenerateError, ShapeError, guarded, points

# Spreads of points between 1/_HUGE and _HUGE keep every product below finite.
_HUGE = 1e70


def _set_of_points(x: npt.ArrayLike, name: str) -> Array:
    x = points(x, name, 2, 3)
    if x.size == 0:
        raise DegenerateError(f"{name}: expected at least one point (..., n, d), got {x.shape}")
    if x.ndim < 2:
        raise ShapeError(f"{name}: expected several points (..., n, d), got a single one")
    return x


@guarded(x=_set_of_points)
def normaliser(x: Array) -> Array:
    """Give Hartley's similarity N: N x has centroid 0 and mean distance √d from it.

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
