"""The corners in the board's own frame."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property
from cvnotes.targets import Chessboard


def board_points(columns: int, rows: int, square: float) -> Array:
    """Give the inner corners (n, 3) of a board, row by row."""
    return Chessboard((columns, rows), square, half_turn_symmetric=True).points


def _grid(columns: int, rows: int, square: float, start: int = 0) -> Array:
    y, x = np.mgrid[start : rows + start, start : columns + start] * square
    return np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)


BOARD = Exercise(
    name="board_points",
    chapter=5,
    title="The corners in the board's own frame",
    task="Give the inner corners (n, 3) of a board with `columns` × `rows` inner corners, "
    "`square` millimetres apart: the first in the origin, x along the columns and running "
    "fastest, y along the rows, z = 0.",
    stub='''def my_board_points(columns, rows, square):
    """Give the inner corners (n, 3), row by row."""
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
    misconceptions=(
        Misconception(
            "column by column",
            "The corners are all there, but y runs fastest. The finder lists them row by row, "
            "and each needs its partner in the same place of the list.",
            lambda c, r, s: _grid(c, r, s).reshape(r, c, 3).transpose(1, 0, 2).reshape(-1, 3),
        ),
        Misconception(
            "squares for millimetres",
            "You counted in squares; multiply by the side of a square.",
            lambda c, r, s: _grid(c, r, 1.0),
        ),
        Misconception(
            "counted from one",
            "Your first corner is at (square, square); the origin is in the first corner.",
            lambda c, r, s: _grid(c, r, s, start=1),
        ),
        Misconception(
            "squares counted, not corners",
            "You have a point for every corner of every square, the border included. Inner "
            "corners are one fewer than squares, in both directions.",
            lambda c, r, s: _grid(c + 2, r + 2, s),
        ),
        Misconception(
            "origin in the middle",
            "Your origin is in the board's middle; here it is in the first corner.",
            lambda c, r, s: _grid(c, r, s) - _grid(c, r, s).mean(0),
        ),
        Misconception(
            "z = 1",
            "Your points have z = 1: they are (x, y, 1) lifted, not points of the board, whose "
            "frame lies in it: z = 0.",
            lambda c, r, s: _grid(c, r, s) + [0, 0, 1],
        ),
        Misconception(
            "x and y exchanged",
            "x runs along the columns and comes first; you have y in its place.",
            lambda c, r, s: _grid(c, r, s)[:, [1, 0, 2]],
        ),
        Misconception(
            "z left out",
            "The corners are right, in their plane; z = 0 is missing.",
            lambda c, r, s: _grid(c, r, s)[:, :2],
        ),
        Misconception(
            "y upwards",
            "Your y runs against the rows: its sign is wrong.",
            lambda c, r, s: _grid(c, r, s) * [1, -1, 1],
        ),
        Misconception(
            "one corner too few",
            (
                "You have one corner too few in each direction: `columns` and `rows` count inner "
                "corners already."
            ),
            lambda c, r, s: _grid(c - 1, r - 1, s),
        ),
        Misconception(
            "one corner too many",
            (
                "You have one corner too many in each direction: `columns` and `rows` count "
                "corners, and the last is number columns − 1."
            ),
            lambda c, r, s: _grid(c + 1, r + 1, s),
        ),
        Misconception(
            "spread over all squares",
            "Your last corner is at columns × square: n corners have n − 1 squares between them.",
            lambda c, r, s: _grid(c, r, s) * [c / (c - 1), r / (r - 1), 1],
        ),
        Misconception(
            "in metres",
            "The corners are right, in metres; asked are millimetres.",
            lambda c, r, s: _grid(c, r, s) / 1000,
        ),
        Misconception(
            "as a picture",
            "The corners are right, in an array of rows and columns; asked is one list (n, 3): "
            "reshape(-1, 3).",
            lambda c, r, s: _grid(c, r, s).reshape(r, c, 3),
            variants=(lambda c, r, s: _grid(c, r, s).reshape(r, c, 3).transpose(1, 0, 2),),
        ),
        Misconception(
            "y in z's place",
            "Your board stands upright: y along the rows is the second coordinate, z = 0 the "
            "third.",
            lambda c, r, s: _grid(c, r, s)[:, [0, 2, 1]],
            variants=(lambda c, r, s: _grid(c, r, s)[:, [2, 0, 1]],),
        ),
        Misconception(
            "half a square off",
            "Your corners are in the middles of the squares: the first corner is the origin.",
            lambda c, r, s: _grid(c, r, s) + [s / 2, s / 2, 0],
        ),
        Misconception(
            "z = square",
            "You put z = square; the board is its own plane, z = 0.",
            lambda c, r, s: _grid(c, r, s) + [0, 0, s],
        ),
        Misconception(
            "diagonal only",
            "You let x and y run together, along a diagonal: every row of the board has all "
            "columns.",
            lambda c, r, s: _grid(c, r, s)[:: c + 1],
        ),
        Misconception(
            "one row only",
            "That is the first row of corners alone: as many of them as the board has rows.",
            lambda c, r, s: _grid(c, 1, s),
        ),
        Misconception(
            "square too large",
            "You multiplied by the side of a square twice: once is enough.",
            lambda c, r, s: _grid(c, r, s * s),
        ),
    ),
    reference=board_points,
    concepts=("39", "41"),
    sources=(Chessboard.points,),
)
