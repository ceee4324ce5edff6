"""RANSAC: a homography from pairs of which many are wrong, and what chance alone would give."""

from math import ceil, inf, lgamma, log, log1p
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CvnotesError,
    DegenerateError,
    ShapeError,
    chunks,
    numbers,
    paired,
    points,
    whole,
)
from cvnotes.homography.linear import dlt
from cvnotes.homography.refinement import refine_homography
from cvnotes.projective import apply, to_homogeneous
from cvnotes.projective.points import normaliser

_MOST_TRIALS = 10**7
HOPELESS = (
    "only {count} of {n} pairs agree on a homography, no more than chance would give: the "
    "correspondences are wrong, or the threshold does not fit their noise"
)


def trials_needed(inlier_fraction: float, confidence: float = 0.999, sample: int = 4) -> float:
    """Return how many samples must be drawn to meet one without an outlier with `confidence`.

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
    clean = fraction(inlier_fraction, "inlier_fraction") ** whole(sample, "sample")
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


# Samples tried at a time.
BATCH = 64
# Twice the area of a triangle of normalised points below which three of them count as collinear.
_FLAT = 1e-6
# The fourth point in place of the first, the second, the third; and the first three.
_TRIANGLES = [[3, 1, 2], [0, 3, 2], [0, 1, 3], [0, 1, 2]]


def samples(rng: "np.random.Generator", n: int) -> npt.NDArray[np.intp]:
    """Draw four different rows of n, (BATCH, 4): the j-th among the n − j that are left."""
    rows = rng.integers(0, [n, n - 1, n - 2, n - 3], size=(BATCH, 4))
    for j in (1, 2, 3):
        for earlier in np.sort(rows[:, :j], axis=-1).T:
            rows[:, j] += rows[:, j] >= earlier
    return rows


def of_four(src: Array, dst: Array) -> tuple[Array, int]:
    """Return the H (k, 3, 3) that map four normalised points (s, 4, 2) exactly, where one does.

    Four points, no three of them collinear, are a projective basis: the fourth is
    λ1 a + λ2 b + λ3 c, so [λ1 a, λ2 b, λ3 c] maps the standard basis and (1, 1, 1)ᵀ to the four,
    and H is this matrix for dst times the inverse of that for src. No h9 is fixed. Also given is
    how many samples count as trials: those that a right map could have come from.
    """
    M_src, areas_src = _basis(src)
    M_dst, areas_dst = _basis(dst)
    trial = (np.abs(areas_src) > _FLAT).all(-1)
    # λ_dst / λ_src is the third coordinate of each image: one sign for all points in front.
    sides = np.sign(areas_src * areas_dst) * (np.abs(areas_dst) > _FLAT)
    usable = trial & (np.abs(sides.sum(-1)) == 4)
    H = M_dst[usable] @ np.linalg.inv(M_src[usable]) * sides[usable, :1, None]
    return H / np.linalg.norm(H, axis=(-2, -1), keepdims=True), int(trial.sum())


def _basis(x: Array) -> tuple[Array, Array]:
    """Return M diag(λ) (..., 3, 3), and the four triangles' signed areas (..., 4), twice.

    By Cramer's rule λ_i is a triangle's area over another's, so the areas serve as λ.
    """
    x_h = np.concatenate([x, np.ones_like(x[..., :1])], axis=-1)
    areas = np.linalg.det(x_h[..., _TRIANGLES, :])
    return x_h[..., :3, :].mT * areas[..., None, :3], areas


Mask = npt.NDArray[np.bool_]


def ransac_homography(
    src: npt.ArrayLike,
    dst: npt.ArrayLike,
    *,
    threshold: float,
    rng: "np.random.Generator",
    confidence: float = 0.999,
    max_trials: int = 20_000,
) -> tuple[Array, Mask]:
    """Estimate H with dst ≈ H src although some of the pairs are wrong.

    Parameters
    ----------
    src, dst : array_like, shape (n, 2)
        At least 5 point pairs.
    threshold : float
        Distance in the plane of `dst` up to which a pair agrees with H. For noise of standard
        deviation σ in each coordinate, 2.45 σ keeps 95 % of the right pairs.
    rng : numpy.random.Generator
        Where the samples come from.
    confidence : float
        Probability of meeting at least one sample without a wrong pair.
    max_trials : int
        Samples after which to give up; enough for 15 % of right pairs.

    Returns
    -------
    H : ndarray, shape (3, 3)
        Refined on the inliers; ‖H‖ = 1, points in front have a positive third coordinate.
    inliers : ndarray of bool, shape (n,)
        Which pairs agree with H.

    Raises
    ------
    DegenerateError
        No homography explains more pairs than chance would: the data are hopeless, or the
        threshold is too large or too small for them.

    Notes
    -----
    The number of trials adapts: whenever a map with more inliers is found, N follows from their
    fraction (`trials_needed`). Samples with three collinear points, or with a point on the other
    side of the vanishing line, are skipped. A map through four noisy pairs loses right pairs far
    from them, so each new best map is fitted again to those who agree with it, at a threshold
    that shrinks from four times the given one (local optimisation [4]_). How many inliers are
    enough is asked of chance: if all pairs were random, k of n would agree to within the
    threshold in (n − 4) C(n, k) C(k, 4) pᵏ⁻⁴ cases on average, p being the fraction of the
    occupied area that the threshold covers; the answer is refused unless that is below 1/1000.

    References
    ----------
    .. [1] Notes 2b.5, "Removal of perspective deformation"; erratum E39.
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), algorithm 4.6.
    .. [3] L. Moisan and B. Stival, IJCV 57 (2004) 201-218, on the number of false alarms.
    .. [4] O. Chum, J. Matas and J. Kittler, Locally optimized RANSAC, DAGM (2003) 236-243.

    Examples
    --------
    >>> src = np.array([[x, y] for x in range(5) for y in range(4)], dtype=float)
    >>> dst = 10 * src + [3, 4]
    >>> dst[:6] = dst[5::-1] + 17
    >>> H, inliers = ransac_homography(src, dst, threshold=0.1, rng=np.random.default_rng(0))
    >>> (H / H[2, 2]).round(9) + 0.0
    array([[10.,  0.,  3.],
           [ 0., 10.,  4.],
           [ 0.,  0.,  1.]])
    >>> int(inliers.sum())
    14
    """
    src, dst = points(src, "src", 2), points(dst, "dst", 2)
    if src.ndim != 2 or dst.ndim != 2:
        raise ShapeError(f"expected point pairs (n, 2), got {src.shape} and {dst.shape}")
    paired(src, dst, ("src", "dst"), at_least=5)
    threshold, confidence = _guard(threshold, confidence, rng)
    max_trials = whole(max_trials, "max_trials", at_most=_MOST_TRIALS)
    N1, N2 = normaliser(src), normaliser(dst)
    src_n, dst_n, t = apply(N1, src), apply(N2, dst), threshold * N2[0, 0]
    inliers = _search(_Pairs(src_n, dst_n, t), rng, confidence, max_trials)
    H, inliers = _polish(src, dst, threshold, inliers)
    refuse_chance(int(inliers.sum()), dst, threshold)
    return H, inliers


def _search(pairs: "_Pairs", rng: "np.random.Generator", confidence: float, most: int) -> Mask:
    """Draw samples until enough were drawn for the best map so far; gives who agrees with it."""
    src, dst = pairs.src, pairs.dst
    best: Mask = np.zeros(len(src), dtype=bool)
    drawn, trials, needed = 0, 0, inf
    while drawn < most and trials < needed:
        rows = samples(rng, len(src))
        H, counted = of_four(src[rows], dst[rows])
        agree = pairs.that_agree(H)
        if len(H) and agree.max() > best.sum():
            best = _optimised(pairs, pairs.missed(H[agree.argmax()]))
            needed = trials_needed(float(best.mean()), confidence)
        drawn += BATCH
        trials += counted
    return _grown(pairs, best)


# Pairs at a time whose distances from many maps are asked for: they then stay in the cache.
_AT_ONCE = 6000


class _Pairs:
    """Normalised pairs, and by how much maps miss them."""

    def __init__(self, src: Array, dst: Array, t: float) -> None:
        self.src, self.dst, self.t = src, dst, t
        self._fits: dict[bytes, Array] = {}

    def missed(self, H: Array) -> Array:
        return _missed(H, self.src, self.dst)

    def that_agree(self, H: Array) -> npt.NDArray[np.intp]:
        """Count the pairs that agree with each H (k, 3, 3)."""
        count = np.zeros(len(H), dtype=np.intp)
        for part in chunks(len(H), max(1, _AT_ONCE // len(self.src))):
            count[part] = (self.missed(H[part]) <= self.t**2).sum(-1)
        return count

    def missed_by_fit(self, to: Mask) -> Array:
        """Return by how much a fit to some of the pairs misses all; the same are fitted once."""
        if (key := to.tobytes()) not in self._fits:
            self._fits[key] = self.missed(dlt(self.src[to], self.dst[to]))
        return self._fits[key]


# Multiples of the threshold at which a new best map is fitted again, one after the other.
_SHRINKING = (8.0, 4.0, 2.5, 1.6, 1.0)


def _grown(pairs: _Pairs, best: Mask) -> Mask:
    """Let the fit of all who agree find those whom it lost so far, until nobody joins.

    Most pairs may lie close together, and one far away is then missed by several thresholds.
    """
    while True:
        try:
            agree = _optimised(pairs, pairs.missed_by_fit(best))
        except DegenerateError:  # too few, or a line of neighbours
            return best
        if agree.sum() <= best.sum():
            return best
        best = agree


def _optimised(pairs: _Pairs, missed: Array) -> Mask:
    """Fit a new best map to those who agree with it, ever more strictly; gives who does at last.

    Four pairs extrapolate their own noise: a map through them loses right pairs far away, which
    a wider threshold still holds and a fit to many brings back.
    """
    best = missed <= pairs.t**2
    for multiple in _SHRINKING:
        try:
            missed = pairs.missed_by_fit(missed <= (multiple * pairs.t) ** 2)
        except DegenerateError:  # too few, or a line of neighbours
            break
        agree = missed <= pairs.t**2
        if agree.sum() > best.sum():
            best = agree
    return best


def _polish(src: Array, dst: Array, threshold: float, inliers: Mask) -> tuple[Array, Mask]:
    """Fit all inliers by least squares, and ask again who agrees, until nobody changes sides."""
    for _ in range(20):
        if inliers.sum() < 4:
            raise DegenerateError(HOPELESS.format(count=int(inliers.sum()), n=len(src)))
        H = dlt.inside(src[inliers], dst[inliers])
        H = refine_homography.inside(H, src[inliers], dst[inliers])
        agree = _missed(H, src, dst) <= threshold**2
        if (agree == inliers).all():
            break
        inliers = agree
    return H, agree


def _missed(H: Array, src: Array, dst: Array) -> Array:
    """Return by how much each H misses pairs, ‖m̂ − m‖² (..., n); infinity beyond the horizon."""
    m_h = H @ to_homogeneous.inside(src).T  # (..., 3, n)
    w = m_h[..., 2, :]
    off = m_h[..., :2, :] - w[..., None, :] * dst.T
    off *= off
    missed = np.divide(off.sum(-2), w * w, out=np.full_like(w, np.inf), where=w > 0)
    return np.asarray(missed)


def _guard(threshold: Any, confidence: Any, rng: Any) -> tuple[float, float]:
    if not isinstance(rng, np.random.Generator):
        raise CvnotesError(
            f"rng: expected a numpy.random.Generator (np.random.default_rng(seed)), got {rng!r}"
        )
    t = numbers(threshold, "threshold")
    if t.ndim or not 0 < t < 1e100:
        raise CvnotesError(f"threshold: expected a positive distance, got {threshold!r}")
    return float(t), fraction(confidence, "confidence", below=1.0)
