"""Axes of the course's figures: empty ones, those of a picture, words and arrows on them."""

import logging
import sys
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from cvnotes.base import InputTypeError, image_size, whole
from cvnotes.show.style import DPI, FAINT, FONT, INK, MUTED
from cvnotes.show.typeface import enlargement, font_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

if sys.platform == "emscripten":  # matplotlib warns there, in red, each time it lists its fonts
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)


def panels(
    columns: int = 1, rows: int = 1, *, width: int = 640, height: int | None = None, **kwargs: Any
) -> Any:
    """Make empty axes for figures that stand side by side.

    Parameters
    ----------
    columns, rows : int
        How many.
    width, height : int
        Size of the whole on the page, in px; by default each panel is three quarters as high
        as it is wide.
    **kwargs
        Passed to ``Figure.subplots``.

    Returns
    -------
    Axes, or ndarray of Axes
        One, a row of them, or rows of them. They belong to a figure of their own that no global
        state knows, so that nothing has to be closed.

    Examples
    --------
    >>> left, right = panels(2)
    >>> left.figure is right.figure
    True
    """
    columns, rows = whole(columns, "columns", at_most=99), whole(rows, "rows", at_most=99)
    width = whole(width, "width")
    if height is None:
        height = round(0.75 * width / columns * rows)
    height = whole(height, "height")
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **kwargs)
    for ax in axes.flat:
        dress(ax)
    if rows > 1:
        return axes
    return axes[0] if columns > 1 else axes[0, 0]


def dress(ax: "Axes") -> "Axes":
    """Return axes the course's look: a light frame, small type."""
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["left", "bottom"]].set_color(FAINT)
    size = enlargement() * (FONT - 1)
    ax.tick_params(labelsize=size, labelfontfamily=_family(), color=FAINT, labelcolor="#333333")
    ax.title.set_fontsize(FONT)
    ax.title.set_color("#333333")
    for axis in (ax.xaxis, ax.yaxis):
        axis.label.set_fontsize(FONT)
    return ax


def set_words(figure: "Figure") -> None:
    """Draw words in the course's type and in their darker ink, and titles from the left."""
    from matplotlib.colors import to_hex
    from matplotlib.text import Text

    found: list[Any] = figure.findobj(Text)
    for words in found:
        colour = to_hex(words.get_color()).upper()
        words.set_color(INK.get(colour, colour))
        if words.get_fontfamily() != _family():
            words.set(fontfamily=_family(), fontsize=enlargement() * words.get_fontsize())
    for ax in figure.axes:
        ax.title.set(x=0, ha="left")  # here: each set_title puts it back into the middle


@lru_cache(maxsize=1)
def _family() -> list[str]:
    """Tell matplotlib of the course's type, and how to ask for it; the rest has its own."""
    from matplotlib.font_manager import FontProperties, fontManager

    for face in ("Regular", "Bold"):
        fontManager.addfont(font_file().with_name(font_file().name.replace("Regular", face)))
    return [FontProperties(fname=font_file()).get_name(), "DejaVu Sans"]


def halo() -> list[Any]:
    """Return the white rim that keeps words and lines readable over a picture."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=3, foreground="white")]


def picture_axes(size: tuple[int, int]) -> Any:
    """Make axes that fit a picture of (width, height): 640 px wide, not absurdly high."""
    width, height = size
    return panels(height=round(min(max(560 * height / width, 160), 760) + 60))


def drawn_on(ax: "Axes | None", size: tuple[int, int] | None = None, **shape: int) -> "Axes":
    """Return the axes to draw on: those given, or new ones, for a picture of (width, height).

    Examples
    --------
    >>> drawn_on(None, (64, 48)).get_xlim()
    (np.float64(0.0), np.float64(1.0))
    """
    from matplotlib.axes import Axes

    if ax is None:
        new: Axes = panels(**shape) if size is None else picture_axes(size)
        return new
    if not isinstance(ax, Axes):
        raise InputTypeError(
            f"ax: expected the axes of one panel, got {type(ax).__name__}; of several panels "
            "take one: left, right = panels(2)"
        )
    return ax


def pixel_axes(ax: "Axes | None", size: tuple[int, int]) -> "Axes":
    """Return axes for pixels: those that there are, or new ones for a picture of a size.

    Examples
    --------
    >>> pixel_axes(None, (64, 48)).get_xlabel()
    'u (px)'
    """
    new = ax is None
    ax = drawn_on(ax, image_size(size))
    return as_picture(ax, size) if new else ax


def as_picture(ax: "Axes", size: tuple[int, int], *, ticks: bool = True) -> "Axes":
    """Let axes show pixels: v downwards, equal scales, a picture's limits, units in the labels."""
    width, height = size
    ax.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5), aspect="equal")
    if ticks:
        ax.set(xlabel="u (px)", ylabel="v (px)")
    else:
        ax.set(xticks=[], yticks=[])
    ax.spines[:].set(visible=True, color=MUTED)
    return ax


def beside(ax: "Axes", text: str, at: Any, by: Any, colour: str | None = None, **more: Any) -> None:
    """Write words beside a place: `by` so many points of paper, to the right and upwards."""
    ax.annotate(text, at, by, textcoords="offset points", color=colour, **more)


def letter(ax: "Axes", text: str, at: Any, colour: str, **more: Any) -> None:
    """Write words about a place, with the white rim."""
    style = {"ha": "center", "va": "center", "path_effects": halo(), **more}
    ax.text(at[0], at[1], text, color=colour, **style)


def arrow(
    ax: "Axes", start: Any, end: Any, colour: str, width: float, gap: float = 0, **more: Any
) -> None:
    """Draw an arrow from one place to another, or to so many points of paper before it."""
    style = {"arrowstyle": "-|>", "color": colour, "lw": width, "shrinkA": gap, "shrinkB": gap}
    ax.annotate("", tuple(end), tuple(start), arrowprops=style, **more)
