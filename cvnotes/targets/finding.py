"""From a picture to the ordered corners of a board."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CornersNotFound, InputTypeError
from cvnotes.targets.charuco import CharucoBoard
from cvnotes.targets.charuco_corners import measured_numbered
from cvnotes.targets.chessboard import Chessboard
from cvnotes.targets.finders import PART_PIXELS, attempts, reduced, sighted
from cvnotes.targets.grey import eight_bits, grey_picture
from cvnotes.targets.growing import grown_board
from cvnotes.targets.lattice import NotABoard, measured
from cvnotes.targets.opencv_finders import find_numbered


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
    1. OpenCV's finders say where the board is, in a reduced copy if the picture is large; if they
       find none, whatever board there is is grown (`cvnotes.targets.growing`).
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
        side = 1 - 2 * board.clear  # of a marker, in squares
        seen = find_numbered(grey, board.squares, side, board.dictionary)
        return measured_numbered(picture, seen, board)
    tried: list[str] = []
    others: list[tuple[int, int]] = []
    shown: Array | None = None
    best = np.full((0, 2), np.nan)
    if min(board.corners) > 2:
        for name, finder, copy in attempts(grey):
            try:
                found = sighted(finder, copy, board.corners, grey)
                m = measured(picture, copy, found, partial=partial)
            except NotABoard as doubt:
                tried.append(f"{name}: {doubt}")
                others += [doubt.count] if doubt.count else []
                shown = doubt.found if shown is None else shown
                continue
            best = max(best, m, key=lambda m: np.count_nonzero(np.isfinite(m)))
            if np.isfinite(best).all():
                break
    if not len(best):
        error = CornersNotFound(_lesson(picture.shape, board, tried, others))
        error.found = shown
        raise error
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
    lattice = grown_board(reduced(eight_bits(grey_picture(image)), PART_PIXELS))
    return None if lattice is None else (lattice.shape[1], lattice.shape[0])


def _lesson(
    shape: tuple[int, ...], board: Chessboard, tried: list[str], others: list[tuple[int, int]]
) -> str:
    """Say what was looked for, what was tried, and what probably went wrong."""
    (columns, rows), (height, width) = board.corners, shape
    start = (
        f"no board of {columns}×{rows} inner corners found in a picture of {width}×{height} pixels"
    )
    if not tried:
        return f"{start}: boards need at least 3 inner corners along each side to be found"
    return f"{start} ({'; '.join(tried)}); {_guess(board, tried, others)}"


def _guess(board: Chessboard, tried: list[str], others: list[tuple[int, int]]) -> str:
    """Guess what went wrong, from other boards (columns, rows) that were found instead."""
    long, short = max(board.corners), min(board.corners)
    # A finder that found the board that was asked for knows better than who grows a part of it.
    if others and not any("found, but its" in words for words in tried):
        columns, rows = others[0]
        there = f"but a board of {columns}×{rows} inner corners is there"
        if (columns, rows) == (long - 1, short - 1):
            return f"{there}: were its squares counted instead of its inner corners?"
        if columns > long or rows > short:
            return f"{there}: were all of its inner corners counted?"
        return (
            f"only {columns}×{rows} of them can be seen: is the whole board in the picture, with "
            "paper around it and unhidden, and are its inner corners counted right?"
        )
    return (
        "is the whole board in the picture, with paper around it, unhidden and sharp, and are "
        "its inner corners (where four squares meet) counted, not its squares?"
    )
