"""Explore shadows: where the sun is seen, the lines from all shadows through what throws them meet.

Its rays are parallel: they have a vanishing point like other parallel lines.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from PIL import Image, ImageDraw

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, pose
from cvnotes.pictures import rails, render_scene
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.style import CAMERA, ESTIMATED

_SIZE = (640, 480)  # px of the photograph
_EYE = np.array([0, 0, 13.0])  # m, as all below
_CAMERA = Camera(intrinsics(400, 400, 319.5, 239.5), pose(np.eye(3), -_EYE), size=_SIZE)
_WARM, _BLUE = (1.0, 0.89, 0.74), (0.22, 0.45, 0.85)  # the evening sky, low and high
_SUN, _GLOW, _DARK = "#FFFDF0", "#FFE3A6", "#33302A"  # the sun, its light; a shadow's tip
_GRASS, _STONES, _RAIL, _POLE = "#87995A", "#938A80", "#E4E2DC", "#5B4636"  # as in the evening
_DISC, _ACROSS = 18, 2000  # px: radius of the sun; more than any picture is long
_NEAR, _THINNEST = 0.2, 3  # m: what is nearer is not drawn; px, of a shadow far away
_POLES = np.array([[-4.0, -4.05, z] for z in range(15, 215, 25)])  # m, the tops
_GROUND, _BALLAST, _BESIDE = 1.95, 1.77, 2.3  # m, their y, and how far the ballast reaches
_HALF = 0.09  # m, half as wide as a pole


def shadows_model() -> Model:
    """Make the model of the railway in the evening, the camera level."""
    settings = (
        Setting("azimuth", "azimuth (°)", -180, 180, 0.5, 15, "how far to the right the sun is"),
        Setting("elevation", "elevation (°)", 2, 60, 0.5, 20, "how high the sun is"),
    )
    about = """A railway with poles and their shadows; the line through each pole's top and the tip
    of its shadow is drawn on, to where all meet; beside it the same from above."""

    def draw(paper: Paper, values: Values) -> Drawing:
        azimuth, elevation = np.radians([values["azimuth"], values["elevation"]])
        sun = np.array([np.sin(azimuth), -np.tan(elevation), np.cos(azimuth)]).round(15)
        panel = paper.picture_panel((440, 330), _SIZE, "poles, and where their shadows fall")
        panel.image(_photographed(_CAMERA, sun))
        end = _CAMERA.vanishing_point(sun)
        for top in _POLES[1:5]:  # the first one stands beside the camera
            _draw_ray(panel, _CAMERA, top, sun)
        panel.mark(end, "estimated", 8)
        held = end.clip(16, np.array(_SIZE) - 17)
        panel.grip("sun", "the sun, or the shadow of the camera", held, 10)
        if np.isfinite(end).all() and (held != end).any():
            _point_to(panel, end, held)
        plan = paper.panel((330, 330), (-68, 68), (104, -32), "the same from above")
        _draw_plan(plan, sun)
        return Drawing(paper.join((panel, plan)), _sentence(sun, end, values))

    def pulled(_: Values, at: Array) -> Values:
        ray = np.linalg.solve(_CAMERA.A, [*at, 1])
        x, y, z = -ray if ray[1] > 0 else ray  # below the horizon: the sun is behind the camera
        azimuth, elevation = np.degrees([np.arctan2(x, z), np.arctan2(-y, np.hypot(x, z))])
        return {"azimuth": float(azimuth), "elevation": float(elevation)}

    return Model("shadows", about, settings, draw, {"sun": pulled})


def _point_to(panel: Panel, end: Array, held: Array) -> None:
    """Tell at the border where the end is that lies outside of the picture."""
    (u, v), (x, y) = end.tolist(), held.tolist()
    arrow = ("→" if u > x else "←") if u != x else ("↑" if v < y else "↓")
    words = f"{arrow} ({u:.0f}, {v:.0f})"
    side = 1 if x < _SIZE[0] / 2 else -1
    panel.text([x + 26 * side, y], words, ESTIMATED, anchor="lm" if side > 0 else "rm")


@lru_cache(maxsize=2)
def _photographs(camera: Camera) -> tuple[Drawn, Drawn]:
    """Photograph the rails in the evening with all ground in the light, and all in the shade."""
    evening = replace(
        rails(), around=replace(rails().around, horizon=_WARM, zenith=_BLUE, ambient=0.2)
    )
    eye = Camera(camera.A, pose(camera.R, 1e3 * camera.T), size=_SIZE)  # the rails are in mm
    lit, dark = (render_scene(evening.lit_from((0, y, 0)), eye, samples=4) for y in (-1, 1))
    return lit, dark


@lru_cache(maxsize=1)
def _glare() -> tuple[Image.Image, Image.Image]:
    """Return how much of each pixel its light and the sun cover, for a sun in the middle."""
    v, u = np.mgrid[-_SIZE[1] : _SIZE[1], -_SIZE[0] : _SIZE[0]]
    away = (np.hypot(u, v) - _DISC).clip(0)
    glow, sun = 0.9 * np.exp(-away / 140), np.exp(-away / 4) + 0.4 * np.exp(-away / 30)
    return _sheet(glow), _sheet(sun.clip(0, 1))


def _sheet(part: Array) -> Image.Image:
    return Image.fromarray((255 * part).astype(np.uint8))


def _photographed(camera: Camera, sun: Array) -> Drawn:
    """Photograph the railway towards a sun (3,), with the shadows of its poles.

    If the sun is behind the camera, this throws its own shadow: a box on a thin post.
    """
    eye = camera.centre
    things = [(top + [0, 9, 0], top, _HALF) for top in _POLES]
    if sun[2] < 0:
        things += [(eye + [0, 9, 0], eye, 0.04), (eye + [0, 0.2, 0], eye - [0, 0.2, 0], 0.15)]
    ground, ballast = (
        _mask([_strip(camera, *thing, sun, y) for thing in things], _THINNEST)
        for y in (_GROUND, _BALLAST)
    )
    edges = np.array([[x, _BALLAST, z] for x in (-_BESIDE, _BESIDE) for z in (eye[2] + _NEAR, 1e4)])
    ground.paste(ballast, mask=_mask([camera.project(edges[[0, 1, 3, 2]])]))
    lit, dark = map(Image.fromarray, _photographs(camera))
    lit.paste(dark, mask=ground)
    if sun[2] > 0:
        left, top = _SIZE - camera.vanishing_point(sun).round().astype(int).clip(-9999, 9999)
        for ink, part in zip((_GLOW, _SUN), _glare(), strict=True):
            lit.paste(ink, mask=part.crop((left, top, left + _SIZE[0], top + _SIZE[1])))
    return np.asarray(lit)


def _strip(camera: Camera, low: Array, top: Array, half: float, sun: Array, y: float) -> Array:
    """Return the corners (4, 2) of the shadow, on the plane of that y, of a thing from low to top.

    What stands on the plane begins there.
    """
    foot, tip = (at + (y - at[1]) / sun[1] * sun for at in (low - [0, max(low[1] - y, 0), 0], top))
    level = sun[::2] / np.linalg.norm(sun[::2])
    aside = half * np.abs(level).sum() * np.array([level[1], 0, -level[0]])  # it is square
    eye = camera.centre
    left, right = (
        camera.project(_in_front(foot + by - eye, tip - foot) + eye) for by in (-aside, aside)
    )
    return np.concatenate([left, right[::-1]])


def _in_front(start: Array, along: Array) -> Array:
    """Cut the segment start … start + along to what lies in front of the camera: (2, 3)."""
    z, dz = float(start[2]) - _NEAR, float(along[2])
    if z < 0 and z + dz < 0:
        return np.full((2, 3), 0.0)  # the camera's centre has no image
    cut = -z / dz if z * (z + dz) < 0 else None
    first = cut if cut is not None and z < 0 else 0.0
    last = cut if cut is not None and z >= 0 else 1.0
    return start + np.outer([first, last], along)


def _mask(polygons: list[Array], thinnest: float = 0) -> Image.Image:
    """Fill polygons (4, 2) of the photograph, none thinner than so many px, with smooth edges."""
    mask = Image.new("L", (4 * _SIZE[0], 4 * _SIZE[1]))
    pen = ImageDraw.Draw(mask)
    for corners in polygons:
        at = (4 * corners + 2).clip(-1e5, 1e5)
        pen.polygon(at.ravel().tolist(), fill=255)
        if thinnest:
            pen.line(((at[:2] + at[:1:-1]) / 2).ravel().tolist(), 255, round(4 * thinnest))
    return mask.reduce(4)


def _draw_ray(panel: Panel, camera: Camera, top: Array, sun: Array) -> None:
    """Draw the ray that ends in the tip of a shadow, on to where all rays seem to begin or end.

    It enters at the border of the picture where the sun, or the tip, is behind the camera.
    """
    tip, over = camera.project([_tip_of(top, sun), top])
    end = camera.vanishing_point(sun) if sun[2] else over + 9 * (over - tip)
    border = over + _ACROSS * (over - end) / np.linalg.norm(over - end)
    ahead = (_tip_of(top, sun) - camera.centre)[2] > _NEAR
    panel.line([tip if ahead and sun[2] >= 0 else border, over, end], ESTIMATED, 1)
    if ahead:
        panel.polygons([tip + 2.5 * panel.pixel * circle(20)], _DARK)


def _tip_of(top: Array, sun: Array) -> Array:
    """Return where the sun throws the shadow of a pole's top: on the ballast or beside it."""
    high, low = (top + (y - top[1]) / sun[1] * sun for y in (_BALLAST, _GROUND))
    return np.asarray(high if abs(high[0]) < _BESIDE else low)


def _draw_plan(panel: Panel, sun: Array) -> None:
    strips = [[[-x, -32], [x, -32], [x, 104], [-x, 104]] for x in (68, _BESIDE)]
    panel.polygons(strips, (_GRASS, _STONES))
    for x in (-0.75, 0.75):
        panel.line([[x, -32], [x, 104]], _RAIL, 1.2)
    for top in _POLES:
        foot, tip = (at[::2] - _EYE[::2] for at in (top, _tip_of(top, sun)))
        panel.line([foot, tip], _DARK, 2.5)
        panel.polygons([foot + circle(20) * 0.9], _POLE)
    to_sun = sun[::2] / np.linalg.norm(sun[::2])
    panel.line(np.outer([0, 200], to_sun), _SUN, 1.4, dash=5)
    side = -1 if to_sun[0] < -0.3 else 1  # the words stand beside the line, away from the shadows
    aside = side * np.copysign(1, to_sun[1]) * np.array([to_sun[1], -to_sun[0]])
    beside = (26 + 20 * to_sun[0] ** 2) * to_sun + (np.abs(aside) @ [14, 4]) * aside
    panel.text(beside.clip([-44, -26], [44, 98]), "to the sun", ESTIMATED, anchor="mm")
    panel.mark([0, 0], "camera", 9)
    below = -4 if sun[2] > 0 else 4
    panel.text([4 * side, below], "camera", CAMERA, anchor="lm" if side > 0 else "rm")


def _sentence(sun: Array, end: Array, values: Values) -> str:
    said = f"The sun stands {values['elevation']:g}° high"
    if sun[2] == 0:
        return f"{said}, just at our side: its rays stay parallel here, too, and end at infinity."
    place = f"({end[0]:.0f}, {end[1]:.0f}) px"
    if sun[2] > 0:
        inside = (np.abs(end - np.array(_SIZE) / 2 + 0.5) <= np.array(_SIZE) / 2).all()
        seen = "seen at" if inside else "outside of the picture, at"
        return f"{said}, and is {seen} {place}: all lines from shadow to pole end there."
    return (
        f"{said} behind the camera. Its rays end at {place}: there falls the camera's own shadow."
    )
