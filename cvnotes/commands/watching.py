"""The machine's own camera, watched by a page: when a picture is taken by itself.

That is when the board is still, and where it helps most: before there is a camera, wherever the
board is seen as in no photograph so far; after that, where it would bring at least a third of what
the best next view would (`cvnotes.calibration.next_view`).
"""

from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.calibration import pose_from_view
from cvnotes.calibration.coverage import covered_cells
from cvnotes.calibration.next_view import left_with
from cvnotes.commands.dropped import Dropped
from cvnotes.targets.finding import rough_corners

STILL = 0.4  # px of the small frame that corners move between two frames, root mean square
_OTHER = 0.5  # of a cell: how far corners are, on average, from those of any photograph so far
_PART = 1 / 3  # of what the best view would bring


class Watch:
    """Looks at small frames of the machine's camera, one after the other.

    Parameters
    ----------
    dropped : Dropped
        The photographs so far.
    """

    def __init__(self, dropped: Dropped) -> None:
        self.dropped = dropped
        self._before: Array | None = None

    def see(self, grey: bytes, size: tuple[int, int], full: tuple[int, int]) -> dict[str, Any]:
        """Look at a frame.

        Parameters
        ----------
        grey : bytes
            Its pixels, row by row.
        size, full : (width, height)
            Of the frame, and of the photograph that would be taken.

        Returns
        -------
        dict
            Where the ``corners`` are on the frame, flat; whether to ``take`` a picture now; and in
            ``words`` what it waits for.
        """
        (width, height), full = size, (full[0], full[1])
        picture = np.frombuffer(grey, np.uint8).reshape(height, width)
        corners = self.dropped.board.corners
        m = rough_corners(picture, corners)
        before, self._before = self._before, None
        if m is None or np.isnan(m).any():
            return {"corners": [], "take": False, "words": "the board is not seen whole"}
        self._before = m = _in_order(m, corners)
        moved = np.inf if before is None else _apart(m, before)
        helps, words = self._helps((m + 0.5) * full[0] / width - 0.5, full)
        take = helps and moved < STILL
        if helps:
            words = "taken" if take else "hold the board still: a picture helps here"
        return {"corners": m.ravel().tolist(), "take": take, "words": words}

    def _helps(self, m: Array, size: tuple[int, int]) -> tuple[bool, str]:
        """Say whether a photograph with these corners would help, and if not what would."""
        so_far = self.dropped.corners_of(size)
        cell = max(size) / 8
        if so_far and min(_apart(m, other) for other in so_far) < _OTHER * cell:
            return False, f"there is such a photograph already{self._wish()}"
        found = self.dropped.found
        if found is None or found.next_view is None or found.calibration.size != size:
            new = covered_cells(m, size)
            if so_far:
                new &= ~covered_cells(so_far, size)
            return bool(new.any()) or len(so_far) < 4, "hold the board where no dots are"
        board = self.dropped.board
        try:
            G = pose_from_view(found.camera, board.points, m)
            left = left_with(found.calibration, G)
        except CvnotesError:
            return False, "this view of the board cannot be judged"
        now, best = found.next_view.before, found.next_view.after
        helps = np.log(now / left) >= _PART * np.log(now / best)
        return bool(helps), f"another view would help more{self._wish()}"

    def _wish(self) -> str:
        found = self.dropped.found
        return f": {found.next_view.words}" if found and found.next_view else ""


def _apart(m: Array, other: Array) -> float:
    """How far corners lie from others (root mean square, px), whichever way round both are told."""
    squares = [((m - way) ** 2).sum(axis=1) for way in (other, other[::-1])]
    return float(np.sqrt(min(np.nanmean(each) for each in squares)))


def _in_order(m: Array, corners: tuple[int, int]) -> Array:
    """Tell corners from left to right as the board does, not as in a mirror."""
    columns, rows = corners
    lattice = m.reshape(rows, columns, 2)
    (x, y), (u, v) = lattice[0, -1] - lattice[0, 0], lattice[-1, 0] - lattice[0, 0]
    return m if x * v - y * u > 0 else lattice[:, ::-1].reshape(-1, 2)
