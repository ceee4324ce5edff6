"""Explore the camera: every entry of A, R and T, with the picture of a board and the space."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, inverse, pose, rotation_from_angles
from cvnotes.show.explorations.boards import (
    draw_arrows,
    draw_board,
    draw_in_space,
    in_space,
    on_sheet,
    pinhole,
)
from cvnotes.show.explorations.matrices import FOCAL, PIERCING, SHIFT, SKEW, TURN, matrix_table
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.orbit import round_the_board
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.space.camera_shapes import camera_shapes
from cvnotes.show.space.shapes import Lines, axes_shapes, target_shapes
from cvnotes.show.style import ESTIMATED, MUTED
from cvnotes.targets import Chessboard

_ASIDE = 12  # px from the way T to the words beside it


def camera_model(camera: Camera, board: Chessboard) -> Model:
    """Make the model of a board seen by `camera`, its lens left out."""
    alpha, (u0, v0), (w, h) = camera.A[0, 0], camera.A[:2, 2], camera.size
    reach = float(np.ceil(np.linalg.norm(board.points[-1])))
    x, y, _ = -board.points.mean(axis=0)
    axis = "in which the optical axis pierces the picture"
    turn = "turns the board about the camera's {} axis: R = Rz Ry Rx"
    shift = "where the board's origin lies along the camera's {} axis, mm"
    settings = (
        _whole("alpha", "α (px)", 0.3 * alpha, 2 * alpha, alpha, "focal length in pixels", FOCAL),
        _whole("u0", "u0 (px)", 0, w, u0, f"column {axis}", PIERCING),
        _whole("v0", "v0 (px)", 0, h, v0, f"row {axis}", PIERCING),
        _whole("skew", "skew (px)", -0.4 * alpha, 0.4 * alpha, camera.A[0, 1], "entry A12", SKEW),
        Setting("angle_x", "angle x (°)", -75, 75, 1, -25, turn.format("x"), TURN),
        Setting("angle_y", "angle y (°)", -75, 75, 1, 20, turn.format("y"), TURN),
        Setting("angle_z", "angle z (°)", -180, 180, 1, 5, turn.format("z"), TURN),
        _whole("T_x", "T x (mm)", -reach, reach, 0.9 * x, shift.format("x"), SHIFT),
        _whole("T_y", "T y (mm)", -reach, reach, 0.9 * y, shift.format("y"), SHIFT),
        _whole("T_z", "T z (mm)", 0, 3.2 * reach, 2.6 * reach, shift.format("z"), SHIFT),
    )
    about = (
        "The picture that a camera takes of a chessboard; beside it camera and board in space, "
        "in the frame of the board."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        return _draw(_moved(camera, values), board, paper)

    def carried(values: Values, at: Array) -> Values:
        return round_the_board(_moved(camera, values), board, at)

    def shifted(values: Values, at: Array) -> Values:
        x, y, _ = np.linalg.solve(_moved(camera, values).A, [*at, 1]) * values["T_z"]
        return {"T_x": float(x), "T_y": float(y)}

    def pierced(_: Values, at: Array) -> Values:
        return {"u0": float(at[0]), "v0": float(at[1])}

    drags = {"camera": carried, "board": shifted, "principal point": pierced}
    return Model("camera", about, settings, draw, drags)


def _whole(
    name: str, label: str, low: float, high: float, value: float, about: str, tint: str
) -> Setting:
    """Make a setting in steps of 1."""
    return Setting(name, label, round(low), round(high), 1, round(value), about, tint)


def _moved(camera: Camera, values: Values) -> Camera:
    ratio = camera.A[1, 1] / camera.A[0, 0]
    alpha = values["alpha"]
    A = intrinsics(alpha, ratio * alpha, values["u0"], values["v0"], values["skew"])
    angles = np.radians([values["angle_x"], values["angle_y"], values["angle_z"]])
    T = [values["T_x"], values["T_y"], values["T_z"]]
    return pinhole(Camera(A, size=camera.size)).moved(pose(rotation_from_angles(*angles), T))


def _draw(camera: Camera, board: Chessboard, paper: Paper) -> Drawing:
    picture = paper.picture_panel((440, 330), camera.size, "the picture of the board")
    complete = draw_board(picture, camera, board)
    w, h = camera.size
    for way in np.array([[11, 0], [0, 11]]) * picture.pixel:  # the middle of the picture
        picture.line(np.outer([-1, 1], way) + [(w - 1) / 2, (h - 1) / 2], MUTED, 1.5)
    picture.mark(camera.A[:2, 2], "camera", 7)
    origin = camera.project([0, 0, 0])
    picture.mark(origin, "world", 5)
    picture.grip(
        "principal point", "where the optical axis pierces the picture", camera.A[:2, 2], 5
    )
    picture.grip("board", "the board's origin in the picture", origin, 5)
    space = _space(camera, board, paper)
    sentence = _sentence(camera, board, complete)
    return Drawing(paper.join((picture, space)), sentence, _matrices(camera))


def _space(camera: Camera, board: Chessboard, paper: Paper) -> Panel:
    size = (410, 330)
    length = 5 * board.square
    shapes = (
        *target_shapes(board),
        *axes_shapes(length=length, name=""),
        *axes_shapes(inverse(camera.G), 1.7 * length, name="", meaning="camera"),
        *camera_shapes(camera, 1.25 * length, name=""),
    )
    # The scale stays when the camera goes away, as far as its slider does.
    farthest = -3.2 * float(np.linalg.norm(board.points[-1])) * camera.R[2]
    low, high = in_space((*shapes, Lines("", np.array([[farthest, farthest]]), MUTED, 1)), size)
    panel = paper.panel(
        size, (low[0], high[0]), (low[1], high[1]), "space, in the frame of the board"
    )
    draw_in_space(panel, shapes)
    _draw_T(panel, camera)
    return panel


def _draw_T(panel: Panel, camera: Camera) -> None:
    """Draw the way from the camera to the board's origin, which is T in the camera's frame."""
    ends = on_sheet(np.stack([camera.centre, np.zeros(3)]))
    draw_arrows(panel, ends[:1], ends[1:] - ends[:1])
    panel.mark(ends[0], "camera", 5)
    panel.grip("camera", "the camera, to carry it round the board", ends[0], 6)
    way, aside = ends[1] - ends[0], _ASIDE * panel.pixel  # the name stands beside the way
    across = np.array([-way[1], way[0]]) / max(float(np.linalg.norm(way)), panel.pixel)
    panel.text(ends.mean(axis=0) + aside * across, "T", ESTIMATED, anchor="mm", size=12)


def _sentence(camera: Camera, board: Chessboard, complete: bool) -> str:
    said = (
        f"T = {_words(camera.T)} mm is where the camera sees the board's origin; the camera stands "
        f"at C = −RᵀT = {_words(camera.centre)} mm."
    )
    if not complete:
        return f"{said} The part of the board behind the camera has no image."
    m = camera.project(board.points)
    inside = ((m >= -0.5) & (m <= np.array(camera.size) - 0.5)).all(axis=-1)
    return said if inside.any() else f"{said} All inner corners are outside of the picture."


def _matrices(camera: Camera) -> str:
    """Write A, G and P = A [R|T]; what mixes several parameters has no colour."""
    of_A = {(0, 0): FOCAL, (1, 1): FOCAL, (0, 1): SKEW, (0, 2): PIERCING, (1, 2): PIERCING}
    of_G = {(i, j): TURN if j < 3 else SHIFT for i in range(3) for j in range(4)}
    rotations = np.array([[2, 2, 2, 0]] * 3 + [[0, 0, 0, 0]])
    products = np.array([[1, 1, 1, 0], [1, 1, 1, 0], [3, 3, 3, 0]])
    return (
        matrix_table(camera.A, "A: the sensor (px)", np.zeros((3, 3), int), of_A)
        + matrix_table(camera.G, "G: camera ← board (T in mm)", rotations, of_G)
        + matrix_table(camera.P, "P = A [R | T]", products, {})
    )


def _words(x: Array) -> str:
    return f"({', '.join(f'{value:.0f}' for value in (x.round() + 0.0).tolist())})"
