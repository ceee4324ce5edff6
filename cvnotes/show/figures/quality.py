"""Figures of how good a calibration is: its residuals, its views, and what they cover.

Like all ``draw_<thing>(data, *, ax=None)``: they draw on the axes they are given, or on new ones,
and return them.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, image_size, number
from cvnotes.base.digits import round_number
from cvnotes.calibration.coverage import count_cells
from cvnotes.show.axes import as_picture, drawn_on, letter
from cvnotes.show.guards import calibrated
from cvnotes.show.style import ESTIMATED, IDEAL

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from cvnotes.calibration import Calibration


def draw_residuals(
    calibration: "Calibration", *, ax: "Axes | None" = None, magnify: float | None = None
) -> "Axes":
    """Draw where each corner was seen relative to where the camera predicts it, magnified.

    Arrows that point all over the place are noise; arrows that agree with their neighbours are
    something the model does not describe.

    Parameters
    ----------
    calibration : Calibration
        With its corners.
    magnify : float, optional
        How much longer than true the arrows are; by default a round number that makes the longer
        ones 4 % of the picture's width.
    """
    m, r = _corners_of(calibration), np.concatenate(calibration.residuals)
    width = calibration.size[0]
    longer = float(np.percentile(np.hypot(*r.T), 95))
    if magnify is None:
        magnify = round_number(0.04 * width / longer) if longer > 0 else 1.0
    magnify = number(magnify, "magnify")
    ax = as_picture(drawn_on(ax, calibration.size), calibration.size, ticks=False)
    ax.quiver(
        *(m - r).T, *(r * magnify).T, color=ESTIMATED, alpha=0.7, angles="xy", scale_units="xy",
        scale=1, units="width", width=0.002, headwidth=3, headlength=3.5, headaxislength=3,
        minlength=0,
    )  # fmt: skip
    ax.set_title(f"residuals × {magnify:g}, RMS {calibration.rms:.3f} px per point")
    return ax


def draw_coverage(
    image_points: npt.ArrayLike | Sequence[npt.ArrayLike],
    size: tuple[int, int],
    *,
    ax: "Axes | None" = None,
) -> "Axes":
    """Draw how many corners there are in each cell of the picture: the more, the darker it is.

    The lens is known where corners were; in the empty cells, which are hatched, it is guessed.

    Parameters
    ----------
    image_points : array_like, shape (views, n, 2) or (n, 2), or a list of (n_i, 2)
        Pixels.
    size : (width, height)
        Size of the picture.

    Examples
    --------
    >>> draw_coverage([[[10, 10], [600, 400]]], (640, 480)).get_title()
    'corners in 2 of 48 cells of the picture'
    """
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.patches import Rectangle

    size = image_size(size)
    count = count_cells(image_points, size)
    side = np.array(size) / count.shape
    ax = as_picture(drawn_on(ax, size), size, ticks=False)
    tint = LinearSegmentedColormap.from_list("", ["#FFF6EE", "#F6B07A", "#E37A26"])
    for cell, corners in np.ndenumerate(count):
        u, v = (np.array(cell) * side - 0.5).tolist()
        look: dict[str, Any] = {"fc": tint((corners / max(count.max(), 1)) ** 0.6), "ec": "white"}
        if not corners:
            look = {"fc": "#EEEEEE", "ec": "#C4C4C4", "hatch": "//"}
        ax.add_patch(Rectangle((u, v), *side, **look))
        if corners:
            letter(ax, f"{corners}", (u + side[0] / 2, v + side[1] / 2), IDEAL, path_effects=[])
    ax.set_title(f"corners in {(count > 0).sum()} of {count.size} cells of the picture")
    return ax


def _corners_of(calibration: "Calibration") -> Array:
    """Return all image points (n, 2) of a calibration that still has them."""
    calibrated(calibration)
    if not calibration.image_points:
        raise DegenerateError("this calibration was read from a file that has no corners")
    return np.concatenate(calibration.image_points)
