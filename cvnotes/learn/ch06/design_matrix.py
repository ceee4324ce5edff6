"""The rows of the DLT."""

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import design_matrix
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import to_homogeneous


def _pairs(rng: Rng) -> list[Case]:
    src, dst = rounded(rng.uniform(0, 9, (3, 2)), 1), rounded(rng.uniform(2, 30, (3, 2)), 1)
    return [Case((np.array([[1.0, 2.0]]), np.array([[3.0, 4.0]]))), Case((src, dst))]


def same_row_space(a: Array, b: Array, tolerance: float) -> bool:
    """Tell whether two systems have the same solutions: their rows span the same space."""
    if a.shape != b.shape:
        return False
    scale = np.abs(b).max(axis=0) + 1e-9
    spaces = []
    for x in (a / scale, b / scale):
        if not np.isfinite(x).all():  # in what was given, or where it is too large
            return False
        _, s, Vt = np.linalg.svd(x, full_matrices=False)
        Vt = Vt[s > 1e-9 * s[0]]
        spaces.append(Vt.T @ Vt)
    return bool(np.abs(spaces[0] - spaces[1]).max() <= 10 * tolerance)


def _design(src: Array, dst: Array, lift: float = 1.0, last: float = 1.0) -> Array:
    """Give the design matrix, with a factor on its last block and another 1 in the points."""
    D = design_matrix(src, dst)
    D[:, 6:] *= last
    D[:, [2, 5, 8]] *= lift
    return D


def _affine_rows(src: Array, dst: Array) -> Array:
    D = design_matrix(src, dst)
    D[:, 6:8] = 0
    return D


def _third_rows(src: Array, dst: Array) -> Array:
    W = to_homogeneous(src)
    return np.hstack([-dst[:, 1:] * W, dst[:, :1] * W, 0 * W])


def _affine_last(src: Array, dst: Array) -> Array:
    """Give rows whose last block is (x, y, 1) but for the 1, which is multiplied by u or v."""
    D = design_matrix(src, dst)
    W = to_homogeneous(src)
    D[:, 6:8] = -np.repeat(W[:, :2], 2, axis=0)
    return D


def _u_alone(src: Array, dst: Array) -> Array:
    """Give rows whose last block is −u or −v three times."""
    D = design_matrix(src, dst)
    D[:, 6:8] = D[:, 8:]
    return D


DESIGN = Exercise(
    name="design_matrix",
    chapter=6,
    title="The rows of the DLT",
    task="Give the matrix D, shape (2n, 9), of the equations D h = 0 that n point pairs src and "
    "dst, shape (n, 2) each, put on h, the rows of H stacked: two rows for each pair, in any "
    "order and of any scale.",
    stub='''def my_design_matrix(src, dst):
    """Give D (2n, 9) of D h = 0 for dst ≈ H src."""
    ...''',
    hints=(
        "m̃ × H W̃' = 0 has three rows for each pair; two of them suffice.",
        "With W̃' = (x, y, 1) and m = (u, v): [0 0 0, −W̃', v W̃'] and [W̃', 0 0 0, −u W̃'].",
        "np.hstack joins blocks of columns, np.vstack the two sets of rows.",
    ),
    cases=_pairs,
    properties=(
        Property("The true h of these pairs solves D h = 0, and nothing else is asked of it."),
    ),
    misconceptions=(
        Misconception(
            "columns of H stacked",
            "Your h has the columns of H stacked; the notes stack its rows: h = (h1; h2; h3).",
            lambda src, dst: design_matrix(src, dst)[:, [0, 3, 6, 1, 4, 7, 2, 5, 8]],
        ),
        Misconception(
            "sign of the last block",
            "The last block has the wrong sign: u (h3·W̃') = h1·W̃' gives W̃' and −u W̃'.",
            lambda src, dst: _design(src, dst, last=-1.0),
        ),
        Misconception(
            "u and v exchanged",
            "u and v are exchanged: u goes with the first row of H, v with the second.",
            lambda src, dst: design_matrix(src, dst[:, ::-1]),
        ),
        Misconception(
            "points lifted with 0",
            "W̃' = (x, y, 1): the third coordinate of a point of the plane is 1, not 0.",
            lambda src, dst: _design(src, dst, lift=0.0),
        ),
        Misconception(
            "denominator left out",
            "Your equations say u = h1·W̃', as for an affine map; the pixel is "
            "h1·W̃' divided by h3·W̃'.",
            _affine_rows,
        ),
        Misconception(
            "one row for each pair",
            "One row for each pair does not fix both u and v; two of the three are independent.",
            lambda src, dst: design_matrix(src, dst)[1::2],
        ),
        Misconception(
            "all three rows",
            "All three rows of the cross product are true, but the third follows from the others; "
            "asked are two for each pair.",
            lambda src, dst: np.vstack([design_matrix(src, dst), _third_rows(src, dst)]),
        ),
        Misconception(
            "x and y exchanged",
            "Your W̃' is (y, x, 1): x comes first.",
            lambda src, dst: design_matrix(src[:, ::-1], dst),
        ),
        Misconception(
            "the 1 in front",
            "Your W̃' is (1, x, y): the 1 comes last.",
            lambda src, dst: design_matrix(src, dst)[:, [2, 0, 1, 5, 3, 4, 8, 6, 7]],
        ),
        Misconception(
            "u for both rows",
            "u goes with the first row of H, v with the second: you have u in both.",
            lambda src, dst: design_matrix(src, dst[:, [0, 0]]),
        ),
        Misconception(
            "v for both rows",
            "u goes with the first row of H, v with the second: you have v in both.",
            lambda src, dst: design_matrix(src, dst[:, [1, 1]]),
        ),
        Misconception(
            "last block not multiplied by x and y",
            "u and v multiply all of W̃' in the last block, not its 1 alone.",
            _affine_last,
        ),
        Misconception(
            "last block without u and v",
            "The last block is −u W̃' and −v W̃': u and v are missing.",
            lambda src, dst: design_matrix(src, np.ones_like(dst)),
        ),
        Misconception(
            "h9 = 1",
            "You have eight columns, as if h9 were 1 and on the other side; asked are nine.",
            lambda src, dst: design_matrix(src, dst)[:, :8],
        ),
        Misconception(
            "divided by u and v",
            "u and v multiply W̃' in the last block; you divided by them.",
            lambda src, dst: design_matrix(src, 1 / dst),
        ),
        Misconception(
            "zeros left out",
            "The zeros are missing: each row has W̃' once, three zeros, and the last block.",
            lambda src, dst: np.hstack(
                [np.repeat(to_homogeneous(src), 2, 0), design_matrix(src, dst)[:, 6:]]
            ),
        ),
        Misconception(
            "sign of one block",
            "In one of the two rows of each pair the last block has the wrong sign: −u W̃' and −v "
            "W̃'.",
            lambda src, dst: design_matrix(src, dst * [-1, 1]),
            variants=(lambda src, dst: design_matrix(src, dst * [1, -1]),),
        ),
        Misconception(
            "points not lifted",
            "W̃' = (x, y, 1) has three coordinates: nine columns.",
            lambda src, dst: design_matrix(src, dst)[:, [0, 1, 3, 4, 6, 7]],
        ),
        Misconception(
            "dst not multiplied by x and y",
            "The last block is −u W̃', so −u x, −u y, −u; you have −x, −y and −u, or −u three "
            "times.",
            lambda src, dst: _u_alone(src, dst),
        ),
        Misconception(
            "lifted with −1",
            "W̃' = (x, y, 1), with a plus.",
            lambda src, dst: _design(src, dst, lift=-1.0),
        ),
    ),
    reference=design_matrix,
    same=same_row_space,
    concepts=("45", "46", "E24"),
)
