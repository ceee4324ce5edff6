"""Explore three angles: rings that turn in each other, and how two of their axes become one."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import rotation_from_angles
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, nearest
from cvnotes.show.explorations.paper import Paper
from cvnotes.show.space.directions import onto, sheet, towards
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, hexed, rgb

_UPRIGHT = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])  # z, the grey axis, points up on the sheet
_on_sheet, _TOWARDS = onto(sheet((22, -52)) @ _UPRIGHT), towards((22, -52)) @ _UPRIGHT
_RADII, _PIECES = (1.0, 0.8, 0.6), 72
_HELD, _BARED = 0.9, 0.72  # where the orange axis is held, and ends: before the blue ring
_COLOURS = MUTED, LENS, ESTIMATED
_WIDE, _HIGH = (1, 1, 0.9, 0.9), (-0.04, 0.04, 0.04, -0.04)  # a ring's cut: radius and height
_SHADES = 0.8, 1.0, 0.65, 1.0  # of a ring's rim, its side, its inside and the other side
# A dart of paper: nose, two wings, tail and keel.
_DART = np.array([[0.5, 0, 0], [-0.4, 0.3, 0], [-0.28, 0, 0], [-0.4, -0.3, 0], [-0.4, 0, 0.25]])


def gimbal_model() -> Model:
    """Make the model of three rings, R = Rz Ry Rx."""
    settings = (
        Setting("x", "angle x (°)", -180, 180, 5, 20, "turns the orange ring about its own axis"),
        Setting("y", "angle y (°)", -90, 90, 5, 30, "the middle one: turns the blue ring"),
        Setting("z", "angle z (°)", -180, 180, 5, 0,
                "turns all about the grey axis, which is fixed"),
    )  # fmt: skip
    about = """Three rings, each of which turns in the one outside of it, with their axes, and a
    dart in the innermost."""

    def ends(values: Values, tried: Array) -> Array:
        return np.array([_on_sheet(axes({**values, "y": y})[2] * _HELD) for y in tried])

    drags = {"orange axis": nearest("y", np.arange(-90, 91, 5.0), ends)}
    return Model("gimbal", about, settings, _draw, drags)


def axes(values: Values) -> Array:
    """Return the axes (3, 3) about which the angles z, y and x turn, where the rings now stand."""
    y, z = np.radians([values["y"], values["z"]])
    about_z, about_zy = rotation_from_angles(0, 0, z), rotation_from_angles(0, y, z)
    return np.array([[0, 0, 1.0], about_z[:, 1], about_zy[:, 0]])


def _draw(paper: Paper, values: Values) -> Drawing:
    outer, middle, inner = turns = axes(values)
    R = rotation_from_angles(*np.radians([values["x"], values["y"], values["z"]]))
    title = "each ring turns in the one outside"
    panel = paper.panel((480, 400), (-1.68, 1.68), (-1.4, 1.4), title)
    faces, paints = [], []
    rings = (*zip("zyx", turns, (middle, inner, R[:, 1]), _RADII, _COLOURS, strict=True),)
    for name, axis, side, r, colour in rings:
        quads = _ring(axis, side, r)
        faces.append(quads.reshape(-1, 4, 3))
        paints += _PIECES * [hexed(np.rint(255 * s * np.array(rgb(colour)))) for s in _SHADES]
        end = _BARED if name == "x" else r + 0.3
        bars = np.array([-r - 0.3, -r, r, end])[:, None] * axis
        for pair in (bars[:2], bars[2:]):
            faces.append(_bar(pair))
            paints += [colour] * len(faces[-1])
    dart = _DART @ R.T
    faces.append(dart[[[0, 1, 2, 2], [0, 3, 2, 2], [0, 4, 2, 2]]])
    paints += [IDEAL, "#555555", "#333333"]
    quads = np.concatenate(faces)
    depth = quads.mean(axis=1) @ _TOWARDS
    order = np.argsort(depth)
    panel.polygons(_on_sheet(quads[order]), [paints[i] for i in order])
    for name, axis, _, r, colour in rings:
        at = _on_sheet((r + 0.3) * axis)
        panel.text(at + [0.14 if at[0] > -0.2 else -0.14, 0], name, colour, anchor="mm", size=15)
    end = _on_sheet(inner * _HELD)
    panel.grip("orange axis", "the end of the orange axis", end, 8, "estimated", 6)
    apart = np.degrees(np.arccos(min(abs(float(outer @ inner)), 1)))
    return Drawing(paper.join((panel,)), _sentence(values["y"], apart))


def _ring(axis: Array, side: Array, r: float) -> Array:
    """Return the sides (pieces, 4, 4, 3) of a ring through two axes."""
    t = np.linspace(0, 2 * np.pi, _PIECES + 1)[:, None, None]
    wide, high = np.array(_WIDE)[:, None], np.array(_HIGH)[:, None]
    cut = r * wide * (np.cos(t) * axis + np.sin(t) * side) + high * np.cross(axis, side)
    cut = np.concatenate([cut, cut[:, :1]], axis=1)
    return np.stack([cut[:-1, :-1], cut[1:, :-1], cut[1:, 1:], cut[:-1, 1:]], axis=2)


def _bar(ends: Array) -> Array:
    """Return a bar between two places as pieces (k, 4, 3) that face the reader."""
    aside = np.cross(ends[1] - ends[0], _TOWARDS)
    aside = 0.025 * aside / max(float(np.linalg.norm(aside)), 1e-9)
    along = ends[0] + np.linspace(0, 1, 5)[:, None] * (ends[1] - ends[0])
    start, end = along[:-1], along[1:]
    return np.stack([start - aside, start + aside, end + aside, end - aside], 1)


def _sentence(y: float, apart: float) -> str:
    if abs(y) == 90:
        return """The orange axis lies in the grey one: the angles x and z turn the dart about one
        line, and only two directions of turning are left."""
    return f"The grey and the orange axis are {apart:.0f}° apart."
