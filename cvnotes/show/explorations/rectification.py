"""Explore rectification: a stereo pair, and the same pair turned until it shares its rows."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, chain, pose, rotation_from_angles, rotation_from_vector
from cvnotes.show.explorations.boards import draw_board, pinhole
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, LENS, MUTED, WORLD
from cvnotes.stereo import epipolar_lines, fundamental_matrix, rectify
from cvnotes.targets import Chessboard

_SIZE = (340, 255)
_BASELINE = 0.35  # of the board's diagonal
_LINES = ESTIMATED, LENS, WORLD, CAMERA  # one for each corner
_RECTIFIED = (160, 120)  # px; only its camera is needed, and a small one is made sooner


def rectification_model(camera: Camera, board: Chessboard) -> Model:
    """Make the model of two cameras like `camera`, their lenses left out, that see `board`."""
    ahead = round(0.6 * _BASELINE * float(np.linalg.norm(board.points[-1])))
    turn = "turns the right camera about its {} axis"
    settings = (
        Setting("angle_x", "angle x (°)", -12, 12, 0.5, 4, turn.format("x") + " (nods)"),
        Setting("angle_y", "angle y (°)", -12, 12, 0.5, -5, turn.format("y") + " (turns aside)"),
        Setting("angle_z", "angle z (°)", -20, 20, 0.5, 8, turn.format("z") + " (rolls)"),
        Setting(
            "forward", "ahead (mm)", -ahead, ahead, 1, 0, "how far the right camera stands ahead"
        ),
    )
    about = (
        "Two pictures of a chessboard by two cameras, with epipolar lines; below the rectified "
        "pair, in which these lines are rows that both pictures share."
    )
    left = pinhole(camera).moved(_pose(board))

    def draw(paper: Paper, values: Values) -> Drawing:
        return _draw(left, _beside(left, board, values), board, paper)

    return Model("rectification", about, settings, draw)


def _beside(left: Camera, board: Chessboard, values: Values) -> Camera:
    angles = np.radians([values["angle_x"], values["angle_y"], values["angle_z"]])
    turned = pose(rotation_from_angles(*angles), np.zeros(3))
    step = _BASELINE * float(np.linalg.norm(board.points[-1]))
    moved = pose(np.eye(3), [-step, 0, -values["forward"]])
    return left.moved(chain(turned, moved, left.G))


def _draw(left: Camera, right: Camera, board: Chessboard, paper: Paper) -> Drawing:
    pair = rectify(left, right, size=_RECTIFIED, keep="all")
    taken = left, right
    before = _row(paper, taken, taken, board, "as taken")
    after = _row(paper, (pair.left, pair.right), taken, board, "rectified")
    # In the pixels of the given cameras, whatever the size of the rectified pictures.
    scale = left.A[0, 0] / pair.left.A[0, 0]
    apart = _rows_apart(left, right, board), scale * _rows_apart(pair.left, pair.right, board)
    sentence = (
        f"As taken, partners lie up to {apart[0]:.1f} px above or below each other; rectified, "
        f"{apart[1]:.1f} px: the search for a partner runs along one row."
    )
    return Drawing(paper.join(before, after), sentence)


def _row(
    paper: Paper,
    pair: tuple[Camera, Camera],
    taken: tuple[Camera, Camera],
    board: Chessboard,
    what: str,
) -> tuple[Panel, Panel]:
    """Draw what a pair shows: of a rectified one, what was in the pictures as they were taken."""
    shown, panels = board.points[_four(board)], []
    for i, side in enumerate(("left", "right")):
        camera, other, old = pair[i], pair[1 - i], taken[i]
        panel = paper.picture_panel(_SIZE, camera.size, f"{side}, {what}")
        draw_board(panel, camera, board)
        for line, colour in zip(lines_from(other, camera, shown), _LINES, strict=True):
            panel.line(_across(line, camera.size), colour, 1.8)
        m = old.project(shown)
        panel.mark(camera.project(shown[((m >= -0.5) & (m <= np.subtract(old.size, 0.5))).all(1)]),
                   "ideal", 8)  # fmt: skip
        if camera is not old:
            _hide_unseen(panel, camera, old)
        panels.append(panel)
    return panels[0], panels[1]


def _hide_unseen(panel: Panel, camera: Camera, old: Camera) -> None:
    """Lay grey over all that the picture as it was taken does not show."""
    w, h = np.subtract(old.size, 0.5)
    rays = old.ray([[-0.5, -0.5], [w, -0.5], [w, h], [-0.5, h]])
    corners = camera.project(camera.centre + rays)
    far = corners.mean(axis=0) + 9 * (corners - corners.mean(axis=0))
    panel.polygons([[corners[i - 1], corners[i], far[i], far[i - 1]] for i in range(4)], "#CFCFCF")
    panel.line(corners[[0, 1, 2, 3, 0]], MUTED, 1)


def lines_from(other: Camera, camera: Camera, W: Array) -> Array:
    """Return the lines (n, 3) in a camera's picture on which what the other sees of W must lie."""
    return epipolar_lines(fundamental_matrix(other, camera), other.project(W))


def _rows_apart(left: Camera, right: Camera, board: Chessboard) -> float:
    v = left.project(board.points)[:, 1] - right.project(board.points)[:, 1]
    return float(np.abs(v).max())


def _across(line: Array, size: tuple[int, int]) -> Array:
    """Return two points (2, 2) of a line, beyond the left and right (or upper, lower) border."""
    a, b, c = line.tolist()
    along = 0 if abs(b) >= abs(a) else 1
    ends = np.array([-1.0, size[along]])
    other = -(line[along] * ends + c) / line[1 - along]
    return np.stack([ends, other] if along == 0 else [other, ends], axis=-1)


def _four(board: Chessboard) -> list[int]:
    """Choose four inner corners at different heights."""
    columns, rows = board.corners
    return [0, columns * (rows // 3) + columns // 2, columns * (rows - 1), columns * rows - 1]


def _pose(board: Chessboard) -> Array:
    R = rotation_from_vector([-0.35, 0.3, 0.1])
    extent = float(np.linalg.norm(board.points[-1]))
    middle = [0.5 * _BASELINE * extent, 0, 2.2 * extent]
    return pose(R, middle - R @ board.points.mean(axis=0))
