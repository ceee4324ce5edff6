"""A sheet to draw on, with Pillow at twice the size: no figure library is loaded."""

import io
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, FileError, clipped_segments

# The meanings of the course's figures, and shades of grey.
ESTIMATED, WORLD, LENS = "#D55E00", "#009E73", "#0072B2"
MUTED, PALE, FAINT, INK = "#6E6E6E", "#C4C4C4", "#EEEEEE", "#000000"
_FINE = 2  # times finer than the sheet is drawn what has edges
_THINNEST = 3  # fine pixels: thinner lines fade at some slopes


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

    What is drawn later lies above what was drawn before, and words lie above all.

    Examples
    --------
    >>> sheet = Canvas(30, 20)
    >>> sheet.rectangle((5, 5), (25, 15), fill="#D55E00")
    >>> sheet.png()[1:4]
    b'PNG'
    """

    def __init__(self, width: int, height: int) -> None:
        from PIL import Image, ImageDraw

        self._size = width, height
        self._sheet = Image.new("RGB", (_FINE * width, _FINE * height), "white")
        self._draw = ImageDraw.Draw(self._sheet)
        self._words: list[_Word] = []

    def line(self, m: npt.ArrayLike, colour: str, width: float = 1) -> None:
        """Join points (n, 2)."""
        m = np.asarray(m, dtype=float)
        self.segments(m[:-1], m[1:], colour, width)

    def segments(self, start: Array, end: Array, colour: str, width: float = 1) -> None:
        """Draw a line from each point (n, 2) to the other, if both are known (not NaN)."""
        thick, ends = max(round(_FINE * width), _THINNEST), np.stack([start, end], axis=1)
        reach = 2.0 * sum(self._size)  # far outside of the sheet Pillow cannot count
        near = clipped_segments(ends, np.concatenate([ends + reach, reach - ends], axis=-1))
        for line in _fine(near).reshape(-1, 4).tolist():
            self._draw.line(line, colour, thick)
        if width > 1:  # so that lines of a corner meet
            self.dots(np.concatenate([start, end]), colour, width / 2)

    def dots(self, m: npt.ArrayLike, colour: str, radius: float = 2) -> None:
        """Put a dot on each point (n, 2)."""
        m = np.asarray(m, dtype=float).reshape(-1, 2)
        seen = ((m > -radius) & (m < np.array(self._size) + radius)).all(1)
        for x, y in _fine(m[seen]).tolist():
            r = _FINE * radius - 0.5
            self._draw.ellipse((x - r, y - r, x + r, y + r), colour)

    def ring(self, centre: npt.ArrayLike, radius: float, colour: str, width: float = 1.5) -> None:
        """Draw a circle."""
        (x, y), r = _fine(np.asarray(centre, dtype=float)).tolist(), _FINE * (radius + width / 2)
        self._draw.ellipse((x - r, y - r, x + r, y + r), outline=colour, width=round(_FINE * width))

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
            left, top, right, bottom = (_FINE * round(x) for x in (x0, y0, x1, y1))
            if right > left and bottom > top:
                self._draw.rectangle((left, top, right - 1, bottom - 1), fill)
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
        fine = small.resize((_FINE * width, _FINE * height), Image.Resampling.NEAREST)
        self._sheet.paste(fine, (_FINE * x, _FINE * y))

    def png(self) -> bytes:
        """Encode it."""
        from PIL import Image, ImageDraw

        sheet = self._sheet.reduce(_FINE)
        draw = ImageDraw.Draw(sheet)
        for word in self._words:
            font = _font(word.text, word.size)
            x, y = (round(at) for at in word.where)
            if word.upright:
                left, top, right, bottom = (int(at) for at in font.getbbox(word.text, anchor="ls"))
                label = Image.new("L", (right - left + 2, bottom - top + 2))
                ImageDraw.Draw(label).text((1 - left, 1 - top), word.text, 255, font, "ls")
                turned = label.transpose(Image.Transpose.ROTATE_90)
                sheet.paste(word.colour, (x - turned.width // 2, y), turned)
            else:
                draw.text(
                    (x, y), word.text, word.colour, font, word.anchor,
                    stroke_width=int(word.halo), stroke_fill="white",
                )  # fmt: skip
        packed = io.BytesIO()
        sheet.quantize(256, dither=Image.Dither.NONE).save(packed, "PNG")
        return packed.getvalue()


def _fine(m: Array) -> Array:
    """Return places on the fine sheet, where Pillow counts from the middle of the first pixel."""
    return _FINE * m - 0.5


def ticks(low: float, high: float, most: int = 6) -> Array:
    """Return round numbers between two, at most so many.

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
    """Return a font that has the letters of a text: Pillow's own has no umlauts."""
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
