"""Explore the way back through a lens: dividing by L follows a ray, Newton's method a tangent."""

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED

_K1, _F = -0.4, 800  # of the lens, and px
_FOLD = float(np.sqrt(-1 / (3 * _K1)))
_ROUNDS = 20  # rounds of which the errors are drawn
_LEAST, _MOST = 1e-5, 300.0  # px: the errors that are drawn
_ENOUGH = 0.1  # px
_ACROSS, _UPWARDS = (0.455, 0.96), (0.365, 0.632)  # what is shown of the curve: r and r'
_SMALL, _HIGHEST = ((0.665, 0.387), (0.235, 0.11)), 0.66  # where all of it is drawn small

Step = Callable[[float, float], float]


def newton_model() -> Model:
    """Make the model of an ideal radius that is looked for in two ways."""
    settings = (
        Setting("r", "ideal radius r", 0.6, 0.91, 0.01, 0.86, "what is to be found, from r'"),
        Setting(
            "rounds", "rounds drawn", 1, 8, 1, 3, "how often each method goes on, in the middle"
        ),
    )
    about = (
        "The observed radius over the ideal one, a level, and the ways of two methods to where the "
        "curve reaches it; beside it how far off both are after each round."
    )

    def pulled(_: Values, at: Array) -> Values:
        return {"r": float(at[0])}

    return Model("newton", about, settings, _draw, {"level": pulled})


def seen(r: Array | float) -> Array:
    """Return the observed radius r L(r)."""
    return np.asarray(r * (1 + _K1 * np.square(r)))


def along_the_ray(r: float, level: float) -> float:
    """Divide by L: follow the ray from the origin through the curve up to the level."""
    return r * level / float(seen(r))


def along_the_tangent(r: float, level: float) -> float:
    """Take Newton's step: follow the tangent of the curve up to the level."""
    return r + (level - float(seen(r))) / (1 + 3 * _K1 * r * r)


def guesses(step: Step, level: float, rounds: int) -> Array:
    """Return the guesses (rounds + 1,) from r' on."""
    found = [level]
    for _ in range(rounds):
        found.append(step(found[-1], level))
    return np.array(found)


def _draw(paper: Paper, values: Values) -> Drawing:
    r, rounds = values["r"], int(values["rounds"])
    level = float(seen(r))
    title = f"r' over r, for k₁ = {_K1}: pull the plus".replace("-", "−")
    curve = paper.panel((540, 360), _ACROSS, _UPWARDS[::-1], title)
    curve.ticks(y=(0.4, 0.45, 0.5, 0.55, 0.6))
    for number in (0.5, 0.6, 0.7, 0.8):
        curve.text([number, 0.372], f"{number:g}", anchor="md", size=11)
    along = np.linspace(0.4, 0.96, 57)
    curve.line(np.column_stack([along, seen(along)]), LENS, 2.2)
    curve.line(np.array([[0, level], [1, level]]), IDEAL, 1)
    curve.line([[_FOLD, 0], [_FOLD, 1]], MUTED, 1, dash=4)
    curve.text([_FOLD + 0.005, 0.4], "fold", MUTED, anchor="lm", size=12)
    errors = paper.panel(
        (300, 360), (-2.6, _ROUNDS + 0.8), (np.log10(_MOST), np.log10(_LEAST)),
        "error (px) after each round",
    )  # fmt: skip
    for power in (2, 1, 0, -1, -2, -3, -4):
        errors.line(np.array([[-2.6, power], [_ROUNDS + 1, power]]), "#DDDDDD", 0.5)
        errors.text([-2.4, power], f"{10.0**power:g}", size=11)
    for n in range(0, _ROUNDS + 1, 5):
        errors.text([n, np.log10(_LEAST) + 0.25], f"{n}", anchor="mm", size=11)
    errors.text([_ROUNDS - 2.5, np.log10(_LEAST) + 0.75], "rounds", MUTED, anchor="mm", size=12)
    first = float(seen(level))
    curve.line(np.array([[0, 0], [level, first]]), MUTED, 1, dash=3)
    foot = np.array([level, first])
    curve.text([0.51, 0.413], "ray from (0, 0)", MUTED, size=12)
    _draw_whole(curve, level)
    curve.text(foot + [0.03, 0.004], "the tangent", ESTIMATED, size=12)
    counts = []
    for step, name, colour, side in (
        (along_the_ray, "dividing by L", MUTED, -1),
        (along_the_tangent, "Newton", ESTIMATED, 1),
    ):
        way = guesses(step, level, 1000)
        _way(curve, way[: rounds + 1], level, colour, 1.5, side)
        off = _F * np.abs(way - r)
        counts.append(int(np.argmax(off < _ENOUGH)))
        _series(errors, off, colour, rounds)
        end = min(int(np.argmax(off < 0.003)), 12)  # to the right of it the curve has fallen
        at = [end + 0.4, np.log10(max(off[end], 2e-4)) + 0.15]
        errors.text(at, name, colour, anchor="ld", size=12)
    curve.mark([level, level], "ideal", 6)
    curve.text([level, level + 0.013], "start: r₀ = r'", IDEAL, anchor="mm", size=13)
    curve.mark([r, level], "ideal", 8)
    curve.grip("level", "the level r', by the ideal radius that it belongs to", [r, level], 4)
    return Drawing(paper.join((curve, errors)), _sentence(r, level, counts))


def _draw_whole(panel: Panel, level: float) -> None:
    """Draw the same from (0, 0) on, small: the first ray of dividing, and what the panel shows."""
    box = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])

    def small(at: Array) -> Array:
        return np.asarray(_SMALL[0] + at / [1, _HIGHEST] * np.array(_SMALL[1]))

    panel.polygons([small(box * [1, _HIGHEST])], "#FFFFFF")
    panel.line(small(box * [1, _HIGHEST]), MUTED, 0.8)
    frame = np.transpose([_ACROSS, _UPWARDS])
    frame = np.minimum(frame[0] + box * (frame[1] - frame[0]), [1, _HIGHEST])
    panel.polygons([small(frame)], "#EEEEEE")
    along = np.linspace(0, 1, 61)
    panel.line(small(np.column_stack([along, seen(along)])), LENS, 1.8)
    panel.line(small(np.array([[0, level], [1, level]])), IDEAL, 1)
    reached = along_the_ray(level, level)
    panel.line(small(np.array([[0, 0], [reached, level]])), MUTED, 1.8)
    panel.line(small(np.array([[level, level], [level, float(seen(level))]])), MUTED, 1.8)
    panel.text(small(np.array([0.1, 0.03])), "(0, 0)", MUTED, anchor="ld", size=11)
    panel.text(
        small(np.array([0.98, 0.03])), "grey: the large picture", MUTED, anchor="rd", size=11
    )


def _way(panel: Panel, way: Array, level: float, colour: str, width: float, side: int) -> None:
    """Draw the way of a method: from the level to the curve, and along a line to the level.

    Two ways that begin alike lie side by side.
    """
    heights = np.column_stack([np.full(len(way), level), seen(way)])
    places = np.stack([np.repeat(way[:, None], 2, axis=1), heights], axis=-1).reshape(-1, 2)
    aside = side * width / 2 * panel.pixel
    panel.line(places[:-1] + [aside, 0], colour, width)


def _series(panel: Panel, off: Array, colour: str, rounds: int) -> None:
    """Draw errors round by round, as a logarithm; those of the rounds drawn as larger dots."""
    at = np.column_stack([np.arange(_ROUNDS + 1), np.log10(np.maximum(off[: _ROUNDS + 1], 1e-9))])
    panel.line(at, colour, 1.5)
    size = np.array([0.14, 0.055])
    box = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * size
    panel.polygons(at[: rounds + 1, None] + box, colour)


def _sentence(r: float, level: float, counts: list[int]) -> str:
    divided, newton = counts
    return (
        f"Seen at r' = {level:.3f}; looked for is r = {r:.2f}. To a tenth of a pixel, dividing by "
        f"L takes {divided} rounds, Newton's method {newton}."
    )
