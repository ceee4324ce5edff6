"""Explore what noise does to a corner: forty noisy photographs of it, and an ellipse."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.pictures import course, render
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, mixed

_VIEW, _CORNER, _BLUR = 6, 22, 0.7  # which of the course's photographs, and as it was rendered
_HALF, _SHOWN, _ABOVE = 8, 16, 6  # px: half the window, half of what is shown, and its middle
_PHOTOS, _SIDE, _REACH = 40, (424, 424), 0.025  # px of the page; px to each side, enlarged
_SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])


def forty_model() -> Model:
    """Make the model of forty photographs, in each of which a corner is found."""
    settings = (
        Setting("up", "window, up the edge (px)", 0, 12, 1, 9, "0 is on the corner"),
        Setting("noise", "noise (grey levels)", 0.5, 6, 0.5, 2, "its standard deviation"),
        Setting("count", "photographs", 1, _PHOTOS, 1, _PHOTOS, "the last one is shown"),
    )
    about = """A window of 17 × 17 pixels over a noisy photograph of a corner. Beside it, much
    enlarged, the places found in forty such photographs, as dots, and the ellipse of the
    eigenvalues."""
    drags = {"height": lambda _, at: {"up": float(-at[1])}}
    return Model("forty", about, settings, _draw, drags)


@lru_cache(maxsize=5)
def quiet(right: float = 0, down: float = 0) -> Array:
    """Return the shown part (33, 33) of the photograph without noise, pushed by so many px."""
    A, (u, v) = course.camera().A.copy(), np.rint(course.exact_corners()[_VIEW, _CORNER])
    A[:2, 2] += [_SHOWN - u + right, _SHOWN + _ABOVE - v + down]
    side = 2 * _SHOWN + 1
    eye = Camera(A, course.poses()[_VIEW], course.camera().lens, (side, side))
    return np.asarray(render(course.board(), eye, blur=_BLUR), float)


@lru_cache(maxsize=1)
def noises() -> Array:
    """Return the noise of all photographs (40, 33, 33), with a standard deviation of 1."""
    return np.random.default_rng(0).normal(size=(_PHOTOS, *quiet().shape))


def edges() -> Array:
    """Return the directions (2, 2) of the upright and of the level edge, up and to the right."""
    m = course.exact_corners()[_VIEW]
    ways = m[[_CORNER - 9, _CORNER + 1]] - m[_CORNER]
    return np.asarray(ways / np.linalg.norm(ways, axis=1, keepdims=True))


def found(up: int) -> tuple[Array, Array, Array]:
    """Return eigenvalues (2,), their directions in columns, and the places (40, 2) for noise 1.

    A place is by how far the picture without noise must be pushed to fit a photograph best: what
    is left, n, is then perpendicular to both columns of J, what a push changes.
    """
    row, column = _SHOWN + _ABOVE - up, _SHOWN + round(up * edges()[0, 0])
    window = (slice(at - _HALF, at + _HALF + 1) for at in (row, column))
    cut = (slice(None), *window)
    pushed = np.stack([quiet(0.5, 0) - quiet(-0.5, 0), quiet(0, 0.5) - quiet(0, -0.5)])
    J = pushed[cut].reshape(2, -1).T
    eigenvalues, axes = np.linalg.eigh(J.T @ J)
    return eigenvalues, axes, np.asarray(noises()[cut].reshape(_PHOTOS, -1) @ np.linalg.pinv(J).T)


def _draw(paper: Paper, values: Values) -> Drawing:
    up, noise, count = round(values["up"]), values["noise"], round(values["count"])
    eigenvalues, axes, places = found(up)
    half = noise * axes / np.sqrt(eigenvalues)
    places = noise * places[:count]
    panels = _photo(paper, up, noise, count), _cloud(paper, places, half)
    long, short = (f"{noise:g}/√{one:.0f} = {noise / one**0.5:.4f} px" for one in eigenvalues)
    along, across = np.sqrt(np.mean((places @ axes) ** 2, axis=0))
    said = f"The half axes are {long} and {short}. In these directions the dots lie"
    said += f" {along:.4f} and {across:.4f} px from the middle (RMS)."
    return Drawing(paper.join(panels), said)


def _photo(paper: Paper, up: int, noise: float, count: int) -> Panel:
    """Draw the last photograph, and the window."""
    x, y = (-_SHOWN - 0.5, _SHOWN + 0.5), (-_SHOWN - _ABOVE - 0.5, _SHOWN - _ABOVE + 0.5)
    panel = paper.panel(_SIDE, x, y, f"photograph {count}: pull the window along the edge")
    grey = quiet() + noise * noises()[count - 1]
    panel.image(np.rint(grey).clip(0, 255).astype(np.uint8), smooth=False)
    at = np.array([round(up * edges()[0, 0]), -up])
    for colour, width in (("#FFFFFF", 4), (ESTIMATED, 2.2)):
        panel.line(at + (_HALF + 0.5) * _SQUARE, colour, width)
    panel.mark(at, "estimated", 6)
    panel.grip("height", "the window, along the upright edge", at, 12)
    return panel


def _cloud(paper: Paper, places: Array, half: Array) -> Panel:
    """Draw what is found as dots, the last one larger, and the ellipse with its half axes."""
    title = f"what {len(places)} photographs say, enlarged {(_SHOWN + 0.5) / _REACH:.0f} times"
    panel = paper.panel(_SIDE, (-_REACH, _REACH), (-_REACH, _REACH), title)
    ellipse = circle(91) @ half.T
    panel.polygons([2 * ellipse], mixed("#FFFFFF", ESTIMATED, 0.12))
    panel.polygons([ellipse], mixed("#FFFFFF", ESTIMATED, 0.28))
    for way, ink in zip(edges(), (ESTIMATED, LENS), strict=True):
        panel.line(np.outer([-2 * _REACH, 2 * _REACH], way), ink, 1.2)
    panel.line(ellipse, IDEAL, 1.6)
    panel.polygons(places[:, None] + 3 * panel.pixel * circle(13), ESTIMATED)
    panel.mark(places[-1], "estimated", 8)
    for axis in half.T:
        panel.line([[0, 0], axis], IDEAL, 3)
        beside = axis * (1 + 26 * panel.pixel / np.hypot(*axis))
        panel.text(beside, f"{np.hypot(*axis):.4f}", IDEAL, anchor="mm", size=14)
    panel.line([[0.011, 0.0225], [0.021, 0.0225]], IDEAL, 2)
    panel.text([0.016, 0.0215], "0.01 px", IDEAL, anchor="ms", size=13)
    return panel
