"""Explore aliasing: rings, finer and finer outwards, are shrunk, as they are or blurred before."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Paper, circle
from cvnotes.show.style import ESTIMATED, LENS, MUTED

_SIZE, _FINENESS = 240, 0.0036  # px, and rings per px for each px from the middle
_SHRINK = 3  # how many old pixels a new one is wide
_MIDDLE = (_SIZE - 1) / 2
_AROUND = 16  # px that the profile shows to either side
_FINEST = 1 / (2 * _SHRINK * _FINENESS)  # px from the middle: there a wave is two new pixels long
_HANDLE = 229.5  # px down to what a hand takes hold of: at the lower border, off all true rings


def rings_model() -> Model:
    """Make the model of a picture of rings, shrunk."""
    settings = (
        Setting("blur", "blur σ (new px)", 0, 1, 0.05, 0, "blurred first: 0.5 is the usual cure"),
        Setting("place", "look at (px)", 0, 104, 1, 90, "how far right of the middle"),
    )
    about = """Rings, finer and finer outwards; the same picture shrunk; and a piece of one row of
    both: the grey values that were there, and those that the new pixels take."""
    drags = {"place": placed("place", start=(_MIDDLE, 0))}
    return Model("rings", about, settings, _draw, drags)


def rings(x: Array, y: Array) -> Array:
    """Return the grey value x px right of the middle and y px below it."""
    return np.asarray(127.5 + 127.5 * np.cos(_FINENESS * np.pi * (x**2 + y**2)))


def taken(blur: float) -> Array:
    """Return how much of each old pixel (240,) a new one takes, along a row or a column."""
    old = np.arange(_SIZE, dtype=np.float64)
    new = _SHRINK * (np.arange(_SIZE // _SHRINK) + 0.5) - 0.5
    bilinear: Array = np.maximum(1 - np.abs(new[:, None] - old), 0)
    if not blur:
        return bilinear
    return np.asarray(bilinear @ blurred(_SIZE, blur * _SHRINK))


def blurred(n: int, sigma: float) -> Array:
    """Return the matrix (n, n) of a Gaussian blur along rows or columns: a page has no SciPy.

    Beyond the border the last pixel goes on.
    """
    at, far = np.arange(n), np.arange(-n, 2 * n)
    bell = np.exp(-0.5 * ((at[:, None] - far) / sigma) ** 2)
    return np.asarray(bell / bell.sum(axis=1, keepdims=True) @ (far.clip(0, n - 1)[:, None] == at))


def _draw(paper: Paper, values: Values) -> Drawing:
    blur, place = values["blur"], values["place"]
    line = np.arange(_SIZE) - _MIDDLE
    weights, old = taken(blur), rings(*np.meshgrid(line, line))
    new = weights @ old @ weights.T
    row = len(new) // 2
    y = _SHRINK * (row + 0.5) - 0.5 - _MIDDLE
    left = paper.picture_panel((360, 360), (_SIZE, _SIZE), f"{_SIZE} × {_SIZE} pixels")
    left.image((8 * np.rint(old / 8)).clip(0, 255).astype(np.uint8))
    held = np.array([_MIDDLE + place, _HANDLE])
    stick = np.array([[held[0], _MIDDLE + y + 7], held])  # from the box to its handle
    left.line(stick, ESTIMATED, 2, rim=3)
    left.polygons([held + 13 * left.pixel * circle(41)], "white")
    left.grip("place", "where to look along the row", held, 2, "estimated", 7)
    title = "shrunk by three; in blue 46 px to each side"
    right = paper.picture_panel((360, 360), (_SIZE, _SIZE), title)
    right.image((8 * np.rint(new / 8)).clip(0, 255).astype(np.uint8), smooth=False)
    frame = _MIDDLE + _FINEST * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    right.line(frame, LENS, 2.5, rim=3.5)
    low, high = _MIDDLE + place + np.array([-_AROUND, _AROUND])
    for panel in (left, right):
        around = np.array([[low, -7], [high, -7], [high, 7], [low, 7], [low, -7]])
        panel.line(around + [0, _MIDDLE + y], ESTIMATED, 2.5, rim=3.5)
    at = np.column_stack([_SHRINK * (np.arange(len(new)) + 0.5) - 0.5, new[row]])
    u = np.linspace(low, high, 600)
    there, below = np.column_stack([u, rings(u - _MIDDLE, np.full_like(u, y))]), []
    for curve, colour, title in (
        (there, MUTED, "the rings there, and what the new pixels take"),
        (at, ESTIMATED, "the new pixels alone"),
    ):
        panel = paper.panel((360, 130), (low, high), (285, -30), title)
        panel.line(curve, colour, 2)
        panel.mark(at[(at[:, 0] > low) & (at[:, 0] < high)], "estimated", 5)
        below.append(panel)
    wide = np.maximum(*np.abs(np.meshgrid(*2 * [line[1::_SHRINK]]))) < _FINEST
    before = old[1::_SHRINK, 1::_SHRINK]
    left_of = [f"{new[part].std():.0f} of {before[part].std():.0f}" for part in (wide, ~wide)]
    said = f"{_sentence(_FINENESS * place * _SHRINK)} Inside the blue frame "
    said += f"{left_of[0]} grey levels of contrast are left, outside {left_of[1]}."
    return Drawing(paper.join((left, right), tuple(below)), said)


def _sentence(rate: float) -> str:
    """Say how many rings pass from one new pixel to the next, and what these make of them."""
    said = f"There {rate:.2f} rings pass from one new pixel to the next"
    if rate <= 0.5:
        return f"{said}: at most one half, so that the new pixels can show them."
    return f"{said}. The new pixels cannot tell that from {abs(rate - round(rate)):.2f}."
