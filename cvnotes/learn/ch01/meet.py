"""Where two lines meet."""

from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.learn.cases.cameras import rounded
from cvnotes.projective import from_homogeneous, meet
from cvnotes.tutor.checker.equality import close, up_to_scale
from cvnotes.tutor.checker.exercise import Case, Exercise, Misconception, Property, Rng, mistakes


def _two_lines(rng: Rng) -> list[Case]:
    l1, l2 = rounded(rng.uniform(-3, 3, (2, 3)))
    return [
        Case((np.array([1.0, 0.0, -2.0]), np.array([1.0, 1.0, -5.0]))),
        Case((l1, l2)),
        Case((np.array([1.0, 2.0, -3.0]), np.array([-2.0, -4.0, 9.0])), about="parallel"),
    ]


def _solved(l1: Array, l2: Array, sign: float = -1.0) -> Array:
    normals = np.array([l1[:2], l2[:2]])
    if abs(np.linalg.det(normals)) < 1e-12:
        raise CvnotesError("parallel")
    return np.array([*np.linalg.solve(normals, sign * np.array([l1[2], l2[2]])), 1.0])


def _on_both(x_h: Array, case: Case) -> bool:
    lines = np.array(case.args)
    return bool(
        (np.abs(lines @ x_h) <= 1e-6 * case.slack * (np.abs(lines) @ np.abs(x_h))).all()
        and x_h.any()
    )


def _at_infinity(l1: Array, l2: Array, point: Array) -> Array:
    """Return the right point, but another one for parallel lines."""
    x_h = np.cross(l1, l2)
    return point if x_h[2] == 0 else x_h


def _finite(x: Array) -> Array | None:
    return x if np.isfinite(x).all() else None


def _steps(l1: Array, l2: Array) -> Any:
    a, b, c = l1
    d, e, f = l2
    x = b * f - c * e  # the first coordinate
    y = c * d - a * f  # the second coordinate
    w = a * e - b * d  # the third coordinate
    return np.array([x, y, w])


MISTAKES = mistakes(
    ("parallel lines left out",
     "Right, except that parallel lines have no answer in the plane. In the projective plane"
     " they have.",
     _solved),
    ("no point for parallel lines",
     "Right, except for parallel lines: they meet in the point at infinity of their own "
     "direction.",
     lambda l1, l2: _at_infinity(l1, l2, np.zeros(3)),
     lambda l1, l2: _at_infinity(l1, l2, np.array([0.0, 0, 1])),
     lambda l1, l2: _at_infinity(l1, l2, np.array([*l1[:2], 0.0])),
     lambda l1, l2: _at_infinity(l1, l2, np.array([1.0, 1, 0]))),
    ("sign of the constant",
     "Your point is mirrored at the origin: on which side of the equation does c stand?",
     lambda l1, l2: _solved(l1, l2, sign=1.0)),
    ("sum of the lines", "That is another line through the same point, not the point.",
     lambda l1, l2: l1 + l2, lambda l1, l2: l1 - l2),
    ("entry by entry",
     "You multiplied entry by entry; another product is perpendicular to both.",
     lambda l1, l2: l1 * l2),
    ("direction of one line",
     "That is a point at infinity. The direction of a line is not where it meets another.",
     lambda l1, _: np.array([l1[1], -l1[0], 0.0]), lambda _, l2: np.array([l2[1], -l2[0], 0.0]),
     lambda l1, l2: np.cross(l1, l2) * [1, 1, 0]),
)  # fmt: skip


MEET = Exercise(
    name="meet",
    chapter=1,
    title="Where two lines meet",
    task="Give the point, homogeneous (3,) and of any scale, in which two lines (a, b, c) meet. "
    "Parallel lines meet too: at infinity.",
    stub='''def my_meet(l1, l2):
    """Return the homogeneous point (3,) on both lines l1 and l2, (3,) each."""
    ...''',
    hints=(
        "The point x̃ has l1·x̃ = 0 and l2·x̃ = 0.",
        "So it is perpendicular to both, as vectors of three numbers.",
        "No division is needed, and parallel lines need no case of their own.",
    ),
    cases=_two_lines,
    properties=(
        Property("The point lies on both lines.", _on_both),
        Property(
            "Parallel lines meet at infinity, in their direction.", _on_both, about="parallel"
        ),
    ),
    misconceptions=(
        *MISTAKES,
        Misconception(
            "Euclidean coordinates",
            "You divided already. Asked is the homogeneous point (3,), which exists for parallel "
            "lines too.",
            lambda l1, l2: _finite(from_homogeneous(np.cross(l1, l2))),
            same=close,
        ),
    ),
    reference=meet,
    steps=_steps,
    same=up_to_scale,
    concepts=("1", "5", "7"),
)
