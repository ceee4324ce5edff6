"""`cvnotes calibrate` for a page: photographs come one by one, and each is answered at once.

The page "Calibrate your camera" of the site runs this in the browser; what it makes are the files
that the command writes, to the same digits.
"""

import argparse
import io
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError, DegenerateError
from cvnotes.calibration import Calibration, NextView
from cvnotes.commands.calibrate import (
    asked_board,
    calibrated,
    contents_of,
    proposal_of,
    without_misfits,
)
from cvnotes.commands.examined import Examined, look_at
from cvnotes.commands.mirrored import doubted, mirrored
from cvnotes.commands.report import camera_report, doubts, photo_table
from cvnotes.files import Rejected
from cvnotes.files.photos import COPY
from cvnotes.files.writing import printable


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
        self.asked = argparse.Namespace(
            corners=(columns, rows), square=square, charuco=None, marker=None, skew=False
        )
        self.board = asked_board(self.asked)
        self.examined: dict[str, Examined] = {}
        self.rejected: dict[str, Rejected] = {}
        self.first: dict[bytes, str] = {}  # photograph by its pixels
        self.known: tuple[Calibration, NextView | None] | None = None

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
        content, item = look_at(Path(path), self.board)
        if isinstance(item, Rejected):
            return self._refuse(name, item.reason)
        same = self.first.setdefault(content, name)
        if same != name:
            return self._refuse(name, f"{COPY} {printable(same)}")
        self.examined[name] = item
        shown = {
            "name": name,
            "used": item.corners is not None,
            "words": item.note,
            "size": list(item.size),
            "png": _png(item),
            "corners": [],
        }
        if item.thumbnail_corners is not None:
            seen = item.thumbnail_corners[np.isfinite(item.thumbnail_corners).all(-1)]
            shown["corners"] = seen.ravel().tolist()
        else:
            self.rejected[name] = Rejected(printable(name), item.note)
        return shown

    def forget(self, name: str) -> None:
        """Leave a photograph out again."""
        self.examined.pop(name, None)
        self.rejected.pop(name, None)
        self.first = {content: other for content, other in self.first.items() if other != name}

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
        self.known = None
        examined, rejected = self._of_one_size()
        used = [photo for photo in examined if photo.corners is not None]
        asked = argparse.Namespace(**vars(self.asked), lens=lens, board_shape="auto")
        try:
            result = calibrated(used, self.board, asked)
        except DegenerateError as error:
            raise CvnotesError(f"{len(used)} usable photographs; {error}") from None
        result, used, misfits = without_misfits(result, used, self.board, asked)
        examined = [misfits.get(photo.path, photo) for photo in examined]
        rejected += [Rejected(printable(path.name), at.note) for path, at in misfits.items()]
        result = doubted(result, mirrored(used, result, self.board))
        names, notes = [printable(photo.path.name) for photo in used], [p.note for p in used]
        proposal = proposal_of(result, self.board)
        self.known = result, proposal
        return {
            "used": [photo.path.name for photo in used],
            "unlike": self._unlike() | {path.name: at.note for path, at in misfits.items()},
            "report": camera_report(result),
            "table": photo_table(names, notes, rejected, result),
            "doubts": doubts(result, examined, names, rejected, self.board),
            "reliable": result.reliable,
            "next": str(proposal) if proposal else "",
            "parameters": [list(row) for row in result.table()],
            "files": contents_of(result, examined, self.board, names, rejected, proposal),
        }

    def corners_of(self, size: tuple[int, int]) -> list[Array]:
        """Give the corners (n, 2) in all photographs of a size, NaN for those that are hidden."""
        seen = [photo for photo in self.examined.values() if photo.size == size]
        return [photo.corners for photo in seen if photo.corners is not None]

    def _of_one_size(self) -> tuple[list[Examined], list[Rejected]]:
        """Give the photographs of the size that most have; the others are refused."""
        unlike = self._unlike()
        rejected = list(self.rejected.values())
        for name, words in unlike.items():
            if name not in self.rejected:
                rejected.append(Rejected(printable(name), words))
        return [p for name, p in self.examined.items() if name not in unlike], rejected

    def _unlike(self) -> dict[str, str]:
        """Say of each photograph that has not the size of most what size it has."""
        sizes = Counter(photo.size for photo in self.examined.values())
        size = sizes.most_common(1)[0][0] if sizes else (0, 0)
        return {
            name: _SIZE.format(*photo.size, *size)
            for name, photo in self.examined.items()
            if photo.size != size
        }

    def _refuse(self, name: str, reason: str) -> dict[str, Any]:
        self.rejected[name] = Rejected(printable(name), reason)
        return {"name": name, "used": False, "words": reason}


_SIZE = "{}×{} pixels where most photographs have {}×{}"


def _png(photo: Examined) -> bytes:
    from PIL import Image

    packed = io.BytesIO()
    Image.fromarray(photo.thumbnail).save(packed, "PNG")
    return packed.getvalue()
