"""Polynomials of the radius."""

from collections.abc import Sequence

import numpy as np

from cvnotes.errors import Array


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
