"""Figures on the page: an image, and a text for those who cannot see it."""

import base64
import io
import sys
import zlib
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, whole
from cvnotes.show.axes import set_words
from cvnotes.show.style import DPI

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from PIL.Image import Image as PillowImage

# A figure with more colours than this holds a photograph.
_MANY_COLOURS = 4096
# Grey levels, in the mean: so has one whose palette is farther off.
_OFF = 0.1
# A drawing is smaller than this, in bytes.
_LARGE = 150_000
# From so many bytes on a photograph is tried without loss, too.
_MUCH = 100_000
# px: how wide what is made for a telephone is drawn.
NARROW = 380
# Of zlib: the last levels take six times as long, and save a fourteenth.
_PACKING = 7


@dataclass(frozen=True)
class Picture:
    """A finished figure: an image for the notebook, and its description everywhere else.

    A page as narrow as a telephone shows `narrow` instead, an SVG, if there is one.
    """

    data: bytes
    alt: str
    width: int
    mime: str = "image/png"
    narrow: bytes = b""

    def __repr__(self) -> str:
        return self.alt

    def _repr_html_(self) -> str:
        code = base64.b64encode(self.data).decode()
        image = (
            f'<img alt="{escape(self.alt)}" width="{self.width}" '
            f'style="max-width: 100%; background: white" src="data:{self.mime};base64,{code}">'
        )
        if not self.narrow:
            return image
        code = base64.b64encode(self.narrow).decode()
        source = f'media="(max-width: 600px)" srcset="data:image/svg+xml;base64,{code}"'
        return f'<picture><source {source} width="{NARROW}">{image}</picture>'


def show(figure: Any, *, alt: str, width: int | None = None) -> Picture:
    """Turn a figure into a picture for the page, at twice its resolution.

    Parameters
    ----------
    figure : Axes, ndarray of Axes, or Figure
        What a ``draw_…`` function returned, or what it drew on.
    alt : str
        What the picture shows, in a sentence, for those who cannot see it. JupyterLab and static
        pages hand it to screen readers.
    width : int, optional
        Width on the page in px; by default the figure's own.

    Returns
    -------
    Picture
        Shown by a notebook; its repr is `alt`. The figure is closed.

    Examples
    --------
    >>> from cvnotes.show import panels
    >>> show(panels(), alt="Empty axes.")
    Empty axes.
    """
    if not alt.strip():
        raise CvnotesError("alt: say in a sentence what the picture shows")
    figure = figure_of(figure)
    width = round(figure.get_figwidth() * DPI) if width is None else whole(width, "width")
    data, mime = encode(figure)
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close(figure)
    return Picture(data, alt, width, mime)


def figure_of(drawn: Any) -> "Figure":
    """Return the figure that axes, or the first of several, belong to."""
    from matplotlib.figure import Figure

    while not isinstance(drawn, Figure):
        drawn = np.ravel(drawn)[0].figure
    return drawn


def encode(figure: "Figure") -> tuple[bytes, str]:
    """Encode a figure at 200 dpi, small; gives the bytes and their type."""
    return packed(pixels_of(figure))


def packed(pixels: npt.NDArray[np.uint8], level: int = _PACKING) -> tuple[bytes, str]:
    """Pack pixels small; gives the bytes and their type.

    Line drawings become PNG with a palette of 256 colours, which suffices for their blended
    edges. What has a photograph in it becomes WebP, which needs half of what JPEG does.
    """
    from PIL import Image

    picture, encoded = Image.fromarray(pixels).convert("RGB"), io.BytesIO()
    few = with_palette(picture)
    if few and _off(few, pixels) < _OFF and not _never_small(few.tobytes()):
        few.save(encoded, "PNG", compress_level=level)
        if encoded.tell() < _LARGE:
            return encoded.getvalue(), "image/png"
        encoded = io.BytesIO()  # a grey photograph: few colours, but noise that no PNG packs
    picture.save(encoded, "WEBP", quality=90)
    if encoded.tell() > _MUCH:  # small dots on large pixels: edges that only a lossless one packs
        exact = io.BytesIO()
        picture.save(exact, "WEBP", lossless=True, method=1)
        encoded = min(encoded, exact, key=io.BytesIO.tell)
    return encoded.getvalue(), "image/webp"


def with_palette(picture: "PillowImage") -> "PillowImage | None":
    """Return a drawing in 256 of its colours, or None if it has more than 4096.

    The palette is chosen by median cut, where a colour counts by the square root of its pixels:
    paper has nearly all of them, and the blended edges need the colours. Then each goes to the
    middle of those nearest to it, so that a small thing keeps its colour beside one like it.

    Examples
    --------
    >>> from PIL import Image
    >>> drawing = Image.new("RGB", (4, 3), "#D55E00")
    >>> with_palette(drawing).convert("RGB") == drawing
    True
    """
    from PIL import Image

    counted = picture.getcolors(_MANY_COLOURS)
    if counted is None:
        return None
    colours = np.array([colour for _, colour in counted], dtype=np.uint8)
    times = np.sqrt([n for n, _ in counted]).round().astype(int)
    strip = Image.fromarray(colours.repeat(times, axis=0)[None])
    palette = strip.quantize(256, kmeans=1, dither=Image.Dither.NONE)
    code = np.zeros(256**3, dtype=np.uint8)
    code[_in_one_number(colours)] = np.asarray(palette)[0, np.cumsum(times) - 1]
    few = Image.fromarray(code[_in_one_number(np.asarray(picture))])
    few.putpalette(palette.getpalette() or ())
    return few


def _in_one_number(colours: npt.NDArray[np.uint8]) -> npt.NDArray[np.int32]:
    red, green, blue = np.moveaxis(colours.astype(np.int32), -1, 0)
    return np.asarray(red << 16 | green << 8 | blue)


def pixels_of(figure: "Figure") -> npt.NDArray[np.uint8]:
    """Draw a figure once, as (height, width, 4); savefig draws it twice, and packs it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    set_words(figure)
    canvas, dpi, paper = figure.canvas, figure.dpi, figure.get_facecolor()
    try:
        figure.set_facecolor("white")
        ours: Any = FigureCanvasAgg(figure)
        figure.dpi = 2 * DPI
        ours.draw()
        return np.array(ours.buffer_rgba())
    finally:
        figure.set_canvas(canvas)
        figure.set_facecolor(paper)
        figure.dpi = dpi


def _off(few: "PillowImage", pixels: npt.NDArray[np.uint8]) -> float:
    """Return by how many grey levels a palette's colours differ from the pixels, in the mean."""
    shown = np.asarray(few.convert("RGB"), dtype=np.int16)
    return float(np.abs(shown - pixels[..., :3]).mean())


def _never_small(pixels: bytes) -> bool:
    """Return in a hurry whether pixels will not be small, however carefully they are packed."""
    return len(zlib.compress(pixels, 1)) > 3 * _LARGE
