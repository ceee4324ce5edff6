"""What a calibration is judged by: its numbers, and those that follow from them."""

from dataclasses import dataclass
from functools import cached_property
from math import acos, degrees

import numpy as np

from cvnotes.errors import Array
from cvnotes.lens import Lens
from cvnotes.zhang.b import constraint_rows

_FAR = 100  # boards compared with each other; all pairs of thousands would take too long
_ROUNDING = 1e-6  # px, more than rounding leaves


@dataclass(frozen=True)
class Evidence:
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
    likeness : float
        Correlation between the residuals of corners that follow each other; about 0 for noise.
    """

    A: Array
    lens: Lens
    size: tuple[int, int]
    poses: Array
    std: dict[str, float]
    view_rms: Array
    distances: Array
    corners: Array
    converged: bool
    likeness: float = 0.0

    @cached_property
    def tilt_between(self) -> float:
        """Largest angle between two boards, degrees; of many, those farthest from the mean."""
        far = self.poses[:, :3, 2]
        if len(far) > _FAR:
            far = far[np.argsort(far @ far.mean(0))[:_FAR]]
        return degrees(acos(min(1.0, float(np.abs(far @ far.T).min()))))

    @cached_property
    def determinacy(self) -> float:
        """Second smallest over largest singular value of Zhang's V; 0 if A is undetermined.

        V is taken from the estimated camera, in a picture scaled to about [−1, 1].
        """
        scale = 2 / max(self.size)
        A = np.diag([scale, scale, 1]) @ self.A
        A[:2, 2] -= np.array(self.size) / max(self.size)
        skewless = [0, 2, 3, 4, 5]
        V = constraint_rows(A @ self.poses[:, :3, [0, 1, 3]])[:, skewless]
        s = np.linalg.svd(V, compute_uv=False)
        return float(s[3] / s[0])

    @cached_property
    def typical_rms(self) -> float:
        """Median of the views' RMS, px."""
        return median(self.view_rms)

    @property
    def focal_uncertainty(self) -> float:
        """Largest standard deviation of a focal length over its value."""
        return float(max(self.std["alpha_u"] / self.A[0, 0], self.std["alpha_v"] / self.A[1, 1]))


def likeness(residuals: Array, freedom: int) -> float:
    """Correlate the residuals (n_views, n, 2) of corners that follow each other.

    0 where that tells nothing: when there are hardly more measured coordinates than unknowns (the
    difference is `freedom`), or when only rounding errors are left.

    Examples
    --------
    >>> drift = np.linspace(-1, 1, 50).reshape(1, 25, 2)
    >>> likeness(drift, 40) > 0.8, likeness(drift, 10), likeness(1e-12 * drift, 40)
    (True, 0.0, 0.0)
    """
    r = residuals if np.isfinite(residuals.sum()) else np.nan_to_num(residuals)
    squares = float((r * r).sum())
    if 2 * freedom < r.size or squares < r.size * _ROUNDING**2:
        return 0.0
    return float((r[:, 1:] * r[:, :-1]).sum()) / squares


def median(x: Array) -> float:
    """Give the median of numbers (n,)."""
    # np.median takes longer than all the rest here, with its care for axes, NaN and subclasses.
    ordered = np.sort(x)
    return float(ordered[(x.size - 1) // 2] + ordered[x.size // 2]) / 2
