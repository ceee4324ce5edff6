"""A drawing for a page: SVG, which is sharp at any size and in the page's own light."""

import base64
import io
from html import escape
from typing import Any

import numpy as np
import numpy.typing as npt

# The meanings of the course's figures.
ESTIMATED, WORLD, LENS, INK = "#D55E00", "#009E73", "#0072B2", "currentColor"


def encoded(picture: Any, kind: str = "PNG", **how: Any) -> bytes:
    """Return a picture, an array or Pillow's, as a file."""
    from PIL import Image

    file = io.BytesIO()
    image = picture if isinstance(picture, Image.Image) else Image.fromarray(picture)
    image.save(file, kind, **how)
    return file.getvalue()


class Drawing:
    """A sheet of (width, height); places are (x, y) from its upper left corner.

    What is drawn later lies above what was drawn before; widths are in px of the page.

    Examples
    --------
    >>> sheet = Drawing((30, 20), "A line")
    >>> sheet.lines([[[5, 5], [np.nan, 0], [25, 15], [20, 15]]], "red")
    >>> str(sheet).split('"')[15]
    'M5 5M25 15L20 15'
    """

    def __init__(self, size: tuple[float, float], label: str) -> None:
        self._parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]:g} {size[1]:g}" '
            f'role="img" aria-label="{escape(label)}" font-size="15" stroke-linecap="round">\n'
        ]

    def lines(
        self, m: npt.ArrayLike, colour: str, width: float = 1.2, *, fill: str = "none"
    ) -> None:
        """Draw lines (n, k, 2), with gaps where a point is not known; filled, they are closed."""
        way = []
        for line in np.round(np.asarray(m, dtype=float), 1).tolist():
            pen = "M"
            for x, y in line:
                known = abs(x) < np.inf and abs(y) < np.inf
                way += [f"{pen}{x:g} {y:g}"] * known
                pen = "L" if known else "M"
            way += ["Z"] * (fill != "none")
        inside = fill if fill == "none" else f'{fill}" fill-opacity=".08'
        self._parts.append(
            f'<path vector-effect="non-scaling-stroke" d="{"".join(way)}" fill="{inside}" '
            f'stroke="{colour}" stroke-width="{width:g}"/>\n'
        )

    def dots(self, m: npt.ArrayLike, colour: str, width: float = 3) -> None:
        """Put a dot on each point (n, 2) that is known: one, where several are drawn at a place."""
        m = np.asarray(m, dtype=float)
        places = np.unique(np.round(m[np.isfinite(m).all(-1)]), axis=0)[:, None]
        self.lines(places.repeat(2, axis=1), colour, width)

    def text(self, where: npt.ArrayLike, words: str, colour: str = INK) -> None:
        """Write in the middle of a place."""
        (x, y), look = np.asarray(where, dtype=float), 'text-anchor="middle" dy=".35em"'
        self._parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" {look} fill="{colour}">{escape(words)}</text>\n'
        )

    def photograph(
        self,
        picture: npt.NDArray[np.uint8],
        size: tuple[float, float],
        at: tuple[float, float] = (0, 0),
    ) -> None:
        """Put a grey picture (h, w) on the sheet, of such a size; at most twice as fine as that."""
        from PIL import Image

        small = Image.fromarray(picture)
        small.thumbnail((round(2 * size[0]), round(2 * size[1])), Image.Resampling.BOX)
        self._image(encoded(small, "JPEG", quality=75), "jpeg", size, at)

    def areas(
        self, numbers: npt.NDArray[np.uint8], colours: list[str], size: tuple[float, float]
    ) -> None:
        """Put a picture (h, w) on the sheet whose pixels are numbers of colours."""
        from PIL import Image, ImageColor

        picture = Image.fromarray(numbers)
        picture.putpalette(sum(map(ImageColor.getrgb, colours), ()))
        self._image(encoded(picture), "png", size)

    def _image(
        self, file: bytes, kind: str, size: tuple[float, float], at: tuple[float, float] = (0, 0)
    ) -> None:
        data = base64.b64encode(file).decode()
        (x, y), (width, height) = at, size
        self._parts.append(
            f'<image x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" '
            f'preserveAspectRatio="none" '
            f'href="data:image/{kind};base64,{data}"/>\n'
        )

    def __str__(self) -> str:
        return "".join([*self._parts, "</svg>"])
