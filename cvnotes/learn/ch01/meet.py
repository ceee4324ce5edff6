"""Where two lines meet."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import incident, rounded
from cvnotes.projective import meet
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import close, up_to_scale


def _two_lines(rng: np.random.Generator) -> list[Case]:
    l1, l2 = rounded(rng.uniform(-3, 3, (2, 3)))
    return [
        Case((np.array([1.0, 0.0, -2.0]), np.array([1.0, 1.0, -5.0]))),
        Case((l1, l2)),
        Case((np.array([2.0, 1.0, -3.0]), np.array([-4.0, -2.0, 9.0])), about="parallel"),
    ]


def _both(x_h: Array, case: Case) -> bool:
    return incident(np.array(case.args), x_h, case.slack)


def _steps(l1: Array, l2: Array) -> Array:
    """Return the homogeneous point (3,) on both lines l1 and l2, (3,) each."""
    a, b, c = l1
    d, e, f = l2
    x = b * f - c * e  # the first coordinate
    y = c * d - a * f  # the second coordinate
    w = a * e - b * d  # the third coordinate
    return np.array([x, y, w])


MISTAKES = mistakes_in(_steps,
    ("parallel lines left out", "Right, except that parallel lines have no answer in the plane. In "
     "the projective plane they have.",
     "np.array([*np.linalg.solve([[a, b], [d, e]], [-c, -f]), 1.0])"),
    ("no point for parallel lines", "Right, except for parallel lines: they meet in the point at "
     "infinity of their own direction.",
     *(f"np.array([x, y, w] if w else {other})"
       for other in ("[0, 0, 0]", "[0, 0, 1]", "[a, b, 0]", "[1, 1, 0]"))),
    ("sign of the constant",
     "Your point is mirrored at the origin: on which side of the equation does c stand?",
     "np.array([*np.linalg.solve([[a, b], [d, e]], [c, f]), 1.0])"),
    ("sum of the lines", "That is another line through the same point, not the point.",
     "l1 + l2", "l1 - l2"),
    ("entry by entry", "You multiplied entry by entry; another product is perpendicular to both.",
     "l1 * l2"),
    ("direction of one line",
     "That is a point at infinity. The direction of a line is not where it meets another.",
     "np.array([b, -a, 0])", "np.array([e, -d, 0])", "np.array([x, y, 0])"),
    ("Euclidean coordinates", "You divided already. Asked is the homogeneous point (3,), and "
     "parallel lines have one, too.",
     "np.array([x / w, y / w]) if w else None", {"same": close}),
)  # fmt: skip


EXERCISE = Exercise(
    name="meet",
    chapter=1,
    title="Where two lines meet",
    task="Give the point, homogeneous (3,) and of any scale, in which two lines (a, b, c) meet. "
    "Parallel lines meet too: at infinity.",
    hints=(
        "The point x̃ has l1·x̃ = 0 and l2·x̃ = 0.",
        "So it is perpendicular to both, as vectors of three numbers.",
        "No division is needed, and parallel lines need no case of their own.",
    ),
    cases=_two_lines,
    properties=(
        Property("The point lies on both lines.", _both),
        Property("Parallel lines meet at infinity, in their direction.", _both, about="parallel"),
    ),
    misconceptions=MISTAKES,
    reference=meet,
    steps=_steps,
    same=up_to_scale,
    concepts=("1", "5", "7"),
)
