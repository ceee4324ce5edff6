"""Explore how wide a picture can be: pinhole views in all directions, out of one fisheye's."""

from functools import cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, FisheyeLens, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import render_scene, room
from cvnotes.projective import to_homogeneous
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import ESTIMATED, MUTED
from cvnotes.warping import backward_warp

_SIZE, _SHOWN, _VIEW = 700, (350, 350), (420, 350)  # px: of the photograph, and on the page
_WIDTH = np.radians(220)  # that the fisheye sees; what is farther aside falls on its mount
_F, _MIDDLE = 0.97 * _SIZE / _WIDTH, (_SIZE - 1) / 2
_A, _G = intrinsics(_F, _F, _MIDDLE, _MIDDLE), pose(np.eye(3), [300, 100, -6900])
_CAMERA = Camera(_A, _G, FisheyeLens(), size=(_SIZE, _SIZE))


def fisheye_model() -> Model:
    """Make the model of a room through a fisheye, and of a pinhole view made of its picture."""
    settings = (
        Setting("fov", "field of view (°)", 40, 150, 1, 110, "of the view, from left to right"),
        Setting("right", "to the right (°)", -80, 80, 1, -25, "where to look"),
        Setting("up", "upwards (°)", -60, 40, 1, -10, "where to look"),
    )
    about = """A room through a fisheye that sees 220°, with the outline of a pinhole's view; beside
    it this view, made of the fisheye's pixels."""
    return Model("fisheye", about, settings, _draw, {"view": _pulled})


def _draw(paper: Paper, values: Values) -> Drawing:
    fov, f = values["fov"], _VIEW[0] / 2 / np.tan(np.radians(values["fov"]) / 2)
    turned, raised = np.radians([[0, values["right"], 0], [values["up"], 0, 0]])
    R = rotation_from_vector(turned) @ rotation_from_vector(raised)  # from the view's axes; level
    photo = paper.picture_panel(_SHOWN, (_SIZE, _SIZE), "through a fisheye (+ to look elsewhere)")
    photo.image(_photograph())
    _outline(photo, f, R)
    # For each pixel of the view: what the fisheye has in that direction.
    width, height = size = paper.sharpness * _VIEW[0], paper.sharpness * _VIEW[1]
    A = intrinsics(paper.sharpness * f, paper.sharpness * f, (width - 1) / 2, (height - 1) / 2)
    back = R @ np.linalg.inv(A)
    seen = backward_warp(_photograph(), lambda m: shown_at(to_homogeneous(m) @ back.T), size=size)
    view = paper.panel(_VIEW, (0, 1), (0, 1), "a pinhole's view, out of the fisheye's picture")
    view.image(seen.astype(np.uint8))
    border = _border(f, R)
    beyond = bool((border[:, 2] < np.cos(_WIDTH / 2) * np.linalg.norm(border, axis=1)).any())
    return Drawing(paper.join((photo, view)), _sentence(fov, f, beyond))


def _pulled(_: Values, at: Array) -> Values:
    off = (at - _MIDDLE) / _F
    x, y, z = _CAMERA.lens.rays(off / max(1.0, np.hypot(*off) / (np.pi / 2)))
    return {"right": float(np.degrees(np.arctan2(x, z))), "up": float(np.degrees(np.arcsin(-y)))}


def shown_at(rays: Array) -> Array:
    """Return the pixels (..., 2) at which the fisheye shows what lies in directions (..., 3)."""
    return np.asarray(_F * _CAMERA.lens.of_rays(rays) + _MIDDLE)


@cache
def _photograph() -> Drawn:
    """Photograph the room once; beyond its field of view the fisheye shows its black mount."""
    picture: Drawn = render_scene(room(), _CAMERA, samples=4)
    v, u = np.indices(picture.shape[:2])
    picture[np.hypot(u - _MIDDLE, v - _MIDDLE) > _F * _WIDTH / 2] = 0
    return picture


def _border(f: float, R: Array) -> Array:
    """Return the rays (n, 3) around a view."""
    along, one = np.linspace(-1, 1, 41), np.ones(41)
    x, y = np.r_[along, one, -along, -one], np.r_[-one, along, one, -along]
    return np.asarray(np.stack([x * _VIEW[0] / 2, y * _VIEW[1] / 2, f + 0 * x], axis=-1) @ R.T)


def _outline(panel: Panel, f: float, R: Array) -> None:
    """Draw what the view sees, and the circle of what lies exactly beside the fisheye."""
    phi = np.linspace(0, 2 * np.pi, 181)
    panel.line(shown_at(np.stack([np.cos(phi), np.sin(phi), 0 * phi], -1)), "white", 1.2, dash=5)
    below = shown_at(np.array([0.0, -1, 0])) + [0, 5 * panel.pixel]
    panel.text(below, "90° from the axis", MUTED, anchor="ma", size=12)
    panel.line(shown_at(_border(f, R)), ESTIMATED, 2.6, rim=2.4)
    ahead = shown_at(R[:, 2])
    panel.grip("view", "where to look", ahead, 6, "ideal", 9)


def _sentence(fov: float, f: float, beyond: bool) -> str:
    corner = np.hypot(*_VIEW) / 2 / f  # tan of its angle from the middle
    needed = 2 * _F * np.tan(np.radians(fov) / 2)
    return f"""A view of {fov:g}°: in its middle a pixel of the fisheye becomes {f / _F:.1f} pixels
    long, in its corners up to {f / _F * (1 + corner**2):.1f}. A pinhole camera as sharp in the
    middle, with the same f of {_F:.0f} px, needs a sensor {needed:,.0f} px wide; for 180° none is
    enough.{" Black: beyond the 220° that the fisheye sees." if beyond else ""}"""
