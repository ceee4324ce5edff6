"""Who looks for a board in a picture, and in a copy of how many pixels."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.targets.grey import Grey8
from cvnotes.targets.growing import grown_board
from cvnotes.targets.lattice import NotABoard
from cvnotes.targets.opencv_finders import find_classic, find_sb, has_opencv
from cvnotes.targets.saddle_points import find_saddles

# Looks in a grey picture for a board of so many inner corners (columns, rows).
Finder = Callable[[Grey8, tuple[int, int]], Array | None]


def _find_grown(grey: Grey8, corners: tuple[int, int]) -> Array | None:
    """Grow whatever board there is; (rows, columns, 2), the longer side as in the board asked."""
    lattice = grown_board(grey)
    if lattice is not None and corners[0] < corners[1]:
        return lattice.transpose(1, 0, 2)
    return lattice


# Who looks for the board, and in a copy of at most how many pixels: the quickest first. The
# classic finder can take minutes on large pictures without a board; the last attempt is for small
# boards in large ones.
PART_PIXELS = 1_300_000
ATTEMPTS = (
    ("classic finder", find_classic, 500_000),
    ("classic finder", find_classic, 1_300_000),
    ("SB finder", find_sb, 1_300_000),
    ("growing a part", _find_grown, PART_PIXELS),
    ("SB finder", find_sb, 12_000_000),
)
ATTEMPTS_WITHOUT_OPENCV = (
    ("saddle points", find_saddles, 500_000),
    ("saddle points", find_saddles, 1_300_000),
    ("growing a part", _find_grown, PART_PIXELS),
    ("saddle points", find_saddles, 12_000_000),
)


def attempts(grey: Grey8) -> Iterator[tuple[str, Finder, Grey8]]:
    """Give the finders, what each is called, and the copy that it should look at, no pair twice."""
    seen = set()
    for name, finder, most in ATTEMPTS if has_opencv() else ATTEMPTS_WITHOUT_OPENCV:
        copy = reduced(grey, most)
        height, width = copy.shape
        called = f"{name} at {width}×{height}"
        if called not in seen:
            seen.add(called)
            yield called, finder, copy


def sighted(finder: Finder, copy: Grey8, corners: tuple[int, int], grey: Grey8) -> Array:
    """Let a finder look at the copy of a picture; returns corners (rows, columns, 2) in its pixels.

    Raises
    ------
    NotABoard
        It found none, or, counting for itself, one of another count.
    """
    columns, rows = corners
    found = finder(copy, corners)
    if found is None:
        raise NotABoard("not found")
    m = (found + 0.5) * (np.array(grey.shape[::-1]) / copy.shape[::-1]) - 0.5
    if m.ndim == 3 and m.shape[:2] != (rows, columns):
        count = max(m.shape[:2]), min(m.shape[:2])
        seen = m[np.isfinite(m).all(-1)]
        raise NotABoard(f"found {count[0]}×{count[1]} corners", count=count, found=seen)
    return m.reshape(rows, columns, 2)


def reduced(grey: Grey8, pixels: int) -> Grey8:
    """Return the picture, or a copy of it of at most so many pixels."""
    height, width = grey.shape
    zoom = np.sqrt(pixels / grey.size)
    if zoom >= 1:
        return grey
    return shrink(grey, (max(int(width * zoom), 1), max(int(height * zoom), 1)))


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
