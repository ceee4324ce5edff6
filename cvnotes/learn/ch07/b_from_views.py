"""What all views say about B."""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.calibration import constraints, solve_b, v_ij
from cvnotes.learn.cases.cameras import ABOUT_X, ABOUT_Y, plane_image, some_intrinsics, some_views
from cvnotes.tutor.checker.equality import Same, up_to_scale, up_to_signs
from cvnotes.tutor.checker.exercise import Case, Exercise, Misconception, Property, Rng, mistakes
from cvnotes.tutor.checker.steps import edited

# The picture scaled to about [−1, 1], in which the entries of b are of one size.
_UNIT = np.array([[1 / 320, 0, -0.85], [0, 1 / 320, -0.6], [0, 0, 1]])


def b_from_views(H: Array) -> Array:
    """Return b (6,), up to scale, from the homographies (n, 3, 3) of n views."""
    return solve_b(constraints(H), skew=True)


def _tilted_views(rng: Rng) -> list[Case]:
    A = _UNIT @ some_intrinsics(rng, skew=True)
    three = [plane_image(np.diag([2.0, 2.5, 1]), R, np.array([0.5, 0, 4])) for R in _TILTS]
    return [
        Case((np.array(three),)),
        Case((some_views(rng, A, 4),)),
        Case((_noisy_views(rng, A),), about="noisy"),
    ]


def _noisy_views(rng: Rng, A: Array) -> Array:
    """Return twelve views, of which neither the first nor the last three are enough."""
    while True:
        views = some_views(rng, A, 12)
        views = views / np.linalg.norm(views, axis=(1, 2), keepdims=True)
        views = views + 2e-4 * rng.standard_normal(views.shape)
        best = _misfit(b_from_views(views), views)
        if all(_misfit(b_from_views(views[i : i + 3]), views) > 2 * best for i in (0, 9)):
            return np.asarray(views)


_TILTS = (ABOUT_X, ABOUT_Y, ABOUT_X @ ABOUT_Y)


def _null(V: Array) -> Array:
    return np.asarray(np.linalg.svd(V)[2][-1])


def _products(a: Array, b: Array) -> Array:
    """Return v with aᵀ B b = v·b for columns a and b (n, 3) of n views."""
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
    size = np.linalg.norm(V, axis=1) * np.linalg.norm(b)
    return bool((np.abs(V @ b) <= 1e-6 * case.slack * size).all())


def _misfit(b: Array, H: Array) -> float:
    """Return how much the constraints are violated, for views of size one and b of length one."""
    V = _rows(H / np.linalg.norm(H, axis=(1, 2), keepdims=True))
    return float(np.linalg.norm(V @ b) / np.linalg.norm(b))


def _fits_noise(b: Array, case: Case) -> bool:
    return _misfit(b, *case.args) <= 1.5 * _misfit(case.right, *case.args)


def _steps(H: Array) -> Any:
    H = H / np.linalg.norm(H, axis=(1, 2), keepdims=True)  # the homographies, each of size 1
    g, h = H[:, :, 0], H[:, :, 1]
    i, j = np.array([0, 0, 1, 0, 1, 2]), np.array([0, 1, 1, 2, 2, 2])
    once = np.where(i == j, 0.5, 1)  # half where a product is counted twice
    v12 = once * (g[:, i] * h[:, j] + g[:, j] * h[:, i])  # the rows of the right angles
    v11 = 2 * once * g[:, i] * g[:, j]  # the rows of the length of h1
    v22 = 2 * once * h[:, i] * h[:, j]  # the rows of the length of h2
    V = np.vstack([v12, v11 - v22])  # the equations of all views
    Vt = np.linalg.svd(V)[2]  # the right singular vectors
    return Vt[-1]


_MISTAKES = (
    _at_any_scale(
        "sum for difference", "You added the equations of both lengths; what is said of them?",
        edited(_steps, "v11 - v22", "v11 + v22"),
    ),
    _at_any_scale(
        "rows of H", "You took the rows of H; what are h1 and h2?",
        edited(_steps, "H[:, :, 0], H[:, :, 1]", "H[:, 0], H[:, 1]"),
    ),
    _at_any_scale(
        "a column of Vt", "You took the last column of Vt. Where are the singular vectors?",
        lambda H: np.linalg.svd(_rows(H))[2][:, -1], same=up_to_signs,
    ),
    _at_any_scale(
        "the largest singular value", "You took the first singular vector, for which ‖V b‖ is "
        "largest; for which one is it smallest?",
        edited(_steps, "Vt[-1]", "Vt[0]"),
    ),
    _at_any_scale(
        "first view only", "One view gives two equations for five unknowns: what do the others "
        "say?",
        lambda H: _null(_rows(H[:1])), seen=_only(_first_view),
    ),
    _at_any_scale(
        "the last view only", "Your b fits the last view alone: does each round of the loop "
        "overwrite the rows of the one before?",
        lambda H: _null(_rows(H[-1:])), seen=_only(_last_view),
    ),
    _at_any_scale(
        "right angles only", "You asked that h1 and h2 are at right angles. Each view gives a "
        "second equation: what of their lengths?",
        _of_some(_right_angles), seen=_only(_right_angles),
    ),
    _at_any_scale(
        "equal lengths only", "You asked that h1 and h2 are of one length. Each view gives a "
        "second equation: what of their angle?",
        _of_some(_equal_lengths), seen=_only(_equal_lengths),
    ),
    _at_any_scale(
        "mixed products doubled", "You doubled one of the mixed products, where both belong: check "
        "v_ij by itself.",
        lambda H: _null(_slipped_rows(H, [0, 1, 1, 2, 2, 2])),
    ),
    *mistakes(
        ("the first three views only", "Right on exact data. With noise every view counts.",
         lambda H: b_from_views(H[:3])),
        ("the trivial solution", "b = 0 solves V b = 0, as least squares will tell you, and means "
         "nothing.",
         lambda _: np.zeros(6)),
        ("B12 for 0", "You set B12 to 0, as for a camera without skew. Here A may have one.",
         _without_skew,
         lambda H: b_from_views(H) * [1, 0, 1, 1, 1, 1],
         lambda H: np.delete(_without_skew(H), 1),
         lambda H: np.insert(_null(_rows(H)[:, [0, 2, 3, 4, 5]]), 1, 0.0)),
        ("B, not b", "That is the matrix B; asked are its six entries.",
         lambda H: _matrix(b_from_views(H)), lambda H: np.triu(_matrix(b_from_views(H))),
         lambda H: _matrix(b_from_views(H)).ravel()),
    ),
)  # fmt: skip

B_FROM_VIEWS = Exercise(
    name="b_from_views",
    chapter=7,
    title="What all views say about B",
    task="Give b = (B11, B12, B22, B13, B23, B33), of any scale and sign, from homographies H "
    "(n, 3, 3) of n ≥ 3 views, each of a scale of its own, into a picture scaled to about "
    "[−1, 1].",
    stub='''def my_b_from_views(H):
    """Return b (6,) from the homographies H (n, 3, 3)."""
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
    misconceptions=_MISTAKES,
    reference=b_from_views,
    steps=_steps,
    same=up_to_scale,
    concepts=("55", "58", "E29", "E30"),
    sources=(v_ij, constraints, solve_b),
)
