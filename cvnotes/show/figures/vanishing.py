"""Figures of vanishing points: the triangle that gives a camera away."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, ShapeError, matrix
from cvnotes.projective import from_homogeneous, join, meet, to_homogeneous
from cvnotes.show.axes import beside, halo, pixel_axes
from cvnotes.show.figures.images import draw_points
from cvnotes.show.style import ESTIMATED, FONT

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_altitudes(v: npt.ArrayLike, *, ax: "Axes | None" = None) -> "Axes":
    """Draw the triangle of three vanishing points, its altitudes, and their orthocentre.

    For three orthogonal directions and square pixels that point, c, is the principal point, which
    the notes call the piercing point.

    Parameters
    ----------
    v : array_like, shape (3, 2)
        Vanishing points in pixels, of the directions X, Y and Z.

    Raises
    ------
    DegenerateError
        The points lie on a line: there is no triangle.

    Examples
    --------
    >>> ax = draw_altitudes([[0, 0], [900, 0], [400, 700]])
    >>> [text.get_text() for text in ax.texts]
    ['c', 'X', 'Y', 'Z']
    """
    v = matrix(v, "v", 3, 2)
    if v.ndim != 2:
        raise ShapeError(f"v: expected three points (3, 2), got {v.shape}")
    feet = np.array([_foot(v[i], v[i - 1], v[i - 2]) for i in range(3)])
    ax = pixel_axes(ax, (640, 480))
    ax.plot(*np.concatenate([v, v[:1]]).T, color=ESTIMATED, linewidth=1.2)
    for corner, foot in zip(v, feet, strict=True):
        ax.plot(*np.stack([corner, foot]).T, "--", color=ESTIMATED, linewidth=0.9)
    altitudes = [join(*to_homogeneous([v[i], feet[i]])) for i in range(2)]
    c = from_homogeneous(meet(*altitudes))
    draw_points(c, ax=ax)
    draw_points(v, ax=ax)
    _widened(ax, v)
    away = v - v.mean(axis=0)
    shifts = 14 * away / np.linalg.norm(away, axis=1, keepdims=True) * (1, -1)  # paper: upwards
    for name, at, shift in zip("cXYZ", [c, *v], [(12, 12), *shifts], strict=True):
        beside(ax, name, at, shift, ESTIMATED, ha="center", va="center", fontsize=FONT + 1,
               path_effects=halo(), annotation_clip=False)  # fmt: skip
    return ax


def _foot(corner: Array, a: Array, b: Array) -> Array:
    """Return the point of the line through a and b that is nearest to a corner."""
    side, height = b - a, np.linalg.det(np.stack([corner - a, b - a]))
    if abs(height) <= 1e-12 * max(float(side @ side), float((corner - a) @ (corner - a))):
        raise DegenerateError("the three vanishing points lie on a line: there is no triangle")
    return np.asarray(a + (corner - a) @ side / (side @ side) * side)


def _widened(ax: "Axes", m: Array) -> "Axes":
    """Let the axes of a picture reach to points (n, 2) outside of it."""
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    span = np.ptp(np.concatenate([m, [[left, top], [right, bottom]]]), axis=0).max()
    low = np.minimum([left, top], m.min(axis=0) - 0.08 * span)
    high = np.maximum([right, bottom], m.max(axis=0) + 0.08 * span)
    ax.set(xlim=(low[0], high[0]), ylim=(high[1], low[1]))
    return ax
