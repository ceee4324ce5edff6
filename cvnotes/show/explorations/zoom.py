"""Explore the matrix A: a sensor that is carried away from the centre, or pushed sideways."""

from functools import lru_cache

import numpy as np
from PIL import Image

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics
from cvnotes.pictures import render_scene, room
from cvnotes.pictures.meshes import from_above
from cvnotes.show.explorations.matrices import SHIFT, TURN, matrix_table
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, IDEAL, LENS, hexed

_SIZE, _SHOWN, _PLAN = (640, 480), (372, 279), (516, 279)  # px
_MM, _WALL = 5, 10_000  # mm: of the plan for each px of the sensor; to the far wall
_TINTS = {(0, 0): TURN, (1, 1): TURN, (0, 2): SHIFT}
_LEAST, _FIRST, _MIDDLE = 300, 400, 319.5  # px, of α; of u0
_MORE, _LARGE = 1.25, (930, 698)  # times as wide: what the sensor is pushed over; in px
_BOARD = np.array([[-700, -920, 9950], [700, -920, 9950]])  # just above the blackboard's frame
_GLASS, _LEGS, _PALE, _GREEN = "#DDEFFA", "#A9D5F1", "#B9CFE0", "#3A6A66"


def zoom_model() -> Model:
    """Make the model of one room from one spot, with the sensor at any place before it."""
    settings = (
        Setting("alpha", "α (px)", _LEAST, 1500, 10, _FIRST, "the focal length", TURN),
        Setting("u0", "u₀ (px)", 239.5, 399.5, 0.5, _MIDDLE, "where the axis meets it", SHIFT),
    )
    about = """A room from above, with a camera's centre and its sensor before it, and the angle
    that the sensor sees; beside it the photograph, and A."""

    def draw(paper: Paper, values: Values) -> Drawing:
        alpha, u0 = values["alpha"], values["u0"]
        photo = paper.picture_panel(_SHOWN, _SIZE, f"the photograph: α = {alpha:g} px")
        photo.image(photograph(alpha, paper.sharpness, u0))
        ends, angle, width = _seen(alpha, u0)
        photo.line(ends, IDEAL, 2)
        photo.text(ends.mean(axis=0) - [0, 18], f"{width:.0f} px", IDEAL, anchor="mm", size=15)
        said = f"""With α = {alpha:g} px the camera sees {angle:.1f}°, and the blackboard is
        {width:.0f} px wide."""
        if alpha != _FIRST:
            _, first, narrow = _seen(_FIRST, u0)
            said += f""" Against {_FIRST} px: α × {alpha / _FIRST:.2f}, blackboard ×
            {width / narrow:.2f}, angle ÷ {first / angle:.2f}."""
        A = camera_at(alpha, _SIZE, u0).A
        table = matrix_table(A, "A", np.where(A % 1, 1, 0), _TINTS)
        return Drawing(paper.join((_plan(paper, alpha, u0, angle), photo)), said, table)

    # Sideways in steps of 20 px, 100 mm of the plan: else a hand could not pull straight ahead.
    drags = {"sensor": lambda _, m: {"alpha": m[0] / _MM, "u0": _MIDDLE - 20 * round(m[1] / 100)}}
    return Model("zoom", about, settings, draw, drags)


def _seen(alpha: float, u0: float) -> tuple[Array, float, float]:
    """Return where the blackboard's ends (2, 2) are seen, the angle in degrees, its width in px."""
    camera = camera_at(alpha, _SIZE, u0)
    ends = camera.project(_BOARD)
    return ends, float(np.degrees(camera.field_of_view[0])), float(np.ptp(ends[:, 0]))


def camera_at(alpha: float, size: tuple[int, int], u0: float = _MIDDLE) -> Camera:
    """Return the camera in the room's origin, of some size."""
    return Camera(intrinsics(alpha, alpha, u0, 239.5)).resized(size)


@lru_cache(maxsize=3)
def _wide(alpha: float) -> Drawn:
    """Take a picture twice as sharp as it is shown: too long for a hand, so once an octave."""
    return render_scene(room(), camera_at(alpha / _MORE, _LARGE), samples=4)


def photograph(alpha: float, sharpness: int = 1, u0: float = _MIDDLE) -> Drawn:
    """Return what a sensor sees, of what a larger one has seen from the same spot."""
    short = _LEAST * 2 ** int(np.log2(alpha / _LEAST))
    wide = Image.fromarray(_wide(short))
    sides = np.array([[-1, -1], [1, 1]]) + [2 * (_MIDDLE - u0) / _SIZE[0], 0]
    box = (1 + short / alpha / _MORE * sides) * wide.size / 2
    size = (sharpness * _SHOWN[0], sharpness * _SHOWN[1])
    return np.asarray(wide.resize(size, Image.Resampling.BILINEAR, box=tuple(box.ravel())))


def _plan(paper: Paper, alpha: float, u0: float, angle: float) -> Panel:
    """Draw the room from above, along its y axis: z to the right, x down, walls at the border."""
    panel = paper.panel(_PLAN, (-1100, _WALL), (-3000, 3000), "from above: pull the sensor")
    z, px, first = alpha * _MM, panel.pixel, _FIRST * _MM
    left, right = ends = (np.array([-0.5, _SIZE[0] - 0.5]) - u0) * _MM
    far = _WALL * np.array([[1, left / z], [0, 0], [1, right / z]])
    panel.polygons([far], _GLASS)
    legs = np.array([[0, 0], [z, 0], [z, right]])
    panel.polygons([legs], _LEGS)
    for corners, colour in zip(*from_above(room(), -1500), strict=True):
        panel.polygons([corners[:, ::-1]], hexed(np.rint(255 * colour)))
    panel.line(_BOARD[:, [2, 0]], _GREEN, 6)
    if alpha != _FIRST:
        panel.line(far * [1, z / first], CAMERA, 1, dash=4)
        panel.line(np.column_stack([[first, first], ends]), _PALE, 5)
    panel.line(far, CAMERA, 1.5)
    panel.line(legs, IDEAL, 1.5)
    corner = np.array([[z - 9 * px, 0], [z - 9 * px, 9 * px], [z, 9 * px]])
    panel.line(corner, IDEAL, 1)
    panel.line(np.column_stack([[z, z], ends]), LENS, 5)
    turn = np.arctan(np.linspace(left, right, 41) / z)
    panel.line(22 * px * np.column_stack([np.cos(turn), np.sin(turn)]), CAMERA, 1.5)
    panel.text([z - 16 * px, -12 * px], f"α = {alpha:g}", IDEAL, anchor="rm", size=15)
    panel.text([z - 7 * px, right * 0.72], f"{right / _MM:g}", IDEAL, anchor="rm", size=15)
    panel.text([-8 * px, 0], f"{angle:.1f}°", CAMERA, anchor="rm", size=15)
    panel.mark([0, 0], "camera", 8, looks=(1, 0))
    panel.grip("sensor", "the sensor, away from the centre or sideways", [z, ends.mean()], 12)
    return panel
