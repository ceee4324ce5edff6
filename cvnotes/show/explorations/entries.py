"""Explore the nine entries of a homography: pull one, and see what it alone does to a plane."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.pictures.posters import chart
from cvnotes.projective import apply, to_homogeneous
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.explorations.strokes import cut
from cvnotes.show.style import ESTIMATED, FAINT, LENS, MUTED, WORLD

_HIGH, _FAR = 594.0, 1e4  # mm, the height of the chart, here 1; as good as infinitely far
_INKS = ESTIMATED, LENS, WORLD  # of the columns
_ALONE = np.array([[0.6, 0.6, 0.4], [0.45, 0.4, 0.4], [0.9, 0.9, 0.7]])  # what each net shows
_LOW = np.array([[0.4, -0.8, -0.4], [-0.8, 0.4, -0.4], [-0.6, -0.6, 0.5]])
_TOP = np.array([[1.6, 0.8, 1.0], [0.8, 1.6, 0.8], [1.5, 1.5, 2.0]])
_SEEN, _NETS = (430, 342), (318, 342)  # px
_CELL, _TRACK = np.array([106, 114]), (15, 91, 101)  # px; from, to, and how far down
_WALL, _PAPER, _INK, _NEAREST = "#D5DADB", "#F8F5EC", "#1E2233", 0.03


def entries_model() -> Model:
    """Make the model of a chart of letters and of the nine entries that lay it down."""
    start = np.eye(3)
    start[2, 0] = 0.8
    settings = tuple(
        Setting(f"h{k}", f"h{k}", low, top, 0.02, value, f"row {(k - 1) // 3 + 1} of H")
        for k, (low, top, value) in enumerate(
            zip(*(M.ravel().tolist() for M in (_LOW, _TOP, start)), strict=True), start=1
        )
    )
    about = """A chart of letters as a homography lays it down; its edges, continued, and its first
    corner show the three columns. Beside it the nine entries: what each does alone to a net."""

    def pulled(k: int) -> Drag:
        def drag(_: Values, at: Array) -> Values:
            low, top = _LOW.flat[k], _TOP.flat[k]
            part = (at[0] - k % 3 * _CELL[0] - _TRACK[0]) / (_TRACK[1] - _TRACK[0])
            return {f"h{k + 1}": float(low + part * (top - low))}

        return drag

    return Model("entries", about, settings, _draw, {f"h{k}": pulled(k - 1) for k in range(1, 10)})


@lru_cache(maxsize=1)
def _chart() -> Array:
    """Return the paper and the strips of the letters (n, 4, 2), the chart 1 high."""
    return np.asarray(chart().faces[..., :2] / _HIGH)


def _draw(paper: Paper, values: Values) -> Drawing:
    H = np.array([*values.values()]).reshape(3, 3)
    panel = paper.panel(_SEEN, (-0.5, 1.5), (-0.3, 1.29), "what H makes of the chart")
    panel.polygons([[[-1, -1], [2, -1], [2, 2], [-1, 2]]], _WALL)
    sheet, *letters = _chart()
    sheet_h = to_homogeneous(sheet) @ H.T
    whole = cut(sheet_h, sheet_h[:, 2] - _NEAREST)
    panel.polygons([whole[:, :2] / whole[:, 2:]], _PAPER)
    ink = to_homogeneous(letters) @ H.T
    ink = ink[(ink[..., 2] > _NEAREST).all(axis=1)]
    panel.polygons(ink[..., :2] / ink[..., 2:], _INK)
    said = [_edges(panel, H, axis, sheet) for axis in (0, 1)]
    corner = H[:2, 2] / H[2, 2]
    _name(panel, corner, "third column", WORLD)
    said.append(f"Third: the first corner is at ({corner[0]:.2f}, {corner[1]:.2f}).")
    return Drawing(paper.join((panel, _nets(paper, H))), " ".join(said))


def _edges(panel: Panel, H: Array, axis: int, sheet: Array) -> str:
    """Continue two edges of the chart to where its column of H is; say where that is."""
    name, which = (("First", "upper and lower"), ("Second", "left and right"))[axis]
    ahead = 1 if H[2, axis] >= 0 else -1
    for corner in sheet[[0, 3] if axis == 0 else [0, 1]]:
        far = corner + _FAR * ahead * np.eye(2)[axis]
        ends = to_homogeneous(np.stack([corner, far])) @ H.T
        if (ends[:, 2] > _NEAREST).all():
            panel.line(ends[:, :2] / ends[:, 2:], _INKS[axis], 2)
    if H[2, axis] == 0:
        return f"{name} column: the {which} edges stay parallel."
    x, y = H[:2, axis] / H[2, axis] + 0.0
    _name(panel, np.array([x, y]), f"{name.lower()} column", _INKS[axis])
    return f"{name} column: the {which} edges meet at ({x:.2f}, {y:.2f})."


def _name(panel: Panel, at: Array, words: str, colour: str) -> None:
    for size, ink in ((6.5, "white"), (5, colour)):
        panel.polygons([at + size * panel.pixel * circle(25)], ink)
    panel.text(at - [0, 19 * panel.pixel], words, colour, anchor="mm", size=14, rim=_WALL)


def _nets(paper: Paper, H: Array) -> Panel:
    """Draw the nine entries, each with its net and a track on which it is pulled."""
    panel = paper.panel(_NETS, (0, _NETS[0]), (0, _NETS[1]), "H: what each entry does alone")
    steps = np.linspace(0, 1, 4)
    net = np.stack(np.meshgrid(steps, steps), axis=-1)
    for k, value in enumerate(H.ravel().tolist()):
        row, column = divmod(k, 3)
        at, colour = _CELL * [column, row], _INKS[column]
        alone = np.eye(3)
        alone[row, column] += _ALONE[row, column]
        for M, ink, width in ((np.eye(3), FAINT, 1), (alone, colour, 1.6)):
            put = at + [27, 24] + 42 * apply(M, net)
            for line in (*put, *put.swapaxes(0, 1)):
                panel.line(line, ink, width)
        panel.text(at + [6, 12], f"h{'₁₂₃₄₅₆₇₈₉'[k]}", colour, size=14)
        panel.text(at + [100, 12], f"{value:.2f}", MUTED, anchor="rm", size=13)
        left, right, down = _TRACK
        panel.line(at + [[left, down], [right, down]], FAINT, 3)
        low, top = _LOW[row, column], _TOP[row, column]
        knob = at + [left + (value - low) / (top - low) * (right - left), down]
        panel.polygons([knob + 5 * circle(25)], colour)
        panel.grip(f"h{k + 1}", f"h{k + 1}, in row {row + 1} and column {column + 1}", knob, 1)
    return panel
