"""Text for terminals: columns that stand below each other, and lines that are not too long."""

from collections.abc import Sequence

_LONGEST = 72  # letters of a cell, the last of a row excepted


def text_table(lines: Sequence[Sequence[str]]) -> str:
    """Lay out rows of text in columns, all but the first and the last to the right.

    A name that would push all other columns aside is shortened in its middle.

    Parameters
    ----------
    lines : sequence of rows
        The header first, if there is one; as many cells in each.

    Examples
    --------
    >>> print(text_table([["view", "px", "note"], ["left01", "0.2", ""], ["b", "11.5", "far off"]]))
    view      px  note
    left01   0.2
    b       11.5  far off
    """
    lines = [[*map(shortened, line[:-1]), line[-1]] for line in lines]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    ends = (0, len(widths) - 1)
    return "\n".join(
        "  ".join(
            cell.ljust(width) if i in ends else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    )


def shortened(name: str, width: int = _LONGEST) -> str:
    """Leave the middle out of a name that is too long: its beginning and its end tell it apart.

    Examples
    --------
    >>> shortened("photographs_of_the_first_camera_0001.png", 20)
    'photograph…_0001.png'
    """
    half = width // 2
    return name if len(name) <= width else f"{name[:half]}…{name[half + 1 - width :]}"


def clipped(line: str, width: int) -> str:
    """Cut a line that is too long, between two words if there are any, and say so by dots.

    Examples
    --------
    >>> clipped("the board is held too far away", 20)
    'the board is held …'
    >>> clipped("0123456789", 6), clipped("short", 6)
    ('01234…', 'short')
    """
    if len(line) <= width:
        return line
    words = line[:width].rpartition(" ")[0].rstrip()
    return (
        f"{words} …"
        if 2 * len(words) > width and len(words) + 2 <= width
        else f"{line[: width - 1]}…"
    )
