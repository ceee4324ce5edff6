"""Through the lens."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Lens
from cvnotes.camera.lens import horner, radial_factor
from cvnotes.learn.cases.cameras import lens_factor, rounded, some_lens
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def distort(xy: Array, k: Array, p: Array) -> Array:
    """Give where a lens with k (2,) and p (2,) shows ideal points (n, 2)."""
    return Lens(tuple(k), tuple(p)).distort(xy)


def _ideal_points(rng: Rng) -> list[Case]:
    k, p = some_lens(rng)
    return [
        Case((np.array([[0.5, 0.0], [0.2, 0.4]]), np.array([-0.2, 0.1]), np.array([0.01, 0.02]))),
        Case((rounded(rng.uniform(-0.45, 0.45, (5, 2)), 3), k, p)),
        Case((rounded(rng.uniform(-0.45, 0.45, (5, 2)), 3), k, np.zeros(2)), about="radial"),
    ]


def _through(xy: Array, L: Array, p: Array, factor: float = 2.0, crossed: float = 2.0) -> Array:
    """Apply L and the tangential terms, with a factor that may be wrong in either."""
    x, y = xy.T
    r2 = x * x + y * y
    dx = crossed * p[0] * x * y + p[1] * (r2 + factor * x * x)
    dy = p[0] * (r2 + factor * y * y) + crossed * p[1] * x * y
    return np.asarray(L * xy + np.stack([dx, dy], axis=1))


def _with_r2(xy: Array, k: Array, p: Array, r2: Array) -> Array:
    """Apply L of another r², and the right tangential terms."""
    return np.asarray(xy * (1 + k[0] * r2 + k[1] * r2**2) + _through(xy, 0 * xy, p))


DISTORT = Exercise(
    name="distort",
    chapter=4,
    title="Through the lens",
    task="Give where a lens with radial coefficients k = (k1, k2) and tangential ones "
    "p = (p1, p2) shows ideal points xy (n, 2) of the plane z = 1.",
    stub='''def my_distort(xy, k, p):
    """Give the points (n, 2) that a lens makes of ideal points xy (n, 2)."""
    ...''',
    hints=(
        "r² = x² + y², and L = 1 + k1 r² + k2 r⁴ multiplies both coordinates.",
        "The tangential terms are added: 2 p1 x y + p2 (r² + 2x²) to x, "
        "p1 (r² + 2y²) + 2 p2 x y to y.",
        "x, y = xy.T gives columns; np.stack([…, …], axis=1) makes rows of them again.",
    ),
    cases=_ideal_points,
    properties=(
        Property(
            "Without tangential terms each point moves along its radius, by L(r).", about="radial"
        ),
        Property("With them it is what the notes' formula says."),
    ),
    misconceptions=(
        Misconception(
            "factor 2 lost on the mixed term",
            "The mixed terms are 2 p1 x y and 2 p2 x y: your factor 2 is missing.",
            lambda xy, k, p: _through(xy, lens_factor(xy, k), p, crossed=1.0),
        ),
        Misconception(
            "factor 2 lost on the square",
            "The tangential terms have r² + 2x² and r² + 2y²: your factor 2 is missing.",
            lambda xy, k, p: _through(xy, lens_factor(xy, k), p, factor=1.0),
        ),
        Misconception(
            "factor 2 lost everywhere",
            "The tangential terms have a factor 2 before x y and before x² and y²; both are "
            "missing.",
            lambda xy, k, p: _through(xy, lens_factor(xy, k), p, factor=1.0, crossed=1.0),
        ),
        Misconception(
            "p1 and p2 exchanged",
            "p1 and p2 are exchanged: p2 goes with r² + 2x² in x, p1 with r² + 2y² in y.",
            lambda xy, k, p: _through(xy, lens_factor(xy, k), p[::-1]),
        ),
        Misconception(
            "tangential terms left out",
            "The radial part is right; the tangential terms are missing.",
            lambda xy, k, p: _through(xy, lens_factor(xy, k), 0 * p),
        ),
        Misconception(
            "r for r²",
            "You used r and r² where L has r² and r⁴: only even powers.",
            lambda xy, k, p: _through(
                xy,
                1 + k[0] * np.hypot(*xy.T)[:, None] + k[1] * (xy**2).sum(1, keepdims=True),
                p,
            ),
        ),
        Misconception(
            "both coefficients with r²",
            "k2 belongs to r⁴, which is (r²)²; you used r² for both.",
            lambda xy, k, p: _through(xy, lens_factor(xy, np.array([k.sum(), 0.0])), p),
        ),
        Misconception(
            "divided by L",
            "You divided by L: that is about the way back. The lens multiplies.",
            lambda xy, k, p: _through(xy, 1 / lens_factor(xy, k), p),
        ),
        Misconception(
            "the 1 of L left out",
            "L starts with 1: without distortion nothing moves. You gave the displacement only.",
            lambda xy, k, p: _through(xy, lens_factor(xy, k) - 1, p),
        ),
        Misconception(
            "r⁶ for r⁴",
            "k2 belongs to r⁴, which is (r²)²; you have r⁶.",
            lambda xy, k, p: _through(
                xy, 1 + k[0] * (xy**2).sum(1)[:, None] + k[1] * (xy**2).sum(1)[:, None] ** 3, p
            ),
        ),
        Misconception(
            "r² lost in the tangential terms",
            "The tangential terms have r² + 2x² and r² + 2y²: your r² is missing.",
            lambda xy, k, p: (
                _through(xy, lens_factor(xy, k), p) - (xy**2).sum(1)[:, None] * p[::-1]
            ),
        ),
        Misconception(
            "x² and y² exchanged",
            "p2 goes with r² + 2x² in x, p1 with r² + 2y² in y: your squares are exchanged.",
            lambda xy, k, p: (
                _through(xy, lens_factor(xy, k), p) + 2 * (xy[:, ::-1] ** 2 - xy**2) * p[::-1]
            ),
        ),
        Misconception(
            "tangential terms multiplied by L",
            "L multiplies x and y only; the tangential terms are added afterwards.",
            lambda xy, k, p: lens_factor(xy, k) * _through(xy, np.ones((len(xy), 1)), p),
        ),
        Misconception(
            "tangential terms of the moved point",
            ("The tangential terms are those of the ideal point, not of the one that L has moved."),
            lambda xy, k, p: _through(xy * lens_factor(xy, k), np.ones((len(xy), 1)), p),
        ),
        Misconception(
            "tangential part alone",
            "The radial part is missing: L multiplies x and y.",
            lambda xy, k, p: _through(xy, np.ones((len(xy), 1)), p),
        ),
        Misconception(
            "L added",
            "You added L to the coordinates: it multiplies them.",
            lambda xy, k, p: xy + lens_factor(xy, k) + _through(xy, 0 * xy, p),
            variants=(lambda xy, k, p: xy + lens_factor(xy, k) - 1 + _through(xy, 0 * xy, p),),
        ),
        Misconception(
            "tangential terms exchanged",
            "The tangential terms of x stand in y and those of y in x.",
            lambda xy, k, p: xy * lens_factor(xy, k) + _through(xy, 0 * xy, p)[:, ::-1],
        ),
        Misconception(
            "r² of one coordinate",
            "r² = x² + y²: you took one of the two squares.",
            lambda xy, k, p: _with_r2(xy, k, p, xy[:, :1] ** 2),
            variants=(lambda xy, k, p: _with_r2(xy, k, p, xy[:, 1:] ** 2),),
        ),
        Misconception(
            "each coordinate by itself",
            "You used x² in the x and y² in the y: r² = x² + y² belongs to both.",
            lambda xy, k, p: _with_r2(xy, k, p, xy**2),
            variants=(
                lambda xy, k, p: xy * (1 + k[0] * xy**2 + k[1] * xy**4) + _through(xy, 0 * xy, p),
            ),
        ),
        Misconception(
            "one r² for all points",
            "You summed over all points: each has an r² of its own, axis=1.",
            lambda xy, k, p: xy * lens_factor(xy.reshape(1, -1), k) + _through(xy, 0 * xy, p),
        ),
        Misconception(
            "k2 with r² squared twice",
            "k2 belongs to r⁴ = (r²)²; you squared once more.",
            lambda xy, k, p: (
                _with_r2(xy, k * [1, 0], p, (xy**2).sum(1)[:, None])
                + k[1] * xy * (xy**2).sum(1)[:, None] ** 4
            ),
        ),
        Misconception(
            "k1 with r",
            "k1 belongs to r²; you have r.",
            lambda xy, k, p: _through(
                xy, 1 + k[0] * np.hypot(*xy.T)[:, None] + k[1] * (xy**2).sum(1)[:, None] ** 2, p
            ),
        ),
        Misconception(
            "undistorted",
            "That is the way back, from where points are seen to where they should be.",
            lambda xy, k, p: Lens(tuple(k), tuple(p)).undistort(xy),
        ),
        Misconception(
            "r² + 2x² for both",
            "p1 goes with r² + 2y² in y: you have x² in both.",
            lambda xy, k, p: (
                _through(xy, lens_factor(xy, k), p)
                + 2 * np.column_stack([0 * xy[:, 0], p[0] * (xy[:, 0] ** 2 - xy[:, 1] ** 2)])
            ),
            variants=(
                lambda xy, k, p: (
                    _through(xy, lens_factor(xy, k), p)
                    + 2 * np.column_stack([p[1] * (xy[:, 1] ** 2 - xy[:, 0] ** 2), 0 * xy[:, 0]])
                ),
            ),
        ),
        Misconception(
            "columns for rows",
            "You summed x² over all points, and y²: r² = x² + y² of each point is a sum along its "
            "row, axis=1.",
            lambda xy, k, p: _with_r2(xy, k, p, (xy**2).sum(0)),
        ),
        Misconception(
            "one tangential term for both",
            "You added the same tangential term to x and to y: p2 (r² + 2x²) belongs to x, p1 (r² "
            "+ 2y²) to y.",
            lambda xy, k, p: xy * lens_factor(xy, k) + _through(xy, 0 * xy, p)[:, :1],
            variants=(
                lambda xy, k, p: xy * lens_factor(xy, k) + _through(xy, 0 * xy, p)[:, 1:],
                lambda xy, k, p: xy * lens_factor(xy, k) + _through(xy, 0 * xy, p).sum(1)[:, None],
            ),
        ),
    ),
    reference=distort,
    concepts=("28", "29", "31", "32", "E14", "E15"),
    sources=(Lens.distort, radial_factor, horner),
)
