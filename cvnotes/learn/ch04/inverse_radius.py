"""Back through a lens that folds."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import lens_factor, rounded
from cvnotes.learn.ch04.fold_radius import fold_radius
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def inverse_radius(s: Array, k: Array) -> Array:
    """Return the ideal radii (n,) seen at the radii s (n,); NaN beyond the fold."""
    k1, k2 = k
    z = np.roots([5 * k2, 3 * k1, 1.0])  # r² where the slope of r L(r) is 0
    fold = np.sqrt(min(z[(z.imag == 0) & (z.real > 0)].real, default=100.0))  # the fold's radius
    low, high = 0 * s, fold + 0 * s  # between which bounds each radius is
    for _ in range(40):
        r = (low + high) / 2
        more = r + k1 * r**3 + k2 * r**5 < s
        low, high = np.where(more, r, low), np.where(more, high, r)  # the radii, halved together
    end = fold + k1 * fold**3 + k2 * fold**5  # the radius at which the fold is seen
    return np.where(s <= end, low, np.nan)


def _lenses(rng: np.random.Generator) -> list[Case]:
    # one that only folds, one that rises again behind its fold, and one that magnifies so much that
    # r = s is behind the fold: from there Newton goes astray, and dividing by L leaps to and fro
    low = [[-0.5, -0.04], [-0.7, 0.1], [0.38, -0.085]]
    high = [[-0.3, 0.02], [-0.6, 0.13], [0.42, -0.078]]
    cases = [Case((np.array([0.25, 0.3, 0.4]), np.array([-4 / 3, 0.0])))]
    for k in rounded(rng.uniform(low, high), 3):
        seen = fold_radius(k) * float(lens_factor(np.array([fold_radius(k)]), k)[0])
        parts = rng.uniform([0.3, 0.7, 0.998, 1.001, 1.1], [0.6, 0.9, 0.999, 1.002, 1.5])
        cases.append(Case((rounded(seen * parts, 4), k)))
    s = np.append(0, rounded(rng.uniform(0.3, 1.8, 3)))
    endless = np.array([[-0.25, 0.1], [0.2, 0.0]])
    return [*cases, *(Case((s, k), about="endless") for k in endless)]


def _rounds(n: int, step: str) -> tuple[str, ...]:
    """Return the changes that make n rounds from r = s, r ← step; right beyond the fold."""
    halving = "np.where(more, r, low), np.where(more, high, r)"
    loop = ("range(40)", f"range({n})", "(low + high) / 2", "low", halving, f"{step}, 0")
    return "0 * s, fold", "s, 0", *loop


def _root(s: Array, k: Array, first: bool) -> Array:
    """Return the first or the last radius that is shown at s, on whatever branch."""
    z = [np.roots([k[1], 0, k[0], 0, 1, -one]) for one in s]
    found = [x[(abs(x.imag) < 1e-9) & (x.real >= 0)].real for x in z]
    return np.array([(min if first else max)(x, default=np.nan) for x in found])


_MISTAKES = mistakes_in(inverse_radius,
    ("beyond the fold", "Farther out than the fold is seen, the lens shows nothing: NaN. What you "
     "give there belongs to no lens.",
     "low", "_root(s, k, True)"),
    ("two radii of the fold", "You compared what is seen with the ideal radius of the fold. The "
     "fold itself is seen elsewhere: where?",
     ("s <= end", "s <= fold")),
    ("lenses without a fold", "A lens that never folds shows every radius; yours ends. What is its "
     "largest radius, and what becomes of your bounds?",
     ("default=100.0", "default=np.inf"), ("default=100.0", "default=1.0")),
    ("another branch", "That is on a branch behind the fold. Newton's method goes there where "
     "r = s is behind it already. Hold r between 0 and the fold: how can one halve the way?",
     "_root(s, k, False)",
     *(_rounds(n, "r - (r + k1 * r**3 + k2 * r**5 - s) / (1 + 3 * k1 * r**2 + 5 * k2 * r**4)")
       for n in (10, 20, 30, 50, 100))),
    ("rounds that do not settle", "Dividing by L settles slowly near a fold, and not at all where "
     "L is large. Halving the way from 0 to the fold always does.",
     *(_rounds(n, "s / (1 + k1 * r**2 + k2 * r**4)") for n in (5, 10, 20, 50, 100, 200, 1000))),
)  # fmt: skip

EXERCISE = Exercise(
    name="inverse_radius",
    chapter=4,
    title="Back through a lens that folds",
    task="Give the ideal radii r, shape (n,), that a lens with k = (k1, k2) shows at the radii s, "
    "shape (n,): r L(r) = s, to 1e-6, on the branch that begins at 0. Beyond the fold no lens "
    "shows anything: give NaN there. Lenses may fold, rise again behind their fold, or never fold.",
    hints=(
        "Where is the fold, and at which radius is it seen? What is seen farther out gets NaN.",
        "From 0 to the fold r L(r) grows. So halve: is r L(r) at the middle below s, then r is "
        "in the upper half. For a lens that never folds, begin with a radius that is large enough.",
        "low, high = 0 * s, fold + 0 * s; 60 times: r = (low + high)/2, more = r L(r) < s, "
        "low = np.where(more, r, low), high = np.where(more, high, r). At the end "
        "np.where(s <= fold * L(fold), low, np.nan).",
    ),
    cases=_lenses,
    properties=(
        Property("Your radii are shown at s, and beyond the fold there are none."),
        Property("Without a fold there is a radius for every s.", about="endless"),
    ),
    misconceptions=_MISTAKES,
    steps=inverse_radius,
    concepts=("h", "31", "E13", "E15"),
)
