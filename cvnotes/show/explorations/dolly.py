"""Explore the dolly zoom: step back and zoom, and one thing keeps its size while others do not."""

from functools import lru_cache
from itertools import pairwise

import numpy as np

from cvnotes.camera import Camera, intrinsics
from cvnotes.pictures import render_scene, room
from cvnotes.pictures.meshes import from_above
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, IDEAL, MUTED, hexed

_SIZE, _SHOWN, _PLAN = (640, 480), (440, 330), (205, 330)  # px
_GROWS = 0.25  # px for each mm of distance
_X, _Y, _FRONT = 350, 300, 7450  # mm: the camera's way, and the front of the red box
_BOX = np.array([[450, 940, _FRONT], [850, 940, _FRONT]])  # just below its front
_BOARD = np.array([[-700, 360, 9950], [700, 360, 9950]])  # just below the blackboard's frame
_PALE, _GREEN = "#DDEFFA", "#3A6A66"
_CORNERS = np.array([[-3000, 0], [-3000, 10_000], [3000, 10_000], [3000, 0]])  # mm, from above
_OUTSIDE = [np.stack([a, b, 2 * b, 2 * a]) for a, b in pairwise(_CORNERS)]


def dolly_model() -> Model:
    """Make the model of the room from near and far, with a lens that makes up for the distance."""
    settings = (Setting("distance", "distance (mm)", 1500, 7000, 250, 3000, "to the red box"),)
    about = """A red box in a room, and how wide the box and the blackboard behind it are in the
    picture; beside it the room from above, with the part of it that the camera sees."""

    def draw(paper: Paper, values: Values) -> Drawing:
        camera = camera_at(values["distance"])
        alpha, angle = camera.A[0, 0], np.degrees(camera.field_of_view[0])
        panel = paper.picture_panel(_SHOWN, _SIZE, f"α = {alpha:g} px")
        panel.image(_photograph(values["distance"]))
        seen = camera.project([_BOX, _BOARD])
        widths = np.ptp(seen[..., 0], axis=1)
        for ends, width in zip(seen, widths, strict=True):
            panel.line(ends, IDEAL, 2)
            panel.text(ends.mean(axis=0) + [0, 14], f"{width:.0f} px", IDEAL, anchor="mm", size=13)
        said = f"""The camera is {values["distance"] / 1000:g} m away; with α = {alpha:g} px it sees
        {angle:.1f}°. The box is {widths[0]:.0f} px wide, the blackboard {widths[1]:.0f} px."""
        return Drawing(paper.join((panel, _plan(paper, camera, angle))), said)

    drags = {"walk": lambda _, at: {"distance": _FRONT - at[1]}}
    return Model("dolly", about, settings, draw, drags)


def camera_at(distance: float, size: tuple[int, int] = _SIZE) -> Camera:
    """Return the camera at some distance, of some size; α grows with the distance."""
    alpha = _GROWS * distance
    A, G = intrinsics(alpha, alpha, 319.5, 239.5), np.eye(4)
    G[:3, 3] = -_X, -_Y, distance - _FRONT
    return Camera(A, G).resized(size)


@lru_cache(maxsize=64)
def _photograph(distance: float) -> Drawn:
    """Take a picture once: a tenth of a second, too long for a hand that comes back to it."""
    return render_scene(room(), camera_at(distance, _SHOWN), samples=4)


def _plan(paper: Paper, camera: Camera, angle: float) -> Panel:
    """Draw the room from above, what the camera sees of it, and how wide that is at the box."""
    panel = paper.panel(_PLAN, (-3200, 3200), (10_300, 0), "from above: pull the camera")
    eye, sides = camera.centre[[0, 2]], camera.ray([[-0.5, 239.5], [639.5, 239.5]])[:, [0, 2]]
    sides = sides / sides[:, 1:]
    left, right = eye + (10_000 - eye[1]) * sides
    panel.polygons([[eye, left, right]], _PALE)
    for corners, colour in zip(*from_above(room(), -1500), strict=True):
        panel.polygons([corners], hexed(np.rint(255 * colour)))
    panel.line([left, eye, right], CAMERA, 1.5)
    across = eye + (_FRONT - eye[1]) * sides
    panel.line(across, IDEAL, 1.5)
    panel.line(_BOARD[:, ::2], _GREEN, 5)
    panel.polygons(_OUTSIDE, "#E4E4E4")
    panel.line(_CORNERS, MUTED, 3)
    panel.text([_X, _FRONT - 420], f"{np.ptp(across[:, 0]) / 1000:.2f} m", IDEAL, anchor="mm")
    panel.mark(eye, "camera", 9)
    panel.text(eye + [480, -60], f"{angle:.0f}°", CAMERA, size=13)
    panel.grip("walk", "how far back the camera stands", eye, 8)
    return panel
