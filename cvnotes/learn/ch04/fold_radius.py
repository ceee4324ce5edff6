"""Where the model ends."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _lenses(rng: np.random.Generator) -> list[Case]:
    k1, k2 = rounded(rng.uniform([-0.5, 0.005], [-0.3, 0.02]), 3)
    return [
        Case((np.array([-4 / 3, 0.0]),)),
        Case((np.array([k1, k2]),)),
        Case((np.array([-0.3, -0.1]),)),
        Case((np.array([0.2, -0.1]),)),
        Case((np.array([0.2, 0.1]),), about="endless"),
        Case((np.array([-0.25, 0.1]),), about="endless"),  # the course's own
    ]


def fold_radius(k: Array) -> float:
    """Return the largest radius r up to which r L(r) grows; np.inf if it always does."""
    a, b = 5 * k[1], 3 * k[0]
    z = np.roots([a, b, 1.0])  # r² where the slope of r L(r) is 0
    x = z[(z.imag == 0) & (z.real > 0)].real  # those that are real and positive
    r2 = min(x, default=np.inf)  # the smallest of them
    return np.sqrt(r2)


MISTAKES = mistakes_in(fold_radius,
    ("k2 = 0 left out", "Right unless k2 is 0: the formula of quadratic equations divides by it.",
     "np.sqrt(r2) if k[1] else None", "np.sqrt(r2) if k[1] else np.inf"),
    ("root of L", "There L(r) is 0: all points fall into the centre. The picture folds before "
     "that, where r L(r) stops growing.",
     ("5 * k[1], 3 * k[0]", "k[1], k[0]")),
    ("another slope",
     "That is not where the slope of r L(r) is 0: look at the terms of your slope again.",
     "np.sqrt(-k[0] / (2 * k[1])) if k[0] * k[1] < 0 else np.inf",
     ("5 * k[1], 3 * k[0]", "4 * k[1], 2 * k[0]"), ("5 * k[1], 3 * k[0]", "3 * k[1], 3 * k[0]"),
     "np.sqrt(-3 * k[0] / (5 * k[1])) if k[0] * k[1] < 0 else np.inf"),
    ("radius in the picture",
     "That is how far from the centre the fold is seen. Asked is the ideal radius.",
     "np.sqrt(r2) * (1 + k[0] * r2 + k[1] * r2**2) if np.isfinite(r2) else np.inf"),
    ("the outer root", "The slope is 0 at two radii. The picture has folded at the first of them.",
     ("min(x", "max(x")),
    ("one root of the formula only",
     "The formula has two roots: take the smallest that is positive, of both.",
     *(f"np.sqrt(q) if a and b * b >= 4 * a and (q := (-b {sign} np.sqrt(b * b - 4 * a)) / a / 2) "
       "> 0 else None" for sign in "+-")),
    ("a sign thought to tell", "Right for other lenses. The sign of one coefficient alone does not "
     "tell whether the picture folds: both count.",
     "np.inf if k[0] >= 0 else np.sqrt(r2)", "np.inf if k[1] > 0 else np.sqrt(r2)"),
    ("signs of the roots lost",
     "You took the root of |r²|: where r² is negative there is no radius.",
     "np.sqrt(np.abs(z).min())"),
)  # fmt: skip


EXERCISE = Exercise(
    name="fold_radius",
    chapter=4,
    title="Where the model ends",
    task="Beyond some radius the picture r L(r) of a radius shrinks again: the image folds over, "
    "which no lens does. Give this largest valid ideal radius for k = (k1, k2), or np.inf if "
    "there is none.",
    hints=(
        "r L(r) = r + k1 r³ + k2 r⁵. Where does its slope become 0?",
        "1 + 3 k1 r² + 5 k2 r⁴ = 0 is a quadratic equation for r².",
        "Of its positive roots the smallest counts; without one, as for k = (0.2, 0), it is "
        "np.inf. For k = (−4/3, 0) the answer is 0.5.",
    ),
    cases=_lenses,
    properties=(
        Property("Up to your radius r L(r) grows, beyond it it shrinks."),
        Property("A lens that never folds has no such radius: np.inf.", about="endless"),
    ),
    misconceptions=MISTAKES,
    steps=fold_radius,
    concepts=("31", "h", "E15"),
)
