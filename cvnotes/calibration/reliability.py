"""Is a calibration to be believed? The evidence, and the sentences that judge it."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import acos, degrees

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.calibration import thresholds
from cvnotes.calibration.doubts import Corner, Doubt, View, Views
from cvnotes.calibration.refinement import CORRELATED, autocorrelation
from cvnotes.calibration.result import Calibration
from cvnotes.calibration.zhang import constraints
from cvnotes.camera import AnyLens, xy_from_px

_FAR = 100  # boards compared with each other; all pairs of thousands would take too long


@dataclass(frozen=True, eq=False)
class Diagnostics:
    """What a calibration is judged by.

    Parameters
    ----------
    A, lens, size
        The estimated camera.
    poses : ndarray, shape (n_views, 4, 4)
        CRF ← board.
    std : dict
        Standard deviations by name.
    view_rms : ndarray, shape (n_views,)
        Root mean square reprojection distance of each view, px.
    distances : ndarray, shape (n_views, n)
        Reprojection distance of each corner, px; 0 where none was seen, NaN where the lens folds.
    corners : ndarray, shape (n_views, n, 2)
        Where the corners were seen, px.
    converged : bool
        Whether the refinement ended at a minimum.
    autocorrelation : float
        Correlation between the residuals of corners that follow each other; about 0 for noise.
    by_radius : float
        Part of the residuals' squares that goes outwards or inwards by the distance from the
        principal point; 0 where that tells nothing.
    together : float
        Distance in pixels by which corners of a typical view miss their places together; not
        looked at, and 0, where no view misses by so much that it would matter.
    shape_tried, lens_tried : bool
        Whether the board was allowed a shape of its own, the same in all views; and whether other
        lenses were compared.
    """

    A: Array
    lens: AnyLens
    size: tuple[int, int]
    poses: Array
    std: dict[str, float]
    view_rms: Array
    distances: Array
    corners: Array
    converged: bool
    autocorrelation: float = 0.0
    by_radius: float = 0.0
    together: float = 0.0
    shape_tried: bool = False
    lens_tried: bool = False

    @staticmethod
    def of(
        found: Calibration,
        residuals: Array,
        corners: Array,
        board: Array,
        freedom: float | None = None,
    ) -> "Diagnostics":
        """Gather what a calibration is judged by; residuals and corners are (n_views, n, 2).

        They are of the points `board`, (n, 3) or (n_views, n, 3). `freedom` is that of the
        residuals; without it their autocorrelation is not looked at.
        """
        may_matter, choice = found.view_rms.max() > thresholds.MOVED * max(found.size), found.choice
        same = ("A", "lens", "size", "poses", "std", "view_rms", "converged")
        boards = found.shape is not None or (choice is not None and len(choice.by_board) > 1)
        return Diagnostics(
            **{name: getattr(found, name) for name in same},
            distances=np.sqrt(residuals[..., 0] ** 2 + residuals[..., 1] ** 2),
            corners=corners,
            autocorrelation=0.0 if freedom is None else autocorrelation(residuals, freedom),
            by_radius=by_radius(residuals, corners, found.A[:2, 2]),
            together=missed_together(residuals, board) if may_matter else 0.0,
            shape_tried=boards,
            lens_tried=choice is not None and len(choice.by_lens) > 1,
        )

    @cached_property
    def tilt_between(self) -> float:
        """Largest angle between two boards, degrees."""
        return widest_angle(self.poses)

    @cached_property
    def determinacy(self) -> float:
        """Second smallest over largest singular value of Zhang's V; 0 if A is undetermined.

        V is taken from the estimated camera, in a picture scaled to about [−1, 1].
        """
        scale = 2 / max(self.size)
        A = np.diag([scale, scale, 1]) @ self.A
        A[:2, 2] -= np.array(self.size) / max(self.size)
        skewless = [0, 2, 3, 4, 5]
        V = constraints.inside(A @ self.poses[:, :3, [0, 1, 3]])[:, skewless]
        s = np.linalg.svd(V, compute_uv=False)
        return float(s[3] / s[0])

    @cached_property
    def typical_rms(self) -> float:
        """Median of the views' RMS, px."""
        return float(np.median(self.view_rms))

    @property
    def focal_uncertainty(self) -> float:
        """Largest standard deviation of a focal length over its value."""
        return float(max(self.std["alpha_u"] / self.A[0, 0], self.std["alpha_v"] / self.A[1, 1]))


def by_radius(residuals: Array, corners: Array, centre: Array) -> float:
    """Return which part of the residuals a better lens would explain.

    Notes
    -----
    The residuals' components along the radius are fitted by odd powers of the radius, r to r⁹, as
    a lens of more coefficients would. 0 if that part is no larger than noise makes it.

    Examples
    --------
    >>> m = np.random.default_rng(0).uniform(-1, 1, (5, 50, 2))
    >>> by_radius(0.1 * (m**2).sum(-1, keepdims=True) * m, m, np.zeros(2)) > 0.99
    True
    """
    (u, v), (x, y) = np.moveaxis(residuals, -1, 0), np.moveaxis(corners - centre, -1, 0)
    squares_of, outwards, r2 = u * u + v * v, u * x + v * y, x * x + y * y
    if not 0 < squares_of.min() < np.inf:  # some were not seen, or lie where the lens folds
        seen = np.isfinite(squares_of) & (squares_of > 0)
        squares_of, outwards, r2 = squares_of[seen], outwards[seen], r2[seen]
    n, squares = squares_of.size, float(squares_of.sum())
    if n < 2 * _POWERS or squares < n * thresholds.NEGLIGIBLE**2 or not r2.max() > 0:
        return 0.0
    # Normal equations of r, r³, …, the largest radius being 1: sums of powers of r² alone. (A QR
    # of all corners would take longer than the rest of the judgement.)
    largest = r2.max()
    powers, relative = np.ones((_POWERS + 1, n)), r2.ravel() / largest
    for i in range(_POWERS):
        np.multiply(powers[i], relative, out=powers[i + 1])
    N = powers[:-1] @ powers[1:].T
    g = powers[:-1] @ outwards.ravel() / np.sqrt(largest)
    part = float(g @ np.linalg.lstsq(N, g, rcond=1e-13)[0])
    return part / squares if part > _POWERS * thresholds.BY_CHANCE * squares / (2 * n) else 0.0


def missed_together(residuals: Array, board: Array) -> float:
    """Return by how many pixels the corners of a typical view miss their places together.

    Parameters
    ----------
    residuals : ndarray, shape (n_views, n, 2)
        0 where no corner was seen, NaN where the lens folds.
    board : ndarray, shape (n, 3) or (n_views, n, 3)
        Places of the corners on the board.

    Returns
    -------
    float
        Root mean square distance, of the median view. 0 for fewer than 12 corners.

    Notes
    -----
    What a camera of the wrong kind leaves varies slowly over the board; noise does not. So cubics
    in x and y (of few corners parabolas) are fitted to the residuals of each view: of squares that
    are noise they take one share for each coefficient that the pose has not taken before.

    Examples
    --------
    >>> rng, W = np.random.default_rng(0), np.array([[x, y, 0] for y in range(6) for x in range(9)])
    >>> noise, bend = rng.normal(0, 0.5, (9, 54, 2)), 0.1 * (W[:, :2] - [4, 2.5]) ** 2
    >>> missed_together(noise, W) < 0.2, missed_together(noise + bend, W) > 0.7
    (True, True)
    """
    squares = residuals[..., 0] ** 2 + residuals[..., 1] ** 2
    seen = np.isfinite(squares) & (squares > 0)
    n, all_seen = seen.sum(1), bool(seen.all())
    usual = n[0] if all_seen else np.median(n)
    order = 3 if usual >= 20 else 2
    x, y = ([np.ones_like(t), t, t * t, t * t * t] for t in np.moveaxis(board[..., :2], -1, 0))
    powers = [x[i - j] * y[j] for i in range(order + 1) for j in range(i + 1)]
    if usual < 2 * len(powers):
        return 0.0
    smooth = np.stack(powers, axis=-1, dtype=float)
    if not all_seen:
        residuals, smooth = np.where(seen[..., None], residuals, 0.0), smooth * seen[..., None]
        squares = np.where(seen, squares, 0.0)
    of_noise = 2 * len(powers)  # in x and in y, of which six are the pose's
    part = np.square(np.linalg.qr(smooth).Q.mT @ residuals).sum((1, 2))
    variance = np.median((squares.sum(1) - part) / np.maximum(2 * n - of_noise, 1))
    beyond = (part - (of_noise - 6) * variance) / np.maximum(n, 1)
    return float(np.sqrt(max(np.median(beyond), 0.0)))


def widest_angle(poses: Array) -> float:
    """Return the largest angle between the planes of two boards (n, 4, 4), in degrees.

    Of very many boards, only those farthest from their mean are compared.

    Examples
    --------
    >>> upright, tilted = np.eye(4), np.eye(4)
    >>> tilted[:3, :3] = [[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]]
    >>> round(widest_angle(np.array([upright, tilted])), 2)
    36.87
    """
    normals = poses[:, :3, 2]
    if len(normals) > _FAR:
        normals = normals[np.argsort(normals @ normals.mean(0))[:_FAR]]
    return degrees(acos(min(1.0, float(np.abs(normals @ normals.T).min()))))


_POWERS = 5  # of the radius
_ADVICE = "tilt the board by 30 to 45 degrees, in different directions"


def judge(evidence: Diagnostics) -> tuple[tuple[Doubt, ...], bool]:
    """Return sentences about what is doubtful, and whether the result is reliable all the same.

    Returns
    -------
    warnings : tuple of Doubt
        Sentences that know their views. Empty if nothing is doubtful.
    reliable : bool
        False when the answer may be wrong by more than its error bars say.
    """
    fatal = [*_undetermined(evidence), *_mirrored(evidence), *_badly_fitted(evidence)]
    doubtful = [*_systematic(evidence), *_outside(evidence), *_outliers(evidence)]
    if not fatal:
        doubtful = [*_weak(evidence), *doubtful]
    sentences = (s if isinstance(s, Doubt) else Doubt(s) for s in fatal + doubtful)
    return tuple(sentences), not fatal


def _undetermined(e: Diagnostics) -> Iterator[str]:
    if not e.converged:
        yield "the refinement stopped before it reached a minimum; the answer is only a start"
    if e.tilt_between < thresholds.PARALLEL:
        yield (
            f"all boards are nearly parallel (at most {e.tilt_between:.1f}° between two), which "
            f"leaves the focal length open: {_ADVICE}"
        )
    elif e.determinacy < thresholds.UNDETERMINED:
        yield (
            f"these views do not determine the camera (V is singular to {e.determinacy:.4f}): "
            f"{_ADVICE}"
        )
    elif e.focal_uncertainty > thresholds.UNKNOWN:
        yield f"the focal length is known to {e.focal_uncertainty:.0%} only: {_ADVICE}"
    ratio = e.A[1, 1] / e.A[0, 0]
    if not 1 / thresholds.PIXEL_RATIO < ratio < thresholds.PIXEL_RATIO:
        yield (
            f"pixels {ratio:.2g} times as high as wide are unlikely: are rows and columns of the "
            "board swapped, or its squares not square?"
        )


def _weak(e: Diagnostics) -> Iterator[str]:
    if len(e.poses) == 2:
        yield (
            "two views give as many constraints as A has unknowns, so nothing checks the answer: "
            "add views"
        )
    elif e.tilt_between < thresholds.FLAT or e.determinacy < thresholds.WEAK:
        yield (
            f"the boards' tilts (at most {e.tilt_between:.0f}° between two) determine the focal "
            f"length only weakly: {_ADVICE}"
        )
    elif e.focal_uncertainty > thresholds.UNCERTAIN:
        yield (
            f"the focal length has a standard deviation of {e.focal_uncertainty:.1%}: add views, "
            "fill more of the picture, or tilt the board more"
        )


def _mirrored(e: Diagnostics) -> Iterator[str]:
    """Find boards seen from behind: the sign of det H, which no RMS shows."""
    facing = np.vecdot(e.poses[:, :3, 2], e.poses[:, :3, 3])
    behind = np.flatnonzero(facing < 0)
    if len(behind) == len(e.poses):
        yield (
            "every board is seen from behind: are the pictures mirrored, or (v, u) given for "
            "(u, v)?"
        )
    elif len(behind):
        yield Doubt("boards seen from behind in {}: mirrored labels or pictures?", _views(behind))


def misfits(view_rms: Array) -> npt.NDArray[np.intp]:
    """List the views whose corners miss their places by far more than those of a typical view.

    Parameters
    ----------
    view_rms : ndarray, shape (n_views,)
        Root mean square reprojection distance of each view, px.

    Examples
    --------
    >>> misfits(np.array([0.1, 0.2, 3.0, 0.15])).tolist()
    [2]
    """
    misfit = view_rms > thresholds.MISFIT
    if misfit.any():
        misfit &= view_rms > thresholds.TIMES_TYPICAL * np.median(view_rms)
    return np.flatnonzero(misfit)


def _badly_fitted(e: Diagnostics) -> Iterator[str]:
    """Find views and whole sets that no camera of this kind explains."""
    limit = thresholds.OF_PICTURE * max(e.size)
    if e.view_rms.max() > limit and e.typical_rms > limit:
        yield (
            f"the corners are {e.typical_rms:.1f} px away from where the model puts them, in a "
            "typical view: are the board's counts and the order of its corners right?"
        )
        return
    bad = misfits(e.view_rms)
    if len(bad):
        worst = int(np.argmax(e.view_rms))
        yield Doubt(
            "{} do not fit the others ({}: "
            f"{e.view_rms[worst]:.2f} px, typical {e.typical_rms:.2f} px): moved, zoomed, rotated "
            "or badly found? Leave them out and see what changes",
            _views(bad),
            View(worst),
        )
    if e.by_radius > thresholds.TOO_SMALL:
        yield (
            f"corners miss their places outwards or inwards by their distance from the middle "
            f"({e.by_radius:.0%} of the residuals): this lens has too few coefficients; let views "
            'that are left out choose one (lens="auto")'
        )
    elif _is_no_noise(e):
        yield _no_noise(e)
    if np.isnan(e.distances).any():
        yield (
            "some corners lie where the estimated lens folds over, so it shows nothing there: let "
            'views that are left out choose a lens (lens="auto"), or bring the board into the '
            "corners of the picture in more views"
        )


def _is_no_noise(e: Diagnostics) -> bool:
    """Return whether corners miss their places together, by more than bent boards do."""
    most = thresholds.MOVED * max(e.size)
    return e.together > most or (e.autocorrelation > CORRELATED and e.typical_rms > most)


def _no_noise(e: Diagnostics) -> str:
    """Say that residuals are alike, and ask what may be the cause; one that is ruled out is not."""
    what = (
        "this is no noise, and no shape that the board has in all pictures explains it: did it "
        "bend differently from picture to picture"
        if e.shape_tried
        else "this is no noise: are the board's corners not quite where they should be, or did it "
        "change its shape between the pictures"
    )
    lens = "" if e.lens_tried else ", or does the lens need more coefficients"
    return (
        f"neighbouring corners miss their places in the same direction, so {what}, did zoom, focus "
        f"or orientation change{lens}?"
    )


def _systematic(e: Diagnostics) -> Iterator[str]:
    """Find residuals that are small, but that another lens or board may explain: not yet tried."""
    tried = e.shape_tried and e.lens_tried
    if e.autocorrelation > CORRELATED and not tried and not _is_no_noise(e):
        yield f"{_no_noise(e)} The true error is then larger than noise alone would make it"


def _outliers(e: Diagnostics) -> Iterator[str]:
    found = np.argwhere(astray(e.distances)).tolist()
    if found:
        first = ", ".join(f"{{}} ({e.distances[i, k]:.1f} px)" for i, k in found[:3])
        more = f" and {len(found) - 3} more" if len(found) > 3 else ""
        places = (Corner(i, k) for i, k in found[:3])
        yield Doubt(f"corners far from their place: {first}{more}", *places)


def astray(distances: Array) -> npt.NDArray[np.bool_]:
    """Return which single corners miss their places by far more than all others of their view.

    Parameters
    ----------
    distances : ndarray, shape (n_views, n)
        By how many pixels each corner misses; 0 where none was seen, NaN where the lens folds.

    Examples
    --------
    >>> d = np.full((3, 24), 0.1)
    >>> d[1, 5], d[2, :6] = 3.9, 3.9
    >>> np.argwhere(astray(d)).tolist()
    [[1, 5]]
    """
    d = np.nan_to_num(distances)
    # (sooner counted than the median is found)
    near = np.count_nonzero(thresholds.TIMES_MEDIAN * d > d.max())
    if d.max() <= thresholds.OUTLIER or 2 * near > d.size:
        return np.zeros(d.shape, bool)
    limit = max(thresholds.TIMES_MEDIAN * np.median(d[d > 0]), thresholds.OUTLIER)
    few = int(thresholds.PART_ASTRAY * d.shape[1])
    farthest = -np.sort(-d, axis=1)[:, : few + 1]
    # The last of a view's corners that is far, and far from the next.
    last = (farthest[:, :-1] > limit) & (farthest[:, :-1] > thresholds.APART * farthest[:, 1:])
    least = np.min(np.where(last, farthest[:, :-1], np.inf), axis=1, initial=np.inf)
    return np.asarray(d >= least[:, None])


def _outside(e: Diagnostics) -> Iterator[str]:
    w, h = e.size
    u, v = e.corners[..., 0], e.corners[..., 1]
    if min(u.min(), v.min()) < -0.5 or u.max() > w - 0.5 or v.max() > h - 0.5:
        yield (
            f"corners lie outside of the {w}×{h} picture: is size (width, height), and of these "
            "pictures?"
        )
    if e.lens.wide:  # whose picture may well be a disc that ends before
        return
    xy = xy_from_px.inside(e.A, np.array([[0, 0], [w - 1, 0], [0, h - 1], [w - 1, h - 1]]))
    if not e.lens.reaches(float(np.hypot(*xy.T).max())):
        yield (
            "the estimated lens folds over before it reaches the corners of the picture: it holds "
            "only where corners were seen; bring the board into the corners too"
        )


def _views(indices: npt.NDArray[np.intp]) -> Views:
    return Views(tuple(indices.tolist()))
