"""How sure is each parameter."""

# A mistake is often an argument that was left out.

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration.refinement import covariance
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes
from cvnotes.tutor.checker.steps import edited


def error_bars(J: Array, r: Array) -> Array:
    """Return the standard deviations (p,) of parameters from Jacobian (n, p) and residuals (n,)."""
    n, p = J.shape
    return np.asarray(np.sqrt(r @ r / (n - p) * np.diag(np.linalg.inv(J.T @ J))))


def _fits(rng: Rng) -> list[Case]:
    line = np.array([[1.0, 0], [1, 1], [1, 2], [1, 3], [1, 4]])
    J = rounded(rng.normal(size=(9, 3)) @ np.array([[2, 1, 0], [0, 1, 1], [0, 0, 3.0]]), 1)
    return [
        Case((line, np.array([0.1, -0.2, 0.0, 0.2, -0.1]))),
        Case((J, rounded(rng.normal(size=9)))),
    ]


def _steps(J: Array, r: Array) -> Any:
    n, p = J.shape
    s2 = r @ r / (n - p)  # σ², the variance of the residuals
    N = J.T @ J  # JᵀJ
    C = np.linalg.inv(N)  # (JᵀJ)⁻¹
    return np.sqrt(s2 * np.diag(C))


_MISTAKES = mistakes(
    ("n for n − p", "You divided Σ r² by n: how many of the n residuals did the fit use up?",
     edited(_steps, "(n - p)", "n")),
    ("noise of 1", "That is for noise of one pixel; what do the residuals say of it?",
     edited(_steps, "r @ r / (n - p)", "1")),
    ("correlations left out", "You inverted the diagonal of JᵀJ. That holds the other parameters "
     "fixed, and makes error bars too short.",
     edited(_steps, "np.linalg.inv(N)", "1 / N")),
    ("standard deviation about the mean", "You took the residuals about their mean; σ² is of the "
     "residuals themselves, less what the fit used up.",
     edited(_steps, "r @ r / (n - p)", "r.var()"),
     edited(_steps, "r @ r / (n - p)", "r.var(ddof=1)"),
     edited(_steps, "r @ r / (n - p)", "r.var(ddof=p)")),
    ("σ for σ²", "You multiplied by σ under the root: what has the unit of a variance?",
     edited(_steps, "s2 * ", "np.sqrt(s2) * ")),
    ("σ² outside of the root", "You multiplied the root by σ²: what has the unit of a standard "
     "deviation?",
     edited(_steps, "np.sqrt(s2 * np.diag(C))", "s2 * np.sqrt(np.diag(C))")),
    ("pairs for residuals", "You counted half as many residuals, or twice as many: r has n of "
     "them.",
     edited(_steps, "(n - p)", "(n / 2 - p)"), edited(_steps, "(n - p)", "(2 * n - p)")),
    ("root of the diagonal first", "You took the roots of the diagonal before inverting: that is "
     "not the same.",
     edited(_steps, "np.sqrt(s2 * np.diag(C))", "np.sqrt(s2) / np.diag(N)"),
     edited(_steps, "np.sqrt(s2 * np.diag(C))", "1 / np.sqrt(np.diag(N))")),
    ("covariance matrix", "That is the whole covariance; the variances stand on its diagonal.",
     edited(_steps, "np.sqrt(s2 * np.diag(C))", "s2 * C")),
    ("σ alone", "That is the noise, one number; asked is how it gets into each parameter.",
     edited(_steps, "np.sqrt(s2 * np.diag(C))", "np.full(p, np.sqrt(s2))")),
)  # fmt: skip

ERRORS = Exercise(
    name="error_bars",
    chapter=9,
    title="How sure is each parameter?",
    task="At the end of a least-squares fit there are the Jacobian J (n, p) of the residuals and "
    "the residuals r (n,). Give the standard deviation of each parameter, (p,); the noise is "
    "estimated from r.",
    stub='''def my_error_bars(J, r):
    """Return the standard deviations (p,)."""
    ...''',
    hints=(
        "The covariance of the parameters is σ² (JᵀJ)⁻¹.",
        "σ² = Σ r² / (n − p): p of the n residuals were spent on the parameters.",
        "Standard deviations are the roots of its diagonal.",
    ),
    cases=_fits,
    properties=(Property("They are the roots of the diagonal of σ² (JᵀJ)⁻¹, with σ² from n − p."),),
    misconceptions=_MISTAKES,
    reference=error_bars,
    steps=_steps,
    concepts=("m", "64"),
    sources=(error_bars, covariance),
)
