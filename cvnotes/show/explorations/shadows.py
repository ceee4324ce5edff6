"""Explore shadows: where the sun is seen, the lines from all shadows through what throws them meet.

Its rays are parallel: they have a vanishing point like other parallel lines.
"""

from functools import lru_cache

import numpy as np
from PIL import Image, ImageDraw

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics
from cvnotes.pictures import rails, render_scene
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.explorations.projection import in_front
from cvnotes.show.style import CAMERA, ESTIMATED, MUTED, WORLD

SIZE = (640, 480)  # px of the photograph
_CAMERA = Camera(intrinsics(400, 400, 319.5, 239.5), size=SIZE)
_DISC = 13 * np.column_stack([f(np.linspace(0, 6.2, 40)) for f in (np.cos, np.sin)])  # px
_GLOW, _NEAR = "#FFF0B8", 0.2  # what is nearer than 0.2 m is not drawn
POLES = np.array([[-4.0, -4.05, z] for z in range(15, 140, 25)])  # m, the tops
GROUND, _BALLAST, _BESIDE = 1.95, 1.77, 2.3  # m, their y, and how far the ballast reaches
_HALF = 0.09  # m, half as wide as a pole


def shadows_model() -> Model:
    """Make the model of the railway in the evening, the camera level."""
    settings = (
        Setting("azimuth", "azimuth (°)", -180, 180, 0.5, -30, "how far to the right the sun is"),
        Setting("elevation", "elevation (°)", 2, 60, 0.5, 14, "how high the sun is"),
    )
    about = (
        "A railway with poles and their shadows; the line through each pole's top and the tip of "
        "its shadow is drawn on, to where all meet; beside it the same from above."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        azimuth, elevation = np.radians([values["azimuth"], values["elevation"]])
        sun = np.array([np.sin(azimuth), -np.tan(elevation), np.cos(azimuth)]).round(15)
        panel = paper.picture_panel((440, 330), SIZE, "poles, and where their shadows fall")
        panel.image(shaded(_CAMERA, np.tile(sun, (len(POLES), 1))))
        end = _CAMERA.vanishing_point(sun)
        if sun[2] > 0:
            draw_sun(panel, end)
        for top in POLES[:4]:
            ray = _CAMERA.project(in_front(top, tip_of(top, sun) - top))
            panel.line(ray, ESTIMATED, 1.5)
            panel.line([ray[0] if sun[2] > 0 else ray[1], end], ESTIMATED, 0.9, dash=5)
        panel.mark(end, "estimated", 8)
        panel.grip("sun", "the sun, or the shadow of the camera", end, 10)
        plan = paper.panel((330, 330), (-68, 68), (104, -32), "the same from above (m)")
        _draw_plan(plan, sun)
        return Drawing(paper.join((panel, plan)), _sentence(sun, end, values))

    def pulled(_: Values, at: Array) -> Values:
        ray = np.linalg.solve(_CAMERA.A, [*at, 1])
        x, y, z = -ray if ray[1] > 0 else ray  # below the horizon: the sun is behind the camera
        azimuth, elevation = np.degrees([np.arctan2(x, z), np.arctan2(-y, np.hypot(x, z))])
        return {"azimuth": float(azimuth), "elevation": float(elevation)}

    return Model("shadows", about, settings, draw, {"sun": pulled})


@lru_cache(maxsize=2)
def _photographs(camera: Camera) -> tuple[Drawn, Drawn]:
    """Photograph the rails with all ground in the light, and with all in the shade."""
    lit, dark = (render_scene(rails().lit_from((0, y, 0)), camera, samples=4) for y in (-1, 1))
    return lit, dark


def shaded(camera: Camera, suns: Array) -> Drawn:
    """Photograph the railway, with the shadow of each of `POLES` under a sun of its own (n, 3)."""
    edges = [camera.project([[x, _BALLAST, z] for z in (_NEAR, 1e4)]) for x in (-_BESIDE, _BESIDE)]
    each = [*zip(POLES, suns, strict=True)]
    ground, ballast = (
        _mask([_strip(camera, top, sun, y) for top, sun in each]) for y in (GROUND, _BALLAST)
    )
    ground.paste(ballast, mask=_mask([np.concatenate([edges[0], edges[1][::-1]])]))
    mask = ground.resize(SIZE, Image.Resampling.BOX)
    lit, dark = map(Image.fromarray, _photographs(camera))
    return np.asarray(Image.composite(dark, lit, mask))


def _strip(camera: Camera, top: Array, sun: Array, y: float) -> Array:
    """Return the corners (4, 2) of a pole's shadow on the plane of that y."""
    foot, tip = np.array([top[0], y, top[2]]), top + (y - top[1]) / sun[1] * sun
    level = sun[::2] / np.linalg.norm(sun[::2])
    aside = _HALF * np.abs(level).sum() * np.array([level[1], 0, -level[0]])  # it is square
    left, right = (camera.project(in_front(foot + by, tip - foot)) for by in (-aside, aside))
    return np.concatenate([left, right[::-1]])


def draw_sun(panel: Panel, at: Array) -> None:
    """Draw the disc of the sun at a pixel."""
    panel.polygons([at + _DISC], _GLOW)


def _mask(polygons: list[Array]) -> Image.Image:
    """Fill polygons (n, 2) of the photograph on a sheet of four times its size."""
    mask = Image.new("L", (4 * SIZE[0], 4 * SIZE[1]))
    for corners in polygons:
        ImageDraw.Draw(mask).polygon((4 * corners + 2).ravel().tolist(), fill=255)
    return mask


def tip_of(top: Array, sun: Array) -> Array:
    """Return where the sun throws the shadow of a pole's top: on the ballast or beside it."""
    high, low = (top + (y - top[1]) / sun[1] * sun for y in (_BALLAST, GROUND))
    return np.asarray(high if abs(high[0]) < _BESIDE else low)


def _draw_plan(panel: Panel, sun: Array) -> None:
    panel.ticks(x=(-40, 40), y=(0, 50, 100))
    for x in (-0.75, 0.75):
        panel.line([[x, -33], [x, 111]], WORLD, 1)
    for top in POLES:
        panel.line([top[::2], tip_of(top, sun)[::2]], MUTED, 1.5)
        panel.mark(top[::2], "world", 6)
    to_sun = sun[::2] / np.linalg.norm(sun[::2])
    panel.line(np.outer([0, 200], to_sun), ESTIMATED, 0.9, dash=5)
    side = -1 if to_sun[0] < -0.3 else 1  # the words stand beside the line, away from the shadows
    aside = side * np.copysign(1, to_sun[1]) * np.array([to_sun[1], -to_sun[0]])
    beside = (26 + 20 * to_sun[0] ** 2) * to_sun + (np.abs(aside) @ [14, 4]) * aside
    panel.text(beside, "to the sun", ESTIMATED, anchor="mm")
    panel.mark([0, 0], "camera", 9)
    below = -4 if sun[2] > 0 else 4
    panel.text([4 * side, below], "camera", CAMERA, anchor="lm" if side > 0 else "rm")


def _sentence(sun: Array, end: Array, values: Values) -> str:
    said = f"The sun stands {values['elevation']:g}° high"
    if sun[2] == 0:
        return f"{said}, just at our side: its rays stay parallel in the picture, and end nowhere."
    place = f"({end[0]:.0f}, {end[1]:.0f}) px"
    if sun[2] > 0:
        inside = (np.abs(end - np.array(SIZE) / 2 + 0.5) <= np.array(SIZE) / 2).all()
        seen = "seen at" if inside else "outside of the picture, at"
        return f"{said}, and is {seen} {place}: all lines from shadow to pole end there."
    return (
        f"{said} behind the camera. Its rays end at {place}: there falls the camera's own shadow."
    )
