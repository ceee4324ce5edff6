"""What a map is, and how the warps ask it: a PixelMap, any function of pixels, or a table."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    CvnotesError,
    InputTypeError,
    ShapeError,
    chunks,
    points,
    positions,
    target_size,
)

# Pixels mapped at a time: a dozen arrays of them stay in the cache.
_TILE = 14_000


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


def compose(*maps: Mapping) -> PixelMap:
    """Compose maps as they are written: compose(f, g) maps m to f(g(m)), exactly.

    One backward warp by compose(f, g) is better than a warp by f and then by g: the picture is
    interpolated once. Arrays cannot be composed, since they are known at whole pixels only.

    Examples
    --------
    >>> from cvnotes.warping import rotation_map, zoom_map
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
    >>> from cvnotes.warping import zoom_map
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
    rows = max(1, _TILE // width)
    table = None if callable(mapping) else _checked_array(mapping, size)
    columns = columns_of(mapping) if table is None else None
    m_h = homogeneous_columns(np.tile(np.arange(width), rows), np.repeat(np.arange(rows), width))
    for part in chunks(height * width, rows * width):
        if table is not None:
            m = table[part].T.copy()
        elif columns is not None:
            with np.errstate(all="ignore"):  # what has no image becomes NaN in silence
                m = columns(m_h[:, : part.stop - part.start])
        own = m.flags.c_contiguous and not np.may_share_memory(m, m_h)
        yield part, np.array(m, dtype=np.float64, order="C", copy=None if own else True)
        m_h[1] += rows


def factored(mapping: PixelMap, size: tuple[int, int]) -> tuple[Array, Array] | None:
    """Write a smooth map of a picture as a product, some twenty times cheaper than the map itself.

    Between the nodes u_j = cos(π j / n) a function as smooth as a lens is a polynomial of low
    degree, up to rounding: m(u, v) = Σ T_i(v) c_ik T_k(u) with T_k(u) = cos(k arccos u), where the
    picture reaches from −1 to 1. n is doubled until the last coefficients are below a millionth of
    a pixel.

    Returns
    -------
    tuple or None
        T(v) (height, n + 1) and c Tᵀ(u) (2, n + 1, width), whose product is m for all pixels; None
        where that needs more than 33 nodes, or a pixel has no image.

    References
    ----------
    .. [1] L. N. Trefethen, *Approximation Theory and Approximation Practice*, SIAM 2013, ch. 3
       and 7.

    Examples
    --------
    >>> from cvnotes.warping import zoom_map
    >>> rows, columns = factored(zoom_map(0.5), (640, 480))
    >>> (rows @ columns)[:, 0, 1].round(9)
    array([ 0.25, -0.25])
    """
    for n in (8, 16, 32):
        angles = np.arange(n + 1) * np.pi / n
        to_c = np.linalg.inv(_chebyshev(angles, n))
        u, v = ((np.cos(angles) + 1) * (side - 1) / 2 for side in size)
        c = to_c @ np.moveaxis(mapping(np.stack(np.meshgrid(u, v), axis=-1)), -1, 0) @ to_c.T
        if max(abs(c[:, -2:]).max(), abs(c[..., -2:]).max()) < 1e-6:
            T_u, T_v = (_chebyshev(np.arccos(np.linspace(-1, 1, side)), n) for side in size)
            return T_v, c @ T_u.T
    return None


def _chebyshev(angles: Array, n: int) -> Array:
    """Return T_0 to T_n at the cosines of angles."""
    return np.cos(np.multiply.outer(angles, np.arange(n + 1)))


def columns_of(mapping: Mapping) -> Callable[[Array], Array]:
    """Return a map as a function from homogeneous columns (3, n) to columns (2, n)."""
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


def _checked_array(mapping: Any, size: tuple[int, int]) -> Array:
    """Guard a map given as an array (height, width, 2), and give it as (n, 2)."""
    table = positions(mapping, "map")
    if table.shape != (size[1], size[0], 2):
        raise ShapeError(
            f"map: expected shape (height, width, 2) = {(size[1], size[0], 2)}, got {table.shape}"
        )
    return table.reshape(-1, 2)
