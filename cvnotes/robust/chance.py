"""What chance would give: how many samples it takes, and how many inliers are too few."""

from math import ceil, inf, lgamma, log, log1p
from typing import Any

import numpy as np

from cvnotes.errors import Array, CvnotesError, DegenerateError, numbers

HOPELESS = (
    "only {count} of {n} pairs agree on a homography, no more than chance would give: the "
    "correspondences are wrong, or the threshold does not fit their noise"
)


def trials_needed(inlier_fraction: float, confidence: float = 0.999, sample: int = 4) -> float:
    """Give how many samples must be drawn to meet one without an outlier with `confidence`.

    A sample of s pairs is clean with probability wˢ, and N of them are all spoilt with
    probability (1 − wˢ)ᴺ, so N = log(1 − confidence) / log(1 − wˢ), rounded up.

    References
    ----------
    .. [1] M. Fischler and R. Bolles, Random sample consensus, CACM 24 (1981) 381-395.
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 4.7.1.

    Examples
    --------
    >>> trials_needed(0.5, 0.99)  # table 4.3 of [2]
    72
    """
    clean = fraction(inlier_fraction, "inlier_fraction") ** sample
    spoilt = log1p(-fraction(confidence, "confidence", below=1.0))
    if clean in (0, 1):
        return 1 if clean else inf
    return ceil(spoilt / log1p(-clean))


def refuse_chance(k: int, dst: Array, threshold: float) -> None:
    """Refuse k inliers that random pairs would give too."""
    n = len(dst)
    area = float(np.prod(np.ptp(dst, axis=0)))
    p = min(1.0, np.pi * threshold**2 / area) if area > 0 else 1.0
    # log of the expected number of sets of k random pairs that agree as well
    alarms = log(n - 4) + _log_choose(n, k) + _log_choose(k, 4) + (k - 4) * log(p)
    if k < 5 or alarms > log(1e-3):
        raise DegenerateError(HOPELESS.format(count=k, n=n))


def fraction(x: Any, name: str, *, below: float = np.inf) -> float:
    """Guard a number from 0 to 1, smaller than `below`."""
    value = numbers(x, name)
    if value.ndim or not 0 <= value <= 1 or value >= below:
        raise CvnotesError(f"{name}: expected a fraction below 1, got {x!r}")
    return float(value)


def _log_choose(n: int, k: int) -> float:
    return lgamma(n + 1) - lgamma(k + 1) - lgamma(n - k + 1)
