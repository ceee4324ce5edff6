"""Text for terminals: columns that stand below each other."""

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
