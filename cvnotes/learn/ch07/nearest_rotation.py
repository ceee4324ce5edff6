"""The nearest rotation."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import nearest_rotation
from cvnotes.learn.cases.cameras import ABOUT_Y, rounded, some_rotation
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _nearly_rotations(rng: np.random.Generator) -> list[Case]:
    by_hand = rounded(ABOUT_Y + [[0.1, 0.0, 0.2], [0.2, 0.1, 0.0], [0.0, 0.1, 0.1]], 2)
    noisy = rounded(some_rotation(rng) + 0.1 * rng.standard_normal((3, 3)), 3)
    mirrored = rounded(some_rotation(rng) @ np.diag([1, 1, -0.2]) + 0.03 * noisy, 3)
    # the direction that counts least is not always the last one
    other = rounded(some_rotation(rng) @ np.diag([0.9, -0.3, 1.2]) + 0.01 * noisy, 3)
    return [
        Case((by_hand,)),
        Case((noisy,)),
        Case((mirrored,), about="mirrored"),
        Case((other,), about="mirrored"),
    ]


def _gram_schmidt(M: Array) -> Array:
    Q, U = np.linalg.qr(M)
    return Q * np.sign(np.diag(U))


def _rq(M: Array) -> Array:
    from scipy.linalg import rq

    return np.asarray(rq(M)[1])


def _crossed(M: Array) -> Array:
    return np.column_stack([M[:, 0], M[:, 1], np.cross(M[:, 0], M[:, 1])])


def _steps(M: Array) -> Array:
    """Return the rotation (3, 3) nearest to M (3, 3)."""
    U, _, Vt = np.linalg.svd(M)
    d = np.linalg.det(U @ Vt)  # whether it is a rotation, 1, or a reflection, −1
    F = np.diag([1, 1, d])  # what turns the direction around that counts least
    return U @ F @ Vt


MISTAKES = mistakes_in(_steps,
    ("V for Vᵀ", "The factors of the SVD do not belong together like that: np.linalg.svd gives U, "
     "s and Vᵀ, in the order in which they are multiplied.",
     "U @ Vt.T", "Vt @ U", "Vt.T @ U", "Vt", "U", "Vt.T"),
    ("a reflection", "Right where the determinant is 1. Where it is −1, that is a reflection.",
     "U @ Vt"),
    ("the wrong direction turned around", "A reflection is cured by turning around the one "
     "direction that counts least, and only where there is one; you turned something else around.",
     "U @ Vt * np.sign(d)", "U @ Vt @ F", "F @ U @ Vt",
     *(("[1, 1, d]", other) for other in ("[d, 1, 1]", "[1, d, 1]", "[1, 1, -1]"))),
    ("Gram and Schmidt", "That is a rotation, or one up to signs. But it favours the first or the "
     "last of the columns or rows: it is not the nearest.",
     _gram_schmidt, "np.linalg.qr(M)[0]", "_gram_schmidt(M.T).T", _rq,
     "_gram_schmidt(M[::-1].T).T[::-1]",
     "_gram_schmidt(M) * [1, 1, np.linalg.det(_gram_schmidt(M))]"),
    ("lengths only", "That sets lengths, or the determinant, and makes no rotation: the columns "
     "have to be perpendicular too.",
     "M / np.linalg.norm(M, axis=0)", "M / np.linalg.norm(M, axis=1, keepdims=True)",
     "M / np.cbrt(np.linalg.det(M))", "M / np.linalg.norm(M)", "M / np.linalg.norm(M, 2)",
     "M / np.sqrt((M**2).sum() / 3)", "M / np.linalg.det(M)"),
    ("stretching kept", "You left singular values in: a rotation stretches nothing.",
     "M", "U @ np.diag([1, 1, 0]) @ Vt"),
    ("cross product of the first two columns", "You made the third column of the first two as "
     "they are: they are neither of length 1 nor perpendicular.",
     _crossed, "_crossed(M / np.linalg.norm(M, axis=0))"),
    ("the average of M and its inverse", "One step of averaging with the inverse transpose comes "
     "nearer to a rotation, but has to be repeated until nothing changes.",
     "(M + np.linalg.inv(M).T) / 2"),
)  # fmt: skip


EXERCISE = Exercise(
    name="nearest_rotation",
    chapter=7,
    title="The nearest rotation",
    task="Give the rotation (3, 3) that is nearest to a matrix M (3, 3), in the sense of the sum "
    "of squared differences.",
    hints=(
        "U, s, Vt = np.linalg.svd(M) takes M apart: rotate, stretch by s, rotate.",
        "Leave the stretching out.",
        "Is your result a rotation or a reflection? Look at its determinant, and turn around the "
        "direction that counts least: the last column of U.",
    ),
    cases=_nearly_rotations,
    properties=(
        Property(
            "The columns are orthonormal.",
            lambda R, _: np.allclose(R.T @ R, np.eye(3), atol=1e-5),
        ),
        Property("No other rotation is nearer."),
        Property(
            "Also if M is nearer to a reflection: the determinant is +1 always.", about="mirrored"
        ),
    ),
    misconceptions=MISTAKES,
    reference=nearest_rotation,
    steps=_steps,
    concepts=("61", "c", "E33"),
)
