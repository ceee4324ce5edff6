"""Explore the focal length: a sensor that is carried away from the centre sees a smaller angle."""

from functools import lru_cache

import numpy as np
from PIL import Image

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics
from cvnotes.pictures import render_scene, room
from cvnotes.pictures.meshes import from_above
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, IDEAL, LENS, hexed

_SIZE, _SHOWN, _PLAN = (640, 480), (372, 279), (516, 279)  # px
_MM = 5  # of the plan for each px of the sensor
_LEAST, _FIRST = 300, 400  # px, of α
_WALL = 10_000  # mm, to the far wall
_BOARD = np.array([[-700, -920, 9950], [700, -920, 9950]])  # just above the blackboard's frame
_GLASS, _LEGS, _PALE, _GREEN = "#DDEFFA", "#A9D5F1", "#B9CFE0", "#3A6A66"


def zoom_model() -> Model:
    """Make the model of one room from one spot, with the sensor at any distance."""
    settings = (Setting("alpha", "α (px)", _LEAST, 1500, 10, _FIRST, "the focal length"),)
    about = """A room from above, with a camera's centre and its sensor before it, and the angle
    that the sensor sees; beside it the photograph."""

    def draw(paper: Paper, values: Values) -> Drawing:
        alpha = values["alpha"]
        photo = paper.picture_panel(_SHOWN, _SIZE, f"the photograph: α = {alpha:g} px")
        photo.image(photograph(alpha, paper.sharpness))
        ends, angle, width = _seen(alpha)
        photo.line(ends, IDEAL, 2)
        photo.text(ends.mean(axis=0) - [0, 18], f"{width:.0f} px", IDEAL, anchor="mm", size=15)
        said = f"""With α = {alpha:g} px the camera sees {angle:.1f}°, and the blackboard is
        {width:.0f} px wide."""
        if alpha != _FIRST:
            _, first, narrow = _seen(_FIRST)
            said += f""" Against {_FIRST} px: α × {alpha / _FIRST:.2f}, blackboard ×
            {width / narrow:.2f}, angle ÷ {first / angle:.2f}."""
        return Drawing(paper.join((_plan(paper, alpha, angle), photo)), said)

    return Model("zoom", about, settings, draw, {"sensor": lambda _, at: {"alpha": at[0] / _MM}})


def _seen(alpha: float) -> tuple[Array, float, float]:
    """Return where the blackboard's ends (2, 2) are seen, the angle in degrees, its width in px."""
    camera = camera_at(alpha, _SIZE)
    ends = camera.project(_BOARD)
    return ends, float(np.degrees(camera.field_of_view[0])), float(np.ptp(ends[:, 0]))


def camera_at(alpha: float, size: tuple[int, int]) -> Camera:
    """Return the camera in the room's origin, of some size."""
    return Camera(intrinsics(alpha, alpha, 319.5, 239.5)).resized(size)


@lru_cache(maxsize=3)
def _wide(alpha: float) -> Drawn:
    """Take a picture twice as large as it is shown: too long for a hand, so once an octave."""
    return render_scene(room(), camera_at(alpha, (2 * _SHOWN[0], 2 * _SHOWN[1])), samples=4)


def photograph(alpha: float, sharpness: int = 1) -> Drawn:
    """Return what a lens sees, of what a shorter one has seen from the same spot: its middle."""
    short = _LEAST * 2 ** int(np.log2(alpha / _LEAST))
    wide = Image.fromarray(_wide(short))
    box = (np.outer([1, 1], wide.size) + short / alpha * np.outer([-1, 1], wide.size)) / 2
    size = (sharpness * _SHOWN[0], sharpness * _SHOWN[1])
    return np.asarray(wide.resize(size, Image.Resampling.BILINEAR, box=tuple(box.ravel())))


def _plan(paper: Paper, alpha: float, angle: float) -> Panel:
    """Draw the room from above, along its y axis: z to the right, x down, walls at the border."""
    panel = paper.panel(_PLAN, (-1100, _WALL), (-3000, 3000), "from above: pull the sensor")
    half, z, px = _SIZE[0] / 2 * _MM, alpha * _MM, panel.pixel
    far, first = _WALL * np.array([[1, -half / z], [0, 0], [1, half / z]]), _FIRST * _MM
    panel.polygons([far], _GLASS)
    legs = np.array([[0, 0], [z, 0], [z, half]])
    panel.polygons([legs], _LEGS)
    for corners, colour in zip(*from_above(room(), -1500), strict=True):
        panel.polygons([corners[:, ::-1]], hexed(np.rint(255 * colour)))
    panel.line(_BOARD[:, [2, 0]], _GREEN, 6)
    if alpha != _FIRST:
        panel.line(far * [1, z / first], CAMERA, 1, dash=4)
        panel.line(np.array([[first, -half], [first, half]]), _PALE, 5)
    panel.line(far, CAMERA, 1.5)
    panel.line(legs, IDEAL, 1.5)
    corner = np.array([[z - 9 * px, 0], [z - 9 * px, 9 * px], [z, 9 * px]])
    panel.line(corner, IDEAL, 1)
    panel.line(np.array([[z, -half], [z, half]]), LENS, 5)
    turn = np.radians(np.linspace(-angle / 2, angle / 2, 41))
    panel.line(22 * px * np.column_stack([np.cos(turn), np.sin(turn)]), CAMERA, 1.5)
    panel.text([z - 16 * px, -12 * px], f"α = {alpha:g}", IDEAL, anchor="rm", size=15)
    panel.text([z - 7 * px, half * 0.72], "320", IDEAL, anchor="rm", size=15)
    panel.text([-8 * px, 0], f"{angle:.1f}°", CAMERA, anchor="rm", size=15)
    panel.mark([0, 0], "camera", 8, looks=(1, 0))
    panel.grip("sensor", "the sensor, away from the centre", [z, 0], 12)
    return panel
