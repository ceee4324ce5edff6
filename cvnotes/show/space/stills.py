"""Stills of 3-D figures, for the page: the same shapes as in `cvnotes.show.space.viewer`.

The lines of sight are parallel: what is parallel in the world is so on the page, too.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from cvnotes.base import Array
from cvnotes.show.axes import beside, drawn_on, halo
from cvnotes.show.picture import figure_of, pixels_of
from cvnotes.show.space.directions import sheet, towards
from cvnotes.show.space.order import Part, from_far_to_near
from cvnotes.show.space.shapes import Faces, Label, Lines, Photo, Shape, extent, places
from cvnotes.show.style import FONT, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ROOM = 0.06  # around the scene, of its longer side
_GHOST = 0.22  # how strongly a line shows through what hides it
_LEADER = 14  # points from which on a label has a line to what it names
_OFF = 9  # points of paper from what a label names to its middle
_CLEAR = 2  # px around a label
# Points of paper by which a label may move, the short ways first.
_STEPS = [
    reach * np.array([np.cos(angle), np.sin(angle)])
    for reach in range(0, 160, 4)
    for angle in np.radians(np.arange(0, 360, 15))
]


def draw_scene(
    *shapes: Shape, ax: "Axes | None" = None, view: tuple[float, float] = (20.0, -40.0)
) -> "Axes":
    """Draw a still of shapes, without axes: no length is read off it.

    Near things hide far ones; a hidden line shows through a little. Where a line pierces a picture
    there is a dot. Labels move to the nearest place that is clear.

    Parameters
    ----------
    *shapes : Faces, Lines, Photo or Label
        What the functions of `cvnotes.show.space.shapes` give.
    ax : Axes, optional
        Where to draw; by default new axes, as high as the scene asks for.
    view : (elevation, azimuth)
        Where it is seen from, in degrees: above the horizontal, and around the vertical, where
        −90 looks along +z and 0 along −x.

    Returns
    -------
    Axes
        Its scales are equal, and in the unit of the shapes.

    Examples
    --------
    >>> from cvnotes.show import axes_shapes
    >>> [text.get_text() for text in draw_scene(*axes_shapes()).texts]
    ['WRF', 'X', 'Y', 'Z']
    """
    from matplotlib.collections import LineCollection

    on_sheet, way = sheet(view).T, towards(view)
    seen = places(*shapes) @ on_sheet
    low, high = seen.min(axis=0), seen.max(axis=0)
    room = _ROOM * (high - low).max()
    width, height = high - low + 2 * room
    ax = drawn_on(ax, height=round(float(np.clip(640 * height / width, 240, 560))))
    ax.set(xlim=(low[0] - room, high[0] + room), ylim=(high[1] + room, low[1] - room))
    ax.set_aspect("equal")
    ax.axis("off")
    lines = [shape for shape in shapes if isinstance(shape, Lines)]
    photos = [shape for shape in shapes if isinstance(shape, Photo)]
    parts = from_far_to_near(_parts(shapes), way, 1e-6 * extent(*shapes))
    for order, part in enumerate(parts):
        _paint(ax, part, on_sheet, order)
    for line in lines:
        style: Any = {"colors": line.colour, "lw": line.width, "alpha": _GHOST, "zorder": 1e6}
        ax.add_collection(LineCollection([*(line.ends @ on_sheet)], **style), autolim=False)
        for photo in photos:
            dots = _pierced(line.ends, photo.corners) @ on_sheet
            ax.plot(*dots.T, "o", color=line.colour, ms=7, mec="white", zorder=2e6)
    _write(ax, [shape for shape in shapes if isinstance(shape, Label) and shape.name], on_sheet)
    return ax


def _parts(shapes: tuple[Shape, ...]) -> list[Part[Any]]:
    """Take shapes apart into lines and faces, each with what it is painted with."""
    parts = list[Part[Any]]()
    for shape in shapes:
        match shape:
            case Faces(_, corners, colours):
                parts += map(Part, corners, colours)
            case Lines(_, ends, _, _):
                parts += [Part(line, shape) for line in ends]
            case Photo(_, corners, _):
                parts.append(Part(corners, shape))
    return parts


def _paint(ax: "Axes", part: Part[Any], on_sheet: Array, order: int) -> None:
    """Paint a part, over those of a lower order."""
    from matplotlib.patches import Polygon
    from matplotlib.transforms import Affine2D

    at, paint = part.corners @ on_sheet, part.paint
    if isinstance(paint, Lines):
        ax.plot(*at.T, color=paint.colour, lw=paint.width, solid_capstyle="round", zorder=order)
    elif isinstance(paint, Photo):
        origin, right, _, down = paint.corners @ on_sheet
        placed = Affine2D(np.eye(3))
        placed.set_matrix([*np.column_stack([right - origin, down - origin, origin]), [0, 0, 1]])
        picture = ax.imshow(
            paint.image, extent=(0, 1, 1, 0), transform=placed + ax.transData, zorder=order,
            interpolation="bilinear", aspect="equal",
        )  # fmt: skip
        picture.set_clip_path(Polygon(at, transform=ax.transData))
    else:
        edge = paint if paint[3] == 1 else "none"
        ax.add_patch(Polygon(at, fc=paint, ec=edge, lw=0.3, zorder=order))


def _pierced(ends: Array, corners: Array) -> Array:
    """Return where lines (k, 2, 3) pierce a rectangle (4, 3), a point (n, 3) each."""
    origin, right, down = corners[0], corners[1] - corners[0], corners[3] - corners[0]
    start, end = np.moveaxis((ends - origin) @ np.cross(right, down), -1, 0)
    through = start * end < 0
    ends, start, end = ends[through], start[through, None], end[through, None]
    at = ends[:, 0] + start / (start - end) * (ends[:, 1] - ends[:, 0])
    part = np.stack([(at - origin) @ side / (side @ side) for side in (right, down)], axis=-1)
    inside = (part > 1e-9) & (part < 1 - 1e-9)  # not at a corner, where its pyramid ends
    return np.asarray(at[inside.all(axis=-1)])


def _write(ax: "Axes", labels: list[Label], on_sheet: Array) -> None:
    """Write each label at the clear place that is nearest to its own."""
    figure = figure_of(ax)
    ink = (pixels_of(figure)[::-1, :, :3] < 250).any(axis=-1)  # its rows upwards, as points go
    sharp = ink.shape[1] / figure.bbox.width
    room = ax.get_position(original=True).transformed(figure.transFigure)
    beyond = np.ones_like(ink)
    (left, bottom), (right, top) = (sharp * np.array([room.p0, room.p1])).astype(int)
    beyond[bottom:top, left:right] = False
    ink |= beyond
    for label in labels:
        at = label.at @ on_sheet
        style: Any = {"ha": "center", "va": "center", "fontsize": FONT + 1}
        words = ax.text(at[0], at[1], label.name, **style)
        half = sharp * (np.array(words.get_window_extent().size) / 2 + _CLEAR)
        words.remove()
        place = sharp * ax.transData.transform(at)
        way = (label.way @ on_sheet) * [1, -1]  # which is short where it leads to the viewer
        reach = max(float(np.linalg.norm(way)), 0.3 * float(np.linalg.norm(label.way)))
        off = _OFF * way / (reach or 1)
        for step in off + _STEPS:
            low, high = (place + sharp * figure.dpi / 72 * step + s * half for s in (-1, 1))
            (left, bottom), (right, top) = np.rint(low).astype(int), np.rint(high).astype(int)
            under = ink[max(bottom, 0) : top, max(left, 0) : right]
            if under.size == (right - left) * (top - bottom) and not under.any():
                break
        else:
            step = off
        under[:] = True
        leader = {"arrowstyle": "-", "color": MUTED, "lw": 0.8, "shrinkA": 1, "shrinkB": 2}
        far = np.linalg.norm(step) - half[1] * 72 / figure.dpi / sharp > _LEADER
        style |= {"path_effects": halo(), "zorder": 3e6}
        beside(ax, label.name, at, step, label.colour, arrowprops=leader if far else None, **style)
