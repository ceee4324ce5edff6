"""Why what was found is not the board that was looked for, and what is said of it."""

import numpy as np

from cvnotes.base import Array, CornersNotFound
from cvnotes.targets.chessboard import Chessboard

_SAME = 0.3  # of a square: nearer to each other, two corners are the same


class NotABoard(Exception):
    """Why corners that were found are not to be trusted, and the count that is there if known.

    `instead` says what was found instead of the board, if anything was.
    """

    def __init__(
        self,
        reason: str,
        count: tuple[int, int] | None = None,
        found: Array | None = None,
        instead: str = "",
    ) -> None:
        super().__init__(reason)
        self.count, self.found, self.instead = count, found, instead


def check_whole(m: Array, corners: tuple[int, int], doubts: list[NotABoard]) -> None:
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


def not_found(
    shape: tuple[int, ...],
    board: Chessboard,
    tried: list[str],
    doubts: list[NotABoard],
    markers: str = "",
) -> CornersNotFound:
    """Describe what was looked for, what was tried, and what probably went wrong."""
    (columns, rows), (height, width) = board.corners, shape
    start = (
        f"no board of {columns}×{rows} inner corners found in a picture of {width}×{height} pixels"
    )
    if not tried:
        few = f"{start}: boards need at least 3 inner corners along each side to be found"
        return CornersNotFound(few)
    if markers:
        there = f"{start}: there are markers of {markers}"
        question = "is it a ChArUco board (--charuco, with the name of its markers)?"
        lesson = f"{there}; {question}"
        return CornersNotFound(lesson, brief=there, question=question, markers=markers)
    of_copy: dict[str, str] = {}
    for each in tried:  # of a copy the largest that was found says most
        of_copy.setdefault(each.partition(":")[0], each)
    question = _guess(board, doubts)
    lesson = f"{start} ({'; '.join(of_copy.values())}); {question}"
    if not doubts:
        return CornersNotFound(lesson, brief=start, question=question)
    most = max(doubts, key=lambda doubt: 0 if doubt.found is None else len(doubt.found))
    brief, count = f"{start}: {most.instead}", _largest(doubts)
    return CornersNotFound(lesson, brief=brief, question=question, found=most.found, count=count)


def _guess(board: Chessboard, doubts: list[NotABoard]) -> str:
    """Guess what went wrong, from what was found instead."""
    long, short = max(board.corners), min(board.corners)
    count = _largest(doubts)
    # Where the board that was asked for was found, a smaller one is a part of it.
    if count and (count[0] * count[1] > long * short or all(doubt.count for doubt in doubts)):
        columns, rows = count
        there = f"a board of {columns}×{rows} inner corners is there"
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
