"""Explore where a lens ends: a growing disc that the polynomial folds over at the lens's rim."""

from itertools import pairwise

import numpy as np

from cvnotes.camera import Lens
from cvnotes.show.explorations.lens import bent_room, draw_fold, polynomial, seen_radius
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, LENS, MUTED

_LENS, _BESIDE = (470, 430), (270, 201)
_HALF = 0.417  # of the lens's panel: for k1 = −4/3 the rim fills 80 % of its height
_SHOWN = 0.95  # of the plane z = 1, to above and below its middle
_RADIUS = 0.95  # of the curve
_Tints = tuple[tuple[str, str], tuple[str, str]]
_NET, _SPOKES = 0.1, 24  # how wide a ring of cells is, and how many cells are in it
_BLUE, _ORANGE, _GREY = (
    (("#EFF6FB", "#DDECF6"), ("#B4D6EB", "#8FC2E2")),
    (("#FCE6D6", "#F9D3B8"), ("#F8B98A", "#F39B5E")),
    (("#F4F4F4", "#E6E6E6"), ("#C4C4C4", "#A8A8A8")),
)  # cells of the disc by turns, and of its outermost ring


def rim_model() -> Model:
    """Make the model of a disc of the plane z = 1, and of what a polynomial makes of it."""
    settings = (
        Setting("ring", "r", 0.1, 0.87, 0.01, 0.7, "the ideal radius of the disc"),
        Setting("k1", "k₁", -1.5, 0, 0.01, -1.33, "radial"),
    )
    about = """A room through a lens, and on it a disc of cells. Up to the lens's rim it is blue;
    what the polynomial folds back over it is orange. Beside it the same disc on the plane z = 1,
    and the observed radius against the ideal one."""
    drags = {"ring": lambda _, at: {"ring": float(np.hypot(*at))}}
    return Model("rim", about, settings, _draw, drags)


def _draw(paper: Paper, values: Values) -> Drawing:
    lens, r = Lens((values["k1"],)), values["ring"]
    seen = float(seen_radius(lens, np.array(r)))
    other = _other(lens, r, seen)
    column = [_plane(paper, lens, r), _curve(paper, lens, r, other)]
    drawn = paper.join((_seen(paper, lens, r, other), column))
    return Drawing(drawn, _sentence(lens, r, seen, other))


def _other(lens: Lens, r: float, seen: float) -> float:
    """Return the radius that the lens shows where it would draw r beyond its fold, or NaN."""
    if r <= lens.max_radius:
        return np.nan
    return float(lens.undistort([abs(seen), 0.0])[0])


def _seen(paper: Paper, lens: Lens, r: float, other: float) -> Panel:
    x = _HALF * _LENS[0] / _LENS[1]
    panel = paper.panel(_LENS, (-x, x), (-_HALF, _HALF), "what the polynomial makes of the disc")
    panel.image(bent_room(lens, panel.x, panel.y, _LENS, paper.sharpness, 0.65))
    end, folds = min(r, lens.max_radius), r > lens.max_radius
    _disc(panel, lens, (0, float(np.nan_to_num(other)) if folds else r), _BLUE, not folds)
    if folds:
        _disc(panel, lens, (end, r), _ORANGE, True)
    for s in np.arange(_NET, end, _NET):
        panel.line(polynomial(lens, s * circle(91)), LENS, 0.7)
    spokes = np.stack([s * circle(_SPOKES + 1) for s in (_NET, end)], axis=1)
    panel.segments(polynomial(lens, spokes), LENS, 0.7)
    draw_fold(panel, lens)
    panel.line(polynomial(lens, r * circle(121)), ESTIMATED if folds else LENS, 3)
    panel.mark(polynomial(lens, np.array([r, 0])), "estimated" if folds else "lens", 9)
    return panel


def _disc(
    panel: Panel, lens: Lens, ends: tuple[float, float], tints: _Tints, outermost: bool
) -> None:
    """Lay the cells between two radii over the panel, the last ring in stronger tints."""
    start, end = ends
    last = max(end - _NET, start) if outermost else end
    radii = [*np.arange(start, last - 1e-9, _NET), last, *[end] * int(last < end)]
    turn = np.linspace(0, 2 * np.pi, 4 * _SPOKES + 1)
    arcs = [polynomial(lens, s * circle(len(turn))) for s in radii]
    panes, colours = [], []
    for k, (low, high) in enumerate(pairwise(arcs)):
        pair = tints[int(outermost and k == len(arcs) - 2)]
        for i in range(_SPOKES):
            cell = slice(4 * i, 4 * i + 5)
            panes.append(np.concatenate([low[cell], high[cell][::-1]]))
            colours.append(pair[(i + k) % 2])
    if panes:
        panel.veil(panes, colours)


def _plane(paper: Paper, lens: Lens, r: float) -> Panel:
    x = _SHOWN * _BESIDE[0] / _BESIDE[1]
    panel = paper.panel(_BESIDE, (-x, x), (-_SHOWN, _SHOWN), "plane z = 1: pull the plus")
    panel.image(bent_room(Lens(), panel.x, panel.y, _BESIDE, paper.sharpness, 0.65))
    _disc(panel, Lens(), (0, r), _GREY, True)
    panel.line(r * circle(121), MUTED, 1.5)
    if lens.max_radius < r:
        panel.line(lens.max_radius * circle(121), ESTIMATED, 1.5)
    panel.grip("ring", "the radius of the disc", [r, 0], 2, "ideal", 9)
    return panel


def _curve(paper: Paper, lens: Lens, r: float, other: float) -> Panel:
    panel = paper.panel(_BESIDE, (0, _RADIUS), (0.45, -0.2), "observed radius against r")
    panel.line([[0.0, 0.0], [_RADIUS, 0.0]], FAINT, 1)
    if np.isfinite(lens.max_radius) and lens.max_radius < _RADIUS:
        fold, top = lens.max_radius, float(seen_radius(lens, np.array(lens.max_radius)))
        back = lens.max_radius * float(np.sqrt(3))  # where r L(r) is 0 again
        panel.line(np.array([[0, top], [fold, top], [fold, 0]]), MUTED, 0.8, dash=3)
        panel.text([0.02, top - 0.01], f"{top:.2f}", anchor="ld", size=11)
        for x in (fold, back):
            if abs(x - r) > 0.13 and x < _RADIUS - 0.05:  # the curve falls to the right of it
                panel.text([x, -0.04], f"{x:.2f}", anchor="ra", size=11)
    end = min(lens.max_radius, _RADIUS)
    for start, stop, ink in ((0, end, LENS), (end, _RADIUS, ESTIMATED)):
        along = np.linspace(start, stop, 61)
        panel.line(np.stack([along, seen_radius(lens, along)], -1), ink, 2.5)
    seen = float(seen_radius(lens, np.array(r)))
    panel.line(np.array([[r, 0], [r, seen]]), IDEAL, 1)
    if seen > 0:
        panel.line(np.array([[r, seen], [other, seen]]), ESTIMATED, 1, dash=4)
    panel.mark([r, 0], "ideal", 6)
    by, anchor = (-0.05, "ma") if seen > 0 else (0.05, "md")
    panel.text([r, by], f"{r:.2f}", IDEAL, anchor=anchor, size=12)
    panel.mark([r, seen], "lens" if r <= lens.max_radius else "estimated", 8)
    return panel


def _sentence(lens: Lens, r: float, seen: float, other: float) -> str:
    ends = "Nothing folds."
    if np.isfinite(lens.max_radius):
        top = float(seen_radius(lens, np.array(lens.max_radius)))
        ends = f"The lens ends at r = {lens.max_radius:.2f}, seen at {top:.2f}."
    if r <= lens.max_radius:
        return f"{ends} The disc of radius {r:.2f} is seen up to {seen:.2f}."
    said = f"{ends} The polynomial draws the edge of the disc, r = {r:.2f}, at {seen:.2f}"
    if seen < 0:
        return f"{said}, beyond the middle."
    return f"{said}, where r = {other:.2f} is seen."
