"""Explore the maps of the plane: pull a square, and see what each kind of map leaves alone."""

import numpy as np

from cvnotes.base import Array
from cvnotes.projective import apply, cross_ratio, to_homogeneous
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, WORLD

_RIGHT, _TOP = np.array([1.0, 0]), np.array([0.0, -1])  # where the square is taken hold of
_SIDE = np.array([[1, -1], [1, 0], [1, 0.5], [1, 1]])  # four points of its right side
_SQUARE = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
_MEASURED = (
    ("length of the side", "{:.3f}"),
    ("angle of the corner", "{:.0f}°"),
    ("angle of opposite sides", "{:.0f}°"),
    ("upper half : lower", "{:.3f}"),
    ("cross-ratio", "{:.2f}"),
)
_SNAP = 0.08  # of size, shear and tilt: so near to what changes nothing a hand means just that
_KINDS = "Euclidean", "similar", "affine", "projective"
_NUMBERS = 3, 4, 6, 8


def maps_model() -> Model:
    """Make the model of a square with a circle in it, mapped by a matrix of four numbers."""
    settings = (
        Setting("turn", "turn (°)", -180, 180, 5, 20, "allowed to every kind"),
        Setting("size", "size", 0.4, 1.5, 0.05, 1, "1 is Euclidean; else at least a similarity"),
        Setting("shear", "shear", -1, 1, 0.05, 0, "not 0: at least affine"),
        Setting("tilt", "tilt", -0.5, 0.5, 0.05, 0, "not 0: projective"),
    )
    about = (
        "A square with a grid and a circle in it, before the map, dashed, and after it; beside it "
        "what was measured on both, orange where the map has changed it."
    )
    drags = {"right side": _pulled_right, "top": _pulled_top}
    return Model("maps", about, settings, _draw, drags)


def matrix(values: Values) -> Array:
    """Return the map (3, 3): first the tilt and the shear, then the size and the turn."""
    a, k = np.radians(values["turn"]), values["size"]
    similar = [[k * np.cos(a), -k * np.sin(a), 0], [k * np.sin(a), k * np.cos(a), 0], [0, 0, 1]]
    rest = [[1, values["shear"], 0], [0, 1, 0], [0, values["tilt"], 1]]
    return np.asarray(np.array(similar) @ np.array(rest))


def kind(values: Values) -> int:
    """Return the first of the four nested kinds that has this map."""
    steps = values["tilt"] != 0, values["shear"] != 0, values["size"] != 1
    return next((3 - i for i, step in enumerate(steps) if step), 0)


def _pulled_right(_: Values, at: Array) -> Values:
    return {"turn": float(np.degrees(np.arctan2(at[1], at[0]))), "size": _snap(np.hypot(*at), 1)}


def _pulled_top(values: Values, at: Array) -> Values:
    """Choose shear and tilt: turned back, the top lies at (−shear, −1) / (1 − tilt)."""
    a, k = np.radians(values["turn"]), values["size"]
    x, y = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]]) @ at / k
    w = 1 / max(-y, 0.5)
    return {"tilt": _snap(1 - w, 0), "shear": _snap(-x * w, 0)}


def _snap(value: float, still: float) -> float:
    return still if abs(value - still) < _SNAP else float(value)


def measured(H: Array) -> Array:
    """Return a length, an angle, a tilt of sides, a ratio and a cross-ratio, (5,), after a map."""
    side = apply(H, _SIDE)
    top, middle, low = side[[0, 1, 3]]
    left = apply(H, _SIDE * [-1, 1])
    return np.array([
        np.linalg.norm(low - top),
        _angle(left[0] - top, low - top),
        _angle(left[3] - left[0], low - top),
        np.linalg.norm(middle - top) / np.linalg.norm(low - middle),
        cross_ratio(*to_homogeneous(side)),
    ])  # fmt: skip


def _angle(a: Array, b: Array) -> float:
    """Return the angle between two directions, in degrees."""
    return float(np.degrees(np.arctan2(abs(a[0] * b[1] - a[1] * b[0]), a @ b)))


def _draw(paper: Paper, values: Values) -> Drawing:
    H = matrix(values)
    panel = paper.panel(
        (350, 350), (-2.1, 2.1), (-2.1, 2.1), "pull the square at its right side, and at its top"
    )
    panel.line(_SQUARE, MUTED, 1.2, dash=5)
    if values["tilt"]:  # both sides run on to their vanishing point
        far = apply(H, [[0, 1e6]])[0]
        panel.segments([[end, far] for end in apply(H, _SQUARE[:2] * [1, -1])], MUTED, 0.8)
    steps = np.linspace(-1, 1, 5)
    panel.polygons(apply(H, _SQUARE[:4])[None], "#E3F3EE")
    for v in steps:
        for ends in ([[-1, v], [1, v]], [[v, -1], [v, 1]]):
            panel.line(apply(H, ends), WORLD, 2 if abs(v) == 1 else 0.8)
    panel.line(apply(H, circle(121)), IDEAL, 2.2)
    panel.line(apply(H, _SIDE[[0, 3]]), LENS, 3)
    panel.mark(apply(H, _SIDE), "lens", 5)
    for name, what, place in (
        ("right side", "the right side, to turn and enlarge", _RIGHT),
        ("top", "the top, to shear and tilt", _TOP),
    ):
        at = apply(H, place)
        panel.mark(at, "estimated", 8)
        panel.grip(name, what, at, 4)
    return Drawing(paper.join((panel, _table(paper, H, values))), _sentence(H, values))


def _table(paper: Paper, H: Array, values: Values) -> Panel:
    """Write what was measured before and after the map, orange where it has changed."""
    panel = paper.panel((350, 350), (0, 10), (0, 10), "measured before and after")
    which = kind(values)
    name = f"{_KINDS[which]}: {_NUMBERS[which]} numbers"
    panel.text([0.4, 1], name, IDEAL, size=16)
    for row, (what, form, before, after) in enumerate(_rows(H)):
        same = form.format(before) == form.format(after)
        y = 2.6 + 1.5 * row
        panel.text([0.4, y], what, IDEAL, size=13)
        panel.text([6.6, y], form.format(before), MUTED, anchor="rm", size=13)
        panel.text([7.1, y], "=" if same else "→", IDEAL if same else ESTIMATED, size=13)
        panel.text([9.6, y], form.format(after), IDEAL if same else ESTIMATED, anchor="rm", size=13)
    return panel


def _rows(H: Array) -> list[tuple[str, str, float, float]]:
    both = zip(_MEASURED, measured(np.eye(3)).tolist(), measured(H).tolist(), strict=True)
    return [(what, form, before, after) for (what, form), before, after in both]


def _sentence(H: Array, values: Values) -> str:
    kept = [what for what, form, *both in _rows(H) if len({form.format(x) for x in both}) == 1]
    return f"A map that is {_KINDS[kind(values)]}. As before: {', '.join(kept)}, straight lines."
