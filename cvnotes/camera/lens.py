"""The lens: where it moves ideal image points, where that ends, and the way back (notes 2b.3).

Everything here happens on the plane z = 1, between the projection and the pixels. With d the
offset from the distortion centre and r = ‖d‖,

    x' = centre + L(r) d + 2 (p·d) d + r² p,    L(r) = 1 + k1 r² + k2 r⁴ + …,

where p = (p2, p1) collects the notes' tangential terms in one vector.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, Points, ShapeError, chunks, guarded, numbers
from cvnotes.camera.any_lens import PlaneLens

# Far from all lenses powers of r overflow: to infinity, or to NaN, and in silence.
_beyond_all_numbers = np.errstate(over="ignore", invalid="ignore")

_ZERO = (0.0, 0.0)
# Nobody fits more coefficients to a lens, and the roots of a long polynomial take minutes.
_MOST = 32
# Radii beyond this are infinite for our purpose: a ray 0.0001 degrees before 90.
_INFINITE = 1e6
# Knots of the table that Newton's method starts from; more of them would only save steps.
_KNOTS = 4096
# Points at a time: the dozen temporaries then stay in the cache.
_CHUNK = 12288


def horner(coefficients: Sequence[float], t: Array) -> Array:
    """Evaluate c0 + c1 t + c2 t² + … from its coefficients.

    Examples
    --------
    >>> horner([1, 2], np.array([0.0, 10.0]))
    array([ 1., 21.])
    """
    if len(coefficients) < 2:
        return np.full_like(t, coefficients[0] if len(coefficients) else 0.0)
    value = coefficients[-1] * t
    for c in coefficients[-2:0:-1]:
        value += c
        value *= t
    value += coefficients[0]
    return value


def radial_factor(k: Sequence[float], r2: Array) -> Array:
    """Return L = 1 + k1 r² + k2 r⁴ + … as a function of r².

    Examples
    --------
    >>> radial_factor((-0.25,), np.array([0.0, 1.0]))
    array([1.  , 0.75])
    """
    return horner((1.0, *k), r2)


@dataclass(frozen=True)
class Lens(PlaneLens):
    """A lens with radial and tangential distortion; ``Lens()`` is perfect.

    Parameters
    ----------
    k : sequence of float
        Radial coefficients k1, k2, … of L(r) = 1 + k1 r² + k2 r⁴ + …; at most 32 of them.
    p : (p1, p2)
        Tangential coefficients.
    centre : (x, y)
        Distortion centre on the plane z = 1; (0, 0) is the principal point.

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

    model: ClassVar[str] = "polynomial"
    choices: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "none": (),
        "k1": ("k1",),
        "k1 k2": ("k1", "k2"),
        "k1 k2 k3": ("k1", "k2", "k3"),
        "k1 k2 p1 p2": ("k1", "k2", "p1", "p2"),
        "k1 k2 p1 p2 k3": ("k1", "k2", "k3", "p1", "p2"),
    }
    linear_terms: ClassVar[int] = 3
    ros_name: ClassVar[str] = "plumb_bob"
    seldom: ClassVar[tuple[str, ...]] = ("centre",)

    k: tuple[float, ...] = ()
    p: tuple[float, float] = _ZERO
    centre: tuple[float, float] = _ZERO

    def __post_init__(self) -> None:
        for name, length in (("k", None), ("p", 2), ("centre", 2)):
            if getattr(self, name) is _ZERO:  # which nobody gave
                continue
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
        """Return whether this lens moves nothing."""
        return not any(self.k) and not any(self.p)

    @property
    def parameters(self) -> dict[str, float]:
        """The coefficients by name: k1, k2, … and, unless both are zero, p1 and p2.

        A coefficient without a name here is zero.
        """
        radial = {f"k{i}": k for i, k in enumerate(self.k, start=1)}
        return radial | (dict(zip(("p1", "p2"), self.p, strict=True)) if any(self.p) else {})

    def with_parameters(self, values: Mapping[str, float]) -> "Lens":
        """Return the same lens with other values of the coefficients that are named.

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

    @classmethod
    def unchecked(cls, values: Mapping[str, float]) -> "Lens":
        """Make the lens of such coefficients, whatever they are; see `AnyLens.unchecked`."""
        lens = object.__new__(cls)
        radial = [x for name, x in values.items() if name[0] == "k"]
        object.__setattr__(lens, "k", tuple(radial))
        object.__setattr__(lens, "p", (values.get("p1", 0.0), values.get("p2", 0.0)))
        return lens

    @_beyond_all_numbers
    def L(self, r: npt.ArrayLike) -> Array:
        """Return the radial factor L(r) = 1 + k1 r² + k2 r⁴ + …, same shape as r.

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
    def _certain(self) -> float:
        """A radius below `max_radius` that needs no roots, and mostly holds all that is seen.

        Within it none of the n terms by which the Jacobian differs from 1 exceeds 0.99/n.
        """
        terms = [((2 * i + 1) * abs(k_i), 2 * i) for i, k_i in enumerate(self.k, start=1)]
        terms = [term for term in (*terms, (6 * float(np.hypot(*self.p)), 1)) if term[0]]
        allowed = 0.99 / max(len(terms), 1)
        ends = ((allowed / max(size, 1e-6)) ** (1 / power) for size, power in terms)
        return min(ends, default=_INFINITE)

    @_beyond_all_numbers
    def reaches(self, r: float) -> bool:
        """Return whether some ideal point before the fold is shown at distance r from the centre.

        Examples
        --------
        >>> Lens(k=(-4 / 3,)).reaches(0.3), Lens(k=(-4 / 3,)).reaches(0.4)
        (True, False)
        """
        if self._certain * radial_factor(self.k, np.array(self._certain**2)) >= r:
            return True
        fold = self.max_radius
        return not np.isfinite(fold) or bool(fold * abs(self.L(fold)) >= r)

    @cached_property
    def _inverse(self) -> "Inverse":
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
        if not r2.max(initial=0.0) <= self._certain**2 and np.isfinite(self.max_radius):
            factor = np.where(r2 <= self.max_radius**2, factor, np.nan)
        if p1 or p2:
            factor += 2 * (p2 * x + p1 * y)
            x0, y0 = x0 + p2 * r2, y0 + p1 * r2
        return np.stack([factor * x + x0, factor * y + y0], axis=-1)

    @guarded(xy_lens=Points(2))
    def undistort(self, xy_lens: Array) -> Array:
        """Move observed image points back to where an ideal lens would show them.

        Newton's method on the radius, to 1e-12; see `Inverse`.

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

    def on_plane(
        self, xy: Array, names: tuple[str, ...], by_coefficients: Array
    ) -> tuple[Array, tuple[Array, Array]]:
        """Distort xy (2, ...), with derivatives; see `PlaneLens.on_plane`.

        Notes
        -----
        With d = (x, y) from the centre and D the derivative by it, which is symmetric,

            D = L I + (L'/r) d dᵀ + [6 p2 x + 2 p1 y,  2 p1 x + 2 p2 y;  …,  2 p2 x + 6 p1 y],

        by k_i: r²ⁱ d; by p1: (2 x y, r² + 2 y²); by p2: (r² + 2 x², 2 x y).
        """
        if any(self.centre):
            xy = xy - np.reshape(self.centre, (2, *[1] * (xy.ndim - 1)))
        x, y = xy
        tangential = "p1" in names
        n_radial = len(names) - 2 * tangential
        products = np.empty((3, *x.shape))  # x², x y, y²
        np.multiply(xy, x, out=products[:2])
        np.multiply(y, y, out=products[2, ...])
        r2 = products[0] + products[2]
        power = xy
        for i in range(n_radial):
            power = np.multiply(power, r2, out=by_coefficients[i])
        slope = horner([2 * i * k for i, k in enumerate(self.k, start=1)], r2)  # L'(r) / r
        L = radial_factor(self.k, r2)
        xy_lens = L * xy
        D = slope * products  # D11, D12, D22
        D[::2] += L
        p1, p2 = self.p
        if tangential or p1 or p2:
            by_p = by_coefficients[-2:] if tangential else np.empty((2, *xy.shape))
            by_p1, by_p2 = by_p
            np.multiply(2, products[1:], out=by_p1)
            np.multiply(2, products[:2], out=by_p2)
            by_p1[1] += r2
            by_p2[0] += r2
            xy_lens += p1 * by_p1 + p2 * by_p2
            by_xy = np.array([[6 * p2, 2 * p1], [2 * p1, 2 * p2], [2 * p2, 6 * p1]])
            D += (by_xy @ xy.reshape(2, -1)).reshape(D.shape)
        if any(self.centre):
            xy_lens += np.reshape(self.centre, (2, *[1] * (xy.ndim - 1)))
        return xy_lens, (D[:2], D[1:])

    def opencv_coefficients(self) -> Array:
        """Return k1, k2, p1, p2, k3, as OpenCV orders them.

        Raises
        ------
        CvnotesError
            The lens has more radial coefficients, or a distortion centre of its own.
        """
        if any(self.centre) or any(self.k[3:]):
            raise CvnotesError(
                "OpenCV and ROS hold k1 k2 p1 p2 k3 about the principal point; this lens has "
                f"more ({self}); keep it as JSON"
            )
        k1, k2, k3 = (*self.k, 0.0, 0.0, 0.0)[:3]
        return np.array([k1, k2, *self.p, k3])


def _is_radial(name: str) -> bool:
    """Return whether a name is k1, k2 or so on."""
    return name[:1] == "k" and name[1:].isdecimal() and 1 <= int(name[1:]) <= 99


# --- where it ends


def fold_radius(k: Sequence[float], p_norm: float = 0.0) -> float:
    """Return the smallest ideal radius at which the picture folds over; inf if there is none.

    It folds where the smaller eigenvalue of the Jacobian, a symmetric matrix, reaches 0. With
    a = r dL/dr and m = 4 ‖p‖ r, the smallest value of this eigenvalue on a circle is

        L + a − 3m/2              if a ≤ 2m/3, in the direction −p,
        L − a/8 − m²/(2a)         if 2m/3 < a < 2m, beside it,
        L − m/2                   if a ≥ 2m; it grows there, so it never reaches 0 first,

    so that every fold is a root of one of two polynomials in r. Without tangential terms
    L + a = d(r L)/dr decides alone.

    Examples
    --------
    >>> fold_radius([-4 / 3]), fold_radius([0.1])
    (0.5, inf)
    """
    L = np.array([1.0, *k])  # ascending powers of r², like a
    a = 2 * np.arange(L.size) * L
    towards = np.zeros(2 * L.size)  # ascending powers of r
    towards[::2], towards[1] = L + a, -6 * p_norm
    candidates = _positive_roots(towards, _INFINITE)
    if p_norm > 0 and k:
        beside = np.convolve(a[1:], 8 * L - a)  # 8a (L − a/8 − m²/(2a)) / r², powers of r²
        beside[0] -= 64 * p_norm**2
        candidates += [t**0.5 for t in _positive_roots(beside, _INFINITE**2)]
    candidates.sort()
    curves = L.tolist(), a.tolist()
    for i, r in enumerate(candidates):
        beyond = (r + candidates[i + 1]) / 2 if i + 1 < len(candidates) else 2 * r
        if _smallest_eigenvalue(curves, p_norm, beyond) < 0:
            return r
    return np.inf


def _smallest_eigenvalue(curves: tuple[list[float], list[float]], p_norm: float, r: float) -> float:
    """Return the smallest eigenvalue of the Jacobian on a circle, by `fold_radius`'s formulas."""
    L, a = (_value(curve, r * r) for curve in curves)
    m = 4 * p_norm * r
    if 2 * m < 3 * a < 6 * m:
        return L - a / 8 - m**2 / (2 * a)
    return min(L + a - 1.5 * m, L - m / 2)


def _positive_roots(ascending: Array, beyond: float) -> list[float]:
    """Return the positive roots of a polynomial, up to `beyond`, polished by a step of Newton's."""
    # Read backwards the polynomial has the reciprocals as roots, and small roots come out best.
    reciprocal = np.roots(np.where(np.abs(ascending) < 1e-100, 0, ascending))
    real = np.abs(reciprocal.imag) <= 1e-7 * np.abs(reciprocal)
    roots = (1 / reciprocal.real[real & (reciprocal.real > 1 / beyond)]).tolist()
    c = ascending.tolist()
    derivative = [i * c_i for i, c_i in enumerate(c)][1:]
    polished = [r - _value(c, r) / (_value(derivative, r) or np.inf) for r in roots]
    # Beside a double root, where the slope is all but 0, the step may lead anywhere.
    return [new if r / 2 < new < 2 * r else r for r, new in zip(roots, polished, strict=True)]


def _value(ascending: list[float], t: float) -> float:
    return reduce(lambda value, c: value * t + c, reversed(ascending), 0.0)


# --- the way back


class Inverse:
    """The way back through a lens: from where it shows a point to the ideal point.

    Parameters
    ----------
    k : sequence of float
        Radial coefficients k1, k2, …
    p : (2,) sequence of float
        The tangential vector p = (p2, p1).
    centre : (2,) sequence of float
        The distortion centre.

    Notes
    -----
    With d the offset from the centre at which a point is shown, and x its ideal offset, write S =
    ‖d‖², r² = q² S, a = q² p·d, b = q⁴ ‖p‖² S and n = ‖d − r² p‖/‖d‖ = √(1 − 2a + b). Since d − r²
    p = (L + 2 p·x) x, its length gives L + 2 p·x = n/q and its product with p gives p·x; together

        q L n = 1 − 4a + 3b,    x = (q/n) (d − r² p).

    Before the fold the Jacobian is symmetric and positive definite, so no two points share their
    image: the equation has at most one root, and left − right passes from − to + there.
    Newton's method starts from a table of q for p = 0. Its argument w is chosen such that q is
    smooth in it, at the fold too, so that linear interpolation is right to about 1e-7.
    """

    def __init__(
        self, k: Sequence[float], p: Sequence[float], centre: Sequence[float] = (0.0, 0.0)
    ) -> None:
        self.k, self.p, self.centre = tuple(k), tuple(p), tuple(centre)
        self.k_slope = tuple((2 * i + 1) * k_i for i, k_i in enumerate(k, start=1))
        self.p_norm2 = p[0] ** 2 + p[1] ** 2
        self.r_max = fold_radius(k, self.p_norm2**0.5)
        self._tabulate(fold_radius(k))

    def __call__(self, xy_lens: Array) -> Array:
        """Map points (..., 2); rows that no point before the fold is shown at become NaN."""
        rows = xy_lens.reshape(-1, 2)
        out = np.empty_like(rows)
        x0, y0 = self.centre
        for part in chunks(len(rows), _CHUNK):
            x, y = self._offsets_of(rows[part, 0] - x0, rows[part, 1] - y0)
            x += x0
            y += y0
            out[part, 0], out[part, 1] = x, y
        return out.reshape(xy_lens.shape)

    @np.errstate(all="ignore")  # rows without an answer may overflow on their way to NaN
    def _offsets_of(self, dx: Array, dy: Array) -> tuple[Array, Array]:
        S = dx * dx
        S += dy * dy
        e = self.p[0] * dx + self.p[1] * dy if self.p_norm2 else np.zeros(1)
        q = self._start(S, e)
        for _ in range(2 if self.p_norm2 else 1):
            f, slope = self._newton(q, S, e)
            step = f / slope
            step *= q
            q -= step
        # Newton's step squares the error; where that may not be enough yet, take care. Whether
        # there are such rows at all, the largest error and the smallest slope tell at less cost.
        np.abs(f, out=f)
        least = slope.min(initial=1.0)
        if not f.max(initial=0.0) <= 1e-7 * least * abs(least):
            late = np.flatnonzero(~(f <= 1e-7 * np.minimum(slope, slope * slope)))
            q[late] = self._search(q[late], S[late], e[late] if self.p_norm2 else e)
        return self._offsets(q, S, dx, dy)

    def _offsets(self, q: Array, S: Array, dx: Array, dy: Array) -> tuple[Array, Array]:
        """Return x = (q/n) (d − r² p), NaN beyond the fold."""
        r2 = q * q
        r2 *= S
        if self.p_norm2:
            dx, dy = dx - self.p[0] * r2, dy - self.p[1] * r2  # d − r² p points along x
            length2 = dx * dx
            length2 += dy * dy
            length2 += 1e-300  # in the centre
            q = np.divide(r2, length2, out=length2)
            np.sqrt(q, out=q)
        if not r2.max(initial=0.0) <= self.r_max**2:
            q[~(r2 <= self.r_max**2)] = np.nan
        return q * dx, q * dy

    def _newton(self, q: Array, S: Array, e: Array) -> tuple[Array, Array]:
        """Return f = left − right and its slope q df/dq; e = p·d.

        f = q L n − 1 − 3 (b − a) + a and q df/dq = q (L + r dL/dr) n + 2 q L n (b − a)/n²
        − 12 (b − a) − 4a, step by step in as few arrays as can be.
        """
        q2 = q * q
        r2 = q2 * S
        f, slope = radial_factor(self.k, r2), radial_factor(self.k_slope, r2)
        if not self.p_norm2:
            f *= q
            f -= 1
            slope *= q
            return f, slope
        a = q2 * e
        b_a = np.multiply(q2, r2, out=r2)
        b_a *= self.p_norm2
        b_a -= a
        n2 = np.subtract(b_a, a, out=q2)
        n2 += 1
        qn = np.sqrt(n2)
        qn *= q
        f *= qn
        slope *= qn
        np.divide(b_a, n2, out=n2)
        n2 *= 2
        n2 *= f
        slope += n2
        b_a *= 3
        f -= b_a
        b_a *= 4
        slope -= b_a
        f += a
        f -= 1
        a *= 4
        slope -= a
        return f, slope

    def _search(self, q: Array, S: Array, e: Array) -> Array:
        """Solve the rows that need care: stay between bounds, and halve these while far."""
        lower, upper = np.zeros_like(q), self.r_max / np.sqrt(S)
        if np.isfinite(self.r_max):
            beyond = self._newton(upper, S, e)[0] < 0
            lower[beyond] = upper[beyond] = np.nan  # no root before the fold
        for _ in range(100):
            middle = np.where(np.isinf(upper), 2 * lower + 1, (lower + upper) / 2)
            q = np.where((lower < q) & (q < upper), q, middle)
            f, slope = self._newton(q, S, e)
            lower, upper = np.where(f < 0, q, lower), np.where(f < 0, upper, q)
            if not ((np.abs(f) > 1e-13 * slope) & (upper - lower > 1e-15 * q)).any():
                break
            q = np.where(np.abs(f) < 0.1 * slope, q - q * f / slope, np.inf)
        return q

    def _start(self, S: Array, e: Array) -> Array:
        """Look q up; to first order the tangential terms scale ‖d‖ by 1/c = 1 + 3a."""
        c = np.ones(1)
        if self.p_norm2:
            q = 1 + (self.k[0] if self.k else 0.0) * S  # its reciprocal, to first order
            c = 1 - 3 * e / (q * q)
        w = self._w(c * c * S)
        i = w.astype(np.intp)
        w -= i
        w *= self.q_step.take(i, mode="clip")
        w += self.q.take(i, mode="clip")
        w *= c
        return w

    def _w(self, S: Array) -> Array:
        """Place S in the table, from 0 (the fold, or infinity) to _KNOTS (the centre)."""
        if self.folds:
            w = S * (-(_KNOTS**2) / self.S_scale)
            w += _KNOTS**2
            np.maximum(w, 0, out=w)
        else:
            w = S * (1 / self.S_scale)
            w += 1
            np.divide(_KNOTS**2, w, out=w)
        return np.sqrt(w, out=w)

    def _tabulate(self, fold: float) -> None:
        """Tabulate q for p = 0 at equal steps of w."""
        w = np.linspace(1, 0, _KNOTS, endpoint=False)
        self.folds = bool(np.isfinite(fold))
        if self.folds:
            r = fold * np.append(1 - w, 1)
            self.S_scale = float(fold * radial_factor(self.k, np.array(fold**2))) ** 2
        else:
            reach = [abs(k_i) ** (-0.5 / i) for i, k_i in enumerate(self.k, start=1) if k_i]
            self.S_scale = min([1.0, *reach]) ** 2
            r = np.sqrt(self.S_scale * (1 / w**2 - 1))
        L = radial_factor(self.k, r * r)
        knots = np.arange(_KNOTS + 1)
        self.q = np.interp(knots, self._w((r * L) ** 2)[::-1], (1 / L)[::-1])
        self.q_step = np.diff(self.q, append=self.q[-1])
