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
    """Draw a corner response: blue where it is positive, grey where negative.

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
    colours = LinearSegmentedColormap.from_list("response", [MUTED, "white", COLOURS["lens"]])
    ax.imshow(rooted, cmap=colours, vmin=-reach, vmax=reach)
    ax.set_title(title)
    return as_picture(ax, (R.shape[1], R.shape[0]))


def draw_clouds(errors: Mapping[str, npt.ArrayLike], *, reach: float | None = None) -> "Axes":
    """Draw the errors of several methods as clouds about the truth, in a pixel and enlarged.

    A ring about the truth is as large as the RMS of one coordinate.

    Parameters
    ----------
    errors : mapping from name to array_like of shape (n, 2)
        Measured minus true positions, px.
    reach : float, optional
        Half the side of the enlarged part, px; by default 98 % of all errors fit.

    Returns
    -------
    Axes
        The enlargement; the pixel stands beside it.

    Examples
    --------
    >>> draw_clouds({"a": [[0, 0.1]], "b": [[0.1, 0]]}).texts[0].get_text()
    'a: 0.071 px'
    """
    from matplotlib.patches import Circle, ConnectionPatch, Rectangle

    if len(thing(errors, "errors", Mapping)) < 2:  # type: ignore[type-abstract]
        raise CvnotesError("errors: expected at least two methods to compare")
    clouds = {name: points(e, name, 2).reshape(-1, 2) for name, e in errors.items()}
    if not all(map(len, clouds.values())):
        raise DegenerateError("errors: expected at least one error of each method")
    if reach is None:
        reach = float(np.percentile(np.abs(np.concatenate(list(clouds.values()))), 98)) * 1.2 or 1.0
    reach = length(reach, "reach")
    pixel, near = panels(2, width=900, height=452)
    pixel.fill([-0.5, 0.5, 0.5, -0.5], [-0.5, -0.5, 0.5, 0.5], "#E4E4E4")
    for i, (name, cloud) in enumerate(clouds.items()):
        colour, rms = _CLOUDS[i % 3], float(np.sqrt((cloud**2).mean()))
        for ax, size in ((pixel, 2.0), (near, 6.0)):
            ax.plot(*cloud.T, ".", color=colour, ms=size, alpha=0.5, mew=0)
        near.add_patch(Circle((0, 0), rms, ec=colour, fc="none", lw=1.5))
        near.annotate(
            f"{name}: {rms:.3f} px", (0.7 * rms, 0.7 * rms * (-1) ** i), color=colour,
            xytext=(0.97, 0.04 + 0.9 * i / (len(clouds) - 1)), textcoords="axes fraction",
            ha="right", arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.8},
        )  # fmt: skip
    for ax, half, size in ((pixel, max(0.52, 1.2 * reach), 5), (near, reach, 12)):
        ax.plot(0, 0, "+", color=IDEAL, ms=size, mew=1.2)
        ax.set(xlim=(-half, half), ylim=(half, -half), aspect="equal", xticks=[], yticks=[])
        ax.spines[:].set(visible=ax is near, color=MUTED)
    pixel.add_patch(Rectangle((-reach, -reach), 2 * reach, 2 * reach, fc="none", ec=MUTED, lw=0.8))
    for v in (-reach, reach):
        ends = {"xyA": (reach, v), "xyB": (-reach, v), "axesA": pixel, "axesB": near}
        pixel.figure.add_artist(ConnectionPatch(**ends, coordsA="data", color=MUTED, lw=0.8))
    pixel.set_title("one pixel, and the errors in it")
    near.set_title(f"its middle {2 * reach:.2g} px")
    enlarged: Axes = near
    return enlarged
