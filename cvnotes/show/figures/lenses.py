"""Figures of lenses: what they do to a grid, and how far they can be believed."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cvnotes.base import Array, CvnotesError, InputTypeError
from cvnotes.camera import AnyLens, Lens
from cvnotes.show.axes import beside, drawn_on, halo
from cvnotes.show.guards import length, thing
from cvnotes.show.style import COLOURS, ESTIMATED, FONT, IDEAL, LENS, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_CURVE: Any = {"width": 560, "height": 380}  # px on the page
_HIGHEST = 3.2  # focal lengths from the middle, of the curves over an angle


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
    ax = drawn_on(ax, **_CURVE)
    r = np.linspace(0, up_to, 400)
    observed = r * lens.L(r)
    good = r <= lens.max_radius
    top = 1.1 * max(float(np.max(observed[good])), 0.5 * up_to)
    ax.plot(r, r, ":", color=IDEAL, lw=1.5)
    ax.plot(r[good], observed[good], color=LENS, lw=2.5)
    if not good.all():
        end = lens.max_radius
        ax.plot(r[~good], observed[~good], "--", color=ESTIMATED, lw=2)
        ax.axvline(end, color=ESTIMATED, lw=1)
        beside(ax, f"max_radius = {end:.2f}", (end, 0), (6, 8), ESTIMATED)
        falls = 0.5 * (end + up_to)
        at = falls, falls * float(lens.L(falls))
        beside(ax, "beyond the fold:\nno lens", at, (8, 4), ESTIMATED)
    beside(ax, "an ideal lens", (0.9 * min(top, up_to),) * 2, (-9, 0), IDEAL, ha="right")
    within = 0.75 * min(lens.max_radius, up_to)
    beside(ax, "r L(r)", (within, within * float(lens.L(within))), (2, -18), LENS)
    ax.set(xlabel="ideal radius r", ylabel="observed radius r'", xlim=(0, up_to), ylim=(0, top))
    ax.locator_params(nbins=5)
    return ax


def draw_newton(lens: Lens, r_lens: float, *, ax: "Axes | None" = None) -> "Axes":
    """Draw three of Newton's steps: from r' along tangents of the curve r L(r) to the level r'.

    Parameters
    ----------
    lens : Lens
        Its radial part is inverted.
    r_lens : float
        The observed radius r', below the fold's; the first guess of r, too.

    Examples
    --------
    >>> ax = draw_newton(Lens(k=(-0.4,)), 0.55)
    >>> [text.get_text() for text in ax.texts][:2]
    ["r' = 0.55", 'r₀']
    """
    r = r_lens = length(r_lens, "r_lens")
    reach = min(thing(lens, "lens", Lens).max_radius, 2.5 * r_lens)
    if reach * float(lens.L(reach)) < r_lens:
        raise CvnotesError(f"r' = {r_lens:g} is beyond the fold: no r is shown there")
    ax = drawn_on(ax, **_CURVE)
    low = max(0.0, r - 0.1 * (reach - r))
    fine = np.linspace(low, reach, 300)
    ax.plot(fine, fine * lens.L(fine), color=LENS, lw=2.5)
    ax.axhline(r_lens, color=IDEAL, lw=1)
    beside(ax, f"r' = {r_lens:g}", (reach, r_lens), (-6, -16), IDEAL, ha="right")
    tiny = 1e-6
    for i in "₀₁₂":
        value = r * float(lens.L(r))
        slope = ((r + tiny) * float(lens.L(r + tiny)) - value) / tiny
        following = r - (value - r_lens) / slope
        ax.plot([r, r, following], [r_lens, value, r_lens], color=ESTIMATED, lw=1.3)
        ax.plot(r, value, "x", color=ESTIMATED, ms=7)
        beside(ax, f"r{i}", (r, r_lens), (-4, 6), ESTIMATED, ha="right")
        r = following
    name = low + 0.25 * (reach - low)
    beside(ax, "r L(r)", (name, name * float(lens.L(name))), (8, -10), LENS)
    ax.set(xlim=(low, reach), ylim=(low * float(lens.L(low)), 1.05 * reach * float(lens.L(reach))))
    ax.set(xlabel="ideal radius r", ylabel="observed radius r'")
    ax.locator_params(nbins=5)
    return ax


def draw_angles(lenses: Mapping[str, AnyLens], *, ax: "Axes | None" = None) -> "Axes":
    """Draw how far from the middle each lens shows a ray, over the ray's angle from the axis.

    Parameters
    ----------
    lenses : mapping from names to Lens, RationalLens or FisheyeLens
        Up to five. The plane z = 1 ends at 90°, and with it a `Lens`.

    Examples
    --------
    >>> from cvnotes.camera import FisheyeLens
    >>> draw_angles({"pinhole": Lens(), "fisheye": FisheyeLens()}).get_xlabel()
    'angle θ from the axis (degrees)'
    """
    colours = (IDEAL, LENS, COLOURS["camera"], COLOURS["world"], ESTIMATED)
    if not isinstance(lenses, Mapping) or not 1 <= len(lenses) <= len(colours):
        raise CvnotesError(f"lenses: expected one to {len(colours)} by name")
    ax = drawn_on(ax, **_CURVE)
    theta = np.linspace(0, 2.1, 400)[1:]
    M = np.stack([np.sin(theta), 0 * theta, np.cos(theta)], axis=-1)
    for i, ((name, lens), colour) in enumerate(zip(lenses.items(), colours, strict=False)):
        shown = _lens(lens, name).of_rays(M)[:, 0]
        ax.plot(np.degrees(theta), shown, color=colour, lw=2.5)
        last = int(np.flatnonzero(shown <= _HIGHEST).max(initial=0))
        # The names of curves that leave at the top stand at their right and left by turns.
        by = (-4, 8) if last == theta.size - 1 else (-12, -12) if i % 2 else (8, -12)
        ha = "right" if by[0] < 0 else "left"
        at = np.degrees(theta[last]), shown[last]
        beside(ax, name, at, by, colour, ha=ha, path_effects=halo())
    ax.axvline(90, color=MUTED, ls=":")
    words = "here the plane z = 1 ends"
    beside(ax, words, (90, 0), (-5, 8), MUTED, ha="right", fontsize=FONT - 1)
    ax.set(xlabel="angle θ from the axis (degrees)", ylabel="distance from the middle, in f")
    ax.set(xlim=(0, np.degrees(2.1)), ylim=(0, _HIGHEST))
    ax.set(xticks=range(0, 121, 30), yticks=range(4))
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


def _lens(x: Any, name: str) -> AnyLens:
    """Guard a lens of any kind."""
    if not isinstance(x, AnyLens):
        raise InputTypeError(f"{name}: expected a Lens, got {type(x).__name__}")
    return x
