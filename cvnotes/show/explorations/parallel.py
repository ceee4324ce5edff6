"""Explore the picture of a direction: parallel rods, and the ray from the eye beside them."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.pictures import course
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, nearest
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.explorations.strokes import clipped
from cvnotes.show.style import CAMERA, ESTIMATED, FAINT, IDEAL, LENS, MUTED, WORLD, mixed

_CAMERA = Camera(course.camera().A)
_SIZE, _SPACE = (440, 330), (440, 330)  # px
_GLASS, _RAY, _HALF, _RADIUS = 2.4, 3.3, 0.55, 0.03  # m; the last two are of a rod
_TURN, _ABOVE = np.radians([58, 20])  # from where space is seen
_SHEET = ((-1.15, 6.05), (-3.1, 2.3))  # of space, in m
_AT = np.stack(np.meshgrid(np.linspace(95, 545, 4), np.linspace(85, 395, 3)), -1).reshape(-1, 2)
_STREWN = np.random.default_rng(3).uniform([-40, -32, 3.5], [40, 32, 5.4], (12, 3))
_FOLLOWED = [1, 7, 8]  # the rods whose lines of sight are drawn
_LEFTMOST = -30  # degrees: farther to the left the ray would lie over the glass
_FRAME = np.array([[0, 0], [640, 0], [640, 480], [0, 480]]) - 0.5
_PANE, _LIGHT = "#DCEDF8", "#F4F9FD"


def parallel_model() -> Model:
    """Make the model of twelve parallel rods, their pictures, and the ray that is parallel."""
    settings = (
        Setting("heading", "heading (°)", _LEFTMOST, 90, 0.5, 17, "how far they turn to the right"),
        Setting("slope", "slope (°)", -12, 12, 0.5, 6, "how steeply they climb"),
    )
    about = """The picture of twelve parallel rods, each extended to their vanishing point; beside
    it in space the rods, the eye and before it the picture as a pane of glass, which the ray that
    is parallel to the rods pierces in this point."""

    def ends(values: Values, headings: Array) -> Array:
        return on_sheet(_RAY * direction(headings, values["slope"]))

    def pointed(_: Values, at: Array) -> Values:
        x, y, z = np.linalg.solve(_CAMERA.A, [*at, 1])
        heading, slope = np.degrees([np.arctan2(x, z), np.arctan2(-y, np.hypot(x, z))])
        return {"heading": float(heading), "slope": float(slope)}

    turned = nearest("heading", np.arange(_LEFTMOST, 90.5, 0.5), ends)
    return Model("parallel", about, settings, _draw, {"ray": turned, "vanishing point": pointed})


def direction(heading: npt.ArrayLike, slope: npt.ArrayLike) -> Array:
    """Return directions (..., 3) of length 1; 90° is exact."""
    h, s = np.broadcast_arrays(np.radians(heading), np.radians(slope))
    return np.stack([np.sin(h) * np.cos(s), -np.sin(s), np.cos(h) * np.cos(s)], -1).round(15)


def rods(d: Array) -> Array:
    """Return the ends (12, 2, 3) of the rods, the nearer one first; each turns about its middle."""
    at = _AT + _STREWN[:, :2]
    middle = _CAMERA.ideal(at)
    middle = np.insert(middle, 2, 1, axis=1) * _STREWN[:, 2:]
    return np.asarray(middle[:, None] + np.outer([-_HALF, _HALF], d))


def on_sheet(place: Array) -> Array:
    """Project places (..., 3) in parallel onto the sheet (..., 2): what is parallel stays so."""
    away = np.array([-np.sin(_TURN), 0, np.cos(_TURN)])
    down = np.cos(_ABOVE) * np.array([0, 1, 0]) - np.sin(_ABOVE) * away
    return np.asarray(place @ np.transpose([[np.cos(_TURN), 0, np.sin(_TURN)], down]))


def _on_glass(pixels: Array) -> Array:
    """Return where on the sheet pixels (..., 2) are on the glass."""
    ideal = _CAMERA.ideal(pixels)
    return on_sheet(_GLASS * np.concatenate([ideal, np.ones_like(ideal[..., :1])], axis=-1))


def _draw(paper: Paper, values: Values) -> Drawing:
    d = direction(values["heading"], values["slope"])
    there = rods(d)
    seen, end = _CAMERA.project(there), _CAMERA.vanishing_point(d)
    beyond = end if d[2] else seen[:, 1] + 9 * (seen[:, 1] - seen[:, 0])
    limits = (_FRAME[0], _FRAME[2])
    dashes = clipped(seen[:, 1], np.broadcast_to(beyond, (12, 2)), limits)
    picture = paper.picture_panel(_SIZE, _CAMERA.size, "the picture")
    _draw_picture(picture, there, dashes, end)
    space = paper.panel(_SPACE, *_SHEET, "in space: pull the end of the black ray")
    _draw_space(space, there, seen, dashes, d, end)
    return Drawing(paper.join((picture, space)), _sentence(d, end))


def _draw_picture(panel: Panel, there: Array, dashes: Array, end: Array) -> None:
    panel.polygons([_FRAME], _LIGHT)
    for dash in dashes:
        panel.line(dash, ESTIMATED, 1, dash=4)
    for far_and_near in there[np.argsort(-_STREWN[:, 2]), ::-1]:  # what is near stands before
        seen = _CAMERA.project(far_and_near)
        r = 800 * _RADIUS / far_and_near[:, 2]
        way = (seen[1] - seen[0]) / np.linalg.norm(seen[1] - seen[0]).clip(1e-9)
        aside = np.outer(r, [-way[1], way[0]])
        rim = [at + reach * circle(25) for at, reach in zip(seen, r, strict=True)]
        body = np.concatenate([seen + aside, (seen - aside)[::-1]])
        panel.polygons([rim[0], body, rim[1]], LENS)
        panel.polygons([seen[1] + 0.62 * r[1] * circle(25)], mixed(LENS, "#FFFFFF", 0.55))
    panel.mark(end, "estimated", 9)
    w, h = _CAMERA.size
    panel.grip("vanishing point", "the vanishing point", end.clip(16, [w - 17, h - 17]), 10)
    u, v = end.tolist()
    if 0 <= u < w and 0 <= v < h:
        left, above = u > 0.6 * w, v > 40
        beside = [u - 24 if left else u + 24, v - 22 if above else v + 26]
        panel.text(beside, "vanishing point", ESTIMATED, anchor="rm" if left else "lm", size=14)
    elif np.isfinite(u):  # an arrow at the border, to where it is
        at, arrow, anchor = (w - 24, "→", "rm") if u >= w else (24, "←", "lm")
        if 0 <= u < w:
            at, arrow, anchor = float(np.clip(u, 120, w - 120)), "↑" if v < 0 else "↓", "mm"
        row = float(np.clip(v, 16, h - 17)) + (-34 if v > h / 2 else 34)
        panel.text([at, row], f"{arrow} vanishing point", ESTIMATED, anchor=anchor, size=14)


def _draw_space(
    panel: Panel, there: Array, seen: Array, dashes: Array, d: Array, end: Array
) -> None:
    eye, tip = on_sheet(np.array([np.zeros(3), _RAY * d]))
    arc = on_sheet(_RAY * direction(np.arange(_LEFTMOST, 91), -np.degrees(np.arcsin(d[1]))))
    panel.line(arc, FAINT, 1.2)
    through = _GLASS / d[2] if d[2] else np.inf
    pierced = on_sheet(through * d) if through < _RAY else tip
    panel.line([pierced, tip], IDEAL, 2)
    near = on_sheet(there[_FOLLOWED]).reshape(-1, 2), _on_glass(seen[_FOLLOWED]).reshape(-1, 2)
    panel.segments(np.stack(near, axis=1), MUTED, 0.8)
    for i, ends in enumerate(on_sheet(there)):
        ink = WORLD if i in _FOLLOWED else mixed(WORLD, "#FFFFFF", 0.6)
        panel.line(ends, ink, 5)
        panel.polygons([at + 2.4 * panel.pixel * circle(17) for at in ends], ink)
    pane = _on_glass(_FRAME)
    panel.veil([pane], [_PANE])
    panel.line(pane[[0, 1, 2, 3, 0]], CAMERA, 1.2)
    for dash in _on_glass(dashes):
        panel.line(dash, ESTIMATED, 0.8, dash=3)
    panel.segments(_on_glass(seen), LENS, 2.2)
    panel.segments([[eye, at] for at in near[1]], MUTED, 0.8)
    panel.line([eye, pierced], IDEAL, 2)
    panel.mark(eye, "camera", 10, looks=(1, -0.2))
    if np.isfinite(end).all():
        panel.mark(_on_glass(end), "estimated", 8)
    panel.grip("ray", "the end of the ray, which turns the rods", tip, 4)
    panel.text(eye + [-0.1, 0.45], "eye", CAMERA, anchor="mm", size=14)
    panel.text(pane[0] + [0.3, -0.25], "glass = picture", CAMERA, anchor="rm", size=14)
    panel.text([_SHEET[0][0] + 0.2, 1.98], "black: parallel to the rods", IDEAL, size=14)


def _sentence(d: Array, end: Array) -> str:
    if d[2] == 0:
        return """The ray is parallel to the glass and pierces it nowhere: the pictures of the rods
        are parallel, too."""
    a, b = d[:2] / d[2]
    aside = f"{abs(a):.2f} to the {'right' if a >= 0 else 'left'}"
    up = f"{abs(b):.2f} {'up' if b <= 0 else 'down'}"
    w, h = _CAMERA.size
    inside = -0.5 <= end[0] <= w - 0.5 and -0.5 <= end[1] <= h - 0.5
    place = "" if inside else ", outside of the picture"
    return f"""The rods lead {aside} and {up} for 1 ahead. Their pictures, extended, meet at
    ({end[0]:.0f}, {end[1]:.0f}) px{place}."""
