"""A sheet as what a printer reads: PDF or SVG."""

import os
from dataclasses import dataclass

from cvnotes.errors import CvnotesError
from cvnotes.page import Page

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
    >>> from cvnotes.sheet import lay_out
    >>> lay_out((9, 6), 25.0).page.size
    (297.0, 210.0)
    """

    page: Page

    def pdf(self) -> bytes:
        """Give the sheet as a PDF file, the same bytes every time."""
        return self.page.pdf()

    def svg(self) -> str:
        """Give the sheet as SVG, a user unit being a millimetre."""
        return self.page.svg()

    def save(self, path: PathLike) -> None:
        """Write the sheet; the name says how: ``.pdf`` or ``.svg``."""
        from pathlib import Path

        Path(path).write_bytes(self.encoded(path))

    def encoded(self, path: PathLike) -> bytes:
        """Give the bytes that belong into a file of that name.

        Raises
        ------
        CvnotesError
            The name ends neither in ``.pdf`` nor in ``.svg``.

        Examples
        --------
        >>> from cvnotes.sheet import lay_out
        >>> lay_out((9, 6), 25.0).encoded("board.pdf")[:4]
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
