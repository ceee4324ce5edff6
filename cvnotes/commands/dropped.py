"""`cvnotes calibrate` for a page: photographs come one by one, and each is answered at once.

The page "Calibrate your camera" of the site runs this in the browser; what it makes are the files
that the command writes, to the same digits.
"""

from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cvnotes.base import Array, CornersNotFound, CvnotesError
from cvnotes.base.writing import printable
from cvnotes.commands.calibrate import contents_of
from cvnotes.commands.drawing import encoded
from cvnotes.commands.page import figures, words
from cvnotes.commands.report import camera_report, note_of
from cvnotes.commands.undistort import straightened
from cvnotes.files import Reason, Rejected
from cvnotes.files.photos import open_photo
from cvnotes.files.reasons import Copy, together
from cvnotes.photographs import (
    CalibratedPhotographs,
    Detection,
    Model,
    NoCamera,
    calibrate_detected,
    detect,
)
from cvnotes.photographs.detection import Counting, count_in, sorted_out
from cvnotes.photographs.driver import chessboard
from cvnotes.targets import find_corners
from cvnotes.targets.finding import count_corners
from cvnotes.warping.framing import ideal_camera


class Dropped:
    """The photographs that were dropped on a page, and what is known of each.

    Parameters
    ----------
    columns, rows : int
        Inner corners of the board.
    square : float
        Side of its squares, mm.

    Raises
    ------
    CvnotesError
        There is no such board.
    """

    def __init__(self, columns: int, rows: int, square: float) -> None:
        self.board = chessboard((columns, rows), square)
        self.seen: dict[str, Detection | Rejected] = {}
        self.found: CalibratedPhotographs | None = None

    def look(self, path: str) -> dict[str, Any]:
        """Look for the board in one more photograph.

        Returns
        -------
        dict
            Its ``name``, whether it is ``used``, and if not why, in ``words``; of a photograph that
            can be read its ``size``, a small copy (``png``), and the ``corners`` on that, flat.
        """
        name = Path(path).name
        self.forget(name)
        item = detect(Path(path), self.board)
        if isinstance(item, Rejected):
            return self._refuse(name, item.reason)
        copied = [o for o in self._detections() if o.pixels == item.pixels]
        if copied:
            return self._refuse(name, Copy(printable(copied[0].path)))
        self.seen[name] = item = replace(item, path=Path(name))
        corners = np.zeros((0, 2)) if item.corners is None else item.corners[item.seen]
        return {
            "name": name,
            "used": item.corners is not None,
            "words": item.reason.brief if item.reason else note_of(item),
            "size": list(item.size),
            "png": encoded(item.thumbnail),
            "corners": item.on_thumbnail(corners).ravel().tolist(),
        }

    def forget(self, name: str) -> None:
        """Leave a photograph out again."""
        self.seen.pop(name, None)

    def calibrate(self, lens: str = "auto") -> dict[str, Any]:
        """Calibrate with all photographs that show the board.

        Returns
        -------
        dict
            The names that were ``used``, their ``rms`` in words, and why others were not after all
            (``unlike``: words by name); of the report the ``title``, what is said (``words``) and
            the ``figures``, as HTML; the ``parameters`` with value and deviation, and the
            ``files``: contents by name. Where the photographs determine no camera, why not
            (``error``), and the inner corners that they show ``instead`` of those asked for, if
            any. In both cases ``reasons``: a sentence for all photographs that are not used for the
            same reason.
        """
        self.found = None
        photographs = sorted_out(self.board, self.seen.values())
        try:
            self.found = found = calibrate_detected(photographs, Model(lens=lens))
        except NoCamera as error:
            return {
                "error": str(error),
                "instead": error.photographs.instead,
                "reasons": together(error.photographs.rejected),
            }
        result, used = found.calibration, [photo.path.name for photo in found.photographs.used]
        shown = {photo.path.name for photo in self._detections() if photo.corners is not None}
        lost = {r.file: str(r.reason) for r in found.photographs.rejected}
        title, *blocks = camera_report(result)
        return {
            "used": used,
            "rms": [f"{rms:.3f} px" for rms in result.view_rms],
            "unlike": {name: lost[printable(name)] for name in sorted(shown - set(used))},
            "title": title,
            "words": words(found, blocks),
            "parameters": [list(row) for row in result.table()],
            "figures": "".join(figures(found)),
            "files": contents_of(found),
            "reasons": together(found.photographs.rejected),
        }

    def straighten(self, path: str) -> dict[str, Any]:
        """Take the lens out of a photograph, as ``cvnotes undistort`` does.

        Returns
        -------
        dict
            The ``png`` that the ideal camera with the same A would have taken, and ``words`` on it.

        Raises
        ------
        CvnotesError
            There is no camera yet, or it is no photograph of its size.
        """
        if self.found is None:
            raise CvnotesError("there is no camera yet")
        photo = open_photo(Path(path))
        if isinstance(photo, Rejected):
            raise CvnotesError(str(photo.reason))
        camera = self.found.camera
        png, note = straightened(photo, camera, ideal_camera(camera))
        return {"png": png, "words": note}

    def corners_of(self, size: tuple[int, int]) -> list[Array]:
        """Return the corners (n, 2) in all photographs of a size, NaN for those that are hidden."""
        seen = (photo for photo in self._detections() if photo.size == size)
        return [photo.corners for photo in seen if photo.corners is not None]

    def _detections(self) -> list[Detection]:
        return [item for item in self.seen.values() if isinstance(item, Detection)]

    def _refuse(self, name: str, reason: Reason) -> dict[str, Any]:
        self.seen[name] = Rejected(printable(name), reason)
        return {"name": name, "used": False, "words": str(reason)}


class Unknown:
    """A board whose inner corners are still to be counted, as ``--corners auto`` does."""

    def __init__(self) -> None:
        self.counting = Counting()

    def count(self, path: str) -> dict[str, Any]:
        """Count the corners in one more photograph.

        Returns
        -------
        dict
            The ``corners`` as soon as enough photographs agree, else None; and in ``words`` why
            there are none in this one.
        """
        photo = open_photo(Path(path), grey=True)
        if isinstance(photo, Rejected):
            return {"corners": None, "words": str(photo.reason)}
        found = count_in(photo)
        known = self.counting.add(found)
        return {
            "corners": found if known else None,
            "words": "" if found else "no chessboard found",
        }

    def see(self, grey: bytes, size: tuple[int, int]) -> dict[str, Any]:
        """Count them in a frame of the machine's camera, if the board is seen whole in it.

        Returns what `cvnotes.commands.watching.Watch.see` does, and what was ``counted`` as soon as
        enough frames agree.
        """
        picture = np.frombuffer(grey, np.uint8).reshape(size[::-1])
        found, m = count_corners(picture), np.zeros((0, 2))
        with suppress(CornersNotFound):
            if found and _inside(
                seen := find_corners(picture, chessboard(found, 1.0)), found, size
            ):
                m = seen
        known = self.counting.add(found if len(m) else None)
        return {
            "corners": m.ravel().tolist(),
            "take": False,
            "words": "counting the board's corners" if len(m) else "the board is not seen whole",
            "counted": found if known else None,
        }


def _inside(m: Array, corners: tuple[int, int], size: tuple[int, int]) -> bool:
    """Whether the outer squares of a board with these corners lie in the picture, too."""
    columns, rows = corners
    lattice = m.reshape(rows, columns, 2)
    sides = (lattice, lattice[::-1], lattice.swapaxes(0, 1), lattice[:, ::-1].swapaxes(0, 1))
    outer = np.vstack([2 * side[0] - side[1] for side in sides])
    return bool(((outer >= 0) & (outer < size)).all())


def sheet(columns: int, rows: int, square: float, paper: str) -> bytes:
    """Return the PDF of a board to print, as ``cvnotes target`` writes it."""
    return chessboard((columns, rows), square).sheet(paper).pdf()
