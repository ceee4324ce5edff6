"""How far off is H."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import geometric_error
from cvnotes.learn.cases.cameras import board_grid, rounded, some_factors, some_homography
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import apply, from_homogeneous, to_homogeneous


def _with_errors(rng: Rng) -> list[Case]:
    by_hand = np.array([[2.0, 0, 4], [0, 2, 6], [0, 0.5, 2]])
    src = board_grid()[:7]
    H = some_homography(rng)
    dst = rounded(apply(H, src) + rng.uniform(-3, 3, src.shape), 1)
    return [
        Case((by_hand, np.array([[1.0, 0.0], [2.0, 4.0]]), np.array([[6.0, 7.0], [2.0, 3.0]]))),
        Case((H * some_factors(rng, 1)[0], src, dst)),
    ]


def _mapped(H: Array, src: Array) -> Array:
    return from_homogeneous.inside(to_homogeneous(src) @ H.T)


def _algebraic(H: Array, src: Array, dst: Array) -> Array:
    m_h = to_homogeneous(src) @ H.T
    return np.asarray(np.linalg.norm(m_h[:, :2] - m_h[:, 2:] * dst, axis=1))


GEOMETRIC = Exercise(
    name="geometric_error",
    chapter=6,
    title="How far off is H?",
    task="Give for each pair the distance in pixels between dst (n, 2) and where H (3, 3), of any "
    "scale, takes src (n, 2): shape (n,).",
    stub='''def my_geometric_error(H, src, dst):
    """Give the distances (n,) between dst and the image of src under H."""
    ...''',
    hints=(
        "Lift src, multiply by H, divide by the third coordinate.",
        "Only then subtract: homogeneous coordinates have no scale of their own.",
        "np.linalg.norm(…, axis=1) gives one length for each row.",
    ),
    cases=_with_errors,
    properties=(
        Property("They are distances in the plane of dst, and the scale of H does not matter."),
    ),
    misconceptions=(
        Misconception(
            "no division",
            "You subtracted before dividing by the third coordinate, so the scale of H enters.",
            lambda H, src, dst: np.linalg.norm(dst - (to_homogeneous(src) @ H.T)[:, :2], axis=1),
        ),
        Misconception(
            "difference of homogeneous vectors",
            "You subtracted vectors with three coordinates, as the notes print it. Their scales "
            "are arbitrary: divide both by their last coordinate first.",
            lambda H, src, dst: np.linalg.norm(
                to_homogeneous(dst) - to_homogeneous(src) @ H.T, axis=1
            ),
        ),
        Misconception(
            "H transposed",
            "You applied Hᵀ: rows of points are multiplied by H.T from the right.",
            lambda H, src, dst: np.linalg.norm(dst - _mapped(H.T, src), axis=1),
        ),
        Misconception(
            "sum of absolute differences",
            "You added |Δu| and |Δv|; the distance is √(Δu² + Δv²).",
            lambda H, src, dst: np.abs(dst - _mapped(H, src)).sum(1),
        ),
        Misconception(
            "error in the other plane",
            "That is the error in the plane of src. Corners are measured in the picture, so the "
            "distance belongs there.",
            lambda H, src, dst: np.linalg.norm(src - _mapped(np.linalg.inv(H), dst), axis=1),
        ),
        Misconception(
            "differences, not lengths",
            (
                "These are the differences of both coordinates; the distance is the length of "
                "each row."
            ),
            lambda H, src, dst: dst - _mapped(H, src),
            variants=(
                lambda H, src, dst: _mapped(H, src) - dst,
                lambda H, src, dst: np.abs(_mapped(H, src) - dst),
                lambda H, src, dst: (_mapped(H, src) - dst) ** 2,
            ),
        ),
        Misconception(
            "columns for rows",
            "You took the length of each column: axis=1 gives one for each row.",
            lambda H, src, dst: np.linalg.norm(dst - _mapped(H, src), axis=0),
        ),
        Misconception(
            "root of the mean square",
            ("That is the root of the mean squared distance; asked is one distance for each pair."),
            lambda H, src, dst: np.sqrt((geometric_error(H, src, dst) ** 2).mean()),
        ),
        Misconception(
            "length of all differences",
            (
                "That is the length of all differences taken together; asked is one distance for "
                "each pair: axis=1."
            ),
            lambda H, src, dst: np.linalg.norm(dst - _mapped(H, src)),
        ),
        Misconception(
            "one coordinate only",
            "You compared u only; the distance is √(Δu² + Δv²).",
            lambda H, src, dst: np.abs(dst - _mapped(H, src))[:, 0],
        ),
        Misconception(
            "src not mapped",
            "You compared dst with src itself: H takes src to the plane of dst.",
            lambda H, src, dst: np.linalg.norm(dst - src, axis=1),
        ),
        Misconception(
            "divided by h33",
            "You divided H by h33; every point has a third coordinate of its own to be divided by.",
            lambda H, src, dst: np.linalg.norm(
                dst - (to_homogeneous(src) @ (H / H[2, 2]).T)[:, :2], axis=1
            ),
        ),
        Misconception(
            "both directions",
            "You added the error in the other plane; asked is the distance in the plane of dst.",
            lambda H, src, dst: (
                geometric_error(H, src, dst)
                + np.linalg.norm(src - _mapped(np.linalg.inv(H), dst), axis=1)
            ),
            variants=(
                lambda H, src, dst: np.sqrt(
                    geometric_error(H, src, dst) ** 2
                    + np.linalg.norm(src - _mapped(np.linalg.inv(H), dst), axis=1) ** 2
                ),
            ),
        ),
        Misconception(
            "mean of the squares",
            "That is a mean or a sum of squared distances; asked is one distance for each pair.",
            lambda H, src, dst: (geometric_error(H, src, dst) ** 2).mean(),
            variants=(
                lambda H, src, dst: (geometric_error(H, src, dst) ** 2).sum(),
                lambda H, src, dst: ((dst - _mapped(H, src)) ** 2).mean(),
            ),
        ),
        Misconception(
            "root of the mean of each row",
            "You took the mean of Δu² and Δv²; the distance is the root of their sum.",
            lambda H, src, dst: geometric_error(H, src, dst) / np.sqrt(2),
        ),
        Misconception(
            "mean of each row",
            "You took the mean of |Δu| and |Δv|; the distance is √(Δu² + Δv²).",
            lambda H, src, dst: np.abs(dst - _mapped(H, src)).mean(1),
            variants=(
                lambda H, src, dst: (dst - _mapped(H, src)).mean(1),
                lambda H, src, dst: (_mapped(H, src) - dst).mean(1),
            ),
        ),
        Misconception(
            "sum of the differences",
            "Δu + Δv may cancel; the distance is √(Δu² + Δv²).",
            lambda H, src, dst: (dst - _mapped(H, src)).sum(1),
            variants=(lambda H, src, dst: (_mapped(H, src) - dst).sum(1),),
        ),
        Misconception(
            "larger of the two",
            "You took the larger of |Δu| and |Δv|; the distance is √(Δu² + Δv²).",
            lambda H, src, dst: np.abs(dst - _mapped(H, src)).max(1),
        ),
        Misconception(
            "rows only",
            "You compared v only; the distance is √(Δu² + Δv²).",
            lambda H, src, dst: np.abs(dst - _mapped(H, src))[:, 1],
        ),
        Misconception(
            "length of the mapped points",
            "You took the length of the mapped points themselves: subtract dst first.",
            lambda H, src, dst: np.linalg.norm(_mapped(H, src), axis=1),
            variants=(lambda H, src, dst: np.linalg.norm(to_homogeneous(_mapped(H, src)), axis=1),),
        ),
        Misconception(
            "algebraic error",
            "That is the algebraic error, as D h = 0 has it: it depends on the scale of H and is "
            "no distance.",
            lambda H, src, dst: _algebraic(H, src, dst),
        ),
        Misconception(
            "every pair with every other",
            "You compared every point with every other: (n, n). Subtract row by row.",
            lambda H, src, dst: np.linalg.norm(dst[:, None] - _mapped(H, src)[None], axis=2),
        ),
    ),
    reference=geometric_error,
    sources=(geometric_error, from_homogeneous),
    concepts=("49", "50", "E25"),
)
