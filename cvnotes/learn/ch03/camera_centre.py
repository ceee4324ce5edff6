"""Where the camera stands."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, pose
from cvnotes.learn.cases.cameras import ABOUT_Y, some_pose
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, mistakes


def camera_centre(R: Array, T: Array) -> Array:
    """Return the camera's position in the world, (3,)."""
    return Camera(np.eye(3), pose(R, T)).centre


def _steps(R: Array, T: Array) -> Any:
    B = R.T  # the rotation back into the world
    return -B @ T


MISTAKES = mistakes(
    ("T itself",
     "T is where the world's origin is seen from the camera, not where the camera stands. It"
     " is the most frequent confusion of all.",
     lambda R, T: T),
    ("minus T",
     "−T would be the position if the camera were not rotated; it is still in the camera's "
     "frame. Turn it into the world's.",
     lambda R, T: -T),
    ("rotated the wrong way",
     "R leads from the world to the camera; the way back needs its inverse, and a sign.",
     lambda R, T: -R @ T, lambda R, T: R @ T),
    ("an axis for the centre",
     "That is an axis, of the camera or of the world, seen from the other; the centre "
     "follows from T.",
     lambda R, T: R[2], lambda R, T: R[:, 2]),
    ("T added to the centre",
     "You added T to the centre, or subtracted it; it has been used already.",
     lambda R, T: -R.T @ T - T, lambda R, T: T - R.T @ T),
)  # fmt: skip


CENTRE = Exercise(
    name="camera_centre",
    chapter=3,
    title="Where the camera stands",
    task="Give the camera's centre in the world, shape (3,), from R and T.",
    stub='''def my_camera_centre(R, T):
    """Return the camera's centre (3,) in the WRF."""
    ...''',
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
    reference=camera_centre,
    steps=_steps,
    concepts=("22", "24", "E11"),
    sources=(Camera.centre,),
)
