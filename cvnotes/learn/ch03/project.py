"""Project points."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, px_from_xy
from cvnotes.learn.cases.cameras import photographed
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _on_ray(m: Array, case: Case) -> bool:
    """Return whether each pixel's ray contains its point."""
    A, R, T, W = case.args
    rays = np.hstack([m, np.ones((len(m), 1))]) @ np.linalg.inv(A).T
    M = W @ R.T + T
    return np.allclose(rays * M[:, 2:], M, rtol=0, atol=1e-5 * np.abs(M).max())


def project(A: Array, R: Array, T: Array, W: Array) -> Array:
    """Return pixels (n, 2) of world points W (n, 3)."""
    M = W @ R.T + T  # the points in the camera's frame
    m_h = M @ A.T  # the homogeneous pixels
    w = m_h[:, 2:]  # what to divide by
    return m_h[:, :2] / w


MISTAKES = mistakes_in(project,
    ("no division", "You did not divide by the third coordinate: without that, nothing looks "
     "smaller when it is farther away.",
     (" / w", "")),
    ("T taken for the camera's position", "You used R and T as if they said where the camera "
     "stands. They lead from the world to it: T is where it sees the world's origin.",
     ("W @ R.T + T", "(W - T) @ R.T"), ("W @ R.T + T", "(W - T) @ R")),
    ("T with the wrong sign or in the wrong place", "Which way does T lead? It is added in the "
     "camera's frame: after the rotation, before there are pixels.",
     ("+ T", "- T"), ("W @ R.T + T", "(W + T) @ R.T"), (" + T", "", "M @ A.T", "M @ A.T + T")),
    ("divided by the world's Z",
     "You divided by the Z of the world; depth is the z of the camera's own frame.",
     ("/ w", "/ W[:, 2:]"), "M[:, :2] / W[:, 2:] * np.diag(A)[:2] + A[:2, 2]"),
    ("divided by another number", "You divided by something else than each point's own depth, the "
     "z of the camera's frame, once: not by the distance, for the picture is a plane.",
     *(("/ w", f"/ {other}") for other in (
         "T[2]", "M[:, :1]", "M[0, 2]", "M[:, 2].mean()", "w / M[:, 2:]",
         "np.linalg.norm(M, axis=1, keepdims=True)")),
     "m_h[:, 1:] / m_h[:, :1]"),
    ("pose left out",
     "You projected W as if it were given in the camera's frame; R and T take it there.",
     ("W @ R.T + T", "W")),
    ("principal point added before the division", "You added u0 and v0 before dividing by z: they "
     "belong to the pixel, so they are added at the end.",
     ("m_h[:, :2]", "(M[:, :2] @ A[:2, :2].T + A[:2, 2])")),
    ("focal lengths exchanged", "The focal lengths are exchanged: the first row of A is u's.",
     ("A.T", "A[[1, 0, 2]][:, [1, 0, 2]].T", "/ w", "/ w - A[[1, 0], 2] + A[:2, 2]"),
     ("M @ A.T",
      "M * [A[1, 1] / A[0, 0], A[0, 0] / A[1, 1], 1] @ (A * [[1, 0, 1], [1, 1, 1], [1, 1, 1]]).T")),
    ("mirrored", "Your picture is mirrored: x runs to the right, y downwards, in both frames.",
     ("M @ A.T", "M * [1, -1, 1] @ A.T"), ("M @ A.T", "M * [-1, -1, 1] @ A.T")),
)  # fmt: skip


EXERCISE = Exercise(
    name="project",
    chapter=3,
    title="Project points",
    task="Give the pixels (n, 2) at which a camera with A, R and T sees world points W (n, 3). "
    "All of them are in front of it.",
    hints=(
        "M = R W + T first. Points are rows here: W @ R.T + T.",
        "Then m̃ ≈ A M: three numbers a point.",
        "Divide the first two of them by the third.",
    ),
    cases=lambda rng: [Case(given) for given in photographed(rng)],
    properties=(
        Property("The ray through each pixel contains its point.", _on_ray),
        Property("Pixels are (u, v), rows as the points are."),
    ),
    misconceptions=MISTAKES,
    steps=project,
    concepts=("9", "11", "23", "25", "E4", "E10"),
    sources=(Camera.project, px_from_xy),
)
