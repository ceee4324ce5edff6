"""The direct linear transform."""

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import design_matrix, dlt, geometric_error, normaliser
from cvnotes.homography.linear import normal_matrix
from cvnotes.learn.cases.cameras import (
    SQUARE,
    affine_fit,
    board_grid,
    plane_image,
    some_homography,
    some_intrinsics,
    some_pose,
)
from cvnotes.learn.ch06.design_matrix import _steps as _steps_of_rows
from cvnotes.projective import apply
from cvnotes.tutor import Case, Exercise, Property, edited, mistakes_in
from cvnotes.tutor.checker.equality import up_to_scale, up_to_signs


def _views(rng: np.random.Generator) -> list[Case]:
    # the first four are corners of the board: no three of them on a line
    board = board_grid()[[0, 3, 11, 8, 1, 2, 4, 5, 6, 7, 9, 10]]
    H = some_homography(rng)
    noisy = apply(some_homography(rng), board) + 0.3 * rng.standard_normal((12, 2))
    return [
        Case(SQUARE),
        Case((board, np.round(apply(H, board), 9))),
        Case((board, np.round(noisy, 2)), about="noisy"),
        Case(_far_away(rng, board), about="noisy"),
    ]


def _far_away(rng: np.random.Generator, board: Array) -> tuple[Array, Array]:
    """Return pairs with a small picture and a far origin, where normalising is seen to matter."""
    while True:
        R, T = some_pose(rng)
        small = apply(plane_image(some_intrinsics(rng), R, 6 * T), board - [45, 30])
        src, dst = board + 1000, np.round(small + rng.standard_normal((12, 2)), 2)
        about_centres = (board - board.mean(axis=0), dst - dst.mean(axis=0))
        if all(
            _rms(_raw(*pairs), *pairs) > 1.5 * _rms(dlt(*pairs), *pairs)
            for pairs in ((src, dst), about_centres)
        ):
            return src, dst


def _rms(H: Array, src: Array, dst: Array) -> float:
    return float(np.sqrt((geometric_error(H, src, dst) ** 2).mean()))


def _fits(H: Array, case: Case) -> bool:
    return bool((geometric_error(H, *case.args) < 1e-4 * case.slack).all())


def _fits_noise(H: Array, case: Case) -> bool:
    """Return whether H is about as good as the library's; three rows for each pair are 11 % off."""
    return _rms(H, *case.args) <= 1.2 * _rms(case.right, *case.args)


def _steps(src: Array, dst: Array) -> Array:
    """Return H (3, 3) with dst ≈ H src."""
    N1 = normaliser(src)  # what normalises src
    N2 = normaliser(dst)  # what normalises dst
    p = apply(N1, src)  # src, normalised
    q = apply(N2, dst)  # dst, normalised
    D = design_matrix(p, q)  # the equations, two rows for each pair
    Vt = np.linalg.svd(D)[2]  # the right singular vectors
    G = Vt[-1].reshape(3, 3)  # the homography between normalised points
    return np.linalg.inv(N2) @ G @ N1


# The steps without normalising.
_RAW = ("normaliser(src)", "np.eye(3)", "normaliser(dst)", "np.eye(3)")
_raw = edited(_steps, *_RAW)
# The rows of D with their sign slipped, in both of each pair or in one.
_two_signs = edited(_steps_of_rows, "-u", "u", "-v", "v")
_one_sign = edited(_steps_of_rows, "-u", "u")


def _both(*changes: str) -> tuple[tuple[str, ...], ...]:
    """Return a mistake without normalising, and with."""
    return (*_RAW, *changes), changes


# What a slip in the rows of D does to H, where it leaves one null vector.
OF_THE_ROWS = mistakes_in(_steps,
    ("sign of the last block",
     "The last block of D has the wrong sign: W̃' and −u W̃'. So the last row of H has, too.",
     *_both("design_matrix(", "_two_signs(")),
    ("sign of one block",
     "In one of the two rows of each pair D has the wrong sign: −u W̃' and −v W̃'.",
     *_both("design_matrix(", "_one_sign(")),
)  # fmt: skip
_MISTAKES = mistakes_in(_steps,
    ("a column of Vt", "You took a column of Vᵀ: where in it are the singular vectors?",
     (*_RAW, "Vt[-1]", "Vt[:, -1]"), {"same": up_to_signs}),
    ("an affine map", "The last row of your H is (0, 0, 1): an affine map keeps parallels "
     "parallel, which a camera does not.",
     affine_fit),
    ("the largest singular value", "You took the first singular vector, for which ‖D h‖ is "
     "largest; for which one is it smallest?",
     *_both("Vt[-1]", "Vt[0]")),
    ("normalisation not undone", "That is the homography between normalised points: how does "
     "a point get there, and back?",
     "G", "G @ N1", "np.linalg.inv(N2) @ G"),
    ("normalisers in the wrong places", "The normalisers are exchanged, or inverted: a point of "
     "src enters at the right, and leaves at the left as one of dst.",
     "np.linalg.inv(N1) @ G @ N2", "N1 @ G @ np.linalg.inv(N2)", "N2 @ G @ np.linalg.inv(N1)"),
    ("full_matrices=False", "full_matrices=False leaves out the null vector that eight rows have.",
     *_both("svd(D)", "svd(D, full_matrices=False)")),
    ("not normalised", "Right on exact data. With noise the entries of D must be of one size: "
     "what is to be done with the points first?",
     _raw, (*_RAW, "Vt[-1]", "np.linalg.eigh(D.T @ D)[1][:, 0]"),
     (*_RAW, "Vt[-1]", "np.append(np.linalg.lstsq(D[:, :8], -D[:, 8], rcond=None)[0], 1.0)")),
)  # fmt: skip

EXERCISE = Exercise(
    name="dlt",
    chapter=6,
    title="The direct linear transform",
    task="Estimate the homography H (3, 3), of any scale and sign, with dst ≈ H src from n ≥ 4 "
    "point pairs, shape (n, 2) each.",
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
    misconceptions=OF_THE_ROWS + _MISTAKES,
    reference=dlt,
    steps=_steps,
    same=up_to_scale,
    concepts=("43", "47", "48", "68", "E26"),
    sources=(normaliser, design_matrix, normal_matrix, dlt),
)
