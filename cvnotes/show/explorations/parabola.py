"""Explore the step of Gauss and Newton: a cost over one unknown, and the parabola in its place."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.explorations.swing import floor_A, rows_of_tiles
from cvnotes.show.style import ESTIMATED, LENS, MUTED, mixed, rgb

_NEAREST, _FARTHEST = -190, 630  # mm, of the start
_SHOWN = (-760.0, 730.0), (210_000.0, -30_000.0)  # t in mm, the cost in px²
_STEPS = 5
_WALL = -450  # mm: beyond it row 1 would lie behind the camera
_WIDE, _NARROW = (754, 360), (374, 340)  # px
_GROUND = "#8FA3BD", "#EDF1F6"  # low and high
_APART = 16  # px between steps that have a number each


def parabola_model() -> Model:
    """Make the model of a floor believed t mm too far away, and of the steps that find this t."""
    settings = (
        Setting("t", "t (mm)", _NEAREST, _FARTHEST, 1, 200, "where the parabola touches the cost"),
        Setting("mu", "μ", 0, 3, 0.05, 0, "the damping: by this fraction the parabola is narrower"),
    )
    about = """The cost over one unknown t as a hilly ground, a parabola that touches it where t is,
    and the steps to its lowest point from there on, damped or not."""
    return Model("parabola", about, settings, _draw, {"t": placed("t")})


def residuals(t: Array | float) -> tuple[Array, Array]:
    """Return r (..., 6), predicted minus seen by the middle tile of each row, and J = dr/dt."""
    tiles, exact = rows_of_tiles()
    seen = exact + np.random.default_rng(6).normal(scale=1.0, size=exact.shape)
    distance = tiles[3::7, 1] + np.asarray(t)[..., None]
    _, alpha, v0 = floor_A()[1]
    return v0 + alpha * 300 / distance - seen[3::7, 1], -alpha * 300 / distance**2


def cost(t: Array | float) -> Array:
    """Return the sum of squares."""
    return np.asarray(np.sum(residuals(t)[0] ** 2, axis=-1))


def walk(t: float, mu: float) -> Array:
    """Return t before the first step and after each, with so much damping in all of them."""
    way = [t]
    for _ in range(_STEPS):
        r, J = residuals(way[-1])
        way.append(way[-1] - float(J @ r / (J @ J) / (1 + mu)))
    return np.array(way)


@lru_cache(maxsize=1)
def _ground() -> Drawn:
    part = np.linspace(1, 0, 240)[:, None, None]
    low, high = (255 * np.array(rgb(tone)) for tone in _GROUND)
    return np.asarray((low + part * (high - low)).round(), np.uint8).repeat(2, axis=1)


def _draw(paper: Paper, values: Values) -> Drawing:
    t, mu = values.values()
    size = _NARROW if paper.narrow else _WIDE
    panel = paper.panel(size, *_SHOWN, "the cost over t (mm), and its parabola")
    panel.image(_ground())
    (left, right), (top, _) = _SHOWN
    before = np.linspace(_WALL + 1, right, 600)
    curve = np.column_stack([before, np.minimum(cost(before), 3 * top)])
    panel.polygons([np.vstack([curve, [right, 3 * top]])], "white")
    panel.line(curve, LENS, 2.4)
    at, way, (r, J) = np.array([t, cost(t)]), walk(t, mu), residuals(t)
    across = np.linspace(left, right, 400)
    free, touching = (at[1] + (2 * J @ r + (1 + more) * J @ J * (across - t)) * (across - t)
                      for more in (0, mu))  # fmt: skip
    if mu:
        panel.line(np.column_stack([across, free]), mixed("#FFFFFF", ESTIMATED, 0.6), 1.4, dash=5)
    panel.line(np.column_stack([across, touching]), ESTIMATED, 2.2)
    _name(panel, float(np.interp(-550, across, touching)))
    lowest = np.array([way[1], at[1] + J @ r * (way[1] - t)])
    up = np.array([way[1], min(float(cost(way[1])), top)])
    panel.line(np.stack([lowest, up]), ESTIMATED, 1.2, dash=3)
    _number_steps(panel, way)
    panel.mark(lowest, "estimated", 8)
    panel.grip("t", "t, where the parabola touches", at, 4, "world", 9)
    rms = np.sqrt(cost(way) / len(r))
    return Drawing(paper.join((panel,)), _sentence(way, rms, mu))


def _name(panel: Panel, passing: float) -> None:
    """Draw the scale of t, and the wall; the words stay clear of the parabola passing there."""
    top, low = _SHOWN[1]
    for tick in (-600, -400, -200, 0, 200, 400, 600):
        panel.text([tick, low + 7000], f"{tick}", anchor="mm", size=11)
    panel.line(np.array([[_WALL, top], [_WALL, -14_000]]), MUTED, 1.2, dash=4)
    above = 194_000 if 12_000 < passing < 100_000 else 62_000
    for words, down in (("row 1", 0), ("is behind", 14_000), ("the camera", 28_000)):
        panel.text([_WALL - 14, above - down], words, MUTED, anchor="rm", size=12)
    panel.text([560, float(cost(560.0)) - 22_000], "cost", LENS, anchor="lm", size=13)


def _number_steps(panel: Panel, way: Array) -> None:
    """Write each step's number where it stands on the cost, if there is room for it."""
    last = np.full(2, np.inf)
    for step, at in enumerate(np.column_stack([way, cost(way)])[1:], start=1):
        here = panel.place(at) / panel.scale
        if at[1] < _SHOWN[1][0] and np.linalg.norm(here - last) > _APART:
            aside = [-12 * panel.pixel, 0] if at[1] > 8000 else [0, 9000]
            panel.mark(at, "estimated", 5)
            panel.text(at + aside, f"{step}", ESTIMATED, anchor="mm", size=13)
            last = here


def _sentence(way: Array, rms: Array, mu: float) -> str:
    damped = f" and μ = {mu:.2f}" if mu else ""
    said = f"""At t = {round(way[0])} mm{damped} the curve is replaced by a parabola; the step goes
    to its lowest point, {round(way[1])} mm. """
    if way[1] < _WALL:
        rows = "row 1 lies" if way[1] > -600 else "rows 1 and 2 lie"
        return f"{said}There {rows} behind the camera: the walk does not find back."
    after = ", ".join(f"{x:.1f}" for x in rms[:5])
    return f"{said}RMS from step to step: {after} px."
