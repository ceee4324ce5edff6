"""How far off is H."""

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import geometric_error
from cvnotes.learn.cases.cameras import board_grid, rounded, some_factors, some_homography
from cvnotes.projective import apply, from_homogeneous, to_homogeneous
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _with_errors(rng: np.random.Generator) -> list[Case]:
    by_hand = np.array([[2.0, 0, 4], [0, 2, 6], [0, 0.5, 2]])
    src = board_grid()[:7]
    H = some_homography(rng)
    dst = rounded(apply(H, src) + rng.uniform(-3, 3, src.shape), 1)
    return [
        Case((by_hand, np.array([[1.0, 0.0], [2.0, 4.0]]), np.array([[6.0, 7.0], [2.0, 3.0]]))),
        Case((H * some_factors(rng, 1)[0], src, dst)),
    ]


def _other_plane(H: Array, src: Array, dst: Array) -> Array:
    return geometric_error(np.linalg.inv(H), dst, src)


def _steps(H: Array, src: Array, dst: Array) -> Array:
    """Return the distances (n,) between dst and the image of src under H."""
    s_h = np.column_stack([src, np.ones(len(src))])  # src, lifted
    m_h = s_h @ H.T  # where H takes src, homogeneous
    m = m_h[:, :2] / m_h[:, 2:]  # where H takes src
    d = m - dst  # the differences
    return np.sqrt((d**2).sum(axis=1))


_MISTAKES = mistakes_in(_steps,
    ("no division", "Divide by the third coordinate before you subtract: H has any scale.",
     (" / m_h[:, 2:]", "")),
    ("difference of homogeneous vectors", "You subtracted vectors with three coordinates, as the "
     "notes print it. Their scales are arbitrary.",
     lambda H, src, dst: np.linalg.norm(to_homogeneous(dst) - to_homogeneous(src) @ H.T, axis=1)),
    ("algebraic error", "That is the error of D h = 0: it depends on the scale of H.",
     "np.linalg.norm(m_h[:, :2] - m_h[:, 2:] * dst, axis=1)"),
    ("divided by h33", "You divided H by h33; every point has a third coordinate of its own.",
     ("m_h[:, 2:]", "H[2, 2]")),
    ("error in the other plane", "That is the distance in the plane of src; asked is that of dst.",
     _other_plane),
    ("both directions", "You added the error in the other plane; asked is that of dst.",
     lambda H, src, dst: geometric_error(H, src, dst) + _other_plane(H, src, dst),
     lambda H, src, dst: np.hypot(geometric_error(H, src, dst), _other_plane(H, src, dst))),
    ("one coordinate only", "You compared one coordinate only; a distance has both.",
     "abs(d[:, 0])", "abs(d[:, 1])"),
    ("no distance",
     "You added both differences, took their mean, or the larger one; what is their distance?",
     "abs(d).sum(axis=1)", "abs(d).max(axis=1)", "d.sum(axis=1)", "-d.sum(axis=1)",
     "abs(d).mean(axis=1)", "d.mean(axis=1)", "-d.mean(axis=1)"),
)  # fmt: skip


EXERCISE = Exercise(
    name="geometric_error",
    chapter=6,
    title="How far off is H?",
    task="Give for each pair the distance in pixels between dst (n, 2) and where H (3, 3), of any "
    "scale, takes src (n, 2): shape (n,).",
    hints=(
        "Lift src, multiply by H, divide by the third coordinate.",
        "Only then subtract: homogeneous coordinates have no scale of their own.",
        "np.linalg.norm(…, axis=1) gives one length for each row.",
    ),
    cases=_with_errors,
    properties=(
        Property("They are distances in the plane of dst, and the scale of H does not matter."),
    ),
    misconceptions=_MISTAKES,
    reference=geometric_error,
    steps=_steps,
    sources=(geometric_error, from_homogeneous),
    concepts=("49", "50", "E25"),
)
