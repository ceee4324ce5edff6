"""P taken apart by hand."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import nearest_rotation
from cvnotes.learn.cases.cameras import TIDY, some_camera, some_factors
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import close, up_to_scale


def rq(P: Array) -> tuple[Array, Array]:
    """Give A, R: P[:, :3] is A @ R up to a factor."""
    M = P[:, :3] * np.sign(np.linalg.det(P[:, :3]))  # the left block, its determinant positive
    r3 = M[2] / np.linalg.norm(M[2])  # the third row of R
    across = M[1] - M[1] @ r3 * r3  # the second row of the block without its part along r3
    r2 = across / np.linalg.norm(across)  # the second row of R
    R = np.array([np.cross(r2, r3), r2, r3])  # R
    A = M @ R.T  # A, up to its factor
    return A / A[2, 2], R


def _matrices(rng: np.random.Generator) -> list[Case]:
    A, R, T = TIDY
    cases = [Case((A @ np.column_stack([R, T]),))]
    for sign in (1, -1):
        A, R, T = some_camera(rng)
        P = A @ np.column_stack([R, T])
        cases.append(Case((sign * abs(some_factors(rng, 1)) * P,), about="-" * (sign < 0)))
    return cases


def _each_close(answer: Array, right: Array, tolerance: float) -> bool:
    """Return whether A and R are equal, each to its size."""
    return answer.shape == right.shape and all(map(close, answer, right, 2 * [tolerance]))


def _by_qr(P: Array, fixed: bool) -> tuple[Array, Array]:
    Q, U = np.linalg.qr(P[:, :3])
    s = np.sign(np.diag(U)) if fixed else np.ones(3)
    return s[:, None] * U / (s[2] * U[2, 2]), Q * s


def _from_above(P: Array) -> tuple[Array, Array]:
    _, R = rq(P[::-1])
    M, R = P[:, :3] * np.sign(np.linalg.det(P[:, :3])), R[::-1] * np.linalg.det(R[::-1])
    return M @ R.T / (M @ R.T)[2, 2], R


def _nearest(P: Array) -> tuple[Array, Array]:
    M = P[:, :3] * np.sign(np.linalg.det(P[:, :3]))
    A = M @ nearest_rotation(M).T
    return A / A[2, 2], nearest_rotation(M)


_MISTAKES = mistakes_in(rq,
    ("QR for RQ", "A = QR has the rotation on the left; in P it stands on the right of A.",
     "_by_qr(P, False)", "_by_qr(P, True)"),
    ("signs left as they came", "A column of A and a row of R have a sign in common that may be "
     "changed: which one makes the focal lengths positive, and R no mirror?",
     *(f"A * {s} / A[2, 2] / {s[2]}, R * np.array({s})[:, None]" for s in (
         (-1, 1, 1), (1, -1, 1), (1, 1, -1), (-1, -1, 1), (-1, 1, -1), (1, -1, -1), (-1, -1, -1)))),
    ("begun with the first row", "You began with the first row, and A is a triangle of the wrong "
     "kind: which row of A has one number only?",
     _from_above),
    ("the nearest rotation", "You took the nearest rotation: what it leaves of P is no triangle.",
     _nearest),
)  # fmt: skip

EXERCISE = Exercise(
    name="rq",
    chapter=3,
    title="P taken apart",
    task="Give A (3, 3), an upper triangle with a positive diagonal and A[2, 2] = 1, and the "
    "rotation R (3, 3), from P (3, 4), which is A [R | T] times a number of either sign.",
    hints=(
        "The third row of A is (0, 0, 1), so that of A R is r3. Make it 1 long. What must P be "
        "multiplied by first, so that det(A R) > 0?",
        "The second row of A R is α_v r2 + v0 r3: subtract what lies along r3, and make the rest "
        "1 long. Then r1 = r2 × r3.",
        "M = P[:, :3] * np.sign(np.linalg.det(P[:, :3])); r3 = M[2]/‖M[2]‖; r2 from "
        "M[1] − (M[1]·r3) r3; A = M @ R.T, divided by its last number.",
    ),
    cases=_matrices,
    properties=(
        Property("R is a rotation.", lambda x, _: np.allclose(x[1] @ x[1].T, np.eye(3), atol=1e-5)),
        Property(
            "A R is the left block of P, up to a factor.",
            lambda x, c: up_to_scale(x[0] @ x[1], c.args[0][:, :3], 1e-6 * c.slack),
        ),
        Property("A is an upper triangle with a positive diagonal."),
        Property("A negative factor of P changes nothing.", about="-"),
    ),
    misconceptions=_MISTAKES,
    steps=rq,
    same=_each_close,
    concepts=("o", "27"),
)
