"""A sheet to draw on with Pillow: no figure library is loaded, and each picture is encoded once."""

from collections.abc import Iterable
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.base.png import pack_png

# The meanings of the course's figures, and shades of grey.
ESTIMATED, WORLD, LENS = "#D55E00", "#009E73", "#0072B2"
MUTED, FAINT, INK = "#6E6E6E", "#EEEEEE", "#000000"
_FINE = 2  # drawn so many times as large, and then reduced, so that edges are smooth


class Canvas:
    """A white sheet of (width, height) pixels; places are pixels (x, y) from its upper left.

    Examples
    --------
    >>> sheet = Canvas(30, 20)
    >>> sheet.rectangle((5, 5), (25, 15), fill="#D55E00")
    >>> sheet.png()[1:4]
    b'PNG'
    """

    def __init__(self, width: int, height: int) -> None:
        from PIL import Image, ImageDraw

        self._image = Image.new("RGB", (_FINE * width, _FINE * height), "white")
        self._draw = ImageDraw.Draw(self._image)

    def line(self, m: npt.ArrayLike, colour: str, width: float = 1) -> None:
        """Join points (n, 2)."""
        self._draw.line(_scaled(m), colour, round(_FINE * width), joint="curve")

    def dots(self, m: npt.ArrayLike, colour: str, radius: float = 2) -> None:
        """Put a dot on each point (n, 2)."""
        m = _FINE * np.asarray(m, dtype=float).reshape(-1, 2)
        for x, y in m.tolist():
            r = _FINE * radius
            self._draw.ellipse((x - r, y - r, x + r, y + r), fill=colour)

    def ring(self, centre: npt.ArrayLike, radius: float, colour: str, width: float = 1.5) -> None:
        """Draw a circle."""
        (x, y), r = _FINE * np.asarray(centre, dtype=float), _FINE * radius
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
        self._draw.rectangle([*_scaled(low), *_scaled(high)], fill, line, _FINE)

    def text(
        self, where: tuple[float, float], text: str, colour: str = INK, *, size: int = 13,
        anchor: str = "ms", halo: bool = False,
    ) -> None:  # fmt: skip
        """Write; `anchor` is Pillow's, and a halo keeps letters legible over a photograph."""
        self._draw.text(
            (_FINE * where[0], _FINE * where[1]), text, colour, _font(_FINE * size), anchor,
            stroke_width=_FINE * halo, stroke_fill="white",
        )  # fmt: skip

    def upright(self, where: tuple[float, float], text: str, size: int = 12) -> None:
        """Write from below to above, ending at a place."""
        from PIL import Image, ImageDraw

        font = _font(_FINE * size)
        left, top, right, bottom = font.getbbox(text, anchor="ls")
        label = Image.new("L", (int(right - left) + 4, int(bottom - top) + 4))
        ImageDraw.Draw(label).text((2 - left, 2 - top), text, 255, font, "ls")
        label = label.transpose(Image.Transpose.ROTATE_90)
        x, y = round(_FINE * where[0] - label.width / 2), round(_FINE * where[1])
        self._image.paste(INK, (x, y), label)

    def photograph(
        self, grey: npt.NDArray[np.uint8], where: tuple[int, int], size: tuple[int, int]
    ) -> None:
        """Put a grey picture on the sheet, in the size that it shall have there."""
        from PIL import Image

        x, y = where
        large = (_FINE * size[0], _FINE * size[1])
        fine = Image.fromarray(grey).resize(size).resize(large, Image.Resampling.NEAREST)
        self._image.paste(fine, (_FINE * x, _FINE * y))

    def png(self) -> bytes:
        """Encode it."""
        return pack_png(np.asarray(self._image.reduce(_FINE)))


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


def _scaled(m: npt.ArrayLike) -> list[float]:
    return [float(x) for x in _FINE * np.asarray(m, dtype=float).ravel()]


@cache
def _font(size: int) -> Any:
    from PIL import ImageFont

    return ImageFont.load_default(size)


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
