"""Explore heights in one picture: a rod in metres that is stood anywhere on the ground."""

from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, horizon, look_at
from cvnotes.pictures import blocks, course, depth_map, render_scene
from cvnotes.projective import from_homogeneous, to_homogeneous
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, nearest, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED

_CAMERA = Camera(course.camera().A, look_at([12500, -1200, -2500], [1200, -2300, 12500]))
_EYE, _BOX, _TALLEST = 2.8, 2.0, 6.0  # m: heights of camera, yellow box and highest rod
_EDGE = _CAMERA.project(blocks().vertices[[17, 19]])  # of the yellow box, from top to foot
_UP, _LEVEL = _CAMERA.vanishing_point([0, 1, 0]), horizon(_CAMERA, [0, 1, 0])
_HORIZON = float(-_LEVEL[2] / _LEVEL[1])  # its row: the camera is not rolled
_WIDTH, _TRIANGLES = 0.16, 36  # m, of the rod; of three blocks
_LATE = 540  # px: farther to the right the border leaves no room for words
_BORDER = (-440, 80)  # px: so much more is shown on the left, and less of the sky
_SHIFTED = [[1, 0, -_BORDER[0]], [0, 1, -_BORDER[1]], [0, 0, 1]] @ _CAMERA.A
_WIDE = Camera(_SHIFTED, _CAMERA.G, size=(1080, 400))


def rod_model() -> Model:
    """Make the model of the three blocks, with a rod among them."""
    settings = (
        Setting("u", "foot, u (px)", 8, 615, 1, 135, "where the foot is, from left to right"),
        Setting("v", "foot, v (px)", 352, 464, 1, 382, "where it is, downwards"),
        Setting("height", "height (m)", 1, _TALLEST, 0.1, 4, "the rod's height"),
    )
    about = """A rod with a band for each metre stands on the ground before three blocks; the black
    line is the horizon. The line through its foot and the yellow box's meets it in e, and from e a
    line over the box brings 2 m to the rod."""

    @lru_cache(maxsize=1)
    def photographed() -> tuple[Drawn, Array]:
        photo = render_scene(blocks(), _WIDE).astype(float)
        photo[:, : -_BORDER[0]] += 0.45 * (255 - photo[:, : -_BORDER[0]])  # beside the photograph
        parts = ("triangles", "colours", "uv", "extent")  # of the blocks without their ground
        alone = replace(blocks(), **{name: getattr(blocks(), name)[:_TRIANGLES] for name in parts})
        return np.rint(photo).astype(np.uint8), depth_map(alone, _WIDE)

    def draw(paper: Paper, values: Values) -> Drawing:
        photo, depths = photographed()
        foot, height = np.array([values["u"], values["v"]]), values["height"]
        left, width = (0, 480) if paper.narrow else (_BORDER[0], 810)
        part, corner = (640 - left, 480 - _BORDER[1]), (left, _BORDER[1])
        panel = paper.picture_panel((width, 300), part, "pull the rod by its foot", corner)
        panel.image(photo[:, left - _BORDER[0] :])
        panel.text([_BORDER[0] + 14, _BORDER[1] + 16], "beyond the photograph")
        panel.line([[-460, _HORIZON], [660, _HORIZON]], IDEAL, 1)
        beside, anchor = (20, "lm") if foot[0] > _LATE else (633, "rm")
        panel.text([beside, _HORIZON - 11], "horizon", IDEAL, anchor=anchor)
        e = _draw_way(panel, foot, depths)
        _draw_rod(panel, foot, height, depths)
        panel.mark(at_height(foot, _BOX), "estimated", 5)
        panel.grip("foot", "the foot of the rod", foot, 4)
        top = at_height(foot, height)
        panel.grip("top", "the top of the rod", top, 4)
        return Drawing(paper.join((panel,)), _sentence(foot, height, e))

    def places(values: Values, heights: Array) -> Array:
        return at_height(np.array([values["u"], values["v"]]), heights)

    stretched = nearest("height", np.linspace(1, _TALLEST, 141), places)
    return Model("rod", about, settings, draw, {"foot": placed("u", "v"), "top": stretched})


def at_height(foot: Array, height: npt.ArrayLike) -> Array:
    """Return the pixels (..., 2) so many metres over a foot, all of it from the picture.

    A. Criminisi's single view metrology: with the horizon l and the vanishing point v of the
    upright direction, what is h over the ground point p lies at p / (l · p) + h μ v, and the
    yellow box, 2 m high, gives μ.
    """
    top, bottom, up, p = to_homogeneous([*_EDGE, _UP, foot])
    across = np.cross(up, top)
    mu = -np.cross(bottom, top) @ across / (_BOX * (_LEVEL @ bottom) * (across @ across))
    h = np.asarray(height, dtype=float)[..., None]
    return from_homogeneous(p / (_LEVEL @ p) + h * mu * up)


def _stands(foot: Array) -> Array:
    """Return where in the world, in mm, a foot stands: the truth, which the picture has not."""
    ray = _CAMERA.R.T @ np.linalg.solve(_CAMERA.A, [*foot, 1])
    return np.asarray(_CAMERA.centre + ray * 1e3 * _EYE / ray[1])


def _draw_way(panel: Panel, foot: Array, depths: Array) -> float:
    """Draw how the height of the box comes to a foot, by e on the horizon; returns the u of e.

    What a block hides is dashed, as it is of the rod.
    """
    u, v = _EDGE[1]
    e = np.array([u + (foot[0] - u) * (_HORIZON - v) / (foot[1] - v), _HORIZON])
    near = max((foot, _EDGE[1]), key=lambda at: float(at[1]))
    feet = near + np.linspace(0, 0.99, 64)[:, None] * (e - near)
    for h in (_BOX, 0):
        way = np.array([at_height(at, h) for at in feet])
        places = np.array([_stands(at) for at in feet]) - [0, 1e3 * h, 0]
        hidden = _hidden(way, places, depths)
        # Line and dashes meet halfway between what is seen and what is hidden.
        way = np.insert(way, range(1, len(way)), (way[1:] + way[:-1]) / 2, axis=0)
        next_to = hidden[1:], hidden[:-1]
        both, either = np.logical_and(*next_to), np.logical_or(*next_to)
        all_hidden, some = (np.insert(hidden, range(1, len(hidden)), at) for at in (both, either))
        panel.line([*np.where(all_hidden[:, None], np.nan, way), e], ESTIMATED, 1)
        panel.line(np.where(some[:, None], way, np.nan), ESTIMATED, 1, dash=3)
    panel.line(_EDGE, LENS, 2)
    panel.mark(e, "estimated", 6)
    (left, right), word = panel.x, "e"
    if not left < e[0] < right:
        word = "e →" if e[0] > right else "← e"
    above = -20 if e[0] > right else 18  # at the right, under "horizon"
    at = [np.clip(e[0], left + 8, right - 8), _HORIZON - above]
    anchor = "mm" if word == "e" else "rm" if e[0] > right else "lm"
    panel.text(at, word, IDEAL, anchor=anchor, size=14)
    return float(e[0])


def _draw_rod(panel: Panel, foot: Array, height: float, depths: Array) -> None:
    """Draw a band for each metre; where something stands before it, thin dashes."""
    h = np.append(np.arange(0, height, 0.125), height)
    pixels, places = at_height(foot, h), _stands(foot) - 1e3 * h[:, None] * [0, 1, 0]
    hidden = _hidden(pixels, places, depths)
    width = float(np.linalg.norm(pixels[1] - pixels[0])) * _WIDTH / 0.125 / panel.pixel
    seen = np.where(hidden[:, None], np.nan, pixels)
    if not hidden[0]:  # dim the ground round the foot, on which the rod stands
        panel.polygons([foot + 1.4 * width * circle(30) * [1, 0.3]], "#5F5D54")
    panel.line(seen, MUTED, width + 1.5)
    for i, part in enumerate(pairwise(pixels)):
        colour, behind = ESTIMATED if int(h[i]) % 2 == 0 else "#FFFFFF", hidden[i : i + 2].any()
        if not behind or i % 2:
            panel.line(part, colour, 1 if behind else width)
    cut = int(_EYE)  # the band that the horizon crosses has its tenths, the half metre longer
    for tenth in range(1, 10):
        at = at_height(foot, cut + tenth / 10)
        if height >= cut + tenth / 10 and not hidden[0]:
            long = (9 if tenth == 5 else 5) * panel.pixel
            away = -1 if foot[0] > _LATE else 1
            start = at - [away * (width / 2 + 1) * panel.pixel, 0]
            panel.line([start, start - [away * long, 0]], IDEAL, 1)
    apart = np.linalg.norm(pixels[8] - pixels[0]) / panel.pixel  # where letters have no room,
    for metre in range(1 if apart > 20 else int(height), int(height) + 1):  # only the last
        aside = 18 if (height - metre) * apart < 12 else 4  # beside the ring of the grip
        side, anchor = (-1, "rm") if foot[0] > _LATE else (1, "lm")
        at = at_height(foot, metre) + [side * (width / 2 + aside), 0]
        panel.text(at, f"{metre}", ESTIMATED, anchor=anchor, size=10)


def _hidden(pixels: Array, places: Array, depths: Array) -> Array:
    """Return which places (n, 3) a block hides; they are seen at these pixels."""
    u, v = np.clip(np.rint(pixels) - _BORDER, 0, np.array(_WIDE.size) - 1).astype(int).T
    return np.asarray(depths[v, u] < places @ _CAMERA.G[2, :3] + _CAMERA.G[2, 3] - 100)


def _sentence(foot: Array, height: float, e: float) -> str:
    metre, (u, v) = float(np.linalg.norm(at_height(foot, 1) - foot)), foot.tolist()
    place = f"A rod of {height:.1f} m at ({u:.0f}, {v:.0f}) px, its lowest metre {metre:.0f}"
    return f"{place} px high. Its e is at ({e:.0f}, {_HORIZON:.0f})."
