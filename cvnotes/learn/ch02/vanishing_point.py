"""Where a direction is seen."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, pose
from cvnotes.learn.cases.cameras import (
    ABOUT_Y,
    TIDY_A,
    rounded,
    some_intrinsics,
    some_rotation,
)
from cvnotes.learn.cases.slips import centre_divided_too
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import from_homogeneous


def vanishing_point(A: Array, R: Array, d: Array) -> Array:
    """Give the pixel (2,) where lines of world direction d (3,) end."""
    return Camera(A, pose(R, np.zeros(3))).vanishing_point(d)


def _directions(rng: Rng) -> list[Case]:
    A, R = some_intrinsics(rng, skew=True), some_rotation(rng)
    ahead = rounded(R.T @ [*rng.uniform(-0.5, 0.5, 2), 1.0])
    return [
        Case((TIDY_A, ABOUT_Y, np.array([1.0, 2.0, 3.0]))),
        Case((A, R, ahead)),
        Case((A, R, -0.5 * ahead), about="away"),
        Case((TIDY_A, ABOUT_Y, np.array([0.0, 1.0, 0.0])), about="parallel"),
    ]


def _seen(x_h: Array) -> Array:
    return from_homogeneous.inside(np.asarray(x_h, dtype=float))


def _only(condition: bool, value: Array) -> Array | None:
    return value if condition else None


VANISHING = Exercise(
    name="vanishing_point",
    chapter=2,
    title="Where a direction is seen",
    task="Give the pixel (2,) in which all lines of world direction d (3,) seem to end, for a "
    "camera with A and R. If there is no such pixel, give NaN twice.",
    stub='''def my_vanishing_point(A, R, d):
    """Give the vanishing point (2,) of the world direction d (3,); NaN if at infinity."""
    ...''',
    hints=(
        "A direction is the point at infinity [d; 0]: T drops out.",
        "m̃ ≈ A R d, then divide by the third coordinate.",
        "If that is 0, the lines are parallel to the image plane and stay parallel in the "
        "picture. A direction that points away has the same lines as the opposite one.",
    ),
    cases=_directions,
    properties=(
        Property("It is the pixel that far points of such a line approach."),
        Property("d and −d are the same lines, with the same vanishing point.", about="away"),
        Property("Lines parallel to the image plane have none: NaN.", about="parallel"),
    ),
    misconceptions=(
        Misconception(
            "rotation left out",
            "You used A d, as if d were given in the camera's frame. R takes it there.",
            lambda A, R, d: _seen(A @ d),
        ),
        Misconception(
            "rotation transposed",
            "You used Rᵀ, which leads from the camera to the world; d comes from the world.",
            lambda A, R, d: _seen(A @ R.T @ d),
        ),
        Misconception(
            "sensor left out",
            "That is where the direction meets the plane z = 1; A turns it into pixels.",
            lambda A, R, d: _seen(R @ d),
        ),
        Misconception(
            "no division",
            "You did not divide by the third coordinate.",
            lambda A, R, d: (A @ R @ d)[:2],
        ),
        Misconception(
            "principal point left out",
            "f a/c and f b/c are measured from the principal point; add u0 and v0.",
            lambda A, R, d: _seen(A @ R @ d) - A[:2, 2],
        ),
        Misconception(
            "divided by the world's Z",
            "You divided by the third coordinate of d in the world. Depth is the third coordinate "
            "in the camera's frame.",
            lambda A, R, d: (A @ R @ d)[:2] / d[2],
        ),
        Misconception(
            "divided by zero",
            "Right, except for lines parallel to the image plane, where you divided by 0. They "
            "meet at infinity in the picture too: NaN.",
            lambda A, R, d: _only(bool((R @ d)[2]), _seen(A @ R @ d)),
        ),
        Misconception(
            "directions that point away",
            "Right, except that you have no answer where d points away from the camera. A line "
            "has two ends, but d and −d share one vanishing point.",
            lambda A, R, d: _only(bool((R @ d)[2] >= 0), _seen(A @ R @ d)),
        ),
        Misconception(
            "A and R in the wrong order",
            "You applied A before R. The direction goes into the camera's frame first: A R d.",
            lambda A, R, d: _seen(R @ A @ d),
        ),
        Misconception(
            "A transposed",
            "You used Aᵀ: for a single column it is A @ (R @ d).",
            lambda A, R, d: _seen(A.T @ R @ d),
        ),
        Misconception(
            "divided by the absolute depth",
            (
                "You divided by |z|. The factor of a homogeneous point may be negative: d and −d "
                "end in one point."
            ),
            lambda A, R, d: (A @ R @ d)[:2] / np.abs((A @ R @ d)[2]),
        ),
        Misconception(
            "no NaN at infinity",
            (
                "Right, except for lines parallel to the image plane: you gave a pixel where "
                "there is none. The task asks for NaN."
            ),
            lambda A, R, d: _seen(A @ R @ d) if (R @ d)[2] else np.zeros(2),
            variants=(lambda A, R, d: _seen(A @ R @ d) if (R @ d)[2] else (A @ R @ d)[:2],),
        ),
        Misconception(
            "principal point added before the division",
            (
                "You added u0 and v0 before dividing by z: they belong to the pixel, so they are "
                "added at the end."
            ),
            lambda A, R, d: centre_divided_too(A, R @ d),
        ),
        Misconception(
            "everything transposed",
            "A and R are both transposed: for a single column it is A @ R @ d.",
            lambda A, R, d: _seen(A.T @ R.T @ d),
            variants=(lambda A, R, d: _seen(R.T @ A.T @ d),),
        ),
        Misconception(
            "A inverted",
            "You used A⁻¹, which leads from pixels to rays: m̃ ≈ A R d.",
            lambda A, R, d: _seen(np.linalg.inv(A) @ R @ d),
            variants=(lambda A, R, d: _seen(R.T @ np.linalg.inv(A) @ d),),
        ),
        Misconception(
            "nothing but d",
            "That is d itself, divided by its third coordinate: R and A are missing.",
            lambda A, R, d: _seen(d),
        ),
        Misconception(
            "x and y of the direction only",
            "You used the first two coordinates of the direction as they are: divide by the third.",
            lambda A, R, d: (R @ d)[:2] * A[[0, 1], [0, 1]] + A[:2, 2],
            variants=(lambda A, R, d: A[:2, :2] @ (R @ d)[:2] + A[:2, 2],),
        ),
        Misconception(
            "u and v exchanged",
            "You gave (v, u), row before column.",
            lambda A, R, d: _seen(A @ R @ d)[::-1],
        ),
        Misconception(
            "v counted upwards",
            "Your v runs upwards; rows count downwards, as y does.",
            lambda A, R, d: _seen(A @ np.diag([1, -1, 1]) @ R @ d),
        ),
        Misconception(
            "mirrored",
            "Your point is mirrored at the principal point: the sign of x/z and y/z is wrong.",
            lambda A, R, d: 2 * A[:2, 2] - _seen(A @ R @ d),
        ),
        Misconception(
            "principal point for infinity",
            "Right, except for lines parallel to the image plane: they do not end in the "
            "principal point. NaN is asked.",
            lambda A, R, d: _seen(A @ R @ d) if (R @ d)[2] else A[:2, 2],
        ),
    ),
    reference=vanishing_point,
    concepts=("5", "13", "14", "E5", "E6"),
    sources=(Camera.vanishing_point, from_homogeneous),
)
