"""The nearest rotation."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import nearest_rotation
from cvnotes.learn.cases.cameras import ABOUT_Y, rounded, some_rotation
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def _nearly_rotations(rng: Rng) -> list[Case]:
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


def _left(M: Array) -> tuple[Array, Array]:
    U, _, Vt = np.linalg.svd(M)
    return U, Vt


def _flipped(M: Array) -> Array:
    U, Vt = _left(M)
    return np.asarray(U @ Vt * np.sign(np.linalg.det(U @ Vt)))


def _gram_schmidt(M: Array) -> Array:
    Q, U = np.linalg.qr(M)
    return Q * np.sign(np.diag(U))


def _turned_around(M: Array, i: int) -> Array:
    """Give U Vᵀ, with column i of U turned around if that is needed for a rotation."""
    U, Vt = _left(M)
    U[:, i] *= np.linalg.det(U @ Vt)
    return U @ Vt


def _rq(M: Array, proper: bool = False) -> Array:
    """Give the rotation of M = upper triangle @ rotation, diagonal positive."""
    from scipy.linalg import rq

    U, Q = rq(M)
    Q = np.sign(np.diag(U))[:, None] * Q if proper else Q
    return np.asarray(Q)


def _proper(Q: Array) -> Array:
    return np.asarray(Q if np.linalg.det(Q) > 0 else Q * [1, 1, -1])


def _crossed(M: Array) -> Array:
    return np.column_stack([M[:, 0], M[:, 1], np.cross(M[:, 0], M[:, 1])])


def _last_column_turned(M: Array) -> Array:
    U, Vt = _left(M)
    R = U @ Vt
    return np.asarray(R * [1, 1, np.linalg.det(R)])


NEAREST = Exercise(
    name="nearest_rotation",
    chapter=3,
    title="The nearest rotation",
    task="Give the rotation (3, 3) that is nearest to a matrix M (3, 3), in the sense of the sum "
    "of squared differences.",
    stub='''def my_nearest_rotation(M):
    """Give the rotation (3, 3) nearest to M (3, 3)."""
    ...''',
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
            lambda R, c: np.allclose(R.T @ R, np.eye(3), atol=1e-5),
        ),
        Property("No other rotation is nearer."),
        Property(
            "Also if M is nearer to a reflection: the determinant is +1 always.", about="mirrored"
        ),
    ),
    misconceptions=(
        Misconception(
            "V for Vᵀ",
            "np.linalg.svd gives Vᵀ, not V: the product is U @ Vt.",
            lambda M: _left(M)[0] @ _left(M)[1].T,
        ),
        Misconception(
            "transposed",
            "V Uᵀ is the rotation back: the transpose of what is asked.",
            lambda M: (_left(M)[0] @ _left(M)[1]).T,
        ),
        Misconception(
            "a reflection",
            "Right unless U Vᵀ has determinant −1: that is a reflection. "
            "R = U diag(1, 1, det(U Vᵀ)) Vᵀ.",
            lambda M: _left(M)[0] @ _left(M)[1],
        ),
        Misconception(
            "everything turned around",
            "A negative determinant is cured by turning one direction around, the one with the "
            "smallest singular value; you turned around all three, which ends far away.",
            _flipped,
        ),
        Misconception(
            "columns scaled only",
            "Columns of length 1 are not perpendicular yet.",
            lambda M: M / np.linalg.norm(M, axis=0),
        ),
        Misconception(
            "Gram and Schmidt",
            "That is a rotation, by making one column after the other perpendicular. But it "
            "favours the first column: it is not the nearest.",
            _gram_schmidt,
        ),
        Misconception(
            "QR",
            (
                "Q of the QR decomposition has the first column of M up to its sign: it favours "
                "that column, and is not the nearest rotation."
            ),
            lambda M: np.linalg.qr(M)[0],
        ),
        Misconception(
            "Gram and Schmidt by rows",
            (
                "That is a rotation, by making one row after the other perpendicular. But it "
                "favours the first row: it is not the nearest."
            ),
            lambda M: _gram_schmidt(M.T).T,
        ),
        Misconception(
            "rows scaled only",
            "Rows of length 1 are not perpendicular yet.",
            lambda M: M / np.linalg.norm(M, axis=1, keepdims=True),
        ),
        Misconception(
            "the wrong direction turned around",
            (
                "You turned around the direction that counts most, the first column of U: take "
                "the last one, with the smallest singular value."
            ),
            lambda M: _turned_around(M, 0),
        ),
        Misconception(
            "the middle direction turned around",
            (
                "You turned around the second column of U: take the last one, with the smallest "
                "singular value."
            ),
            lambda M: _turned_around(M, 1),
        ),
        Misconception(
            "determinant scaled to 1",
            "A determinant of 1 does not make a rotation: the columns have to be orthonormal.",
            lambda M: M / np.cbrt(np.linalg.det(M)),
        ),
        Misconception(
            "stretching kept", "You put the singular values back: that is M itself.", lambda M: M
        ),
        Misconception(
            "always a turn",
            (
                "You turned the last direction around always; only where the determinant of U Vᵀ "
                "is −1 it has to be."
            ),
            lambda M: _left(M)[0] @ np.diag([1, 1, -1]) @ _left(M)[1],
        ),
        Misconception(
            "RQ",
            "R of the RQ decomposition belongs to a camera's matrix A R; it favours the last row "
            "of M, and is not the nearest rotation.",
            lambda M: _rq(M),
            variants=(lambda M: _rq(M, True),),
        ),
        Misconception(
            "Gram and Schmidt, turned",
            "That is a rotation, by QR with the signs set right. But it favours the first column: "
            "it is not the nearest.",
            lambda M: _proper(_gram_schmidt(M)),
        ),
        Misconception(
            "cross product of the first two columns",
            "You made r3 = r1 × r2 of the first columns as they are: they are neither of length 1 "
            "nor perpendicular.",
            lambda M: np.column_stack([M[:, 0], M[:, 1], np.cross(M[:, 0], M[:, 1])]),
            variants=(lambda M: _crossed(M / np.linalg.norm(M, axis=0)),),
        ),
        Misconception(
            "Vt alone",
            "That is one of the two rotations of the SVD: the product U Vᵀ is asked.",
            lambda M: _left(M)[1],
            variants=(
                lambda M: _left(M)[0],
                lambda M: _left(M)[1].T,
            ),
        ),
        Misconception(
            "order of U and Vt",
            "You multiplied in the wrong order: U @ Vt.",
            lambda M: _left(M)[1] @ _left(M)[0],
            variants=(lambda M: _left(M)[1].T @ _left(M)[0],),
        ),
        Misconception(
            "last singular value 0",
            "You set the last singular value to 0: it becomes 1 or −1, R = U diag(1, 1, ±1) Vᵀ.",
            lambda M: _left(M)[0] @ np.diag([1, 1, 0]) @ _left(M)[1],
        ),
        Misconception(
            "divided by the length of M",
            "Dividing by one number makes no rotation: the columns have to be orthonormal.",
            lambda M: M / np.linalg.norm(M),
            variants=(
                lambda M: M / np.linalg.norm(M, 2),
                lambda M: M / np.sqrt((M**2).sum() / 3),
                lambda M: M / np.linalg.det(M),
            ),
        ),
        Misconception(
            "the average of M and its inverse",
            "One step of averaging with the inverse transpose comes nearer to a rotation, but has "
            "to be repeated until nothing changes.",
            lambda M: (M + np.linalg.inv(M).T) / 2,
        ),
        Misconception(
            "the last column turned around",
            "You turned around the last column of the result, not of U: that is another rotation. "
            "R = U diag(1, 1, det(U Vᵀ)) Vᵀ.",
            lambda M: _last_column_turned(M),
            variants=(lambda M: _last_column_turned(M.T).T,),
        ),
    ),
    reference=nearest_rotation,
    concepts=("61", "c", "E33"),
)
