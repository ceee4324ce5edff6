"""Lift points to projective space."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.projective import to_homogeneous
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _points_and_factor(rng: np.random.Generator) -> list[Case]:
    by_hand = Case((np.array([[2.0, 3.0], [4.0, 5.0], [6.0, 8.0]]), 10.0))
    return [
        by_hand,
        Case((rounded(rng.uniform(-5, 5, (5, 3))), -0.5)),
        Case((rounded(rng.uniform(-5, 5, (4, 2))), 3.0)),
    ]


def lift(x: Array, w: float) -> Array:
    """Return homogeneous coordinates (n, d + 1) of points x (n, d), last coordinate w."""
    one = np.ones((len(x), 1))  # a column of ones
    x_h = np.hstack([x, one])  # the points with last coordinate 1
    return w * x_h


MISTAKES = mistakes_in(lift,
    ("w appended only", "You appended w, and the other coordinates are not multiplied by it. The "
     "factor multiplies all of them (the notes' first formula slips here).",
     "np.hstack([x, np.full((len(x), 1), w)])", "np.hstack([x / w, np.full((len(x), 1), w)])"),
    ("factor on the coordinates only", "The last coordinate takes the factor too: yours is 1.",
     "np.hstack([w * x, np.ones((len(x), 1))])", lambda x, w: to_homogeneous(x / w)),
    ("factor forgotten", "These are the right points, with the factor 1; asked is the member of "
     "the class whose last coordinate is w.",
     "np.hstack([x, np.ones((len(x), 1))])"),
    ("zero appended", "You appended 0: that makes a point at infinity, a direction. A point in a "
     "place has a last coordinate that is not 0.",
     "np.hstack([w * x, np.zeros((len(x), 1))])"),
    ("a row instead of a column", "You added a row: another point. Points are rows here, so a "
     "coordinate is a column: axis=1.",
     "np.vstack([w * x, np.full((1, x.shape[1]), w)])"),
    ("factor added", "You added w to the coordinates; a factor multiplies them.",
     lambda x, w: to_homogeneous(x) + w),
    ("factor twice", "You appended w first and then multiplied everything by w: the last "
     "coordinate has the factor twice now.",
     "w * np.hstack([x, np.full((len(x), 1), w)])"),
)  # fmt: skip


EXERCISE = Exercise(
    name="lift",
    chapter=1,
    title="Lift points to projective space",
    task="Each point has many homogeneous coordinates. Of points x, shape (n, d), give those that "
    "end in the number w, shape (n, d + 1).",
    hints=(
        "For w = 1 the point (x, y) becomes (x, y, 1).",
        "A class of coordinates differs by a factor that multiplies every one of them.",
        "np.hstack or np.concatenate(…, axis=1) joins columns; the new one has shape (n, 1).",
    ),
    cases=_points_and_factor,
    properties=(
        Property(
            "Dividing by the last coordinate gives the points back.",
            lambda x_h, case: np.allclose(x_h[:, :-1] / x_h[:, -1:], case.args[0], atol=1e-6),
        ),
        Property(
            "The last coordinate of every point is w.",
            lambda x_h, case: np.allclose(x_h[:, -1], case.args[1], atol=1e-6),
        ),
    ),
    misconceptions=MISTAKES,
    steps=lift,
    concepts=("2", "3", "4", "E1"),
)
