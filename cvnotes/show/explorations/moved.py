"""Explore who moved: twelve photographs of a board, by a board that moves or by a camera."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import (
    Camera,
    chain,
    inverse,
    move,
    pose,
    rotation_from_vector,
    vector_from_rotation,
)
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import (
    around,
    draw_board,
    draw_sheet,
    paper_and_squares,
    pinhole,
)
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.space.camera_shapes import camera_shapes
from cvnotes.show.space.directions import onto
from cvnotes.show.space.shapes import Lines
from cvnotes.show.style import CAMERA, MUTED, mixed, rgb

_SIZE, _PICTURE = (402, 336), (448, 336)  # px
_LAST = 11  # of the twelve photographs, counted from 0
_CONE, _TILE, _BEYOND, _FOOT = 190.0, 100, 1000, 30.0  # mm
_TILES, _WALL, _SHADOW, _JOINTS = "#EFE7D9", "#E2EBE4", "#CBC5BD", "#FBFAF7"
_LINES, _GREY = "#BFD3C4", "#ECECEC"  # of the wall in the photograph; where nothing is told
# Seen from above and behind the camera: x to the right, y down, z away.
_VIEW = rotation_from_vector([0.45, 0, 0]) @ rotation_from_vector([0, 0.5, 0])
on_sheet = onto(_VIEW[:2])


def moved_model() -> Model:
    """Make the model of the course's twelve photographs, in the frame of the first camera."""
    settings = (
        Setting("photo", "photograph", 0, _LAST, 0.1, 6, "which photograph; the way between two"),
        Setting("who", "who moves (%)", 0, 100, 1, 0, "0: the board alone; 100: the camera alone"),
        Setting("wall", "the wall in it", 0, 1, 1, 0, "whether the photograph shows the wall, too"),
    )
    about = """A board and a camera in space, where they stood for twelve photographs, if the board
    moved, the camera, or both; and the photograph, where the board is the same for all these."""
    drags = {"camera": _carried, "board": _passed}
    return Model("moved", about, settings, _draw, drags)


class _Room(NamedTuple):
    """Lines (n, 2, 3) of floor and wall, and what the panel shows.

    The wall goes on beyond the panel; of that the photograph shows some.
    """

    floor: Array
    wall: Array
    beyond: Array
    shown: tuple[tuple[float, float], tuple[float, float]]


@lru_cache(maxsize=1)
def _poses() -> Array:
    return course.poses()


def between(photo: float) -> Array:
    """Return the board's pose (4, 4) before the camera, also on the way to the next photograph."""
    i = min(int(photo), _LAST - 1)
    G, G_next = _poses()[i : i + 2]
    return chain(part_of(chain(G_next, inverse(G)), photo - i), G)


def part_of(G: Array, part: float) -> Array:
    """Return a part of a motion (4, 4): as much of its rotation, and of its translation."""
    return pose(rotation_from_vector(part * vector_from_rotation(G[:3, :3])), part * G[:3, 3])


def stands(G: Array, who: float) -> tuple[Array, Array]:
    """Return the poses (4, 4) of camera and board in the first camera's frame: frame ← own."""
    camera = part_of(chain(_poses()[0], inverse(G)), who)
    return camera, chain(camera, G)


def _carried(values: Values, at: Array) -> Values:
    """Let a camera that is pulled along its way tell who moves."""
    i = _nearest(_of_cameras(values["photo"]), at, values["who"])
    return {"who": float(i)}


def _passed(values: Values, at: Array) -> Values:
    """Let a board that is pulled tell which photograph it is."""
    i = _nearest(_of_boards(values["who"]), at, 10 * values["photo"])
    return {"photo": i / 10}


def _nearest(places: Array, at: Array, last: float) -> int:
    """Return which of the places (n, 2) is nearest, of several the one nearest to the last."""
    apart = np.linalg.norm(places - at, axis=1)
    return int((apart + 1e-6 * np.abs(np.arange(len(places)) - last)).argmin())


@lru_cache(maxsize=1)  # while one hand pulls
def _of_cameras(photo: float) -> Array:
    """Return where (101, 2) on the sheet the camera stands, from 0 to 100 %."""
    G = between(photo)
    return on_sheet(np.array([stands(G, who / 100)[0][:3, 3] for who in range(101)]))


@lru_cache(maxsize=1)
def _of_boards(who: float) -> Array:
    """Return where (n, 2) on the sheet the board's middle is, photograph by photograph."""
    tenths = range(10 * _LAST + 1)
    return on_sheet(np.array([_middle(stands(between(i / 10), who / 100)[1]) for i in tenths]))


def _middle(of_board: Array) -> Array:
    """Return the middle (3,) of a board."""
    return move(of_board, course.board().points.mean(axis=0))


def _draw(paper: Paper, values: Values) -> Drawing:
    board, own = course.board(), pinhole(course.camera())
    G, who = between(values["photo"]), values["who"] / 100
    room = _room()
    space = paper.panel(_SIZE, *room.shown, "space: pull the board, or the camera")
    border, squares = paper_and_squares(board)
    for plane, colour in ((room.wall, _WALL), (room.floor, _TILES)):
        space.polygons(on_sheet(_border(plane))[None], colour)
        space.segments(on_sheet(plane), _JOINTS, 0.8)
    camera, of_board = stands(G, who)
    there = move(of_board, border)
    space.polygons(on_sheet(there * [1, 0, 1] + room.floor[0, 0] * [0, 1, 0])[None], _SHADOW)
    sheet = on_sheet(there)
    draw_sheet(space, sheet, on_sheet(move(of_board, squares)))
    below = camera[:3, 3] * [1, 0, 1] + room.floor[0, 0] * [0, 1, 0]
    space.polygons(on_sheet(below + _FOOT * np.insert(circle(25), 1, 0, axis=1))[None], _SHADOW)
    space.line(on_sheet(np.array([camera[:3, 3], below])), MUTED, 0.8, dash=3)
    for corner in sheet:  # a pyramid that moves, and keeps its form
        space.line([on_sheet(camera[:3, 3]), corner], CAMERA, 0.7)
    _draw_camera(space, own.moved(inverse(camera)))
    space.grip("camera", "the camera, between its two places", on_sheet(camera[:3, 3]), 6)
    space.grip("board", "the board, from photograph to photograph", on_sheet(_middle(of_board)), 6)
    picture = paper.picture_panel(_PICTURE, own.size, "what the camera sees")
    backdrop = _WALL if values["wall"] else _GREY
    picture.image((255 * np.array([[rgb(backdrop)]])).astype(np.uint8))
    if values["wall"]:
        seen = own.moved(inverse(camera)).project(room.beyond)
        picture.segments(seen, _LINES, 1)
    draw_board(picture, own.moved(chain(inverse(camera), of_board)), board)
    return Drawing(paper.join((space, picture)), _sentence(values, camera, of_board))


def _draw_camera(panel: Panel, camera: Camera) -> None:
    """Draw a camera as a body, from its farthest face to its nearest."""
    (lines, *_) = camera_shapes(camera, _CONE, name="")
    assert isinstance(lines, Lines)
    base = lines.ends[:4, 0]
    sides = [np.array([*edge, camera.centre]) for edge in lines.ends[:4]]
    faces = sorted([base, *sides], key=lambda face: -float(face.mean(axis=0) @ _VIEW[2]))
    for face in faces:
        panel.polygons([on_sheet(face)], mixed(CAMERA, "#FFFFFF", 0.75 if len(face) == 4 else 0.6))
    panel.segments(on_sheet(lines.ends), CAMERA, 1.6)


@lru_cache(maxsize=1)
def _room() -> _Room:
    """Make floor and wall, which stand still, with room for all boards and cameras."""
    border, _ = paper_and_squares(course.board())
    both = [stands(G, who) for G in _poses() for who in (0, 0.5, 1)]
    W = np.concatenate([[move(b, border), c[:3, 3] + 0 * border] for c, b in both]).reshape(-1, 3)
    beside = np.array([_FOOT, 0, _FOOT])  # the shadow of a camera that stands at the edge
    first, last = np.floor((W.min(0) - beside) / _TILE), np.ceil((W.max(0) + beside) / _TILE)
    x, y, z = (_TILE * np.arange(*ends) for ends in zip(first, last + 1, strict=True))
    floor = _grid(x, z)[..., [0, 2, 1]] + [0, y[-1], 0]
    wall = _grid(x, y) + [0, 0, z[-1]]
    x, y = (np.arange(s[0] - _BEYOND, s[-1] + _BEYOND + 1, _TILE) for s in (x, y))
    beyond = _grid(x, y) + [0, 0, z[-1]]
    seen = on_sheet(np.concatenate([W, floor.reshape(-1, 3), wall.reshape(-1, 3)]))
    (left, top), (right, bottom) = around(seen.min(0), seen.max(0), _SIZE, 1.05)
    return _Room(floor, wall, beyond, ((left, right), (top, bottom)))


def _border(plane: Array) -> Array:
    """Return the corners (4, 3) of a rectangle, from the lines (n, 2, 3) upon it."""
    low, high = plane.min(axis=(0, 1)), plane.max(axis=(0, 1))
    i, j = np.flatnonzero(high > low)
    corners = np.tile(low, (4, 1))
    corners[1:3, i], corners[2:, j] = high[i], high[j]
    return corners


def _grid(s: Array, t: Array) -> Array:
    """Return the sides (n, 2, 3) of squares with corners at s and t, where the third is 0."""
    at = np.stack([*np.meshgrid(s, t, indexing="ij"), np.zeros((len(s), len(t)))], axis=-1)
    sides = np.stack([at[:-1], at[1:]], axis=2), np.stack([at[:, :-1], at[:, 1:]], axis=2)
    return np.concatenate([side.reshape(-1, 2, 3) for side in sides])


def _sentence(values: Values, camera: Array, of_board: Array) -> str:
    middle = course.board().points.mean(axis=0)
    start = _poses()[0]
    moves = {
        "board": (chain(of_board, inverse(start)), move(start, middle)),
        "camera": (camera, np.zeros(3)),
    }
    said = []
    for name, (motion, at) in moves.items():
        far = float(np.linalg.norm(move(motion, at) - at))
        turn = float(np.degrees(np.linalg.norm(vector_from_rotation(motion[:3, :3]))))
        said.append(f"the {name} has moved by {far:.0f} mm and turned by {turn:.0f}°")
    return f"Photograph {values['photo']:g}: since photograph 0 {' and '.join(said)}."
