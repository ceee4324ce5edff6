"""Explore the cross-ratio: two poles and their vanishing point make a picture into a ruler."""

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics
from cvnotes.pictures import course, rails, render_scene
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, WORLD, mixed

_CAMERA = Camera(course.camera().A)
_LEFT, _TOP, _SIZE, _SHARP = 75, 152, (280, 210), 4  # px: what of the picture is shown, how finely
# m: the row of poles, of which two are known
_X, _GROUND, _UP, _FIRST, _GAP = -4.0, 1.95, -4.05, 15.0, 25.0
_FEET = _CAMERA.project([[_X, _GROUND, _FIRST + _GAP * i] for i in range(2)])
_END, _TOP_OF_FIRST = _CAMERA.A[:2, 2], _CAMERA.project([_X, _UP, _FIRST])
_CLICK, _FARTHEST = 0.3, 112.0  # px by which its row is missed; m that the plan shows
_LONGER = 4  # times as long as the ± is the bar that shows it


def ruler_model() -> Model:
    """Make the model of poles beside a railway, and of one that is pulled along their row."""
    low, high = float(_END[1]) + 2, float(np.floor(_FEET[0, 1]))
    about = """Poles beside a railway, and an orange pole that moves along their row; beside it the
    same from above, with what the picture alone says about the orange pole's distance."""
    settings = (
        Setting("row", "row of the foot (px)", low, high, 0.1, 258, "where its foot is clicked"),
    )

    @lru_cache(maxsize=1)
    def photograph() -> Drawn:
        """Photograph that part of the course's picture of the railway, in finer pixels."""
        (au, _, u0), (_, av, v0), _ = _SHARP * _CAMERA.A
        first = (_SHARP - 1) / 2  # the middle of the first pixel, in the fine ones
        A = intrinsics(au, av, u0 - _SHARP * _LEFT + first, v0 - _SHARP * _TOP + first)
        size = (_SHARP * _SIZE[0], _SHARP * _SIZE[1])
        return render_scene(rails(), Camera(A, size=size), samples=4)

    def draw(paper: Paper, values: Values) -> Drawing:
        part = (values["row"] - _FEET[0, 1]) / (_END[1] - _FEET[0, 1])  # of the way to the end
        foot = _FEET[0] + part * (_END - _FEET[0])
        clicked = foot[1] + _CLICK * np.array([0, 1, -1])
        t, near, far = behind_the_first(clicked).tolist()
        title = "the picture: pull the orange pole by its foot"
        panel = paper.picture_panel((440, 330), _SIZE, title, (_LEFT, _TOP))
        panel.image(photograph())
        panel.line([_FEET[0], _END], IDEAL, 1, dash=4)
        panel.line([foot, _TOP_OF_FIRST + part * (_END - _TOP_OF_FIRST)], ESTIMATED, 3)
        panel.mark(_FEET, "lens", 8)
        for at, name in zip(_FEET, "ab", strict=True):
            panel.text(at + [-7, 8], name, LENS, anchor="mm", size=14)
        panel.text(_END + [-8, -9], "∞", IDEAL, anchor="mm", size=14)
        panel.mark(_END, "ideal", 9)
        panel.mark(foot, "estimated", 9)
        panel.text(foot + [11, 10], "c", ESTIMATED, anchor="mm", size=14)
        panel.grip("foot", "the foot of the orange pole", foot, 4)
        title = f"from above (m), stretched across; bar: {_LONGER} × ±"
        plan = paper.panel((310, 330), (-8.5, 2.7), (_FARTHEST, -12), title)
        _draw_plan(plan, t, near, far)
        return Drawing(paper.join((panel, plan)), _sentence(foot, t, far - near))

    def pulled(_: Values, at: Array) -> Values:
        part = (at[0] - _FEET[0, 0]) / (_END[0] - _FEET[0, 0])
        return {"row": float(_FEET[0, 1] + part * (_END - _FEET[0])[1])}

    return Model("ruler", about, settings, draw, {"foot": pulled})


def behind_the_first(row: npt.ArrayLike) -> Array:
    """Say how many metres behind pole a the ground is that the row's line shows in row v.

    From the picture alone: with the vanishing point as d the cross-ratio (a, b; c, d) is an
    ordinary ratio on the ground, r = t / (t − 25).
    """
    a, b, c, d = _FEET[0, 1], _FEET[1, 1], np.asarray(row, dtype=float), _END[1]
    # t = 25 r / (r − 1), multiplied out: it holds at b, too, where r is infinite.
    return np.asarray(_GAP * (c - a) * (d - b) / ((c - a) * (d - b) - (c - b) * (d - a)))


def _draw_plan(panel: Panel, t: float, near: float, far: float) -> None:
    for (left, right), colour in (((-9, 9), "#E6EFDF"), ((-2.3, 2.3), "#DCD8D2")):
        panel.polygons([[[left, -20], [right, -20], [right, 120], [left, 120]]], colour)
    panel.ticks(y=(0, 25, 50, 75, 100))
    for x in (-0.75, 0.75):
        panel.line([[x, -20], [x, 120]], MUTED, 1.5)
    ends = t + _LONGER * (np.array([near, far]) - t)
    low, high = ends.clip(-99, 199).tolist()
    bar = np.array([[-0.28, low], [0.28, low], [0.28, high], [-0.28, high]]) + [_X, 0]
    panel.polygons([bar], mixed("#FFFFFF", ESTIMATED, 0.4))
    row = [[_X, _GAP * i] for i in range(5)]
    panel.mark(row, "world", 7)
    for at, name in zip(row[:2], "ab", strict=True):
        panel.text([at[0] + 0.6, at[1]], name, WORLD, anchor="mm", size=13)
    panel.mark([_X, t], "estimated", 9)
    said = f"c  {t:.1f} m" if t < _FARTHEST - 4 else f"↑  c  {t:.0f} m"
    panel.text([_X - 0.6, min(t, _FARTHEST - 5)], said, ESTIMATED, anchor="rm", size=13)


def _sentence(foot: Array, t: float, width: float) -> str:
    b, c, end = np.linalg.norm([_FEET[1], foot, _END] - _FEET[0], axis=1).round(1).tolist()
    ratio = c * (end - b) / ((c - b) * end) if c != b else np.inf
    off = f"{width / 2:.1f}" if width > 0.1 else f"{width / 2:.2f}"
    where = f"The foot in row {foot[1]:.1f} stands {t:.1f} ± {off} m behind a"
    where += ", beyond the plan" if t > _FARTHEST else ""
    dashed = f"Along the dashed line, from a: b {b:.1f}, c {c:.1f}, ∞ {end:.1f} px"
    if abs(ratio) > 999:
        return f"{where}. {dashed}; at b the ratio (a, b; c, ∞) is infinite."
    return f"{where}. {dashed}; so (a, b; c, ∞) = {round(ratio, 2) + 0.0:.2f}."
