"""What all views say about B."""

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import constraints, solve_b, v_ij
from cvnotes.learn.cases.cameras import ABOUT_X, ABOUT_Y, plane_image, some_intrinsics, some_views
from cvnotes.learn.checker.equality import Same, up_to_scale, up_to_signs
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng

# The picture scaled to about [−1, 1], in which the entries of b are of one size.
_UNIT = np.array([[1 / 320, 0, -0.85], [0, 1 / 320, -0.6], [0, 0, 1]])


def b_from_views(H: Array) -> Array:
    """Give b (6,), up to scale, from the homographies (n, 3, 3) of n views."""
    return solve_b(constraints(H), skew=True)


def _tilted_views(rng: Rng) -> list[Case]:
    A = _UNIT @ some_intrinsics(rng)
    three = [plane_image(np.diag([2.0, 2.5, 1]), R, np.array([0.5, 0, 4])) for R in _TILTS]
    noisy = some_views(rng, A, 12)
    noisy = noisy / np.linalg.norm(noisy, axis=(1, 2), keepdims=True)
    noisy = noisy + 2e-4 * rng.standard_normal(noisy.shape)
    return [
        Case((np.array(three),)),
        Case((some_views(rng, A, 4),)),
        Case((noisy,), about="noisy"),
    ]


_TILTS = (ABOUT_X, ABOUT_Y, ABOUT_X @ ABOUT_Y)


def _null(V: Array) -> Array:
    return np.asarray(np.linalg.svd(V)[2][-1])


def _rows(H: Array, sign: float = -1.0) -> Array:
    """Stack v_12 and v_11 − v_22 of all views."""
    pairs = [(v_ij(X, 1, 2), v_ij(X, 1, 1) + sign * v_ij(X, 2, 2)) for X in H]
    return np.concatenate(pairs)


def _at_any_scale(
    name: str, sentence: str, gives: Callable[[Array], Array], same: Same | None = None
) -> Misconception:
    """Name a mistake whose result depends on how the student scaled the H."""
    scales: tuple[Callable[[Array], Array], ...] = (
        lambda H: np.asarray(H / np.linalg.norm(H, axis=(1, 2), keepdims=True)),
        lambda H: np.asarray(H / H[:, 2:, 2:]),
        lambda H: np.asarray(H / np.cbrt(np.linalg.det(H))[:, None, None]),
    )
    variants = tuple(lambda H, scale=scale: gives(scale(H)) for scale in scales)
    return Misconception(name, sentence, gives, variants, same)


def _both_constraints(b: Array, case: Case) -> bool:
    V = constraints(case.args[0])
    return bool((np.abs(V @ b) <= 1e-6 * np.linalg.norm(V, axis=1) * np.linalg.norm(b)).all())


def _misfit(b: Array, case: Case) -> float:
    """Give how much the constraints are violated, for views of size one and b of length one."""
    H = case.args[0]
    V = _rows(H / np.linalg.norm(H, axis=(1, 2), keepdims=True))
    return float(np.linalg.norm(V @ b) / np.linalg.norm(b))


def _fits_noise(b: Array, case: Case) -> bool:
    return _misfit(b, case) <= 1.5 * _misfit(case.right, case)


B_FROM_VIEWS = Exercise(
    name="b_from_views",
    chapter=7,
    title="What all views say about B",
    task="Give b = (B11, B12, B22, B13, B23, B33), of any scale and sign, from homographies H "
    "(n, 3, 3) of n ≥ 3 views, each of a scale of its own, into a picture scaled to about "
    "[−1, 1].",
    stub='''def my_b_from_views(H):
    """Give b (6,) from the homographies H (n, 3, 3)."""
    ...''',
    hints=(
        "Each view gives two rows of V: v_12 and v_11 − v_22, with your v_ij.",
        "V b = 0 is solved by b = 0; you want ‖b‖ = 1.",
        "So b is the right singular vector of the smallest singular value: the last row of Vt.",
    ),
    cases=_tilted_views,
    properties=(
        Property("h1ᵀ B h2 = 0 and h1ᵀ B h1 = h2ᵀ B h2 in every view.", _both_constraints),
        Property("b is the one and only answer, up to scale and sign."),
        Property(
            "With noise all views count: the constraints fit as well as they can.",
            _fits_noise,
            about="noisy",
        ),
    ),
    misconceptions=(
        _at_any_scale(
            "sum for difference",
            "You asked for v_11·b + v_22·b = 0. Both columns have the same length, so it is their "
            "difference that is 0.",
            lambda H: _null(_rows(H, sign=1.0)),
        ),
        _at_any_scale(
            "rows of H",
            "You took the rows of H; h1 and h2 are its columns.",
            lambda H: _null(_rows(H.mT)),
        ),
        _at_any_scale(
            "a column of Vt",
            "You took the last column of Vt. Its rows are the singular vectors: Vt[-1].",
            lambda H: np.linalg.svd(_rows(H))[2][:, -1],
            same=up_to_signs,
        ),
        _at_any_scale(
            "the largest singular value",
            "You took the first singular vector, for which ‖V b‖ is largest. The last one makes "
            "it small.",
            lambda H: np.linalg.svd(_rows(H))[2][0],
        ),
        Misconception(
            "the trivial solution",
            "b = 0 solves V b = 0, as least squares will tell you, and means nothing. Ask for "
            "‖b‖ = 1.",
            lambda _: np.zeros(6),
        ),
        _at_any_scale(
            "first view only",
            "One view gives two equations for five unknowns: stack the rows of all views.",
            lambda H: _null(_rows(H[:1])),
        ),
        Misconception(
            "another order of b",
            "Your b is (B11, B12, B13, B22, B23, B33); the notes have B22 before B13.",
            lambda H: b_from_views(H)[[0, 1, 3, 2, 4, 5]],
        ),
    ),
    reference=b_from_views,
    same=up_to_scale,
    concepts=("55", "58", "E29", "E30"),
    sources=(v_ij, constraints, solve_b),
)
