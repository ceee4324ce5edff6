"""Sets of photographs at a glance."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import ShapeError
from cvnotes.show.axes import panels
from cvnotes.show.guards import eight_bits, pictures

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_wall(images: Sequence[npt.ArrayLike]) -> "Axes":
    """Draw small copies of grey pictures, five in a row, as on a contact sheet.

    Parameters
    ----------
    images : sequence of array_like, shape (height, width)
        All of one size.

    Examples
    --------
    >>> draw_wall([np.zeros((48, 64), np.uint8)] * 3).axison
    False
    """
    small = [eight_bits(image, "images")[::4, ::4] for image in pictures(images, "images")]
    if small[0].ndim != 2:
        raise ShapeError(f"images: expected grey pictures, got colours, {small[0].shape}")
    columns, gap = 5, 4
    rows = -(-len(small) // columns)
    h, w = small[0].shape
    wall = np.full((rows * (h + gap) - gap, columns * (w + gap) - gap), 255, np.uint8)
    for i, image in enumerate(small):
        top, left = (i // columns) * (h + gap), (i % columns) * (w + gap)
        wall[top : top + h, left : left + w] = image
    ax: Axes = panels(height=min(max(round(640 * len(wall) / wall.shape[1]), 60), 1200))
    ax.imshow(wall, cmap="gray", vmin=0, vmax=255)
    ax.axis("off")
    return ax
