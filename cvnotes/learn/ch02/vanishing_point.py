"""Where a direction is seen."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.learn.cases.cameras import ABOUT_Y, TIDY_A, rounded, some_intrinsics, some_rotation
from cvnotes.projective import from_homogeneous
from cvnotes.tutor import Case, Exercise, Property, mistakes_in

# A camera that looks along the world's y.
_ALONG_Y = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def _directions(rng: np.random.Generator) -> list[Case]:
    A, R = some_intrinsics(rng, skew=True), some_rotation(rng)
    ahead = rounded(R.T @ [*rng.uniform(-0.5, 0.5, 2), 1.0])
    aside = rounded(R.T @ [*rng.uniform(-1.4, -1.1, 2), 1.0])  # left of the picture and above
    return [
        Case((TIDY_A, ABOUT_Y, np.array([1.0, 2.0, 3.0]))),
        Case((A, R, ahead)),
        Case((A, R, -0.5 * aside), about="away"),
        Case((TIDY_A, ABOUT_Y, np.array([0.0, 1.0, 0.0])), about="parallel"),
        # seen, though level in the world; and parallel, though not level in it
        Case((TIDY_A, ABOUT_Y, np.array([1.0, 2.0, 0.0]))),
        Case((TIDY_A, _ALONG_Y, np.array([1.0, 0.0, 3.0])), about="parallel"),
    ]


def _seen(x_h: Array) -> Array:
    return from_homogeneous.inside(np.asarray(x_h, dtype=float))


def vanishing_point(A: Array, R: Array, d: Array) -> Array:
    """Return the vanishing point (2,) of the world direction d (3,); NaN if at infinity."""
    D = R @ d  # the direction in the camera's frame
    m_h = A @ D  # its homogeneous pixel
    m = m_h[:2] / m_h[2]  # the pixel, where there is one
    return np.where(D[2] == 0, np.nan, m)


MISTAKES = mistakes_in(vanishing_point,
    ("no division",
     "The first two coordinates are not the pixel yet: the division by the third is missing.",
     "m_h[:2]", "D[:2] * A[[0, 1], [0, 1]] + A[:2, 2]", "A[:2, :2] @ D[:2] + A[:2, 2]"),
    ("divided by the world's Z", "It is the third coordinate in the camera's frame that counts, as "
     "divisor and for lines without an end; you took the world's.",
     "(A @ R @ d)[:2] / d[2]",
     lambda A, R, d: vanishing_point(A, R, d) if d[2] else np.full(2, np.nan),
     "(A @ R @ d)[:2] / (A @ R @ d)[2] if d[2] else np.full(2, np.nan)"),
    ("no NaN at infinity", "Right, except for lines parallel to the image plane: there is no pixel "
     "in which they end. The task asks for NaN.",
     *(f"m if D[2] else {other}" for other in ("None", "np.zeros(2)", "m_h[:2]", "A[:2, 2]"))),
    ("directions that point away",
     "d and −d are the same lines and share one vanishing point: a factor may be negative.",
     "None if D[2] < 0 else _seen(m_h)", "m_h[:2] / np.abs(m_h[2])"),
    ("A and R in the wrong order",
     "A and R are not where they belong: to the left of the direction, R next to it.",
     "_seen(R @ A @ d)", "_seen(A.T @ R @ d)", "_seen(A.T @ R.T @ d)", "_seen(R.T @ A.T @ d)",
     "_seen(R.T @ np.linalg.inv(A) @ d)"),
    ("principal point added before the division", "You added u0 and v0 before dividing by z: they "
     "belong to the pixel, so they are added at the end.",
     ("m_h[:2] / m_h[2]", "(A[:2, :2] @ D[:2] + A[:2, 2]) / D[2]")),
    ("mirrored", "Your picture is mirrored: x runs to the right, y downwards, in both frames.",
     "_seen(A @ np.diag([1, -1, 1]) @ R @ d)", "2 * A[:2, 2] - _seen(A @ R @ d)"),
)  # fmt: skip


EXERCISE = Exercise(
    name="vanishing_point",
    chapter=2,
    title="Where a direction is seen",
    task="Give the pixel (2,) in which all lines of world direction d (3,) seem to end, for a "
    "camera with A and R. If there is no such pixel, give NaN twice.",
    hints=(
        "A direction is the point at infinity [d; 0]: T drops out.",
        "m̃ ≈ A R d, then divide by the third coordinate.",
        "If that is 0, the lines are parallel to the image plane and stay parallel in the "
        "picture. A direction that points away has the same lines as the opposite one.",
    ),
    cases=_directions,
    properties=(
        Property("It is the pixel that far points of such a line approach."),
        Property("d and −d are the same lines, with the same vanishing point.", about="away"),
        Property("Lines parallel to the image plane have none: NaN.", about="parallel"),
    ),
    misconceptions=MISTAKES,
    steps=vanishing_point,
    concepts=("5", "13", "14", "E5", "E6"),
    sources=(Camera.vanishing_point, from_homogeneous),
)
