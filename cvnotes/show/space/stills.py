"""Stills of 3-D figures, for the page: the same shapes as in `cvnotes.show.space.viewer`."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.show.space.directions import towards
from cvnotes.show.space.shapes import Faces, Label, Lines, Photo, Shape, extent, places
from cvnotes.show.style import DPI, FONT, halo

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]


def draw_scene(
    *shapes: Shape,
    ax: "Axes3D | None" = None,
    view: tuple[float, float] = (20.0, -40.0),
    unit: str = "mm",
) -> "Axes3D":
    """Draw a still of shapes.

    Parameters
    ----------
    *shapes : Faces, Lines, Photo or Label
        What the functions of `cvnotes.show.space.shapes` give.
    ax : Axes3D, optional
        Where to draw; by default new axes.
    view : (elevation, azimuth)
        Where it is seen from, in degrees: above the horizontal, and around the vertical, where
        −90 looks along +z and 0 along −x.
    unit : str
        Of lengths, for the axes' labels.

    Returns
    -------
    Axes3D
        Its scales are equal, y points down.

    Examples
    --------
    >>> from cvnotes.show import axes_shapes
    >>> draw_scene(*axes_shapes()).get_zlabel()
    'y (mm)'
    """
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    from cvnotes.show.space.frame import frame

    reach = extent(*shapes)
    ax = _axes() if ax is None else ax
    # All in one collection: matplotlib sorts by distance only within one. Its own limits would
    # come from memory it never wrote where the polygons have different numbers of corners.
    corners, colours = _painted(shapes, reach, towards(view))
    polygons = Poly3DCollection(corners, facecolors=colours, edgecolors=colours, lw=0.3)
    ax.add_collection(polygons, autolim=False)
    for shape in shapes:
        if isinstance(shape, Label):
            text = ax.text(*_upright(shape.at), shape.name, color=shape.colour, zorder=1e6)
            text.set(fontsize=FONT - 1, ha="center", va="center", path_effects=halo())
    ax.view_init(*view)
    frame(ax, _upright(places(*shapes)), unit)
    return ax


def _painted(shapes: tuple[Shape, ...], reach: float, towards: Array) -> tuple[list[Array], Array]:
    """Turn shapes into coloured polygons, lines into ribbons that face the viewer."""
    from matplotlib.colors import to_rgba

    polygons: list[Array] = []
    colours: list[Array] = []
    for shape in shapes:
        match shape:
            case Faces(_, corners, rgba):
                pass
            case Photo(_, rectangle, image):
                corners, rgba = _mosaic(rectangle, image)
            case Lines(_, ends, colour, width):
                # A little nearer, for lines on faces; along the line of sight nothing moves.
                pieces = _in_pieces(ends, reach / 25) + reach / 35 * towards
                corners = _ribbons(pieces, width * reach / 500, towards)
                rgba = np.tile(to_rgba(colour), (len(corners), 1))
            case Label():
                continue
        polygons += list(_upright(corners))
        colours.append(rgba)
    return polygons, np.concatenate(colours) if colours else np.zeros((0, 4))


def _in_pieces(ends: Array, longest: float) -> Array:
    """Cut segments (k, 2, 3) into pieces no longer than `longest`, to be sorted one by one."""
    way = ends[:, 1] - ends[:, 0]
    count = np.ceil(np.linalg.norm(way, axis=-1) / longest).astype(int).clip(1)
    which = np.repeat(np.arange(len(ends)), count)
    step = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    part = np.stack([step, step + 1], axis=-1) / count[which, None]
    return np.asarray(ends[which, :1] + part[..., None] * way[which, None])


def _ribbons(ends: Array, width: float, towards: Array) -> Array:
    """Widen segments (k, 2, 3) to rectangles (k, 4, 3) that face the direction `towards`."""
    across = np.cross(ends[:, 1] - ends[:, 0], towards)
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    across = np.divide(across, length, out=np.zeros_like(across), where=length > 0) * width / 2
    near, far = ends[:, 0], ends[:, 1]
    return np.asarray(np.stack([near - across, far - across, far + across, near + across], axis=1))


def _axes() -> "Axes3D":
    from matplotlib.figure import Figure

    figure = Figure(figsize=(640 / DPI, 520 / DPI), dpi=DPI)
    ax: Axes3D = figure.add_axes((0, 0, 1, 1), projection="3d")
    return ax


def _upright(W: Array) -> Array:
    """Order coordinates as matplotlib draws them: its third axis is the vertical one."""
    return np.asarray(W[..., [0, 2, 1]])


def _mosaic(corners: Array, image: npt.NDArray[np.uint8]) -> tuple[Array, Array]:
    """Cut a picture into at most 80 by 80 faces of one colour each."""
    height, width = (-(-side // 80) for side in image.shape[:2])
    rows, columns = image.shape[0] // height, image.shape[1] // width
    cells = image[: rows * height, : columns * width].reshape(rows, height, columns, width, 3)
    rgb = cells.mean(axis=(1, 3)).reshape(-1, 3) / 255
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    grid = np.stack([i, j], axis=-1).reshape(-1, 1, 2) + [[0, 0], [1, 0], [1, 1], [0, 1]]
    along, down = corners[1] - corners[0], corners[3] - corners[0]
    place = corners[0] + grid[..., :1] / columns * along + grid[..., 1:] / rows * down
    return place, np.concatenate([rgb, np.ones_like(rgb[:, :1])], axis=1)
