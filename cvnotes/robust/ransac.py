"""RANSAC: samples are drawn until the best of their maps is known, and that map is polished."""

from math import inf
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, CvnotesError, DegenerateError, ShapeError, numbers, paired, points
from cvnotes.homography import dlt, normaliser, refine_homography
from cvnotes.projective import apply, to_homogeneous
from cvnotes.robust.chance import HOPELESS, fraction, refuse_chance, trials_needed
from cvnotes.robust.samples import BATCH, of_four, samples

Mask = npt.NDArray[np.bool_]


def ransac_homography(
    src: npt.ArrayLike,
    dst: npt.ArrayLike,
    *,
    threshold: float,
    rng: np.random.Generator,
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
    side of the vanishing line, are skipped. How many inliers are enough is asked of chance: if
    all pairs were random, k of n would agree to within the threshold in
    (n − 4) C(n, k) C(k, 4) pᵏ⁻⁴ cases on average, p being the fraction of the occupied area that
    the threshold covers; the answer is refused unless that is below 1/1000.

    References
    ----------
    .. [1] Notes 2b.5, "Removal of perspective deformation"; erratum E39.
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), algorithm 4.6.
    .. [3] L. Moisan and B. Stival, IJCV 57 (2004) 201-218, on the number of false alarms.

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
    threshold, confidence = _guard(threshold, confidence, max_trials, rng)
    N1, N2 = normaliser(src), normaliser(dst)
    src_n, dst_n, t = apply(N1, src), apply(N2, dst), threshold * N2[0, 0]
    inliers = _search(src_n, dst_n, t, rng, confidence, max_trials)
    H, inliers = _polish(src, dst, threshold, inliers)
    refuse_chance(int(inliers.sum()), dst, threshold)
    return H, inliers


def _search(
    src: Array, dst: Array, t: float, rng: np.random.Generator, confidence: float, most: int
) -> Mask:
    """Draw samples until enough were drawn for the best map so far; gives who agrees with it."""
    best: Mask = np.zeros(len(src), dtype=bool)
    drawn, trials, needed = 0, 0, inf
    while drawn < most and trials < needed:
        rows = samples(rng, len(src))
        H, counted = of_four(src[rows], dst[rows])
        for agree in _agreement(H, src, dst, t):
            if agree.sum() > best.sum():
                best = agree
                needed = trials_needed(float(best.mean()), confidence)
        drawn += BATCH
        trials += counted
    return best


def _polish(src: Array, dst: Array, threshold: float, inliers: Mask) -> tuple[Array, Mask]:
    """Fit all inliers by least squares, and ask again who agrees, until nobody changes sides."""
    for _ in range(20):
        if inliers.sum() < 4:
            raise DegenerateError(HOPELESS.format(count=int(inliers.sum()), n=len(src)))
        H = dlt(src[inliers], dst[inliers])
        H = refine_homography(H, src[inliers], dst[inliers])
        agree = _agreement(H, src, dst, threshold)
        if (agree == inliers).all():
            break
        inliers = agree
    return H, agree


def _agreement(H: Array, src: Array, dst: Array, threshold: float) -> Mask:
    """Tell which pairs (..., n) lie within the threshold, on the near side of infinity.

    ‖m̂ − m‖ ≤ t is asked as (w û − w u)² + (w v̂ − w v)² ≤ (t w)², without a division.
    """
    m_h = H @ to_homogeneous(src).T  # (..., 3, n)
    w = m_h[..., 2, :]
    off = m_h[..., :2, :] - w[..., None, :] * dst.T
    off *= off
    return np.asarray((off[..., 0, :] + off[..., 1, :] <= threshold**2 * w * w) & (w > 0))


def _guard(threshold: Any, confidence: Any, most: Any, rng: Any) -> tuple[float, float]:
    if not isinstance(rng, np.random.Generator):
        raise CvnotesError(
            f"rng: expected a numpy.random.Generator (np.random.default_rng(seed)), got {rng!r}"
        )
    t = numbers(threshold, "threshold")
    if t.ndim or not 0 < t < 1e100:
        raise CvnotesError(f"threshold: expected a positive distance, got {threshold!r}")
    if isinstance(most, bool) or not isinstance(most, int | np.integer) or most < 1:
        raise CvnotesError(f"max_trials: expected a positive whole number, got {most!r}")
    return float(t), fraction(confidence, "confidence", below=1.0)
