"""The lens: where it moves ideal image points, and back (notes 2b.3).

Everything here happens on the plane z = 1, between the projection and the pixels. With d the
offset from the distortion centre and r = ‖d‖,

    x' = centre + L(r) d + 2 (p·d) d + r² p,    L(r) = 1 + k1 r² + k2 r⁴ + …,

where p = (p2, p1) collects the notes' tangential terms in one vector.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, Points, ShapeError, guarded, numbers
from cvnotes.camera.lens_fold import fold_radius, horner, radial_factor
from cvnotes.camera.lens_inverse import Inverse

# Far from all lenses powers of r overflow: to infinity, or to NaN, and in silence.
_beyond_all_numbers = np.errstate(over="ignore", invalid="ignore")

# Nobody fits more coefficients to a lens, and the roots of a long polynomial take minutes.
_MOST = 32


@dataclass(frozen=True)
class Lens:
    """A lens with radial and tangential distortion; ``Lens()`` is perfect.

    Parameters
    ----------
    k : sequence of float
        Radial coefficients k1, k2, … of L(r) = 1 + k1 r² + k2 r⁴ + …; at most 32 of them.
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
            values = numbers(getattr(self, name), name, largest=np.inf)
            if values.ndim != 1 or length not in (None, values.size):
                wanted = "a sequence k1, k2, …" if length is None else "two numbers"
                raise ShapeError(f"{name}: expected {wanted}, got shape {values.shape}")
            given = tuple(values.tolist())
            if len(given) > _MOST:
                raise CvnotesError(f"{name}: no lens has {len(given)} coefficients")
            if any(abs(value) > 1e50 for value in given):
                raise CvnotesError(f"{name} = {list(given)}: no lens has such coefficients")
            object.__setattr__(self, name, given)

    @property
    def is_ideal(self) -> bool:
        """Tell whether this lens moves nothing."""
        return not any(self.k) and not any(self.p)

    @property
    def parameters(self) -> dict[str, float]:
        """The coefficients by name: k1, k2, … and, unless both are zero, p1 and p2.

        A coefficient without a name here is zero.
        """
        radial = {f"k{i}": k for i, k in enumerate(self.k, start=1)}
        return radial | (dict(zip(("p1", "p2"), self.p, strict=True)) if any(self.p) else {})

    def with_parameters(self, values: Mapping[str, float]) -> "Lens":
        """Give the same lens with other values of the coefficients that are named.

        Examples
        --------
        >>> Lens(k=(-0.25,)).with_parameters({"k2": 0.1, "p1": 0.001})
        Lens(k=(-0.25, 0.1), p=(0.001, 0.0), centre=(0.0, 0.0))
        """
        value = self.parameters | dict(values)
        unknown = [name for name in value if not (name in ("p1", "p2") or _is_radial(name))]
        if unknown:
            raise CvnotesError(
                f"{unknown[0]!r} is no coefficient of a lens: those are k1 …, p1, p2"
            )
        terms = max((int(name[1:]) for name in value if name[0] == "k"), default=0)
        k = tuple(value.get(f"k{i}", 0.0) for i in range(1, terms + 1))
        return replace(self, k=k, p=(value.get("p1", 0.0), value.get("p2", 0.0)))

    @_beyond_all_numbers
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

        Without tangential terms, the first positive root of d(r L)/dr; with them, the first
        radius at which the Jacobian becomes singular in some direction.
        """
        return fold_radius(self.k, float(np.hypot(*self.p)))

    @cached_property
    def _inverse(self) -> Inverse:
        return Inverse(self.k, self.p[::-1], self.centre)

    @guarded(xy=Points(2))
    @_beyond_all_numbers
    def distort(self, xy: Array) -> Array:
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
        x' = L(r) x + 2 p1 x y + p2 (r² + 2 x²); y' alike, with p1 and p2 exchanged. Where
        p = (p2, p1) multiplies x it is one factor with L: 2 p2 x² + 2 p1 x y = 2 (p2 x + p1 y) x.

        References
        ----------
        .. [1] Notes 2b.3, "Lens distortion parameters".

        Examples
        --------
        >>> Lens(k=(-0.1,)).distort([0.5, 0.0])
        array([0.4875, 0.    ])
        """
        if self.is_ideal:
            return xy
        (x0, y0), (p1, p2) = self.centre, self.p
        x, y = xy[..., 0] - x0, xy[..., 1] - y0
        r2 = x * x + y * y
        factor = radial_factor(self.k, r2)
        if np.isfinite(self.max_radius):
            factor = np.where(r2 <= self.max_radius**2, factor, np.nan)
        if p1 or p2:
            factor += 2 * (p2 * x + p1 * y)
            x0, y0 = x0 + p2 * r2, y0 + p1 * r2
        return np.stack([factor * x + x0, factor * y + y0], axis=-1)

    @guarded(xy_lens=Points(2))
    def undistort(self, xy_lens: Array) -> Array:
        """Move observed image points back to where an ideal lens would show them.

        Newton's method on the radius, to 1e-12; see `cvnotes.camera.lens_inverse`.

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
        if self.is_ideal:
            return xy_lens
        return self._inverse(xy_lens)

    @guarded(xy=Points(2))
    @_beyond_all_numbers
    def jacobian(self, xy: Array) -> Array:
        """Differentiate the distorted point by the ideal one: (..., 2, 2).

        Examples
        --------
        >>> Lens(k=(-4 / 3,)).jacobian([0.5, 0.0])[0, 0].round(12) + 0.0
        np.float64(0.0)
        """
        d = xy - self.centre
        x, y = d[..., 0], d[..., 1]
        p1, p2 = self.p
        r2 = x * x + y * y
        L = radial_factor(self.k, r2)
        slope = horner([2 * i * k for i, k in enumerate(self.k, start=1)], r2)  # L'(r) / r
        J11 = L + slope * x * x + 6 * p2 * x + 2 * p1 * y
        J12 = slope * x * y + 2 * (p1 * x + p2 * y)
        J22 = L + slope * y * y + 2 * p2 * x + 6 * p1 * y
        return np.stack([np.stack([J11, J12], -1), np.stack([J12, J22], -1)], -2)


def _is_radial(name: str) -> bool:
    """Tell whether a name is k1, k2 or so on."""
    return name[:1] == "k" and name[1:].isdecimal() and 1 <= int(name[1:]) <= 99
