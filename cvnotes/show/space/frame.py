"""The box around a still: equal scales, y downwards, numbers and labels that never meet."""

from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]
from mpl_toolkits.mplot3d.proj3d import proj_transform  # type: ignore[import-untyped]

from cvnotes.base import Array
from cvnotes.show.style import FONT, MUTED

_BORDER = 6.0  # px between the outermost words and the border of the place
_SPACING = 75.0  # px from number to number along an axis, at least
_STEP = 3.0  # points by which a label moves away from the numbers, as often as it must
_MOST_STEPS = 12


class _Paper(RendererAgg):
    """Paper on which words are placed and measured; nothing is drawn, as that takes most time."""

    def draw_text(self, *_: Any, **__: Any) -> None:
        """Leave the word out."""

    def draw_path(self, *_: Any, **__: Any) -> None:
        """Leave the line out."""


def frame(ax: Axes3D, shown: Array, unit: str) -> None:
    """Return axes that are looked at from where they will be seen a box around points.

    Parameters
    ----------
    ax : Axes3D
        With its view already chosen.
    shown : ndarray, shape (n, 3)
        What must be inside, in the order x, z, y in which matplotlib draws.
    unit : str
        Of lengths, for the labels.

    Examples
    --------
    >>> from cvnotes.show import axes_shapes, draw_scene
    >>> draw_scene(*axes_shapes(), unit="m").get_xlabel()
    'x (m)'
    """
    low, high = shown.min(axis=0), shown.max(axis=0)
    middle = (low + high) / 2
    half = np.maximum(high - low, 0.25 * (high - low).max()) / 2 * 1.02
    ax.set_xlim(middle[0] - half[0], middle[0] + half[0])
    ax.set_ylim(middle[1] - half[1], middle[1] + half[1])
    ax.set_zlim(middle[2] + half[2], middle[2] - half[2])
    ax.set_box_aspect(half)
    ax.patch.set_visible(False)  # larger than its place, it would cover its neighbours
    for axis, name in zip(_axes(ax), "xzy", strict=True):
        axis.set_label_text(f"{name} ({unit})", fontsize=FONT)
        axis.set_tick_params(labelsize=FONT - 2, labelcolor=MUTED)
        axis.set_pane_color((1, 1, 1, 0))
        axis._axinfo["grid"].update(color=(0.88, 0.88, 0.88, 1), linewidth=0.6)
        axis.line.set_color("#BBBBBB")
    _fill(ax)


def _fill(ax: Axes3D) -> None:
    """Return the box all the room of the axes' place; matplotlib leaves half of it empty."""
    figure = ax.get_figure()
    place = ax.get_position(original=True).transformed(figure.transFigure)
    paper = _Paper(round(figure.bbox.width), round(figure.bbox.height), figure.dpi)  # type: ignore[no-untyped-call]
    ax.apply_aspect()
    _zoom(ax, place, _box(ax))
    for axis, length in zip(_axes(ax), _lengths(ax), strict=True):
        axis.set_major_locator(MaxNLocator(max(1, round(length / _SPACING))))
    for _ in range(2):  # to make room moves the words, though little
        _thin_out(ax, paper)
        _separate(ax, paper)
        _zoom(ax, place, np.concatenate([_box(ax), _words(ax, paper)]))


def _zoom(ax: Axes3D, place: Bbox, corners: Array) -> None:
    """Let the box grow until it and its words, pixels (n, 2), fill the axes' place.

    The words keep their size, so that the box has the place but for what sticks out of it.
    """
    box = _box(ax)
    low, high = box.min(axis=0), box.max(axis=0)
    before, after = low - corners.min(axis=0), corners.max(axis=0) - high
    free = np.array(place.size) - 2 * _BORDER - before - after
    zoom = float((np.maximum(free, 0.2 * np.array(place.size)) / (high - low)).min())
    window = ax.get_window_extent()
    centre = (np.array(window.p0) + window.p1) / 2
    middle = (np.array(place.p0) + place.p1 + before - after) / 2
    middle -= zoom * ((low + high) / 2 - centre)
    side = zoom * np.array(window.size) / 2
    paper = ax.get_figure().transFigure.inverted()
    ax.set_position(Bbox([middle - side, middle + side]).transformed(paper))
    ax.apply_aspect()


def _thin_out(ax: Axes3D, paper: RendererAgg) -> None:
    """Leave out numbers that meet others: where two axes end, and on one seen from its end."""
    found, kept = _numbers(ax, paper), list[Bbox]()
    for i in np.argsort(-_lengths(ax)):
        places = []
        for place, box in found[i]:
            if not any(box.overlaps(other) for other in kept):
                kept.append(box)
                places.append(place)
        _axes(ax)[i].set_ticks(places)


def _separate(ax: Axes3D, paper: RendererAgg) -> None:
    """Move each axis's label away until it meets no number and no other label."""
    for _ in range(_MOST_STEPS):
        numbers = [box for found in _numbers(ax, paper) for _, box in found]
        labels = [_pieces(axis.label, paper) for axis in _axes(ax)]
        moved = False
        for i, axis in enumerate(_axes(ax)):
            others = [*numbers, *(piece for pieces in labels[:i] for piece in pieces)]
            if any(piece.overlaps(other) for piece in labels[i] for other in others):
                axis.labelpad += _STEP
                moved = True
        if not moved:
            return


def _numbers(ax: Axes3D, paper: RendererAgg) -> list[list[tuple[float, Bbox]]]:
    """Return each axis's numbers with their boxes, and put all words where they will be."""
    ax.M = ax.get_proj()
    found = []
    for axis in _axes(ax):
        axis.draw(paper)
        low, high = sorted(axis.get_view_interval())
        drawn = axis.majorTicks[: len(axis.get_majorticklocs())]
        ticks = [tick for tick in drawn if low <= tick.get_loc() <= high]
        found.append([(tick.get_loc(), tick.label1.get_window_extent(paper)) for tick in ticks])
    return found


def _pieces(label: Text, paper: RendererAgg) -> list[Bbox]:
    """Cut a slanted label into squares along its line; the box around it has empty corners."""
    around = label.get_window_extent(paper)
    angle = np.radians(label.get_rotation())
    direction = np.array([np.cos(angle), np.sin(angle)])
    high = 1.5 * FONT / 72 * paper.dpi
    i = int(np.abs(direction).argmax())
    long = (around.size[i] - high * abs(direction[1 - i])) / abs(direction[i])
    steps = np.linspace(-0.5, 0.5, max(2, int(np.ceil(long / high))))[:, None]
    centres = (np.array(around.p0) + around.p1) / 2 + steps * (long - high) * direction
    return [Bbox([centre - high / 2, centre + high / 2]) for centre in centres]


def _words(ax: Axes3D, paper: RendererAgg) -> Array:
    """Return the corners (n, 2) of the boxes of all words: numbers, labels and names."""
    boxes = [box for found in _numbers(ax, paper) for _, box in found]
    boxes += [axis.label.get_window_extent(paper) for axis in _axes(ax)]
    for text in ax.texts:
        size = np.array(text.get_window_extent(paper).size)
        middle = ax.transData.transform(proj_transform(*text.get_position_3d(), ax.M)[:2])
        boxes.append(Bbox([middle - size / 2, middle + size / 2]))
    return np.array([corner for box in boxes for corner in (box.p0, box.p1)])


def _box(ax: Axes3D) -> Array:
    """Return the pixels (8, 2) of the box's corners."""
    ax.M = ax.get_proj()
    limits = np.array([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()])
    corners = [limits[[0, 1, 2], choice] for choice in np.ndindex(2, 2, 2)]
    seen = [proj_transform(*corner, ax.M)[:2] for corner in corners]
    return np.asarray(ax.transData.transform(seen))


def _lengths(ax: Axes3D) -> Array:
    """Return the mean length (3,) in pixels of the box's edges along each axis."""
    corners = _box(ax).reshape(2, 2, 2, 2)
    ways = [np.diff(corners, axis=i).reshape(-1, 2) for i in range(3)]
    return np.array([np.linalg.norm(way, axis=-1).mean() for way in ways])


def _axes(ax: Axes3D) -> tuple[Any, Any, Any]:
    return ax.xaxis, ax.yaxis, ax.zaxis
