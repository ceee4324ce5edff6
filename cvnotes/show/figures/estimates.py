"""A figure of an estimate: how far what it predicts is from the truth."""

from typing import TYPE_CHECKING

import numpy.typing as npt

from cvnotes.base import ShapeError, number, paired, points
from cvnotes.show.axes import as_picture, drawn_on
from cvnotes.show.style import ESTIMATED, LENS

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_plane_error(
    m: npt.ArrayLike,
    predicted: npt.ArrayLike,
    *,
    ax: "Axes | None" = None,
    magnify: float = 10.0,
    title: str = "",
) -> "Axes":
    """Draw how far predicted points are from the true ones, as magnified arrows.

    Parameters
    ----------
    m, predicted : array_like, shape (n, 2)
        True and predicted pixels.
    magnify : float
        How much longer than true the arrows are; said in the title.

    Examples
    --------
    >>> draw_plane_error([[0, 0], [9, 9]], [[1, 0], [9, 9]], title="two points").get_title()
    'two points (arrows × 10)'
    """
    m, predicted = points(m, "m", 2), points(predicted, "predicted", 2)
    paired(m, predicted, ("m", "predicted"), at_least=1)
    if m.ndim != 2 or m.shape != predicted.shape:
        raise ShapeError(f"m and predicted: expected (n, 2), got {m.shape} and {predicted.shape}")
    magnify = number(magnify, "magnify")
    ax = drawn_on(ax)
    d = magnify * (predicted - m)
    ax.plot(*m.T, "o", color=LENS, ms=3)
    arrows = ax.quiver(
        *m.T, *d.T, color=ESTIMATED, angles="xy", scale_units="xy", scale=1, width=0.005,
        minshaft=2, clip_on=False,
    )  # fmt: skip
    arrows.set_in_layout(False)  # one that leads out of the picture leaves it as large as it is
    if not ax.images:  # (else the photograph says what is shown)
        low, high = m.min(0), m.max(0)  # of the points alone, so that two figures can be compared
        room = max(0.15 * float((high - low).max()) + 1, 1e-9 * float(abs(m).max()))
        as_picture(ax, (2, 2))
        ax.set(xlim=(low[0] - room, high[0] + room), ylim=(high[1] + room, low[1] - room))
    ax.set_title(f"{title} (arrows × {magnify:g})".strip())
    return ax
