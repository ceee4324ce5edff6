"""From a picture to the ordered corners of a board."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, InputTypeError
from cvnotes.targets.charuco import CharucoBoard
from cvnotes.targets.charuco_corners import measured_numbered
from cvnotes.targets.chessboard import Chessboard
from cvnotes.targets.doubts import NotABoard, check_whole, not_found
from cvnotes.targets.grey import Grey8, copies, eight_bits, grey_picture
from cvnotes.targets.lattice import as_asked, measured
from cvnotes.targets.markers import find_numbered, markers_in
from cvnotes.targets.saddle_points import lattices

_COUNTED = 1_300_000  # pixels of the largest copy in which corners are counted


def find_corners(
    image: npt.ArrayLike, board: Chessboard | CharucoBoard, *, partial: bool = False
) -> Array:
    """Find the inner corners of a chessboard in a picture.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3 or 4)
        The picture: grey, RGB or RGBA; uint8, uint16 or floating point of any range.
    board : Chessboard or CharucoBoard
        What was photographed.
    partial : bool
        Accept a board of which up to a quarter of the corners are hidden, dirty or out of line. Of
        a `CharucoBoard` any four corners are accepted, always.

    Returns
    -------
    ndarray, shape (n, 2)
        Pixels (u, v), in the order of ``board.points``; with `partial`, and of a `CharucoBoard`,
        NaN for lost corners.

    Raises
    ------
    CornersNotFound
        The board is not there, or what was found is not to be trusted: it goes on beyond the
        corners asked for, or a corner is hidden. The message says what was tried.

    Notes
    -----
    1. In a small copy of the picture, then in larger ones, saddle points of the grey levels are
       joined into lattices (`cvnotes.targets.saddle_points`).
    2. The model of two blurred edges is fitted to the pixels of the whole picture (`fit_edges`).
    3. Seen from its front, a board is right-handed, and the square outside of its origin is dark:
       that puts the corners in order. A board that looks the same after half a turn gets its
       origin at the end nearer to the picture's top left pixel.
    4. The result is doubted: are the squares alternately light and dark, do the corners continue
       each other smoothly, does the pattern end where the board should?

    References
    ----------
    .. [1] Notes 2b.4, "Corner detection" and "Zhang's Method".

    Examples
    --------
    >>> from cvnotes.camera import Camera, intrinsics
    >>> from cvnotes.camera import pose
    >>> from cvnotes.pictures import render
    >>> board = Chessboard((9, 6), 25.0)
    >>> camera = Camera(intrinsics(800, 800, 320, 240), pose(np.eye(3), [-100, -60, 600]))
    >>> m = find_corners(render(board, camera, blur=0.7), board)
    >>> bool(np.abs(m - camera.project(board.points)).max() < 0.01)
    True
    """
    if not isinstance(board, Chessboard | CharucoBoard):
        raise InputTypeError(
            f"board: expected a Chessboard or CharucoBoard, got {type(board).__name__}"
        )
    picture = grey_picture(image)
    grey = eight_bits(picture)
    if isinstance(board, CharucoBoard):
        numbered = find_numbered(grey, *board.read_by)
        return measured_numbered(picture, numbered, board)
    tried: list[str] = []
    doubts: list[NotABoard] = []
    best = np.full((0, 2), np.nan)
    for k, copy in copies(grey) if min(board.corners) > 2 else ():
        there = sorted(lattices(copy), key=lambda each: -each.shape[0] * each.shape[1])
        at = f"{copy.shape[1]}×{copy.shape[0]}"
        tried += [] if there else [f"{at}: not found"]
        for lattice in there:
            try:
                found = as_asked(lattice, board.corners, k)
                m = measured(picture, found, copy=copy, k=k, partial=partial)
                check_whole(m, board.corners, doubts)
            except NotABoard as doubt:
                tried.append(f"{at}: {doubt}")
                doubts.append(doubt)
                continue
            best = max(best, m, key=lambda m: np.count_nonzero(np.isfinite(m)))
            if np.isfinite(best).all():
                return best
    if not len(best):
        raise not_found(picture.shape, board, tried, doubts, markers_in(grey))
    return best


def count_corners(image: npt.ArrayLike) -> tuple[int, int] | None:
    """Count the inner corners of whatever chessboard is in a picture.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3 or 4)
        The picture.

    Returns
    -------
    (columns, rows) or None
        The larger number first; None if there is no board with 3×3 inner corners or more. Of a
        board that is cut off or covered along a side, it is what can be seen.

    Examples
    --------
    >>> from cvnotes.camera import Camera, intrinsics
    >>> from cvnotes.camera import pose
    >>> from cvnotes.pictures import render
    >>> camera = Camera(intrinsics(800, 800, 320, 240), pose(np.eye(3), [-100, -60, 600]))
    >>> count_corners(render(Chessboard((9, 6), 25.0), camera, blur=0.7))
    (9, 6)
    """
    grey = eight_bits(grey_picture(image))
    every = [each for _, copy in copies(grey, _COUNTED) for each in lattices(copy)]
    if not every:
        return None
    rows, columns = max((each.shape[:2] for each in every), key=np.prod)
    return max(columns, rows), min(columns, rows)


def rough_corners(grey: Grey8, corners: tuple[int, int]) -> Array | None:
    """Look for a board of so many corners (columns, rows), to about a pixel, in a live picture.

    Returns (n, 2) row by row, NaN for hidden ones, or None; their order is the picture's.

    Examples
    --------
    >>> rough_corners(np.zeros((40, 40), np.uint8), (9, 6)) is None
    True
    """
    for k, copy in copies(grey):
        for lattice in lattices(copy):
            try:
                return ((as_asked(lattice, corners, k) + 0.5) * k - 0.5).reshape(-1, 2)
            except NotABoard:
                continue
    return None
