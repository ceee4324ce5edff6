"""Explore the formation of an image: one box, before and after each step from world to pixels."""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, inverse, look_at, move, xy_from_px
from cvnotes.pictures.meshes import box, outlined
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.moved import part_of
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import cut
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, MUTED, WORLD, hexed, rgb

# One step or several: from points of the world (..., 3) to where a panel shows them, (..., 2).
Seen = Callable[[Array], Array]

_SIZE = 400, 300  # px, of a panel
_ABOVE = np.array([[-400.0, 816], [306, -606]])  # mm, X and Z of the panel of the world
_FRAME = np.array([[-608.0, 608], [760, -152]])  # mm, x and z of that of the camera's frame
_PLANE = 250.0  # mm: where z = 1 is drawn
_HEIGHT, _BACK = 125.0, 80.0  # mm, of the box, and Z of its far side; Y is 0 on the floor
_CORNER = np.array([200.0, -_HEIGHT, 0])  # mm, of the box: the one that is followed
_EYE, _TILT = -255.0, 20.0  # mm, Y of the camera; degrees that it looks down
_TILE, _TILES_ASIDE = 150.0, 10  # mm; how many tiles there are to each side of the origin
_NEAR, _WIDEST = 10.0, 20.0  # mm before the camera; how far from the axis on z = 1
_SIGHT = 230.0  # mm: how far away one takes hold of the line of sight
_LIGHT = np.array([0.55, 1, 0.35])  # how light goes down
_SHADES = 1.0, 0.5, 0.55, 0.8, 0.92, 0.7  # of front, back, left, right, top, bottom
_SKY, _FAR, _TILES, _SHADOW = "#DCE8F2", "#E8E1D4", ("#F0EADF", "#E0D8C9"), "#B5AC9A"
_ROUND = np.linspace(-np.pi, np.pi, 361)
_HORIZON = 1e9 * np.stack([np.sin(_ROUND), 0 * _ROUND, np.cos(_ROUND)], axis=1)
_WEDGE = "#D3E9F7"


def formation_model() -> Model:
    """Make the model of a box before a camera that is moved, turned and zoomed."""
    settings = (
        Setting("way", "steps", 0, 3, 0.05, 3, "0 the world, 1 after G, 2 divided by z, 3 after A"),
        Setting("X", "camera's X (mm)", -300, 600, 5, 340, "where the camera stands"),
        Setting("Z", "camera's Z (mm)", -540, -120, 5, -420, "negative: before the box"),
        Setting("turn", "turn (°)", -80, 80, 0.5, -30, "of the camera on the spot, to the right"),
        Setting("alpha", "α (px)", 600, 1200, 10, 800, "the focal length"),
    )
    about = """A box on a floor, four times: from above in the world, with a camera; from above in
    the camera's frame; divided by z, on the plane z = 1; and in the picture. One corner of the box
    is followed, with its numbers. What is still to come is pale."""
    drags = {"camera": placed("X", "Z"), "line of sight": looked_at}
    return Model("formation", about, settings, _draw, drags)


def looked_at(values: Values, at: Array) -> Values:
    """Turn a camera at X and Z towards a place that it is to look at, seen from above."""
    return {"turn": np.degrees(np.arctan2(*(at - [values["X"], values["Z"]])))}


def camera_of(values: Values) -> Camera:
    """Return the camera, which looks down at the floor."""
    turn, down = np.radians([values["turn"], _TILT])
    eye = np.array([values["X"], _EYE, values["Z"]])
    ahead = [np.sin(turn), np.tan(down), np.cos(turn)]
    A = intrinsics(values["alpha"], 1.005 * values["alpha"], 325, 238)
    return Camera(A, look_at(eye, eye + ahead))


def _draw(paper: Paper, values: Values) -> Drawing:
    camera, W, way = camera_of(values), _CORNER, values["way"]
    (x0, x1), (y0, y1) = _ABOVE
    world = paper.panel(_SIZE, (x0, x1), (y0, y1), "the world, from above: pull camera and plus")
    draw_above(world, lambda W: W[..., [0, 2]], camera, W)
    draw_axes(world, max(150, W[0] + 70), WORLD, "XZ", lambda ends: ends[..., [0, 2]])
    _take_hold(world, camera)
    world.line(np.array([camera.centre, W])[:, [0, 2]], ESTIMATED, 1.2)
    frame, at = _draw_frame(paper, camera, W, min(way, 2))
    plane = paper.panel(_SIZE, (-0.64, 0.64), (-0.48, 0.48), "2. ÷ z: the plane z = 1")
    picture = paper.picture_panel(_SIZE, camera.size, "3. A: the picture")
    scene = Scene.of(camera, W)
    draw_seen(plane, scene, lambda xy: xy)
    alpha, centre = np.diag(camera.A)[:2], camera.A[:2, 2]
    draw_seen(picture, scene, lambda xy: xy * alpha + centre)
    _draw_border(plane, camera)
    M = move(camera.G, W)
    xy = M[:2] / M[2] if M[2] > 0 else np.full(2, np.nan)
    m = camera.project(W)
    said = written(W, 0), written(M, 0), written(xy, 3), written(m, 1)
    on_the_way = {0.0: said[0], 1.0: said[1], 2.0: said[2][:-1] + ", 1)"}
    follow(world, W[[0, 2]], said[0], up=-16)  # below the X axis
    follow(frame, at, on_the_way.get(min(way, 2), ""), up=16 if way >= 2 else 0)
    follow(plane, xy, said[2], over=True)
    follow(picture, m, said[3], over=True)
    for panel, step in ((plane, 2), (picture, 3)):
        if way < step:
            _make_pale(panel, min(step - way, 1), f"after step {step}")
    return Drawing(paper.join((world, frame), (plane, picture)), _sentence(said, m, way))


def _make_pale(panel: Panel, part: float, words: str) -> None:
    """Make pale, by some part, what is still to come."""
    panel.image((255 - (1 - 0.85 * part) * (255.0 - panel.drawn())).astype(np.uint8))
    panel.text([np.mean(panel.x), np.mean(panel.y)], words, MUTED, anchor="mm", size=17)


def _draw_frame(paper: Paper, camera: Camera, W: Array, way: float) -> tuple[Panel, Array]:
    """Draw the box on its way; returns where the corner is: (2,).

    The world turns into the camera's frame; then the box runs along its rays onto the plane z = 1,
    which is drawn `_PLANE` mm before the camera.
    """
    turned, slid = min(way, 1.0), max(way - 1.0, 0.0)
    G = part_of(camera.G, turned)
    x, y = (1 - turned) * _ABOVE + turned * _FRAME
    steps = "from the world to the camera's frame", "1. G, then along the rays onto one plane"
    title = "1. G: the camera's frame, along its y" if way == 1 else steps[int(way > 1)]
    frame = paper.panel(_SIZE, (x[0], x[1]), (y[0], y[1]), title)

    def seen(W: Array) -> Array:
        return move(G, W)[..., [0, 2]]

    def on_the_way(W: Array) -> Array:
        M = move(G, W)
        z = M[..., 2:].clip(_NEAR)
        return (M * (1 - slid + slid * _PLANE / z))[..., [0, 2]]

    draw_above(frame, seen, camera, W)
    draw_axes(frame, 150, CAMERA, "xz", lambda ends: seen(move(inverse(camera.G), ends)))
    if slid:
        faces = faces_of(W)
        corners = faces[:2].reshape(-1, 3)
        frame.segments(np.stack([0 * seen(corners), seen(corners)], axis=1), MUTED, 0.7)
        draw_faces(frame, list(seen(faces)), turn=-1)
        v0 = camera.A[1, 2]
        sides = camera.ideal([[-0.5, v0], [camera.size[0] - 0.5, v0]])[:, 0]
        frame.line(np.column_stack([_PLANE * sides, [_PLANE, _PLANE]]), CAMERA, 3)
        left = [_PLANE * sides[0] - 8 * frame.pixel, _PLANE]
        frame.text(left, "z = 1 (not to scale)", CAMERA, anchor="rm", size=12)
        flat = on_the_way(corners)  # what is left where the faces are seen edge-on
        frame.line(flat[[flat[:, 0].argmin(), flat[:, 0].argmax()]], WORLD, 4)
        if slid < 1:
            draw_faces(frame, list(on_the_way(faces)), turn=-1)
    frame.line(seen(np.array([camera.centre, W])), ESTIMATED, 1.2)
    return frame, on_the_way(W)


def _sentence(said: tuple[str, ...], m: Array, way: float) -> str:
    if np.isnan(m).any():
        return f"W = {said[0]} mm. G makes {said[1]} of it, behind the camera: it has no image."
    inside = ((m >= -0.5) & (m <= [639.5, 479.5])).all()
    told = (
        f"W = {said[0]} mm",
        f". G makes {said[1]} of it, in the camera's frame",
        f"; the division by z {said[2]}",
        f", and A the pixel {said[3]}{'' if inside else ', outside of the picture'}",
    )
    return "".join(told[: 1 + int(way)]) + "."


class Scene(NamedTuple):
    """What stands before a camera, as polygons on z = 1."""

    tiles: tuple[list[Array], list[Array]]
    shadow: list[Array]
    faces: list[Array]
    horizon: Array

    @classmethod
    def of(cls, camera: Camera, corner: Array) -> "Scene":
        """Return what a camera sees, the box with this corner."""
        faces = faces_of(corner)
        light, dark = (_on_plane(camera, tiles) for tiles in _tiles(_TILE))
        far = move(camera.G, _HORIZON)
        horizon = (far[:, :2] / far[:, 2:])[far[:, 2] > _NEAR]
        shadow = _on_plane(camera, faces - faces[..., 1:2] * _LIGHT)
        return cls((light, dark), shadow, _on_plane(camera, faces), horizon)


def _on_plane(camera: Camera, corners: Array) -> list[Array]:
    """Bring polygons (n, k, 3) of the world onto z = 1, those parts that lie before the camera."""
    M = move(camera.G, corners)
    parts = list(outlined(M))
    for i in np.flatnonzero((M[..., 2] < _NEAR).any(axis=1)):
        parts[i] = outlined(cut(M[i], M[i, :, 2] - _NEAR))
    ends = np.cumsum([len(part) for part in parts])[:-1]
    x, y, z = np.concatenate(parts).T
    xy = np.stack([x, y], axis=1) / z[:, None]
    xy = xy * np.minimum(1, _WIDEST / np.linalg.norm(xy, axis=1).clip(1e-12))[:, None]
    return np.split(xy, ends)


def faces_of(corner: Array) -> Array:
    """Return the faces (6, 4, 3) of the box between a corner and the axes."""
    X, _, Z = corner
    return box((0, X), (-_HEIGHT, 0), (Z, _BACK), (0, 0, 0)).faces


@lru_cache(maxsize=2)
def _tiles(side: float) -> tuple[Array, Array]:
    """Return the tiles (n, 4, 3) of each of the two colours."""
    i, j = np.indices(2 * [2 * _TILES_ASIDE]).reshape(2, -1, 1) - _TILES_ASIDE
    x, z = side * (i + [0, 1, 1, 0]), side * (j + [0, 0, 1, 1])
    tiles = np.stack([x, 0 * x, z], axis=-1)
    odd = ((i + j) % 2 == 1)[:, 0]
    return tiles[~odd], tiles[odd]


def draw_floor(panel: Panel, seen: Seen, side: float = _TILE) -> None:
    """Draw the tiles of the floor from above."""
    for tiles, colour in zip(_tiles(side), _TILES, strict=True):
        panel.polygons(seen(tiles), colour)


def draw_above(panel: Panel, seen: Seen, camera: Camera, corner: Array) -> None:
    """Draw box and camera from above, and what the row of the principal point sees."""
    v0 = camera.A[1, 2]
    sides = camera.ray([[-0.5, v0], [camera.size[0] - 0.5, v0]])
    draw_floor(panel, seen)
    panel.veil([seen(camera.centre + 4000 * np.array([[0, 0, 0], *sides]))], [_WEDGE])
    faces = faces_of(corner)
    panel.polygons(seen(faces - faces[..., 1:2] * _LIGHT), _SHADOW)
    draw_faces(panel, list(seen(faces)), turn=-1)
    eye, ahead = panel.place(seen(camera.centre + np.outer([0, 1], camera.R[2])))
    panel.mark(seen(camera.centre), "camera", 9, looks=tuple(ahead - eye))


def draw_seen(panel: Panel, scene: Scene, place: Callable[[Array], Array]) -> None:
    """Draw box and floor as the camera sees them."""
    (x0, x1), (y0, y1) = panel.x, panel.y
    panel.polygons([[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]], _FAR)
    horizon = place(scene.horizon)
    horizon = horizon[(np.abs(horizon) < 1e4 * panel.pixel).all(axis=1)]
    horizon = horizon[np.argsort(horizon[:, 0])]
    over = np.array([[horizon[-1, 0], y0], [horizon[0, 0], y0]])
    panel.polygons(np.concatenate([horizon, over])[None], _SKY)
    shaded = *zip(scene.tiles, _TILES, strict=True), (scene.shadow, _SHADOW)
    for polygons, colour in shaded:
        panel.polygons([place(polygon) for polygon in polygons], colour)
    draw_faces(panel, [place(face) for face in scene.faces])


def draw_faces(panel: Panel, faces: Sequence[Array], turn: int = 1) -> None:
    """Draw those faces (n, 2) of a box that go round one way: the others are hidden."""
    for face, shade in zip(faces, _SHADES, strict=True):
        u, v = face.T
        if turn * np.sum(u * np.roll(v, -1) - v * np.roll(u, -1)) > 0:
            panel.polygons(face[None], hexed(255 * shade * np.array(rgb(WORLD))))
            panel.line(face[[*range(len(face)), 0]], "#FFFFFF", 0.8)


def draw_axes(panel: Panel, length: float, colour: str, names: str, seen: Seen) -> None:
    """Draw the axes that run to the right and ahead, with their names."""
    for tip, name in zip(np.diag([length, 0, 170])[[0, 2]], names, strict=True):
        panel.line(seen(np.stack([0 * tip, tip])), colour, 2.5)
        panel.text(seen(tip + 26 * np.sign(tip)), name, colour, anchor="mm", size=13)


def _take_hold(world: Panel, camera: Camera) -> None:
    """Let a hand move the camera, and turn it."""
    C, ahead = camera.centre[[0, 2]], camera.R[2, [0, 2]]
    sight = C + _SIGHT * ahead / np.linalg.norm(ahead)
    world.line([C, sight], IDEAL, 1, dash=4)
    world.mark(sight, "ideal", 7)
    world.grip("camera", "where the camera stands", C, 6)
    world.grip("line of sight", "where the camera looks", sight, 6)


def _draw_border(plane: Panel, camera: Camera) -> None:
    """Draw what of the plane z = 1 the sensor covers."""
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) * camera.size - 0.5
    border = xy_from_px(camera.A, corners)
    plane.line(border, CAMERA, 2)
    below = border[3] + np.array([7, -6]) * plane.pixel
    plane.text(below, "the sensor", CAMERA, anchor="ld", size=12)


def written(x: Array, digits: int) -> str:
    """Write numbers in brackets."""
    return f"({', '.join(f'{number:.{digits}f}' for number in x + 0.0)})"


def follow(panel: Panel, place: Array, words: str, up: float = 0, over: bool = False) -> None:
    """Mark the corner that is followed, and write its numbers beside it, or over the box."""
    panel.mark(place, "estimated", 8)
    low, high = np.sort([panel.x, panel.y]).T
    if over and ((place >= low) & (place <= high)).all():
        room, away = 52 * panel.pixel, 46 * panel.pixel
        row = place[1] - away if place[1] - low[1] > 1.4 * away else place[1] + away
        at = np.array([np.clip(place[0], low[0] + room, high[0] - room), row])
        panel.text(at, words, ESTIMATED, anchor="mm", size=12)
    elif ((place >= low) & (place <= high)).all():
        side = 1 if high[0] - place[0] > 120 * panel.pixel else -1
        beside = place + np.array([14 * side, up]) * panel.pixel
        panel.text(beside, words, ESTIMATED, anchor="lm" if side > 0 else "rm", size=12)
    elif over:
        top = np.array([(low[0] + high[0]) / 2, low[1] + 14 * panel.pixel])
        words = "the corner is outside" if np.isfinite(place).all() else "the corner has no image"
        panel.text(top, words, ESTIMATED, anchor="mm", size=12)
