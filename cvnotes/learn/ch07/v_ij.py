"""One equation for B."""

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import v_ij as library_v_ij
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, edited, mistakes_in


def _columns(rng: np.random.Generator) -> list[Case]:
    by_hand = np.array([[1.0, 2, 3], [4, 5, 6], [7, 8, 10]])
    other = rounded(rng.uniform(-4, 4, (3, 3)), 1)
    B = rng.uniform(-1, 1, (3, 3))
    pairs = [(by_hand, 1, 2), (by_hand, 1, 1), (other, 2, 2), (other, 1, 3), (other, 2, 1)]
    return [Case(pair, truth=B + B.T) for pair in pairs]


def _form(v: Array, case: Case) -> bool:
    """Return whether v·b = h_iᵀ B h_j for some symmetric B."""
    H, i, j = case.args
    B = case.truth
    b = B[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]
    return bool(
        abs(v @ b - H[:, i - 1] @ B @ H[:, j - 1]) <= 1e-6 * case.slack * np.abs(H).max() ** 2
    )


def v_ij(H: Array, i: int, j: int) -> Array:
    """Return v_ij (6,) with h_iᵀ B h_j = v_ij·b; i and j count columns from 1."""
    a, b = H[:, i - 1], H[:, j - 1]
    b12 = a[0] * b[1] + a[1] * b[0]  # what belongs to B12
    b13 = a[0] * b[2] + a[2] * b[0]  # what belongs to B13
    b23 = a[1] * b[2] + a[2] * b[1]  # what belongs to B23
    return np.array([a[0] * b[0], b12, a[1] * b[1], b13, b23, a[2] * b[2]])


_MISTAKES = mistakes_in(v_ij,
    ("columns counted from 0", "Python counts columns from 0, this exercise from 1.",
     ("i - 1], H[:, j - 1]", "i], H[:, j]")),
    ("mixed products once", "B12 stands in B twice: two products belong to it, you have one.",
     (" + a[1] * b[0]", "", " + a[2] * b[0]", "", " + a[2] * b[1]", ""),
     ("a[0] * b[1] + ", "", "a[0] * b[2] + ", "", "a[1] * b[2] + ", "")),
    ("mixed products doubled", "You doubled one product; the two of B12 differ if i and j do.",
     ("+ a[1] * b[0]", "+ a[0] * b[1]", "+ a[2] * b[0]", "+ a[0] * b[2]", "+ a[2] * b[1]",
      "+ a[1] * b[2]")),
    ("mixed products halved", "B12 and B21 are one unknown, and b has it once: why a half?",
     ("b12, ", "b12 / 2, ", "b13, b23,", "b13 / 2, b23 / 2,")),
    ("difference of the mixed products", "You subtracted the two products that belong to B12.",
     ("] + a", "] - a"), lambda H, i, j: edited(v_ij, "] + a", "] - a")(H, j, i)),
    ("products of equal entries only", "The mixed entries of B are missing.",
     ("b12, ", "0, ", "b13, b23,", "0, 0,")),
    ("everything doubled", "Mixed entries of B have two products; how many has B11?",
     ("a[0] * b[0]", "2 * a[0] * b[0]", "a[1] * b[1]", "2 * a[1] * b[1]", "a[2] * b[2]",
      "2 * a[2] * b[2]"), ("b12, ", "2 * b12, ", "b13, b23,", "2 * b13, 2 * b23,")),
)  # fmt: skip

EXERCISE = Exercise(
    name="v_ij",
    chapter=7,
    title="One equation for B",
    task="Give v_ij (6,) with h_iᵀ B h_j = v_ij·b for every symmetric B, where h_i is column i of "
    "H (3, 3), counted from 1, and b = (B11, B12, B22, B13, B23, B33).",
    hints=(
        "h_i = H[:, i - 1]: a column, and Python counts from 0.",
        "Multiply h_iᵀ B h_j out; B12 and B21 are one unknown, so its two products add up.",
        "v = (a1 b1, a1 b2 + a2 b1, a2 b2, a1 b3 + a3 b1, a2 b3 + a3 b2, a3 b3).",
    ),
    cases=_columns,
    properties=(
        Property("v_ij·b = h_iᵀ B h_j for a random symmetric B.", _form),
        Property("That is so for every symmetric B."),
    ),
    misconceptions=_MISTAKES,
    steps=v_ij,
    concepts=("55", "57", "E23"),
    sources=(library_v_ij,),
)
