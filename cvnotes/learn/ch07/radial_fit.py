"""The lens by least squares."""

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import radial_distortion
from cvnotes.camera import xy_from_px
from cvnotes.learn.cases.cameras import rounded, some_lens
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _ideal_and_seen(rng: np.random.Generator) -> list[Case]:
    cases = []
    for n in (3, 12):
        k, _ = some_lens(rng)
        xy = _some_points(rng, n)
        cases.append(Case((xy, rounded(xy + _bent(xy, xy) @ k, 13)), truth=k))
    k, _ = some_lens(rng)
    xy = _some_points(rng, 9)
    noisy = xy + _bent(xy, xy) @ k + 2e-3 * rng.standard_normal((9, 2))
    cases.append(Case((xy, rounded(noisy, 4)), about="noisy"))
    return cases


def _some_points(rng: np.random.Generator, n: int) -> Array:
    """Return ideal points, one far from the axis and one nearer: k1 and k2 need both."""
    others = rounded(rng.uniform(-0.5, 0.5, (n - 2, 2)), 2)
    return np.vstack([[0.5, -0.4], [-0.2, 0.3], others])


def _bent(xy: Array, radius_of: Array) -> Array:
    """Return (n, 2, 2): what k1 = 1 and k2 = 1 add to each point."""
    r2 = (radius_of**2).sum(1)[:, None]
    return np.stack([xy * r2, xy * r2**2], axis=-1)


def _misfit(k: Array, case: Case) -> float:
    xy, xy_lens = case.args
    return float(((xy_lens - xy - _bent(xy, xy) @ k) ** 2).sum())


def radial_fit(xy: Array, xy_lens: Array) -> Array:
    """Return k (2,) with xy_lens = (1 + k1 r² + k2 r⁴) xy, by least squares."""
    r2 = (xy**2).sum(axis=1, keepdims=True)  # r² of the ideal points
    first = xy * r2  # what k1 is multiplied by
    second = xy * r2**2  # what k2 is multiplied by
    D = np.column_stack([first.ravel(), second.ravel()])  # the matrix of the equations
    d = (xy_lens - xy).ravel()  # what the lens has moved
    return np.linalg.solve(D.T @ D, D.T @ d)


_MISTAKES = mistakes_in(radial_fit,
    ("r of the observed points", "You computed r from the observed points, as the notes print it: "
     "even exact data give wrong coefficients then. Of which points is L(r)?",
     ("(xy**2)", "(xy_lens**2)"), ("(xy**2)", "(xy_lens**2)", "xy * r2", "xy_lens * r2")),
    ("k1 alone first", "You fitted k2 to what k1 had left. Both share the same points.",
     "[k1 := D[:, 0] @ d / (D[:, 0] @ D[:, 0]), "
     "D[:, 1] @ (d - k1 * D[:, 0]) / (D[:, 1] @ D[:, 1])]"),
    ("k1 only", "You fitted k1 alone, and gave 0 for k2: the fit has two unknowns.",
     "[D[:, 0] @ d / (D[:, 0] @ D[:, 0]), 0]"),
    ("r for r²", "Which powers of r does L have? You have others.",
     ("r2**2", "r2", "first = xy * r2", "first = xy * np.sqrt(r2)"), ("r2**2", "r2**1.5")),
    ("one coordinate only", "You used one coordinate; with noise the other counts, too.",
     "np.linalg.lstsq(D[::2], d[::2])[0]", "np.linalg.lstsq(D[1::2], d[1::2])[0]"),
    ("each coordinate by itself", "You fitted x and y separately; both share k1 and k2.",
     "sum(np.linalg.lstsq(D[i::2], d[i::2])[0] for i in (0, 1)) / 2"),
    ("the factors, not the points", "You fitted L itself, the quotient of observed and ideal: "
     "right on exact data. With noise, dividing by a small coordinate makes it large.",
     ("    return", "    D, d = D / xy.reshape(-1, 1), d / xy.ravel(); return"),
     ("xy * r2", "r2", "(xy_lens - xy)", "(np.sqrt((xy_lens**2).sum(axis=1) / r2[:, 0]) - 1)")),
    ("not multiplied by x and y", "You fitted k1 r² + k2 r⁴ itself: which factor is left out?",
     ("    return", "    D = D / xy.reshape(-1, 1); return")),
    ("a constant fitted too", "You fitted L with a constant of its own, which is known. On exact "
     "data that is the same, with noise it is not.",
     ("xy * r2", "r2", "first.ravel()", "np.ones(len(xy)), first.ravel()", "(xy_lens - xy)",
      "np.sqrt((xy_lens**2).sum(axis=1) / r2[:, 0])", "np.linalg.lstsq(D, d)[0][1:]"),
     ("first.ravel()", "xy.ravel(), first.ravel()", "(xy_lens - xy)", "xy_lens",
      "np.linalg.lstsq(D, d)[0][1:]")),
    ("the first points only", "Right on exact data. With noise every point counts.",
     "np.linalg.lstsq(D[:2], d[:2])[0]"),
)  # fmt: skip

EXERCISE = Exercise(
    name="radial_fit",
    chapter=7,
    title="The lens by least squares",
    task="Give k = (k1, k2) from points of the plane z = 1: where they should be (xy, ideal) and "
    "where they were seen (xy_lens), shape (n, 2) each. No tangential terms.",
    hints=(
        "xy_lens − xy = (k1 r² + k2 r⁴) xy is linear in k1 and k2.",
        "Stack it to D k = d with two rows for each point.",
        "r is the radius of the ideal points, as L(r) was defined. np.linalg.lstsq solves it.",
    ),
    cases=_ideal_and_seen,
    properties=(
        Property(
            "On exact data k is the lens that made them.",
            lambda k, c: np.allclose(k, c.truth, rtol=0, atol=1e-6 * c.slack),
        ),
        Property(
            "With noise no other k makes the sum of squares smaller.",
            lambda k, c: _misfit(k, c) <= (1 + 1e-5 * c.slack) * _misfit(c.right, c),
            about="noisy",
        ),
    ),
    misconceptions=_MISTAKES,
    steps=radial_fit,
    concepts=("62", "63", "E34", "E35"),
    sources=(radial_distortion, xy_from_px),
)
