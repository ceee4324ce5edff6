"""Explore why errors go together: two unknowns, two corners, and the noise as their J leaves it."""

from typing import NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, MUTED, WORLD, mixed

ALPHA, BESIDE, NEAR, SIGMA = 800, 240, 300, 0.1  # px, px beside the middle, mm, px
_ENLARGED = 220  # how many mm of the plan show a move of 1 px
_X = BESIDE / ALPHA  # of the near corner; the far one is on the other side
_PLAN, _MOVES, _BOWL = (236, 290), (282, 290), (330, 290)  # px of the page
_DOT = mixed(ESTIMATED, "#FFFFFF", 0.4)
_SHOWN, _TRIED = (3.2, 1.5), (2.5, 1.3)  # errors of α (px) and of the distance (mm)


class Pair(NamedTuple):
    """Two corners as they move outwards: J (2, 2), a row for each, columns for α and T_z."""

    J: Array

    @property
    def alone(self) -> float:
        """Return the standard deviation of α where T_z is known, in px."""
        return float(SIGMA / np.linalg.norm(self.J[:, 0]))

    @property
    def together(self) -> float:
        """Return the standard deviation of α where T_z is not; infinite if columns are parallel."""
        det = np.linalg.det(self.J)
        return float(SIGMA * np.linalg.norm(self.J[:, 1]) / det) if det > 1e-12 else np.inf

    def errors(self, noise: Array) -> Array:
        """Return the errors (n, 2) of α and T_z that noise (n, 2) of the corners brings.

        Of parallel columns they are as far away as one likes: 10⁹ times.
        """
        U, s, Vt = np.linalg.svd(self.J)
        return np.asarray(noise @ U / s.clip(1e-10) @ Vt)


def pair_of(far: float) -> Pair:
    """Return how two corners move, 300 mm away and `far`, if α or the board's distance grows."""
    return Pair(np.array([[_X, -BESIDE / NEAR], [_X, -BESIDE / far]]))


def bowl_model() -> Model:
    """Make the model of a board from above, of its corners' moves, and of the bowl of both."""
    alpha, T_z = _TRIED
    settings = (
        Setting("far", "far corner (mm)", NEAR, 500, 5, 400, "300: the board faces the camera"),
        Setting("alpha", "α (px)", -alpha, alpha, 0.01, 1.67, "a camera that is tried"),
        Setting("T_z", "distance (mm)", -T_z, T_z, 0.01, 0.70, "a distance that is tried"),
    )
    about = """A tilted board from above, its picture below; how both corners move there if the
    camera gets longer and the board goes away, amid the noise of 300 throws; and the errors of α
    and of the distance that these throws bring, with the ellipse that the circle becomes."""
    noise = np.random.default_rng(0).normal(0, SIGMA, (300, 2))

    def draw(paper: Paper, values: Values) -> Drawing:
        tried, pair = np.array([values["alpha"], values["T_z"]]), pair_of(values["far"])
        board = _from_above(paper, values["far"], pair.J * tried)
        beside = _moves(paper, pair, tried, noise), _bowl(paper, pair, tried, noise)
        return Drawing(paper.join((board, *beside)), _sentence(pair, tried))

    ray = np.array([-_X, 1])
    drags = {
        "far": lambda _, at: {"far": float(at @ ray / (ray @ ray))},
        "tried": lambda _, at: {"alpha": float(at[0]), "T_z": float(at[1])},
    }
    return Model("bowl", about, settings, draw, drags)


def _sentence(pair: Pair, tried: Array) -> str:
    right, left = (pair.J @ tried).round(2) + 0.0
    said = f"""With α {tried[0]:+.2f} px and the distance {tried[1]:+.2f} mm the right corner moves
    {right:+.2f} px outwards, the left one {left:+.2f} px. """
    if np.isinf(pair.together):
        return f"{said}α has no ±: a camera longer by 1 px, 0.375 mm farther, sees the same."
    return f"{said}α has ± {pair.together:.2f} px, and ± {pair.alone:.2f} px at a known distance."


def _from_above(paper: Paper, far: float, moves: Array) -> Panel:
    """Draw the board, and below the picture: how either corner moves for α, then for T_z."""
    half = 750 * _PLAN[0] / _PLAN[1] / 2
    panel = paper.panel(_PLAN, (-half, half), (530, -220), "from above: pull the far corner")
    near, away = np.array([[_X * NEAR, NEAR], [-_X * far, far]])
    panel.line(600 * np.array([[_X, 1], [0, 0], [-_X, 1]]), MUTED, 0.8)
    panel.line([[0, 0], [0, 600]], MUTED, 0.8, dash=4)
    panel.line([near, away], WORLD, 5)
    panel.mark([0, 0], "camera", 12)
    panel.mark([near, away], "world", 7)
    for at, by in ((near, (16, 0)), (away, (28, 22))):
        panel.text(at + by, f"{at[1]:.0f} mm", WORLD, size=13)
    panel.line([[-half, -130], [half, -130]], MUTED, 0.8)
    panel.text([0, -170], "the picture", MUTED, anchor="mm", size=13)
    for side, (longer, farther) in zip((1, -1), moves * _ENLARGED, strict=True):
        corner, out = np.array([side * 100, -130]), np.array([side, 0])
        panel.arrows(corner + [0, 18], longer * out, CAMERA, 4)
        panel.arrows(corner + [0, -18] + longer * out, farther * out, WORLD, 2)
        panel.mark(corner, "ideal", 6)
    panel.grip("far", "the far corner, along its ray", away, 5)
    return panel


def _moves(paper: Paper, pair: Pair, tried: Array, noise: Array) -> Panel:
    """Draw what both unknowns do to the corners, one arrow after the other, and the noise."""
    high = 0.8
    half = high * _MOVES[0] / _MOVES[1]
    title = "→ right corner moves out, ↑ left one (px)"
    panel = paper.panel(_MOVES, (-half, half), (high, -high), title)
    panel.ticks(x=(-0.5, 0, 0.5), y=(-0.5, 0, 0.5))
    _dots(panel, noise)
    panel.line(SIGMA * circle(91), IDEAL, 1.8)
    longer, farther = pair.J.T * tried[:, None]
    for start, by, ink, width in ((0 * longer, longer, CAMERA, 5), (longer, farther, WORLD, 2)):
        if np.linalg.norm(by) > 0.01:
            panel.arrows(start, by, ink, width)
    panel.mark(longer + farther, "estimated", 7)
    panel.text([-0.7, 0.7], f"distance {tried[1]:+.2f} mm", WORLD, anchor="lm", size=13)
    panel.text([0.7, -0.6], f"α {tried[0]:+.2f} px", CAMERA, anchor="rm", size=13)
    return panel


def _bowl(paper: Paper, pair: Pair, tried: Array, noise: Array) -> Panel:
    """Draw the same noise as errors of the unknowns, and lines of equal height of the bowl."""
    a, t = _SHOWN
    panel = paper.panel(_BOWL, (-a, a), (t, -t), "errors of α (px, →) and distance (mm, ↑)")
    panel.ticks(x=(-2, -1, 0, 1, 2), y=(-1, 0, 1))
    _dots(panel, pair.errors(noise))
    for times, width in ((2, 0.8), (1, 1.8)):
        panel.line(pair.errors(times * SIGMA * circle(721)), IDEAL, width)
    panel.line([[-pair.alone, 0], [pair.alone, 0]], CAMERA, 5)
    bar = "no ±" if np.isinf(pair.together) else f"± {pair.together:.2f} px"
    known = f"distance known: ± {pair.alone:.2f} px"
    for y, words, colour in ((-0.8, known, CAMERA), (-1.06, f"unknown: {bar}", IDEAL)):
        panel.text([a - 0.1, y], words, colour, anchor="rm", size=13)
    panel.mark(tried, "estimated", 7)
    panel.grip("tried", "a camera and a distance, to be tried", tried, 4)
    return panel


def _dots(panel: Panel, places: Array) -> None:
    up = (panel.y[1] - panel.y[0]) / panel.height * panel.scale  # of y, a px of the page down
    near = places[np.abs(places).max(axis=1) < 10]
    panel.polygons(near[:, None] + 1.6 * circle(9) * [panel.pixel, up], _DOT)
