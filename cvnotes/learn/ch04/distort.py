"""Through the lens."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Lens
from cvnotes.camera.lens import horner, radial_factor
from cvnotes.learn.cases.cameras import rounded, some_lens
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _ideal_points(rng: np.random.Generator) -> list[Case]:
    k, p = some_lens(rng)
    return [
        Case((np.array([[0.5, 0.0], [0.2, 0.4]]), np.array([-0.2, 0.1]), np.array([0.01, 0.02]))),
        Case((rounded(rng.uniform(-0.45, 0.45, (5, 2)), 3), k, p)),
        Case((rounded(rng.uniform(-0.45, 0.45, (5, 2)), 3), k, np.zeros(2)), about="radial"),
    ]


def distort(xy: Array, k: Array, p: Array) -> Array:
    """Return the points (n, 2) that a lens makes of ideal points xy (n, 2)."""
    x, y = xy.T
    r2 = x**2 + y**2  # r²
    L = 1 + k[0] * r2 + k[1] * r2**2  # the radial factor L
    dx = 2 * p[0] * x * y + p[1] * (r2 + 2 * x**2)  # the tangential term of x
    dy = p[0] * (r2 + 2 * y**2) + 2 * p[1] * x * y  # the tangential term of y
    return np.stack([L * x + dx, L * y + dy], axis=1)


MISTAKES = mistakes_in(distort,
    ("r for r²", "Which powers of r does L have? You have others.",
     ("k[0] * r2 + k[1] * r2**2", "k[0] * np.sqrt(r2) + k[1] * r2"),
     ("k[0] * r2 + k[1] * r2**2", "k[0] * np.sqrt(r2) + k[1] * r2**2")),
    ("the way back", "That leads from where points are seen to where they should be.",
     ("L * x + dx, L * y + dy", "x / L + dx, y / L + dy"),
     lambda xy, k, p: Lens(tuple(k), tuple(p)).undistort(xy)),
    ("L added", "You added L to the coordinates: it multiplies them.",
     ("L * x + dx, L * y + dy", "x + L + dx, y + L + dy"),
     ("L * x + dx, L * y + dy", "x + L - 1 + dx, y + L - 1 + dy")),
    ("factor 2 lost everywhere",
     "The tangential terms have factors 2, before x y and before the squares; both are missing.",
     ("2 * p", "p", "2 * x", "x", "2 * y", "y")),
    ("tangential terms of the moved point",
     "The tangential terms are those of the ideal point, and L does not multiply them.",
     ("L * x + dx, L * y + dy", "L * (x + dx), L * (y + dy)"),
     ("    dx =", "    x, y = L * x, L * y; r2 = x**2 + y**2; dx =", "L * x + dx, L * y + dy",
      "x + dx, y + dy")),
    ("tangential terms exchanged",
     "In the tangential terms something of x stands in y, or of y in x.",
     ("L * x + dx, L * y + dy", "L * x + dy, L * y + dx"),
     ("p[1] * (r2 + 2 * x**2)", "p[1] * (r2 + 2 * y**2)", "p[0] * (r2 + 2 * y**2)",
      "p[0] * (r2 + 2 * x**2)"), ("L * x + dx, L * y + dy", "L * x + dx, L * y + dx"),
     ("L * x + dx, L * y + dy", "L * x + dy, L * y + dy"),
     ("L * x + dx, L * y + dy", "L * x + dx + dy, L * y + dx + dy")),
    ("r² of one coordinate",
     "You took the square of one coordinate: a point has one radius, the same for x and y.",
     ("k[0] * r2 + k[1] * r2**2", "k[0] * x**2 + k[1] * x**4"),
     ("k[0] * r2 + k[1] * r2**2", "k[0] * y**2 + k[1] * y**4"),
     ("L * x", "(1 + k[0] * x**2 + k[1] * x**4) * x", "L * y",
      "(1 + k[0] * y**2 + k[1] * y**4) * y")),
    ("one r² for all points",
     "You summed over all points: each has an r² of its own, along its row.",
     ("k[0] * r2 + k[1] * r2**2", "k[0] * r2.sum() + k[1] * r2.sum() ** 2"),
     ("L * x", "(1 + k[0] * x @ x + k[1] * (x @ x) ** 2) * x", "L * y",
      "(1 + k[0] * y @ y + k[1] * (y @ y) ** 2) * y")),
)  # fmt: skip


EXERCISE = Exercise(
    name="distort",
    chapter=4,
    title="Through the lens",
    task="Give where a lens with radial coefficients k = (k1, k2) and tangential ones "
    "p = (p1, p2) shows ideal points xy (n, 2) of the plane z = 1.",
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
    steps=distort,
    concepts=("28", "29", "31", "32", "E14", "E15"),
    sources=(Lens.distort, radial_factor, horner),
)
