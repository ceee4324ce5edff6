"""The rows of the DLT."""

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import design_matrix
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _pairs(rng: np.random.Generator) -> list[Case]:
    src, dst = rounded(rng.uniform(0, 9, (3, 2)), 1), rounded(rng.uniform(2, 30, (3, 2)), 1)
    return [Case((np.array([[1.0, 2.0]]), np.array([[3.0, 4.0]]))), Case((src, dst))]


def same_row_space(a: Array, b: Array, tolerance: float) -> bool:
    """Return whether two systems have the same solutions: their rows span the same space."""
    if a.shape != b.shape:
        return False
    scale = np.abs(b).max(axis=0) + 1e-9
    spaces = []
    for x in (a / scale, b / scale):
        if not np.isfinite(x).all():  # in what was given, or where it is too large
            return False
        _, s, Vt = np.linalg.svd(x, full_matrices=False)
        Vt = Vt[s > 1e-3 * tolerance * s[0]]
        spaces.append(Vt.T @ Vt)
    return bool(np.abs(spaces[0] - spaces[1]).max() <= 10 * tolerance)


def _steps(src: Array, dst: Array) -> Array:
    """Return D (2n, 9) of D h = 0 for dst ≈ H src."""
    u, v = dst[:, :1], dst[:, 1:]
    W = np.column_stack([src, np.ones(len(src))])  # the points of src, homogeneous
    Z = np.zeros_like(W)  # as many zeros
    first = np.hstack([W, Z, -u * W])  # the rows of u
    second = np.hstack([Z, W, -v * W])  # the rows of v
    return np.vstack([first, second])


_MISTAKES = mistakes_in(_steps,
    ("columns of H stacked", "Your h has the columns of H stacked; the notes stack its rows.",
     lambda src, dst: design_matrix(src, dst)[:, [0, 3, 6, 1, 4, 7, 2, 5, 8]]),
    ("sign of the last block", "The last block has the wrong sign: from which side did it come?",
     ("-u", "u", "-v", "v")),
    ("sign of one block", "In one of the two rows of each pair the last block has the wrong sign.",
     ("-u", "u"), ("-v", "v")),
    ("points lifted with 0", "You lifted points with 0, as directions; what do points get?",
     ("np.ones(len(src))", "np.zeros(len(src))")),
    ("the last block", "The last block is wrong: what is multiplied by a pixel's denominator?",
     ("-u * W", "-W", "-v * W", "-W"),
     ("-u * W", "-u * W * [0, 0, 1]", "-v * W", "-v * W * [0, 0, 1]"),
     ("-u * W", "-W * np.hstack([u**0, u**0, u])", "-v * W", "-W * np.hstack([v**0, v**0, v])"),
     ("-u * W", "-u * W**0", "-v * W", "-v * W**0")),
    ("h9 = 1", "You have eight columns, as if h9 were 1 and on the other side; asked are nine.",
     lambda src, dst: design_matrix(src, dst)[:, :8]),
)  # fmt: skip

EXERCISE = Exercise(
    name="design_matrix",
    chapter=6,
    title="The rows of the DLT",
    task="Give the matrix D, shape (2n, 9), of the equations D h = 0 that n point pairs src and "
    "dst, shape (n, 2) each, put on h, the rows of H stacked: two rows for each pair, in any "
    "order and of any scale.",
    hints=(
        "m̃ × H W̃' = 0 has three rows for each pair; two of them suffice.",
        "With W̃' = (x, y, 1) and m = (u, v): [0 0 0, −W̃', v W̃'] and [W̃', 0 0 0, −u W̃'].",
        "np.hstack joins blocks of columns, np.vstack the two sets of rows.",
    ),
    cases=_pairs,
    properties=(
        Property("The true h of these pairs solves D h = 0, and nothing else is asked of it."),
    ),
    misconceptions=_MISTAKES,
    reference=design_matrix,
    steps=_steps,
    same=same_row_space,
    concepts=("45", "46", "E24"),
)
