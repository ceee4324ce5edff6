"""Drawings of ideas: P² as rays and planes, maps of a square, the pinhole, the course's colours."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, ShapeError, matrix, real
from cvnotes.projective import apply
from cvnotes.show.axes import arrow, beside, drawn_on, halo, letter
from cvnotes.show.guards import texts
from cvnotes.show.style import CAMERA, COLOURS, ESTIMATED, FONT, IDEAL, LENS, MARKERS, MUTED, WORLD

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Where x, y and w lead on paper: x to the right, y away from us, w up.
_OBLIQUE = np.array([[1.0, 0.0], [0.42, 0.40], [0.0, 1.7]])
_WIDE, _DEEP = 2.2, 1.3  # half the sides of the piece of the plane w = 1 that is drawn
_MEANINGS = {
    "world": "what stands in the world",
    "camera": "the camera: its centre, its image plane",
    "ideal": "the truth, or what an exact formula says",
    "lens": "a point in a picture, as the lens shows it",
    "estimated": "found by a computation: corners, lines, cameras",
}


def draw_meanings(*, ax: "Axes | None" = None) -> "Axes":
    """Draw the legend of all figures: five colours and markers, with one meaning each.

    Examples
    --------
    >>> [text.get_text().split(":")[0] for text in draw_meanings().texts][2:4]
    ['the truth, or what an exact formula says', 'a point in a picture, as the lens shows it']
    """
    ax = drawn_on(ax, width=450, height=150)
    for row, (meaning, words) in enumerate(_MEANINGS.items()):
        ax.plot([0.02, 0.12], [row, row], "-", color=COLOURS[meaning], linewidth=2)
        ax.plot(0.07, row, MARKERS[meaning], color=COLOURS[meaning], markersize=9)
        ax.text(0.16, row, words, va="center", fontsize=FONT + 1)
    ax.set(xlim=(0, 1), ylim=(len(_MEANINGS) - 0.5, -0.5))
    ax.axis("off")
    return ax


def draw_rays(
    x_h: npt.ArrayLike,
    lines: npt.ArrayLike = (),
    *,
    ax: "Axes | None" = None,
    names: Sequence[str] = (),
) -> "Axes":
    """Draw points of P² as rays through the origin, and lines of P² as planes of such rays.

    The plane w = 1 is the Euclidean one: there a ray is a dot, and a plane is a line. The arrow
    of a plane is its normal, the triple (a, b, c) of the line.

    Parameters
    ----------
    x_h : array_like, shape (n, 3)
        Points, homogeneous. Those with w = 0 are rays that never reach the plane w = 1.
    lines : array_like, shape (m, 3)
        Lines a x + b y + c w = 0.
    names : sequence of str
        Written beside the points, and then beside the normals of the lines.

    Examples
    --------
    >>> ax = draw_rays([[0, 0, 1], [1, 1, 1]], [[-1, 1, 0]], names=["a", "b", "l"])
    >>> [text.get_text() for text in ax.texts if text.get_text()]
    ['w = 1', 'a', 'b', 'l']
    """
    x_h, names = matrix(x_h, "x_h", 3).reshape(-1, 3), texts(names, "names")
    if len(x_h) == 0:
        raise CvnotesError("x_h: expected at least one point")
    lines = real(lines, "lines")
    lines = matrix(lines, "lines", 3).reshape(-1, 3) if lines.size else np.zeros((0, 3))
    if not (np.concatenate([x_h, lines]) != 0).any(axis=1).all():
        raise CvnotesError("the zero vector is neither a point nor a line")
    ax = drawn_on(ax, height=400)
    patch = np.array([[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]) * [_WIDE, _DEEP, 1]
    ax.fill(*_on_paper(patch).T, color=WORLD, alpha=0.16, linewidth=0, zorder=2)
    _write(ax, "w = 1", patch[1], WORLD, (12, -10))
    named = [*names, *[""] * (len(x_h) + len(lines))]
    for x, name in zip(x_h, named, strict=False):
        _draw_ray(ax, x, name)
    for line, name in zip(lines, named[len(x_h) :], strict=False):
        _draw_plane(ax, line, name)
    ax.plot(0, 0, "o", color="white", markeredgecolor=MUTED, markersize=7, zorder=6)
    ax.set(aspect="equal")
    ax.margins(0.08)
    ax.axis("off")
    return ax


def _draw_ray(ax: "Axes", x: Array, name: str) -> None:
    ideal = bool(x[2] == 0)
    colour = ESTIMATED if ideal else IDEAL
    tip = 1.9 * x / np.linalg.norm(x) if ideal else x / x[2]
    below = -0.9 * tip if ideal else -0.25 * tip
    ax.plot(*_on_paper([below, tip]).T, color=colour, linewidth=1.6, zorder=3)
    if ideal:
        _write(ax, name, tip, colour, (10, 8))
        return
    ax.plot(*_on_paper([tip, 1.22 * tip]).T, color=colour, linewidth=1.6, zorder=5)
    ax.plot(*_on_paper(tip), "s", color=WORLD, markersize=7, zorder=6)
    _write(ax, name, tip, colour, (12, 10))


def _draw_plane(ax: "Axes", line: Array, name: str) -> None:
    ends = _cut(line)
    if len(ends) == 2:
        ax.fill(*_on_paper([[0, 0, 0], *ends]).T, color=ESTIMATED, alpha=0.22, lw=0, zorder=2.5)
        ax.plot(*_on_paper(ends).T, color=ESTIMATED, linewidth=2.2, zorder=4)
    tip = 0.9 * line / np.linalg.norm(line)
    arrow(ax, (0.0, 0.0), _on_paper(tip), ESTIMATED, 1.8, zorder=5)
    ax.plot(*_on_paper(tip), " ")  # the axes reach to the tip
    away = 12 + 3.5 * max(len(name) - 2, 0)
    _write(ax, name, tip, ESTIMATED, (-away, 4) if _on_paper(tip)[0] < 0 else (away, 4))


def _cut(line: Array) -> Array:
    """Return the ends (2, 3) of a line in the piece of the plane w = 1, or none."""
    a, b, c = line
    found = [[x, -(a * x + c) / b, 1.0] for x in (-_WIDE, _WIDE) if b != 0]
    found += [[-(b * y + c) / a, y, 1.0] for y in (-_DEEP, _DEEP) if a != 0]
    inside = [p for p in found if abs(p[0]) <= _WIDE + 1e-9 and abs(p[1]) <= _DEEP + 1e-9]
    return np.array(sorted(inside))[[0, -1]] if len(inside) > 1 else np.zeros((0, 3))


def _on_paper(x: npt.ArrayLike) -> Array:
    return np.asarray(np.asarray(x, dtype=float) @ _OBLIQUE)


def _write(
    ax: "Axes", text: str, at: npt.ArrayLike, colour: str, shift: tuple[float, float]
) -> None:
    beside(ax, text, tuple(_on_paper(at)), shift, colour, fontsize=FONT + 1, ha="center",
           va="center", path_effects=halo(), zorder=7, annotation_clip=False)  # fmt: skip


def draw_mapped(H: npt.ArrayLike, *, ax: "Axes | None" = None, title: str = "") -> "Axes":
    """Draw what a map of the plane makes of a square with a grid and a circle.

    Parameters
    ----------
    H : array_like, shape (3, 3)
        The map, which moves the square from −1 to 1. The square itself is dashed.

    Examples
    --------
    >>> ax = draw_mapped([[2, 0, 0], [0, 2, 0], [0, 0, 1]])
    >>> ax.lines[0].get_xydata()[:2] * 2 == ax.lines[1].get_xydata()[:2]
    array([[ True,  True],
           [ True,  True]])
    """
    H = matrix(H, "H", 3, 3)
    if H.ndim != 2:
        raise ShapeError(f"H: expected one map (3, 3), got {H.shape}")
    ax = drawn_on(ax, width=300, height=300)
    square = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    angle = np.linspace(0, 2 * np.pi, 73)
    ax.plot(*square.T, "--", color=IDEAL, linewidth=1)
    ax.plot(*apply(H, square).T, color=WORLD, linewidth=2)
    for t in np.linspace(-1, 1, 5):
        for ends in ([[t, -1], [t, 1]], [[-1, t], [1, t]]):
            ax.plot(*apply(H, ends).T, color=WORLD, linewidth=0.8)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    ax.plot(*apply(H, circle).T, color=ESTIMATED, linewidth=2)
    ax.set(aspect="equal", title=title)
    ax.axis("off")
    return ax


def draw_pinhole(*, ax: "Axes | None" = None) -> "Axes":
    """Draw a pinhole camera from the side, with the two similar triangles of v = f y / z.

    Examples
    --------
    >>> ax = draw_pinhole()  # of the point y = 1.5, z = 4, with f = 1.5
    >>> [float(v) for v in ax.lines[0].get_xydata()[1]]  # the ray meets the image plane
    [1.5, 0.5625]
    """
    y, z, f = 1.5, 4.0, 1.5
    v = f * y / z
    ax = drawn_on(ax, height=300)
    ax.plot([-f, f, z], [-v, v, y], color=LENS, linewidth=1.6, zorder=3)
    ax.fill([0, z, z], [0, 0, y], color=WORLD, alpha=0.2, linewidth=0)
    ax.fill([0, f, f], [0, 0, v], fill=False, hatch="///", edgecolor=ESTIMATED, linewidth=0)
    ax.axhline(0, color=MUTED, linewidth=1, linestyle="-.", zorder=1)
    half = 0.85 * y
    ax.plot([f, f], [-half, half], color=CAMERA, linewidth=2.5)
    ax.plot([-f, -f], [-half, half], color=CAMERA, linewidth=2.5, linestyle=":")
    for at, tip, colour in ((z, y, WORLD), (f, v, ESTIMATED), (-f, -v, ESTIMATED)):
        arrow(ax, (at, 0), (at, tip), colour, 3, zorder=4)
    ax.plot(0, 0, "o", color=CAMERA, markersize=9, zorder=5)
    up, down = -1.05 * half, 1.15 * half
    span: dict[str, Any] = {"arrowstyle": "<->", "color": MUTED, "shrinkA": 0, "shrinkB": 0}
    for end, row, name in ((f, 0.55 * up, "f"), (z, 0.9 * up, "z")):
        ax.annotate("", (0, row), (end, row), arrowprops=span)
        _label(ax, name, (end / 2, row), IDEAL)
    _label(ax, "C, the pinhole", (-0.1, 0.33 * down), CAMERA)
    _label(ax, "image plane, z = f", (f, 1.15 * down), CAMERA)
    _label(ax, "film behind the hole:\nupside down", (-f, 1.25 * down), MUTED)
    _label(ax, "y", (z + 0.04 * z, y / 2), WORLD)
    _label(ax, "v", (f + 0.03 * z, v / 2), ESTIMATED)
    _label(ax, "axis", (1.15 * z, 0.12 * up), MUTED)
    ax.set(xlim=(-1.5 * f, 1.2 * z), ylim=(1.6 * down, 1.3 * up))
    ax.axis("off")
    return ax


def _label(ax: "Axes", text: str, at: tuple[float, float], colour: str) -> None:
    letter(ax, text, at, colour, fontsize=FONT + 1, zorder=6)
