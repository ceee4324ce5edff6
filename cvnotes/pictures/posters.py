"""Posters on the walls of a room: letters that grow smaller, a switch beside them; and a sun."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import pose
from cvnotes.pictures.meshes import Scene, box, join, quads
from cvnotes.pictures.scenes import INDOORS, PALE, room

# Five rows of five, from the top; a letter's cell is dark where there is an x.
_LETTERS = {
    "A": " xxx |x   x|xxxxx|x   x|x   x",
    "B": "xxxx |x   x|xxxx |x   x|xxxx ",
    "D": "xxxx |x   x|x   x|x   x|xxxx ",
    "E": "xxxxx|x    |xxxx |x    |xxxxx",
    "F": "xxxxx|x    |xxxx |x    |x    ",
    "G": " xxxx|x    |x  xx|x   x| xxxx",
    "H": "x   x|x   x|xxxxx|x   x|x   x",
    "I": " xxx |  x  |  x  |  x  | xxx ",
    "L": "x    |x    |x    |x    |xxxxx",
    "M": "x   x|xx xx|x x x|x   x|x   x",
    "N": "x   x|xx  x|x x x|x  xx|x   x",
    "O": " xxx |x   x|x   x|x   x| xxx ",
    "P": "xxxx |x   x|xxxx |x    |x    ",
    "Q": " xxx |x   x|x x x|x  x | xx x",
    "R": "xxxx |x   x|xxxx |x  x |x   x",
    "S": " xxxx|x    | xxx |    x|xxxx ",
    "T": "xxxxx|  x  |  x  |  x  |  x  ",
    "U": "x   x|x   x|x   x|x   x| xxx ",
    "V": "x   x|x   x|x   x| x x |  x  ",
    "Y": "x   x| x x |  x  |  x  |  x  ",
}
# The rows: their words, the upper edge of their letters, and the letters' height, mm.
ROWS = (
    ("H", 45.0, 120.0),
    ("DLT", 205.0, 85.0),
    ("PLANE", 325.0, 55.0),
    ("FOURPAIRS", 410.0, 34.0),
    ("HOMOGRAPHY", 472.0, 22.0),
    ("LEVENBERGMARQUARDT", 518.0, 14.0),
    ("THESMALLESTSINGULARVALUE", 552.0, 9.0),
)
SIZE = (420.0, 594.0)  # A2
SWITCH = (-330.0, 470.0)  # its middle, in the chart's frame, mm
_LINE = 1200 / 90  # mm: how high a line of the print's sky is, and a gap
_INK, _PAPER = (0.07, 0.09, 0.16), (1.0, 0.99, 0.95)


def letter(name: str) -> npt.NDArray[np.bool_]:
    """Return the cells (5, 5) of a letter, True where it is dark.

    Examples
    --------
    >>> letter("L").astype(int)[-2:]
    array([[1, 0, 0, 0, 0],
           [1, 1, 1, 1, 1]])
    """
    return np.array([[cell == "x" for cell in row] for row in _LETTERS[name].split("|")])


def chart_room() -> Scene:
    """Build the room with a chart of letters, a sheet of A2, on one of its walls.

    The frame is the chart's: the origin in its upper left corner, x to the right, y down, z into
    the wall. The chart's corners are (0, 0), (420, 0), (420, 594) and (0, 594) mm; a light switch
    has its middle at `SWITCH`, on the same wall.

    Examples
    --------
    >>> chart_room().vertices[:4]
    array([[  0.,   0.,   0.],
           [420.,   0.,   0.],
           [420., 594.,   0.],
           [  0., 594.,   0.]])
    """
    wall_from_room = pose([[0, 0, -1], [0, 1, 0], [1, 0, 0]], [5200, 250, -2999.0])
    u, v = SWITCH
    plate = box((u - 40, u + 40), (v - 40, v + 40), (-1, 0), (0.97, 0.97, 0.95))
    rocker = box((u - 22, u + 22), (v - 28, v + 28), (-4, -1), (0.80, 0.42, 0.30))
    # The wall at the right of the room stands in the light here: pale paint, not brightened.
    scene = join(chart(), plate, rocker, room(PALE).moved(wall_from_room))
    return replace(scene, around=INDOORS)


def chart() -> Scene:
    """Build the chart alone, in its own frame."""
    width, height = SIZE
    corners = np.array([[0.0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]])
    # The letters are strips, one for each run of dark cells.
    strips = np.concatenate([_word(*row) for row in ROWS])
    places = np.concatenate([strips, np.full((*strips.shape[:2], 1), -0.2)], axis=-1)
    loops = np.arange(4 * len(strips)).reshape(-1, 4)
    return join(quads(corners, [[0, 1, 2, 3]], _PAPER), quads(places.reshape(-1, 3), loops, _INK))


def poster_room() -> Scene:
    """Build the room with a print on the white sheet of its left wall: a red sun over the sea.

    The sheet is 2600 mm wide and 1200 mm high, the sun is a disc of 600 mm, and its sky has 34
    lines: 45 would fill the sheet's height. The first 4 vertices are the corners of the sheet, as
    seen from the room from the upper left one to the right.

    Examples
    --------
    >>> poster_room().vertices[:3]
    array([[-2979.,  -900.,  6300.],
           [-2979.,  -900.,  8900.],
           [-2979.,   300.,  8900.]])
    """
    turn = np.linspace(0, 2 * np.pi, 121)
    rim = 300 * np.column_stack([0 * turn, np.sin(turn), np.cos(turn)]) + [-2977.5, -420, 7600]
    first = np.arange(1, 120, 2)
    fan = np.stack([0 * first, first, first + 1, first + 2], axis=1)
    sun = quads(np.vstack([[[-2977.5, -420, 7600]], rim]), fan, (0.83, 0.24, 0.16))
    tops = -900 + _LINE * (np.arange(1, 69, 2)[:, None] + np.array([0.0, 0, 1, 1]))
    loops = np.stack([np.full((34, 4), -2978.0), tops, 0 * tops + [6300, 8900, 8900, 6300]], axis=2)
    sky = quads(loops.reshape(-1, 3), np.arange(136).reshape(-1, 4), (0.50, 0.63, 0.72))
    parts = [sky, sun, room()]
    for x, top, colour in ((-2978.0, 20.0, (0.16, 0.36, 0.55)), (-2979.0, -900.0, _PAPER)):
        corners = [[x, top, 6300], [x, top, 8900], [x, 300, 8900], [x, 300, 6300]]
        parts.insert(0, quads(corners, [[0, 1, 2, 3]], colour))
    return replace(join(*parts), around=INDOORS)


def _word(word: str, top: float, height: float) -> Array:
    """Return the strips (n, 4, 2) of a word in the middle of the chart."""
    cell = height / 5
    left = (SIZE[0] - (6 * len(word) - 1) * cell) / 2
    strips = []
    for k, name in enumerate(word):
        for j, cells in enumerate(letter(name)):
            edges = np.flatnonzero(np.diff(np.r_[False, cells, False].astype(int)))
            for begin, end in edges.reshape(-1, 2):
                x0, x1 = (left + (6 * k + i) * cell for i in (begin, end))
                y0, y1 = top + j * cell, top + (j + 1) * cell
                strips.append([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    return np.array(strips)
