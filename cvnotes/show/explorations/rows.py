"""Explore the rows of R: what a camera's axes are, counted along the world's, from above."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.formation import draw_floor
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.walks import frames
from cvnotes.show.style import CAMERA, IDEAL, LENS, MUTED, WORLD, mixed

_C, _SIGHT, _WIDE = np.array([2.3, 2.0]), 1.75, 0.42  # the camera; of its view, length and slope
_X, _Z, _UNIT = (-1.15, 4.3), (4.0, -1.0), 88  # what is shown; px of an axis, which is 1 long
# Of each axis the name, the colour, how far outside its shadows lie, and where its name stands.
_ROWS = ("x", CAMERA, -0.3, (0.6, -0.17)), ("z", LENS, -0.78, (-0.17, 0.6))


def rows_model() -> Model:
    """Make the model of a camera that is turned, and of the shadows of its axes."""
    settings = (Setting("turn", "turn (°)", -180, 180, 1, -37, "of the camera, to the right"),)
    about = """A level camera from above, with its axes x and z, each 1 long; their shadows on the
    world's axes X and Z; and beside it the matrix R, whose rows they are."""
    drags = {"line of sight": lambda _, at: {"turn": np.degrees(np.arctan2(*(at - _C)))}}
    return Model("rows", about, settings, _draw, drags)


def _draw(paper: Paper, values: Values) -> Drawing:
    R, *_ = frames({"X": 0, "Z": 0, **values})
    size = round(_UNIT * (_X[1] - _X[0])), round(_UNIT * (_Z[0] - _Z[1]))
    plan = paper.panel(size, _X, _Z, "the shadows of x and z on X and Z: pull the plus")
    draw_floor(plan, lambda W: W[..., [0, 2]], 1)
    for tip, name in zip(np.diag([4.0, 3.7]), "XZ", strict=True):
        plan.arrows([0, 0], tip, WORLD, 2.5)
        plan.text(tip + 0.16 * np.sign(tip[::-1]), name, WORLD, anchor="mm", size=17)
    sight = _C + _SIGHT * R[1]
    sides = _C + _SIGHT * np.array([[-_WIDE, 1], [_WIDE, 1]]) @ R
    plan.veil([np.stack([_C, *sides])], ["#D3E9F7"])
    plan.line([_C, sight], IDEAL, 1, dash=4)
    for axis, (name, colour, out, beside) in zip(R, _ROWS, strict=True):
        _cast(plan, axis, colour, out)
        plan.text(_C + np.array(beside) @ R, name, colour, anchor="mm", size=18)
    plan.mark(_C, "camera", 10, looks=(R[1, 0], -R[1, 1]))
    plan.grip("line of sight", "where the camera looks", sight, 6, "ideal", 7)
    side = "left" if values["turn"] < 0 else "right"
    (a, b), (c, d) = R.round(2) + 0.0
    said = f"""Turned by {abs(values["turn"]):.0f}° to the {side}: the shadows of x are {a:.2f} on X
    and {b:.2f} on Z, those of z {c:.2f} and {d:.2f}."""
    return Drawing(paper.join((plan, _matrix(paper, R))), said)


def _cast(plan: Panel, axis: Array, colour: str, out: float) -> None:
    """Draw an axis of the camera, and its shadows beside the axes of the world."""
    tip = _C + axis
    for i in range(2):
        shadow = np.array([_C, tip])
        shadow[:, 1 - i] = out
        plan.segments([[tip, shadow[1]]], mixed("#FFFFFF", colour, 0.5), 1)
        plan.segments([[_C, shadow[0]]], "#D4D4D4", 1)
        plan.line(shadow, colour, 7)
        beyond = shadow[1] + (0.3, 0.16)[i] * np.eye(2)[i] * (1 if axis[i] >= 0 else -1)
        plan.text(beyond, f"{axis[i].round(2) + 0.0:.2f}", colour, anchor="mm", size=14)
    plan.arrows(_C, axis, colour, 3.5)


def _matrix(paper: Paper, R: Array) -> Panel:
    """Write R: the axes of the camera below each other, each on its colour."""
    panel = paper.panel((250, 160), (0, 250), (0, 160), "the matrix R")
    top = 54
    for j, head in enumerate("XZ"):
        panel.text([105 + 80 * j, top - 24], f"on {head}", WORLD, anchor="mm", size=13)
    for i, (name, colour, *_) in enumerate(_ROWS):
        y, tint = top + 40 * i, mixed("#FFFFFF", colour, 0.25)
        corners = np.array([[62, y], [228, y], [228, y + 40], [62, y + 40]])
        panel.polygons([corners], tint)
        panel.text([34, y + 20], name, colour, anchor="mm", size=18)
        for j, number in enumerate(R[i].round(2) + 0.0):
            words = f"{number:.2f}"
            panel.text([132 + 80 * j, y + 20], words, IDEAL, anchor="rm", size=18, rim=tint)
    for x, turn in ((56, 8), (234, -8)):
        ends = [[x + turn, top - 4], [x, top - 4], [x, top + 84], [x + turn, top + 84]]
        panel.line(ends, MUTED, 2)
    return panel
