"""The figure of how good a calibration is: its residuals.

Like all ``draw_<thing>(data, *, ax=None)``: it draws on the axes it is given, or on new ones, and
returns them.
"""

from typing import TYPE_CHECKING

import numpy as np

from cvnotes.base import Array, DegenerateError, number
from cvnotes.base.digits import round_number
from cvnotes.show.axes import as_picture, drawn_on
from cvnotes.show.guards import calibrated
from cvnotes.show.style import ESTIMATED

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


def _corners_of(calibration: "Calibration") -> Array:
    """Return all image points (n, 2) of a calibration that still has them."""
    calibrated(calibration)
    if not calibration.image_points:
        raise DegenerateError("this calibration was read from a file that has no corners")
    return np.concatenate(calibration.image_points)
