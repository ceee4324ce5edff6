"""Where the camera stands."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, pose
from cvnotes.learn.cases.cameras import ABOUT_Y, some_pose
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property


def camera_centre(R: Array, T: Array) -> Array:
    """Give the camera's position in the world, (3,)."""
    return Camera(np.eye(3), pose(R, T)).centre


CENTRE = Exercise(
    name="camera_centre",
    chapter=3,
    title="Where the camera stands",
    task="Give the camera's centre in the world, shape (3,), from R and T.",
    stub='''def my_camera_centre(R, T):
    """Give the camera's centre (3,) in the WRF."""
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
    misconceptions=(
        Misconception(
            "T itself",
            "T is where the world's origin is seen from the camera, not where the camera stands. "
            "It is the most frequent confusion of all.",
            lambda R, T: T,
        ),
        Misconception(
            "minus T",
            "−T would be the position if the camera were not rotated; it is still in the "
            "camera's frame. Turn it into the world's.",
            lambda R, T: -T,
        ),
        Misconception(
            "sign lost",
            "The direction is right, the sign is not: R C = −T.",
            lambda R, T: R.T @ T,
        ),
        Misconception(
            "rotated the wrong way",
            "You used R where its inverse belongs: from R C = −T follows C = −Rᵀ T.",
            lambda R, T: -R @ T,
        ),
        Misconception(
            "rotated the wrong way, sign lost",
            "You gave R T: from R C + T = 0 follows C = −Rᵀ T.",
            lambda R, T: R @ T,
        ),
        Misconception(
            "divided entry by entry",
            "/ divides entry by entry; R C = −T is solved by the inverse of R, its transpose.",
            lambda R, T: -T / R,
            variants=(lambda R, T: T / R,),
        ),
        Misconception(
            "the camera's z axis",
            "That is the camera's z axis, seen in the world; its centre follows from T.",
            lambda R, T: R[2],
        ),
        Misconception(
            "T added to the centre",
            "You added T to the centre, or subtracted it: C = −Rᵀ T is all.",
            lambda R, T: -R.T @ T - T,
            variants=(lambda R, T: T - R.T @ T,),
        ),
        Misconception(
            "the origin",
            "(0, 0, 0) is the centre in the camera's own frame; asked is where it is in the world.",
            lambda R, T: np.zeros(3),
        ),
        Misconception(
            "the world's z axis",
            "R[:, 2] is the world's z axis, seen by the camera; its centre follows from T.",
            lambda R, T: R[:, 2],
        ),
        Misconception(
            "R * T",
            "* multiplies entry by entry; the product of a matrix and a vector is R.T @ T.",
            lambda R, T: -R.T * T,
            variants=(
                lambda R, T: -R * T,
                lambda R, T: R * T,
                lambda R, T: R.T * T,
            ),
        ),
    ),
    reference=camera_centre,
    concepts=("22", "24", "E11"),
    sources=(Camera.centre,),
)
