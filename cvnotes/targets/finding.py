"""From a picture to the ordered corners of a board."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CornersNotFound, DegenerateError, Image, InputTypeError, stretched
from cvnotes.targets.charuco import CharucoBoard
from cvnotes.targets.charuco_corners import find_numbered
from cvnotes.targets.chessboard import Chessboard
from cvnotes.targets.doubts import NotABoard, check_board, check_pattern_ends, trusted, vouched
from cvnotes.targets.edge_corners import EdgeFit, fit_edges
from cvnotes.targets.growing import grown_board
from cvnotes.targets.lattice import completed, ordered
from cvnotes.targets.opencv_finders import Grey8, find_classic, find_sb, has_opencv, shrink
from cvnotes.targets.patches import grey_picture
from cvnotes.targets.saddle_points import find_saddles


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
       find none or only part of it, it is grown from that part (`cvnotes.targets.growing`).
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
    grey = _eight_bits(picture)
    if isinstance(board, CharucoBoard):
        return find_numbered(picture, grey, board)
    tried: list[str] = []
    others: list[tuple[int, int]] = []
    shown: Array | None = None
    best = np.full((0, 2), np.nan)
    if min(board.corners) > 2:
        for name, finder, copy in _attempts(grey):
            try:
                m = _measure(picture, grey, copy, finder(copy, board.corners), board, partial)
            except NotABoard as doubt:
                tried.append(f"{name} at {_size(copy)}: {doubt}")
                others += [doubt.count] if doubt.count else []
                if doubt.found is not None and shown is None:
                    shown = _in_full(doubt.found, copy, grey) if doubt.count else doubt.found
                continue
            best = max(best, m, key=lambda m: np.count_nonzero(np.isfinite(m)))
            if np.isfinite(best).all():
                break
    if not len(best):
        error = CornersNotFound(_lesson(grey, board, tried, others))
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
    lattice = grown_board(_reduced(_eight_bits(grey_picture(image)), _PART_PIXELS))
    return None if lattice is None else (lattice.shape[1], lattice.shape[0])


def _find_grown(grey: Grey8, corners: tuple[int, int]) -> Array | None:
    """Look for a board by growing it from a part; corners (n, 2), NaN where they are hidden."""
    lattice = grown_board(grey)
    if lattice is None:
        return None
    rows, columns = lattice.shape[:2]
    if (columns, rows) != (max(corners), min(corners)):
        seen = lattice[np.isfinite(lattice).all(-1)]
        raise NotABoard(f"found {columns}×{rows} corners", count=(columns, rows), found=seen)
    if corners[0] < corners[1]:
        lattice = lattice.transpose(1, 0, 2)
    return lattice.reshape(-1, 2)


# Who looks for the board, and in a copy of at most how many pixels: the quickest first. The
# classic finder can take minutes on large pictures without a board; the last attempt is for small
# boards in large ones.
_PART_PIXELS = 1_300_000
_ATTEMPTS = (
    ("classic finder", find_classic, 500_000),
    ("classic finder", find_classic, 1_300_000),
    ("SB finder", find_sb, 1_300_000),
    ("growing a part", _find_grown, _PART_PIXELS),
    ("SB finder", find_sb, 12_000_000),
)
_ATTEMPTS_WITHOUT_OPENCV = (
    ("saddle points", find_saddles, 500_000),
    ("saddle points", find_saddles, 1_300_000),
    ("growing a part", _find_grown, _PART_PIXELS),
    ("saddle points", find_saddles, 12_000_000),
)


# So much smaller, a pixel of a copy is more than the edge model's start may be off.
_MUCH_SMALLER = 2.5


def _attempts(grey: Grey8) -> Iterator[tuple[str, Any, Grey8]]:
    """Give each finder with the copy of the picture that it should look at, no pair twice."""
    seen = set()
    for name, finder, most in _ATTEMPTS if has_opencv() else _ATTEMPTS_WITHOUT_OPENCV:
        copy = _reduced(grey, most)
        if (name, copy.shape) not in seen:
            seen.add((name, copy.shape))
            yield name, finder, copy


def _measure(
    picture: Image,
    grey: Grey8,
    copy: Grey8,
    found: Array | None,
    board: Chessboard,
    partial: bool,
) -> Array:
    """Refine what a finder found in a copy, in the picture itself; first in a copy much smaller."""
    if found is None:
        raise NotABoard("not found")
    columns, rows = board.corners
    found = completed(found.reshape(rows, columns, 2)).reshape(-1, 2)
    try:
        if copy.shape[1] * _MUCH_SMALLER < grey.shape[1]:
            refined = fit_edges(copy, found, grid=board.corners).m
            found = np.where(np.isfinite(refined), refined, found)
        found = _in_full(found, copy, grey)
        fit = _fit_twice(picture, found, board.corners)
        check_board(fit, board.corners, partial=partial)
        good = trusted(fit, board.corners)[:, None]
        check_pattern_ends(picture, replace(fit, m=np.where(good, fit.m, np.nan)), board.corners)
    except DegenerateError:
        raise NotABoard("found, but its corners lie on a line") from None
    except NotABoard as doubt:
        raise NotABoard(f"found, but {doubt}", found=found) from None
    lattice = np.where(good, fit.m, np.nan).reshape(rows, columns, 2)
    return ordered(lattice, fit.contrast.reshape(rows, columns))


def _in_full(m: Array, copy: Grey8, grey: Grey8) -> Array:
    """Give where pixels of a copy lie in the picture that was reduced to it."""
    return np.asarray((m + 0.5) * (np.array(grey.shape[::-1]) / copy.shape[::-1]) - 0.5)


def _fit_twice(picture: Image, found: Array, corners: tuple[int, int]) -> EdgeFit:
    """Fit edges, for corners that come to nothing once more from where the others expect them."""
    columns, rows = corners
    window = _window(found, rows)
    fit = vouched(fit_edges(picture, found, window=window, grid=corners), picture, corners)
    good = trusted(fit, corners)
    if good.all() or 2 * np.count_nonzero(good) < len(good):
        return fit
    kept = np.where(good[:, None], fit.m, np.nan).reshape(rows, columns, 2)
    places = completed(kept).reshape(-1, 2)
    again = vouched(fit_edges(picture, places, window=window, grid=corners), picture, corners)
    better = np.count_nonzero(trusted(again, corners)) > np.count_nonzero(good)
    return again if better else fit


def _window(m: Array, rows: int) -> int:
    """Half a window: 8 px, more where squares are larger than 64 px (their blur is, too)."""
    sides = np.linalg.norm(np.diff(m.reshape(rows, -1, 2), axis=1), axis=-1)
    return int(np.clip(np.median(sides) / 8, 8, 16))


def _eight_bits(picture: Image) -> Grey8:
    """Give what OpenCV reads: 8-bit pictures as they are, whatever type holds them."""
    if picture.dtype == np.uint8:
        return picture.astype(np.uint8, copy=False)
    if picture.min() >= 0 and picture.max() <= 255:
        whole = picture.astype(np.uint8)
        if np.array_equal(whole, picture):
            return whole
    return stretched(picture)


def _reduced(grey: Grey8, pixels: int) -> Grey8:
    """Give a copy of at most so many pixels."""
    height, width = grey.shape
    zoom = np.sqrt(pixels / grey.size)
    if zoom >= 1:
        return grey
    return shrink(grey, (max(int(width * zoom), 1), max(int(height * zoom), 1)))


def _size(image: Image) -> str:
    return f"{image.shape[1]}×{image.shape[0]}"


def _lesson(grey: Grey8, board: Chessboard, tried: list[str], others: list[tuple[int, int]]) -> str:
    """Say what was looked for, what was tried, and what probably went wrong."""
    columns, rows = board.corners
    start = f"no board of {columns}×{rows} inner corners found in a picture of {_size(grey)} pixels"
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
