"""Where the model ends."""

from collections.abc import Callable
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def fold_radius(k: Array) -> float:
    """Return the largest ideal radius up to which a lens with k (2,) is valid.

    Up to there r L(r) = r + k1 r³ + k2 r⁵ grows; `Lens.max_radius` knows tangential terms too.
    """
    k1, k2 = k
    r2 = np.roots([5 * k2, 3 * k1, 1.0])  # its slope, a quadratic in r²
    ends = r2[(r2.imag == 0) & (r2.real > 0)].real
    return float(np.sqrt(ends.min(initial=np.inf)))


def _lenses(rng: Rng) -> list[Case]:
    k1, k2 = rounded(rng.uniform([-0.5, 0.005], [-0.3, 0.02]), 3)
    return [
        Case((np.array([-4 / 3, 0.0]),)),
        Case((np.array([k1, k2]),)),
        Case((np.array([-0.3, -0.1]),)),
        Case((np.array([0.2, -0.1]),)),
        Case((np.array([0.2, 0.1]),), about="endless"),
        Case((np.array([-0.25, 0.1]),), about="endless"),  # the course's own
    ]


def _smallest_root(a: float, b: float, largest: bool = False) -> float:
    """Return the smallest r > 0 with 1 + a r² + b r⁴ = 0, infinite without one."""
    roots = np.roots([b, a, 1.0] if b else [a, 1.0])
    real = np.sort(roots[(np.abs(roots.imag) < 1e-12) & (roots.real > 0)].real)
    return float(np.sqrt(real[-1 if largest else 0])) if real.size else np.inf


def _seen_radius(k: Array) -> float:
    r = fold_radius(k)
    return float(r * (1 + k[0] * r**2 + k[1] * r**4)) if np.isfinite(r) else np.inf


def _real_part(a: float, b: float) -> float:
    """Return the smallest r > 0 with 1 + a r² + b r⁴ = 0, of complex roots the real part."""
    roots = np.roots([b, a, 1.0] if b else [a, 1.0]).real
    return float(np.sqrt(roots[roots > 0].min())) if (roots > 0).any() else np.inf


def _one_root(a: float, b: float, sign: float) -> float | None:
    """Return one of the two roots; none where it is not real, or the formula divides by 0."""
    if b == 0 or a * a < 4 * b:
        return None
    x = (-a + sign * np.sqrt(a * a - 4 * b)) / (2 * b)
    return float(np.sqrt(x)) if x > 0 else None


def _unless(endless: Callable[[Array], bool], elsewhere: float | None = np.inf) -> Any:
    """Return the right answer, except for lenses that are taken for endless."""
    return lambda k: elsewhere if endless(k) else fold_radius(k)


def _steps(k: Array) -> Any:
    a, b = 5 * k[1], 3 * k[0]
    z = np.roots([a, b, 1.0])  # r² where the slope of r L(r) is 0
    x = z[(z.imag == 0) & (z.real > 0)].real  # those that are real and positive
    r2 = min(x, default=np.inf)  # the smallest of them
    return np.sqrt(r2)


MISTAKES = mistakes(
    ("k2 = 0 left out",
     "Right where k2 is not 0. Without k2 the equation is no quadratic one, and its formula "
     "divides by 0.",
     _unless(lambda k: k[1] == 0, None), _unless(lambda k: k[1] == 0)),
    ("root of L",
     "There L(r) is 0: all points fall into the centre. The picture folds before that, where"
     " r L(r) stops growing.",
     lambda k: _smallest_root(*k)),
    ("another slope",
     "That is not where the slope of r L(r) is 0: look at the terms of your slope again.",
     lambda k: np.sqrt(-k[0] / (2 * k[1])) if k[0] * k[1] < 0 else np.inf,
     lambda k: _smallest_root(2 * k[0], 4 * k[1]), lambda k: _smallest_root(3 * k[0], 3 * k[1]),
     lambda k: np.sqrt(-3 * k[0] / (5 * k[1])) if k[0] * k[1] < 0 else np.inf),
    ("radius in the picture",
     "That is how far from the centre the fold is seen. Asked is the ideal radius.",
     _seen_radius),
    ("the outer root",
     "There are two radii at which the slope is 0. The picture has folded at the first of "
     "them.",
     lambda k: _smallest_root(3 * k[0], 5 * k[1], largest=True)),
    ("lenses without end left out",
     "Right where the picture folds. Where no radius is real and positive, the lens never "
     "folds: infinity.",
     lambda k: fold_radius(k) if np.isfinite(fold_radius(k)) else None,
     lambda k: fold_radius(k) if np.isfinite(fold_radius(k)) else 0.0,
     lambda k: _real_part(3 * k[0], 5 * k[1])),
    ("one root of the formula only",
     "The formula has two roots: take the smallest that is positive, of both.",
     lambda k: _one_root(3 * k[0], 5 * k[1], 1.0), lambda k: _one_root(3 * k[0], 5 * k[1], -1.0)),
    ("a sign thought to tell",
     "Right for other lenses. The sign of one coefficient alone does not tell whether the "
     "picture folds: both count.",
     _unless(lambda k: k[0] >= 0), _unless(lambda k: k[1] > 0)),
    ("signs of the roots lost",
     "You took the root of |r²|: where r² is negative there is no radius.",
     lambda k: np.sqrt(np.abs(np.roots([5 * k[1], 3 * k[0], 1.0])).min())),
)  # fmt: skip


FOLD = Exercise(
    name="fold_radius",
    chapter=4,
    title="Where the model ends",
    task="Beyond some radius the picture r L(r) of a radius shrinks again: the image folds over, "
    "which no lens does. Give this largest valid ideal radius for k = (k1, k2), or np.inf if "
    "there is none.",
    stub='''def my_fold_radius(k):
    """Return the largest radius r up to which r L(r) grows; np.inf if it always does."""
    ...''',
    hints=(
        "r L(r) = r + k1 r³ + k2 r⁵. Where does its slope become 0?",
        "1 + 3 k1 r² + 5 k2 r⁴ = 0 is a quadratic equation for r².",
        "Of its positive roots the smallest counts; without one, as for k = (0.2, 0), it is "
        "np.inf. "
        "For k = (−4/3, 0) the answer is 0.5.",
    ),
    cases=_lenses,
    properties=(
        Property("Up to your radius r L(r) grows, beyond it it shrinks."),
        Property("A lens that never folds has no such radius: np.inf.", about="endless"),
    ),
    misconceptions=MISTAKES,
    reference=fold_radius,
    steps=_steps,
    concepts=("31", "h", "E15"),
)
