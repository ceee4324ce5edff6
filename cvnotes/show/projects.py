"""The sheet of the eight projects: a small drawing for each."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.show.picture import NARROW, Picture
from cvnotes.show.style import CAMERA, ESTIMATED, FAINT, LENS, MUTED, WORLD
from cvnotes.show.typeface import svg

_WIDE, _TALL, _GAP, _ABOVE = 200, 140, 14, 26
_STYLE = ".s{font:600 15px cvnotes;fill:#333}"
_EYE = Camera(
    intrinsics(158, 158, 96, 58), look_at([3.4, -6.0, -5.6], [0.1, 0, -0.5], up=(0, 0, -1))
)
_NAMES = (
    "1 ★ A poster", "2 ★★ A building", "3 ★★ A cube", "4 ★★ Zoom",
    "5 ★★ How many pictures?", "6 ★★★ Your board", "7 ★★★ A very wide lens", "8 ★★★ Stereo",
)  # fmt: skip


def eight_projects() -> Picture:
    """Draw the eight projects of the further exercises, four in a row, two on a telephone.

    Examples
    --------
    >>> eight_projects()
    Eight drawings: a poster straightened; a house with three edges drawn on; a cube on a board;
    a frame within a frame; a falling curve; a board with two shifted columns; a bent net; a cube
    in red and in cyan
    """
    drawn = (
        _poster(), _building(), _cube(), _zoom(), _curve(), _columns(), _very_wide(), _pair(),
    )  # fmt: skip

    def sheet(columns: int, scale: float) -> bytes:
        pitch, row = _WIDE + _GAP, _ABOVE + _TALL + _GAP
        width, height = columns * pitch - _GAP + 4, len(drawn) // columns * row
        tiles = [
            f'<g transform="translate({k % columns * pitch + 2} {k // columns * row + _ABOVE})">'
            f'<text class="s" x="2" y="-8">{_NAMES[k]}</text>'
            f'<clipPath id="tile{k}"><rect width="{_WIDE}" height="{_TALL}" rx="6"/></clipPath>'
            f'<g clip-path="url(#tile{k})" fill="none" stroke-linejoin="round">{each}</g>'
            f'<rect width="{_WIDE}" height="{_TALL}" rx="6" fill="none" stroke="{FAINT}"/></g>'
            for k, each in enumerate(drawn)
        ]
        return svg("".join(tiles), width, height, style=_STYLE, scale=scale)

    alt = (
        "Eight drawings: a poster straightened; a house with three edges drawn on; a cube on a "
        "board; a frame within a frame; a falling curve; a board with two shifted columns; a bent "
        "net; a cube in red and in cyan"
    )
    wide = 4 * (_WIDE + _GAP) - _GAP + 4
    return Picture(sheet(4, 1), alt, wide, "image/svg+xml", sheet(2, NARROW / 418))


def _line(points: npt.ArrayLike, stroke: str, width: float = 2, more: str = "") -> str:
    d = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in np.asarray(points, float))
    return f'<path d="{d}" stroke="{stroke}" stroke-width="{width}" {more}/>'


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


def _poster() -> str:
    """Draw a poster seen from the side, and beside it straight on."""

    def poster(corners: npt.ArrayLike) -> str:
        a, b, c, d = np.asarray(corners, float)

        def at(x: float, y: float) -> Array:
            w = np.array([1, np.hypot(*(d - a)) / np.hypot(*(c - b))])  # nearer is larger
            s = x * w[0] / (x * w[0] + (1 - x) * w[1])
            return np.asarray((1 - y) * ((1 - s) * a + s * b) + y * ((1 - s) * d + s * c))

        def part(x0: float, y0: float, x1: float, y1: float, ink: str) -> str:
            return _face([at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)], ink)

        lines = (part(0.14, y, x, y + 0.04, MUTED) for y, x in ((0.7, 0.86), (0.8, 0.7)))
        return (_face([a, b, c, d], "#fff", "#333", 2) + part(0.14, 0.1, 0.86, 0.58, CAMERA)
                + part(0.26, 0.22, 0.5, 0.58, LENS) + "".join(lines))  # fmt: skip

    arrow = _line([[97, 70], [117, 70]], ESTIMATED, 3) + _line([[110, 63], [117, 70], [110, 77]],
                                                              ESTIMATED, 3)  # fmt: skip
    return (poster([[22, 14], [80, 34], [80, 104], [22, 126]]) + arrow
            + poster([[128, 20], [184, 20], [184, 120], [128, 120]]))  # fmt: skip


def _building() -> str:
    """Draw a house, and its three directions."""
    near = [[92, 22], [92, 122]]
    left, right = [[18, 52], [18, 112]], [[184, 44], [184, 114]]

    def wall(a: npt.ArrayLike, b: npt.ArrayLike, ink: str, columns: int) -> str:
        (a0, a1), (b0, b1) = np.array(a, float), np.array(b, float)

        def at(x: float, y: float) -> Array:
            near, far = np.hypot(*(a1 - a0)), np.hypot(*(b1 - b0))
            s = x * far / (x * far + (1 - x) * near)
            s = x * near / (x * near + (1 - x) * far) if far > near else s
            return np.asarray((1 - y) * ((1 - s) * a0 + s * b0) + y * ((1 - s) * a1 + s * b1))

        holes = [
            _face([at(x, y), at(x + w, y), at(x + w, y + 0.17), at(x, y + 0.17)], "#fff")
            for w in [0.5 / columns]
            for x in (np.arange(columns) + 0.25) / columns
            for y in (0.14, 0.42, 0.7)
        ]
        return _face([a0, b0, b1, a1], ink) + "".join(holes)

    ways = (near, [near[0], left[0]], [near[0], right[0]])
    return (wall(near, left, "#B9C4CC", 3) + wall(near, right, "#D9E0E5", 4)
            + "".join(_line(way, ESTIMATED, 4) for way in ways))  # fmt: skip


def _cube() -> str:
    """Draw a cube that stands on a board."""
    return _board() + _block(-1, -0.5, 2, 2, ("#F9C48A", "#F08A24", "#C96A0E"))


def _zoom() -> str:
    """Draw a hill with a tree, and the frames of three zooms."""
    hill = '<path d="M0 112Q60 78 118 98T200 92V140H0Z" fill="#CFE3D6"/>'
    tree = (f'<path d="M100 96V66" stroke="#7A5230" stroke-width="5"/>'
            f'<circle cx="100" cy="56" r="15" fill="{WORLD}"/>')  # fmt: skip
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
        bars += f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{ESTIMATED}"/>'
    return axes + _line(curve, LENS, 3) + bars


def _columns() -> str:
    """Draw a board, two of whose columns of corners are shifted."""
    dark = "".join(
        f'<rect x="{20 + 20 * i}" y="{20 + 20 * j}" width="20" height="20" fill="#D4D4D4"/>'
        for j in range(5) for i in range(8) if (i + j) % 2 == 0
    )  # fmt: skip
    rows = 40 + 20 * np.arange(4)
    shown = ""
    for i in range(7):
        shift, ink = {2: (7, ESTIMATED), 5: (-6, ESTIMATED)}.get(i, (0, LENS))
        x = 40 + 20 * i + shift
        shown += _line([[x, 26], [x, 114]], ink, 3 if shift else 1.5)
        shown += "".join(f'<circle cx="{x}" cy="{y}" r="3.5" fill="{ink}"/>' for y in rows)
    return dark + shown


def _very_wide() -> str:
    """Draw a net of straight lines ahead, as a lens sees it whose picture is a disc."""
    lines = []
    t = np.linspace(-6, 6, 61)
    for c in (-3, -1.2, -0.4, 0.4, 1.2, 3):
        for x, y in ((np.full_like(t, c), t), (t, np.full_like(t, c))):
            r = np.hypot(x, y)
            far = 40 * np.arctan(r) / np.maximum(r, 1e-9)
            lines.append(np.column_stack([100 + far * x, 70 + far * y]))
    net = "".join(_line(line, LENS, 1.6) for line in lines)
    return (f'<rect width="{_WIDE}" height="{_TALL}" fill="#222"/>'
            f'<circle cx="100" cy="70" r="64" fill="#F4F8FB"/>{net}')  # fmt: skip


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
