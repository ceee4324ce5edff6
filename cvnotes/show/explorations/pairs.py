"""Explore pairs of numbers: a dot is pulled along its class, and its number stays."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, MUTED, WORLD

_MEMBERS = (1.0, 10.0, -0.5)  # factors of the page


def pairs_model() -> Model:
    """Make the model of one pair [wx, w] of the projective line, and of its class."""
    settings = (
        Setting("x", "x", -2, 2, 0.1, 2, "the number, where the line crosses w = 1"),
        Setting("w", "w", -1.2, 1.5, 0.1, 1.5, "the factor: which pair of the class"),
    )
    about = (
        "The plane of the pairs [wx, w]: a line through the origin, one dot of it, and where it "
        "crosses the level w = 1; beside it pairs of this class, each divided by its last number."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        x, w = values["x"], values["w"]
        panel = paper.panel((460, 250), (-4.14, 4.14), (2.5, -2), "pull the black dot")
        _draw_pair(panel, x, w)
        table = paper.panel((320, 250), (0, 10), (0, 10), "pairs of its class")
        for row, factor in enumerate((w, *_MEMBERS)):
            _write_row(table, 1.6 + 2.2 * row, x, factor, IDEAL if row == 0 else MUTED)
        return Drawing(paper.join((panel, table)), _sentence(x, w))

    def slid(values: Values, at: Array) -> Values:
        """Stay on the line, as near to the hand as it goes."""
        way = np.array([values["x"], 1])
        return {"w": float(at @ way / (way @ way))}

    def moved(_: Values, at: Array) -> Values:
        return {"x": float(at[0])}

    return Model("pairs", about, settings, draw, {"pair": slid, "number": moved})


def _draw_pair(panel: Panel, x: float, w: float) -> None:
    panel.line([[-9, 0], [9, 0]], FAINT, 0.8)
    panel.line([[0, -9], [0, 9]], FAINT, 0.8)
    panel.text([4.0, -0.22], "wx", anchor="rm", size=13)
    panel.text([0.12, 2.28], "w", size=13)
    panel.line([[-9, 1], [9, 1]], WORLD, 2)
    panel.segments([[[n, 0.94], [n, 1.06]] for n in range(-4, 5)], WORLD, 1)
    panel.line(np.outer([-9, 9], [x, 1]), IDEAL, 1.5)
    panel.mark([x, 1], "world", 9)
    side = 1 if x >= 0 else -1  # the line leads up to this side: words to the others
    anchor, other = ("rm", "lm") if x >= 0 else ("lm", "rm")
    panel.text([-4.0 * side, 1.25], "w = 1", WORLD, anchor=other, size=12)
    panel.text([x - 0.17 * side, 1.27], _number(x), WORLD, anchor=anchor, size=15)
    panel.polygons([0.085 * circle(24) + [w * x, w]], IDEAL)
    beside = np.clip(w * x + 0.17 * side, -2.7, 2.7)  # within the panel
    panel.text([beside, w - 0.32], _pair(x, w), IDEAL, anchor=other, size=13)
    panel.grip("number", "the number, on the line w = 1", [x, 1], 6)
    panel.grip("pair", "the pair, along its class", [w * x, w], 6)


def _write_row(panel: Panel, y: float, x: float, w: float, ink: str) -> None:
    panel.text([0.5, y], _pair(x, w), ink, size=14)
    panel.text([7.6, y], f"{_number(w * x)} / {_number(w)}  =", ink, anchor="rm", size=14)
    said, colour = (_number(x), WORLD) if w else ("?", ESTIMATED)
    panel.text([8.2, y], said, colour, size=14)


def _pair(x: float, w: float) -> str:
    return f"[{_number(w * x)}  {_number(w)}]"


def _number(x: float) -> str:
    return f"{round(x, 2) + 0.0:g}".replace("-", "−")


def _sentence(x: float, w: float) -> str:
    if w == 0:
        return "[0 0] lies on every line through the origin: no line is its own."
    return (
        f"[{_number(w * x)} {_number(w)}] is {_number(w)} · [{_number(x)} 1]: "
        f"its line crosses w = 1 at x = {_number(x)}."
    )
