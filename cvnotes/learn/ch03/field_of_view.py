"""How much the camera sees."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import some_intrinsics
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _off_centre(rng: np.random.Generator) -> list[Case]:
    by_hand = np.array([[500.0, 0, 399.5], [0, 600, 240], [0, 0, 1]])
    return [Case((by_hand, 1000)), Case((some_intrinsics(rng), 640))]


def field_of_view(A: Array, width: int) -> float:
    """Return the horizontal field of view in radians."""
    left = A[0, 2] + 0.5  # the pixels from the left border to the principal point
    right = width - 0.5 - A[0, 2]  # the pixels from there to the right border
    a = np.arctan(left / A[0, 0])  # the angle to the left
    b = np.arctan(right / A[0, 0])  # the angle to the right
    return a + b


MISTAKES = mistakes_in(field_of_view,
    ("principal point in the middle", "That holds if the principal point is in the middle; in "
     "general it is not. Take the two sides one by one.",
     "2 * np.arctan(width / 2 / A[0, 0])", "2 * np.arctan((width - 1) / 2 / A[0, 0])"),
    ("one angle for two", "That is one angle: half of the field of view, or that of a side as "
     "wide as the picture. There is a left and a right one, each from the axis to its border.",
     "np.arctan(width / 2 / A[0, 0])", "np.arctan(width / A[0, 0])",
     "2 * np.arctan(width / A[0, 0])"),
    ("borders at whole pixels", "Nearly: a border is off. Whole numbers are pixel centres, and the "
     "picture ends half a pixel outside of the first and the last.",
     *(("+ 0.5", left, "width - 0.5", right) for left, right in (
         ("", "width - 1"), ("", "width"), ("- 0.5", "width - 1.5"), ("- 0.5", "width + 0.5"),
         ("", "width - 0.5"), ("+ 0.5", "width"), ("+ 0.5", "width - 1"),
         ("+ 0.5", "width + 0.5")))),
    ("tangents for angles", "Side and focal length give the tangent of the angle: that, or another "
     "function, is not the angle yet.",
     "width / A[0, 0]", ("np.arctan", "np.arcsin"), ("np.arctan", "np.tan")),
    ("in degrees",
     "That is in degrees, and not exact: asked are radians, of the two sides one by one.",
     "np.degrees(2 * np.arctan(width / 2 / A[0, 0]))",
     ("+ 0.5", "", "- 0.5", "", "np.degrees(a + b)"),
     ("+ 0.5", "", "- 0.5", "- 1", "np.degrees(a + b)")),
    ("focal length in the numerator", "You turned the fraction around.",
     ("left / A[0, 0]", "A[0, 0] / left", "right / A[0, 0]", "A[0, 0] / right"),
     "2 * np.arctan(2 * A[0, 0] / width)"),
    ("twice one side", "You took one side twice; the principal point is not in the middle.",
     "2 * a", "2 * b", "2 * np.arctan(A[0, 2] / A[0, 0])"),
)  # fmt: skip


EXERCISE = Exercise(
    name="field_of_view",
    chapter=3,
    title="How much the camera sees",
    task="Give the angle in radians between the rays through the left and the right border of a "
    "picture of given width, at the height of the principal point. Integers are pixel centres, so "
    "the borders are u = −½ and u = width − ½; the principal point need not be in the middle.",
    hints=(
        "Draw the triangle of centre, principal point and border: its sides are α_u and pixels.",
        "Two such triangles, one to the left and one to the right, with two different angles.",
        "Each is arctan(pixels / α_u).",
    ),
    cases=_off_centre,
    properties=(
        Property("It is the angle between the two rays, wherever the principal point is."),
    ),
    misconceptions=MISTAKES,
    steps=field_of_view,
    concepts=("18", "20", "E7", "E45"),
)
