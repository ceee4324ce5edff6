"""A board grown from one square of it: its count, and its corners though some are hidden."""

from collections.abc import Iterator
from itertools import islice

import numpy as np

from cvnotes.base import Array, DegenerateError, Image
from cvnotes.targets.grey import Grey8
from cvnotes.targets.lattice import Mask, completed
from cvnotes.targets.opencv_finders import find_part, has_opencv
from cvnotes.targets.saddle_points import find_saddle_part
from cvnotes.targets.subpixel import fit_edges, led_by_gradients

_FAR = 0.35  # of a square: farther from where it was expected, it is another corner
_WINDOW = 0.4  # half a window in which gradients lead to a corner, of a square
_LED = 0.1  # px, to which gradients need to lead: the model of two edges goes on from there
_FAINT = 0.6  # of the board's contrast: what is fainter is no edge of its squares
_UNLIKE = 0.15  # of the contrast: so much more may a corner leave unexplained than most
_TRIES = 3  # squares to begin with
_LOOKS = 5  # of OpenCV, at most
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
    OpenCV finds a part of the board, or without it `find_saddle_part`; of that the surest square
    is taken. Its neighbours on each side are expected where the rows before them lead, the model of
    two edges is fitted there, and a row is taken over if at least half of it are corners: in their
    place, alternating, with a contrast like the others'. That is repeated until no side has such a
    row.
    """
    # OpenCV's part is not the same each time, and from some of them not all of the board grows: the
    # largest lattice is looked for until it came twice.
    look, looks = (find_part, _LOOKS) if has_opencv() else (find_saddle_part, 1)
    grown: list[Array] = [np.full((0, 0, 2), np.nan)]
    parts: list[Array] = []
    for _ in range(looks):
        part = look(grey)
        if part is None:
            break
        same = next((i for i, other in enumerate(parts, 1) if np.array_equal(other, part)), None)
        parts.append(part)
        grown.append(grown[same] if same else _grown_from(grey, part))
        sizes = [lattice.size for lattice in grown]
        if max(sizes) > 0 and sizes.count(max(sizes)) > 1:
            break
    best = max(grown, key=np.size)
    if min(best.shape[:2]) < 3:
        return None
    # Half a turn does not matter here: finders give their corners in any order.
    return best if best.shape[1] >= best.shape[0] else np.rot90(best)


def _grown_from(grey: Grey8, part: Array) -> Array:
    """Grow the surest squares of a part, until what they grow to is as large as the part."""
    best = np.full((0, 0, 2), np.nan)
    for square in islice(_squares(grey, part), _TRIES):
        best = max(best, _grown(grey, square), key=np.size)
        if best.size >= part.size:
            break
    return best


def _grown(grey: Image, lattice: Array) -> Array:
    """Put rows on all sides of a lattice until there are no more."""
    ended = [0, 0, 0, 0]  # the size of the lattice that had no further row on a side
    while max(lattice.shape) < _LARGEST:
        if all(ended):
            # A lattice that has grown since may have one: of a longer row, more can be seen.
            ended = [size if size == lattice.size else 0 for size in ended]
            if all(ended):
                break
        if not ended[0]:
            larger = _one_row_more(grey, lattice)
            if larger is None:
                ended[0] = lattice.size
            else:
                lattice = larger
        lattice, ended = np.rot90(lattice), [*ended[1:], ended[0]]
    return lattice


def _squares(grey: Image, part: Array) -> Iterator[Array]:
    """Give the corners (2, 2, 2) of a part's squares, those first that look most like squares.

    OpenCV passes over hidden rows. The corners beside them do not alternate, and no square is
    between them.
    """
    x, y = np.diff(part, axis=1), np.diff(part, axis=0)
    sides = np.stack([x[:-1], x[1:], y[:, :-1], y[:, 1:]])
    lengths = np.linalg.norm(sides, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):  # two corners in one place: no square
        oblong = lengths.max(0) / lengths.min(0)
    for k in np.argsort(oblong, axis=None):
        i, j = np.unravel_index(k, oblong.shape)
        found = _corners(grey, part[i : i + 2, j : j + 2])
        if found is not None and np.isfinite(found).all():
            yield found


def _one_row_more(grey: Image, lattice: Array) -> Array | None:
    """Put a row before the first one of a lattice, or give None if there is none."""
    known = completed(lattice)[:4]
    # Newton's formula: the differences of the highest order stay the same. The row after the
    # next one is only there to be looked past.
    known = np.concatenate([known[:1] + _differences(known), known])
    known = np.concatenate([2 * known[:1] - known[1:2], known])
    height, width = grey.shape
    inside = ((known[1] >= 0) & (known[1] <= [width - 1, height - 1])).all(-1)
    # The two rows that are known there tell what corners look like.
    found = _corners(grey, known[:4]) if 2 * inside.sum() >= inside.size else None
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


def _corners(grey: Image, expected: Array) -> Array | None:
    """Fit edges to a lattice of expected corners: NaN where there are none, None for no lattice.

    Of more than two rows, those after the first two are known already.
    """
    rows, columns = shape = expected.shape[:2]
    sides = [np.linalg.norm(np.gradient(expected, axis=axis), axis=-1) for axis in (0, 1)]
    side = np.minimum(*sides)
    # Gradients lead from farther away than the model of two sharp edges does.
    half = int(np.clip(_WINDOW * np.median(side), 4, 30))
    start = expected.reshape(-1, 2).copy()
    unknown = start[: 2 * columns]
    led = led_by_gradients(grey, unknown, half, _LED)
    unknown[:] = np.where(np.isfinite(led), led, unknown)
    try:
        fit = fit_edges.inside(grey, start, grid=(columns, rows))
    except DegenerateError:
        return None
    m, contrast = fit.m.reshape(*shape, 2), fit.contrast.reshape(shape)
    judged = slice(2, None) if rows > 2 else slice(None)  # what is known, if anything
    seen: Mask = np.asarray(np.isfinite(m).all(-1))
    i, j = np.indices(shape)
    alike = contrast * (-1.0) ** (i + j)
    alike *= np.sign(alike[judged][seen[judged]].sum())
    usual = np.abs(contrast[judged][seen[judged]])
    unexplained = fit.residual.reshape(shape) / np.maximum(np.abs(contrast), 1e-9)
    if not usual.size:
        return None
    plain = unexplained < np.median(unexplained[judged][seen[judged]]) + _UNLIKE
    near = np.linalg.norm(m - expected, axis=-1) < _FAR * side
    good = seen & near & plain & (alike > _FAINT * np.median(usual))
    return np.where(good[..., None], m, np.nan)
