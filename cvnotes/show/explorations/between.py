"""Explore what lies between four pixels, each weighted by the area of the opposite rectangle."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, hexed
from cvnotes.warping import interpolate

_GREY = np.array([60.0, 90, 110, 200])  # I1 to I4: the upper two pixels, then the lower two
_NAMES = "I₁", "I₂", "I₃", "I₄"
_AT = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
_REACH = 0.36  # px beyond the centres
_PIXEL = 0.09  # px from the centre to the side of the little squares that stand for the pixels
_FINE = 120  # the surface is drawn in so many steps
_LIGHT = 117  # grey level on which black and white are read equally well


def between_model() -> Model:
    """Make the model of a place between four pixels."""
    settings = (
        Setting("du", "Δu", 0, 1, 0.05, 0.35, "how far right of I₁, in pixels"),
        Setting("dv", "Δv", 0, 1, 0.05, 0.6, "how far below I₁, in pixels"),
    )
    about = """Four pixels and a place between their centres, which cuts the square between them
    into four rectangles; and the same as a smooth surface."""
    drags = {"place": placed("du", "dv")}
    return Model("between", about, settings, _draw, drags)


def weights(du: float, dv: float) -> Array:
    """Return the weights (4,) of the pixels: the areas opposite to them."""
    return np.array([(1 - du) * (1 - dv), du * (1 - dv), (1 - du) * dv, du * dv])


def _draw(paper: Paper, values: Values) -> Drawing:
    du, dv = values["du"], values["dv"]
    place, weight = np.array([du, dv]), weights(du, dv)
    drawn = paper.join((_areas(paper, place, weight), _surface(paper, place)))
    terms = " + ".join(f"{w:.2f} · {g:g}" for w, g in zip(weight, _GREY, strict=True))
    nearest = ", or ".join(f"{g:g}" for g in _GREY[weight > weight.max() - 1e-9])
    said = f"{terms} = {weight @ _GREY:.1f}. The nearest pixel alone says {nearest}."
    return Drawing(drawn, said)


def _cell(paper: Paper, title: str) -> Panel:
    """Make a panel with the square between four centres."""
    return paper.panel((400, 400), (-_REACH, 1 + _REACH), (-_REACH, 1 + _REACH), title)


def _box(low: npt.ArrayLike, high: npt.ArrayLike) -> Array:
    """Return the corners (1, 4, 2) of an upright rectangle."""
    (u0, v0), (u1, v1) = np.asarray(low), np.asarray(high)
    return np.array([[[u0, v0], [u1, v0], [u1, v1], [u0, v1]]])


def _areas(paper: Paper, place: Array, weight: Array) -> Panel:
    """Draw the square in four rectangles, each as grey as the pixel that it weighs."""
    panel = _cell(paper, "each pixel is weighted by the opposite area")
    for at, grey in zip(_AT, _GREY, strict=True):
        panel.polygons(_box(*np.sort([1 - at, place], axis=0)), hexed(3 * [grey]))
    for at, grey in zip(_AT, _GREY, strict=True):
        panel.polygons(_box(at - _PIXEL, at + _PIXEL), hexed(3 * [grey]))
    for ends in (_box([0, 0], [1, 1])[0], *_box([0, 0], place), *_box(place, [1, 1])):
        panel.line([*ends, ends[0]], ESTIMATED, 1.5)
    for at, name, grey, w in zip(_AT, _NAMES, _GREY, weight, strict=True):
        panel.text(at + (at - 0.5) * [0, 0.55], f"{name} = {grey:g}", LENS, anchor="mm", size=15)
        if (np.abs(1 - at - place) > [0.31, 0.12]).all():
            _write(panel, (1 - at + place) / 2, f"{name} × {w:.2f}", grey)
    panel.grip("place", "a place between four pixels", place, 8, "estimated", 8)
    return panel


def _surface(paper: Paper, place: Array) -> Panel:
    """Draw every value between the pixels, and the way: twice along u, once along v."""
    panel = _cell(paper, "twice along u, once along v")
    steps = np.linspace(-_REACH, 1 + _REACH, _FINE).clip(0, 1)
    between = interpolate(_GREY.reshape(2, 2), np.stack(np.meshgrid(steps, steps), axis=-1))
    panel.image(np.rint(between).astype(np.uint8))
    du, dv = place
    above, below = _GREY[[0, 2]] + (_GREY[[1, 3]] - _GREY[[0, 2]]) * du
    panel.line([[du, 0], [du, 1]], ESTIMATED, 2)
    for v, name, value in ((0, "upper", above), (1, "lower", below)):
        panel.line([[0, v], [1, v]], LENS, 2)
        panel.mark([du, v], "estimated", 6)
        _write(panel, np.array([du, v + 0.36 * (v - 0.5)]), f"{name} {value:.1f}", value)
    panel.mark(_AT, "lens", 6)
    panel.mark(place, "estimated", 8)
    aside = np.array([0.17 if du < 0.5 else -0.17, np.clip(dv, 0.1, 0.9) - dv])
    value = float(weights(du, dv) @ _GREY)
    _write(panel, place + aside, f"{value:.1f}", value)
    return panel


def _write(panel: Panel, at: Array, words: str, grey: float) -> None:
    """Write on grey: white on what is dark, black on what is light."""
    ink = IDEAL if grey > _LIGHT else "#FFFFFF"
    panel.text(at, words, ink, anchor="mm", size=15, rim=hexed(3 * [grey]))
