"""Explore the projective line: a class of pairs turns about the origin, and closes like a ring."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, MUTED, WORLD

_NUMBERS = np.array([0, 1, 2, 4, 8, -8, -4, -2, -1])
_WIDE = 1.38


def ring_model() -> Model:
    """Make the model of the pairs [wx, w], with their ring."""
    settings = (
        Setting("angle", "angle (°)", -90, 270, 0.5, 45, "how far the line has turned from x = 0"),
    )
    about = """Left, lines through the origin: each is one class of pairs, and crosses w = 1 at its
    number x. Right, a ring on the line of these numbers: where the dashed join of x and the ring's
    top crosses the ring is the mark of x."""

    def draw(paper: Paper, values: Values) -> Drawing:
        turn = np.radians(values["angle"])
        way = np.array([np.sin(turn), np.cos(turn)]).round(15)  # [wx, w], so that 90° is exact
        x = float(way[0] / way[1]) + 0.0 if way[1] else np.inf  # + 0.0 makes -0 a 0
        colour = IDEAL if way[1] else ESTIMATED
        pairs = paper.panel((370, 290), (-2.42, 2.42), (2.2, -1.6), "the pairs [wx  w]")
        _draw_pairs(pairs, way, x, colour, values["angle"])
        ring = paper.panel((500, 290), (-_WIDE, _WIDE), (1.3, -0.3), "the same classes as a ring")
        _draw_ring(ring, way, x)
        return Drawing(paper.join((pairs, ring)), _sentence(values["angle"], x))

    def turned(values: Values, at: Array) -> Values:
        """Turn the line to a pair, by the shorter way from where it is."""
        return {"angle": _nearest(np.degrees(np.arctan2(*at)), values["angle"])}

    def walked(values: Values, at: Array) -> Values:
        """Turn it to half the angle at which a place of the ring stands."""
        twice = np.degrees(np.arctan2(at[0], 0.5 - at[1]))
        return {"angle": _nearest(twice / 2, values["angle"])}

    return Model("ring", about, settings, draw, {"line": turned, "dot": walked})


def _nearest(angle: float, to: float) -> float:
    """Return the angle of the same class that is nearest: a class comes back after half a turn."""
    return float(angle + 180 * np.round((to - angle) / 180))


def _draw_pairs(panel: Panel, way: Array, x: float, colour: str, angle: float) -> None:
    for number in _NUMBERS:
        panel.line(np.outer([-9, 9], [number, 1]), FAINT, 0.8)
    panel.line([[-9, 0], [9, 0]], FAINT, 0.8)
    panel.line([[-9, 1], [9, 1]], WORLD, 2)
    panel.text([-2.33, 1.2], "w = 1", WORLD)
    panel.line(np.outer([-9, 9], way), colour, 2.2)
    _draw_angle(panel, angle, 0.5)
    if np.isfinite(x):
        panel.mark([x, 1], "world", 9)
        side = 1 if x >= 0 else -1  # the line leads up to this side, the number is on the other
        where = [x - 0.13 * side, 1.25]
        panel.text(where, f"{x:.3g}", WORLD, anchor="rm" if x >= 0 else "lm", size=13)
    held = min(1.9, 1.42 / max(-way[1], 0.1)) * way  # in the panel, with its ring
    panel.polygons([held + 5 * panel.pixel * circle(24)], colour)
    panel.grip("line", "the class, a line through the origin", held, 5)


def _draw_ring(panel: Panel, way: Array, x: float) -> None:
    round_ = np.radians(np.arange(0, 361, 3))
    panel.line([[-9, 0], [9, 0]], WORLD, 2)
    panel.line(np.column_stack([np.sin(round_), 1 - np.cos(round_)]) / 2, WORLD, 2)
    for number in _NUMBERS:
        panel.line(_ray(number), FAINT, 0.8)
        mark = _dot(np.array([number, 1]))
        panel.mark(mark, "world", 5)
        if abs(number) <= 1:
            panel.text([number, -0.15], f"{number:.3g}", anchor="mm", size=11)
        if number:
            panel.text([0, 0.5] + 1.18 * (mark - [0, 0.5]), f"{number:.3g}", anchor="mm", size=11)
    dot = _dot(way)
    if np.isfinite(x):
        panel.line(_ray(x), WORLD, 2, dash=5)  # not the black line of the pairs
        panel.mark([x, 0], "world", 9)
    else:
        panel.line([[-9, 1], [9, 1]], ESTIMATED, 2, dash=5)
    panel.text([0, 1.14], "∞", ESTIMATED, anchor="mm", size=15)
    panel.mark(dot, "world" if np.isfinite(x) else "estimated", 10)
    panel.grip("dot", "the mark on the ring", dot, 5)


def _dot(way: Array) -> Array:
    """Return where a pair's dot is, at twice its angle on a ring of diameter 1 that stands on 0."""
    a, w = way
    return np.asarray(np.array([a * w, a * a]) / (a * a + w * w))


def _draw_angle(panel: Panel, angle: float, radius: float) -> None:
    """Draw an angle at the origin, from the upright, and write it if it is wide."""
    turn = np.radians(np.linspace(0, angle, 61))
    arc = radius * np.column_stack([np.sin(turn), np.cos(turn)])
    panel.line(arc, MUTED, 1)
    if abs(angle) > 15:
        away = 1 + 22 * panel.pixel / radius
        panel.text(away * arc[30], f"{angle:.3g}°", anchor="mm")


def _ray(x: float) -> Array:
    """Return the ray from the ring's top to the number x, or to where it has left the panel."""
    part = min(1, 2 * _WIDE / max(abs(x), 1))
    return np.array([[0, 1], [part * x, 1 - part]])


def _sentence(angle: float, x: float) -> str:
    if not np.isfinite(x):
        return f"""At {angle:g}° the line is level, [1 0]: it never reaches w = 1. Its mark is the
        top of the ring, the same from both sides: the point at infinity."""
    said = f"At {angle:g}° the line crosses w = 1 at x = {x:.4g}."
    if abs(x) < 20:
        return said
    return f"{said} As far beyond the level line, it crosses at {-x:.3g}."
