"""The sheets of the further exercises and of the projects: a small drawing for each."""

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.show.picture import NARROW, Picture
from cvnotes.show.style import CAMERA, ESTIMATED, FAINT, LENS, MUTED, WORLD
from cvnotes.show.typeface import svg

_WIDE, _TALL, _GAP, _ABOVE, _LINE = 200, 140, 14, 26, 22
_PAGE = 856  # px: as wide are four tiles
_EYE = Camera(
    intrinsics(158, 158, 96, 58), look_at([3.4, -6.0, -5.6], [0.1, 0, -0.5], up=(0, 0, -1))
)


def eight_projects() -> Picture:
    """Draw the eight projects of the further exercises, four in a row, two on a telephone.

    Examples
    --------
    >>> eight_projects()
    Eight drawings: a poster straightened; a house with three edges drawn on; a cube on a board;
    a frame within a frame; a falling curve; a board with two shifted columns; a bent net; a cube
    in red and in cyan
    """
    tiles = (
        ("1 ★ A poster", _poster()), ("2 ★★ A building", _building()),
        ("3 ★★ A cube", _board() + _block(-1, -0.5, 2, 2, ("#F9C48A", "#F08A24", "#C96A0E"))),
        ("4 ★★ Zoom", _zoom()), ("5 ★★ How many pictures?", _curve()),
        ("6 ★★★ Your board", _columns()), ("7 ★★★ A very wide lens", _very_wide()),
        ("8 ★★★ Stereo", _pair()),
    )  # fmt: skip
    alt = (
        "Eight drawings: a poster straightened; a house with three edges drawn on; a cube on a "
        "board; a frame within a frame; a falling curve; a board with two shifted columns; a bent "
        "net; a cube in red and in cyan"
    )
    return _sheet(tiles, 4, alt, 15)


def exercise_map() -> Picture:
    """Draw a card for each section of the further exercises, with the tasks that stand in it.

    Examples
    --------
    >>> str(exercise_map())[:70]
    'Twelve cards. Projective space: 1 ★, A ★★. Vanishing points: B ★★. The'
    """
    tiles = (
        ("Projective space", _rails(), "1 ★", "A ★★"), ("Vanishing points", _poles(), "B ★★"),
        ("The camera model", _wedge(), "2 ★"), ("Lens distortion", _bent(), "3 ★★", "C ★★"),
        ("Calibration targets", _weighted(), "D ★★"), ("Homographies", _missed(), "4 ★"),
        ("Zhang’s calibration", _boards(), "5 ★★  6 ★★  7 ★★", "E ★★★  F ★★★"),
        ("Without a board", _turned(), "8 ★★★"), ("Many views", _arrow(), "9 ★★★"),
        ("Image warping", _pixels(), "10 ★★"),
        ("Your own camera", _telephone(), "11 ★★  12 ★★★", "G ★★★"),
        ("Two pictures", _diamond(), "13 ★★  14 ★★"),
    )  # fmt: skip
    named = (f"{name}: {', '.join('  '.join(tasks).split('  '))}." for name, _, *tasks in tiles)
    return _sheet(tiles, 6, f"Twelve cards. {' '.join(named)}", 21)


def _sheet(tiles: Sequence[tuple[str, ...]], columns: int, alt: str, size: int) -> Picture:
    """Draw tiles: over each its name, under it up to two lines; two in a row on a telephone."""
    below = _LINE * (max(map(len, tiles)) - 2)

    def sheet(columns: int, page: float) -> bytes:
        pitch, row = _WIDE + _GAP, _ABOVE + _TALL + below + _GAP
        width, height = columns * pitch - _GAP + 4, len(tiles) // columns * row
        drawn = ""
        for k, (name, drawing, *under) in enumerate(tiles):
            left, top = k % columns * pitch + 2, k // columns * row + _ABOVE
            words = (f'<text x="2" y="{_TALL + _LINE * (i + 1)}">{words}</text>'
                     for i, words in enumerate(under))  # fmt: skip
            drawn += (
                f'<g transform="translate({left} {top})"><text class="s" x="2" y="-8">{name}</text>'
                f'<clipPath id="tile{k}"><rect width="{_WIDE}" height="{_TALL}" rx="6"/></clipPath>'
                f'<g clip-path="url(#tile{k})" fill="none" stroke-linejoin="round">{drawing}</g>'
                f'<rect width="{_WIDE}" height="{_TALL}" rx="6" fill="none" stroke="{FAINT}"/>'
                f"{''.join(words)}</g>"
            )
        style = f"text{{font:{size}px cvnotes;fill:#333;white-space:pre}}.s{{font-weight:600}}"
        return svg(drawn, width, height, style=style, scale=page / width)

    return Picture(sheet(columns, _PAGE), alt, _PAGE, "image/svg+xml", sheet(2, NARROW))


def _line(points: npt.ArrayLike, stroke: str, width: float = 2) -> str:
    d = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in np.asarray(points, float))
    return f'<path d="{d}" stroke="{stroke}" stroke-width="{width}"/>'


def _face(points: npt.ArrayLike, fill: str, stroke: str = "none", width: float = 1) -> str:
    d = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in np.asarray(points, float)) + "Z"
    return f'<path d="{d}" fill="{fill}" stroke="{stroke}" stroke-width="{width}"/>'


def _seen(points: npt.ArrayLike) -> Array:
    """Return where the eye sees points of a board one unit wide, whose z axis points into it."""
    return _EYE.project(np.asarray(points, float))


def _square(x: float, y: float, side: float = 1, z: float = 0) -> Array:
    return np.array([[x, y, z], [x + side, y, z], [x + side, y + side, z], [x, y + side, z]])


def _block(x: float, y: float, side: float, high: float, inks: tuple[str, str, str]) -> str:
    """Draw a block that stands on the board: its top and the two sides towards the eye."""
    low, top = _square(x, y, side), _square(x, y, side, -high)
    sides = (top, np.array([*low[:2], *top[1::-1]]), np.array([*low[1:3], *top[2:0:-1]]))
    return "".join(
        _face(_seen(one), ink, "#333", 1.2) for one, ink in zip(sides, inks, strict=True)
    )


def _board(columns: int = 6, rows: int = 5) -> str:
    left, back = -columns / 2, -rows / 2
    corners = np.array([[left, back], [-left, back], [-left, -back], [left, -back]])
    sheet = np.column_stack([1.12 * corners, np.zeros(4)])
    dark = [(i, j) for j in range(rows) for i in range(columns) if (i + j) % 2 == 0]
    squares = (_face(_seen(_square(left + i, back + j)), "#444") for i, j in dark)
    return _face(_seen(sheet), "#fff", MUTED) + "".join(squares)


def _dot(x: float, y: float, ink: str, radius: float = 4.5) -> str:
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{ink}"/>'


def _upright(corners: npt.ArrayLike) -> Callable[[float, float, float, float, str], str]:
    """Return what draws a part of a wall; of its two upright sides the longer one is nearer."""
    a, b, c, d = np.asarray(corners, float)
    left, right = np.hypot(*(d - a)), np.hypot(*(c - b))

    def at(x: float, y: float) -> Array:
        s = x * left / (x * left + (1 - x) * right)  # the half that is nearer is the wider
        return np.asarray((1 - y) * ((1 - s) * a + s * b) + y * ((1 - s) * d + s * c))

    def part(x0: float, y0: float, x1: float, y1: float, ink: str) -> str:
        return _face([at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)], ink)

    return part


def _checks(part: Callable[..., str], columns: int, rows: int, ink: str) -> str:
    return "".join(part(i / columns, j / rows, (i + 1) / columns, (j + 1) / rows, ink)
                   for i in range(columns) for j in range(rows) if (i + j) % 2 == 0)  # fmt: skip


def _path(d: str, stroke: str, width: float, fill: str = "none") -> str:
    return f'<path d="{d}" stroke="{stroke}" stroke-width="{width}" fill="{fill}"/>'


def _poster() -> str:
    """Draw a poster seen from the side, and beside it straight on."""

    def poster(corners: npt.ArrayLike) -> str:
        part = _upright(corners)
        lines = (part(0.14, y, x, y + 0.04, MUTED) for y, x in ((0.7, 0.86), (0.8, 0.7)))
        return (_face(corners, "#fff", "#333", 2) + part(0.14, 0.1, 0.86, 0.58, CAMERA)
                + part(0.26, 0.22, 0.5, 0.58, LENS) + "".join(lines))  # fmt: skip

    arrow = _path("M97 70h20m-7 -7l7 7l-7 7", ESTIMATED, 3)
    return (poster([[22, 14], [80, 34], [80, 104], [22, 126]]) + arrow
            + poster([[128, 20], [184, 20], [184, 120], [128, 120]]))  # fmt: skip


def _building() -> str:
    """Draw a house, and its three directions."""
    near, left, right = ([92, 22], [92, 122]), ([18, 52], [18, 112]), ([184, 44], [184, 114])

    def wall(far: tuple[list[int], list[int]], ink: str, columns: int) -> str:
        part = _upright([near[0], far[0], far[1], near[1]])
        holes = (
            part(x, y, x + 0.5 / columns, y + 0.17, "#fff")
            for x in (np.arange(columns) + 0.25) / columns
            for y in (0.14, 0.42, 0.7)
        )
        return part(0, 0, 1, 1, ink) + "".join(holes)

    ways = (near, (near[0], left[0]), (near[0], right[0]))
    return (wall(left, "#B9C4CC", 3) + wall(right, "#D9E0E5", 4)
            + "".join(_line(way, ESTIMATED, 4) for way in ways))  # fmt: skip


def _zoom() -> str:
    """Draw a hill with a tree, and the frames of three zooms."""
    hill = _path("M0 112Q60 78 118 98T200 92V140H0Z", "none", 0, "#CFE3D6")
    tree = _path("M100 96V66", "#7A5230", 5) + _dot(100, 56, WORLD, 15)
    shown = "".join(
        f'<rect x="{100 - 92 * part / 0.9:.0f}" y="{70 - 62 * part / 0.9:.0f}" '
        f'width="{184 * part / 0.9:.0f}" height="{124 * part / 0.9:.0f}" '
        f'stroke="{ink}" stroke-width="{wide}"/>'
        for part, ink, wide in ((0.9, MUTED, 1.5), (0.52, LENS, 2), (0.26, ESTIMATED, 3))
    )
    return hill + tree + shown


def _curve() -> str:
    """Draw an error that falls like 1/√n, with bars at four numbers of pictures."""
    n = np.linspace(1, 40, 80)
    curve = np.column_stack([24 + 4.2 * n, 120 - 92 / np.sqrt(n)])
    axes = _line([[18, 14], [18, 122], [188, 122]], MUTED, 1.5)
    bars = ""
    for count in (3, 10, 20, 38):
        x, y, half = 24 + 4.2 * count, 120 - 92 / np.sqrt(count), 26 / np.sqrt(count)
        bars += _line([[x, y - half], [x, y + half]], ESTIMATED, 2.5)
        bars += _dot(x, y, ESTIMATED)
    return axes + _line(curve, LENS, 3) + bars


def _columns() -> str:
    """Draw a board, two of whose columns of corners are shifted."""
    dark = _checks(_upright([[20, 20], [180, 20], [180, 120], [20, 120]]), 8, 5, "#D4D4D4")
    shown = ""
    for x, ink, wide in ((40, LENS, 1.5), (60, LENS, 1.5), (87, ESTIMATED, 3), (100, LENS, 1.5),
                         (120, LENS, 1.5), (134, ESTIMATED, 3), (160, LENS, 1.5)):  # fmt: skip
        dots = "".join(_dot(x, y, ink, 3.5) for y in (40, 60, 80, 100))
        shown += _path(f"M{x} 26V114", ink, wide) + dots
    return dark + shown


def _net(bend: Callable[[Array], Array], width: float, ink: str = LENS) -> str:
    """Draw a net of straight lines ahead, whose points go to another distance from the middle."""
    lines, t = "", np.linspace(-6, 6, 61)
    for c in (-3, -1.2, -0.4, 0.4, 1.2, 3):
        for x, y in ((np.full_like(t, c), t), (t, np.full_like(t, c))):
            r = np.hypot(x, y)
            lines += _line((bend(r) / r * [x, y]).T + [100, 70], ink, width)
    return lines


def _very_wide() -> str:
    """Draw the net as a lens sees it whose picture is a disc."""
    return (f'<rect width="{_WIDE}" height="{_TALL}" fill="#222"/>{_dot(100, 70, "#F4F8FB", 64)}'
            + _net(lambda r: 40 * np.arctan(r), 1.6))  # fmt: skip


def _pair() -> str:
    """Draw the edges of a cube from two places: red and cyan."""
    low, high = _square(-1.6, -1.6, 3.2), _square(-1.6, -1.6, 3.2, -3.2)
    rings = [[ring[k], ring[(k + 1) % 4]] for ring in (low, high) for k in range(4)]
    edges = [*rings, *zip(low, high, strict=True)]
    drawn = ""
    for shift, ink in ((-7, "#E0402A"), (7, "#0FA3B1")):
        near = "".join(_line(_seen(edge) + [shift + 3, 22], ink, 2.5) for edge in edges)
        drawn += f'<g style="mix-blend-mode:multiply">{near}</g>'
    return drawn


def _rails() -> str:
    """Draw two rails, and the line through two points of one."""
    sleepers = (_line([[154 - 0.9 * v, v], [46 + 0.9 * v, v]], "#8A6A52", (v - 56) / 9)
                for v in (64, 70, 80, 95, 118))  # fmt: skip
    return (_path("M0 60H200V140H0Z", "none", 0, "#DCE8D6") + "".join(sleepers)
            + _path("M40 140L100 60L160 140", MUTED, 4) + _path("M40 140L145 0", ESTIMATED, 3)
            + _dot(55, 120, ESTIMATED, 6) + _dot(85, 80, ESTIMATED, 6))  # fmt: skip


def _poles() -> str:
    """Draw three poles that stand equally far apart, and the line on which their feet are."""
    drawn = _path("M0 60H200V140H0Z", "none", 0, "#DCE8D6") + _path("M20 132L170 60", ESTIMATED, 3)
    for z in (1, 2, 3, 4, 5):
        x, y, high = 170 - 138 / z, 60 + 66 / z, 116 / z
        drawn += _path(f"M{x:.0f} {y:.0f}v{-high:.0f}", "#7A5230", 2 + 5 / z)
        drawn += _dot(x, y, ESTIMATED, 6) if z < 4 else ""
    return drawn


def _weighted() -> str:
    """Draw three points with their scatter, and the line that heeds the certain ones more."""
    bars = "".join(_path(f"M{x} {y - half}v{2 * half}", LENS, 2) + _dot(x, y, LENS, 5)
                   for x, y, half in ((44, 98, 14), (96, 100, 14), (152, 42, 32)))  # fmt: skip
    return _line([[14, 120], [186, 52]], ESTIMATED, 3) + bars


def _wedge() -> str:
    """Draw from above what a camera sees, and its angle."""
    return (_path("M34 0L100 126L166 0", CAMERA, 3, "#DCEDF8")
            + _path("M72 26h18v18h-18zM112 44h18v18h-18z", "none", 0, WORLD)
            + _path("M18 60h18v18h-18zM168 36h18v18h-18z", "none", 0, FAINT)
            + _path("M77 82A50 50 0 0 1 123 82", ESTIMATED, 5))  # fmt: skip


def _bent() -> str:
    """Draw a net bent by a lens over the straight one."""
    return _net(lambda r: 30 * r, 1, MUTED) + _net(lambda r: 91 * np.arctan(0.33 * r), 2.5)


def _missed() -> str:
    """Draw a board, and by how much its corners are missed."""
    drawn = _checks(_upright([[10, 4], [190, 28], [190, 114], [10, 138]]), 4, 3, "#D4D4D4")
    for x, y, far in ((72, 51, 15), (120, 54, 24), (158, 55, 9),
                      (72, 91, 24), (120, 88, 10), (158, 87, 19)):  # fmt: skip
        way = far * np.array([np.cos(x + y), np.sin(x + y)])
        drawn += f'<circle cx="{x}" cy="{y}" r="{far}" stroke="{LENS}" stroke-width="2"/>'
        drawn += _path(f"M{x} {y}l{way[0]:.1f} {way[1]:.1f}", ESTIMATED, 3) + _dot(x, y, LENS, 4)
    return drawn


def _boards() -> str:
    """Draw three boards around a camera."""
    drawn = _path("M33 54L100 122V34M167 54L100 122", FAINT, 1.5)
    for x, end, high, low in ((14, 52, (20, 34), (84, 76)), (74, 126, (16, 16), (52, 52)),
                              (148, 186, (36, 20), (76, 86))):  # fmt: skip
        corners = [[x, high[0]], [end, high[1]], [end, low[1]], [x, low[0]]]
        drawn += _face(corners, "#fff", WORLD, 1.5) + _checks(_upright(corners), 4, 4, WORLD)
    return drawn + _path("M100 122L80 98H120Z", CAMERA, 3, "#DCEDF8")


def _turned() -> str:
    """Draw two pictures of a tree, taken by a turn on the spot."""
    return (_path("M20 34H124V112H20Z", LENS, 3, "#E7F0F7")
            + _path("M78 34L182 12V130L78 112Z", ESTIMATED, 3, "#F6D9C055")
            + _path("M101 102V74", "#7A5230", 5) + _dot(101, 64, WORLD, 16))  # fmt: skip


def _arrow() -> str:
    """Draw the arrow of many views: blocks on a diagonal, and what all share."""
    blocks = "".join(f"M{42 + 14 * i} {12 + 14 * i}h13v13h-13z" for i in range(9))
    shared = _path("M42 12H167V25H55V137H42Z", "none", 0, CAMERA)
    return shared + _path(blocks, "none", 0, LENS)


def _pixels() -> str:
    """Draw pixels, and a place between four of them."""
    levels = (68, 102, 187, 238, 102, 153, 221, 255, 170, 204, 238, 255)
    each = (_path(f"M{50 * (i % 4)} {47 * (i // 4)}h50v47h-50z", "none", 0, f"rgb({n},{n},{n})")
            for i, n in enumerate(levels))  # fmt: skip
    ways = _path("M75 23L112 40L125 23M75 70L112 40L125 70", ESTIMATED, 2)
    return "".join(each) + ways + _dot(112, 40, ESTIMATED, 7)


def _telephone() -> str:
    """Draw a telephone that photographs a board, and a number with its standard deviation."""
    board = _checks(_upright([[50, 36], [120, 36], [120, 92], [50, 92]]), 5, 4, "#444")
    return ('<rect x="24" y="18" width="122" height="92" rx="12" fill="#333"/>'
            + _path("M38 26H132V102H38Z", "none", 0, "#fff") + board
            + _path("M164 30V98M156 30h16m-16 68h16", ESTIMATED, 4)
            + _dot(164, 64, ESTIMATED, 7))  # fmt: skip


def _diamond() -> str:
    """Draw from above two cameras that see one point, each through a pixel."""
    return (_path("M60 126L106 8H136ZM140 126L94 8H64Z", "none", 0, "#56B4E955")
            + _path("M100 23L109.8 49L100 64L90.2 49Z", "none", 0, ESTIMATED)
            + _path("M60 128l-11-18h22zM140 128l-11-18h22z", CAMERA, 3, "#fff"))  # fmt: skip
