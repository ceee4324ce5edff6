"""The direct linear transform."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import design_matrix, dlt, geometric_error, normaliser
from cvnotes.learn.cases.cameras import (
    SQUARE,
    SQUARE_SEEN,
    board_grid,
    plane_image,
    some_homography,
    some_intrinsics,
    some_pose,
)
from cvnotes.learn.ch06.design_matrix import DESIGN
from cvnotes.learn.ch06.slips import AFFINE, EXCHANGED, TRANSPOSED, V_BEFORE_U, Y_BEFORE_X
from cvnotes.learn.checker.equality import up_to_scale, up_to_signs
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import apply


def _views(rng: Rng) -> list[Case]:
    # the first four are corners of the board: no three of them on a line
    board = board_grid()[[0, 3, 11, 8, 1, 2, 4, 5, 6, 7, 9, 10]]
    H = some_homography(rng)
    noisy = apply(some_homography(rng), board) + 0.3 * rng.standard_normal((12, 2))
    # far away: small in the picture, and its origin far outside of it
    R, T = some_pose(rng)
    small = apply(plane_image(some_intrinsics(rng), R, 6 * T), board - [45, 30])
    return [
        Case((SQUARE, SQUARE_SEEN)),
        Case((board, np.round(apply(H, board), 9))),
        Case((board, np.round(noisy, 2)), about="noisy"),
        Case((board + 1000, np.round(small + rng.standard_normal((12, 2)), 2)), about="noisy"),
    ]


def _right_vectors(src: Array, dst: Array) -> Array:
    """Give Vᵀ (9, 9) of the design matrix, whose rows are the right singular vectors."""
    return np.asarray(np.linalg.svd(design_matrix(src, dst))[2])


def _normalised(gives: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """Make a mistake between normalised points, and undo the normalisation rightly."""

    def mistake(src: Array, dst: Array) -> Array:
        N1, N2 = normaliser(src), normaliser(dst)
        return np.asarray(np.linalg.inv(N2) @ gives(apply(N1, src), apply(N2, dst)) @ N1)

    return mistake


def _first_row(src: Array, dst: Array) -> Array:
    return np.asarray(_right_vectors(src, dst)[0].reshape(3, 3))


def _last_column(src: Array, dst: Array) -> Array:
    return _right_vectors(src, dst)[:, -1].reshape(3, 3)


def _hat(src: Array, dst: Array) -> tuple[Array, Array, Array]:
    """Give the H of normalised points, and both normalisers."""
    N1, N2 = normaliser(src), normaliser(dst)
    return dlt(apply(N1, src), apply(N2, dst)), N1, N2


def _undone_wrongly(src: Array, dst: Array, *, order: bool) -> Array:
    H, N1, N2 = _hat(src, dst)
    return np.linalg.inv(N1) @ H @ N2 if order else N2 @ H @ np.linalg.inv(N1)


def _fits(H: Array, case: Case) -> bool:
    return bool((geometric_error(H, *case.args) < 1e-4 * case.slack).all())


def _fits_noise(H: Array, case: Case) -> bool:
    mine, best = (np.sqrt((geometric_error(X, *case.args) ** 2).mean()) for X in (H, case.right))
    return bool(mine <= 1.04 * best)


def _economic(src: Array, dst: Array) -> Array:
    Vt = np.linalg.svd(design_matrix(src, dst), full_matrices=False)[2]
    return np.asarray(Vt[-1].reshape(3, 3))


def _by_eigenvectors(src: Array, dst: Array) -> Array:
    D = design_matrix(src, dst)
    return np.linalg.eigh(D.T @ D)[1][:, 0].reshape(3, 3)


def _inhomogeneous(src: Array, dst: Array) -> Array:
    D = design_matrix(src, dst)
    h = np.linalg.lstsq(D[:, :8], -D[:, 8], rcond=None)[0]
    return np.append(h, 1.0).reshape(3, 3)


def _of_rows(rows: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """Give the null vector, as H, of a design matrix that has slipped."""
    return lambda src, dst: np.linalg.svd(rows(src, dst))[2][-1].reshape(3, 3)


def of_slipped_rows(name: str, sentence: str) -> Misconception:
    """Make a mistake of the design matrix one of the homography that follows from it."""
    slip = next(m for m in DESIGN.misconceptions if m.name == name).gives
    return Misconception(name, sentence, _of_rows(slip), (_normalised(_of_rows(slip)),))


# What a slip in the rows of D does to H, where it leaves one null vector.
OF_THE_ROWS = (
    of_slipped_rows(
        "sign of the last block",
        "The last block of D has the wrong sign: W̃' and −u W̃'. So the last row of H has, too.",
    ),
    of_slipped_rows(
        "sign of one block",
        "In one of the two rows of each pair D has the wrong sign: −u W̃' and −v W̃'.",
    ),
)


DLT = Exercise(
    name="dlt",
    chapter=6,
    title="The direct linear transform",
    task="Estimate the homography H (3, 3), of any scale and sign, with dst ≈ H src from n ≥ 4 "
    "point pairs, shape (n, 2) each.",
    stub='''def my_dlt(src, dst):
    """Give H (3, 3) with dst ≈ H src."""
    ...''',
    hints=(
        "Stack two rows for each pair to D h = 0, as in design_matrix.",
        "h is the right singular vector of D with the smallest singular value: the last row of "
        "Vt in U, s, Vt = np.linalg.svd(D).",
        "It holds the rows of H: h.reshape(3, 3). Normalise before and undo it after: "
        "H = N2⁻¹ Ĥ N1.",
    ),
    cases=_views,
    properties=(
        Property("On exact data H takes every point of src to its partner in dst.", _fits),
        Property("On exact data H is the map that made the data, up to scale and sign."),
        Property("With noise the errors stay as small as the noise.", _fits_noise, about="noisy"),
    ),
    misconceptions=(
        EXCHANGED,
        TRANSPOSED,
        Misconception(
            "a column of Vt",
            "You took the last column of Vt. np.linalg.svd gives Vᵀ: its rows are the singular "
            "vectors, so take Vt[-1].",
            _last_column,
            same=up_to_signs,
        ),
        Misconception(
            "the largest singular value",
            "You took the first singular vector, for which ‖D h‖ is largest. The smallest comes "
            "last.",
            _first_row,
            variants=(_normalised(_first_row),),
        ),
        Misconception(
            "normalisation not undone",
            "That is the homography between normalised points: H = N2⁻¹ Ĥ N1 brings it back.",
            lambda src, dst: _hat(src, dst)[0],
        ),
        Misconception(
            "normalisers exchanged",
            "You undid the normalisation with N1⁻¹ Ĥ N2. A point of src enters at the right: "
            "first N1, then Ĥ, then N2⁻¹.",
            lambda src, dst: _undone_wrongly(src, dst, order=True),
        ),
        Misconception(
            "normalisers inverted",
            "You have N2 Ĥ N1⁻¹: points of src have to be normalised on the way in (N1), and "
            "those of dst brought back on the way out (N2⁻¹).",
            lambda src, dst: _undone_wrongly(src, dst, order=False),
        ),
        V_BEFORE_U,
        Y_BEFORE_X,
        AFFINE,
        Misconception(
            "full_matrices=False",
            (
                "Four pairs give eight equations, and the null vector of D (8, 9) is the ninth "
                "row of Vt: full_matrices=False leaves it out."
            ),
            _economic,
            variants=(_normalised(_economic),),
        ),
        Misconception(
            "the first four pairs only",
            ("Right on exact data. With noise every pair counts: stack the rows of all of them."),
            lambda src, dst: dlt(src[:4], dst[:4]),
        ),
        Misconception(
            "not normalised",
            (
                "Right on exact data. With noise the entries of D must be of one size: normalise "
                "the points first, H = N2⁻¹ Ĥ N1."
            ),
            lambda src, dst: _right_vectors(src, dst)[-1].reshape(3, 3),
            variants=(lambda src, dst: _by_eigenvectors(src, dst),),
        ),
        Misconception(
            "h9 = 1, not normalised",
            (
                "Right on exact data. With noise the entries of D must be of one size: normalise "
                "the points first, H = N2⁻¹ Ĥ N1; and ‖h‖ = 1 in place of h9 = 1."
            ),
            _inhomogeneous,
        ),
        Misconception(
            "the trivial solution",
            (
                "h = 0 solves D h = 0, as least squares will tell you, and means nothing. Ask for "
                "‖h‖ = 1."
            ),
            lambda src, dst: np.zeros((3, 3)),
        ),
        Misconception(
            "the second smallest singular value",
            ("You took the last but one singular vector; the smallest singular value comes last."),
            lambda src, dst: _right_vectors(src, dst)[-2].reshape(3, 3),
            variants=(_normalised(lambda src, dst: _right_vectors(src, dst)[-2].reshape(3, 3)),),
        ),
        Misconception(
            "undone on one side only",
            "You undid the normalisation on one side only: H = N2⁻¹ Ĥ N1.",
            lambda src, dst: _hat(src, dst)[0] @ _hat(src, dst)[1],
            variants=(lambda src, dst: np.linalg.inv(_hat(src, dst)[2]) @ _hat(src, dst)[0],),
        ),
        *OF_THE_ROWS,
    ),
    reference=dlt,
    same=up_to_scale,
    concepts=("43", "47", "48", "68", "E26"),
    sources=(normaliser, design_matrix, dlt),
)
