"""Figures of projective geometry: lines and segments."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, ShapeError, points
from cvnotes.show.axes import halo, pixel_axes
from cvnotes.show.guards import length
from cvnotes.show.style import colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_lines(
    lines: npt.ArrayLike,
    *,
    ax: "Axes | None" = None,
    size: tuple[int, int] = (640, 480),
    meaning: str = "estimated",
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
        ax.axline(foot, foot + 100 * np.array([-n[1], n[0]]), **style)
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
