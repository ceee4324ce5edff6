"""The head of every chapter: one corner of a board, and the four steps by which it gets a pixel."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, whole
from cvnotes.camera import Camera, intrinsics, look_at, move, px_from_xy, xy_from_px
from cvnotes.show.picture import Picture
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, INK, LENS, MUTED, WORLD

STEPS = ("R, T", "÷ z", "lens", "A")
# Which steps a chapter is about: those of the first page and of the last two are all. Chapter 5
# looks for the pixel itself. Chapters 6 and 7 go from the picture back to the world.
_LIT: dict[int, tuple[str, ...]] = {
    1: ("÷ z",), 2: ("R, T", "÷ z", "A"), 3: ("R, T", "A"), 4: ("lens",), 5: (),
    6: ("R, T", "÷ z", "A"), 8: ("lens", "A"),
}  # fmt: skip
_BACKWARDS = (6, 7)
_WIDE, _TALL, _GAP, _TOP = 138, 112, 52, 26  # px: a panel, the way to the next, what is above it
_STYLE = (
    "text{font:13px system-ui,sans-serif;text-anchor:middle;fill:#333}.s{font-weight:600}"
    # On a telephone larger letters take the room of the numbers, which are left out.
    "@media(max-width:520px){text{font-size:24px}.s{font-size:21px}.n{display:none}"
    "svg>g{transform:translateY(16px)}.t{transform:translateY(-6px)}}"
)


def one_corner(chapter: int) -> Picture:
    """Draw the way of one corner from the world to its pixel; the chapter's steps are lit.

    Parameters
    ----------
    chapter : int
        0 to 10.

    Examples
    --------
    >>> one_corner(4)
    One corner: world (200, 125, 0) mm, camera (99.6, 63.5, 283.1) mm, plane z = 1 (0.3519, 0.2243),
    behind the lens (0.3377, 0.2152), pixel (595.1, 411.0). Lit: lens
    """
    chapter = whole(chapter, "chapter", at_least=0, at_most=10)
    from cvnotes.pictures import course

    camera = course.camera().moved(look_at([125, 40, -285], [100, 62, 0]))
    W = np.concatenate([_dark_squares(25.0).reshape(-1, 3), [[200, 125, 0]]])
    M = move(camera.G, W)
    xy = M[:, :2] / M[:, 2:]
    seen = camera.lens.distort(xy)
    m = px_from_xy(camera.A, seen)
    frame = np.array([[0, 0], [640, 0], [640, 480], [0, 480], [0, 0]]) - 0.5
    border = xy_from_px(camera.A, frame)
    beside = Camera(intrinsics(1, 1, 0, 0), look_at([-520, -260, -330], [20, 10, 150]))
    eye = beside.project(np.zeros(3))
    cone = beside.project(120 * np.column_stack([border, np.ones(5)]))
    cone = np.concatenate([[leg for tip in cone[:4] for leg in (tip, eye)], cone])
    states = (
        ("world", W[:, :2], None, WORLD, "({:.0f}, {:.0f}, {:.0f})", W[-1]),
        ("camera", beside.project(M), cone, WORLD, "({:.1f}, {:.1f}, {:.1f})", M[-1]),
        ("z = 1", xy, border, IDEAL, "({:.4f}, {:.4f})", xy[-1]),
        ("behind the lens", seen, border, LENS, "({:.4f}, {:.4f})", seen[-1]),
        ("pixel", m, frame, LENS, "({:.1f}, {:.1f})", m[-1]),
    )
    lit = _LIT.get(chapter, STEPS)
    parts = [
        _panel(k * (_WIDE + _GAP), name, points, outline, colour, form.format(*numbers))
        for k, (name, points, outline, colour, form, numbers) in enumerate(states)
    ]
    parts += [_step(k, name, name in lit, chapter in _BACKWARDS) for k, name in enumerate(STEPS)]
    if chapter == 5:
        x = 4 * (_WIDE + _GAP) - 3
        parts.append(f'<path d="M{x} {_TOP - 4}h{_WIDE + 6}v{_TALL + 8}h{-_WIDE - 6}z" '
                     f'fill="none" stroke="{ESTIMATED}" stroke-width="2"/>')  # fmt: skip
    width, height = 5 * _WIDE + 4 * _GAP + 8, _TOP + _TALL + 24
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-4 0 {width} {height}" width="{width}" '
        f'height="{height}"><style>{_STYLE}</style><g>{"".join(parts)}</g></svg>'
    )
    said = [form.format(*numbers) for *_, form, numbers in states]
    alt = (
        f"One corner: world {said[0]} mm, camera {said[1]} mm, plane z = 1 {said[2]}, "
        f"behind the lens {said[3]}, pixel {said[4]}. Lit: {', '.join(lit) or 'the pixel'}"
        + (", backwards" if chapter in _BACKWARDS else "")
    )
    return Picture(svg.encode(), alt, width, "image/svg+xml")


def _dark_squares(side: float) -> Array:
    """Return the dark squares of the course's board, (35, 4, 3)."""
    first = [(i, j) for j in range(-1, 6) for i in range(-1, 9) if (i + j) % 2 == 0]
    corners = np.array(first)[:, None] + [[0, 0], [1, 0], [1, 1], [0, 1]]
    return np.concatenate([side * corners, np.zeros((len(first), 4, 1))], axis=2)


def _panel(
    left: int, name: str, points: Array, outline: Array | None, colour: str, numbers: str
) -> str:
    """Draw the board in one of its five states, and the corner that is followed."""
    everything = points if outline is None else np.concatenate([points, outline])
    low, high = everything.min(axis=0), everything.max(axis=0)
    scale = np.min([_WIDE, _TALL] / (high - low))
    shift = [left + _WIDE / 2, _TOP + _TALL / 2] - scale * (low + high) / 2
    (*board, (x, y)) = scale * points + shift
    squares = "".join(f"{_line(square)}z" for square in np.reshape(board, (-1, 4, 2)))
    middle = left + _WIDE // 2
    drawn = f'<path d="{squares}" fill="{colour}"/>'
    if outline is not None:
        border = _line(scale * outline + shift)
        if name == "pixel":  # what is beyond the picture is cut off
            path = f'<path d="{border}" fill="#eee"/>'
            drawn = (
                f'<clipPath id="cut">{path}</clipPath>{path}<g clip-path="url(#cut)">{drawn}</g>'
            )
        drawn += f'<path d="{border}" fill="none" stroke="{CAMERA}" stroke-width="1.5"/>'
    return (
        f"{drawn}"
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="{ESTIMATED}" stroke="white"/>'
        f'<text class="t" x="{middle}" y="16">{name}</text>'
        f'<text class="n" x="{middle}" y="{_TOP + _TALL + 18}">{numbers}</text>'
    )


def _line(points: npt.ArrayLike) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in np.asarray(points))


def _step(number: int, name: str, lit: bool, backwards: bool) -> str:
    """Draw an arrow between two panels."""
    left = number * (_WIDE + _GAP) + _WIDE + 7
    tip, end, y = left + _GAP - 14, left, _TOP + _TALL // 2
    if backwards:
        tip, end = end, tip
    back = 8 if tip < end else -8
    colour = ESTIMATED if lit else MUTED
    ink = INK.get(colour, colour)
    return (
        f'<path d="M{end} {y}H{tip}m{back} -6L{tip} {y}l{back} 6" fill="none" stroke="{colour}" '
        f'stroke-width="{3 if lit else 1}"/>'
        f'<text class="s" x="{(tip + end) // 2}" y="{y - 10}" style="fill:{ink}">{name}</text>'
    )
