"""Figures of what a calibration is worth, and of sets of photographs at a glance."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, ShapeError, number
from cvnotes.calibration import Calibration, prediction_std
from cvnotes.show.axes import as_picture, drawn_on, letter, panels
from cvnotes.show.guards import calibrated, count, eight_bits, pictures
from cvnotes.show.style import ESTIMATED, FONT, IDEAL, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_RIM = 0.08  # of the picture's height, above and below a map


def draw_prediction_error(
    calibration: Calibration,
    *,
    ax: "Axes | None" = None,
    between: tuple[float, float] | None = None,
) -> "Axes":
    """Draw, over the picture, how far off the image of a fixed ray may be: the darker, the farther.

    Parameters
    ----------
    calibration : Calibration
        Its corners, if it has them, are drawn too: where they end, extrapolation begins.
    between : (least, most), optional
        Deviations in px at the ends of the colours, so that two maps can be compared; by default
        those of this map.
    """
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.patches import Rectangle
    from matplotlib.ticker import MaxNLocator

    calibrated(calibration)
    w, h = calibration.size
    ax = drawn_on(ax, calibration.size)
    u, v = np.meshgrid(np.linspace(0, w - 1, 65), np.linspace(0, h - 1, 49))
    std = prediction_std(calibration, np.stack([u, v], axis=-1))
    least, most = float(np.nanmin(std)), float(np.nanmax(std))
    if between is not None:
        least, most = (number(x, "between", at_least=0) for x in between)
        if not least < most:
            raise CvnotesError(f"between: expected (least, most), got ({least:g}, {most:g})")
    levels = MaxNLocator(6).tick_values(least, most)[1:]
    colours = LinearSegmentedColormap.from_list("", ["white", ESTIMATED])
    box = -0.5, w - 0.5, h - 0.5, -0.5
    ax.imshow(std, cmap=colours, vmin=least, vmax=most, extent=box, interpolation="bilinear")
    ax.contour(u, v, std, levels=levels, colors="white", linewidths=0.8)
    for m in calibration.image_points:
        ax.plot(*m.T, ".", color=MUTED, ms=1.5)
    for i, j in ((0, 0), (0, 64), (24, 32), (48, 0), (48, 64)):  # in the corners and the middle
        side, words = ("left", "center", "right")[j // 32], f"{std[i, j]:#.2g}"
        at = u[i, j], -_RIM * h / 2 if i == 0 else (1 + _RIM / 2) * h
        words = f"{words} in the middle" if i == 24 else words
        letter(ax, words, at, IDEAL, fontsize=FONT, path_effects=[], ha=side)
    ax.set_title(f"σ of a pixel: {levels[1] - levels[0]:.2g} px from line to line")
    as_picture(ax, calibration.size, ticks=False)
    border = Rectangle((-0.5, -0.5), w, h, fill=False, ec=MUTED, lw=0.8, clip_on=False)
    ax.add_patch(border)  # of the picture alone: the axes reach beyond it
    ax.spines[:].set_visible(False)
    ax.set_ylim((1 + _RIM) * h, -_RIM * h)  # room for the numbers of the corners
    return ax


def draw_wall(images: Sequence[npt.ArrayLike], *, columns: int = 5) -> "Axes":
    """Draw small copies of grey pictures side by side, as on a contact sheet.

    Parameters
    ----------
    images : sequence of array_like, shape (height, width)
        All of one size.
    columns : int
        Pictures in a row.

    Examples
    --------
    >>> draw_wall([np.zeros((48, 64), np.uint8)] * 3, columns=3).axison
    False
    """
    small = [eight_bits(image, "images")[::4, ::4] for image in pictures(images, "images")]
    if small[0].ndim != 2:
        raise ShapeError(f"images: expected grey pictures, got colours, {small[0].shape}")
    columns = count(columns, "columns")
    rows, gap = -(-len(small) // columns), 4
    h, w = small[0].shape
    wall = np.full((rows * (h + gap) - gap, columns * (w + gap) - gap), 255, np.uint8)
    for i, image in enumerate(small):
        top, left = (i // columns) * (h + gap), (i % columns) * (w + gap)
        wall[top : top + h, left : left + w] = image
    ax: Axes = panels(height=min(max(round(640 * len(wall) / wall.shape[1]), 60), 1200))
    ax.imshow(wall, cmap="gray", vmin=0, vmax=255)
    ax.axis("off")
    return ax
