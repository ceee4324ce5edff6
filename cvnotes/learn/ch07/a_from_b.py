"""The camera in B."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.calibration import intrinsics_from_b
from cvnotes.learn.cases.cameras import some_intrinsics, without_skew
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def A_from_b(b: Array) -> Array:
    """Give A (3, 3) from b (6,) of any scale and sign."""
    return intrinsics_from_b(b * np.sign(b[0]))


def _b_of(A: Array, factor: float) -> Array:
    B = np.linalg.inv(A @ A.T) * factor
    return np.asarray(B[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]])


def _bs(rng: Rng) -> list[Case]:
    A = some_intrinsics(rng, skew=True)
    factor = float(rng.uniform(2, 9))
    by_hand = np.array([[2.0, 0.5, 1], [0, 4, 3], [0, 0, 1]])
    return [
        Case((_b_of(by_hand, 64.0),), truth=by_hand),
        Case((_b_of(A, factor),), truth=A),
        Case((_b_of(A, -factor),), truth=A, about="negative"),
    ]


def _B(b: Array) -> Array:
    B11, B12, B22, B13, B23, B33 = b
    return np.array([[B11, B12, B13], [B12, B22, B23], [B13, B23, B33]])


def _formulas(b: Array, *, wrong_u0: bool = False, scale: bool = True) -> Array:
    """Give A by Zhang's formulas, with one of the slips they are printed with."""
    B11, B12, B22, B13, B23, B33 = b
    v0 = (B12 * B13 - B11 * B23) / (B11 * B22 - B12**2)
    s = B33 - (B13**2 + v0 * (B12 * B13 - B11 * B23)) / B11 if scale else 1.0
    alpha, beta = np.sqrt(s / B11), np.sqrt(s * B11 / (B11 * B22 - B12**2))
    gamma = -B12 * alpha**2 * beta / s
    u0 = gamma * v0 / (alpha if wrong_u0 else beta) - B13 * alpha**2 / s
    return np.array([[alpha, gamma, u0], [0, beta, v0], [0, 0, 1]])


def _last_one(M: npt.ArrayLike) -> Array:
    M = np.asarray(M, dtype=float)
    return np.asarray(M / M[2, 2])


def _without_skew(b: Array) -> Array:
    A = A_from_b(b)
    s = b[5] - (b[3] ** 2 + A[1, 2] * (b[1] * b[3] - b[0] * b[4])) / b[0]
    A[0, 1], A[0, 2] = 0.0, -b[3] * A[0, 0] ** 2 / s
    return A


def _solved(b: Array) -> Array | None:
    """Factorise as A_from_b does; None where that cannot be."""
    B = _B(b)
    B = B * np.sign(B[0, 0])
    if not (np.linalg.eigvalsh(B) > 0).all():
        return None
    return _last_one(np.linalg.inv(np.linalg.cholesky(B)).T)


def _exchanged_centre(A: Array) -> Array:
    A[:2, 2] = A[[1, 0], 2]
    return A


def _from_quotients(b: Array) -> Array:
    alpha, beta = np.sqrt(np.abs(b[5] / b[[0, 2]]))
    return np.array([[alpha, 0, -b[3] / b[0]], [0, beta, -b[4] / b[2]], [0, 0, 1]])


def _simple_centre(b: Array) -> Array:
    A = A_from_b(b)
    A[:2, 2] = -b[3] / b[0], -b[4] / b[2]
    return A


A_FROM_B = Exercise(
    name="A_from_b",
    chapter=7,
    title="The camera in B",
    task="Give A (3, 3), with skew, from b = (B11, B12, B22, B13, B23, B33) of any scale and sign, "
    "where B ∝ A⁻ᵀ A⁻¹. The last entry of A is 1.",
    stub='''def my_A_from_b(b):
    """Give A (3, 3) from b (6,), of any scale and sign."""
    ...''',
    hints=(
        "Write B as a matrix first, and give it the sign that makes B11 positive.",
        "np.linalg.cholesky gives L, lower triangular, with B = L Lᵀ. Compare with A⁻ᵀ A⁻¹.",
        "So A⁻ᵀ is L up to scale, and A = (L⁻¹)ᵀ, divided by its last entry.",
    ),
    cases=_bs,
    properties=(
        Property(
            "A is the camera that b was made of.",
            lambda A, c: np.allclose(
                A, c.truth, rtol=1e-6 * c.slack, atol=1e-6 * c.slack * np.abs(c.truth).max()
            ),
        ),
        Property("The sign of b does not matter.", about="negative"),
    ),
    misconceptions=(
        Misconception(
            "last entry not 1",
            "Your A is right up to scale: b has an unknown scale, so divide A by its last entry.",
            lambda b: np.linalg.inv(np.linalg.cholesky(_B(b))).T if b[0] > 0 else None,
        ),
        Misconception(
            "transposed",
            "Your A is lower triangular. From B = L Lᵀ and B = A⁻ᵀ A⁻¹ follows L = A⁻ᵀ, so A is "
            "the transpose of L⁻¹.",
            lambda b: A_from_b(b).T,
            variants=(lambda b: np.linalg.inv(np.linalg.cholesky(_B(b * np.sign(b[0])))),),
        ),
        Misconception(
            "inverse forgotten",
            "You gave the factor of B itself. B is made of A⁻¹: invert.",
            lambda b: _last_one(np.linalg.cholesky(_B(b)).T) if b[0] > 0 else None,
        ),
        Misconception(
            "u0 with α for β",
            "All but u0 is right: u0 = γ v0 / β − B13 α² / s. An α in place of the β is often "
            "printed.",
            lambda b: _formulas(b, wrong_u0=True),
        ),
        Misconception(
            "scale taken for 1",
            "B11 = 1/α_u² holds only if b has the scale of A⁻ᵀ A⁻¹; its scale is unknown and has "
            "to be found first (s, or λ, in the formulas).",
            lambda b: _formulas(b, scale=False) if b[0] > 0 else None,
        ),
        Misconception(
            "sign taken for positive",
            "Right for a b with B11 > 0. A null vector comes with either sign; multiply b by that "
            "of B11.",
            lambda b: A_from_b(b) if b[0] > 0 else None,
        ),
        Misconception(
            "skew left out",
            "All but the skew is as it should be, and u0 suffers from it: γ = −B12 α² β / s.",
            _without_skew,
        ),
        Misconception(
            "inverse before the factorisation",
            (
                "B⁻¹ ∝ A Aᵀ, but Cholesky gives a lower triangular factor of it, and A is upper "
                "triangular: factorise B, then invert."
            ),
            lambda b: _last_one(np.linalg.cholesky(np.linalg.inv(_B(b)))) if b[0] > 0 else None,
            variants=(
                lambda b: (
                    _last_one(np.linalg.cholesky(np.linalg.inv(_B(b))).T) if b[0] > 0 else None
                ),
            ),
        ),
        Misconception(
            "skew for 0",
            "All but the skew is right, which you have set to 0: γ = −B12 α² β / s.",
            lambda b: without_skew(A_from_b(b)),
        ),
        Misconception(
            "sign of the skew",
            "All but the sign of the skew is right: γ = −B12 α² β / s, with a minus.",
            lambda b: A_from_b(b) * [[1, -1, 1], [1, 1, 1], [1, 1, 1]],
        ),
        Misconception(
            "roots forgotten",
            "You have α² and β²: take the roots.",
            lambda b: A_from_b(b) ** np.array([[2, 1, 1], [1, 2, 1], [1, 1, 1]]),
        ),
        Misconception(
            "the inverse", "That is A⁻¹: B = A⁻ᵀ A⁻¹.", lambda b: np.linalg.inv(A_from_b(b))
        ),
        Misconception(
            "B13 and B23 exchanged",
            "You filled B in another order: b = (B11, B12, B22, B13, B23, B33).",
            lambda b: _solved(b[[0, 1, 2, 4, 3, 5]]),
        ),
        Misconception(
            "A Aᵀ",
            "That is A Aᵀ = B⁻¹, up to scale: it has to be factorised.",
            lambda b: _last_one(np.linalg.inv(_B(b))),
            variants=(
                lambda b: np.linalg.inv(_B(b)),
                lambda b: np.linalg.inv(_B(b * np.sign(b[0]))),
            ),
        ),
        Misconception(
            "B itself",
            "That is B; A is in its factors.",
            lambda b: _last_one(_B(b)),
            variants=(lambda b: _B(b),),
        ),
        Misconception(
            "last entry not 1, any sign",
            "Right up to scale, for either sign of b: divide A by its last entry.",
            lambda b: np.linalg.inv(np.linalg.cholesky(_B(b * np.sign(b[0])))).T,
        ),
        Misconception(
            "divided by the first entry",
            "You divided A by its first entry; it is the last one that is 1.",
            lambda b: A_from_b(b) / A_from_b(b)[0, 0],
        ),
        Misconception(
            "the inverse transposed",
            "That is A⁻ᵀ, the factor of B.",
            lambda b: np.linalg.inv(A_from_b(b)).T,
            variants=(lambda b: _last_one(np.linalg.cholesky(_B(b * np.sign(b[0])))),),
        ),
        Misconception(
            "B not symmetric",
            "You left the lower triangle of B at 0: B is symmetric, B21 = B12.",
            lambda b: _last_one(np.linalg.inv(np.triu(_B(b)))),
            variants=(lambda b: _last_one(np.linalg.inv(np.triu(_B(b))).T),),
        ),
        Misconception(
            "one focal length for both",
            "You took one focal length for both directions: α_v follows from B22 as well.",
            lambda b: (
                A_from_b(b) * [[1, 1, 1], [1, 0, 1], [1, 1, 1]] + np.diag([0, A_from_b(b)[0, 0], 0])
            ),
            variants=(
                lambda b: (
                    A_from_b(b) * [[0, 1, 1], [1, 1, 1], [1, 1, 1]]
                    + np.diag([A_from_b(b)[1, 1], 0, 0])
                ),
            ),
        ),
        Misconception(
            "u0 and v0 exchanged",
            "u0 and v0 are exchanged: u0 = A[0, 2].",
            lambda b: _exchanged_centre(A_from_b(b)),
        ),
        Misconception(
            "α_u and α_v exchanged",
            "α_u and α_v are exchanged: α_u = A[0, 0].",
            lambda b: (
                A_from_b(b) * (1 - np.diag([1, 1, 0]))
                + np.diag([A_from_b(b)[1, 1], A_from_b(b)[0, 0], 0])
            ),
        ),
        Misconception(
            "u0 without the skew",
            "All but u0 is right: u0 = γ v0 / β − B13 α² / s; you left out γ v0 / β.",
            lambda b: (
                A_from_b(b)
                - [
                    [0, 0, A_from_b(b)[0, 1] * A_from_b(b)[1, 2] / A_from_b(b)[1, 1]],
                    [0, 0, 0],
                    [0, 0, 0],
                ]
            ),
        ),
        Misconception(
            "centre of a camera without skew",
            "You took u0 = −B13/B11 and v0 = −B23/B22, which holds without skew only: B12 mixes "
            "both.",
            lambda b: _simple_centre(b),
        ),
        Misconception(
            "the numbers, not the matrix",
            "Asked is the matrix A (3, 3).",
            lambda b: A_from_b(b)[[0, 1, 0, 1], [0, 1, 2, 2]],
            variants=(lambda b: A_from_b(b)[[0, 1, 0, 1, 0], [0, 1, 2, 2, 1]],),
        ),
        Misconception(
            "α² = B33 / B11",
            "B33 is not 1 / s: it has u0² / α_u² and v0² / α_v² in it, too. Find the scale first.",
            lambda b: _from_quotients(b),
        ),
    ),
    reference=A_from_b,
    concepts=("56", "59", "E28", "E31"),
    sources=(intrinsics_from_b,),
)
