"""From a picture to the ordered corners of a board."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CornersNotFound, InputTypeError
from cvnotes.targets.charuco import CharucoBoard
from cvnotes.targets.charuco_corners import measured_numbered
from cvnotes.targets.chessboard import Chessboard
from cvnotes.targets.grey import Grey8, eight_bits, grey_picture, reduced
from cvnotes.targets.lattice import NotABoard, measured
from cvnotes.targets.markers import find_numbered
from cvnotes.targets.saddle_points import lattices, seen

# Pixels of the smallest copy of a picture in which a board is looked for, and of the largest. In
# the smallest, its squares are 10 px wide if it fills a quarter of the picture.
_SMALLEST, _LARGEST = 80_000, 12_000_000
_COUNTED = 1_300_000  # pixels of the largest copy in which corners are counted
_SAME = 0.3  # of a square: nearer to each other, two corners are the same


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
                found = _as_asked(lattice, board.corners, k)
                m = measured(picture, found, copy=copy, k=k, partial=partial)
                _check_whole(m, board.corners, doubts)
            except NotABoard as doubt:
                tried.append(f"{at}: {doubt}")
                doubts.append(doubt)
                continue
            best = max(best, m, key=lambda m: np.count_nonzero(np.isfinite(m)))
            if np.isfinite(best).all():
                return best
    if not len(best):
        raise _not_found(picture.shape, board, tried, doubts)
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
                return ((_as_asked(lattice, corners, k) + 0.5) * k - 0.5).reshape(-1, 2)
            except NotABoard:
                continue
    return None


def copies(grey: Grey8, largest: int = _LARGEST) -> Iterator[tuple[int, Grey8]]:
    """Yield reduced copies of a picture, and by how much they are, the smallest first."""
    k = max(round(np.sqrt(grey.size / _SMALLEST)), 1)
    while k:
        if grey.size <= largest * k * k:
            yield k, reduced(grey, k)
        k //= 2


def _as_asked(lattice: Array, corners: tuple[int, int], k: int) -> Array:
    """Turn a lattice so that it has as many columns and rows as were asked for."""
    columns, rows = corners
    if lattice.shape[:2] == (columns, rows):
        lattice = lattice.transpose(1, 0, 2)
    if lattice.shape[:2] != (rows, columns):
        count = max(lattice.shape[:2]), min(lattice.shape[:2])
        found = (lattice[seen(lattice)] + 0.5) * k - 0.5
        there = f"{count[0]}×{count[1]} corners"
        raise NotABoard(f"found {there}", count, found, instead=f"{there} are there")
    return lattice


def _check_whole(m: Array, corners: tuple[int, int], doubts: list[NotABoard]) -> None:
    """Refuse corners that are a part of a larger board that was seen before.

    Raises
    ------
    NotABoard
        With the larger board's count.
    """
    side = float(np.nanmedian(np.linalg.norm(np.diff(m, axis=0), axis=-1)))
    for doubt in doubts:
        if doubt.count is None or doubt.found is None or np.prod(doubt.count) <= np.prod(corners):
            continue
        away = np.linalg.norm(m[:, None] - doubt.found, axis=-1).min(1)
        if 2 * np.count_nonzero(away < _SAME * side) > len(m):
            columns, rows = doubt.count
            part = f"a part of {columns}×{rows} corners"
            raise NotABoard(part, doubt.count, doubt.found, instead=doubt.instead)


def _largest(doubts: list[NotABoard]) -> tuple[int, int] | None:
    """Return the count of the largest board among those found instead."""
    counts = [doubt.count for doubt in doubts if doubt.count]
    return max(counts, key=lambda count: count[0] * count[1], default=None)


def _not_found(
    shape: tuple[int, ...], board: Chessboard, tried: list[str], doubts: list[NotABoard]
) -> CornersNotFound:
    """Describe what was looked for, what was tried, and what probably went wrong."""
    (columns, rows), (height, width) = board.corners, shape
    start = (
        f"no board of {columns}×{rows} inner corners found in a picture of {width}×{height} pixels"
    )
    if not tried:
        few = f"{start}: boards need at least 3 inner corners along each side to be found"
        return CornersNotFound(few)
    lesson = f"{start} ({'; '.join(dict.fromkeys(tried))}); {_guess(board, doubts)}"
    if not doubts:
        return CornersNotFound(lesson, brief=start)
    most = max(doubts, key=lambda doubt: 0 if doubt.found is None else len(doubt.found))
    brief = f"{start}: {most.instead}"
    return CornersNotFound(lesson, brief=brief, found=most.found, count=_largest(doubts))


def _guess(board: Chessboard, doubts: list[NotABoard]) -> str:
    """Guess what went wrong, from what was found instead."""
    long, short = max(board.corners), min(board.corners)
    count = _largest(doubts)
    # Where the board that was asked for was found, a smaller one is a part of it.
    if count and (count[0] * count[1] > long * short or all(doubt.count for doubt in doubts)):
        columns, rows = count
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
