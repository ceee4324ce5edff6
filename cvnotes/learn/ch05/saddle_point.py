"""The corner between the pixels."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def saddle_point(c: Array) -> Array:
    """Give where the gradient of a quadratic surface with coefficients c (6,) vanishes, (2,)."""
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


SADDLE = Exercise(
    name="saddle_point",
    chapter=5,
    title="The corner between the pixels",
    task="Around a chessboard corner the grey levels form a saddle, "
    "a u² + b u v + c v² + d u + e v + f. Give the point (u, v), shape (2,), in which the surface "
    "is level, from its coefficients (a, b, c, d, e, f).",
    stub='''def my_saddle_point(coefficients):
    """Give (u, v) of the saddle, shape (2,)."""
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
    misconceptions=(
        Misconception(
            "factor 2 lost",
            "The derivative of a u² is 2 a u: the factor 2 is missing on the diagonal.",
            lambda c: _solve(c, diagonal=1.0),
        ),
        Misconception(
            "factor 2 on the mixed term",
            "The derivative of b u v by u is b v, without a factor 2.",
            lambda c: _solve(c, mixed=2.0),
        ),
        Misconception(
            "sign",
            "d and e change sign when they go to the other side: your point is mirrored.",
            lambda c: _solve(c, sign=1.0),
        ),
        Misconception(
            "axes one by one",
            "You looked for the level point along u and along v separately; the term b u v "
            "couples them.",
            lambda c: _solve(c, mixed=0.0),
        ),
        Misconception(
            "not divided by the determinant",
            "That is the right direction: by Cramer's rule, divide by the determinant 4 a c − b².",
            lambda c: _solve(c) * (4 * c[0] * c[2] - c[1] ** 2),
        ),
        Misconception(
            "multiplied, not solved",
            (
                "You multiplied by the matrix of the second derivatives: solve with it, which is "
                "multiplying by its inverse."
            ),
            lambda c: np.array([[2 * c[0], c[1]], [c[1], 2 * c[2]]]) @ [-c[3], -c[4]],
        ),
        Misconception(
            "half of the mixed term",
            (
                "With [[a, b/2], [b/2, c]] you have half of the derivatives: the point is twice "
                "as far away."
            ),
            lambda c: _solve(c, diagonal=1.0, mixed=0.5),
        ),
        Misconception(
            "a and c exchanged",
            "a belongs to u², c to v²: they are exchanged.",
            lambda c: _solve(c[[2, 1, 0, 3, 4, 5]]),
        ),
        Misconception(
            "d and e exchanged",
            "d belongs to u, e to v: they are exchanged.",
            lambda c: _solve(c[[0, 1, 2, 4, 3, 5]]),
        ),
        Misconception(
            "sign of the mixed term",
            "The mixed term has the wrong sign: 2 a u + b v + d = 0.",
            lambda c: _solve(c, mixed=-1.0),
        ),
        Misconception(
            "coefficients in another order",
            "You took the coefficients as those of u², v², u v: they are a u² + b u v + c v².",
            lambda c: _solve(c[[0, 2, 1, 3, 4, 5]]),
        ),
        Misconception(
            "sign in the determinant",
            "You have another determinant: it is 4 a c − b², with a minus.",
            lambda c: _solve(c) * (4 * c[0] * c[2] - c[1] ** 2) / (4 * c[0] * c[2] + c[1] ** 2),
            variants=(
                lambda c: _solve(c) * (4 * c[0] * c[2] - c[1] ** 2) / (c[0] * c[2] - c[1] ** 2),
            ),
        ),
        Misconception(
            "value of the surface",
            "That is the grey level at the saddle; asked is where it is.",
            lambda c: c[5] + _solve(c) @ [c[3], c[4]] / 2,
        ),
        Misconception(
            "slope at the origin",
            "(d, e) is the slope at (0, 0); asked is where it vanishes.",
            lambda c: c[3:5],
            variants=(lambda c: -c[3:5],),
        ),
        Misconception(
            "one sign",
            "d and e both change sign when they go to the other side.",
            lambda c: np.linalg.solve([[2 * c[0], c[1]], [c[1], 2 * c[2]]], [-c[3], c[4]]),
            variants=(
                lambda c: np.linalg.solve([[2 * c[0], c[1]], [c[1], 2 * c[2]]], [c[3], -c[4]]),
            ),
        ),
        Misconception(
            "one factor 2 lost",
            "Both derivatives of a square have a 2: [[2a, b], [b, 2c]].",
            lambda c: np.linalg.solve([[2 * c[0], c[1]], [c[1], c[2]]], [-c[3], -c[4]]),
            variants=(lambda c: np.linalg.solve([[c[0], c[1]], [c[1], 2 * c[2]]], [-c[3], -c[4]]),),
        ),
        Misconception(
            "d and e halved",
            "With [[2a, b], [b, 2c]] the right-hand side is (−d, −e), without a half.",
            lambda c: _solve(c) / 2,
        ),
        Misconception(
            "factor 2 lost, and the sign",
            "The factor 2 is missing on the diagonal, and d and e change sign on the other side.",
            lambda c: _solve(c, diagonal=1.0, sign=1.0),
        ),
        Misconception(
            "axes one by one, without 2",
            "Along u alone 2 a u + d = 0; and the term b u v couples both.",
            lambda c: _solve(c, diagonal=1.0, mixed=0.0),
            variants=(lambda c: _solve(c, mixed=0.0, sign=1.0),),
        ),
        Misconception(
            "f for e",
            "You took f for d or e: the coefficients are (a, b, c, d, e, f).",
            lambda c: _solve(c[[0, 1, 2, 4, 5, 3]]),
            variants=(lambda c: _solve(c[[0, 1, 2, 3, 5, 4]]),),
        ),
    ),
    reference=saddle_point,
    concepts=("40", "E19"),
)
