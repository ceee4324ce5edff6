"""The corners of a board as a lattice (rows, columns, 2): measured, doubted, and put in order."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cvnotes.base import Array, DegenerateError, Image
from cvnotes.targets.doubts import NotABoard
from cvnotes.targets.grey import Grey8
from cvnotes.targets.subpixel import EdgeFit, Mask, fit_edges

# So much smaller, a pixel of a copy is more than the edge model's start may be off.
_MUCH_SMALLER = 2.5
# How unevenly corners in line may stand, as `unevenness` measures it: lenses of 150° need 0.4.
_UNEVEN = 0.5
# A corner may leave so many times as much of it as the others do, if it is that much at all. In
# photographs it is twice as much at most, where paper ends beside a corner 4 to 16 times.
_UNLIKE, _NOTICED = 3.0, 0.12
_SMEARED = 4.0  # blur over that of the others, from which on it is no edge of the board
_MOST_LOST = 0.25  # of a board's corners; with more of them, nothing holds it together
_PAST = 1.2  # squares beyond the outermost corners: past the outer squares
_GOES_ON = 0.6  # of 1, were the pattern to go on there


def as_asked(lattice: Array, corners: tuple[int, int], k: int) -> Array:
    """Turn a lattice so that it has as many columns and rows as were asked for."""
    columns, rows = corners
    if lattice.shape[:2] == (columns, rows):
        lattice = lattice.transpose(1, 0, 2)
    if lattice.shape[:2] != (rows, columns):
        count = max(lattice.shape[:2]), min(lattice.shape[:2])
        found = (lattice[seen(lattice)] + 0.5) * k - 0.5
        there = f"{count[0]}×{count[1]} corners"
        raise NotABoard(f"found {there}", count, found, instead=f"{there} are there")
    return lattice


def measured(
    picture: Image, found: Array, *, copy: Grey8 | None = None, k: int = 1, partial: bool = False
) -> Array:
    """Measure a board that was found in a reduced copy, in the picture itself, and doubt it.

    Parameters
    ----------
    picture : ndarray, shape (height, width)
        Grey levels.
    found : ndarray, shape (rows, columns, 2)
        The corners to about a pixel, in pixels of the copy; NaN for hidden ones.
    copy : ndarray of uint8, optional
        The copy, reduced by `k`, in which they were found; by default the picture.
    k : int
        Pixels of the picture along a side of the copy's.
    partial : bool
        Whether a quarter of the corners may be lost.

    Returns
    -------
    ndarray, shape (rows · columns, 2)
        The corners in the order of ``board.points``, NaN for lost ones.

    Raises
    ------
    NotABoard
        What was found is not to be trusted.
    """
    rows, columns = found.shape[:2]
    corners = columns, rows
    start = completed(found).reshape(-1, 2)
    tries: list[tuple[EdgeFit, Mask]] = []
    try:
        if copy is not None and k > _MUCH_SMALLER:
            led = fit_edges.inside(copy, start, grid=corners).m
            start = np.where(np.isfinite(led), led, start)
        start = (start + 0.5) * k - 0.5
        window = _window(start, rows)
        # Corners that come to nothing are tried once more from where the others expect them.
        places = start
        while len(tries) < 2:
            fit = fit_edges.inside(picture, places, window=window, grid=corners)
            fit = confirmed(fit, picture, corners)
            good = trusted(fit, corners)[:, None]
            tries.append((fit, good))
            if good.all() or 2 * np.count_nonzero(good) < len(good):
                break
            places = completed(np.where(good, fit.m, np.nan).reshape(found.shape)).reshape(-1, 2)
        fit, good = max(tries, key=lambda each: np.count_nonzero(each[1]))
        check_board(fit, corners, partial=partial)
        check_pattern_ends(picture, replace(fit, m=np.where(good, fit.m, np.nan)), corners)
    except DegenerateError:
        on_a_line = "its corners lie on a line"
        raise NotABoard(f"found, but {on_a_line}", instead=on_a_line) from None
    except NotABoard as doubt:
        raise NotABoard(f"found, but {doubt}", found=start, instead=str(doubt)) from None
    lattice = np.where(good, fit.m, np.nan).reshape(found.shape)
    return ordered(lattice, fit.contrast.reshape(rows, columns))


def _window(m: Array, rows: int) -> int:
    """Half a window: 8 px, more where squares are larger than 64 px (their blur is, too)."""
    sides = np.linalg.norm(np.diff(m.reshape(rows, -1, 2), axis=1), axis=-1)
    return int(np.clip(np.median(sides) / 8, 8, 16))


def confirmed(fit: EdgeFit, picture: Image, corners: tuple[int, int]) -> EdgeFit:
    """Return the same fit, with NaN for corners that the pixels do not vouch for.

    They lie beyond the picture, where the edges were only prolonged, or are much more blurred than
    others; or, being the last that are seen of a row or column, they have surroundings that two
    edges explain much worse than those of others, as where the paper ends beside them. (What
    covers a corner further inside hardly moves its neighbours: their edges go on elsewhere.)
    """
    height, width = picture.shape
    inside = ((fit.m >= 0) & (fit.m <= [width - 1, height - 1])).all(-1)
    if not inside.any():
        return replace(fit, m=np.full_like(fit.m, np.nan))
    unexplained, blur = np.full(len(fit.m), np.inf), fit.blur.max(-1)
    np.divide(fit.residual, np.abs(fit.contrast), out=unexplained, where=fit.contrast != 0)
    usual, sharp = np.median([unexplained[inside], blur[inside]], axis=1)
    clear = (inside & (blur <= _SMEARED * sharp)).reshape(corners[::-1])
    unlike = (unexplained > max(_UNLIKE * usual, _NOTICED)).reshape(corners[::-1])
    while (bad := unlike & _outermost(clear)).any():
        clear &= ~bad
    return replace(fit, m=np.where(clear.reshape(-1, 1), fit.m, np.nan))


def _outermost(seen: Mask) -> Mask:
    """Mark the first and the last corner that is seen of each row and column."""
    up_to = [np.cumsum(seen, axis) for axis in (0, 1)]
    of_all = [n.take([-1], axis) for axis, n in enumerate(up_to)]
    ends = [(n == 1) | (n == N) for n, N in zip(up_to, of_all, strict=True)]
    return np.asarray(seen & (ends[0] | ends[1]))


def trusted(fit: EdgeFit, corners: tuple[int, int]) -> Mask:
    """Return which corners (n,) are crossings of edges, alternate, and are in line."""
    columns, rows = corners
    signs = _signs(fit, corners)
    seen = np.isfinite(fit.m).all(-1).reshape(rows, columns)
    good = seen & (signs == np.sign(signs[seen].sum()))
    lattice = np.where(good[..., None], fit.m.reshape(rows, columns, 2), np.nan)
    most = int(_MOST_LOST * good.size) + 1
    return np.asarray(good & ~out_of_line(lattice, _UNEVEN, most)).ravel()


def check_board(fit: EdgeFit, corners: tuple[int, int], *, partial: bool = False) -> None:
    """Refuse corners that have no crossing of edges, do not alternate, or are out of line.

    With `partial`, a quarter of them may.

    Raises
    ------
    NotABoard
        With the first thing that is wrong.
    """
    columns, rows = corners
    seen, signs = np.isfinite(fit.m).all(-1), _signs(fit, corners).ravel()
    lost = np.count_nonzero(~seen)
    wrong = min(np.count_nonzero(signs[seen] > 0), np.count_nonzero(signs[seen] < 0))
    may = int(_MOST_LOST * len(fit.m)) if partial else 0
    if lost > may:
        raise NotABoard(
            f"{lost} of {len(fit.m)} corners cannot be seen clearly (hidden, dirty or blurred)"
        )
    if wrong > may:
        raise NotABoard("its squares are not alternately light and dark")
    good = trusted(fit, corners)
    if np.count_nonzero(~good) > may:
        lattice = np.where(good[:, None], fit.m, np.nan).reshape(rows, columns, 2)
        off = np.linalg.norm(fit.m - completed(lattice).reshape(-1, 2), axis=-1)
        raise NotABoard(f"its corners are out of line by {np.nanmax(off):.1f} px")


def _signs(fit: EdgeFit, corners: tuple[int, int]) -> Array:
    """Return the signs (rows, columns) of a chessboard's contrasts: all alike on a board."""
    columns, rows = corners
    i, j = np.indices((rows, columns))
    return np.asarray(np.sign(fit.contrast.reshape(rows, columns)) * (-1.0) ** (i + j))


def check_pattern_ends(picture: Image, fit: EdgeFit, corners: tuple[int, int]) -> None:
    """Refuse corners beyond which the squares go on: they belong to a larger board.

    Raises
    ------
    NotABoard
        Naming both counts.

    Notes
    -----
    Next to a board's outer squares is paper. If the board is larger, there is another row of
    squares, alternately light and dark like those inside.
    """
    columns, rows = corners
    lattice = np.dstack(
        [x.reshape(rows, columns, -1) for x in (fit.m, fit.level, np.abs(fit.contrast))]
    )
    lattice = completed(np.where(np.isfinite(lattice).all(-1, keepdims=True), lattice, np.nan))
    i, j = np.indices((rows, columns))
    signs = np.sign(alternating(fit.contrast.reshape(rows, columns))) * (-1.0) ** (i + j)
    for quarter in range(4):
        # A quarter turn exchanges the two pairs of opposite quadrants.
        light = (-1) ** quarter * np.rot90(signs, quarter)[0]
        if _resemblance(picture, np.rot90(lattice, quarter), light) > _GOES_ON:
            raise NotABoard(
                f"squares go on beyond {columns}×{rows} corners, so the board has more of them"
            )


def _resemblance(picture: Image, lattice: Array, light: Array) -> float:
    """Compare what lies two rows above the first row of corners with squares, 1 if they are.

    `lattice` (rows, columns, 4) holds u, v, level and contrast of the corners.
    """
    first, second, third = lattice[:3]
    # Continue the course of the first three rows by Newton's formula, past the outer squares.
    beyond = (
        first - _PAST * (second - first) + _PAST * (_PAST + 1) / 2 * (first - 2 * second + third)
    )
    t = np.array([0.3, 0.5, 0.7])[:, None, None]  # across a square
    place = (1 - t) * beyond[:-1, :2] + t * beyond[1:, :2]
    u, v = np.rint(place).astype(int).transpose(2, 0, 1)
    seen = ((u >= 0) & (u < picture.shape[1]) & (v >= 0) & (v < picture.shape[0])).all(0)
    if seen.sum() < min(3, len(seen)):
        return 0.0
    grey = picture[v[:, seen], u[:, seen]].mean(0)
    level, contrast = (first[1:, 2:] + first[:-1, 2:])[seen].T / 2
    # Above the corner (0, j), two rows up, is a square like the one towards (1, j + 1).
    same = light[:-1][seen] * (grey - level) / contrast
    return float(same.clip(-1, 1).mean())


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
    """Return the mean signed area of a board's squares, positive if seen from its front.

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


def trimmed(lattice: Array) -> Array:
    """Take off border rows and columns of which less than half is there; NaN is not.

    Examples
    --------
    >>> lattice = np.zeros((4, 5, 2))
    >>> lattice[0, :3] = np.nan
    >>> trimmed(lattice).shape
    (3, 5, 2)
    """
    kept = 0
    while kept < 4 and lattice.size:
        if 2 * np.count_nonzero(np.isfinite(lattice[0]).all(-1)) < lattice.shape[1]:
            lattice, kept = lattice[1:], 0
        else:
            lattice, kept = np.rot90(lattice), kept + 1
    return lattice


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


def seen(lattice: Array) -> Mask:
    """Return which corners (rows, columns) of a lattice are there."""
    return np.asarray(np.isfinite(lattice).all(-1))
