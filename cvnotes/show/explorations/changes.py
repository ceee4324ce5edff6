"""Explore how inner corners are told from others: a ring, and its changes of light and dark."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.pictures import course
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.rings import blurred
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED

_VIEW = 6  # which photograph of the course
_LEFT, _TOP, _WIDE, _HIGH = 168, 141, 56, 45  # px: the part of it that is shown
_PART, _LEVELS = (448, 360), (336, 360)  # px of the page
_AROUND, _N = 5, 16  # px, the ring's radius, and its pixels
_FLAT = 40  # grey levels: what is less is no light and dark


def changes_model() -> Model:
    """Make the model of a ring over a part of a photograph, and of the grey levels on it."""
    u, v = _LEFT + _AROUND + 1, _TOP + _AROUND + 1
    settings = (
        Setting("u", "u (px)", u, u + _WIDE - 2 * _AROUND - 3, 1, 205, "column of its middle"),
        Setting("v", "v (px)", v, v + _HIGH - 2 * _AROUND - 3, 1, 151, "row of its middle"),
    )
    about = (
        "A dark square at the rim of a chessboard, with a ring of sixteen pixels round one of its "
        "corners; beside it their grey levels in turn, with the places where light and dark change."
    )
    drags = {"ring": lambda _, at: {"u": float(at[0]), "v": float(at[1])}}
    return Model("changes", about, settings, _draw, drags)


@lru_cache(maxsize=1)
def _soft() -> Array:
    """Return the photograph, blurred by a Gaussian of one pixel: noise makes no changes."""
    photo = course.photo(_VIEW)
    height, width = photo.shape
    return np.asarray(blurred(height, 1) @ photo @ blurred(width, 1).T)


def ring_at(u: float, v: float) -> tuple[Array, Array, Array]:
    """Return a ring's pixels (16, 2), their grey levels, and which of them are light."""
    turn = 2 * np.pi * np.arange(_N) / _N
    at = np.rint([u, v] + _AROUND * np.column_stack([np.cos(turn), np.sin(turn)])).astype(int)
    grey = _soft()[at[:, 1], at[:, 0]]
    return at, grey, grey > (grey.min() + grey.max()) / 2


def _draw(paper: Paper, values: Values) -> Drawing:
    u, v = values["u"], values["v"]
    at, grey, light = ring_at(u, v)
    flat = float(np.ptp(grey)) < _FLAT
    inks = [MUTED if flat else ESTIMATED if one else LENS for one in light]
    x, y = (_LEFT - 0.5, _LEFT + _WIDE - 0.5), (_TOP - 0.5, _TOP + _HIGH - 0.5)
    part = paper.panel(_PART, x, y, "pull the ring from corner to corner")
    photo = course.photo(_VIEW)
    part.image(photo[_TOP : _TOP + _HIGH, _LEFT : _LEFT + _WIDE], smooth=False)
    part.polygons(at[:, None] + 0.62 * circle(17), "#FFFFFF")
    part.polygons(at[:, None] + 0.48 * circle(17), inks)
    turn = np.radians(np.linspace(8, 60, 9))  # from the right, clockwise on the page: v runs down
    arc = [u, v] + (_AROUND + 1.6) * np.column_stack([np.cos(turn), np.sin(turn)])
    for colour, width in (("#FFFFFF", 5), (IDEAL, 2)):
        part.line(arc, colour, width)
        part.arrows(arc[-5:-4], arc[-1:] - arc[-5:-4], colour, width)
    part.grip("ring", "the ring, to be pulled over the photograph", [u, v])
    times = 0 if flat else int(np.sum(light != np.roll(light, 1)))
    return Drawing(
        paper.join((part, _levels(paper, grey, light, inks, times))), _sentence(u, v, flat, times)
    )


def _levels(paper: Paper, grey: Array, light: Array, inks: list[str], times: int) -> Panel:
    """Draw the grey levels on the ring as bars, and a stroke where light and dark change."""
    title = "grey levels, clockwise from the right"
    panel = paper.panel(_LEVELS, (-2.6, _N), (300, -12), title)
    panel.ticks(y=(0, 50, 100, 150, 200), size=11)
    bar = np.array([[0.1, 0], [0.9, 0], [0.9, 1], [0.1, 1]])
    bars = [[i, 0] + bar * [1, level] for i, level in enumerate(grey)]
    panel.polygons(bars, inks)
    if times:
        half = float(grey.min() + grey.max()) / 2
        panel.line([[0, half], [_N, half]], IDEAL, 1, dash=4)
        for i in np.flatnonzero(light != np.roll(light, 1)).tolist():
            panel.line([[i, 0], [i, 240]], IDEAL, 1.6)
    words = f"{times} changes" if times else "nearly alike"
    panel.text([_N / 2, 268], words, IDEAL, anchor="mm", size=22)
    return panel


def _sentence(u: float, v: float, flat: bool, times: int) -> str:
    if flat:
        return f"Round ({u:.0f}, {v:.0f}) all pixels are nearly alike."
    return f"Round ({u:.0f}, {v:.0f}) light and dark change {times} times."
