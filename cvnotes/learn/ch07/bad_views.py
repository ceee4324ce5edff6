"""Which set of views is worthless."""

from functools import cache

import numpy as np

from cvnotes.calibration import constraints
from cvnotes.camera import rotation_from_vector
from cvnotes.learn.cases.cameras import plane_image
from cvnotes.tutor import Case, Exercise, Property, mistakes


@cache
def determinacy() -> tuple[float, ...]:
    """Return for each set of the question how well it determines A: 0 is not at all."""
    A = np.diag([2.0, 2.0, 1.0])
    # rotation vectors in degrees, CRF ← board
    sets = (
        [(35, 0, 0), (0, 35, 0)],
        [(40, 0, 0)] * 10,
        [(20, 0, 0), (-10, 17, 0), (-10, -17, 0)],
        [(45, 0, 0), (-45, 0, 0), (0, 45, 0), (0, -45, 0)],
    )
    found = []
    for number, vectors in enumerate(sets):
        views = []
        for i, w in enumerate(vectors):
            R = rotation_from_vector(np.radians(w))
            if number == 1:  # turned in its own plane
                R = R @ rotation_from_vector(np.radians([0, 0, 36.0 * i]))
            views.append(plane_image(A, R, np.array([0.2 * i - 1, 0.1 * i, 4 + 0.3 * i])))
        s = np.linalg.svd(constraints(np.array(views))[:, [0, 2, 3, 4, 5]], compute_uv=False)
        found.append(float(s[3] / s[0]))
    return tuple(found)


def bad_views() -> float:
    """Return the number of the set that does not determine the camera."""
    return float(np.argmin(determinacy()))


EXERCISE = Exercise(
    name="bad_views",
    chapter=7,
    title="Which set of views is worthless?",
    task="""Four students photograph a board to calibrate a camera without skew or distortion. \
Whose pictures do not determine A, however many corners are found in them?
A: two pictures, the board tilted by 35° once about its x and once about its y axis.
B: ten pictures, the board tilted by 40° each time, always parallel to itself, but turned in its own
   plane and moved into every part of the picture, near and far.
C: three pictures, tilted by 20° about three different axes.
D: four pictures, tilted by 45° up, down, left and right, all in the middle of the picture.""",
    stub='my_bad_views = ...  # "A", "B", "C" or "D"',
    hints=(
        "Each view gives two equations for A, of which there are four unknowns without skew.",
        "What in H changes, and what in v_12 and v_11 − v_22, if the board is only shifted?",
        "r1 and r2 span the board's plane. Turning the board in its plane mixes them, and mixes "
        "the two equations.",
    ),
    cases=lambda _: [Case(())],
    properties=(Property("Its equations are those of one single view, again and again."),),
    misconceptions=mistakes(
        ("two views thought too few", "A is fine: two views give four equations, and without skew "
         "A has four unknowns. The notes' “at least 3” is for a camera with skew.",
         lambda: 0.0),
        ("small tilt thought worthless", "C is fine: 20° give large error bars but an answer. What "
         "counts is that the boards are tilted against each other.",
         lambda: 2.0),
        ("the middle thought worthless", "D determines A well: tilts differ by up to 90°. Pictures "
         "in the middle only are a pity for the lens coefficients, which show in the corners.",
         lambda: 3.0),
    ),
    reference=bad_views,
    concepts=("55", "58", "f", "E29"),
    answer="value",
    choices=("A", "B", "C", "D"),
    sources=(determinacy,),
)  # fmt: skip
