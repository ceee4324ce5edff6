"""Corners as a lattice (rows, columns, 2): its order, its gaps, and how evenly it bends."""

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array

Mask = npt.NDArray[np.bool_]


def ordered(lattice: Array, contrast: Array) -> Array:
    """Put corners in the order of ``board.points``, whatever the order of the finder.

    Parameters
    ----------
    lattice : ndarray, shape (rows, columns, 2)
        Corners with neighbours next to each other; NaN for those that are lost.
    contrast : ndarray, shape (rows, columns)
        Positive where the quadrant towards larger row and column, and the one opposite, is light.

    Returns
    -------
    ndarray, shape (rows · columns, 2)
        Right-handed, and with a dark square outside of the first corner. If several orders are
        so, the one whose first corner is nearest to the picture's top left pixel.

    Examples
    --------
    >>> lattice = np.stack(np.meshgrid([10.0, 20, 30], [10.0, 20]), axis=-1)
    >>> light = np.array([[1, -1, 1], [-1, 1, -1]])
    >>> ordered(lattice, light)[0]  # the square outside of (10, 10) is light
    array([30., 20.])
    """
    lost = np.isnan(lattice)
    lattice, contrast = completed(lattice), np.where(lost.any(-1), 0.0, contrast)
    every = np.where(lost, np.nan, lattice)
    if handedness(lattice) < 0:
        lattice, every, contrast = lattice[:, ::-1], every[:, ::-1], -contrast[:, ::-1]
    same_shape = (0, 1, 2, 3) if lattice.shape[0] == lattice.shape[1] else (0, 2)
    # A quarter turn exchanges the two pairs of opposite quadrants.
    light = {k: alternating((-1) ** k * np.rot90(contrast, k)) for k in same_shape}
    dark = [k for k in same_shape if light[k] < 0] or list(same_shape)
    first = min(dark, key=lambda k: float(np.hypot(*np.rot90(lattice, k)[0, 0])))
    return np.array(np.rot90(every, first)).reshape(-1, 2)


def handedness(lattice: Array) -> float:
    """Give the mean signed area of a board's squares, positive if seen from its front.

    Examples
    --------
    >>> handedness(np.stack(np.meshgrid([1.0, 2, 3], [1.0, 2]), axis=-1))
    1.0
    """
    x, y = np.diff(lattice, axis=1)[:-1], np.diff(lattice, axis=0)[:, :-1]
    return float(np.mean(x[..., 0] * y[..., 1] - x[..., 1] * y[..., 0]))


def alternating(contrast: Array) -> float:
    """Sum contrasts with a chessboard's signs: negative if the square before (0, 0) is dark."""
    i, j = np.indices(contrast.shape)
    return float((contrast * (-1.0) ** (i + j)).sum())


def completed(lattice: Array) -> Array:
    """Fill the gaps (NaN) of a lattice (rows, columns, d) so that it bends as evenly as can be.

    The third differences along rows and columns become as small as least squares can make them:
    what lies on a parabola goes on as one.

    Examples
    --------
    >>> x, y = np.meshgrid([0.0, 1, 4, 9, 16], [0.0, 1, 2, 3])
    >>> gap = np.dstack([x, y])
    >>> gap[1, 2] = gap[0, 0] = np.nan
    >>> completed(gap)[[1, 0], [2, 0]].round(9) + 0.0
    array([[4., 1.],
           [0., 0.]])
    """
    lost = np.isnan(lattice).any(-1).ravel()
    if not lost.any() or lost.all():
        return lattice
    shape = lattice.shape
    equations = [
        np.diff(np.eye(lost.size).reshape(*shape[:2], -1), order, axis=axis).reshape(-1, lost.size)
        for axis in (0, 1)
        if (order := min(3, shape[axis] - 1)) > 0
    ]
    D = np.concatenate(equations)
    m = lattice.reshape(lost.size, -1).copy()
    m[lost] = np.linalg.lstsq(D[:, lost], -D[:, ~lost] @ m[~lost], rcond=None)[0]
    return m.reshape(shape)


def unevenness(lattice: Array) -> Iterator[Array]:
    """Measure how far corners in line depart from a smooth course, in squares of their own place.

    For each axis, the length of the fourth differences over the mean side there (where there are
    only four corners in line, that of the third). A corner that is wrong by δ squares makes a
    fourth difference of up to 6 δ. Photographs through a lens of 150° reach 0.3, or 0.4 in
    the third. Lines with a lost corner give NaN.

    Examples
    --------
    >>> line = np.stack(np.meshgrid([0.0, 10, 20, 31, 40, 50], [0.0, 10]), axis=-1)
    >>> [u.max().round(2) for u in unevenness(line)]
    [np.float64(0.6)]
    """
    for axis in (0, 1):
        order = min(4, lattice.shape[axis] - 1)
        if order < 3:
            continue
        along = np.moveaxis(lattice, axis, 0)
        sides = np.linalg.norm(np.diff(along, axis=0), axis=-1)
        mean = np.mean([sides[i : len(sides) - order + 1 + i] for i in range(order)], axis=0)
        yield np.linalg.norm(np.diff(along, order, axis=0), axis=-1) / mean


def out_of_line(lattice: Array, limit: float, most: int) -> Mask:
    """Mark the corners (rows, columns) without which nothing is uneven beyond the limit.

    They are found one after the other: each the one that, left out, takes most unevenness with it.
    After `most` of them the search ends.

    Examples
    --------
    >>> lattice = np.stack(np.meshgrid(10.0 * np.arange(9), 10.0 * np.arange(6)), axis=-1)
    >>> lattice[2, 3] += 2
    >>> np.argwhere(out_of_line(lattice, 0.5, most=5))
    array([[2, 3]])
    """
    lattice, shape = lattice.copy(), lattice.shape[:2]
    marked = np.zeros(shape, dtype=bool)
    excess = _excess(lattice, limit)
    while excess > 0 and np.count_nonzero(marked) < most:
        known = np.argwhere(np.isfinite(lattice).all(-1))
        left = []
        for i, j in known:
            without = lattice.copy()
            without[i, j] = np.nan
            left.append((_excess(without, limit), _typical(without)))
        (excess, _), (i, j) = min(zip(left, known.tolist(), strict=True))
        lattice[i, j], marked[i, j] = np.nan, True
    return marked


def _excess(lattice: Array, limit: float) -> float:
    """Sum the unevenness of all lines that have more of it than the limit."""
    return sum(float(u[u > limit].sum()) for u in unevenness(lattice))


def _typical(lattice: Array) -> float:
    """Average the unevenness of all lines."""
    every = np.concatenate([u.ravel() for u in unevenness(lattice)])
    return float(np.mean(every[np.isfinite(every)])) if np.isfinite(every).any() else 0.0
