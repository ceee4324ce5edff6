"""A lens for wide views: the radial factor is a quotient of two polynomials.

The polynomial of the notes (2b.3) bends away from a wide lens: far from the centre its highest
power wins. A quotient can level off, as lenses do. It is OpenCV's model with 8 to 14 coefficients.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, Points, ShapeError, guarded, numbers
from cvnotes.camera.any_lens import PlaneLens
from cvnotes.camera.lens import horner

NAMES = ("k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2")
_FARTHEST = 1e12  # r², a ray almost at 90°
_STEPS = 50  # of Newton's method; points near the fold need a dozen
_CLOSE = 1e-13  # how near to the observed point the answer must be shown
# The quotient that shows rays up to 75° where an equidistant lens does, to 0.001 of its radius.
_LIKE_EQUIDISTANT = (0.693219, 0.077366, 0.000712, 1.02607, 0.221729, 0.007531)


@dataclass(frozen=True)
class RationalLens(PlaneLens):
    """A lens whose radial factor is a quotient, with tangential and further terms.

    Parameters
    ----------
    k : sequence of up to 6 floats
        k1 … k6 of L(r) = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶).
    p : (p1, p2)
        Tangential coefficients, as in `Lens`.
    s : (s1, s2, s3, s4)
        Thin prism: s1 r² + s2 r⁴ is added to x', s3 r² + s4 r⁴ to y'.
    tilt : (about x, about y)
        Angles in radians by which the sensor stands askew behind the lens.

    Notes
    -----
    x' = L(r) x + 2 p1 x y + p2 (r² + 2 x²) + s1 r² + s2 r⁴; y' alike. A tilted sensor then maps
    (x', y', 1) by a homography. `calibrate` estimates k and p; s and the tilt are read from files.

    References
    ----------
    .. [1] Notes 2b.3 for the polynomial; D. Claus and A. Fitzgibbon, A rational function lens
       distortion model for general cameras, CVPR 2005, for the quotient.
    .. [2] OpenCV, calib3d, "Detailed description", for the 14 coefficients.

    Examples
    --------
    >>> RationalLens(k=(0.0, 0.0, 0.0, 1.0)).distort([1.0, 0.0])
    array([0.5, 0. ])
    """

    model: ClassVar[str] = "rational"
    choices: ClassVar[Mapping[str, tuple[str, ...]]] = {"rational": NAMES}
    linear_terms: ClassVar[int] = 2  # of the quotient's numerator
    cancelling: ClassVar[tuple[str, ...]] = NAMES[:6]
    ros_name: ClassVar[str] = "rational_polynomial"

    k: tuple[float, ...] = (0.0,) * 6
    p: tuple[float, float] = (0.0, 0.0)
    s: tuple[float, float, float, float] = (0.0,) * 4
    tilt: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        for name, length in (("k", 6), ("p", 2), ("s", 4), ("tilt", 2)):
            given = numbers(getattr(self, name), name, largest=np.inf)
            short = name == "k" and given.size < length
            if given.ndim != 1 or (given.size != length and not short):
                raise ShapeError(f"{name}: expected {length} numbers, got shape {given.shape}")
            if (np.abs(given) > 1e50).any():
                raise CvnotesError(f"{name} = {given.tolist()}: no lens has such coefficients")
            padded = given.tolist() + [0.0] * (length - given.size)
            object.__setattr__(self, name, tuple(padded))
        if max(map(abs, self.tilt)) > 1.5:
            raise CvnotesError(f"tilt = {list(self.tilt)}: radians below 1.5 (degrees?)")

    @classmethod
    def usual(cls) -> "tuple[RationalLens, ...]":
        """Return the quotient that is like an equidistant lens; see `AnyLens.usual`."""
        return (cls(_LIKE_EQUIDISTANT),)

    @property
    def is_ideal(self) -> bool:
        """Return whether this lens moves nothing."""
        return self.k[:3] == self.k[3:] and not any((*self.p, *self.s, *self.tilt))

    def L(self, r: npt.ArrayLike) -> Array:
        """Radial factor at radii r, same shape; NaN at a pole.

        Examples
        --------
        >>> RationalLens(k=(0.0, 0.0, 0.0, 3.0)).L(1.0)
        array(0.25)
        """
        t = numbers(r, "r") ** 2
        with np.errstate(all="ignore"):
            value = self._quotient(t)[0]
        return np.asarray(np.where(np.isfinite(value), value, np.nan))

    @cached_property
    def max_radius(self) -> float:
        """Largest ideal radius up to which the lens maps one to one (inf if there is no end).

        The first radius at which d(r L)/dr is 0, or at which the quotient has a pole; with
        tangential terms, at which the Jacobian is singular in some direction. The thin prism and
        the tilt, which are small, are left out of account.
        """
        # in t = r²
        above, below = (np.array([*k[::-1], 1.0]) for k in (self.k[:3], self.k[3:]))
        # d(r L)/dr times below²: above below + 2 t (above' below − above below')
        slope = np.convolve(above, below)
        powers = np.arange(3.0, 0, -1)
        bent = np.convolve(powers * above[:-1], below) - np.convolve(above, powers * below[:-1])
        slope[:-1] += 2 * bent  # of one degree less; t raises it
        ends = [np.sqrt(root) for f in (slope, below) for root in sign_changes(f, _FARTHEST)]
        return self._narrowed(min(ends, default=np.inf))

    def reaches(self, r: float) -> bool:
        """Return whether an ideal point before the fold is shown at distance r from the centre."""
        fold = self.max_radius
        return not np.isfinite(fold) or bool(fold * abs(self.L(fold)) >= r)

    def _narrowed(self, end: float) -> float:
        """Where tangential terms fold the picture, at the latest where it folds without them.

        On a circle of radius r the smallest eigenvalue of the Jacobian is that of `fold_radius`.
        """
        p_norm = float(np.hypot(*self.p))
        if not p_norm:
            return end
        # (beyond 20, a ray 87° off the axis, tangential terms have long folded what they fold)
        r = np.linspace(0, min(end, 20.0), 4001)[1:]
        folded = np.flatnonzero(self._smallest_eigenvalue(r, p_norm) <= 0)
        if not folded.size:
            return end
        low, high = (r[folded[0] - 1] if folded[0] else 0.0), r[folded[0]]
        for _ in range(60):
            middle = (low + high) / 2
            if self._smallest_eigenvalue(np.array([middle]), p_norm)[0] > 0:
                low = middle
            else:
                high = middle
        return float(low)

    @np.errstate(all="ignore")  # at a pole
    def _smallest_eigenvalue(self, r: Array, p_norm: float) -> Array:
        L, by_t, _ = self._quotient(r * r)
        a, m = 2 * r * r * by_t, 4 * p_norm * r
        beside = L - a / 8 - m * m / (2 * np.where(a > 0, a, 1))
        straight = np.minimum(L + a - 1.5 * m, L - m / 2)
        return np.where((2 * m < 3 * a) & (a < 2 * m), beside, straight)

    @guarded(xy=Points(2))
    @np.errstate(all="ignore")
    def distort(self, xy: Array) -> Array:
        """Move ideal image points (..., 2) to where the lens shows them; NaN beyond its end.

        Examples
        --------
        >>> RationalLens(k=(-0.1,)).distort([0.5, 0.0])
        array([0.4875, 0.    ])
        """
        x, y = xy[..., 0], xy[..., 1]
        seen = np.moveaxis(self._with_derivatives(np.stack([x, y]))[0], 0, -1)
        inside = (x * x + y * y <= self.max_radius**2)[..., None]
        return np.where(inside & np.isfinite(seen), seen, np.nan)

    @guarded(xy_lens=Points(2))
    @np.errstate(all="ignore")  # a step too far may leave the model; it is then halved
    def undistort(self, xy_lens: Array) -> Array:
        """Move observed points (..., 2) back; NaN where no point within ``max_radius`` is shown.

        Notes
        -----
        Newton's method on (x, y), with steps halved while they lead away, from the best of a table
        along the radius.

        Examples
        --------
        >>> lens = RationalLens(k=(0.3, 0.1, 0.0, 0.6, 0.2), p=(0.001, 0.0))
        >>> lens.undistort(lens.distort([0.4, -0.3])).round(12)
        array([ 0.4, -0.3])
        """
        target = np.moveaxis(xy_lens, -1, 0).reshape(2, -1)
        xy = self._start(target)
        seen, D, _ = self._with_derivatives(xy)
        miss = seen - target
        for _ in range(_STEPS):
            det = D[0, 0] * D[1, 1] - D[0, 1] * D[1, 0]
            step = (
                np.stack(
                    [D[1, 1] * miss[0] - D[0, 1] * miss[1], D[0, 0] * miss[1] - D[1, 0] * miss[0]]
                )
                / det
            )
            late = np.flatnonzero((miss**2).sum(0) > _CLOSE**2)
            if not late.size:
                break
            length = np.ones(late.size)
            for _ in range(8):  # halve the steps that lead away
                tried = xy[:, late] - length * step[:, late]
                seen, by_xy, _ = self._with_derivatives(tried)
                off = seen - target[:, late]
                worse = ~((off**2).sum(0) < (miss[:, late] ** 2).sum(0))
                if not worse.any():
                    break
                length[worse] /= 2
            better = ~worse
            chosen = late[better]
            if not chosen.size:
                break
            xy[:, chosen], miss[:, chosen] = tried[:, better], off[:, better]
            D[:, :, chosen] = by_xy[:, :, better]
        reached = ((miss**2).sum(0) <= 1e-20) & ((xy**2).sum(0) <= self.max_radius**2 * (1 + 1e-9))
        return (
            np.where(reached, xy, np.nan)
            .reshape(2, *xy_lens.shape[:-1])
            .transpose(*range(1, xy_lens.ndim), 0)
        )

    def on_plane(
        self, xy: Array, names: tuple[str, ...], by_coefficients: Array
    ) -> tuple[Array, tuple[Array, Array]]:
        """Distort xy (2, ...), with derivatives by all of k1 … k6, p1 and p2."""
        del names
        xy_lens, D, by_coefficients[...] = self._with_derivatives(xy)
        return xy_lens, (D[:, 0], D[:, 1])

    def opencv_coefficients(self) -> Array:
        """Return k1, k2, p1, p2, k3, …, k6, then s1 … s4 and the tilt if it has them."""
        k1, k2, k3, *others = self.k
        size = 14 if any(self.tilt) else 12 if any(self.s) else 8
        return np.array([k1, k2, *self.p, k3, *others, *self.s, *self.tilt])[:size]

    def _with_derivatives(self, xy: Array) -> tuple[Array, Array, Array]:
        """Distort xy (2, ...), with derivatives: by xy (2, 2, ...), by NAMES (8, 2, ...)."""
        x, y = xy
        seen, D, C = self._through_quotient(xy)
        if any(self.s):
            t, (s1, s2, s3, s4) = x * x + y * y, self.s
            seen += np.stack([s1 * t + s2 * t * t, s3 * t + s4 * t * t])
            by_t = np.stack([s1 + 2 * s2 * t, s3 + 2 * s4 * t])
            D += by_t[:, None] * np.stack([2 * x, 2 * y])
        if any(self.tilt):
            H = self._sensor
            w = H[2, 0] * seen[0] + H[2, 1] * seen[1] + H[2, 2]
            shown = np.stack([H[i, 0] * seen[0] + H[i, 1] * seen[1] + H[i, 2] for i in (0, 1)]) / w
            T = (H[:2, :2].reshape(2, 2, *[1] * x.ndim) - shown[:, None] * H[2, :2].reshape(
                1, 2, *[1] * x.ndim)) / w  # fmt: skip
            D, C = np.einsum("ij...,jk...->ik...", T, D), np.einsum("ij...,nj...->ni...", T, C)
            seen = shown
        return seen, D, C

    @cached_property
    def _sensor(self) -> Array:
        """Homography from the plane behind the lens to the tilted sensor."""
        cx, cy = np.cos(self.tilt)
        sx, sy = np.sin(self.tilt)
        about_x = np.array([[1, 0, 0], [0, cx, sx], [0, -sx, cx]])
        about_y = np.array([[cy, 0, -sy], [0, 1, 0], [sy, 0, cy]])
        R = about_y @ about_x
        onto = [[R[2, 2], 0, -R[0, 2]], [0, R[2, 2], -R[1, 2]], [0, 0, 1]]
        return np.asarray(np.array(onto) @ R)

    def _quotient(self, t: Array) -> tuple[Array, Array, Array]:
        """L(r), its derivative by t = r², and what L is divided by."""
        a, b = (1.0, *self.k[:3]), (1.0, *self.k[3:])
        above, below = horner(a, t), horner(b, t)
        slopes = [horner([i * c for i, c in enumerate(ks)][1:], t) for ks in (a, b)]
        return above / below, (slopes[0] * below - above * slopes[1]) / below**2, below

    def _through_quotient(self, xy: Array) -> tuple[Array, Array, Array]:
        """Distort by k and p alone, with derivatives."""
        x, y = xy
        t = x * x + y * y
        L, by_t, below = self._quotient(t)
        p1, p2 = self.p
        by_p1, by_p2 = np.stack([2 * x * y, t + 2 * y * y]), np.stack([t + 2 * x * x, 2 * x * y])
        seen = L * xy + p1 * by_p1 + p2 * by_p2
        D = (2 * by_t * xy)[:, None] * xy  # dt/d(x, y) = 2 (x, y)
        D[0, 0] += L + 2 * p1 * y + 6 * p2 * x
        D[0, 1] += 2 * (p1 * x + p2 * y)
        D[1, 0] += 2 * (p1 * x + p2 * y)
        D[1, 1] += L + 2 * p2 * x + 6 * p1 * y
        powers = np.stack([t, t * t, t * t * t])[:, None] / below * xy
        return seen, D, np.concatenate([powers, -L * powers, [by_p1, by_p2]])

    def _start(self, target: Array) -> Array:
        """Interpolate the radius in a table of r L(r); the direction is that of the target."""
        if any(self.tilt):  # as it would be on a sensor that stands straight
            h = np.linalg.inv(self._sensor) @ np.concatenate([target, np.ones_like(target[:1])])
            target = h[:2] / h[2]
        end = min(self.max_radius * (1 - 1e-12), 20.0)  # at a pole there is no value
        r = np.tan(np.linspace(0, np.arctan(end), 513))
        shown = r * self._quotient(r * r)[0]
        d = np.hypot(*target)
        ratio = np.interp(d, shown, r) / np.where(d > 0, d, 1)
        return target * np.where(d > 0, ratio, 1)


def sign_changes(f: Array | list[float], beyond: float) -> list[float]:
    """Find the positive roots up to `beyond` at which a polynomial changes its sign.

    Its coefficients come highest power first. (With these, NumPy has no need of its package of
    polynomials, which takes longer to load than all lenses.)

    Examples
    --------
    >>> sign_changes([2.0, -4.0], 10.0)
    [2.0]
    >>> sign_changes([1.0, -4.0, 4.0], 10.0)
    []
    """
    roots = np.asarray(np.roots(f), complex)
    near_real = np.abs(roots.imag) <= 1e-7 * np.abs(roots)
    real = sorted(roots.real[near_real & (roots.real > 0) & (roots.real < beyond)].tolist())
    between = [0.0, *[(a + b) / 2 for a, b in pairwise(real)], beyond]
    signs = [0.0]
    for t in between:  # (between two equal roots it is 0: no change)
        signs.append(float(np.sign(np.polyval(np.asarray(f), t))) or signs[-1])
    del signs[0]
    return [t for t, (before, after) in zip(real, pairwise(signs), strict=False) if before != after]
