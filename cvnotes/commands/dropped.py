"""`cvnotes calibrate` for a page: photographs come one by one, and each is answered at once.

The page "Calibrate your camera" of the site runs this in the browser; what it makes are the files
that the command writes, to the same digits.
"""

import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.base.writing import printable
from cvnotes.commands.calibrate import contents_of
from cvnotes.commands.report import camera_report, note_of, photo_table
from cvnotes.files import Reason, Rejected
from cvnotes.files.reasons import Copy
from cvnotes.photographs import (
    CalibratedPhotographs,
    Detection,
    Model,
    calibrate_detected,
    detect,
)
from cvnotes.photographs.detection import sorted_out
from cvnotes.photographs.driver import chessboard


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
            "words": str(item.reason or note_of(item)),
            "size": list(item.size),
            "png": _png(item),
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
            The names that were ``used``, and why others were not after all (``unlike``: words by
            name); the ``report`` and the ``table`` of photographs as the command prints them, what
            is doubtful (``doubts``), whether it is ``reliable``, where the ``next`` photograph
            should be, the ``parameters`` with value and deviation, and the ``files``: contents by
            name.

        Raises
        ------
        CvnotesError
            The photographs do not determine a camera.
        """
        self.found = None
        together = sorted_out(self.board, self.seen.values())
        self.found = found = calibrate_detected(together, Model(lens=lens))
        used = [photo.path.name for photo in found.photographs.used]
        shown = {photo.path.name for photo in self._detections() if photo.corners is not None}
        lost = {r.file: str(r.reason) for r in found.photographs.rejected}
        return {
            "used": used,
            "unlike": {name: lost[printable(name)] for name in sorted(shown - set(used))},
            "report": camera_report(found.calibration),
            "table": photo_table(found.photographs, found.calibration),
            "doubts": found.doubts,
            "reliable": found.reliable,
            "next": str(found.next_view) if found.next_view else "",
            "parameters": [list(row) for row in found.calibration.table()],
            "files": contents_of(found),
        }

    def corners_of(self, size: tuple[int, int]) -> list[Array]:
        """Return the corners (n, 2) in all photographs of a size, NaN for those that are hidden."""
        seen = (photo for photo in self._detections() if photo.size == size)
        return [photo.corners for photo in seen if photo.corners is not None]

    def _detections(self) -> list[Detection]:
        return [item for item in self.seen.values() if isinstance(item, Detection)]

    def _refuse(self, name: str, reason: Reason) -> dict[str, Any]:
        self.seen[name] = Rejected(printable(name), reason)
        return {"name": name, "used": False, "words": str(reason)}


def _png(photo: Detection) -> bytes:
    from PIL import Image

    packed = io.BytesIO()
    Image.fromarray(photo.thumbnail).save(packed, "PNG")
    return packed.getvalue()
