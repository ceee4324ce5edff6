"""Explore pairs of numbers: a dot is pulled along its class, and its number stays."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, MUTED, WORLD

_MEMBERS = (-1, -0.5, 0.5, 1.5, 2)  # factors of the grey dots


def pairs_model() -> Model:
    """Make the model of one pair [wx, w] of the projective line, and of its class."""
    settings = (
        Setting("x", "x", -2, 2, 0.1, 2, "the number, where the line crosses w = 1"),
        Setting("w", "w", -1.2, 2, 0.1, 0.5, "the factor: which pair of the class"),
    )
    about = (
        "The plane of the pairs [wx, w]: a line through the origin with many dots, the number "
        "beside those that were passed, and where it crosses the level w = 1. On the right the "
        "black dot is divided, and its number stands on the level w = 1."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        x, w = values["x"], values["w"]
        plane = paper.panel((590, 270), (-5.4, 5.4), (2.55, -2.4), "pull the black dot")
        _draw_class(plane, x, w)
        seen = paper.panel((260, 270), (-2.6, 2.6), (2.2, -2.2), "divided by its last number")
        _draw_number(seen, x, w)
        return Drawing(paper.join((plane, seen)), _sentence(x, w))

    def slid(values: Values, at: Array) -> Values:
        """Stay on the line, as near to the hand as it goes."""
        way = np.array([values["x"], 1])
        return {"w": float(at @ way / (way @ way))}

    def moved(_: Values, at: Array) -> Values:
        return {"x": float(at[0])}

    return Model("pairs", about, settings, draw, {"pair": slid, "number": moved})


def _draw_class(panel: Panel, x: float, w: float) -> None:
    panel.line([[-9, 0], [9, 0]], FAINT, 0.8)
    panel.line([[0, -9], [0, 9]], FAINT, 0.8)
    panel.text([5.3, -0.22], "wx", anchor="rm", size=13)
    panel.text([0.1, 2.3], "w", size=13)
    panel.line([[-9, 1], [9, 1]], WORLD, 2)
    panel.line(np.outer([-9, 9], [x, 1]), MUTED, 1.5)
    side = 1 if x >= 0 else -1  # the line leads up to this side: words to the others
    other = "lm" if x >= 0 else "rm"
    aside = 19 * panel.pixel * np.array([-side, abs(x)]) / np.hypot(x, 1)
    for factor in _MEMBERS:
        at = factor * np.array([x, 1])
        panel.polygons([at + 3.5 * panel.pixel * circle(17)], MUTED)
        if min(w, 1) <= factor <= max(w, 1):  # between the black dot and the green mark
            panel.text(at + aside, _number(x), WORLD, anchor="mm", size=15)
    panel.mark([x, 1], "world", 9)
    panel.text([-5.3 * side, 1.25], "w = 1", WORLD, anchor=other, size=13)
    panel.polygons([6 * panel.pixel * circle(24) + [w * x, w]], IDEAL)
    beside = np.clip(w * x + 0.3 * side, -4.3, 4.3)  # within the panel
    panel.text([beside, w - 0.36], _pair(x, w), IDEAL, anchor=other, size=14)
    panel.grip("number", "the number, on the line w = 1", [x, 1], 6)
    panel.grip("pair", "the pair, along its class", [w * x, w], 6)


def _draw_number(panel: Panel, x: float, w: float) -> None:
    """Divide the pair, in large letters, over the line of numbers."""
    said, colour = (_number(x), WORLD) if w else ("?", ESTIMATED)
    panel.text([1.2, 0.9], f"{_number(w * x)} / {_number(w)}  =", IDEAL, anchor="rm", size=23)
    panel.text([1.5, 0.9], said, colour, size=30)
    panel.line([[-9, -0.8], [9, -0.8]], WORLD, 2)
    for n in range(-2, 3):
        panel.line([[n, -0.86], [n, -0.74]], WORLD, 1)
        panel.text([n, -1.2], _number(n), MUTED, anchor="mm", size=13)
    if w:
        panel.mark([x, -0.8], "world", 9)


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
