"""Explore a turn about one axis: what of a vector stays, and on which circle its tip runs."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import rotation_from_vector
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.space.directions import sheet
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, LENS, MUTED, WORLD, mixed

_UPRIGHT = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])  # n, which is z, points up on the sheet
_SHEET = sheet((35, -62)) @ _UPRIGHT
_N, _W = np.array([0.0, 0, 1]), np.array([3.0, 0, 2])
_ALONG = (_N @ _W) * _N
_P = _W - _ALONG  # what of w lies across n
_Q = np.cross(_N, _W)


def rodrigues_model() -> Model:
    """Make the model of a vector that is turned about an upright axis."""
    settings = (Setting("theta", "angle θ (°)", -180, 180, 1, 50, "how far w is turned about n"),)
    about = """A vector w turned about an axis n: its part along n stays, the tip of its part p
    across n runs on a circle, towards n × w. Beside it the circle from above, seen against n."""

    def in_space(_: Values, at: Array) -> Values:
        """Find the angle on the circle, which the sheet shows as an ellipse."""
        across = np.linalg.solve(_SHEET @ np.array([_P, _Q]).T, at - _SHEET @ _ALONG)
        return {"theta": float(np.degrees(np.arctan2(across[1], across[0])))}

    drags: dict[str, Drag] = {"tip in space": in_space}
    drags["tip from above"] = lambda _, at: {"theta": np.degrees(np.arctan2(at[1], at[0]))}
    return Model("rodrigues", about, settings, _draw, drags)


def _draw(paper: Paper, values: Values) -> Drawing:
    theta = np.radians(values["theta"])
    turned = (rotation_from_vector(theta * _N) @ _W).round(9) + 0.0
    space = paper.panel((380, 280), (-3.7, 3.7), (-4.45, 1.0), "w is turned about n")
    _draw_space(space, turned, theta)
    above = paper.panel((440, 280), (-6.05, 6.05), (3.85, -3.85), "the circle from above")
    _draw_above(above, turned, theta)
    c, s = np.array([turned @ _P, turned @ _Q]) / (_P @ _P)
    x, y, z = turned
    across, towards = (f"{'−' if part < 0 else '+'} {abs(part):.2f}" for part in (c, s))
    said = f"""w = (3, 0, 2) becomes (0, 0, 2) {across} · (3, 0, 0) {towards} · (0, 3, 0) =
    ({x:.2f}, {y:.2f}, {z:.0f})."""
    return Drawing(paper.join((space, above)), said)


def _arc(radius: float, theta: float) -> Array:
    """Return places (61, 2) on an arc from p by an angle, towards n × w."""
    turn = np.linspace(0, theta, 61)
    return radius * np.column_stack([np.cos(turn), np.sin(turn)])


def _draw_space(panel: Panel, turned: Array, theta: float) -> None:
    round_, centre = circle(97) @ np.array([_P, _Q]), _SHEET @ _ALONG
    panel.polygons([(round_ + _ALONG) @ _SHEET.T], "#F4F4F4")
    wedge = _arc(1, theta) @ np.array([_P, _Q])
    panel.polygons([[centre, *(wedge + _ALONG) @ _SHEET.T]], mixed("#FFFFFF", ESTIMATED, 0.16))
    panel.line((round_ + _ALONG) @ _SHEET.T, MUTED, 1)
    panel.line(np.outer([-0.6, 5.3], _SHEET @ _N), MUTED, 1, dash=5)
    for way, name, colour, far in ((_P, "p", IDEAL, 1.14), (_Q, "n × w", LENS, 1.2)):
        panel.arrows(centre, _SHEET @ way, colour, 2)
        panel.text(centre + far * _SHEET @ way, name, colour, anchor="mm", size=15)
    for end, colour in ((_W, IDEAL), (turned, ESTIMATED)):
        panel.arrows([0, 0], _SHEET @ end, colour, 3)
    panel.arrows([0, 0], centre, WORLD, 4)
    panel.text([-0.2, 0.55 * centre[1]], "along n", WORLD, anchor="rm", size=14)
    panel.arrows(_SHEET @ (3.6 * _N), _SHEET @ (1.4 * _N), IDEAL, 2)
    panel.text(_SHEET @ (4.8 * _N) + [0.2, 0], "n", IDEAL, size=15)
    panel.text(0.55 * _SHEET @ _W + [0.15, 0.35], "w", IDEAL, size=15)
    tip = _SHEET @ turned
    panel.grip("tip in space", "the tip, to be turned about n", tip, 5, "estimated", 7)


def _draw_above(panel: Panel, turned: Array, theta: float) -> None:
    (x, y), r = turned[:2], float(np.linalg.norm(_P))
    panel.polygons([r * circle(97)], "#F4F4F4")
    panel.polygons([[[0, 0], *_arc(r, theta)]], mixed("#FFFFFF", ESTIMATED, 0.16))
    panel.line(r * circle(97), MUTED, 1)
    panel.line(np.array([[-r, 0], [0, 0], [0, -r]]), FAINT, 1)
    for way, name, colour in ((_P, "p", IDEAL), (_Q, "n × w", LENS)):
        panel.arrows([0, 0], way[:2], colour, 1.5)
        panel.text(1.15 * way[:2], name, colour, anchor="mm", size=15)
    panel.line(_arc(0.6, theta), ESTIMATED, 1.5)
    panel.arrows([0, 0], [x, y], ESTIMATED, 3)
    panel.line([[0, 0], [x, 0]], IDEAL, 4.5)  # the two steps that lead to the tip
    panel.line([[x, 0], [x, y]], LENS, 4.5)
    if abs(x) > 0.1:  # a step of no length has no name
        panel.text([x / 2, -0.3 if y >= 0 else 0.3], "cos θ p", IDEAL, anchor="mm", size=14)
    side = 1 if x >= 0 else -1
    if abs(y) > 0.1:
        beside = [x + 0.2 * side, y / 2]
        panel.text(beside, "sin θ (n × w)", LENS, anchor="lm" if side > 0 else "rm", size=14)
    panel.text(_arc(1, theta / 2)[-1], "θ", ESTIMATED, anchor="mm", size=15)
    panel.grip("tip from above", "the tip, to be turned about n", [x, y], 5, "estimated", 7)
