"""The corner between the pixels."""

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def saddle_point(c: Array) -> Array:
    """Return where the gradient of a quadratic surface with coefficients c (6,) vanishes, (2,)."""
    return np.linalg.solve([[2 * c[0], c[1]], [c[1], 2 * c[2]]], [-c[3], -c[4]])


def _surfaces(rng: Rng) -> list[Case]:
    a, b, e, f = rng.uniform([2, 1, -3, -3], [6, 3, 3, 3])
    # a saddle at (u, v): the determinant of the quadratic part is negative
    return [
        Case((np.array([1.0, 2.0, -1.0, -4.0, 8.0, 5.0]),)),
        Case((rounded([a, b, -a / 2, e, f, 100.0], 2),)),
    ]


def _solve(c: Array, diagonal: float = 2.0, mixed: float = 1.0, sign: float = -1.0) -> Array:
    M = [[diagonal * c[0], mixed * c[1]], [mixed * c[1], diagonal * c[2]]]
    return np.linalg.solve(M, [sign * c[3], sign * c[4]])


def _steps(c: Array) -> Any:
    M = np.array([[2 * c[0], c[1]], [c[1], 2 * c[2]]])  # the second derivatives
    g = np.array([c[3], c[4]])  # the derivatives at (0, 0)
    return np.linalg.solve(M, -g)


MISTAKES = mistakes(
    ("factor 2 on the mixed term", "The derivative of b u v by u has no factor 2.",
     lambda c: _solve(c, mixed=2.0)),
    ("factor 2 lost, and the sign",
     "A square has a factor 2 in its derivative; and what goes to the other side changes its"
     " sign.",
     lambda c: _solve(c, diagonal=1.0, sign=1.0)),
    ("one sign",
     "A sign is wrong: of the mixed term, or of one of those that go to the other side.",
     lambda c: _solve(c, mixed=-1.0),
     lambda c: np.linalg.solve([[2 * c[0], c[1]], [c[1], 2 * c[2]]], [-c[3], c[4]]),
     lambda c: np.linalg.solve([[2 * c[0], c[1]], [c[1], 2 * c[2]]], [c[3], -c[4]])),
    ("axes one by one",
     "You looked for the level point along u and along v separately; the mixed term couples "
     "them.",
     lambda c: _solve(c, diagonal=1.0, mixed=0.0), lambda c: _solve(c, mixed=0.0, sign=1.0)),
    ("not divided by the determinant",
     "The determinant of the two equations is left out, or is another: look at its signs.",
     lambda c: _solve(c) * (4 * c[0] * c[2] - c[1] ** 2),
     lambda c: _solve(c) * (4 * c[0] * c[2] - c[1] ** 2) / (4 * c[0] * c[2] + c[1] ** 2),
     lambda c: _solve(c) * (4 * c[0] * c[2] - c[1] ** 2) / (c[0] * c[2] - c[1] ** 2)),
    ("multiplied, not solved",
     "You multiplied by the matrix of the second derivatives: solve with it.",
     lambda c: np.array([[2 * c[0], c[1]], [c[1], 2 * c[2]]]) @ [-c[3], -c[4]]),
    ("coefficients in another order",
     "You took the coefficients in another order than the task has them.",
     lambda c: _solve(c[[0, 2, 1, 3, 4, 5]]), lambda c: _solve(c[[2, 1, 0, 3, 4, 5]]),
     lambda c: _solve(c[[0, 1, 2, 4, 3, 5]]), lambda c: _solve(c[[0, 1, 2, 4, 5, 3]]),
     lambda c: _solve(c[[0, 1, 2, 3, 5, 4]])),
    ("slope at the origin", "That is the slope at (0, 0); asked is where it vanishes.",
     lambda c: c[3:5], lambda c: -c[3:5]),
)  # fmt: skip


SADDLE = Exercise(
    name="saddle_point",
    chapter=5,
    title="The corner between the pixels",
    task="Around a chessboard corner the grey levels form a saddle, "
    "a u² + b u v + c v² + d u + e v + f. Give the point (u, v), shape (2,), in which the surface "
    "is level, from its coefficients (a, b, c, d, e, f).",
    stub='''def my_saddle_point(coefficients):
    """Return (u, v) of the saddle, shape (2,)."""
    ...''',
    hints=(
        "Level means that both derivatives are 0.",
        "By u: 2 a u + b v + d = 0. By v: b u + 2 c v + e = 0.",
        "np.linalg.solve([[2a, b], [b, 2c]], [−d, −e]).",
    ),
    cases=_surfaces,
    properties=(
        Property(
            "Both derivatives are 0 there.",
            lambda x, c: np.allclose(
                [
                    2 * c.args[0][0] * x[0] + c.args[0][1] * x[1] + c.args[0][3],
                    2 * c.args[0][2] * x[1] + c.args[0][1] * x[0] + c.args[0][4],
                ],
                0,
                atol=1e-4,
            ),
        ),
    ),
    misconceptions=MISTAKES,
    reference=saddle_point,
    steps=_steps,
    concepts=("40", "E19"),
)
