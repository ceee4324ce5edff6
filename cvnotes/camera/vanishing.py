"""Vanishing points and horizons: found in a picture, and the camera they give away (notes 2b.1)."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    DegenerateError,
    ShapeError,
    levenberg_marquardt,
    matrix,
    points,
    solve_dense,
)
from cvnotes.camera.model import Camera, intrinsics
from cvnotes.projective import to_homogeneous
from cvnotes.projective.points import apply_similarity, normaliser


def vanishing_point(segments: npt.ArrayLike) -> Array:
    """Find where several noisy pictures of parallel segments meet.

    Parameters
    ----------
    segments : array_like, shape (n, 2, 2)
        Both end points (u, v) of at least two segments, in pixels.

    Returns
    -------
    ndarray, shape (3,)
        The vanishing point, homogeneous, of unit length; its last coordinate is not negative, and
        (nearly) 0 where the segments are parallel in the picture too.

    Raises
    ------
    DegenerateError
        Fewer than two segments, one without length, or all on one line.

    Notes
    -----
    Minimises the distances in pixels of the end points to the line through the segment's middle
    and the vanishing point, by Levenberg-Marquardt. Nothing else would be fair to segments of
    different lengths. It starts from the point v that minimises Σ (lᵢᵀ v)² over the segments'
    lines lᵢ, found by SVD. Segments of another direction are not recognised: sort them before.

    References
    ----------
    .. [1] Notes 2b.1, "Vanishing points in projective coordinates".
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 8.6.1.

    Examples
    --------
    >>> rails = [[[200, 479], [300, 279]], [[500, 479], [380, 279]]]
    >>> v = vanishing_point(rails)
    >>> (v[:2] / v[2]).round(6)
    array([336.363636, 206.272727])
    """
    ends = points(segments, "segments", 2)
    if ends.ndim != 3 or ends.shape[1] != 2:
        raise ShapeError(f"segments: expected shape (n, 2, 2), got {ends.shape}")
    if len(ends) < 2:
        raise DegenerateError(f"need at least 2 segments, got {len(ends)}")
    if (ends[:, 0] == ends[:, 1]).all(axis=1).any():
        raise DegenerateError("a segment has no length: its end points coincide")
    N = normaliser.inside(ends.reshape(-1, 2))
    a, b = (to_homogeneous.inside(apply_similarity(N, x)) for x in ends.swapaxes(0, 1))
    # 1. closest to all lines, algebraically
    lines = np.cross(a, b)
    _, s, Vt = np.linalg.svd(lines)
    if s[1] <= 1e-9 * s[0]:
        raise DegenerateError("all segments lie on one line; any of its points could be meant")
    # 2. closest to all end points, in pixels
    middle = (a + b) / 2
    v = levenberg_marquardt(
        Vt[2],
        lambda v: _linearise(v, a, middle),
        solve_dense,
        lambda v, step: _unit(v + _tangents(v) @ step),
        floor=1e-24,
    ).x
    v = _unit(np.linalg.solve(N, v))
    return v if v[2] >= 0 else -v


def horizon(camera: Camera, normal: npt.ArrayLike) -> Array:
    """Return the line (3,) in which the picture shows the far end of planes with a normal (3,).

    l ≈ A⁻ᵀ R n, of unit normal (l1, l2) if it is not itself at infinity; n is in the WRF. It
    contains the vanishing points of all directions in the plane.

    References
    ----------
    .. [1] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 8.6.2.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> horizon(Camera(intrinsics(800, 800, 320, 240)), [0, 1, 0])  # v = 240
    array([   0.,    1., -240.])
    """
    n = points(normal, "normal", 3)
    if n.ndim != 1 or not n.any():
        raise DegenerateError("normal: expected one direction (3,) that is not zero")
    return _unit_line(
        np.asarray(np.linalg.solve(camera.A.T, camera.R @ _unit(n / np.abs(n).max())))
    )


def _linearise(v: Array, end: Array, middle: Array) -> tuple[float, Array]:
    """Return the cost and [J r]ᵀ[J r] of the ends' distances to the lines from the middles to v."""
    n = np.cross(middle, end)
    line = np.cross(v, middle)
    length = np.hypot(line[:, 0], line[:, 1])
    r = n @ v / length
    # d(line) = dv × middle, of which the first two components change the length
    x, y, w = middle.T
    p, q = line[:, 0] / length, line[:, 1] / length
    d_length = np.stack([-q * w, p * w, q * x - p * y], axis=1)
    J = (n - r[:, None] * d_length) / length[:, None]
    Jr = np.column_stack([J @ _tangents(v), r])
    return float(r @ r), Jr.T @ Jr


def _tangents(v: Array) -> Array:
    """Return two unit directions (3, 2) in which a unit vector can move."""
    return np.linalg.svd(v[None])[2][1:].T


def _unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v)) + 0.0


def _unit_line(line: Array) -> Array:
    """Scale a line such that its product with a pixel is a distance, if it is not at infinity."""
    length = np.hypot(line[0], line[1])
    far = length <= 1e-15 * np.abs(line).max()
    return np.asarray(line / (np.abs(line).max() if far else length)) + 0.0


def focal_length(v1: npt.ArrayLike, v2: npt.ArrayLike, centre: npt.ArrayLike) -> float:
    """Return the focal length in pixels from two vanishing points (2,) of orthogonal directions.

    Parameters
    ----------
    v1, v2 : array_like, shape (2,)
        The vanishing points, in pixels.
    centre : array_like, shape (2,)
        The principal point; for an uncropped picture its middle is a fair guess.

    Raises
    ------
    DegenerateError
        No focal length makes the two directions orthogonal.

    Notes
    -----
    Square pixels without skew: the rays (v1 − c, f) and (v2 − c, f) are orthogonal, so
    f² = −(v1 − c)ᵀ(v2 − c). Seen from c the two points lie on opposite sides.

    References
    ----------
    .. [1] B. Caprile and V. Torre, Int. J. Computer Vision 4 (1990) 127-139.

    Examples
    --------
    >>> focal_length([1120, 240], [-480, 240], centre=(320, 240))
    800.0
    """
    v1, v2, c = (points(x, name, 2) for x, name in ((v1, "v1"), (v2, "v2"), (centre, "centre")))
    if not v1.ndim == v2.ndim == c.ndim == 1:
        raise ShapeError("v1, v2 and centre: expected one pixel (2,) each")
    f2 = -float((v1 - c) @ (v2 - c))
    if f2 <= 0:
        raise DegenerateError(
            "seen from the centre, the two vanishing points are less than 90° apart: no camera "
            "sees orthogonal directions there (a wrong centre, or lines that are not orthogonal?)"
        )
    return float(np.sqrt(f2))


def intrinsics_from_vanishing_points(v: npt.ArrayLike) -> Array:
    """Find A (3, 3) from the vanishing points (3, 2) of three orthogonal directions.

    Raises
    ------
    DegenerateError
        The three points lie on a line, one is at infinity, or their triangle has an angle of 90°
        or more.

    Notes
    -----
    Square pixels without skew. The rays to the three points are orthogonal in pairs, so
    (v1 − c)ᵀ(v2 − v3) = 0 and so on: the principal point c is where the altitudes of the triangle
    meet, its orthocentre. A vanishing point at infinity leaves c undetermined; guess it, and use
    `focal_length`.

    References
    ----------
    .. [1] B. Caprile and V. Torre, Int. J. Computer Vision 4 (1990) 127-139.
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 8.8.

    Examples
    --------
    >>> s, c = 800 * np.sqrt(1.5), 800 * np.sqrt(0.5)
    >>> v = np.array([[s, c], [-s, c], [0, -2 * c]]) + [320, 240]  # a cube seen corner on
    >>> intrinsics_from_vanishing_points(v).round(9)
    array([[800.,   0., 320.],
           [  0., 800., 240.],
           [  0.,   0.,   1.]])
    """
    if isinstance(v, np.ndarray) and v.dtype.kind == "f" and np.isnan(v).any():
        raise DegenerateError(
            "v contains NaN or infinite values: edges that are parallel in the picture meet at "
            "infinity; tilt the camera until no edge is parallel to the sensor"
        )
    v = matrix(v, "v", 3, 2)
    if v.ndim != 2:
        raise ShapeError(f"v: expected three pixels (3, 2), got {v.shape}")
    middle = v.mean(axis=0)
    v1, v2, v3 = v - middle
    D = np.stack([v2 - v3, v3 - v1])
    size = np.linalg.norm(D, axis=1).prod()
    if abs(np.linalg.det(D)) <= 1e-12 * size or size == 0:
        raise DegenerateError("the three vanishing points lie on a line: they fix no camera")
    c = np.linalg.solve(D, [v1 @ (v2 - v3), v2 @ (v3 - v1)])
    if (v1 - c) @ (v2 - c) >= 0 or (v2 - c) @ (v3 - c) >= 0 or (v3 - c) @ (v1 - c) >= 0:
        raise DegenerateError(
            "the triangle of the vanishing points has an angle of 90° or more: the three "
            "directions are not orthogonal, or the lens was not taken out"
        )
    f = focal_length(v1, v2, c)
    return intrinsics(f, f, *(c + middle))
