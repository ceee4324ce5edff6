"""A sheet to draw on: no figure library is loaded, and a pixel is one byte of a fixed palette."""

from collections.abc import Iterable, Iterator
from functools import cache, lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, FileError, chunks
from cvnotes.base.png import pack_png

# The meanings of the course's figures, and shades of grey.
ESTIMATED, WORLD, LENS = "#D55E00", "#009E73", "#0072B2"
MUTED, PALE, FAINT, INK = "#6E6E6E", "#C4C4C4", "#EEEEEE", "#000000"
_INKS = (LENS, ESTIMATED, WORLD, INK)
_LAYERS = (FAINT, PALE, MUTED, *_INKS)  # from the lowest to the topmost
_DABS = 4096  # looked at together: their pixels then stay in the cache

Bytes = npt.NDArray[np.uint8]
Places = npt.NDArray[np.intp]
Paint = npt.NDArray[np.float32]


class _Word(NamedTuple):
    """Something to be written when all else is drawn."""

    where: tuple[float, float]
    text: str
    colour: str
    size: int
    anchor: str = "ms"
    halo: bool = False
    upright: bool = False


class Canvas:
    """A white sheet of (width, height) pixels; places are (x, y) from its upper left corner.

    Photographs are put on it at once. What is drawn lies above them, colour by colour, all of a
    colour in one go: the faint lowest, then grey, blue, orange, green and black. Words lie above
    all.

    Examples
    --------
    >>> sheet = Canvas(30, 20)
    >>> sheet.rectangle((5, 5), (25, 15), fill="#D55E00")
    >>> sheet.png()[1:4]
    b'PNG'
    """

    def __init__(self, width: int, height: int) -> None:
        self._grey = np.full((height, width), 255, np.uint8)
        # 0 without ink; else 8 times its number in _INKS, and how thick it is, 1 to 8
        self._ink = np.zeros((height, width), np.uint8)
        self._thick = np.zeros(height * width, np.float32)  # how thick one colour lies
        self._strokes: dict[str, list[Array]] = {}  # by colour: rows of x, y, x, y, radius
        self._fills: dict[str, list[tuple[slice, slice]]] = {}
        self._words: list[_Word] = []

    def line(self, m: npt.ArrayLike, colour: str, width: float = 1) -> None:
        """Join points (n, 2)."""
        m = np.asarray(m, dtype=float)
        self.segments(m[:-1], m[1:], colour, width)

    def segments(self, start: Array, end: Array, colour: str, width: float = 1) -> None:
        """Draw a line from each point (n, 2) to the other."""
        radius = np.full((len(start), 1), width / 2)
        self._strokes.setdefault(colour, []).append(np.concatenate([start, end, radius], axis=1))

    def dots(self, m: npt.ArrayLike, colour: str, radius: float = 2) -> None:
        """Put a dot on each point (n, 2)."""
        m = np.asarray(m, dtype=float).reshape(-1, 2)
        self.segments(m, m, colour, 2 * radius)

    def ring(self, centre: npt.ArrayLike, radius: float, colour: str, width: float = 1.5) -> None:
        """Draw a circle."""
        angle = np.linspace(0, 2 * np.pi, max(16, int(2 * radius)))
        round_it = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        self.line(np.asarray(centre, dtype=float) + round_it, colour, width)

    def rectangle(
        self,
        low: npt.ArrayLike,
        high: npt.ArrayLike,
        *,
        fill: str | None = None,
        line: str | None = None,
    ) -> None:
        """Draw a rectangle between its upper left and its lower right."""
        (x0, y0), (x1, y1) = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
        if fill:
            left, top, right, bottom = (max(round(x), 0) for x in (x0, y0, x1, y1))
            area = np.s_[top:bottom, left:right]
            self._fills.setdefault(fill, []).append(area)
        if line:
            self.line([(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)], line)

    def text(
        self, where: tuple[float, float], text: str, colour: str = INK, *, size: int = 13,
        anchor: str = "ms", halo: bool = False,
    ) -> None:  # fmt: skip
        """Write; `anchor` is Pillow's, and a halo keeps letters legible over a photograph."""
        self._words.append(_Word(where, text, colour, size, anchor, halo))

    def upright(self, where: tuple[float, float], text: str, size: int = 12) -> None:
        """Write from below to above, ending at a place."""
        self._words.append(_Word(where, text, INK, size, upright=True))

    def photograph(
        self, grey: npt.NDArray[np.uint8], where: tuple[int, int], size: tuple[int, int]
    ) -> None:
        """Put a grey picture on the sheet, in the size that it shall have there."""
        from PIL import Image

        (x, y), (width, height) = where, size
        small = Image.fromarray(grey).resize(size, Image.Resampling.BILINEAR)
        self._grey[y : y + height, x : x + width] = np.asarray(small)

    def png(self) -> bytes:
        """Encode it."""
        for colour in _LAYERS:
            for area in self._fills.get(colour, ()):
                self._fill(area, colour)
            if colour in self._strokes:
                self._lay(*self._covered(np.concatenate(self._strokes[colour])), colour)
        for word in self._words:
            x, y = (round(at) for at in word.where)
            for halo in (True, False) if word.halo else (False,):
                u, v, paint = _letters(word.text, word.size, word.anchor, word.upright, halo)
                self._lay(*self._on_sheet(x + u, y + v, paint), "#FFFFFF" if halo else word.colour)
        inked = 128 + ((self._ink - 1) << 2) + (self._grey >> 6)
        return pack_png(np.where(self._ink, inked, self._grey >> 1), _palette())

    def _fill(self, area: tuple[slice, slice], colour: str) -> None:
        self._ink[area] = 8 * _INKS.index(colour) + 8 if colour in _INKS else 0
        if colour not in _INKS:
            self._grey[area] = _rgb(colour)[0]

    def _lay(self, place: Places, paint: Paint, colour: str) -> None:
        """Lay paint, 0 to 1, on pixels: mixed with grey, or as ink, of which the thicker counts."""
        grey, ink = self._grey.reshape(-1), self._ink.reshape(-1)
        if colour in _INKS:
            level = np.rint(8 * paint).astype(np.uint8)
            seen = (level > 3) | ((level > 0) & (ink[place] == 0))
            ink[place[seen]] = 8 * _INKS.index(colour) + level[seen]
            return
        grey[place] = np.rint(grey[place] + paint * (np.float32(_rgb(colour)[0]) - grey[place]))
        ink[place[paint > 0.5]] = 0

    def _covered(self, strokes: Array) -> tuple[Places, Paint]:
        """Give the pixels under strokes (n, 5): x, y, x, y, radius."""
        height, width = self._grey.shape
        thick = self._thick
        for radius in np.unique(strokes[:, 4]):
            some = strokes[strokes[:, 4] == radius, :4]
            for dabs in _dabs(*_within(some, np.array([width, height]), radius + 1)):
                place, paint = self._on_sheet(*_around(dabs, radius))
                np.maximum.at(thick, place, paint)  # the thicker paint counts
        place = np.flatnonzero(thick > 0)
        paint, thick[place] = thick[place], 0
        return place, paint

    def _on_sheet(self, x: Any, y: Any, paint: Paint) -> tuple[Places, Paint]:
        """Give the places in memory of pixels (x, y) with paint on them, those on the sheet."""
        height, width = self._grey.shape
        seen = (paint > 0) & (x >= 0) & (x < width) & (y >= 0) & (y < height)
        return y[seen].astype(np.intp) * width + x[seen].astype(np.intp), paint[seen]


def _dabs(start: Array, end: Array) -> Iterator[Paint]:
    """Give places along strokes, a pixel apart at most, each with its stroke, some at a time.

    Rows of (k, 7) are the place x, y, the stroke's start x, y and direction x, y, and its length.
    """
    along = end - start
    length = np.hypot(*along.T)
    direction = along / np.where(length > 0, length, 1)[:, None]
    stroke = np.column_stack([start, direction, length]).astype(np.float32)
    count = np.ceil(length).astype(np.intp) + 1
    which, first = np.repeat(np.arange(len(start)), count), np.cumsum(count) - count
    far = (np.arange(len(which)) - first[which]) * (length / np.maximum(count - 1, 1))[which]
    place = (start[which] + far[:, None] * direction[which]).astype(np.float32)
    for part in chunks(len(which), _DABS):
        yield np.concatenate([place[part], stroke[which[part]]], axis=1)


def _around(dabs: Paint, radius: float) -> tuple[Paint, Paint, Paint]:
    """Give pixels x and y around places on strokes (n, 7), and how far the strokes cover them.

    A pixel is covered as far as its middle lies inside the stroke, up to half a pixel beyond its
    edge.
    """
    reach = int(np.ceil(radius + 0.5))
    dy, dx = np.mgrid[-reach : reach + 1, -reach : reach + 1].reshape(2, -1, 1).astype(np.float32)
    x, y, x0, y0, u, v, length = dabs.T
    x, y = np.floor(x) + dx, np.floor(y) + dy
    from_x, from_y = x + (0.5 - x0), y + (0.5 - y0)
    # How far the middle of each pixel is before or past the stroke. What is left goes across.
    past = from_x * u + from_y * v
    past = np.clip(past, 0, length, out=past)
    from_x -= past * u
    from_y -= past * v
    paint = np.float32(radius + 0.5) - np.sqrt(from_x * from_x + from_y * from_y)
    return x, y, np.minimum(paint, 1, out=paint)


def _within(ends: Array, size: Array, margin: float) -> tuple[Array, Array]:
    """Cut strokes (n, 4) off outside of a sheet: (k, 2) and (k, 2), without those that miss it.

    References
    ----------
    .. [1] Y.-D. Liang and B. Barsky, A new concept and method for line clipping, ACM Trans.
       Graphics 3 (1984) 1-22.
    """
    start, along = ends[:, :2], ends[:, 2:] - ends[:, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.sort([(-margin - start) / along, (size + margin - start) / along], axis=0)
    inside = (start >= -margin) & (start <= size + margin)
    still = along == 0
    t[:, still] = np.where(inside[still], [[0.0], [1.0]], np.nan)
    first, last = t[0].max(1).clip(0), t[1].min(1).clip(max=1)
    seen = first <= last
    cut = start[seen, None] + np.stack([first, last], 1)[seen, :, None] * along[seen, None]
    return cut[:, 0], cut[:, 1]


@lru_cache(64)  # what is written on every photograph
def _letters(
    text: str, size: int, anchor: str, upright: bool, halo: bool
) -> tuple[Places, Places, Paint]:
    """Give the pixels of a word, seen from its place, and how far letters or halo cover them."""
    from PIL import Image, ImageDraw

    font, anchor = _font(text, size), "ls" if upright else anchor
    left, top, right, bottom = font.getbbox(text, anchor=anchor, stroke_width=int(halo))
    left, top = int(left) - 1, int(top) - 1
    label = Image.new("L", (int(right) - left + 2, int(bottom) - top + 2))
    ImageDraw.Draw(label).text(
        (-left, -top), text, 255, font, anchor, stroke_width=int(halo), stroke_fill=255
    )
    paint: Paint = np.asarray(label).astype(np.float32) / np.float32(255)
    if upright:
        paint, left, top = np.rot90(paint), -paint.shape[0] // 2, 0
    v, u = np.nonzero(paint)
    return u + left, v + top, paint[v, u]


@cache
def _palette() -> Bytes:
    """Give the colours (256, 3): 128 greys, then each ink in 8 thicknesses over 4 greys."""
    i = np.arange(128)
    greys = np.repeat((2 * i + (i > 63))[:, None], 3, axis=1)
    inks = np.array([_rgb(ink) for ink in _INKS], dtype=float)[:, None, None]
    thick, under = np.arange(1, 9)[:, None, None] / 8, np.arange(4)[:, None] * 85.0
    mixed = under + thick * (inks - under)
    return np.concatenate([greys, np.rint(mixed).reshape(-1, 3)]).astype(np.uint8)


def _rgb(colour: str) -> Bytes:
    return np.frombuffer(bytes.fromhex(colour[1:]), np.uint8)


def ticks(low: float, high: float, most: int = 6) -> Array:
    """Give round numbers between two, at most so many.

    Examples
    --------
    >>> ticks(0, 0.37)
    array([0. , 0.1, 0.2, 0.3])
    """
    rough = max(high - low, 1e-300) / most
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(f for f in (1, 2, 5, 10) if f * power >= rough * (1 - 1e-9))
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return np.asarray(step * np.arange(first, last + 1) + 0.0)


def wrapped(text: str, width: float, size: int = 13) -> list[str]:
    """Break a text between words into lines no wider than so many pixels.

    Examples
    --------
    >>> wrapped("the board, tilted by 40° to the left", 120)
    ['the board, tilted by', '40° to the left']
    """
    font, lines = _font(text, size), [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if font.getlength(longer) <= width or not lines[-1]:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def _font(text: str, size: int) -> Any:
    """Give a font that has the letters of a text: Pillow's own has no umlauts."""
    plain = text.translate(_LIGHT).isascii()
    return _light(size) if plain else _with_accents(size)


_LIGHT = str.maketrans("", "", "…°·")  # what Pillow's own has besides ASCII


@cache
def _light(size: int) -> Any:
    from PIL import ImageFont

    return ImageFont.load_default(size)


@cache
def _with_accents(size: int) -> Any:
    from PIL import ImageFont

    from cvnotes.show.explore.lettering import font_file

    try:
        return ImageFont.truetype(font_file(), size)
    except (FileError, OSError):
        return _light(size)


def known_runs(m: Array) -> Iterable[Array]:
    """Give the parts of a line (n, 2) between its gaps (NaN), at least two points each.

    Examples
    --------
    >>> line = np.array([[0, 0], [1, 0], [np.nan, np.nan], [3, 0], [4, 0], [5, 0]])
    >>> [len(run) for run in known_runs(line)]
    [2, 3]
    """
    known = np.isfinite(m).all(-1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(int)))
    return [m[a:b] for a, b in edges.reshape(-1, 2) if b - a > 1]
