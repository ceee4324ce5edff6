"""Figures of warps: pixels that were hit or missed, the cell between four pixels, shared rows."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, ShapeError, number, numbers
from cvnotes.show.figures.images import draw_image
from cvnotes.show.guards import count, one_point, pictures
from cvnotes.show.style import ESTIMATED, FONT, IDEAL, LENS, MUTED, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_hits(hits: npt.ArrayLike, *, ax: "Axes | None" = None) -> "Axes":
    """Draw how often each target pixel of a forward warp was hit: never, once, or more often.

    Parameters
    ----------
    hits : array_like, shape (height, width)
        Counts, as `forward_warp` gives them.

    Examples
    --------
    >>> draw_hits([[0, 1], [2, 1]]).get_xlabel()
    'u (px)'
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    counts = numbers(hits, "hits")
    if counts.ndim != 2 or counts.size == 0:
        raise ShapeError(f"hits: expected (height, width), got {counts.shape}")
    ax = panels(height=460) if ax is None else ax
    colours = [IDEAL, "white", ESTIMATED]
    ax.imshow(np.minimum(counts, 2), cmap=ListedColormap(colours), vmin=0, vmax=2)
    names = ("never hit: a hole", "hit once", "hit more often: a fold")
    patches = [Patch(fc=c, ec=MUTED, label=n) for c, n in zip(colours, names, strict=True)]
    ax.legend(handles=patches, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3,
              frameon=False, fontsize=FONT)  # fmt: skip
    ax.set(xlabel="u (px)", ylabel="v (px)")
    return ax


def draw_cell(values: npt.ArrayLike, du: float, dv: float, *, ax: "Axes | None" = None) -> "Axes":
    """Draw the four pixels I1 to I4 around a point, and the way to its interpolated value.

    Parameters
    ----------
    values : array_like, shape (4,)
        Grey values I1 (top left), I2 (top right), I3 (bottom left), I4 (bottom right).
    du, dv : float
        Fractions of the point, in [0, 1].

    Examples
    --------
    >>> draw_cell([0, 10, 20, 30], 0.5, 0.5).texts[-1].get_text()
    'I = 15'
    """
    I1, I2, I3, I4 = grey = one_point(values, "values", 4).tolist()
    du, dv = number(du, "du"), number(dv, "dv")
    if not (0 <= du <= 1 and 0 <= dv <= 1):
        raise CvnotesError(f"du and dv are fractions, from 0 to 1; got {du:g} and {dv:g}")
    ax = panels(height=400) if ax is None else ax
    upper, lower = I1 + (I2 - I1) * du, I3 + (I4 - I3) * du
    ax.plot([0, 1, 1, 0, 0], [0, 0, 1, 1, 0], color=MUTED, lw=1)
    for (u, v), value, n in zip(((0, 0), (1, 0), (0, 1), (1, 1)), grey, "1234", strict=True):
        ax.plot(u, v, "o", color=LENS, ms=9)
        ax.annotate(f"$I_{n}$ = {value:g}", (u, v), (0, 12 if v == 0 else -22), ha="center",
                    textcoords="offset points", color=LENS)  # fmt: skip
    ax.plot([du, du], [0, 1], ":", color=ESTIMATED)
    for v, name, value in ((0, "a", upper), (1, "b", lower)):
        ax.plot(du, v, "s", color=ESTIMATED, ms=6)
        ax.annotate(f"$I_{name}$ = {value:g}", (du, v), (0, 12 if v == 0 else -22), ha="center",
                    textcoords="offset points", color=ESTIMATED)  # fmt: skip
    ax.plot(du, dv, "x", color=ESTIMATED, ms=10, mew=2)
    ax.annotate(f"I = {upper + (lower - upper) * dv:g}", (du, dv), (10, -4),
                textcoords="offset points", color=ESTIMATED)  # fmt: skip
    ax.set(xlim=(-0.25, 1.25), ylim=(1.25, -0.25), aspect="equal", xlabel="du", ylabel="dv")
    ax.set(xticks=[0, du, 1], yticks=[0, dv, 1])
    return ax


def draw_rows(
    before: Sequence[npt.ArrayLike], after: Sequence[npt.ArrayLike], *, lines: int = 9
) -> npt.NDArray[np.object_]:
    """Draw a stereo pair before and after rectification, with rows running through both.

    Parameters
    ----------
    before, after : two pictures each
        Left and right, all of one size.
    lines : int
        Rows drawn.

    Returns
    -------
    ndarray of Axes, shape (2, 2)
    """
    pairs = pictures(before, "before"), pictures(after, "after")
    if len(pairs[0]) != 2 or len(pairs[1]) != 2:
        raise CvnotesError("before and after: expected two pictures each, left and right")
    lines = count(lines, "lines")
    axes: npt.NDArray[np.object_] = panels(2, 2, width=900, height=720, sharey=True)
    titles = (("left camera", "right camera"), ("left, rectified", "right, rectified"))
    for row, pair, names in zip(axes, pairs, titles, strict=True):
        for ax, picture, name in zip(row, pair, names, strict=True):
            draw_image(picture, ax=ax, title=name)
            for v in np.linspace(0, picture.shape[0] - 1, lines + 2)[1:-1]:
                ax.axhline(v, color=ESTIMATED, lw=0.9)
        row[1].set_ylabel("")
    return axes
