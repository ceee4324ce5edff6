"""Where in a picture one ray a pixel is not enough, and how to cast many.

Pixels are (height, width, 2) arrays of (u, v); tiles are squares of neighbouring pixels, whose
rays stay close together.
"""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, chunks, clipped_segments, target_size
from cvnotes.camera import Camera, px_from_xy

Mask = npt.NDArray[np.bool_]

TILE = 16  # pixels along a side
_GOLDEN = (np.sqrt(5) - 1) / 2


def pixel_centres(size: tuple[int, int]) -> Array:
    """Return the pixels (u, v) of a picture of (width, height) as (height, width, 2).

    Examples
    --------
    >>> pixel_centres((640, 480))[1, 2]
    array([2., 1.])
    """
    width, height = target_size(size)
    u, v = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    return np.stack([u, v], axis=-1)


def within_pixel(samples: int) -> Array:
    """Spread points (samples, 2) evenly over a pixel, [−½, ½) × [−½, ½).

    A lattice on the golden ratio. Seen along either axis no two points coincide, so that even an
    upright edge is placed to 1 / `samples` of a pixel; and with each point there is its mirror
    image in the pixel's centre, so that edges are not moved.

    Examples
    --------
    >>> within_pixel(4)[:, 0]
    array([-0.375, -0.125,  0.125,  0.375])
    """
    from_middle = np.arange(samples) - (samples - 1) / 2
    return np.stack([from_middle / samples, (from_middle * _GOLDEN + 0.5) % 1 - 0.5], axis=-1)


def in_tiles(x: Array) -> Array:
    """Cut (height, width, ...) into tiles (n, TILE², ...), filled up with NaN at the borders.

    Examples
    --------
    >>> in_tiles(np.zeros((480, 630, 2))).shape
    (1200, 256, 2)
    """
    down, across = -x.shape[0] % TILE, -x.shape[1] % TILE
    rest = x.shape[2:]
    fill = ((0, down), (0, across)) + ((0, 0),) * len(rest)
    x = np.pad(x, fill, constant_values=np.nan)
    x = x.reshape(x.shape[0] // TILE, TILE, x.shape[1] // TILE, TILE, *rest)
    return x.swapaxes(1, 2).reshape(-1, TILE * TILE, *rest)


def out_of_tiles(x: Array, size: tuple[int, int]) -> Array:
    """Put tiles (n, TILE², ...) together again: (height, width, ...).

    Examples
    --------
    >>> m = pixel_centres((630, 470))
    >>> bool((out_of_tiles(in_tiles(m), (630, 470)) == m).all())
    True
    """
    width, height = size
    across = -(-width // TILE)
    x = x.reshape(-1, across, TILE, TILE, *x.shape[2:]).swapaxes(1, 2)
    return x.reshape(-1, across * TILE, *x.shape[4:])[:height, :width].copy()


def tile_order(m: Array) -> npt.NDArray[np.intp]:
    """Sort pixels (n, 2) so that those of a tile follow one another.

    Examples
    --------
    >>> tile_order(np.array([[0, 0], [20, 0], [3, 5]]))
    array([0, 2, 1])
    """
    u, v = m.T // TILE
    return np.lexsort((u, v))


def changing(signature: Array) -> Mask:
    """Mark in which pixels (height, width, d) a value differs by 1 from one of the 8 neighbours.

    Examples
    --------
    >>> changing(np.array([[0, 0, 0, 3, 3.2]])[..., None])
    array([[False, False,  True,  True, False]])
    """
    framed = np.pad(np.moveaxis(signature, -1, 0), ((0, 0), (1, 1), (1, 1)), mode="edge")
    mask = np.zeros(signature.shape[:2], dtype=bool)
    for rows in chunks(len(mask), TILE):  # so few that the processor has them at hand
        for part in framed[:, rows.start : rows.stop + 2]:
            mask[rows] |= _of_nine(np.maximum, part) - _of_nine(np.minimum, part) >= 1
    return mask


def _of_nine(choose: np.ufunc, x: Array) -> Array:
    """Choose among each inner value of x and its 8 neighbours."""
    of_three = choose(choose(x[:-2], x[1:-1]), x[2:])
    return np.asarray(choose(choose(of_three[:, :-2], of_three[:, 1:-1]), of_three[:, 2:]))


def crossed(camera: Camera, ends: Array, xy: Array) -> Mask:
    """Mark through which pixels line segments pass, so that none is too thin to be noticed.

    Parameters
    ----------
    camera : Camera
        Whose picture.
    ends : ndarray, shape (k, 2, 3)
        Both ends of each segment, in the CRF.
    xy : ndarray, shape (height, width, 2)
        The ideal image points of the pixels; NaN where there is none.

    Examples
    --------
    >>> from cvnotes.camera import intrinsics
    >>> camera = Camera(intrinsics(80, 80, 32, 24), size=(64, 48))
    >>> upright = np.array([[[0.0, -9, 5], [0, 9, 5]]])
    >>> np.flatnonzero(crossed(camera, upright, camera.ideal(pixel_centres((64, 48))))[0])
    array([32])
    """
    width, height = camera.size
    low, high = (f.reduce(f.reduce(xy)) for f in (np.fmin, np.fmax))  # both axes: 80 times slower
    a, b = _clipped(ends, low, high)
    a, b = a[:, :2] / a[:, 2:], b[:, :2] / b[:, 2:]
    # Straight in the ideal image: two points a pixel, each its part of the way.
    count = np.ceil(2 * np.linalg.norm((b - a) * np.diag(camera.A)[:2], axis=-1)).astype(int) + 1
    which = np.repeat(np.arange(len(count)), count)
    part = (np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)) / count[which]
    on = a[which] + part[:, None] * (b - a)[which]
    lens = camera.lens.distort(on)
    m = np.rint(px_from_xy(camera.A, lens[np.isfinite(lens[:, 0])])).astype(int)
    u, v = m[((m >= 0) & (m < camera.size)).all(axis=-1)].T
    mask = np.zeros((height, width), dtype=bool)
    mask[v, u] = True
    return mask


def _clipped(ends: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Cut segments (k, 2, 3) to the pyramid of rays between the ideal points low and high.

    The planes go through the camera: what is behind it goes too.
    """
    planes = np.array(
        [[1, 0, -low[0]], [-1, 0, high[0]], [0, 1, -low[1]], [0, -1, high[1]], [0, 0, 1]]
    )
    a, b = np.moveaxis(clipped_segments(ends, ends @ planes.T), 1, 0)
    front = (a[:, 2] > 0) & (b[:, 2] > 0)
    return a[front], b[front]
