"""Maps of the plane: homography, rotation, zoom, and the plane that a camera sees."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, DegenerateError, ShapeError, matrix, number, points
from cvnotes.warping.pixel_map import PixelMap


def homography_map(H: npt.ArrayLike) -> PixelMap:
    """Map pixels by a homography H (3, 3): s m̃' = H m̃.

    Raises
    ------
    DegenerateError
        H is singular, so that it maps the picture to a line or a point.

    References
    ----------
    .. [1] Notes 2b.5, "Removal of perspective deformation", whose left side lacks its 1 (E39).

    Examples
    --------
    >>> homography_map([[1, 0, 10], [0, 1, 20], [0, 0, 1]])([1, 2])
    array([11., 22.])
    """
    H = matrix(H, "H", 3, 3)
    if H.ndim != 2:
        raise ShapeError(f"H: expected one (3, 3) matrix, got {H.shape}")
    # Scaling rows and columns to size 1 first: pixels and tilts differ by orders of magnitude.
    with np.errstate(all="ignore"):
        balanced = H / np.abs(H).max(axis=0)
        balanced = balanced / np.abs(balanced).max(axis=1, keepdims=True)
        determined = np.isfinite(balanced).all() and np.linalg.cond(balanced) < 1e13
    if not determined:
        raise DegenerateError("H is singular: it maps the picture to a line or a point")

    if (H[2] == [0, 0, 1]).all():  # affine: every third coordinate is 1
        return PixelMap(lambda m_h: np.asarray(H[:2] @ m_h))

    def columns(m_h: Array) -> Array:
        x_h = H @ m_h
        x_h[:2] /= x_h[2]
        return np.asarray(x_h[:2])

    return PixelMap(columns)


def rotation_map(angle: float, centre: npt.ArrayLike = (0, 0)) -> PixelMap:
    """Rotate pixels by an angle in radians about a centre (u, v).

    (u', v') = R (u, v) with R = [cos θ  −sin θ; sin θ  cos θ], as in the notes. Since v points
    down, a positive angle turns clockwise on the screen (erratum E38). For a backward warp take
    the negative angle: it is asked where a pixel comes from.

    Examples
    --------
    >>> rotation_map(np.pi / 2, centre=(10, 10))([20, 10]).round(9)
    array([10., 20.])
    """
    angle = number(angle, "angle")
    c, s = np.cos(angle), np.sin(angle)
    return _about(np.array([[c, -s], [s, c]]), centre)


def zoom_map(factor: float, centre: npt.ArrayLike = (-0.5, -0.5)) -> PixelMap:
    """Move pixels away from a centre (u, v) by a factor; for a backward warp take its reciprocal.

    The default centre is the picture's outer corner, so that a picture of twice the size, zoomed
    by two, shows the same.

    Examples
    --------
    >>> zoom_map(2)([0, 0])  # the middle of the 2 × 2 pixels that pixel (0, 0) turns into
    array([0.5, 0.5])
    """
    factor = number(factor, "factor")
    if factor <= 0:
        raise CvnotesError(f"factor: expected a positive number, got {factor:g}")
    return _about(factor * np.eye(2), centre)


def plane_map(H: npt.ArrayLike, corner: npt.ArrayLike, pixel: float) -> PixelMap:
    """Map the pixels of a plane's own picture to the pixels of a camera's picture of the plane.

    Parameters
    ----------
    H : array_like, shape (3, 3)
        Homography picture ← plane, as `cvnotes.homography.dlt` gives it.
    corner : (X, Y)
        The point of the plane in the new picture's outer top-left corner.
    pixel : float
        Side of a new pixel on the plane, in the plane's unit.

    Examples
    --------
    >>> plane_map(np.eye(3), corner=(100, 50), pixel=2)([0, 0])  # its centre is half a pixel in
    array([101.,  51.])
    """
    pixel = number(pixel, "pixel")
    if pixel <= 0:
        raise CvnotesError(f"pixel: expected a positive side, got {pixel:g}")
    X, Y = _one_point(corner, "corner") + 0.5 * pixel
    return homography_map(matrix(H, "H", 3, 3) @ [[pixel, 0, X], [0, pixel, Y], [0, 0, 1]])


def _about(M: Array, centre: npt.ArrayLike) -> PixelMap:
    """Apply M (2, 2) about a centre that stays where it is."""
    c = _one_point(centre, "centre")
    H = np.eye(3)
    H[:2, :2], H[:2, 2] = M, c - M @ c
    return homography_map(H)


def _one_point(x: npt.ArrayLike, name: str) -> Array:
    x = points(x, name, 2)
    if x.ndim != 1:
        raise ShapeError(f"{name}: expected one point (2,), got {x.shape}")
    return x
