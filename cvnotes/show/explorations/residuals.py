"""Explore residuals: with a wrong lens they form a pattern, with the right one they are noise."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration.refinement import solve_by_schur, take_step
from cvnotes.pictures import course
from cvnotes.show.explorations.finding import Finding, alike, rms
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import GRID, Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS

_SENSOR, _BESIDE = (500, 375), (270, 375)  # px
_LONG = 20  # px of the photographs: about so long is an arrow as long as the RMS drawn
_BAR = 75  # px of the photographs: the bar that shows the scale is as long as this at most
_SURE = 1e12  # how much more one wish about k1 weighs than all pictures


def residuals_model() -> Model:
    """Make the model of all residuals of the first chapter's twelve photographs, for a given k1."""
    settings = (
        Setting("k1", "k₁", -0.4, 0.1, 0.01, 0, "the lens that is believed; the rest fits"),
    )
    about = """All corners of twelve photographs on one sensor, each with an arrow to where the best
    camera with this k₁ puts it. Beside it the RMS of all arrows against k₁."""
    return Model("residuals", about, settings, _draw, {"k1": placed("k1")})


@lru_cache(maxsize=1)
def _finding() -> Finding:
    return Finding(course.first_corners())


@lru_cache(maxsize=128)
def fitted(k1: float) -> Array:
    """Find all that fits best beside a given k1; return its misses (12, 54, 2), in pixels."""
    problem, x = _finding().problem, _finding().states[-1]
    place = problem.names.index("k1")
    for _ in range(8):
        _, system = problem.linearise(x)
        system.shared[place, place] += _SURE
        system.g_shared[place] += _SURE * (x.shared[place] - k1)
        x = take_step(x, solve_by_schur(system, 0.0)[0])
    return -problem.residuals(problem.camera_of(x.shared), x)


@lru_cache(maxsize=1)
def _valley() -> Array:
    """Return some k1 and the RMS of the best camera with each, (n, 2)."""
    some = np.r_[-0.4:-0.28:0.01, -0.28:-0.22:0.0025, -0.22:-0.1:0.01, -0.1:0.11:0.02].round(4)
    return np.array([[k1, rms(fitted(float(k1)))] for k1 in some])


def _draw(paper: Paper, values: Values) -> Drawing:
    k1 = values["k1"]
    misses = fitted(k1)
    missed, agree = rms(misses), alike(misses)
    times = float(f"{_LONG / missed:.1g}")
    m = _finding().m.reshape(-1, 2)
    sensor = paper.picture_panel(_SENSOR, _finding().size, f"all residuals, × {times:,.0f}")
    frame = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * _finding().size - 0.5
    sensor.polygons([frame], "#F4F4F2")
    _scale(sensor, times)
    sensor.arrows(m, times * misses.reshape(-1, 2), ESTIMATED, 1.2)
    said = f"With k₁ = {k1:g} the RMS is {missed:.3g} px. Neighbouring arrows are"
    what = ("", "the model's lens is wrong") if agree > 0.2 else (" not", "what is left is noise")
    sentence = f"{said}{what[0]} alike: {what[1]}."
    return Drawing(paper.join((sensor, _curve(paper, k1, missed))), sentence)


def _scale(sensor: Panel, times: float) -> None:
    """Draw a bar of a round length as long as such an arrow, below the corners."""
    power = 10.0 ** np.floor(np.log10(_BAR / times))
    length = max(n * power for n in (1, 2, 5) if n * power * times <= _BAR)
    long = length * times
    end = np.array([_finding().size[0] - 20.0, _finding().size[1] - 22.0])
    sensor.line([end - [long, 0], end], IDEAL, 2)
    sensor.segments([[at - [0, 6], at + [0, 6]] for at in (end - [long, 0], end)], IDEAL, 2)
    sensor.text(end - [long + 12, 0], f"{length:g} px", IDEAL, anchor="rm", size=14)


def _curve(paper: Paper, k1: float, missed: float) -> Panel:
    panel = paper.panel(_BESIDE, (-0.46, 0.13), (-0.1, -2.5), "RMS (px) by k₁")
    panel.ticks(x=(-0.3, -0.2, -0.1, 0))
    for power in (-2, -1):
        panel.segments([[[-0.38, power], [0.13, power]]], GRID, 0.5)
        panel.text([-0.45, power], f"{10.0**power:g}")
    panel.line(np.column_stack([_valley()[:, 0], np.log10(_valley()[:, 1])]), LENS, 2)
    here = np.array([k1, np.log10(missed)])
    panel.grip("k1", "k₁, to be moved along the curve", here, 4, "estimated", 8)
    return panel
