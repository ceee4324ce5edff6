"""Whatever board is in a picture: its count, and its corners though some are hidden."""

import numpy as np

from cvnotes.base import Array, DegenerateError, Image
from cvnotes.targets.grey import Grey8
from cvnotes.targets.lattice import Mask, completed, trimmed
from cvnotes.targets.saddle_points import saddle_lattice
from cvnotes.targets.subpixel import fit_edges, led_by_gradients

_FAR = 0.35  # of a square: farther from where it was expected, it is another corner
_WINDOW = 0.4  # half a window in which gradients lead to a corner, of a square
_LED = 0.1  # px, to which gradients need to lead: the model of two edges goes on from there
_FAINT = 0.6  # of the board's contrast: what is fainter is no edge of its squares
_UNLIKE = 0.15  # of the contrast: so much more may a corner leave unexplained than most
_QUADRANT = np.array([0.2, 0.3, 0.4])  # of both steps: there the quadrants are looked at
_ALIKE = 0.3  # of the contrast: so much is the darker light quadrant lighter than the lighter dark
_LARGEST = 60  # corners along a side


def grown_board(grey: Grey8) -> Array | None:
    """Find the largest lattice of squares that go on from each other.

    Parameters
    ----------
    grey : ndarray of uint8, shape (height, width)
        The picture.

    Returns
    -------
    ndarray, shape (rows, columns, 2), or None
        The corners, NaN for those that are hidden between the others, with the longer side along
        the columns; None if there is no board of 3×3 inner corners.

    Notes
    -----
    Saddle points that go on from each other are taken (`saddle_lattice`), and the model of two
    edges is fitted to all of them. On each side the next row is expected where the rows before it
    lead, and is taken over if at least half of it are corners: in their place, alternating, with a
    contrast like the others'. That is repeated until no side has such a row.
    """
    start = saddle_lattice(grey)
    found = None if start is None else _corners(grey, completed(start), new=0)
    lattice = np.full((0, 0, 2), np.nan) if found is None else trimmed(found)
    if min(lattice.shape[:2]) >= 2:
        lattice = _grown(grey, lattice)
    if min(lattice.shape[:2]) < 3:
        return None
    # Half a turn does not matter here: finders give their corners in any order.
    return lattice if lattice.shape[1] >= lattice.shape[0] else np.rot90(lattice)


def _grown(grey: Image, lattice: Array) -> Array:
    """Put rows on all sides of a lattice until there are no more."""
    blocked = 0
    while blocked < 4 and max(lattice.shape) < _LARGEST:
        larger = _one_row_more(grey, lattice)
        blocked = blocked + 1 if larger is None else 0
        lattice = np.rot90(lattice if larger is None else larger)
    return lattice


def _one_row_more(grey: Image, lattice: Array) -> Array | None:
    """Put a row before the first one of a lattice, or give None if there is none."""
    known = completed(lattice)[:4]
    # Newton's formula: the differences of the highest order stay the same. The row after the
    # next one is only there to be looked past.
    known = np.concatenate([known[:1] + _differences(known), known])
    known = np.concatenate([2 * known[:1] - known[1:2], known])[:4]
    height, width = grey.shape
    inside = ((known[1] >= 0) & (known[1] <= [width - 1, height - 1])).all(-1)
    found = _corners(grey, known, new=2) if 2 * inside.sum() >= inside.size else None
    if found is None:
        return None
    row = np.where(inside[:, None], found[1], np.nan)
    if 2 * np.isfinite(row).all(-1).sum() < len(row):
        return None
    return np.concatenate([row[None], lattice])


def _differences(rows: Array) -> Array:
    """Sum the differences of all orders, up to the third, at the first of some rows."""
    total, step = np.zeros_like(rows[:1]), rows[:4]
    while len(step) > 1:
        step = step[:-1] - step[1:]
        total = total + step[:1]
    return total


def _corners(grey: Image, expected: Array, new: int) -> Array | None:
    """Fit edges to a lattice of expected corners: NaN where there are none, None for no lattice.

    The first `new` rows are only expected, and by what the others look like they are judged.
    """
    rows, columns = shape = expected.shape[:2]
    sides = [np.linalg.norm(np.gradient(expected, axis=axis), axis=-1) for axis in (0, 1)]
    side = np.minimum(*sides)
    # Gradients lead from farther away than the model of two sharp edges does.
    half = int(np.clip(_WINDOW * np.median(side), 4, 30))
    start = expected.reshape(-1, 2).copy()
    led = led_by_gradients(grey, start[: new * columns], half, _LED)
    start[: new * columns] = np.where(np.isfinite(led), led, start[: new * columns])
    try:
        fit = fit_edges.inside(grey, start, grid=(columns, rows))
    except DegenerateError:
        return None
    m, contrast = fit.m.reshape(*shape, 2), fit.contrast.reshape(shape)
    seen: Mask = np.asarray(np.isfinite(m).all(-1))
    judges = seen & (np.arange(rows) >= new)[:, None]
    if not judges.any():
        return None
    i, j = np.indices(shape)
    alike = contrast * (-1.0) ** (i + j)
    alike *= np.sign(alike[judges].sum())
    unexplained = fit.residual.reshape(shape) / np.maximum(np.abs(contrast), 1e-9)
    plain = unexplained < np.median(unexplained[judges]) + _UNLIKE
    strong = alike > _FAINT * np.median(np.abs(contrast[judges]))
    near = np.linalg.norm(m - expected, axis=-1) < _FAR * side
    good = seen & near & plain & strong & _alternate(grey, m, expected)
    return np.where(good[..., None], m, np.nan)


def _alternate(grey: Image, m: Array, expected: Array) -> Mask:
    """Tell around which corners two opposite quadrants are light, and both of the others dark.

    Where only one of four quadrants is dark, at the end of a board, two edges cross as well.
    """
    a, b = (np.gradient(expected, axis=axis) for axis in (1, 0))
    ways = np.stack([a + b, -a - b, a - b, b - a])
    places = m + _QUADRANT[:, None, None, None, None] * ways
    height, width = grey.shape
    u, v = np.rint(np.nan_to_num(places)).astype(np.intp).clip(0, [width - 1, height - 1]).T
    one, other = grey[v, u].mean(-1, dtype=float).T.reshape(2, 2, *m.shape[:2])
    clear = np.maximum(one.min(0) - other.max(0), other.min(0) - one.max(0))
    return np.asarray(clear > _ALIKE * np.ptp([*one, *other], axis=0))
