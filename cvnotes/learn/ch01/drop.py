"""Drop back to Euclidean space."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded, some_factors
from cvnotes.projective import from_homogeneous, to_homogeneous
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _homogeneous_points(rng: np.random.Generator) -> list[Case]:
    by_hand = np.array([[4.0, 6.0, 2.0], [3.0, 9.0, -3.0], [5.0, 7.0, 1.0]])
    many = to_homogeneous(rounded(rng.uniform(-5, 5, (5, 3))))
    infinite = np.array([[8.0, -6.0, 2.0], [3.0, 1.0, 0.0], [0.0, -2.0, 0.0]])
    return [
        Case((by_hand,)),
        Case((rounded(many * some_factors(rng, 5)[:, None], 6),)),
        Case((infinite,), about="at infinity"),
    ]


def _steps(x_h: Array) -> Array:
    """Return points (n, d) of homogeneous x_h (n, d + 1), or NaN."""
    w = x_h[:, -1:]  # the last coordinate of each point
    x = x_h[:, :-1] / w  # the others, divided by it
    return np.where(w == 0, np.nan, x)


MISTAKES = mistakes_in(_steps,
    ("no division", "You left the last coordinate out without dividing by it.",
     "x_h[:, :-1]"),
    ("sign of the factor lost",
     "The factor of a point may be negative: (3, 9, −3) is the point (−1, −3).",
     "np.where(w == 0, np.nan, x * np.sign(w))", "np.where(w > 0, x, np.nan)"),
    ("divided by another number", "You divided by another number than each point's own factor, "
     "which is its last coordinate.",
     "x_h[:, 1:] / x_h[:, :1]", "x_h[:, :-1] / np.linalg.norm(x_h, axis=1, keepdims=True)",
     "x_h[:, :-1] / x_h.max(axis=1, keepdims=True)",
     "x_h[:, :-1] / np.abs(x_h).max(axis=1, keepdims=True)", "x_h[:, :-1] / x_h[0, -1]"),
    ("multiplied by the last coordinate",
     "You multiplied by the last coordinate, or subtracted it: undo the factor.",
     "x_h[:, :-1] * w", "x_h[:, :-1] - w"),
    ("infinity left out",
     "Right, but points at infinity are missing: each row has its answer, and theirs is NaN.",
     "x[w[:, 0] != 0]"),
    ("one point at infinity spoils all",
     "One point at infinity made all of them NaN: decide row by row, as np.where does.",
     "x if w.all() else np.nan * x"),
)  # fmt: skip


EXERCISE = Exercise(
    name="drop",
    chapter=1,
    title="Drop back to Euclidean space",
    task="Give Euclidean coordinates, shape (n, d), of homogeneous ones, shape (n, d + 1). "
    "A point at infinity has none: its row is NaN.",
    hints=(
        "Undo the factor: which coordinate tells how large it is?",
        "x_h[:, -1:] has shape (n, 1), so that a whole row can be divided by it.",
        "np.where(w == 0, np.nan, …) puts NaN where the last coordinate w is 0.",
    ),
    cases=_homogeneous_points,
    properties=(
        Property("Each point comes back, whatever its factor was, negative ones too."),
        Property("Rows whose last coordinate is 0 are NaN.", about="at infinity"),
    ),
    misconceptions=MISTAKES,
    reference=from_homogeneous,
    steps=_steps,
    concepts=("5", "8", "E3"),
)
