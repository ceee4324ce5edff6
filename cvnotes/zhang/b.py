"""The constraints of each view on B = A⁻ᵀ A⁻¹, and the b that satisfies them."""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, CvnotesError, DegenerateError, ShapeError, matrix, numbers

# The six entries of b and where they stand in the symmetric B.
B_ROWS, B_COLUMNS = [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]
# The duplication matrix (9, 6): all nine entries of B, row by row, are D b.
_DUPLICATION = np.zeros((3, 3, 6))
_DUPLICATION[B_ROWS, B_COLUMNS, range(6)] = _DUPLICATION[B_COLUMNS, B_ROWS, range(6)] = 1
_DUPLICATION = _DUPLICATION.reshape(9, 6)


def v_ij(H: npt.ArrayLike, i: int, j: int) -> Array:
    """Give v_ij (..., 6) with h_iᵀ B h_j = v_ijᵀ b; i and j count columns of H from 1.

    Examples
    --------
    >>> v_ij([[1, 0, 0], [0, 2, 0], [0, 0, 1]], 1, 2)
    array([0., 2., 0., 0., 0., 0.])
    """
    H = matrix(H, "H", 3, 3)
    if i not in (1, 2, 3) or j not in (1, 2, 3):
        raise CvnotesError(f"i and j number the columns of H, 1 to 3; got {i} and {j}")
    return _v(H[..., :, i - 1], H[..., :, j - 1])


def constraints(H: npt.ArrayLike) -> Array:
    """Stack the two constraints of each view to V (2n, 6): v_12ᵀ b = 0, (v_11 − v_22)ᵀ b = 0.

    Each H is first scaled to ‖h1‖ ‖h2‖ = 1, so that its arbitrary scale gives it no weight.

    Raises
    ------
    DegenerateError
        A homography is singular; the message gives its index.

    Examples
    --------
    >>> constraints(np.eye(3)[None])
    array([[ 0.,  1.,  0.,  0.,  0.,  0.],
           [ 1.,  0., -1.,  0.,  0.,  0.]])
    """
    return constraint_rows(scaled(matrix(H, "H", 3, 3)).reshape(-1, 3, 3))


def solve_b(V: npt.ArrayLike, *, skew: bool = False) -> Array:
    """Solve V b = 0 with ‖b‖ = 1 and the sign that makes B positive: b (6,).

    b = (B11, B12, B22, B13, B23, B33). With ``skew=False``, B12 = 0 is imposed by leaving its
    column out; then two views suffice (erratum E29), otherwise three are needed.

    Raises
    ------
    DegenerateError
        Too few views, or views that do not determine b (parallel or repeated boards).

    References
    ----------
    .. [1] Notes 2b.4, "Estimation of intrinsic parameters".

    Examples
    --------
    >>> A = np.array([[2.0, 0, 1], [0, 2, 1], [0, 0, 1]])
    >>> R = [[[1, 0, 0], [0, 0.8, 0], [0, 0.6, 5]], [[0.8, 0, 0], [0, 1, 0], [0.6, 0, 5]]]
    >>> (solve_b(constraints(A @ R)) * 2 * np.sqrt(10)).round(9) + 0.0
    array([ 1.,  0.,  1., -1., -1.,  6.])
    """
    V = rows_of(V)
    kept = [0, 1, 2, 3, 4, 5] if skew else [0, 2, 3, 4, 5]
    needed = 3 if skew else 2
    if len(V) < 2 * needed:
        raise DegenerateError(
            f"need at least {needed} views {'with' if skew else 'without'} skew, got {len(V) // 2}"
        )
    # Two views without skew have four rows: the null vector is then in no thin decomposition.
    _, s, Vt = np.linalg.svd(V[:, kept], full_matrices=len(V) < len(kept))
    if s[len(kept) - 2] <= 1e-9 * s[0]:
        raise DegenerateError(
            "rank of V too low: the views do not determine the camera, because their boards are "
            "parallel or repeated; tilt the board by 30 to 45 degrees in different directions"
        )
    b = np.zeros(6)
    b[kept] = Vt[-1]
    return np.asarray(b if b[0] > 0 else -b) + 0.0


def constraint_rows(H: Array) -> Array:
    """Give V (2n, 6) of homographies (n, 3, 3), without a guard: for use inside."""
    lengths = _column_lengths(H)
    scale = np.sqrt(lengths[:, 0] * lengths[:, 1])[:, None]
    h1, h2 = H[:, :, 0] / scale, H[:, :, 1] / scale
    V = np.stack([_v(h1, h2), _v(h1, h1) - _v(h2, h2)], axis=1)
    return V.reshape(-1, 6)


def _v(a: Array, b: Array) -> Array:
    """Give v (..., 6) with aᵀ B b = vᵀ b, for columns a and b (..., 3)."""
    products = a[..., :, None] * b[..., None, :]  # aᵀ B b = Σ B_ij a_i b_j
    return np.asarray(products.reshape(*a.shape[:-1], 9) @ _DUPLICATION)


def rows_of(V: npt.ArrayLike) -> Array:
    """Guard V (2n, 6)."""
    V = numbers(V, "V")
    if V.ndim != 2 or V.shape[1] != 6:
        raise ShapeError(f"V: expected (2n, 6), got {V.shape}")
    return V


def scaled(H: Array) -> Array:
    """Scale each homography (..., 3, 3) to a largest entry of 1, and name one that is singular."""
    largest = np.abs(H).max((-2, -1), keepdims=True)
    H = H / np.where(largest > 0, largest, 1)
    sizes = _column_lengths(H).prod(-1)
    bad = (np.abs(np.linalg.det(H)) <= 1e-12 * sizes) | (sizes == 0)
    if bad.any():
        raise DegenerateError(f"homography {int(np.argmax(bad))} is singular: it shows no plane")
    return H


def _column_lengths(H: Array) -> Array:
    return np.asarray(np.sqrt(np.vecdot(H.mT, H.mT)))
