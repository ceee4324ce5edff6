"""Explore the disparity: two similar triangles, and how the error of a depth grows with it."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, MUTED

_ALPHA, _BASE = 520.0, 200.0  # px, mm
_PLANE = 1100.0  # mm, where both pictures are drawn: a pixel is 1100/520 mm there
_X, _Z = (-400, 620), (5600, -520)  # mm that are shown, from above
_LOWEST = 70.0  # mm: so high at least is the axis of the error
_LIGHT, _WARM = "#D1EDE5", "#F3CDAE"


def disparity_model() -> Model:
    """Make the model of two rectified cameras, from above, and a point that both see."""
    settings = (
        Setting("X", "X (mm)", 0, 440, 10, 330, "how far to the right of the left camera"),
        Setting("Z", "Z (mm)", 1500, 4500, 10, 4000, "how far away"),
        Setting("sigma", "σ of d (px)", 0, 1, 0.05, 0.25, "how well the disparity is known"),
    )
    about = (
        "Two cameras from above that see one point, with the triangle over their base line and the "
        "similar one over the disparity; around the point where it may lie, and beside it the "
        "standard deviation of its depth against the depth, and the line of 1 %."
    )

    def pulled(_: Values, at: Array) -> Values:
        return {"X": float(at[0]), "Z": float(at[1])}

    return Model("disparity", about, settings, _draw, {"point": pulled})


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
    panel = paper.panel(
        (450, 390), _X, _Z, "from above, depths seven times shorter: pull the point"
    )
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
    by = sigma / 2 * np.array([1, 1, -1, -1]), sigma / 2 * np.array([-1, 1, 1, -1])
    panel.polygons(triangulated(left + by[0], right + by[1])[None], ESTIMATED)
    panel.mark([X, Z], "world", 4)
    panel.grip("point", "the point that both cameras see", [X, Z], 6)
    return Drawing(paper.join((panel, _error(paper, Z, sigma))), _sentence(left, right, sigma))


def _error(paper: Paper, Z: float, sigma: float) -> Panel:
    """Draw the standard deviation of the depth against the depth."""
    depths = np.linspace(0, 5000, 41)
    curve = np.column_stack([depths, depths**2 / (_ALPHA * _BASE) * sigma])
    top = max(_LOWEST, 1.06 * float(curve[-1, 1]))
    panel = paper.panel((340, 390), (-400, 5600), (top, -0.1 * top), "σ of Z (mm) against Z (mm)")
    step = 20 if top < 2 * _LOWEST else 50
    panel.ticks(x=(1000, 2000, 3000, 4000), y=range(0, round(top), step), size=11)
    panel.line([[0, 0], [5000, 50]], MUTED, 1, dash=4)
    panel.text([5060, 50], "1 %", MUTED, anchor="lm", size=12)
    panel.line(curve, ESTIMATED, 2)
    here = [Z, Z**2 / (_ALPHA * _BASE) * sigma]
    panel.mark(here, "estimated", 8)
    side = 1 if here[1] < 0.01 * Z else -1  # not upon the line of 1 %
    at, anchor = [Z + 140 * side, here[1] - 0.05 * side * top], "lm" if side > 0 else "rm"
    panel.text(at, f"{here[1]:.0f} mm", ESTIMATED, anchor=anchor, size=13)
    return panel


def _sentence(left: float, right: float, sigma: float) -> str:
    d = left - right
    near, far = (_ALPHA * _BASE / (d + by) for by in (sigma, -sigma))
    said = f"d = {d:.1f} px, so Z = α b / d = {_ALPHA * _BASE / d:.0f} mm."
    if not sigma:
        return said
    return f"{said} Were d wrong by {sigma:g} px, it would be {near:.0f} or {far:.0f} mm."
