"""Maps from pixels to pixels: rotation, zoom, homography, plane, and their composition."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.errors import (
    Array,
    CvnotesError,
    DegenerateError,
    InputTypeError,
    ShapeError,
    image_size,
    matrix,
    numbers,
    points,
)
from cvnotes.interpolate import positions

# Pixels mapped at a time: a dozen arrays of them stay in the cache.
TILE = 20_000
# A size that is certainly a slip; it would not fit into the memory either.
_TOO_MANY_PIXELS = 2**30


@dataclass(frozen=True)
class PixelMap:
    """A map (u, v) ↦ (f_u, f_v), called with pixels (..., 2) and giving as many.

    Parameters
    ----------
    columns : callable
        The map as the warps use it: homogeneous pixels (3, n), whose rows are u, v and 1, to
        pixels (2, n). What has no image becomes NaN or infinite.

    Notes
    -----
    Any function from (..., 2) to (..., 2), and any array (height, width, 2), is a map too; this
    class only spares the warps the rearranging.

    Examples
    --------
    >>> mirror = PixelMap(lambda m_h: np.stack([639 - m_h[0], m_h[1]]))
    >>> mirror([[0, 5], [639, 5]])
    array([[639.,   5.],
           [  0.,   5.]])
    """

    columns: Callable[[Array], Array]

    def __call__(self, m: npt.ArrayLike) -> Array:
        """Map pixels (..., 2); rows without an image are NaN."""
        m = points(m, "m", 2)
        with np.errstate(all="ignore"):
            mapped = self.columns(homogeneous_columns(*m.reshape(-1, 2).T)).T
        mapped[~np.isfinite(mapped).all(axis=1)] = np.nan
        return mapped.reshape(m.shape)


Mapping = PixelMap | Callable[[Any], npt.ArrayLike] | Array


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
    c, s = np.cos(numbers(angle, "angle")), np.sin(numbers(angle, "angle"))
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
    if not numbers(factor, "factor") > 0:
        raise CvnotesError(f"factor: expected a positive number, got {factor:g}")
    return _about(float(factor) * np.eye(2), centre)


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
    if not numbers(pixel, "pixel") > 0:
        raise CvnotesError(f"pixel: expected a positive side, got {pixel:g}")
    X, Y = _one_point(corner, "corner") + 0.5 * pixel
    return homography_map(matrix(H, "H", 3, 3) @ [[pixel, 0, X], [0, pixel, Y], [0, 0, 1]])


def compose(*maps: Mapping) -> PixelMap:
    """Compose maps as they are written: compose(f, g) maps m to f(g(m)), exactly.

    One backward warp by compose(f, g) is better than a warp by f and then by g: the picture is
    interpolated once. Arrays cannot be composed, since they are known at whole pixels only.

    Examples
    --------
    >>> compose(zoom_map(2, (0, 0)), rotation_map(np.pi))([3, 4]).round(9)
    array([-6., -8.])
    """
    if not maps:
        raise CvnotesError("compose needs at least one map")
    if any(isinstance(f, np.ndarray) for f in maps):
        raise InputTypeError("compose: arrays are known at whole pixels only; compose functions")
    *outer, columns = (columns_of(f) for f in maps)

    def composed(m_h: Array) -> Array:
        m = columns(m_h)
        for f in reversed(outer):
            m = f(homogeneous_columns(*m))
        return m

    return PixelMap(composed)


def map_array(mapping: Mapping, size: tuple[int, int]) -> Array:
    """Tabulate a map for every pixel of a picture of (width, height): (height, width, 2).

    For OpenCV: ``cv2.remap(image, map_array(f, size).astype(np.float32), None, ...)``.

    Examples
    --------
    >>> map_array(zoom_map(0.5), (640, 480))[0, 1]
    array([ 0.25, -0.25])
    """
    width, height = target_size(size)
    table = np.empty((2, height * width))
    for part, m in tiles(mapping, (width, height)):
        table[:, part] = m
    return np.moveaxis(table.reshape(2, height, width), 0, -1)


def tiles(mapping: Mapping, size: tuple[int, int]) -> Iterator[tuple[slice, Array]]:
    """Map a picture's pixels, some rows at a time: slices of the flat picture, pixels (2, n).

    The pixels belong to whoever asked for them and may be written over.
    """
    width, height = size
    rows = max(1, TILE // width)
    table = None if callable(mapping) else _checked_array(mapping, size)
    columns = columns_of(mapping) if table is None else None
    m_h = homogeneous_columns(np.tile(np.arange(width), rows), np.repeat(np.arange(rows), width))
    for first in range(0, height, rows):
        part = slice(first * width, min(first + rows, height) * width)
        if table is not None:
            m = table[part].T.copy()
        elif columns is not None:
            with np.errstate(all="ignore"):  # what has no image becomes NaN in silence
                m = columns(m_h[:, : part.stop - part.start])
        own = m.flags.c_contiguous and not np.may_share_memory(m, m_h)
        yield part, np.array(m, dtype=np.float64, order="C", copy=None if own else True)
        m_h[1] += rows


def columns_of(mapping: Mapping) -> Callable[[Array], Array]:
    """Give a map as a function from homogeneous columns (3, n) to columns (2, n)."""
    if isinstance(mapping, PixelMap):
        return mapping.columns
    if not callable(mapping):
        raise InputTypeError(f"expected a map, got {type(mapping).__name__}")

    def columns(m_h: Array) -> Array:
        m = positions(mapping(m_h[:2].T.copy()), "what the map gives")
        if m.shape != (m_h.shape[1], 2):
            raise ShapeError(f"the map turned pixels {m_h[:2].T.shape} into {m.shape}")
        return m.T

    return columns


def homogeneous_columns(u: npt.ArrayLike, v: npt.ArrayLike) -> Array:
    """Put u (n,) and v (n,) above a row of ones."""
    u = np.asarray(u)
    return np.stack([u, v, np.ones(u.shape)])


def target_size(size: Any) -> tuple[int, int]:
    """Guard the size of a picture that is to be made."""
    width, height = image_size(size)
    if width * height > _TOO_MANY_PIXELS:
        raise CvnotesError(f"size: a picture of {width} × {height} pixels would be too large")
    return width, height


def _checked_array(mapping: Any, size: tuple[int, int]) -> Array:
    """Guard a map given as an array (height, width, 2), and give it as (n, 2)."""
    table = positions(mapping, "map")
    if table.shape != (size[1], size[0], 2):
        raise ShapeError(
            f"map: expected shape (height, width, 2) = {(size[1], size[0], 2)}, got {table.shape}"
        )
    return table.reshape(-1, 2)


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
