"""The focal length in a picture of a box."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.camera import focal_length
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def _perpendicular(rng: Rng) -> list[Case]:
    by_hand = (np.array([400.0, 100]), np.array([-300.0, 200]), np.array([100.0, 0]))
    f, centre = rng.uniform(500, 900), np.round(rng.uniform([300, 220], [340, 260]), 1)
    x, y = rng.uniform(0.3, 1.2), rng.uniform(-0.6, 0.6)
    d1 = np.array([x, y, 1.0])
    d2 = np.array([-1.0, 0.2, x - 0.2 * y])
    v1, v2 = (rounded(centre + f * d[:2] / d[2], 3) for d in (d1, d2))
    return [Case(by_hand), Case((v1, v2, centre))]


FOCAL = Exercise(
    name="focal_from_vanishing_points",
    chapter=2,
    title="The focal length in a picture of a box",
    task="Give the focal length in pixels of a camera with square pixels and known principal point "
    "`centre`, from the vanishing points v1 and v2 of two perpendicular directions, shape (2,) "
    "each.",
    stub='''def my_focal_from_vanishing_points(v1, v2, centre):
    """Give f in pixels."""
    ...''',
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
    misconceptions=(
        Misconception(
            "principal point forgotten",
            "You took v1·v2 from pixel (0, 0); measure both from the principal point.",
            lambda v1, v2, centre: np.sqrt(-v1 @ v2),
            (lambda v1, v2, centre: np.sqrt(np.abs(v1 @ v2)),),
        ),
        Misconception(
            "sign under the root",
            "The root of a negative number is NaN. Measured from the principal point the dot "
            "product of the two is negative, and f² is minus that.",
            lambda v1, v2, centre: np.sqrt((v1 - centre) @ (v2 - centre)),
        ),
        Misconception(
            "lengths multiplied",
            "You multiplied the two distances from the principal point; it is the dot product, "
            "which is the same only if both points lie on one line with the principal point.",
            lambda v1, v2, centre: np.sqrt(
                np.linalg.norm(v1 - centre) * np.linalg.norm(v2 - centre)
            ),
        ),
        Misconception(
            "half the distance",
            "That is half the distance between v1 and v2, the radius of the sphere over them. "
            "The camera's centre lies on that sphere, but f is its height above the picture.",
            lambda v1, v2, centre: np.linalg.norm(v1 - v2) / 2,
        ),
        Misconception(
            "the distance itself",
            "That is how far apart the two vanishing points are. It depends on how the box "
            "stands, f does not.",
            lambda v1, v2, centre: np.linalg.norm(v1 - v2),
        ),
        Misconception(
            "columns only",
            "You multiplied the columns only; the dot product has the rows too.",
            lambda v1, v2, centre: np.sqrt(-(v1 - centre)[0] * (v2 - centre)[0]),
        ),
        Misconception(
            "one point measured from pixel 0",
            "Only one of the two vanishing points is measured from the principal point.",
            lambda v1, v2, centre: np.sqrt(-(v1 - centre) @ v2),
            variants=(lambda v1, v2, centre: np.sqrt(-v1 @ (v2 - centre)),),
        ),
        Misconception(
            "entry by entry",
            "* multiplies entry by entry and gives two numbers; the dot product is (v1 − centre) "
            "@ (v2 − centre).",
            lambda v1, v2, centre: np.sqrt(-(v1 - centre) * (v2 - centre)),
            variants=(
                lambda v1, v2, centre: -(v1 - centre) * (v2 - centre),
                lambda v1, v2, centre: np.sqrt(np.abs((v1 - centre) * (v2 - centre))),
            ),
        ),
        Misconception(
            "rows only",
            "You multiplied the rows only; the dot product has the columns too.",
            lambda v1, v2, centre: np.sqrt(np.abs((v1 - centre)[1] * (v2 - centre)[1])),
        ),
        Misconception(
            "one distance alone",
            "That is how far one vanishing point is from the principal point; f needs both.",
            lambda v1, v2, centre: np.linalg.norm(v1 - centre),
            variants=(lambda v1, v2, centre: np.linalg.norm(v2 - centre),),
        ),
        Misconception(
            "mean of the distances",
            "You took a mean of the two distances from the principal point; it is their dot "
            "product that is −f².",
            lambda v1, v2, centre: (np.linalg.norm(v1 - centre) + np.linalg.norm(v2 - centre)) / 2,
        ),
        Misconception(
            "centre added",
            "You added the principal point; measure from it: v − centre.",
            lambda v1, v2, centre: np.sqrt(np.abs((v1 + centre) @ (v2 + centre))),
        ),
        Misconception(
            "cross product",
            "You took the cross product, which is 0 for parallel vectors; perpendicular rays have "
            "a dot product of 0.",
            lambda v1, v2, centre: np.sqrt(np.abs(np.linalg.det([v1 - centre, v2 - centre]))),
            variants=(lambda v1, v2, centre: np.linalg.det([v1 - centre, v2 - centre]),),
        ),
        Misconception(
            "sign and root",
            "That is −f²: change the sign, then take the root.",
            lambda v1, v2, centre: (v1 - centre) @ (v2 - centre),
        ),
        Misconception(
            "distance from the middle",
            "That is how far the principal point is from the middle between the two vanishing "
            "points.",
            lambda v1, v2, centre: np.linalg.norm((v1 + v2) / 2 - centre),
        ),
        Misconception(
            "products subtracted",
            "You subtracted one product from the other; the dot product adds both.",
            lambda v1, v2, centre: np.sqrt(np.abs(np.subtract(*((v1 - centre) * (v2 - centre))))),
        ),
    ),
    reference=focal_length,
    concepts=("13", "20"),
)
