"""Explore the structure tensor: push a window one pixel, and add up how its grey values change."""

import numpy as np

from cvnotes.base import Array
from cvnotes.pictures import course
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.explorations.votes import slopes, window_at
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, LENS, MUTED

_PLACES = {"edge": (352, 201), "corner": (352, 213), "flat paper": (367, 205)}
_HALF = 5  # px from the window's middle to the border of what is shown of the photograph
_SIDE = 275, 275  # px, of a panel
_STEEPEST = 84.0  # grey levels a pixel: the square of such a change fills its pixel
_SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
_GROUND = "#A6A6A6"


def push_model() -> Model:
    """Make the model of a window that is pushed one pixel, and of its changes in all directions."""
    settings = (
        Setting("place", "place", 1, 3, 1, 1, "where the window lies", names=tuple(_PLACES)),
        Setting("angle", "direction d (°)", 0, 360, 1, 40, "from the right, clockwise"),
    )
    about = """A window of 7 × 7 pixels of a photograph, and where it is pushed to; squares as large
    as the squares of its changes; and their sum as a curve round the middle, by the direction."""
    drags = {"d": lambda _, at: {"angle": np.degrees(np.arctan2(at[1], at[0])) % 360}}
    return Model("push", about, settings, _draw, drags)


def changes_at(place: str) -> Array:
    """Return about how much each pixel changes, if it is pushed towards 0 to 360°: (49, 361)."""
    return np.asarray(window_at(slopes(), _PLACES[place]).g @ circle(361).T)


def _draw(paper: Paper, values: Values) -> Drawing:
    place, angle = [*_PLACES][round(values["place"]) - 1], round(values["angle"])
    change, way = changes_at(place)[:, : angle + 1], circle(361)[angle]
    sums = np.sum(change**2, axis=0)
    panels = _photo(paper, place, way), _changes(paper, change[:, -1]), _traced(paper, sums)
    said = f"""{place.capitalize()}, d at {angle}°: the sum of the squares is {sums[-1]:.0f}. From
    0° to here the largest is {sums.max():.0f}, the smallest {sums.min():.0f}."""
    return Drawing(paper.join(panels), said)


def _photo(paper: Paper, place: str, way: Array) -> Panel:
    """Draw the window, the same window pushed, and the direction on a circle of one pixel."""
    reach, (u, v) = (-_HALF - 0.5, _HALF + 0.5), _PLACES[place]
    panel = paper.panel(_SIDE, reach, reach, f"{place}: pull d round")
    photo = course.photo(6)[v - _HALF : v + _HALF + 1, u - _HALF : u + _HALF + 1]
    panel.image(130 + (photo * (125 / 255)).astype(np.uint8), smooth=False)
    panel.line(3.5 * _SQUARE, IDEAL, 1.5, dash=5)
    panel.line(way + 3.5 * _SQUARE, ESTIMATED, 2.5)
    panel.line(circle(91), MUTED, 1)
    panel.line(np.outer([0, 1], way), ESTIMATED, 2.5)
    panel.text(1.8 * way, "d", ESTIMATED, anchor="mm", size=17)
    panel.grip("d", "the direction d, to be turned", way, 2, "estimated", 5)
    return panel


def _changes(paper: Paper, change: Array) -> Panel:
    """Draw a square for each pixel, its side the change: white if it gets brighter, else black."""
    title = f"sides g · d, all areas {np.sum(change**2):.0f}"
    panel = paper.panel(_SIDE, (-0.5, 6.5), (-0.5, 6.5), title)
    panel.polygons([3 + 3.5 * _SQUARE], _GROUND)
    at = np.indices((7, 7)).reshape(2, -1).T[:, ::-1]
    corners = at[:, None] + (abs(change) / _STEEPEST / 2)[:, None, None] * _SQUARE
    panel.polygons(corners, ["#FFFFFF" if one > 0 else IDEAL for one in change])
    return panel


def _traced(paper: Paper, sums: Array) -> Panel:
    """Draw the sum as far out as it is large, from 0° to d, and the same for pushing back."""
    reach = 96000.0
    ends, title = (-reach, reach), "all areas, direction by direction"
    panel = paper.panel(_SIDE, ends, ends, title)
    for ring in (25, 50, 75):
        panel.line(1000 * ring * circle(91), FAINT, 1)
        panel.text([0, -1000 * ring], f"{ring} 000", MUTED, anchor="mm", size=11)
    curve = sums[:, None] * circle(361)[: len(sums)]
    for end in (1, -1):
        panel.line(end * np.concatenate([curve, curve[-1:]]), MUTED, 2)
    for k, ink, words, down in (
        (sums.argmax(), ESTIMATED, "largest", 0.8), (sums.argmin(), LENS, "smallest", 0.92),
    ):  # fmt: skip
        panel.line(np.outer([0, 1], curve[k]), ink, 3)
        words = f"{words}{' so far' * (len(sums) < 181)}: {sums[k]:.0f}"
        panel.text([-0.95 * reach, down * reach], words, ink, size=13)
    panel.mark(curve[-1], "estimated", 6)
    return panel
