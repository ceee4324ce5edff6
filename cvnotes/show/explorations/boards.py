"""Boards, cameras and axes as line drawings: what several explorations show."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, rotation_from_vector
from cvnotes.show.explorations.paper import Panel
from cvnotes.show.space.directions import onto
from cvnotes.show.space.shapes import Faces, Lines, target_shapes
from cvnotes.show.style import MUTED
from cvnotes.targets import Chessboard

PAPER, SQUARES = "#FBFBF8", "#262629"
_PALE = "#E2E2E2"  # squares that arrows or letters lie on
# Seen a little from above and from the left: x to the right, y down, z away.
on_sheet = onto((rotation_from_vector([0.5, 0, 0]) @ rotation_from_vector([0, -0.1, 0]))[:2])


def pinhole(camera: Camera) -> Camera:
    """Return a camera's sensor behind an ideal lens, in its own frame: straight lines stay so."""
    return Camera(camera.A, size=camera.size)


def draw_board(panel: Panel, camera: Camera, board: Chessboard) -> bool:
    """Draw a board's picture by a camera without distortion; tell if all of it is in front.

    From behind only its paper is seen.
    """
    border, squares = paper_and_squares(board)
    paper, printed = camera.project(border), squares if camera.centre[2] < 0 else squares[:0]
    draw_sheet(panel, paper, camera.project(printed))
    return bool(np.isfinite(paper).all())


def draw_sheet(panel: Panel, border: Array, squares: Array) -> None:
    """Draw a board's paper (4, 2) and its dark squares (n, 4, 2), as they are seen."""
    panel.polygons(border[None], PAPER)
    panel.line(border[[0, 1, 2, 3, 0]], MUTED, 0.8)
    panel.polygons(squares, SQUARES)


def draw_measured(panel: Panel, m: Array, board: Chessboard) -> None:
    """Draw corners (n, 2) as they were measured, and pale the dark squares between them."""
    draw_squares(panel, m, board, _PALE)
    panel.mark(m, "lens", 2.5)


def draw_squares(panel: Panel, m: Array, board: Chessboard, colour: str) -> None:
    """Draw the dark squares between corners (n, 2)."""
    squares, dark = squares_between(m.reshape(*board.corners[::-1], 2))
    panel.polygons(squares[dark], colour)


def squares_between(grid: Array) -> tuple[Array, Array]:
    """Return the squares (rows × columns, 4, d) between corners, and which of them are dark."""
    squares = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
    dark = np.indices(squares.shape[:2]).sum(axis=0) % 2 == 0
    return squares.reshape(-1, *squares.shape[2:]), dark.ravel()


def draw_net(
    panel: Panel, m: Array, board: Chessboard, colour: str, width: float, dash: float = 0
) -> None:
    """Draw the rows and columns of corners (n, 2) as lines."""
    grid = m.reshape(*board.corners[::-1], 2)
    for line in (*grid, *grid.transpose(1, 0, 2)):
        panel.line(line, colour, width, dash)


def around(low: Array, high: Array, size: tuple[int, int], room: float) -> tuple[Array, Array]:
    """Choose both ends (x, y) of a panel for what lies between two corners, at equal scales."""
    reach = room * ((high - low) / size).max() / 2 * np.array(size)
    middle = (low + high) / 2
    return middle - reach, middle + reach


@lru_cache(maxsize=4)
def paper_and_squares(board: Chessboard) -> tuple[Array, Array]:
    """Return the corners of a board's paper (4, 3) and of its dark squares (m, 4, 3)."""
    squares, border = target_shapes(board)
    assert isinstance(squares, Faces)
    assert isinstance(border, Lines)
    return border.ends[:, 0], squares.corners[squares.colours[:, 0] < 0.5]
