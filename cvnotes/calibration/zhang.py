"""Zhang's closed form: from homographies to b, A, the poses and the lens (notes 2b.4).

Each view constrains B = A⁻ᵀ A⁻¹ twice; b holds its six different entries.
"""

from functools import partial

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CvnotesError,
    DegenerateError,
    Matrix,
    Points,
    ShapeError,
    equally_many,
    guarded,
    intrinsic_matrix,
    matrix,
    numbers,
    points,
    rigid_motion,
    solved,
    whole,
)
from cvnotes.camera import nearest_rotation, skew_matrix, xy_from_px

# The six entries of b and where they stand in the symmetric B.
B_ROWS, B_COLUMNS = [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]
_NOT_POSITIVE = (
    "B is not positive definite, so no camera fits: the noise is too high, or the views do not "
    "determine the camera (tilt the board by 30 to 45 degrees in different directions)"
)


def homographies(x: npt.ArrayLike, name: str) -> Array:
    """Guard homographies (..., 3, 3), and scale each to a largest entry of 1."""
    H = matrix(x, name, 3, 3)
    largest = np.abs(H).max((-2, -1), keepdims=True)
    H = H / np.where(largest > 0, largest, 1)
    sizes = _column_lengths(H).prod(-1)
    bad = (np.abs(np.linalg.det(H)) <= 1e-12 * sizes) | (sizes == 0)
    if bad.any():
        raise DegenerateError(f"homography {int(np.argmax(bad))} is singular: it shows no plane")
    return H


def _column_lengths(H: Array) -> Array:
    return np.asarray(np.sqrt(np.vecdot(H.mT, H.mT)))


def _rows(x: npt.ArrayLike, name: str) -> Array:
    V = numbers(x, name)
    if V.ndim != 2 or V.shape[1] != 6:
        raise ShapeError(f"{name}: expected (2n, 6), got {V.shape}")
    return V


def _six(x: npt.ArrayLike, name: str) -> Array:
    b = points(x, name, 6)
    if b.ndim != 1:
        raise ShapeError(f"{name}: expected one vector (6,), got {b.shape}")
    return b


def _columns(i: int, j: int, **_: Array) -> None:
    if not all(isinstance(x, int | np.integer) and 1 <= x <= 3 for x in (i, j)):
        raise CvnotesError(f"i and j number the columns of H, 1 to 3; got {i!r} and {j!r}")


def _views(A: Array, G: Array, W: Array, m: Array, terms: int = 2) -> None:  # noqa: ARG001
    if 0 in equally_many("G, W and m", G.shape[:-2], W.shape[:-2], m.shape[:-2]):
        raise DegenerateError("need at least one view, got none")


@guarded(H=Matrix(3, 3), also=_columns)
def v_ij(H: Array, i: int, j: int) -> Array:
    """Return v_ij (..., 6) with h_iᵀ B h_j = v_ijᵀ b; i and j count columns of H from 1.

    Examples
    --------
    >>> v_ij([[1, 0, 0], [0, 2, 0], [0, 0, 1]], 1, 2)
    array([0., 2., 0., 0., 0., 0.])
    """
    a1, a2, a3 = (H[..., row, i - 1] for row in range(3))
    b1, b2, b3 = (H[..., row, j - 1] for row in range(3))
    v = [a1 * b1, a1 * b2 + a2 * b1, a2 * b2, a1 * b3 + a3 * b1, a2 * b3 + a3 * b2, a3 * b3]
    return np.stack(v, axis=-1)


@guarded(H=homographies)
def constraints(H: Array) -> Array:
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
    lengths = _column_lengths(H)
    H = H / np.sqrt(lengths[..., 0] * lengths[..., 1])[..., None, None]
    v_12, v_11, v_22 = v_ij.inside(H, 1, 2), v_ij.inside(H, 1, 1), v_ij.inside(H, 2, 2)
    return np.stack([v_12, v_11 - v_22], axis=-2).reshape(-1, 6)


@guarded(V=_rows)
def solve_b(V: Array, *, skew: bool = False) -> Array:
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


@guarded(b=_six)
def intrinsics_from_b(b: Array) -> Array:
    """Return A (3, 3) from b (6,) by Cholesky: B = L Lᵀ and B ∝ A⁻ᵀ A⁻¹, so A ∝ L⁻ᵀ.

    Raises
    ------
    DegenerateError
        B is not positive definite: too much noise, or views that do not determine it.

    Examples
    --------
    >>> intrinsics_from_b([1, 0, 1, -1, -1, 6]).round(9) + 0.0
    array([[2., 0., 1.],
           [0., 2., 1.],
           [0., 0., 1.]])
    """
    B = np.zeros((3, 3))
    B[B_ROWS, B_COLUMNS] = B[B_COLUMNS, B_ROWS] = b
    L = solved(np.linalg.cholesky, B, why=_NOT_POSITIVE)
    A = np.triu(np.linalg.inv(L).T)  # rounding leaves 1e-16 below the diagonal
    return np.asarray(A / A[2, 2])


@guarded(b=_six)
def intrinsics_from_b_by_formulas(b: Array) -> Array:
    """Return A (3, 3) from b (6,) by Zhang's six formulas; the same A as `intrinsics_from_b`.

    The notes leave them out (erratum E31). u0 = γ v0 / β − B13 α² / s, with β in the
    denominator; the α often printed there is wrong.

    Raises
    ------
    DegenerateError
        B is not positive definite.

    References
    ----------
    .. [1] Z. Zhang, PAMI 22 (2000) 1330-1334, appendix B.

    Examples
    --------
    >>> intrinsics_from_b_by_formulas([1, 0, 1, -1, -1, 6]) + 0.0
    array([[2., 0., 1.],
           [0., 2., 1.],
           [0., 0., 1.]])
    """
    B11, B12, B22, B13, B23, B33 = b.tolist()
    minor = B11 * B22 - B12**2
    if B11 <= 0 or minor <= 0:
        raise DegenerateError(_NOT_POSITIVE)
    v0 = (B12 * B13 - B11 * B23) / minor
    s = B33 - (B13**2 + v0 * (B12 * B13 - B11 * B23)) / B11
    if s <= 0:
        raise DegenerateError(_NOT_POSITIVE)
    alpha = np.sqrt(s / B11)
    beta = np.sqrt(s * B11 / minor)
    gamma = -B12 * alpha**2 * beta / s
    u0 = gamma * v0 / beta - B13 * alpha**2 / s
    return np.array([[alpha, gamma, u0], [0, beta, v0], [0, 0, 1]])


@guarded(V=_rows)
def focal_lengths_from_v(V: Array) -> tuple[float, float]:
    """Solve V b = 0 with b = (1/α_u², 0, 1/α_v², 0, 0, 1) for the two focal lengths.

    Raises
    ------
    DegenerateError
        They are not positive.

    Examples
    --------
    >>> focal_lengths_from_v([[4, 0, 0, 0, 0, -1], [0, 0, 9, 0, 0, -1]])
    (2.0, 3.0)
    """
    B11, B22 = np.linalg.lstsq(V[:, [0, 2]], -V[:, 5], rcond=None)[0].tolist()
    if B11 <= 0 or B22 <= 0:
        raise DegenerateError(_NOT_POSITIVE)
    return B11**-0.5, B22**-0.5


@guarded(A=intrinsic_matrix, H=homographies)
def extrinsics(A: Array, H: Array) -> Array:
    """Return the pose G (..., 4, 4) of each view, CRF ← board, from A and H (..., 3, 3).

    λ r1 = A⁻¹ h1 and λ r2 = A⁻¹ h2 with two sizes of λ when there is noise; their mean is
    taken (erratum E32), with the sign that puts the board in front of the camera (T_z > 0).
    r3 = r1 × r2, and the SVD gives the rotation nearest to [r1 r2 r3] (erratum E33).

    Raises
    ------
    DegenerateError
        A homography is singular.

    References
    ----------
    .. [1] Notes 2b.4, "Estimation of extrinsic parameters".

    Examples
    --------
    >>> extrinsics(np.eye(3), -7 * np.diag([1.0, 1, 2]))[:3, 3] + 0.0
    array([0., 0., 2.])
    """
    rays = np.linalg.inv(A) @ H  # λ [r1 r2 T]
    lengths = _column_lengths(rays)
    scale = (lengths[..., 0] + lengths[..., 1]) / 2
    scale = np.where(rays[..., 2, 2] < 0, -scale, scale)
    rays = rays / scale[..., None, None]
    r1, r2 = rays[..., :, 0], rays[..., :, 1]
    G = np.zeros((*H.shape[:-2], 4, 4))
    r3 = (skew_matrix.inside(r1) @ r2[..., None])[..., 0]
    G[..., :3, :3] = nearest_rotation.inside(np.stack([r1, r2, r3], axis=-1))
    G[..., :3, 3], G[..., 3, 3] = rays[..., :, 2], 1
    return G


@guarded(
    A=intrinsic_matrix,
    G=rigid_motion,
    W=Points(3),
    m=Points(2),
    terms=partial(whole, at_most=100),
    pair=("W", "m"),
    also=_views,
)
def radial_distortion(A: Array, G: Array, W: Array, m: Array, *, terms: int = 2) -> Array:
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
    M = W @ G[..., :3, :3].mT + G[..., None, :3, 3]
    if not (M[..., 2] > 0).all():
        raise DegenerateError("a board point does not lie in front of the camera")
    ideal = M[..., :2] / M[..., 2:]
    r2 = ideal[..., :1] ** 2 + ideal[..., 1:] ** 2
    d = xy_from_px.inside(A, m) - ideal
    D = np.empty((*d.shape, terms))
    power = ideal
    for i in range(terms):
        power = power * r2
        D[..., i] = power
    k, _, rank, _ = np.linalg.lstsq(D.reshape(-1, terms), d.ravel(), rcond=None)
    if rank < terms:
        raise DegenerateError(f"the points do not determine {terms} coefficients: vary the radius")
    return np.asarray(k)
