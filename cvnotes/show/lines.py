"""Figures of projective geometry: lines, where they meet, and the classes of coordinates."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from cvnotes.errors import (
    Array,
    CvnotesError,
    DegenerateError,
    ShapeError,
    image_size,
    matrix,
    points,
)
from cvnotes.incidence import join, meet
from cvnotes.projective import from_homogeneous, to_homogeneous
from cvnotes.show.figures import draw_points
from cvnotes.show.shapes import colour_of
from cvnotes.show.style import (
    ESTIMATED,
    FONT,
    IDEAL,
    MUTED,
    WORLD,
    as_picture,
    panels,
    picture_axes,
)

_HALO = withStroke(linewidth=3, foreground="white")


def draw_lines(
    lines: npt.ArrayLike,
    *,
    ax: Axes | None = None,
    size: tuple[int, int] = (640, 480),
    meaning: str = "estimated",
    label: str = "",
    **kwargs: Any,
) -> Axes:
    """Draw whole lines of P², as far as the axes reach.

    Parameters
    ----------
    lines : array_like, shape (..., 3)
        Lines (a, b, c) with a u + b v + c = 0, of any scale. The line at infinity is left out.
    size : (width, height)
        Size of the picture, where new axes are made.
    meaning : {"world", "camera", "ideal", "lens", "estimated"}
        Whose lines these are; sets the colour.
    label : str
        Name in a legend.
    **kwargs
        Passed to ``Axes.axline``, as ``linestyle`` and ``linewidth``.

    Examples
    --------
    >>> len(draw_lines([[0, 1, -240], [1, 0, -320], [0, 0, 1]]).lines)
    2
    """
    lines = points(lines, "lines", 3).reshape(-1, 3)
    ax, colour = _axes(ax, size), colour_of(meaning)
    style: dict[str, Any] = {"color": colour, "linewidth": 1.4, "path_effects": [_HALO]} | kwargs
    middle = np.array([np.mean(ax.get_xlim()), np.mean(ax.get_ylim())])
    for a, b, c in lines[(lines[:, :2] != 0).any(axis=1)]:
        n = np.array([a, b]) / np.hypot(a, b)
        foot = middle - (n @ middle + c / np.hypot(a, b)) * n
        ax.axline(foot, foot + 100 * np.array([-n[1], n[0]]), label=label or None, **style)
        label = ""
    return ax


def draw_segments(
    segments: npt.ArrayLike,
    *,
    ax: Axes | None = None,
    size: tuple[int, int] = (640, 480),
    meaning: str = "estimated",
    label: str = "",
    **kwargs: Any,
) -> Axes:
    """Draw segments, each between its two end points.

    Parameters
    ----------
    segments : array_like, shape (..., 2, 2)
        End points (u, v).
    size, meaning, label, **kwargs
        As for `draw_lines`; the rest is passed to ``Axes.plot``.

    Examples
    --------
    >>> len(draw_segments([[[0, 0], [90, 90]], [[0, 90], [90, 0]]]).lines)
    2
    """
    ends = _segments(segments)
    ax, colour = _axes(ax, size), colour_of(meaning)
    style: dict[str, Any] = {"color": colour, "linewidth": 1.8, "path_effects": [_HALO]} | kwargs
    for i, pair in enumerate(ends):
        ax.plot(*pair.T, label=label if label and i == 0 else None, **style)
    return ax


def draw_vanishing(
    segments: npt.ArrayLike,
    v_h: npt.ArrayLike,
    *,
    ax: Axes | None = None,
    size: tuple[int, int] = (640, 480),
    meaning: str = "estimated",
    label: str = "",
) -> Axes:
    """Draw segments and, dashed, the way on to their vanishing point; the axes grow to show it.

    Parameters
    ----------
    segments : array_like, shape (n, 2, 2)
        End points (u, v).
    v_h : array_like, shape (3,)
        The vanishing point, homogeneous. At infinity it is not drawn, and the axes stay.
    size, meaning, label
        As for `draw_lines`.

    Examples
    --------
    >>> ax = draw_vanishing([[[0, 0], [90, 90]], [[0, 190], [90, 100]]], [900, 95, 1])
    >>> bool(ax.get_xlim()[1] > 900)
    True
    """
    ends, v_h = _segments(segments), matrix(v_h, "v_h", 3)
    if v_h.ndim != 1:
        raise ShapeError(f"v_h: expected one point (3,), got {v_h.shape}")
    ax = draw_segments(ends, ax=ax, size=size, meaning=meaning)
    if v_h[2] == 0:
        return ax
    v = from_homogeneous(v_h)
    near = ends[np.arange(len(ends)), np.linalg.norm(ends - v, axis=-1).argmin(axis=1)]
    for start in near:
        ax.plot(*np.stack([start, v]).T, "--", color=colour_of(meaning), linewidth=0.9)
    draw_points(v, ax=ax, meaning=meaning, label=label)
    return _widened(ax, v[None])


def draw_heights(
    v: npt.ArrayLike,
    *,
    ax: Axes | None = None,
    size: tuple[int, int] = (640, 480),
    names: Sequence[str] = ("X", "Y", "Z"),
) -> Axes:
    """Draw the triangle of three vanishing points, its heights, and the point that they share.

    For three orthogonal directions and square pixels that point is the piercing point.

    Parameters
    ----------
    v : array_like, shape (3, 2)
        Vanishing points in pixels.
    size : (width, height)
        Size of the picture, where new axes are made.
    names : sequence of three str
        Written beside the points.

    Raises
    ------
    DegenerateError
        The points lie on a line: there is no triangle.

    Examples
    --------
    >>> ax = draw_heights([[0, 0], [900, 0], [400, 700]])
    >>> [text.get_text() for text in ax.texts]
    ['X', 'Y', 'Z']
    """
    v = matrix(v, "v", 3, 2)
    if v.ndim != 2 or len(names) != 3:
        raise ShapeError(f"expected three points (3, 2) and three names, got {v.shape}")
    feet = np.array([_foot(v[i], v[i - 1], v[i - 2]) for i in range(3)])
    ax = _axes(ax, size)
    ax.plot(*np.concatenate([v, v[:1]]).T, color=ESTIMATED, linewidth=1.2)
    for corner, foot in zip(v, feet, strict=True):
        ax.plot(*np.stack([corner, foot]).T, "--", color=IDEAL, linewidth=0.9)
    heights = [join(*to_homogeneous([v[i], feet[i]])) for i in range(2)]
    draw_points(from_homogeneous(meet(*heights)), ax=ax, meaning="ideal", label="heights meet")
    draw_points(v, ax=ax, meaning="estimated", label="vanishing points")
    ax.legend(loc="lower right", fontsize=FONT - 1)
    _widened(ax, v)
    for name, corner, away in zip(names, v, v - v.mean(axis=0), strict=True):
        shift = 14 * away / np.linalg.norm(away) * (1, -1)  # points on paper count upwards
        ax.annotate(
            name, corner, shift, textcoords="offset points", ha="center", va="center",
            color=ESTIMATED, fontsize=FONT, fontweight="bold", annotation_clip=False,
        )  # fmt: skip
    return ax


def draw_classes(x_h: npt.ArrayLike, *, ax: Axes | None = None, reach: float = 5.0) -> Axes:
    """Draw points of P¹, the projective line: classes [kx k] are lines through the origin.

    Where such a line crosses k = 1 is the Euclidean point x. The class of [1 0] never does: it is
    the point at infinity. All of them pass through [0 0], which therefore is no point.

    Parameters
    ----------
    x_h : array_like, shape (n, 2)
        One member (kx, k) of each class; a dot marks it where it is not the one with k = 1.
    reach : float
        Of the axes, to both sides.

    Examples
    --------
    >>> ax = draw_classes([[1, 1], [4, 2], [1, 0]])
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('first coordinate, kx', 'last coordinate, k')
    """
    x_h = matrix(x_h, "x_h", 2).reshape(-1, 2)
    if not (x_h != 0).any(axis=1).all():
        raise CvnotesError("x_h: [0 0] is no point, and has no line of its own")
    ax = panels(height=370) if ax is None else ax
    ax.axhline(1, color=WORLD, linewidth=2.2, zorder=1)
    for x, k in x_h:
        ideal = k == 0
        ax.axline((0, 0), (x, k), color=ESTIMATED if ideal else IDEAL, linewidth=1.1, zorder=2)
        if not ideal:
            ax.plot(x / k, 1, "s", color=WORLD, markersize=6, zorder=3)
        if k != 1:
            ax.plot(x, k, "o", color=ESTIMATED if ideal else IDEAL, markersize=5, zorder=3)
    ax.plot(0, 0, "o", color="white", markeredgecolor=MUTED, markersize=8, zorder=4)
    text: dict[str, Any] = {"textcoords": "offset points", "fontsize": FONT, "zorder": 5}
    text["path_effects"] = [_HALO]
    ax.annotate("R, at\nk = 1", (reach, 1), (6, 0), va="center", color=WORLD, **text)
    ax.annotate("[0 0]", (0, 0), (0, -20), ha="center", color=MUTED, **text)
    ax.set(xlim=(-reach, reach), ylim=(-0.35 * reach, 0.65 * reach), aspect="equal")
    ax.set(xlabel="first coordinate, kx", ylabel="last coordinate, k")
    return ax


def _segments(segments: npt.ArrayLike) -> Array:
    ends = points(segments, "segments", 2)
    if ends.ndim < 2 or ends.shape[-2] != 2:
        raise ShapeError(f"segments: expected two ends each, (..., 2, 2), got {ends.shape}")
    return ends.reshape(-1, 2, 2)


def _foot(corner: Array, a: Array, b: Array) -> Array:
    """Give the point of the line through a and b that is nearest to a corner."""
    side, height = b - a, np.linalg.det(np.stack([corner - a, b - a]))
    if abs(height) <= 1e-12 * max(float(side @ side), float((corner - a) @ (corner - a))):
        raise DegenerateError("the three vanishing points lie on a line: there is no triangle")
    return np.asarray(a + (corner - a) @ side / (side @ side) * side)


def _widened(ax: Axes, m: Array) -> Axes:
    """Let the axes of a picture reach to points (n, 2) outside of it."""
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    span = np.ptp(np.concatenate([m, [[left, top], [right, bottom]]]), axis=0).max()
    low = np.minimum([left, top], m.min(axis=0) - 0.08 * span)
    high = np.maximum([right, bottom], m.max(axis=0) + 0.08 * span)
    ax.set(xlim=(low[0], high[0]), ylim=(high[1], low[1]))
    return ax


def _axes(ax: Axes | None, size: tuple[int, int]) -> Axes:
    return as_picture(picture_axes(image_size(size)), size) if ax is None else ax
