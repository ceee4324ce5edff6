"""Explore a corner between the pixels: pull a line along each of its edges, as a finder does."""

from functools import lru_cache
from math import erf

import numpy as np

from cvnotes.base import Array, Image
from cvnotes.pictures import course
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, mixed
from cvnotes.targets import refine_edges, refine_subpixel

_VIEW = 6  # which photograph of the course
_WINDOW = 8  # px: of the finders, and all of it is shown
_ENDS = 7.5  # px from the middle: there the lines are held
_SIZE, _PROFILE = (391, 391), (391, 181)  # 23 px of the page for each of 17
_MIDDLE, _CONTRAST, _BLUR = 125.0, 95.0, 0.757  # grey levels; px, with the width of a pixel
_FAR, _CLEAR = 4.6, 2.5  # px: of dots from their edge, and at least from the other one
_HANDLES = {  # who is pulled: along u or v, from where, and its label
    "upper end": ("top", 0, -1.3, "of the orange line, to the right"),
    "lower end": ("bottom", 0, 2.2, "of the orange line, to the right"),
    "left end": ("left", 1, 0.4, "of the blue line, down"),
    "right end": ("right", 1, -2.6, "of the blue line, down"),
}


def subpixel_model() -> Model:
    """Make the model of one corner after the other, whose edges a hand finds, and two finders."""
    settings = (
        *(Setting(name, f"{held} (px)", -5, 5, 0.02, start, f"the {held} {way}")
          for held, (name, _, start, way) in _HANDLES.items()),
        Setting("finders", "show the finders", 0, 1, 1, 0, "how far off they and you are"),
        Setting("corner", "corner", 0, 53, 1, 22, "of the 54 corners of the board"),
    )  # fmt: skip
    about = """Seventeen by seventeen pixels around a corner of a chessboard, with a line to be
    pulled along each of its two edges; beside it, for each edge, its pixels as dots: the grey value
    over the distance from the line, and the curve of a blurred edge."""
    drags = {held: _pull(name, axis) for held, (name, axis, *_) in _HANDLES.items()}
    return Model("subpixel", about, settings, _draw, drags)


def _pull(name: str, axis: int) -> Drag:
    """Let an end of a line be pulled along its border; who pulls sees no finders."""
    return lambda _, at: {name: float(at[axis]), "finders": 0}


def place_of(corner: int) -> Array:
    """Return where a corner truly is (2,), in px from the middle of the pixel that it lies in."""
    m = course.exact_corners()[_VIEW, corner]
    return np.asarray(m - np.rint(m))


def neighbourhood(corner: int) -> Image:
    """Return the grey levels of the window, with the corner's pixel in its middle."""
    u, v = np.rint(course.exact_corners()[_VIEW, corner]).astype(int)
    inside = (slice(at - _WINDOW, at + _WINDOW + 1) for at in (v, u))
    return np.asarray(course.photo(_VIEW)[tuple(inside)])


@lru_cache(maxsize=1)
def found() -> Array:
    """Return where gradients and edge model find all corners (2, 54, 2), as `place_of` has it."""
    photo, start = course.photo(_VIEW), np.rint(course.exact_corners()[_VIEW])
    edges = refine_edges(photo, start, grid=course.board().corners, window=_WINDOW)
    return np.asarray([refine_subpixel(photo, start, window=_WINDOW), edges] - start)


def lines(values: Values) -> Array:
    """Return both lines, each as its two ends (2, 2, 2)."""
    top, bottom, left, right = (values[name] for name, *_ in _HANDLES.values())
    return np.array([[[top, -_ENDS], [bottom, _ENDS]], [[-_ENDS, left], [_ENDS, right]]])


def _normal(line: Array) -> Array:
    way = line[1] - line[0]
    return np.asarray(np.array([-way[1], way[0]]) / np.hypot(*way))


def crossing(both: Array) -> Array:
    """Return where two lines meet, (2,)."""
    n = np.array([_normal(line) for line in both])
    return np.asarray(np.linalg.solve(n, np.sum(n * both[:, 0], axis=1)))


def dots(corner: int, both: Array) -> list[Array]:
    """Return, for each edge, its pixels (n, 2): the distance from its line, and −1 dark, 1 bright.

    Those near the other edge, which blurs them too, are left out.
    """
    v, u = np.indices((2 * _WINDOW + 1, 2 * _WINDOW + 1)).reshape(2, -1) - _WINDOW
    off = np.array([(np.stack([u, v], axis=1) - line[0]) @ _normal(line) for line in both])
    grey = (neighbourhood(corner).ravel() - _MIDDLE) / _CONTRAST
    grey = grey * np.sign(grey @ off.prod(axis=0))
    clear = (np.abs(off) < _FAR) & (np.abs(off[::-1]) > _CLEAR)
    return [np.stack([off[k], grey * np.sign(off[1 - k])], axis=1)[clear[k]] for k in (0, 1)]


def blurred(t: Array) -> Array:
    """Return the curve of an edge at distances t: −1 on its dark side, 1 on its bright one."""
    return np.array([erf(each / (np.sqrt(2) * _BLUR)) for each in t])


def _draw(paper: Paper, values: Values) -> Drawing:
    corner, both = round(values["corner"]), lines(values)
    n, title = 2 * _WINDOW + 1, "two edges: pull a line onto each"
    panel = paper.picture_panel(_SIZE, (n, n), title, (-_WINDOW, -_WINDOW))
    panel.image(neighbourhood(corner).astype(np.uint8), smooth=False)
    for line, ink in zip(both, (ESTIMATED, LENS), strict=True):
        panel.line(line + np.outer([-0.2, 0.2], line[1] - line[0]), ink, 2.2, rim=1.8)
    if values["finders"]:
        panel.mark(place_of(corner), "ideal", 9)
    for held, end in zip(_HANDLES, both.reshape(4, 2), strict=True):
        panel.grip(held, f"the {held} of a line", end, 1)
    pixels = dots(corner, both)
    edges = zip(pixels, ("upright", "level"), (ESTIMATED, LENS), strict=True)
    profiles = [_profile(paper, *edge) for edge in edges]
    miss = [_CONTRAST * np.sqrt(np.mean((y - blurred(t)) ** 2)) for t, y in (x.T for x in pixels)]
    said = f"The dots miss their curves by {miss[0]:.1f} and {miss[1]:.1f} grey levels. "
    off = np.array([crossing(both), *found()[:, corner]]) - place_of(corner)
    return Drawing(paper.join((panel, profiles)), said + _rest(off, bool(values["finders"])))


def _profile(paper: Paper, pixels: Array, name: str, ink: str) -> Panel:
    """Draw each pixel of an edge as a dot over the curve that it should lie on."""
    panel = paper.panel(_PROFILE, (-5, 5), (1.35, -1.35), f"{name} edge: each pixel's grey")
    panel.ticks(x=(-4, -2, 0, 2), size=12)
    panel.text([4.8, -1.2], "px from the line", anchor="rm")
    t = np.linspace(-5, 5, 101)
    panel.line(np.stack([t, blurred(t)], axis=1), mixed(ink, "#FFFFFF", 0.7), 9)
    round_ = circle(9) * 2.6 * panel.pixel * [1, 2.7 / 10 * _PROFILE[0] / _PROFILE[1]]
    panel.polygons(pixels[:, None] + round_, ink)
    panel.text([-4.8, -0.7], "dark", IDEAL, size=14)
    panel.text([4.8, 0.7], "bright", IDEAL, anchor="rm", size=14)
    return panel


def _rest(off: Array, shown: bool) -> str:
    if not shown:
        return "When each edge has one curve, show the finders (two programs; a pull hides them)."
    hand, *both = np.linalg.norm(off, axis=1)
    gradients, edges = (f"{x:.3f}" if x >= 0.0005 else "less than 0.001" for x in both)
    you = f"{hand:.2f}" if hand >= 0.1 else f"{hand:.3f}"
    return f"You are {you} px off here; gradients {gradients}, edge model {edges} px."
