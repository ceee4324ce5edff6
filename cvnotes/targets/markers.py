"""The markers of ChArUco boards, drawn and read by OpenCV, which is not there in a browser."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
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


# How many markers there are, and of how many bits a side.
DICTIONARIES = {
    **{f"{n}x{n}_{many}": (many, n) for n in (4, 5, 6, 7) for many in (50, 100, 250, 1000)},
    "apriltag_16h5": (30, 4),
    "apriltag_25h9": (35, 5),
    "apriltag_36h10": (2320, 6),
    "apriltag_36h11": (587, 6),
}
# In these others are looked for: of dictionaries with as many bits, the smaller ones are parts of
# the larger.
_PROBABLE = ("4x4_250", "5x5_250", "6x6_250", "7x7_250", "apriltag_16h5", "apriltag_25h9",
             "apriltag_36h11")  # fmt: skip
_CELL = 4  # px to which a cell of a marker is straightened, as in OpenCV; and of its cells
_BORDER, _WRONG = 0.35, 0.6  # so many may be wrong: of n² in its border, of what can be corrected
_SURE = 4  # markers of a dictionary, more than of another: a few may be read into anything
_MOST_COLUMNS = 60  # of a board whose columns are counted
_OFF = 0.7  # squares by which a marker may be off, measured by the sides of its neighbour
_AGREE = 0.75  # part of all markers that must stand to each other as on a board


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
    markers, n = _dictionary(dictionary), DICTIONARIES[dictionary][1] + 2
    return np.array([markers.generateImageMarker(i, n) == 0 for i in range(count)])


Numbers = npt.NDArray[np.integer[Any]]


class Numbered(NamedTuple):
    """What can be read of a ChArUco board in a picture.

    Its corners m (n, 2) and their numbers (n,); the numbers of all markers that were read; the
    dictionary of the markers that are there, if not one is of that asked for, else ""; whether the
    pattern is the legacy one, None if the markers do not tell; and the squares (columns, rows) of a
    board on which the markers stand, if they do not stand as on the one asked for.
    """

    m: Array
    numbers: Numbers
    markers: Numbers
    other: str = ""
    legacy: bool | None = None
    squares: tuple[int, int] | None = None


def find_numbered(
    grey: Grey8,
    squares: tuple[int, int],
    marker: float,
    dictionary: str,
    legacy: bool | None = None,
) -> Numbered:
    """Look for the corners of a ChArUco board, whose markers have the side `marker` in squares.

    A board with an even number of rows may also be in OpenCV's legacy pattern, which begins with a
    light square: where the markers stand tells, if it is not said. Where not one can be read, those
    of other dictionaries are looked for.

    Examples
    --------
    >>> find_numbered(np.zeros((40, 40), np.uint8), (5, 4), 0.75, "4x4_50").m.shape
    (0, 2)
    """
    grey = np.ascontiguousarray(grey)
    every = _outlines(grey)
    outlines, markers = _read(grey, every, dictionary)
    none = np.zeros((0, 2)), np.zeros(0, dtype=np.intp), markers
    if len(markers) < _SURE and (other := _other(grey, every, dictionary, len(markers))):
        return Numbered(*none[:2], markers[:0], other=other)
    if not len(markers):
        return Numbered(*none)
    (columns, rows), stand = squares, _Standing.of(outlines, markers, marker)
    shown: bool | None = False
    if rows % 2 == 0:
        as_is, light = (stand.agreeing(columns, light=x).sum() for x in (False, True))
        shown = bool(light > as_is) if abs(light - as_is) > 1 else None
    patterns = [x for x in (legacy, shown) if x is not None][:1] or [False, True]
    agreed = max(stand.agreeing(columns, light=x).mean() for x in patterns)
    if agreed < _AGREE and (other := _other(grey, every, dictionary, len(markers))):
        return Numbered(*none[:2], markers[:0], other=other)
    beyond = max(stand.beyond(columns, rows, light=x) for x in patterns)
    if (agreed < _AGREE or beyond >= _SURE) and (counted := stand.counted()) is not None:
        return Numbered(*none, squares=counted)
    # (where nothing tells, OpenCV's own doubts may)
    of_board, found = (grey, squares, marker, dictionary), []
    for x in patterns:
        each = _corners(*of_board, x, outlines, markers)
        if not len(each[0]):  # OpenCV gives up for one that was misread
            stands = stand.agreeing(columns, light=x)
            each = _corners(*of_board, x, outlines[stands], markers[stands])
        found.append(each)
    m, numbers = max(found, key=lambda each: len(each[0]))
    return Numbered(m, numbers, markers, legacy=shown)


def _corners(
    grey: Grey8,
    squares: tuple[int, int],
    marker: float,
    dictionary: str,
    legacy: bool,
    outlines: Array,
    markers: Numbers,
) -> tuple[Array, Numbers]:
    """Return the corners m (n, 2) between markers that were read, and their numbers (n,)."""
    import cv2

    board = cv2.aruco.CharucoBoard(squares, 1.0, marker, _dictionary(dictionary))
    board.setLegacyPattern(legacy)
    m, ids, *_ = cv2.aruco.CharucoDetector(board).detectBoard(
        grey, markerCorners=list(outlines[:, None].astype(np.float32)), markerIds=markers[:, None]
    )
    corners, numbers = ([] if x is None else x for x in (m, ids))
    return np.reshape(np.asarray(corners, dtype=np.float64), (-1, 2)), np.ravel(numbers).astype(
        np.intp
    )


def markers_in(grey: Grey8) -> str:
    """Return which markers are in a picture, if several of a dictionary are, else "".

    Examples
    --------
    >>> markers_in(np.zeros((40, 40), np.uint8))
    ''
    """
    if not has_opencv():
        return ""
    grey = np.ascontiguousarray(grey)
    return _other(grey, _outlines(grey), "", 0)


def _outlines(grey: Grey8) -> Array:
    """Return the outlines (n, 4, 2) of all that may be a marker."""
    import cv2

    # OpenCV compares each of them with one marker of the dictionary after the other, in which most
    # of its time goes: so it is given only one, and `_read` compares. It is to keep outlines that
    # are close to others, as that of the square around a marker is.
    whole, settings = _dictionary("4x4_50"), cv2.aruco.DetectorParameters()
    single = cv2.aruco.Dictionary(whole.bytesList[:1], whole.markerSize, 0)
    settings.minMarkerDistanceRate = 0.0
    read, _, others = cv2.aruco.ArucoDetector(single, settings).detectMarkers(grey)
    return np.reshape([*read, *others], (-1, 4, 2)).astype(float)


def _read(grey: Grey8, outlines: Array, dictionary: str) -> tuple[Array, Numbers]:
    """Read the markers of a dictionary: their outlines (n, 4, 2), from their own first corner on.

    Of outlines in which the same can be read, the longest counts: that of the marker's border.

    References
    ----------
    .. [1] S. Garrido-Jurado et al., Automatic generation and detection of highly reliable fiducial
       markers under occlusion, Pattern Recognition 47 (2014) 2280-2292, section 4.
    """
    markers, may_be_wrong = _signs(dictionary)
    n = markers.shape[-1]
    light = _light_cells(grey, outlines, n + 2)
    inner = light[:, 1:-1, 1:-1]
    framed = light.sum((1, 2)) - inner.sum((1, 2)) <= int(_BORDER * n * n)
    outlines, signs = outlines[framed], 2 * inner[framed].astype(np.float32) - 1
    turned = np.stack([np.rot90(signs, k, (1, 2)).reshape(-1, n * n) for k in range(4)], axis=1)
    wrong = (n * n - turned @ markers.reshape(-1, n * n).T) / 2  # (n_outlines, 4, n_markers)
    turns, numbers = np.divmod(wrong.reshape(-1, 4 * len(markers)).argmin(1), len(markers))
    length = np.linalg.norm(outlines - np.roll(outlines, 1, axis=1), axis=-1).sum(1)
    there = np.flatnonzero(wrong.min((1, 2), initial=n * n) <= may_be_wrong)
    there = there[np.argsort(-length[there], kind="stable")]
    read, each = np.unique(numbers[there], return_index=True)
    first = turns[there[each], None] + np.arange(4)
    outlines = np.take_along_axis(outlines[there[each]], first[..., None] % 4, axis=1)
    return outlines, read.astype(np.int32)


def _light_cells(grey: Grey8, outlines: Array, n: int) -> npt.NDArray[np.bool_]:
    """Return which of n by n cells within each outline are light, by a threshold of its own."""
    import cv2

    side, flags = n * _CELL, cv2.THRESH_BINARY | cv2.THRESH_OTSU
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32) * (side - 1)
    light = np.empty((len(outlines), side, side), np.uint8)
    for outline, straight in zip(outlines.astype(np.float32), light, strict=True):
        H = cv2.getPerspectiveTransform(outline, square)
        cv2.warpPerspective(grey, H, (side, side), straight, cv2.INTER_NEAREST)
        cv2.threshold(straight, 0, 1, flags, straight)
    return np.asarray(light.reshape(-1, n, _CELL, n, _CELL).mean((2, 4)) > 0.5)


@cache
def _signs(dictionary: str) -> tuple[npt.NDArray[np.float32], int]:
    """Return a dictionary's markers, 1 where light, else −1, and how many bits may be wrong."""
    cells = marker_cells(dictionary, DICTIONARIES[dictionary][0])[:, 1:-1, 1:-1]
    wrong = int(_WRONG * _dictionary(dictionary).maxCorrectionBits)
    return np.where(cells, -1, 1).astype(np.float32), wrong


def _other(grey: Grey8, outlines: Array, dictionary: str, own: int) -> str:
    """Return which probable dictionary most markers are of, more than `own`, or ""."""
    n = {name: len(_read(grey, outlines, name)[1]) for name in _PROBABLE if name != dictionary}
    most = max(n, key=n.__getitem__)
    if n[most] < own + _SURE:
        return ""
    return most if _family(most) == _family(dictionary) else _family(most)


def _family(dictionary: str) -> str:
    """Return what dictionaries that are parts of each other have in common.

    Examples
    --------
    >>> _family("4x4_250"), _family("apriltag_36h11")
    ('4x4', 'apriltag_36h11')
    """
    return dictionary if dictionary.startswith("apriltag") else dictionary.split("_")[0]


class _Standing(NamedTuple):
    """How markers stand to their nearest neighbours: (n,) numbers, and steps (n, 2) in squares."""

    numbers: Numbers
    neighbours: Numbers
    steps: Array

    @staticmethod
    def of(outlines: Array, numbers: Numbers, side: float) -> "_Standing":
        """Measure where the nearest marker is, by the sides of each marker itself."""
        middle = outlines.mean(1)
        apart = np.linalg.norm(middle[:, None] - middle, axis=-1)
        np.fill_diagonal(apart, np.inf)
        nearest = apart.argmin(1)
        tl, tr, br, bl = outlines.swapaxes(0, 1)
        x, y = (tr + br - tl - bl) / (2 * side), (bl + br - tl - tr) / (2 * side)
        frame, offset = np.stack([x, y], axis=-1), middle[nearest] - middle
        frame[np.linalg.det(frame) == 0] = np.nan
        steps = np.linalg.solve(frame, offset[..., None])[..., 0]
        return _Standing(numbers, numbers[nearest], steps)

    def agreeing(self, columns: int, *, light: bool = False) -> npt.NDArray[np.bool_]:
        """Return which markers' nearest stands as on a board of so many columns of squares."""
        if len(self.numbers) < 2:
            return np.ones(1, dtype=bool)
        a, b = (_square(n, columns, light) for n in (self.numbers, self.neighbours))
        return np.asarray((np.abs(b - a - self.steps) < _OFF).all(-1))

    def beyond(self, columns: int, rows: int, *, light: bool = False) -> int:
        """Count the markers that stand below a board of so many squares, as on a larger one."""
        below = _square(self.numbers, columns, light)[:, 1] >= rows
        return int((self.agreeing(columns, light=light) & below).sum())

    def counted(self) -> tuple[int, int] | None:
        """Return the squares (columns, rows, as many as are seen) that a board must have."""
        if len(self.numbers) < _SURE:
            return None
        every = [(n, light) for n in range(2, _MOST_COLUMNS) for light in (False, True)]
        columns, light = max(every, key=lambda each: self.agreeing(each[0], light=each[1]).sum())
        if self.agreeing(columns, light=light).mean() < _AGREE:
            return None
        return columns, int(_square(self.numbers, columns, light)[:, 1].max()) + 1


def _square(numbers: Numbers, columns: int, light: bool) -> Array:
    """Return the squares (n, 2) of markers, counted along x and y.

    Row by row they stand in the light squares: two rows have as many as there are columns.
    """
    first = 0 if light else 1
    in_first = (columns - first + 1) // 2
    pair, k = np.divmod(numbers, columns)
    below = k >= in_first
    i = np.where(below, 1 - first + 2 * (k - in_first), first + 2 * k)
    return np.stack([i, 2 * pair + below], axis=-1).astype(float)


def _dictionary(name: str) -> Any:
    if not has_opencv():
        raise ImportError("markers are drawn and read by OpenCV, which is not installed here")
    import cv2

    family, bits = name.split("_")  # (spelt as OpenCV does: APRILTAG_36h11)
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{family.upper()}_{bits}"))


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
