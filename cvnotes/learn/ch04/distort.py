"""Through the lens."""

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Lens
from cvnotes.camera.lens import horner, radial_factor
from cvnotes.learn.cases.cameras import lens_factor, rounded, some_lens
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes


def distort(xy: Array, k: Array, p: Array) -> Array:
    """Return where a lens with k (2,) and p (2,) shows ideal points (n, 2)."""
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


def _steps(xy: Array, k: Array, p: Array) -> Any:
    x, y = xy.T
    r2 = x**2 + y**2  # r²
    L = 1 + k[0] * r2 + k[1] * r2**2  # the radial factor L
    dx = 2 * p[0] * x * y + p[1] * (r2 + 2 * x**2)  # the tangential term of x
    dy = p[0] * (r2 + 2 * y**2) + 2 * p[1] * x * y  # the tangential term of y
    return np.stack([L * x + dx, L * y + dy], axis=1)


MISTAKES = mistakes(
    ("r for r²", "Which powers of r does L have? You have others.",
     lambda xy, k, p: _through(xy, 1 + k[0] * np.hypot(*xy.T)[:, None] + k[1] * (xy ** 2).sum(1,
         keepdims=True), p),
     lambda xy, k, p: _through(xy, 1 + k[0] * np.hypot(*xy.T)[:, None] + k[1] * (xy ** 2).sum(1)[:,
         None] ** 2, p)),
    ("the way back",
     "That is the way back, from where points are seen to where they should be; the lens "
     "multiplies by L.",
     lambda xy, k, p: _through(xy, 1 / lens_factor(xy, k), p),
     lambda xy, k, p: Lens(tuple(k), tuple(p)).undistort(xy)),
    ("L added", "You added L to the coordinates: it multiplies them.",
     lambda xy, k, p: xy + lens_factor(xy, k) + _through(xy, 0 * xy, p),
     lambda xy, k, p: xy + lens_factor(xy, k) - 1 + _through(xy, 0 * xy, p)),
    ("factor 2 lost everywhere",
     "The tangential terms have factors 2, before x y and before the squares; both are "
     "missing.",
     lambda xy, k, p: _through(xy, lens_factor(xy, k), p, factor=1.0, crossed=1.0)),
    ("tangential terms of the moved point",
     "The tangential terms are those of the ideal point, and L does not multiply them.",
     lambda xy, k, p: lens_factor(xy, k) * _through(xy, np.ones((len(xy), 1)), p),
     lambda xy, k, p: _through(xy * lens_factor(xy, k), np.ones((len(xy), 1)), p)),
    ("tangential terms exchanged",
     "In the tangential terms something of x stands in y, or of y in x.",
     lambda xy, k, p: xy * lens_factor(xy, k) + _through(xy, 0 * xy, p)[:, ::-1],
     lambda xy, k, p: _through(xy, lens_factor(xy, k), p) + 2 * (xy[:, ::-1] ** 2 - xy ** 2) *
         p[::-1], lambda xy, k, p: xy * lens_factor(xy, k) + _through(xy, 0 * xy, p)[:, :1],
     lambda xy, k, p: xy * lens_factor(xy, k) + _through(xy, 0 * xy, p)[:, 1:],
     lambda xy, k, p: xy * lens_factor(xy, k) + _through(xy, 0 * xy, p).sum(1)[:, None]),
    ("r² of one coordinate", "You took the square of one coordinate: a point has one radius, the "
     "same for x and y.",
     lambda xy, k, p: _with_r2(xy, k, p, xy[:, :1] ** 2),
     lambda xy, k, p: _with_r2(xy, k, p, xy[:, 1:] ** 2),
     lambda xy, k, p: _with_r2(xy, k, p, xy ** 2),
     lambda xy, k, p: xy * (1 + k[0] * xy ** 2 + k[1] * xy ** 4) + _through(xy, 0 * xy, p)),
    ("one r² for all points",
     "You summed over all points: each has an r² of its own, along its row.",
     lambda xy, k, p: xy * lens_factor(xy.reshape(1, -1), k) + _through(xy, 0 * xy, p),
     lambda xy, k, p: _with_r2(xy, k, p, (xy ** 2).sum(0))),
)  # fmt: skip


DISTORT = Exercise(
    name="distort",
    chapter=4,
    title="Through the lens",
    task="Give where a lens with radial coefficients k = (k1, k2) and tangential ones "
    "p = (p1, p2) shows ideal points xy (n, 2) of the plane z = 1.",
    stub='''def my_distort(xy, k, p):
    """Return the points (n, 2) that a lens makes of ideal points xy (n, 2)."""
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
    misconceptions=MISTAKES,
    reference=distort,
    steps=_steps,
    concepts=("28", "29", "31", "32", "E14", "E15"),
    sources=(Lens.distort, radial_factor, horner),
)
