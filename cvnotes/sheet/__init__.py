"""A chessboard on paper: the sheet to print, in true millimetres (notes 2b.4).

The sheet carries what a class needs besides the squares: how many there are, in words, where the
board's frame lies, and a ruler, because printers like to scale.
"""

from cvnotes.sheet.layout import PAPERS, lay_out
from cvnotes.sheet.printable import PathLike, Sheet

__all__ = ["PAPERS", "PathLike", "Sheet", "lay_out"]
