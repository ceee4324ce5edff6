"""The sensor's matrix."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _sensors(rng: np.random.Generator) -> list[Case]:
    f, du, dv = np.round(rng.uniform([4, 0.003, 0.006], [12, 0.005, 0.009]), 4).tolist()
    u0, v0 = rounded(rng.uniform([300, 200], [340, 260]), 1).tolist()
    return [Case((8.0, 0.01, 0.02, 320.0, 240.0)), Case((f, du, dv, u0, v0))]


def intrinsics_from_sensor(f: float, du: float, dv: float, u0: float, v0: float) -> Array:
    """Return A (3, 3); f, du and dv in mm, u0 and v0 in pixels."""
    a = f / du  # α_u, the focal length in pixel widths
    b = f / dv  # α_v, the focal length in pixel heights
    return np.array([[a, 0, u0], [0, b, v0], [0, 0, 1]])


MISTAKES = mistakes_in(intrinsics_from_sensor,
    ("principal point divided by the pixel size",
     "u0 and v0 are in pixels already; only lengths on the sensor are divided.",
     ("u0]", "u0 / du]", "v0]", "v0 / dv]"), ("u0]", "u0 * du]", "v0]", "v0 * dv]"),
     ("f / du", "f", "f / dv", "f", "u0]", "u0 * du]", "v0]", "v0 * dv]")),
    ("principal point left out",
     "u0 and v0 are missing, or have the wrong sign: where is the axis seen?",
     ("u0]", "0]", "v0]", "0]"), ("u0]", "-u0]", "v0]", "-v0]")),
    ("one pixel size for both",
     "You took one focal length for both directions; pixels need not be square.",
     ("f / du", "2 * f / (du + dv)", "f / dv", "2 * f / (du + dv)"),
     ("[a, 0", "[(a + b) / 2, 0", "[0, b", "[0, (a + b) / 2")),
    ("pixel sizes for focal lengths",
     "You have du and dv themselves in the place of the focal lengths.",
     ("f / du", "du", "f / dv", "dv")),
    ("in metres", "f and du are both in millimetres: their quotient needs no 1000.",
     ("f / d", "f / 1000 / d"), ("f / d", "1000 * f / d")),
)  # fmt: skip


EXERCISE = Exercise(
    name="intrinsics_from_sensor",
    chapter=3,
    title="The sensor's matrix",
    task="Give A (3, 3) of a camera with focal length f and pixels du wide and dv high, all in "
    "millimetres; its principal point (u0, v0) is in pixels. No skew.",
    hints=(
        "α_u is the focal length measured in pixel widths: how many of them fit into it?",
        "u0 and v0 are pixels already.",
        "A = [[α_u, 0, u0], [0, α_v, v0], [0, 0, 1]].",
    ),
    cases=_sensors,
    properties=(
        Property(
            "The optical axis, (0, 0, 1), is seen at (u0, v0).",
            lambda A, c: np.allclose(A @ [0, 0, 1], [c.args[3], c.args[4], 1], rtol=1e-6),
        ),
        Property("A point at 45° to the right is f/du pixels right of that, and so for v."),
    ),
    misconceptions=MISTAKES,
    steps=intrinsics_from_sensor,
    concepts=("17", "18", "19", "20", "E8"),
)
