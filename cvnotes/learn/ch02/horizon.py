"""The horizon of a plane."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, pose
from cvnotes.camera import horizon as library_horizon
from cvnotes.learn.cases.cameras import (
    ABOUT_X,
    ABOUT_Y,
    TIDY_A,
    rounded,
    some_intrinsics,
    some_rotation,
)
from cvnotes.learn.checker.equality import up_to_scale
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property


def horizon(A: Array, R: Array, n: Array) -> Array:
    """Give the line (3,) in which planes with world normal n (3,) seem to end."""
    return library_horizon(Camera(A, pose(R, np.zeros(3))), n)


def _ends_there(line: Array, case: Case) -> bool:
    A, R, n = case.args
    inside = np.linalg.svd(n[None])[2][1:]
    m_h = inside @ R.T @ A.T
    return bool(
        (np.abs(m_h @ line) <= 1e-6 * case.slack * (np.abs(m_h) @ np.abs(line))).all()
        and line.any()
    )


def _joined(A: Array, R: Array, d1: npt.ArrayLike, d2: npt.ArrayLike) -> Array:
    """Give the line through the vanishing points of two directions."""
    return np.cross(A @ R @ np.asarray(d1), A @ R @ np.asarray(d2))


HORIZON = Exercise(
    name="horizon",
    chapter=2,
    title="The horizon of a plane",
    task="Give the line (a, b, c), of any scale, in which all planes with world normal n (3,) "
    "seem to end: it contains the vanishing points of all directions in the plane.",
    stub='''def my_horizon(A, R, n):
    """Give the horizon (3,) of planes with world normal n (3,)."""
    ...''',
    hints=(
        "Two directions in the plane have two vanishing points; the horizon joins them.",
        "Or at once: a pixel m̃ is on the horizon if its ray Rᵀ A⁻¹ m̃ is perpendicular to n.",
        "n·(Rᵀ A⁻¹ m̃) = 0 is l·m̃ = 0 with which l?",
    ),
    cases=lambda rng: [
        Case((TIDY_A, ABOUT_Y, np.array([1.0, 2.0, 3.0]))),
        Case(
            (
                some_intrinsics(rng, skew=True),
                some_rotation(rng),
                rounded(rng.uniform(0.3, 1, 3) * rng.choice([-1, 1], 3)),
            )
        ),
        # the ground, and walls: whoever needs a direction in the plane must find one for these too
        *(
            Case((TIDY_A, ABOUT_X @ ABOUT_Y, np.array(n)), about="along an axis")
            for n in ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0])
        ),
    ],
    properties=(
        Property("The vanishing points of directions in the plane lie on it.", _ends_there),
        Property(
            "That is so for the ground and for walls, whose normal is an axis, too.",
            _ends_there,
            about="along an axis",
        ),
    ),
    misconceptions=(
        Misconception(
            "vanishing point of the normal",
            "A R n is a point: where the normals of the plane end. Lines transform with the "
            "inverse transpose, A⁻ᵀ.",
            lambda A, R, n: A @ R @ n,
        ),
        Misconception(
            "inverse without transpose",
            "A⁻¹ R n is still a point. From n·(Rᵀ A⁻¹ m̃) = 0 follows l = A⁻ᵀ R n.",
            lambda A, R, n: np.linalg.inv(A) @ R @ n,
        ),
        Misconception(
            "transpose without inverse",
            "You have Aᵀ R n: invert as well, A⁻ᵀ.",
            lambda A, R, n: A.T @ R @ n,
        ),
        Misconception(
            "rotation left out",
            "You took n as if it were given in the camera's frame: R is missing.",
            lambda A, R, n: np.linalg.inv(A).T @ n,
        ),
        Misconception(
            "rotation transposed",
            "You used Rᵀ: n is given in the world, and R takes it to the camera.",
            lambda A, R, n: np.linalg.inv(A).T @ R.T @ n,
        ),
        Misconception(
            "sensor left out",
            "R n is the horizon on the plane z = 1. In pixels it is A⁻ᵀ R n.",
            lambda A, R, n: R @ n,
        ),
        Misconception(
            "A for its inverse transpose, nothing turned",
            "You used A n, with a point's matrix and without the rotation: l = A⁻ᵀ R n.",
            lambda A, R, n: A @ n,
        ),
        Misconception(
            "R and A in the wrong order",
            (
                "You applied R last. It takes n to the camera's frame, and A⁻ᵀ takes the line "
                "from there to the picture: A⁻ᵀ R n."
            ),
            lambda A, R, n: R @ np.linalg.inv(A).T @ n,
        ),
        Misconception(
            "sign of the constant",
            "The last entry has the wrong sign; all others are right.",
            lambda A, R, n: horizon(A, R, n) * [1, 1, -1],
        ),
        Misconception(
            "n itself",
            "That is the normal itself, in the world: R and A are missing.",
            lambda A, R, n: n,
        ),
        Misconception(
            "directions that vanish",
            "Right, unless n is an axis: n × that axis is 0, which is no direction. Take "
            "another axis there, or use A⁻ᵀ R n.",
            lambda A, R, n: _joined(A, R, np.cross(n, [1, 0, 0]), np.cross(n, [0, 1, 0])),
            variants=(
                lambda A, R, n: _joined(A, R, np.cross(n, [0, 1, 0]), np.cross(n, [0, 0, 1])),
                lambda A, R, n: _joined(A, R, np.cross(n, [1, 0, 0]), np.cross(n, [0, 0, 1])),
            ),
        ),
        Misconception(
            "the horizon of an axis",
            "You joined the vanishing points of two axes; the directions must lie in the plane "
            "with normal n.",
            lambda A, R, n: _joined(A, R, [1, 0, 0], [0, 1, 0]),
            variants=(
                lambda A, R, n: _joined(A, R, [0, 1, 0], [0, 0, 1]),
                lambda A, R, n: _joined(A, R, [1, 0, 0], [0, 0, 1]),
            ),
        ),
        Misconception(
            "everything inverted",
            "You have Rᵀ A⁻¹ n, the inverse of A R: the horizon is A⁻ᵀ R n.",
            lambda A, R, n: np.linalg.inv(A @ R) @ n,
            variants=(lambda A, R, n: np.linalg.inv(A) @ R.T @ n,),
        ),
        Misconception(
            "everything transposed",
            "You have the transpose of A R without its inverse: l = A⁻ᵀ R n.",
            lambda A, R, n: (A @ R).T @ n,
            variants=(lambda A, R, n: A.T @ R.T @ n,),
        ),
        Misconception(
            "A R transposed",
            "You used A Rᵀ n: a point, and with the rotation the wrong way round. l = A⁻ᵀ R n.",
            lambda A, R, n: A @ R.T @ n,
        ),
        Misconception(
            "transpose for inverse, nothing turned",
            "You used Aᵀ n: the inverse and the rotation are missing.",
            lambda A, R, n: A.T @ n,
        ),
        Misconception(
            "the line at infinity",
            "(0, 0, 1) is the line at infinity of a plane; the horizon is where the camera sees "
            "that line, A⁻ᵀ R n.",
            lambda A, R, n: np.array([0.0, 0, 1]),
        ),
    ),
    reference=horizon,
    same=up_to_scale,
    concepts=("7", "13"),
    sources=(library_horizon,),
)
