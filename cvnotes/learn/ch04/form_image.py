"""The four steps of image formation."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

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
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def form_image(A: Array, R: Array, T: Array, k: Array, W: Array) -> Array:
    """Give the pixels (n, 2) of world points (n, 3), through a lens with k (2,)."""
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


FORM = Exercise(
    name="form_image",
    chapter=4,
    title="The four steps of image formation",
    task="Give the pixels (n, 2) of world points W (n, 3), through a lens with k = (k1, k2), for a "
    "camera with A, R and T. All points are in front of it.",
    stub='''def my_form_image(A, R, T, k, W):
    """Give the pixels (n, 2) of world points W (n, 3)."""
    ...''',
    hints=(
        "Four steps, in this order: into the camera's frame, divide by z, lens, sensor.",
        "The lens acts on x/z and y/z, before there are pixels.",
        "The last step is A (x', y', 1)ᵀ: u = α_u x' + u0, v = α_v y' + v0.",
    ),
    cases=_photographs,
    properties=(Property("Every point is where the four steps, in their order, put it."),),
    misconceptions=(
        Misconception(
            "lens left out",
            "These are the pixels of an ideal lens: the third step is missing.",
            lambda A, R, T, k, W: _pixels(A, _ideal(R, T, W)),
        ),
        Misconception(
            "lens before the division",
            "You distorted before dividing by z: r is then in millimetres. The lens acts on "
            "x/z and y/z.",
            _lens_before_division,
        ),
        Misconception(
            "lens after the pixels",
            "You distorted the pixels themselves, about pixel (0, 0). The lens acts before the "
            "sensor, on x/z and y/z.",
            _lens_after_pixels,
        ),
        Misconception(
            "radius in pixels",
            "You distorted about (u0, v0), which is right, but with r in pixels. k1 and k2 belong "
            "to the r of the plane z = 1.",
            _radius_in_pixels,
        ),
        Misconception(
            "the way back",
            "You divided by L. The lens multiplies: image formation distorts, correction "
            "undistorts.",
            lambda A, R, T, k, W: _pixels(A, _ideal(R, T, W) / lens_factor(_ideal(R, T, W), k)),
        ),
        Misconception(
            "T taken for the camera's position",
            "You used R (W − T), as if the camera stood at T: M = R W + T.",
            lambda A, R, T, k, W: _pixels(A, _bent(R, -R @ T, k, W)),
        ),
        Misconception(
            "no pixels yet",
            "These are x' and y' on the plane z = 1: the sensor's A is missing.",
            lambda A, R, T, k, W: _ideal(R, T, W) * lens_factor(_ideal(R, T, W), k),
        ),
        Misconception(
            "rotation transposed",
            "W @ R applies Rᵀ to points that are rows: W @ R.T.",
            lambda A, R, T, k, W: form_image(A, R.T, T, k, W),
        ),
        Misconception(
            "T subtracted",
            "You subtracted T: M = R W + T.",
            lambda A, R, T, k, W: _pixels(A, _bent(R, -T, k, W)),
        ),
        Misconception(
            "both coefficients with r²",
            "k2 belongs to r⁴, which is (r²)²; you used r² for both.",
            lambda A, R, T, k, W: form_image(A, R, T, np.array([k.sum(), 0]), W),
        ),
        Misconception(
            "u and v exchanged",
            "You gave (v, u), row before column; pixels are (u, v) here.",
            lambda A, R, T, k, W: form_image(A, R, T, k, W)[:, ::-1],
        ),
        Misconception(
            "principal point left out",
            "u0 and v0 are missing: your pixels are measured from the principal point.",
            lambda A, R, T, k, W: form_image(A, R, T, k, W) - A[:2, 2],
        ),
        Misconception(
            "pose left out",
            "You took W as if it were given in the camera's frame; R and T take it there.",
            lambda A, R, T, k, W: _pixels(A, _bent(np.eye(3), 0 * T, k, W)),
        ),
        Misconception(
            "no division",
            "You did not divide by z: the lens acts on x/z and y/z.",
            lambda A, R, T, k, W: _pixels(
                A, (W @ R.T + T)[:, :2] * lens_factor((W @ R.T + T)[:, :2], k)
            ),
            variants=(lambda A, R, T, k, W: _pixels(A, (W @ R.T + T)[:, :2]),),
        ),
        Misconception(
            "R and T taken for the camera's own pose",
            "You used Rᵀ (W − T), as if R and T said how the camera stands in the world: M = R W "
            "+ T.",
            lambda A, R, T, k, W: _pixels(A, _bent(R.T, -R.T @ T, k, W)),
        ),
        Misconception(
            "T added before the rotation",
            "You added T before rotating: M = R W + T, not R (W + T).",
            lambda A, R, T, k, W: _pixels(A, _bent(R, R @ T, k, W)),
        ),
        Misconception(
            "r for r²",
            "You used r and r² where L has r² and r⁴.",
            lambda A, R, T, k, W: _pixels(A, _by_r(_ideal(R, T, W), k)),
        ),
        Misconception(
            "undistorted",
            "You undid the lens, as a correction does. Image formation distorts: multiply by L.",
            lambda A, R, T, k, W: _pixels(A, Lens(tuple(k)).undistort(_ideal(R, T, W))),
        ),
        Misconception(
            "the 1 of L left out",
            "L starts with 1: without distortion nothing moves.",
            lambda A, R, T, k, W: _pixels(A, _bent(R, T, k, W) - _ideal(R, T, W)),
        ),
        Misconception(
            "lens of the world's coordinates",
            "You took r from the world's x and y; the lens acts in the camera, on x/z and y/z.",
            lambda A, R, T, k, W: _pixels(A, _ideal(R, T, W) * lens_factor(W[:, :2], k)),
        ),
        Misconception(
            "divided by the distance",
            "You divided by the distance; depth is the z of the camera's frame.",
            lambda A, R, T, k, W: _pixels(A, _on_sphere(W @ R.T + T, k)),
        ),
        Misconception(
            "radius of three coordinates",
            "r² = x² + y² on the plane z = 1; you added z² = 1 too.",
            lambda A, R, T, k, W: _pixels(
                A, _ideal(R, T, W) * lens_factor((W @ R.T + T) / (W @ R.T + T)[:, 2:], k)
            ),
        ),
        Misconception(
            "lens twice",
            "You applied the lens twice.",
            lambda A, R, T, k, W: _pixels(A, _bent(R, T, k, W) * lens_factor(_bent(R, T, k, W), k)),
        ),
    ),
    reference=form_image,
    concepts=("34", "35", "E13", "E16"),
    sources=(Camera.project, Lens.distort, px_from_xy),
)
