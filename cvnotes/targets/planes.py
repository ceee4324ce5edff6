"""Targets with depth: equal boards on two or three planes that meet."""

from dataclasses import dataclass, field

import numpy as np

from cvnotes.base import Array, CvnotesError, number
from cvnotes.camera import move, pose
from cvnotes.targets.chessboard import Chessboard, Faces


@dataclass(frozen=True)
class TwoPlanes:
    """Two equal boards that meet along a common edge, like the pages of an open book.

    One picture of it fixes the whole projection matrix, which one plane alone cannot do.

    Parameters
    ----------
    board : Chessboard
        The board on either plane.
    angle : float
        Angle in radians between the planes on their visible side, in (0, π]; π is flat.
    margin : float
        White paper between the squares and the common edge, in squares.

    Notes
    -----
    WRF: the common edge is the y axis, at the height of the first corners. The back face lies in
    z = 0 and extends towards +x, as a single board does. The side face is hinged at the edge; at
    a right angle it lies in x = 0 and comes towards the camera (z < 0), its own x axis running
    to the edge, so that both boards read from left to right. Order of corners: back, then side.

    References
    ----------
    .. [1] Notes 2b.4, "Calibration Targets": several known planes in one picture.

    Examples
    --------
    >>> target = TwoPlanes(Chessboard((3, 2), 25.0))
    >>> target.points[[0, 6]]
    array([[  50.,    0.,    0.],
           [   0.,    0., -100.]])
    """

    board: Chessboard = field(default_factory=Chessboard)
    angle: float = np.pi / 2
    margin: float = 1.0

    def __post_init__(self) -> None:
        _guard_board_and_margin(self)
        angle = number(self.angle, "angle")
        if not 0 < angle <= np.pi:
            raise CvnotesError(
                f"angle: the planes meet at an angle in (0, π] radians, got {angle:g}"
                + (" (degrees?)" if angle > np.pi else "")
            )
        object.__setattr__(self, "angle", angle)

    @property
    def faces(self) -> Faces:
        """Back and side: each ``world_from_board`` (4, 4) with its board."""
        near, across, _ = _reach(self.board, self.margin)
        # Rounded, so that a right angle gives exact zeros.
        cos, sin = np.cos(self.angle).round(15) + 0.0, np.sin(self.angle).round(15)
        back = pose(np.eye(3), [near, 0, 0])
        # Columns: the board's x, y and z axes in the WRF. x runs to the edge.
        side = pose([[-cos, 0, -sin], [0, 1, 0], [sin, 0, -cos]], [across * cos, 0, -across * sin])
        return (back, self.board), (side, self.board)

    @property
    def points(self) -> Array:
        """Inner corners (n, 3) of the back face, then of the side face."""
        return _all_points(self.faces)


@dataclass(frozen=True)
class ThreePlanes:
    """Three equal boards in the inside corner of a box: back wall, side wall and floor.

    Parameters
    ----------
    board : Chessboard
        The board on each plane.
    margin : float
        White paper between the squares and the edges, in squares.

    Notes
    -----
    WRF: origin in the corner, the planes are z = 0 (back), x = 0 (side) and y = 0 (floor); the
    target is seen from x > 0, y < 0, z < 0. The walls read from left to right and from the top
    down, the floor from the back to the front. Order of corners: back, side, floor.

    References
    ----------
    .. [1] Notes 2b.4, "Calibration Targets": several known planes in one picture.

    Examples
    --------
    >>> target = ThreePlanes(Chessboard((3, 2), 25.0))
    >>> target.points[[0, 6, 12]]
    array([[  50.,  -75.,    0.],
           [   0.,  -75., -100.],
           [  50.,    0.,  -50.]])
    """

    board: Chessboard = field(default_factory=Chessboard)
    margin: float = 1.0

    def __post_init__(self) -> None:
        _guard_board_and_margin(self)

    @property
    def faces(self) -> Faces:
        """Back, side and floor: each ``world_from_board`` (4, 4) with its board."""
        near, across, down = _reach(self.board, self.margin)
        # Columns of each rotation: the board's x, y and z axes in the WRF.
        back = pose(np.eye(3), [near, -down, 0])
        side = pose([[0, 0, -1], [0, 1, 0], [1, 0, 0]], [0, -down, -across])
        floor = pose([[1, 0, 0], [0, 0, 1], [0, -1, 0]], [near, 0, -near])
        return (back, self.board), (side, self.board), (floor, self.board)

    @property
    def points(self) -> Array:
        """Inner corners (n, 3) of back, side and floor."""
        return _all_points(self.faces)


def _guard_board_and_margin(target: "TwoPlanes | ThreePlanes") -> None:
    if not isinstance(target.board, Chessboard):
        raise CvnotesError(f"board: expected a Chessboard, got {type(target.board).__name__}")
    margin = number(target.margin, "margin")
    if margin < 0:
        raise CvnotesError(f"margin: {margin:g} squares would let the boards overlap at the edge")
    object.__setattr__(target, "margin", margin)


def _reach(board: Chessboard, margin: float) -> tuple[float, float, float]:
    """Distances from an edge to the nearest corners, to the last column and to the last row."""
    near = (1 + margin) * board.square
    columns, rows = board.corners
    return near, near + (columns - 1) * board.square, near + (rows - 1) * board.square


def _all_points(faces: Faces) -> Array:
    return np.concatenate([move(world_from_board, b.points) for world_from_board, b in faces])
