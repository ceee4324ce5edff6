"""Explore the protractor: two vanishing points on the horizon, and the angle of their walls."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, MUTED

_F, _C = 800.0, np.array([325.0, 238.0])  # px, of a level camera with square pixels
_SHOWN, _HIGH, _AHEAD = (-1540.0, 1120.0), (-60.0, 520.0), (1210.0, -75.0)  # px: u, v, z
# The near corner of the house, its foot and top, and how long a wall is; in px, like f.
_CORNER, _FOOT, _TOP, _LONG = np.array([-30.0, 900.0]), 165.0, -215.0, 300.0
_WALLS = ("#A65F43", "#C98A68")
_SKY, _GRASS = ("#EDF3F8", "#BFD6EC"), ("#E4EAD9", "#A9BE8B")  # around the picture, and in it
_EVERYWHERE = (-2e3, -200), (2e3, -200), (2e3, 2e3), (-2e3, 2e3)
_DISC, _ROOF = "#FBF1C7", "#DDB299"


def protractor_model() -> Model:
    """Make the model of a house whose two walls vanish where one pulls."""
    settings = (
        Setting("left", "left, u (px)", -1360, -200, 5, -475, "where the left wall vanishes"),
        Setting("right", "right, u (px)", 420, 940, 5, 725, "where the right wall vanishes"),
    )
    about = """The corner of a house in a picture, and its horizon, on which both walls vanish;
    below, the same from above: the rays from the eye to both vanishing points are parallel to the
    walls, so their angle is that of the walls."""

    def draw(paper: Paper, values: Values) -> Drawing:
        ends = np.array([values["left"], values["right"]])
        ways = np.column_stack([ends - _C[0], [_F, _F]])  # x and z of both directions
        width = 480 if paper.narrow else 800
        part = width / np.ptp(_SHOWN)
        size, title = (width, round(part * np.ptp(_HIGH))), "the picture, and what is far beside it"
        picture = paper.panel(size, _SHOWN, _HIGH, title)
        size = (width, round(part * np.ptp(_AHEAD)))
        above = paper.panel(size, _SHOWN, _AHEAD, "the same from above")
        _draw_picture(picture, ends, ways)
        angle = _angle(ways)
        _draw_above(above, ends, ways, angle)
        (a, _), (b, _) = ways / _F
        said = f"The left wall runs along [{a:.2f} 0 1], the right one along [{b:.2f} 0 1]"
        said += f": the angle between them is {angle:.1f}°."
        return Drawing(paper.join((picture,), (above,)), said)

    drags = {name: placed(name) for name in ("left", "right")}
    return Model("protractor", about, settings, draw, drags)


def _angle(ways: Array) -> float:
    a, b = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    return float(np.degrees(np.arccos(a @ b)))


def _draw_picture(panel: Panel, ends: Array, ways: Array) -> None:
    frame = np.array([[0, 0], [640, 0], [640, 480], [0, 480]]) - 0.5
    row = _C[1]
    around = np.stack([np.repeat(_SHOWN, 2), [*_HIGH, *_HIGH[::-1]]], axis=1)
    for corners, sky, grass in zip((around, frame), _SKY, _GRASS, strict=True):
        panel.polygons([corners], sky)
        panel.polygons([np.maximum(corners, [_SHOWN[0], row])], grass)
    panel.line([[_SHOWN[0], row], [_SHOWN[1], row]], IDEAL, 1.2)  # behind the house
    far = _CORNER + _LONG * ways / np.linalg.norm(ways, axis=1, keepdims=True)
    for (x, z), end, ink in zip(far, ends, _WALLS, strict=True):
        near_u, far_u = _C[0] + _F * np.array([_CORNER[0] / _CORNER[1], x / z])
        wall = [[u, row + _F * y / depth] for u, depth, y in (
            (near_u, _CORNER[1], _TOP), (far_u, z, _TOP), (far_u, z, _FOOT),
            (near_u, _CORNER[1], _FOOT))]  # fmt: skip
        panel.polygons([wall], ink)
        for corner in wall[:1] + wall[3:]:
            panel.line(np.array([corner, [end, row]], dtype=float), ESTIMATED, 1, dash=4)
    panel.line(frame[[0, 1, 2, 3, 0]], MUTED, 1)
    panel.text([_SHOWN[1] - 16, row + 64], "horizon", IDEAL, anchor="rm", size=13)
    for name, end, aside in zip(("left", "right"), ends, (-220, -20), strict=True):
        panel.grip(name, f"the vanishing point of the {name} wall", [end, row], 5, "estimated", 7)
        said = f"u = {end:.0f}"
        panel.text([max(end + aside, _SHOWN[0] + 16), row - 66], said, ESTIMATED, size=13)


def _draw_above(panel: Panel, ends: Array, ways: Array, angle: float) -> None:
    eye = np.array([_C[0], 0])
    corner = eye + _CORNER
    units = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    panel.polygons([np.array(_EVERYWHERE)], _GRASS[0])
    round_ = np.radians(np.arange(0, 181, 10))[:, None] * [1, 1] + [np.pi / 2, 0]
    rim = eye + 340 * np.sin(round_)  # the half disc, at every ten degrees
    panel.polygons([rim], _DISC)
    panel.line([*rim, rim[0]], MUTED, 1)
    panel.segments(np.stack([rim, eye + 0.92 * (rim - eye)], axis=1), MUTED, 1)
    roof = np.array([[0, 0], units[0], units.sum(axis=0), units[1]])
    panel.polygons([corner + _LONG * roof], _ROOF)
    panel.line([[_SHOWN[0], _F], [_SHOWN[1], _F]], IDEAL, 1.2)
    panel.line([[0, _F], [639, _F]], MUTED, 4)
    panel.text([_SHOWN[0] + 16, _F + 42], "the plane of the picture", IDEAL, size=13)
    panel.line(np.array([eye, [_C[0], _F]]), MUTED, 0.9, dash=5)
    panel.text([_C[0] + 16, 0.7 * _F], "f", MUTED, size=14)
    for end, unit, ink in zip(ends, units, _WALLS, strict=True):
        panel.line(np.array([eye, [end, _F]]), CAMERA, 2)
        panel.line([corner, corner + _LONG * unit], ink, 6)
        panel.mark([end, _F], "estimated", 7)
    turned = np.radians(np.linspace(0, angle, 40))[:, None]
    across = (units[1] - (units[1] @ units[0]) * units[0]) / np.sin(np.radians(angle))
    arc = eye + 150 * (np.cos(turned) * units[0] + np.sin(turned) * across)
    if abs(angle - 90) < 0.05:
        arc = eye + 110 * np.array([units[0], units.sum(axis=0), units[1]])
    panel.line(arc, IDEAL, 1.6)
    middle = units.sum(axis=0) / np.linalg.norm(units.sum(axis=0))
    panel.text(eye + 235 * middle, f"{angle:.1f}°", IDEAL, anchor="mm", size=16)
    panel.mark(eye, "camera", 9, looks=(0, -1))
    panel.text(eye + [44, -38], "eye", CAMERA, size=14)
    panel.text(corner + [36, -30], "house", "#8E4B38", size=13)
