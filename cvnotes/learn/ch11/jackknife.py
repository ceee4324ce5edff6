"""Error bars from leaving out."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import lens_factor, rounded, some_lens
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def jackknife(xy: Array, xy_lens: Array) -> Array:
    """Give the jackknife's standard deviations (2,) of k1 and k2."""
    v = len(xy)  # the number of views
    r2 = (xy**2).sum(axis=2, keepdims=True)  # r² of the ideal points
    D = np.stack([xy * r2, xy * r2**2], axis=3).reshape(v, -1, 2)  # the equations of each view
    d = (xy_lens - xy).reshape(v, -1, 1)  # what the lens has moved
    N = D.mT @ D  # DᵀD of each view
    g = D.mT @ d  # Dᵀd of each view
    k = np.linalg.solve(N.sum(axis=0) - N, g.sum(axis=0) - g)  # k without each view
    s2 = (v - 1) / v * ((k - k.mean(axis=0)) ** 2).sum(axis=0)  # the variances of the jackknife
    return np.asarray(np.sqrt(s2[:, 0]))


def _seen(rng: np.random.Generator) -> list[Case]:
    cases = []
    for v, n in ((3, 2), (7, 5)):
        xy = rounded(rng.uniform(-0.5, 0.5, (v, n, 2)), 2)
        k, _ = some_lens(rng)
        # what is wrong with a view is wrong with all of its points
        off = 1e-2 * rng.standard_normal((v, 1, 2)) + 1e-3 * rng.standard_normal(xy.shape)
        cases.append(Case((xy, rounded(xy * lens_factor(xy, k) + off, 4))))
    return cases


_FACTOR, _LEFT_OUT = "(v - 1) / v * ", "N.sum(axis=0) - N, g.sum(axis=0) - g"
_MISTAKES = mistakes_in(jackknife,
    ("an ordinary variance", "Estimates without one view are nearly the same, for they share all "
     "others: their ordinary variance is far too small. Which factor makes up for it?",
     (_FACTOR, "1 / (v - 1) * "), (_FACTOR, "1 / v * "), (_FACTOR, "1 / (v * (v - 1)) * "),
     (_FACTOR, "1 / v**2 * ")),
    ("points left out", "You left out one point after the other. What is wrong with a view is "
     "wrong with all of its points: leave out whole views.",
     lambda xy, xy_lens: jackknife(xy.reshape(-1, 1, 2), xy_lens.reshape(-1, 1, 2))),
    ("each view alone", "You fitted each view alone; leave it out, and fit all others.",
     (_LEFT_OUT, "N, g", _FACTOR, "1 / (v - 1) * "),
     (_LEFT_OUT, "N, g", _FACTOR, "1 / (v * (v - 1)) * "),
     (_LEFT_OUT, "N, g", _FACTOR, "1 / v * "), (_LEFT_OUT, "N, g")),
)  # fmt: skip

EXERCISE = Exercise(
    name="jackknife",
    chapter=11,
    title="Your own jackknife",
    task="In each of v views n points of the plane z = 1 should be at xy and were seen at xy_lens, "
    "shape (v, n, 2) each. Fit k = (k1, k2) by least squares to all views but one, for each view "
    "left out in turn. From the scatter of these v results about their mean, give the jackknife's "
    "standard deviations (2,) of k.",
    hints=(
        "One fit: xy_lens − xy = (k1 r² + k2 r⁴) xy, two rows for each point of the views that "
        "stay; np.linalg.lstsq. np.delete(xy, i, axis=0) leaves view i out.",
        "If x_i is left out of a mean, it moves by (x̄ − x_i)/(v − 1) only. So the squares are not "
        "divided by v − 1: multiply.",
        "With k (v, 2), a row for each view left out: "
        "np.sqrt((v − 1)/v · ((k − k.mean(axis=0))**2).sum(axis=0)).",
    ),
    cases=_seen,
    properties=(Property("They are the scatter of k between views, as large as it is."),),
    misconceptions=_MISTAKES,
    steps=jackknife,
    concepts=("m", "62"),
)
