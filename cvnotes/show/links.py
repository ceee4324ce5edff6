"""The strip of chapter 7: the links from corners to a camera, and what was measured at each."""

from typing import NamedTuple

from cvnotes.base import CvnotesError
from cvnotes.show.picture import Picture
from cvnotes.show.style import ESTIMATED, FAINT, INK, LENS, MUTED, WORLD
from cvnotes.show.typeface import svg


class _Link(NamedTuple):
    """A box of the strip: its name, what stands under it once it is measured, and its drawing."""

    name: str
    number: str
    remark: str
    drawing: str


def _path(d: str, more: str = "") -> str:
    return f'<path d="{d}" {more}/>'


def _dots(centres: list[tuple[float, float]], radius: float = 2.2, colour: str = LENS) -> str:
    each = (f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}"/>' for x, y in centres)
    return f'<g fill="{colour}" stroke="none">{"".join(each)}</g>'


def _cross(x: float, y: float) -> str:
    return _path(f"M{x - 4} {y - 4}l8 8m0 -8l-8 8", f'stroke="{ESTIMATED}" stroke-width="2.5"')


_DASHED = 'stroke-dasharray="3 3"'
# The numbers are those of chapter 7's twelve photographs. The drawings are 74 × 50 px.
_LINKS = (
    _Link("corners", "0.008 px", "RMS error",
          _dots([(37 + (5.5 + j) * i, 13 + 12 * j) for j in range(3) for i in (-3, -1, 1, 3)])),
    _Link("H", "87° to 93°", "true: 90°",
          _path("M12 42L27 20H47L62 42ZM29 42L34 20M45 42L40 20M20 30H54")
          + _path("M27 20L37 6L47 20M34 20L37 6L40 20", _DASHED) + _dots([(37, 6)], 3)),
    _Link("B", "24 rows", "4 unknowns",
          _path("M8 39H66", _DASHED)
          + _path("M11 39L37 13L63 39M31 19l6 6l6 -6", f'stroke="{LENS}"')
          + _dots([(11, 39), (63, 39)], 3)),
    _Link("A", "12 px off", "u₀ and v₀",
          _path("M20 8H15V42H20M54 8H59V42H54")
          + _dots([(25, 14), (49, 14), (37, 25), (49, 25), (49, 36)], 3.2)
          + _dots([(37, 14), (25, 25), (25, 36), (37, 36)], 1.3, MUTED)),
    _Link("poses", "up to 31 mm", "off",
          f'<g fill="#fff" stroke="{WORLD}">'
          + _path("M8 14L24 8L28 28L11 31Z") + _path("M45 9L66 13L62 32L43 26Z")
          + _path("M22 25L48 20L51 39L24 44Z") + "</g>"),
    _Link("lens", "k₁ = +0.09", "true: −0.25",
          _path("M17 10Q37 4 57 10Q62 25 57 40Q37 46 17 40Q12 25 17 10Z"
                "M30 7.5Q28 25 30 42.5M44 7.5Q46 25 44 42.5M15 19Q37 16 59 19M15 31Q37 34 59 31")),
    _Link("all at once", "0.008 px", "RMS",
          "".join(f'<circle cx="37" cy="25" r="{r}" fill="none"/>' for r in (19, 11))
          + _cross(37, 25)),
    _Link("±", "800.05 ± 0.04", "αᵤ, true: 800",
          _path("M33 6V44", _DASHED) + _path("M12 25H62M12 18v14M62 18v14", f'stroke="{ESTIMATED}"')
          + _cross(38, 25)),
)  # fmt: skip
_WIDE, _TALL, _GAP = 74, 50, 25
_ABOVE, _BELOW = 22, 36
_STYLE = (
    "text{font:13.5px cvnotes;text-anchor:middle;fill:#333}.s{font-weight:600}"
    ".r{fill:#6E6E6E}.narrow text{font-size:12.5px}"
)


def chain(*lit: str) -> Picture:
    """Draw the links from corners to a camera; each has its number once it has been measured.

    Parameters
    ----------
    *lit : str
        The links that are worked on: they are lit, and those after them are still pale. Without
        any, all have been measured.

    Examples
    --------
    >>> chain("H")
    From corners to a camera: corners 0.008 px RMS error, H lit; to come: B, A, poses, lens, all at
    once, ±
    """
    names = [link.name for link in _LINKS]
    if unknown := [name for name in lit if name not in names]:
        raise CvnotesError(f"lit: expected some of {', '.join(names)}, got {unknown[0]!r}")
    at = [names.index(name) for name in lit]
    done = min(at, default=len(names))
    said = [" ".join(link[:3]) for link in _LINKS[:done]] + [f"{name} lit" for name in lit]
    alt = f"From corners to a camera: {', '.join(said)}"
    if lit and (later := names[max(at) + 1 :]):
        alt += f"; to come: {', '.join(later)}"

    def drawn(columns: int, gap: int, kind: str) -> bytes:
        width = columns * (_WIDE + gap) - gap + 20
        height = len(_LINKS) // columns * (_ABOVE + _TALL + _BELOW)
        parts = [_box(k, columns, gap, k < done, k in at) for k in range(len(_LINKS))]
        body = f'<g class="{kind}">{"".join(parts)}</g>'
        return svg(body, width, height, style=_STYLE, left=-10)

    width = 8 * (_WIDE + _GAP) - _GAP + 20
    return Picture(drawn(8, _GAP, "wide"), alt, width, "image/svg+xml", drawn(4, 18, "narrow"))


def _box(number: int, columns: int, gap: int, done: bool, lit: bool) -> str:
    """Draw a link: its name, its box with the arrow to it, and under it its number."""
    link, (row, column) = _LINKS[number], divmod(number, columns)
    left, top = column * (_WIDE + gap), row * (_ABOVE + _TALL + _BELOW) + _ABOVE
    ink = INK[ESTIMATED] if lit else "#333" if done else MUTED
    edge, thick = (ESTIMATED, 3) if lit else (MUTED if done else FAINT, 1)
    middle, y = left + _WIDE // 2, top + _TALL // 2
    arrow = f"M{left - gap + 4} {y}H{left - 5}m-6 -5l6 5l-6 5" if column else ""
    under = (link.number, link.remark) if done else ("?", "") if lit else ("", "")
    return (
        f'<path d="{arrow}" fill="none" stroke="{MUTED if done or lit else FAINT}"/>'
        f'<g transform="translate({left} {top})" fill="none" stroke="#333" stroke-width="1.3" '
        f'opacity="{1 if done or lit else 0.35}">'
        f'<rect width="{_WIDE}" height="{_TALL}" rx="6" fill="#fff" stroke="{edge}" '
        f'stroke-width="{thick}"/>{link.drawing}</g>'
        f'<text class="s" x="{middle}" y="{top - 8}" style="fill:{ink}">{link.name}</text>'
        f'<text class="n" x="{middle}" y="{top + _TALL + 17}">{under[0]}</text>'
        f'<text class="r" x="{middle}" y="{top + _TALL + 31}">{under[1]}</text>'
    )
