"""Where two lines meet."""

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.equality import close, up_to_scale
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import from_homogeneous, meet


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
    """Give the right point, but another one for parallel lines."""
    x_h = np.cross(l1, l2)
    return point if x_h[2] == 0 else x_h


def _products_added(l1: Array, l2: Array, entry: int | None = None) -> Array:
    """Give the cross product with a plus for its minus, in one entry or in all."""
    right, added = np.cross(l1, l2), l1[[1, 2, 0]] * l2[[2, 0, 1]] + l1[[2, 0, 1]] * l2[[1, 2, 0]]
    return added if entry is None else np.where(np.arange(3) == entry, added, right)


def _finite(x: Array) -> Array | None:
    return x if np.isfinite(x).all() else None


MEET = Exercise(
    name="meet",
    chapter=1,
    title="Where two lines meet",
    task="Give the point, homogeneous (3,) and of any scale, in which two lines (a, b, c) meet. "
    "Parallel lines meet too: at infinity.",
    stub='''def my_meet(l1, l2):
    """Give the homogeneous point (3,) on both lines l1 and l2, (3,) each."""
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
        Misconception(
            "parallel lines left out",
            "Right, except that parallel lines have no answer in the plane: there the two "
            "equations cannot be solved. In the projective plane they can: the cross product "
            "gives a point whose last coordinate is 0.",
            _solved,
        ),
        Misconception(
            "sign of the constant",
            "Your point is mirrored at the origin: a x + b y + c = 0 means a x + b y = −c.",
            lambda l1, l2: _solved(l1, l2, sign=1.0),
        ),
        Misconception(
            "sum of the lines",
            "l1 + l2 is another line through the same point, not the point.",
            lambda l1, l2: l1 + l2,
        ),
        Misconception(
            "difference of the lines",
            "l1 − l2 is another line through the same point, not the point.",
            lambda l1, l2: l1 - l2,
        ),
        Misconception(
            "entry by entry",
            "l1 * l2 multiplies entry by entry; the product that is perpendicular to both is the "
            "cross product.",
            lambda l1, l2: l1 * l2,
        ),
        Misconception(
            "direction of the first line",
            "That is the point at infinity on the first line: its direction. The second line was "
            "not used.",
            lambda l1, _: np.array([l1[1], -l1[0], 0.0]),
        ),
        Misconception(
            "sign of the second entry",
            "The second entry of the cross product has the other sign: c1 a2 − a1 c2.",
            lambda l1, l2: np.cross(l1, l2) * [1, -1, 1],
        ),
        Misconception(
            "Euclidean coordinates",
            (
                "You divided already. Asked is the homogeneous point (3,), which exists for "
                "parallel lines too."
            ),
            lambda l1, l2: _finite(from_homogeneous(np.cross(l1, l2))),
            same=close,
        ),
        Misconception(
            "direction of the second line",
            (
                "That is the point at infinity on the second line: its direction. The first line "
                "was not used."
            ),
            lambda _, l2: np.array([l2[1], -l2[0], 0.0]),
        ),
        Misconception(
            "products added",
            "The cross product subtracts: b1 c2 − c1 b2, and so on; you added.",
            lambda l1, l2: _products_added(l1, l2),
        ),
        Misconception(
            "one product added",
            "In one entry of the cross product you added where it subtracts: (b1 c2 − c1 b2, c1 "
            "a2 − a1 c2, a1 b2 − b1 a2).",
            lambda l1, l2: _products_added(l1, l2, 0),
            variants=(
                lambda l1, l2: _products_added(l1, l2, 1),
                lambda l1, l2: _products_added(l1, l2, 2),
            ),
        ),
        Misconception(
            "sign of the first entry",
            "The first entry of the cross product has the other sign: b1 c2 − c1 b2.",
            lambda l1, l2: np.cross(l1, l2) * [-1, 1, 1],
        ),
        Misconception(
            "sign of the last entry",
            "The last entry of the cross product has the other sign: a1 b2 − b1 a2. So your point "
            "is mirrored at the origin.",
            lambda l1, l2: np.cross(l1, l2) * [1, 1, -1],
        ),
        Misconception(
            "x and y exchanged",
            "You gave (y, x, 1): x comes first.",
            lambda l1, l2: np.cross(l1, l2)[[1, 0, 2]],
        ),
        Misconception(
            "normal for the direction",
            "Right, except for parallel lines: they meet in the point at infinity of their "
            "direction, (b, −a, 0); (a, b) is perpendicular to it.",
            lambda l1, l2: _at_infinity(l1, l2, np.array([*l1[:2], 0.0])),
        ),
        Misconception(
            "no point for parallel lines",
            "Right, except for parallel lines: (0, 0, 0) is no point, and (0, 0, 1) is the "
            "origin. The cross product gives the point at infinity by itself.",
            lambda l1, l2: _at_infinity(l1, l2, np.zeros(3)),
            variants=(lambda l1, l2: _at_infinity(l1, l2, np.array([0.0, 0, 1])),),
        ),
        Misconception(
            "infinity in both coordinates",
            "Right, except for parallel lines: you gave one point for all of them, but theirs "
            "is in their own direction, (b, −a, 0).",
            lambda l1, l2: _at_infinity(l1, l2, np.array([1.0, 1, 0])),
        ),
        Misconception(
            "dot product",
            "l1·l2 is a number; the point that is on both lines is their cross product.",
            lambda l1, l2: l1 @ l2,
        ),
        Misconception(
            "last coordinate 0",
            "Every point of yours is at infinity: the last coordinate a1 b2 − b1 a2 is missing.",
            lambda l1, l2: np.cross(l1, l2) * [1, 1, 0],
        ),
    ),
    reference=meet,
    same=up_to_scale,
    concepts=("1", "5", "7"),
)
