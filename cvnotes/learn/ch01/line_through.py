"""The line through two points."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.equality import up_to_scale
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import join, to_homogeneous


def line_through(p: Array, q: Array) -> Array:
    """Give the line (3,) through two points (2,): l with l·x̃ = 0 for all its points."""
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
    """Tell whether a line that is none of the zero vector contains both points."""
    far = np.abs(to_homogeneous([p, q])) @ np.abs(line)
    return bool((np.abs(to_homogeneous([p, q]) @ line) <= 1e-6 * far).all() and line.any())


LINE = Exercise(
    name="line_through",
    chapter=1,
    title="The line through two points",
    task="Give the line l = (a, b, c), of any scale, through two pixels p and q, shape (2,) each: "
    "a x + b y + c = 0 for both, l·x̃ = 0 in short.",
    stub='''def my_line_through(p, q):
    """Give the line (3,) through the points p and q, (2,) each."""
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
    misconceptions=(
        Misconception(
            "lifted with 0",
            "You lifted the points with 0, as directions: their line is the line at infinity. "
            "Points get a 1.",
            lambda p, q: np.cross([*p, 0], [*q, 0]),
        ),
        Misconception(
            "upright lines left out",
            "Right where the line has a slope. An upright line has none: y = m x + c cannot "
            "express it, the cross product of the lifted points can.",
            _slope_form,
        ),
        Misconception(
            "sign of the constant",
            "The direction is right but the constant has the wrong sign: from y = m x + c follows "
            "m x − y + c = 0.",
            lambda p, q: _slope_form(p, q, sign=1.0),
        ),
        Misconception(
            "direction taken for the normal",
            "(a, b) is perpendicular to the line, not along it: turn q − p by 90°.",
            lambda p, q: np.array([*(q - p), -(q - p) @ p]),
        ),
        Misconception(
            "difference of the points",
            "q̃ − p̃ is the point at infinity on the line, its direction, and not the line.",
            lambda p, q: np.array([*(q - p), 0.0]),
        ),
        Misconception(
            "x and y exchanged",
            "Your line goes through (y, x) of both points: a belongs to x, b to y.",
            lambda p, q: np.cross([*p[::-1], 1], [*q[::-1], 1]),
        ),
        Misconception(
            "sign of b",
            (
                "Your b has the wrong sign: the second entry of the cross product is q_x − p_x, "
                "if the first is p_y − q_y."
            ),
            lambda p, q: line_through(p, q) * [1, -1, 1],
        ),
        Misconception(
            "entry by entry",
            "p̃ * q̃ multiplies entry by entry; perpendicular to both is their cross product.",
            lambda p, q: np.array([*(p * q), 1.0]),
        ),
        Misconception(
            "sum of the points",
            "p̃ + q̃ is a point, halfway between both, and not the line.",
            lambda p, q: np.array([*(p + q), 2.0]),
        ),
        Misconception(
            "constant left out",
            "Your line has the right direction but goes through pixel (0, 0): c is missing.",
            lambda p, q: line_through(p, q) * [1, 1, 0],
        ),
        Misconception(
            "slope and intercept",
            "That is m and c of y = m x + c, which no upright line has. Asked are three numbers: "
            "m x − y + c = 0.",
            _slope_and_intercept,
            variants=(lambda p, q: _swapped(_slope_and_intercept(p, q)),),
        ),
        Misconception(
            "sign of c",
            "Your c has the wrong sign: a and b are right, and a x + b y = −c for both points.",
            lambda p, q: line_through(p, q) * [1, 1, -1],
        ),
        Misconception(
            "sign of a",
            "Your a has the wrong sign: it is p_y − q_y, if b is q_x − p_x.",
            lambda p, q: line_through(p, q) * [-1, 1, 1],
        ),
        Misconception(
            "constant of one coordinate",
            "Your c has only one of its two parts: c = −(a x + b y).",
            lambda p, q: _with_constant(p, q, [1, 0]),
            variants=(lambda p, q: _with_constant(p, q, [0, 1]),),
        ),
        Misconception(
            "normal not turned",
            "Your c is right, but your (a, b) is q − p, along the line: turn it by 90°.",
            lambda p, q: np.array([*(q - p), line_through(p, q)[2]]),
        ),
        Misconception(
            "Euclidean cross product",
            "You crossed the points as they are, with two coordinates, which gives one number: "
            "lift them first.",
            lambda p, q: p[0] * q[1] - p[1] * q[0],
            variants=(lambda p, q: q[0] * p[1] - q[1] * p[0],),
        ),
    ),
    reference=line_through,
    same=up_to_scale,
    concepts=("2", "12"),
    sources=(line_through, join),
)
