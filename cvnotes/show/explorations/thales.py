"""Explore the hinge of one photograph: every eye on a half circle sees both right angles."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.fold import (
    HINGE,
    PAIRS,
    SIDE,
    Circle,
    angles,
    eye_over_sheet,
    sentence_of,
    turned_to,
    two_photographs,
    vanishing_points,
)
from cvnotes.show.explorations.model import Drawing, Model, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import IDEAL

_SCALE, _FOOT = 0.62, 420  # of the hinge, face on; where its horizon is drawn


def thales_model() -> Model:
    """Make the model of the eye before one photograph."""
    (camera, _), (H, _), (circle, _) = two_photographs()
    about = (
        "A photograph of a board lies flat. An eye hangs over it on a half circle about the "
        "horizon, with lines to the vanishing points of the square's sides and of its diagonals. "
        "Beside it the plane of both, with a half circle over each pair."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        eye = circle.place(values["fold"])
        space = eye_over_sheet(paper, camera, [H], [circle], eye)
        panels = space, _face_on(paper, H, circle, eye)
        return Drawing(paper.join(panels), sentence_of([H], eye))

    return Model("thales", about, (HINGE,), draw, {"eye": turned_to(circle)})


def _face_on(paper: Paper, H: Array, circle: Circle, place: Array) -> Panel:
    """Draw horizon and eye in their own plane: the eye is on two half circles, by Thales."""
    panel = paper.panel(SIDE, (-580, 960), (1498, -350), "the hinge, face on")
    along = np.array([circle.up[1], -circle.up[0]])
    s = (vanishing_points(H) - circle.foot) @ along
    shift = np.array([190 - _SCALE * (s.min() + s.max()) / 2, _FOOT])
    eye = shift + [0, _SCALE * circle.radius]
    panel.line(np.array([[-3000, _FOOT], [3000, _FOOT]]), IDEAL, 0.8, dash=5)
    turn = np.radians(np.arange(0, 181.0, 3))
    for (name, meaning, colour), (a, b), angle, (x, anchor) in zip(
        PAIRS, s.reshape(2, 2), angles(H, place), ((-540, "ld"), (920, "rd")), strict=True
    ):
        thales = np.column_stack([a + b + (b - a) * np.cos(turn), abs(b - a) * np.sin(turn)]) / 2
        panel.line(shift + _SCALE * thales, colour, 0.8)
        ends = shift + _SCALE * np.array([[a, 0], [b, 0]])
        panel.line(np.array([ends[0], eye, ends[1]]), colour, 1.4)
        one, two = 80 * (ends - eye) / np.linalg.norm(ends - eye, axis=1, keepdims=True)
        panel.line(eye + np.array([one, one + two, two]), colour, 1.4)
        panel.mark(ends, meaning, 5)
        panel.text([x, 1180], f"{name}: {angle:.1f}°", colour, anchor=anchor, size=16)
    panel.mark(eye, "camera", 9)
    return panel
