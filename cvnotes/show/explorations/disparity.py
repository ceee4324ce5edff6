"""Explore the disparity: two similar triangles, and how the error of a depth grows with it."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, MUTED, mixed

_ALPHA, _BASE = 520.0, 200.0  # px, mm
_PLANE = 1100.0  # mm, where both pictures are drawn: a pixel is 1100/520 mm there
_X, _Z = (-400, 620), (5600, -520)  # mm that are shown, from above
_TIMES, _DEPTHS = 20, (1000, 2000, 4000)  # errors are drawn so many times larger, there
_LIGHT, _WARM, _GREY = "#D1EDE5", "#F3CDAE", "#E2E2E2"


def disparity_model() -> Model:
    """Make the model of two rectified cameras, from above, and a point that both see."""
    settings = (
        Setting("X", "X (mm)", 0, 440, 10, 330, "how far to the right of the left camera"),
        Setting("Z", "Z (mm)", 1500, 4500, 10, 4000, "how far away"),
        Setting("sigma", "σ of d (px)", 0.05, 0.3, 0.05, 0.25, "how well the disparity is known"),
    )
    about = """Two cameras from above that see one point, with the triangle over their base line and
    the similar one over the disparity. Beside it diamonds, in which a point may lie that is 1, 2 or
    4 m away: each is four times as long as the one before. Grey is 1 % of the depth."""

    return Model("disparity", about, settings, _draw, {"point": placed("X", "Z")})


def columns(X: float, Z: float) -> tuple[float, float]:
    """Return u − u0 of a point in the left picture and in the right one, in px."""
    return _ALPHA * X / Z, _ALPHA * (X - _BASE) / Z


def triangulated(left: Array, right: Array) -> Array:
    """Return the points (n, 2), X and Z in mm, that are seen in columns u − u0, in px."""
    Z = _ALPHA * _BASE / (left - right)
    return np.stack([left * Z / _ALPHA, Z], axis=-1)


def _draw(paper: Paper, values: Values) -> Drawing:
    X, Z, sigma = values["X"], values["Z"], values["sigma"]
    left, right = columns(X, Z)
    title = "from above, depths seven times shorter: pull the point"
    panel = paper.panel((450, 390), _X, _Z, title)
    panel.polygons(np.array([[[0.0, 0], [_BASE, 0], [X, Z]]]), _LIGHT)
    tips = np.array([left, right]) * _PLANE / _ALPHA  # mm along the planes of the pictures
    panel.polygons(np.array([[[0.0, 0], [tips[1], _PLANE], [tips[0], _PLANE]]]), _WARM)
    panel.line([[0, 0], [tips[1], _PLANE]], ESTIMATED, 1.6, dash=5)
    for at, tip, name, side in ((0.0, tips[0], "left", -1), (_BASE, tips[1], "right", 1)):
        panel.line([[at, 0], [at, _PLANE]], MUTED, 1, dash=2)
        panel.line([[at - 200, _PLANE], [at + 190, _PLANE]], LENS, 2)
        panel.line([[at, 0], [X, Z]], IDEAL, 1.6)
        panel.mark([at, 0], "camera", 8)
        panel.mark([at + tip, _PLANE], "lens", 6)
        anchor = "lm" if side > 0 else "rm"
        panel.text([at + 20 * side, -230], f"{name} camera", CAMERA, anchor=anchor, size=12)
        row = _PLANE - 140 if 0 < at < X else _PLANE + 110  # not upon a ray
        panel.text([at + tip + 14 * side, row], f"u {name}", LENS, anchor=anchor, size=12)
    for row, ends, below in ((1370, tips[::-1], 150), (-150, np.array([0, _BASE]), -170)):
        panel.line([[ends[0], row], [ends[1], row]], IDEAL, 1.2)
        panel.segments([[[x, row - 45], [x, row + 45]] for x in ends], IDEAL, 1.2)
        name = "d" if row > 0 else f"b = {_BASE:.0f} mm"
        panel.text([ends.mean(), row + below], name, IDEAL, anchor="mm", size=13)
    for x, top, name in ((-350, _PLANE, f"α = {_ALPHA:.0f} px"), (560, Z, "Z")):
        panel.line(np.array([[x, 0.0], [x, top]]), IDEAL, 1.2)
        panel.segments([[[x - 14, z], [x + 14, z]] for z in (0.0, top)], IDEAL, 1.2)
        panel.text([x + 12, top / 2], name, IDEAL, size=13)
    panel.polygons([_diamond(X, Z, sigma)], ESTIMATED)
    panel.grip("point", "the point that both cameras see", [X, Z], 6, "world", 4)
    return Drawing(paper.join((panel, _diamonds(paper, Z, sigma))), _sentence(left, right, sigma))


def _diamond(X: float, Z: float, sigma: float) -> Array:
    """Return the corners of where a point may lie, whose columns may be off by σ/2 each."""
    left, right = columns(X, Z)
    by = sigma / 2 * np.array([[1, 1, -1, -1], [-1, 1, 1, -1]])
    return triangulated(left + by[0], right + by[1])


def _diamonds(paper: Paper, Z: float, sigma: float) -> Panel:
    """Draw where points between the cameras may lie, so many times larger, and 1 % of the depth."""
    middle, title = _BASE / 2, f"where it may lie, {_TIMES} times as large; grey: 1 %"
    panel = paper.panel((340, 390), (-130, 390), (5950, -520), title)
    panel.segments([[[x, 0], [middle, Z]] for x in (0, _BASE)], CAMERA, 1)
    depths = [*((z, MUTED) for z in _DEPTHS if abs(z - Z) > 700), (Z, ESTIMATED)]
    for z, ink in depths:
        far, near = z * (1 + _TIMES / 100), z * (1 - _TIMES / 100)
        ends = middle + 26 * np.array([-1, 1, 1, -1])
        panel.polygons([np.column_stack([ends, [far, far, near, near]])], _GREY)
        panel.text([-110, z], f"{z / 1000:g} m", ink, size=13)
        error = z**2 / (_ALPHA * _BASE) * sigma
        panel.text([_BASE + 30, z], f"± {error:.1f} mm", ink, size=13)
    for z, ink in depths:
        at = np.array([middle, z])
        pale = ESTIMATED if ink == ESTIMATED else mixed(ESTIMATED, "#FFFFFF", 0.45)
        panel.polygons([at + _TIMES * (_diamond(middle, z, sigma) - at)], pale)
    panel.mark(np.array([[0, 0], [_BASE, 0]]), "camera", 8)
    return panel


def _sentence(left: float, right: float, sigma: float) -> str:
    d = left - right
    near, far = (_ALPHA * _BASE / (d + by) for by in (sigma, -sigma))
    said = f"d = {d:.1f} px, so Z = α b / d = {_ALPHA * _BASE / d:.0f} mm."
    return f"{said} Were d wrong by {sigma:g} px, it would be {near:.0f} or {far:.0f} mm."
