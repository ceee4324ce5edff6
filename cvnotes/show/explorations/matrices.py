"""Matrices beside an exploration, as HTML: each entry on the colour of the slider that moves it."""

from collections.abc import Mapping

from cvnotes.base import Array

# Behind black letters, each light enough to read them, and different for every eye.
TURN, SHIFT = "#FFF0B3", "#CBEBDB"

Tints = Mapping[tuple[int, int], str]

_BRACKETS = (
    "display:inline-table;width:auto;margin:0 1.2em 0.6em 0;border-collapse:separate;"
    "border-spacing:2px;border:0;border-left:2px solid #6E6E6E;border-right:2px solid #6E6E6E;"
    "border-radius:5px;font-size:0.85rem;font-variant-numeric:tabular-nums"
)
_ENTRY = "padding:1px 6px;text-align:right;border:0;white-space:nowrap"
_TINTED = "background:{};color:#000"


def matrix_table(M: Array, title: str, digits: Array, tints: Tints) -> str:
    """Write a matrix (m, n) as a table.

    Parameters
    ----------
    M : ndarray, shape (m, n)
        The numbers.
    title : str
        What stands above it.
    digits : ndarray of int, shape (m, n)
        How many decimals each entry has.
    tints : mapping
        Colours behind entries, by row and column.

    Examples
    --------
    >>> import numpy as np
    >>> "−1.5</td>" in matrix_table(np.array([[-1.5]]), "s", np.array([[1]]), {})
    True
    """
    rows = "".join(
        "<tr>"
        + "".join(
            _cell(f"{value + 0.0:.{digits[i, j]}f}", tints.get((i, j), ""))
            for j, value in enumerate(row)
        )
        + "</tr>"
        for i, row in enumerate(M.tolist())
    )
    above = "caption-side:top;text-align:left;padding:0;white-space:nowrap;color:inherit"
    return f'<table style="{_BRACKETS}"><caption style="{above}">{title}</caption>{rows}</table>'


def _cell(number: str, tint: str) -> str:
    sign = number if float(number) else number.lstrip("-")  # no "−0"
    style = f"{_ENTRY};{_TINTED.format(tint)}" if tint else _ENTRY
    return f'<td style="{style}">{sign.replace("-", "−")}</td>'
