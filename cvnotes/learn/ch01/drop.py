"""Drop back to Euclidean space."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded, some_factors
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import from_homogeneous, to_homogeneous


def _homogeneous_points(rng: Rng) -> list[Case]:
    by_hand = np.array([[4.0, 6.0, 2.0], [3.0, 9.0, -3.0], [5.0, 7.0, 1.0]])
    many = to_homogeneous(rounded(rng.uniform(-5, 5, (5, 3))))
    infinite = np.array([[8.0, -6.0, 2.0], [3.0, 1.0, 0.0], [0.0, -2.0, 0.0]])
    return [
        Case((by_hand,)),
        Case((rounded(many * some_factors(rng, 5)[:, None], 6),)),
        Case((infinite,), about="at infinity"),
    ]


def _divided(x_h: Array, by: Array) -> Array:
    return x_h[:, :-1] / by[:, None]


def _where_finite(x_h: Array, elsewhere: float | Array) -> Array:
    return np.where(x_h[:, -1:] != 0, _divided(x_h, x_h[:, -1]), elsewhere)


DROP = Exercise(
    name="drop",
    chapter=1,
    title="Drop back to Euclidean space",
    task="Give Euclidean coordinates, shape (n, d), of homogeneous ones, shape (n, d + 1). "
    "A point at infinity has none: its row is NaN.",
    stub='''def my_drop(x_h):
    """Give points (n, d) from homogeneous coordinates x_h (n, d + 1); NaN at infinity."""
    ...''',
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
    misconceptions=(
        Misconception(
            "no division",
            "You left out the last coordinate without dividing by it. That is right only where "
            "it is 1.",
            lambda x_h: x_h[:, :-1],
        ),
        Misconception(
            "sign of the factor lost",
            "You divided by the absolute value of the last coordinate, but the factor of a point "
            "may be negative.",
            lambda x_h: np.sign(x_h[:, -1:]) * _where_finite(x_h, np.nan),
        ),
        Misconception(
            "last coordinate kept",
            "You divided but kept the last coordinate, which is now 1: leave it out.",
            lambda x_h: np.where(x_h[:, -1:] != 0, x_h / x_h[:, -1:], np.nan),
        ),
        Misconception(
            "last coordinate kept, infinity too",
            "You divided but kept the last coordinate: leave it out. And where it is 0, the row "
            "is NaN.",
            lambda x_h: x_h / x_h[:, -1:],
        ),
        Misconception(
            "divided by the first coordinate",
            "You divided by the first coordinate; the factor is the last one.",
            lambda x_h: x_h[:, 1:] / x_h[:, :1],
        ),
        Misconception(
            "divided by the length",
            "You divided by the length of the whole vector. That is a fair representative of the "
            "class, but the Euclidean one has a last coordinate of 1.",
            lambda x_h: _divided(x_h, np.linalg.norm(x_h, axis=1)),
        ),
        Misconception(
            "divided by zero",
            "Right, but for points at infinity, which you divided by 0: infinite coordinates say "
            "neither where nor in which direction. The task asks for NaN.",
            lambda x_h: _divided(x_h, x_h[:, -1]),
        ),
        Misconception(
            "infinity sent to the origin",
            "Right, but points at infinity became the origin, which is a place like any other. "
            "The task asks for NaN.",
            lambda x_h: _where_finite(x_h, 0.0),
        ),
        Misconception(
            "infinity left undivided",
            "Right, but rows at infinity came back undivided, as if they were points. "
            "The task asks for NaN.",
            lambda x_h: _where_finite(x_h, x_h[:, :-1]),
        ),
        Misconception(
            "multiplied by the last coordinate",
            "You multiplied by the last coordinate, which is the factor: divide by it.",
            lambda x_h: x_h[:, :-1] * x_h[:, -1:],
        ),
        Misconception(
            "the first point's factor for all",
            (
                "You divided all rows by the last coordinate of the first: each point has a "
                "factor of its own, x_h[:, -1:]."
            ),
            lambda x_h: x_h[:, :-1] / x_h[0, -1],
        ),
        Misconception(
            "last row for last column",
            "x_h[-1] is the last point. The last coordinate of all points is x_h[:, -1:].",
            lambda x_h: x_h[:-1] / x_h[-1],
        ),
        Misconception(
            "infinity left out",
            "Right, but points at infinity are missing: each row has its answer, and theirs is "
            "NaN.",
            lambda x_h: _divided(x_h, x_h[:, -1])[x_h[:, -1] != 0],
        ),
        Misconception(
            "negative factors left out",
            "You gave NaN where the last coordinate is negative. A factor may be negative: (3, 9, "
            "−3) is the point (−1, −3).",
            lambda x_h: np.where(x_h[:, -1:] > 0, _divided(x_h, x_h[:, -1]), np.nan),
        ),
        Misconception(
            "one point at infinity spoils all",
            "One point at infinity made all of them NaN: decide row by row, as np.where does.",
            lambda x_h: _where_finite(x_h, np.nan) + (0 if x_h[:, -1].all() else np.nan),
        ),
        Misconception(
            "last coordinate subtracted",
            "You subtracted the last coordinate; it is a factor: divide by it.",
            lambda x_h: x_h[:, :-1] - x_h[:, -1:],
        ),
        Misconception(
            "divided by the largest",
            "You divided each row by its largest number; the factor is the last one.",
            lambda x_h: x_h[:, :-1] / x_h.max(axis=1, keepdims=True),
            variants=(lambda x_h: x_h[:, :-1] / np.abs(x_h).max(axis=1, keepdims=True),),
        ),
        Misconception(
            "lifted once more",
            "You appended another coordinate; asked is the way back, one coordinate fewer.",
            lambda x_h: np.hstack([x_h, np.ones((len(x_h), 1))]),
        ),
    ),
    reference=from_homogeneous,
    concepts=("5", "8", "E3"),
)
