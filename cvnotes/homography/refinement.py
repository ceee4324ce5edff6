"""The geometric error of a homography, and the H that minimises it."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    DegenerateError,
    equally_many,
    levenberg_marquardt,
    matrix,
    paired,
    points,
    solve_dense,
)
from cvnotes.homography.linear import RANK, apply_similarity, inverse_similarity, normaliser_of
from cvnotes.projective import from_homogeneous, to_homogeneous


def geometric_error(H: npt.ArrayLike, src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Distances (..., n) in the plane of `dst` between dst and π(H src).

    Examples
    --------
    >>> geometric_error(np.eye(3), [[0, 0]], [[3, 4]])
    array([5.])
    """
    H = matrix(H, "H", 3, 3)
    src, dst = points(src, "src", 2), points(dst, "dst", 2)
    paired(src, dst, ("src", "dst"), at_least=1)
    equally_many("H, src and dst", H.shape[:-2], src.shape[:-2], dst.shape[:-2])
    d = dst - from_homogeneous.inside(to_homogeneous(src) @ H.mT)
    return np.asarray(np.hypot(d[..., 0], d[..., 1]))


def refine_homography(H: npt.ArrayLike, src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Refine H (3, 3) by minimising the geometric error Σ ‖dst − π(H src)‖².

    Parameters
    ----------
    H : array_like, shape (..., 3, 3)
        The start, for example from `dlt`; of any scale.
    src, dst : array_like, shape (..., n, 2)
        At least 4 point pairs.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        The refined H, ‖H‖ = 1, with the sign of the start.

    Notes
    -----
    π divides by the third component; the notes print the difference of homogeneous vectors,
    which depends on their arbitrary scales (erratum E25). Levenberg–Marquardt on all nine
    entries: h itself is a direction in which nothing changes, so h hᵀ is added to JᵀJ and the
    step stays perpendicular to h.

    References
    ----------
    .. [1] Notes 2b.4, "Estimating H_i".

    Examples
    --------
    >>> src = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]])
    >>> dst = 2 * src + [3, 4]
    >>> H = refine_homography(np.diag([2.1, 2, 1]), src, dst)
    >>> (H / H[2, 2]).round(9) + 0.0
    array([[2., 0., 3.],
           [0., 2., 4.],
           [0., 0., 1.]])
    """
    H = matrix(H, "H", 3, 3)
    src, dst = points(src, "src", 2), points(dst, "dst", 2)
    paired(src, dst, ("src", "dst"), at_least=4)
    if max(H.ndim, src.ndim, dst.ndim) > 2:
        stack = equally_many("H, src and dst", H.shape[:-2], src.shape[:-2], dst.shape[:-2])
        if 0 in stack:
            return np.zeros((*stack, 3, 3))
        views = (np.broadcast_to(x, (*stack, *x.shape[-2:])) for x in (H, src, dst))
        refined = [_refine_one(*one) for one in zip(*(_flatten(x) for x in views), strict=True)]
        return np.stack(refined).reshape(*stack, 3, 3)
    return _refine_one(H, src, dst)


def _flatten(x: Array) -> Array:
    return x.reshape(-1, *x.shape[-2:])


def _refine_one(H: Array, src: Array, dst: Array) -> Array:
    N1, N2 = normaliser_of(src), normaliser_of(dst)
    W, m = to_homogeneous(apply_similarity(N1, src)), apply_similarity(N2, dst)
    n = len(W)

    def linearise(h: Array) -> tuple[float, Array]:
        m_h = W @ h.reshape(3, 3).T
        w = m_h[:, 2:]
        predicted = m_h[:, :2] / w
        J = np.zeros((n, 2, 10))
        J[:, 0, 0:3] = J[:, 1, 3:6] = W / w
        J[:, :, 6:9] = -predicted[:, :, None] * (W / w)[:, None, :]
        J[:, :, 9] = predicted - m
        J = J.reshape(2 * n, 10)
        system = J.T @ J
        cost = float(system[9, 9])
        system[:9, :9] += np.outer(h, h)
        return cost, system

    def take_step(h: Array, step: Array) -> Array:
        return np.asarray((h + step) / np.linalg.norm(h + step))

    start = N2 @ (H / (np.abs(H).max() or 1.0)) @ inverse_similarity(N1)
    s = np.linalg.svd(start, compute_uv=False)
    if s[2] <= RANK * s[0]:
        raise DegenerateError("H is singular: it maps the plane onto a line or a point")
    start = start.ravel() / np.linalg.norm(start)
    h = levenberg_marquardt(start, linearise, solve_dense, take_step, floor=1e-28 * n).x
    refined = inverse_similarity(N2) @ h.reshape(3, 3) @ N1
    return np.asarray(refined / np.linalg.norm(refined))
