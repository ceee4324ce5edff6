"""What is photographed: calibration targets as points in a frame of their own (notes 2b.4).

Every target is made of chessboards: ``faces`` gives each board with its pose in the target's
frame, ``points`` all inner corners, face after face and each in its board's own order.
"""

from dataclasses import dataclass, field

import numpy as np

from cvnotes.errors import Array, CvnotesError, image_size, number
from cvnotes.rigid import move, pose
from cvnotes.sheet import Sheet, lay_out

Faces = tuple[tuple[Array, "Chessboard"], ...]


@dataclass(frozen=True)
class Chessboard:
    """A planar chessboard, named by its inner corners and the side of a square.

    Parameters
    ----------
    corners : (columns, rows)
        Inner corners along x and along y; both at least 2.
    square : float
        Side of a square; it sets the unit of all lengths (the course uses millimetres).
    half_turn_symmetric : bool
        Must be True for a board whose two counts are both even or both odd. Such a board looks
        the same after half a turn, so that a picture cannot tell where its origin is.

    Notes
    -----
    The WRF lies on the board: origin in the first inner corner, x along the columns, y along the
    rows, z = 0, pointing away from whoever looks at it. The square outside of the origin corner,
    towards −x and −y, is dark. The notes ask for counts that differ; what makes the board
    recognisable is that they differ in parity (erratum E18).

    References
    ----------
    .. [1] Notes 2b.4, "Zhang's Method".

    Examples
    --------
    >>> board = Chessboard((9, 6), 25.0)
    >>> board.points[:2]
    array([[ 0.,  0.,  0.],
           [25.,  0.,  0.]])
    """

    corners: tuple[int, int] = (9, 6)
    square: float = 25.0
    half_turn_symmetric: bool = False

    def __post_init__(self) -> None:
        columns, rows = image_size(self.corners, "corners")
        square = number(self.square, "square")
        if min(columns, rows) < 2:
            raise CvnotesError(f"corners: a board needs at least 2×2 inner corners, got {self}")
        if square <= 0:
            raise CvnotesError(f"square: the side of a square must be positive, got {square:g}")
        if (columns - rows) % 2 == 0 and not self.half_turn_symmetric:
            raise CvnotesError(
                f"a board of {columns}×{rows} inner corners looks the same after half a turn, so "
                "its origin cannot be told from a picture; take one even and one odd count "
                "(9×6), or say half_turn_symmetric=True"
            )
        object.__setattr__(self, "corners", (columns, rows))
        object.__setattr__(self, "square", square)

    @property
    def points(self) -> Array:
        """Inner corners (n, 3), row by row: x runs fastest, z = 0."""
        columns, rows = self.corners
        grid = np.zeros((rows, columns, 3))
        grid[..., 0] = self.square * np.arange(columns)
        grid[..., 1] = self.square * np.arange(rows)[:, None]
        return grid.reshape(-1, 3)

    @property
    def squares(self) -> tuple[int, int]:
        """Numbers of squares along x and y, one more than inner corners."""
        return self.corners[0] + 1, self.corners[1] + 1

    @property
    def faces(self) -> Faces:
        """The board itself, in the pose (4, 4) that leaves it where it is."""
        return ((np.eye(4), self),)

    def sheet(self, paper: str = "A4") -> Sheet:
        """Lay the board out for printing, `square` read as millimetres.

        Parameters
        ----------
        paper : {"A4", "Letter", "A3"}
            The paper; it is turned as the board needs it.

        Returns
        -------
        Sheet
            With ``pdf()``, ``svg()`` and ``save(path)``.

        Raises
        ------
        CvnotesError
            The board does not fit; the message says what would.

        Examples
        --------
        >>> Chessboard((9, 6), 25.0).sheet().pdf()[:4]
        b'%PDF'
        """
        return lay_out(self.corners, self.square, paper)


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
