"""Figures of projective geometry: lines, segments, and the classes of coordinates."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, ShapeError, matrix, points
from cvnotes.show.axes import beside, drawn_on, halo, pixel_axes
from cvnotes.show.guards import length
from cvnotes.show.style import ESTIMATED, FONT, IDEAL, MUTED, WORLD, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_lines(
    lines: npt.ArrayLike,
    *,
    ax: "Axes | None" = None,
    size: tuple[int, int] = (640, 480),
    meaning: str = "estimated",
    label: str = "",
    linewidth: float = 1.4,
) -> "Axes":
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
    linewidth : float
        As matplotlib's.

    Examples
    --------
    >>> len(draw_lines([[0, 1, -240], [1, 0, -320], [0, 0, 1]]).lines)
    2
    """
    lines = points(lines, "lines", 3).reshape(-1, 3)
    style: dict[str, Any] = {"color": colour_of(meaning), "path_effects": halo()}
    style["linewidth"] = length(linewidth, "linewidth")
    ax = pixel_axes(ax, size)
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
    ax: "Axes | None" = None,
    size: tuple[int, int] = (640, 480),
    meaning: str = "estimated",
    label: str = "",
    linewidth: float = 1.8,
    path_effects: Sequence[Any] | None = None,
) -> "Axes":
    """Draw segments, each between its two end points.

    Parameters
    ----------
    segments : array_like, shape (..., 2, 2)
        End points (u, v).
    size, meaning, label, linewidth
        As for `draw_lines`.
    path_effects : sequence
        As matplotlib's; by default a white rim keeps segments visible over a picture.

    Examples
    --------
    >>> len(draw_segments([[[0, 0], [90, 90]], [[0, 90], [90, 0]]]).lines)
    2
    """
    ends = segment_ends(segments)
    style: dict[str, Any] = {"color": colour_of(meaning)}
    style["linewidth"] = length(linewidth, "linewidth")
    style["path_effects"] = halo() if path_effects is None else list(path_effects)
    ax = pixel_axes(ax, size)
    for i, pair in enumerate(ends):
        ax.plot(*pair.T, label=label if label and i == 0 else None, **style)
    return ax


def draw_classes(x_h: npt.ArrayLike, *, ax: "Axes | None" = None) -> "Axes":
    """Draw points of P¹, the projective line: classes [wx w] are lines through the origin.

    Where such a line crosses w = 1 is the Euclidean point x. The class of [1 0] never does: it is
    the point at infinity. All of them pass through [0 0], which therefore is no point.

    Parameters
    ----------
    x_h : array_like, shape (n, 2)
        One member (wx, w) of each class; a dot marks it where it is not the one with w = 1.

    Examples
    --------
    >>> ax = draw_classes([[1, 1], [4, 2], [1, 0]])
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('first coordinate, wx', 'last coordinate, w')
    """
    x_h = matrix(x_h, "x_h", 2).reshape(-1, 2)
    if len(x_h) == 0:
        raise CvnotesError("x_h: expected at least one class")
    if not (x_h != 0).any(axis=1).all():
        raise CvnotesError("x_h: [0 0] is no point, and has no line of its own")
    reach = 5.0  # of the axes, to both sides
    ax = drawn_on(ax, width=760, height=320)
    ax.axhline(1, color=WORLD, linewidth=2.2, zorder=1)
    text: dict[str, Any] = {"fontsize": FONT + 1, "zorder": 5, "path_effects": halo()}
    for x, w in x_h:
        ideal = abs(w) < 1e-100 * abs(x)
        colour = ESTIMATED if ideal else IDEAL
        ax.axline((0, 0), (x, w), color=colour, linewidth=1.1, zorder=2)
        if ideal:
            beside(ax, "[1 0]", (reach, 0), (6, 0), colour, va="center", **text)
        elif abs(x / w) <= reach:
            ax.plot(x / w, 1, "s", color=WORLD, markersize=6, zorder=3)
            name = f"{x / w:g}".replace("-", "−")
            beside(ax, name, (x / w, 1), (0, 8), WORLD, ha="center", **text)
        if w != 1:
            ax.plot(x, w, "o", color=colour, markersize=5, zorder=3)
    ax.plot(0, 0, "o", color="white", markeredgecolor=MUTED, markersize=8, zorder=4)
    beside(ax, "ℝ, at w = 1", (reach, 1), (6, 0), WORLD, va="center", **text)
    beside(ax, "[0 0]", (0, 0), (0, -36), MUTED, ha="center", **text)
    ax.set(xlim=(-reach, reach), ylim=(-0.3 * reach, 0.45 * reach), aspect="equal")
    ax.set(xlabel="first coordinate, wx", ylabel="last coordinate, w", xticks=[], yticks=[])
    ax.spines[:].set_visible(False)
    return ax


def segment_ends(segments: npt.ArrayLike) -> Array:
    """Guard segments and give their ends, (n, 2, 2).

    Examples
    --------
    >>> segment_ends([[0, 1], [2, 3]]).shape
    (1, 2, 2)
    """
    ends = points(segments, "segments", 2)
    if ends.ndim < 2 or ends.shape[-2] != 2:
        raise ShapeError(f"segments: expected two ends each, (..., 2, 2), got {ends.shape}")
    return ends.reshape(-1, 2, 2)
