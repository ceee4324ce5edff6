"""The way back through a lens: a search for one number (notes 2b.3)."""

from collections.abc import Sequence

import numpy as np

from cvnotes.base import Array, chunks
from cvnotes.camera.lens_fold import fold_radius, radial_factor

# Knots of the table that Newton's method starts from; more of them would only save steps.
_KNOTS = 4096
# Points at a time: the dozen temporaries then stay in the cache.
_CHUNK = 12288


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
        """Give x = (q/n) (d − r² p), NaN beyond the fold."""
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
        """Give f = left − right and its slope q df/dq; e = p·d.

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
