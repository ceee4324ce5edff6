"""Who agrees with the best of some draws, and how many draws are enough."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.homography import dlt
from cvnotes.learn.cases.cameras import rounded, some_homography
from cvnotes.projective import apply
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def ransac(src: Array, dst: Array, draws: Any, t: float) -> tuple[float, float]:
    """Give k, N: how many pairs agree with the best draw, and how many draws they ask for."""
    H = np.array([dlt(src[rows], dst[rows]) for rows in draws])  # the maps of the draws
    s_h = np.column_stack([src, np.ones(len(src))])  # src, lifted
    m_h = s_h @ H.mT  # where each map takes src, homogeneous
    off = m_h[..., :2] / m_h[..., 2:] - dst  # how far each map is off
    counts = (np.sqrt((off**2).sum(axis=2)) < t).sum(axis=1)  # who agrees with each map, counted
    q = counts.max() / len(src)  # the part of right pairs
    return counts.max(), np.ceil(np.log(0.001) / np.log(1 - q**4))


def _some_wrong(rng: np.random.Generator) -> list[Case]:
    # on an ellipse, so that no three are on a line; every third pair has another's partner
    cases = []
    for n in (9, 24, 36):
        angles = 2 * np.pi * (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n
        src = rounded(100 + np.column_stack([90 * np.cos(angles), 60 * np.sin(angles)]), 1)
        dst = apply(some_homography(rng), src) + rng.standard_normal((n, 2))
        wrong = np.arange(0, n, 3)
        dst[wrong] = dst[np.roll(rng.permutation(wrong), 1)] + rng.uniform(9, 30, (n // 3, 2))
        clean = np.setdiff1d(np.arange(n), wrong)
        # the first and the last draw are of neighbours: right pairs, and a map that few agree with
        pools = [clean[:5], clean, np.arange(n), np.arange(n), clean, clean[-5:]]
        draws = np.array([rng.choice(pool, 4, replace=False) for pool in pools])
        cases.append(Case((src, rounded(dst, 2), draws, 2.6)))
    return cases


_N = "np.ceil(np.log(0.001) / np.log(1 - q**4))"
_MISTAKES = mistakes_in(ransac,
    ("all pairs at once", "You fitted all pairs together: the wrong ones bend that map, too.",
     lambda src, dst, draws, t: ransac(src, dst, np.arange(len(src))[None], t)),
    ("one draw", "You asked one draw only; the best of them counts, with whom most agree.",
     ("counts.max()", "counts[0]"), ("counts.max()", "counts[-1]")),
    ("one pair for four", "A draw is right only if all four of its pairs are: how likely is that?",
     ("q**4", "q"), ("q**4", "4 * q")),
    ("no pair twice", "True, a draw takes no pair twice; here the simpler q⁴ is asked for.",
     ("q**4", "np.prod((counts.max() - np.arange(4)) / (len(src) - np.arange(4)))")),
    ("0.999 for 0.001", "All N draws may be wrong with probability 0.001; you allowed 0.999.",
     ("0.001", "0.999")),
    ("the part of wrong pairs", "You took the wrong pairs' part: four right ones have to meet.",
     ("q**4", "(1 - q) ** 4"), ("1 - q**4", "1 - (1 - q**4)"),
     (_N, "np.ceil(np.log(0.001) / np.log(q))")),
)  # fmt: skip

EXERCISE = Exercise(
    name="ransac",
    chapter=6,
    title="RANSAC, and its number of draws",
    task="Some of the pairs src, dst (n, 2) are wrong. Each row of draws (d, 4) says which four "
    "pairs one draw has taken. Give two numbers. k: the largest number of src that one draw's map "
    "takes to within t px of their dst. N: how many random draws make it 99.9 % sure that at "
    "least one of them has four right pairs, if one draw has them with the probability q⁴, "
    "q = k/n (round up).",
    hints=(
        "For each row of draws: H = dlt(src[row], dst[row]). Count the pairs whose distance "
        "between dst and where H takes src is below t. k is the largest count.",
        "One draw is right with the probability q⁴, q = k/n, and all N are wrong with (1 − q⁴)ᴺ.",
        "(1 − q⁴)ᴺ = 0.001, so N = log 0.001 / log(1 − q⁴), rounded up by np.ceil.",
    ),
    cases=_some_wrong,
    properties=(
        Property("k pairs agree with the best of the maps.", lambda x, c: x[0] == c.right[0]),
        Property("By q⁴, after N draws one of right pairs alone has been met, with 0.999."),
    ),
    misconceptions=_MISTAKES,
    steps=ransac,
    concepts=("p", "50"),
)
