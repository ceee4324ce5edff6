"""Explore the pictures of a circle: pull the line that goes to infinity towards it, and through."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS

_SIZE = (400, 340)
_NEAR, _FAR = 1.7, 4.0  # how far up and down the panels show the plane, before and after
_PALE = "#CFE0EC", "#F3D5C2"  # of the net, before the line and beyond it
_AT_INFINITY = 0.02  # in w: so near the line nothing is drawn


def conic_model() -> Model:
    """Make the model of the unit circle under H with the rows (1, 0, 0), (0, 1, 0), (a, b, 1)."""
    settings = (
        Setting("a", "a", -1.5, 1.5, 0.01, 0.5, "the first number of the last row of H"),
        Setting("b", "b", -1.5, 1.5, 0.01, 0.4, "the second one"),
    )
    about = (
        "A circle on a net of squares, and a black line; beside it what H makes of circle and net, "
        "which takes the line to infinity. Orange is what lies beyond the line."
    )

    def pulled(_: Values, at: Array) -> Values:
        a, b = (-at / max(float(at @ at), 1e-9)).tolist()
        return {"a": a, "b": b}

    return Model("conic", about, settings, _draw, {"horizon": pulled})


def _draw(paper: Paper, values: Values) -> Drawing:
    n = np.array([values["a"], values["b"]])
    before, after = (
        paper.panel(_SIZE, (-reach * 20 / 17, reach * 20 / 17), (reach, -reach), title)
        for reach, title in ((_NEAR, "a circle, and the line that goes to infinity"),
                             (_FAR, "their picture"))
    )  # fmt: skip
    fine, at = np.linspace(-4, 4, 401), np.arange(-4, 4.1, 0.5)
    net = np.stack(np.meshgrid(fine, at), axis=-1)
    for line in (*net, *net[..., ::-1]):
        _draw_both(before, after, line, n, _PALE, 0.8)
    _draw_both(before, after, circle(721), n, (LENS, ESTIMATED), 3)
    if n.any():
        foot, along = -n / (n @ n), np.array([-n[1], n[0]]) / np.hypot(*n)
        before.line(foot + np.outer([-9, 9], along), IDEAL, 2)
        before.mark(foot, "ideal", 9)
        before.grip("horizon", "the line that goes to infinity", foot, 4)
    return Drawing(paper.join((before, after)), _sentence(n))


def _draw_both(
    before: Panel, after: Panel, xy: Array, n: Array, inks: tuple[str, str], width: float
) -> None:
    """Draw a curve (k, 2) and its picture, in one colour before the line and one beyond it."""
    w = xy @ n + 1
    for ink, side in zip(inks, (1, -1), strict=True):
        before.line(np.where((side * w > 0)[:, None], xy, np.nan), ink, width)
        with np.errstate(divide="ignore", invalid="ignore"):
            seen = np.where((side * w > _AT_INFINITY)[:, None], xy / w[:, None], np.nan)
        after.line(seen, ink, width)


def _sentence(n: Array) -> str:
    s = float(n @ n)
    said = f"a² + b² = {s:.4f}"
    if s == 0:
        return f"{said}: H is the identity, and a circle stays a circle."
    if np.isclose(s, 1, rtol=0, atol=1e-9):
        return f"{said}: the line touches the circle, whose picture is a parabola."
    if s < 1:
        return f"{said}: the line passes the circle by, whose picture is an ellipse."
    return f"{said}: the line cuts the circle in two points, and its picture is a hyperbola."
