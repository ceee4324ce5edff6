"""A cropped and a smaller picture."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import some_intrinsics
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _crops(rng: np.random.Generator) -> list[Case]:
    by_hand = np.array([[800.0, 2, 329.5], [0, 840, 239.5], [0, 0, 1]])
    corner = rng.integers(20, 200, 2).astype(float)
    return [
        Case((by_hand, np.array([100.0, 40.0]), 0.5)),
        Case((some_intrinsics(rng, skew=True), corner, 0.25)),
        Case((some_intrinsics(rng, skew=True), corner[::-1], 3.0)),
    ]


def _borders_stay(answer: Array, case: Case) -> bool:
    """Return whether the cut's upper left border, u = left − ½, is seen at −½ as before."""
    A, corner, _ = case.args
    ray = np.linalg.solve(A, [*(corner - 0.5), 1.0])
    m = answer @ ray
    return bool(np.allclose(m[:2] / m[2], -0.5, rtol=0, atol=1e-5 * case.slack))


def new_intrinsics(A: Array, corner: Array, s: float) -> Array:
    """Return A (3, 3) after cropping at corner (2,), then scaling by s."""
    c = A[:2, 2] - corner  # the principal point of the cropped picture
    u0, v0 = s * (c + 0.5) - 0.5  # the principal point, scaled about the picture's border
    f = s * A[:2, :2]  # the focal lengths and the skew, scaled
    return np.array([[f[0, 0], f[0, 1], u0], [0, f[1, 1], v0], [0, 0, 1]])


MISTAKES = mistakes_in(new_intrinsics,
    ("half a pixel forgotten", "Half a pixel is missing, or has the wrong sign: pixel centres are "
     "integers before and after, and it is the border that stays where it is.",
     *(("(c + 0.5) - 0.5", other)
       for other in ("c", "(c - 0.5) + 0.5", "(c + 0.5)", "c - 0.5", "c + 0.5"))),
    ("skew not scaled", "The skew is in pixels of u, as α_u is: it is scaled as α_u is.",
     ("f[0, 1]", "A[0, 1]"), ("f[0, 1]", "s * f[0, 1]")),
    ("crop after scaling", "You scaled first. The corner is a pixel of the old picture, so it is "
     "subtracted before, and scaled along.",
     ("A[:2, 2] - corner", "A[:2, 2]", "(c + 0.5) - 0.5", "(c + 0.5) - 0.5 - corner"),
     ("A[:2, 2] - corner", "A[:2, 2]", "(c + 0.5) - 0.5", "(c + 0.5) - 0.5 + corner"),
     ("A[:2, 2] - corner", "A[:2, 2]", "(c + 0.5) - 0.5", "c - corner")),
    ("principal point not scaled", "The focal lengths are right. The principal point moves too: by "
     "the crop, then as a whole by the scaling.",
     *(("s * (c + 0.5) - 0.5", other) for other in ("A[:2, 2]", "c", "A[:2, 2] - s * corner"))),
    ("divided by s", "You divided by s in one place: all lengths in pixels are multiplied by it.",
     ("s * A[:2, :2]", "A[:2, :2] / s"), ("s * (c + 0.5)", "(c + 0.5) / s")),
    ("nothing changed", "You gave A as it was: the crop and the scaling both change it.",
     "A"),
)  # fmt: skip


EXERCISE = Exercise(
    name="new_intrinsics",
    chapter=3,
    title="A of a cropped and scaled picture",
    task="A picture is cropped: its pixel corner = (left, top) becomes pixel (0, 0). Then what is "
    "left is scaled by a factor s in both directions, as cv2.resize does. Pixel centres are "
    "integers before and after. Give the new A (3, 3). A may have a skew.",
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
    steps=new_intrinsics,
    concepts=("18", "19", "21", "i", "E45"),
)
