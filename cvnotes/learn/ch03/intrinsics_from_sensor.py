"""The sensor's matrix."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import intrinsics
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def intrinsics_from_sensor(f: float, du: float, dv: float, u0: float, v0: float) -> Array:
    """Give A (3, 3) from focal length and pixel sizes in mm, principal point in pixels."""
    return intrinsics(f / du, f / dv, u0, v0)


def _sensors(rng: Rng) -> list[Case]:
    f, du, dv = np.round(rng.uniform([4, 0.003, 0.006], [12, 0.005, 0.009]), 4).tolist()
    u0, v0 = rounded(rng.uniform([300, 200], [340, 260]), 1).tolist()
    return [Case((8.0, 0.01, 0.02, 320.0, 240.0)), Case((f, du, dv, u0, v0))]


def _matrix(a: float, b: float, u0: float, v0: float) -> Array:
    return np.array([[a, 0, u0], [0, b, v0], [0, 0, 1]])


INTRINSICS = Exercise(
    name="intrinsics_from_sensor",
    chapter=3,
    title="The sensor's matrix",
    task="Give A (3, 3) of a camera with focal length f and pixels du wide and dv high, all in "
    "millimetres; its principal point (u0, v0) is in pixels. No skew.",
    stub='''def my_intrinsics_from_sensor(f, du, dv, u0, v0):
    """Give A (3, 3); f, du and dv in mm, u0 and v0 in pixels."""
    ...''',
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
    misconceptions=(
        Misconception(
            "multiplied by the pixel size",
            "You multiplied f by the pixel size. The unit tells: millimetres by millimetres per "
            "pixel give pixels only if one divides.",
            lambda f, du, dv, u0, v0: _matrix(f * du, f * dv, u0, v0),
        ),
        Misconception(
            "principal point divided by the pixel size",
            "u0 and v0 are in pixels already; only lengths on the sensor are divided.",
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, u0 / du, v0 / dv),
        ),
        Misconception(
            "principal point left out",
            "u0 and v0 are missing: the axis would be seen at pixel (0, 0). (The notes' formula "
            "for u loses them in its middle term too.)",
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, 0, 0),
        ),
        Misconception(
            "focal length left out",
            "1/du and 1/dv are k_u and k_v; α_u and α_v carry the focal length as well.",
            lambda f, du, dv, u0, v0: _matrix(1 / du, 1 / dv, u0, v0),
        ),
        Misconception(
            "transposed",
            "A is upper triangular: u0 and v0 stand in its last column.",
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, u0, v0).T,
        ),
        Misconception(
            "focal length in millimetres",
            "α_u and α_v are in pixels: divide f by the size of a pixel.",
            lambda f, du, dv, u0, v0: _matrix(f, f, u0, v0),
        ),
        Misconception(
            "last 1 left out",
            (
                "The last entry of A is 1: without it nothing has a third coordinate to be "
                "divided by."
            ),
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, u0, v0) * [[1], [1], [0]],
        ),
        Misconception(
            "upside down",
            "You have du / f: turn the fraction around, α_u = f / du.",
            lambda f, du, dv, u0, v0: _matrix(du / f, dv / f, u0, v0),
        ),
        Misconception(
            "sign of the principal point",
            "u0 and v0 are added to what the division gives: they stand in A with a plus.",
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, -u0, -v0),
        ),
        Misconception(
            "v upwards",
            "α_v has the wrong sign: rows count downwards, as y does in the camera's frame.",
            lambda f, du, dv, u0, v0: _matrix(f / du, -f / dv, u0, v0),
        ),
        Misconception(
            "one pixel size for both",
            "You took one focal length for both directions; pixels need not be square.",
            lambda f, du, dv, u0, v0: _matrix(2 * f / (du + dv), 2 * f / (du + dv), u0, v0),
            variants=(
                lambda f, du, dv, u0, v0: _matrix(
                    (f / du + f / dv) / 2, (f / du + f / dv) / 2, u0, v0
                ),
            ),
        ),
        Misconception(
            "principal point in millimetres",
            "u0 and v0 stay in pixels: A takes rays to pixels.",
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, u0 * du, v0 * dv),
            variants=(lambda f, du, dv, u0, v0: _matrix(f, f, u0 * du, v0 * dv),),
        ),
        Misconception(
            "in metres",
            "f and du are both in millimetres: their quotient needs no 1000.",
            lambda f, du, dv, u0, v0: _matrix(f / du / 1000, f / dv / 1000, u0, v0),
            variants=(lambda f, du, dv, u0, v0: _matrix(1000 * f / du, 1000 * f / dv, u0, v0),),
        ),
        Misconception(
            "a skew where none is",
            "There is no skew: A[0, 1] = 0.",
            lambda f, du, dv, u0, v0: (
                _matrix(f / du, f / dv, u0, v0) + [[0, 1, 0], [0, 0, 0], [0, 0, 0]]
            ),
        ),
        Misconception(
            "last column left out",
            "u0 and v0 stand in a third column: A is (3, 3).",
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, u0, v0)[:, :2],
        ),
        Misconception(
            "last row left out",
            "A is (3, 3): its last row is (0, 0, 1).",
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, u0, v0)[:2],
        ),
        Misconception(
            "pixel sizes for focal lengths",
            "You have du and dv themselves in the place of α_u and α_v: α_u = f / du.",
            lambda f, du, dv, u0, v0: _matrix(du, dv, u0, v0),
        ),
        Misconception(
            "f in the last entry",
            "The last entry of A is 1; f is in α_u and α_v already.",
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, u0, v0) + np.diag([0, 0, f - 1]),
        ),
        Misconception(
            "half a pixel",
            "u0 and v0 are given in pixels whose centres are whole numbers: nothing is added.",
            lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, u0 + 0.5, v0 + 0.5),
            variants=(lambda f, du, dv, u0, v0: _matrix(f / du, f / dv, u0 - 0.5, v0 - 0.5),),
        ),
    ),
    reference=intrinsics_from_sensor,
    concepts=("17", "18", "19", "20", "E8"),
    sources=(intrinsics_from_sensor, intrinsics),
)
