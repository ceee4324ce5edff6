"""A cropped and a smaller picture."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import some_intrinsics
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def new_intrinsics(A: Array, corner: Array, s: float) -> Array:
    """Give A (3, 3) after cropping at a corner (2,), then scaling by s.

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
    """Give what is added to A to move its principal point."""
    return np.array([[0, 0, du], [0, 0, du if dv is None else dv], [0, 0, 0]])


def _scaled_first(A: Array, corner: Array, s: float) -> Array:
    return np.asarray(new_intrinsics(A, 0 * corner, s) - _only_centre(*corner))


def _all_scaled(A: Array, corner: Array, s: float) -> Array:
    return s * new_intrinsics(A, corner, 1.0)


def _borders_stay(answer: Array, case: Case) -> bool:
    """Tell whether the cut's upper left border, u = left − ½, is seen at −½ as before."""
    A, corner, _ = case.args
    ray = np.linalg.solve(A, [*(corner - 0.5), 1.0])
    m = answer @ ray
    return bool(np.allclose(m[:2] / m[2], -0.5, rtol=0, atol=1e-5 * case.slack))


NEW = Exercise(
    name="new_intrinsics",
    chapter=3,
    title="A of a cropped and scaled picture",
    task="A picture is cropped: its pixel corner = (left, top) becomes pixel (0, 0). Then what is "
    "left is scaled by a factor s in both directions, as cv2.resize does. Pixel centres are "
    "integers before and after. Give the new A (3, 3). A may have a skew.",
    stub='''def my_new_intrinsics(A, corner, s):
    """Give A (3, 3) after cropping at corner (2,), then scaling by s."""
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
    misconceptions=(
        Misconception(
            "half a pixel forgotten",
            "You multiplied u0 itself by s. Integers are pixel centres, so the border is at −½: "
            "u + ½ is what is scaled.",
            lambda A, corner, s: _changed(A, corner, s, shift=0.0),
        ),
        Misconception(
            "half a pixel the wrong way",
            "You scaled u − ½. The left border is at u = −½, so the distance from it is u + ½.",
            lambda A, corner, s: _changed(A, corner, s, shift=-0.5),
        ),
        Misconception(
            "half a pixel added only",
            "You added ½ before scaling and did not take it away again: pixel centres are "
            "integers in the new picture too.",
            lambda A, corner, s: _changed(A, corner, s) + _only_centre(0.5),
        ),
        Misconception(
            "skew not scaled",
            "The skew is in pixels of u, as α_u is: it is scaled too.",
            lambda A, corner, s: _changed(A, corner, s, skew=1.0),
        ),
        Misconception(
            "skew scaled twice",
            "The skew is scaled once, by the factor of u.",
            lambda A, corner, s: _changed(A, corner, s, skew=s * s),
        ),
        Misconception(
            "skew lost",
            "Cropping and scaling straighten no sensor: the skew A[0, 1] stays, scaled by s.",
            lambda A, corner, s: _changed(A, corner, s, skew=0.0),
        ),
        Misconception(
            "crop added",
            "You added the corner. The pixel (left, top) becomes (0, 0): it is subtracted.",
            lambda A, corner, s: _changed(A, -corner, s),
        ),
        Misconception(
            "row before column",
            "You subtracted top from u0 and left from v0; u runs along the columns.",
            lambda A, corner, s: _changed(A, corner[::-1], s),
        ),
        Misconception(
            "crop after scaling",
            "You scaled first. The corner is a pixel of the old picture, so it is subtracted "
            "before, and scaled along.",
            _scaled_first,
        ),
        Misconception(
            "scaling forgotten",
            "You cropped and did not scale: a picture with half as many pixels has half the focal "
            "length in pixels.",
            lambda A, corner, s: new_intrinsics(A, corner, 1.0),  # noqa: ARG005
        ),
        Misconception(
            "focal lengths kept",
            "The centre is right. Focal lengths are counted in pixels too, and these are now "
            "larger or smaller: α_u and α_v are scaled by s.",
            lambda A, corner, s: np.column_stack([A[:, :2], new_intrinsics(A, corner, s)[:, 2]]),
        ),
        Misconception(
            "the last 1 scaled too",
            "You multiplied the whole matrix by s. A factor of the whole matrix changes no pixel: "
            "only the first two rows are scaled.",
            _all_scaled,
        ),
        Misconception(
            "upside down",
            "You divided by s: a smaller picture, s < 1, has a smaller focal length in pixels.",
            lambda A, corner, s: new_intrinsics(A, corner, 1 / s),
        ),
        Misconception(
            "half a pixel subtracted only",
            "You subtracted ½ at the end and did not add it before scaling: u + ½ is what is "
            "scaled.",
            lambda A, corner, s: _changed(A, corner, s, shift=0.0) - _only_centre(0.5),
        ),
        Misconception(
            "half a pixel added at the end",
            "You added ½ at the end; it is added before scaling and subtracted after it.",
            lambda A, corner, s: _changed(A, corner, s, shift=0.0) + _only_centre(0.5),
        ),
        Misconception(
            "one direction only",
            "s scales both directions: α_v and v0 as well as α_u and u0.",
            lambda A, corner, s: np.vstack(
                [new_intrinsics(A, corner, s)[0], new_intrinsics(A, corner, 1.0)[1:]]
            ),
            variants=(
                lambda A, corner, s: np.vstack(
                    [new_intrinsics(A, corner, 1.0)[0], new_intrinsics(A, corner, s)[1:]]
                ),
            ),
        ),
        Misconception(
            "principal point kept",
            "The focal lengths are right. The principal point moves too: by the crop, then by the "
            "scaling.",
            lambda A, corner, s: np.column_stack([new_intrinsics(A, corner, s)[:, :2], A[:, 2]]),
        ),
        Misconception(
            "principal point not scaled",
            "The focal lengths are right, and the crop. What is left is scaled: the principal "
            "point too.",
            lambda A, corner, s: np.column_stack(
                [new_intrinsics(A, corner, s)[:, :2], new_intrinsics(A, corner, 1.0)[:, 2]]
            ),
        ),
        Misconception(
            "corner scaled only",
            "You scaled the corner, but not the principal point: u0 − left is scaled as a whole.",
            lambda A, corner, s: np.column_stack(
                [new_intrinsics(A, corner, s)[:, :2], A[:, 2] - [*(s * corner), 0]]
            ),
        ),
        Misconception(
            "nothing changed",
            "You gave A as it was: the crop and the scaling both change it.",
            lambda A, *_: A,
        ),
        Misconception(
            "corner added after scaling",
            "You scaled first, and added the corner: it is subtracted, before.",
            lambda A, corner, s: new_intrinsics(A, 0 * corner, s) + _only_centre(*corner),
        ),
        Misconception(
            "crop after scaling, half a pixel forgotten",
            "You scaled first, and u0 itself: the corner is a pixel of the old picture, "
            "subtracted before, and u + ½ is what is scaled.",
            lambda A, corner, s: _changed(A, 0 * corner, s, shift=0.0) - _only_centre(*corner),
        ),
        Misconception(
            "divided by s",
            "You divided by s in the focal lengths, or in the principal point: both are "
            "multiplied by s.",
            lambda A, corner, s: np.column_stack(
                [new_intrinsics(A, corner, 1 / s)[:, :2], new_intrinsics(A, corner, s)[:, 2]]
            ),
            variants=(
                lambda A, corner, s: np.column_stack(
                    [new_intrinsics(A, corner, s)[:, :2], new_intrinsics(A, corner, 1 / s)[:, 2]]
                ),
            ),
        ),
        Misconception(
            "skew lost, half a pixel forgotten",
            "You lost the skew A[0, 1], which is scaled by s, and scaled u0 itself: u + ½ is what "
            "is scaled.",
            lambda A, corner, s: _changed(A, corner, s, shift=0.0, skew=0.0),
        ),
    ),
    reference=new_intrinsics,
    concepts=("18", "19", "21", "i", "E45"),
)
