"""The corners in the board's own frame."""

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.targets import Chessboard
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, mistakes


def board_points(columns: int, rows: int, square: float) -> Array:
    """Return the inner corners (n, 3) of a board, row by row."""
    return Chessboard((columns, rows), square, half_turn_symmetric=True).points


def _grid(columns: int, rows: int, square: float, start: int = 0) -> Array:
    y, x = np.mgrid[start : rows + start, start : columns + start] * square
    return np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)


def _steps(columns: int, rows: int, square: float) -> Any:
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    z = np.zeros(columns * rows)  # the third coordinates
    W = np.column_stack([x.ravel(), y.ravel(), z])  # the corners, counted in squares
    return square * W


MISTAKES = mistakes(
    ("column by column",
     "The corners are all there, but y runs fastest. The finder lists them row by row, and "
     "each needs its partner in the same place of the list.",
     lambda c, r, s: _grid(c, r, s).reshape(r, c, 3).transpose(1, 0, 2).reshape(-1, 3)),
    ("x and y exchanged", "x runs along the columns and comes first; you have y in its place.",
     lambda c, r, s: _grid(c, r, s)[:, [1, 0, 2]]),
    ("another origin",
     "The corners are not measured from the first of them, which is the origin.",
     lambda c, r, s: _grid(c, r, s, start=1), lambda c, r, s: _grid(c, r, s) + [s / 2, s / 2, 0],
     lambda c, r, s: _grid(c, r, s) - _grid(c, r, s).mean(0)),
    ("squares counted, not corners",
     "You have too many corners: `columns` and `rows` count inner corners.",
     lambda c, r, s: _grid(c + 2, r + 2, s), lambda c, r, s: _grid(c + 1, r + 1, s)),
    ("z = 1", "A third coordinate that is not 0: the board's frame lies in the board.",
     lambda c, r, s: _grid(c, r, s) + [0, 0, 1], lambda c, r, s: _grid(c, r, s) + [0, 0, s]),
    ("y upwards", "Your y runs against the rows: its sign is wrong.",
     lambda c, r, s: _grid(c, r, s) * [1, -1, 1]),
    ("spread over all squares",
     "Your last corner is at columns × square: n corners have n − 1 squares between them.",
     lambda c, r, s: _grid(c, r, s) * [c / (c - 1), r / (r - 1), 1]),
)  # fmt: skip


BOARD = Exercise(
    name="board_points",
    chapter=5,
    title="The corners in the board's own frame",
    task="Give the inner corners (n, 3) of a board with `columns` × `rows` inner corners, "
    "`square` millimetres apart: the first in the origin, x along the columns and running "
    "fastest, y along the rows, z = 0.",
    stub='''def my_board_points(columns, rows, square):
    """Return the inner corners (n, 3), row by row."""
    ...''',
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
    reference=board_points,
    steps=_steps,
    concepts=("39", "41"),
    sources=(Chessboard.points,),
)
