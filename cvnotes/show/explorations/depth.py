"""Explore depth: sweep a pair of pictures from near to far; each pixel keeps what agrees best."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, Image, luma
from cvnotes.camera import Camera, intrinsics, pose
from cvnotes.pictures import depth_map, pixel_centres, radiance, room
from cvnotes.pictures.meshes import from_above
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, rgb
from cvnotes.warping import backward_warp, interpolate

_PICTURE, _PLAN = (400, 300), (409, 628)
_ALPHA, _BASE, _SIZE = 520, 400, (640, 480)  # px, mm, px
_NEAREST, _FARTHEST = 2000, 12_000  # mm
_NOISE, _TEXTURE = 2, 2  # grey levels; so much the patch beside differs at least, or it is plain
_BRIGHT = 0.5  # of its light that a dot of the projector adds to a place
_SHIFTS = np.arange(_ALPHA * _BASE // _NEAREST, 16, -1)  # px, from near to far
_PATCH = 7  # pixels of the halved pictures
_UPRIGHT = 1400  # mm from the height of the cameras: floor and ceiling are a patch farther
_NAMES = {"cupboard": (1130, 8900), "box": (650, 6950), "table": (-2150, 6050)}
_COLOURED = 5500, 10_200  # mm: where most things are the colours change
_RAMP = "#F89540", "#CC4778", "#7E03A8", "#0D0887"  # from near to far
_NONE = 205  # grey level of a pixel without a depth
_WALL = 10_000  # mm
_WALLS = [[-3000, -600], [-3000, _WALL], [3000, _WALL], [3000, -600]]


class Sweep(NamedTuple):
    """How well the halved pictures agree, for each shift, and how much each pixel has to go by.

    Attributes
    ----------
    differences : ndarray, shape (shifts, height, width)
        Mean difference of the patches around a pixel of the left picture and around its partner.
    texture : ndarray, shape (height, width)
        The same, of a patch of the left picture and the one beside it.
    best : ndarray, shape (shifts, height, width)
        Which shift agrees best of all up to this one.
    back : ndarray, shape (shifts, height, width)
        The same for the pixels of the right picture, which look into the left one.
    """

    differences: Array
    texture: Array
    best: npt.NDArray[np.uint8]
    back: npt.NDArray[np.uint8]


def pair() -> tuple[Camera, Camera]:
    """Return two cameras that look the same way, the right one beside the left one."""
    A = intrinsics(_ALPHA, _ALPHA, (_SIZE[0] - 1) / 2, (_SIZE[1] - 1) / 2)
    left = Camera(A, size=_SIZE)
    return left, left.moved(pose(np.eye(3), [-_BASE, 0, 0]))


def in_two_colours(left: Image, right: Image, d: float) -> Drawn:
    """Lay two grey pictures over each other, in red and cyan, the right one d px to the right."""
    moved = backward_warp(right, lambda m: m - [d, 0], border="replicate")
    return np.stack([left, moved, moved], axis=-1).clip(0, 255).astype(np.uint8)


@lru_cache(maxsize=1)
def _light() -> tuple[Image, Image]:
    left, right = (luma(radiance(room(), camera, samples=4)) for camera in pair())
    return left, right


@lru_cache(maxsize=2)
def photographs(dots: bool = False) -> tuple[Image, Image]:
    """Return the grey pictures of both cameras, with noise, in a room with or without dots."""
    noise = np.random.default_rng(8).normal(0, _NOISE, (2, *_SIZE[::-1]))
    left, right = _light()
    if dots:
        thrown = [1 + _BRIGHT * dots_on(camera) for camera in pair()]
        left, right = left * thrown[0], right * thrown[1]
    return left + noise[0], right + noise[1]


def dots_on(camera: Camera) -> Array:
    """Return how bright (height, width) a projector's dots are on what each pixel shows.

    It stands between the cameras; what one of them sees and the projector does not gets dots, too.
    """
    projector = pair()[0].moved(pose(np.eye(3), [-_BASE / 2, 0, 0]))
    slide = np.random.default_rng(3).random(_SIZE[::-1]) < 0.25
    rays = np.insert(camera.ideal(pixel_centres(camera.size)), 2, 1, axis=-1)
    places = rays * depth_map(room(), camera)[..., None] - camera.T
    at = projector.project(places)
    return np.asarray(interpolate(slide.astype(np.float64), at, border="replicate"), np.float64)


@lru_cache(maxsize=2)
def sweep(dots: bool = False) -> Sweep:
    """Compare the two pictures at each shift."""
    left, right = photographs(dots)
    small = _halved(left)
    found = np.empty((len(_SHIFTS), *small.shape), np.float32)
    for difference, d in zip(found, _SHIFTS, strict=True):
        moved = np.roll(right, d, axis=1)
        moved[:, :d] = np.inf  # there the right camera has seen nothing
        difference[:] = _mean_around(np.minimum(np.abs(small - _halved(moved)), 255))
    back, columns = np.full_like(found, np.inf), np.arange(small.shape[1])
    for difference, other, d in zip(found, back, _SHIFTS, strict=True):
        there = columns + _halved_shift(d)
        inside = there < len(columns)
        other[:, inside] = difference[:, there[inside]]
    beside = np.abs(np.diff(small, axis=1, append=small[:, -1:]))
    return Sweep(found, _mean_around(beside), _best_so_far(found), _best_so_far(back))


def _halved_shift(d: npt.NDArray[np.intp] | np.intp) -> npt.NDArray[np.intp] | np.intp:
    """Return by how many columns of the halved pictures d px are, rounded up."""
    return (d + 1) // 2


def _best_so_far(differences: Array) -> npt.NDArray[np.uint8]:
    """Return which of the differences (shifts, height, width) is the least up to each of them."""
    best, least = np.zeros(differences.shape, np.uint8), differences[0].copy()
    for k in range(1, len(differences)):
        best[k] = np.where(differences[k] < least, k, best[k - 1])
        np.minimum(least, differences[k], out=least)
    return best


def _halved(picture: Image) -> Image:
    height, width = picture.shape
    return np.asarray(picture.reshape(height // 2, 2, width // 2, 2).mean(axis=(1, 3)))


def _mean_around(values: Array) -> Array:
    """Return the mean of the patch around each pixel."""
    half = _PATCH // 2
    padded = np.pad(values, half, mode="edge")
    total = np.pad(padded, ((1, 0), (1, 0))).cumsum(axis=0).cumsum(axis=1)
    n = _PATCH
    return np.asarray((total[n:, n:] - total[:-n, n:] - total[n:, :-n] + total[:-n, :-n]) / n**2)


def depths_so_far(Z: float, dots: bool = False) -> Array:
    """Return the depth in mm of each pixel of the left picture, halved; NaN where there is none.

    It is the one that agrees best of all up to Z, between two whole shifts where the next ones
    say so. A pixel has none if its patch differs from the one beside it by less than 2 grey
    levels, or from its partner by more than from that one, or if the partner does not come
    back to it, to one shift.
    """
    differences, enough, best, back = sweep(dots)
    last = min(int(np.searchsorted(-_SHIFTS, -_ALPHA * _BASE / Z, "right")), len(_SHIFTS)) - 1
    k = best[last].astype(int)
    inside = np.clip(k, 1, len(_SHIFTS) - 2)
    rows, columns = np.indices(k.shape)
    before, least, after = (differences[inside + step, rows, columns] for step in (-1, 0, 1))
    steep = np.maximum(before, after) - least  # a valley of two straight sides
    between = np.divide(before - after, 2 * steep, out=np.zeros_like(steep), where=steep > 0)
    found = _ALPHA * _BASE / (_SHIFTS[k] - np.where(k == inside, between.clip(-0.5, 0.5), 0))
    again = back[last][rows, (columns - _halved_shift(_SHIFTS[k])).clip(0)].astype(int)
    agree = (differences[k, rows, columns] < enough) & (abs(again - k) <= 1)
    return np.where(agree & (enough >= _TEXTURE), found, np.nan)


@lru_cache(maxsize=1)
def true_depths() -> Array:
    """Return the depth in mm of each pixel of the left picture, halved."""
    return depth_map(room(), pair()[0].resized((_SIZE[0] // 2, _SIZE[1] // 2)))


def coloured(depths: Array) -> Drawn:
    """Return a colour for each depth, from near to far; grey where there is none."""
    stops = 255 * np.array([rgb(colour) for colour in _RAMP])
    steps = np.linspace(0, len(stops) - 1, 256)
    colours = [np.interp(steps, range(len(stops)), channel) for channel in stops.T]
    table = np.array([*np.transpose(colours), 3 * [_NONE]], dtype=np.uint8)
    first, last = _COLOURED
    at = 255 * (depths - first) / (last - first)
    return np.asarray(table[np.where(np.isnan(at), 256, at.clip(0, 255)).astype(int)])


def depth_model() -> Model:
    """Make the model of the room, seen by two cameras side by side."""
    settings = (
        Setting("depth", "depth (mm)", _NEAREST, _FARTHEST, 50, 12_000,
                "each pixel keeps the depth that agrees best of all up to this one"),
        Setting("dots", "dots thrown", 0, 1, 1, 0,
                "whether a projector between the cameras throws dots on the room"),
    )  # fmt: skip
    about = """A room by two cameras side by side, one picture in red and the other in cyan, shifted
    until what lies at one depth has no fringes. Below, the depth of each pixel that agrees best of
    all up to this one, by colours; beside it what is neither floor nor ceiling, as dots, from
    above."""

    def draw(paper: Paper, values: Values) -> Drawing:
        Z, dots = values["depth"], bool(values["dots"])
        found = depths_so_far(Z, dots)
        panel = paper.picture_panel(_PICTURE, _SIZE, "left in red, right in cyan and shifted")
        panel.image(in_two_colours(*photographs(dots), _ALPHA * _BASE / Z))
        height, width = found.shape
        below = paper.picture_panel(_PICTURE, (width, height), "depth so far; grey: none")
        below.image(coloured(found), smooth=False)
        plan = _plan(paper, Z, found)
        return Drawing(paper.join(([panel, below], plan)), _sentence(Z, found))

    return Model("depth", about, settings, draw, {"depth": placed("", "depth")})


def _sentence(Z: float, found: Array) -> str:
    d, here = _ALPHA * _BASE / Z, ~np.isnan(found)
    near, far = _ALPHA * _BASE / (d + np.array([0.5, -0.5]))
    said = f"Shifted by {d:.1f} px, for {Z / 1000:.2f} m; one pixel is {far - near:.0f} mm here. "
    if here.mean() < 0.05:
        return f"{said}So far hardly a pixel has a depth."
    off = np.median(np.abs(found - true_depths())[here])
    return f"""{said}So far {100 * here.mean():.0f} of 100 pixels have a depth; half of these are
    off by less than {off:.0f} mm."""


def _plan(paper: Paper, Z: float, found: Array) -> Panel:
    """Draw from above where what has a depth so far must be, and where it is."""
    title = "from above, without floor and ceiling: pull the line"
    panel = paper.panel(_PLAN, (-4150, 4650), (12_900, -620), title)
    panel.image(_dots(panel, found), smooth=False)
    for corners in from_above(room(), -1500)[0]:
        panel.line([*corners, corners[0]], IDEAL, 1)
    panel.line(_WALLS, IDEAL, 1.5)
    for thing, at in _NAMES.items():
        panel.text(at, thing, IDEAL, anchor="mm", size=12)
    depths = np.arange(2000.0, 13_000, 2000, dtype=np.float64)
    for at, ink in zip(depths, coloured(depths), strict=True):  # in the colour of its dots
        tint = "#{:02X}{:02X}{:02X}".format(*ink)
        panel.text([-3250, at], f"{at / 1000:.0f} m", tint, anchor="rm", size=13, rim="white")
    panel.line([[-3000, Z], [3850, Z]], ESTIMATED, 1.5, dash=5)
    panel.mark([[0, 0], [_BASE, 0]], "camera", 7)
    panel.mark([3850, Z], "estimated", 8)
    panel.text([3850, Z - 500], f"{Z / 1000:.2f} m", IDEAL, anchor="mm", size=12)
    panel.grip("depth", "up to which depth the pixels look", [3850, Z], 4)
    return panel


def _dots(panel: Panel, found: Array) -> Drawn:
    """Return a picture for the plan: a dot for each depth of what is not floor or ceiling."""
    camera = pair()[0].resized(found.shape[::-1])
    x, y = np.moveaxis(camera.ideal(pixel_centres(camera.size)), -1, 0)
    upright = (np.abs(y * true_depths()) < _UPRIGHT) & ~np.isnan(found)  # a found one may be wrong
    places = np.stack([(x * found)[upright], found[upright]], axis=-1)
    half = panel.scale / 2
    dots = np.full((2 * _PLAN[1], 2 * _PLAN[0], 3), 255, np.uint8)
    u, v = np.rint(panel.place(places) / half).astype(int).T
    inside = (u > 0) & (u < dots.shape[1] - 1) & (v > 0) & (v < dots.shape[0] - 1)
    colours = coloured(places[inside, 1])
    for du, dv in np.ndindex(3, 3):
        dots[v[inside] + dv - 1, u[inside] + du - 1] = colours
    return dots
