"""The line through two points."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import incident, rounded
from cvnotes.projective import to_homogeneous
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import up_to_scale


def _two_points(rng: np.random.Generator) -> list[Case]:
    p, q = rounded(rng.uniform(0, 640, (2, 2)), 1)
    return [
        Case((np.array([1.0, 2.0]), np.array([3.0, 5.0]))),
        Case((p, q)),
        Case((np.array([4.0, 1.0]), np.array([4.0, 7.0])), about="vertical"),
    ]


def _through_both(line: Array, case: Case) -> bool:
    return incident(to_homogeneous(case.args), line, case.slack)


def line_through(p: Array, q: Array) -> Array:
    """Return the line (3,) through the points p and q, (2,) each."""
    x, y, w = np.array([p[0], p[1], 1.0])
    s, t, z = np.array([q[0], q[1], 1.0])
    a = y * z - w * t  # a of the line
    b = w * s - x * z  # b of the line
    c = x * t - y * s  # c of the line
    return np.array([a, b, c])


MISTAKES = mistakes_in(line_through,
    ("lifted with 0", "Lifted with 0 they are directions, on the line at infinity. Points get a 1.",
     "np.cross([*p, 0], [*q, 0])"),
    ("upright lines left out", "Right where the line has a slope. An upright line has none.",
     "None if x == s else np.array([(t - y) / (s - x), -1, y - (t - y) / (s - x) * x])"),
    ("sign of the constant", "The constant has the wrong sign: bring all terms to one side.",
     "None if x == s else np.array([(t - y) / (s - x), -1, (t - y) / (s - x) * x - y])"),
    ("direction taken for the normal", "(a, b) is perpendicular to the line, not along it.",
     "np.array([*q - p, -(q - p) @ p])", "np.array([*q - p, c])"),
    ("difference of the points", "The difference of the lifted points is the direction of the "
     "line, their sum a point between: neither is the line.",
     "np.array([*q - p, 0.0])", "np.array([*p + q, 2.0])"),
    ("entry by entry", "You multiplied entry by entry; another product is perpendicular to both.",
     "np.array([*p * q, 1.0])"),
    ("slope and intercept", "No upright line has a slope. Asked are the three numbers a, b, c.",
     "None if x == s else np.array([(t - y) / (s - x), y - (t - y) / (s - x) * x])",
     "None if x == s else np.array([y - (t - y) / (s - x) * x, (t - y) / (s - x)])"),
)  # fmt: skip


EXERCISE = Exercise(
    name="line_through",
    chapter=1,
    title="The line through two points",
    task="Give the line l = (a, b, c), of any scale, through two pixels p and q, shape (2,) each: "
    "a x + b y + c = 0 for both, l·x̃ = 0 in short.",
    hints=(
        "l is perpendicular to both homogeneous points, as vectors of three numbers.",
        "Which product of two vectors is perpendicular to both of them?",
        "Lift both points first: p̃ = (x, y, 1). Then np.cross.",
    ),
    cases=_two_points,
    properties=(
        Property("Both points lie on the line.", _through_both),
        Property("That is so for upright lines too.", _through_both, about="vertical"),
    ),
    misconceptions=MISTAKES,
    steps=line_through,
    same=up_to_scale,
    concepts=("2", "12"),
)
