"""Explore least squares: two pixels wish an edge elsewhere, and a square says how badly m fits."""

import numpy as np

from cvnotes.base import Array
from cvnotes.pictures import course
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.votes import slopes
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, WORLD, mixed

_LEFT, _ROW = 312, 242  # px: the first column that is shown, and the row of both pixels
_VOTERS = 3, 4  # columns, counted from there
_UNIT = 38.0  # grey levels a pixel, so that the gradients are 2 and 1
_PHOTO, _PLANE = (336, 336), (399, 336)  # px


def wishes_model() -> Model:
    """Make the model of one unknown, two wishes, and the sum of squares that is left."""
    settings = (Setting("m", "m (px)", 2, 4.2, 0.05, 2.4, "where the edge is believed to be"),)
    about = """An edge of a photograph with the upright lines of two of its pixels, and a line m.
    Beside it their wishes as one point b, and m on a line, with the square on what is left."""
    drags = {
        "m": placed("m"),
        "foot": lambda _, at: {"m": float(at @ column() / (column() @ column()))},
    }
    return Model("wishes", about, settings, _draw, drags)


def column() -> Array:
    """Return both gradients, in units of the weaker one: what J is here."""
    return np.asarray(slopes()[_ROW, np.add(_LEFT, _VOTERS), 0] / _UNIT)


def _draw(paper: Paper, values: Values) -> Drawing:
    m, J, b = values["m"], column(), column() * _VOTERS
    x, y = b - m * J
    drawn = paper.join((_photo(paper, m), _plane(paper, m * J, b)))
    said = f"m = {m:.2f} leaves {x:.2f} and {y:.2f}: the sum of the squares is {x * x + y * y:.2f}"
    least = ", the least of all" if abs(m - J @ b / (J @ J)) < 0.01 else ""
    return Drawing(drawn, f"{said}{least}.")


def _photo(paper: Paper, m: float) -> Panel:
    panel = paper.panel(_PHOTO, (-0.5, 6.5), (-3.5, 3.5), "an edge, and two of its pixels: pull m")
    grey = course.photo(6)[_ROW - 3 : _ROW + 4, _LEFT : _LEFT + 7]
    panel.image(130 + (grey * (125 / 255)).astype(np.uint8), smooth=False)
    votes = [*zip(_VOTERS, column(), (-1, 1), strict=True)]
    for u, strong, _ in votes:
        panel.line([[u, -3.5], [u, 3.5]], ESTIMATED, 2.5 * strong)
        panel.mark([u, 0], "lens", 6)
    panel.line([[m, -3.5], [m, 3.5]], WORLD, 2.5)
    for u, strong, side in votes:
        words, anchor = f"gradient {strong:.0f}", "lm" if side > 0 else "rm"
        panel.text([u + 0.2 * side, -2.5], words, ESTIMATED, anchor=anchor, size=15)
    for u in range(7):
        panel.text([u, 3.2], f"{u}", IDEAL, anchor="mm", size=13)
    panel.text([m - 0.3, 2], "m", WORLD, anchor="rm", size=18)
    panel.grip("m", "the line m", [m, 2], 3, "world", 6)
    return panel


def _plane(paper: Paper, at: Array, b: Array) -> Panel:
    """Draw what m reaches, b, and the square on the dashed way from one to the other."""
    panel = paper.panel(_PLANE, (0, 9.5), (7.2, -0.8), "both wishes as one point b")
    panel.ticks(x=(2, 4, 6), y=(2, 4, 6), size=13)
    panel.text([9.4, -0.46], "2m, wanted 6", anchor="rm", size=13)
    panel.text([0.1, 6.9], "m, wanted 4", size=13)
    x, y = b - at
    corners = np.array([at, b, b + [-y, x], at + [-y, x]])
    panel.polygons([corners], mixed("#FFFFFF", ESTIMATED, 0.25))
    panel.line(np.outer([0, 8], column()), LENS, 2.5)
    for m in range(1, 5):
        panel.mark(m * column(), "lens", 4)
        panel.text(m * column() + [0.15, -0.4], f"m = {m}", LENS, size=13)
    panel.line([at, b], ESTIMATED, 2.5, dash=5)
    area = x * x + y * y
    small = area < 1.5  # its number stands beside it
    inside = corners.T @ [0.1, 0.1, 0.4, 0.4]
    place, anchor = (corners.max(axis=0) + [0.2, 0.1], "lm") if small else (inside, "mm")
    panel.text(place, f"{area:.2f}", ESTIMATED, anchor=anchor, size=16)
    panel.mark(b, "estimated", 7)
    panel.text(b + [0.05, 0.45], "b", ESTIMATED, size=18)
    panel.grip("foot", "m, on the blue line", at, 3, "world", 7)
    return panel
