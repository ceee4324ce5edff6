"""Explore the homography: pull the four corners of a chart, and the whole wall is measured."""

from functools import lru_cache

import numpy as np
from PIL import Image as Bitmap

from cvnotes.base import Array, Image
from cvnotes.camera import Camera, look_at
from cvnotes.homography import dlt
from cvnotes.pictures import chart_room, course, render_scene
from cvnotes.projective import apply, to_homogeneous
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, WORLD
from cvnotes.warping import rectify_plane

_PICTURE, _SHOWN, _SIZE = (640, 480), (372, 279), (346, 279)  # px
_EDGE = (20, 15)  # px of the picture, white around it, for the rings of corners at its border
_NAMES = ("top left", "top right", "bottom right", "bottom left")
_CHART = np.array([[0.0, 0], [420, 0], [420, 594], [0, 594]])  # mm, a sheet of A2
_READ = np.array([[343.0, 44], [522, 13], [508, 462], [342, 381]])  # px, its corners as read off
_PLUS = (450, 240)  # px, where the plus begins: on the chart
# mm of the wall, x and y, as wide and high as _SIZE: about the chart, and where a corner is off.
_REGION = (-440.0, 460.0), (-70.0, 655.72)
_FAR = (-1000.0, 1000.0), (-513.5, 1099.22)
_GRID = np.arange(-700, 701, 100)  # mm


def homography_model() -> Model:
    """Make the model of the wall of chapter 6, with a chart and a switch on it."""
    settings = tuple(
        Setting(f"d{axis}{i}", f"corner {i} {axis}", -140, 140, 1, 0,
                f"moves the {name} corner by so many px along {axis}")
        for i, name in enumerate(_NAMES, start=1)
        for axis in "uv"
    )  # fmt: skip
    settings += tuple(
        Setting(name, f"plus {name} (px)", 0, most, 1, start, "where the plus is, in the picture")
        for name, most, start in zip("uv", _PICTURE, _PLUS, strict=True)
    )
    about = """A wall at a slant, with a chart whose four corners are marked, and the millimetres of
    the wall as the homography of these corners lays them; beside it the wall seen straight on."""

    drags = {f"corner {i}": placed(f"du{i}", f"dv{i}", _READ[i - 1]) for i in range(1, 5)}
    drags["plus"] = placed("u", "v")
    return Model("homography", about, settings, _draw, drags)


@lru_cache(maxsize=1)
def photograph() -> Image:
    """Photograph the wall, as in the chapter."""
    camera = Camera(course.camera().A, look_at([1180, 150, -760], [-60, 340, 0]))
    return np.asarray(render_scene(chart_room(), camera))


@lru_cache(maxsize=2)
def _shown(sharpness: int) -> Drawn:
    """Keep the photograph as large as its panel: it is the same for all values."""
    size = (sharpness * _SHOWN[0], sharpness * _SHOWN[1])
    w, h = _EDGE
    framed = np.pad(photograph().astype(np.uint8), ((h, h), (w, w), (0, 0)), constant_values=255)
    return np.asarray(Bitmap.fromarray(framed).resize(size))


def _draw(paper: Paper, values: Values) -> Drawing:
    m = _READ + [[values[f"du{i}"], values[f"dv{i}"]] for i in range(1, 5)]
    H, plus = dlt(_CHART, m), np.array([values["u"], values["v"]])
    place = apply(np.linalg.inv(H), plus)
    framed = _PICTURE[0] + 2 * _EDGE[0], _PICTURE[1] + 2 * _EDGE[1]
    title = "the wall, and its squares of 100 mm"
    picture = paper.picture_panel(_SHOWN, framed, title, (-_EDGE[0], -_EDGE[1]))
    picture.image(_shown(paper.sharpness))
    _draw_grid(picture, H)
    _draw_horizon(picture, H)
    picture.line(m[[0, 1, 2, 3, 0]], ESTIMATED, 1.6)
    picture.mark(plus, "ideal", 8)
    picture.mark(m, "estimated", 7)
    for i, at in enumerate(m, start=1):
        picture.grip(f"corner {i}", f"corner {i}, {_NAMES[i - 1]}", at, 1)
        aside = np.clip(at + 22 * np.sign(at - m.mean(axis=0)), 16, np.subtract(_PICTURE, 16))
        picture.text(aside, f"{i}", ESTIMATED, anchor="mm", size=14)
    picture.grip("plus", "the plus, whose place on the wall is measured", plus, 1)
    off = np.any(m != _READ)  # what leaves the chart's surroundings is to be followed
    (X0, X1), (Y0, Y1) = _FAR if off else _REGION
    straight = paper.panel(_SIZE, (X0, X1), (Y0, Y1), f"straight on, {(X1 - X0) / 1000:g} m wide")
    pixel = (X1 - X0) / (_SIZE[0] * paper.sharpness)
    wall = rectify_plane(photograph(), H, ((X0, Y0), (X1, Y1)), pixel, fill=255)
    straight.image(wall.astype(np.uint8))
    straight.line(_CHART[[0, 1, 2, 3, 0]], WORLD, 1.5, dash=5)
    straight.mark(place, "ideal", 8)
    _draw_way(straight, place)
    said = [_sentence(place)]
    for i, (du, dv) in enumerate(m - _READ, start=1):
        if du or dv:
            said.append(f"Corner {i} is pulled by ({du:.0f}, {dv:.0f}) px.")
    return Drawing(paper.join((picture, straight)), " ".join(said))


def _draw_grid(panel: Panel, H: Array) -> None:
    """Draw the lines at every hundredth millimetre before the camera, but not over the letters."""
    fine = np.linspace(_GRID[0], _GRID[-1], 57)
    across = np.stack(np.meshgrid(fine, _GRID), axis=-1)
    for line in (*across, *across[..., ::-1]):
        seen = to_homogeneous(line) @ H.T
        seen[seen[:, 2] * (H @ [210, 297, 1])[2] <= 0] = np.nan
        seen[((line > 0) & (line < _CHART[2])).all(axis=-1)] = np.nan
        at = seen[:, :2] / seen[:, 2:]
        at[((at < 0) | (at > _PICTURE)).any(axis=-1)] = np.nan
        panel.line(at, ESTIMATED, 0.6)


def _draw_horizon(panel: Panel, H: Array) -> None:
    """Draw the picture of the wall's line at infinity."""
    line = np.linalg.inv(H)[2]  # H⁻ᵀ [0 0 1]
    ends = np.cross(line, [[0, 1, 0], [0, 1, -_PICTURE[1]]])  # in the first row and the last
    panel.line(ends[:, :2] / ends[:, 2:], IDEAL, 1.4, dash=5)
    at = ends[1, 0] / ends[1, 2]
    if 0 < at < 0.8 * _PICTURE[0]:
        aside, anchor = (8, "lm") if at < 250 else (-8, "rm")  # to the right of it is corner 3
        below = [at + aside, _PICTURE[1] - 14]
        panel.text(below, "the wall's horizon", IDEAL, anchor=anchor, size=12)


def _draw_way(panel: Panel, place: Array) -> None:
    """Draw an arrow at the border to a plus that lies beyond; at a side, with its X."""
    low, high = np.array([panel.x, panel.y]).T + np.array([[14], [-14]]) * panel.pixel
    middle = (low + high) / 2
    way = place - middle
    part = np.min((high - low) / 2 / np.abs(way).clip(1e-9))
    if part >= 1:
        return
    along, tip = way / np.linalg.norm(way), middle + part * way
    panel.arrows(tip - 34 * panel.pixel * along, 40 * panel.pixel * along, "white", 5)
    panel.arrows(tip - 32 * panel.pixel * along, 36 * panel.pixel * along, IDEAL, 2.4)
    if (high[0] - low[0]) / 2 <= part * abs(way[0]) + 1e-6:  # it has left at a side
        words, below = f"X = {place[0]:.0f} mm", tip + [0, 24 * panel.pixel]
        anchor = "lm" if way[0] < 0 else "rm"
        if anchor == "rm":  # so long that it would lie over the chart
            below[1] = max(below[1], _CHART[2, 1] + 20 * panel.pixel)
        panel.text(np.minimum(below, high), words, IDEAL, anchor=anchor, size=13)


def _sentence(place: Array) -> str:
    x, y = place
    said = f"By these corners the plus lies at ({x:.0f}, {y:.0f}) mm from the chart's first corner"
    return f"{said}: it is near the wall's horizon." if np.abs(place).max() > 1e4 else f"{said}."
