"""The corners in the board's own frame."""

from typing import Any

import numpy as np

from cvnotes.learn.cases.cameras import rounded
from cvnotes.targets import Chessboard
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def board_points(columns: int, rows: int, square: float) -> Any:
    """Return the inner corners (n, 3), row by row."""
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    z = np.zeros(columns * rows)  # the third coordinates
    W = np.column_stack([x.ravel(), y.ravel(), z])  # the corners, counted in squares
    return square * W


MISTAKES = mistakes_in(board_points,
    ("column by column", "The corners are all there, but y runs fastest. The finder lists them row "
     "by row, and each needs its partner in the same place of the list.",
     "square * W.reshape(rows, columns, 3).transpose(1, 0, 2).reshape(-1, 3)"),
    ("another origin", "The corners are not measured from the first of them, which is the origin.",
     "square * (W + [1, 1, 0])", "square * (W + [0.5, 0.5, 0])", "square * (W - W.mean(axis=0))"),
    ("squares counted, not corners",
     "You have too many corners: `columns` and `rows` count inner corners.",
     *(("(columns)", f"(columns + {n})", "(rows)", f"(rows + {n})", "columns * rows", "x.size")
       for n in (2, 1))),
    ("spread over all squares",
     "Your last corner is at columns × square: n corners have n − 1 squares between them.",
     "square * W * [columns / (columns - 1), rows / (rows - 1), 1]"),
)  # fmt: skip


EXERCISE = Exercise(
    name="board_points",
    chapter=5,
    title="The corners in the board's own frame",
    task="Give the inner corners (n, 3) of a board with `columns` × `rows` inner corners, "
    "`square` millimetres apart: the first in the origin, x along the columns and running "
    "fastest, y along the rows, z = 0.",
    hints=(
        "For 3 columns: (0, 0, 0), (s, 0, 0), (2s, 0, 0), then (0, s, 0) …",
        "Two loops do it, the one over rows outside; or np.meshgrid and ravel.",
        "np.column_stack joins x, y and zeros.",
    ),
    cases=lambda rng: [
        Case((3, 2, 10.0)),
        Case((int(rng.integers(5, 9)), 4, rounded(rng.uniform(20, 40), 1).item())),
    ],
    properties=(
        Property("The first corner is the origin.", lambda W, _: not W[0].any()),
        Property(
            "The second one is one square to its right.",
            lambda W, c: np.allclose(W[1] - W[0], [c.args[2], 0, 0], atol=1e-6 * c.slack),
        ),
        Property("All corners are there, row by row, in millimetres."),
    ),
    misconceptions=MISTAKES,
    steps=board_points,
    concepts=("39", "41"),
    sources=(Chessboard.points,),
)
