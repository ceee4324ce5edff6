"""The head of every chapter: one corner of a board, and the four steps by which it gets a pixel."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, whole
from cvnotes.camera import Camera, intrinsics, look_at, move, px_from_xy, xy_from_px
from cvnotes.show.picture import Picture
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, INK, LENS, MUTED, WORLD
from cvnotes.show.typeface import svg

STEPS = ("R, T", "÷ z", "lens", "A")
_IN_WORDS = ("place", "divide", "bend", "pixels")  # below the arrows, where a reader is new
# Which steps a chapter is about: those of the first page and of chapter 9 are all. Chapters 6 and 7
# go from the picture back to the world, and chapter 10 finds the depth again by which was divided.
_LIT: dict[int, tuple[str, ...]] = {
    1: ("÷ z",), 2: ("R, T", "÷ z", "A"), 3: ("R, T", "÷ z", "A"), 4: ("lens",), 5: (),
    6: ("R, T", "÷ z", "A"), 8: ("lens", "A"), 10: ("÷ z",), 11: (),
}  # fmt: skip
_BOXED = {5: (4, "the pixel"), 11: (0, "the world")}  # no step, but where the way ends or begins
_BACKWARDS = (6, 7, 10)
_WITHOUT_LENS = (2, 3)  # their cameras have none, so their corner goes by another pixel
_STYLE = (
    "text{font:14px cvnotes;text-anchor:middle;fill:#333}.s{font-weight:600}"
    ".narrow text{font-size:13px}.narrow .n{font-size:12px}"
)


class _Layout(NamedTuple):
    """How large a panel is, the way to the next one, and how many stand in a row; px."""

    wide: int
    tall: int
    gap: int
    columns: int
    above: int = 26  # for the name
    below: int = 24  # for the numbers

    def place(self, number: int) -> Array:
        """Return the top left corner of a panel; a second row begins with the arrow to it."""
        row, column = divmod(number, self.columns)
        left = column * (self.wide + self.gap) + row * self.gap
        return np.array([left, row * (self.above + self.tall + self.below) + self.above])

    @property
    def size(self) -> tuple[int, int]:
        rows = -(-5 // self.columns)
        width = self.columns * (self.wide + self.gap) - self.gap
        return width, rows * (self.above + self.tall + self.below)


_STRIP, _TELEPHONE = _Layout(138, 112, 52, 5), _Layout(94, 82, 42, 3)


def one_corner(chapter: int) -> Picture:
    """Draw the way of one corner from the world to its pixel; the chapter's steps are lit.

    Parameters
    ----------
    chapter : int
        From 0 to the last one.

    Examples
    --------
    >>> one_corner(4)
    One corner: world (200, 125, 0) mm, camera (104.7, 47.1, 415.6) mm, plane z = 1 (0.252, 0.113),
    behind the lens (0.247, 0.111), pixel (523, 327). Lit: lens
    """
    chapter = whole(chapter, "chapter", at_least=0, at_most=max(_LIT))
    from cvnotes.pictures import course

    camera = course.camera().moved(course.first_pose())
    W = np.concatenate([_dark_squares(25.0).reshape(-1, 3), [[200, 125, 0]]])
    M = move(camera.G, W)
    xy = M[:, :2] / M[:, 2:]
    bare = chapter in _WITHOUT_LENS
    behind, seen = ("no lens", xy) if bare else ("behind the lens", camera.lens.distort(xy))
    m = px_from_xy(camera.A, seen)
    frame = np.array([[0, 0], [640, 0], [640, 480], [0, 480], [0, 0]]) - 0.5
    border = xy_from_px(camera.A, frame)
    beside = Camera(intrinsics(1, 1, 0, 0), look_at([-420, -260, -420], [20, 10, 150]))
    eye = beside.project(np.zeros(3))
    cone = beside.project(120 * np.column_stack([border, np.ones(5)]))
    cone = np.concatenate([[leg for tip in cone[:4] for leg in (tip, eye)], cone])
    # So many digits that each step, with the numbers that are written, gives the next ones.
    states = (
        ("world", W[:, :2], None, WORLD, "({:.0f}, {:.0f}, {:.0f}) mm".format(*W[-1])),
        ("camera", beside.project(M), cone, WORLD, "({:.1f}, {:.1f}, {:.1f}) mm".format(*M[-1])),
        ("z = 1", xy, border, IDEAL, "({:.3f}, {:.3f})".format(*xy[-1])),
        (behind, seen, border, LENS, "({:.3f}, {:.3f})".format(*seen[-1])),
        ("pixel", m, frame, LENS, "({:.0f}, {:.0f})".format(*m[-1])),
    )
    lit = _LIT.get(chapter, STEPS)

    def drawn(layout: _Layout, kind: str) -> bytes:
        parts = [_panel(layout, k, *state) for k, state in enumerate(states)]
        backwards = chapter in _BACKWARDS
        at_once = chapter == 6 and layout is _STRIP  # H: all steps but the lens in one
        shown = () if at_once else lit
        parts += [
            _step(layout, k, name, name in shown, backwards, bare and name == "lens")
            + (_below_step(layout, k) if chapter == 0 else "")
            for k, name in enumerate(STEPS)
        ]
        if chapter in _BOXED:
            x, y = layout.place(_BOXED[chapter][0]) - [3, 4]
            parts.append(f'<path d="M{x} {y}h{layout.wide + 6}v{layout.tall + 8}'
                         f'h{-layout.wide - 6}z" fill="none" stroke="{ESTIMATED}" '
                         'stroke-width="2"/>')  # fmt: skip
        width, height = layout.size
        if at_once:
            height += 34
            parts.append(_back_to_the_world(layout))
        body = f'<g class="{kind}">{"".join(parts)}</g>'
        return svg(body, width + 8, height, style=_STYLE, left=-4)

    said = [numbers for *_, numbers in states]
    shines = ", ".join(lit) or _BOXED[chapter][1]
    alt = (
        f"One corner: world {said[0]}, camera {said[1]}, plane z = 1 {said[2]}, "
        f"{behind} {said[3]}, pixel {said[4]}. Lit: {shines}"
        + (", backwards" if chapter in _BACKWARDS else "")
    )
    width = _STRIP.size[0] + 8
    strip, narrow = drawn(_STRIP, "wide"), drawn(_TELEPHONE, "narrow")
    return Picture(strip, alt, width, "image/svg+xml", narrow)


def _dark_squares(side: float) -> Array:
    """Return the dark squares of the course's board, (35, 4, 3)."""
    first = [(i, j) for j in range(-1, 6) for i in range(-1, 9) if (i + j) % 2 == 0]
    corners = np.array(first)[:, None] + [[0, 0], [1, 0], [1, 1], [0, 1]]
    return np.concatenate([side * corners, np.zeros((len(first), 4, 1))], axis=2)


def _panel(
    layout: _Layout, k: int, name: str, points: Array, outline: Array | None, ink: str, said: str
) -> str:
    """Draw the board in one of its five states, and the corner that is followed."""
    everything = points if outline is None else np.concatenate([points, outline])
    low, high = everything.min(axis=0), everything.max(axis=0)
    room = np.array([layout.wide, layout.tall])
    left, top = layout.place(k)
    scale = np.min(room / (high - low))
    shift = [left, top] + room / 2 - scale * (low + high) / 2
    (*board, (x, y)) = scale * points + shift
    squares = "".join(f"{_line(square)}z" for square in np.reshape(board, (-1, 4, 2)))
    middle = left + layout.wide // 2
    drawn = f'<path d="{squares}" fill="{ink}"/>'
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
        f'<text class="t" x="{middle}" y="{top - 10}">{name}</text>'
        f'<text class="n" x="{middle}" y="{top + layout.tall + 18}">{said}</text>'
    )


def _back_to_the_world(layout: _Layout) -> str:
    """Draw the way from the pixel to the board by a homography's inverse, under all panels."""
    end, start = (round(layout.place(k)[0]) + layout.wide // 2 for k in (0, 4))
    top = layout.size[1] + 2
    return (
        f'<path d="M{start} {top}V{top + 16}H{end}V{top}m-6 8L{end} {top}l6 8" fill="none" '
        f'stroke="{ESTIMATED}" stroke-width="3"/>'
        f'<text class="s" x="{(start + end) // 2}" y="{top + 9}" '
        f'style="fill:{INK[ESTIMATED]}">H⁻¹, once the lens is straightened</text>'
    )


def _line(points: npt.ArrayLike) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in np.asarray(points))


def _step(
    layout: _Layout, number: int, name: str, lit: bool, backwards: bool, crossed: bool
) -> str:
    """Draw the arrow to a panel from the one before it; a step that is not taken is crossed out."""
    left, top = layout.place(number + 1)
    tip, end, y = left - 7, left - layout.gap + 7, top + layout.tall // 2
    if backwards:
        tip, end = end, tip
    back = 8 if tip < end else -8
    colour = ESTIMATED if lit else MUTED
    ink = INK.get(colour, colour)
    return (
        f'<path d="M{end} {y}H{tip}m{back} -6L{tip} {y}l{back} 6" fill="none" stroke="{colour}" '
        f'stroke-width="{3 if lit else 1}"/>'
        f'<text class="s" x="{(tip + end) // 2}" y="{y - 10}" style="fill:{ink}'
        f'{";text-decoration:line-through" if crossed else ""}">{name}</text>'
    )


def _below_step(layout: _Layout, number: int) -> str:
    """Write below an arrow what its step does."""
    x, y = layout.place(number + 1) + [-layout.gap // 2, layout.tall // 2 + 20]
    return f'<text class="n" x="{x}" y="{y}">{_IN_WORDS[number]}</text>'
