"""Where the model ends."""

from collections.abc import Callable
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def fold_radius(k: Array) -> float:
    """Give the largest ideal radius up to which a lens with k (2,) is valid.

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
    """Give the smallest r > 0 with 1 + a r² + b r⁴ = 0, infinite without one."""
    roots = np.roots([b, a, 1.0] if b else [a, 1.0])
    real = np.sort(roots[(np.abs(roots.imag) < 1e-12) & (roots.real > 0)].real)
    return float(np.sqrt(real[-1 if largest else 0])) if real.size else np.inf


def _seen_radius(k: Array) -> float:
    r = fold_radius(k)
    return float(r * (1 + k[0] * r**2 + k[1] * r**4)) if np.isfinite(r) else np.inf


def _real_part(a: float, b: float) -> float:
    """Give the smallest r > 0 with 1 + a r² + b r⁴ = 0, of complex roots the real part."""
    roots = np.roots([b, a, 1.0] if b else [a, 1.0]).real
    return float(np.sqrt(roots[roots > 0].min())) if (roots > 0).any() else np.inf


def _one_root(a: float, b: float, sign: float) -> float | None:
    """Give one of the two roots; none where it is not real, or the formula divides by 0."""
    if b == 0 or a * a < 4 * b:
        return None
    x = (-a + sign * np.sqrt(a * a - 4 * b)) / (2 * b)
    return float(np.sqrt(x)) if x > 0 else None


def _unless(endless: Callable[[Array], bool], elsewhere: float | None = np.inf) -> Any:
    """Give the right answer, except for lenses that are taken for endless."""
    return lambda k: elsewhere if endless(k) else fold_radius(k)


FOLD = Exercise(
    name="fold_radius",
    chapter=4,
    title="Where the model ends",
    task="Beyond some radius the picture r L(r) of a radius shrinks again: the image folds over, "
    "which no lens does. Give this largest valid ideal radius for k = (k1, k2), or np.inf if "
    "there is none.",
    stub='''def my_fold_radius(k):
    """Give the largest radius r up to which r L(r) grows; np.inf if it always does."""
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
    misconceptions=(
        Misconception(
            "k2 = 0 left out",
            "Right where k2 is not 0. Without k2 the equation is no quadratic one, and its "
            "formula divides by 0: r² = −1 / (3 k1).",
            _unless(lambda k: k[1] == 0, None),
            variants=(_unless(lambda k: k[1] == 0),),
        ),
        Misconception(
            "root of L",
            "There L(r) = 0: all points fall into the centre. The picture folds before that, "
            "where r L(r) stops growing.",
            lambda k: _smallest_root(*k),
        ),
        Misconception(
            "derivative of L alone",
            "You looked where L itself is flat. It is r L(r) that must grow; its slope is "
            "1 + 3 k1 r² + 5 k2 r⁴.",
            lambda k: np.sqrt(-k[0] / (2 * k[1])) if k[0] * k[1] < 0 else np.inf,
        ),
        Misconception(
            "square root forgotten",
            "The equation is one for r²: take the root of its root.",
            lambda k: fold_radius(k) ** 2,
        ),
        Misconception(
            "radius in the picture",
            "That is how far from the centre the fold is seen, r L(r). Asked is the ideal radius.",
            _seen_radius,
        ),
        Misconception(
            "k2 left out",
            "You left k2 out: √(−1 / 3k1) is the answer for k2 = 0 only.",
            lambda k: np.sqrt(-1 / (3 * k[0])) if k[0] < 0 else np.inf,
            variants=(lambda k: np.sqrt(-1 / (3 * k[0])) if k[0] < 0 else None,),
        ),
        Misconception(
            "the outer root",
            "There are two radii at which the slope is 0. The picture has folded at the first of "
            "them.",
            lambda k: _smallest_root(3 * k[0], 5 * k[1], largest=True),
        ),
        Misconception(
            "factors of the derivative",
            "The derivative of r³ is 3r², that of r⁵ is 5r⁴: your factors are those of L.",
            lambda k: _smallest_root(2 * k[0], 4 * k[1]),
        ),
        Misconception(
            "complex roots taken for real",
            (
                "Right where there is such a radius. Where the quadratic equation has complex "
                "roots the slope is never 0, and their real part means nothing: np.inf."
            ),
            lambda k: _real_part(3 * k[0], 5 * k[1]),
        ),
        Misconception(
            "lenses without end left out",
            (
                "Right where the picture folds. A lens that never folds has no such radius, and "
                "the task asks for np.inf."
            ),
            lambda k: fold_radius(k) if np.isfinite(fold_radius(k)) else None,
        ),
        Misconception(
            "0 for a lens without end",
            (
                "Right where the picture folds. A lens that never folds is valid everywhere: "
                "np.inf, not 0."
            ),
            lambda k: fold_radius(k) if np.isfinite(fold_radius(k)) else 0.0,
        ),
        Misconception(
            "one root of the formula only",
            (
                "(−b + √(b² − 4ac)) / 2a is one of the two roots: take the smallest that is "
                "positive, of both."
            ),
            lambda k: _one_root(3 * k[0], 5 * k[1], 1.0),
            variants=(lambda k: _one_root(3 * k[0], 5 * k[1], -1.0),),
        ),
        Misconception(
            "factor 3 alone",
            "The slope of k1 r³ is 3 k1 r², that of k2 r⁵ is 5 k2 r⁴: you have 3 for both.",
            lambda k: _smallest_root(3 * k[0], 3 * k[1]),
        ),
        Misconception(
            "sign of the slope",
            (
                "The equation is 1 + 3 k1 r² + 5 k2 r⁴ = 0, with plus signs: k1 itself may be "
                "negative."
            ),
            lambda k: _smallest_root(-3 * k[0], -5 * k[1]),
        ),
        Misconception(
            "k1 positive thought endless",
            "Right where k1 is negative. With k1 > 0 and k2 < 0 the picture folds too: the last "
            "term wins in the end.",
            _unless(lambda k: k[0] >= 0),
        ),
        Misconception(
            "k2 positive thought endless",
            "Right where k2 is not positive. A strongly negative k1 folds the picture before k2 "
            "r⁵ can help.",
            _unless(lambda k: k[1] > 0),
        ),
        Misconception(
            "signs of the roots lost",
            "You took the root of |r²|: where r² is negative there is no radius.",
            lambda k: np.sqrt(np.abs(np.roots([5 * k[1], 3 * k[0], 1.0])).min()),
        ),
        Misconception(
            "slope of r L without the 1",
            "The slope of r L(r) is 1 + 3 k1 r² + 5 k2 r⁴: its 1 is missing.",
            lambda k: np.sqrt(-3 * k[0] / (5 * k[1])) if k[0] * k[1] < 0 else np.inf,
        ),
        Misconception(
            "k1 and k2 exchanged",
            "k1 goes with r², k2 with r⁴: they are exchanged.",
            lambda k: fold_radius(k[::-1]),
        ),
    ),
    reference=fold_radius,
    concepts=("31", "h", "E15"),
)
