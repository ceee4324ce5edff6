"""Explore the maps of the plane: pull a square, and see what each kind of map leaves alone."""

import numpy as np

from cvnotes.base import Array
from cvnotes.projective import apply, cross_ratio, to_homogeneous
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, LENS, MUTED, WORLD

# Where the square is taken hold of.
_RIGHT, _TOP, _CORNER = np.array([1.0, 0]), np.array([0.0, -1]), np.array([1.0, -1])
_SIDE = np.array([[1, -1], [1, 0], [1, 0.5], [1, 1]])  # four points of its right side
_SQUARE = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
# A clock's face: hands for ten past ten, and its hours but for three, where b has its name.
_HOURS = np.array([[np.sin(a), -np.cos(a)] for a in np.radians(np.arange(0, 360, 30))])
_HANDS = [[[0, 0], at] for at in (0.42 * _HOURS[10], 0.64 * _HOURS[2])]
_FACE = np.array([*_HANDS, *([0.74 * at, 0.85 * at] for at in np.delete(_HOURS, 3, axis=0))])
_MEASURED = (
    ("blue side's length", "{:.3f}"),
    ("angle at corner 3", "{:.0f}°"),
    ("blue side : bottom", "{:.3f}"),
    ("angle of opposite sides", "{:.0f}°"),
    ("ab : bd", "{:.3f}"),
    ("cross-ratio", "{:.2f}"),
)
_SNAP = 0.08  # so near to what changes nothing a hand means just that
_WIDE = 2.3  # how far from the middle a hand may pull
# Where the frames of the kinds begin, from the outermost to the innermost, and the rows of each.
_FRAMES = (7, slice(5, 6)), (59, slice(3, 5)), (131, slice(1, 3)), (203, slice(0, 1))
_KINDS = "Euclidean: 3", "similar: 4", "affine: 6", "projective: 8"
_SAID = "A Euclidean map", "A similarity", "An affine map", "A projective map"


def maps_model() -> Model:
    """Make the model of a square with a circle in it, mapped by a matrix of four numbers."""
    settings = (
        Setting("turn", "turn (°)", -180, 180, 5, 20, "allowed to every kind"),
        Setting("size", "size", 0.6, 1.5, 0.05, 1, "1 is Euclidean; else at least a similarity"),
        Setting("shear", "shear", -1, 1, 0.05, 0, "not 0: at least affine"),
        Setting("stretch", "stretch", 0.4, 1.5, 0.05, 1, "not 1: at least affine"),
        Setting("along", "corner, along", -0.5, 0.5, 0.05, 0, "not 0: projective"),
        Setting("up", "corner, up", -0.5, 0.5, 0.05, 0, "not 0: projective"),
    )
    about = """A square clock with a round face, before the map, dashed, and after it; beside it
    four frames, each in the next, for the kinds of maps, with what each keeps, measured on both;
    lit is the kind of this map, and orange is what it has changed."""
    drags = {
        name: lambda values, at, held=held, pull=pull: _inside(held, pull, values, at)
        for name, _, held, pull in _PULLS
    }
    return Model("maps", about, settings, _draw, drags)


def matrix(values: Values) -> Array:
    """Return the map (3, 3): first the corner is moved, then stretch and shear, size and turn."""
    similar, affine, projective = _steps(values)
    return np.asarray(similar @ affine @ projective)


def _steps(values: Values) -> tuple[Array, Array, Array]:
    a, k = np.radians(values["turn"]), values["size"]
    similar = [[k * np.cos(a), -k * np.sin(a), 0], [k * np.sin(a), k * np.cos(a), 0], [0, 0, 1]]
    affine = [[1, values["shear"], 0], [0, values["stretch"], 0], [0, 0, 1]]
    # With the origin in the opposite corner and sides of 1, (1, 1) goes to (s, t); the rest stays.
    s, t = 1 + values["along"] / 2, 1 + values["up"] / 2
    moved = np.array([[s, 0, 0], [0, t, 0], [1 - t, 1 - s, s + t - 1]])
    unit = np.array([[0.5, 0, 0.5], [0, -0.5, 0.5], [0, 0, 1]])
    return np.array(similar), np.array(affine), np.linalg.inv(unit) @ moved @ unit


def kind(values: Values) -> int:
    """Return the first of the four nested kinds that has this map."""
    projective = values["along"] != 0 or values["up"] != 0
    affine = values["shear"] != 0 or values["stretch"] != 1
    steps = projective, affine, values["size"] != 1
    return next((3 - i for i, step in enumerate(steps) if step), 0)


def _to_side(values: Values, at: Array) -> Values:
    _, affine, projective = _steps(values)
    before = apply(affine @ projective, _RIGHT)
    turn = np.arctan2(at[1], at[0]) - np.arctan2(before[1], before[0])
    size = np.hypot(*at) / np.hypot(*before)
    return {"turn": float(np.degrees(turn) + 180) % 360 - 180, "size": _snap(size, 1)}


def _to_top(values: Values, at: Array) -> Values:
    similar, _, projective = _steps(values)
    (x, y), (u, v) = apply(np.linalg.inv(similar), at), apply(projective, _TOP)
    return {"shear": _snap((x - u) / v, 0), "stretch": _snap(y / v, 1)}


def _to_corner(values: Values, at: Array) -> Values:
    similar, affine, _ = _steps(values)
    by = (apply(np.linalg.inv(similar @ affine), at) - _CORNER) * [1, -1]
    along, up = by if np.hypot(*by) > _SNAP else (0, 0)
    return {"along": float(along), "up": float(up)}


# What is pulled, in the words of who cannot see it, where, and what a hand there does.
_PULLS = (
    ("right side", "the right side, to turn and enlarge", _RIGHT, _to_side),
    ("top", "the top, to shear and stretch", _TOP, _to_top),
    ("corner", "the corner, to break the parallels", _CORNER, _to_corner),
)


def _inside(held: Array, pull: Drag, values: Values, at: Array) -> Values:
    """Follow a hand, but only so far that no corner leaves the panel."""
    start = apply(matrix(values), held)
    for part in (1, 0.75, 0.5, 0.25):
        goal = start + part * (at.clip(-_WIDE, _WIDE) - start)
        pulled = {**values, **pull(values, goal)}
        if (np.abs(apply(matrix(pulled), _SQUARE)) <= _WIDE).all():
            return pulled
    return {}


def _snap(value: float, still: float) -> float:
    return still if abs(value - still) < _SNAP else float(value)


def measured(H: Array) -> Array:
    """Return a length, two angles, two ratios and a cross-ratio, (6,), after a map."""
    side, corners = apply(H, _SIDE), apply(H, _SQUARE)
    top, middle, low = side[[0, 1, 3]]
    across, right, back, left = corners[1:] - corners[:-1]  # no hand on 3 moves the bottom, back
    return np.array([
        np.linalg.norm(low - top),
        _angle(-across, right),
        np.linalg.norm(right) / np.linalg.norm(back),
        max(_angle(across, -back), _angle(right, -left)),
        np.linalg.norm(middle - top) / np.linalg.norm(low - middle),
        cross_ratio(*to_homogeneous(side)),
    ])  # fmt: skip


def _angle(a: Array, b: Array) -> float:
    """Return the angle between two directions, in degrees."""
    return float(np.degrees(np.arctan2(abs(a[0] * b[1] - a[1] * b[0]), a @ b)))


def _draw(paper: Paper, values: Values) -> Drawing:
    H = matrix(values)
    wide = max(2.5, 1.2 * float(np.abs(apply(H, _SQUARE)).max()))  # more by sliders, not by hand
    panel = paper.panel((380, 380), (-wide, wide), (-wide, wide), "pull the clock at its crosses")
    panel.line(_SQUARE, MUTED, 1.2, dash=5)
    for way in np.eye(3)[:2]:  # sides that are no longer parallel run on to where they meet
        far = H @ way
        if abs(far[2]) > 1e-9:
            starts = apply(H, _SQUARE[:4])
            panel.segments([[start, far[:2] / far[2]] for start in starts], MUTED, 0.8)
    panel.polygons(apply(H, _SQUARE[:4])[None], "#BFE3D7")
    panel.line(apply(H, _SQUARE), WORLD, 2)
    panel.polygons(apply(H, circle(121))[None], "white")
    panel.line(apply(H, circle(121)), IDEAL, 2.2)
    panel.segments(apply(H, _FACE), IDEAL, 3.5)
    panel.line(apply(H, _SIDE[[0, 3]]), LENS, 3)
    panel.mark(apply(H, _SIDE), "lens", 5)
    for name, place, away in zip("abcd", _SIDE, (25, 25, 14, 14), strict=True):
        inwards = apply(H, place - [0.5, 0]) - apply(H, place)  # clear of marks and rings
        at = apply(H, place) + away * panel.pixel * inwards / np.hypot(*inwards)
        panel.text(at, name, LENS, anchor="mm", size=14)
    for number, (name, what, place, _) in enumerate(_PULLS, 1):
        at = apply(H, place)
        away = at - apply(H, [0, 0])
        away *= 0.132 * wide / np.hypot(*away)
        panel.text(at + away, f"{number}", ESTIMATED, anchor="mm", size=15)
        panel.mark(at, "estimated", 8)
        panel.grip(name, what, at, 4)
    return Drawing(paper.join((panel, _table(paper, H, values))), _sentence(H, values))


def _table(paper: Paper, H: Array, values: Values) -> Panel:
    """Draw the four kinds as frames, each in the next, with what each keeps; lit is the map's."""
    panel = paper.panel((350, 380), (0, 280), (0, 304), "measured before → after")
    rows, which = _rows(H), kind(values)
    for i, (top, kept) in enumerate(_FRAMES):
        x, y = 7 + 10 * i, 297 - 11 * i
        frame = np.array([[x, top], [280 - x, top], [280 - x, y], [x, y], [x, top]])
        lit, name = 3 - i == which, f"{_KINDS[3 - i]} numbers"
        rim, ink, width = ("#E3F3EE", WORLD, 2.5) if lit else ("white", FAINT, 1)
        panel.polygons([frame], rim)
        panel.line(frame, ink, width)
        panel.text([x + 9, top + 17], name, IDEAL if lit else MUTED, size=15, rim=rim)
        for y, (what, form, before, after) in zip((38, 57), rows[kept], strict=False):
            same = form.format(before) == form.format(after)
            ink, said = (IDEAL, "=") if same else (ESTIMATED, "→")
            panel.text([x + 9, top + y], what, ink, size=13, rim=rim)
            words = f"{form.format(before)} {said} {form.format(after)}"
            panel.text([271 - x, top + y], words, ink, anchor="rm", size=13, rim=rim)
    return panel


def _rows(H: Array) -> list[tuple[str, str, float, float]]:
    both = zip(_MEASURED, measured(np.eye(3)).tolist(), measured(H).tolist(), strict=True)
    return [(what, form, before, after) for (what, form), before, after in both]


def _sentence(H: Array, values: Values) -> str:
    changed = [what for what, form, *both in _rows(H) if len({form.format(x) for x in both}) > 1]
    return f"{_SAID[kind(values)]}. It has changed: {', '.join(changed) or 'none of these'}."
