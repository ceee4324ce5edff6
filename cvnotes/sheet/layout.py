"""Where a board goes on its paper, upright or across, and whether it fits."""

from cvnotes.errors import CvnotesError, image_size, number
from cvnotes.page import Page
from cvnotes.sheet.drawing import EDGE, FOOT, foot, frame, squares
from cvnotes.sheet.printable import Sheet

PAPERS = {"A4": (210.0, 297.0), "Letter": (215.9, 279.4), "A3": (297.0, 420.0)}  # upright, mm
_FOOT_WIDTH = 190.0  # what the words and the ruler under the board need


def lay_out(corners: tuple[int, int], square: float, paper: str = "A4") -> Sheet:
    """Lay a chessboard out on paper, upright or across, whichever suits it.

    Parameters
    ----------
    corners : (columns, rows)
        Inner corners.
    square : float
        Side of a square in millimetres.
    paper : {"A4", "Letter", "A3"}
        The paper to print on.

    Raises
    ------
    CvnotesError
        The board does not fit; the message says what would.

    Notes
    -----
    Around the squares stays a white margin of up to one square, closed by a thin line: finding
    the corners needs it, so cut outside of the line. The ruler under the board is 100 mm long
    if, and only if, the sheet was printed at its true size.

    References
    ----------
    .. [1] Notes 2b.4, "Calibration Targets".

    Examples
    --------
    >>> lay_out((9, 6), 40.0)
    Traceback (most recent call last):
        ...
    cvnotes.errors.CvnotesError: a board of 10 by 7 squares of 40 mm does not fit on A4; \
squares of up to 25 mm do
    """
    corners, square = image_size(corners, "corners"), number(square, "square")
    size, quiet = _oriented(corners, square, paper)
    columns, rows = corners
    title = f"Chessboard, {columns} by {rows} inner corners, squares of {square:g} mm"
    width, height = (columns + 1) * square, (rows + 1) * square
    left = _on_raster((size[0] - width) / 2 + square) - square
    top = _on_raster((size[1] - FOOT - height) / 2 + square) - square
    border = frame(left - quiet, top - quiet, width + 2 * quiet, height + 2 * quiet)
    shapes = (
        squares(columns, rows, square, left, top),
        border,
        *foot(corners, square, size, max(width + 2 * quiet, _FOOT_WIDTH)),
    )
    return Sheet(Page(title, size, shapes))


def _oriented(
    corners: tuple[int, int], square: float, paper: str
) -> tuple[tuple[float, float], float]:
    """Turn the paper for the larger margin (of up to a square); if equal, as the board lies."""
    if paper not in PAPERS:
        raise CvnotesError(f"paper: expected one of {', '.join(PAPERS)}, got {paper!r}")
    if square < 1:
        raise CvnotesError(
            f"a sheet is measured in millimetres and squares of {square:g} mm cannot be printed "
            "(metres?)"
        )
    wide = corners[0] > corners[1]
    margin, _, size = max(
        (min(_margin(corners, square, size), square), (size[0] > size[1]) == wide, size)
        for size in _ways(paper)
    )
    if margin < _least_margin(square):
        raise CvnotesError(_refusal(corners, square, paper))
    return size, margin


def _ways(paper: str) -> tuple[tuple[float, float], tuple[float, float]]:
    width, height = PAPERS[paper]
    return (width, height), (height, width)


def _margin(corners: tuple[int, int], square: float, size: tuple[float, float]) -> float:
    """White that stays around the squares; negative if they do not even fit."""
    across = size[0] - (corners[0] + 1) * square - 2 * EDGE
    down = size[1] - (corners[1] + 1) * square - 2 * EDGE - FOOT
    return min(across, down) / 2


def _least_margin(square: float) -> float:
    return max(5.0, square / 5)


def _refusal(corners: tuple[int, int], square: float, paper: str) -> str:
    """Say what would fit: smaller squares on this paper, or this board on another."""

    def fits(square: float, paper: str) -> bool:
        margins = (_margin(corners, square, size) for size in _ways(paper))
        return max(margins) >= _least_margin(square)

    largest = min(square, max(PAPERS[paper]))
    halves = [n / 2 for n in range(2, int(2 * largest) + 1) if fits(n / 2, paper)]
    offers = [f"squares of up to {halves[-1]:g} mm do"] if halves else []
    offers += [f"take {other}" for other in PAPERS if other != paper and fits(square, other)][:1]
    columns, rows = (n + 1 for n in corners)
    return f"a board of {columns} by {rows} squares of {square:g} mm does not fit on {paper}; " + (
        ", or ".join(offers) or "take fewer squares"
    )


def _on_raster(mm: float) -> float:
    """Move a place by less than 0.05 mm, to just inside of a dot of a 300 dpi printer.

    Printers and viewers round edges to dots, or to quarters of dots. With the first corner placed
    so, no two neighbours of a 9×6 board of 25 mm, 295.28 dots, are rounded in opposite directions.
    """
    dot = 25.4 / 300
    return (round(mm / dot) + 0.02) * dot
