"""Explore the way from a point to its pixel: a length on the sensor, and pixels counted in it."""

import numpy as np

from cvnotes.base import Array
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, MUTED, mixed

_SIZE = 400, 300  # px, of a panel
_ENLARGED = 20.0  # the sensor, from above; its distance f as well, so the ray meets it rightly
_CENTRE, _HALF = 325.0, 1.6  # px, the principal point; mm, the half of what is shown of a row


def pixels_model() -> Model:
    """Make the model of a point before a sensor whose row is counted in mm and in pixels."""
    settings = (
        Setting("x", "x (mm)", -45, 45, 1, 30, "how far the point is to the right of the axis"),
        Setting("z", "z (mm)", 200, 320, 5, 250, "its depth"),
        Setting("f", "f (mm)", 4, 8, 0.1, 4, "how far the sensor is from the hole"),
        Setting("du", "Δu (mm)", 0.004, 0.01, 0.001, 0.005, "how wide a pixel is"),
    )
    about = (
        "From above: the ray of a point to the hole, and where it meets the sensor, drawn before "
        "the hole. Beside it a row of the sensor, counted in mm above and in pixels below."
    )

    def point(_: Values, at: Array) -> Values:
        return {"x": float(at[0]), "z": float(at[1])}

    def sensor(_: Values, at: Array) -> Values:
        return {"f": float(at[1]) / _ENLARGED}

    return Model("pixels", about, settings, _draw, {"point": point, "sensor": sensor})


def _draw(paper: Paper, values: Values) -> Drawing:
    x, z, f, du = (values[name] for name in ("x", "z", "f", "du"))
    length = f * x / z
    title = f"from above; the sensor {_ENLARGED:.0f} times as large"
    plan = paper.panel(_SIZE, (-60, 60), (345, -25), title)
    _draw_plan(plan, np.array([x, z]), f, du)
    row = paper.panel(_SIZE, (-1.12 * _HALF, 1.12 * _HALF), (-1, 1), "a row of the sensor")
    _draw_row(row, length, du)
    said = (
        f"f · x/z = {f:g} · {x / z:.3f} = {length:.2f} mm; ÷ {du:.3f} mm = {length / du:.1f} px; "
        f"+ {_CENTRE:.0f} gives u = {length / du + _CENTRE:.1f}."
    )
    if abs(length) > _HALF:
        said += " That is beside the sensor, and not seen."
    return Drawing(paper.join((plan, row)), said)


def _draw_plan(panel: Panel, M: Array, f: float, du: float) -> None:
    """Draw the triangle of the point, and in it the similar one of the sensor."""
    (x, z), at = M, _ENLARGED * f
    hit, end = x * at / z, _ENLARGED * _HALF
    panel.polygons([np.array([[0, 0], [0, z], M])], mixed("#FFFFFF", ESTIMATED, 0.12))
    panel.polygons([np.array([[0, 0], [0, at], [hit, at]])], mixed("#FFFFFF", LENS, 0.25))
    panel.line([[0, -25], [0, 345]], MUTED, 0.9, dash=6)
    panel.line(np.array([[0, z], M]), ESTIMATED, 1.2, dash=4)
    panel.line(np.array([[0, 0], M]), ESTIMATED, 1.5)
    panel.line([[-end, at], [end, at]], CAMERA, 3)
    panel.line([[0, at], [hit, at]], LENS, 5)
    side = 1 if x >= 0 else -1
    panel.text([x / 2, z + 14], "x", ESTIMATED, anchor="mm", size=15)
    panel.text([-4 * side, z - 20], "z", ESTIMATED, anchor="mm", size=15)
    words, anchor = f"f = {f:g} mm = {f / du:.0f} Δu", "rm" if side > 0 else "lm"
    panel.text([-2 * side, at / 2], words, LENS, anchor=anchor, size=15)
    panel.text([hit / 2, at + 14], "f · x/z", LENS, anchor="mm", size=15)
    panel.text([-end, at + 22], "sensor", CAMERA, size=13)
    panel.text([4, -12], "hole", CAMERA, size=13)
    panel.mark([0, 0], "camera", 7)
    panel.mark(M, "estimated", 7)
    panel.grip("sensor", "the sensor, nearer to the hole or farther", [-end, at], 4)
    panel.grip("point", "the point, to be pulled", M, 6)


def _draw_row(panel: Panel, length: float, du: float) -> None:
    """Draw a row of the sensor with two scales, and on each the way to the image point."""
    panel.line([[-_HALF, 0], [_HALF, 0]], CAMERA, 4)
    for mm in np.arange(-1.5, 1.6, 0.5):
        panel.line([[mm, 0], [mm, -0.07]], MUTED, 1.2)
        panel.text([mm, -0.15], f"{mm:g}".replace("-", "−"), anchor="mm", size=13)
    first = 100 * np.ceil((_CENTRE - _HALF / du) / 100)
    for u in np.arange(first, _CENTRE + _HALF / du, 100):
        at = (u - _CENTRE) * du
        panel.line([[at, 0], [at, 0.07]], MUTED, 1.2)
        panel.text([at, 0.15], f"{u + 0.0:.0f}".replace("-", "−"), anchor="mm", size=13)
    panel.text([-_HALF, -0.28], "mm", anchor="lm", size=13)
    panel.text([-_HALF, 0.28], "px", anchor="lm", size=13)
    for end in (-1, 1):  # none through the numbers
        panel.segments([[[at, 0.24 * end], [at, 0.62 * end]] for at in (0, length)], MUTED, 0.8)
    for level, ink in ((-0.5, LENS), (0.42, IDEAL)):
        panel.arrows([0, level], [length, 0], ink, 2.5)
    middle = length / 2
    for level, words, ink in (
        (-0.72, f"{length:.2f} mm", LENS),
        (0.55, f"{length / du:.1f} px", IDEAL),
    ):
        panel.text([middle, level], words.replace("-", "−"), ink, anchor="mm", size=15)
    u0, u = f"u₀ = {_CENTRE:.0f}", f"u = {length / du + _CENTRE:.1f}"
    side = 1 if length >= 0 else -1
    panel.text([-0.04 * side, 0.74], u0, CAMERA, anchor="rm" if side > 0 else "lm", size=14)
    out = side if abs(length) < 1.1 else -side  # at the border it stands inside
    panel.text([length + 0.04 * out, 0.74], u, ESTIMATED, anchor="lm" if out > 0 else "rm", size=14)
    panel.mark([length, 0], "estimated", 8)
