"""Whether what a finder found is the board that was asked for."""

from dataclasses import replace

import numpy as np

from cvnotes.base import Array, Image
from cvnotes.targets.edge_corners import EdgeFit
from cvnotes.targets.lattice import Mask, alternating, completed, out_of_line

# How unevenly corners in line may stand, as `unevenness` measures it: lenses of 150° need 0.4.
_UNEVEN = 0.5
# A fit may leave so much of the contrast unexplained; noise of 30 grey levels leaves 0.3.
_UNEXPLAINED = 0.5
# A corner may leave so many times as much of it as the others do, if it is that much at all. In
# photographs it is twice as much at most, where paper ends beside a corner 4 to 16 times.
_UNLIKE, _NOTICED = 3.0, 0.12
_SMEARED = 4.0  # blur over that of the others, from which on it is no edge of the board
_MOST_LOST = 0.25  # of a board's corners; with more of them, nothing holds it together
_PAST = 1.2  # squares beyond the outermost corners: past the outer squares
_GOES_ON = 0.6  # of 1, were the pattern to go on there


class NotABoard(Exception):
    """Why corners that were found are not to be trusted, and the count that is there if known."""

    def __init__(
        self, reason: str, count: tuple[int, int] | None = None, found: Array | None = None
    ) -> None:
        super().__init__(reason)
        self.count, self.found = count, found


def vouched(fit: EdgeFit, picture: Image, corners: tuple[int, int]) -> EdgeFit:
    """Give the same fit, with NaN for corners that the pixels do not vouch for.

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
    """Tell which corners (n,) are crossings of edges, alternate with the others and are in line."""
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
    if np.median(fit.residual[seen] / np.abs(fit.contrast[seen])) > _UNEXPLAINED:
        raise NotABoard("its corners drown in noise")
    good = trusted(fit, corners)
    if np.count_nonzero(~good) > may:
        lattice = np.where(good[:, None], fit.m, np.nan).reshape(rows, columns, 2)
        off = np.linalg.norm(fit.m - completed(lattice).reshape(-1, 2), axis=-1)
        raise NotABoard(f"its corners are out of line by {np.nanmax(off):.1f} px")


def _signs(fit: EdgeFit, corners: tuple[int, int]) -> Array:
    """Give the signs (rows, columns) of a chessboard's contrasts: all alike on a board."""
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
