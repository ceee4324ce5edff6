"""The four steps of image formation."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, pose, px_from_xy
from cvnotes.learn.cases.cameras import (
    ABOUT_Y,
    TIDY_A,
    TIDY_POINT,
    TIDY_T,
    lens_factor,
    points_in_front,
    some_intrinsics,
    some_lens,
    some_pose,
)
from cvnotes.tutor import edited
from cvnotes.tutor.checker.equality import close_to
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def form_image(A: Array, R: Array, T: Array, k: Array, W: Array) -> Array:
    """Return the pixels (n, 2) of world points (n, 3), through a lens with k (2,)."""
    return Camera(A, pose(R, T), Lens(tuple(k))).project(W)


def _photographs(rng: Rng) -> list[Case]:
    cases = [Case((TIDY_A, ABOUT_Y, TIDY_T, np.array([-0.2, 0.1]), TIDY_POINT))]
    for n in (4, 6):
        R, T = some_pose(rng)
        W = points_in_front(rng, R, T, n)
        cases.append(Case((some_intrinsics(rng, skew=True), R, T, some_lens(rng)[0], W)))
    return cases


def _pixels(A: Array, xy: Array) -> Array:
    return np.asarray(xy @ A[:2, :2].T + A[:2, 2])


def _ideal(R: Array, T: Array, W: Array) -> Array:
    M = W @ R.T + T
    return np.asarray(M[:, :2] / M[:, 2:])


def _lens_before_division(A: Array, R: Array, T: Array, k: Array, W: Array) -> Array:
    M = W @ R.T + T
    return _pixels(A, M[:, :2] * lens_factor(M[:, :2], k) / M[:, 2:])


def _lens_after_pixels(A: Array, R: Array, T: Array, k: Array, W: Array) -> Array:
    m = _pixels(A, _ideal(R, T, W))
    return m * lens_factor(m, k)


def _radius_in_pixels(A: Array, R: Array, T: Array, k: Array, W: Array) -> Array:
    xy = _ideal(R, T, W)
    offset = _pixels(A, xy) - A[:2, 2]
    return A[:2, 2] + offset * lens_factor(offset, k)


def _bent(R: Array, T: Array, k: Array, W: Array) -> Array:
    xy = _ideal(R, T, W)
    return xy * lens_factor(xy, k)


def _by_r(xy: Array, k: Array) -> Array:
    r = np.linalg.norm(xy, axis=1, keepdims=True)
    return np.asarray(xy * (1 + k[0] * r + k[1] * r**2))


def _on_sphere(M: Array, k: Array) -> Array:
    xy = M[:, :2] / np.linalg.norm(M, axis=1, keepdims=True)
    return np.asarray(xy * lens_factor(xy, k))


def _steps(A: Array, R: Array, T: Array, k: Array, W: Array) -> Any:
    M = W @ R.T + T  # the points in the camera's frame
    xy = M[:, :2] / M[:, 2:]  # the ideal points, in the plane z = 1
    r2 = (xy**2).sum(axis=1, keepdims=True)  # r²
    L = 1 + k[0] * r2 + k[1] * r2**2  # the radial factor L
    bent = L * xy  # the points as the lens bends them
    return bent @ A[:2, :2].T + A[:2, 2]


MISTAKES = mistakes(
    ("lens before the division",
     "You distorted before dividing by z: r is then in millimetres. The lens acts on x/z and"
     " y/z.",
     _lens_before_division),
    ("lens after the pixels",
     "You distorted the pixels themselves, about pixel (0, 0). The lens acts before the "
     "sensor.",
     _lens_after_pixels),
    ("radius in pixels",
     "You distorted about (u0, v0), which is right, but with r in pixels. k1 and k2 belong "
     "to the r of the plane z = 1.",
     _radius_in_pixels),
    ("the way back", "You undid the lens, as a correction does. Image formation distorts.",
     lambda A, R, T, k, W: _pixels(A, _ideal(R, T, W) / lens_factor(_ideal(R, T, W), k)),
     lambda A, R, T, k, W: _pixels(A, Lens(tuple(k)).undistort(_ideal(R, T, W)))),
    ("T taken for the camera's position",
     "You used R and T as if they said where the camera stands; they lead from the world to "
     "the camera.",
     lambda A, R, T, k, W: _pixels(A, _bent(R, -R @ T, k, W)),
     lambda A, R, T, k, W: _pixels(A, _bent(R.T, -R.T @ T, k, W))),
    ("T subtracted", "T has the wrong sign: which way does it lead?",
     edited(_steps, "+ T", "- T")),
    ("T added before the rotation", "T is added after the rotation, in the camera's frame.",
     lambda A, R, T, k, W: _pixels(A, _bent(R, R @ T, k, W))),
    ("pose left out",
     "You took W as if it were given in the camera's frame; R and T take it there.",
     lambda A, R, T, k, W: _pixels(A, _bent(np.eye(3), 0 * T, k, W))),
    ("no division",
     "The division by the depth is missing, or comes too late: the lens acts on ideal "
     "points.",
     lambda A, R, T, k, W: _pixels(A, (W @ R.T + T)[:, :2] * lens_factor((W @ R.T + T)[:, :2], k)),
     lambda A, R, T, k, W: _pixels(A, (W @ R.T + T)[:, :2])),
    ("divided by the distance",
     "You divided by the distance; depth is the z of the camera's frame.",
     lambda A, R, T, k, W: _pixels(A, _on_sphere(W @ R.T + T, k))),
    ("another radius",
     "That is not the radius of the lens: it takes r² of the ideal point, on the plane z = "
     "1.",
     lambda A, R, T, k, W: _pixels(A, _by_r(_ideal(R, T, W), k)),
     lambda A, R, T, k, W: _pixels(A, _ideal(R, T, W) * lens_factor(W[:, :2], k)),
     lambda A, R, T, k, W: _pixels(A, _ideal(R, T, W) * lens_factor((W @ R.T + T) / (W @ R.T +
         T)[:, 2:], k))),
    ("lens twice", "You applied the lens twice.",
     lambda A, R, T, k, W: _pixels(A, _bent(R, T, k, W) * lens_factor(_bent(R, T, k, W), k))),
)  # fmt: skip


FORM = Exercise(
    name="form_image",
    chapter=4,
    title="The four steps of image formation",
    task="Give the pixels (n, 2) of world points W (n, 3), through a lens with k = (k1, k2), for a "
    "camera with A, R and T. All points are in front of it.",
    stub='''def my_form_image(A, R, T, k, W):
    """Return the pixels (n, 2) of world points W (n, 3)."""
    ...''',
    hints=(
        "Four steps, in this order: into the camera's frame, divide by z, lens, sensor.",
        "The lens acts on x/z and y/z, before there are pixels.",
        "The last step is A (x', y', 1)ᵀ: u = α_u x' + u0, v = α_v y' + v0.",
    ),
    cases=_photographs,
    properties=(Property("Every point is where the four steps, in their order, put it."),),
    misconceptions=MISTAKES,
    reference=form_image,
    same=close_to(2e-7),  # a ten-thousandth of a pixel
    steps=_steps,
    concepts=("34", "35", "E13", "E16"),
    sources=(Camera.project, Lens.distort, px_from_xy),
)
