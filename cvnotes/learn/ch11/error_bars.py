"""How sure is each parameter."""

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration.refinement import covariance
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _fits(rng: np.random.Generator) -> list[Case]:
    line = np.array([[1.0, 0], [1, 1], [1, 2], [1, 3], [1, 4]])
    J = rounded(rng.normal(size=(9, 3)) @ np.array([[2, 1, 0], [0, 1, 1], [0, 0, 3.0]]), 1)
    return [
        Case((line, np.array([0.1, -0.2, 0.0, 0.2, -0.1]))),
        Case((J, rounded(rng.normal(size=9)))),
    ]


def error_bars(J: Array, r: Array) -> Array:
    """Return the standard deviations (p,)."""
    n, p = J.shape
    s2 = r @ r / (n - p)  # σ², the variance of the residuals
    N = J.T @ J  # JᵀJ
    C = np.linalg.inv(N)  # (JᵀJ)⁻¹
    return np.sqrt(s2 * np.diag(C))


_MISTAKES = mistakes_in(error_bars,
    ("n for n − p", "You divided Σ r² by n: how many of the n residuals did the fit use up?",
     ("(n - p)", "n")),
    ("noise of 1", "That is for noise of one pixel; what do the residuals say of it?",
     ("r @ r / (n - p)", "1")),
    ("correlations left out", "You inverted the diagonal of JᵀJ. That holds the other parameters "
     "fixed, and makes error bars too short.",
     ("np.linalg.inv(N)", "1 / N")),
    ("standard deviation about the mean", "You took the residuals about their mean; σ² is of the "
     "residuals themselves, less what the fit used up.",
     ("r @ r / (n - p)", "r.var()"), ("r @ r / (n - p)", "r.var(ddof=1)"),
     ("r @ r / (n - p)", "r.var(ddof=p)")),
    ("σ for σ²", "You multiplied by σ under the root, or by σ² outside of it: what has the unit "
     "of a variance, what that of a standard deviation?",
     ("s2 * ", "np.sqrt(s2) * "), "s2 * np.sqrt(np.diag(C))"),
    ("root of the diagonal first", "You took roots before inverting: that is not the same.",
     "np.sqrt(s2) / np.diag(N)", "1 / np.sqrt(np.diag(N))"),
    ("covariance matrix", "That is the whole covariance; the variances stand on its diagonal.",
     "s2 * C"),
    ("σ alone", "That is the noise, one number; asked is how it gets into each parameter.",
     "np.full(p, np.sqrt(s2))"),
)  # fmt: skip

EXERCISE = Exercise(
    name="error_bars",
    chapter=11,
    title="How sure is each parameter?",
    task="At the end of a least-squares fit there are the Jacobian J (n, p) of the residuals and "
    "the residuals r (n,). Give the standard deviation of each parameter, (p,); the noise is "
    "estimated from r.",
    hints=(
        "The covariance of the parameters is σ² (JᵀJ)⁻¹.",
        "σ² = Σ r² / (n − p): p of the n residuals were spent on the parameters.",
        "Standard deviations are the roots of its diagonal.",
    ),
    cases=_fits,
    properties=(Property("They are the roots of the diagonal of σ² (JᵀJ)⁻¹, with σ² from n − p."),),
    misconceptions=_MISTAKES,
    steps=error_bars,
    concepts=("m", "64"),
    sources=(error_bars, covariance),
)
