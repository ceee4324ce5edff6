"""Explore the smallest singular vector: turn h on its circle, and D h goes round an ellipse."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, Range, circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED

_FULL = np.array([[1.6, 0.9], [0.5, 1.1]])
_ASIDE = np.array([[1, -1.7], [1.7, 1]]) / 2  # 60°: off a row of D along v
_PARALLEL = np.array([[1.6, 0.8], [0.8, 0.4]])  # its second row is half of the first
_HIGH = 288  # px, of a panel
_UNIT = 100  # px, of circle and ellipse alike: so one sees by how much D stretches
_CORNER = 0.13  # side of the square that marks a right angle, in units
_UP = np.array([1, -1])  # y goes up here, and down on a panel


def ellipse_model() -> Model:
    """Make the model of a matrix with two unknowns, and of all h of length 1."""
    settings = (
        Setting("angle", "direction of h (°)", 0, 180, 1, 70, "h has the length 1"),
        Setting("parallel", "rows parallel", 0, 1, 0.05, 0, "1: the second row says nothing new"),
    )
    about = "A vector h on the circle of all that have the length 1, and D h on an ellipse."
    drags = {"h": lambda _, at: {"angle": np.degrees(np.arctan2(-at[1], at[0])) % 180}}
    return Model("ellipse", about, settings, _draw, drags)


def matrix(parallel: float) -> Array:
    """Return D (2, 2): 0 as it is, 1 with parallel rows."""
    return np.asarray((1 - parallel) * _FULL + parallel * _PARALLEL)


def _draw(paper: Paper, values: Values) -> Drawing:
    D, a = matrix(values["parallel"]), np.radians(values["angle"])
    h = np.array([np.cos(a), np.sin(a)])
    _, s, Vt = np.linalg.svd(D)
    Vt = Vt * np.where(Vt[:, 1:] < 0, -1, 1)  # v and −v are as good: take the upper one
    title = "all h of length 1; rows r₁ and r₂ of D"
    left = _round(paper, (title, (-1.3, 1.95)), (np.eye(2), Vt, h), "")
    # Rows that nearly lie on each other share a name.
    names = ("r₁, r₂", "") if values["parallel"] > 0.7 else ("r₁", "r₂")
    for name, row in zip(names, D, strict=True):
        left.line([[0, 0], row * _UP], MUTED, 1.4, dash=4)
        left.text(1.08 * row * _UP, name, MUTED, anchor="mm", size=12)
    left.grip("h", "the vector h", h * _UP, 4)
    right = _round(paper, ("where D takes them", (-1.95, 2.3)), (D, Vt, h), "D ")
    long = float(np.linalg.norm(D @ h))
    said = f"The length of D h is {long:.2f}. "
    if s[1] < 1e-9:
        said += "For v₂ it is 0: D v₂ = 0."
    else:
        said += f"The longest is σ₁ = {s[0]:.2f}, the shortest σ₂ = {s[1]:.2f}."
    return Drawing(paper.join((left, right)), said)


def _round(
    paper: Paper, about: tuple[str, Range], what: tuple[Array, Array, Array], name: str
) -> Panel:
    """Draw where a map takes the circle, the singular vectors, and h."""
    (title, x), (map_, Vt, h) = about, what
    high = _HIGH / (2 * _UNIT)
    panel = paper.panel((round((x[1] - x[0]) * _UNIT), _HIGH), x, (-high, high), title)
    panel.line(circle(91), "#DDDDDD", 1.5)
    panel.line(circle(181) @ map_.T * _UP, MUTED, 1.5)
    for v, colour, letter in zip(Vt, (LENS, ESTIMATED), ("v₁", "v₂"), strict=True):
        end = map_ @ v
        panel.line([[0, 0], end * _UP], colour, 2.5)
        beside = end + 0.26 * (v if name else _ASIDE @ v)
        nought = " = 0" if np.linalg.norm(end) < 1e-9 else ""
        panel.text(beside * _UP, f"{name}{letter}{nought}", colour, anchor="mm", size=13)
    ends = Vt @ map_.T
    long = np.linalg.norm(ends, axis=1, keepdims=True)
    if long.min() > 2 * _CORNER:
        one, other = _CORNER * ends / long
        panel.line(np.array([one, one + other, other]) * _UP, MUTED, 1.2)  # a right angle
    panel.line([[0, 0], map_ @ h * _UP], IDEAL, 1.5)
    panel.mark(map_ @ h * _UP, "ideal", 8)
    aside = 0.55 * map_ @ h + 0.15 * (_ASIDE @ h - 0.5 * h)  # not at its end, where v₁ may be
    if np.linalg.norm(map_ @ h) < 0.3:  # so short that its name would lie on its end
        aside = np.array([0.2, -0.3])
    panel.text(aside * _UP, f"{name}h", IDEAL, anchor="mm", size=13)
    return panel
