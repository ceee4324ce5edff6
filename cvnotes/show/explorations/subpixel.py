"""Explore a corner between the pixels: pull a cross there by eye, and see two finders beat you."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array, Image
from cvnotes.pictures import course
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, WORLD
from cvnotes.targets import refine_edges, refine_subpixel

_VIEW = 6  # which photograph of the course
_WINDOW = 8  # px: of the finders, and all of it is shown
_SIZE = (391, 391)  # 23 px of the page for each of 17
_STALK = np.array([3.0, 3.0])  # px: the hand holds the cross from aside, and hides no corner
_RINGS = (0.004, 0.02, 0.1, 0.5, 2.5)  # px, as far apart as logarithms are
_RIM = len(_RINGS) + 0.25  # of the target; what lies beyond is drawn there
_HALF = len(_RINGS) + 0.75  # of the panel
_GROUND = "#F2F2ED", "#FFFFFF"


def subpixel_model() -> Model:
    """Make the model of one corner after the other, measured by hand and by two finders."""
    settings = (
        Setting("u", "cross, aside (px)", -3.5, 3.5, 0.01, 1.6, "to the right of the middle pixel"),
        Setting("v", "cross, down (px)", -3.5, 3.5, 0.01, -1.7, "below the middle pixel"),
        Setting("finders", "show the finders", 0, 1, 1, 0, "how far off they and you are"),
        Setting("corner", "corner", 0, 53, 1, 22, "of the 54 corners of the board"),
    )
    about = (
        "Seventeen by seventeen pixels around a corner of a chessboard, with a cross that a hand "
        "pulls; beside it a target with five rings, each of a fifth of the next one's radius."
    )
    return Model("subpixel", about, settings, _draw, {"cross": _pulled})


def _pulled(_: Values, at: Array) -> Values:
    """Carry the cross by its handle; who pulls sees no hits."""
    u, v = (at - _STALK).tolist()
    return {"u": u, "v": v, "finders": 0}


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


def on_target(off: Array) -> Array:
    """Draw errors (..., 2) together, by the logarithm of their lengths: rings are 1 to 5."""
    far = np.linalg.norm(off, axis=-1, keepdims=True)
    ring = 1 + np.log(np.maximum(far, 1e-9) / _RINGS[0]) / np.log(_RINGS[1] / _RINGS[0])
    return np.asarray(off / np.maximum(far, 1e-9) * ring.clip(0, _RIM))


def _draw(paper: Paper, values: Values) -> Drawing:
    corner = round(values["corner"])
    hand, true = np.array([values["u"], values["v"]]), place_of(corner)
    half = _WINDOW + 0.5
    panel = paper.panel(
        _SIZE, (-half, half), (-half, half), f"corner {corner}: where do its edges meet?"
    )
    panel.image(neighbourhood(corner).astype(np.uint8), smooth=False)
    target = paper.panel(
        _SIZE, (-_HALF, _HALF), (-_HALF, _HALF), "how far off, enlarged towards the middle"
    )
    for ring in range(len(_RINGS), 0, -1):
        target.polygons([ring * circle(181)], _GROUND[ring % 2])
        target.line(ring * circle(181), "#BBBBBB", 0.8)
    for ring, px in enumerate(_RINGS, 1):
        words = f"{px:g} px" if ring == len(_RINGS) else f"{px:g}"
        target.text([0, ring - 0.35], words, IDEAL, anchor="mm", size=14)
    target.mark([0, 0], "ideal", 7)
    off = np.array([hand, *found()[:, corner]]) - true
    _cross(panel, hand)
    if values["finders"]:
        panel.mark(true, "ideal", 9)
        _hits(target, on_target(off))
    return Drawing(paper.join((panel, target)), _sentence(off, bool(values["finders"])))


def _cross(panel: Panel, hand: Array) -> None:
    """Draw the hand's cross, open in the middle, and a stalk to hold it by."""
    arms = np.array([[[0.22, 0], [2, 0]], [[0, 0.22], [0, 2]]])
    arms = hand + np.concatenate([arms, -arms, [[[0.16, 0.16], _STALK]]])
    for colour, width in (("#FFFFFF", 3.6), (WORLD, 1.6)):
        panel.segments(arms, colour, width)
    panel.mark(hand + _STALK, "world", 8)
    panel.grip("cross", "the cross, held from aside", hand + _STALK, 1)


def _hits(target: Panel, hits: Array) -> None:
    """Mark the hand's hit and those of the finders, and name them in the panel's corners."""
    for at, name, meaning, ink, (x, y) in (
        ([0, 0], "true corner", "ideal", IDEAL, (5.4, -5.4)),
        (hits[0], "you", "world", WORLD, (-5.4, -5.4)),
        (hits[1], "gradients", "lens", LENS, (-5.4, 5.4)),
        (hits[2], "edge model", "estimated", ESTIMATED, (5.4, 5.4)),
    ):
        target.mark([at, (x, y)], meaning, 7)
        target.text([x - 0.35 * np.sign(x), y], name, ink, anchor="lm" if x < 0 else "rm", size=12)


def _sentence(off: Array, shown: bool) -> str:
    if not shown:
        return (
            "Pull the green square until the cross is where the edges seem to meet. Then show the "
            "finders. (The next pull hides them.)"
        )
    hand, *both = np.linalg.norm(off, axis=1)
    gradients, edges = (f"{x:.3f}" if x >= 0.0005 else "less than 0.001" for x in both)
    you = f"{hand:.2f}" if hand >= 0.1 else f"{hand:.3f}"
    return f"You are {you} px off here; gradients {gradients}, edge model {edges} px."
