"""Text for terminals: columns that stand below each other, and lines that are not too long."""

from collections.abc import Collection, Sequence


def text_table(lines: Sequence[Sequence[str]], *, left: Collection[int] = (0, -1)) -> str:
    """Lay out rows of text in columns, numbers to the right.

    Parameters
    ----------
    lines : sequence of rows
        The header first, if there is one; as many cells in each.
    left : collection of int
        Columns whose text stands to the left, by default the first and the last.

    Examples
    --------
    >>> print(text_table([["view", "px", "note"], ["left01", "0.2", ""], ["b", "11.5", "far off"]]))
    view      px  note
    left01   0.2
    b       11.5  far off
    """
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    starts = {i % len(widths) for i in left}
    return "\n".join(
        "  ".join(
            cell.ljust(width) if i in starts else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    )


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
