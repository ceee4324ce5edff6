"""The lens: where it moves ideal image points, and back (notes 2b.3).

Everything here happens on the plane z = 1, between the projection and the pixels. With d the
offset from the distortion centre and r = ‖d‖,

    x' = centre + L(r) d + 2 (p·d) d + r² p,    L(r) = 1 + k1 r² + k2 r⁴ + …,

where p = (p2, p1) collects the notes' tangential terms in one vector.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, ShapeError, numbers, points

# Points worked on at a time by undistort: its dozen temporaries then stay in the cache.
_CHUNK = 8192


@dataclass(frozen=True)
class Lens:
    """A lens with radial and tangential distortion; ``Lens()`` is perfect.

    Parameters
    ----------
    k : sequence of float
        Radial coefficients k1, k2, … of L(r) = 1 + k1 r² + k2 r⁴ + …; any number of them.
    p : (p1, p2)
        Tangential coefficients.
    centre : (x, y)
        Distortion centre on the plane z = 1; (0, 0) is the piercing point.

    Notes
    -----
    Valid up to ``max_radius``: beyond it the polynomial folds the image over, which no lens does.
    With a centre away from 0 the printed form of the notes is wrong (erratum E14); here the
    centre is subtracted before, and added after, all terms.

    References
    ----------
    .. [1] Notes 2b.3, "Lens distortion parameters".
    .. [2] D. C. Brown, Photogrammetric Engineering 32 (1966) 444-462.

    Examples
    --------
    >>> Lens(k=(-4 / 3,)).max_radius
    0.5
    """

    k: tuple[float, ...] = ()
    p: tuple[float, float] = (0.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        for name, length in (("k", None), ("p", 2), ("centre", 2)):
            values = numbers(getattr(self, name), name)
            if values.ndim != 1 or length not in (None, values.size):
                wanted = "a sequence k1, k2, …" if length is None else "two numbers"
                raise ShapeError(f"{name}: expected {wanted}, got shape {values.shape}")
            object.__setattr__(self, name, tuple(values.tolist()))

    @property
    def is_ideal(self) -> bool:
        """Tell whether this lens moves nothing."""
        return not any(self.k) and not any(self.p)

    def L(self, r: npt.ArrayLike) -> Array:
        """Give the radial factor L(r) = 1 + k1 r² + k2 r⁴ + …, same shape as r.

        Examples
        --------
        >>> Lens(k=(-0.2, 0.1)).L(1.0)
        array(0.9)
        """
        return np.asarray(radial_factor(self.k, numbers(r, "r") ** 2))

    @cached_property
    def max_radius(self) -> float:
        """Largest ideal radius up to which the lens maps one to one (inf if there is no end).

        Without tangential terms, the first positive root of d(r L)/dr. With them, the first
        radius at which det J = 0 in the direction −p, where the image folds first: there
        det J = (d(r L)/dr − 6 ‖p‖ r)(L − 2 ‖p‖ r).
        """
        q = float(np.hypot(*self.p))
        slope = [0.0] * (2 * len(self.k) + 2)  # ascending powers of r
        factor = list(slope)
        slope[0] = factor[0] = 1.0
        for i, k in enumerate(self.k, start=1):
            slope[2 * i], factor[2 * i] = (2 * i + 1) * k, k
        slope[1], factor[1] = -6 * q, -2 * q
        return min(_first_positive_root(slope), _first_positive_root(factor))

    def distort(self, xy: npt.ArrayLike) -> Array:
        """Move ideal image points to where the lens shows them.

        Parameters
        ----------
        xy : array_like, shape (..., 2)
            Ideal image coordinates x/z, y/z (dimensionless).

        Returns
        -------
        ndarray, shape (..., 2)
            Observed coordinates x', y'. Rows beyond ``max_radius`` are NaN: there the
            polynomial folds the image over and no longer describes a lens.

        Notes
        -----
        x' = L(r) x + 2 p1 x y + p2 (r² + 2 x²); y' alike, with p1 and p2 exchanged.

        References
        ----------
        .. [1] Notes 2b.3, "Lens distortion parameters".

        Examples
        --------
        >>> Lens(k=(-0.1,)).distort([0.5, 0.0])
        array([0.4875, 0.    ])
        """
        return self._distort(points(xy, "xy", 2))

    def undistort(self, xy_lens: npt.ArrayLike) -> Array:
        """Move observed image points back to where an ideal lens would show them.

        Newton's method to 1e-12, started on the inverse of the radial curve.

        Parameters
        ----------
        xy_lens : array_like, shape (..., 2)
            Observed image coordinates x', y' (dimensionless).

        Returns
        -------
        ndarray, shape (..., 2)
            Ideal coordinates. Rows that no ideal point within ``max_radius`` reaches are NaN.

        References
        ----------
        .. [1] Notes 2b.3 gives only the forward direction; the inverse has no closed form.

        Examples
        --------
        >>> lens = Lens(k=(-0.25, 0.1), p=(0.001, 0.0))
        >>> lens.undistort(lens.distort([0.4, -0.3])).round(12)
        array([ 0.4, -0.3])
        """
        xy_lens = points(xy_lens, "xy_lens", 2)
        if self.is_ideal or xy_lens.size == 0:
            return xy_lens
        d = xy_lens.reshape(-1, 2) - self.centre
        s = np.hypot(d[:, 0], d[:, 1])
        table = self._radial_table(float(s.max()))
        out = np.empty_like(d)
        for i in range(0, len(d), _CHUNK):
            part = slice(i, i + _CHUNK)
            out[part] = self._newton(d[part], s[part], table)
        return (out + self.centre).reshape(xy_lens.shape)

    def jacobian(self, xy: npt.ArrayLike) -> Array:
        """Differentiate the distorted point by the ideal one: (..., 2, 2).

        Examples
        --------
        >>> Lens(k=(-4 / 3,)).jacobian([0.5, 0.0])[0, 0].round(12) + 0.0
        np.float64(0.0)
        """
        d = points(xy, "xy", 2) - self.centre
        x, y = d[..., 0], d[..., 1]
        L, slope = self._factor_and_slope(x * x + y * y)
        J11, J12, J22 = _symmetric_jacobian(x, y, L, slope, self.p)
        return np.stack([np.stack([J11, J12], -1), np.stack([J12, J22], -1)], -2)

    def _distort(self, xy: Array) -> Array:
        """Distort without a guard; NaN rows stay NaN."""
        if self.is_ideal:
            return xy
        d = xy - self.centre
        r2 = (d * d).sum(-1, keepdims=True)
        out = radial_factor(self.k, r2) * d
        if any(self.p):
            p = np.array(self.p[::-1])
            out += 2 * (d @ p)[..., None] * d + r2 * p
        out += self.centre
        out[~(r2[..., 0] <= self.max_radius**2)] = np.nan
        return np.asarray(out)

    def _factor_and_slope(self, r2: Array) -> tuple[Array, Array]:
        """Give L and 2 dL/d(r²), both as functions of r²."""
        slope = [2 * i * k for i, k in enumerate(self.k, start=1)]
        return radial_factor(self.k, r2), horner(slope, r2)

    def _radial_table(self, s_max: float) -> tuple[Array, Array]:
        """Tabulate r against r L(r), far enough to cover observed radii up to `s_max`."""
        R = self.max_radius
        if np.isinf(R):
            R = s_max
            while R * float(self.L(R)) < s_max:
                R *= 2
        # Denser towards the fold, where r changes fastest with r L(r).
        r = R * (1 - np.linspace(1, 0, 512) ** 2)
        return r * self.L(r), r

    def _newton(self, d: Array, s: Array, table: tuple[Array, Array]) -> Array:
        """Solve distort(x) = d; `s` = ‖d‖."""
        ratio = np.divide(np.interp(s, *table), s, out=np.ones_like(s), where=s > 0)
        x, y = d[:, 0] * ratio, d[:, 1] * ratio
        p1, p2 = self.p
        error = np.full_like(s, np.inf)
        with np.errstate(all="ignore"):  # rows that have no answer may run away
            for _ in range(20):
                r2 = x * x + y * y
                L, slope = self._factor_and_slope(r2)
                pd = 2 * (p2 * x + p1 * y)
                ex, ey = (L + pd) * x + p2 * r2 - d[:, 0], (L + pd) * y + p1 * r2 - d[:, 1]
                error = np.abs(ex) + np.abs(ey)
                if not (error > 1e-15 * (1 + s)).any():
                    break
                J11, J12, J22 = _symmetric_jacobian(x, y, L, slope, self.p)
                det = J11 * J22 - J12 * J12
                dx, dy = (J22 * ex - J12 * ey) / det, (J11 * ey - J12 * ex) / det
                x, y = x - dx, y - dy
                if not (np.abs(dx) + np.abs(dy) > 1e-9 * (1 + s)).any():
                    error = np.zeros_like(s)  # the next step would be about 1e-18
                    break
            found = (error <= 1e-12 * (1 + s)) & (x * x + y * y <= self.max_radius**2)
        return np.where(found[:, None], np.stack([x, y], -1), np.nan)


def radial_factor(k: Sequence[float], r2: Array) -> Array:
    """Give L as a function of r² by Horner's scheme, without a guard: for use inside."""
    return 1 + r2 * horner(k, r2)


def horner(coefficients: Sequence[float], t: Array) -> Array:
    """Evaluate c0 + c1 t + c2 t² + … from its coefficients, without a guard: for use inside."""
    if not coefficients:
        return np.zeros_like(t)
    value = np.full_like(t, coefficients[-1])
    for c in reversed(coefficients[:-1]):
        value *= t
        value += c
    return value


def _symmetric_jacobian(
    x: Array, y: Array, L: Array, slope: Array, p: tuple[float, float]
) -> tuple[Array, Array, Array]:
    """Give the entries (11, 12 = 21, 22) of d(x', y')/d(x, y)."""
    p1, p2 = p
    J11 = L + slope * x * x + 6 * p2 * x + 2 * p1 * y
    J12 = slope * x * y + 2 * (p1 * x + p2 * y)
    J22 = L + slope * y * y + 2 * p2 * x + 6 * p1 * y
    return J11, J12, J22


def _first_positive_root(ascending: list[float]) -> float:
    """Find the first sign change of a polynomial that is 1 at 0; inf if there is none."""
    roots = np.roots(ascending[::-1])
    real = np.sort(roots[np.abs(roots.imag) <= 1e-7 * np.abs(roots)].real)
    value = np.polynomial.Polynomial(ascending)
    candidates = np.append(real[real > 0], np.inf)
    for root, following in pairwise(candidates):
        middle = (root + following) / 2 if np.isfinite(following) else 2 * root
        if value(middle) < 0:
            return float(root - value(root) / value.deriv()(root))
    return np.inf
