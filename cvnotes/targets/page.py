"""A page in true millimetres, written as PDF or SVG: exact vectors, the same bytes every time.

Places are (x, y) from the top left corner of the paper, y downwards, as in pictures. A plotting
library would round, add its version and the date; a calibration target must do neither.
"""

from dataclasses import dataclass
from typing import NamedTuple

_POINTS_PER_MM = 72 / 25.4
MADE_BY = "made by cvnotes target"  # by which the command knows its own sheets
_FONTS = ("Helvetica", "Helvetica-Bold", "Courier")


Places = tuple[tuple[float, float], ...]


class Line(NamedTuple):
    """A line from place to place, `width` millimetres wide; `grey` is 0 black, 1 white."""

    places: Places
    width: float = 0.2
    grey: float = 0.0


class Area(NamedTuple):
    """Polygons filled in one go.

    Drawn one by one, some viewers would move the sides of each upright rectangle to whole pixels.
    """

    polygons: tuple[Places, ...]
    grey: float = 0.0


class Text(NamedTuple):
    """A line of text whose baseline starts at (x, y); `size` is the font's, in millimetres."""

    x: float
    y: float
    text: str
    size: float = 3.0
    font: str = "Helvetica"
    grey: float = 0.0


def rectangle(x: float, y: float, width: float, height: float) -> Places:
    """Return the corners of an upright rectangle, from the top left one clockwise.

    Examples
    --------
    >>> rectangle(10, 20, 5, 3)
    ((10, 20), (15, 20), (15, 23), (10, 23))
    """
    right, bottom = x + width, y + height
    return (x, y), (right, y), (right, bottom), (x, bottom)


Shape = Line | Area | Text


@dataclass(frozen=True)
class Page:
    """What is on a sheet of paper of `size` (width, height) millimetres.

    Examples
    --------
    >>> page = Page("a black square", (100, 100), (Area((rectangle(10, 10, 25, 25),)),))
    >>> page.pdf()[:8]
    b'%PDF-1.4'
    >>> "35 10" in page.svg()
    True
    """

    title: str
    size: tuple[float, float]
    shapes: tuple[Shape, ...]

    def pdf(self) -> bytes:
        """Write the page as PDF that asks the viewer to print it unscaled.

        Notes
        -----
        The content is drawn in millimetres: one matrix at its head turns them into points of
        1/72 inch and flips y.
        """
        width, height = (_number(_POINTS_PER_MM * side) for side in self.size)
        scale = f"{_POINTS_PER_MM:.12f}"
        content = f"{scale} 0 0 -{scale} 0 {height} cm\n" + "".join(map(_pdf, self.shapes))
        stream = content.encode("cp1252")
        fonts = "".join(f" /F{i} {6 + i} 0 R" for i in range(len(_FONTS)))
        objects = [
            b"<< /Type /Catalog /Pages 2 0 R"
            b" /ViewerPreferences << /PrintScaling /None /PickTrayByPDFSize true >> >>",
            b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
            f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {width} {height}] /Contents 4 0 R"
            f" /Resources << /Font <<{fonts} >> >> >>".encode(),
            b"<< /Length %d >>\nstream\n%b\nendstream" % (len(stream), stream),
            b"<< /Title (%b) >>" % _pdf_string(self.title).encode("cp1252"),
        ]
        for font in _FONTS:
            objects.append(
                f"<< /Type /Font /Subtype /Type1 /BaseFont /{font}"
                " /Encoding /WinAnsiEncoding >>".encode()
            )
        return _pdf_file(objects)

    def svg(self) -> str:
        """Write the page as SVG, a user unit being a millimetre."""
        width, height = map(_number, self.size)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" '
            f'viewBox="0 0 {width} {height}">\n<!-- {MADE_BY} -->\n'
            f"<title>{_escaped(self.title)}</title>\n"
            f'<rect width="{width}" height="{height}" fill="#ffffff"/>\n'
            + "".join(map(_svg, self.shapes))
            + "</svg>\n"
        )


def _pdf(shape: Shape) -> str:
    """Return the drawing operators of one shape."""
    grey = _number(shape.grey)
    match shape:
        case Line(places, width):
            return f"{grey} G {_number(width)} w {_way(places)} S\n"
        case Area(polygons):
            return f"{grey} g {' '.join(f'{_way(places)} h' for places in polygons)} f\n"
        case Text(x, y, text, size, font):
            # The text matrix flips y once more, or the letters would stand on their heads.
            return (
                f"BT {grey} g /F{_FONTS.index(font)} {_number(size)} Tf "
                f"1 0 0 -1 {_numbers(x, y)} Tm ({_pdf_string(text)}) Tj ET\n"
            )


def _svg(shape: Shape) -> str:
    """Return the element of one shape."""
    grey = f"#{round(255 * shape.grey):02x}" + 2 * f"{round(255 * shape.grey):02x}"
    match shape:
        case Line(places, width):
            stroke = f'fill="none" stroke="{grey}" stroke-width="{_number(width)}"'
            return f'<polyline points="{_points(places)}" {stroke}/>\n'
        case Area(polygons):
            way = " ".join(f"M{_points(places)}Z" for places in polygons)
            return f'<path d="{way}" fill="{grey}"/>\n'
        case Text(x, y, text, size, font):
            family = "Courier, monospace" if font == "Courier" else "Helvetica, Arial, sans-serif"
            weight = ' font-weight="bold"' if font.endswith("Bold") else ""
            return (
                f'<text x="{_number(x)}" y="{_number(y)}" font-family="{family}"{weight} '
                f'font-size="{_number(size)}" fill="{grey}">{_escaped(text)}</text>\n'
            )


def _pdf_file(objects: list[bytes]) -> bytes:
    """Return each object its number, and list at the end where each begins."""
    file, starts = b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n%" + MADE_BY.encode() + b"\n", []
    for i, body in enumerate(objects, start=1):
        starts.append(len(file))
        file += b"%d 0 obj\n%b\nendobj\n" % (i, body)
    table = b"".join(b"%010d 00000 n \n" % start for start in starts)
    n = len(objects) + 1
    return file + (
        b"xref\n0 %d\n0000000000 65535 f \n%btrailer\n<< /Size %d /Root 1 0 R /Info 5 0 R >>\n"
        b"startxref\n%d\n%%%%EOF\n" % (n, table, n, len(file))
    )


def _pdf_string(text: str) -> str:
    for character in "\\()":
        text = text.replace(character, "\\" + character)
    return text


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _way(places: Places) -> str:
    """Return the operators of a path: move to the first place, on to the others."""
    first, *others = (_numbers(*place) for place in places)
    return f"{first} m " + " ".join(f"{place} l" for place in others)


def _points(places: Places) -> str:
    return " ".join(_numbers(*place) for place in places)


def _number(x: float) -> str:
    """Write a length in millimetres to the nanometre: no exponent, no idle zeros."""
    return f"{round(x, 6) + 0.0:.6f}".rstrip("0").rstrip(".")


def _numbers(*xs: float) -> str:
    return " ".join(map(_number, xs))
