"""Lines and planes of projective space: what passes through what, at infinity too (notes 2b.1).

A line of P² is a vector (3,), a plane of P³ a vector (4,); a point x lies on it if their product
is 0. So points and lines (or planes) change roles freely: what joins two points also meets two
lines. A line of P³ is a skew matrix (4, 4) (Plücker). Everything is defined up to a factor.
"""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, CvnotesError, DegenerateError, ShapeError, matrix, numbers

LINE_AT_INFINITY = np.array([0.0, 0.0, 1.0])
PLANE_AT_INFINITY = np.array([0.0, 0.0, 0.0, 1.0])
LINE_AT_INFINITY.setflags(write=False)
PLANE_AT_INFINITY.setflags(write=False)

_ROUNDING = 2e-15  # relative size of what is left of a product that should be 0


def join(a: npt.ArrayLike, b: npt.ArrayLike) -> Array:
    """Give the line (..., 3) through two points of P², (..., 3) each: l = a × b.

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
    return _cross(a, b, ("a", "b"), "point", "the points coincide: many lines pass through them")


def meet(k: npt.ArrayLike, m: npt.ArrayLike) -> Array:
    """Give the point (..., 3) that two lines of P² share: x = k × m.

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
    return _cross(k, m, ("k", "m"), "line", "the lines coincide: they share all their points")


def plane_through(a: npt.ArrayLike, b: npt.ArrayLike, c: npt.ArrayLike) -> Array:
    """Give the plane (..., 4) through three points of P³, (..., 4) each.

    Raises
    ------
    DegenerateError
        The points lie on a line: many planes pass through them.

    Examples
    --------
    >>> plane_through([1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1])  # x + y + z = 1
    array([ 1.,  1.,  1., -1.])
    """
    why = "the points lie on a line: many planes pass through them"
    return _wedge((a, b, c), ("a", "b", "c"), "point", why)


def point_of_planes(p: npt.ArrayLike, q: npt.ArrayLike, r: npt.ArrayLike) -> Array:
    """Give the point (..., 4) that three planes of P³ share.

    Raises
    ------
    DegenerateError
        The planes share a whole line.

    Examples
    --------
    >>> point_of_planes([1, 0, 0, -2], [0, 1, 0, -3], [0, 0, 1, -4])  # x = 2, y = 3, z = 4
    array([2., 3., 4., 1.])
    """
    return -_wedge((p, q, r), ("p", "q", "r"), "plane", "the planes share a whole line") + 0.0


def line_through(a: npt.ArrayLike, b: npt.ArrayLike) -> Array:
    """Give the line of P³ through two points (..., 4), as L = a bᵀ − b aᵀ of shape (..., 4, 4).

    Raises
    ------
    DegenerateError
        The points coincide.

    References
    ----------
    .. [1] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 3.2.2.

    Examples
    --------
    >>> z_axis = line_through([0, 0, 0, 1], [0, 0, 5, 1])
    >>> meet_plane(z_axis, PLANE_AT_INFINITY)  # its direction
    array([ 0.,  0., -5.,  0.])
    """
    why = "the points coincide: many lines pass through them"
    return _plucker(a, b, ("a", "b"), "point", why)


def line_of_planes(p: npt.ArrayLike, q: npt.ArrayLike) -> Array:
    """Give the line of P³ that two planes (..., 4) share, as a matrix L (..., 4, 4).

    Parallel planes share a line at infinity.

    Raises
    ------
    DegenerateError
        The planes coincide.

    Examples
    --------
    >>> z_axis = line_of_planes([1, 0, 0, 0], [0, 1, 0, 0])
    >>> meet_plane(z_axis, [0, 0, 1, -7])
    array([ 0.,  0., -7., -1.])
    """
    why = "the planes coincide: they share all their points"
    return dual(_plucker(p, q, ("p", "q"), "plane", why))


def dual(L: npt.ArrayLike) -> Array:
    """Turn a line given by points into the same line given by planes, and back.

    Examples
    --------
    >>> L = line_through([0, 0, 0, 1], [0, 0, 5, 1])
    >>> bool((dual(dual(L)) == L).all())
    True
    """
    L = matrix(L, "L", 4, 4)
    D = np.zeros_like(L)
    for (i, j), (k, m) in (((0, 1), (2, 3)), ((0, 2), (3, 1)), ((0, 3), (1, 2))):
        D[..., i, j], D[..., k, m] = L[..., k, m], L[..., i, j]
    return D - D.mT


def meet_plane(L: npt.ArrayLike, p: npt.ArrayLike) -> Array:
    """Give the point (..., 4) where a line L of P³ meets a plane (..., 4): x = L p.

    Raises
    ------
    DegenerateError
        The line lies in the plane.

    Examples
    --------
    >>> L = line_through([1, 2, 0, 1], [1, 2, 1, 1])
    >>> meet_plane(L, [0, 0, 1, -9])
    array([1., 2., 9., 1.])
    """
    return _apply(matrix(L, "L", 4, 4), p, "plane", "the line lies in the plane")


def join_point(L: npt.ArrayLike, x: npt.ArrayLike) -> Array:
    """Give the plane (..., 4) through a line L of P³ and a point (..., 4): p = L* x.

    Raises
    ------
    DegenerateError
        The point lies on the line.

    Examples
    --------
    >>> z_axis = line_through([0, 0, 0, 1], [0, 0, 1, 1])
    >>> join_point(z_axis, [3, 0, 0, 1])  # y = 0
    array([0., 3., 0., 0.])
    """
    return _apply(dual(L), x, "point", "the point lies on the line: many planes contain both")


def lies_on(x: npt.ArrayLike, line: npt.ArrayLike, atol: float = 1e-12) -> npt.NDArray[np.bool_]:
    """Tell whether points (..., d) lie on lines or planes (..., d), whatever their factors.

    Both are scaled to unit length, so `atol` is the cosine of an angle, not a distance.

    Examples
    --------
    >>> lies_on([[1, 1, 1], [1, 2, 1]], [1, -1, 0])
    array([ True, False])
    """
    x, line = _vectors(x, "x", "point"), _vectors(line, "line", "line or plane")
    if x.shape[-1] != line.shape[-1]:
        raise ShapeError(f"x {x.shape} and line {line.shape} are not of one space")
    cosine = (x * line).sum(-1) / (np.linalg.norm(x, axis=-1) * np.linalg.norm(line, axis=-1))
    return np.asarray(np.abs(cosine) <= atol)


def map_lines(H: npt.ArrayLike, lines: npt.ArrayLike) -> Array:
    """Map lines of P² (..., 3), or planes of P³ (..., 4), where H maps points: l' = H⁻ᵀ l.

    So l'ᵀ x' = lᵀ H⁻¹ H x = 0 wherever lᵀ x = 0: incidence stays.

    Raises
    ------
    DegenerateError
        H is singular: it maps some lines to points.

    References
    ----------
    .. [1] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 2.3.

    Examples
    --------
    >>> map_lines([[1, 0, 5], [0, 1, 0], [0, 0, 1]], [1, 0, 0])  # x = 0 becomes x = 5
    array([ 1.,  0., -5.])
    """
    lines = _vectors(lines, "lines", "line or plane")
    H = matrix(H, "H", lines.shape[-1], lines.shape[-1])
    try:
        return np.asarray(np.linalg.solve(H.mT, lines[..., None])[..., 0]) + 0.0
    except np.linalg.LinAlgError:
        raise DegenerateError("H is singular: it maps some lines to points") from None


def cross_ratio(a: npt.ArrayLike, b: npt.ArrayLike, c: npt.ArrayLike, d: npt.ArrayLike) -> float:
    """Give the cross-ratio (a, b; c, d) of four collinear homogeneous points, (3,) or (4,) each.

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
    x = np.stack([_vectors(x, name, "point") for x, name in zip((a, b, c, d), "abcd", strict=True)])
    x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    _, s, Vt = np.linalg.svd(x)
    if s[2] > 1e-9 * s[0]:
        raise DegenerateError("the four points do not lie on one line")
    t = x @ Vt[:2].T  # homogeneous coordinates on the line

    def det(i: int, j: int) -> float:
        return float(t[i, 0] * t[j, 1] - t[i, 1] * t[j, 0])

    above, below = det(0, 2) * det(1, 3), det(1, 2) * det(0, 3)
    if abs(above) <= 1e-14 and abs(below) <= 1e-14:
        raise DegenerateError("three of the four points coincide: their cross-ratio is 0/0")
    return above / below if below != 0 else float(np.inf)


def _vectors(x: npt.ArrayLike, name: str, what: str, d: int | None = None) -> Array:
    """Guard homogeneous vectors; factors that would make products overflow are taken out."""
    x = numbers(x, name)
    wanted = "(..., 3) or (..., 4)" if d is None else f"(..., {d})"
    if x.ndim == 0 or x.shape[-1] not in ((3, 4) if d is None else (d,)):
        raise ShapeError(f"{name}: expected homogeneous coordinates {wanted}, got {x.shape}")
    largest = np.abs(x).max(axis=-1, keepdims=True, initial=0.0)
    if (largest == 0).any():
        raise CvnotesError(f"{name}: the zero vector is not a {what}")
    exponent = np.frexp(largest)[1]
    return np.asarray(np.ldexp(x, np.where(np.abs(exponent) > 200, -exponent, 0)))


def _cross(
    a: npt.ArrayLike, b: npt.ArrayLike, names: tuple[str, str], what: str, why: str
) -> Array:
    a, b = (_vectors(x, name, what, 3) for x, name in zip((a, b), names, strict=True))
    product = np.cross(a, b)
    _refuse_zero(product, np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1), why)
    return np.asarray(product) + 0.0


def _plucker(
    a: npt.ArrayLike, b: npt.ArrayLike, names: tuple[str, str], what: str, why: str
) -> Array:
    a, b = (_vectors(x, name, what, 4) for x, name in zip((a, b), names, strict=True))
    L = a[..., :, None] * b[..., None, :]
    L = L - L.mT
    size = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
    _refuse_zero(L.reshape(*L.shape[:-2], 16), size, why)
    return np.asarray(L)


def _wedge(
    vectors: tuple[npt.ArrayLike, ...], names: tuple[str, ...], what: str, why: str
) -> Array:
    """Give the vector (..., 4) that is orthogonal to three: the cross product of P³."""
    given = [_vectors(x, name, what, 4) for x, name in zip(vectors, names, strict=True)]
    M = np.stack(np.broadcast_arrays(*given), axis=-2)
    minors = [(-1) ** i * np.linalg.det(np.delete(M, i, axis=-1)) for i in range(4)]
    product = np.stack(minors, axis=-1)
    _refuse_zero(product, np.prod(np.linalg.norm(M, axis=-1), axis=-1), why)
    return product + 0.0


def _apply(L: Array, x: npt.ArrayLike, what: str, why: str) -> Array:
    x = _vectors(x, what, what, 4)
    product = (L @ x[..., None])[..., 0]
    _refuse_zero(product, np.linalg.norm(L, axis=(-2, -1)) * np.linalg.norm(x, axis=-1), why)
    return np.asarray(product) + 0.0


def _refuse_zero(product: Array, size: Array, why: str) -> None:
    if (np.linalg.norm(product, axis=-1) <= _ROUNDING * size).any():
        raise DegenerateError(why)
