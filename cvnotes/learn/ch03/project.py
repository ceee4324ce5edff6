"""Project points."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

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
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import from_homogeneous


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
    """Tell whether each pixel's ray contains its point."""
    A, R, T, W = case.args
    rays = np.hstack([m, np.ones((len(m), 1))]) @ np.linalg.inv(A).T
    M = W @ R.T + T
    return np.allclose(rays * M[:, 2:], M, rtol=0, atol=1e-5 * np.abs(M).max())


PROJECT = Exercise(
    name="project",
    chapter=3,
    title="Project points",
    task="Give the pixels (n, 2) at which a camera with A, R and T sees world points W (n, 3). "
    "All of them are in front of it.",
    stub='''def my_project(A, R, T, W):
    """Give pixels (n, 2) of world points W (n, 3)."""
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
    misconceptions=(
        Misconception(
            "no division",
            "You did not divide by the third coordinate: without that, nothing looks smaller "
            "when it is farther away.",
            lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2],
        ),
        Misconception(
            "T taken for the camera's position",
            "You used R (W − T), as if the camera stood at T. T is where the world's origin is "
            "seen from the camera: M = R W + T.",
            lambda A, R, T, W: _seen((W - T) @ R.T, A),
        ),
        Misconception(
            "T added before the rotation",
            "You added T before rotating: M = R W + T, not R (W + T).",
            lambda A, R, T, W: _seen((W + T) @ R.T, A),
        ),
        Misconception(
            "rotation transposed",
            "W @ R applies Rᵀ, the inverse rotation, to points that are rows. It takes W @ R.T.",
            lambda A, R, T, W: _seen(W @ R + T, A),
        ),
        Misconception(
            "u and v exchanged",
            "You gave (v, u), row before column; pixels are (u, v) here.",
            lambda A, R, T, W: _seen(W @ R.T + T, A)[:, ::-1],
        ),
        Misconception(
            "divided by the world's Z",
            "You divided by the Z of the world; depth is the z of the camera's own frame.",
            lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / W[:, 2:],
        ),
        Misconception(
            "divided by the distance",
            "You divided by the distance to the camera's centre; the picture is a plane, so it is "
            "the depth z that counts.",
            lambda A, R, T, W: (
                ((W @ R.T + T) @ A.T)[:, :2] / np.linalg.norm(W @ R.T + T, axis=1, keepdims=True)
            ),
        ),
        Misconception(
            "not in pixels",
            "These are x/z and y/z on the plane z = 1; A turns them into pixels.",
            lambda A, R, T, W: _seen(W @ R.T + T, np.eye(3)),
        ),
        Misconception(
            "pose left out",
            "You projected W as if it were given in the camera's frame; R and T take it there.",
            lambda A, R, T, W: _seen(W, A),
        ),
        Misconception(
            "A transposed",
            "M @ A applies Aᵀ to points that are rows: M @ A.T.",
            lambda A, R, T, W: _seen(W @ R.T + T, A.T),
        ),
        Misconception(
            "W @ A in place of A M",
            ("M @ A applies Aᵀ, and W @ R applies Rᵀ, to points that are rows: W @ R.T, M @ A.T."),
            lambda A, R, T, W: _seen(W @ R + T, A.T),
        ),
        Misconception(
            "T left out", "T is missing: M = R W + T.", lambda A, R, T, W: _seen(W @ R.T, A)
        ),
        Misconception(
            "T subtracted",
            "You subtracted T: M = R W + T.",
            lambda A, R, T, W: _seen(W @ R.T - T, A),
        ),
        Misconception(
            "principal point added before the division",
            (
                "You added u0 and v0 before dividing by z: they belong to the pixel, so they are "
                "added at the end."
            ),
            lambda A, R, T, W: centre_divided_too(A, W @ R.T + T),
        ),
        Misconception(
            "principal point left out",
            "u0 and v0 are missing: your pixels are measured from the principal point.",
            lambda A, R, T, W: _seen(W @ R.T + T, A) - A[:2, 2],
        ),
        Misconception(
            "focal lengths exchanged",
            "α_u = A[0, 0] goes with u, α_v = A[1, 1] with v.",
            lambda A, R, T, W: (
                _seen(W @ R.T + T, A[[1, 0, 2]][:, [1, 0, 2]]) - A[[1, 0], 2] + A[:2, 2]
            ),
            variants=(
                lambda A, R, T, W: _seen(
                    (W @ R.T + T) * [A[1, 1] / A[0, 0], A[0, 0] / A[1, 1], 1], without_skew(A)
                ),
            ),
        ),
        Misconception(
            "v counted upwards",
            "Your v runs upwards; rows count downwards, as y does.",
            lambda A, R, T, W: _seen((W @ R.T + T) * [1, -1, 1], A),
        ),
        Misconception(
            "R and T taken for the camera's own pose",
            "You used Rᵀ (W − T), as if R and T said how the camera stands in the world. They "
            "lead from the world to the camera: M = R W + T.",
            lambda A, R, T, W: _seen((W - T) @ R, A),
        ),
        Misconception(
            "T added after A",
            "You added T after A: T is in the camera's frame, so A (R W + T).",
            lambda A, R, T, W: from_homogeneous.inside(W @ R.T @ A.T + T),
        ),
        Misconception(
            "multiplied by the depth",
            "You multiplied by the third coordinate: divide by it.",
            lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] * (W @ R.T + T)[:, 2:],
        ),
        Misconception(
            "divided twice",
            "You divided by z twice: once is enough.",
            lambda A, R, T, W: _seen(W @ R.T + T, A) / (W @ R.T + T)[:, 2:],
        ),
        Misconception(
            "camera's coordinates",
            "These are the points in the camera's frame, M = R W + T: A and the division by z are "
            "missing.",
            lambda A, R, T, W: W @ R.T + T,
            variants=(lambda A, R, T, W: (W @ R.T + T)[:, :2],),
        ),
        Misconception(
            "mirrored",
            "Your picture stands on its head: x/z and y/z have the wrong sign.",
            lambda A, R, T, W: _seen((W @ R.T + T) * [-1, -1, 1], A),
        ),
        Misconception(
            "divided by T",
            "You divided by T_z: every point has a depth of its own.",
            lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / T[2],
        ),
        Misconception(
            "divided by the first coordinate",
            "You divided by the first coordinate: depth is the third.",
            lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / (W @ R.T + T)[:, :1],
            variants=(
                lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, 1:] / ((W @ R.T + T) @ A.T)[:, :1],
            ),
        ),
        Misconception(
            "one depth for all",
            "You divided all points by the depth of the first: each has its own.",
            lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / (W @ R.T + T)[0, 2],
            variants=(
                lambda A, R, T, W: ((W @ R.T + T) @ A.T)[:, :2] / (W @ R.T + T)[:, 2].mean(),
            ),
        ),
    ),
    reference=project,
    concepts=("9", "11", "23", "25", "E4", "E10"),
    sources=(Camera.project, px_from_xy),
)
