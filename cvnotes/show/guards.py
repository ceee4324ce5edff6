"""The guards of figures: of lengths, counts and pictures, and of the things that are drawn."""

from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CvnotesError,
    InputTypeError,
    ShapeError,
    number,
    points,
    real,
    rigid_motion,
)

Kind = TypeVar("Kind")

# Beyond these no axis tells its numbers apart any more.
_SHORTEST, _LONGEST, _MOST = 1e-12, 1e12, 1000


def length(x: Any, name: str) -> float:
    """Guard a positive number, neither so small nor so large that axes could not show it.

    Examples
    --------
    >>> length(5, "extent")
    5.0
    """
    value = number(x, name)
    if not _SHORTEST <= value <= _LONGEST:
        raise CvnotesError(
            f"{name} = {value:g} but must be positive, from {_SHORTEST:g} to {_LONGEST:g}"
        )
    return value


def thing(x: Any, name: str, kind: type[Kind]) -> Kind:
    """Guard what is no array: a camera, a lens, a board.

    Examples
    --------
    >>> thing("corners.json", "corners", np.ndarray)
    Traceback (most recent call last):
    cvnotes.base.errors.InputTypeError: corners: expected a ndarray, got str
    """
    if not isinstance(x, kind):
        raise InputTypeError(f"{name}: expected a {kind.__name__}, got {type(x).__name__}")
    return x


def one_motion(x: Any, name: str) -> Array:
    """Guard a single rigid motion (4, 4).

    Examples
    --------
    >>> one_motion(np.eye(4), "world_from_frame").shape
    (4, 4)
    """
    G = rigid_motion(x, name)
    if G.ndim != 2:
        raise ShapeError(f"{name}: expected one rigid motion (4, 4), got {G.shape}")
    return G


def one_point(x: Any, name: str, *dims: int) -> Array:
    """Guard a single point.

    Examples
    --------
    >>> one_point([1, 2, 3], "centre", 3)
    array([1., 2., 3.])
    """
    point = points(x, name, *dims)
    if point.ndim != 1:
        raise ShapeError(f"{name}: expected one row of {point.shape[-1]}, got {point.shape}")
    return point


def picture(x: Any, name: str = "image") -> npt.NDArray[Any]:
    """Guard a picture, grey or RGB, of any kind of numbers; it is not copied.

    Examples
    --------
    >>> picture(np.zeros((48, 64), bool)).shape
    (48, 64)
    """
    true_or_false = type(x) is np.ndarray and x.dtype == bool
    given: npt.NDArray[Any] = x if true_or_false else real(x, name)
    if given.ndim not in (2, 3) or given.size == 0 or given.shape[2:] not in ((), (3,)):
        raise ShapeError(
            f"{name}: expected (height, width) or (height, width, 3), got {given.shape}"
        )
    return given


def in_bytes(x: Any, name: str = "image") -> npt.NDArray[np.uint8]:
    """Guard a picture of any kind of numbers and return it as a screen shows it, from 0 to 255.

    Whole numbers stay, deep ones are scaled to their largest, since they seldom use their whole
    range; floats are from 0 to 1, and NaN is white.

    Examples
    --------
    >>> in_bytes([[0, 0.5, 1, np.nan]])
    array([[  0, 128, 255, 255]], dtype=uint8)
    """
    given = picture(x, name)
    if given.dtype == np.uint16:
        given = given / max(int(given.max()), 1)
    if given.dtype.kind not in "ui":
        given = 255 * np.nan_to_num(given, nan=1).clip(0, 1)
    return np.rint(given).clip(0, 255).astype(np.uint8)


def eight_bits(x: Any, name: str = "image") -> npt.NDArray[np.uint8]:
    """Guard a picture of whole numbers from 0 to 255.

    Examples
    --------
    >>> eight_bits([[0, 255]]).dtype
    dtype('uint8')
    """
    given = picture(x, name)
    if given.dtype.kind not in "iu" or given.min() < 0 or given.max() > 255:
        raise CvnotesError(
            f"{name}: expected uint8, whole numbers from 0 to 255, got {given.dtype} from "
            f"{given.min():g} to {given.max():g}"
        )
    return given.astype(np.uint8, copy=False)


def pictures(x: Any, name: str) -> list[npt.NDArray[Any]]:
    """Guard several pictures of one size and one kind.

    Examples
    --------
    >>> len(pictures([np.zeros((48, 64))] * 3, "images"))
    3
    """
    several = x if isinstance(x, list | tuple) else np.atleast_1d(real(x, name))
    given = [picture(image, name) for image in several]
    if len({(image.shape, image.dtype) for image in given}) != 1:
        raise ShapeError(f"{name}: expected pictures of one size and one kind, at least one")
    return given
