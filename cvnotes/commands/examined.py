"""The photographs of a calibration: which of them show the board, and why the others do not."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CornersNotFound, FileError
from cvnotes.commands.console import progress
from cvnotes.commands.ownership import photographs
from cvnotes.files import Photo, Rejected, open_photos
from cvnotes.files.writing import printable
from cvnotes.targets import Chessboard

_THUMBNAIL = 480  # px wide


@dataclass(frozen=True, eq=False)
class Examined:
    """A photograph in which the board was looked for; its pixels are not kept.

    Parameters
    ----------
    path : Path
        Where it is.
    size : (width, height)
        Its size in pixels.
    thumbnail : ndarray of uint8, shape (h, w)
        A small copy.
    corners : ndarray, shape (n, 2), or None
        Where the board's corners are in the photograph; None if it was not found.
    turned : bool
        Whether its EXIF data ask for a rotation (which is not carried out).
    note : str
        What was done to it, or why the board was not found.
    """

    path: Path
    size: tuple[int, int]
    thumbnail: npt.NDArray[np.uint8]
    corners: Array | None
    turned: bool
    note: str

    @property
    def thumbnail_corners(self) -> Array | None:
        """The corners in pixels of the thumbnail."""
        if self.corners is None:
            return None
        # Pixel centres are integers, so the picture's edge lies at −½ in both.
        return np.asarray((self.corners + 0.5) * self.thumbnail.shape[1] / self.size[0] - 0.5)


def examine(paths: Sequence[str], board: Chessboard) -> tuple[list[Examined], list[Rejected]]:
    """Look for the board in photographs; gives those looked at, and those that cannot be used.

    A photograph without the board is in both lists.
    """
    files, rejected = photographs(paths, straightened=True)
    if not files and not rejected:
        raise FileError(f"no photographs in {', '.join(map(printable, paths))}")
    examined = []
    for photo in progress(open_photos(files), total=len(files)):
        if isinstance(photo, Photo):
            examined.append(_examine(photo, board))
            if examined[-1].corners is None:
                rejected.append(Rejected(printable(photo.path), examined[-1].note))
        else:
            rejected.append(photo)
    return examined, rejected


def _examine(photo: Photo, board: Chessboard) -> Examined:
    from cvnotes.targets import find_corners

    try:
        corners, note = find_corners(photo.grey, board), photo.note
    except CornersNotFound as error:
        corners, note = None, str(error)
    return Examined(
        photo.path, photo.size, _thumbnail(photo), corners, photo.orientation != 1, note
    )


def _thumbnail(photo: Photo) -> npt.NDArray[np.uint8]:
    from PIL import Image

    width, height = photo.size
    shrink = min(1.0, _THUMBNAIL / max(width, height))
    small = (max(round(width * shrink), 1), max(round(height * shrink), 1))
    return np.asarray(Image.fromarray(photo.grey).resize(small, Image.Resampling.BOX))
