"""Explore what two real cameras measure: thirteen boards in the air, each by the other twelve."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import PAPER, SQUARES, squares_between
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, nearest
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, FAINT, IDEAL, MUTED, WORLD
from cvnotes.stereo import calibrate_stereo, triangulate

_COUNT, _TRUE = 13, 240.0  # pairs; mm from the first column of corners to the last
_PHOTO, _BESIDE = (236, 177), (250, 177)  # px: a photograph, and the plot beside them
_ABOVE, _ROWS = (478, 354), (250, 354)  # px: the view from above, and the rows
_Z, _X = (-80.0, 580.0), (-200.0, 288.8)  # mm that are seen from above, at equal scales
_NUMBERS = 5.0, 45.0, 255.0  # mm: where the first number stands, the next one, and their row
_LONG = 237.6, 242.4  # mm
_WALL, _PALE = "#CFCFCA", "#F9DCC8"
_UNEVEN = 0.10  # mm by which the heights of the sheet scatter, chapter 11
_MOST = 0.6  # mm of scatter


class Measured(NamedTuple):
    """What the cameras, known by twelve pairs, measure of the thirteenth; mm but for `apart`."""

    board: Array  # (6, 9, 3)
    right: Array  # the right camera's centre
    promised: float
    scatter: float
    apart: float  # px by which a corner's two rows differ, but for what grows evenly


def thirteen_model() -> Model:
    """Make the model of the thirteen pairs of real photographs."""
    settings = (Setting("pair", "pair", 1, _COUNT, 1, 7, "which of the thirteen is measured"),)
    about = """The corners of a board in two photographs taken at once; the board in the air from
    above, with rays from both cameras; its depths' scatter against what was promised, among
    thirteen such; and the lengths of its six rows."""

    drags = {
        "number": lambda _, at: {"pair": 1 + (at[0] - _NUMBERS[0]) / _NUMBERS[1]},
        "dot": nearest("pair", np.arange(1, _COUNT + 1), lambda *_: _all_dots()),
    }
    return Model("thirteen", about, settings, _draw, drags)


def _all_dots() -> Array:
    """Return what was promised for each pair, and its scatter (13, 2)."""
    return np.array([[one.promised, one.scatter] for one in all_measured()])


@lru_cache(maxsize=1)
def all_measured() -> list[Measured]:
    """Measure each pair with the cameras that the other twelve give."""
    return [_measured(i) for i in range(_COUNT)]


def _measured(i: int) -> Measured:
    real, rest = course.real_corners(), np.arange(_COUNT) != i
    pair = real.left[rest], real.right[rest]
    rig = calibrate_stereo(real.board.points, *pair, real.size, lens="k1 k2 p1 p2")
    W = triangulate(rig.cameras, [real.left[i], real.right[i]])
    missed = real.left[i] - rig.left.project(W) - (real.right[i] - rig.right.project(W))
    both = np.column_stack([W[:, 2], missed[:, 1]])
    flat = np.column_stack([W[:, :2], np.ones(len(W))])
    scatter, apart = np.std(both - flat @ np.linalg.lstsq(flat, both, rcond=None)[0], axis=0)
    centre = rig.right.centre
    promised = W[:, 2].mean() ** 2 / (rig.left.A[0, 0] * np.linalg.norm(centre)) * apart
    board = W.reshape(*real.board.corners[::-1], 3)
    return Measured(board, centre, float(promised), float(scatter), float(apart))


def lengths(board: Array) -> Array:
    """Return how long (6,) the rows of corners of a board (6, 9, 3) are."""
    return np.asarray(np.linalg.norm(board[:, -1] - board[:, 0], axis=-1))


def _draw(paper: Paper, values: Values) -> Drawing:
    i, real = int(values["pair"]) - 1, course.real_corners()
    now, photos = all_measured()[i], []
    for name, m in (("left", real.left[i]), ("right", real.right[i])):
        photos.append(_photo(paper, f"pair {i + 1}, the {name} camera", m.reshape(6, 9, 2)))
    page = paper.join((*photos, _plot(paper, i)), (_above(paper, i), _rows(paper, now.board)))
    long = lengths(now.board)
    sentence = f"""Pair {i + 1}, {now.board[..., 2].mean():.0f} mm away: its rows are
    {long.min():.1f} to {long.max():.1f} mm long instead of 240, {long.mean():.1f} mm on average.
    Its depths scatter by {now.scatter:.2f} mm; {now.promised:.2f} mm are promised, for its rows
    differ by {now.apart:.2f} px."""
    return Drawing(page, sentence)


def _photo(paper: Paper, title: str, grid: Array) -> Panel:
    """Draw the corners (6, 9, 2) that a photograph showed, and the squares that belong to them."""
    panel = paper.picture_panel(_PHOTO, course.real_corners().size, title)
    panel.polygons([[[-9, -9], [650, -9], [650, 490], [-9, 490]]], _WALL)
    for _ in range(2):  # one square more on each side, as the last ones go on, and then the others
        grid = np.concatenate([2 * grid[:1] - grid[1:2], grid, 2 * grid[-1:] - grid[-2:-1]])
        grid = grid.swapaxes(0, 1)
    squares, dark = squares_between(grid)
    outline = np.concatenate([grid[0], grid[1:, -1], grid[-1, -2::-1], grid[-2:0:-1, 0]])
    panel.polygons([outline], PAPER)
    panel.polygons(squares[dark], SQUARES)
    inner = grid[1:-1, 1:-1].reshape(-1, 2)
    panel.mark(inner, "lens", 3)
    panel.mark(grid[1, [1, -2]], "estimated", 7)
    return panel


def _above(paper: Paper, i: int) -> Panel:
    """Draw all boards from above, one of them with the rays to the ends of its first row."""
    panel = paper.panel(_ABOVE, _Z, _X, "the board in the air, from above")
    for one in all_measured():
        panel.line(_seen(one.board)[[0, 0, -1, -1, 0], [0, -1, -1, 0, 0]], FAINT, 1)
    now = all_measured()[i]
    board, eyes = _seen(now.board), _seen(np.array([[0.0, 0, 0], now.right]))
    panel.polygons([board[[0, 0, -1, -1], [0, -1, -1, 0]]], _PALE)
    for line in (*board, *board.swapaxes(0, 1)):
        panel.line(line, ESTIMATED, 0.7)
    for eye, name in zip(eyes, ("left", "right"), strict=True):
        panel.segments([[eye, end] for end in board[0, [0, -1]]], CAMERA, 1.2)
        panel.mark(eye, "camera", 11, (1, 0))
        panel.text(eye - [16, 0], name, CAMERA, anchor="rm", size=14)
    panel.line(board[0], ESTIMATED, 2.5)
    panel.mark(board[0, [0, -1]], "estimated", 7)
    far = board[0, board[0, :, 0].argmax()]
    long = f"{lengths(now.board)[0]:.1f} mm"
    at, anchor = (far + [12, 0], "lm") if far[0] < 470 else (np.array([572, far[1] - 24]), "rm")
    panel.text(at, long, ESTIMATED, anchor=anchor, size=15)
    first, step, row = _NUMBERS
    panel.text([first - 24, row], "pair", MUTED, anchor="rm", size=14)
    for k in range(_COUNT):
        at = [first + step * k, row]
        panel.text(at, f"{k + 1}", ESTIMATED if k == i else MUTED, anchor="mm", size=15)
    panel.grip("number", "the pair's number", [first + step * i, row], round(step / panel.pixel))
    return panel


def _seen(W: Array) -> Array:
    """Return where points (..., 3) are seen from above: depth to the right, x downwards."""
    return np.asarray(W[..., [2, 0]])


def _plot(paper: Paper, i: int) -> Panel:
    """Draw all boards' scatter against what was promised, and what the uneven sheet adds."""
    title = "scatter (up), promised (right), mm"
    panel = paper.panel(_BESIDE, (-0.1, _MOST), (_MOST, -0.08), title)
    panel.ticks(x=(0.2, 0.4), y=(0.2, 0.4), size=13)
    promised = np.linspace(0, _MOST, 40)
    panel.line(np.column_stack([promised, promised]), MUTED, 1)
    panel.line(np.column_stack([promised, np.hypot(promised, _UNEVEN)]), IDEAL, 1, dash=4)
    panel.mark(np.delete(_all_dots(), i, axis=0), "lens", 6)
    now = _all_dots()[i]
    panel.mark(now, "estimated", 9)
    panel.text(_free(now) + now, f"{i + 1}", ESTIMATED, anchor="mm", size=14)
    panel.grip("dot", "a pair's dot", now, 20)
    return panel


def _free(at: Array) -> Array:
    """Return the way (2,), one of sixteen, to a label of the dot `at` that is far from others."""
    turns = np.arange(16) * np.pi / 8
    ways = np.column_stack([0.075 * np.cos(turns), 0.1 * np.sin(turns)])
    ways = ways[(at + ways < _MOST - 0.02).all(axis=1)]
    apart = np.linalg.norm(at + ways[:, None] - _all_dots(), axis=-1).min(axis=1)
    return np.asarray(ways[apart.argmax()])


def _rows(paper: Paper, board: Array) -> Panel:
    """Draw how long the rows of a board are, beside what was printed."""
    panel = paper.panel(_ROWS, _LONG, (0.2, 7.3), "its six rows (mm)")
    for mm in (238, 239, 241, 242):
        panel.line([[mm, 0.2], [mm, 6.6]], FAINT, 0.6)
    panel.line([[_TRUE, 0.2], [_TRUE, 6.6]], WORLD, 2)
    for mm in range(238, 243):
        panel.text([mm, 6.95], f"{mm}", WORLD if mm == _TRUE else MUTED, anchor="mm", size=14)
    for row, long in enumerate(lengths(board), start=1):
        panel.line([[_TRUE, row], [long, row]], ESTIMATED, 2)
        panel.mark([long, row], "estimated", 7)
        side, anchor = (-0.16, "rm") if long < _TRUE else (0.16, "lm")
        panel.text([long + side, row - 0.3], f"{long:.1f}", ESTIMATED, anchor=anchor, size=14)
    return panel
