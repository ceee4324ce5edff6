"""Vanishing points and horizons found in a picture."""

import numpy as np
import numpy.typing as npt

from cvnotes.camera import Camera
from cvnotes.errors import Array, DegenerateError, ShapeError, matrix, points
from cvnotes.incidence import join
from cvnotes.optimise import levenberg_marquardt, solve_dense


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
    lines lᵢ, found by SVD.

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
    N = _normaliser(ends.reshape(-1, 2))
    a, b = (np.concatenate([x, np.ones((len(x), 1))], axis=1) @ N.T for x in ends.swapaxes(0, 1))
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
    """Give the line (3,) in which the picture shows the far end of planes with a normal (3,).

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


def horizon_from_vanishing_points(v_h: npt.ArrayLike) -> Array:
    """Give the line (3,) closest to homogeneous vanishing points (n, 3) of one plane.

    Two points are joined; with more, Σ (lᵀ vᵢ)² over points of unit length in normalised pixels is
    minimised.

    Examples
    --------
    >>> horizon_from_vanishing_points([[100, 240, 1], [900, 240, 1]])
    array([   0.,    1., -240.])
    """
    v = matrix(v_h, "v_h", 3)
    if v.ndim != 2 or len(v) < 2:
        raise ShapeError(f"v_h: expected at least two points (n, 3), got {v.shape}")
    if len(v) == 2:
        return _unit_line(join(*v))
    finite = v[v[:, 2] != 0]
    N = _normaliser(finite[:, :2] / finite[:, 2:]) if len(finite) > 1 else np.eye(3)
    v = v @ N.T
    _, s, Vt = np.linalg.svd(v / np.linalg.norm(v, axis=1, keepdims=True))
    if s[1] <= 1e-12 * s[0]:
        raise DegenerateError("the vanishing points coincide: many lines pass through them")
    return _unit_line(N.T @ Vt[2])


def _linearise(v: Array, end: Array, middle: Array) -> tuple[float, Array]:
    """Give the cost and [J r]ᵀ[J r] of the ends' distances to the lines from the middles to v."""
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
    """Give two unit directions (3, 2) in which a unit vector can move."""
    return np.linalg.svd(v[None])[2][1:].T


def _normaliser(m: Array) -> Array:
    """Give the similarity (3, 3) that brings pixels (n, 2) around 0, at a distance of about 1."""
    centre = m.mean(axis=0)
    spread = np.sqrt(((m - centre) ** 2).sum(axis=1).mean())
    scale = 1 / spread if spread > 0 else 1.0
    return np.array([[scale, 0, -scale * centre[0]], [0, scale, -scale * centre[1]], [0, 0, 1]])


def _unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v)) + 0.0


def _unit_line(line: Array) -> Array:
    """Scale a line such that its product with a pixel is a distance, if it is not at infinity."""
    length = np.hypot(line[0], line[1])
    far = length <= 1e-15 * np.abs(line).max()
    return np.asarray(line / (np.abs(line).max() if far else length)) + 0.0
