"""The lens by least squares."""

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import radial_distortion
from cvnotes.camera import xy_from_px
from cvnotes.learn.cases.cameras import rounded, some_lens
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes
from cvnotes.tutor.checker.steps import edited


def radial_fit(xy: Array, xy_lens: Array) -> Array:
    """Return k (2,) from ideal and observed points (n, 2) of the plane z = 1."""
    W = np.column_stack([xy, np.zeros(len(xy))])
    at_one = np.eye(4)
    at_one[2, 3] = 1
    return radial_distortion(np.eye(3), at_one, W, xy_lens)


def _ideal_and_seen(rng: Rng) -> list[Case]:
    cases = []
    for n in (3, 12):
        k, _ = some_lens(rng)
        xy = rounded(rng.uniform(-0.5, 0.5, (n, 2)), 2)
        cases.append(Case((xy, rounded(xy + _bent(xy, xy) @ k, 13)), truth=k))
    k, _ = some_lens(rng)
    xy = rounded(rng.uniform(-0.5, 0.5, (9, 2)), 2)
    noisy = xy + _bent(xy, xy) @ k + 2e-3 * rng.standard_normal((9, 2))
    cases.append(Case((xy, rounded(noisy, 4)), about="noisy"))
    return cases


def _bent(xy: Array, radius_of: Array) -> Array:
    """Return (n, 2, 2): what k1 = 1 and k2 = 1 add to each point."""
    r2 = (radius_of**2).sum(1)[:, None]
    return np.stack([xy * r2, xy * r2**2], axis=-1)


def _fit(D: Array, d: Array) -> Array:
    if not (np.isfinite(D).all() and np.isfinite(d).all()):
        return np.full(D.shape[-1], np.nan)  # a point on an axis, divided by its 0
    return np.asarray(np.linalg.lstsq(D.reshape(d.size, -1), d.ravel(), rcond=None)[0])


def _one_by_one(xy: Array, xy_lens: Array) -> Array:
    D, d = _bent(xy, xy), xy_lens - xy
    k1 = _fit(D[..., 0], d)
    return np.array([*k1, *_fit(D[..., 1], d - D[..., 0] * k1)])


def _misfit(k: Array, case: Case) -> float:
    xy, xy_lens = case.args
    return float(((xy_lens - xy - _bent(xy, xy) @ k) ** 2).sum())


def _radii_quotient(xy: Array, xy_lens: Array) -> Array:
    r2 = (xy**2).sum(1)
    D = np.column_stack([r2, r2**2])
    return _fit(D, np.sqrt((xy_lens**2).sum(1) / r2) - 1)


def _powers(xy: Array, first: int, second: int) -> Array:
    r = np.linalg.norm(xy, axis=1)[:, None]
    return np.stack([xy * r**first, xy * r**second], axis=-1)


def _polynomial(xy: Array, xy_lens: Array) -> Array:
    """Return (c, k1, k2) of r'/r = c + k1 r² + k2 r⁴."""
    r2 = (xy**2).sum(1)
    return _fit(np.column_stack([r2**0, r2, r2**2]), np.sqrt((xy_lens**2).sum(1) / r2))


def _fit_with_constant(xy: Array, xy_lens: Array) -> Array:
    return _fit(np.concatenate([xy[..., None], _bent(xy, xy)], axis=-1), xy_lens)


def _steps(xy: Array, xy_lens: Array) -> Any:
    r2 = (xy**2).sum(axis=1, keepdims=True)  # r² of the ideal points
    first = xy * r2  # what k1 is multiplied by
    second = xy * r2**2  # what k2 is multiplied by
    D = np.column_stack([first.ravel(), second.ravel()])  # the matrix of the equations
    d = (xy_lens - xy).ravel()  # what the lens has moved
    return np.linalg.solve(D.T @ D, D.T @ d)


_MISTAKES = mistakes(
    ("r of the observed points", "You computed r from the observed points, as the notes print it: "
     "even exact data give wrong coefficients then. Of which points is L(r)?",
     lambda xy, xy_lens: _fit(_bent(xy, xy_lens), xy_lens - xy),
     lambda xy, xy_lens: _fit(_bent(xy_lens, xy_lens), xy_lens - xy)),
    ("the 1 of L left out", "You fitted all of what was observed: where is a point that the lens "
     "does not move?",
     edited(_steps, "xy_lens - xy", "xy_lens")),
    ("k1 alone first", "You fitted k1 without k2, and then k2 to what was left. Both share the "
     "same points.",
     _one_by_one),
    ("k1 only", "You fitted k1 alone, and gave 0 for k2: the fit has two unknowns.",
     lambda xy, xy_lens: np.append(_fit(_bent(xy, xy)[..., 0], xy_lens - xy), 0)),
    ("r for r²", "Which powers of r does L have? You have others.",
     lambda xy, xy_lens: _fit(_powers(xy, 1, 2), xy_lens - xy),
     lambda xy, xy_lens: _fit(_powers(xy, 2, 3), xy_lens - xy)),
    ("one coordinate only", "You used the equations of one coordinate; with noise those of the "
     "other count too.",
     lambda xy, xy_lens: _fit(_bent(xy, xy)[:, 0], (xy_lens - xy)[:, 0]),
     lambda xy, xy_lens: _fit(_bent(xy, xy)[:, 1], (xy_lens - xy)[:, 1])),
    ("each coordinate by itself", "You fitted x and y separately; both share k1 and k2.",
     lambda xy, xy_lens: sum(_fit(_bent(xy, xy)[:, i], (xy_lens - xy)[:, i]) for i in (0, 1)) / 2),
    ("the factors, not the points", "You fitted L itself, the quotient of observed and ideal: "
     "right on exact data. With noise, dividing by a small coordinate makes it large.",
     lambda xy, xy_lens: _fit(_bent(xy, xy) / xy[..., None], xy_lens / xy - 1), _radii_quotient),
    ("not multiplied by x and y", "You fitted k1 r² + k2 r⁴ itself to what the lens has moved: "
     "which factor is left out?",
     lambda xy, xy_lens: _fit(_bent(xy, xy) / xy[..., None], xy_lens - xy)),
    ("a constant fitted too", "You fitted L with a constant of its own, which is known. On exact "
     "data that is the same, with noise it is not.",
     lambda xy, xy_lens: _polynomial(xy, xy_lens)[1:],
     lambda xy, xy_lens: _fit_with_constant(xy, xy_lens)[1:]),
    ("the first points only", "Right on exact data. With noise every point counts.",
     lambda xy, xy_lens: radial_fit(xy[:2], xy_lens[:2]),
     lambda xy, xy_lens: _fit(_bent(xy[:1], xy[:1]), (xy_lens - xy)[:1]),
     lambda xy, xy_lens: radial_fit(xy[:3], xy_lens[:3])),
)  # fmt: skip

RADIAL = Exercise(
    name="radial_fit",
    chapter=7,
    title="The lens by least squares",
    task="Give k = (k1, k2) from points of the plane z = 1: where they should be (xy, ideal) and "
    "where they were seen (xy_lens), shape (n, 2) each. No tangential terms.",
    stub='''def my_radial_fit(xy, xy_lens):
    """Return k (2,) with xy_lens = (1 + k1 r² + k2 r⁴) xy, by least squares."""
    ...''',
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
    reference=radial_fit,
    steps=_steps,
    concepts=("62", "63", "E34", "E35"),
    sources=(radial_distortion, xy_from_px),
)
