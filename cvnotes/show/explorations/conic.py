"""Explore the pictures of a circle: pull the line that goes to infinity towards it, and through."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, WORLD

_SIZE = (400, 340)
_NEAR, _FAR = 1.7, 4.0  # how far up and down the panels show the plane, before and after
_PALE = "#80B8D8", "#EAAE80"  # of the net, before the line and beyond it
_AT_INFINITY = 0.02  # in w: so near the line no point of the circle is drawn
_TINTS = "#F1F7FB", "#FDF4EE"  # of the two sides of the line
_NET = np.arange(-6, 6.1, 0.5)  # where the lines of the net are
_WIDE = 60.0  # how far they are drawn: beyond the frames
_RIM = 0.7  # how far inside of the frame an arrow points to what lies outside


def conic_model() -> Model:
    """Make the model of the unit circle under H with the rows (1, 0, 0), (0, 1, 0), (a, b, 1)."""
    settings = (
        Setting("a", "a", -1.5, 1.5, 0.01, 0.5, "the first number of the last row of H"),
        Setting("b", "b", -1.5, 1.5, 0.01, 0.4, "the second one"),
    )
    about = """A circle on a net of squares, and a green line; beside it what H makes of circle and
    net, which takes the line to infinity. Orange is what lies beyond the line. Blue and orange meet
    at the plane's horizon, a black line."""

    def pulled(_: Values, at: Array) -> Values:
        return dict(zip("ab", -at / max(float(at @ at), 1e-9), strict=True))

    return Model("conic", about, settings, _draw, {"horizon": pulled})


def _draw(paper: Paper, values: Values) -> Drawing:
    n = np.array([values["a"], values["b"]])
    before, after = (
        paper.panel(_SIZE, (-reach * 20 / 17, reach * 20 / 17), (reach, -reach), title)
        for reach, title in ((_NEAR, "a circle; the green line goes to infinity"),
                             (_FAR, "their picture, drawn smaller; the black line is the horizon"))
    )  # fmt: skip
    s = float(n @ n)
    along = np.array([-n[1], n[0]]) / max(np.sqrt(s), 1e-12)
    across = np.array([along[1], -along[0]])  # as n
    for panel, sign in ((before, -1), (after, 1)):
        panel.polygons([_WIDE * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])], _TINTS[0])
        if s:
            line = sign * n / s + np.outer([-_WIDE, _WIDE], along)
            panel.polygons([[*line, *(line + 2 * sign * _WIDE * across)[::-1]]], _TINTS[1])
    for way in np.eye(2):
        for start in np.outer(_NET, 1 - way):
            _draw_sides(before, start, way, -n)
            _draw_sides(after, *_pictured(start, way, n), n)
    _draw_circle(before, after, n)
    if s:
        for panel, foot, ink in ((before, -n / s, WORLD), (after, n / s, IDEAL)):
            panel.line(foot + np.outer([-_WIDE, _WIDE], along), ink, 2)
        if s >= 1:
            half = np.sqrt(1 - 1 / s)
            before.polygons([circle(25) * 0.05 - n / s + x * along for x in (-half, half)], IDEAL)
        if s > 1 + 1e-9:
            _point_to_the_other_piece(after, n / np.sqrt(s), np.sqrt(s))
        before.grip("horizon", "the line that goes to infinity", -n / s, 4, "world", 7)
    return Drawing(paper.join((before, after)), _sentence(n))


def _pictured(start: Array, way: Array, n: Array) -> tuple[Array, Array]:
    """Return a point and the direction of the picture of a line: it is a line as well."""
    w, far = start @ n + 1, way @ n
    if max(abs(w), abs(far)) < 1e-9:  # the line that goes to infinity has none
        return np.full(2, np.nan), way
    # (start + t way) / (w + t far) moves along way w − start far, and is at way / far for t → ∞.
    along = way * w - start * far
    along /= np.hypot(*along)
    at = start / w if abs(w) > abs(far) else way / far
    return at - (at @ along) * along, along


def _draw_sides(panel: Panel, at: Array, along: Array, n: Array) -> None:
    """Draw a line, in one colour where n x is below 1, and in the other where it is above."""
    slope = float(along @ n)
    cut = (1 - at @ n) / slope if slope else np.copysign(np.inf, 1 - at @ n)
    lower = np.clip([-_WIDE, cut], -_WIDE, _WIDE), np.clip([cut, _WIDE], -_WIDE, _WIDE)
    for ink, part in zip(_PALE, lower if slope >= 0 else lower[::-1], strict=True):
        panel.line(at + np.outer(part, along), ink, 0.8)


def _draw_circle(before: Panel, after: Panel, n: Array) -> None:
    """Draw the circle and its picture, in one colour before the line and one beyond it."""
    xy = circle(361)
    w = xy @ n + 1
    for ink, side in zip((LENS, ESTIMATED), (1, -1), strict=True):
        before.line(np.where((side * w > 0)[:, None], xy, np.nan), ink, 4)
        with np.errstate(divide="ignore", invalid="ignore"):
            seen = np.where((side * w > _AT_INFINITY)[:, None], xy / w[:, None], np.nan)
        after.line(seen, ink, 4)


def _point_to_the_other_piece(after: Panel, way: Array, size: float) -> None:
    """Draw an arrow towards the piece beyond the horizon for as long as the frame does not show it.

    Its vertex is the picture of the circle's point -n / |n|, at the distance 1 / (|n| - 1).
    """
    inside = np.array([_FAR * 20 / 17, _FAR]) - _RIM
    rim = float(np.min(inside / np.abs(way).clip(1e-9)))
    if (size - 1) * rim > 1:
        return
    tail = (rim - 1.2) * way
    after.arrows(tail, 1.2 * way, ESTIMATED, 3)
    words = tail[0].clip(-3.2, 3.2), tail[1] - np.copysign(0.5, way[1])
    after.text(words, "the other piece", ESTIMATED, anchor="mm", size=14, rim=_TINTS[1])


def _sentence(n: Array) -> str:
    s = float(n @ n)
    said = f"a² + b² = {s:.4f}"
    if s == 0:
        return f"{said}: H is the identity."
    if np.isclose(s, 1, rtol=0, atol=1e-9):
        return f"{said}: the line touches the circle."
    if s < 1:
        return f"{said}: the line passes the circle by."
    return f"{said}: the line cuts the circle in two points."
