"""Figures of least squares: the singular vectors, two kinds of error, the way into a valley."""

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import DegenerateError, ShapeError, matrix, numbers, points
from cvnotes.show.axes import arrow, beside, drawn_on, letter, panels
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
    # The same scale on both sides, so that lengths can be compared.
    wide, high = max(1.3, 1.2 * s[0]), max(1.15, 1.15 * float(np.abs(circle @ D.T)[:, 1].max()))
    left, right = axes = panels(
        2, width=900, height=round(840 * high / (wide + 1.3)) + 64, width_ratios=(1.3, wide)
    )
    for ax, M, reach, names in (
        (left, np.eye(2), 1.3, "v₁ v₂"),
        (right, D, wide, "D\xa0v₁ D\xa0v₂"),
    ):
        around = circle @ M.T
        ax.plot(*around.T, color=MUTED, lw=1)
        for i in range(0, 240, 20):  # every other one of 24 sectors, so that each is found again
            ax.fill(*np.vstack([around[i : i + 11], [0, 0]]).T, color="0.5", alpha=0.16, lw=0)
        for name, v, colour in zip(names.split(" "), Vt, (LENS, ESTIMATED), strict=True):
            end = M @ v
            arrow(ax, np.zeros(2), end, colour, 2)
            at = end + 0.18 * (end / max(float(np.hypot(*end)), 1e-12))
            letter(ax, name, at, colour, fontsize=FONT + 2)
        ax.plot(0, 0, "o", color=IDEAL, ms=4)
        ax.set(xlim=(-reach, reach), ylim=(-high, high), aspect="equal")
        ax.set_axis_off()
    left.set_title("all h of length 1")
    right.set_title(f"D h: σ₁ = {s[0]:.2f}, σ₂ = {s[1]:.2f}")
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
    ax = drawn_on(ax, width=760, height=300)
    ax.axvline(1, color=CAMERA, lw=6, alpha=0.35)
    for xi, wi, mi in zip(x, w, seen, strict=True):
        ax.fill([0, wi, wi], [0, xi, mi * wi], color=LENS, alpha=0.08, lw=0)
        ax.plot([0, wi], [0, xi], color=MUTED, lw=1)
        ax.plot([0, wi], [0, mi * wi], color=MUTED, lw=1, ls="--")
        outwards = 16 if xi < 0 else -16  # there no ray passes
        errors = ((1.0, ESTIMATED, (-7, outwards), "right"), (wi, LENS, (9, 0), "left"))
        for depth, colour, offset, side in errors:
            gap = np.array([xi / wi, mi]) * depth
            ax.plot([depth, depth], gap, color=colour, lw=4, solid_capstyle="butt")
            beside(ax, f"{abs(gap[1] - gap[0]):.2f}", (depth, gap.mean()), offset, colour,
                   ha=side, va="center", fontsize=FONT)  # fmt: skip
        ax.plot(wi, xi, "s", color=WORLD, ms=6)
    ax.plot(0, 0, ">", color=CAMERA, ms=12)
    both = np.concatenate([x, seen * w])
    top, bottom = (1.15 * max(float((side * both).max()), 0.6, 0.1 * w.max()) for side in (-1, 1))
    far = int(w.argmax())  # there the names stand
    for text, at, by, colour in (
        ("geometric error, on w = 1", (1, -top), (8, -10), ESTIMATED),
        ("algebraic error", (w[far], (x[far] + seen[far] * w[far]) / 2), (38, 0), LENS),
        ("where H puts it", (w[far], x[far]), (9, 3), WORLD),
        ("where it was seen", (w[far], seen[far] * w[far]), (9, -4), MUTED),
    ):
        beside(ax, text, at, by, colour, va="center", fontsize=FONT)
    depths = np.unique([0, 1, *w])
    ax.set(xlim=(-0.06 * w.max(), 1.32 * w.max()), ylim=(bottom, -top), xticks=depths, yticks=[])
    ax.spines["left"].set_visible(False)
    ax.set_xlabel("w, the depth in units of H")
    return ax
