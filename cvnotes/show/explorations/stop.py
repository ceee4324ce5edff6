"""Explore why a lens bends lines: a stop before and behind it, and each ray through the glass."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Lens
from cvnotes.show.explorations.lens import bent_room
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS

# One lens of glass, the same on both sides, in mm; its middle is at 0.
_INDEX, _RADIUS, _THICK, _RIM = 1.5, 100.0, 10.0, 28.0
_POWER = 2 * (_INDEX - 1) / _RADIUS - (_INDEX - 1) ** 2 * _THICK / (_INDEX * _RADIUS**2)
FOCAL = 1 / _POWER
_PRINCIPAL = _THICK / 2 - FOCAL * (_INDEX - 1) * _THICK / (_INDEX * _RADIUS)
SENSOR = _PRINCIPAL + FOCAL  # where an ideal lens of this focal length shows what is far away

_DRAWN = np.array([-0.5, -0.25, 0, 0.25, 0.5])  # the ideal radii of the rays
_STEEPEST = 1.0, 0.5  # slopes at the stop of the rays the picture is made of; within the glass
_ACROSS, _DOWN, _SIZE = (-62.0, 112.0), 66.0, (520, 394)  # mm, mm, px
_ROOM, _FACTOR = (340, 226), (340, 140)  # px
_FAR, _LEAST, _MOST = 0.62, 0.9, 1.12  # of the curve: r, and from where to where L
_HANDLE = -42.0  # mm: where the stop is taken hold of
_HALF = 0.5  # of the plane z = 1, to above and below its middle
_EDGE = np.array([[x, 1600, 4500] for x in np.linspace(-2500, 2500, 51)])  # of the tiles, mm
_GLASS, _PLATE = "#DDEFFA", "#A6A6A6"


def stop_model() -> Model:
    """Make the model of a stop that is carried through a lens."""
    settings = (Setting("stop", "the stop (mm)", -15, 15, 1, -15, "negative: before the lens"),)
    about = """A lens, cut in two, with a stop and the sensor: rays through the middle of the stop,
    bent by the glass, in blue, and dashed where an ideal lens would send them. Beside it the
    picture of a room that arises so, and below it, over the ideal radius r, L: the observed radius
    of each ray divided by the ideal one."""
    return Model("stop", about, settings, _draw, {"stop": placed("stop")})


def trace(stop: float, slopes: Array) -> tuple[Array, Array]:
    """Follow rays through the middle of a stop in both directions, out of the glass.

    Parameters
    ----------
    stop : float
        Where the stop is on the axis, in mm from the lens's middle.
    slopes : ndarray, shape (n,)
        The rays' slopes at the stop.

    Returns
    -------
    before, behind : ndarray, shape (n, 2, 2)
        Where each ray meets the lens or the stop last, and its direction there, with a 1 along
        the axis: towards the room, and towards the sensor.
    """
    d = np.column_stack([np.ones_like(slopes), slopes])
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    start = np.column_stack([np.full_like(slopes, stop), 0 * slopes])
    ends = []
    for side in (-1, 1):
        at, way, out = start, side * d, side * _THICK / 2
        if abs(stop) <= _THICK / 2:  # the stop is within the glass
            at, way = _through(at, way, out, _INDEX)
        elif side * stop < 0:  # the lens lies ahead
            at, way = _through(*_through(at, way, -out, 1 / _INDEX), out, _INDEX)
        ends.append(np.stack([at, way / way[:, :1]], axis=1))
    return ends[0], ends[1]


def _through(at: Array, way: Array, face: float, ratio: float) -> tuple[Array, Array]:
    """Carry rays on to one face of the lens, and break them there by Snell's law."""
    centre = np.array([face - np.sign(face) * _RADIUS, 0.0])
    o = at - centre
    along = (o * way).sum(axis=1)
    root = np.sqrt(along**2 - (o * o).sum(axis=1) + _RADIUS**2)
    ends = [at + (-along + sign * root)[:, None] * way for sign in (-1, 1)]
    near = np.abs(ends[0][:, 0] - face) < np.abs(ends[1][:, 0] - face)
    met = np.where(near[:, None], *ends)
    normal = (met - centre) / _RADIUS
    cosine = (way * normal).sum(axis=1)
    normal, cosine = normal * np.sign(cosine)[:, None], np.abs(cosine)
    broken = np.sqrt(1 - ratio**2 * (1 - cosine**2)) - ratio * cosine
    return met, ratio * way + broken[:, None] * normal


def radii(stop: float, slopes: Array) -> tuple[Array, Array]:
    """Return the ideal and the observed radius of rays with some slopes at the stop."""
    before, behind = trace(stop, slopes)
    on_sensor = behind[:, 0, 1] + (SENSOR - behind[:, 0, 0]) * behind[:, 1, 1]
    return before[:, 1, 1], on_sensor / FOCAL


@lru_cache(maxsize=64)
def lens_of(stop: float) -> Lens:
    """Return the polynomial that comes nearest to what the traced rays do."""
    steepest = _STEEPEST[int(abs(stop) <= _THICK / 2)]
    r, seen = radii(stop, np.linspace(0.01, steepest, 80))
    powers = r[:, None] ** [3, 5, 7, 9]
    k = np.linalg.lstsq(powers, seen - r, rcond=None)[0]
    return Lens(tuple(k.tolist()))


def _draw(paper: Paper, values: Values) -> Drawing:
    stop = values["stop"]
    slopes = np.linspace(-0.7, 0.7, 281)
    slopes = np.interp(_DRAWN, radii(stop, slopes)[0], slopes)
    seen = radii(stop, slopes)[1]
    cut = paper.panel(_SIZE, _ACROSS, (-_DOWN, _DOWN), "a lens, cut in two: pull the stop")
    _draw_lens(cut)
    _draw_rays(cut, stop, slopes, seen)
    _draw_stop(cut, stop)
    lens, x = lens_of(stop), _HALF * _ROOM[0] / _ROOM[1]
    room = paper.panel(_ROOM, (-x, x), (-_HALF, _HALF), "the picture, turned upright")
    room.image(bent_room(lens, room.x, room.y, _ROOM, paper.sharpness, 1))
    edge = lens.distort(_EDGE[:, :2] / _EDGE[:, 2:])
    room.line(edge[[0, -1]], IDEAL, 1.5)
    room.line(edge, LENS, 3)
    column = [room, _factor(paper, stop, slopes)]
    return Drawing(paper.join((cut, column)), _sentence(stop, float(seen[-1])))


def _draw_lens(panel: Panel) -> None:
    """Draw axis, glass and sensor."""
    panel.line(np.array([[_ACROSS[0], 0], [_ACROSS[1], 0]]), "#BBBBBB", 0.8)
    y = np.linspace(-_RIM, _RIM, 57)
    bulge = _THICK / 2 - _RADIUS + np.sqrt(_RADIUS**2 - y * y)
    glass = np.concatenate([np.column_stack([-bulge, y]), np.column_stack([bulge, y])[::-1]])
    panel.polygons([glass], _GLASS)
    panel.line(glass[[*range(len(glass)), 0]], CAMERA, 1.5)
    panel.line([[SENSOR, -_DOWN + 4], [SENSOR, _DOWN - 4]], _PLATE, 4)
    panel.text([SENSOR - 3, _DOWN - 5], "sensor", "#333333", anchor="rm", size=13)


def _draw_rays(panel: Panel, stop: float, slopes: Array, seen: Array) -> None:
    """Draw each ray from the room to the sensor, and where an ideal lens would send it."""
    before, behind = trace(stop, slopes)
    origin = np.column_stack([np.full_like(slopes, _ACROSS[0]), before[:, 0, 1]])
    origin[:, 1] += (_ACROSS[0] - before[:, 0, 0]) * before[:, 1, 1]
    sensed = np.column_stack([np.full_like(seen, SENSOR), FOCAL * seen])
    meant = np.column_stack([np.full_like(seen, SENSOR), FOCAL * _DRAWN])
    left = np.column_stack([np.full_like(seen, max(stop, _PRINCIPAL)), 0 * seen])
    left[:, 1] = -_DRAWN * min(stop + _PRINCIPAL, 0)
    middle = np.column_stack([np.full_like(seen, stop), 0 * seen])
    for way in np.stack([origin, before[:, 0], middle, behind[:, 0], sensed], axis=1):
        panel.line(way, LENS, 1.8)
    for ends in np.stack([left, meant], axis=1):
        panel.line(ends, IDEAL, 1, dash=4)
    panel.mark(meant, "ideal", 7)
    panel.mark(sensed, "lens", 5)


def _draw_stop(panel: Panel, stop: float) -> None:
    for side in (-1, 1):
        panel.line([[stop, 2.2 * side], [stop, side * 40.0]], IDEAL, 4)
    top = [stop, _HANDLE]
    panel.polygons([top + 6 * panel.pixel * circle(25)], IDEAL)
    panel.text([stop, _HANDLE - 8], "stop", IDEAL, anchor="mm", size=14)
    panel.grip("stop", "the stop", top, 2)


def _factor(paper: Paper, stop: float, slopes: Array) -> Panel:
    """Draw by which factor the rays arrive farther out than meant, and polynomials through it."""
    panel = paper.panel(_FACTOR, (-_FAR, _FAR), (_MOST, _LEAST), "L over r (negative: other side)")
    panel.ticks(x=(-0.5, -0.25, 0, 0.25, 0.5), y=(0.95, 1, 1.05, 1.1))
    panel.line([[0.06 - _FAR, 1], [_FAR, 1]], IDEAL, 1)
    r, k1 = np.linspace(-_FAR, _FAR, 125), _k1(stop)
    panel.line(np.column_stack([r, lens_of(stop).L(r)]), LENS, 2.2)
    panel.line(np.column_stack([r, 1 + k1 * r**2]), ESTIMATED, 2.2, dash=7)
    high = 1.045 if k1 < 0.1 else 0.955  # where no curve is
    panel.text([0, high], "dashed: 1 + k₁r²", ESTIMATED, anchor="mm")
    ideal, seen = radii(stop, slopes)
    factors = np.divide(seen, ideal, out=np.ones_like(seen), where=np.abs(_DRAWN) > 0)
    panel.mark(np.column_stack([ideal, factors]), "lens", 5)
    return panel


def _k1(stop: float) -> float:
    """Return what is left near the axis of the polynomial."""
    r, near = radii(stop, np.array([0.02]))
    return float(((near / r - 1) / r**2)[0])


def _sentence(stop: float, seen: float) -> str:
    k1 = _k1(stop)
    place = f"{abs(stop):.0f} mm {'before' if stop < 0 else 'behind'} the middle of the lens"
    shape = "barrel" if k1 < -0.02 else "pincushion" if k1 > 0.02 else "nearly straight"
    return f"""The stop is {place if stop else "in the middle of the lens"}. An ideal lens would
    show the outermost ray {FOCAL * _DRAWN[-1]:.1f} mm from the axis, this one shows it at
    {FOCAL * seen:.1f} mm: {shape}, k₁ = {round(k1, 2) + 0.0:.2f}."""
