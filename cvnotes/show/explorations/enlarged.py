"""Explore an enlargement: between the pixels of a photograph nothing was seen."""

from functools import lru_cache
from typing import Literal

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.pictures import course, render
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS
from cvnotes.warping import backward_warp, map_array, zoom_map

VIEW, FACTOR, SIZE = 6, 8, (480, 360)  # which photograph, how much larger, and px of the piece
CORNER = np.array([284.0, 196.0])  # px of the photograph, where the piece begins
_ROW = 270  # of the piece, whose grey values are drawn
_BESIDE = (290, 360)
Method = Literal["nearest", "bilinear"]


def enlarged_model() -> Model:
    """Make the model of a piece of a photograph, enlarged to the left of a bar that is pulled."""
    settings = (
        Setting("bar", "bar (px)", 0, SIZE[0], 1, 300, "how far the enlargement reaches"),
        Setting("bilinear", "bilinear", 0, 1, 1, 1, "or the nearest pixel"),
    )
    about = (
        "A corner of a board. Left of an orange bar is a photograph, eight times as large; right "
        "of it what a camera with a lens eight times as long sees. Beside it the grey values of "
        "one row."
    )
    return Model("enlarged", about, settings, _draw, {"bar": lambda _, at: {"bar": float(at[0])}})


@lru_cache(maxsize=2)
def piece(method: Method) -> Array:
    """Enlarge the piece of the photograph, (height, width) of grey values."""
    look_up = CORNER + map_array(zoom_map(1 / FACTOR), SIZE)
    return np.asarray(backward_warp(course.photo(VIEW), look_up, method=method), np.float64)


@lru_cache(maxsize=1)
def sharp() -> Array:
    """Photograph the piece with a lens eight times as long, (height, width) of grey values."""
    short = course.camera()
    A = np.diag([FACTOR, FACTOR, 1]) @ short.A
    A[:2, 2] = FACTOR * (short.A[:2, 2] - CORNER + 0.5) - 0.5
    long = Camera(A, course.poses()[VIEW], short.lens, SIZE)
    return np.asarray(render(course.board(), long, blur=0.7), np.float64)


def _draw(paper: Paper, values: Values) -> Drawing:
    bar = int(values["bar"])
    method: Method = "bilinear" if values["bilinear"] else "nearest"
    enlarged = piece(method)
    shown = np.where(np.arange(SIZE[0]) < bar, enlarged, sharp())
    panel = paper.picture_panel(
        SIZE, SIZE, f"{method}, eight times as large | a lens eight times as long"
    )
    panel.image(shown.round().clip(0, 255).astype(np.uint8))
    panel.line([[-1, _ROW], [SIZE[0], _ROW]], LENS, 1, dash=6)
    panel.line([[bar - 0.5, -1], [bar - 0.5, SIZE[1]]], ESTIMATED, 3)
    panel.grip("bar", "the bar", [bar - 0.5, 60], 8)
    curve = _curve(paper, enlarged, bar)
    off = np.sqrt(np.mean((enlarged - sharp()) ** 2))
    wide = [rise(picture[_ROW]) for picture in (enlarged, sharp())]
    sentence = (
        f"From dark to light the row takes {wide[0]} px in the enlargement, and {wide[1]} px "
        f"through the long lens. All in all they differ by {off:.0f} grey levels (RMS)."
    )
    return Drawing(paper.join((panel, curve)), sentence)


def rise(row: Array) -> int:
    """Count the pixels of a row (n,) whose grey is in the middle eight tenths of its range."""
    low, high = row.min(), row.max()
    return int(np.sum((row > low + 0.1 * (high - low)) & (row < high - 0.1 * (high - low))))


def _curve(paper: Paper, enlarged: Array, bar: int) -> Panel:
    panel = paper.panel(_BESIDE, (0, SIZE[0]), (275, -20), "grey values of the dashed row")
    panel.ticks(y=(0, 100, 200))
    for row, ink, width in ((sharp(), IDEAL, 1.2), (enlarged, LENS, 2.2)):
        panel.line(np.column_stack([np.arange(SIZE[0]), row[_ROW]]), ink, width)
    panel.line([[bar, 275], [bar, -20]], ESTIMATED, 1.5)
    panel.text([14, 262], "enlarged", LENS, size=13)
    panel.text([14, 236], "the long lens", IDEAL, size=13)
    return panel
