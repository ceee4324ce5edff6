"""Explore the projection: a direction of lines, and the point in which they all seem to end."""

from functools import partial

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.show.explorations.boards import pinhole
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import CAMERA, IDEAL, WORLD, mixed
from cvnotes.targets import Chessboard

_GAUGE, _START = 1.5, 8.0  # m between the rails; m ahead where they pass before the camera
_NEAREST = 0.2  # m: what is nearer to the camera is not drawn
_WOOD, _BALLAST, _FAR = "#6B574A", "#B5ADA3", "#A1968B"  # the last is the mean of both
_SKY, _HAZE, _GRASS = np.array([[176, 203, 234], [233, 238, 239], [142, 163, 98]])
_REACH = 8.2  # m: how far away the direction is taken hold of
_PLANE = 6.0  # m: how far away the image plane is drawn from above


def projection_model(camera: Camera, _: Chessboard) -> Model:
    """Make the model of rails seen by `camera`, its lens left out."""
    settings = (
        Setting("heading", "heading (°)", -90, 90, 1, 20, "how far the rails turn to the right"),
        Setting("slope", "slope (°)", -15, 15, 1, 0, "how steeply the rails climb"),
        Setting("height", "height (m)", 0.2, 2, 0.1, 1.6, "how far the camera is above the rails"),
    )
    about = (
        "Two rails as the camera sees them, meeting in their vanishing point; beside it the same "
        "from above, with the ray through the camera's centre that is parallel to the rails."
    )
    ideal = pinhole(camera)

    def pointed(_: Values, at: Array) -> Values:
        x, y, z = np.linalg.solve(ideal.A, [*at, 1])
        slope = np.arctan2(-y, np.hypot(x, z))
        return {"heading": float(np.degrees(np.arctan2(x, z))), "slope": float(np.degrees(slope))}

    def turned(_: Values, at: Array) -> Values:
        # A direction has no sign: beyond 90° it goes on at −90°.
        return {"heading": float((np.degrees(np.arctan2(*at)) + 90) % 180 - 90)}

    drags = {"vanishing point": pointed, "rails": turned}
    return Model("projection", about, settings, partial(_draw, ideal), drags)


def _draw(camera: Camera, paper: Paper, values: Values) -> Drawing:
    heading, slope = np.radians([values["heading"], values["slope"]])
    # The rails' direction, and the level one across; rounded, so that 90° is exact.
    along = np.array([np.sin(heading), -np.tan(slope), np.cos(heading)]) * np.cos(slope)
    along, across = along.round(15), np.array([np.cos(heading), 0, -np.sin(heading)]).round(15)
    # Where they pass before the camera: straight ahead, on their own plane below it.
    normal = np.cross(along, across)
    ahead = np.array([0, 0, 1]) - normal[2] * normal
    middle = np.array([0, values["height"], 0]) + _START * ahead / np.linalg.norm(ahead)
    picture = paper.picture_panel((440, 330), camera.size, "what the camera sees")
    _draw_picture(picture, camera, middle, along, across)
    above = paper.panel((410, 330), (-8.9, 8.9), (12.6, -1.7), "the same from above")
    _draw_above(above, camera, middle, along, across)
    return Drawing(paper.join((picture, above)), _sentence(camera, along))


def _draw_picture(panel: Panel, camera: Camera, middle: Array, along: Array, across: Array) -> None:
    w, h = camera.size
    horizon = np.cross(camera.A @ along, camera.A @ across)
    side = horizon @ camera.A @ middle  # the side on which the plane of the rails is seen
    panel.image(_sky_and_grass(camera, horizon * np.sign(side) / np.hypot(*horizon[:2])))
    for colour, start, length in ((_BALLAST, -60, 2060), (_FAR, 45, 1955)):
        bed = [in_front(middle + x * across + start * along, length * along) for x in (-1.7, 1.7)]
        panel.polygons(camera.project(np.concatenate([bed[0], bed[1][::-1]]))[None], colour)
    for colour, half, length in ((_BALLAST, 1.7, 1.0), (_WOOD, 0.8 * _GAUGE, 0.25)):
        ends = _sleepers(middle, along, across, half)
        quads = np.concatenate([ends, ends[:, ::-1] + length * along], axis=1)
        # Farther away than a pixel can tell them apart, wood and ballast have one colour.
        faded = ((ends[:, 0] @ [0, 0, 1] - 10) / 30).clip(0, 1).round(2).tolist()
        panel.polygons(camera.project(quads), [mixed(colour, _FAR, part) for part in faded])
    for side in (-0.5, 0.5):
        rail = in_front(middle + side * _GAUGE * across - 1e3 * along, 1e7 * along)
        panel.line(camera.project(rail), WORLD, 2.5)
    end = camera.vanishing_point(along)
    panel.mark(end, "ideal", 9)
    panel.grip("vanishing point", "the vanishing point", end, 10)
    u, v = end.tolist()
    if 0 <= u < w and 0 <= v < h:
        left, above = u > 0.7 * w, v > 40
        beside = [u - 18 if left else u + 18, v - 20 if above else v + 24]
        panel.text(beside, "vanishing point", IDEAL, anchor="rm" if left else "lm")
    elif along[2] == 0:
        for at, anchor in ((8, "lm"), (w - 9, "rm")):
            panel.text([at, h / 2], "∞", IDEAL, anchor=anchor, size=16)
    else:  # an arrow at the border, to where it is
        at, arrow, anchor = (w - 9, "→", "rm") if u >= w else (8, "←", "lm")
        if 0 <= u < w:
            at, arrow = u, "↑" if v < 0 else "↓"
        words = f"{arrow} ({u:.0f}, {v:.0f})".replace("-", "−")
        panel.text([at, np.clip(v, 20, h - 20)], words, IDEAL, anchor=anchor, size=13)


def _sky_and_grass(camera: Camera, horizon: Array) -> Drawn:
    """Paint both sides of the horizon, a line (a, b, c) of length 1: they pale towards it."""
    v, u = np.mgrid[0 : camera.size[1] : 2, 0 : camera.size[0] : 2]
    below = (horizon[0] * u + horizon[1] * v + horizon[2])[..., None]
    grass = (below / 3 + 0.5).clip(0, 1)  # the line between both is smooth, tilted too
    haze = np.exp(-np.abs(below) / np.where(below > 0, 4, 150))
    return np.asarray(haze * _HAZE + (1 - haze) * (grass * _GRASS + (1 - grass) * _SKY), np.uint8)


def _draw_above(panel: Panel, camera: Camera, middle: Array, along: Array, across: Array) -> None:
    panel.segments(_sleepers(middle, along, across)[..., ::2], _WOOD, 1)
    for side in (-0.5, 0.5):
        rail = middle + side * _GAUGE * across + np.outer([-50, 50], along)
        panel.line(rail[:, ::2], WORLD, 2.5)
    (left, _), (right, _) = camera.ideal([[-0.5, 0], [camera.size[0] - 0.5, 0]]) * _PLANE
    view = np.array([[left, _PLANE], [0, 0], [right, _PLANE]])
    panel.line(5 * view, CAMERA, 0.8)
    panel.line([[-9, _PLANE], [9, _PLANE]], CAMERA, 0.8)  # the plane goes on
    panel.line([[left, _PLANE], [right, _PLANE]], CAMERA, 3)  # the picture on it
    panel.line(np.outer([0, 20], along[::2]), IDEAL, 1.2, dash=5)
    panel.mark([0, 0], "camera", 8)
    held = _REACH * along[::2]
    panel.polygons([held + 5 * panel.pixel * circle(24)], IDEAL)
    panel.grip("rails", "the direction of the rails, from above", held, 5)
    if along[2] > 0:
        panel.mark(_PLANE * along[::2] / along[2], "ideal", 8)
    # On the side that the rails leave free, and over all lines.
    side = 1.0 if along[0] >= 0 else -1.0
    anchor = "lm" if side > 0 else "rm"
    panel.text([0.4 * side, -0.6], "camera", CAMERA, anchor=anchor)
    beside = abs(right) + 0.3
    if along[2] > 0 and (out := _PLANE * abs(along[0]) / along[2]) < _REACH:
        # Not upon the vanishing point; without room beside it, at the other border.
        beside = max(beside, out + 0.6) if out < 4.8 else -8.7
    panel.text([side * beside, _PLANE + 0.55], "image plane", CAMERA, anchor=anchor)


def _sleepers(middle: Array, along: Array, across: Array, half: float = 0.8 * _GAUGE) -> Array:
    """Return the ends (n, 2, 3) of the sleepers, one for each metre, of half a length in m."""
    s = np.arange(-25.0, 45.0)[:, None, None]
    return np.asarray(middle + s * along + np.outer([-half, half], across))


def _sentence(camera: Camera, along: Array) -> str:
    a, b, c = (along.round(3) + 0.0).tolist()
    said = f"All lines of direction d = ({a:.3f}, {b:.3f}, {c:.3f})"
    if along[2] == 0:
        return (
            f"{said} are parallel to the image plane (c = 0): their vanishing point lies at "
            "infinity, and in the picture too they stay parallel."
        )
    u, v = camera.vanishing_point(along)
    w, h = camera.size
    inside = -0.5 <= u <= w - 0.5 and -0.5 <= v <= h - 0.5
    place = "" if inside else ", outside of the picture"
    return f"{said} end at ({u:.1f}, {v:.1f}) px{place}, wherever they start."


def in_front(start: Array, along: Array) -> Array:
    """Cut the segment start … start + along to what lies in front of the camera: (2, 3)."""
    z, dz = float(start[2]) - _NEAREST, float(along[2])
    if z < 0 and z + dz < 0:
        return np.full((2, 3), 0.0)  # the camera's centre has no image
    cut = -z / dz if z * (z + dz) < 0 else None
    first = cut if cut is not None and z < 0 else 0.0
    last = cut if cut is not None and z >= 0 else 1.0
    return start + np.outer([first, last], along)
