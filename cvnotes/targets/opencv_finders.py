"""OpenCV's board finders, the same in every version: what differs between versions stays here.

Since version 5 the finders give (n, 2), before it (n, 1, 2). They raise for pictures that are too
small and for boards with fewer than three corners along a side; here, all of these are not found.

In a browser there is no OpenCV. `has_opencv` says so to those who then find boards by their saddle
points (`cvnotes.targets.saddle_points`).
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array

Grey8 = npt.NDArray[np.uint8]


def has_opencv() -> bool:
    """Tell whether OpenCV can be used here; a browser has only a place where it would be."""
    try:
        from cv2 import findChessboardCorners  # noqa: F401
    except ImportError:
        return False
    return True


def find_sb(grey: Grey8, corners: tuple[int, int]) -> Array | None:
    """Look for a board with `cv2.findChessboardCornersSB`; corners (n, 2) in its order, or None.

    Examples
    --------
    >>> find_sb(np.zeros((40, 40), np.uint8), (9, 6)) is None
    True
    """
    import cv2

    # Without NORMALIZE_IMAGE, boards with narrow outer squares are missed.
    return _found(cv2.findChessboardCornersSB, grey, corners, cv2.CALIB_CB_NORMALIZE_IMAGE)


def find_classic(grey: Grey8, corners: tuple[int, int]) -> Array | None:
    """Look for a board with `cv2.findChessboardCorners`; corners (n, 2) in its order, or None.

    Its time grows steeply with the number of things in a picture without a board (minutes at
    12 million pixels): pass a reduced copy.

    Examples
    --------
    >>> find_classic(np.zeros((40, 40), np.uint8), (9, 6)) is None
    True
    """
    import cv2

    flags = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE
    return _found(cv2.findChessboardCorners, grey, corners, flags)


def find_part(grey: Grey8) -> Array | None:
    """Look for the largest part without gaps of a board of any count with OpenCV's SB finder.

    Gives its inner corners (rows, columns, 2), at least 3×3 of them, or None.

    Examples
    --------
    >>> find_part(np.zeros((40, 40), np.uint8)) is None
    True
    """
    import cv2

    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_LARGER
    try:
        found, m, squares = cv2.findChessboardCornersSBWithMeta(
            np.ascontiguousarray(grey), (3, 3), flags
        )
    except cv2.error:
        return None
    if not found or squares is None:
        return None
    return np.asarray(m, dtype=np.float64).reshape(*np.shape(squares)[:2], 2)


# Markers of so many bits a side, and how many there are.
DICTIONARIES = tuple(f"{n}x{n}_{many}" for n in (4, 5, 6, 7) for many in (50, 100, 250, 1000))


def marker_cells(dictionary: str, count: int) -> npt.NDArray[np.bool_]:
    """Give which cells (count, n, n) of the first markers are dark, their dark border included.

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


def find_charuco(
    grey: Grey8, squares: tuple[int, int], marker: float, dictionary: str
) -> tuple[Array, npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Look for the corners of a ChArUco board, whose markers have the side `marker` in squares.

    Gives the corners (n, 2), their numbers (n,), and the numbers of all markers that were read.

    Examples
    --------
    >>> m, ids, markers = find_charuco(np.zeros((40, 40), np.uint8), (5, 4), 0.75, "4x4_50")
    >>> m.shape, len(ids), len(markers)
    ((0, 2), 0, 0)
    """
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


def shrink(grey: Grey8, size: tuple[int, int]) -> Grey8:
    """Reduce a picture to (width, height), each pixel the mean of the area it covers.

    Examples
    --------
    >>> shrink(np.array([[0, 100, 8, 8]], np.uint8), (2, 1))
    array([[50,  8]], dtype=uint8)
    """
    if not has_opencv():
        means = area_means(area_means(grey, size[1]).T, size[0]).T
        return np.rint(means).astype(np.uint8)
    import cv2

    return np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def area_means(rows: npt.NDArray[Any], count: int) -> Array:
    """Reduce the first axis to so many rows, each the mean of those, and parts of those, it covers.

    Examples
    --------
    >>> area_means(np.array([[0.0], [6.0], [12.0]]), 2)
    array([[ 2.],
           [10.]])
    """
    n = len(rows)
    sums = np.concatenate([np.zeros((1, *rows.shape[1:])), np.cumsum(rows, axis=0, dtype=float)])
    ends = np.linspace(0, n, count + 1)
    whole = np.minimum(ends.astype(np.intp), n - 1)
    upto = sums[whole] + (ends - whole)[:, None] * rows[whole]
    return np.asarray(np.diff(upto, axis=0) * (count / n))


def _found(
    finder: Callable[..., tuple[bool, Any]], grey: Grey8, corners: tuple[int, int], flags: int
) -> Array | None:
    import cv2

    try:
        found, m = finder(np.ascontiguousarray(grey), corners, flags=flags)
    except cv2.error:
        return None
    m = np.asarray(m, dtype=np.float64).reshape(-1, 2) if found else np.empty((0, 2))
    return m if len(m) == corners[0] * corners[1] else None
