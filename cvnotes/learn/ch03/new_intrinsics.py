"""A cropped and a smaller picture."""

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import some_intrinsics
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def new_intrinsics(A: Array, corner: Array, s: float) -> Array:
    """Return A (3, 3) after cropping at a corner (2,), then scaling by s.

    `Camera.cropped` and `Camera.resized` do the two steps one by one.
    """
    left, top = corner
    moved = np.array([[1, 0, -left], [0, 1, -top], [0, 0, 1]])
    scaled = np.array([[s, 0, (s - 1) / 2], [0, s, (s - 1) / 2], [0, 0, 1]])
    return np.asarray(scaled @ moved @ A)


def _crops(rng: Rng) -> list[Case]:
    by_hand = np.array([[800.0, 2, 329.5], [0, 840, 239.5], [0, 0, 1]])
    corner = rng.integers(20, 200, 2).astype(float)
    return [
        Case((by_hand, np.array([100.0, 40.0]), 0.5)),
        Case((some_intrinsics(rng, skew=True), corner, 0.25)),
        Case((some_intrinsics(rng, skew=True), corner[::-1], 3.0)),
    ]


def _changed(
    A: Array, corner: Array, s: float, *, shift: float = 0.5, skew: float | None = None
) -> Array:
    """Make the new A with another place for the border, or another factor for the skew."""
    skew = s if skew is None else skew
    u0, v0 = s * (A[:2, 2] - corner + shift) - shift
    return np.array([[s * A[0, 0], skew * A[0, 1], u0], [0, s * A[1, 1], v0], [0, 0, 1]])


def _only_centre(du: float, dv: float | None = None) -> Array:
    """Return what is added to A to move its principal point."""
    return np.array([[0, 0, du], [0, 0, du if dv is None else dv], [0, 0, 0]])


def _scaled_first(A: Array, corner: Array, s: float) -> Array:
    return np.asarray(new_intrinsics(A, 0 * corner, s) - _only_centre(*corner))


def _all_scaled(A: Array, corner: Array, s: float) -> Array:
    return s * new_intrinsics(A, corner, 1.0)


def _borders_stay(answer: Array, case: Case) -> bool:
    """Return whether the cut's upper left border, u = left − ½, is seen at −½ as before."""
    A, corner, _ = case.args
    ray = np.linalg.solve(A, [*(corner - 0.5), 1.0])
    m = answer @ ray
    return bool(np.allclose(m[:2] / m[2], -0.5, rtol=0, atol=1e-5 * case.slack))


def _steps(A: Array, corner: Array, s: float) -> Any:
    c = A[:2, 2] - corner  # the principal point of the cropped picture
    u0, v0 = s * (c + 0.5) - 0.5  # the principal point, scaled about the picture's border
    f = s * A[:2, :2]  # the focal lengths and the skew, scaled
    return np.array([[f[0, 0], f[0, 1], u0], [0, f[1, 1], v0], [0, 0, 1]])


MISTAKES = mistakes(
    ("half a pixel forgotten",
     "Half a pixel is missing, or has the wrong sign: pixel centres are integers before and "
     "after, and it is the border that stays where it is.",
     lambda A, corner, s: _changed(A, corner, s, shift=0.0),
     lambda A, corner, s: _changed(A, corner, s, shift=-0.5),
     lambda A, corner, s: _changed(A, corner, s) + _only_centre(0.5),
     lambda A, corner, s: _changed(A, corner, s, shift=0.0) - _only_centre(0.5),
     lambda A, corner, s: _changed(A, corner, s, shift=0.0) + _only_centre(0.5)),
    ("skew not scaled", "The skew is in pixels of u, as α_u is: it is scaled as α_u is.",
     lambda A, corner, s: _changed(A, corner, s, skew=1.0),
     lambda A, corner, s: _changed(A, corner, s, skew=s * s)),
    ("crop after scaling",
     "You scaled first. The corner is a pixel of the old picture, so it is subtracted "
     "before, and scaled along.",
     _scaled_first, lambda A, corner, s: new_intrinsics(A, 0 * corner, s) + _only_centre(*corner),
     lambda A, corner, s: _changed(A, 0 * corner, s, shift=0.0) - _only_centre(*corner)),
    ("principal point not scaled",
     "The focal lengths are right. The principal point moves too: by the crop, then as a "
     "whole by the scaling.",
     lambda A, corner, s: np.column_stack([new_intrinsics(A, corner, s)[:, :2], A[:, 2]]),
     lambda A, corner, s: np.column_stack([new_intrinsics(A, corner, s)[:, :2], new_intrinsics(A,
         corner, 1.0)[:, 2]]),
     lambda A, corner, s: np.column_stack([new_intrinsics(A, corner, s)[:, :2], A[:, 2] - [*s *
         corner, 0]])),
    ("the last 1 scaled too",
     "You multiplied the whole matrix by s. A factor of the whole matrix changes no pixel: "
     "only the first two rows are scaled.",
     _all_scaled),
    ("one direction only", "s scales both directions.",
     lambda A, corner, s: np.vstack([new_intrinsics(A, corner, s)[0], new_intrinsics(A, corner,
         1.0)[1:]]),
     lambda A, corner, s: np.vstack([new_intrinsics(A, corner, 1.0)[0], new_intrinsics(A, corner,
         s)[1:]])),
    ("divided by s",
     "You divided by s in one place: focal lengths and principal point grow and shrink "
     "together.",
     lambda A, corner, s: np.column_stack([new_intrinsics(A, corner, 1 / s)[:, :2],
         new_intrinsics(A, corner, s)[:, 2]]),
     lambda A, corner, s: np.column_stack([new_intrinsics(A, corner, s)[:, :2], new_intrinsics(A,
         corner, 1 / s)[:, 2]])),
    ("nothing changed", "You gave A as it was: the crop and the scaling both change it.",
     lambda A, *_: A),
)  # fmt: skip


NEW = Exercise(
    name="new_intrinsics",
    chapter=3,
    title="A of a cropped and scaled picture",
    task="A picture is cropped: its pixel corner = (left, top) becomes pixel (0, 0). Then what is "
    "left is scaled by a factor s in both directions, as cv2.resize does. Pixel centres are "
    "integers before and after. Give the new A (3, 3). A may have a skew.",
    stub='''def my_new_intrinsics(A, corner, s):
    """Return A (3, 3) after cropping at corner (2,), then scaling by s."""
    ...''',
    hints=(
        "Follow one pixel. Cropping: u becomes u − left. What does scaling make of that?",
        "The left border of the picture is at u = −½, and stays there: u + ½ is what is scaled.",
        "After the crop: u0 = s (u0 − left + ½) − ½. Row 1 of A is scaled by s, skew included.",
    ),
    cases=_crops,
    properties=(
        Property("The corner of the cut stays the corner of the picture, (−½, −½).", _borders_stay),
        Property("Every ray is seen where its pixel went."),
    ),
    misconceptions=MISTAKES,
    reference=new_intrinsics,
    steps=_steps,
    concepts=("18", "19", "21", "i", "E45"),
)
