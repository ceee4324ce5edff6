"""The focal length in a picture of a box."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import focal_length
from cvnotes.learn.cases.cameras import rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _perpendicular(rng: np.random.Generator) -> list[Case]:
    by_hand = (np.array([400.0, 100]), np.array([-300.0, 200]), np.array([100.0, 0]))
    f, centre = rng.uniform(500, 900), np.round(rng.uniform([300, 220], [340, 260]), 1)
    x, y = rng.uniform(0.3, 1.2), rng.uniform(-0.6, 0.6)
    d1 = np.array([x, y, 1.0])
    d2 = np.array([-1.0, 0.2, x - 0.2 * y])
    v1, v2 = (rounded(centre + f * d[:2] / d[2], 3) for d in (d1, d2))
    return [Case(by_hand), Case((v1, v2, centre))]


def _steps(v1: Array, v2: Array, centre: Array) -> Array:
    """Return f in pixels."""
    a = v1 - centre  # v1 measured from the principal point
    b = v2 - centre  # v2 measured from the principal point
    f2 = -(a @ b)  # f² is minus the dot product
    return np.sqrt(f2)


MISTAKES = mistakes_in(_steps,
    ("sign under the root", "The root of a negative number is NaN. Measured from the principal "
     "point the dot product of the two is negative.",
     "np.sqrt(a @ b)"),
    ("sign and root",
     "Sign and root are missing: the number is the square of what is asked, with a minus.",
     "a @ b"),
    ("lengths for the dot product", "You took lengths, of one or both; the dot product of the two "
     "vectors is another number, unless they point along one line.",
     "np.sqrt(np.linalg.norm(a) * np.linalg.norm(b))", "np.linalg.norm(a)", "np.linalg.norm(b)",
     "(np.linalg.norm(a) + np.linalg.norm(b)) / 2"),
    ("half the distance", "A distance in the picture depends on how the box stands. f does not.",
     "np.linalg.norm(v1 - v2) / 2", "np.linalg.norm(v1 - v2)",
     "np.linalg.norm((v1 + v2) / 2 - centre)"),
    ("columns only", "The dot product adds what the columns give and what the rows give.",
     "np.sqrt(-a[0] * b[0])", "np.sqrt(np.abs(a[1] * b[1]))",
     "np.sqrt(np.abs(np.subtract(*a * b)))"),
    ("centre added", "You added the principal point; measure from it.",
     "np.sqrt(np.abs((v1 + centre) @ (v2 + centre)))"),
    ("cross product",
     "You took the cross product, which is 0 for parallel vectors; these are perpendicular.",
     "np.sqrt(np.abs(np.linalg.det([v1 - centre, v2 - centre])))",
     "np.linalg.det([v1 - centre, v2 - centre])"),
)  # fmt: skip


EXERCISE = Exercise(
    name="focal_from_vanishing_points",
    chapter=2,
    title="The focal length in a picture of a box",
    task="Give the focal length in pixels of a camera with square pixels and known principal point "
    "`centre`, from the vanishing points v1 and v2 of two perpendicular directions, shape (2,) "
    "each.",
    hints=(
        "Measured from the principal point, v = f (a/c, b/c): the ray of v is (v − centre, f).",
        "The rays of v1 and v2 are perpendicular: their dot product is 0.",
        "(v1 − centre)·(v2 − centre) + f² = 0.",
    ),
    cases=_perpendicular,
    properties=(
        Property(
            "With this f the rays of both vanishing points are perpendicular.",
            lambda f, c: bool(
                abs((c.args[0] - c.args[2]) @ (c.args[1] - c.args[2]) + f**2) < 1e-5 * f**2
            ),
        ),
        Property("f is positive.", lambda f, _: bool(f > 0)),
    ),
    misconceptions=MISTAKES,
    reference=focal_length,
    steps=_steps,
    concepts=("13", "20"),
)
