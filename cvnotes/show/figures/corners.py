"""Figures of corners: how strongly pixels look like one, and how far off measured ones are."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import ShapeError, numbers
from cvnotes.show.axes import as_picture, drawn_on
from cvnotes.show.style import COLOURS, ESTIMATED, MUTED

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
