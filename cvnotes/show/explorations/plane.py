"""Explore the epipolar plane: both centres and a point; it cuts the second picture in a line."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.pictures import render_scene, room
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, nearest, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, hexed

_SIZE, _SHOWN, _OUTSIDE = (320, 240), (276, 207), (650, 442)  # px
_NEAREST, _FARTHEST = 1500, 6000  # mm along the axis
_STANDS = 900.0  # mm before its camera's centre: there a picture is drawn
_TILES = (80, 60)  # of a picture that stands in the room
_TINT = "#FBDCC6"
_NORMAL, _SQUARE = 210.0, 60.0  # mm: the arrow of n, and the side of a right angle


def plane_model() -> Model:
    """Make the model of two cameras in the room, and the plane through both and a point."""
    settings = (
        Setting("u", "u (px)", 110, 280, 1, 190, "a pixel of the first picture"),
        Setting("v", "v (px)", 50, 220, 1, 150, "and its row"),
        Setting("depth", "depth (mm)", _NEAREST, _FARTHEST, 50, 3500, "of the point on its ray"),
    )
    about = """The pictures of two cameras in a room, and both from outside: the ray of a pixel of
    the first, a point on it, the ray back to the second, and the plane of both rays, which cuts the
    second picture in a line."""

    def seen(values: Values, depths: Array) -> Array:
        return onlooker().project(on_the_ray(values["u"], values["v"], depths))

    pulled = nearest("depth", np.arange(_NEAREST, _FARTHEST + 1.0, 25), seen)
    drags = {"pixel": placed("u", "v"), "depth": pulled}
    return Model("plane", about, settings, _draw, drags)


@lru_cache(maxsize=1)
def cameras() -> tuple[Camera, Camera]:
    """Return the two cameras, two metres apart and turned towards each other."""
    A = intrinsics(260, 260, 159.5, 119.5)
    first = Camera(A, look_at([-1000, 100, 3000], [100, 300, 6200]), size=_SIZE)
    return first, Camera(A, look_at([1000, -100, 3000], [-200, 300, 6200]), size=_SIZE)


@lru_cache(maxsize=1)
def onlooker() -> Camera:
    """Return the camera by which both are seen."""
    A = intrinsics(1370, 1370, 267, 191)
    return Camera(A, look_at([-1500, -3100, -1200], [60, 250, 4500]), size=_OUTSIDE)


@lru_cache(maxsize=1)
def photographs() -> tuple[Drawn, Drawn]:
    """Return what the two cameras see."""
    first, second = (render_scene(room(), camera) for camera in cameras())
    return first, second


def on_the_ray(u: float, v: float, depth: Array) -> Array:
    """Return the points (n, 3) of the room behind a pixel of the first picture, by depth (n,)."""
    first = cameras()[0]
    ray = first.R.T @ [*first.ideal([u, v]), 1]
    return np.asarray(first.centre + np.asarray(depth)[..., None] * ray)


def epipolar_line(u: float, v: float) -> Array:
    """Return the line (3,) on which the second picture shows that ray: F m of chapter 10."""
    first, second = cameras()
    T, R = second.T - second.R @ first.R.T @ first.T, second.R @ first.R.T
    normal = np.cross(T, R @ [*first.ideal([u, v]), 1])
    return np.asarray(np.linalg.inv(second.A).T @ normal)


def _draw(paper: Paper, values: Values) -> Drawing:
    u, v, depth = values["u"], values["v"], values["depth"]
    second = cameras()[1]
    point = on_the_ray(u, v, np.array(depth))
    a, b, c = epipolar_line(u, v)
    across = np.arange(_SIZE[0] + 1) - 0.5
    line = np.column_stack([across, -(a * across + c) / b])
    line = line[(line[:, 1] > -0.5) & (line[:, 1] < _SIZE[1] - 0.5)]
    pictures = []
    for photo, name in zip(photographs(), ("first: pull its plus", "second"), strict=True):
        picture = paper.picture_panel(_SHOWN, _SIZE, name)
        picture.image(photo)
        pictures.append(picture)
    pictures[0].grip("pixel", "a pixel of the first picture", [u, v], 4, "ideal", 8)
    partner = second.project(point)
    pictures[1].line(line, ESTIMATED, 2)
    pictures[1].mark(partner, "estimated", 8)
    outside = paper.picture_panel(_OUTSIDE, _OUTSIDE, "both from outside: pull the point")
    _draw_outside(outside, np.array([u, v]), point, line)
    at = "beside the second picture"
    if ((partner > 0) & (partner < _SIZE)).all():
        at = f"at ({partner[0]:.0f}, {partner[1]:.0f}) px of the second picture"
    said = f"{depth / 1000:.2f} m away the point is seen {at}."
    return Drawing(paper.join((pictures, outside)), said)


def _draw_outside(panel: Panel, m: Array, point: Array, line: Array) -> None:
    """Draw both pictures in the room, the plane, and what it cuts out of the second one."""
    seen = onlooker().project
    first, second = cameras()
    panel.image(_pictures_standing(panel.scale // 2))
    one, two = first.centre, second.centre
    panel.veil([seen(np.array([one, two, point]))], [_TINT])
    panel.line(seen(np.array([one, one + 1.6 * (point - one)])), IDEAL, 1.2, dash=5)
    panel.line(seen(np.array([one, point])), IDEAL, 2)
    panel.line(seen(np.array([two, point])), ESTIMATED, 2)
    panel.line(seen(np.array([one, two])), CAMERA, 7)
    panel.line(seen(standing(second, line)), ESTIMATED, 3)
    panel.mark(seen(standing(first, m[None])), "ideal", 7)
    panel.mark(seen(standing(second, second.project(point)[None])), "estimated", 7)
    for centre, name, beside in ((one, "first", (32, 22)), (two, "second", (-22, 30))):
        panel.mark(seen(centre), "lens", 5)
        panel.text(seen(centre) + beside, name, CAMERA, size=18)
    panel.text(seen(0.4 * one + 0.6 * two) + [0, 20], "base line", CAMERA, anchor="mm", size=18)
    T, d = one - two, (point - one) / np.linalg.norm(point - one)
    n = np.cross(T, d) / np.linalg.norm(np.cross(T, d))
    for way in (-T / np.linalg.norm(T), d):  # n stands upright on both
        corner = _SQUARE * np.array([n, n + way, way])
        panel.line(seen(one + corner), IDEAL, 1.2)
    for start, way, name, ink, beside in (
        (two, T, "T", IDEAL, (-20, 6)),
        (one, 700 * d, "d", IDEAL, (-16, 0)),
        (one, _NORMAL * n, "n", ESTIMATED, (-17, -12)),
    ):
        begin, end = seen(np.array([start, start + way]))
        panel.arrows(begin, end - begin, IDEAL, 3 if ink == IDEAL else 5)
        panel.text(end + beside, name, ink, anchor="mm", size=20)
    panel.arrows(begin, 0.9 * (end - begin), ESTIMATED, 2.2)  # within its black rim
    panel.grip("depth", "the point on its ray", seen(point), 6, "estimated", 8)


def standing(camera: Camera, m: Array) -> Array:
    """Return where in the room pixels (n, 2) of a picture are that stands before its camera."""
    rays = np.insert(camera.ideal(m), 2, 1, axis=-1)
    return np.asarray(camera.centre + _STANDS * rays @ camera.R)


@lru_cache(maxsize=2)
def _pictures_standing(sharpness: int) -> Drawn:
    """Draw once what no hand moves."""
    panel = Paper(sharpness).picture_panel(_OUTSIDE, _OUTSIDE)
    for camera, photo in zip(cameras(), photographs(), strict=True):
        _draw_pyramid(panel, camera, photo)
    return panel.drawn()


def _draw_pyramid(panel: Panel, camera: Camera, photo: Drawn) -> None:
    """Draw a picture before its camera, in tiles, and its four edges."""
    columns, rows = _TILES
    tiles = photo.reshape(rows, _SIZE[1] // rows, columns, _SIZE[0] // columns, 3).mean(axis=(1, 3))
    u, v = (np.linspace(0, side, n + 1) - 0.5 for side, n in zip(_SIZE, _TILES, strict=True))
    grid = onlooker().project(standing(camera, np.stack(np.meshgrid(u, v), axis=-1)))
    at = [grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]]
    corners = np.stack(at, axis=2).reshape(-1, 4, 2)
    panel.polygons(corners, [hexed(tile) for tile in tiles.reshape(-1, 3)])
    frame = grid[[0, 0, -1, -1, 0], [0, -1, -1, 0, 0]]
    panel.line(frame, CAMERA, 1.5)
    eye = onlooker().project(camera.centre)
    panel.segments([[eye, corner] for corner in frame[:4]], CAMERA, 1)
