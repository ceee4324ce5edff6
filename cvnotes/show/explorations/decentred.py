"""Explore a decentred lens: pull the direction of its tangential terms, beside a tilted sensor."""

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Lens
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import CAMERA, IDEAL, LENS

_SIZE, _SHOWN = (372, 400), ((-0.84, 0.84), (-0.903, 0.903))
_EXTENT, _TIMES = 0.5, 3  # of the grid; each point is moved so many times as far
_BESIDE = 0.63  # how far from the centre three points are pointed out, outside of the grid
_RULER = 0.35, 0.5  # how far along p it lies, and how far it reaches to both sides
_ARROW = 4  # how much longer than p its arrow is
_F = 800  # px, in which a bow is told
_SIDE, _PLATE = (372, 96), "#A6A6A6"  # of the panels that show lens and sensor from the side: px
_FIRST, _SECOND, _SENSOR, _AXIS = 110, 180, 330, 48  # px: where two pieces of glass stand
_ASIDE, _FOCAL = 300, 110  # px: how far the second is aside for a p of 1; its focal length
_STEEP = 0.14  # slope of the rays to a tilted sensor


def decentred_model() -> Model:
    """Make the model of a grid through a lens with tangential terms alone."""
    settings = (
        Setting(
            "p1", "p₁", -0.05, 0.05, 0.001, 0.04, "an element of the lens off the axis, along y"
        ),
        Setting("p2", "p₂", -0.05, 0.05, 0.001, 0, "an element of the lens off the axis, along x"),
    )
    about = (
        "A grid through a lens with tangential terms alone, each point moved three times as far, "
        "with the direction p in black. Beside it the same grid on a tilted sensor. A ruler shows "
        "by how much a line across p bows. Below, both from the side: two pieces "
        "of glass, one aside, and a sensor askew."
    )

    def pulled(_: Values, at: Array) -> Values:
        return {"p1": float(at[1] / _ARROW), "p2": float(at[0] / _ARROW)}

    return Model("decentred", about, settings, _draw, {"p": pulled})


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
    p = np.array([values["p2"], values["p1"]])
    lens = paper.panel(_SIZE, *_SHOWN, "a decentred lens, each point moved 3 times as far")
    sensor = paper.panel(_SIZE, *_SHOWN, "a tilted sensor, also 3 times as far")
    bows = [_bent(panel, p, move) for panel, move in ((lens, decentred), (sensor, tilted))]
    _point_out(lens, p)
    tip = _ARROW * p
    lens.arrows([0, 0], tip, IDEAL, 2.5)
    lens.mark([0, 0], "ideal", 5)
    lens.polygons([tip + 6 * lens.pixel * circle(25)], IDEAL)
    lens.text(tip + 18 * lens.pixel * _along(p)[1], "p", IDEAL, anchor="mm", size=17)
    lens.grip("p", "the direction of the tangential terms", tip, 1)
    size = float(np.hypot(*p))
    below = _glass(paper, size), _askew(paper, size)
    words = (
        f"p₁ = {values['p1']:.3f}, p₂ = {values['p2']:.3f}: at a focal length of {_F} px the line "
        f"across p bows by {bows[0]:.1f} px, and by {bows[1]:.1f} px on the tilted sensor."
    )
    return Drawing(paper.join((lens, sensor), below), words)


def _glass(paper: Paper, p: float) -> Panel:
    """Draw two pieces of glass from the side, and the ray on the axis of the first."""
    panel = paper.panel(
        _SIDE, (0, _SIDE[0]), (0, _SIDE[1]), "from the side: two pieces of glass, one aside"
    )
    _piece(panel, np.array([_FIRST, _AXIS]))
    _piece(panel, np.array([_SECOND, _AXIS + _ASIDE * p]))
    panel.line([[_SENSOR, 6], [_SENSOR, _SIDE[1] - 6]], _PLATE, 4)
    panel.line(axis_ray(p), LENS, 2.2)
    panel.mark(axis_ray(p)[-1], "lens", 5)
    return panel


def axis_ray(p: float) -> Array:
    """Return the way (3, 2) of the ray on the first one's axis: only the second bends it."""
    run = _SENSOR - _SECOND
    return np.array([[0, _AXIS], [_SECOND, _AXIS], [_SENSOR, _AXIS + run * _ASIDE * p / _FOCAL]])


def _askew(paper: Paper, p: float) -> Panel:
    """Draw a piece of glass from the side, rays through its middle, and a tilted sensor."""
    panel = paper.panel(_SIDE, (0, _SIDE[0]), (0, _SIDE[1]), "from the side: the sensor askew")
    _piece(panel, np.array([_FIRST, _AXIS]))
    panel.line([[_SENSOR, 6], [_SENSOR, _SIDE[1] - 6]], "#999999", 1, dash=4)
    for ends in tilted_rays(p):
        panel.line(
            [[0, _AXIS - _FIRST * (ends[1, 1] - _AXIS) / (ends[1, 0] - _FIRST)], *ends], LENS, 1.8
        )
    met = tilted_rays(p)[:, 1]
    panel.line(met[0] + np.outer([-0.15, 1.15], met[-1] - met[0]), _PLATE, 4)
    panel.mark(met, "lens", 5)
    return panel


def tilted_rays(p: float) -> Array:
    """Return the ways (3, 2, 2) from the middle of the glass to a sensor, tilted 3 times as far."""
    slopes = np.array([-_STEEP, 0, _STEEP])
    far = (_SENSOR - _FIRST) / (1 - 2 * _TIMES * p * slopes)
    met = np.column_stack([_FIRST + far, _AXIS + slopes * far])
    return np.stack([np.broadcast_to([_FIRST, _AXIS], met.shape), met], axis=1)


def _piece(panel: Panel, at: Array) -> None:
    """Draw a piece of glass from the side, and the axis of the first."""
    panel.line([[0, _AXIS], [_SIDE[0], _AXIS]], "#999999", 1, dash=4)
    turn = np.linspace(-1, 1, 31)
    side = np.column_stack([9 * (1 - turn**2), 22 * turn])
    face = np.concatenate([at + side, (at + side * [-1, 1])[::-1]])
    panel.polygons([face], "#DDEFFA")
    panel.line(face[[*range(len(face)), 0]], CAMERA, 1.5)
    panel.mark(at, "ideal", 3)


def _point_out(panel: Panel, p: Array) -> None:
    """Draw two points across p, which move across their rays, and one along p, as its ray does."""
    ahead, across = _along(p)
    points = _BESIDE * np.array([across, -across, ahead])
    for point in points:
        panel.line([[0, 0], point], "#FFFFFF", 4)
        panel.line([[0, 0], point], IDEAL, 1.2, dash=4)
    panel.arrows(points, decentred(_TIMES * p, points) - points, IDEAL, 3.5)
    for at, aside, words in (
        (points[0], -20 * ahead, "r²p"),
        (points[1], -20 * ahead, "r²p"),
        (points[2], 30 * across, "3r²p"),
        (0.5 * points[0], -18 * ahead, "across p"),
        (0.76 * points[2], 40 * across, "along p"),
    ):
        panel.text(at + panel.pixel * aside, words, IDEAL, anchor="mm", size=14)


def _along(p: Array) -> tuple[Array, Array]:
    """Return the direction of p, downwards if it has none, and the one across it."""
    ahead = p / np.hypot(*p) if p.any() else np.array([0.0, 1])
    return ahead, np.array([ahead[1], -ahead[0]])


def _bent(panel: Panel, p: Array, move: Callable[[Array, Array], Array]) -> float:
    """Draw the grid and what becomes of it; return by how many px a line across p bows."""
    fine, coarse = (np.linspace(-_EXTENT, _EXTENT, n) for n in (49, 11))
    across = np.stack(np.meshgrid(fine, coarse), -1)
    lines = [*across, *across[..., ::-1]]
    for line in lines:
        panel.line(line[[0, -1]], "#D4D4D4", 1)
    for line in lines:
        panel.line(move(_TIMES * p, line), LENS, 1.6)
    ahead, across_p = _along(p)
    ruled = _RULER[0] * ahead + np.outer(np.linspace(-_RULER[1], _RULER[1], 49), across_p)
    seen = move(_TIMES * p, ruled)
    panel.line(seen, LENS, 4)
    panel.line(seen[[0, -1]], IDEAL, 2)
    px = _F * bow(move(p, ruled))
    words = f"the line across p bows by {px:.1f} px (drawn: {_TIMES * px:.0f})"
    panel.text([0, 0.86], words, IDEAL, anchor="mm", size=14)
    return px
