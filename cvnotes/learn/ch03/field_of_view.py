"""How much the camera sees."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import some_intrinsics
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def field_of_view(A: Array, width: int) -> float:
    """Give the horizontal angle in radians that a picture spans at the height of its axis."""
    alpha, u0 = A[0, 0], A[0, 2]
    left, right = -0.5, width - 0.5  # the borders; pixel centres are whole numbers
    return float(np.arctan((u0 - left) / alpha) + np.arctan((right - u0) / alpha))


def _off_centre(rng: Rng) -> list[Case]:
    by_hand = np.array([[500.0, 0, 399.5], [0, 600, 240], [0, 0, 1]])
    return [Case((by_hand, 1000)), Case((some_intrinsics(rng), 640))]


def _to_the_sides(A: Array, left: float, right: float, alpha: float | None = None) -> float:
    alpha = A[0, 0] if alpha is None else alpha
    return float(np.arctan((right - A[0, 2]) / alpha) + np.arctan((A[0, 2] - left) / alpha))


FIELD = Exercise(
    name="field_of_view",
    chapter=3,
    title="How much the camera sees",
    task="Give the angle in radians between the rays through the left and the right border of a "
    "picture of given width, at the height of the principal point. Integers are pixel centres, so "
    "the borders are u = −½ and u = width − ½; the principal point need not be in the middle.",
    stub='''def my_field_of_view(A, width):
    """Give the horizontal field of view in radians."""
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
    misconceptions=(
        Misconception(
            "principal point in the middle",
            "2 arctan(width / 2α_u) holds if the principal point is in the middle; in general it "
            "is not. Take the two sides one by one.",
            lambda A, width: 2 * np.arctan(width / 2 / A[0, 0]),
        ),
        Misconception(
            "half of the angle",
            "That is half of the field of view: there is a left side too.",
            lambda A, width: np.arctan(width / 2 / A[0, 0]),
        ),
        Misconception(
            "one triangle for both sides",
            "arctan(width / α_u) is the angle if the principal point were at the border.",
            lambda A, width: np.arctan(width / A[0, 0]),
        ),
        Misconception(
            "borders at whole pixels",
            "Nearly: the first and last pixels have their centres at 0 and width − 1, and reach "
            "half a pixel further.",
            lambda A, width: _to_the_sides(A, 0, width - 1),
        ),
        Misconception(
            "borders from 0 to width",
            "Nearly: you have the borders at 0 and width, as if whole numbers were the borders "
            "of pixels. Here they are their centres.",
            lambda A, width: _to_the_sides(A, 0, width),
        ),
        Misconception(
            "twice the whole width",
            "2 arctan(width / α_u) takes the whole width for each side.",
            lambda A, width: 2 * np.arctan(width / A[0, 0]),
        ),
        Misconception(
            "the right side only",
            "That is the angle from the axis to the right border; the left side is missing.",
            lambda A, width: np.arctan((width - 0.5 - A[0, 2]) / A[0, 0]),
        ),
        Misconception(
            "the left side only",
            "That is the angle from the axis to the left border; the right side is missing.",
            lambda A, width: np.arctan((A[0, 2] + 0.5) / A[0, 0]),
        ),
        Misconception(
            "tangents for angles",
            "You added the tangents; an angle is the arctan of its tangent.",
            lambda A, width: width / A[0, 0],
        ),
        Misconception(
            "sides subtracted",
            (
                "You subtracted the angle on the left from that on the right; both sides belong "
                "to the picture."
            ),
            lambda A, width: (
                np.arctan((width - 0.5 - A[0, 2]) / A[0, 0]) - np.arctan((A[0, 2] + 0.5) / A[0, 0])
            ),
        ),
        Misconception(
            "principal point in the middle, in degrees",
            (
                "In degrees, and with the principal point in the middle: asked are radians, and "
                "the two sides one by one."
            ),
            lambda A, width: np.degrees(2 * np.arctan(width / 2 / A[0, 0])),
        ),
        Misconception(
            "arcsin for arctan",
            "The side along the picture and the focal length enclose the right angle: arctan, not "
            "arcsin.",
            lambda A, width: (
                np.arcsin((A[0, 2] + 0.5) / A[0, 0]) + np.arcsin((width - 0.5 - A[0, 2]) / A[0, 0])
            ),
        ),
        Misconception(
            "tangent for arctan",
            "tan gives the tangent of an angle; asked is the angle: arctan.",
            lambda A, width: (
                np.tan((A[0, 2] + 0.5) / A[0, 0]) + np.tan((width - 0.5 - A[0, 2]) / A[0, 0])
            ),
        ),
        Misconception(
            "focal length in the numerator",
            "You turned the fraction around: arctan(pixels / α_u).",
            lambda A, width: (
                np.arctan(A[0, 0] / (A[0, 2] + 0.5)) + np.arctan(A[0, 0] / (width - 0.5 - A[0, 2]))
            ),
            variants=(
                lambda A, width: 2 * np.arctan(2 * A[0, 0] / width),
                lambda A, width: 2 * np.arctan(A[0, 0] / (width / 2)),
            ),
        ),
        Misconception(
            "half a pixel the wrong way",
            "The borders are half a pixel outside of the first and last pixel centres: −½ and "
            "width − ½.",
            lambda A, width: _to_the_sides(A, 0.5, width - 1.5),
            variants=(lambda A, width: _to_the_sides(A, 0.5, width + 0.5),),
        ),
        Misconception(
            "from 0 to the last pixel's border",
            "Nearly: one border is half a pixel off. They are u = −½ and u = width − ½.",
            lambda A, width: _to_the_sides(A, 0, width - 0.5),
            variants=(
                lambda A, width: _to_the_sides(A, -0.5, width),
                lambda A, width: _to_the_sides(A, -0.5, width - 1),
                lambda A, width: _to_the_sides(A, -0.5, width + 0.5),
            ),
        ),
        Misconception(
            "twice one side",
            "You took one side twice; the principal point is not in the middle.",
            lambda A, width: 2 * np.arctan((A[0, 2] + 0.5) / A[0, 0]),
            variants=(
                lambda A, width: 2 * np.arctan((width - 0.5 - A[0, 2]) / A[0, 0]),
                lambda A, width: 2 * np.arctan(A[0, 2] / A[0, 0]),
            ),
        ),
        Misconception(
            "the middle, half a pixel off",
            "The principal point need not be in the middle: take the two sides one by one.",
            lambda A, width: 2 * np.arctan((width - 1) / 2 / A[0, 0]),
        ),
        Misconception(
            "sides one by one, in degrees",
            "In degrees, and with borders at 0 and width: asked are radians, and −½ to width − ½.",
            lambda A, width: np.degrees(_to_the_sides(A, 0, width)),
            variants=(lambda A, width: np.degrees(_to_the_sides(A, 0, width - 1)),),
        ),
    ),
    reference=field_of_view,
    concepts=("18", "20", "E7", "E45"),
)
