"""How much the camera sees."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import some_intrinsics
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def field_of_view(A: Array, width: int) -> float:
    """Return the horizontal angle in radians that a picture spans at the height of its axis."""
    alpha, u0 = A[0, 0], A[0, 2]
    left, right = -0.5, width - 0.5  # the borders; pixel centres are whole numbers
    return float(np.arctan((u0 - left) / alpha) + np.arctan((right - u0) / alpha))


def _off_centre(rng: Rng) -> list[Case]:
    by_hand = np.array([[500.0, 0, 399.5], [0, 600, 240], [0, 0, 1]])
    return [Case((by_hand, 1000)), Case((some_intrinsics(rng), 640))]


def _to_the_sides(A: Array, left: float, right: float, alpha: float | None = None) -> float:
    alpha = A[0, 0] if alpha is None else alpha
    return float(np.arctan((right - A[0, 2]) / alpha) + np.arctan((A[0, 2] - left) / alpha))


def _steps(A: Array, width: int) -> Any:
    left = A[0, 2] + 0.5  # the pixels from the left border to the principal point
    right = width - 0.5 - A[0, 2]  # the pixels from there to the right border
    a = np.arctan(left / A[0, 0])  # the angle to the left
    b = np.arctan(right / A[0, 0])  # the angle to the right
    return a + b


MISTAKES = mistakes(
    ("principal point in the middle",
     "That holds if the principal point is in the middle; in general it is not. Take the two"
     " sides one by one.",
     lambda A, width: 2 * np.arctan(width / 2 / A[0, 0]),
     lambda A, width: 2 * np.arctan((width - 1) / 2 / A[0, 0])),
    ("half of the angle", "That is half of the field of view: there is a left side too.",
     lambda A, width: np.arctan(width / 2 / A[0, 0])),
    ("the whole width for a side",
     "You took the whole width for one side; each side reaches from the axis to its border.",
     lambda A, width: np.arctan(width / A[0, 0]), lambda A, width: 2 * np.arctan(width / A[0, 0])),
    ("borders at whole pixels",
     "Nearly: a border is off. Whole numbers are pixel centres, and the picture ends half a "
     "pixel outside of the first and the last.",
     lambda A, width: _to_the_sides(A, 0, width - 1), lambda A, width: _to_the_sides(A, 0, width),
     lambda A, width: _to_the_sides(A, 0.5, width - 1.5),
     lambda A, width: _to_the_sides(A, 0.5, width + 0.5),
     lambda A, width: _to_the_sides(A, 0, width - 0.5),
     lambda A, width: _to_the_sides(A, -0.5, width),
     lambda A, width: _to_the_sides(A, -0.5, width - 1),
     lambda A, width: _to_the_sides(A, -0.5, width + 0.5)),
    ("tangents for angles",
     "Side and focal length give the tangent of the angle: that, or another function, is not"
     " the angle yet.",
     lambda A, width: width / A[0, 0],
     lambda A, width: np.arcsin((A[0, 2] + 0.5) / A[0, 0]) + np.arcsin((width - 0.5 - A[0, 2]) /
         A[0, 0]),
     lambda A, width: np.tan((A[0, 2] + 0.5) / A[0, 0]) + np.tan((width - 0.5 - A[0, 2]) / A[0,
         0])),
    ("in degrees",
     "That is in degrees, and not exact: asked are radians, of the two sides one by one.",
     lambda A, width: np.degrees(2 * np.arctan(width / 2 / A[0, 0])),
     lambda A, width: np.degrees(_to_the_sides(A, 0, width)),
     lambda A, width: np.degrees(_to_the_sides(A, 0, width - 1))),
    ("focal length in the numerator", "You turned the fraction around.",
     lambda A, width: np.arctan(A[0, 0] / (A[0, 2] + 0.5)) + np.arctan(A[0, 0] / (width - 0.5 -
         A[0, 2])), lambda A, width: 2 * np.arctan(2 * A[0, 0] / width),
     lambda A, width: 2 * np.arctan(A[0, 0] / (width / 2))),
    ("twice one side", "You took one side twice; the principal point is not in the middle.",
     lambda A, width: 2 * np.arctan((A[0, 2] + 0.5) / A[0, 0]),
     lambda A, width: 2 * np.arctan((width - 0.5 - A[0, 2]) / A[0, 0]),
     lambda A, width: 2 * np.arctan(A[0, 2] / A[0, 0])),
)  # fmt: skip


FIELD = Exercise(
    name="field_of_view",
    chapter=3,
    title="How much the camera sees",
    task="Give the angle in radians between the rays through the left and the right border of a "
    "picture of given width, at the height of the principal point. Integers are pixel centres, so "
    "the borders are u = −½ and u = width − ½; the principal point need not be in the middle.",
    stub='''def my_field_of_view(A, width):
    """Return the horizontal field of view in radians."""
    ...''',
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
    reference=field_of_view,
    steps=_steps,
    concepts=("18", "20", "E7", "E45"),
)
