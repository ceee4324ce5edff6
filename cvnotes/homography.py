"""Homographies between planes, from point pairs (notes 2b.4, "P as a Homography").

A plane Z = 0 is seen through columns 1, 2 and 4 of P, a 3×3 matrix H: dst ≈ H src. Estimators
take one set of points (n, 2) or a stack of sets (..., n, 2).
"""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import (
    Array,
    CvnotesError,
    DegenerateError,
    ShapeError,
    matrix,
    paired,
    points,
)
from cvnotes.optimise import levenberg_marquardt, solve_dense
from cvnotes.projective import drop, to_homogeneous

Mask = npt.NDArray[np.bool_]

# Relative singular value, after normalisation, below which a rank is called deficient.
_RANK = 1e-9
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
    return _normaliser(points(x, "x", 2))


def design_matrix(src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Give D (..., 2n, 9) of D h = 0, two rows for each point pair, h = the rows of H stacked.

    m̃ × H W̃' = 0 has three rows for W̃' = (x, y, 1) and m = (u, v); the first two suffice:
    [0ᵀ, −W̃'ᵀ, v W̃'ᵀ] and [W̃'ᵀ, 0ᵀ, −u W̃'ᵀ]. The third is −u times the first minus v times the
    second.

    Examples
    --------
    >>> design_matrix([[1, 2]], [[3, 4]]).astype(int)
    array([[ 0,  0,  0, -1, -2, -1,  4,  8,  4],
           [ 1,  2,  1,  0,  0,  0, -3, -6, -3]])
    """
    src, dst = points(src, "src", 2), points(dst, "dst", 2)
    paired(src, dst, ("src", "dst"), at_least=1)
    return _design_matrix(src, dst)


def dlt(src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Estimate H with dst ≈ H src by the direct linear transform.

    Parameters
    ----------
    src, dst : array_like, shape (..., n, 2)
        At least 4 point pairs; leading axes are independent problems. One `src` serves a whole
        stack of `dst`.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        H with ‖H‖ = 1 and the sign that gives the points a positive third coordinate, as points
        in front of a camera have.

    Raises
    ------
    DegenerateError
        Fewer than 4 points, coinciding points, or too many of them on one line.

    Notes
    -----
    Minimises the algebraic error ‖D h‖ with ‖h‖ = 1 in Hartley's normalised coordinates: h is
    the right singular vector of D of the smallest singular value, H = N₂⁻¹ Ĥ N₁. It needs no
    h9 ≠ 0.

    References
    ----------
    .. [1] Notes 2b.4, "Estimating H_i".
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), algorithm 4.2.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> H = dlt(square, [[10, 10], [30, 10], [30, 30], [10, 30]])
    >>> (H / H[2, 2]).round(9) + 0.0
    array([[20.,  0., 10.],
           [ 0., 20., 10.],
           [ 0.,  0.,  1.]])
    """
    src, dst = points(src, "src", 2), points(dst, "dst", 2)
    paired(src, dst, ("src", "dst"), at_least=4)
    N1, N2 = _normaliser(src), _normaliser(dst)
    src_n, dst_n = _similar(N1, src), _similar(N2, dst)
    h = _null_vector(src_n, dst_n)
    H = h.reshape(*h.shape[:-1], 3, 3)
    _refuse_singular(H, src_n, dst_n)
    # Ĥ[2, 2] is the mean third coordinate of the points, whose centroid is the origin here.
    sign = np.where(H[..., 2, 2] < 0, -1.0, 1.0)[..., None, None]
    H = _inverse_similarity(N2) @ H @ N1
    return np.asarray(H * (sign / np.sqrt((H * H).sum((-2, -1), keepdims=True))))


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
    if H.ndim > 2 or dst.ndim > 2:
        stack = np.broadcast_shapes(H.shape[:-2], src.shape[:-2], dst.shape[:-2])
        views = (np.broadcast_to(x, (*stack, *x.shape[-2:])) for x in (H, src, dst))
        refined = [_refine_one(*one) for one in zip(*(_flatten(x) for x in views), strict=True)]
        return np.stack(refined).reshape(*stack, 3, 3)
    return _refine_one(H, src, dst)


def four_points_h9_one(src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Solve the 4-point case with h9 = 1: eight equations in h1 … h8 (notes, first choice).

    Raises
    ------
    DegenerateError
        The 8×8 matrix is singular: three points on a line, or a true h9 of zero (erratum E27),
        which happens when the origin of `src` is seen at infinity.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> four_points_h9_one(square, [[5, 5], [7, 5], [7, 7], [5, 7]]).round(9) + 0.0
    array([[2., 0., 5.],
           [0., 2., 5.],
           [0., 0., 1.]])
    """
    return np.append(_eight_of_four(src, dst), 1.0).reshape(3, 3)


def four_points_unit_norm(src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Solve the 4-point case with ‖h‖ = 1: h9 = 1 / √(‖Ã⁻¹ A9‖² + 1) (notes, second choice).

    Fails where `four_points_h9_one` fails, for the same 8×8 matrix is solved (erratum E27).

    Raises
    ------
    DegenerateError
        The 8×8 matrix is singular.

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> float(np.linalg.norm(four_points_unit_norm(square, square)).round(12))
    1.0
    """
    h = _eight_of_four(src, dst)
    h9 = 1 / np.sqrt(h @ h + 1)
    return np.append(h9 * h, h9).reshape(3, 3)


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
    return np.asarray(np.linalg.norm(dst - drop(to_homogeneous(src) @ H.mT), axis=-1))


def _normaliser(x: Array) -> Array:
    if x.ndim < 2:
        raise ShapeError("x: expected several points (..., n, 2), got a single one")
    centre = x.sum(-2) / x.shape[-2]  # the method mean costs twice as much on few points
    d = x - centre[..., None, :]
    distance = np.hypot(d[..., 0], d[..., 1]).sum(-1) / x.shape[-2]
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


def _similar(N: Array, x: Array) -> Array:
    """Apply similarities without rotation to sets of points."""
    return np.asarray(N[..., 0, 0, None, None] * x + N[..., None, :2, 2])


def _inverse_similarity(N: Array) -> Array:
    inverse = np.zeros_like(N)
    inverse[..., 0, 0] = inverse[..., 1, 1] = 1 / N[..., 0, 0]
    inverse[..., :2, 2] = -N[..., :2, 2] / N[..., 0, 0, None]
    inverse[..., 2, 2] = 1
    return inverse


def _design_matrix(src: Array, dst: Array) -> Array:
    shape = np.broadcast_shapes(src.shape, dst.shape)
    D = np.zeros((*shape[:-1], 2, 9))
    D[..., 0, 3:5], D[..., 0, 5] = -src, -1
    D[..., 1, 0:2], D[..., 1, 2] = src, 1
    D[..., 0, 6:8] = dst[..., 1:] * src
    D[..., 1, 6:8] = -dst[..., :1] * src
    D[..., 0, 8], D[..., 1, 8] = dst[..., 1], -dst[..., 0]
    return D.reshape(*shape[:-2], 2 * shape[-2], 9)


def _null_vector(src: Array, dst: Array) -> Array:
    """Right singular vectors (..., 9) of D (..., 2n, 9) of its smallest singular values."""
    # The eigenvectors of DᵀD are the right singular vectors of D, at a fraction of the price and
    # with half of the digits; where those are needed, the SVD of D itself is taken.
    values, vectors = np.linalg.eigh(_normal_matrix(src, dst))
    h = vectors[..., 0]
    doubtful = values[..., 1] < 1e-5 * values[..., 8]
    if doubtful.any():
        D = _design_matrix(src, dst)[doubtful]
        _, s, Vt = np.linalg.svd(D, full_matrices=D.shape[-2] < 9)
        bad = s[..., 7] <= _RANK * s[..., 0]
        if bad.any():
            raise DegenerateError(_why_degenerate(src, dst, doubtful, bad))
        h[doubtful] = Vt[..., 8, :]
    return np.asarray(h)


def _normal_matrix(src: Array, dst: Array) -> Array:
    """DᵀD (..., 9, 9) from its blocks Σ W̃'W̃'ᵀ times 1, −u, −v and u² + v², without D."""
    W = np.concatenate([src, np.ones_like(src[..., :1])], axis=-1)
    WW = (W[..., :, None] * W[..., None, :]).reshape(*W.shape[:-1], 9)
    weights = np.ones((*dst.shape[:-2], 4, dst.shape[-2]))
    weights[..., 1:3, :] = -dst.mT
    weights[..., 3, :] = (dst * dst).sum(-1)
    blocks = weights @ WW
    N = np.zeros((*blocks.shape[:-2], 9, 9))
    blocks = blocks.reshape(*blocks.shape[:-1], 3, 3)
    N[..., 0:3, 0:3] = N[..., 3:6, 3:6] = blocks[..., 0, :, :]
    N[..., 0:3, 6:9] = N[..., 6:9, 0:3] = blocks[..., 1, :, :]
    N[..., 3:6, 6:9] = N[..., 6:9, 3:6] = blocks[..., 2, :, :]
    N[..., 6:9, 6:9] = blocks[..., 3, :, :]
    return N


def _refuse_singular(H: Array, src: Array, dst: Array) -> None:
    """Refuse a normalised H that squeezes the plane onto a line: no two planes are related so."""
    # det is the product of the singular values, of which the largest is at most ‖H‖ = 1.
    doubtful = np.abs(np.linalg.det(H)) < 1e-4
    if doubtful.any():
        s = np.linalg.svd(H[doubtful], compute_uv=False)
        bad = s[..., 2] <= _RANK * s[..., 0]
        if bad.any():
            raise DegenerateError(_why_degenerate(src, dst, doubtful, bad))


def _why_degenerate(src: Array, dst: Array, doubtful: Mask, bad: Mask) -> str:
    """Say in words which configuration keeps the first bad homography from being determined.

    `bad` has one entry for each set of points that is `doubtful`, which has one for every set.
    """
    where = tuple(np.argwhere(doubtful)[np.argmax(bad)].tolist())
    src, dst = np.broadcast_arrays(src, dst)
    prefix = f"set {', '.join(map(str, where))}: " if where else ""
    for name, x in (("src", src[where]), ("dst", dst[where])):
        distinct = len(np.unique(x.round(9), axis=0))
        if distinct < 4:
            return f"{prefix}{name} has only {distinct} distinct points (duplicates); 4 are needed"
        s = np.linalg.svd(x - x.mean(0), compute_uv=False)
        if s[1] <= _RANK * s[0]:
            return f"{prefix}all points of {name} are collinear; move some off the line"
    return (
        f"{prefix}all but one of the points lie on a line (collinear), so they do not fix a "
        "homography; use four points of which no three are collinear"
    )


def _flatten(x: Array) -> Array:
    return x.reshape(-1, *x.shape[-2:])


def _refine_one(H: Array, src: Array, dst: Array) -> Array:
    N1, N2 = _normaliser(src), _normaliser(dst)
    W, m = to_homogeneous(_similar(N1, src)), _similar(N2, dst)
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

    def move(h: Array, step: Array) -> Array:
        return np.asarray((h + step) / np.linalg.norm(h + step))

    start = N2 @ (H / (np.abs(H).max() or 1.0)) @ _inverse_similarity(N1)
    s = np.linalg.svd(start, compute_uv=False)
    if s[2] <= _RANK * s[0]:
        raise DegenerateError("H is singular: it maps the plane onto a line or a point")
    start = start.ravel() / np.linalg.norm(start)
    h = levenberg_marquardt(start, linearise, solve_dense, move, floor=1e-28 * n).x
    refined = _inverse_similarity(N2) @ h.reshape(3, 3) @ N1
    return np.asarray(refined / np.linalg.norm(refined))


def _eight_of_four(src: npt.ArrayLike, dst: npt.ArrayLike) -> Array:
    """Solve Ã h̃ = −A9 for h1 … h8, with h9 = 1."""
    src, dst = points(src, "src", 2), points(dst, "dst", 2)
    if src.shape != (4, 2) or dst.shape != (4, 2):
        raise ShapeError(f"the 4-point case takes (4, 2) and (4, 2), got {src.shape}, {dst.shape}")
    D = _design_matrix(src, dst)
    # Scale the columns so that the rank does not depend on the units.
    scale = np.linalg.norm(D, axis=0)
    s = np.linalg.svd(D[:, :8] / scale[:8], compute_uv=False)
    if s[7] <= 1e-12 * s[0]:
        raise DegenerateError(
            "the 8×8 system is singular: three of the four points lie on a line, or the true h9 "
            "is zero, which neither h9 = 1 nor its closed form can express; use dlt"
        )
    return np.asarray(np.linalg.solve(D[:, :8] / scale[:8], -D[:, 8]) / scale[:8])
