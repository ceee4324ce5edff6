"""Explore a poster seen straight on: of a width that is guessed, and of the one that A gives."""

from functools import lru_cache

import numpy as np
from PIL import Image as Bitmap

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.homography import dlt
from cvnotes.pictures import render_scene
from cvnotes.pictures.posters import poster_room
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, IDEAL
from cvnotes.warping import backward_warp, homography_map

_SIZE, _SHOWN = (640, 480), (440, 330)
_HIGH, _WIDEST = 240, 640  # px: how high a straightened poster is, and how wide at most
_LOWEST = 120
_PLACE, _PANEL = ((-20.0, 660.0), (-12.0, 252.0)), (391, 151)  # of each poster; px of the page
_READ = np.array([[170.0, 70], [415, 156], [414, 305], [172, 389]])  # corners, to whole pixels
_SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
_NAMES = ("upper left", "upper right", "lower right", "lower left")
_BESIDE_SUN = 362  # px: right of the sun in the photograph
_RED = 2.0  # so many times as red as green is the sun


def poster_model() -> Model:
    """Make the model of the print of chapter 8, with four corners to be pulled."""
    settings = (
        Setting("guess", "guessed width (px)", _LOWEST, _WIDEST, 1, 320, "240 px high"),
        *(
            Setting(f"{axis}{i}", f"corner {i} {axis}", low, high, 1, start, f"{name}, in px")
            for i, name in enumerate(_NAMES, start=1)
            for axis, start, low, high in zip("uv", _READ[i - 1].tolist(), *_limits(i), strict=True)
        ),
    )
    about = (
        "A print on a wall at a slant, with its four corners marked; beside it the same straight "
        "on, once of a width that is guessed, and once of the width that the camera's A gives."
    )

    def corner(i: int) -> Drag:
        return lambda _, at: {f"u{i}": float(at[0]), f"v{i}": float(at[1])}

    drags = {f"corner {i}": corner(i) for i in range(1, 5)}
    drags["width"] = lambda _, at: {"guess": float(at[0])}
    return Model("poster", about, settings, _draw, drags)


def _limits(i: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return how far, (u, v) to (u, v), a corner may go: the others stay beyond it.

    The right-hand corners, which the page has pulled along the edges, stop before the sun.
    """
    across = (120, 280) if i in (1, 4) else (_BESIDE_SUN, 480)
    down = (20, 220) if i < 3 else (240, 440)
    return (across[0], down[0]), (across[1], down[1])


@lru_cache(maxsize=1)
def camera() -> Camera:
    """Return the camera of the chapter, to the right of the print."""
    there = look_at([-1500, -300, 4900], [-2980, -250, 7400])
    return Camera(intrinsics(520, 520, 319.5, 239.5), there, size=_SIZE)


@lru_cache(maxsize=1)
def photograph() -> Drawn:
    """Photograph the print aslant."""
    return render_scene(poster_room(), camera())


@lru_cache(maxsize=2)
def _shown(sharpness: int) -> Drawn:
    """Keep the photograph as large as its panel: it is the same for all values."""
    size = (sharpness * _SHOWN[0], sharpness * _SHOWN[1])
    return np.asarray(Bitmap.fromarray(photograph()).resize(size))


def wide_by_high(four: Array) -> float:
    """Return how many times as wide as high, by A, a rectangle with these corners (4, 2) is."""
    h1, h2, _ = np.linalg.solve(camera().A, dlt(_SQUARE, four)).T
    return float(np.linalg.norm(h1) / np.linalg.norm(h2))


def straight_on(four: Array, wide: int) -> Drawn:
    """Return the poster with these corners (4, 2), straight on and so many pixels wide."""
    size = (wide, _HIGH)
    H = dlt(_SQUARE * size - 0.5, four)
    return np.asarray(backward_warp(photograph(), homography_map(H), size=size), np.uint8)


def sun(poster: Drawn) -> Array:
    """Return where the sun begins and ends, (u, v) each, in a poster; NaN where none is."""
    v, u = np.nonzero(poster[..., 0] > _RED * poster[..., 1])
    if not len(u):
        return np.full((2, 2), np.nan)
    return np.array([[u.min(), v.min()], [u.max(), v.max()]], dtype=np.float64)


def _draw(paper: Paper, values: Values) -> Drawing:
    four = np.array([[values[f"u{i}"], values[f"v{i}"]] for i in range(1, 5)])
    left = paper.picture_panel(_SHOWN, _SIZE, "the photograph: pull the corners of the print")
    left.image(_shown(paper.sharpness))
    left.line(four[[0, 1, 2, 3, 0]], ESTIMATED, 2)
    left.mark(four, "estimated", 6)
    for i, at in enumerate(four, start=1):
        left.grip(f"corner {i}", f"corner {i}, {_NAMES[i - 1]}", at, 1)
        aside = at + 30 * np.sign(at - four.mean(axis=0))
        left.text(aside, f"{i}", ESTIMATED, anchor="mm", size=14)
    ratio, guess = wide_by_high(four), int(values["guess"])
    by_A = round(min(max(_HIGH * ratio, 1), _WIDEST))
    above = _straight(paper, four, guess, f"straight on, {guess} px wide: a guess, pull its edge")
    below = _straight(paper, four, by_A, f"straight on, {by_A} px wide: by A")
    edge = [guess - 0.5, _HIGH / 2]
    above[0].line([[edge[0], -0.5], [edge[0], _HIGH - 0.5]], ESTIMATED, 2.5)
    above[0].mark(edge, "estimated", 6)
    above[0].grip("width", "the right edge, whose place is guessed", edge, 8)
    sentence = (
        f"Of the guessed width, {guess} px, the sun is {above[1]}. By A what the corners "
        f"frame is {ratio:.2f} times as wide as high, and the sun is {below[1]}."
    )
    return Drawing(paper.join((left, [above[0], below[0]])), sentence)


def _straight(paper: Paper, four: Array, wide: int, title: str) -> tuple[Panel, str]:
    """Draw the poster straight on, a circle about its sun; and say how large that is."""
    (low, high), poster = np.rint(np.array(_PLACE)).astype(int).tolist(), straight_on(four, wide)
    panel = paper.panel(_PANEL, *_PLACE, title)
    sheet = np.full((high[1] - high[0], low[1] - low[0], 3), 255, np.uint8)
    sheet[-high[0] :, -low[0] :][:_HIGH, :wide] = poster
    panel.image(sheet)
    begin, end = sun(poster)
    across, down = end - begin + 1
    if not np.isfinite(across):
        return panel, "not to be seen"
    if begin.min() == 0 or (end == [wide - 1, _HIGH - 1]).any():
        return panel, "cut by the frame"
    panel.line((begin + end) / 2 + down / 2 * circle(61), IDEAL, 1.3, dash=3)
    return panel, f"{across:.0f} px wide and {down:.0f} px high"
