"""Where the camera stands."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.learn.cases.cameras import ABOUT_Y, some_pose
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def camera_centre(R: Array, T: Array) -> Array:
    """Return the camera's centre (3,) in the WRF."""
    B = R.T  # the rotation back into the world
    return -B @ T


MISTAKES = mistakes_in(camera_centre,
    ("T itself", "T is where the world's origin is seen from the camera, not where the camera "
     "stands. To take one for the other is a common mistake.",
     "T"),
    ("rotated the wrong way",
     "R leads from the world to the camera; the way back needs its inverse, and a sign.",
     "-R @ T", "R @ T"),
    ("an axis for the centre", "That is an axis, of the camera or of the world, seen from the "
     "other; the centre follows from T.",
     "R[2]", "R[:, 2]"),
    ("T added to the centre",
     "You added T to the centre, or subtracted it; it has been used already.",
     "-R.T @ T - T", "T - R.T @ T"),
)  # fmt: skip


EXERCISE = Exercise(
    name="camera_centre",
    chapter=3,
    title="Where the camera stands",
    task="Give the camera's centre in the world, shape (3,), from R and T.",
    hints=(
        "In the camera's own frame its centre is (0, 0, 0).",
        "Solve R C + T = 0 for C.",
        "The inverse of a rotation is its transpose.",
    ),
    cases=lambda rng: [
        Case((ABOUT_Y, np.array([1.0, 2.0, 10.0]))),
        Case(some_pose(rng)),
    ],
    properties=(
        Property(
            "Seen from the camera, its centre is the origin: R C + T = 0.",
            lambda C, c: np.allclose(
                c.args[0] @ C, -c.args[1], atol=1e-5 * np.abs(c.args[1]).max()
            ),
        ),
    ),
    misconceptions=MISTAKES,
    steps=camera_centre,
    concepts=("22", "24", "E11"),
    sources=(Camera.centre,),
)
