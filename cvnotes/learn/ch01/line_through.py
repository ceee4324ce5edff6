"""The line through two points."""

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.projective import join, to_homogeneous
from cvnotes.tutor.checker.equality import up_to_scale
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def line_through(p: Array, q: Array) -> Array:
    """Return the line (3,) through two points (2,): l with l·x̃ = 0 for all its points."""
    return join(to_homogeneous(p), to_homogeneous(q))


def _two_points(rng: Rng) -> list[Case]:
    p, q = rounded(rng.uniform(0, 640, (2, 2)), 1)
    return [
        Case((np.array([1.0, 2.0]), np.array([3.0, 5.0]))),
        Case((p, q)),
        Case((np.array([4.0, 1.0]), np.array([4.0, 7.0])), about="vertical"),
    ]


def _slope_form(p: Array, q: Array, sign: float = -1.0) -> Array | None:
    if p[0] == q[0]:
        return None
    m = (q[1] - p[1]) / (q[0] - p[0])
    return np.array([m, -1.0, -sign * (p[1] - m * p[0])])


def _slope_and_intercept(p: Array, q: Array) -> Array | None:
    if p[0] == q[0]:
        return None
    m = (q[1] - p[1]) / (q[0] - p[0])
    return np.array([m, p[1] - m * p[0]])


def _swapped(x: Array | None) -> Array | None:
    return None if x is None else x[::-1]


def _with_constant(p: Array, q: Array, part: list[int]) -> Array:
    line = line_through(p, q)
    line[2] = -line[:2] @ (p * part)
    return line


def _through(p: Array, q: Array, line: Array) -> bool:
    """Return whether a line that is none of the zero vector contains both points."""
    far = np.abs(to_homogeneous([p, q])) @ np.abs(line)
    return bool((np.abs(to_homogeneous([p, q]) @ line) <= 1e-6 * far).all() and line.any())


def _steps(p: Array, q: Array) -> Any:
    x, y, w = np.array([p[0], p[1], 1.0])
    s, t, z = np.array([q[0], q[1], 1.0])
    a = y * z - w * t  # a of the line
    b = w * s - x * z  # b of the line
    c = x * t - y * s  # c of the line
    return np.array([a, b, c])


MISTAKES = mistakes(
    ("lifted with 0",
     "You lifted the points with 0, as directions: their line is the line at infinity. "
     "Points get a 1.",
     lambda p, q: np.cross([*p, 0], [*q, 0])),
    ("upright lines left out", "Right where the line has a slope. An upright line has none.",
     _slope_form),
    ("sign of the constant",
     "The direction is right but the constant has the wrong sign: bring all terms to one "
     "side.",
     lambda p, q: _slope_form(p, q, sign=1.0)),
    ("direction taken for the normal", "(a, b) is perpendicular to the line, not along it.",
     lambda p, q: np.array([*q - p, -(q - p) @ p]),
     lambda p, q: np.array([*q - p, line_through(p, q)[2]])),
    ("difference of the points",
     "The difference of the lifted points is the direction of the line, their sum a point "
     "between: neither is the line.",
     lambda p, q: np.array([*q - p, 0.0]), lambda p, q: np.array([*p + q, 2.0])),
    ("entry by entry",
     "You multiplied entry by entry; another product is perpendicular to both.",
     lambda p, q: np.array([*p * q, 1.0])),
    ("constant left out",
     "Your line has the right direction, but c is missing, or one of its two parts.",
     lambda p, q: line_through(p, q) * [1, 1, 0], lambda p, q: _with_constant(p, q, [1, 0]),
     lambda p, q: _with_constant(p, q, [0, 1])),
    ("slope and intercept",
     "That is slope and intercept, which no upright line has. Asked are the three numbers of"
     " the line.",
     _slope_and_intercept, lambda p, q: _swapped(_slope_and_intercept(p, q))),
)  # fmt: skip


LINE = Exercise(
    name="line_through",
    chapter=1,
    title="The line through two points",
    task="Give the line l = (a, b, c), of any scale, through two pixels p and q, shape (2,) each: "
    "a x + b y + c = 0 for both, l·x̃ = 0 in short.",
    stub='''def my_line_through(p, q):
    """Return the line (3,) through the points p and q, (2,) each."""
    ...''',
    hints=(
        "l is perpendicular to both homogeneous points, as vectors of three numbers.",
        "Which product of two vectors is perpendicular to both of them?",
        "Lift both points first: p̃ = (x, y, 1). Then np.cross.",
    ),
    cases=_two_points,
    properties=(
        Property(
            "Both points lie on the line.", lambda line, c: _through(c.args[0], c.args[1], line)
        ),
        Property(
            "That is so for upright lines too.",
            lambda line, c: _through(c.args[0], c.args[1], line),
            about="vertical",
        ),
    ),
    misconceptions=MISTAKES,
    reference=line_through,
    steps=_steps,
    same=up_to_scale,
    concepts=("2", "12"),
    sources=(line_through, join),
)
