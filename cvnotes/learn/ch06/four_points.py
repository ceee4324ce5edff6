"""Four points fix a homography."""

from dataclasses import replace

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import design_matrix, dlt
from cvnotes.learn.cases.cameras import (
    SQUARE,
    SQUARE_SEEN,
    affine_fit,
    board_grid,
    rounded,
    some_homography,
)
from cvnotes.learn.ch06.dlt import OF_THE_ROWS
from cvnotes.learn.ch06.slips import AFFINE, EXCHANGED, TRANSPOSED, V_BEFORE_U, Y_BEFORE_X
from cvnotes.learn.checker.equality import up_to_scale, up_to_signs
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import apply, from_homogeneous, to_homogeneous


def _four(rng: Rng) -> list[Case]:
    src = board_grid()[[0, 3, 11, 8]] + rounded(rng.uniform(-8, 8, (4, 2)), 1)
    dst = rounded(apply(some_homography(rng), src), 3)
    at_infinity = np.array([[100.0, 0, 300], [0, 100, 200], [1, 1, 0]])
    corners = np.array([[1.0, 1], [3, 1], [4, 4], [1, 4]])
    return [
        Case((SQUARE, SQUARE_SEEN)),
        Case((src, dst)),
        Case((corners, rounded(apply(at_infinity, corners), 12)), about="h9 = 0"),
    ]


def _with_h9(src: Array, dst: Array, sign: float = -1.0) -> Array | None:
    """Solve with h9 = 1; None where the eight equations have no solution."""
    D = design_matrix(src, dst)
    if np.linalg.cond(D[:, :8] / np.abs(D).max(0)[:8]) > 1e10:
        return None
    return np.append(np.linalg.solve(D[:, :8], sign * D[:, 8]), 1.0).reshape(3, 3)


def _with_zero(src: Array, dst: Array) -> Array:
    D = design_matrix(src, dst)
    return np.append(np.linalg.svd(D[:, :8])[2][-1], 0.0).reshape(3, 3)


def _fits_three(H: Array, case: Case) -> bool:
    """Tell whether H takes three of the four points to their partners, and not the last."""
    src, dst = case.args
    return _exactly(H, replace(case, args=(src[:3], dst[:3]))) and not _exactly(H, case)


def _exactly(H: Array, case: Case) -> bool:
    mapped = from_homogeneous.inside(to_homogeneous(case.args[0]) @ H.T)
    return np.allclose(mapped, case.args[1], rtol=0, atol=1e-3 * max(1.0, case.slack / 20))


FOUR = Exercise(
    name="four_points",
    chapter=6,
    title="Four points fix a homography",
    task="Give H (3, 3), of any scale, with dst ≈ H src from exactly four point pairs, shape "
    "(4, 2) each, no three of them on a line. It must work too when the origin of src is seen at "
    "infinity.",
    stub='''def my_four_points(src, dst):
    """Give H (3, 3) with dst ≈ H src for four pairs (4, 2)."""
    ...''',
    hints=(
        "Four pairs give D (8, 9): nine unknowns, and one of them is only a scale.",
        "The notes fix the scale by h9 = 1, or by ‖h‖ = 1 with a formula for h9. "
        "What if the true h9 is 0?",
        "The null vector of D needs no such assumption: the last row of Vt, from an SVD with "
        "full_matrices=True.",
    ),
    cases=_four,
    properties=(
        Property("H takes the four points of src to those of dst.", _exactly),
        Property(
            "It also does if its ninth entry is 0: the origin is then seen at infinity.",
            _exactly,
            about="h9 = 0",
        ),
    ),
    misconceptions=(
        Misconception(
            "h9 = 1",
            "Right unless the true h9 is 0, which neither h9 = 1 nor the notes' formula for h9 "
            "can express: both solve the same 8×8 system, and it is singular then. Take the null "
            "vector of D.",
            _with_h9,
        ),
        Misconception(
            "sign of the right-hand side",
            "With h9 = 1 the ninth column goes to the other side with a minus: Ã h̃ = −A9.",
            lambda src, dst: _with_h9(src, dst, sign=1.0),
        ),
        TRANSPOSED,
        EXCHANGED,
        Misconception(
            "three points only",
            "That is the affine map of the first three points; the fourth says how far it is from "
            "one.",
            lambda src, dst: affine_fit(src[:3], dst[:3]),
        ),
        V_BEFORE_U,
        Misconception(
            "full_matrices=False",
            (
                "The null vector of D (8, 9) is the ninth row of Vt: full_matrices=False leaves "
                "it out."
            ),
            lambda src, dst: np.linalg.svd(design_matrix(src, dst), full_matrices=False)[2][
                -1
            ].reshape(3, 3),
        ),
        Misconception(
            "a column of Vt",
            (
                "You took the last column of Vt. np.linalg.svd gives Vᵀ: its rows are the "
                "singular vectors, so take Vt[-1]."
            ),
            lambda src, dst: np.linalg.svd(design_matrix(src, dst))[2][:, -1].reshape(3, 3),
            same=up_to_signs,
        ),
        Y_BEFORE_X,
        *OF_THE_ROWS,
        AFFINE,
        Misconception(
            "the largest singular value",
            "You took the first singular vector, for which ‖D h‖ is largest. The null vector "
            "comes last.",
            lambda src, dst: np.linalg.svd(design_matrix(src, dst))[2][0].reshape(3, 3),
        ),
        Misconception(
            "the trivial solution",
            "h = 0 solves D h = 0 and means nothing. Ask for ‖h‖ = 1.",
            lambda *_: np.zeros((3, 3)),
        ),
        Misconception(
            "h9 = 0",
            "You set h9 to 0, which is right only if the origin of src is seen at infinity.",
            lambda src, dst: _with_zero(src, dst),
        ),
        Misconception(
            "the last pair left out",
            "You used three of the four pairs: D needs eight rows.",
            lambda src, dst: np.linalg.svd(design_matrix(src[:3], dst[:3]))[2][-1].reshape(3, 3),
            seen=_fits_three,
        ),
    ),
    reference=dlt,
    sources=(design_matrix, dlt),
    same=up_to_scale,
    concepts=("51", "52", "53", "E27"),
)
