"""The direct linear transform."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from collections.abc import Callable
from typing import Any

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
from cvnotes.learn.ch06.slips import AFFINE, EXCHANGED, TRANSPOSED
from cvnotes.projective import apply
from cvnotes.tutor.checker.equality import up_to_scale, up_to_signs
from cvnotes.tutor.checker.exercise import Case, Exercise, Misconception, Property, Rng, mistakes
from cvnotes.tutor.checker.steps import edited


def _views(rng: Rng) -> list[Case]:
    # the first four are corners of the board: no three of them on a line
    board = board_grid()[[0, 3, 11, 8, 1, 2, 4, 5, 6, 7, 9, 10]]
    H = some_homography(rng)
    noisy = apply(some_homography(rng), board) + 0.3 * rng.standard_normal((12, 2))
    return [
        Case((SQUARE, SQUARE_SEEN)),
        Case((board, np.round(apply(H, board), 9))),
        Case((board, np.round(noisy, 2)), about="noisy"),
        Case(_far_away(rng, board), about="noisy"),
    ]


def _far_away(rng: Rng, board: Array) -> tuple[Array, Array]:
    """Return pairs with a small picture and a far origin, where normalising is seen to matter."""
    while True:
        R, T = some_pose(rng)
        small = apply(plane_image(some_intrinsics(rng), R, 6 * T), board - [45, 30])
        src, dst = board + 1000, np.round(small + rng.standard_normal((12, 2)), 2)
        about_centres = (board - board.mean(axis=0), dst - dst.mean(axis=0))
        if all(
            _rms(_right_vectors(*pairs)[-1].reshape(3, 3), *pairs) > 1.5 * _rms(dlt(*pairs), *pairs)
            for pairs in ((src, dst), about_centres)
        ):
            return src, dst


def _rms(H: Array, src: Array, dst: Array) -> float:
    return float(np.sqrt((geometric_error(H, src, dst) ** 2).mean()))


def _right_vectors(src: Array, dst: Array) -> Array:
    """Return Vᵀ (9, 9) of the design matrix, whose rows are the right singular vectors."""
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


def _fits(H: Array, case: Case) -> bool:
    return bool((geometric_error(H, *case.args) < 1e-4 * case.slack).all())


def _fits_noise(H: Array, case: Case) -> bool:
    """Return whether H is about as good as the library's; three rows for each pair are 11 % off."""
    return _rms(H, *case.args) <= 1.2 * _rms(case.right, *case.args)


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
    """Return the null vector, as H, of a design matrix that has slipped."""
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


def _steps(src: Array, dst: Array) -> Any:
    N1 = normaliser(src)  # what normalises src
    N2 = normaliser(dst)  # what normalises dst
    p = apply(N1, src)  # src, normalised
    q = apply(N2, dst)  # dst, normalised
    D = design_matrix(p, q)  # the equations, two rows for each pair
    Vt = np.linalg.svd(D)[2]  # the right singular vectors
    G = Vt[-1].reshape(3, 3)  # the homography between normalised points
    return np.linalg.inv(N2) @ G @ N1


_MISTAKES = (
    EXCHANGED,
    TRANSPOSED,
    AFFINE,
    *OF_THE_ROWS,
    Misconception(
        "a column of Vt",
        "You took the last column of Vt. np.linalg.svd gives Vᵀ: where are the singular vectors?",
        _last_column,
        same=up_to_signs,
    ),
    *mistakes(
        ("the largest singular value", "You took the first singular vector, for which ‖D h‖ is "
         "largest; for which one is it smallest?",
         _first_row, _normalised(_first_row)),
        ("normalisation not undone", "That is the homography between normalised points: how does "
         "a point get there, and back?",
         edited(_steps, "np.linalg.inv(N2) @ G @ N1", "G"),
         edited(_steps, "np.linalg.inv(N2) @ G @ N1", "G @ N1"),
         edited(_steps, "np.linalg.inv(N2) @ G @ N1", "np.linalg.inv(N2) @ G")),
        ("normalisers exchanged", "You undid the normalisation with the two normalisers exchanged: "
         "a point of src enters at the right.",
         edited(_steps, "np.linalg.inv(N2) @ G @ N1", "np.linalg.inv(N1) @ G @ N2"),
         edited(_steps, "np.linalg.inv(N2) @ G @ N1", "N1 @ G @ np.linalg.inv(N2)")),
        ("normalisers inverted", "You undid the normalisation with both normalisers inverted: "
         "which of them leads in, which out?",
         edited(_steps, "np.linalg.inv(N2) @ G @ N1", "N2 @ G @ np.linalg.inv(N1)")),
        ("full_matrices=False", "Four pairs give eight equations, and full_matrices=False leaves "
         "their null vector out.",
         _economic, _normalised(_economic)),
        ("the first four pairs only", "Right on exact data. With noise every pair counts.",
         lambda src, dst: dlt(src[:4], dst[:4])),
        ("not normalised", "Right on exact data. With noise the entries of D must be of one size: "
         "what is to be done with the points first?",
         lambda src, dst: _right_vectors(src, dst)[-1].reshape(3, 3), _by_eigenvectors,
         _inhomogeneous),
        ("the trivial solution", "h = 0 solves D h = 0, as least squares will tell you, and means "
         "nothing.",
         lambda src, dst: np.zeros((3, 3))),
    ),
)  # fmt: skip

DLT = Exercise(
    name="dlt",
    chapter=6,
    title="The direct linear transform",
    task="Estimate the homography H (3, 3), of any scale and sign, with dst ≈ H src from n ≥ 4 "
    "point pairs, shape (n, 2) each.",
    stub='''def my_dlt(src, dst):
    """Return H (3, 3) with dst ≈ H src."""
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
    misconceptions=_MISTAKES,
    reference=dlt,
    steps=_steps,
    same=up_to_scale,
    concepts=("43", "47", "48", "68", "E26"),
    sources=(normaliser, design_matrix, dlt),
)
