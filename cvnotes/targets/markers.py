"""The markers of ChArUco boards, drawn and read by OpenCV, which is not there in a browser."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.targets.grey import Grey8


def has_opencv() -> bool:
    """Return whether OpenCV can be used here; a browser has only a place where it would be."""
    try:
        from cv2 import findChessboardCorners  # noqa: F401
    except ImportError:
        return False
    return True


# Markers of so many bits a side, and how many there are.
DICTIONARIES = tuple(f"{n}x{n}_{many}" for n in (4, 5, 6, 7) for many in (50, 100, 250, 1000))
_SURE = 4  # markers of a dictionary: one alone may be read into anything


def marker_cells(dictionary: str, count: int) -> npt.NDArray[np.bool_]:
    """Return which cells (count, n, n) of the first markers are dark, their dark border included.

    Examples
    --------
    >>> marker_cells("4x4_50", 1)[0].astype(int)
    array([[1, 1, 1, 1, 1, 1],
           [1, 0, 1, 0, 0, 1],
           [1, 1, 0, 1, 0, 1],
           [1, 1, 1, 0, 0, 1],
           [1, 1, 1, 0, 1, 1],
           [1, 1, 1, 1, 1, 1]])
    """
    markers, n = _dictionary(dictionary), int(dictionary[0]) + 2
    return np.array([markers.generateImageMarker(i, n) == 0 for i in range(count)])


class Numbered(NamedTuple):
    """What can be read of a ChArUco board in a picture.

    Its corners m (n, 2) and their numbers (n,); the numbers of all markers that were read; and the
    dictionary of the markers that are there, if not one is of that asked for, else "".
    """

    m: Array
    numbers: npt.NDArray[np.intp]
    markers: npt.NDArray[np.intp]
    other: str


def find_numbered(
    grey: Grey8, squares: tuple[int, int], marker: float, dictionary: str
) -> Numbered:
    """Look for the corners of a ChArUco board, whose markers have the side `marker` in squares.

    Where not one of its markers can be read, those of the other dictionaries are looked for.

    Examples
    --------
    >>> find_numbered(np.zeros((40, 40), np.uint8), (5, 4), 0.75, "4x4_50").m.shape
    (0, 2)
    """
    m, numbers, markers = _detected(grey, squares, marker, dictionary)
    other = ""
    if not len(markers):
        # Of the dictionaries with as many bits, the smaller ones are parts of the largest.
        largest = [name for name in DICTIONARIES if name.endswith("_1000")]
        read = {name: len(_detected(grey, squares, marker, name)[2]) for name in largest}
        best = max(read, key=lambda name: read[name])
        other = best.split("_")[0] if read[best] >= _SURE else ""
    return Numbered(m, numbers, markers, other)


def _detected(
    grey: Grey8, squares: tuple[int, int], marker: float, dictionary: str
) -> tuple[Array, npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    import cv2

    board = cv2.aruco.CharucoBoard(squares, 1.0, marker, _dictionary(dictionary))
    m, ids, _, markers = cv2.aruco.CharucoDetector(board).detectBoard(np.ascontiguousarray(grey))
    corners, numbers, read = ([] if x is None else x for x in (m, ids, markers))
    return (
        np.asarray(corners, dtype=np.float64).reshape(-1, 2),
        np.ravel(numbers).astype(np.intp),
        np.ravel(read).astype(np.intp),
    )


def _dictionary(name: str) -> Any:
    if not has_opencv():
        raise ImportError("markers are drawn and read by OpenCV, which is not installed here")
    import cv2

    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{name.upper()}"))


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Let OpenCV work in the thread that asks it alone, for those who ask it from several.

    Its own threads wait busily for a while after each piece of work.
    """
    if not has_opencv():
        yield
        return
    import cv2

    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)
