"""A figure of the sensor, whose axes may lean."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import intrinsic_matrix
from cvnotes.camera import Camera, xy_from_px
from cvnotes.pictures import render_scene, room
from cvnotes.show.axes import arrow, beside, drawn_on, halo, letter
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
    for tip, name, outside in zip(tips, "uv", ((-8, 8), (-12, 4)), strict=True):
        arrow(ax, start, tip, LENS, 2.2, gap=2)
        beside(ax, name, tip, outside, LENS, fontsize=FONT + 2, fontstyle="italic")
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
