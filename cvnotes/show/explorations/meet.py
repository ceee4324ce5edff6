"""Explore where two lines meet: each is a sheet of rays through the origin, and they share one."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.space.directions import onto
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, LENS, MUTED, WORLD

_TURNED, _FROM_ABOVE = np.radians([40, 27])  # from where the drawing is seen
_ACROSS = np.array([np.cos(_TURNED), np.sin(_TURNED), 0])
_BACK = np.array([-np.sin(_TURNED), np.cos(_TURNED), 0])
on_sheet = onto(np.array([_ACROSS, np.sin(_FROM_ABOVE) * _BACK + [0, 0, np.cos(_FROM_ABOVE)]]))
_SPACE, _BESIDE = (520, 400), (330, 400)
_SHOWN = ((-1.76, 1.64), (1.755, -0.86))
_SQUARE = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [-1, -1, 0]])
_ARROW = 0.62  # how long the arrows are, on the sheet of paper
_ORIGIN, _UP = np.zeros(3), np.array([0, 0, 1.0])
_AXES = np.array([[-0.9, -1.12, 1], [-1.34, -0.3, 1]])  # where arrows of u and v begin
_LINES = (
    ("1", "l₁", "orange", ESTIMATED, ("#FDF0E7", "#FBE0CE")),
    ("2", "l₂", "blue", LENS, ("#E8F2F8", "#CFE2F0")),
)
_ENDS = (("a", -1.0, "left"), ("b", 1.0, "right"))


def meet_model() -> Model:
    """Make the model of two lines of the plane w = 1, each from (−1, a) to (1, b) and beyond."""
    starts = {"a1": 0.5, "b1": 0.5, "a2": 0.0, "b2": 1}
    names = [
        (end + n, f"{colour}, {side}", x) for n, _, colour, *_ in _LINES for end, x, side in _ENDS
    ]
    settings = tuple(
        Setting(name, label, -1, 1, 0.1, starts[name], f"the line's v at u = {x:g}")
        for name, label, x in names
    )
    about = """The plane w = 1 over the origin, with an orange and a blue line. Through each goes
    its sheet of rays, down to the origin, where its normal stands; both sheets share a black ray,
    which pierces the plane in a green square. Beside it the triples and their product."""
    drags = {name: lambda _, at, name=name, x=x: {name: _slid(x, at)} for name, _, x in names}
    return Model("meet", about, settings, _draw, drags)


def triple(values: Values, n: str) -> Array:
    """Return the triple [a b c] of a line v = p + k u: (−k, 1, −p)."""
    a, b = values[f"a{n}"], values[f"b{n}"]
    return np.array([(a - b) / 2, 1, -(a + b) / 2]).round(9) + 0.0


def arrow_along(row: Array) -> Array:
    """Return the arrow (3,) along a triple, of any scale: as long as others where it is seen."""
    seen = float(np.linalg.norm(on_sheet(row)) / np.linalg.norm(row))
    return np.asarray(_ARROW / max(seen, 0.2) * row / np.linalg.norm(row))


def _slid(x: float, at: Array) -> float:
    """Return the v at which the edge at u of the plane w = 1 comes nearest to a place."""
    start, way = on_sheet(np.array([[x, 0, 1], [0, 1, 0]]))
    return float((at - start) @ way / (way @ way))


def _draw(paper: Paper, values: Values) -> Drawing:
    lines = [triple(values, n) for n in "12"]
    m = np.cross(lines[0], lines[1]).round(9) + 0.0
    space = _space(paper, values, lines, m)
    return Drawing(paper.join((space, _table(paper, lines, m))), _sentence(lines, m))


def _space(paper: Paper, values: Values, lines: list[Array], m: Array) -> Panel:
    title = "the plane w = 1 over the origin; pull the lines at their ends"
    panel = paper.panel(_SPACE, *_SHOWN, title)
    ray = (-m if m[2] < 0 else m) / max(float(np.linalg.norm(m)), 1e-9)
    panel.polygons([on_sheet(_SQUARE)], "#EDEDE8")
    panel.line(on_sheet(_SQUARE), FAINT, 1)
    panel.line(on_sheet(np.outer([-9, 0], ray)), IDEAL, 1.4)
    ends = [np.array([[x, values[end + n], 1] for end, x, _ in _ENDS]) for n in "12"]
    for two, (*_, tints) in zip(ends, _LINES, strict=True):
        level = (two[1] - two[0]) / 2  # the direction in which the sheet leaves w = 0
        sheets = np.array([*two, level, -level]), np.array([*two, _ORIGIN])
        panel.veil([*map(on_sheet, sheets)], tints)
    panel.veil([on_sheet(_SQUARE + _UP)], ["#E3F3EE"])
    panel.line(on_sheet(_SQUARE + _UP), "#9ECFBF", 1)
    panel.line(on_sheet(np.outer([0, 9], ray)), IDEAL, 2)
    for two, row, (n, name, colour, ink, *_) in zip(ends, lines, _LINES, strict=True):
        way = arrow_along(row)
        _arrow(panel, _ORIGIN, way, name, ink)
        if ray.any():
            foot = 0.25 * way
            panel.line(on_sheet(np.array([0.16 * ray, 0.16 * ray + foot, foot])), ink, 1.2)
        panel.line(on_sheet(two + np.outer([-9, 9], two[1] - two[0])), ink, 0.7)
        panel.line(on_sheet(two), ink, 2.5)
        for place, (end, _, side) in zip(two, _ENDS, strict=True):
            panel.mark(on_sheet(place), "estimated" if n == "1" else "lens", 8)
            panel.grip(end + n, f"the {side} end of the {colour} line", on_sheet(place), 4)
    if m[2]:
        panel.mark(on_sheet(m / m[2]), "world", 11)
        left = on_sheet(ray)[0] > 0  # the name stands where the ray leaves room
        low = on_sheet(m / m[2])[1] > _SHOWN[1][0] - 30 * panel.pixel
        by = (-18 if left else 18, 8) if low else (-10 if left else 10, -10)
        _name(panel, m / m[2], by, "m", IDEAL, "rs" if left else "ls")
    for start, way, name in zip(_AXES, 0.36 * np.eye(3), "uv", strict=False):
        _arrow(panel, start, way, name, WORLD)
    panel.mark(on_sheet(_ORIGIN), "lens", 5)
    for w, ink in ((0, MUTED), (1, WORLD)):
        _name(panel, np.array([-1, -1, w]), (-7, 15), f"w = {w}", ink, "rm")
    return panel


def _name(
    panel: Panel, place: Array, by: tuple[float, float], words: str, ink: str, anchor: str
) -> None:
    """Write so many px to the right of a place, and so many below it."""
    at = on_sheet(place) + panel.pixel * np.array(by) * [1, -1]
    panel.text(at, words, ink, anchor=anchor, size=14)


def _arrow(panel: Panel, start: Array, way: Array, name: str, ink: str) -> None:
    foot, tip = on_sheet(np.array([start, start + way]))
    ahead = (tip - foot) / np.linalg.norm(tip - foot)
    panel.arrows(foot, tip - foot, ink, 1.6)
    panel.text(tip + 11 * panel.pixel * ahead, name, ink, anchor="mm", size=15)


def _table(paper: Paper, lines: list[Array], m: Array) -> Panel:
    """Write both triples, their cross product, and what is left when it is divided by w."""
    panel = paper.panel(_BESIDE, (0, 330), (0, 400), "as triples")
    rows = [
        (f"{name}:  {_equation(row)}", row, ink)
        for row, (_, name, _, ink, *_) in zip(lines, _LINES, strict=True)
    ]
    for k, (caption, row, ink) in enumerate([*rows, ("m = l₁ × l₂", m, IDEAL)]):
        y = 28 + 98 * k
        panel.text([18, y], caption, ink, size=15)
        for x, words in zip((30, 118, 198, 278, 290), ("[", *map(_number, row), "]"), strict=True):
            at_infinity = x == 278 and k == 2 and row[2] == 0
            panel.text([x, y + 34], words, ESTIMATED if at_infinity else ink, anchor="rm", size=17)
    panel.text([18, 324], "m divided by its w", IDEAL, size=15)
    panel.text([18, 358], _place(m), IDEAL if m[2] else ESTIMATED, size=17 if m[2] else 15)
    return panel


def _place(m: Array) -> str:
    """Say where a point of the plane is."""
    if m[2]:
        u, v = m[:2] / m[2] + 0.0
        return f"({_number(u, 3)}, {_number(v, 3)})"
    if not m.any():
        return "no point, or every one"
    return f"at infinity, direction ±(1, {_number(m[1] / m[0] + 0.0)})"


def _equation(line: Array) -> str:
    """Write a line as in school: v = p + k u, without what is 0 or 1."""
    k, p = 0.0 - line[0], 0.0 - line[2]
    slope = "u" if abs(k) == 1 else f"{_number(abs(k))}u"
    if not k:
        return f"v = {_number(p)}"
    if not p:
        return f"v = {'−' if k < 0 else ''}{slope}"
    return f"v = {_number(p)} {'−' if k < 0 else '+'} {slope}"


def _number(x: float, digits: int = 4) -> str:
    return f"{x:.{digits}g}"


def _sentence(lines: list[Array], m: Array) -> str:
    one, other = map(_equation, lines)
    product = f"m = [{' '.join(map(_number, m))}]"
    if not m.any():
        return f"Both lines are {one}, and {product} is no point: they share all of theirs."
    if not m[2]:
        return f"""{one} and {other} are parallel. {product} is the end of both, {_place(m)}; the
        ray that the sheets share is level."""
    return f"{one} and {other} meet in {product}, which is the point {_place(m)}."
