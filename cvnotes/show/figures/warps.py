"""Figures of warps: pixels hit or missed, the cell between four pixels, rows and disparity."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import CvnotesError, ShapeError, number, numbers
from cvnotes.show.axes import beside, drawn_on
from cvnotes.show.figures.images import draw_image
from cvnotes.show.guards import eight_bits, one_point
from cvnotes.show.style import CAMERA, ESTIMATED, FONT, IDEAL, LENS, MUTED, WORLD

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_forward(
    image: npt.ArrayLike, hits: npt.ArrayLike, *, ax: "Axes | None" = None, title: str = ""
) -> "Axes":
    """Draw a picture that was warped forward, with its holes in orange.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3)
        The picture, grey levels from 0 to 255.
    hits : array_like, shape (height, width)
        How often each pixel was hit; both as `forward_warp` gives them.

    Examples
    --------
    >>> ax = draw_forward([[0, 255]], [[0, 1]])
    >>> ax.images[0].get_array().tolist()
    [[[213, 94, 0], [255, 255, 255]]]
    """
    from matplotlib.colors import to_rgb

    picture, counts = eight_bits(image, "image"), numbers(hits, "hits")
    if counts.shape != picture.shape[:2]:
        raise ShapeError(f"hits: expected {picture.shape[:2]} as the image, got {counts.shape}")
    rgb = picture.copy() if picture.ndim == 3 else np.repeat(picture[..., None], 3, axis=2)
    rgb[counts == 0] = np.rint(255 * np.array(to_rgb(ESTIMATED)))
    return draw_image(rgb, ax=ax, title=title)


def draw_cell(
    values: npt.ArrayLike,
    du: float,
    dv: float,
    *,
    ax: "Axes | None" = None,
    areas: bool = False,
    solved: bool = True,
) -> "Axes":
    """Draw the four pixels I1 to I4 around a point, and the way to its interpolated value.

    Parameters
    ----------
    values : array_like, shape (4,)
        Grey values I1 (top left), I2 (top right), I3 (bottom left), I4 (bottom right).
    du, dv : float
        Fractions of the point, in [0, 1].
    areas : bool
        Shade the four rectangles, the larger the darker, and write into each the pixel of which
        it is the weight.
    solved : bool
        Write the values between the pixels, too.

    Examples
    --------
    >>> draw_cell([0, 10, 20, 30], 0.5, 0.5).texts[-1].get_text()
    'I = 15'
    """
    I1, I2, I3, I4 = grey = one_point(values, "values", 4).tolist()
    du, dv = number(du, "du"), number(dv, "dv")
    if not (0 <= du <= 1 and 0 <= dv <= 1):
        raise CvnotesError(f"du and dv are fractions, from 0 to 1; got {du:g} and {dv:g}")
    ax = drawn_on(ax, height=400)
    upper, lower = I1 + (I2 - I1) * du, I3 + (I4 - I3) * du
    ax.plot([0, 1, 1, 0, 0], [0, 0, 1, 1, 0], color=MUTED, lw=1)
    for (u, v), value, n in zip(((0, 0), (1, 0), (0, 1), (1, 1)), grey, "1234", strict=True):
        ax.plot(u, v, "o", color=LENS, ms=9)
        by = (0, 12 if v == 0 else -22)
        beside(ax, f"$I_{n}$ = {value:g}", (u, v), by, LENS, ha="center")
    if areas:
        _weights(ax, du, dv)
    ax.plot([du, du], [0, 1], ":", color=ESTIMATED)
    ax.plot(du, dv, "x", color=ESTIMATED, ms=10, mew=2)
    for v, name, value in ((0, "a", upper), (1, "b", lower)) if solved else ():
        ax.plot(du, v, "s", color=ESTIMATED, ms=6)
        by = (0, 12 if v == 0 else -22)
        beside(ax, f"$I_{name}$ = {value:g}", (du, v), by, ESTIMATED, ha="center")
    if solved:
        beside(ax, f"I = {upper + (lower - upper) * dv:g}", (du, dv), (10, -4), ESTIMATED)
    ax.set(xlim=(-0.25, 1.25), ylim=(1.25, -0.25), aspect="equal", xlabel="du", ylabel="dv")
    ax.set(xticks=[0, du, 1], yticks=[0, dv, 1])
    return ax


def _weights(ax: "Axes", du: float, dv: float) -> None:
    """Shade the rectangles around a point; each is the weight of the pixel opposite to it."""
    from matplotlib.patches import Rectangle

    sides = ((0, du), (du, 1 - du)), ((0, dv), (dv, 1 - dv))
    for n in range(4):
        # The rectangle opposite to I1, top left, is the one at the bottom right.
        (u, wide), (v, high) = sides[0][1 - n % 2], sides[1][1 - n // 2]
        ax.add_patch(Rectangle((u, v), wide, high, fc=MUTED, alpha=wide * high, lw=0))
        words = f"$I_{n + 1}$ × {wide * high:.2f}"
        ax.text(u + wide / 2, v + high / 2 + 0.07, words, ha="center", fontsize=FONT)


def draw_disparity(point: npt.ArrayLike, b: float, f: float, *, ax: "Axes | None" = None) -> "Axes":
    """Draw two cameras side by side from above, a point, and the two similar triangles.

    Parameters
    ----------
    point : array_like, shape (2,)
        (X, Z) of the point, with the left camera in (0, 0) and Z forward.
    b : float
        Distance of the right camera, to the right.
    f : float
        Distance of both pictures in front of their cameras, in the same unit.

    Examples
    --------
    >>> draw_disparity([120, 400], 100, 150).get_title()
    'The orange triangle is the green one, smaller: d / α = b / Z'
    """
    X, Z = one_point(point, "point", 2).tolist()
    b, f = number(b, "b", at_least=1e-9), number(f, "f", at_least=1e-9)
    if not f < Z:
        raise CvnotesError(f"the point must lie beyond the pictures, Z > f; got {Z:g} and {f:g}")
    ax = drawn_on(ax, height=480)
    left, right = X * f / Z, (X - b) * f / Z  # in the frame of each camera
    ax.fill([0, b, X], [0, 0, Z], color=WORLD, alpha=0.18, lw=0)
    ax.fill([0, right, left], [0, f, f], color=ESTIMATED, alpha=0.45, lw=0)
    for x, name, u in ((0.0, "left", left), (b, "right", right)):
        ax.plot([x, X], [0, Z], color=IDEAL, lw=1)
        ax.plot([x - 0.3 * b, x + 0.45 * b], [f, f], color=LENS, lw=2)
        ax.plot([x, x], [0, f], ":", color=MUTED, lw=1)
        ax.plot(x, 0, "^", color=CAMERA, ms=11)
        ax.plot(x + u, f, "o", color=LENS, ms=6)
        beside(ax, f"{name} camera", (x, 0), (0, -20), ha="center")
        beside(ax, rf"$u_{{{name}}}$", (x + u, f), (6, -14), LENS)
    ax.plot([0, right], [0, f], "--", color=ESTIMATED, lw=1)
    ax.plot(X, Z, "s", color=WORLD, ms=9)
    measures = (((right + left) / 2, f, "d", ESTIMATED, (0, 6)), (b / 2, 0, "b", WORLD, (0, -16)))
    for x, z, text, colour, offset in measures:
        beside(ax, text, (x, z), offset, colour, ha="center", fontsize=FONT + 3)
    for x, high, text in ((-0.5 * b, f, "α"), (1.75 * b, Z, "Z")):
        ax.annotate("", (x, 0), (x, high), arrowprops={"arrowstyle": "<->", "color": MUTED})
        beside(ax, text, (x, high / 2), (-14, -4), fontsize=FONT + 3)
    ax.set(xlim=(-0.8 * b, 2.1 * b), ylim=(-0.14 * Z, 1.08 * Z), xlabel="X", ylabel="Z")
    ax.set_title("The orange triangle is the green one, smaller: d / α = b / Z")
    ax.set(xticks=[], yticks=[])
    return ax
