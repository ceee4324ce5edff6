"""Explore the way back through a lens: from a seen radius to the ideal one, in steps."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from cvnotes.camera import Lens
from cvnotes.show.explorations.lens import bent_room, draw_fold, seen_radius
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED

_K1 = -0.4
_LENS = Lens(k=(_K1,))
_ROOM, _CLOSE, _WHOLE = (330, 205), (460, 272), (460, 138)  # px
_HIGH, _END = 0.66, 1.12  # of the rooms, half as high; of the curve
_F, _NEAR, _MOST = 800, 0.1, 500  # px; px; rounds until a method is given up
_DRAWN = {"Newton": 8, "dividing": 60}  # rounds


def uphill_model() -> Model:
    """Make the model of a point that a lens shows, and of two ways to where it came from."""
    settings = (Setting("seen", "r′", 0.5, 0.65, 0.0002, 0.6056, "where the lens shows the point"),)
    about = (
        "A room through a lens with a point at r′; below, without the lens, where guess after "
        "guess puts it. Beside it r L(r) over r: Newton's method climbs along the tangent up to "
        "the height r′, dividing along the line from the origin."
    )
    drags = {
        "point": lambda _, at: {"seen": float(np.hypot(*at))},
        "height": lambda _, at: {"seen": float(at[1])},
    }
    return Model("uphill", about, settings, _draw, drags)


def _shown(r: float) -> float:
    return r + _K1 * r**3


def _divided(r: float, seen: float) -> float:
    return seen * r / _shown(r)


def _newton(r: float, seen: float) -> float:
    return r + (seen - _shown(r)) / (1 + 3 * _K1 * r**2)


def _guesses(step: Callable[[float, float], float], seen: float, rounds: int) -> list[float]:
    """Return the first guess, r′ itself, and those after each round."""
    guesses = [seen]
    for _ in range(rounds):
        guesses.append(step(guesses[-1], seen))
    return guesses


def _draw(paper: Paper, values: Values) -> Drawing:
    seen = values["seen"]
    ideal = float(_LENS.undistort([seen, 0.0])[0])
    ways = {
        name: _guesses(step, seen, _DRAWN[name])
        for name, step in (("dividing", _divided), ("Newton", _newton))
    }
    wide = _HIGH * _ROOM[0] / _ROOM[1]
    rooms = []
    for lens, title in (
        (_LENS, "through the lens: pull the point"),
        (Lens(), "without it: Newton's guesses"),
    ):
        room = paper.panel(_ROOM, (-wide, wide), (-_HIGH, _HIGH), title)
        room.image(bent_room(lens, room.x, room.y, _ROOM, paper.sharpness, 1))
        rooms.append(room)
    through, without = rooms
    draw_fold(through, _LENS)
    through.line([[0, 0], [seen, 0]], LENS, 2)
    through.mark([seen, 0], "lens", 9)
    through.grip("point", "the point that the lens shows", [seen, 0], 1)
    without.line([[0, 0], [wide, 0]], IDEAL, 1, dash=4)
    without.mark([[r, 0] for r in ways["Newton"] if r > 0], "estimated", 7)
    without.mark([ideal, 0], "ideal", 10)
    close = paper.panel(_CLOSE, (0.46, 1.06), (0.66, 0.41), "the steps: pull the height r′")
    whole = paper.panel(_WHOLE, (0, _END), (0.72, -0.04), "the whole curve: r L(r) over r")
    for panel in (close, whole):
        _draw_curve(panel, seen, ideal)
        for name, ink, width in (("dividing", MUTED, 0.9), ("Newton", ESTIMATED, 2.4)):
            _draw_steps(panel, ways[name], seen, ink, width)
    close.grip("height", "the height r′", [0.49, seen], 1)
    close.text([0.475, seen - 0.018], f"r′ = {seen:.4f}", IDEAL, size=15)
    whole.text([0.56, 0.26], "Newton: along the tangent", ESTIMATED, size=14)
    whole.text([0.56, 0.12], "dividing: along the line from 0", size=14)
    return Drawing(paper.join(([through, without], [close, whole])), _sentence(seen, ideal))


def _draw_curve(panel: Panel, seen: float, ideal: float) -> None:
    """Draw the curve up to the fold and beyond, and the height that is to be reached."""
    fold = _LENS.max_radius
    panel.line([[0, 0], [_END, 0]], MUTED, 1)
    for ends, ink, dash in (((0, fold), LENS, 0), ((fold, _END), ESTIMATED, 5)):
        r = np.linspace(*ends, 91)
        panel.line(np.stack([r, seen_radius(_LENS, r)], axis=1), ink, 3, dash)
    panel.line([[0, seen], [_END, seen]], IDEAL, 1.2)
    if panel.x[0] > 0:
        for r, name in ((seen, "r₀"), (ideal, "r")):
            panel.line([[r, 0], [r, _shown(r)]], IDEAL, 1, dash=3)
            panel.text([r + 0.008, 0.425], name, IDEAL, size=16)


def _draw_steps(panel: Panel, guesses: list[float], seen: float, ink: str, width: float) -> None:
    """Draw each step: straight up to the height, then straight down to the curve."""
    for r, better in pairwise(guesses):
        start = [0, 0] if ink == MUTED else [r, _shown(r)]
        foot = [better, _shown(better)]
        panel.line([start, [better, seen], foot], ink, width)


def _sentence(seen: float, ideal: float) -> str:
    said = f"Seen at r′ = {seen:.4f}"
    if np.isnan(ideal):
        return f"{said}, above the top of the curve: no ideal point is seen there, and both fail."
    counts = [
        next(n for n, r in enumerate(_guesses(step, seen, _MOST)) if _F * abs(r - ideal) < _NEAR)
        for step in (_newton, _divided)
    ]
    return (
        f"{said}: r = {ideal:.3f}. To a tenth of a pixel, with f = {_F} px, Newton's method takes "
        f"{counts[0]} rounds, dividing {counts[1]}."
    )
