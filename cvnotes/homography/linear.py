"""The direct linear transform: a homography from point pairs (notes 2b.4)."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, Points, guarded
from cvnotes.projective import to_homogeneous
from cvnotes.projective.points import apply_similarity, inverse_similarity, normaliser

Mask = npt.NDArray[np.bool_]

# Relative singular value, after normalisation, below which a rank is called deficient.
RANK = 1e-9
# The same of squared singular values, below which squares have too few digits.
_DOUBTFUL = 1e-3


@guarded(src=Points(2), dst=Points(2), pair=("src", "dst"))
def design_matrix(src: Array, dst: Array) -> Array:
    """Return D (..., 2n, 9) of D h = 0, two rows for each point pair, h = the rows of H stacked.

    m̃ × H W̃' = 0 has three rows for W̃' = (x, y, 1) and m = (u, v); the first two suffice:
    [0ᵀ, −W̃'ᵀ, v W̃'ᵀ] and [W̃'ᵀ, 0ᵀ, −u W̃'ᵀ]. The third is −u times the first minus v times the
    second.

    Examples
    --------
    >>> design_matrix([[1, 2]], [[3, 4]]).astype(int)
    array([[ 0,  0,  0, -1, -2, -1,  4,  8,  4],
           [ 1,  2,  1,  0,  0,  0, -3, -6, -3]])
    """
    W, u, v = to_homogeneous.inside(src), dst[..., :1], dst[..., 1:]
    *sets, n, _ = np.broadcast_shapes(src.shape, dst.shape)
    D = np.zeros((*sets, n, 2, 3, 3))
    D[..., 0, 1, :], D[..., 0, 2, :] = -W, v * W
    D[..., 1, 0, :], D[..., 1, 2, :] = W, -u * W
    return D.reshape(*sets, 2 * n, 9)


@guarded(src=Points(2), dst=Points(2), pair=("src", "dst"), at_least=4)
def dlt(src: Array, dst: Array) -> Array:
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

    It is not the most likely H of noisy points, which `refine_homography` finds from here, and one
    wrong pair carries it away: see `ransac_homography`.

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
    N1, N2 = normaliser.inside(src), normaliser.inside(dst)
    src, dst = apply_similarity(N1, src), apply_similarity(N2, dst)
    # DᵀD has D's right singular vectors, for less; where it has too few digits, D itself is
    # asked. (D = Q R, and as QᵀQ = I, the 9 × 9 of R has the same vectors as D.)
    squares, V = np.linalg.eigh(normal_matrix(src, dst))
    h, bad = V[..., 0], np.asarray(squares[..., 1] < _DOUBTFUL * squares[..., 8])
    if bad.any():
        D = design_matrix.inside(src, dst)
        _, s, Vt = np.linalg.svd(np.linalg.qr(D[bad], mode="r"))
        h[bad], bad[bad] = Vt[:, 8], s[:, 7] <= RANK * s[:, 0]
        refuse_sets(bad, src, dst)
    H = h.reshape(*h.shape[:-1], 3, 3)
    refuse_singular(H, src, dst)
    # Ĥ[2, 2] is the mean third coordinate of the points, whose centroid is the origin here.
    sign = np.where(H[..., 2, 2] < 0, -1.0, 1.0)[..., None, None]
    H = inverse_similarity(N2) @ H @ N1
    return np.asarray(H * (sign / np.sqrt((H * H).sum((-2, -1), keepdims=True))))


def normal_matrix(src: Array, dst: Array) -> Array:
    """Return DᵀD (..., 9, 9) of `design_matrix`, without making D.

    It is the sum of [1, 0, −u; 0, 1, −v; −u, −v, u² + v²] ⊗ W̃'W̃'ᵀ over the pairs.
    """
    W, u, v = to_homogeneous.inside(src), dst[..., 0], dst[..., 1]
    WW = (W[..., :, None] * W[..., None, :]).reshape(*W.shape[:-1], 9)
    one, none = np.ones_like(u), np.zeros_like(u)
    rows = np.stack([one, none, -u, none, one, -v, -u, -v, u * u + v * v], axis=-2)
    N = rows @ WW
    return np.asarray(N.reshape(*N.shape[:-2], 3, 3, 3, 3).swapaxes(-3, -2).reshape(N.shape))


def refuse_singular(H: Array, src: Array, dst: Array) -> None:
    """Refuse a normalised H that squeezes the plane onto a line: no two planes are related so."""
    # det is the product of the singular values, of which the largest is at most ‖H‖ = 1.
    bad = np.asarray(np.abs(np.linalg.det(H)) < 1e-4)
    if bad.any():
        s = np.linalg.svd(H[bad], compute_uv=False)
        bad[bad] = s[..., 2] <= RANK * s[..., 0]
        refuse_sets(bad, src, dst)


def refuse_sets(bad: Mask, src: Array, dst: Array) -> None:
    """Say in words which configuration keeps the first bad homography from being determined."""
    if not bad.any():
        return
    where = tuple(np.argwhere(bad)[0].tolist())
    src, dst = np.broadcast_arrays(src, dst)
    prefix = f"set {', '.join(map(str, where))}: " if where else ""
    for name, x in (("src", src[where]), ("dst", dst[where])):
        distinct = len(np.unique(x.round(9), axis=0))
        if distinct < 4:
            raise DegenerateError(
                f"{prefix}{name} has only {distinct} distinct points (duplicates); 4 are needed"
            )
        s = np.linalg.svd(x - x.mean(0), compute_uv=False)
        if s[1] <= RANK * s[0]:
            raise DegenerateError(
                f"{prefix}all points of {name} are collinear; move some off the line"
            )
    raise DegenerateError(
        f"{prefix}all but one of the points lie on a line (collinear), so they do not fix a "
        "homography; use four points of which no three are collinear"
    )
