"""Figures of corners: how strongly pixels look like one, and how far off measured ones are."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, DegenerateError, ShapeError, numbers, points
from cvnotes.show.axes import as_picture, drawn_on, panels
from cvnotes.show.guards import length, thing
from cvnotes.show.style import COLOURS, ESTIMATED, IDEAL, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_CLOUDS = (COLOURS["lens"], ESTIMATED, COLOURS["world"])


def draw_response(response: npt.ArrayLike, *, ax: "Axes | None" = None, title: str = "") -> "Axes":
    """Draw a corner response: violet where it is positive, grey where negative.

    Parameters
    ----------
    response : array_like, shape (height, width)
        As `harris` gives it. Its fourth root is drawn, with its sign, because corners are
        thousands of times stronger than anything else.

    Examples
    --------
    >>> draw_response([[1.0, -1.0], [0.0, 2.0]]).get_ylabel()
    'v (px)'
    """
    from matplotlib.colors import LinearSegmentedColormap

    R = numbers(response, "response")
    if R.ndim != 2 or R.size == 0:
        raise ShapeError(f"response: expected (height, width), got {R.shape}")
    ax = drawn_on(ax, height=480)
    rooted = np.sign(R) * np.abs(R) ** 0.25
    reach = float(np.abs(rooted).max()) or 1.0
    colours = LinearSegmentedColormap.from_list("response", ["#6E6E6E", "white", "#54278F"])
    ax.imshow(rooted, cmap=colours, vmin=-reach, vmax=reach)
    ax.set_title(title)
    return as_picture(ax, (R.shape[1], R.shape[0]))


def draw_clouds(errors: Mapping[str, npt.ArrayLike], *, reach: float | None = None) -> "Axes":
    """Draw the errors of several methods as clouds about the truth, one panel for each.

    Parameters
    ----------
    errors : mapping from name to array_like of shape (n, 2)
        Measured minus true positions, px.
    reach : float, optional
        Half the side of the panels, px; by default 98 % of all errors fit.

    Returns
    -------
    Axes
        The first panel; the others stand beside it.

    Examples
    --------
    >>> draw_clouds({"a": [[0, 0.1]], "b": [[0.1, 0]]}).get_xlabel()
    'error along u (px)'
    """
    if len(thing(errors, "errors", Mapping)) < 2:  # type: ignore[type-abstract]
        raise CvnotesError("errors: expected at least two methods to compare")
    clouds = {name: points(e, name, 2).reshape(-1, 2) for name, e in errors.items()}
    if not all(map(len, clouds.values())):
        raise DegenerateError("errors: expected at least one error of each method")
    if reach is None:
        reach = float(np.percentile(np.abs(np.concatenate(list(clouds.values()))), 98)) * 1.2 or 1.0
    reach = length(reach, "reach")
    axes = panels(len(clouds), width=900, height=round(900 / len(clouds)) + 40)
    for ax, (name, cloud), i in zip(axes, clouds.items(), range(len(clouds)), strict=True):
        ax.axhline(0, color=MUTED, lw=0.6)
        ax.axvline(0, color=MUTED, lw=0.6)
        ax.plot(*cloud.T, ".", color=_CLOUDS[i % 3], ms=5, alpha=0.6)
        ax.plot(0, 0, "+", color=IDEAL, ms=12, mew=2)
        rms = np.sqrt((cloud**2).mean())
        ax.set(title=f"{name}: {rms:.3f} px", xlabel="error along u (px)", aspect="equal")
        ax.set(xlim=(-reach, reach), ylim=(reach, -reach))
    axes[0].set_ylabel("error along v (px)")
    first: Axes = axes[0]
    return first
