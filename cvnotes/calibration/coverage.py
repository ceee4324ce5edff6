"""Where in the picture corners were seen."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, image_size, points


def covered_cells(
    image_points: npt.ArrayLike | Sequence[npt.ArrayLike], size: tuple[int, int]
) -> npt.NDArray[np.bool_]:
    """Divide a picture into about square cells and tell in which of them corners were seen.

    Parameters
    ----------
    image_points : array_like, shape (views, n, 2) or (n, 2), or a list of (n_i, 2)
        Pixels.
    size : (width, height)
        Size of the picture; its longer side has eight cells.

    Returns
    -------
    ndarray of bool, shape (columns, rows)

    Examples
    --------
    >>> covered_cells([[10, 10], [600, 400]], (640, 480)).sum()
    np.int64(2)
    """
    m, size = joined(image_points), image_size(size)
    cells = np.array([max(round(8 * n / max(size)), 1) for n in size])
    inside = m[((m >= -0.5) & (m < np.array(size) - 0.5)).all(axis=1)]
    seen = np.zeros(cells, dtype=bool)
    seen[tuple(((inside + 0.5) // (size / cells)).astype(int).T)] = True
    return seen


def joined(image_points: npt.ArrayLike | Sequence[npt.ArrayLike]) -> Array:
    """Join the points of all views, (n, 2)."""
    views = list(image_points) if isinstance(image_points, Sequence) else [image_points]
    flat = [points(m, "image_points", 2).reshape(-1, 2) for m in views]
    return np.concatenate([np.empty((0, 2)), *flat])
