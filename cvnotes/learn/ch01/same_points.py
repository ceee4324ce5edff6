"""When are two points the same."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _pairs(rng: np.random.Generator) -> list[Case]:
    a = np.array([
        [1.0, 2, 1], [1, 2, 1], [2, 4, 2], [1, 2, 0], [1, 2, 0], [0, 3, 1],
        [4, 2, 2], [1, 2, 1], [0, 3, 1], [1, 2, 1], [1, 2, 1], [1, 2, 1],
    ])  # fmt: skip
    b = np.array([
        [1.0, 2, 1], [2, 4, 2], [-1, -2, -1], [-3, -6, 0], [2, 1, 0], [0, 6, 1],
        [4, 2, 1], [1, -2, 1], [0, 6, 2], [2, 3, 2], [3, 1, 2], [1, -1, 1],
    ])  # fmt: skip
    more = rounded(rng.uniform(-4, 4, (6, 3)), 1)
    factors = np.array([1.0, 2.0, -1.5, -4.0, 1.0, 0.5])[:, None]
    other = more * factors
    other[4:, 2] += 1.0
    # the same, though no product of their rounded numbers cancels exactly
    more = np.vstack([more, [1.3, 0.7, 2.9]])
    other = np.vstack([other, [1.3 * 3, 0.7 * 3, 2.9 * 3]])
    return [Case((a, b)), Case((more, other))]


def _unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x, axis=1, keepdims=True))


def same_points(a: Array, b: Array) -> Array:
    """Return row by row whether homogeneous points (n, 3) are the same."""
    c = np.cross(a, b)  # the cross products, row by row
    n = np.linalg.norm(c, axis=1)  # the lengths of the cross products
    s = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)  # what the lengths are measured by
    return n <= 1e-6 * s


MISTAKES = mistakes_in(same_points,
    ("equality of the numbers", "You compared the numbers as they are; homogeneous coordinates are "
     "the same point if they differ by a factor.",
     "(a == b).all(1)", "np.isclose(np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1))",
     "np.isclose(a[:, 2], b[:, 2])"),
    ("negative factors left out",
     "You allow for a positive factor only: (1, 2, 1) and (−1, −2, −1) are the same point.",
     "np.isclose(_unit(a), _unit(b)).all(1)"),
    ("points at infinity left out",
     "You divided by a coordinate, which may be 0 in both points.",
     "np.isclose(a / a[:, 2:], b / b[:, 2:]).all(1)",
     "np.isclose((a / a[:, 2:])[:, :2], (b / b[:, 2:])[:, :2]).all(1)",
     "np.isclose(a / a[:, :1], b / b[:, :1]).all(1)", "np.isclose(np.ptp(a / b, axis=1), 0)",
     "np.isclose(a[:, 0] / b[:, 0], a[:, 1] / b[:, 1]) & np.isclose(a[:, 1] / b[:, 1], a[:, 2] / "
     "b[:, 2])", "np.isclose(a / b, (a / b)[:, 2:]).all(1)"),
    ("direction in the plane only", "You compared x : y only. Points on one line through the "
     "origin have that in common; the last coordinate tells them apart.",
     "np.isclose(a[:, 0] * b[:, 1], a[:, 1] * b[:, 0])"),
    ("signs ignored", "You ignored signs, or the order: (1, 2, 1) and (1, −2, 1) are two points.",
     "np.isclose(np.abs(_unit(a)), np.abs(_unit(b))).all(1)",
     "np.isclose(np.sort(_unit(a), 1), np.sort(_unit(b), 1)).all(1)"),
    ("one entry of the cross product", "All three entries of the cross product must be 0; one of "
     "them, or their sum, may be 0 by chance.",
     "np.isclose(np.cross(a, b), 0).any(1)", "np.isclose(np.cross(a, b).sum(1), 0)"),
    ("perpendicular", "Vectors of one point are parallel; with a dot product of 0 they are not.",
     "np.isclose((a * b).sum(1), 0)"),
    ("all points at infinity the same",
     "You take all points at infinity for one: (1, 2, 0) and (2, 1, 0) are two directions.",
     "(a[:, 2] == 0) & (b[:, 2] == 0) | np.isclose(a / a[:, 2:], b / b[:, 2:]).all(1)"),
    ("exactly 0", "Right, but for rounding: products are rarely 0 exactly. Ask for nearly 0.",
     "(np.cross(a, b) == 0).all(axis=1)", "np.linalg.norm(np.cross(a, b), axis=1) < 1e-17"),
)  # fmt: skip


EXERCISE = Exercise(
    name="same_points",
    chapter=1,
    title="When are two points the same?",
    task="Tell row by row whether homogeneous points a and b, shape (n, 3), are the same point of "
    "the projective plane: True or False, shape (n,). Some of them are at infinity.",
    hints=(
        "Equal up to a factor, which may be negative, and which you do not know.",
        "Dividing by the last coordinate is not allowed at infinity.",
        "Vectors that differ by a factor are parallel. What is their cross product? Numbers are "
        "rounded, so ask for nearly 0: np.isclose.",
    ),
    cases=_pairs,
    properties=(Property("Points are the same exactly if a factor apart, at infinity too."),),
    misconceptions=MISTAKES,
    steps=same_points,
    concepts=("4", "12", "E3"),
)
