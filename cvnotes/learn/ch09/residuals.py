"""What refinement makes small."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

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
        A, (k, _), G = some_intrinsics(rng, skew=True), some_lens(rng), some_pose_matrix(rng)
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


def _ideal(G: Array, W: Array) -> Array:
    M = W @ G[:3, :3].T + G[:3, 3]
    return np.asarray(M[:, :2] / M[:, 2:])


def _by_hand(A: Array, k: Array, G: Array, W: Array, m: Array) -> Array:
    xy = _ideal(G, W)
    return m - A[:2, 2] - (xy * lens_factor(xy, k)) @ A[:2, :2].T


def _without_T(A: Array, k: Array, G: Array, W: Array, m: Array) -> Array:
    G[:3, 3] = 0
    return _by_hand(A, k, G, W, m)


def _undistorted(A: Array, k: Array, G: Array, W: Array, m: Array) -> Array:
    seen = Camera(A, lens=Lens(tuple(k))).ideal(m) @ A[:2, :2].T + A[:2, 2]
    return np.asarray(_without_lens(A, k, G, W, m) - m + seen)


def _pixels(A: Array, xy: Array) -> Array:
    return np.asarray(xy @ A[:2, :2].T + A[:2, 2])


def _undivided(G: Array, W: Array) -> Array:
    return np.asarray((W @ G[:3, :3].T + G[:3, 3])[:, :2])


def _by_r(xy: Array, k: Array) -> Array:
    r = np.linalg.norm(xy, axis=1, keepdims=True)
    return np.asarray(xy * (1 + k[0] * r + k[1] * r**2))


def _at_one(A: Array, m: Array) -> Array:
    return np.asarray(np.linalg.solve(A[:2, :2], (m - A[:2, 2]).T).T)


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
        Misconception(
            "T left out",
            "T is missing: M = R W + T.",
            lambda A, k, G, W, m: _without_T(A, k, G, W, m),
        ),
        Misconception(
            "G inverted",
            "You used G⁻¹: G takes points of the board to the camera's frame already.",
            lambda A, k, G, W, m: _by_hand(A, k, np.linalg.inv(G), W, m),
        ),
        Misconception(
            "both coefficients with r²",
            "k2 belongs to r⁴, which is (r²)²; you used r² for both.",
            lambda A, k, G, W, m: residuals(A, np.array([k.sum(), 0.0]), G, W, m),
        ),
        Misconception(
            "divided by L",
            ("You divided by L. The lens multiplies: prediction distorts, correction undistorts."),
            lambda A, k, G, W, m: (
                m - A[:2, 2] - (_ideal(G, W) / lens_factor(_ideal(G, W), k)) @ A[:2, :2].T
            ),
        ),
        Misconception(
            "u and v exchanged",
            "Your prediction is (v, u), row before column; pixels are (u, v) here.",
            lambda A, k, G, W, m: m - (m - residuals(A, k, G, W, m))[:, ::-1],
        ),
        Misconception(
            "principal point left out",
            "u0 and v0 are missing in your prediction.",
            lambda A, k, G, W, m: residuals(A, k, G, W, m) + A[:2, 2],
        ),
        Misconception(
            "absolute values",
            "These are absolute values: least squares wants the signs too.",
            lambda A, k, G, W, m: np.abs(residuals(A, k, G, W, m)),
        ),
        Misconception(
            "lens of the wrong points",
            "You undistorted what was seen; prediction distorts the ideal points.",
            lambda A, k, G, W, m: _undistorted(A, k, G, W, m),
        ),
        Misconception(
            "r for r²",
            "You used r and r² where L has r² and r⁴.",
            lambda A, k, G, W, m: m - _pixels(A, _by_r(_ideal(G, W), k)),
        ),
        Misconception(
            "no division",
            "You did not divide by z before the lens.",
            lambda A, k, G, W, m: (
                m - _pixels(A, _undivided(G, W) * lens_factor(_undivided(G, W), k))
            ),
            variants=(lambda A, k, G, W, m: m - _pixels(A, _undivided(G, W)),),
        ),
        Misconception(
            "lens before the division",
            "You distorted before dividing by z: the lens acts on x/z and y/z.",
            lambda A, k, G, W, m: m - _pixels(A, _ideal(G, W) * lens_factor(_undivided(G, W), k)),
        ),
        Misconception(
            "predicted minus observed, lens left out",
            "The sign is the other way round, and the lens is missing.",
            lambda A, k, G, W, m: -_without_lens(A, k, G, W, m),
        ),
        Misconception(
            "the 1 of L left out",
            "L starts with 1: without distortion nothing moves.",
            lambda A, k, G, W, m: m - _pixels(A, _ideal(G, W) * (lens_factor(_ideal(G, W), k) - 1)),
        ),
        Misconception(
            "undistorted",
            "You undid the lens in the prediction: image formation distorts.",
            lambda A, k, G, W, m: m - _pixels(A, Lens(tuple(k)).undistort(_ideal(G, W))),
        ),
        Misconception(
            "on the plane z = 1",
            "You compared on the plane z = 1; corners are measured in pixels, and so are "
            "residuals.",
            lambda A, k, G, W, m: _at_one(A, m) - _ideal(G, W) * lens_factor(_ideal(G, W), k),
            variants=(lambda A, k, G, W, m: m - _ideal(G, W) * lens_factor(_ideal(G, W), k),),
        ),
        Misconception(
            "one number",
            "That is one number for all; least squares wants all differences.",
            lambda A, k, G, W, m: np.linalg.norm(residuals(A, k, G, W, m)),
            variants=(
                lambda A, k, G, W, m: np.sqrt((residuals(A, k, G, W, m) ** 2).sum(1).mean()),
                lambda A, k, G, W, m: np.sqrt((residuals(A, k, G, W, m) ** 2).mean()),
                lambda A, k, G, W, m: (residuals(A, k, G, W, m) ** 2).sum(),
            ),
        ),
        Misconception(
            "squared distances",
            "These are squared distances, one for each corner; asked are the differences "
            "themselves.",
            lambda A, k, G, W, m: (residuals(A, k, G, W, m) ** 2).sum(1),
        ),
        Misconception(
            "observed plus predicted",
            "You added them: observed minus predicted.",
            lambda A, k, G, W, m: 2 * m - residuals(A, k, G, W, m),
        ),
        Misconception(
            "centred",
            "You subtracted the mean of the residuals: it says how far the whole board is off.",
            lambda A, k, G, W, m: residuals(A, k, G, W, m) - residuals(A, k, G, W, m).mean(0),
        ),
        Misconception(
            "divided by what was observed",
            "Those are relative errors; asked are pixels.",
            lambda A, k, G, W, m: residuals(A, k, G, W, m) / m,
        ),
    ),
    reference=residuals,
    concepts=("50", "64", "E36"),
    sources=(residuals, Camera.project, Lens.distort, px_from_xy),
)
