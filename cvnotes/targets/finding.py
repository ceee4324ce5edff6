"""From a picture to the ordered corners of a board."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CornersNotFound, Image, InputTypeError, stretched
from cvnotes.targets.chessboard import Chessboard
from cvnotes.targets.doubts import NotABoard, check_board, check_pattern_ends
from cvnotes.targets.edge_corners import fit_edges
from cvnotes.targets.opencv_finders import Grey8, find_classic, find_sb, shrink
from cvnotes.targets.patches import grey_picture

# Who looks for the board, and in a copy of at most how many pixels. The classic finder can take
# minutes on large pictures without a board; the last attempt is for small boards in large ones.
_ATTEMPTS = (
    ("SB", find_sb, 1_300_000),
    ("classic", find_classic, 500_000),
    ("SB", find_sb, 12_000_000),
)
_HINT_PIXELS = 500_000


def find_corners(image: npt.ArrayLike, board: Chessboard) -> Array:
    """Find the inner corners of a chessboard in a picture.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3 or 4)
        The picture: grey, RGB or RGBA; uint8, uint16 or floating point of any range.
    board : Chessboard
        What was photographed.

    Returns
    -------
    ndarray, shape (n, 2)
        Pixels (u, v), in the order of ``board.points``.

    Raises
    ------
    CornersNotFound
        The board is not there, or what was found is not to be trusted: it goes on beyond the
        corners asked for, or a corner is hidden. The message says what was tried.

    Notes
    -----
    1. OpenCV's finders say where the board is, in a reduced copy if the picture is large.
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
    if not isinstance(board, Chessboard):
        raise InputTypeError(f"board: expected a Chessboard, got {type(board).__name__}")
    picture = grey_picture(image)
    grey, tried = stretched(picture), []
    if min(board.corners) > 2:
        for name, finder, scale in _attempts(grey):
            found = finder(scale, board.corners)
            tried.append(f"{name} finder at {_size(scale)}: ")
            if found is None:
                tried[-1] += "not found"
                continue
            try:
                return _measure(picture, grey, scale, found, board)
            except NotABoard as doubt:
                tried[-1] += f"found, but {doubt}"
    raise CornersNotFound(_lesson(grey, board, tried))


def _attempts(grey: Grey8) -> Iterator[tuple[str, Any, Grey8]]:
    """Give each finder with the copy of the picture that it should look at, no pair twice."""
    seen = set()
    for name, finder, most in _ATTEMPTS:
        copy = _reduced(grey, most)
        if (name, copy.shape) not in seen:
            seen.add((name, copy.shape))
            yield name, finder, copy


def _measure(picture: Image, grey: Grey8, copy: Grey8, found: Array, board: Chessboard) -> Array:
    """Refine what a finder found in a copy, in the copy and then in the picture itself."""
    columns, rows = board.corners
    if copy.shape != grey.shape:
        refined = fit_edges(copy, found, grid=board.corners).m
        found = np.where(np.isfinite(refined), refined, found)
        zoom = np.array(grey.shape[::-1]) / copy.shape[::-1]
        found = (found + 0.5) * zoom - 0.5
    fit = fit_edges(picture, found, window=_window(found, rows), grid=board.corners)
    check_board(fit, board.corners)
    check_pattern_ends(picture, fit, board.corners)
    return ordered(fit.m.reshape(rows, columns, 2), fit.contrast.reshape(rows, columns))


def _window(m: Array, rows: int) -> int:
    """Half a window: 8 px, more where squares are larger than 64 px (their blur is, too)."""
    sides = np.linalg.norm(np.diff(m.reshape(rows, -1, 2), axis=1), axis=-1)
    return int(np.clip(np.median(sides) / 8, 8, 16))


def _reduced(grey: Grey8, pixels: int) -> Grey8:
    """Give a copy of at most so many pixels."""
    height, width = grey.shape
    zoom = np.sqrt(pixels / grey.size)
    if zoom >= 1:
        return grey
    return shrink(grey, (max(int(width * zoom), 1), max(int(height * zoom), 1)))


def _size(image: Image) -> str:
    return f"{image.shape[1]}×{image.shape[0]}"


def _lesson(grey: Grey8, board: Chessboard, tried: list[str]) -> str:
    """Say what was looked for, what was tried, and what probably went wrong."""
    columns, rows = board.corners
    start = f"no board of {columns}×{rows} inner corners found in a picture of {_size(grey)} pixels"
    if not tried:
        return f"{start}: boards need at least 3 inner corners along each side to be found"
    fewer = (columns - 1, rows - 1)
    if min(fewer) > 2 and find_sb(_reduced(grey, _HINT_PIXELS), fewer) is not None:
        why = (
            f"but a board of {fewer[0]}×{fewer[1]} inner corners is there: "
            "were its squares counted instead of its inner corners?"
        )
    else:
        why = (
            "is the whole board in the picture, with paper around it, unhidden and sharp, and are "
            "its inner corners (where four squares meet) counted, not its squares?"
        )
    return f"{start} ({'; '.join(tried)}); {why}"


def ordered(lattice: Array, contrast: Array) -> Array:
    """Put corners in the order of ``board.points``, whatever the order of the finder.

    Parameters
    ----------
    lattice : ndarray, shape (rows, columns, 2)
        Corners with neighbours next to each other.
    contrast : ndarray, shape (rows, columns)
        Positive where the quadrant towards larger row and column, and the one opposite, is light.

    Returns
    -------
    ndarray, shape (rows · columns, 2)
        Right-handed, and with a dark square outside of the first corner. If several orders are
        so, the one whose first corner is nearest to the picture's top left pixel.

    Examples
    --------
    >>> lattice = np.stack(np.meshgrid([10.0, 20, 30], [10.0, 20]), axis=-1)
    >>> light = np.array([[1, -1, 1], [-1, 1, -1]])
    >>> ordered(lattice, light)[0]  # the square outside of (10, 10) is light
    array([30., 20.])
    """
    if handedness(lattice) < 0:
        lattice, contrast = lattice[:, ::-1], -contrast[:, ::-1]
    same_shape = (0, 1, 2, 3) if lattice.shape[0] == lattice.shape[1] else (0, 2)
    # A quarter turn exchanges the two pairs of opposite quadrants.
    turned = [(np.rot90(lattice, k), (-1) ** k * np.rot90(contrast, k)) for k in same_shape]
    dark = [m for m, c in turned if _alternating(c) < 0] or [m for m, _ in turned]
    first = min(dark, key=lambda m: float(np.hypot(*m[0, 0])))
    return np.array(first).reshape(-1, 2)


def handedness(lattice: Array) -> float:
    """Give the mean signed area of a board's squares, positive if seen from its front.

    Examples
    --------
    >>> handedness(np.stack(np.meshgrid([1.0, 2, 3], [1.0, 2]), axis=-1))
    1.0
    """
    x, y = np.diff(lattice, axis=1)[:-1], np.diff(lattice, axis=0)[:, :-1]
    return float(np.mean(x[..., 0] * y[..., 1] - x[..., 1] * y[..., 0]))


def _alternating(contrast: Array) -> float:
    """Sum contrasts with a chessboard's signs: negative if the square before (0, 0) is dark."""
    i, j = np.indices(contrast.shape)
    return float((contrast * (-1.0) ** (i + j)).sum())
