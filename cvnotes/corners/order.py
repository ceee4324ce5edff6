"""Which corner of a board is its origin."""

import numpy as np

from cvnotes.errors import Array


def ordered(lattice: Array, contrast: Array) -> Array:
    """Put corners in the order of ``board.points``, whatever the order of the finder.

    Parameters
    ----------
    lattice : ndarray, shape (rows, columns, 2)
        Corners with neighbours next to each other.
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
    if handedness(lattice) < 0:
        lattice, contrast = lattice[:, ::-1], -contrast[:, ::-1]
    same_shape = (0, 1, 2, 3) if lattice.shape[0] == lattice.shape[1] else (0, 2)
    # A quarter turn exchanges the two pairs of opposite quadrants.
    turned = [(np.rot90(lattice, k), (-1) ** k * np.rot90(contrast, k)) for k in same_shape]
    dark = [m for m, c in turned if _alternating(c) < 0] or [m for m, _ in turned]
    first = min(dark, key=lambda m: float(np.hypot(*m[0, 0])))
    return np.array(first).reshape(-1, 2)


def handedness(lattice: Array) -> float:
    """Give the mean signed area of a board's squares, positive if seen from its front.

    Examples
    --------
    >>> handedness(np.stack(np.meshgrid([1.0, 2, 3], [1.0, 2]), axis=-1))
    1.0
    """
    x, y = np.diff(lattice, axis=1)[:-1], np.diff(lattice, axis=0)[:, :-1]
    return float(np.mean(x[..., 0] * y[..., 1] - x[..., 1] * y[..., 0]))


def _alternating(contrast: Array) -> float:
    """Sum contrasts with a chessboard's signs: negative if the square before (0, 0) is dark."""
    i, j = np.indices(contrast.shape)
    return float((contrast * (-1.0) ** (i + j)).sum())
