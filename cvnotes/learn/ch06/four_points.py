"""Four points fix a homography."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from cvnotes.base import Array, DegenerateError
from cvnotes.homography import design_matrix, dlt, four_points_h9_one, four_points_unit_norm
from cvnotes.homography.linear import normal_matrix
from cvnotes.learn.cases.cameras import SQUARE, affine_fit, board_grid, rounded, some_homography
from cvnotes.learn.ch06.dlt import OF_THE_ROWS
from cvnotes.projective import apply, from_homogeneous, to_homogeneous
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import up_to_scale, up_to_signs


def _four(rng: np.random.Generator) -> list[Case]:
    src = board_grid()[[0, 3, 11, 8]] + rounded(rng.uniform(-8, 8, (4, 2)), 1)
    dst = rounded(apply(some_homography(rng), src), 3)
    at_infinity = np.array([[100.0, 0, 300], [0, 100, 200], [1, 1, 0]])
    corners = np.array([[1.0, 1], [3, 1], [4, 4], [1, 4]])
    return [
        Case(SQUARE),
        Case((src, dst)),
        Case((corners, rounded(apply(at_infinity, corners), 12)), about="h9 = 0"),
    ]


def _fits_three(H: Array, case: Case) -> bool:
    """Return whether H takes three of the four points to their partners, and not the last."""
    src, dst = case.args
    return _exactly(H, replace(case, args=(src[:3], dst[:3]))) and not _exactly(H, case)


def _exactly(H: Array, case: Case) -> bool:
    mapped = from_homogeneous.inside(to_homogeneous(case.args[0]) @ H.T)
    return np.allclose(mapped, case.args[1], rtol=0, atol=1e-3 * max(1.0, case.slack / 20))


def _steps(src: Array, dst: Array) -> Array:
    """Return H (3, 3) with dst ≈ H src for four pairs (4, 2)."""
    u, v = dst[:, :1], dst[:, 1:]
    W = np.column_stack([src, np.ones(4)])  # the points of src, homogeneous
    first = np.hstack([W, 0 * W, -u * W])  # the rows of u
    second = np.hstack([0 * W, W, -v * W])  # the rows of v
    D = np.vstack([first, second])  # the equations, two rows for each pair
    Vt = np.linalg.svd(D)[2]  # the right singular vectors
    h = Vt[-1]  # the null vector
    return h.reshape(3, 3)


def _where_solvable(solve: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Any]:
    """Return one of the notes' two solutions, which gives nothing where h9 is 0."""

    def answer(src: Array, dst: Array) -> Any:
        try:
            return solve(src, dst)
        except DegenerateError:
            return None

    return answer


# With h9 = 1 and a wrong sign; nothing where the eight equations have no solution.
_WRONG_SIGN = (
    "np.append(np.linalg.solve(D[:, :8], D[:, 8]), 1).reshape(3, 3) "
    "if np.linalg.cond(D[:, :8] / abs(D).max(0)[:8]) < 1e10 else None"
)
_MISTAKES = mistakes_in(_steps,
    ("an affine map", "The last row of your H is (0, 0, 1): an affine map keeps parallels "
     "parallel, which a camera does not.",
     affine_fit),
    ("h9 = 1", "Right unless the true h9 is 0, which neither h9 = 1 nor the notes' formula for h9 "
     "can express: both solve the same 8×8 system, and it is singular then.",
     _where_solvable(four_points_h9_one), _where_solvable(four_points_unit_norm),
     "np.append(np.linalg.lstsq(D[:, :8], -D[:, 8])[0], 1).reshape(3, 3)"),
    ("sign of the right-hand side", "With which sign does the ninth column go to the other side?",
     _WRONG_SIGN),
    ("three points only", "That is the affine map of three points. How far off is the fourth?",
     lambda src, dst: affine_fit(src[:3], dst[:3])),
    ("full_matrices=False", "full_matrices=False leaves out the null vector that eight rows have.",
     ("svd(D)", "svd(D, full_matrices=False)")),
    ("a column of Vt", "You took a column of Vᵀ: where in it are the singular vectors?",
     ("Vt[-1]", "Vt[:, -1]"), {"same": up_to_signs}),
    ("the last pair left out", "You used three of the four pairs: how many equations are needed?",
     lambda src, dst: np.linalg.svd(design_matrix(src[:3], dst[:3]))[2][-1].reshape(3, 3),
     {"seen": _fits_three}),
)  # fmt: skip

EXERCISE = Exercise(
    name="four_points",
    chapter=6,
    title="Four points fix a homography",
    task="Give H (3, 3), of any scale, with dst ≈ H src from exactly four point pairs, shape "
    "(4, 2) each, no three of them on a line. It must work too when the origin of src is seen at "
    "infinity.",
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
    misconceptions=OF_THE_ROWS + _MISTAKES,
    reference=dlt,
    steps=_steps,
    sources=(design_matrix, normal_matrix, dlt),
    same=up_to_scale,
    concepts=("51", "52", "53", "E27"),
)
