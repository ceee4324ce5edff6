"""The sheets of the further exercises and of the projects: for each a part of an exploration."""

import base64
import io
from collections.abc import Sequence

from PIL import Image

from cvnotes.show import explorations
from cvnotes.show.picture import NARROW, Picture
from cvnotes.show.style import FAINT
from cvnotes.show.typeface import svg

_WIDE, _TALL, _GAP, _ABOVE, _LINE = 200, 140, 14, 26, 22
_PAGE = 856  # px: as wide are four tiles
_Tile = tuple[str, tuple[str, int, int, int], *tuple[str, ...]]


def eight_projects() -> Picture:
    """Draw the eight projects of the further exercises, four in a row, two on a telephone.

    Examples
    --------
    >>> eight_projects()
    Eight pictures: a poster on a wall; a box, its edges extended; a tower on a board; a room; four
    standard deviations; a crooked sheet; a room as a disc; a room in red and cyan
    """
    tiles: tuple[_Tile, ...] = (
        ("1 ★ A poster", ("poster", 3, 60, 420)), ("2 ★★ A building", ("triangle", 154, 80, 260)),
        ("3 ★★ A cube", ("cube", 60, 110, 400)), ("4 ★★ Zoom", ("zoom", 530, 30, 360)),
        ("5 ★★ How many pictures?", ("nails", 512, 24, 352)),
        ("6 ★★★ Your board", ("sheets", 366, 33, 308)),
        ("7 ★★★ A very wide lens", ("rim", 2, 82, 440)),
        ("8 ★★★ Stereo", ("depth", 3, 24, 400)),
    )  # fmt: skip
    alt = (
        "Eight pictures: a poster on a wall; a box, its edges extended; a tower on a board; "
        "a room; four standard deviations; a crooked sheet; a room as a disc; "
        "a room in red and cyan"
    )
    return _sheet(tiles, 4, alt, 15)


def exercise_map() -> Picture:
    """Draw a card for each section of the further exercises, with the tasks that stand in it.

    Examples
    --------
    >>> str(exercise_map())[:70]
    'Twelve cards. Projective space: 1 ★, A ★★. Vanishing points: B ★★. The'
    """
    tiles: tuple[_Tile, ...] = (
        ("Projective space", ("conic", 410, 60, 390), "1 ★", "A ★★"),
        ("Vanishing points", ("parallel", 3, 24, 430), "B ★★"),
        ("The camera model", ("dolly", 3, 30, 430), "2 ★"),
        ("Lens distortion", ("decentred", 3, 60, 450), "3 ★★", "C ★★"),
        ("Calibration targets", ("votes", 490, 90, 300), "D ★★"),
        ("Homographies", ("homography", 20, 42, 346), "4 ★"),
        ("Zhang’s calibration", ("nails", 3, 24, 505), "5 ★★  6 ★★  7 ★★", "E ★★★  F ★★★"),
        ("Without a board", ("seam", 3, 24, 440), "8 ★★★"),
        ("Many views", ("imitation", 3, 60, 440), "9 ★★★"),
        ("Image warping", ("asks", 370, 30, 360), "10 ★★"),
        ("Your own camera", ("eleventh", 3, 50, 500), "11 ★★  12 ★★★", "G ★★★"),
        ("Two pictures", ("disparity", 75, 158, 290), "13 ★★  14 ★★"),
    )  # fmt: skip
    named = (f"{name}: {', '.join('  '.join(tasks).split('  '))}." for name, _, *tasks in tiles)
    return _sheet(tiles, 6, f"Twelve cards. {' '.join(named)}", 21)


def _part(pixels: int, name: str, left: int, top: int, width: int) -> str:
    """Return a part of an exploration's picture, so many pixels wide, for a tile of an SVG."""
    box = left, top, left + width, top + width * _TALL // _WIDE
    part = Image.fromarray(explorations.model(name).picture()).crop(box)
    part = part.resize((pixels, pixels * _TALL // _WIDE), Image.Resampling.LANCZOS)
    part.save(packed := io.BytesIO(), "webp", quality=65)
    data = base64.b64encode(packed.getvalue()).decode()
    return f'<image width="{_WIDE}" height="{_TALL}" href="data:image/webp;base64,{data}"/>'


def _sheet(tiles: Sequence[_Tile], columns: int, alt: str, size: int) -> Picture:
    """Draw tiles: over each its name, under it up to two lines; two in a row on a telephone."""
    below = _LINE * (max(map(len, tiles)) - 2)
    parts = [_part(3 * _PAGE // (2 * columns), *part) for _, part, *_ in tiles]

    def sheet(columns: int, page: float) -> bytes:
        pitch, row = _WIDE + _GAP, _ABOVE + _TALL + below + _GAP
        width, height = columns * pitch - _GAP + 4, len(tiles) // columns * row
        drawn = ""
        for k, ((name, _, *under), part) in enumerate(zip(tiles, parts, strict=True)):
            left, top = k % columns * pitch + 2, k // columns * row + _ABOVE
            words = (f'<text x="2" y="{_TALL + _LINE * (i + 1)}">{words}</text>'
                     for i, words in enumerate(under))  # fmt: skip
            drawn += (
                f'<g transform="translate({left} {top})"><text class="s" x="2" y="-8">{name}</text>'
                f'<clipPath id="tile{k}"><rect width="{_WIDE}" height="{_TALL}" rx="6"/></clipPath>'
                f'<g clip-path="url(#tile{k})">{part}</g>'
                f'<rect width="{_WIDE}" height="{_TALL}" rx="6" fill="none" stroke="{FAINT}"/>'
                f"{''.join(words)}</g>"
            )
        style = f"text{{font:{size}px cvnotes;fill:#333;white-space:pre}}.s{{font-weight:600}}"
        return svg(drawn, width, height, style=style, scale=page / width)

    return Picture(sheet(columns, _PAGE), alt, _PAGE, "image/svg+xml", sheet(2, NARROW))
