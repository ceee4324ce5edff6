"""Figures of lenses: what they do to a grid."""

from typing import TYPE_CHECKING

import numpy as np

from cvnotes.camera import Lens
from cvnotes.show.axes import drawn_on
from cvnotes.show.guards import thing
from cvnotes.show.style import FAINT, IDEAL, LENS

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_grid(lens: Lens, *, ax: "Axes | None" = None) -> "Axes":
    """Draw a square grid on the plane z = 1, eleven lines each way, and where the lens shows it.

    Parameters
    ----------
    lens : Lens
        What bends the grid; beyond its ``max_radius`` nothing is drawn.

    Examples
    --------
    >>> len(draw_grid(Lens(k=(-0.2,))).lines)
    45
    """
    thing(lens, "lens", Lens)
    ax = drawn_on(ax, height=520)
    fine, coarse = np.linspace(-0.5, 0.5, 121), np.linspace(-0.5, 0.5, 11)
    across = np.stack(np.meshgrid(fine, coarse), -1)
    for line in (*across, *across[..., ::-1]):
        ax.plot(*line.T, color=FAINT, lw=0.6)
        ax.plot(*lens.distort(line).T, color=LENS, lw=1.3)
    ax.plot(*lens.centre, "+", color=IDEAL, ms=9)
    ax.set(xlim=(-0.625, 0.625), ylim=(0.625, -0.625), aspect="equal")
    ax.axis("off")
    return ax
