"""Hartley's normalisation: points of about unit size around the origin."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, DegenerateError, ShapeError, paired, points

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


Mask = npt.NDArray[np.bool_]

# Relative singular value, after normalisation, below which a rank is called deficient.
RANK = 1e-9


def refuse_singular(H: Array, src: Array, dst: Array) -> None:
    """Refuse a normalised H that squeezes the plane onto a line: no two planes are related so."""
    # det is the product of the singular values, of which the largest is at most ‖H‖ = 1.
    doubtful = np.abs(np.linalg.det(H)) < 1e-4
    if doubtful.any():
        s = np.linalg.svd(H[doubtful], compute_uv=False)
        bad = s[..., 2] <= RANK * s[..., 0]
        if bad.any():
            raise DegenerateError(why_degenerate(src, dst, doubtful, bad))


def why_degenerate(src: Array, dst: Array, doubtful: Mask, bad: Mask) -> str:
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
        if s[1] <= RANK * s[0]:
            return f"{prefix}all points of {name} are collinear; move some off the line"
    return (
        f"{prefix}all but one of the points lie on a line (collinear), so they do not fix a "
        "homography; use four points of which no three are collinear"
    )


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
    N1, N2 = normaliser_of(src), normaliser_of(dst)
    src_n, dst_n = apply_similarity(N1, src), apply_similarity(N2, dst)
    h = _null_vector(src_n, dst_n)
    H = h.reshape(*h.shape[:-1], 3, 3)
    refuse_singular(H, src_n, dst_n)
    # Ĥ[2, 2] is the mean third coordinate of the points, whose centroid is the origin here.
    sign = np.where(H[..., 2, 2] < 0, -1.0, 1.0)[..., None, None]
    H = inverse_similarity(N2) @ H @ N1
    return np.asarray(H * (sign / np.sqrt((H * H).sum((-2, -1), keepdims=True))))


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
        bad = s[..., 7] <= RANK * s[..., 0]
        if bad.any():
            raise DegenerateError(why_degenerate(src, dst, doubtful, bad))
        h[doubtful] = Vt[..., 8, :]
    return np.asarray(h)


def _normal_matrix(src: Array, dst: Array) -> Array:
    """DᵀD (..., 9, 9) from its blocks Σ W̃'W̃'ᵀ times 1, −u, −v and u² + v², without D."""
    W = np.concatenate([src, np.ones_like(src[..., :1])], axis=-1)
    WW = (W[..., :, None] * W[..., None, :]).reshape(*W.shape[:-1], 9)
    weights = np.ones((*dst.shape[:-2], 4, dst.shape[-2]))
    weights[..., 1:3, :] = -dst.mT
    weights[..., 3, :] = dst[..., 0] ** 2 + dst[..., 1] ** 2
    blocks = weights @ WW
    N = np.zeros((*blocks.shape[:-2], 9, 9))
    blocks = blocks.reshape(*blocks.shape[:-1], 3, 3)
    N[..., 0:3, 0:3] = N[..., 3:6, 3:6] = blocks[..., 0, :, :]
    N[..., 0:3, 6:9] = N[..., 6:9, 0:3] = blocks[..., 1, :, :]
    N[..., 3:6, 6:9] = N[..., 6:9, 3:6] = blocks[..., 2, :, :]
    N[..., 6:9, 6:9] = blocks[..., 3, :, :]
    return N
