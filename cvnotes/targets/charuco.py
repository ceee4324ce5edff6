"""The ChArUco board: a chessboard whose light squares carry numbered markers."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, number
from cvnotes.targets.chessboard import Print, PrintedBoard
from cvnotes.targets.markers import DICTIONARIES, marker_cells


@dataclass(frozen=True)
class CharucoBoard(PrintedBoard):
    """A chessboard with numbered markers: each corner is known by itself.

    A picture needs to show only a part of it, so the board may reach beyond the picture's corners;
    and its origin is known whatever its counts are.

    Parameters
    ----------
    corners : (columns, rows)
        Inner corners along x and along y; both at least 2.
    square : float
        Side of a square; it sets the unit of all lengths (the course uses millimetres).
    marker : float, optional
        Side of a marker, three quarters of a square unless given.
    dictionary : str
        Which markers, as OpenCV names them: ``"4x4_50"`` has 50 of 4 by 4 bits; or AprilTags,
        such as ``"apriltag_36h11"``.
    legacy : bool, optional
        Whether it is in the pattern that OpenCV had before 4.6, in which a board with an even
        number of rows of squares begins with a light one; unless said, a picture tells, and new
        boards are not.

    Notes
    -----
    The WRF and the order of the corners are those of `Chessboard`; the square outside of the
    origin corner is dark. Markers are numbered from 0, row by row through the light squares.
    OpenCV's ``CharucoBoard`` counts squares, one more than inner corners, and has its origin one
    square before ours.

    References
    ----------
    .. [1] Absent from the notes.
    .. [2] S. Garrido-Jurado et al., Automatic generation and detection of highly reliable fiducial
       markers under occlusion, Pattern Recognition 47 (2014) 2280-2292.

    Examples
    --------
    >>> board = CharucoBoard((9, 6), 25.0)
    >>> board.marker, len(board.ids), board.n_markers
    (18.75, 54, 35)
    """

    marker: float | None = None
    dictionary: str = "4x4_50"
    legacy: bool | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        (columns, rows), square = self.corners, self.square
        marker = 0.75 * square if self.marker is None else number(self.marker, "marker")
        if not 0 < marker < square:
            raise CvnotesError(
                f"marker: a marker of {marker:g} does not fit into a square of {square:g} with "
                "white around it"
            )
        if self.dictionary not in DICTIONARIES:
            known = ", ".join(DICTIONARIES)
            raise CvnotesError(f"dictionary: expected one of {known}, got {self.dictionary!r}")
        most, _ = DICTIONARIES[self.dictionary]
        needed = (columns + 1) * (rows + 1) // 2
        if needed > most:
            raise CvnotesError(
                f"dictionary: {self.dictionary} has {most} markers and a board of {columns}×{rows} "
                f"inner corners needs {needed}"
            )
        object.__setattr__(self, "marker", marker)

    @property
    def ids(self) -> npt.NDArray[np.intp]:
        """Numbers (n,) of the inner corners, which are their places in `points`."""
        return np.arange(self.corners[0] * self.corners[1], dtype=np.intp)

    @property
    def n_markers(self) -> int:
        """How many markers the board carries: one in each light square."""
        return self.squares[0] * self.squares[1] // 2

    @property
    def clear(self) -> float:
        """Width of the white between a marker and its square's sides, in squares."""
        return (1 - float(self.marker or 0) / self.square) / 2

    @property
    def read_by(self) -> tuple[tuple[int, int], float, str, bool | None]:
        """What `find_numbered` asks for: squares, markers' side in squares, dictionary, pattern."""
        return self.squares, 1 - 2 * self.clear, self.dictionary, self.legacy

    @property
    def printed(self) -> Print:
        """What is printed: lines along x and y, and which fields between them are dark."""
        cells = marker_cells(self.dictionary, self.n_markers)
        within = np.concatenate([[0], np.linspace(self.clear, 1 - self.clear, cells.shape[1] + 1)])
        x, y = (
            self.square * np.append((np.arange(-1, n)[:, None] + within).ravel(), n)
            for n in self.corners
        )
        columns, rows = self.squares
        dark = np.ones((rows, len(within), columns, len(within)), dtype=bool)
        for marker, (i, j) in zip(cells, self._light_squares, strict=True):
            dark[j, :, i, :] = False
            dark[j, 1:-1, i, 1:-1] = marker
        return x, y, dark.reshape(rows * len(within), -1)

    @property
    def _light_squares(self) -> list[tuple[int, int]]:
        columns, rows = self.squares
        first = 0 if self.legacy and rows % 2 == 0 else 1
        return [(i, j) for j in range(rows) for i in range(columns) if (i + j) % 2 == first]
