"""The lens, by linear least squares, once A and the poses are known."""

import numpy as np
import numpy.typing as npt

from cvnotes.camera.sensor import ideal_columns
from cvnotes.errors import (
    Array,
    CvnotesError,
    DegenerateError,
    equally_many,
    intrinsic_matrix,
    paired,
    points,
    rigid_motion,
)


def radial_distortion(
    A: npt.ArrayLike, G: npt.ArrayLike, W: npt.ArrayLike, m: npt.ArrayLike, *, terms: int = 2
) -> Array:
    """Estimate k (terms,) by linear least squares, A and the poses being known: D k = d.

    Parameters
    ----------
    A : array_like, shape (3, 3)
        Intrinsic matrix.
    G : array_like, shape (..., 4, 4)
        Poses of the views.
    W : array_like, shape (..., n, 3)
        Board points; one set serves all views.
    m : array_like, shape (..., n, 2)
        Where the points were seen, in pixels.
    terms : int
        How many radial coefficients.

    Raises
    ------
    DegenerateError
        A point does not lie in front of the camera, or the points do not determine k.

    Notes
    -----
    Each point gives x̃ (k1 r² + k2 r⁴ + …) = x' − x̃, and so for y, with r the radius of the
    *ideal* point (x̃, ỹ), as L(r) was defined. The notes print the radius of the observed
    point; with that, even exact data give wrong coefficients (erratum E34).

    References
    ----------
    .. [1] Notes 2b.4, "Estimation of lens distortion parameters".

    Examples
    --------
    >>> W = np.array([[0.0, 0, 0], [0.5, 0, 0], [1, 0, 0], [1, 1, 0]])
    >>> seen = W[:, :2] * (1 - 0.1 * (W**2).sum(-1, keepdims=True))
    >>> G = np.eye(4)
    >>> G[2, 3] = 1
    >>> radial_distortion(np.eye(3), G, W, seen, terms=1).round(12)
    array([-0.1])
    """
    A, G = intrinsic_matrix(A), rigid_motion(G)
    W, m = points(W, "W", 3), points(m, "m", 2)
    paired(W, m, ("W", "m"), at_least=1)
    if not isinstance(terms, int) or terms < 1:
        raise CvnotesError(f"terms: expected how many coefficients, 1 or more, got {terms!r}")
    views = equally_many("G, W and m", G.shape[:-2], W.shape[:-2], m.shape[:-2])
    if 0 in views:
        raise DegenerateError("need at least one view, got none")
    return radial_from_poses(A, G, W, m, terms)


def radial_from_poses(A: Array, G: Array, W: Array, m: Array, terms: int) -> Array:
    """Solve `radial_distortion` without guards of the arrays: for use inside."""
    M = W @ G[..., :3, :3].mT + G[..., None, :3, 3]
    if not (M[..., 2] > 0).all():
        raise DegenerateError("a board point does not lie in front of the camera")
    ideal = M[..., :2] / M[..., 2:]
    r2 = ideal[..., :1] ** 2 + ideal[..., 1:] ** 2
    d = np.stack(ideal_columns(A, m), axis=-1) - ideal
    D = np.empty((*d.shape, terms))
    power = ideal
    for i in range(terms):
        power = power * r2
        D[..., i] = power
    k, _, rank, _ = np.linalg.lstsq(D.reshape(-1, terms), d.ravel(), rcond=None)
    if rank < terms:
        raise DegenerateError(f"the points do not determine {terms} coefficients: vary the radius")
    return np.asarray(k)
