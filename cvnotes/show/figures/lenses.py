"""Figures of lenses: what they do to a grid, and how far they can be believed."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Lens
from cvnotes.show.axes import drawn_on
from cvnotes.show.guards import length, thing
from cvnotes.show.style import IDEAL, LENS, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_grid(
    lens: Lens, *, ax: "Axes | None" = None, extent: float = 0.5, title: str = ""
) -> "Axes":
    """Draw a square grid on the plane z = 1, and where the lens shows it.

    Parameters
    ----------
    lens : Lens
        What bends the grid; beyond its ``max_radius`` nothing is drawn.
    extent : float
        The grid covers [−extent, extent] in x and y, with eleven lines in each direction.

    Examples
    --------
    >>> draw_grid(Lens(k=(-0.2,)), title="barrel").get_title()
    'barrel'
    """
    thing(lens, "lens", Lens)
    extent = length(extent, "extent")
    ax = drawn_on(ax, height=520)
    fine, coarse = np.linspace(-extent, extent, 121), np.linspace(-extent, extent, 11)
    across = np.stack(np.meshgrid(fine, coarse), -1)
    for line in (*across, *across[..., ::-1]):
        ax.plot(*line.T, color=MUTED, lw=0.6)
        ax.plot(*lens.distort(line).T, color=LENS, lw=1.3)
    ax.plot(*lens.centre, "+", color=IDEAL, ms=9)
    reach = 1.25 * extent
    ax.set(xlim=(-reach, reach), ylim=(reach, -reach), aspect="equal", title=title)
    ax.axis("off")
    return ax


def draw_displacement(lens: Lens, *, ax: "Axes | None" = None) -> "Axes":
    """Draw a grid of the plane z = 1, and how a lens three times as strong moves it, as arrows.

    Examples
    --------
    >>> len(draw_displacement(Lens(p=(0.02, 0.0))).collections[0].U)
    25
    """
    thing(lens, "lens", Lens)
    p1, p2 = lens.p
    strong = replace(lens, k=tuple(3 * k for k in lens.k), p=(3 * p1, 3 * p2))
    ax = draw_grid(strong, ax=ax)
    ax.set(xlim=(-0.7, 0.7), ylim=(0.7, -0.7))
    x = np.array([-0.5, -0.3, 0, 0.3, 0.5])
    xy: Array = np.stack(np.meshgrid(x, x), -1).reshape(-1, 2)
    moved = strong.distort(xy) - xy
    ax.quiver(
        *xy.T, *moved.T, color=LENS, zorder=3, width=0.008, minshaft=2,
        angles="xy", scale_units="xy", scale=1,
    )  # fmt: skip
    return ax
