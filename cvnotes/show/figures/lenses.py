"""Figures of lenses: what they do to a grid, and how far they can be believed."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.camera import Lens
from cvnotes.show.guards import count, length, thing
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_grid(
    lens: Lens, *, ax: "Axes | None" = None, extent: float = 0.5, lines: int = 11, title: str = ""
) -> "Axes":
    """Draw a square grid on the plane z = 1, and where the lens shows it.

    Parameters
    ----------
    lens : Lens
        What bends the grid; beyond its ``max_radius`` nothing is drawn.
    extent : float
        The grid covers [−extent, extent] in x and y.
    lines : int
        Lines in each direction.

    Examples
    --------
    >>> draw_grid(Lens(k=(-0.2,)), title="barrel").get_title()
    'barrel'
    """
    thing(lens, "lens", Lens)
    extent, lines = length(extent, "extent"), count(lines, "lines")
    ax = panels(height=520) if ax is None else ax
    fine, coarse = np.linspace(-extent, extent, 121), np.linspace(-extent, extent, lines)
    for c in coarse:
        for line in (
            np.stack([np.full_like(fine, c), fine], -1),
            np.stack([fine, c + 0 * fine], -1),
        ):
            ax.plot(*line.T, color=MUTED, lw=0.6)
            ax.plot(*lens.distort(line).T, color=LENS, lw=1.3)
    ax.plot(*lens.centre, "+", color=IDEAL, ms=9)
    _square(ax, 1.25 * extent)
    ax.set_title(title)
    return ax


def draw_lenses(lenses: Sequence[tuple[str, Lens]], *, extent: float = 0.5) -> Any:
    """Draw the grids of several named lenses side by side; gives their axes.

    Examples
    --------
    >>> len(draw_lenses([("barrel", Lens(k=(-0.3,))), ("pincushion", Lens(k=(0.3,)))]))
    2
    """
    if not isinstance(lenses, list | tuple) or len(lenses) < 2:
        raise CvnotesError("lenses: expected at least two, each with its name")
    axes = panels(len(lenses), width=900, height=round(900 / len(lenses)) + 40)
    for ax, (name, lens) in zip(axes, lenses, strict=True):
        draw_grid(lens, ax=ax, extent=extent, title=name)
    for ax in axes[1:]:
        ax.set_ylabel("")
    return axes


def draw_radius(lens: Lens, *, ax: "Axes | None" = None, up_to: float = 1.5) -> "Axes":
    """Draw the observed radius r' = r L(r) over the ideal radius r, and where the lens ends.

    Parameters
    ----------
    lens : Lens
        Its radial part is drawn.
    up_to : float
        Largest ideal radius on the axis.

    Examples
    --------
    >>> draw_radius(Lens(k=(-4 / 3,))).get_xlabel()
    'ideal radius r'
    """
    thing(lens, "lens", Lens)
    up_to = length(up_to, "up_to")
    ax = panels() if ax is None else ax
    r = np.linspace(0, up_to, 400)
    observed = r * lens.L(r)
    good = r <= lens.max_radius
    ax.plot(r, r, ":", color=IDEAL, label="ideal lens")
    ax.plot(r[good], observed[good], color=LENS, label="r L(r)")
    if not good.all():
        ax.plot(r[~good], observed[~good], "--", color=ESTIMATED, label="beyond the fold: no lens")
        ax.axvline(lens.max_radius, color=ESTIMATED, lw=1)
        ax.annotate(
            f"max_radius = {lens.max_radius:.2f}", (lens.max_radius, 0), (5, 6),
            textcoords="offset points", color=ESTIMATED,
        )  # fmt: skip
    ax.set(xlabel="ideal radius r", ylabel="observed radius r'", xlim=(0, up_to))
    ax.set_ylim(0, 1.1 * max(float(np.max(observed[good])), 0.5 * up_to))
    ax.legend(loc="upper left", frameon=False)
    return ax


def draw_displacement(lens: Lens, *, ax: "Axes | None" = None, extent: float = 0.5) -> "Axes":
    """Draw where the lens moves points of the plane z = 1, as arrows in true length.

    Examples
    --------
    >>> draw_displacement(Lens(p=(0.02, 0.0))).get_xlabel()
    'x'
    """
    thing(lens, "lens", Lens)
    extent = length(extent, "extent")
    ax = panels(height=520) if ax is None else ax
    x = np.linspace(-extent, extent, 13)
    xy: Array = np.stack(np.meshgrid(x, x), -1).reshape(-1, 2)
    moved = lens.distort(xy) - xy
    ax.quiver(*xy.T, *moved.T, color=LENS, angles="xy", scale_units="xy", scale=1, width=0.005)
    _square(ax, 1.25 * extent)
    return ax


def _square(ax: "Axes", reach: float) -> None:
    ax.set(xlim=(-reach, reach), ylim=(reach, -reach), aspect="equal", xlabel="x", ylabel="y")
