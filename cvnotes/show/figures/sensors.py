"""Figures of the sensor: its lines and its pixels."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, image_size, intrinsic_matrix
from cvnotes.camera import Camera, xy_from_px
from cvnotes.pictures import render_scene, room
from cvnotes.show.axes import arrow, beside, drawn_on, halo, letter
from cvnotes.show.figures.images import draw_image
from cvnotes.show.guards import one_point
from cvnotes.show.guards import picture as checked
from cvnotes.show.style import CAMERA, ESTIMATED, FONT, LENS, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_sensor(A: npt.ArrayLike, *, ax: "Axes | None" = None) -> "Axes":
    """Draw a sensor on the plane z = 1, with what it sees of a room: its axes may lean.

    Parameters
    ----------
    A : array_like, shape (3, 3)
        Intrinsic matrix of a sensor of 640 × 480 pixels; a cell stands for 20 × 20 of them.

    Examples
    --------
    >>> draw_sensor([[800, 0, 320], [0, 800, 240], [0, 0, 1]]).collections[0].get_array().shape
    (24, 32, 3)
    """
    A, step = intrinsic_matrix(A), 80
    ax = drawn_on(ax, height=400)
    seen = render_scene(room(), Camera(A, size=(640, 480)), samples=1)
    corners = np.stack(np.meshgrid(np.arange(0, 641, 20), np.arange(0, 481, 20)), axis=-1) - 0.5
    cells = seen.reshape(24, 20, 32, 20, 3).mean(axis=(1, 3)) / 255
    ax.pcolormesh(*np.moveaxis(xy_from_px(A, corners), -1, 0), cells, ec=MUTED, lw=0.3)
    start, *tips = xy_from_px(A, [[0, 0], [2 * step, 0], [0, 2 * step]])
    for tip, name in zip(tips, "uv", strict=True):
        arrow(ax, start, tip, LENS, 2.2, gap=2)
        letter(ax, name, 1.2 * tip - 0.2 * start, LENS, fontsize=FONT + 2)
    first, last = (np.arctan2(*(tip - start)[::-1]) for tip in tips)
    arc = np.linspace(first, last, 25)[:, None]
    reach = 0.4 * float(np.linalg.norm(tips[0] - start))
    ax.plot(*(start + reach * np.hstack([np.cos(arc), np.sin(arc)])).T, color=ESTIMATED, lw=1.8)
    middle = start + 1.5 * reach * np.hstack([np.cos(arc), np.sin(arc)])[12]
    letter(ax, "θ", middle, ESTIMATED)
    ax.plot(0, 0, "^", color=CAMERA, ms=8)
    beside(ax, "(u0, v0)", (0, 0), (8, 8), CAMERA, path_effects=halo())
    ax.set_aspect("equal")
    ax.axis("off")
    ax.invert_yaxis()
    return ax


def draw_pixels(
    image: npt.ArrayLike,
    corner: tuple[int, int],
    size: tuple[int, int] = (8, 6),
    *,
    ax: "Axes | None" = None,
) -> "Axes":
    """Draw a few pixels of a picture as the squares they are, with their centres and numbers.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3)
        The picture.
    corner : (u, v)
        The first pixel to show.
    size : (columns, rows)
        How many.

    Examples
    --------
    >>> draw_pixels(np.zeros((48, 64), np.uint8), (0, 0), (4, 3)).get_xlim()
    (np.float64(-0.5), np.float64(3.5))
    """
    from matplotlib.patches import Rectangle

    picture, (columns, rows) = checked(image), image_size(size)
    first = one_point(corner, "corner", 2)
    if (first < 0).any() or (first + size > picture.shape[1::-1]).any():
        raise CvnotesError("these pixels are not inside of the picture")
    u0, v0 = np.rint(first).astype(int)
    ax = drawn_on(ax, width=560)
    draw_image(picture, ax=ax, ticks=True)
    for u in range(u0, u0 + columns):
        for v in range(v0, v0 + rows):
            ax.add_patch(Rectangle((u - 0.5, v - 0.5), 1, 1, fc="none", ec=MUTED, lw=0.8))
    centres = np.mgrid[u0 : u0 + columns, v0 : v0 + rows].reshape(2, -1)
    ax.plot(*centres, "o", color=MUTED, ms=4, mec="white", mew=0.8)
    ax.set(xlim=(u0 - 0.5, u0 + columns - 0.5), ylim=(v0 + rows - 0.5, v0 - 0.5))
    ax.set(xticks=range(u0, u0 + columns), yticks=range(v0, v0 + rows))
    return ax
