"""Hartley's normalisation."""

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import normaliser
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.equality import up_to_scale
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property
from cvnotes.projective import apply


def _similarity(s: float | Array, move: Array) -> Array:
    N = np.diag([*np.broadcast_to(s, 2), 1.0])
    N[:2, 2] = move
    return N


def _centred(x: Array) -> tuple[Array, float]:
    c = x.mean(0)
    return c, float(np.linalg.norm(x - c, axis=1).mean())


def _mean_distance(N: Array, case: Case) -> float:
    return float(np.linalg.norm(apply(N, case.args[0]), axis=1).mean())


def _scaled_by(x: Array, distance: float) -> Array:
    s = np.sqrt(2) / distance
    return _similarity(s, -s * x.mean(0))


def _scaled_about(x: Array, centre: Array, distances_from: Array) -> Array:
    s = np.sqrt(2) / np.linalg.norm(x - distances_from, axis=1).mean()
    return _similarity(s, -s * centre)


NORMALISER = Exercise(
    name="normaliser",
    chapter=6,
    title="Hartley's normalisation",
    task="Give the matrix N (3, 3), a shift and a scale that is the same in both directions, that "
    "moves points x (n, 2) so that their centroid is 0 and their mean distance from it √2.",
    stub='''def my_normaliser(x):
    """Give N (3, 3): N x has centroid 0 and mean distance √2 from it."""
    ...''',
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
    misconceptions=(
        Misconception(
            "mean distance 1",
            "The mean distance became 1; asked is √2, so that a typical point is (1, 1).",
            lambda x: _similarity(1 / _centred(x)[1], -_centred(x)[0] / _centred(x)[1]),
        ),
        Misconception(
            "each direction by itself",
            "You divided each direction by its own standard deviation; one scale for both is "
            "asked, so that circles stay circles.",
            lambda x: _similarity(1 / x.std(0), -x.mean(0) / x.std(0)),
            variants=(lambda x: _similarity(1 / x.std(0, ddof=1), -x.mean(0) / x.std(0, ddof=1)),),
        ),
        Misconception(
            "root mean square distance",
            "You took the root of the mean squared distance; asked is the mean distance.",
            lambda x: _scaled_by(x, float(np.sqrt(((x - x.mean(0)) ** 2).sum(1).mean()))),
        ),
        Misconception(
            "shift not scaled",
            "N first scales and then shifts by what stands in its last column, so the centroid in "
            "there has to be scaled too: −s c.",
            lambda x: _similarity(np.sqrt(2) / _centred(x)[1], -_centred(x)[0]),
        ),
        Misconception(
            "shift in the wrong direction",
            "Your shift moves the centroid away from 0: its sign is wrong.",
            lambda x: _similarity(
                np.sqrt(2) / _centred(x)[1], np.sqrt(2) / _centred(x)[1] * _centred(x)[0]
            ),
        ),
        Misconception(
            "the inverse",
            "That is N⁻¹: it brings normalised points back.",
            lambda x: np.linalg.inv(normaliser(x)),
        ),
        Misconception(
            "distance from the origin",
            "You took distances from (0, 0); take them from the centroid.",
            lambda x: _scaled_by(x, float(np.linalg.norm(x, axis=1).mean())),
        ),
        Misconception(
            "not centred",
            "The scale is right, but the points are not shifted to their centroid.",
            lambda x: _similarity(np.sqrt(2) / _centred(x)[1], np.zeros(2)),
        ),
        Misconception(
            "standard deviation of the distances",
            (
                "You divided by the standard deviation of the distances; asked is that their mean "
                "is √2."
            ),
            lambda x: _scaled_by(x, float(np.std(np.linalg.norm(x - x.mean(0), axis=1)))),
            variants=(
                lambda x: _scaled_by(
                    x, float(np.std(np.linalg.norm(x - x.mean(0), axis=1), ddof=1))
                ),
            ),
        ),
        Misconception(
            "standard deviation of all coordinates",
            (
                "You divided by the standard deviation of all coordinates together; asked is the "
                "mean distance from the centroid."
            ),
            lambda x: _scaled_by(x, float(np.std(x))),
            variants=(lambda x: _similarity(1 / float(np.std(x)), -x.mean(0) / np.std(x)),),
        ),
        Misconception(
            "sum of the distances",
            "You took the sum of the distances; asked is their mean.",
            lambda x: _scaled_by(x, _centred(x)[1] * len(x)),
        ),
        Misconception(
            "upside down",
            "You multiplied by the mean distance: s = √2 / d.",
            lambda x: _similarity(
                _centred(x)[1] / np.sqrt(2), -_centred(x)[1] / np.sqrt(2) * x.mean(0)
            ),
        ),
        Misconception(
            "mean distance 2",
            "The mean distance became 2; asked is √2.",
            lambda x: _scaled_by(x, _centred(x)[1] / np.sqrt(2)),
        ),
        Misconception(
            "the largest distance",
            "The largest distance became √2; asked is the mean.",
            lambda x: _scaled_by(x, float(np.linalg.norm(x - x.mean(0), axis=1).max())),
        ),
        Misconception(
            "transposed",
            "Your shift stands in the last row; it belongs into the last column.",
            lambda x: normaliser(x).T,
        ),
        Misconception(
            "n − 1 for n",
            "You divided the sum of the distances by n − 1; the mean divides by n.",
            lambda x: _scaled_by(x, _centred(x)[1] * len(x) / (len(x) - 1)),
        ),
        Misconception(
            "moved only",
            "The points are moved to their centroid, but not scaled.",
            lambda x: _similarity(1.0, -x.mean(0)),
        ),
        Misconception(
            "root mean square distance, n − 1",
            (
                "You took the root of the sum of squared distances by n − 1; asked is the mean "
                "distance."
            ),
            lambda x: _scaled_by(x, float(np.sqrt(((x - x.mean(0)) ** 2).sum() / (len(x) - 1)))),
        ),
        Misconception(
            "one mean for both coordinates",
            "x.mean() is the mean of all numbers; the centroid is x.mean(axis=0).",
            lambda x: _scaled_about(x, np.full(2, x.mean()), x.mean(0)),
            variants=(lambda x: _scaled_about(x, np.full(2, x.mean()), np.full(2, x.mean())),),
        ),
        Misconception(
            "the points, not the matrix",
            "These are the normalised points; asked is the matrix that makes them.",
            lambda x: apply(normaliser(x), x),
        ),
        Misconception(
            "median for mean",
            "The centroid is the mean; you took the median.",
            lambda x: _scaled_about(x, np.median(x, axis=0), np.median(x, axis=0)),
            variants=(
                lambda x: _scaled_about(x, np.median(x, axis=0), x.mean(0)),
                lambda x: _scaled_by(x, float(np.median(np.linalg.norm(x - x.mean(0), axis=1)))),
            ),
        ),
        Misconception(
            "scaled to [−1, 1]",
            "You scaled so that all points lie between −1 and 1; asked is a mean distance of √2 "
            "from the centroid.",
            lambda x: _similarity(
                2 / np.ptp(x, axis=0), -2 * (x.max(0) + x.min(0)) / 2 / np.ptp(x, axis=0)
            ),
            variants=(
                lambda x: _similarity(
                    1 / np.abs(x - x.mean(0)).max(), -x.mean(0) / np.abs(x - x.mean(0)).max()
                ),
            ),
        ),
        Misconception(
            "scaled by the largest number",
            "You divided by the largest coordinate; asked is a mean distance of √2 from the "
            "centroid.",
            lambda x: _similarity(1 / x.max(), -x.mean(0) / x.max()),
            variants=(lambda x: _similarity(1 / x.max(0), -x.mean(0) / x.max(0)),),
        ),
        Misconception(
            "mean distance in each direction",
            "You scaled each direction by its own mean distance; one scale for both is asked.",
            lambda x: _similarity(
                1 / np.abs(x - x.mean(0)).mean(0), -x.mean(0) / np.abs(x - x.mean(0)).mean(0)
            ),
            variants=(
                lambda x: _similarity(
                    np.sqrt(2) / np.abs(x - x.mean(0)).mean(0),
                    -np.sqrt(2) * x.mean(0) / np.abs(x - x.mean(0)).mean(0),
                ),
            ),
        ),
        Misconception(
            "each direction by itself, √2",
            "You divided each direction by its own standard deviation, and multiplied by √2; one "
            "scale for both is asked.",
            lambda x: _similarity(np.sqrt(2) / x.std(0), -np.sqrt(2) * x.mean(0) / x.std(0)),
        ),
        Misconception(
            "mean square distance",
            "You took the mean of the squared distances, without a root; asked is the mean "
            "distance.",
            lambda x: _scaled_by(x, float(((x - x.mean(0)) ** 2).sum(1).mean())),
        ),
        Misconception(
            "shift scaled twice",
            "The shift in the last column is −s c: you multiplied by s twice.",
            lambda x: _similarity(
                np.sqrt(2) / _centred(x)[1], -2 * x.mean(0) / _centred(x)[1] ** 2
            ),
        ),
        Misconception(
            "no scale in v",
            "Both directions are scaled: N[1, 1] = s too.",
            lambda x: normaliser(x) * [[1, 1, 1], [1, 0, 1], [1, 1, 1]] + np.diag([0, 1, 0]),
            variants=(
                lambda x: normaliser(x) * [[0, 1, 1], [1, 1, 1], [1, 1, 1]] + np.diag([1, 0, 0]),
            ),
        ),
        Misconception(
            "shift exchanged",
            "c_x and c_y are exchanged in the last column.",
            lambda x: _similarity(
                np.sqrt(2) / _centred(x)[1], -np.sqrt(2) / _centred(x)[1] * x.mean(0)[::-1]
            ),
        ),
        Misconception(
            "divided by √2",
            "The mean distance became 1/√2, or 1/2: s = √2 / d.",
            lambda x: _scaled_by(x, _centred(x)[1] * 2),
            variants=(lambda x: _scaled_by(x, _centred(x)[1] * 2 * np.sqrt(2)),),
        ),
        Misconception(
            "sum of |x| and |y|",
            "You took |Δx| + |Δy| for the distance; it is √(Δx² + Δy²).",
            lambda x: _scaled_by(x, float(np.abs(x - x.mean(0)).sum(1).mean())),
        ),
        Misconception(
            "length of all differences",
            "You took the length of all differences together: axis=1 gives one for each point, "
            "then the mean.",
            lambda x: _scaled_by(x, float(np.linalg.norm(x - x.mean(0)))),
        ),
    ),
    reference=normaliser,
    same=up_to_scale,
    concepts=("a", "E26"),
)
