"""How sure is each parameter."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration.refinement import covariance
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def error_bars(J: Array, r: Array) -> Array:
    """Give the standard deviations (p,) of parameters from Jacobian (n, p) and residuals (n,)."""
    n, p = J.shape
    return np.asarray(np.sqrt(r @ r / (n - p) * np.diag(np.linalg.inv(J.T @ J))))


def _fits(rng: Rng) -> list[Case]:
    line = np.array([[1.0, 0], [1, 1], [1, 2], [1, 3], [1, 4]])
    J = rounded(rng.normal(size=(9, 3)) @ np.array([[2, 1, 0], [0, 1, 1], [0, 0, 3.0]]), 1)
    return [
        Case((line, np.array([0.1, -0.2, 0.0, 0.2, -0.1]))),
        Case((J, rounded(rng.normal(size=9)))),
    ]


def _with_variance(J: Array, variance: float) -> Array:
    return np.sqrt(variance * np.diag(np.linalg.inv(J.T @ J)))


ERRORS = Exercise(
    name="error_bars",
    chapter=9,
    title="How sure is each parameter?",
    task="At the end of a least-squares fit there are the Jacobian J (n, p) of the residuals and "
    "the residuals r (n,). Give the standard deviation of each parameter, (p,); the noise is "
    "estimated from r.",
    stub='''def my_error_bars(J, r):
    """Give the standard deviations (p,)."""
    ...''',
    hints=(
        "The covariance of the parameters is σ² (JᵀJ)⁻¹.",
        "σ² = Σ r² / (n − p): p of the n residuals were spent on the parameters.",
        "Standard deviations are the roots of its diagonal.",
    ),
    cases=_fits,
    properties=(Property("They are the roots of the diagonal of σ² (JᵀJ)⁻¹, with σ² from n − p."),),
    misconceptions=(
        Misconception(
            "n for n − p",
            "You divided Σ r² by n. The fit has used up p residuals: n − p.",
            lambda J, r: _with_variance(J, r @ r / len(r)),
        ),
        Misconception(
            "noise of 1",
            "That is for noise of one pixel; estimate σ² from the residuals.",
            lambda J, r: _with_variance(J, 1.0),
        ),
        Misconception(
            "correlations left out",
            "You inverted the diagonal of JᵀJ. That holds the other parameters fixed, and makes "
            "error bars too short: invert the whole matrix, then take the diagonal.",
            lambda J, r: np.sqrt(r @ r / (len(r) - J.shape[1]) / np.diag(J.T @ J)),
        ),
        Misconception(
            "inverse forgotten",
            "You took the diagonal of JᵀJ itself: a parameter that moves the residuals much is "
            "known well, not badly.",
            lambda J, r: np.sqrt(r @ r / (len(r) - J.shape[1]) * np.diag(J.T @ J)),
        ),
        Misconception(
            "σ for σ²",
            "You used σ where σ² belongs: σ² stands before (JᵀJ)⁻¹, and the root is taken of both.",
            lambda J, r: _with_variance(J, np.sqrt(r @ r / (len(r) - J.shape[1]))),
        ),
        Misconception(
            "standard deviation about the mean",
            (
                "np.std(r) subtracts the mean of r first, which the fit knows nothing of, and "
                "divides by n: σ² = Σ r² / (n − p)."
            ),
            lambda J, r: _with_variance(J, r.var()),
        ),
        Misconception(
            "n − 1",
            "You divided Σ r² by n − 1. The fit has used up p residuals: n − p.",
            lambda J, r: _with_variance(J, r @ r / (len(r) - 1)),
            variants=(lambda J, r: _with_variance(J, r.var(ddof=1)),),
        ),
        Misconception(
            "n + p",
            "The parameters use up residuals: n − p, not n + p.",
            lambda J, r: _with_variance(J, r @ r / (len(r) + J.shape[1])),
        ),
        Misconception(
            "sum of squares for σ²",
            "You took Σ r² itself; divide it by n − p.",
            lambda J, r: _with_variance(J, r @ r),
        ),
        Misconception(
            "covariance matrix",
            "That is the whole covariance; asked are the roots of its diagonal.",
            lambda J, r: r @ r / (len(r) - J.shape[1]) * np.linalg.inv(J.T @ J),
        ),
        Misconception(
            "rows of J⁻¹",
            (
                "You added the entries of J⁻¹ without squaring them: a standard deviation is the "
                "root of a sum of squares."
            ),
            lambda J, r: np.sqrt(r @ r / (len(r) - J.shape[1])) * np.abs(np.linalg.pinv(J)).sum(1),
        ),
        Misconception(
            "σ alone",
            (
                "σ is the noise of one residual; each parameter has its own part of it, from "
                "(JᵀJ)⁻¹."
            ),
            lambda J, r: np.full(J.shape[1], np.sqrt(r @ r / (len(r) - J.shape[1]))),
        ),
        Misconception(
            "number of parameters for n",
            "You divided Σ r² by p: n − p.",
            lambda J, r: _with_variance(J, r @ r / J.shape[1]),
        ),
        Misconception(
            "σ² outside of the root",
            "You have σ² before the root, which is one σ too many: σ² stands under the root.",
            lambda J, r: r @ r / (len(r) - J.shape[1]) * np.sqrt(np.diag(np.linalg.inv(J.T @ J))),
        ),
        Misconception(
            "divided by the root of n",
            "You divided by √n, as for a mean; (JᵀJ)⁻¹ has counted the residuals already.",
            lambda J, r: error_bars(J, r) / np.sqrt(len(r)),
        ),
        Misconception(
            "sum of the residuals",
            "You added residuals without squaring them; they cancel: σ² = Σ r² / (n − p).",
            lambda J, r: _with_variance(J, np.abs(r).sum() / (len(r) - J.shape[1])),
            variants=(lambda J, r: _with_variance(J, r.sum() ** 2 / (len(r) - J.shape[1])),),
        ),
        Misconception(
            "mean of absolute values",
            "You took the mean of |r| for σ: σ² = Σ r² / (n − p).",
            lambda J, r: _with_variance(J, np.abs(r).mean() ** 2),
            variants=(lambda J, r: _with_variance(J, np.abs(r).mean()),),
        ),
        Misconception(
            "root of the diagonal first",
            "You took the diagonal of JᵀJ, or its root, before the inverse: invert the whole "
            "matrix first.",
            lambda J, r: np.sqrt(r @ r / (len(r) - J.shape[1])) / np.diag(J.T @ J),
            variants=(lambda J, r: 1 / np.sqrt(np.diag(J.T @ J)),),
        ),
        Misconception(
            "J not transposed",
            "You used J Jᵀ, which is (n, n), one row for each residual: JᵀJ is (p, p).",
            lambda J, r: np.sqrt(r @ r / (len(r) - J.shape[1]) * np.abs(np.diag(J @ J.T))),
            variants=(
                lambda J, r: np.sqrt(
                    r @ r / (len(r) - J.shape[1]) * np.abs(np.diag(np.linalg.pinv(J @ J.T)))
                ),
            ),
        ),
        Misconception(
            "pairs for residuals",
            "You counted half as many residuals: r has n of them already.",
            lambda J, r: (
                _with_variance(J, r @ r / (len(r) / 2 - J.shape[1]))
                if len(r) > 2 * J.shape[1]
                else None
            ),
            variants=(lambda J, r: _with_variance(J, r @ r / (2 * len(r) - J.shape[1])),),
        ),
        Misconception(
            "two or three sigma",
            "You gave a wider interval: asked is one standard deviation.",
            lambda J, r: 1.96 * error_bars(J, r),
            variants=(
                lambda J, r: 2 * error_bars(J, r),
                lambda J, r: 3 * error_bars(J, r),
            ),
        ),
        Misconception(
            "n − p − 1",
            "You divided Σ r² by n − p − 1: p counts all parameters already.",
            lambda J, r: _with_variance(J, r @ r / (len(r) - J.shape[1] - 1)),
        ),
    ),
    reference=error_bars,
    concepts=("m", "64"),
    sources=(error_bars, covariance),
)
