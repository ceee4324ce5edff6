"""Points and lines of the projective plane P², and what maps leave alone."""

from functools import partial

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, ShapeError, equally_many, guarded
from cvnotes.projective.points import refuse_zero, vectors

_ROUNDING = 1e-15  # what is left of a determinant of unit vectors that should be 0

_point, _line = partial(vectors, what="point", d=3), partial(vectors, what="line", d=3)


def _as_many(**two: Array) -> None:
    equally_many(" and ".join(two), *(x.shape[:-1] for x in two.values()))


@guarded(a=_point, b=_point, also=_as_many)
def join(a: Array, b: Array) -> Array:
    """Return the line (..., 3) through two points of P², (..., 3) each: l = a × b.

    Raises
    ------
    DegenerateError
        The points coincide (up to a factor): many lines pass through them.

    References
    ----------
    .. [1] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 2.2.

    Examples
    --------
    >>> join([0, 0, 1], [1, 1, 1])  # y = x
    array([-1.,  1.,  0.])
    """
    line = np.cross(a, b)
    refuse_zero(line, (a, b), "the points coincide: many lines pass through them")
    return np.asarray(line) + 0.0


@guarded(k=_line, m=_line, also=_as_many)
def meet(k: Array, m: Array) -> Array:
    """Return the point (..., 3) that two lines of P² share: x = k × m.

    Parallel lines share a point at infinity, whose last coordinate is 0.

    Raises
    ------
    DegenerateError
        The lines coincide (up to a factor): they share all their points.

    Examples
    --------
    >>> meet([1, 0, -2], [1, 0, -3])  # x = 2 and x = 3: the point at infinity along y
    array([0., 1., 0.])
    """
    point = np.cross(k, m)
    refuse_zero(point, (k, m), "the lines coincide: they share all their points")
    return np.asarray(point) + 0.0


def cross_ratio(a: npt.ArrayLike, b: npt.ArrayLike, c: npt.ArrayLike, d: npt.ArrayLike) -> float:
    """Return the cross-ratio (a, b; c, d) of four collinear homogeneous points, (3,) or (4,) each.

    On a line with coordinate t it is (c − a)(d − b) / ((c − b)(d − a)); for d at infinity, the
    ratio (c − a)/(c − b). No projective map changes it.

    Raises
    ------
    DegenerateError
        The points are not collinear, or three of them coincide.

    References
    ----------
    .. [1] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 2.5.

    Examples
    --------
    >>> round(cross_ratio([0, 0, 1], [1, 0, 1], [2, 0, 1], [3, 0, 1]), 12)  # 2·2 / (1·3)
    1.333333333333
    """
    four = [vectors(x, name, "point") for x, name in zip((a, b, c, d), "abcd", strict=True)]
    if any(x.shape != four[0].shape or x.ndim != 1 for x in four):
        raise ShapeError(f"expected four points of one space, got {[x.shape for x in four]}")
    x = np.stack(four)
    x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    _, s, Vt = np.linalg.svd(x)
    if s[2] > 1e-9 * s[0]:
        raise DegenerateError("the four points do not lie on one line")
    t = x @ Vt[:2].T  # homogeneous coordinates on the line

    def det(i: int, j: int) -> float:
        value = float(t[i, 0] * t[j, 1] - t[i, 1] * t[j, 0])
        return value if abs(value) > _ROUNDING else 0.0

    above, below = det(0, 2) * det(1, 3), det(1, 2) * det(0, 3)
    if above == 0 and below == 0:
        raise DegenerateError("three of the four points coincide: their cross-ratio is 0/0")
    return above / below if below != 0 else float(np.inf)
