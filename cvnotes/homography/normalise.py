"""Hartley's normalisation: points of about unit size around the origin."""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, CvnotesError, DegenerateError, ShapeError, points

# Spreads of points between 1/_HUGE and _HUGE keep every product below finite.
_HUGE = 1e70


def normaliser(x: npt.ArrayLike) -> Array:
    """Give Hartley's similarity N (..., 3, 3): N x has centroid 0 and mean distance √2 from it.

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
    x = points(x, "x", 2)
    if x.size == 0:
        raise DegenerateError(f"x: expected at least one point (..., n, 2), got {x.shape}")
    return normaliser_of(x)


def normaliser_of(x: Array) -> Array:
    """Give the similarity of `normaliser`, without copying and checking x once more."""
    if x.ndim < 2:
        raise ShapeError("x: expected several points (..., n, 2), got a single one")
    n = x.shape[-2]
    centre = np.ones(n) @ x / n  # on stacks many times as quick as the method mean
    d = x - centre[..., None, :]
    distance = np.sqrt(d[..., 0] ** 2 + d[..., 1] ** 2).sum(-1) / n
    smallest = 1e-12 * np.abs(centre).max(-1) + 1 / _HUGE
    if not ((smallest < distance) & (distance < _HUGE)).all():
        if (distance <= smallest).any():
            raise DegenerateError("all points coincide; a homography needs four that do not")
        raise CvnotesError(f"points more than {_HUGE:g} apart cannot be computed with")
    s = 2**0.5 / distance
    N = np.zeros((*x.shape[:-2], 3, 3))
    N[..., 0, 0] = N[..., 1, 1] = s
    N[..., :2, 2] = -s[..., None] * centre
    N[..., 2, 2] = 1
    return N


def apply_similarity(N: Array, x: Array) -> Array:
    """Apply similarities without rotation to sets of points."""
    return np.asarray(N[..., 0, 0, None, None] * x + N[..., None, :2, 2])


def inverse_similarity(N: Array) -> Array:
    """Invert similarities (..., 3, 3) without rotation."""
    inverse = np.zeros_like(N)
    inverse[..., 0, 0] = inverse[..., 1, 1] = 1 / N[..., 0, 0]
    inverse[..., :2, 2] = -N[..., :2, 2] / N[..., 0, 0, None]
    inverse[..., 2, 2] = 1
    return inverse
