"""What all views say about B."""

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import constraints, solve_b, v_ij
from cvnotes.learn.cases.cameras import ABOUT_X, ABOUT_Y, plane_image, some_intrinsics, some_views
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import up_to_scale, up_to_signs

# The picture scaled to about [−1, 1], in which the entries of b are of one size.
_UNIT = np.array([[1 / 320, 0, -0.85], [0, 1 / 320, -0.6], [0, 0, 1]])


def _tilted_views(rng: np.random.Generator) -> list[Case]:
    A = _UNIT @ some_intrinsics(rng, skew=True)
    three = [plane_image(np.diag([2.0, 2.5, 1]), R, np.array([0.5, 0, 4])) for R in _TILTS]
    return [
        Case((np.array(three),)),
        Case((some_views(rng, A, 4),)),
        Case((_noisy_views(rng, A),), about="noisy"),
    ]


def _noisy_views(rng: np.random.Generator, A: Array) -> Array:
    """Return twelve views, of which neither the first nor the last three are enough."""
    while True:
        views = some_views(rng, A, 12)
        views = views / np.linalg.norm(views, axis=(1, 2), keepdims=True)
        views = views + 2e-4 * rng.standard_normal(views.shape)
        best = _misfit(b_from_views(views), views)
        if all(_misfit(b_from_views(views[i : i + 3]), views) > 2 * best for i in (0, 9)):
            return np.asarray(views)


_TILTS = (ABOUT_X, ABOUT_Y, ABOUT_X @ ABOUT_Y)


def _rows(H: Array) -> Array:
    """Stack v_12 and v_11 − v_22 of all views, view by view, each H of size 1."""
    H = H / np.linalg.norm(H, axis=(1, 2), keepdims=True)
    v = v_ij.inside
    return np.stack([v(H, 1, 2), v(H, 1, 1) - v(H, 2, 2)], axis=1).reshape(-1, 6)


def _solves(some: slice) -> dict[str, Callable[[Array, Case], bool]]:
    """Recognise what solves some of the equations exactly, and not all of them."""

    def seen(b: Array, case: Case) -> bool:
        V = _rows(*case.args)[some]
        size = np.linalg.norm(V, axis=1) * np.linalg.norm(b)
        near = up_to_scale(b, case.right, 1e-4)  # what fits all views fits these by chance, too
        return bool((np.abs(V @ b) <= 1e-9 * size).all() and b.any()) and not near

    return {"seen": seen}


def _both_constraints(b: Array, case: Case) -> bool:
    V = constraints(case.args[0])
    size = np.linalg.norm(V, axis=1) * np.linalg.norm(b)
    return bool((np.abs(V @ b) <= 1e-6 * case.slack * size).all())


def _misfit(b: Array, H: Array) -> float:
    """Return how much the constraints are violated, for views of size one and b of length one."""
    return float(np.linalg.norm(_rows(H) @ b) / np.linalg.norm(b))


def _fits_noise(b: Array, case: Case) -> bool:
    return _misfit(b, *case.args) <= 1.5 * _misfit(case.right, *case.args)


def b_from_views(H: Array) -> Array:
    """Return b (6,) from the homographies H (n, 3, 3)."""
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


_SIZES = (
    "H / np.linalg.norm(H, axis=(1, 2), keepdims=True)", "H", "H / H[:, 2:, 2:]",
    "H / np.cbrt(np.linalg.det(H))[:, None, None]",
)  # fmt: skip


def _at_any_size(*changes: str) -> tuple[tuple[str, ...], ...]:
    """Return a mistake whose result depends on how the student scaled the H."""
    return tuple((_SIZES[0], size, *changes) for size in _SIZES)


_MISTAKES = mistakes_in(b_from_views,
    ("sum for difference", "You added the equations of both lengths; what is said of them?",
     *_at_any_size("v11 - v22", "v11 + v22")),
    ("rows of H", "You took the rows of H; what are h1 and h2?",
     *_at_any_size("H[:, :, 0], H[:, :, 1]", "H[:, 0], H[:, 1]")),
    ("the largest singular value", "You took the first singular vector, for which ‖V b‖ is "
     "largest; for which one is it smallest?",
     *_at_any_size("Vt[-1]", "Vt[0]")),
    ("mixed products doubled", "You doubled a mixed product, where both belong: check v_ij first.",
     *_at_any_size("(g[:, i] * h[:, j] + g[:, j] * h[:, i])", "2 * g[:, i] * h[:, j]")),
    ("the first three views only", "Right on exact data. With noise every view counts.",
     lambda H: solve_b(constraints(H[:3]), skew=True), lambda H: b_from_views(H[:3])),
    ("B12 for 0", "You set B12 to 0, as for a camera without skew. Here A may have one.",
     *_at_any_size("svd(V)", "svd(np.delete(V, 1, axis=1))", "np.insert(Vt[-1], 1, 0)"),
     lambda H: solve_b(constraints(H), skew=True) * [1, 0, 1, 1, 1, 1]),
    ("a column of Vt", "You took a column of Vᵀ: where in it are the singular vectors?",
     *_at_any_size("Vt[-1]", "Vt[:, -1]"), {"same": up_to_signs}),
    ("first view only", "One view gives two equations for five unknowns: what do the others say?",
     "np.linalg.svd(V[:: len(H)])[2][-1]", _solves(np.s_[:2])),
    ("the last view only", "Your b fits the last view alone: does each round of the loop overwrite "
     "the rows of the one before?",
     "np.linalg.svd(V[len(H) - 1 :: len(H)])[2][-1]", _solves(np.s_[-2:])),
    ("right angles only", "You asked that h1 and h2 are at right angles. Each view gives a second "
     "equation: what of their lengths?",
     "np.linalg.svd(v12)[2][-1]", _solves(np.s_[::2])),
    ("equal lengths only", "You asked that h1 and h2 are of one length. Each view gives a second "
     "equation: what of their angle?",
     "np.linalg.svd(v11 - v22)[2][-1]", _solves(np.s_[1::2])),
)  # fmt: skip

EXERCISE = Exercise(
    name="b_from_views",
    chapter=7,
    title="What all views say about B",
    task="Give b = (B11, B12, B22, B13, B23, B33), of any scale and sign, from homographies H (n, "
    "3, 3) of n ≥ 3 views, each of a scale of its own, into a picture scaled to about [−1, 1].",
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
    steps=b_from_views,
    same=up_to_scale,
    concepts=("55", "58", "E29", "E30"),
    sources=(v_ij, constraints, solve_b),
)
