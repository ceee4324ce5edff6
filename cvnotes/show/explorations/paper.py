"""Line drawings made quickly: panels that are drawn straight into arrays of pixels.

Matplotlib takes a tenth of a second for a figure, too long for a picture that follows the hand.
Here Pillow draws at twice the size, and taking the mean of 2 × 2 pixels makes the lines smooth.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageChops, ImageDraw

from cvnotes.base import Array
from cvnotes.show.explorations.lettering import stamp, title_strip
from cvnotes.show.explorations.strokes import clipped, dashed
from cvnotes.show.style import COLOURS, FAINT, INK, MARKERS, MUTED

Drawn = npt.NDArray[np.uint8]
Range = tuple[float, float]
Size = tuple[int, int]
_Stroke = tuple[float, float, float, float]

_TITLE = 22  # px of the page above each panel
_GAP = 6  # px between panels
_NARROW = 440  # px: a panel on a narrow page is no wider
_FARTHEST = 1e12  # px: lines are cut to the panel with all the digits this leaves
_LARGEST = 1e6  # px: polygons are not cut, and Pillow counts in whole numbers
_BEYOND = 8  # px by which lines are drawn over the border, where they are cut off
GRID = "#E6E6E6"
_RING, _RING_INK = 12, "#444444"  # px, what can be pulled


class Grip(NamedTuple):
    """A place of a picture that a hand can take hold of.

    Attributes
    ----------
    name, label : str
        Whose it is, and what is read out.
    place : (x, y)
        On the whole picture, in px of the page.
    at : (x, y)
        In the coordinates of its panel.
    unit : (x, y)
        How much these grow from one px of the page to the next.
    step : float
        How many px an arrow key moves it.
    """

    name: str
    label: str
    place: tuple[float, float]
    at: tuple[float, float]
    unit: tuple[float, float]
    step: float


def circle(n: int) -> Array:
    """Return n points (n, 2) once round the unit circle, the last upon the first."""
    turn = np.linspace(0, 2 * np.pi, n)
    return np.stack([np.cos(turn), np.sin(turn)], axis=-1)


class Paper:
    """Something to draw panels on, in pixels of the page times `sharpness`.

    On a `narrow` page, a telephone's, panels that else stand side by side come below each other.
    """

    def __init__(self, sharpness: int = 1, *, narrow: bool = False) -> None:
        self.sharpness, self.narrow = sharpness, narrow
        self.grips: tuple[Grip, ...] = ()

    def panel(self, size: Size, x: Range, y: Range, title: str = "") -> "Panel":
        """Make a panel of (width, height) px that shows x from left to right, y downwards."""
        if self.narrow and size[0] > _NARROW:  # letters and lines stay as large as they are
            size = _NARROW, round(size[1] * _NARROW / size[0])
        return Panel(size, x, y, title, 2 * self.sharpness)

    def picture_panel(
        self, size: Size, picture: Size, title: str = "", corner: Range = (0, 0)
    ) -> "Panel":
        """Make a panel that shows the pixels of a picture of (width, height), from a corner on."""
        (left, top), (width, height) = np.array(corner) - 0.5, picture
        return self.panel(size, (left, left + width), (top, top + height), title)

    def join(self, *rows: tuple["Panel | list[Panel]", ...]) -> Drawn:
        """Lay panels side by side, and rows below each other: (height, width, 3).

        A list in a row is a column: its panels, all as wide, stand below each other.
        """
        columns = [[one if isinstance(one, list) else [one] for one in row] for row in rows]
        if self.narrow:
            columns = [[[panel]] for row in columns for column in row for panel in column]
        high = [max(sum(panel.sheet[1] for panel in column) for column in row) for row in columns]
        width = max(sum(column[0].sheet[0] for column in row) for row in columns)
        page = np.full((sum(high), width, 3), 255, np.uint8)
        for row, row_top in zip(columns, np.cumsum([0, *high]).tolist(), strict=False):
            left = 0
            for column in row:
                top = row_top
                for panel in column:
                    panel.finish(page[top:, left:])
                    self.grips += tuple(panel.grips(left / self.sharpness, top / self.sharpness))
                    top += panel.sheet[1]
                left += column[0].sheet[0]
        return page


class Panel:
    """A rectangle with coordinates of its own; what leaves it is cut off."""

    def __init__(self, size: tuple[int, int], x: Range, y: Range, title: str, scale: int) -> None:
        self.scale, self.title, self.x, self.y = scale, title, x, y
        self.width, self.height = scale * size[0], scale * size[1]
        self._image = Image.new("RGB", (self.width, self.height), "white")
        self._draw = ImageDraw.Draw(self._image)
        self._frame = FAINT
        self._grips: list[tuple[str, str, Array, float]] = []

    @property
    def sheet(self) -> tuple[int, int]:
        """Return (width, height) of the whole: with its title above, and the gap around."""
        sharpness = self.scale // 2
        return self.width // 2 + sharpness * _GAP, self.height // 2 + sharpness * (_TITLE + _GAP)

    @property
    def pixel(self) -> float:
        """How far it is from one pixel of the page to the next, along x."""
        return (self.x[1] - self.x[0]) * self.scale / self.width

    def place(self, xy: npt.ArrayLike) -> Array:
        """Return where points (..., 2) lie on this panel, in its own pixels; NaN stays NaN."""
        low = np.array([self.x[0], self.y[0]])
        extent = np.array([self.x[1], self.y[1]]) - low
        at = (np.asarray(xy, dtype=np.float64) - low) / extent * [self.width, self.height]
        # What is farther away than any line can be followed has no place either.
        return np.where(np.abs(at) < _FARTHEST, at, np.nan)

    def line(
        self, xy: npt.ArrayLike, colour: str, width: float = 1.5, dash: float = 0, rim: float = 0
    ) -> None:
        """Draw a curve through points (n, 2); it is interrupted where they are NaN.

        With a white rim, by which it is wider in all, it is seen on dark and light.
        """
        if rim:
            self.line(xy, "white", width + rim)
        at = self.place(xy)
        low, high = self._limits()
        thick = max(1, round(width * self.scale))
        if not dash and (at >= low).all() and (at <= high).all():
            self._draw.line(at.ravel().tolist(), colour, thick, joint="curve")
            return
        pairs = clipped(at[:-1], at[1:], (low, high))
        for pair in dashed(pairs, dash * self.scale) if dash else pairs:
            self._draw.line(pair.ravel().tolist(), colour, thick)

    def segments(self, ends: npt.ArrayLike, colour: str, width: float = 1.5) -> None:
        """Draw straight lines between pairs of points (n, 2, 2)."""
        at = self.place(ends)
        thick = max(1, round(width * self.scale))
        for pair in clipped(at[:, 0], at[:, 1], self._limits()):
            self._draw.line(pair.ravel().tolist(), colour, thick)

    def arrows(self, starts: npt.ArrayLike, ways: npt.ArrayLike, colour: str, width: float) -> None:
        """Draw arrows from points (n, 2), so far each; the thicker, the larger their heads."""
        start, way = np.atleast_2d(starts), np.atleast_2d(ways)
        length = np.linalg.norm(way, axis=-1, keepdims=True)
        along = way / length.clip(1e-12)
        across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
        head = np.minimum((5 + 2.5 * width) * self.pixel, 0.6 * length)
        back = start + way - head * along
        self.segments(np.stack([start, back + 0.2 * head * along], axis=1), colour, width)
        wings = back + 0.4 * head * across, back - 0.4 * head * across
        self.polygons(np.stack([start + way, *wings], axis=1), colour)

    def polygons(self, corners: Iterable[npt.ArrayLike], colour: str | Sequence[str]) -> None:
        """Fill polygons, each with corners (k, 2), with one colour or each with its own.

        Those without a place are left out.
        """
        several = [np.asarray(one) for one in corners]
        if not several:
            return
        ends = np.cumsum([len(one) for one in several])[:-1]
        places = np.split(self.place(np.concatenate(several)), ends)
        colours = [colour] * len(several) if isinstance(colour, str) else colour
        for at, ink in zip(places, colours, strict=True):
            if len(at) and (np.abs(at) < _LARGEST).all():
                self._draw.polygon(at.ravel().tolist(), fill=ink)

    def veil(self, panes: Sequence[npt.ArrayLike], tints: Sequence[str]) -> None:
        """Lay one coloured glass over all that is drawn: polygons (k, 2), each with its tint."""
        places = [self.place(pane) for pane in panes]
        ends = np.array([np.concatenate(places).min(axis=0), np.concatenate(places).max(axis=0)])
        low, high = np.rint(ends + [[-1], [1]]).clip(0, self._image.size).astype(int)
        if not (high > low).all():
            return
        left, top, right, bottom = box = (*low.tolist(), *high.tolist())
        glass = Image.new("RGB", (right - left, bottom - top), "white")
        for at, tint in zip(places, tints, strict=True):
            ImageDraw.Draw(glass).polygon((at - low).ravel().tolist(), fill=tint)
        self._image.paste(ImageChops.multiply(self._image.crop(box), glass), box)

    def mark(
        self, xy: npt.ArrayLike, meaning: str, size: float = 5, looks: tuple[float, float] = (0, -1)
    ) -> None:
        """Mark points (n, 2) with the colour and the marker of their meaning.

        A camera's triangle points to where it looks: so far to the right, and so far down.
        """
        reach = size * self.scale
        for at in np.atleast_2d(self.place(xy)):
            if np.isfinite(at).all() and (np.abs(at) < 10 * max(self.width, self.height)).all():
                self._marker(at, MARKERS[meaning], COLOURS[meaning], reach, looks)

    def grip(
        self,
        name: str,
        label: str,
        xy: npt.ArrayLike,
        step: float = 1,
        meaning: str = "",
        size: float = 5,
    ) -> None:
        """Let a hand take hold of a point: a ring; one that lies outside is held at the border.

        If it has a meaning, its mark stands in the ring.
        """
        if meaning:
            self.mark(xy, meaning, size)
        at = np.asarray(xy, dtype=np.float64)
        if np.isfinite(at).all():
            ends = np.array([self.x, self.y])
            at = np.clip(at, ends.min(axis=1), ends.max(axis=1))
            self._grips.append((name, label, at, step))
            self._ring(self.place(at))

    def grips(self, left: float, top: float) -> list[Grip]:
        """Return the grips of this panel, which begins at (left, top) px of the picture."""
        unit = np.ptp([self.x, self.y], axis=1) * self.scale / [self.width, self.height]
        unit = unit * np.sign([self.x[1] - self.x[0], self.y[1] - self.y[0]])
        origin = np.array([left + _GAP // 2, top + _TITLE])
        found = []
        for name, label, at, step in self._grips:
            place = _pair(origin + self.place(at) / self.scale)
            found.append(Grip(name, label, place, _pair(at), _pair(unit), step))
        return found

    def image(self, picture: Drawn, smooth: bool = True) -> None:
        """Fill the panel with a picture, grey or RGB; whole pixels stay as they are."""
        fits = self.width % picture.shape[1] == 0 == self.height % picture.shape[0]
        how = Image.Resampling.NEAREST if fits or not smooth else Image.Resampling.BILINEAR
        resized = Image.fromarray(picture).resize((self.width, self.height), how)
        self._image.paste(resized.convert("RGB"))
        self._frame = MUTED  # photographs end dark, drawings light

    def text(
        self,
        xy: npt.ArrayLike,
        words: str,
        colour: str = MUTED,
        *,
        anchor: str = "lm",
        size: int = 12,
        rim: str = "white",
    ) -> None:
        """Write words at a point; the anchor is Pillow's: left, middle, right; a, m, s or d.

        Those of a point within the panel stay within. On even ground their rim has its colour, and
        is not seen.
        """
        at = self.place(xy)
        if np.isfinite(at).all() and (np.abs(at) < _LARGEST).all():
            stroke = round(1.5 * self.scale)
            around, ink, offset = stamp(words, anchor, size * self.scale, stroke)
            corner, room = np.rint(at) + offset, np.subtract(self._image.size, around.size)
            if ((at >= 0) & (at <= self._image.size)).all():
                corner = np.clip(corner, np.minimum(room, 0), np.maximum(room, 0))
            corner = tuple(corner.astype(int).tolist())
            self._image.paste(rim, corner, around)
            self._image.paste(INK.get(colour, colour), corner, ink)

    def ticks(self, x: npt.ArrayLike = (), y: npt.ArrayLike = (), size: int = 11) -> None:
        """Draw light lines with their numbers at some x and y."""
        (x0, x1), (y0, y1) = self.x, self.y
        at_x, at_y = np.ravel(x).tolist(), np.ravel(y).tolist()
        grid = [[[v, y0], [v, y1]] for v in at_x] + [[[x0, v], [x1, v]] for v in at_y]
        self.segments(grid, GRID, 0.5)
        for value in at_x:
            self.text([value, y1 - 0.03 * (y1 - y0)], f"{value:g}", anchor="md", size=size)
        for value in at_y:
            self.text([x0 + 0.01 * (x1 - x0), value], f"{value:g}", size=size)

    def drawn(self) -> Drawn:
        """Return what was drawn so far, without title and frame."""
        return np.asarray(self._image.reduce(2))

    def finish(self, page: Drawn | None = None) -> Drawn:
        """Put the panel, with frame and title, on the top left of a white page, or of its own."""
        if page is None:
            page = np.full((*self.sheet[::-1], 3), 255, np.uint8)
        sharpness = self.scale // 2
        strip, gap = sharpness * _TITLE, sharpness * _GAP
        whole = (0, 0, self.width - 1, self.height - 1)
        self._draw.rectangle(whole, outline=self._frame, width=self.scale)
        panel = self.drawn()
        height, width = panel.shape[:2]
        page[strip : strip + height, gap // 2 : gap // 2 + width] = panel
        left = self.scale * (_GAP // 2 + 2)
        page[:strip, : width + gap] = title_strip(
            self.title, (width + gap, strip), left, self.scale
        )
        return page

    def _limits(self) -> tuple[Array, Array]:
        beyond = _BEYOND * self.scale
        return np.full(2, -float(beyond)), np.array([self.width, self.height]) + float(beyond)

    def _marker(self, at: Array, marker: str, colour: str, reach: float, looks: Range) -> None:
        u, v = at.tolist()
        r = 0.7 * reach
        box = (u - r, v - r, u + r, v + r)
        if marker == "o":
            self._draw.ellipse(box, fill=colour, outline="white", width=self.scale // 2)
        elif marker == "s":
            self._draw.rectangle(box, fill=colour, outline="white", width=self.scale // 2)
        elif marker == "^":
            ahead = reach * np.array(looks) / np.hypot(*looks)
            aside, back = 0.6 * np.array([-ahead[1], ahead[0]]), at - 0.8 * ahead
            corners = np.array([at + ahead, back + aside, back - aside])
            self._draw.polygon(corners.ravel().tolist(), fill=colour)
        elif marker == "+":
            self._cross((u - reach, v, u + reach, v), (u, v - reach, u, v + reach), colour, reach)
        else:
            self._cross(box, (u - r, v + r, u + r, v - r), colour, reach)

    def _ring(self, at: Array) -> None:
        """Draw what a hand takes hold of: dashes on a white circle, seen on dark and light."""
        for reach, width, ink in ((_RING + 0.4, 2.2, "white"), (_RING, 1.4, _RING_INK)):
            box = (*(at - reach * self.scale).tolist(), *(at + reach * self.scale).tolist())
            for start in range(0, 360, 30 if ink == _RING_INK else 360):
                end = start + (18 if ink == _RING_INK else 360)
                self._draw.arc(box, start, end, fill=ink, width=round(width * self.scale))

    def _cross(self, one: _Stroke, two: _Stroke, colour: str, reach: float) -> None:
        """Draw two strokes with a white rim, to be seen on dark and light."""
        for ink, part in (("white", 0.6), (colour, 0.28)):
            for stroke in (one, two):
                self._draw.line(stroke, ink, max(1, round(part * reach)))


def _pair(xy: Array) -> tuple[float, float]:
    """Return two numbers as a page is told them: more than six digits no hand can hold."""
    x, y = (float(f"{number:.6g}") for number in xy.tolist())
    return x, y
