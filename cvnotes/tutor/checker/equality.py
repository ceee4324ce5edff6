"""When two answers are equal, as mathematics has it: (answer, right, tolerance) → bool."""

from collections.abc import Callable
from typing import Any

import numpy as np

from cvnotes.base import Array

Same = Callable[[Array, Array, float], bool]

TOLERANCE = 1e-6
# A slip repeats a mistake to the last digits; what merely comes near is another one.
AS_NEAR = 0.01
# Single precision is a fair choice; its rounding must not count as a mistake.
_SINGLE = 200.0


def slack(dtype: str) -> float:
    """Return how many times wider every bound is for numbers of a type.

    Examples
    --------
    >>> slack("float64"), slack("float32")
    (1.0, 200.0)
    """
    return _SINGLE if dtype == "float32" else 1.0


def tolerance(dtype: str) -> float:
    """Return by how much numbers may differ that were of a type.

    Examples
    --------
    >>> tolerance("float64")
    1e-06
    """
    return TOLERANCE * slack(dtype)


def of_size_one(x: Array) -> Array:
    """Scale an array so that its largest entry is 1 or −1, whatever it was; 0 stays 0.

    Examples
    --------
    >>> of_size_one(np.array([-1e308, 5e307]))
    array([-1. ,  0.5])
    """
    largest = np.abs(x).max(initial=0.0)
    return x / largest if 0 < largest < np.inf else x


def disturbed(x: Array | float) -> Array:
    """Return other numbers, which are others up to a factor and a sign, too; of counts larger ones.

    Examples
    --------
    >>> disturbed(np.array([1.0, -2.0])), disturbed(5)
    (array([ 1.6, -4.9]), array(12))
    """
    x = np.asarray(x)
    if x.dtype.kind in "iu":
        return np.asarray(x + 7)
    return np.asarray(x * np.linspace(1.5, 2.5, x.size).reshape(x.shape) + 0.1)


def close(answer: Array, right: Array, tolerance: float) -> bool:
    """Return whether two answers are equal, relative to their largest entry; NaN equals NaN.

    Examples
    --------
    >>> close(np.array([1.0, np.nan]), np.array([1.0, np.nan]), 1e-6)
    True
    """
    finite = np.isfinite(right)
    if answer.shape != right.shape or not np.array_equal(np.isfinite(answer), finite):
        return False
    if not finite.all():
        if not np.array_equal(answer[~finite], right[~finite], equal_nan=True):
            return False
        answer, right = answer[finite], right[finite]
    scale = float(np.abs(right).max(initial=0.0)) or 1e-3
    return bool((np.abs(answer - right) <= tolerance * scale).all())


def close_to(bound: float) -> Same:
    """Compare as `close` does, to a bound of its own.

    Examples
    --------
    >>> close_to(1e-8)(np.array([1.0]), np.array([1.0 + 1e-7]), TOLERANCE)
    False
    """
    return lambda answer, right, tolerance: close(answer, right, bound * tolerance / TOLERANCE)


def same_motion(answer: Array, right: Array, tolerance: float) -> bool:
    """Return whether two motions (4, 4) are equal: rotations to their size, translations to theirs.

    Examples
    --------
    >>> G = np.eye(4)
    >>> G[2, 3] = 700.0
    >>> same_motion(G + 1e-5, G, 1e-6), close(G + 1e-5, G, 1e-6)
    (False, True)
    """
    if answer.shape != right.shape or answer.ndim != 2:
        return False
    return close(answer[:, :3], right[:, :3], tolerance) and close(
        answer[:, 3:], right[:, 3:], tolerance
    )


def up_to_scale(answer: Array, right: Array, tolerance: float) -> bool:
    """Return whether two arrays differ only by a factor.

    Examples
    --------
    >>> up_to_scale(np.array([2.0, 4.0]), np.array([-1.0, -2.0]), 1e-6)
    True
    """
    if answer.shape != right.shape or not (np.isfinite(answer).all() and np.isfinite(right).all()):
        return False
    a, b = of_size_one(answer), of_size_one(right)
    norms = np.linalg.norm(a), np.linalg.norm(b)
    if min(norms) == 0:
        return bool(max(norms) == 0)
    a, b = a / norms[0], b / norms[1]
    return bool(min(np.abs(a - b).max(), np.abs(a + b).max()) <= tolerance)


def up_to_signs(answer: Array, right: Array, tolerance: float) -> bool:
    """Return whether two arrays differ only by a factor and by the signs of their entries.

    Each singular vector has a sign of its own, so a column that cuts across them has many.

    Examples
    --------
    >>> up_to_signs(np.array([2.0, -4.0]), np.array([1.0, 2.0]), 1e-6)
    True
    """
    return up_to_scale(np.abs(answer), np.abs(right), tolerance)


def within(distance: float) -> Same:
    """Compare numbers that were read off: equal if no farther apart than a distance.

    Examples
    --------
    >>> within(10.0)(np.array([320.0, 96.0]), np.array([325.0, 92.0]), 1e-6)
    True
    """
    return lambda answer, right, _: _no_farther(answer, right, distance)


def within_part(part: float) -> Same:
    """Compare quantities that were read off: equal if no farther apart than a part of the size.

    Examples
    --------
    >>> within_part(0.05)(np.array(9600.0), np.array(10_000.0), 1e-6)
    True
    """
    return lambda answer, right, _: _no_farther(answer, right, part * np.linalg.norm(right))


def _no_farther(answer: Array, right: Array, most: Any) -> bool:
    return answer.shape == right.shape and bool(np.linalg.norm(answer - right) <= most)
