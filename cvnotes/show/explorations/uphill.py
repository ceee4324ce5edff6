"""Explore the way back through a lens: from a seen radius to the ideal one, in steps."""

from collections.abc import Callable
from itertools import accumulate, pairwise

import numpy as np

from cvnotes.camera import Lens
from cvnotes.show.explorations.lens import bent_room, draw_fold, seen_radius
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED

_K1 = -0.4
_LENS = Lens(k=(_K1,))
_ROOM, _CLOSE, _WHOLE = (330, 190), (460, 250), (460, 130)  # px
_HIGH, _END, _F = 0.66, 1.12, 800  # of the rooms, half as high; of the curve; px


def uphill_model() -> Model:
    """Make the model of a point that a lens shows, and of two ways to where it came from."""
    settings = (Setting("seen", "r′", 0.5, 0.65, 0.0002, 0.6056, "where the lens shows the point"),)
    about = """A room through a lens with a point at r′; below, without the lens, guesses where it
    is. Beside it r L(r) over r: Newton climbs along tangents to r′, dividing along lines from 0."""
    drags = {"point": lambda _, at: {"seen": float(np.hypot(*at))}, "height": placed("", "seen")}
    return Model("uphill", about, settings, _draw, drags)


def _shown(r: float) -> float:
    return float(seen_radius(_LENS, np.asarray(r)))


def _divided(r: float, seen: float) -> float:
    return seen * r / _shown(r)


def _newton(r: float, seen: float) -> float:
    return r + (seen - _shown(r)) / (1 + 3 * _K1 * r**2)


def _guesses(step: Callable[[float, float], float], seen: float, rounds: int) -> list[float]:
    """Return the first guess, r′ itself, and those after each round."""
    return list(accumulate(range(rounds), lambda r, _: step(r, seen), initial=seen))


def _draw(paper: Paper, values: Values) -> Drawing:
    seen = values["seen"]
    ideal = float(_LENS.undistort([seen, 0.0])[0])
    newton, divided = _guesses(_newton, seen, 8), _guesses(_divided, seen, 60)
    wide = _HIGH * _ROOM[0] / _ROOM[1]
    x, y = (-wide, wide), (-_HIGH, _HIGH)
    through = paper.panel(_ROOM, x, y, "through the lens: pull the point")
    without = paper.panel(_ROOM, x, y, "without it: Newton's guesses")
    for room, lens in ((through, _LENS), (without, Lens())):
        room.image(bent_room(lens, room.x, room.y, _ROOM, paper.sharpness, 1))
    draw_fold(through, _LENS)
    through.line([[0.0, 0.0], [seen, 0.0]], LENS, 2)
    through.grip("point", "the point that the lens shows", [seen, 0], 1, "lens", 9)
    without.line([[0.0, 0.0], [wide, 0.0]], IDEAL, 1, dash=4)
    without.mark([[r, 0] for r in newton if r > 0], "estimated", 7)
    without.mark([ideal, 0], "ideal", 10)
    close = paper.panel(_CLOSE, (0.46, 1.06), (0.66, 0.41), "the steps: pull the height r′")
    whole = paper.panel(_WHOLE, (0, _END), (0.72, -0.04), "the whole curve: r L(r) over r")
    for panel in (close, whole):
        _draw_curve(panel, seen, ideal)
        _draw_steps(panel, divided, seen, MUTED, 0.9)
        _draw_steps(panel, newton, seen, ESTIMATED, 2.4)
    close.grip("height", "the height r′", [0.49, seen], 1)
    close.text([0.475, seen - 0.018], f"r′ = {seen:.4f}", IDEAL, size=15)
    whole.text([0.56, 0.26], "Newton: along the tangent", ESTIMATED, size=14)
    whole.text([0.56, 0.12], "dividing: along the line from 0", size=14)
    return Drawing(paper.join(([through, without], [close, whole])), _sentence(seen, ideal))


def _draw_curve(panel: Panel, seen: float, ideal: float) -> None:
    """Draw the curve up to the fold and beyond, and the height that is to be reached."""
    fold = _LENS.max_radius
    panel.line([[0.0, 0.0], [_END, 0.0]], MUTED, 1)
    for start, end, ink, dash in ((0.0, fold, LENS, 0), (fold, _END, ESTIMATED, 5)):
        r = np.linspace(start, end, 91)
        panel.line(np.stack([r, seen_radius(_LENS, r)], axis=1), ink, 3, dash)
    panel.line([[0.0, seen], [_END, seen]], IDEAL, 1.2)
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
    both = (enumerate(_guesses(step, seen, 500)) for step in (_newton, _divided))
    newton, divided = (next(n for n, r in way if _F * abs(r - ideal) < 0.1) for way in both)
    return f"""{said}: r = {ideal:.3f}. To a tenth of a pixel, with f = {_F} px, Newton's method
    takes {newton} rounds, dividing {divided}."""
