"""Explore a poster seen straight on: of a guessed width, of the one that A gives, and small."""

from functools import lru_cache

import numpy as np
from PIL import Image as Bitmap

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.homography import dlt
from cvnotes.pictures import render_scene
from cvnotes.pictures.posters import poster_room
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, IDEAL
from cvnotes.warping import backward_warp, homography_map, map_array

_SIZE, _SHOWN = (640, 480), (440, 330)
_HIGH, _WIDEST = 240, 640  # px: how high a straightened poster is, and how wide at most
_LOWEST = 120
_SHRINK = 6  # so many times smaller is the small one: 40 px high
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
        Setting("small", "small, too", 0, 1, 1, 0, "40 px high, and not 240 px alone"),
        Setting("blur", "each blurs as much as it shrinks", 0, 1, 1, 0,
                "it asks all over its own square, and takes the mean"),
    )  # fmt: skip
    about = """A print on a wall at a slant, with its four corners marked; beside it the same
    straight on: of a guessed width and of the one that the camera's A gives, or large and small."""

    drags = {f"corner {i}": placed(f"u{i}", f"v{i}") for i in range(1, 5)}
    drags["width"] = placed("guess")
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


def straight_on(four: Array, wide: int, high: int = _HIGH, asks: int = 1) -> Drawn:
    """Return the poster with these corners (4, 2), straight on and so many pixels wide.

    Each pixel asks so many times across and down, all over its own square, and takes the mean.
    """
    size = (asks * wide, asks * high)
    H = dlt(_SQUARE * size - 0.5, four)
    many = backward_warp(photograph(), homography_map(H), size=size)
    if asks > 1:
        many = np.rint(many.reshape(high, asks, wide, asks, 3).mean(axis=(1, 3)))
    return np.asarray(many, np.uint8)


def asked(four: Array, wide: int) -> Array:
    """Return where the pixels of the small poster ask (v, u, 2)."""
    size = (wide, _HIGH // _SHRINK)
    return map_array(homography_map(dlt(_SQUARE * size - 0.5, four)), size)


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
    ratio, guess, blur = wide_by_high(four), int(values["guess"]), bool(values["blur"])
    by_A = round(min(max(_HIGH * ratio, 1), _WIDEST))
    title = f"straight on, {guess} px wide: a guess, pull its edge"
    above, above_sun = _hung(paper, straight_on(four, guess), title)
    if values["small"]:
        few, high, asks = round(guess / _SHRINK), _HIGH // _SHRINK, _SHRINK if blur else 1
        how = "each blurs as much as it shrinks" if blur else "each asks once"
        small = straight_on(four, few, high, asks).repeat(_SHRINK, axis=0).repeat(_SHRINK, axis=1)
        below, _ = _hung(paper, small, f"{few} × {high} pixels: {how}")
        dots = asked(four, few)[:, [few // 8, -few // 8]]
        left.polygons(dots.reshape(-1, 1, 2) + 3 * (_SQUARE - 0.5), ESTIMATED)
        sentence = _apart(dots, asks)
    else:
        poster = straight_on(four, by_A, asks=1 + blur)
        below, below_sun = _hung(paper, poster, f"straight on, {by_A} px wide: by A")
        sentence = f"""Of the guessed width, {guess} px, the sun is {above_sun}. By A what the
        corners frame is {ratio:.2f} times as wide as high, and the sun is {below_sun}."""
    left.mark(four, "estimated", 6)
    for i, at in enumerate(four, start=1):
        left.grip(f"corner {i}", f"corner {i}, {_NAMES[i - 1]}", at, 1)
        aside = at + 30 * np.sign(at - four.mean(axis=0))
        left.text(aside, f"{i}", ESTIMATED, anchor="mm", size=14)
    edge = [guess - 0.5, _HIGH / 2]
    above.line([[edge[0], -0.5], [edge[0], _HIGH - 0.5]], ESTIMATED, 2.5)
    above.grip("width", "the right edge, whose place is guessed", edge, 8, "estimated", 6)
    return Drawing(paper.join((left, [above, below])), sentence)


def _apart(dots: Array, asks: int) -> str:
    """Say how far apart the pixels of two columns (v, 2, 2) ask, and how often."""
    far = np.linalg.norm(dots[-1] - dots[0], axis=-1) / (len(dots) - 1)
    how = f"{asks**2} times, all over its own square, and takes the mean" if asks > 1 else "once"
    return f"""Along a column the pixels of the small picture ask {far[0]:.1f} px apart on the left
    (dots) and {far[1]:.1f} px on the right. Each asks {how}."""


def _hung(paper: Paper, poster: Drawn, title: str) -> tuple[Panel, str]:
    """Draw the poster straight on, a circle about its sun; and say how large that is."""
    (low, high), (tall, wide) = np.rint(np.array(_PLACE)).astype(int).tolist(), poster.shape[:2]
    panel = paper.panel(_PANEL, *_PLACE, title)
    sheet = np.full((high[1] - high[0], low[1] - low[0], 3), 255, np.uint8)
    sheet[-high[0] :, -low[0] :][:tall, :wide] = poster
    panel.image(sheet)
    begin, end = sun(poster)
    across, down = end - begin + 1
    if not np.isfinite(across):
        return panel, "not to be seen"
    if begin.min() == 0 or (end == [wide - 1, _HIGH - 1]).any():
        return panel, "cut by the frame"
    panel.line((begin + end) / 2 + down / 2 * circle(61), IDEAL, 1.3, dash=3)
    return panel, f"{across:.0f} px wide and {down:.0f} px high"
