"""What refinement makes small."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, px_from_xy
from cvnotes.learn.cases.cameras import (
    board_grid,
    lens_factor,
    rounded,
    some_intrinsics,
    some_lens,
    some_pose_matrix,
)
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def residuals(A: Array, k: Array, G: Array, W: Array, m: Array) -> Array:
    """Give observed minus predicted pixels (n, 2) of one view."""
    return np.asarray(m - Camera(A, G, Lens(tuple(k))).project(W))


def _views(rng: Rng) -> list[Case]:
    cases = []
    for n in (2, 9):
        A, (k, _), G = some_intrinsics(rng), some_lens(rng), some_pose_matrix(rng)
        W = np.column_stack([board_grid()[-n:], np.zeros(n)])
        seen = Camera(A, G, Lens(tuple(k))).project(W)
        cases.append(Case((A, k, G, W, rounded(seen + rng.uniform(-2, 2, seen.shape)))))
    return cases


def _without_lens(A: Array, k: Array, G: Array, W: Array, m: Array) -> Array:
    return residuals(A, 0 * k, G, W, m)


def _lens_on_pixels(A: Array, k: Array, G: Array, W: Array, m: Array) -> Array:
    ideal = m - _without_lens(A, k, G, W, m)
    offset = ideal - A[:2, 2]
    return np.asarray(m - A[:2, 2] - offset * lens_factor(offset, k))


def _transposed(G: Array) -> Array:
    G[:3, :3] = G[:3, :3].T
    return G


RESIDUALS = Exercise(
    name="residuals",
    chapter=9,
    title="What refinement makes small",
    task="Give observed minus predicted pixels (n, 2) of one view: corners W (n, 3) of the board, "
    "pose G (4, 4), lens k = (k1, k2), sensor A, and where the corners were seen, m (n, 2).",
    stub='''def my_residuals(A, k, G, W, m):
    """Give m minus the predicted pixels, (n, 2)."""
    ...''',
    hints=(
        "Predict with the four steps of image formation, lens included.",
        "R = G[:3, :3] and T = G[:3, 3].",
        "Observed minus predicted: m − m̂.",
    ),
    cases=_views,
    properties=(Property("Each row is where the corner was seen minus where it should be."),),
    misconceptions=(
        Misconception(
            "predicted minus observed",
            "The sign is the other way round: observed minus predicted.",
            lambda A, k, G, W, m: -residuals(A, k, G, W, m),
        ),
        Misconception(
            "lens left out",
            "You predicted with an ideal lens: what remains is its distortion.",
            _without_lens,
        ),
        Misconception(
            "lens on pixels",
            "You applied L to offsets in pixels; the lens acts on the plane z = 1.",
            _lens_on_pixels,
        ),
        Misconception(
            "distances",
            "These are distances, one for each corner. Least squares wants both coordinates: a "
            "distance has no sign and a kink at 0.",
            lambda A, k, G, W, m: np.linalg.norm(residuals(A, k, G, W, m), axis=1),
        ),
        Misconception(
            "squares",
            "These are squares; the minimiser squares by itself.",
            lambda A, k, G, W, m: residuals(A, k, G, W, m) ** 2,
        ),
        Misconception(
            "rotation transposed",
            "W @ R applies Rᵀ to points that are rows: W @ R.T.",
            lambda A, k, G, W, m: residuals(A, k, _transposed(G), W, m),
        ),
        Misconception(
            "the prediction itself",
            "These are the predicted pixels: subtract them from m.",
            lambda A, k, G, W, m: m - residuals(A, k, G, W, m),
        ),
    ),
    reference=residuals,
    concepts=("50", "64", "E36"),
    sources=(residuals, Camera.project, Lens.distort, px_from_xy),
)
