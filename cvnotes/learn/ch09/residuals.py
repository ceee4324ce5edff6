"""What refinement makes small."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens
from cvnotes.learn.cases.cameras import board_grid, some_intrinsics, some_lens, some_pose_matrix
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _views(rng: np.random.Generator) -> list[Case]:
    cases = []
    for n in (2, 9):
        A, (k, _), G = some_intrinsics(rng, skew=True), some_lens(rng), some_pose_matrix(rng)
        W = np.column_stack([board_grid()[-n:], np.zeros(n)])
        seen = Camera(A, G, Lens(tuple(k))).project(W)
        cases.append(Case((A, k, G, W, np.round(seen + rng.uniform(-2, 2, seen.shape), 2))))
    return cases


def residuals(A: Array, k: Array, G: Array, W: Array, m: Array) -> Array:
    """Return m minus the predicted pixels, (n, 2)."""
    M = W @ G[:3, :3].T + G[:3, 3]  # the points in the camera's frame
    xy = M[:, :2] / M[:, 2:]  # the ideal points
    r2 = (xy**2).sum(axis=1, keepdims=True)  # r²
    L = 1 + k[0] * r2 + k[1] * r2**2  # the radial factor L
    seen = L * xy @ A[:2, :2].T + A[:2, 2]  # the predicted pixels
    return m - seen


_MISTAKES = mistakes_in(residuals,
    ("lens left out", "You predicted with an ideal lens: what remains is its distortion.",
     ("L * xy", "xy"), ("L * xy", "xy", "seen - m")),
    ("lens on pixels", "You applied L to offsets in pixels; on which plane does the lens act?",
     ("r2 = (xy**2)", "r2 = ((xy @ A[:2, :2].T)**2)")),
    ("distances", "These are distances, one for each corner. Least squares wants both coordinates: "
     "a distance has no sign and a kink at 0.",
     lambda A, k, G, W, m: np.linalg.norm(residuals(A, k, G, W, m), axis=1)),
    ("undistorted",
     "You undid the lens in the prediction, or divided by L: image formation distorts.",
     ("L * xy", "xy / L"), ("L * xy", "_undone(k, xy)")),
    ("lens of the wrong points", "You undistorted what was seen; prediction distorts.",
     ("    seen = L * xy",
      "    at = (m - A[:2, 2]) @ np.linalg.inv(A[:2, :2]).T; "
      "m = _undone(k, at) @ A[:2, :2].T + A[:2, 2]; seen = xy")),
    ("lens before the division", "You took r before dividing by z: of which plane is it?",
     ("(xy**2)", "(M[:, :2]**2)")),
    ("no division", "You did not divide by z before the lens.",
     (" / M[:, 2:]", ""), (" / M[:, 2:]", "", "L * xy", "xy")),
    ("r for r²", "Which powers of r does L have? You have others.",
     ("(xy**2).sum(axis=1, keepdims=True)", "np.linalg.norm(xy, axis=1, keepdims=True)")),
    ("u and v exchanged", "Your prediction has the row before the column.",
     "m - seen[:, ::-1]"),
    ("on the plane z = 1", "You compared on the plane z = 1; residuals are pixels, as corners are.",
     "(m - A[:2, 2]) @ np.linalg.inv(A[:2, :2]).T - L * xy", "m - L * xy"),
)  # fmt: skip


def _undone(k: Array, xy: Array) -> Array:
    return Lens(tuple(k)).undistort(xy)


EXERCISE = Exercise(
    name="residuals",
    chapter=9,
    title="What refinement makes small",
    task="Give observed minus predicted pixels (n, 2) of one view: corners W (n, 3) of the board, "
    "pose G (4, 4), lens k = (k1, k2), sensor A, and where the corners were seen, m (n, 2).",
    hints=(
        "Predict with the four steps of image formation, lens included.",
        "R = G[:3, :3] and T = G[:3, 3].",
        "Observed minus predicted: m − m̂.",
    ),
    cases=_views,
    properties=(Property("Each row is where the corner was seen minus where it should be."),),
    misconceptions=_MISTAKES,
    steps=residuals,
    concepts=("50", "64", "E36"),
)
