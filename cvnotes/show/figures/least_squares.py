"""Figures of least squares: the singular vectors, two kinds of error, the way into a valley."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, DegenerateError, ShapeError, matrix, numbers, points
from cvnotes.show.axes import arrow, beside, drawn_on, panels
from cvnotes.show.guards import thing
from cvnotes.show.style import CAMERA, ESTIMATED, FONT, IDEAL, LENS, MUTED, WORLD

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_stretched_circle(D: npt.ArrayLike) -> Any:
    """Draw all unit vectors h of the plane, and the ellipse of all D h.

    The right singular vectors, of the largest and the smallest singular value, are drawn on the
    left; where D takes them, on the right: the half axes of the ellipse, σ1 and σ2 long.

    Parameters
    ----------
    D : array_like, shape (2, 2)

    Returns
    -------
    ndarray of two Axes

    Examples
    --------
    >>> left, right = draw_stretched_circle([[2, 1], [1, 1]])
    >>> right.get_title()
    'D h: σ₁ = 2.62, σ₂ = 0.38'
    """
    D = matrix(D, "D", 2, 2)
    if D.ndim != 2:
        raise ShapeError(f"D: expected one matrix (2, 2), got {D.shape}")
    _, s, Vt = np.linalg.svd(D)
    angle = np.linspace(0, 2 * np.pi, 241)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    left, right = axes = panels(2, width=900, height=400)
    many = circle[:-1:12]
    reach = 1.25 * max(1.0, s[0])  # the same on both sides, so that lengths can be compared
    for ax, around, dots, ends in (
        (left, circle, many, Vt),
        (right, circle @ D.T, many @ D.T, Vt @ D.T),
    ):
        ax.plot(*around.T, color=MUTED, lw=1)
        ax.plot(*dots.T, ".", color=MUTED, ms=6)
        for end, colour in zip(ends, (LENS, ESTIMATED), strict=True):
            arrow(ax, np.zeros(2), end, colour, 2)
        ax.plot(0, 0, "o", color=IDEAL, ms=4)
        ax.set_aspect("equal")
        ax.set(xlim=(-reach, reach), ylim=(-reach, reach))
    for name, end, colour in zip(("v₁", "v₂"), Vt, (LENS, ESTIMATED), strict=True):
        for ax, words, at in ((left, name, end), (right, f"D {name}", D @ end)):
            at = at + 0.12 * reach * (at / max(float(np.hypot(*at)), 1e-12))
            ax.annotate(words, at, color=colour, fontsize=FONT + 2, ha="center", va="center")
    left.set(title="all h of length 1", xlabel="first entry of h", ylabel="second entry of h")
    right.set(title=f"D h: σ₁ = {s[0]:.2f}, σ₂ = {s[1]:.2f}")
    right.set(xlabel="first entry of D h", ylabel="second entry of D h")
    return axes


def draw_two_errors(
    points_h: npt.ArrayLike, m: npt.ArrayLike, *, ax: "Axes | None" = None
) -> "Axes":
    """Draw the geometric and the algebraic error of points, in a side view.

    The geometric error of a point is the gap between two rays, that of its prediction (x, w) and
    that of the pixel where it was seen, measured on the plane w = 1. The algebraic error is the
    same gap measured at the depth w of the point, and so w times as long.

    Parameters
    ----------
    points_h : array_like, shape (n, 2)
        Predicted points (x, w), before the division; w > 0.
    m : array_like, shape (n,)
        Where they were seen, on w = 1.

    Examples
    --------
    >>> ax = draw_two_errors([[1.0, 2.0], [-1.0, 5.0]], [0.6, -0.1])
    >>> [text.get_text() for text in ax.texts[:2]]
    ['0.10', '0.20']
    """
    predicted, seen = points(points_h, "points_h", 2).reshape(-1, 2), numbers(m, "m").ravel()
    if len(predicted) != len(seen) or len(seen) == 0:
        raise ShapeError(f"m: expected one number for each of {len(predicted)} points")
    x, w = predicted.T
    if not (w > np.finfo(float).tiny * (1 + np.abs(x))).all():  # else x/w is no number
        raise DegenerateError("points_h: a point with w ≤ 0 is behind the camera and is not seen")
    ax = drawn_on(ax, width=760, height=400)
    ax.axvline(1, color=CAMERA, lw=2)
    for xi, wi, mi in zip(x, w, seen, strict=True):
        ax.plot([0, wi], [0, xi], color=MUTED, lw=1)
        ax.plot([0, wi], [0, mi * wi], color=MUTED, lw=1, ls="--")
        outwards = 16 if xi < 0 else -16  # there no ray passes
        errors = ((1.0, ESTIMATED, (-7, outwards), "right"), (wi, LENS, (7, 0), "left"))
        for depth, colour, offset, side in errors:
            gap = np.array([xi / wi, mi]) * depth
            ax.plot([depth, depth], gap, color=colour, lw=4, solid_capstyle="butt")
            beside(ax, f"{abs(gap[1] - gap[0]):.2f}", (depth, gap.mean()), offset, colour,
                   ha=side, va="center", fontsize=FONT)  # fmt: skip
        ax.plot(wi, xi, "s", color=WORLD, ms=6)
        ax.plot([1, 1], [xi / wi, mi], "o", color=IDEAL, ms=3)
    ax.plot(0, 0, "^", color=CAMERA, ms=10)
    top = 1.15 * float(max(np.abs(x).max(), np.abs(seen * w).max(), 0.1))
    ax.set(xlim=(-0.06 * w.max(), 1.12 * w.max()), ylim=(top, -top))
    beside(ax, "w = 1", (1, -top), (4, -12), CAMERA)
    ax.plot([], [], color=MUTED, lw=1, label="where H puts the point")
    ax.plot([], [], color=MUTED, lw=1, ls="--", label="where it was seen")
    ax.plot([], [], color=ESTIMATED, lw=4, label="geometric error, on w = 1")
    ax.plot([], [], color=LENS, lw=4, label="algebraic error, at the point's own w")
    ax.legend(loc="lower right", fontsize=FONT, frameon=False)
    ax.set(xlabel="w, the depth in units of H", ylabel="x")
    return ax


def draw_valley(
    x: npt.ArrayLike,
    y: npt.ArrayLike,
    cost: npt.ArrayLike,
    paths: Mapping[str, npt.ArrayLike],
    *,
    ax: "Axes | None" = None,
) -> "Axes":
    """Draw a cost over two unknowns as a map, light where it is low, and ways that steps took.

    Parameters
    ----------
    x, y : array_like, shapes (n,) and (m,)
        Values of the two unknowns.
    cost : array_like, shape (m, n)
        Positive; its logarithm is drawn, the low part in finer steps.
    paths : mapping from name to array_like of shape (k, 2)
        At most three ways, from their start on.

    Examples
    --------
    >>> ax = draw_valley([0, 1], [0, 1], [[1, 2], [3, 4]], {"down": [[1, 1], [0, 0]]})
    >>> ax.get_legend().get_texts()[0].get_text()
    'down'
    """
    x, y = numbers(x, "x").ravel(), numbers(y, "y").ravel()
    height = numbers(cost, "cost")
    if height.shape != (len(y), len(x)) or min(height.shape) < 2:
        raise ShapeError(
            f"cost: expected ({len(y)}, {len(x)}), at least (2, 2), got {height.shape}"
        )
    if not (height > 0).all():
        raise CvnotesError("cost: expected positive numbers, whose logarithm can be drawn")
    if not 1 <= len(thing(paths, "paths", Mapping)) <= 3:  # type: ignore[type-abstract]
        raise CvnotesError("paths: expected one to three ways")
    ax = drawn_on(ax, width=760, height=520)
    z = np.log10(height)
    levels = np.unique(np.quantile(z, np.linspace(0, 1, 13) ** 2))  # most of them where it is low
    if len(levels) == 1:
        levels = levels + [0.0, 1.0]
    shades = 0.95 - 0.6 * np.linspace(0, 1, len(levels) - 1)
    ax.contourf(x, y, z, levels=levels, colors=[str(shade) for shade in shades])
    first = "start"
    for (name, path), colour in zip(paths.items(), (ESTIMATED, LENS, WORLD), strict=False):
        way: Array = points(path, name, 2).reshape(-1, 2)
        if not len(way):
            raise DegenerateError(f"{name}: expected at least the start of the way")
        ax.plot(*way.T, "-o", color=colour, lw=1.8, ms=5, label=name)
        ax.plot(*way[0], "s", color=IDEAL, ms=8, zorder=4, label=first)
        first = ""
    ax.set(xlim=(x.min(), x.max()), ylim=(y.min(), y.max()))
    ax.legend(loc="upper left", fontsize=FONT)
    return ax
