"""When are two points the same."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def same_points(a: Array, b: Array) -> Array:
    """Tell row by row whether homogeneous points (n, 3) are the same: (n,) of 1 and 0."""
    lengths = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    return np.asarray(np.linalg.norm(np.cross(a, b), axis=1) <= 1e-9 * lengths, dtype=float)


def _pairs(rng: Rng) -> list[Case]:
    a = np.array(
        [
            [1.0, 2, 1],
            [1, 2, 1],
            [2, 4, 2],
            [1, 2, 0],
            [1, 2, 0],
            [0, 3, 1],
            [4, 2, 2],
            [1, 2, 1],
            [0, 3, 1],
            [1, 2, 1],
            [1, 2, 1],
            [1, 2, 1],
        ]
    )
    b = np.array(
        [
            [1.0, 2, 1],
            [2, 4, 2],
            [-1, -2, -1],
            [-3, -6, 0],
            [2, 1, 0],
            [0, 6, 1],
            [4, 2, 1],
            [1, -2, 1],
            [0, 6, 2],
            [2, 3, 2],
            [3, 1, 2],
            [1, -1, 1],
        ]
    )
    more = rounded(rng.uniform(-4, 4, (6, 3)), 1)
    factors = np.array([1.0, 2.0, -1.5, -4.0, 1.0, 0.5])[:, None]
    other = more * factors
    other[4:, 2] += 1.0
    return [Case((a, b)), Case((more, other))]


def _unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x, axis=1, keepdims=True))


def _all_infinite_same(a: Array, b: Array) -> Array:
    far = (a[:, 2] == 0) & (b[:, 2] == 0)
    return np.asarray(far | np.isclose(a / a[:, 2:], b / b[:, 2:]).all(1), dtype=float)


SAME = Exercise(
    name="same_points",
    chapter=1,
    title="When are two points the same?",
    task="Tell row by row whether homogeneous points a and b, shape (n, 3), are the same point of "
    "the projective plane: True or False, shape (n,). Some of them are at infinity.",
    stub='''def my_same_points(a, b):
    """Tell row by row whether homogeneous points (n, 3) are the same."""
    ...''',
    hints=(
        "Equal up to a factor, which may be negative, and which you do not know.",
        "Dividing by the last coordinate is not allowed at infinity.",
        "Vectors that differ by a factor are parallel. What is their cross product? Numbers are "
        "rounded, so ask for nearly 0: np.isclose.",
    ),
    cases=_pairs,
    properties=(Property("Points are the same exactly if a factor apart, at infinity too."),),
    misconceptions=(
        Misconception(
            "equality of the numbers",
            "You compared the numbers as they are; homogeneous coordinates are the same point if "
            "they differ by a factor.",
            lambda a, b: (a == b).all(1),
        ),
        Misconception(
            "negative factors left out",
            "You allow for a positive factor only: (1, 2, 1) and (−1, −2, −1) are the same point.",
            lambda a, b: np.isclose(_unit(a), _unit(b)).all(1),
        ),
        Misconception(
            "points at infinity left out",
            "You divided by the last coordinate, which is 0 at infinity: (1, 2, 0) and "
            "(−3, −6, 0) are the same point too.",
            lambda a, b: np.isclose(a / a[:, 2:], b / b[:, 2:]).all(1),
        ),
        Misconception(
            "direction in the plane only",
            "You compared x : y only. Points on one line through the origin have that in common; "
            "the last coordinate tells them apart.",
            lambda a, b: np.isclose(a[:, 0] * b[:, 1], a[:, 1] * b[:, 0]),
        ),
        Misconception(
            "every pair the same",
            "You say that all points are the same; (1, 2, 0) and (2, 1, 0) are two directions.",
            lambda a, _: np.ones(len(a)),
        ),
        Misconception(
            "signs ignored",
            (
                "You compared absolute values: (1, 2, 1) and (1, −2, 1) are two points. Only a "
                "common sign does not matter."
            ),
            lambda a, b: np.isclose(np.abs(_unit(a)), np.abs(_unit(b))).all(1),
        ),
        Misconception(
            "sum of the cross product",
            "The cross product must be 0 in all three entries; their sum may be 0 by chance.",
            lambda a, b: np.isclose(np.cross(a, b).sum(1), 0),
        ),
        Misconception(
            "one entry of the cross product",
            "One entry of the cross product that is 0 is not enough: all three must be.",
            lambda a, b: np.isclose(np.cross(a, b), 0).any(1),
        ),
        Misconception(
            "divided by the first coordinate",
            (
                "You divided by the first coordinate, which is 0 for all points on the y axis: "
                "(0, 3, 1) and (0, 6, 2) are the same point."
            ),
            lambda a, b: np.isclose(a / a[:, :1], b / b[:, :1]).all(1),
        ),
        Misconception(
            "perpendicular",
            (
                "The dot product is 0 if two vectors are perpendicular. Those of one point are "
                "parallel: it is the cross product that vanishes."
            ),
            lambda a, b: np.isclose((a * b).sum(1), 0),
        ),
        Misconception(
            "quotients 0/0",
            "You compared the quotients a/b, which are 0/0 wherever both have a 0: (0, 3, 1) and "
            "(0, 6, 2) are the same point. The cross product divides nothing.",
            lambda a, b: np.isclose(np.ptp(a / b, axis=1), 0),
            variants=(
                lambda a, b: (
                    np.isclose(a[:, 0] / b[:, 0], a[:, 1] / b[:, 1])
                    & np.isclose(a[:, 1] / b[:, 1], a[:, 2] / b[:, 2])
                ),
                lambda a, b: np.isclose(a / b, (a / b)[:, 2:]).all(1),
            ),
        ),
        Misconception(
            "all points at infinity the same",
            "You take all points at infinity for one: (1, 2, 0) and (2, 1, 0) are two directions.",
            _all_infinite_same,
        ),
        Misconception(
            "one answer for all pairs",
            "You gave one answer for all pairs together; asked is one for each row: all(axis=1).",
            lambda a, b: bool(same_points(a, b).all()),
            variants=(
                lambda a, b: bool(same_points(a, b).any()),
                lambda a, b: np.allclose(a, b),
                lambda a, b: np.allclose(np.cross(a, b), 0),
            ),
        ),
        Misconception(
            "an answer for each number",
            "You gave an answer for each number; a point is the same if all of its row is: "
            "all(axis=1).",
            lambda a, b: np.isclose(np.cross(a, b), 0),
            variants=(
                lambda a, b: a == b,
                lambda a, b: np.isclose(a, b),
                lambda a, b: np.isclose(a / a[:, 2:], b / b[:, 2:]),
                lambda a, b: np.isclose(_unit(a), _unit(b)),
                lambda a, b: np.cross(a, b) == 0,
            ),
        ),
        Misconception(
            "lengths compared",
            "You compared lengths: two vectors of one length may lead to two points.",
            lambda a, b: np.isclose(np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)),
        ),
        Misconception(
            "last coordinate alone",
            "You compared the last coordinates alone.",
            lambda a, b: np.isclose(a[:, 2], b[:, 2]),
        ),
        Misconception(
            "order of the numbers ignored",
            "You compared the numbers in any order; which coordinate is which matters.",
            lambda a, b: np.isclose(np.sort(_unit(a), 1), np.sort(_unit(b), 1)).all(1),
        ),
    ),
    reference=same_points,
    concepts=("4", "12", "E3"),
)
