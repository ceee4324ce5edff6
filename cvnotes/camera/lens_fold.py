"""Where a lens folds the picture over: its polynomial L(r), and the largest valid radius."""

from collections.abc import Sequence
from functools import reduce

import numpy as np

from cvnotes.base import Array


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
    """Give L = 1 + k1 r² + k2 r⁴ + … as a function of r².

    Examples
    --------
    >>> radial_factor((-0.25,), np.array([0.0, 1.0]))
    array([1.  , 0.75])
    """
    return horner((1.0, *k), r2)


# Radii beyond this are infinite for our purpose: a ray 0.0001 degrees before 90.
_INFINITE = 1e6


def fold_radius(k: Sequence[float], p_norm: float = 0.0) -> float:
    """Give the smallest ideal radius at which the picture folds over; inf if there is none.

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
    """Give the smallest eigenvalue of the Jacobian on a circle, by `fold_radius`'s formulas."""
    L, a = (_value(curve, r * r) for curve in curves)
    m = 4 * p_norm * r
    if 2 * m < 3 * a < 6 * m:
        return L - a / 8 - m**2 / (2 * a)
    return min(L + a - 1.5 * m, L - m / 2)


def _positive_roots(ascending: Array, beyond: float) -> list[float]:
    """Give the positive roots of a polynomial, up to `beyond`, polished by a step of Newton's."""
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
