"""The kinds of errors, and the one warning."""

from typing import Any


class CvnotesError(ValueError):
    """Base of all errors about values."""


class ShapeError(CvnotesError):
    """An array has the wrong shape, or two arrays do not belong together."""


class DegenerateError(CvnotesError):
    """The data do not determine what was asked for."""


class CornersNotFound(CvnotesError):
    """The board was not found in the picture.

    Attributes
    ----------
    brief : str
        What is wrong, without what was tried.
    question : str
        What probably went wrong, to ask whoever took the picture.
    found : ndarray, shape (n, 2), or None
        What was taken for the board.
    count : (columns, rows) or None
        Inner corners of the largest other board that is there, the larger number first unless it
        has markers.
    markers : str
        The dictionary of other markers that are there, or "".
    """

    def __init__(
        self,
        message: str,
        *,
        brief: str = "",
        question: str = "",
        found: Any = None,
        count: tuple[int, int] | None = None,
        markers: str = "",
    ) -> None:
        super().__init__(message)
        self.brief, self.question = brief or message, question
        self.found, self.count, self.markers = found, count, markers


class ConvergenceError(CvnotesError):
    """An iteration did not reach its answer."""


class FileError(CvnotesError):
    """A file cannot be read as what it should be."""


class InputTypeError(TypeError):
    """Something that is not made of real numbers was given."""


class CalibrationWarning(UserWarning):
    """A result is usable but doubtful; the same sentence is in ``result.warnings``."""
