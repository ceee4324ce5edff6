"""Two cameras side by side."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded, some_rotation
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes
from cvnotes.tutor.checker.steps import edited


def rectifying_rotation(R: Array, left: Array, right: Array) -> Array:
    """Return the rotation CRF ← WRF that both cameras of a pair are turned to."""
    x = _unit(right - left)
    y = _unit(np.cross(R[2], x))
    return np.array([x, y, np.cross(x, y)])


def _unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x))


def _stereo_pairs(rng: Rng) -> list[Case]:
    R = some_rotation(rng)
    left = rounded(rng.uniform(-50, 50, 3), 1)
    right = rounded(left + R.T @ [100.0, *rng.uniform(-8, 8, 2)], 1)
    return [Case((np.eye(3), np.zeros(3), np.array([3.0, 0.0, 4.0]))), Case((R, left, right))]


def _steps(R: Array, left: Array, right: Array) -> Any:
    b = right - left  # the baseline
    x = b / np.linalg.norm(b)  # the x axis
    across = np.cross(R[2], x)  # the direction of the y axis
    y = across / np.linalg.norm(across)  # the y axis
    z = np.cross(x, y)  # the z axis
    return np.array([x, y, z])


_MISTAKES = mistakes(
    ("z axis kept", "You kept the old z axis, which need not be perpendicular to the baseline: "
     "that is no rotation.",
     edited(_steps, "np.cross(x, y)", "R[2]")),
    ("old z axis in front", "You kept z and made x perpendicular to it: x has to lie along the "
     "baseline.",
     lambda R, left, right: np.array([np.cross(_y(R, left, right), R[2]), _y(R, left, right),
                                      R[2]])),
    ("old y axis", "You kept y as near as it can be to the old one; asked is that of z.",
     edited(_steps, "across = np.cross(R[2], x)", "across = R[1] - x * (R[1] @ x)"),
     edited(_steps, "across = np.cross(R[2], x)", "across = R[:, 1] - x * (R[:, 1] @ x)")),
    ("y not perpendicular", "You kept the old y axis as it is: it need not be perpendicular to the "
     "baseline.",
     edited(_steps, "across = np.cross(R[2], x)", "across = R[1]"),
     edited(_steps, "across = np.cross(R[2], x)", "across = R[1]", "np.cross(x, y)", "R[2]")),
    ("y the wrong way round", "Your y axis points up; that of a camera points down.",
     edited(_steps, "np.cross(R[2], x)", "np.cross(x, R[2])")),
    ("left-handed", "Your z axis points backwards: that is a reflection, no rotation.",
     edited(_steps, "np.cross(x, y)", "np.cross(y, x)")),
    ("nothing turned", "That is the left camera's own rotation; its x axis need not lie along the "
     "baseline.",
     lambda R, left, right: R),
    ("a column of R for its row", "R[:, 2] is the world's z axis, seen by the camera: where does R "
     "have the camera's own axes?",
     edited(_steps, "R[2]", "R[:, 2]")),
    ("baseline turned too", "You turned the baseline into the camera's frame; the rows of the "
     "rotation are axes seen in the world.",
     edited(_steps, "b = right - left", "b = R @ (right - left)")),
    ("multiplied by R once more", "The rows are axes in the world already: that is the rotation.",
     lambda R, left, right: rectifying_rotation(R, left, right) @ R,
     lambda R, left, right: R @ rectifying_rotation(R, left, right),
     lambda R, left, right: R.T @ rectifying_rotation(R, left, right)),
    ("axes in the camera's frame", "Your axes are seen in the left camera's frame: that is by how "
     "much it is turned. CRF ← WRF needs them in the world.",
     lambda R, left, right: rectifying_rotation(R, left, right) @ R.T,
     lambda R, left, right: R @ rectifying_rotation(R, left, right).T),
)  # fmt: skip


def _y(R: Array, left: Array, right: Array) -> Array:
    return _unit(np.cross(R[2], right - left))


RECTIFY = Exercise(
    name="rectifying_rotation",
    chapter=8,
    title="Two cameras side by side",
    task="To rectify a stereo pair both cameras are turned to one rotation, CRF ← WRF, whose x "
    "axis leads from the left camera's centre to the right one's; its z axis is as near as that "
    "allows to the left camera's. Give it (3, 3) from the left camera's R and the two centres.",
    stub='''def my_rectifying_rotation(R, left, right):
    """Return the common rotation (3, 3), CRF ← WRF; left and right are centres (3,)."""
    ...''',
    hints=(
        "The rows of a rotation CRF ← WRF are the camera's axes, seen in the world.",
        "First row: the unit vector from left to right. The old z axis is R[2].",
        "y = z_old × x, scaled to length 1: it points down, as y does in every camera's frame. "
        "Then "
        "z = x × y.",
    ),
    cases=_stereo_pairs,
    properties=(
        Property(
            "It is a rotation.",
            lambda R, _: np.allclose(R @ R.T, np.eye(3), atol=1e-5) and np.linalg.det(R) > 0,
        ),
        Property(
            "The right camera lies on the left one's x axis.",
            lambda R, c: np.allclose(
                R @ _unit(c.args[2] - c.args[1]), [1, 0, 0], rtol=0, atol=1e-5
            ),
        ),
        Property("It looks as nearly as it can where the left camera looked."),
    ),
    misconceptions=_MISTAKES,
    reference=rectifying_rotation,
    steps=_steps,
    concepts=("70", "j"),
)
