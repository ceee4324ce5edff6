"""Explore two ways to one attitude: about one axis, and by three angles in proportion."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import rotation_from_angles, rotation_from_vector
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.orbit import angles_of
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.space.directions import sheet, towards
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, mixed

_UPRIGHT = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])  # z points up on the sheet
_SHEET, _TOWARDS = sheet((42, -62)) @ _UPRIGHT, towards((42, -62)) @ _UPRIGHT
_T = np.linspace(0, 1, 101)
# A dart of paper that flies along x, from its nose: nose, two wings, fold and keel.
_DART = np.array([[0, 0, 0], [-40, 13, 0], [-36, 0, 0], [-40, -13, 0], [-40, 0, 12]]) / 100
_TURN = np.linspace(0, 2 * np.pi, 97)


def ways_model() -> Model:
    """Make the model of a dart that is carried to an attitude in two ways."""
    settings = (
        Setting("up", "tip up (°)", -30, 150, 1, 105, "90 is the height of the pole"),
        Setting("aside", "tip aside (°)", -60, 60, 1, -6, "0 is the circle through the pole"),
        Setting("t", "time t (s)", 0, 1, 0.01, 0.4, "0 is the start, 1 the target"),
    )
    about = (
        "A dart in a sphere, carried to a target about one axis, orange, and by its three angles, "
        "blue: what their tips draw on the sphere. Dashed: by the target's other three angles."
    )

    def pulled(values: Values, at: Array) -> Values:
        """Put the tip where the hand is, on the side of the sphere that it is on."""
        across = at / max(float(np.linalg.norm(at)), 1)
        deep = np.sqrt(max(1 - float(across @ across), 0)) * (
            -1 if _tip(values) @ _TOWARDS < 0 else 1
        )
        x, y, z = across @ _SHEET + deep * _TOWARDS
        up = (np.degrees(np.arctan2(z, x)) + 120) % 360 - 120
        return {"up": float(up), "aside": float(np.degrees(np.arcsin(np.clip(y, -1, 1))))}

    return Model("ways", about, settings, _draw, {"target": pulled})


def ways(values: Values) -> tuple[Array, Array]:
    """Return where both ways lead: a rotation vector (3,), and angles x, y and z (3,)."""
    tip = _tip(values)
    axis, x = np.array([0, -tip[2], tip[1]]), float(tip[0])
    sine = float(np.linalg.norm(axis))
    omega = np.zeros(3) if sine < 1e-9 else axis / sine * np.arctan2(sine, x)
    # Rounded, so that half a turn is +180° on every machine. Beside half a turn about x, that
    # about z is the other way round: their ways are next to those of the angles around.
    angles = angles_of(rotation_from_vector(omega).round(12) + 0.0)
    if np.isclose(angles[0], np.pi) and np.isclose(angles[2], np.pi):
        angles[2] = -np.pi
    return omega, angles


def other_triple(angles: Array) -> Array:
    """Return the other angles x, y and z (3,) of the same attitude, from -180° to 180°."""
    x, y, z = angles
    other = np.array([x + np.pi, np.pi - y, z + np.pi])
    return np.asarray(np.pi - (np.pi - other) % (2 * np.pi))


def speeds(angles: Array) -> Array:
    """Return how fast the dart turns (101,) while its three angles grow evenly.

    The axes of x and z meet at an angle whose cosine is -sin y, both are perpendicular to y's.
    """
    x, _, z = angles
    return np.asarray(np.sqrt(angles @ angles - 2 * x * z * np.sin(_T * angles[1])))


def _tip(values: Values) -> Array:
    up, aside = np.radians([values["up"], values["aside"]])
    level = np.cos(aside)
    return np.array([level * np.cos(up), np.sin(aside), level * np.sin(up)])


def _tips(angles: Array) -> Array:
    """Return the tips (101, 3) of a dart whose three angles grow evenly."""
    _, up, turn = np.outer(angles, _T)
    return np.stack([np.cos(up) * np.cos(turn), np.cos(up) * np.sin(turn), -np.sin(up)], 1)


def _draw(paper: Paper, values: Values) -> Drawing:
    omega, angles = ways(values)
    others = other_triple(angles)
    length, round_about = (
        np.trapezoid(np.degrees(speeds(several)), _T) for several in (angles, others)
    )
    whole, t = float(np.degrees(np.linalg.norm(omega))), values["t"]
    panel = paper.panel((520, 430), (-1.48, 1.48), (-1.224, 1.224), "two ways to one attitude")
    by_axis = rotation_from_vector(np.outer(_T, omega))
    by_angles, by_others = _tips(angles), _tips(others)
    _draw_sphere(panel)
    tips = by_axis[:, :, 0] @ _SHEET.T
    panel.polygons([[[0, 0], *tips]], mixed("#FFFFFF", ESTIMATED, 0.16))
    if whole:
        _draw_omega(panel, omega, by_axis)
    dashes = np.where((np.arange(101) % 6 < 4)[:, None], by_others, np.nan)
    _draw_front(panel, dashes, LENS, 2)
    panel.line(
        np.where(dashes @ _TOWARDS[:, None] < 0, dashes, np.nan) @ _SHEET.T,
        mixed("#FFFFFF", LENS, 0.4),
        1,
    )
    trails = (by_angles, LENS), (by_axis[:, :, 0], ESTIMATED)
    for trail, colour in trails:
        panel.line(trail @ _SHEET.T, mixed("#FFFFFF", colour, 0.4), 1.2)
    now = rotation_from_vector(t * omega), rotation_from_angles(*(t * angles))
    for trail, colour in trails:
        _draw_front(panel, trail, colour, 2.5)
    _draw_darts(panel, ((np.eye(3), "#D2D2D2"), (now[1], LENS), (now[0], ESTIMATED)))
    for R, meaning in zip(now, ("estimated", "lens"), strict=True):
        panel.mark(R[:, 0] @ _SHEET.T, meaning, 5)
    panel.mark(tips[-1], "ideal", 9)
    panel.grip("target", "the tip of the target", tips[-1], 4)
    for meaning, words, colour, row in (
        ("estimated", "about one axis", ESTIMATED, 0.95),
        ("lens", "by three angles", LENS, 1.1),
    ):
        panel.mark([-1.38, row], meaning, 5)
        panel.text([-1.3, row], words, colour, anchor="lm", size=14)
    panel.line([[0.42, 1.1], [0.62, 1.1]], LENS, 1.5, dash=3)
    panel.text([0.7, 1.1], "by the other triple", LENS, anchor="lm", size=14)
    x, y, z = np.degrees(angles).round() + 0.0
    x_2, y_2, z_2 = np.degrees(others).round() + 0.0
    return Drawing(
        paper.join((panel,)),
        f"The way about one axis is {whole:.0f}° long. That by three angles, {x:.0f}° about x, "
        f"{y:.0f}° about y and {z:.0f}° about z, is {length:.0f}° long, roll "
        f"included; by the other triple, {x_2:.0f}°, {y_2:.0f}° and {z_2:.0f}°, it is "
        f"{round_about:.0f}°.",
    )


def _draw_sphere(panel: Panel) -> None:
    """Draw parallels and meridians, and the pole."""
    c, s = np.cos(_TURN), np.sin(_TURN)
    panel.line(np.column_stack([c, s]), MUTED, 1)
    for up in np.radians([-30, 0, 30, 60]):
        _draw_front(panel, np.column_stack([np.cos(up) * c, np.cos(up) * s, np.sin(up) + 0 * c]))
    for turn in np.radians(np.arange(0, 180, 30)):
        _draw_front(panel, np.column_stack([np.cos(turn) * c, np.sin(turn) * c, s]))
    panel.line(np.outer([1, 1.55], _SHEET[:, 2]), MUTED, 2.5)
    panel.text([0.05, -1.12], "pole", MUTED, size=14)
    panel.text(_SHEET[:, 0] + [0.06, 0.1], "start", MUTED, size=14)


def _draw_front(panel: Panel, W: Array, colour: str = "#C9C9C9", width: float = 0.7) -> None:
    """Draw as much of a curve on the sphere as lies on the side of the reader."""
    front = (W @ _TOWARDS > 0)[:, None]
    panel.line(np.where(front, W @ _SHEET.T, np.nan), colour, width)


def _draw_omega(panel: Panel, omega: Array, by_axis: Array) -> None:
    """Draw the axis as an arrow from the middle of the sphere, and about its foot the angle."""
    foot = 0.3 * by_axis[:, :, 0] @ _SHEET.T
    panel.line(foot, ESTIMATED, 1.5)
    angle = float(np.linalg.norm(omega))
    tip, end = _SHEET @ omega / angle, 0.55 * foot[50]
    along = tip / max(float(np.linalg.norm(tip)), panel.pixel)
    panel.arrows([0, 0], 1.15 * tip, ESTIMATED, 3)
    panel.text(1.15 * tip + 0.1 * along, "ω", ESTIMATED, anchor="mm", size=18)
    panel.text(end, f"{np.degrees(angle):.0f}°", ESTIMATED, anchor="mm", size=14)


def _draw_darts(panel: Panel, looks: tuple[tuple[Array, str], ...]) -> None:
    """Draw darts, each with its attitude and colour, their noses on the sphere."""
    faces = np.concatenate(
        [(R[:, 0] + _DART @ R.T)[[[0, 1, 2], [0, 3, 2], [0, 4, 2]]] for R, _ in looks]
    )
    paints = [mixed(colour, IDEAL, part) for _, colour in looks for part in (0, 0.12, 0.3)]
    order = np.argsort(faces.mean(axis=1) @ _TOWARDS)
    panel.polygons(faces[order] @ _SHEET.T, [paints[i] for i in order])
