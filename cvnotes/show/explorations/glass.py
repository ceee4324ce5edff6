"""Explore the division by the depth: a ball in a room, and its image on a glass, where z is 1."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at, pose
from cvnotes.pictures import render_scene, room
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.explorations.rail import beyond, laid
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, mixed

_SPACE, _BESIDE, _WORDS, _FINER = (470, 360), (330, 248), (330, 84), 2
_STANDS = np.array([-0.9, 0, 1.5])  # m: the camera's place in the room; all else is in its frame
_Y, _FLOOR, _RADIUS = 0.2, 1.6, 0.16  # m: of the ball
_GLASS = np.array([[-0.8, -0.6, 1], [0.8, -0.6, 1], [0.8, 0.6, 1], [-0.8, 0.6, 1]])
_ASIDE = Camera(intrinsics(430, 430, 234.5, 179.5), look_at([3, -1.1, -1.7], [0.48, 0.33, 2]))
_SHADOW, _DARK, _LIGHT = "#9A8C80", "#C25400", "#FFD0A0"


def glass_model() -> Model:
    """Make the model of a ball before a camera, and of its image on a glass before this."""
    settings = (
        Setting("x", "x (m)", 0.5, 1.2, 0.1, 0.8, "how far the ball is to the right of the axis"),
        Setting("z", "z (m)", 1.6, 5, 0.1, 2, "its depth"),
    )
    about = """A camera in a room, from outside, with its picture on a glass 1 m before it, and a
    line of sight from a ball. Beside it the picture, and the ball's x and y over its depth."""

    def pulled(values: Values, at: Array) -> Values:
        row = _ASIDE.P[0] - at[0] * _ASIDE.P[2]  # the line on which the ball hangs, at the hand's u
        return {"z": float(-(row @ [values["x"], _Y, 0, 1]) / row[2])}

    return Model("glass", about, settings, _draw, {"ball": pulled})


def _draw(paper: Paper, values: Values) -> Drawing:
    M = np.array([values["x"], _Y, values["z"]])
    xy = M[:2] / M[2]
    space = paper.picture_panel(_SPACE, _SPACE, "from outside: pull the ball along its line")
    space.image(_scene())
    _draw_space(space, M)
    plane = paper.panel(_BESIDE, (-0.8, 0.8), (-0.6, 0.6), "on the glass, the plane z = 1")
    plane.image(_photograph())
    plane.veil([(_shadow(M) / _shadow(M)[:, 2:])[:, :2]], [_SHADOW])
    _draw_ball(plane, _discs(M, np.eye(2, 3)), lambda W: W[..., :2] / W[..., 2:])
    plane.arrows([[0, 0], [0, 0]], [[0.25, 0], [0, 0.25]], CAMERA, 2)
    plane.text([0.3, 0], "x", CAMERA, anchor="mm", size=15)
    plane.text([0, 0.3], "y", CAMERA, anchor="mm", size=15)
    plane.mark(xy, "ideal", 6)
    words = paper.panel(_WORDS, (0, 1), (0, 1), "divided by the depth")
    for part, row, name, number in zip(xy, (0.28, 0.72), "xy", M[:2], strict=True):
        said = f"{name} / z = {number:.1f} / {M[2]:.1f} = {part:.3f}"
        words.text([0.5, row], said, IDEAL, anchor="mm", size=19)
    told = f"({M[0]:.1f}, {M[1]:.1f}, {M[2]:.1f}) m is divided by its depth, {M[2]:.1f} m"
    said = f"The ball at {told}: ({xy[0]:.3f}, {xy[1]:.3f}, 1)."
    return Drawing(paper.join((space, [plane, words])), said)


def _draw_space(panel: Panel, M: Array) -> None:
    """Draw the ball with its shadow on the floor, its line, and its line of sight."""
    on_floor = np.array([[0, _FLOOR - _Y, 0]])
    along = M * [1, 1, 0] + np.outer([1.6, *range(2, 6)], [0, 0, 1])
    panel.line(_ASIDE.project(along), "#FFFFFF", 1.2, dash=5)
    panel.line(_ASIDE.project(along + on_floor), "#FFFFFF", 1.2)
    for place in along[1:] + on_floor:
        panel.line(_ASIDE.project(place + [[-0.1, 0, 0], [0.1, 0, 0]]), "#FFFFFF", 1.6)
        panel.text(_ASIDE.project(place + [0.14, 0, 0]), f"{place[2]:.0f} m", IDEAL, size=13)
    panel.veil([_ASIDE.project(_shadow(M))], [_SHADOW])
    eye, glass, ball = _ASIDE.project([0 * M, M / M[2], M])
    panel.line([beyond(_ASIDE.project(_GLASS), glass, ball), ball], ESTIMATED, 2.4)
    _draw_ball(panel, _discs(M, _ASIDE.R[:2]), _ASIDE.project)
    _draw_ball(panel, _discs(M, np.eye(2, 3)), lambda W: _ASIDE.project(W / W[..., 2:]))
    panel.line([eye, glass], ESTIMATED, 2.4)
    panel.mark(glass, "ideal", 5)
    panel.text(eye + [0, 18], "camera", IDEAL, anchor="mm", size=14)
    panel.text(_ASIDE.project(_GLASS[0]) + [4, -12], "glass, 1 m ahead", IDEAL, size=14)
    panel.grip("ball", "the ball, nearer or farther", ball, 4)


def _shadow(M: Array) -> Array:
    """Return the outline (n, 3) of the ball's shadow, straight below it on the floor."""
    return M * [1, 0, 1] + np.insert(_RADIUS * circle(40), 1, _FLOOR, axis=1)


def _discs(M: Array, axes: Array) -> Array:
    """Return discs (n, k, 3), each smaller and nearer to the light, along two axes (2, 3)."""
    part = np.linspace(0, 0.9, 12)[:, None, None]
    return M + _RADIUS * ((1 - part) * circle(48) - [0.3, 0.4] * part) @ axes


def _draw_ball(panel: Panel, discs: Array, place: Callable[[Array], Array]) -> None:
    for part, disc in zip(np.linspace(0, 1, len(discs)), discs, strict=True):
        panel.polygons([place(disc)], mixed(_DARK, _LIGHT, part**2))


@lru_cache(maxsize=1)
def _photograph() -> Drawn:
    """Photograph the room as the camera sees it."""
    return _from(Camera(intrinsics(400, 400, 319.5, 239.5), pose(np.eye(3), np.zeros(3))))


def _from(camera: Camera) -> Drawn:
    """Photograph the room, in mm, by a camera of the first one's frame, in m."""
    in_room = pose(camera.R, 1e3 * (camera.T - camera.R @ _STANDS))
    return render_scene(room(), Camera(camera.A, in_room, size=camera.size), samples=4)


@lru_cache(maxsize=1)
def _scene() -> Drawn:
    """Photograph the room from outside, with the camera and the picture on its glass."""
    aside = Camera(_ASIDE.A, _ASIDE.G, size=_SPACE).resized((940, 720))
    panel = Paper(_FINER).picture_panel(_SPACE, _SPACE)
    H = aside.P @ np.vstack([np.linalg.inv(intrinsics(400, 400, 319.5, 239.5)), [0, 0, 1]])
    panel.image(laid(_from(aside), _photograph(), H))
    corners, centre = _ASIDE.project(_GLASS), _ASIDE.project([0.0, 0, 0])
    panel.line([*corners, corners[0]], CAMERA, 2.5)
    panel.segments([[centre, corner] for corner in corners], CAMERA, 1.2)
    panel.mark(centre, "camera", 12, looks=(5, 1))
    return panel.drawn()
