"""Explore the horizon: a cell of the ground is pulled to infinity, which a picture shows."""

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.pictures import course, rails, render_scene
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, MUTED, WORLD, mixed

_CAMERA, _DOWN, _HALFWAY, _CELL = Camera(course.camera().A), 1.95, 20.0, 4.0  # m; the grass
_MAP, _VIEW, _FINER = (330, 330), (440, 330), 1.375  # px; the photograph is finer than _CAMERA's
_SHOWN = (-0.565, 0.565), (1.105, -0.025)  # of the map, whose rim has the radius 1
_DISC, _DISC_AT = 0.16, np.array([-0.38, 0.19])  # the whole map, small, beside what is shown
_SIDE = 21  # degrees to either side, to which the cell is pulled
_SEEN = -22.1, 21.5  # degrees that the picture shows, from its left border to its right one
_NAMED = np.radians([-20, 0, 20])  # directions whose degrees are written there
_TOLD = np.array([610, 70])  # px of the picture, in the sky: where the quadruple ends
_GRASS, _UNSEEN, _YELLOW = "#E6EFDF", "#F4F6F1", "#F0E442"
_MEADOW, _PALE = "#7C8A5C", "#A6F0D8"  # grass of the photograph, and the grid upon it
# Once round a cell of side 1, from the left of its near edge: bent on the map, so in short steps.
_EDGE = np.stack([np.interp(np.linspace(0, 4, 65), range(5), at) for at in (
    [-0.5, 0.5, 0.5, -0.5, -0.5], [0, 0, 1, 1, 0])], axis=1)  # fmt: skip


def horizon_model() -> Model:
    """Make the model of a cell of the ground, pulled up to the line at infinity."""
    settings = (
        Setting("part", "how far (1: ∞)", 0.3, 1, 0.005, 0.375, "of the cell: 0.5 is 20 m"),
        Setting("turn", "direction (°)", -_SIDE, _SIDE, 1, 0, "to the right of the rails"),
    )
    about = """The ground from above with a grid of 4 m, far distances pressed together, so that the
    line at infinity is a rim; and the same grid in the picture of a camera, where it is the
    horizon. One cell is yellow in both; in the sky its quadruple, the last number orange."""

    def on_map(_: Values, at: Array) -> Values:
        return {"part": float(np.hypot(*at)), "turn": _degrees(at)}

    def in_picture(_: Values, at: Array) -> Values:
        u, v = np.linalg.inv(_CAMERA.A)[:2] @ [*at, 1]
        away = _DOWN * np.hypot(u, 1)  # times v; the sky is no place of the ground
        part = away / (away + _HALFWAY * max(v, 0))
        return {"part": float(part), "turn": _degrees(np.array([u, 1]))}

    return Model("horizon", about, settings, _draw, {"map": on_map, "picture": in_picture})


def _degrees(way: Array) -> float:
    return float(np.degrees(np.arctan2(*way)))


def pressed(ground: npt.ArrayLike) -> Array:
    """Return where points of the ground (..., 2), in m, are on the map: within the rim."""
    xz = np.asarray(ground, dtype=np.float64)
    return np.asarray(xz / (np.linalg.norm(xz, axis=-1, keepdims=True) + _HALFWAY))


def seen(homogeneous: Array) -> Array:
    """Return the pixels (..., 2) of points [X Z w] of the ground, also where w is 0."""
    x, z, w = np.moveaxis(homogeneous, -1, 0)
    m = np.stack([x, _DOWN * w, z], axis=-1) @ _CAMERA.A.T
    return np.asarray(m[..., :2] / m[..., 2:])


def quadruple(homogeneous: Array) -> str:
    """Write a point [X Z w] of the ground as the quadruple, in m, whose third number is 1."""
    x, z, w = homogeneous
    told = (f"{number / z + 0.0:.2g}" for number in (x, _DOWN * w, z, w))
    return f"[{' '.join(told)}]"


def _draw(paper: Paper, values: Values) -> Drawing:
    turn, part = np.radians(values["turn"]), values["part"]
    way = np.array([np.sin(turn), np.cos(turn)])
    place = np.array([*(_HALFWAY * part * way), 1 - part])  # [X Z w]: no number becomes large
    plan = paper.panel(_MAP, *_SHOWN, "the ground from above: the black rim is infinity")
    view = paper.picture_panel(_VIEW, _CAMERA.size, "in the picture: infinity is the horizon")
    plan.image(_map(paper.sharpness))
    view.image(_picture(paper.sharpness))
    high = 0.0
    if part < 1:
        cell = place[:2] / place[2] + _CELL * _EDGE
        high = float(np.ptp(seen(_lifted(cell))[:, 1]))
        for panel, at in ((plan, pressed(cell)), (view, seen(_lifted(cell)))):
            panel.polygons([at], _YELLOW)
            panel.line(at, IDEAL if part < 0.6 else _YELLOW, 0.8 if part < 0.6 else 2)
    for panel, name, at in ((plan, "map", part * way), (view, "picture", seen(place))):
        if part < 1:
            for size, ink in ((4.5, IDEAL), (2.7, _YELLOW)):
                panel.polygons([at + size * panel.pixel * circle(17)], ink)
        else:
            panel.mark(at, "ideal", 9)
        panel.grip(name, f"the cell, in the {name}", at, 2)
    _on_disc(plan, part * way, part == 1)
    _tell(view, place)
    return Drawing(paper.join((plan, view)), _sentence(place, high))


def _on_disc(plan: Panel, at: Array, at_the_rim: bool) -> None:
    """Mark the cell on the small map; at the rim it is also the point behind the camera."""
    small = _DISC_AT + _DISC * np.array([at, -at])
    if at_the_rim:
        plan.mark(small, "ideal", 6)
        return
    for size, ink in ((3.6, IDEAL), (2.4, _YELLOW)):
        plan.polygons([small[0] + size * plan.pixel * circle(17)], ink)


def _tell(view: Panel, place: Array) -> None:
    """Write the cell's quadruple into the sky, large, its last number orange, and what that is."""
    *others, last = quadruple(place).strip("[]").split()
    view.text(_TOLD, "]", IDEAL, anchor="rm", size=24)
    view.text(_TOLD - [14, 0], last, ESTIMATED, anchor="rm", size=24)
    view.text(_TOLD - [146, 0], f"[{'  '.join(others)}", IDEAL, anchor="rm", size=24)
    said = f"1 : {place[1] / place[2]:.0f} m" if place[2] else "at infinity"
    view.text(_TOLD + [-14, 46], said, ESTIMATED, anchor="rm", size=15)


def _lifted(ground: Array) -> Array:
    return np.concatenate([ground, np.ones_like(ground[..., :1])], axis=-1)


def _lines(left: float, right: float) -> list[tuple[Array, float]]:
    """Return the grid's lines (n, 2) seen between two directions, in degrees, and how strong."""
    slope = np.tan(np.radians([left, right]))
    odd, even = _CELL * np.arange(0.5, 30), _CELL * np.arange(1, 31)  # m; then it is too fine
    along = [np.array([[x, z] for z in np.geomspace(x / slope[int(x > 0)], 1e5)])
             for x in (*-odd, *odd)]  # fmt: skip
    across = [np.array([[x, z] for x in np.linspace(*slope) * z]) for z in even]
    away = np.abs([*-odd, *odd, *even])
    return list(zip(along + across, (30 / (away + 30)).round(2).tolist(), strict=True))


@lru_cache(maxsize=2)
def _map(sharpness: int) -> Drawn:
    """Draw the map without its cell."""
    panel = Paper(sharpness).panel(_MAP, *_SHOWN)
    turn = np.radians(np.arange(-180, 181))
    rim = np.stack([np.sin(turn), np.cos(turn)], axis=1)
    panel.polygons([rim], _UNSEEN)
    turn = np.radians(np.linspace(*_SEEN, 60))
    seen_rim = np.stack([np.sin(turn), np.cos(turn)], axis=1)
    panel.polygons([[[0, 0], *seen_rim]], _GRASS)
    for line, strength in _lines(*_SEEN):
        panel.line(pressed(line), mixed(_GRASS, WORLD, strength), strength)
    for x in (-0.75, 0.75):
        panel.line(pressed([[x, z] for z in np.geomspace(0.1, 1e6, 200)]), MUTED, 1.2)
    panel.line(rim, MUTED, 1)
    panel.line([seen_rim[0], [0, 0], seen_rim[-1]], CAMERA, 1)
    panel.line(seen_rim, IDEAL, 3)
    panel.mark([0, 0], "camera", 9)
    _name(panel, 1.068 * np.stack([np.sin(_NAMED), np.cos(_NAMED)], axis=1))
    panel.polygons([_DISC_AT + _DISC * rim], "white")
    panel.polygons([_DISC_AT + _DISC * np.array([[0, 0], *seen_rim])], _GRASS)
    panel.line(_DISC_AT + _DISC * rim, MUTED, 1)
    panel.line(_DISC_AT + _DISC * seen_rim, IDEAL, 2)
    panel.mark(_DISC_AT, "camera", 5)
    panel.text(_DISC_AT + [0, _DISC + 0.05], "all around", anchor="mm", size=12)
    return panel.drawn()


@lru_cache(maxsize=2)
def _picture(sharpness: int) -> Drawn:
    """Photograph the railway, and lay the grid upon the ground, behind the poles."""
    half = (_FINER - 1) / 2  # the middle of the first pixel, in the fine ones
    A = np.array([[_FINER, 0, half], [0, _FINER, half], [0, 0, 1]]) @ _CAMERA.A
    panel = Paper(sharpness).picture_panel(_VIEW, _CAMERA.size)
    panel.image(render_scene(rails(), Camera(A, size=(880, 660)), samples=4))
    plain = panel.drawn()
    for line, strength in _lines(*_SEEN)[::-1]:
        panel.line(seen(_lifted(line)), mixed(_MEADOW, _PALE, strength), strength)
    horizon = seen(np.stack([np.sin(_NAMED), np.cos(_NAMED), 0 * _NAMED], axis=1))
    panel.line(horizon + [[-40, 0], [0, 0], [40, 0]], IDEAL, 3)
    _name(panel, horizon - [0, 30])
    page = panel.drawn().copy()
    for z in range(15, 150, 25):  # the poles stand before the lines
        corners = _CAMERA.project([[-4.09, -4.05, z - 0.09], [-3.91, 1.95, z + 0.09]])
        (left, top), (right, foot) = ((corners + 0.5) * page.shape[1] / 640).round().astype(int)
        page[max(top, 0) : foot, left:right] = plain[max(top, 0) : foot, left:right]
    return page


def _name(panel: Panel, places: Array) -> None:
    for at, degrees in zip(places, np.degrees(_NAMED), strict=True):
        panel.text(at, f"{degrees:.0f}°", IDEAL, anchor="mm", size=12)


def _sentence(place: Array, high: float) -> str:
    if place[2] == 0:
        u, v = seen(place)
        where = f"The cell is at infinity, {quadruple(place)}."
        return f"{where} In the picture it is ({u:.1f}, {v:.1f}), on the horizon."
    away, ahead = np.array([np.hypot(*place[:2]), place[1]]) / place[2]
    where = f"The cell is {ahead:.0f} m ahead ({away:.0f} m away), {quadruple(place)}."
    return f"{where} Its 4 m are {high:.2g} px high."
