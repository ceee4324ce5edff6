"""The camera in B."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.calibration import intrinsics_from_b, intrinsics_from_b_by_formulas
from cvnotes.learn.cases.cameras import some_intrinsics
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _b_of(A: Array, factor: float) -> Array:
    B = np.linalg.inv(A @ A.T) * factor
    return np.asarray(B[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]])


def _bs(rng: np.random.Generator) -> list[Case]:
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


def _last_one(M: npt.ArrayLike) -> Array:
    M = np.asarray(M, dtype=float)
    return np.asarray(M / M[2, 2])


def A_from_b(b: Array) -> Array:
    """Return A (3, 3) from b (6,), of any scale and sign."""
    B11, B12, B22, B13, B23, B33 = b * np.sign(b[0])  # the entries of B, with B11 positive
    D = B11 * B22 - B12**2  # the minor B11 B22 − B12²
    v0 = (B12 * B13 - B11 * B23) / D  # v0
    s = B33 - (B13**2 + v0 * (B12 * B13 - B11 * B23)) / B11  # the scale λ of B
    au = np.sqrt(s / B11)  # α_u
    av = np.sqrt(s * B11 / D)  # α_v
    g = -B12 * au**2 * av / s  # the skew γ
    u0 = g * v0 / av - B13 * au**2 / s  # u0
    return np.array([[au, g, u0], [0, av, v0], [0, 0, 1]])


_MISTAKES = mistakes_in(A_from_b,
    ("last entry not 1", "Your A is right up to its scale, or lower triangular: which factor of B "
     "is it, and which of its entries is known?",
     "np.linalg.inv(np.linalg.cholesky(_B(b))).T if b[0] > 0 else None",
     "np.linalg.inv(np.linalg.cholesky(_B(b * np.sign(b[0])))).T",
     "np.linalg.inv(np.linalg.cholesky(_B(b * np.sign(b[0]))))"),
    ("inverse forgotten", "You gave the factor of B itself; what is B made of?",
     "_last_one(np.linalg.cholesky(_B(b)).T) if b[0] > 0 else None"),
    ("inverse before the factorisation", "You inverted B first, and Cholesky gives a lower "
     "triangular factor of that; A is upper triangular.",
     "_last_one(np.linalg.cholesky(np.linalg.inv(_B(b)))) if b[0] > 0 else None",
     "_last_one(np.linalg.cholesky(np.linalg.inv(_B(b))).T) if b[0] > 0 else None"),
    ("scale taken for 1", "You took 1 for the scale of b; it has to be found first.",
     ("s = B33 - (B13**2 + v0 * (B12 * B13 - B11 * B23)) / B11", "s = 1", "b * np.sign(b[0])", "b"),
     ("s = B33 - (B13**2 + v0 * (B12 * B13 - B11 * B23)) / B11", "s = 1")),
    ("sign taken for positive", "Right for a b with B11 > 0. A null vector comes with either sign.",
     lambda b: A_from_b(b) if b[0] > 0 else None),
    ("skew left out", "All but the skew is as it should be, and u0 suffers from it.",
     ("g = -B12 * au**2 * av / s", "g = 0")),
    ("A Aᵀ", "That is A Aᵀ, up to scale: it has to be factorised.",
     "_last_one(np.linalg.inv(_B(b)))", "np.linalg.inv(_B(b))",
     "np.linalg.inv(_B(b * np.sign(b[0])))"),
    ("B itself", "That is B; A is in its factors.",
     "_last_one(_B(b))", _B),
)  # fmt: skip

EXERCISE = Exercise(
    name="A_from_b",
    chapter=7,
    title="The camera in B",
    task="Give A (3, 3), with skew, from b = (B11, B12, B22, B13, B23, B33) of any scale and sign, "
    "where B ∝ A⁻ᵀ A⁻¹. The last entry of A is 1.",
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
    misconceptions=_MISTAKES,
    steps=A_from_b,
    concepts=("56", "59", "b", "E28", "E31"),
    sources=(intrinsics_from_b, intrinsics_from_b_by_formulas),
)
