"""The kinds of errors, and the one warning."""

from typing import Any


class CvnotesError(ValueError):
    """Base of all errors about values."""


class ShapeError(CvnotesError):
    """An array has the wrong shape, or two arrays do not belong together."""


class DegenerateError(CvnotesError):
    """The data do not determine what was asked for."""


class CornersNotFound(CvnotesError):
    """The board was not found in the picture; `found` (n, 2) is what was taken for it, if any."""

    found: Any = None


class ConvergenceError(CvnotesError):
    """An iteration did not reach its answer."""


class FileError(CvnotesError):
    """A file cannot be read as what it should be."""


class InputTypeError(TypeError):
    """Something that is not made of real numbers was given."""


class CalibrationWarning(UserWarning):
    """A result is usable but doubtful; the same sentence is in ``result.warnings``."""
