"""What is drawn on a sheet: the squares, a line around, and what stands under the board."""

from cvnotes.page import Area, Line, Shape, Text, rectangle

EDGE = 5.0  # what a printer cannot reach
FOOT = 12.0  # height of the words and the ruler
_GREY = 0.45
_RULER = 100


def squares(columns: int, rows: int, square: float, left: float, top: float) -> Area:
    """Draw the dark squares; the one in the top left corner is dark."""
    return Area(
        tuple(
            rectangle(left + i * square, top + j * square, square, square)
            for j in range(rows + 1)
            for i in range(columns + 1)
            if (i + j) % 2 == 0
        )
    )


def frame(x: float, y: float, width: float, height: float) -> Line:
    """Draw a thin line around."""
    corners = rectangle(x, y, width, height)
    return Line((*corners, corners[0]), 0.15, _GREY)


def foot(
    corners: tuple[int, int], square: float, size: tuple[float, float], width: float
) -> list[Shape]:
    """Draw what stands under the board: its frame, its numbers, and the ruler."""
    columns, rows = corners
    x, y = (size[0] - width) / 2, size[1] - EDGE - FOOT
    words = x + 18
    symmetric = ", True" if (columns - rows) % 2 == 0 else ""
    code = f"Chessboard(({columns}, {rows}), {square:g}{symmetric})"
    return [
        *_key(x, y + 2.5),
        Text(words, y + 4.5, f"{columns} by {rows} inner corners", 3.4, "Helvetica-Bold"),
        Text(words, y + 8, f"{columns + 1} by {rows + 1} squares of {square:g} mm", 2.8),
        Text(words, y + 11.4, code, 2.5, "Courier", _GREY),
        *_ruler(x + width - _RULER, y + 2.5),
    ]


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


def _ruler(x: float, y: float) -> list[Shape]:
    """Draw a ruler of 100 mm with a line for each."""
    shapes: list[Shape] = [Line(((x, y), (x + _RULER, y)), 0.15)]
    for mm in range(_RULER + 1):
        length = 3.0 if mm % 10 == 0 else 2.2 if mm % 5 == 0 else 1.4
        shapes.append(Line(((x + mm, y), (x + mm, y + length)), 0.1 if mm % 10 else 0.15))
    for cm in range(0, _RULER + 1, 10):
        label, size = str(cm), 2.2
        # A digit of Helvetica is 0.556 of its size wide.
        shapes.append(Text(x + cm - len(label) * 0.278 * size, y + 5.2, label, size, grey=_GREY))
    advice = (
        "Print at 100 %, then measure: this ruler is 100 mm long. Glue the sheet to something flat."
    )
    shapes.append(Text(x, y + 8.9, advice, 2.4))
    return shapes
