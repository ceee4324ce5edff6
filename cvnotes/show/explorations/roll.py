"""Explore roll and tilt: the horizon is pulled, and the camera turns until it is seen there."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import intrinsics, rotation_from_angles
from cvnotes.show.explorations.eye import SIZE, draw_railway
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL

_FOCAL, _MIDDLE = 800.0, np.array([325.0, 238.0])  # px; the pixels are square
_A = intrinsics(_FOCAL, _FOCAL, *_MIDDLE)
_LARGER, _EYE, _YAW = 3, 1.95, 0.05  # times the tilt, in the side view; m; rad


def roll_model() -> Model:
    """Make the model of a tilted and rolled camera, whose horizon is pulled."""
    settings = (
        Setting("tilt", "tilt (°)", 0, 12, 0.1, 3.4, "how far the axis leads down"),
        Setting("roll", "roll (°)", -25, 25, 0.1, 7.8, "how far the camera is turned about it"),
    )
    about = (
        "A railway seen by a camera that is tilted and rolled, and the way from the principal "
        "point c straight to its horizon; beside it the camera from the side, with the level ray, "
        "the axis and the picture, its tilt drawn three times as large."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        tilt, roll = np.radians([values["tilt"], values["roll"]])
        picture = paper.picture_panel((440, 330), SIZE, "pull the horizon")
        R = rotation_from_angles(0, 0, roll) @ rotation_from_angles(tilt, 0, 0)
        draw_railway(picture, _A, R @ rotation_from_angles(0, _YAW, 0), _EYE)
        near = _MIDDLE + _FOCAL * np.tan(tilt) * np.array([np.sin(roll), -np.cos(roll)])
        _draw_way(picture, near, roll)
        side = paper.panel(
            (330, 330), (-0.2, 1.5), (-0.72, 0.98), f"from the side: t drawn {_LARGER} times larger"
        )
        _draw_side(side, _LARGER * tilt)
        return Drawing(paper.join((picture, side)), _sentence(values))

    return Model("roll", about, settings, draw, {"horizon": _pulled})


def _pulled(_: Values, at: Array) -> Values:
    u, v = at - _MIDDLE
    tilt, roll = np.arctan(np.hypot(u, v) / _FOCAL), np.arctan2(u, -v)
    return {"tilt": float(np.degrees(tilt)), "roll": float(np.degrees(roll))}


def _draw_way(panel: Panel, near: Array, roll: float) -> None:
    """Draw the way from c straight to the horizon, and the angle between this and level."""
    panel.line([_MIDDLE, near], ESTIMATED, 2.5)
    panel.line([near, near + [200, 0]], IDEAL, 1, dash=4)
    arc = roll * np.linspace(0, 1, 20)
    panel.line(near + 150 * np.stack([np.cos(arc), np.sin(arc)], axis=1), IDEAL, 1)
    if abs(roll) > 0.1:
        middle = np.array([np.cos(roll / 2), np.sin(roll / 2)])
        panel.text(near + 160 * middle, "roll", IDEAL, size=14)
    panel.mark(_MIDDLE, "ideal", 8)
    panel.text(_MIDDLE + [16, 18], "c", IDEAL, size=15)
    if np.linalg.norm(near - _MIDDLE) > 20:
        panel.text((_MIDDLE + near) / 2 - [18, 0], "f tan t", ESTIMATED, anchor="rm", size=14)
    panel.grip("horizon", "the point of the horizon that is nearest to c", near, 2)


def _draw_side(panel: Panel, t: float) -> None:
    axis, up = np.array([[np.cos(t), np.sin(t)], [np.sin(t), -np.cos(t)]])
    pierced = np.array([1 / np.cos(t), 0])
    panel.line([[0.0, 0.0], [1.42, 0.0]], IDEAL, 1.6)
    panel.line(np.outer([0, 1.3], axis), IDEAL, 1.6)
    panel.line(axis + np.outer([-0.36, np.tan(t) + 0.3], up), CAMERA, 4)
    panel.line([axis, pierced], ESTIMATED, 2.5)
    arc = t * np.linspace(0, 1, 20)
    panel.line(0.42 * np.stack([np.cos(arc), np.sin(arc)], axis=1), IDEAL, 1)
    panel.mark(axis, "ideal", 7)
    panel.mark([0, 0], "camera", 10, looks=(axis[0], axis[1]))
    for at, words, ink, anchor in (
        ([-0.02, -0.1], "eye", CAMERA, "mm"), ([0.5, -0.07], "level ray", IDEAL, "mm"),
        (0.62 * axis - 0.09 * up, "f", IDEAL, "mm"), (1.3 * axis - 0.08 * up, "axis", IDEAL, "mm"),
        (axis + (np.tan(t) + 0.3) * up + [-0.1, -0.06], "picture", CAMERA, "mm"),
        ((axis + pierced) / 2 + [0.06, 0], "f tan t", ESTIMATED, "lm"),
        (0.47 * np.array([np.cos(t / 2), np.sin(t / 2)]), "t", IDEAL, "mm"),
    ):  # fmt: skip
        if t > 0.13 or "t" not in words.split():
            panel.text(at, words, ink, anchor=anchor, size=14)


def _sentence(values: Values) -> str:
    t, roll = values["tilt"], values["roll"]
    away = _FOCAL * np.tan(np.radians(t))
    return (
        f"The camera is tilted by {t:.1f}° and rolled by {roll:.1f}°. From c to the horizon it is "
        f"f tan t = {_FOCAL:.0f} · tan {t:.1f}° = {away:.0f} px."
    )
