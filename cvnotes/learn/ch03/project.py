"""Project points."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, pose, px_from_xy
from cvnotes.learn.cases.cameras import (
    ABOUT_Y,
    TIDY_A,
    TIDY_POINT,
    TIDY_T,
    points_in_front,
    some_intrinsics,
    some_pose,
    without_skew,
)
from cvnotes.learn.cases.slips import centre_divided_too
from cvnotes.projective import from_homogeneous
from cvnotes.tutor import edited
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def project(A: Array, R: Array, T: Array, W: Array) -> Array:
    """Project world points (n, 3) to pixels (n, 2)."""
    return Camera(A, pose(R, T)).project(W)


def _cameras(rng: Rng) -> list[Case]:
    cases = [Case((TIDY_A, ABOUT_Y, TIDY_T, TIDY_POINT))]
    for n in (4, 6):
        R, T = some_pose(rng)
        cases.append(Case((some_intrinsics(rng, skew=True), R, T, points_in_front(rng, R, T, n))))
    return cases


def _seen(M: Array, A: Array) -> Array:
    m_h = M @ A.T
    return m_h[:, :2] / m_h[:, 2:]


def _on_ray(m: Array, case: Case) -> bool:
    """Return whether each pixel's ray contains its point."""
    A, R, T, W = case.args
    rays = np.hstack([m, np.ones((len(m), 1))]) @ np.linalg.inv(A).T
    M = W @ R.T + T
    return np.allclose(rays * M[:, 2:], M, rtol=0, atol=1e-5 * np.abs(M).max())


def _steps(A: Array, R: Array, T: Array, W: Array) -> Any:
    M = W @ R.T + T  # the points in the camera's frame
    m_h = M @ A.T  # the homogeneous pixels
    w = m_h[:, 2:]  # what to divide by
    return m_h[:, :2] / w


MISTAKES = mistakes(
    ("no division",
     "You did not divide by the third coordinate: without that, nothing looks smaller when "
     "it is farther away.",
     lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2]),
    ("T taken for the camera's position",
     "You used R and T as if they said where the camera stands. They lead from the world to "
     "the camera: T is where the world's origin is seen from it.",
     lambda A, R, T, W: _seen((W - T) @ R.T, A), lambda A, R, T, W: _seen((W - T) @ R, A)),
    ("T subtracted", "T has the wrong sign: which way does it lead?",
     edited(_steps, "+ T", "- T")),
    ("T added in the wrong place",
     "T is added in the camera's frame: after the rotation, before there are pixels.",
     lambda A, R, T, W: _seen((W + T) @ R.T, A),
     lambda A, R, T, W: from_homogeneous.inside(W @ R.T @ A.T + T)),
    ("divided by the world's Z",
     "You divided by the Z of the world; depth is the z of the camera's own frame.",
     lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / W[:, 2:],
     lambda A, R, T, W: (W @ R.T + T)[:, :2] / W[:, 2:] * np.diag(A)[:2] + A[:2, 2]),
    ("divided by the distance",
     "You divided by the distance to the camera's centre; the picture is a plane, so it is "
     "the depth z that counts.",
     lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / np.linalg.norm(W @ R.T + T, axis=1,
         keepdims=True)),
    ("divided by another number",
     "You divided by something else than each point's own depth, the z of the camera's "
     "frame, once.",
     lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / T[2],
     lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / (W @ R.T + T)[:, :1],
     lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, 1:] / ((W @ R.T + T) @ A.T)[:, :1],
     lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / (W @ R.T + T)[0, 2],
     lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / (W @ R.T + T)[:, 2].mean(),
     lambda A, R, T, W: _seen(W @ R.T + T, A) / (W @ R.T + T)[:, 2:]),
    ("pose left out",
     "You projected W as if it were given in the camera's frame; R and T take it there.",
     lambda A, R, T, W: _seen(W, A)),
    ("principal point added before the division",
     "You added u0 and v0 before dividing by z: they belong to the pixel, so they are added "
     "at the end.",
     lambda A, R, T, W: centre_divided_too(A, W @ R.T + T)),
    ("focal lengths exchanged",
     "The two focal lengths are exchanged: the first row of A is that of u.",
     lambda A, R, T, W: _seen(W @ R.T + T, A[[1, 0, 2]][:, [1, 0, 2]]) - A[[1, 0], 2] + A[:2, 2],
     lambda A, R, T, W: _seen((W @ R.T + T) * [A[1, 1] / A[0, 0], A[0, 0] / A[1, 1], 1],
         without_skew(A))),
    ("mirrored",
     "Your picture is mirrored: x runs to the right and y downwards, in the camera's frame "
     "as in the picture.",
     lambda A, R, T, W: _seen((W @ R.T + T) * [1, -1, 1], A),
     lambda A, R, T, W: _seen((W @ R.T + T) * [-1, -1, 1], A)),
)  # fmt: skip


PROJECT = Exercise(
    name="project",
    chapter=3,
    title="Project points",
    task="Give the pixels (n, 2) at which a camera with A, R and T sees world points W (n, 3). "
    "All of them are in front of it.",
    stub='''def my_project(A, R, T, W):
    """Return pixels (n, 2) of world points W (n, 3)."""
    ...''',
    hints=(
        "M = R W + T first. Points are rows here: W @ R.T + T.",
        "Then m̃ ≈ A M: three numbers a point.",
        "Divide the first two of them by the third.",
    ),
    cases=_cameras,
    properties=(
        Property("The ray through each pixel contains its point.", _on_ray),
        Property("Pixels are (u, v), rows as the points are."),
    ),
    misconceptions=MISTAKES,
    reference=project,
    steps=_steps,
    concepts=("9", "11", "23", "25", "E4", "E10"),
    sources=(Camera.project, px_from_xy),
)
