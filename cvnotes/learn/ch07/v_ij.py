"""One equation for B."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import v_ij as library_v_ij
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def v_ij(H: Array, i: int, j: int) -> Array:
    """Give v_ij (6,) of a homography (3, 3), columns numbered from 1."""
    return library_v_ij(H, int(i), int(j))


def _columns(rng: Rng) -> list[Case]:
    by_hand = np.array([[1.0, 2, 3], [4, 5, 6], [7, 8, 10]])
    other = rounded(rng.uniform(-4, 4, (3, 3)), 1)
    B = rng.uniform(-1, 1, (3, 3))
    pairs = [(by_hand, 1, 2), (by_hand, 1, 1), (other, 2, 2), (other, 1, 3), (other, 2, 1)]
    return [Case(pair, truth=B + B.T) for pair in pairs]


def _form(v: Array, case: Case) -> bool:
    """Tell whether v·b = h_iᵀ B h_j for some symmetric B."""
    H, i, j = case.args
    B = case.truth
    b = B[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]
    return bool(
        abs(v @ b - H[:, i - 1] @ B @ H[:, j - 1]) <= 1e-6 * case.slack * np.abs(H).max() ** 2
    )


def _outer(a: Array, b: Array) -> tuple[Array, Array]:
    """Give the products with the indices of b, and those with the indices exchanged."""
    rows, columns = [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]
    return a[rows] * b[columns], a[columns] * b[rows]


def _of(a: Array, b: Array) -> Array:
    return v_ij(np.column_stack([a, b, a]), 1, 2)


_MIXED = np.array([0.0, 1, 0, 1, 1, 0])


V_IJ = Exercise(
    name="v_ij",
    chapter=7,
    title="One equation for B",
    task="Give v_ij (6,) with h_iᵀ B h_j = v_ij·b for every symmetric B, where h_i is column i of "
    "H (3, 3), counted from 1, and b = (B11, B12, B22, B13, B23, B33).",
    stub='''def my_v_ij(H, i, j):
    """Give v_ij (6,) with h_iᵀ B h_j = v_ij·b; i and j count columns from 1."""
    ...''',
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
    misconceptions=(
        Misconception(
            "rows of H",
            "You took the rows of H. The DLT stacks rows, but here h_i is a column: "
            "H = λ A [r1 r2 T].",
            lambda H, i, j: v_ij(H.T, i, j),
        ),
        Misconception(
            "columns counted from 0",
            "h_1 is the first column, which Python calls 0: H[:, i - 1].",
            lambda H, i, j: v_ij(H, i + 1, j + 1) if max(i, j) < 3 else None,
        ),
        Misconception(
            "mixed products once",
            "B12 stands in B twice, at (1, 2) and at (2, 1), so that a1 b2 and a2 b1 both belong "
            "to it; you have one of them.",
            lambda H, i, j: _outer(H[:, i - 1], H[:, j - 1])[0],
        ),
        Misconception(
            "mixed products doubled",
            "You doubled a1 b2; the two products of B12 are a1 b2 and a2 b1, which differ for "
            "i ≠ j.",
            lambda H, i, j: _outer(H[:, i - 1], H[:, j - 1])[0] * (1 + _MIXED),
        ),
        Misconception(
            "another order of b",
            "Your v goes with (B11, B12, B13, B22, B23, B33). The notes' b has B22 before B13.",
            lambda H, i, j: v_ij(H, i, j)[[0, 1, 3, 2, 4, 5]],
        ),
        Misconception(
            "products of equal entries only",
            "You have a1 b1, a2 b2 and a3 b3 only: the mixed entries of B are missing.",
            lambda H, i, j: v_ij(H, i, j) * (1 - _MIXED),
        ),
        Misconception(
            "mixed products halved",
            (
                "B12 and B21 are one unknown, b has it once: its factor is a1 b2 + a2 b1, without "
                "a half."
            ),
            lambda H, i, j: v_ij(H, i, j) * (1 - _MIXED / 2),
        ),
        Misconception(
            "difference of the mixed products",
            "The two products of B12 add up: a1 b2 + a2 b1, with a plus.",
            lambda H, i, j: (
                np.subtract(*_outer(H[:, i - 1], H[:, j - 1])) + (1 - _MIXED) * v_ij(H, i, j)
            ),
            variants=(
                lambda H, i, j: (
                    -np.subtract(*_outer(H[:, i - 1], H[:, j - 1])) + (1 - _MIXED) * v_ij(H, i, j)
                ),
            ),
        ),
        Misconception(
            "column i alone",
            "You used column i twice; h_jᵀ is column j.",
            lambda H, i, j: v_ij(H, i, i),
        ),
        Misconception(
            "column j alone",
            "You used column j twice; h_i is column i.",
            lambda H, i, j: v_ij(H, j, j),
        ),
        Misconception(
            "the other mixed products",
            (
                "B12 stands in B twice, so that a1 b2 and a2 b1 both belong to it; you have a2 b1 "
                "only."
            ),
            lambda H, i, j: _outer(H[:, i - 1], H[:, j - 1])[1],
        ),
        Misconception(
            "columns counted from the last",
            "h_1 is H[:, 0]: you took i − 2, which Python counts from the end.",
            lambda H, i, j: v_ij(np.roll(H, 1, axis=1), i, j),
        ),
        Misconception(
            "nine products",
            "You have all nine products; B is symmetric, b has six entries: B12 and B21 are one "
            "unknown, and its two products add up.",
            lambda H, i, j: np.outer(H[:, i - 1], H[:, j - 1]).ravel(),
            variants=(lambda H, i, j: np.outer(H[:, i - 1], H[:, j - 1]),),
        ),
        Misconception(
            "three products",
            "You multiplied entry by entry: the mixed entries of B have their products too, six "
            "in all.",
            lambda H, i, j: H[:, i - 1] * H[:, j - 1],
        ),
        Misconception(
            "dot product",
            "That is h_i·h_j, a number, as if B were the identity.",
            lambda H, i, j: H[:, i - 1] @ H[:, j - 1],
        ),
        Misconception(
            "rows of H, counted from 0",
            "You took rows, and counted from 0: h_1 is H[:, 0].",
            lambda H, i, j: v_ij(H.T, i + 1, j + 1) if max(i, j) < 3 else None,
        ),
        Misconception(
            "one mixed product twice",
            "You repeated one of the mixed products: they belong to B12, B13 and B23, in this "
            "order.",
            lambda H, i, j: v_ij(H, i, j)[[0, 1, 2, 1, 4, 5]],
            variants=(lambda H, i, j: v_ij(H, i, j)[[0, 1, 2, 3, 3, 5]],),
        ),
        Misconception(
            "B13 and B23 exchanged",
            "b ends with B13, B23, B33: you have B23 before B13.",
            lambda H, i, j: v_ij(H, i, j)[[0, 1, 2, 4, 3, 5]],
        ),
        Misconception(
            "diagonal first",
            "Your v goes with (B11, B22, B33, B12, B13, B23); the notes' b is (B11, B12, B22, "
            "B13, B23, B33).",
            lambda H, i, j: v_ij(H, i, j)[[0, 2, 5, 1, 3, 4]],
            variants=(lambda H, i, j: v_ij(H, i, j)[[0, 2, 5, 1, 4, 3]],),
        ),
        Misconception(
            "row i and column j",
            "You took one row and one column: both are columns.",
            lambda H, i, j: _of(H[i - 1], H[:, j - 1]),
            variants=(lambda H, i, j: _of(H[:, i - 1], H[j - 1]),),
        ),
        Misconception(
            "everything doubled",
            "The squares a1 b1 stand once: only mixed entries of B have two products.",
            lambda H, i, j: v_ij(H, i, j) * (2 - _MIXED),
            variants=(lambda H, i, j: v_ij(H, i, j) * (1 + _MIXED),),
        ),
    ),
    reference=v_ij,
    concepts=("55", "57", "E23"),
    sources=(library_v_ij,),
)
