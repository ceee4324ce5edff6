"""Explore a pose: three angles and T, with the picture of a board and the space."""

from functools import lru_cache
from itertools import pairwise

import numpy as np

from cvnotes.base import Array, clipped_segments
from cvnotes.camera import (
    Camera,
    inverse,
    look_at,
    move,
    pose,
    px_from_xy,
    rotation_from_angles,
    xy_from_px,
)
from cvnotes.show.explorations.boards import (
    PAPER,
    SQUARES,
    around,
    draw_board,
    draw_sheet,
    on_sheet,
    paper_and_squares,
    pinhole,
)
from cvnotes.show.explorations.matrices import SHIFT, TURN, matrix_table
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.orbit import angles_of, round_the_board
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.explorations.strokes import cut
from cvnotes.show.style import CAMERA, IDEAL, MUTED, WORLD, mixed
from cvnotes.targets import Chessboard

_SIZE = (440, 330)  # px, of each panel
_TILE, _NEAR = 4, 20.0  # squares to a tile of the floor; mm before the camera
_FLOOR, _WALL, _SHADOW, _JOINTS = "#EFE7D9", "#E2EBE4", "#CBC5BD", "#FBFAF7"
_GLASS, _EDGE = "#E3F1FB", mixed("#FFFFFF", CAMERA, 0.6)


def camera_model(camera: Camera, board: Chessboard) -> Model:
    """Make the model of a board seen by `camera`, its lens left out."""
    reach = float(np.ceil(np.linalg.norm(board.points[-1])))
    start = look_at(*reach / 236 * np.array([[340, 150, -420], [100, 62, 0]]))
    angles, T = np.degrees(angles_of(start[:3, :3])), start[:3, 3]
    shift = "where the world's origin lies along the camera's {} axis, mm"
    settings = (
        _tenth("x", 75, angles[0], "first turns the board about the camera's x direction"),
        _tenth("y", 75, angles[1], "then turns it about the camera's y direction"),
        _tenth("z", 180, angles[2], "at last turns it about the camera's z direction"),
        _whole("x", -reach, reach, T[0], shift.format("x")),
        _whole("y", -reach, reach, T[1], shift.format("y")),
        _whole("z", 0, 3.2 * reach, T[2], shift.format("z")),
    )
    about = """The picture that a camera takes of a chessboard; beside it camera and board in space,
    in the frame of the board."""

    def draw(paper: Paper, values: Values) -> Drawing:
        return _draw(_moved(camera, values), board, paper)

    def carried(values: Values, at: Array) -> Values:
        return round_the_board(_moved(camera, values), board, at)

    def shifted(values: Values, at: Array) -> Values:
        x, y, _ = np.linalg.solve(camera.A, [*at, 1]) * values["T_z"]
        return {"T_x": float(x), "T_y": float(y)}

    return Model("camera", about, settings, draw, {"camera": carried, "board": shifted})


def _whole(axis: str, low: float, high: float, value: float, about: str) -> Setting:
    """Make the setting of a coordinate of T, in steps of 1 mm."""
    ends = round(low), round(high)
    return Setting(f"T_{axis}", f"T {axis} (mm)", *ends, 1, round(value), about, SHIFT)


def _tenth(axis: str, most: float, value: float, about: str) -> Setting:
    """Make the setting of an angle, in steps of 0.1°."""
    start = round(float(value), 1)
    return Setting(f"angle_{axis}", f"angle {axis} (°)", -most, most, 0.1, start, about, TURN)


def _moved(camera: Camera, values: Values) -> Camera:
    angles = np.radians([values["angle_x"], values["angle_y"], values["angle_z"]])
    T = [values["T_x"], values["T_y"], values["T_z"]]
    return pinhole(camera).moved(pose(rotation_from_angles(*angles), T))


def _draw(camera: Camera, board: Chessboard, paper: Paper) -> Drawing:
    picture = paper.picture_panel((440, 330), camera.size, "the picture")
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * camera.size - 0.5
    picture.polygons([corners], _WALL)
    floor, joints = _floor(board, (-60, 60), (-60, 24))
    picture.polygons([_seen(camera, floor)], _FLOOR)
    ends = move(camera.G, joints)
    picture.segments(_pixels(camera, clipped_segments(ends, ends[..., 2:] - _NEAR)), _JOINTS, 1)
    complete = draw_board(picture, camera, board)
    origin = camera.project([0, 0, 0])
    picture.grip("board", "the world's origin in the picture", origin, 5, "world", 7)
    space = _space(camera, board, paper, corners)
    sentence = _sentence(camera, board, complete)
    return Drawing(paper.join((picture, space)), sentence, _matrices(camera))


@lru_cache(maxsize=8)
def _floor(board: Chessboard, x: tuple[int, int], z: tuple[int, int]) -> tuple[Array, Array]:
    """Return corners (4, 3) and joints (n, 2, 3) of a floor below a board, its ends in squares."""
    at = np.array([[x[0], z[0]], [x[1], z[0]], [x[1], z[1]], [x[0], z[1]]])
    along = [[[i, z[0]], [i, z[1]]] for i in range(x[0], x[1] + 1, _TILE)]
    across = [[[x[0], i], [x[1], i]] for i in range(z[0], z[1] + 1, _TILE)]
    low = board.corners[1] + 3
    corners, joints = (np.insert(xz, 1, low, axis=-1) for xz in (at, [*along, *across]))
    return board.square * corners, board.square * joints


def _seen(camera: Camera, corners: Array) -> Array:
    """Return the picture (m, 2) of a polygon (n, 3), of what of it lies before the camera."""
    M = move(camera.G, corners)
    return _pixels(camera, cut(M, M[:, 2] - _NEAR))


def _pixels(camera: Camera, M: Array) -> Array:
    return px_from_xy(camera.A, M[..., :2] / M[..., 2:])


def _space(camera: Camera, board: Chessboard, paper: Paper, corners: Array) -> Panel:
    """Draw board and camera as they stand, and the way T from the camera to the world's origin."""
    border, squares = paper_and_squares(board)
    floor, joints = _floor(board, (-4, 16), (-20, 6))
    columns, rows = board.corners  # the names stand beyond the paper, and can be read
    axes = board.square * np.diag([columns + 0.5, rows + 0.5, 5])
    own = board.square * np.diag([5.5, 5.5, 8]) @ camera.R
    back, C = inverse(camera.G), camera.centre
    walk = move(back, np.vstack([np.zeros(3), np.cumsum(np.diag(camera.T), axis=0)]))
    xy = xy_from_px(camera.A, corners)
    pane = move(back, 5 * board.square * np.insert(xy, 2, 1, axis=-1))
    stands = np.array([*border[2:], C])
    below = np.where([0, 1, 0], floor[0], stands)
    shown = on_sheet(np.concatenate([floor, border, axes, below, pane, C + own, walk]))
    (x0, y0), (x1, y1) = around(shown.min(axis=0), shown.max(axis=0), _SIZE, 1.18)
    title = f"space, T = {_words(camera.T)} mm: pull the camera"
    panel = paper.panel(_SIZE, (x0, x1), (y0, y1), title)
    panel.polygons([on_sheet(floor)], _FLOOR)
    panel.segments(on_sheet(joints), _JOINTS, 1)
    panel.line(on_sheet(below[:2]), _SHADOW, 4)
    panel.polygons([on_sheet(below[2] + board.square * np.insert(circle(25), 1, 0, 1))], _SHADOW)
    panel.segments(on_sheet(np.stack([stands, below], axis=1)), MUTED, 1)
    draw_sheet(panel, on_sheet(border), on_sheet(squares))
    _draw_axes(panel, np.zeros(3), axes, "XYZ", WORLD)
    _draw_pyramid(panel, on_sheet(C), on_sheet(pane))
    seen = [_within(corners, _seen(camera, W)) for W in (border, *squares)]
    across = (on_sheet(pane[[1, 3]]) - on_sheet(pane[0])) / np.array([camera.size]).T
    small = [on_sheet(pane[0]) + (m - corners[0]) @ across for m in seen]
    panel.polygons(small, [PAPER, *[SQUARES] * len(squares)])
    _draw_axes(panel, C, own, "xyz", CAMERA)
    _draw_T(panel, on_sheet(walk), camera.T)
    panel.mark(on_sheet(np.zeros(3)), "world", 6)
    panel.grip("camera", "the camera, to carry it round the board", on_sheet(C), 6)
    return panel


def _within(corners: Array, m: Array) -> Array:
    """Cut a polygon (n, 2) to the picture, whose corners go round from the top left."""
    for axis, side in ((0, 1), (0, -1), (1, 1), (1, -1)):
        m = cut(m, side * (m[:, axis] - corners[1 - side, axis]))
    return m


def _draw_pyramid(panel: Panel, centre: Array, pane: Array) -> None:
    """Draw the sides of a camera's pyramid as glass, and its image plane as the wall it sees."""
    sides = np.stack([np.broadcast_to(centre, pane.shape), pane, np.roll(pane, -1, axis=0)], 1)
    panel.veil(list(sides), [_GLASS] * 4)
    panel.polygons([pane], _WALL)
    panel.segments(sides[:, [[0, 1], [1, 2]]].reshape(-1, 2, 2), _EDGE, 1.2)


def _draw_axes(panel: Panel, start: Array, axes: Array, names: str, colour: str) -> None:
    """Draw three axes (3, 3), with their names beyond their tips."""
    for axis, name in zip(axes, names, strict=True):
        ends = on_sheet(np.array([start, start + axis]))
        panel.line(ends, colour, 2)
        beyond = ends[1] + 11 * panel.pixel * _along(panel, ends)
        panel.text(beyond, name, colour, anchor="mm", size=14)


def _draw_T(panel: Panel, at: Array, T: Array) -> None:
    """Draw T, from the camera to the world's origin, and its three steps along x, y and z."""
    panel.line(at, CAMERA, 3, dash=5)
    x, y = _along(panel, at[[0, 3]])
    tip = at[3] - 8 * panel.pixel * np.array([x, y])  # beside the mark of the origin
    for ink, width in (("#FFFFFF", 6), (IDEAL, 3)):  # a head that is seen on black squares
        panel.arrows(at[0], tip - at[0], ink, width)
        tip = tip - 3 * panel.pixel * np.array([x, y])
    middle = at[[0, 3]].mean(axis=0)
    across = np.array([y, -x])
    across = across * (1 if across @ (middle - at[1:3].mean(axis=0)) > 0 else -1)
    anchor = "lmr"[1 - int(np.rint(1.2 * across[0]))] + "m"
    panel.text(middle + 11 * panel.pixel * across, "T", IDEAL, anchor=anchor, size=17)
    for name, ends, step in zip("xyz", pairwise(at), T, strict=True):
        x, y = _along(panel, np.array(ends))
        if np.linalg.norm(ends[1] - ends[0]) > 25 * panel.pixel:  # else there is no room
            aside = np.array([y, -x]) * (1 if across @ [y, -x] < 0 else -1)
            beside = (ends[0] + ends[1]) / 2 + 16 * panel.pixel * aside
            panel.text(beside, f"{name} {step:.0f}", CAMERA, anchor="mm", size=14)


def _along(panel: Panel, ends: Array) -> Array:
    """Return the direction from one end to the other, shorter than 1 where they nearly meet."""
    way = ends[1] - ends[0]
    return np.asarray(way / max(float(np.linalg.norm(way)), panel.pixel))


def _sentence(camera: Camera, board: Chessboard, complete: bool) -> str:
    said = f"""T = {_words(camera.T)} mm is where the camera sees the world's origin; in the
    world's frame the camera stands at {_words(camera.centre)} mm."""
    if not complete:
        return f"{said} The part of the board behind the camera has no image."
    if camera.centre[2] > 0:
        return f"{said} It stands behind the board."
    m = camera.project(board.points)
    inside = ((m >= -0.5) & (m <= np.array(camera.size) - 0.5)).all(axis=-1)
    return said if inside.any() else f"{said} All inner corners are outside of the picture."


def _matrices(camera: Camera) -> str:
    """Write G."""
    of_G = {(i, j): TURN if j < 3 else SHIFT for i in range(3) for j in range(4)}
    rotations = np.array([[2, 2, 2, 0]] * 3 + [[0, 0, 0, 0]])
    return matrix_table(camera.G, "G: from world to camera (T in mm)", rotations, of_G)


def _words(x: Array) -> str:
    return f"({', '.join(f'{value:.0f}' for value in (x.round() + 0.0).tolist())})"
