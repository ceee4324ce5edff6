"""Explore the division by the depth: a box before a camera, from above, and its image on z = 1."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at, move
from cvnotes.show.explorations.formation import (
    Scene,
    draw_above,
    draw_axes,
    draw_seen,
    faces_of,
    follow,
    written,
)
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, MUTED, WORLD

_SIZE = 400, 300  # px, of a panel
_FRAME = np.array([[-588.0, 588], [762, -120]])  # mm, x and z of the panel from above
_PLANE = 250.0  # mm: where z = 1 is drawn
_SIDE, _HIGH, _TOP = 60.0, 155.0, -125.0  # mm: the camera's X and height; Y of the box's top
_SEEN = np.array([0.8, 0.6])  # on z = 1: how far from the axis the picture reaches


def divide_model() -> Model:
    """Make the model of a box before a level camera, from near and far."""
    settings = (
        Setting("x", "the cross: x (mm)", 40, 220, 5, 120, "how far to the right of the axis"),
        Setting("z", "the cross: z (mm)", 300, 600, 10, 300, "its depth"),
    )
    about = (
        "A box before a camera, from above, with its rays and the plane z = 1; beside it the "
        "picture on this plane, in which each corner has been divided by its depth."
    )

    def pulled(_: Values, at: Array) -> Values:
        return {"x": float(at[0]), "z": float(at[1])}

    return Model("divide", about, settings, _draw, {"corner": pulled})


def _draw(paper: Paper, values: Values) -> Drawing:
    eye = np.array([_SIDE, -_HIGH, -values["z"]])
    A = intrinsics(320 / _SEEN[0], 240 / _SEEN[1], 319.5, 239.5)
    camera = Camera(A, look_at(eye, eye + [0, 0, 1]))
    W = np.array([values["x"] + _SIDE, _TOP, 0])
    M = move(camera.G, W)
    xy = M[:2] / M[2]
    (x, y), (right, low) = _FRAME, _SEEN
    frame = paper.panel(_SIZE, (x[0], x[1]), (y[0], y[1]), "before the camera, from above")
    _draw_rays(frame, camera, W)
    frame.grip("corner", "the corner, to be pulled", M[[0, 2]], 6)
    plane = paper.panel(_SIZE, (-right, right), (-low, low), "÷ z: its image on the plane z = 1")
    draw_seen(plane, Scene.of(camera, W), lambda xy: xy)
    plane.arrows([[0, 0], [0, 0]], [[0.25, 0], [0, 0.25]], CAMERA, 2)
    for at, name in (([0.3, -0.01], "x"), ([0, 0.3], "y")):
        plane.text(at, name, CAMERA, anchor="mm", size=13)
    follow(frame, M[[0, 2]], written(M, 0))
    follow(plane, xy, written(xy, 3), over=True)
    said = (
        f"The corner {written(M, 0)} mm is divided by its depth, {M[2]:.0f} mm: "
        f"({', '.join(f'{part:.3f}' for part in xy)}, 1)."
    )
    return Drawing(paper.join((frame, plane)), said)


def _draw_rays(frame: Panel, camera: Camera, W: Array) -> None:
    """Draw box and camera from above, the rays to the box, and where they pierce z = 1."""

    def seen(W: Array) -> Array:
        return np.asarray(move(camera.G, W)[..., [0, 2]])

    draw_above(frame, seen, camera, W)
    draw_axes(frame, 150, CAMERA, "xz", lambda ends: ends[..., [0, 2]])
    corners = seen(faces_of(W)[:2]).reshape(-1, 2)
    frame.segments(np.stack([0 * corners, corners], axis=1), MUTED, 0.7)
    end = _PLANE * _SEEN[0]
    frame.line([[-end, _PLANE], [end, _PLANE]], CAMERA, 3)
    frame.text([-end - 12, _PLANE], "z = 1", CAMERA, anchor="rm", size=13)
    flat = _PLANE * corners[:, 0] / corners[:, 1]
    frame.line([[flat.min(), _PLANE], [flat.max(), _PLANE]], WORLD, 5)
    M = seen(W)
    frame.line(np.array([0 * M, M]), ESTIMATED, 1.2)
    frame.mark(M * _PLANE / M[1], "estimated", 6)
