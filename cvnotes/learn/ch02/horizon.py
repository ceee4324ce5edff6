"""The horizon of a plane."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import horizon as library_horizon
from cvnotes.learn.cases.cameras import ABOUT_X, TIDY, incident, some_intrinsics, some_rotation
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import up_to_scale


def _planes(rng: np.random.Generator) -> list[Case]:
    A, R = some_intrinsics(rng, skew=True), some_rotation(rng)
    n = np.round(rng.uniform(0.3, 1, 3) * rng.choice([-1, 1], 3), 2)
    tidy_A, about_y, _ = TIDY
    # the ground, and walls: whoever needs a direction in the plane must find one for these too
    axes = np.array([[0.0, 1, 0], [1, 0, 0], [0, 0, -1]])
    return [
        Case((tidy_A, about_y, np.array([1.0, 2.0, 3.0]))),
        Case((A, R, n)),
        *(Case((tidy_A, ABOUT_X @ about_y, axis), about="along an axis") for axis in axes),
    ]


def _ends_there(line: Array, case: Case) -> bool:
    A, R, n = case.args
    inside = np.linalg.svd(n[None])[2][1:]
    return incident(inside @ R.T @ A.T, line, case.slack)


def _joined(A: Array, R: Array, d1: npt.ArrayLike, d2: npt.ArrayLike) -> Array:
    """Return the line through the vanishing points of two directions."""
    return np.cross(A @ R @ np.asarray(d1), A @ R @ np.asarray(d2))


def horizon(A: Array, R: Array, n: Array) -> Array:
    """Return the horizon (3,) of planes with world normal n (3,)."""
    N = R @ n  # the normal in the camera's frame
    B = np.linalg.inv(A)  # what takes pixels to rays
    return B.T @ N


MISTAKES = mistakes_in(horizon,
    ("vanishing point of the normal",
     "You carried the normal as a point. Lines need another matrix than points.",
     "A @ R @ n", "A @ R.T @ n", "A @ n"),
    ("inverse without transpose",
     "You inverted A, which still carries points. The rule for lines has one thing more.",
     "np.linalg.inv(A) @ R @ n"),
    ("R and A in the wrong order", "The normal has to be taken to the camera's frame first, and "
     "from there, as a line, to the picture.",
     "R @ np.linalg.inv(A).T @ n", "np.linalg.inv(A @ R) @ n", "(A @ R).T @ n", "A.T @ R.T @ n"),
    ("directions that vanish", "Right, unless n is an axis: then the cross product with that axis "
     "is 0, which is no direction.",
     "_joined(A, R, np.cross(n, [1, 0, 0]), np.cross(n, [0, 1, 0]))",
     "_joined(A, R, np.cross(n, [0, 1, 0]), np.cross(n, [0, 0, 1]))",
     "_joined(A, R, np.cross(n, [1, 0, 0]), np.cross(n, [0, 0, 1]))"),
    ("the horizon of an axis", "You joined the vanishing points of two axes; the directions must "
     "lie in the plane with normal n.",
     "_joined(A, R, [1, 0, 0], [0, 1, 0])", "_joined(A, R, [0, 1, 0], [0, 0, 1])",
     "_joined(A, R, [1, 0, 0], [0, 0, 1])"),
)  # fmt: skip


EXERCISE = Exercise(
    name="horizon",
    chapter=2,
    title="The horizon of a plane",
    task="Give the line (a, b, c), of any scale, in which all planes with world normal n (3,) "
    "seem to end: it contains the vanishing points of all directions in the plane.",
    hints=(
        "Two directions in the plane have two vanishing points; the horizon joins them.",
        "Or at once: a pixel m̃ is on the horizon if its ray Rᵀ A⁻¹ m̃ is perpendicular to n.",
        "n·(Rᵀ A⁻¹ m̃) = 0 is l·m̃ = 0 with which l?",
    ),
    cases=_planes,
    properties=(
        Property("The vanishing points of directions in the plane lie on it.", _ends_there),
        Property(
            "That is so for the ground and for walls, whose normal is an axis, too.",
            _ends_there,
            about="along an axis",
        ),
    ),
    misconceptions=MISTAKES,
    steps=horizon,
    same=up_to_scale,
    concepts=("7", "13"),
    sources=(library_horizon,),
)
