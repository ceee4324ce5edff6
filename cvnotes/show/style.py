"""How the course's figures look: five colours with one meaning each, markers, sizes.

The colours are those of Okabe and Ito, chosen so that any two that meet in a figure stay apart
for readers with red or green blindness too; each meaning also has its own marker.
"""

from collections.abc import Iterable
from functools import lru_cache

from cvnotes.base import CvnotesError

WORLD = "#009E73"
CAMERA = "#56B4E9"
IDEAL = "#000000"
LENS = "#0072B2"
ESTIMATED = "#D55E00"

COLOURS = {"world": WORLD, "camera": CAMERA, "ideal": IDEAL, "lens": LENS, "estimated": ESTIMATED}
# The same hues for words, dark enough to be read on white: at least 4.5 : 1 (WCAG 2.2 AA).
INK = {WORLD: "#00805D", CAMERA: "#2279AD", ESTIMATED: "#BC5200"}
MARKERS = {"world": "s", "camera": "^", "ideal": "+", "lens": "o", "estimated": "x"}
MUTED = "#6E6E6E"  # frames of photographs, remarks
FAINT = "#C6C6C6"  # frames of all that is drawn

DPI = 100  # a figure's inch is 100 px of the page
FONT = 9.5  # as large as in explorations


def colour_of(meaning: str) -> str:
    """Return the course's colour of a meaning.

    Examples
    --------
    >>> colour_of("ideal")
    '#000000'
    """
    if meaning not in COLOURS:
        raise CvnotesError(f"meaning: expected one of {', '.join(COLOURS)}, got {meaning!r}")
    return COLOURS[meaning]


def hexed(levels: Iterable[float]) -> str:
    """Return red, green and blue from 0 to 255, cut to whole levels, as a colour like those above.

    Examples
    --------
    >>> hexed((0, 51.9, 255))
    '#0033FF'
    """
    return "#{:02X}{:02X}{:02X}".format(*map(int, levels))


@lru_cache(maxsize=4096)  # a picture that is drawn again has the same colours
def mixed(colour: str, other: str, part: float) -> str:
    """Return a colour that lies so far, from 0 to 1, on the way to another one.

    Examples
    --------
    >>> mixed("#000000", "#FFFFFF", 0.2)
    '#333333'
    """
    ends = zip(rgb(colour), rgb(other), strict=True)
    return hexed(255 * ((1 - part) * a + part * b) for a, b in ends)


def rgb(colour: str) -> tuple[float, float, float]:
    """Return one of the colours above as red, green and blue from 0 to 1.

    Examples
    --------
    >>> rgb("#0033FF")
    (0.0, 0.2, 1.0)
    """
    red, green, blue = bytes.fromhex(colour[1:])
    return red / 255, green / 255, blue / 255
