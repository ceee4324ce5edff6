"""Figures of lenses: what they do to a grid."""

from typing import TYPE_CHECKING

import numpy as np

from cvnotes.camera import Lens
from cvnotes.show.axes import drawn_on
from cvnotes.show.guards import length, thing
from cvnotes.show.style import FAINT, IDEAL, LENS

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
        ax.plot(*line.T, color=FAINT, lw=0.6)
        ax.plot(*lens.distort(line).T, color=LENS, lw=1.3)
    ax.plot(*lens.centre, "+", color=IDEAL, ms=9)
    reach = 1.25 * extent
    ax.set(xlim=(-reach, reach), ylim=(reach, -reach), aspect="equal", title=title)
    ax.axis("off")
    return ax
