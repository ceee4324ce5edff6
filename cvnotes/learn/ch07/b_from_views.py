"""What all views say about B."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

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
    A = _UNIT @ some_intrinsics(rng, skew=True)
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


def _products(a: Array, b: Array) -> Array:
    """Give v with aᵀ B b = v·b for columns a and b (n, 3) of n views."""
    first, second = [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]
    both = a[:, first] * b[:, second] + a[:, second] * b[:, first]
    return np.asarray(both * [0.5, 1, 0.5, 1, 1, 0.5])


def _rows(H: Array, sign: float = -1.0) -> Array:
    """Stack v_12 and v_11 − v_22 of all views, view by view."""
    h1, h2 = H[..., 0], H[..., 1]
    pairs = _products(h1, h2), _products(h1, h1) + sign * _products(h2, h2)
    return np.stack(pairs, axis=1).reshape(-1, 6)


# Which rows of V are asked for.
Which = Callable[[npt.NDArray[np.intp]], npt.NDArray[np.bool_]]


def _only(which: Which) -> Callable[[Array, Case], bool]:
    """Recognise what solves some of the equations exactly, and not all of them."""

    def seen(b: Array, case: Case) -> bool:
        H = case.args[0]
        V = _rows(H / np.linalg.norm(H, axis=(1, 2), keepdims=True))
        size = np.linalg.norm(V, axis=1) * np.linalg.norm(b)
        misfit = np.abs(V @ b)
        some = which(np.arange(len(V)))
        return bool((misfit[some] <= 1e-9 * size[some]).all() and b.any())

    return seen


def _of_some(which: Which) -> Callable[[Array], Array]:
    def gives(H: Array) -> Array:
        V = _rows(H)
        return _null(V[which(np.arange(len(V)))])

    return gives


def _right_angles(rows: npt.NDArray[np.intp]) -> npt.NDArray[np.bool_]:
    return np.asarray(rows % 2 == 0)


def _equal_lengths(rows: npt.NDArray[np.intp]) -> npt.NDArray[np.bool_]:
    return np.asarray(rows % 2 == 1)


def _last_view(rows: npt.NDArray[np.intp]) -> npt.NDArray[np.bool_]:
    return np.asarray(rows >= len(rows) - 2)


def _first_view(rows: npt.NDArray[np.intp]) -> npt.NDArray[np.bool_]:
    return np.asarray(rows < 2)


def _scaled_alike(H: Array) -> Array:
    """Scale views so that columns are about one long, as a right answer may."""
    return np.asarray(H / np.linalg.norm(H, axis=(1, 2), keepdims=True))


def _matrix(b: Array) -> Array:
    return np.asarray(b[[0, 1, 3, 1, 2, 4, 3, 4, 5]].reshape(3, 3))


def _b_of(B: Array) -> Array:
    return np.asarray(B[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]])


def _slipped_rows(H: Array, second: list[int]) -> Array:
    """Stack rows whose mixed products are one product doubled."""
    first, mixed = [0, 0, 1, 0, 1, 2], np.array([1, 2, 1, 2, 2, 1])

    def v(a: Array, b: Array) -> Array:
        return np.asarray(mixed * a[first] * b[second])

    return np.concatenate(
        [(v(X[:, 0], X[:, 1]), v(X[:, 0], X[:, 0]) - v(X[:, 1], X[:, 1])) for X in H]
    )


def _without_skew(H: Array) -> Array:
    return np.insert(_null(_rows(_scaled_alike(H))[:, [0, 2, 3, 4, 5]]), 1, 0.0)


def _at_any_scale(
    name: str,
    sentence: str,
    gives: Callable[[Array], Array],
    same: Same | None = None,
    seen: Callable[[Array, Case], bool] | None = None,
) -> Misconception:
    """Name a mistake whose result depends on how the student scaled the H."""
    scales: tuple[Callable[[Array], Array], ...] = (
        lambda H: np.asarray(H / np.linalg.norm(H, axis=(1, 2), keepdims=True)),
        lambda H: np.asarray(H / H[:, 2:, 2:]),
        lambda H: np.asarray(H / np.cbrt(np.linalg.det(H))[:, None, None]),
    )
    variants = tuple(lambda H, scale=scale: gives(scale(H)) for scale in scales)
    return Misconception(name, sentence, gives, variants, same, seen)


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
        "Each view gives two rows of V: v_12 and v_11 − v_22, with your v_ij. The H are scaled to "
        "[−1, 1] already: nothing has to be undone.",
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
            seen=_only(_first_view),
        ),
        Misconception(
            "another order of b",
            "Your b is (B11, B12, B13, B22, B23, B33); the notes have B22 before B13.",
            lambda H: b_from_views(H)[[0, 1, 3, 2, 4, 5]],
        ),
        _at_any_scale(
            "the last view only",
            "Your b fits the last view alone: does each round of the loop overwrite the rows of "
            "the one before? Stack the rows of all views.",
            lambda H: _null(_rows(H[-1:])),
            seen=_only(_last_view),
        ),
        _at_any_scale(
            "right angles only",
            "You asked for h1ᵀ B h2 = 0 alone. Each view gives a second equation, for the equal "
            "lengths: h1ᵀ B h1 = h2ᵀ B h2.",
            _of_some(_right_angles),
            seen=_only(_right_angles),
        ),
        _at_any_scale(
            "equal lengths only",
            "You asked for h1ᵀ B h1 = h2ᵀ B h2 alone. Each view gives a second equation, for the "
            "right angle: h1ᵀ B h2 = 0.",
            _of_some(_equal_lengths),
            seen=_only(_equal_lengths),
        ),
        Misconception(
            "B12 for 0",
            "You set B12 to 0, as for a camera without skew. Here A may have one: six unknowns.",
            _without_skew,
            variants=(
                lambda H: b_from_views(H) * [1, 0, 1, 1, 1, 1],
                lambda H: np.delete(_without_skew(H), 1),
                lambda H: np.insert(_null(_rows(H)[:, [0, 2, 3, 4, 5]]), 1, 0.0),
            ),
        ),
        Misconception(
            "B, not b",
            "That is the matrix B; asked are its six entries b = (B11, B12, B22, B13, B23, B33).",
            lambda H: _matrix(b_from_views(H)),
            variants=(
                lambda H: np.triu(_matrix(b_from_views(H))),
                lambda H: _matrix(b_from_views(H)).ravel(),
            ),
        ),
        _at_any_scale(
            "mixed products doubled",
            "Your v doubles a1 b2 in place of a1 b2 + a2 b1: check v_ij by itself.",
            lambda H: _null(_slipped_rows(H, [0, 1, 1, 2, 2, 2])),
        ),
        _at_any_scale(
            "the second smallest singular value",
            "You took the last but one singular vector; the smallest singular value comes last.",
            lambda H: np.asarray(np.linalg.svd(_rows(H))[2][-2]),
        ),
        Misconception(
            "A⁻ᵀ A⁻¹ inverted",
            "That is A Aᵀ, the inverse of B.",
            lambda H: _b_of(np.asarray(np.linalg.inv(_matrix(b_from_views(H))))),
        ),
    ),
    reference=b_from_views,
    same=up_to_scale,
    concepts=("55", "58", "E29", "E30"),
    sources=(v_ij, constraints, solve_b),
)
