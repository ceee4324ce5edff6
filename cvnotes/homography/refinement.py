"""The geometric error of a homography, and the H that minimises it."""

import numpy as np

from cvnotes.base import (
    Array,
    DegenerateError,
    Matrix,
    Points,
    equally_many,
    guarded,
    levenberg_marquardt,
    solve_dense,
)
from cvnotes.homography.linear import RANK
from cvnotes.projective import from_homogeneous, to_homogeneous
from cvnotes.projective.points import apply_similarity, inverse_similarity, normaliser


def _equally_many(H: Array, src: Array, dst: Array) -> None:
    equally_many("H, src and dst", H.shape[:-2], src.shape[:-2], dst.shape[:-2])


@guarded(H=Matrix(3, 3), src=Points(2), dst=Points(2), pair=("src", "dst"), also=_equally_many)
def geometric_error(H: Array, src: Array, dst: Array) -> Array:
    """Distances (..., n) in the plane of `dst` between dst and π(H src).

    Examples
    --------
    >>> geometric_error(np.eye(3), [[0, 0]], [[3, 4]])
    array([5.])
    """
    d = dst - from_homogeneous.inside(to_homogeneous.inside(src) @ H.mT)
    return np.asarray(np.hypot(d[..., 0], d[..., 1]))


@guarded(H=Matrix(3, 3), src=Points(2), dst=Points(2), pair=("src", "dst"), at_least=4)
def refine_homography(H: Array, src: Array, dst: Array) -> Array:
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

    The minimum is the one nearest to the start. src is taken to be exact, as the corners of a
    board are; between two pictures both sides are noisy, and this minimises one of them.

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
    N1, N2 = normaliser.inside(src), normaliser.inside(dst)
    start = N2 @ (H / (np.abs(H).max() or 1.0)) @ inverse_similarity(N1)
    s = np.linalg.svd(start, compute_uv=False)
    if s[2] <= RANK * s[0]:
        raise DegenerateError("H is singular: it maps the plane onto a line or a point")
    W, m = to_homogeneous.inside(apply_similarity(N1, src)), apply_similarity(N2, dst)
    refined = inverse_similarity(N2) @ refine_projection(start, W, m) @ N1
    return np.asarray(refined / np.linalg.norm(refined))


def refine_projection(P: Array, W: Array, m: Array) -> Array:
    """Minimise Σ ‖m − π(P W̃)‖² over P (3, k), for normalised W̃ (n, k) and m (n, 2).

    P is a homography for points of a plane, k = 3, and the PPM for points in space, k = 4.
    """
    n, k = W.shape

    def linearise(p: Array) -> tuple[float, Array]:
        m_h = W @ p.reshape(3, k).T
        predicted = from_homogeneous.inside(m_h)
        J = np.zeros((n, 2, 3 * k + 1))
        J[:, 0, :k] = J[:, 1, k : 2 * k] = W / m_h[:, 2:]
        J[:, :, 2 * k : -1] = -predicted[:, :, None] * J[:, :1, :k]
        J[:, :, -1] = predicted - m
        J = J.reshape(2 * n, 3 * k + 1)
        system = J.T @ J
        cost = float(system[-1, -1])
        system[:-1, :-1] += np.outer(p, p)
        return cost, system

    def take_step(p: Array, step: Array) -> Array:
        return np.asarray((p + step) / np.linalg.norm(p + step))

    start = P.ravel() / np.linalg.norm(P)
    found = levenberg_marquardt(start, linearise, solve_dense, take_step, floor=1e-28 * n)
    return found.x.reshape(3, k)
