"""Hartley's normalisation."""

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import normaliser
from cvnotes.learn.cases.cameras import rounded
from cvnotes.projective import apply
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import up_to_scale


def _mean_distance(N: Array, case: Case) -> float:
    return float(np.linalg.norm(apply(N, case.args[0]), axis=1).mean())


def _steps(x: Array) -> Array:
    """Return N (3, 3): N x has centroid 0 and mean distance √2 from it."""
    c = x.mean(axis=0)  # the centroid
    r = np.sqrt(((x - c) ** 2).sum(axis=1))  # the distances from the centroid
    d = r.mean()  # the mean distance
    s = np.sqrt(2) / d  # the scale
    return np.array([[s, 0, -s * c[0]], [0, s, -s * c[1]], [0, 0, 1]])


# One scale for each direction.
_BY_DIRECTION = ("[s, 0, -s * c[0]], [0, s, -s", "[s[0], 0, -s[0] * c[0]], [0, s[1], -s[1]")
_MISTAKES = mistakes_in(_steps,
    ("mean distance 1", "The mean distance became 1; for which one is a typical point (1, 1)?",
     ("np.sqrt(2)", "1")),
    ("each direction by itself", "You scaled each direction by its own spread; one scale for both "
     "is asked, so that circles stay circles.",
     *(("np.sqrt(2) / d", scale, *_BY_DIRECTION) for scale in (
         "1 / x.std(0)", "1 / x.std(0, ddof=1)", "np.sqrt(2) / x.std(0)",
         "1 / np.abs(x - c).mean(0)", "np.sqrt(2) / np.abs(x - c).mean(0)"))),
    ("another spread", "You took a root mean square, or a standard deviation; asked is the mean "
     "distance from the centroid.",
     ("r.mean()", "np.sqrt((r**2).mean())"), ("r.mean()", "np.sqrt((r**2).sum() / (len(x) - 1))"),
     ("r.mean()", "x.std()"), ("np.sqrt(2) / d", "1 / x.std()"), ("r.mean()", "r.std()"),
     ("r.mean()", "r.std(ddof=1)")),
    ("shift not scaled", "N first scales and then shifts by what stands in its last column: so in "
     "which units is the centroid there?",
     ("-s * c", "-c")),
    ("not centred", "The scale is right, but the points are not shifted to their centroid.",
     ("-s * c", "0 * c")),
    ("one mean for both coordinates", "You averaged all numbers; a centroid has two coordinates.",
     ("x.mean(axis=0)", "np.full(2, x.mean())")),
    ("scaled to [−1, 1]", "You scaled by the largest number, or so that all points lie between −1 "
     "and 1; asked is a mean distance from the centroid.",
     ("x.mean(axis=0)", "(x.max(0) + x.min(0)) / 2", "np.sqrt(2) / d", "2 / np.ptp(x, axis=0)",
      *_BY_DIRECTION),
     ("np.sqrt(2) / d", "1 / abs(x - c).max()"), ("np.sqrt(2) / d", "1 / x.max()"),
     ("np.sqrt(2) / d", "1 / x.max(0)", *_BY_DIRECTION)),
    ("the points, not the matrix", "These are normalised points; asked is the matrix for it.",
     lambda x: apply(normaliser(x), x)),
)  # fmt: skip


EXERCISE = Exercise(
    name="normaliser",
    chapter=6,
    title="Hartley's normalisation",
    task="Give the matrix N (3, 3), a shift and a scale that is the same in both directions, that "
    "moves points x (n, 2) so that their centroid is 0 and their mean distance from it √2.",
    hints=(
        "First the centroid c = x.mean(axis=0), then the distances ‖x − c‖ and their mean d.",
        "x ↦ s (x − c) with s = √2 / d.",
        "As a matrix: [[s, 0, −s c_x], [0, s, −s c_y], [0, 0, 1]].",
    ),
    cases=lambda rng: [
        Case((np.array([[1.0, 2.0], [5.0, 2.0], [1.0, 8.0]]),)),
        Case((rounded(rng.uniform([100, 50], [500, 300], (7, 2)), 1),)),
    ],
    properties=(
        Property(
            "The centroid moves to 0.",
            lambda N, c: np.allclose(apply(N, c.args[0]).mean(0), 0, atol=1e-6 * c.slack),
        ),
        Property(
            "The mean distance from it becomes √2.",
            lambda N, c: abs(_mean_distance(N, c) - np.sqrt(2)) < 1e-6 * c.slack,
        ),
        Property("Both directions are scaled alike, and nothing is turned."),
    ),
    misconceptions=_MISTAKES,
    reference=normaliser,
    steps=_steps,
    same=up_to_scale,
    concepts=("a", "E26"),
)
