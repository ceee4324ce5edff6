"""Whether what a finder found is the board that was asked for."""

import numpy as np

from cvnotes.base import Array, Image
from cvnotes.targets.edge_corners import EdgeFit

# How far, in squares, four corners in line may depart from a smooth course. Perspective and
# strong lenses together stay below a third of it.
_UNEVEN = 0.1
# A fit may leave so much of the contrast unexplained; noise of 30 grey levels leaves 0.3.
_UNEXPLAINED = 0.5
_PAST = 1.2  # squares beyond the outermost corners: past the outer squares
_GOES_ON = 0.6  # of 1, were the pattern to go on there


class NotABoard(Exception):
    """Why corners that were found are not to be trusted."""


def check_board(fit: EdgeFit, corners: tuple[int, int]) -> None:
    """Refuse corners that have no crossing of edges, do not alternate, or are out of line.

    Raises
    ------
    NotABoard
        With the corner, counted from the finder's own first one.
    """
    columns, rows = corners
    lost = np.flatnonzero(~np.isfinite(fit.m).all(-1))
    if lost.size:
        raise NotABoard(
            f"{lost.size} of {len(fit.m)} corners cannot be seen clearly (hidden, dirty or blurred)"
        )
    i, j = np.indices((rows, columns))
    signs = fit.contrast.reshape(rows, columns) * (-1.0) ** (i + j)
    if not ((signs > 0).all() or (signs < 0).all()):
        raise NotABoard("its squares are not alternately light and dark")
    if np.median(fit.residual / np.abs(fit.contrast)) > _UNEXPLAINED:
        raise NotABoard("its corners drown in noise")
    lattice = fit.m.reshape(rows, columns, 2)
    side = np.linalg.norm(np.diff(lattice, axis=1), axis=-1).min()
    for axis in (0, 1):
        if lattice.shape[axis] > 3:
            bend = np.linalg.norm(np.diff(lattice, 3, axis=axis), axis=-1).max()
            if bend > _UNEVEN * side:
                raise NotABoard(f"its corners are out of line by {bend:.1f} px")


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
    signs = np.sign(fit.contrast).reshape(rows, columns)
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
