"""Explore a decentred lens: pull its second piece of glass aside, beside a tilted sensor."""

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Lens
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import CAMERA, IDEAL, LENS

_SIZE, _TILTED, _X = (470, 470), (330, 260), 0.76  # px of the panels; how far both show x
_EXTENT, _TIMES = 0.5, 3  # of the grid; each point is moved so many times as far
_BESIDE = 0.58  # how far from the centre three points are pointed out, outside of the grid
_RULER = 0.35, 0.5  # how far along p it lies, and how far it reaches to both sides
_KAPPA, _RIM = 0.25, 0.46  # of the glass: how strongly it pulls inwards, p = κ δ; its radius
_F = 800  # px, in which a bow is told
_SIDE, _GLASS, _PLATE = (330, 182), "#E4F2FB", "#A6A6A6"  # of the panel from the side, in px
_FIRST, _SECOND, _SENSOR, _AXIS = 60, 150, 290, 91  # px: where two pieces of glass stand
_SLOPE, _FOCAL, _LONG = 0.32, 230, 100  # of the two rays; px: of the plane z = 1, and a δ of 1


def decentred_model() -> Model:
    """Make the model of a grid through a lens with tangential terms alone."""
    settings = (
        Setting("down", "δ down", -0.2, 0.2, 0.004, 0.16, "the glass's shift, four times p₁"),
        Setting("right", "δ to the right", -0.2, 0.2, 0.004, 0, "the glass's shift, four times p₂"),
    )
    about = """A grid through a lens whose second piece of glass, light blue, is shifted by δ: its
    tangential terms alone, each point moved three times as far. A ruler shows by how much a line
    across δ bows. Beside it both pieces from the side, with two rays of the centred lens, dashed,
    and of the shifted one; and the grid on a tilted sensor."""

    return Model("decentred", about, settings, _draw, {"glass": placed("right", "down")})


def decentred(p: Array, xy: Array) -> Array:
    """Return where a lens with p = (p2, p1) shows points (..., 2)."""
    return Lens(p=(float(p[1]), float(p[0]))).distort(xy)


def tilted(p: Array, xy: Array) -> Array:
    """Return where a tilted sensor shows points (..., 2): to first order 2 (p · d) d farther."""
    return np.asarray(xy / (1 - 2 * xy @ p)[..., None])


def bow(line: Array) -> float:
    """Return how far the middle of a line (n, 2) lies off the straight one through its ends."""
    way, middle = line[-1] - line[0], line[len(line) // 2] - line[0]
    return float(abs(way[0] * middle[1] - way[1] * middle[0]) / np.hypot(*way))


def _draw(paper: Paper, values: Values) -> Drawing:
    delta = np.array([values["right"], values["down"]])
    p, high = _KAPPA * delta, _X * _TILTED[1] / _TILTED[0]
    lens = paper.panel(_SIZE, (-_X, _X), (-_X, _X), "what the shift adds, 3 times too long")
    sensor = paper.panel(_TILTED, (-_X, _X), (-high, high), "a tilted sensor, 3 times too much")
    rim = delta + _RIM * circle(73)
    lens.polygons([rim], _GLASS)
    lens.line(rim, CAMERA, 1.5)
    bows = [_bent(panel, p, move) for panel, move in ((lens, decentred), (sensor, tilted))]
    _point_out(lens, p)
    ahead, across = _along(p)
    lens.arrows([0, 0], delta, IDEAL, 3)
    lens.mark([0, 0], "ideal", 7)
    lens.polygons([delta + 5 * lens.pixel * circle(25)], IDEAL)
    lens.text(delta + lens.pixel * (12 * ahead - 22 * across), "δ", IDEAL, anchor="mm", size=19)
    lens.grip("glass", "the middle of the second piece of glass", delta, 1)
    x, y = delta.round(3) + 0.0
    words = f"""δ = ({x:g}, {y:g}), p₁ = {p[1]:.3f}, p₂ = {p[0]:.3f}: at a focal length of {_F} px
    the line across δ bows by {bows[0]:.1f} px, and by {bows[1]:.1f} px on the tilted sensor."""
    side = -1 if tuple(delta[::-1]) < (0, 0) else 1  # as in the picture: down is down
    aside = _aside(paper, side * float(np.hypot(*delta)))
    return Drawing(paper.join((lens, [aside, sensor])), words)


def _aside(paper: Paper, delta: float) -> Panel:
    """Draw both pieces of glass from the side, and how the shift of one turns two rays."""
    panel = paper.panel(_SIDE, (0, _SIDE[0]), (0, _SIDE[1]), "from the side; dashed: not shifted")
    panel.line([[0, _AXIS], [_SIDE[0], _AXIS]], "#999999", 1, dash=4)
    centre = np.array([_SECOND, _AXIS + _LONG * delta])
    turn = np.linspace(-1, 1, 31)
    for at, tall in (np.array([_FIRST, _AXIS]), 34), (centre, 60):
        side = np.column_stack([13 * (1 - turn**2), tall * turn])
        face = np.concatenate([at + side, (at + side * [-1, 1])[::-1]])
        panel.polygons([face], _GLASS)
        panel.line(face[[*range(len(face)), 0]], CAMERA, 1.5)
    panel.line([[_SENSOR, 5], [_SENSOR, _SIDE[1] - 5]], _PLATE, 5)
    for slope in (-_SLOPE, _SLOPE):
        panel.line(side_ray(slope, 0)[1:], IDEAL, 1.3, dash=4)
        panel.line(side_ray(slope, delta), LENS, 2.4)
        panel.mark(side_ray(slope, delta)[-1], "lens", 6)
    if delta:
        panel.arrows([_SECOND, _AXIS], [0, _LONG * delta], IDEAL, 2.5)
        panel.text([_SECOND + 26, _AXIS + _LONG * delta / 2], "δ", IDEAL, anchor="mm", size=19)
    return panel


def side_ray(slope: float, delta: float) -> Array:
    """Return a ray (3, 2) through the middle of the first piece, bent by the second, shifted by δ.

    It is bent three times as much as by the lens of κ, barrel and tangential terms.
    """
    lens = Lens(k=(-_TIMES * _KAPPA,), p=(_TIMES * _KAPPA * delta, 0))
    met = _FOCAL * float(lens.distort([0, slope])[1])
    before = slope * (np.array([0, _SECOND]) - _FIRST)
    return np.column_stack([[0, _SECOND, _SENSOR], _AXIS + np.array([*before, met])])


def _point_out(panel: Panel, p: Array) -> None:
    """Draw two points across p, which move across their rays, and one along p, as its ray does."""
    ahead, across = _along(p)
    points = _BESIDE * np.array([across, -across, ahead])
    for point in points:
        panel.line([[0, 0], point], IDEAL, 1.2, dash=4, rim=2.8)
    panel.arrows(points, decentred(_TIMES * p, points) - points, IDEAL, 3.5)
    asides = -20 * ahead, -20 * ahead, 30 * across + 14 * ahead
    for at, aside, words in zip(points, asides, ("r²p", "r²p", "3r²p"), strict=True):
        panel.text(at + panel.pixel * aside, words, IDEAL, anchor="mm", size=15)


def _along(p: Array) -> tuple[Array, Array]:
    """Return the direction of p, downwards if it has none, and the one across it."""
    ahead = p / np.hypot(*p) if p.any() else np.array([0.0, 1])
    return ahead, np.array([ahead[1], -ahead[0]])


def _bent(panel: Panel, p: Array, move: Callable[[Array, Array], Array]) -> float:
    """Draw the grid and what becomes of it; return by how many px a line across p bows."""
    fine, coarse = (np.linspace(-_EXTENT, _EXTENT, n) for n in (49, 11))
    across = np.stack(np.meshgrid(fine, coarse), -1)
    lines = [*across, *across[..., ::-1]]
    panel.segments([line[[0, -1]] for line in lines], "#D4D4D4", 1)
    for line in lines:
        panel.line(move(_TIMES * p, line), LENS, 1.6)
    ahead, across_p = _along(p)
    ruled = _RULER[0] * ahead + np.outer(np.linspace(-_RULER[1], _RULER[1], 49), across_p)
    seen = move(_TIMES * p, ruled)
    panel.line(seen, LENS, 4)
    panel.line(seen[[0, -1]], IDEAL, 2)
    return _F * bow(move(p, ruled))
