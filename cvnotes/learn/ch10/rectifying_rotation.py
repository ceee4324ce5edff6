"""Two cameras side by side."""

# A mistake is often an argument that was left out.

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded, some_rotation
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x))


def _stereo_pairs(rng: np.random.Generator) -> list[Case]:
    R = some_rotation(rng)
    left = rounded(rng.uniform(-50, 50, 3), 1)
    right = rounded(left + R.T @ [100.0, *rng.uniform(-8, 8, 2)], 1)
    return [Case((np.eye(3), np.zeros(3), np.array([3.0, 0.0, 4.0]))), Case((R, left, right))]


def rectifying_rotation(R: Array, left: Array, right: Array) -> Array:
    """Return the common rotation (3, 3), CRF ← WRF; left and right are centres (3,)."""
    b = right - left  # the baseline
    x = b / np.linalg.norm(b)  # the x axis
    across = np.cross(R[2], x)  # the direction of the y axis
    y = across / np.linalg.norm(across)  # the y axis
    z = np.cross(x, y)  # the z axis
    return np.array([x, y, z])


_MISTAKES = mistakes_in(rectifying_rotation,
    ("z axis kept", "The old z axis need not be perpendicular to the baseline.",
     ("np.cross(x, y)", "R[2]")),
    ("old z axis in front", "You kept z, and moved x for it: x has to lie along the baseline.",
     "np.array([np.cross(y, R[2]), y, R[2]])"),
    ("old y axis", "You kept y as it was, or as near as it can be to the old one: it must be "
     "perpendicular to the baseline, and asked is the nearest z.",
     ("np.cross(R[2], x)", "R[1] - x * (R[1] @ x)"),
     ("np.cross(R[2], x)", "R[:, 1] - x * (R[:, 1] @ x)"), ("np.cross(R[2], x)", "R[1]"),
     ("np.cross(R[2], x)", "R[1]", "np.cross(x, y)", "R[2]")),
    ("y the wrong way round", "Your y axis points up; that of a camera points down.",
     ("np.cross(R[2], x)", "np.cross(x, R[2])")),
    ("nothing turned", "That is the left camera's R: its x need not lie along the baseline.",
     "R"),
    ("baseline turned too", "You turned the baseline into the camera's frame; the rows of the "
     "rotation are axes seen in the world.",
     ("b = right - left", "b = R @ (right - left)")),
    ("multiplied by R once more",
     "R is in it once too often: the rows of CRF ← WRF are axes seen in the world.",
     "np.array([x, y, z]) @ R", "R @ np.array([x, y, z])", "R.T @ np.array([x, y, z])",
     "np.array([x, y, z]) @ R.T", "R @ np.array([x, y, z]).T"),
)  # fmt: skip


EXERCISE = Exercise(
    name="rectifying_rotation",
    chapter=10,
    title="Two cameras side by side",
    task="To rectify a stereo pair both cameras are turned to one rotation, CRF ← WRF, whose x "
    "axis leads from the left camera's centre to the right one's; its z axis is as near as that "
    "allows to the left camera's. Give it (3, 3) from the left camera's R and the two centres.",
    hints=(
        "The rows of a rotation CRF ← WRF are the camera's axes, seen in the world.",
        "First row: the unit vector from left to right. The old z axis is R[2].",
        "y = z_old × x, scaled to length 1: it points down, as y does in every camera's frame. "
        "Then z = x × y.",
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
    steps=rectifying_rotation,
    concepts=("70", "j"),
)
