"""Explore the twins: cameras in many places, with one and the same picture of a flat board."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import extrinsics
from cvnotes.camera import Camera, intrinsics, inverse, look_at, move
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import around, draw_board, draw_sheet, paper_and_squares
from cvnotes.show.explorations.fold import circle_of
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, nearest
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.space.directions import onto, sheet
from cvnotes.show.style import CAMERA, ESTIMATED

_SPACE, _PICTURE = (440, 300), (400, 300)  # px
_SIZE, _ALPHA = (640, 480), 600  # px, of the one camera
_EYE, _TARGET = [-110, 110, -330], [105, 62, 0]  # mm: where it is, and where it looks
_LOW, _HIGH, _STEP = 300, 1000, 10  # px: α of the other one
_FILM = 0.16  # mm of the drawn pictures, for a pixel
_FOOT = [[0, 1], [2, 1], [2, 2], [0, 2]]  # corners of the board, on which the box stands
_HIGHEST = 100  # mm
_INK, _WAY = "#262629", "#F0C4A4"
_BLUE = ("#8DBFE8", "#C4E0F6")  # of a box's sides and top
_LID = [4, 5, 6, 7]  # of the box's corners
on_sheet = onto(sheet((50, -85)))


def twins_model() -> Model:
    """Make the model of a photograph of the board, and of all cameras that could have taken it."""
    settings = (
        Setting("alpha", "α of the other camera (px)", _LOW, _HIGH, _STEP, 900,
                "its focal length; its principal point and its place follow"),
        Setting("height", "a box on the board (mm)", 0, _HIGHEST, 5, 80,
                "how far it stands out of the plane"),
    )  # fmt: skip
    about = """A board and two cameras in space, with the way on which the other one can be pulled;
    a dot in each is its principal point; and their two pictures, laid over each other, of the board
    and of a box upon it, one in each camera's colour."""

    alphas, heights = np.arange(_LOW, _HIGH + 1, _STEP), np.arange(0, _HIGHEST + 1, 5.0)
    carry = nearest("alpha", alphas, lambda *_: on_sheet(_way()))
    lift = nearest("height", heights, lambda _, tried: np.array([*map(_top, tried)]))
    return Model("twins", about, settings, _draw, {"other": carry, "box": lift})


@lru_cache(maxsize=1)
def one() -> Camera:
    """Return the camera that took the photograph, without a lens."""
    A = intrinsics(_ALPHA, _ALPHA, (_SIZE[0] - 1) / 2, (_SIZE[1] - 1) / 2)
    return Camera(A, look_at(_EYE, _TARGET), size=_SIZE)


@lru_cache(maxsize=256)
def other(alpha: float) -> Camera:
    """Return the camera with another focal length α, and square pixels, that takes it as well.

    If the picture of the board is the same, so is the homography H of its plane. Two right angles
    leave (u0, v0, α) on a circle: see `fold.circle_of`. H gives the pose.
    """
    H = one().A @ one().G[:3, [0, 1, 3]]
    circle = circle_of(H)
    u, v, _ = circle.place(float(np.degrees(np.arcsin(alpha / circle.radius)))).tolist()
    K = intrinsics(alpha, alpha, u, v)
    return Camera(K, extrinsics(K, H[None])[0], size=_SIZE)


def box(height: float) -> Array:
    """Return the corners (8, 3) of a box on the board: its foot, then its top, before the plane."""
    foot = course.board().square * np.column_stack([_FOOT, np.zeros(4)])
    return np.concatenate([foot, foot - [0, 0, height]])


def _top(height: float) -> Array:
    """Return where the camera sees the middle of the box's top."""
    return one().project(box(height)[4:].mean(axis=0))


def _draw(paper: Paper, values: Values) -> Drawing:
    cameras = (one(), other(values["alpha"]))
    W = box(values["height"])
    space = _space(paper, cameras, W)
    picture = paper.picture_panel(_PICTURE, one().size, "both pictures: one board, and two boxes")
    draw_board(picture, one(), course.board())
    _draw_box(picture, one().project(W))
    for camera, colour, width in zip(cameras, (CAMERA, ESTIMATED), (1.8, 2.6), strict=True):
        m = camera.project(W)
        for face in _unhidden(m):
            picture.line(m[[*face, face[0]]], colour, width)
    picture.grip("box", "the top of the box, to be lifted", _top(values["height"]))
    return Drawing(paper.join((space, picture)), _sentence(cameras, W, values["height"]))


def _space(paper: Paper, cameras: tuple[Camera, Camera], W: Array) -> Panel:
    x, y = _shown()
    panel = paper.panel(_SPACE, x, y, "space: pull the orange camera")
    border, squares = paper_and_squares(course.board())
    draw_sheet(panel, on_sheet(border), on_sheet(squares))
    _draw_box(panel, on_sheet(W))
    panel.line(on_sheet(_way()), _WAY, 2)
    corners = course.board().points[[0, 8, 45]]
    # Names: beside the centre, one above the way and one below, so that they never meet.
    sides = (CAMERA, [46, 0], "lm"), (ESTIMATED, [-26, -8], "rd")
    for camera, (colour, aside, anchor) in zip(cameras, sides, strict=True):
        rays = np.stack([_before(camera, corners), on_sheet(corners)], axis=1)
        panel.segments(rays, colour, 0.9)
        _draw_camera(panel, camera, colour)
        at = on_sheet(camera.centre) + np.array(aside) * panel.pixel
        if anchor == "rd":  # no farther out than its name is long
            at[0] = max(at[0], panel.x[0] + 66 * panel.pixel)
        panel.text(at, f"α = {camera.A[0, 0]:.0f}", colour, anchor=anchor, size=13)
    panel.grip("other", "the other camera, to be pulled along its way", on_sheet(cameras[1].centre))
    return panel


def _draw_box(panel: Panel, at: Array) -> None:
    for face in _unhidden(at):
        panel.polygons(at[face][None], _BLUE[face == _LID])


def _unhidden(at: Array) -> list[list[int]]:
    """Return those faces of the box, with corners at (8, 2), that are seen from outside."""
    sides = [[k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4] for k in range(4)]
    return [face for face in (_LID, *sides) if _area(at[face]) > 0]


def _area(corners: Array) -> float:
    """Return twice the area of a polygon (k, 2), negative if it is seen from behind."""
    x, y = corners.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def _draw_camera(panel: Panel, camera: Camera, colour: str) -> None:
    """Draw a camera as its pyramid, with its picture of the board in it."""
    border, squares = paper_and_squares(course.board())
    w, h = camera.size
    frame = camera.ray([[-0.5, -0.5], [w - 0.5, -0.5], [w - 0.5, h - 0.5], [-0.5, h - 0.5]])
    frame = _before(camera, camera.centre + frame)
    panel.polygons(frame[None], "#E4E4E0")
    panel.polygons(_before(camera, border)[None], "#FFFFFF")
    panel.polygons(_before(camera, squares), _INK)
    centre = on_sheet(camera.centre)
    ahead = [0, 0, _FILM * camera.A[0, 0]]  # in the camera's frame: its principal point
    principal = on_sheet(move(inverse(camera.G), ahead))
    panel.line([centre, principal], colour, 1.2, dash=3)
    panel.polygons([principal + 3.2 * panel.pixel * circle(13)], colour)
    for at, after in zip(frame, np.roll(frame, -1, axis=0), strict=True):
        panel.line([at, after, centre], colour, 1.5)


def _before(camera: Camera, W: Array) -> Array:
    """Return where points (..., 3) are seen on a camera's drawn picture, on the sheet (..., 2)."""
    M = move(camera.G, W)
    return on_sheet(move(inverse(camera.G), _FILM * camera.A[0, 0] * M / M[..., 2:]))


@lru_cache(maxsize=1)
def _way() -> Array:
    return np.array([other(float(alpha)).centre for alpha in np.arange(_LOW, _HIGH + 1, _STEP)])


@lru_cache(maxsize=1)
def _shown() -> tuple[tuple[float, float], tuple[float, float]]:
    """Choose what the panel shows: the board, and all places of the other camera."""
    border, _ = paper_and_squares(course.board())
    seen = on_sheet(np.concatenate([border, _way(), box(_HIGHEST)]))
    low = seen.min(0) - [90, 0]  # mm: room for a name on the left
    (left, top), (right, bottom) = around(low, seen.max(0), _SPACE, 1.1)
    return (left, right), (top, bottom)


def _sentence(cameras: tuple[Camera, Camera], W: Array, height: float) -> str:
    first, second = cameras
    apart = float(np.linalg.norm(first.centre - second.centre))
    alpha, u0, v0 = second.A[[0, 0, 1], [0, 2, 2]]
    said = f"""The orange camera, α = {alpha:.0f} px and principal point ({u0:.0f}, {v0:.0f}),
    stands {apart:.0f} mm from the blue one"""
    if not height:
        return f"{said}. No box stands on the board."
    off = np.linalg.norm(first.project(W[4:]) - second.project(W[4:]), axis=1).max()
    return f"{said}. In their pictures the box, {height:.0f} mm high, is up to {off:.0f} px apart."
