"""The printable sheet of a board: its layout on paper, what is drawn, and its PDF or SVG."""

import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from cvnotes.base import CvnotesError
from cvnotes.targets.page import Area, Line, Page, Shape, Text, rectangle

PathLike = str | os.PathLike[str]


@dataclass(frozen=True)
class Sheet:
    """A printable sheet.

    Parameters
    ----------
    page : Page
        What is drawn, on paper of ``page.size`` millimetres.

    Examples
    --------
    >>> from cvnotes.targets import Chessboard
    >>> Chessboard((9, 6), 25.0).sheet().page.size
    (297.0, 210.0)
    """

    page: Page

    def pdf(self) -> bytes:
        """Return the sheet as a PDF file, the same bytes every time."""
        return self.page.pdf()

    def svg(self) -> str:
        """Return the sheet as SVG, a user unit being a millimetre."""
        return self.page.svg()

    def save(self, path: PathLike) -> None:
        """Write the sheet; the name says how: ``.pdf`` or ``.svg``."""
        from cvnotes.base.writing import path_of, write_whole  # here: pathlib costs 4 ms to import

        write_whole({path_of(path): self.encoded(path)})

    def encoded(self, path: PathLike) -> bytes:
        """Return the bytes that belong into a file of that name.

        Raises
        ------
        CvnotesError
            The name ends neither in ``.pdf`` nor in ``.svg``.

        Examples
        --------
        >>> from cvnotes.targets import Chessboard
        >>> Chessboard((9, 6), 25.0).sheet().encoded("board.pdf")[:4]
        b'%PDF'
        """
        suffix = os.path.splitext(path)[1].lower()  # noqa: PTH122 (pathlib costs 4 ms to import)
        if suffix == ".pdf":
            return self.pdf()
        if suffix == ".svg":
            return self.svg().encode()
        raise CvnotesError(f"a sheet is written as .pdf or .svg, not as {suffix or 'no suffix'!r}")

    def _repr_svg_(self) -> str:
        return self.svg()


EDGE = 5.0  # what a printer cannot reach
FOOT = 12.0  # height of the words and the ruler along x
SIDE = 9.0  # width of the ruler along y
_GREY = 0.45
_RULER = 100


def dark_fields(board: Any, left: float, top: float) -> Area:
    """Draw what is dark of a board, the first square's corner being at (left, top).

    Fields beside each other in a row are one rectangle.
    """
    x, y, dark = board.printed
    x, y = x - x[0] + left, y - y[0] + top
    rectangles = []
    for row, above, below in zip(dark, y[:-1], y[1:], strict=True):
        begins, ends = (np.flatnonzero(np.diff(np.r_[0, row, 0]) == step) for step in (1, -1))
        for x0, x1 in zip(x[begins].tolist(), x[ends].tolist(), strict=True):
            rectangles.append(rectangle(x0, float(above), x1 - x0, float(below - above)))
    return Area(tuple(rectangles))


def frame(x: float, y: float, width: float, height: float) -> Line:
    """Draw a thin line around."""
    corners = rectangle(x, y, width, height)
    return Line((*corners, corners[0]), 0.15, _GREY)


def foot(board: Any, size: tuple[float, float], width: float) -> list[Shape]:
    """Draw what stands under the board: its frame, its numbers, and the ruler."""
    (columns, rows), square = board.corners, board.square
    x, y = (size[0] - width) / 2, size[1] - EDGE - FOOT
    words = x + 18
    more = ", True" if getattr(board, "half_turn_symmetric", False) else ""
    if dictionary := getattr(board, "dictionary", ""):
        more = f', {board.marker:g}, "{dictionary}"'
    code = f"{type(board).__name__}(({columns}, {rows}), {square:g}{more})"
    return [
        *_key(x, y + 2.5),
        Text(words, y + 4.5, f"{columns} by {rows} inner corners", 3.4, "Helvetica-Bold"),
        Text(words, y + 8, f"{columns + 1} by {rows + 1} squares of {square:g} mm", 2.8),
        Text(words, y + 11.4, code, 2.5, "Courier", _GREY),
        *_ruler_along_x(x + width - _RULER, y + 2.5),
    ]


def side(x: float, y: float) -> list[Shape]:
    """Draw what stands left of the board: a ruler that ends at x and begins at y, downwards."""
    shapes: list[Shape] = [Line(((x, y), (x, y + _RULER)), 0.15)]
    for mm in range(_RULER + 1):
        shapes.append(Line(((x, y + mm), (x - _tick(mm), y + mm)), 0.1 if mm % 10 else 0.15))
    for cm in range(0, _RULER + 1, 10):
        label = str(cm)
        shapes.append(
            Text(x - 3.6 - len(label) * _DIGIT, y + cm + 0.35 * _SMALL, label, _SMALL, grey=_GREY)
        )
    return shapes


def _key(x: float, y: float) -> list[Shape]:
    """Draw a small board that shows where the WRF lies on the large one."""
    ox, oy, tip = x + 3, y + 3, 0.7
    return [
        frame(x, y, 14, 9),
        Area((rectangle(x, y, 3, 3),), _GREY),
        Line(((ox, oy), (ox + 6, oy)), 0.3),
        Line(((ox, oy), (ox, oy + 3.6)), 0.3),
        Area(
            (
                ((ox + 6, oy - tip), (ox + 8, oy), (ox + 6, oy + tip)),
                ((ox - tip, oy + 3.4), (ox, oy + 5.4), (ox + tip, oy + 3.4)),
            )
        ),
        Text(ox + 8.6, oy + 0.7, "x", 2.5),
        Text(ox + 1.2, oy + 5.2, "y", 2.5),
    ]


_SMALL = 2.2  # size of the rulers' digits
_DIGIT = 0.556 * _SMALL  # a digit of Helvetica is 0.556 of its size wide


def _tick(mm: int) -> float:
    return 3.0 if mm % 10 == 0 else 2.2 if mm % 5 == 0 else 1.4


def _ruler_along_x(x: float, y: float) -> list[Shape]:
    """Draw a ruler of 100 mm with a line for each, and what to do with both rulers."""
    shapes: list[Shape] = [Line(((x, y), (x + _RULER, y)), 0.15)]
    for mm in range(_RULER + 1):
        shapes.append(Line(((x + mm, y), (x + mm, y + _tick(mm))), 0.1 if mm % 10 else 0.15))
    for cm in range(0, _RULER + 1, 10):
        label = str(cm)
        shapes.append(Text(x + cm - len(label) * _DIGIT / 2, y + 5.2, label, _SMALL, grey=_GREY))
    advice = "Print at 100 %, then measure: both rulers are 100 mm. Glue it to something flat."
    shapes.append(Text(x, y + 8.9, advice, 2.4))
    return shapes


PAPERS = {"A4": (210.0, 297.0), "Letter": (215.9, 279.4), "A3": (297.0, 420.0)}  # upright, mm
_FOOT_WIDTH = 190.0  # what the words and the ruler under the board need


def lay_out(board: Any, paper: str = "A4") -> Sheet:
    """Lay a board out on paper, upright or across, whichever suits it.

    Parameters
    ----------
    board : Chessboard or CharucoBoard
        Its lengths are read as millimetres.
    paper : {"A4", "Letter", "A3"}
        The paper to print on.

    Raises
    ------
    CvnotesError
        The board does not fit; the message says what would.

    Notes
    -----
    Around the squares stays a white margin of up to one square, closed by a thin line: finding
    the corners needs it, so cut outside of the line. The rulers under the board and left of it
    are 100 mm long if, and only if, the sheet was printed at its true size; one ruler could not
    tell a printer that stretches one direction only, which would change α_u / α_v.

    References
    ----------
    .. [1] Notes 2b.4, "Calibration Targets".

    Examples
    --------
    >>> from cvnotes.targets import Chessboard
    >>> lay_out(Chessboard((9, 6), 40.0))
    Traceback (most recent call last):
        ...
    cvnotes.base.errors.CvnotesError: a board of 10 by 7 squares of 40 mm does not fit on A4; \
squares of up to 25 mm do
    """
    corners, square = board.corners, board.square
    size, quiet = _oriented(corners, square, paper)
    columns, rows = corners
    kind = "ChArUco board" if hasattr(board, "dictionary") else "Chessboard"
    title = f"{kind}, {columns} by {rows} inner corners, squares of {square:g} mm"
    width, height = (columns + 1) * square, (rows + 1) * square
    middle = max((size[0] - width) / 2, EDGE + SIDE + quiet)
    left = _on_raster(middle + square) - square
    top = _on_raster((size[1] - FOOT - height) / 2 + square) - square
    border = frame(left - quiet, top - quiet, width + 2 * quiet, height + 2 * quiet)
    shapes = (
        dark_fields(board, left, top),
        border,
        *side(left - quiet - 1.5, top - quiet),
        *foot(board, size, max(width + 2 * quiet, _FOOT_WIDTH)),
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
    across = size[0] - (corners[0] + 1) * square - 2 * EDGE - SIDE
    down = size[1] - (corners[1] + 1) * square - 2 * EDGE - FOOT
    return min(across, down) / 2


def _least_margin(square: float) -> float:
    return max(5.0, square / 5)


def _refusal(corners: tuple[int, int], square: float, paper: str) -> str:
    """Describe what would fit: smaller squares on this paper, or this board on another."""

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
