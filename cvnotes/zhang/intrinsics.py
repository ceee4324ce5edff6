"""A from b: by Cholesky, by the six formulas, or for the focal lengths alone."""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, DegenerateError, ShapeError, matrix, points
from cvnotes.zhang.b import B_COLUMNS, B_ROWS, constraints, rows_of, solve_b

_NOT_POSITIVE = (
    "B is not positive definite, so no camera fits: the noise is too high, or the views do not "
    "determine the camera (tilt the board by 30 to 45 degrees in different directions)"
)


def intrinsics_from_b(b: npt.ArrayLike) -> Array:
    """Give A (3, 3) from b (6,) by Cholesky: B = L Lᵀ and B ∝ A⁻ᵀ A⁻¹, so A ∝ L⁻ᵀ.

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
    try:
        L = np.linalg.cholesky(_B(b))
    except np.linalg.LinAlgError:
        raise DegenerateError(_NOT_POSITIVE) from None
    A = np.triu(np.linalg.inv(L).T)  # rounding leaves 1e-16 below the diagonal
    return np.asarray(A / A[2, 2])


def intrinsics_from_b_by_formulas(b: npt.ArrayLike) -> Array:
    """Give A (3, 3) from b (6,) by Zhang's six formulas; the same A as `intrinsics_from_b`.

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
    B11, B12, B22, B13, B23, B33 = _six(b).tolist()
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


def intrinsics_from_homographies(H: npt.ArrayLike, *, skew: bool = False) -> Array:
    """Give A (3, 3) from the homographies (n, 3, 3) of n views: V, then b, then A.

    Pixels far from the origin make V badly conditioned; `calibrate` hands over homographies
    into a picture scaled to about [−1, 1].

    Raises
    ------
    DegenerateError
        Fewer than 2 views (3 with skew), or views that do not determine A.

    Examples
    --------
    >>> A = np.array([[2.0, 0, 1], [0, 2, 1], [0, 0, 1]])
    >>> R = [[[1, 0, 0], [0, 0.8, 0], [0, 0.6, 5]], [[0.8, 0, 0], [0, 1, 0], [0.6, 0, 5]]]
    >>> intrinsics_from_homographies(A @ R).round(9) + 0.0
    array([[2., 0., 1.],
           [0., 2., 1.],
           [0., 0., 1.]])
    """
    return intrinsics_from_b(solve_b(constraints(H), skew=skew))


def focal_lengths_from_homographies(H: npt.ArrayLike, centre: npt.ArrayLike = (0, 0)) -> Array:
    """Give A (3, 3) when its piercing point is known and its skew is zero.

    With the pixels measured from `centre`, B = diag(1/α_u², 1/α_v², 1): the same constraints,
    two unknowns. Less is asked of the views, so this start survives noise that the full closed
    form does not.

    Raises
    ------
    DegenerateError
        The constraints have no solution with positive focal lengths.

    Examples
    --------
    >>> R = [[[1, 0, 0], [0, 0.8, 0], [0, 0.6, 5]], [[0.8, 0, 0], [0, 1, 0], [0.6, 0, 5]]]
    >>> focal_lengths_from_homographies(np.diag([2.0, 2, 1]) @ R).round(9)
    array([[2., 0., 0.],
           [0., 2., 0.],
           [0., 0., 1.]])
    """
    middle = points(centre, "centre", 2)
    if middle.ndim != 1:
        raise ShapeError(f"centre: expected one point (u0, v0), got {middle.shape}")
    u0, v0 = middle
    to_centre = np.array([[1, 0, -u0], [0, 1, -v0], [0, 0, 1]])
    alpha_u, alpha_v = focal_lengths_from_v(constraints(to_centre @ matrix(H, "H", 3, 3)))
    return np.array([[alpha_u, 0, u0], [0, alpha_v, v0], [0, 0, 1]])


def focal_lengths_from_v(V: npt.ArrayLike) -> tuple[float, float]:
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
    V = rows_of(V)
    B11, B22 = np.linalg.lstsq(V[:, [0, 2]], -V[:, 5], rcond=None)[0].tolist()
    if B11 <= 0 or B22 <= 0:
        raise DegenerateError(_NOT_POSITIVE)
    return B11**-0.5, B22**-0.5


def _six(b: npt.ArrayLike) -> Array:
    b = points(b, "b", 6)
    if b.ndim != 1:
        raise ShapeError(f"b: expected one vector (6,), got {b.shape}")
    return b


def _B(b: npt.ArrayLike) -> Array:
    B = np.zeros((3, 3))
    B[B_ROWS, B_COLUMNS] = B[B_COLUMNS, B_ROWS] = _six(b)
    return B
