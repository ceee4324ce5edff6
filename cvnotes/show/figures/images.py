"""Figures of pictures, points and corners.

Each ``draw_<thing>(data, *, ax=None)`` draws on the axes it is given, or on new ones, and returns
them; nothing is shown and no global state is touched. `cvnotes.show.show` puts them on a page.
"""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, ShapeError, points, positions
from cvnotes.show.axes import arrow, as_picture, drawn_on, halo, letter, pixel_axes
from cvnotes.show.guards import in_bytes, thing
from cvnotes.show.style import ESTIMATED, FONT, MARKERS, WORLD, colour_of
from cvnotes.targets import CharucoBoard, Chessboard

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_image(
    image: npt.ArrayLike, *, ax: "Axes | None" = None, title: str = "", ticks: bool = False
) -> "Axes":
    """Draw a picture on axes that count its pixels.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3)
        Grey values or RGB; uint8, uint16, bool, or float from 0 to 1 (NaN stays white).
    ticks : bool
        Whether pixels can be read off, by numbers along the border.

    Examples
    --------
    >>> draw_image(np.zeros((480, 640), np.uint8)).get_ylim()
    (np.float64(479.5), np.float64(-0.5))
    """
    picture = in_bytes(image)
    size = (picture.shape[1], picture.shape[0])
    ax = drawn_on(ax, size)
    ax.imshow(picture, cmap="gray", vmin=0, vmax=255)
    ax.set_title(title)
    return as_picture(ax, size, ticks=ticks)


def draw_points(
    m: npt.ArrayLike,
    *,
    ax: "Axes | None" = None,
    size: tuple[int, int] = (640, 480),
    meaning: str = "estimated",
) -> "Axes":
    """Draw pixels as markers, over a picture or on an empty one.

    Parameters
    ----------
    m : array_like, shape (..., 2)
        Pixels (u, v); rows with NaN have no image and are left out.
    size : (width, height)
        Size of the picture, where new axes are made.
    meaning : {"world", "camera", "ideal", "lens", "estimated"}
        Whose points these are; sets colour and marker.

    Examples
    --------
    >>> len(draw_points([[100, 50], [200, 80]]).collections)
    1
    """
    m = positions(m, "m")
    colour = colour_of(meaning)
    ax = pixel_axes(ax, size)
    u, v = m.reshape(-1, 2).T
    ax.scatter(
        u, v, s=36, marker=MARKERS[meaning], color=colour, linewidths=1.4,
        path_effects=halo(), zorder=3,
    )  # fmt: skip
    return ax


def draw_corners(
    image: npt.ArrayLike,
    corners: npt.ArrayLike,
    board: Chessboard | CharucoBoard,
    *,
    ax: "Axes | None" = None,
) -> "Axes":
    """Draw the corners of a board over its picture, so that their order can be seen.

    Each row is joined, and the outermost corners have their numbers; the ring is the origin of
    the board's frame, the arrows its x and y axes.

    Parameters
    ----------
    image : array_like, shape (height, width) or (height, width, 3)
        The picture.
    corners : array_like, shape (n, 2)
        Pixels, ordered as ``board.points``; NaN for those of a `CharucoBoard` not found.
    board : Chessboard or CharucoBoard
        Tells how many corners a row has.
    """
    if isinstance(board, CharucoBoard):  # of which a part may be seen
        m = positions(corners, "corners")
    else:
        thing(board, "board", Chessboard)
        m = points(corners, "corners", 2)
    columns, rows = board.corners
    if m.shape != (columns * rows, 2):
        raise ShapeError(
            f"corners: a board of {columns}×{rows} has {columns * rows}, got {m.shape}"
        )
    m = np.where(np.isfinite(m), m, np.nan)
    ax = draw_image(image, ax=ax)
    grid = m.reshape(rows, columns, 2)
    for row in grid:
        ax.plot(*row.T, "-", color=ESTIMATED, linewidth=0.8, marker=".", markersize=5)
    along = np.array([grid[0, min(2, columns - 1)], grid[min(2, rows - 1), 0]]) - m[0]
    for name, way, other in zip("xy", along, np.nan_to_num(along[::-1]), strict=True):
        if np.isfinite(way).all():
            arrow(ax, m[0], m[0] + way, WORLD, 1.6)
            _write(ax, name, m[0] + 0.9 * way - 0.3 * other, WORLD)  # on the white margin
    ax.plot(*m[0], "o", color=WORLD, markersize=9, fillstyle="none", markeredgewidth=1.6)
    for j in (0, rows - 1):
        for i, inner in ((0, 1), (columns - 1, columns - 2)):
            at, diagonal = grid[j, i], grid[min(1, rows - 1) if j == 0 else rows - 2, inner]
            if np.isfinite([at, diagonal]).all():  # beside it, in the outer square
                _write(ax, str(columns * j + i), at + 0.5 * (at - diagonal), ESTIMATED)
    return ax


def _write(ax: "Axes", text: str, where: Array, colour: str) -> None:
    """Write a short text that stays legible over a picture, and inside of it."""
    right, bottom = ax.get_xlim()[1], ax.get_ylim()[0]
    margin = 0.04 * max(right, bottom)
    u, v = np.clip(where, margin, [right - margin, bottom - margin])
    letter(ax, text, (u, v), colour, fontsize=FONT + 1)
