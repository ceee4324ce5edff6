"""Explore the horizon: it stays as the eye rises, and is pulled, which turns the camera."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_angles
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, MUTED, mixed

_SIZE, _FOCAL, _MIDDLE = (640, 480), 800.0, np.array([325.0, 238.0])  # px; the pixels are square
_A, _YAW = intrinsics(_FOCAL, _FOCAL, *_MIDDLE), 0.05  # rad
_ROW, _TALL, _START = -4.0, 6.0, 1.95  # m: where the poles stand, their height, the eye's at first
_POLES, _MARKED = np.arange(15.0, 490, 25), 4  # m ahead; how many are marked
_HIGH, _GRASS, _BALLAST, _WOOD = "#9FBFE4", "#7A9155", "#8F877E", "#5C4A3D"
_STEEL, _SHADE, _AIR = "#C8CED5", "#55524F", "#E6EDF2"
_HAZE, _PALEST = 3000.0, 0.4  # m, as photographed; but the ground is green up to its horizon
_FURTHER = np.geomspace(0.3, 1e5, 100)  # m: where the ground changes its colour


def eye_model() -> Model:
    """Make the model of the chapter's railway, seen by an eye that rises."""
    settings = (
        Setting("height", "eye (m)", 0.5, 8, 0.05, _START, "how high it is above the grass"),
        Setting("tilt", "tilt (°)", 0, 12, 0.1, 3.4, "how far the axis leads down"),
        Setting("roll", "roll (°)", -25, 25, 0.1, 7.8, "how far the camera is turned about it"),
    )
    about = """A railway with poles, seen by a camera that is tilted and rolled, its horizon, and
    the way from the principal point c straight to it; beside it the same from the side. Once the
    eye rises, green marks on four poles are as high."""

    def draw(paper: Paper, values: Values) -> Drawing:
        height, tilt, roll = values["height"], *np.radians([values["tilt"], values["roll"]])
        picture = paper.picture_panel((440, 330), _SIZE, "what the camera sees: pull the horizon")
        R = rotation_from_angles(0, 0, roll) @ rotation_from_angles(tilt, 0, 0)
        camera = _draw_railway(picture, R @ rotation_from_angles(0, _YAW, 0), height)
        if _marked(height):
            picture.mark(camera.project([[_ROW, -height, z] for z in _POLES[:_MARKED]]), "world", 5)
        _draw_way(picture, tilt, roll)
        title = "from the side (m), heights stretched: pull the eye"
        side = paper.panel((330, 330), (-18, 100), (8.6, -0.8), title)
        _draw_side(side, height)
        return Drawing(paper.join((picture, side)), _sentence(height, values["tilt"]))

    return Model("eye", about, settings, draw, {"height": placed("", "height"), "horizon": _pulled})


def _pulled(_: Values, at: Array) -> Values:
    u, v = at - _MIDDLE
    tilt, roll = np.arctan(np.hypot(u, v) / _FOCAL), np.arctan2(u, -v)
    return {"tilt": float(np.degrees(tilt)), "roll": float(np.degrees(roll))}


def _draw_railway(panel: Panel, R: Array, height: float) -> Camera:
    """Draw the railway as a camera sees it that is so high above the grass, and its horizon."""
    camera = Camera(_A, pose(R, R @ [0, height, 0]))  # the grass is the plane y = 0
    a, b, c = np.linalg.inv(_A).T @ R @ [0, 1, 0]
    skyline = np.array([[u, -(a * u + c) / b] for u in (-20.0, 660.0)])

    def fill(x: npt.ArrayLike, y: npt.ArrayLike, z: npt.ArrayLike, ink: str) -> None:
        corners = np.stack(np.broadcast_arrays(x, y, z), axis=-1).reshape(-1, 4, 3)
        away = _PALEST * (1 - np.exp(-corners[:, :, 2].mean(axis=1) / _HAZE))
        panel.polygons(camera.project(corners), [mixed(ink, _AIR, part) for part in away.tolist()])

    along = np.stack([_FURTHER[:-1]] * 2 + [_FURTHER[1:]] * 2, axis=1)[::-1]
    panel.polygons([[[-20, -20], [660, -20], [660, 500], [-20, 500]]], _AIR)
    for part in np.linspace(0, 1, 40).tolist():  # the sky, ever bluer
        over = skyline - [0, 420 * part]
        panel.polygons([[*over, [660, -999], [-20, -999]]], mixed(_AIR, _HIGH, part))
    fill(3 * along * [-1, 1, 1, -1], 0, along, _GRASS)
    fill([-2.3, 2.3, 2.3, -2.3], -0.18, along, _BALLAST)
    fill([-1.3, 1.3, 1.3, -1.3], -0.2, np.arange(0.6, 300, 0.6)[:, None] + [0, 0, 0.3, 0.3], _WOOD)
    for x in (-0.715, 0.715):  # the inner face of a rail, and its head
        fill(x, [-0.2, -0.35, -0.35, -0.2], along, _SHADE)
        fill(np.sign(x) * np.array([0.715, 0.785, 0.785, 0.715]), -0.35, along, _STEEL)
    for z in _POLES[::-1]:
        aside = _ROW + np.array([-0.09, 0.09, 0.09, -0.09])
        fill(aside, [0, 0, -_TALL, -_TALL], [z] * 4, _WOOD)
    panel.line(skyline, IDEAL, 2)
    (left, _), (right, far) = skyline
    end, anchor = (right - 30, "rm") if 40 < far < _SIZE[1] else (left + 30, "lm")
    panel.text([end, -(a * end + c) / b - 24], "horizon", IDEAL, anchor=anchor)
    return camera


def _draw_way(panel: Panel, tilt: float, roll: float) -> None:
    """Draw the way from c straight to the horizon."""
    near = _MIDDLE + _FOCAL * np.tan(tilt) * np.array([np.sin(roll), -np.cos(roll)])
    panel.line([_MIDDLE, near], ESTIMATED, 3)
    panel.mark(_MIDDLE, "ideal", 8)
    panel.text(_MIDDLE + [16, 18], "c", IDEAL, size=16)
    if np.tan(tilt) > 0.03:
        panel.text((_MIDDLE + near) / 2 - [14, 0], "f tan(tilt)", ESTIMATED, anchor="rm", size=15)
    panel.grip("horizon", "the point of the horizon that is nearest to c", near, 2)


def _draw_side(panel: Panel, height: float) -> None:
    for low, high, ink in ((0, 9, _AIR), (-9, 0, _GRASS)):
        panel.polygons([[[-20, low], [120, low], [120, high], [-20, high]]], ink)
    panel.ticks(x=(0, 25, 50, 75), y=(2, 4, 6, 8))
    poles = _POLES[:_MARKED]
    panel.segments([[[z, 0], [z, _TALL]] for z in poles], _WOOD, 2)
    panel.line([[0, height], [120, height]], IDEAL, 1)
    if _marked(height):
        panel.mark([[z, height] for z in poles], "world", 4.5)
    panel.line(np.array([[0, 0], [0, height]]), MUTED, 2)
    panel.mark([0, height], "camera", 9, looks=(1, 0))
    panel.text([-5.5, height], "eye", CAMERA, anchor="rm")
    panel.grip("height", "the eye, to be pulled up and down", [0, height], 4)


def _marked(height: float) -> bool:
    return height <= _TALL and height != _START  # where they will be is asked


def _sentence(height: float, t: float) -> str:
    said = f"The eye is {height:.2f} m above the grass"
    if height == _START:  # what the horizon does is asked
        said += f". The poles are {_TALL:g} m high."
    elif height > _TALL:
        said += f": the horizon passes over all poles, for they are {_TALL:g} m high."
    else:
        said += f": the horizon cuts every pole {height:.2f} m above its foot."
    away = f"{_FOCAL:.0f} · tan {t:.1f}° = {_FOCAL * np.tan(np.radians(t)):.0f} px"
    return f"{said} From c to it: f tan(tilt) = {away}."
