"""The photographs of a calibration: which of them show the board, and why the others do not."""

import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CornersNotFound, DegenerateError, FileError
from cvnotes.commands.console import progress
from cvnotes.commands.ownership import photographs
from cvnotes.commands.parallel import in_order
from cvnotes.files import Photo, Rejected, read_photo
from cvnotes.files.decoding import header_size
from cvnotes.files.photos import COPY, fingerprint, open_photo
from cvnotes.files.writing import printable
from cvnotes.targets import CharucoBoard, Chessboard, find_corners
from cvnotes.targets.finding import count_corners
from cvnotes.targets.opencv_finders import one_thread_each

LEFT_OUT = "left out, as asked"
_THUMBNAIL = 480  # px wide
_WORTH_THREADS = 500_000  # pixels; of smaller pictures threads mostly wait for the interpreter
_AT_ONCE, _PIXELS_AT_ONCE = 8, 80_000_000  # a pixel takes about 12 bytes while it is looked at
_SURE = 3  # photographs that agree on the board's count


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
        Where the board's corners are in the photograph, NaN for those that cannot be seen; None
        if it was not found.
    turned : bool
        Whether its EXIF data ask for a rotation (which is not carried out).
    note : str
        What was done to it, or why the board was not found.
    found : ndarray, shape (n, 2), or None
        What a finder took for the board where it is not to be trusted.
    """

    path: Path
    size: tuple[int, int]
    thumbnail: npt.NDArray[np.uint8]
    corners: Array | None
    turned: bool
    note: str
    found: Array | None = None

    @property
    def thumbnail_corners(self) -> Array | None:
        """The corners in pixels of the thumbnail."""
        return None if self.corners is None else self.on_thumbnail(self.corners)

    def on_thumbnail(self, m: Array) -> Array:
        """Give where pixels (n, 2) of the photograph lie on the thumbnail."""
        # Pixel centres are integers, so the picture's edge lies at −½ in both.
        return np.asarray((m + 0.5) * self.thumbnail.shape[1] / self.size[0] - 0.5)


def examine(
    paths: Sequence[str], board: Chessboard | CharucoBoard, *, leave_out: Sequence[str] = ()
) -> tuple[list[Examined], list[Rejected]]:
    """Look for the board in photographs; gives those looked at, and those that cannot be used.

    A photograph without the board is in both lists. Those to leave out are named by their paths or
    by their names alone.
    """
    files, rejected = _photographs(paths)
    unwanted = {path for name in leave_out for path in _named(name, files)}
    rejected += [Rejected(printable(path), LEFT_OUT) for path in files if path in unwanted]
    files = [path for path in files if path not in unwanted]
    examined = []
    first: dict[bytes, Path] = {}
    with one_thread_each():
        found = in_order(lambda path: look_at(path, board), files, workers=_workers(files))
        looked = list(progress(found, total=len(files)))
    for path, (content, item) in zip(files, looked, strict=True):
        same = first.setdefault(content, path)
        if isinstance(item, Rejected):
            rejected.append(item)
        elif same != path:
            rejected.append(Rejected(printable(path), f"{COPY} {printable(same)}"))
        else:
            examined.append(item)
            if item.corners is None:
                rejected.append(Rejected(printable(path), item.note))
    return examined, rejected


def _named(name: str, files: Sequence[Path]) -> list[Path]:
    """List the files that go by a name, of which there must be one."""
    exact = [path for path in files if path.resolve() == Path(name).resolve()]
    found = exact or [path for path in files if path.name == name]
    if not found:
        raise FileError(f"--leave-out {printable(name)}: none of the photographs has this name")
    return found


def counted(paths: Sequence[str]) -> tuple[int, int]:
    """Count the inner corners (columns, rows) of the board in photographs: as most of them show.

    Raises
    ------
    DegenerateError
        There is no board in any of them.
    """
    files, _ = _photographs(paths)
    counts: Counter[tuple[int, int]] = Counter()
    for count in in_order(_count, files, workers=_workers(files)):
        counts.update([count] if count else [])
        if counts and counts.most_common(1)[0][1] == _SURE:
            break
    if not counts:
        raise DegenerateError("no chessboard with 3×3 inner corners or more was found in any")
    return counts.most_common(1)[0][0]


def _workers(files: Sequence[Path]) -> int:
    """Say how many photographs may be looked at at once: as many as cores, or as memory holds.

    Small ones come one after the other: two threads save a twentieth of the time, and cost as much
    of the processor's.
    """
    if not files:
        return 1
    width, height = header_size(files[0])
    if width * height < _WORTH_THREADS:
        return 1
    return max(1, min(os.cpu_count() or 1, _AT_ONCE, _PIXELS_AT_ONCE // (width * height)))


def _count(path: Path) -> tuple[int, int] | None:
    try:
        return count_corners(read_photo(path).grey)
    except FileError:
        return None


def _photographs(paths: Sequence[str]) -> tuple[list[Path], list[Rejected]]:
    files, rejected = photographs(paths, straightened=True)
    if not files and not rejected:
        raise FileError(f"no photographs in {', '.join(map(printable, paths))}")
    return files, rejected


def look_at(path: Path, board: Chessboard | CharucoBoard) -> tuple[bytes, Examined | Rejected]:
    """Read and examine one photograph; gives what its pixels are known by, and what was seen."""
    photo = open_photo(path, grey=True)
    if isinstance(photo, Rejected):
        return bytes(path), photo
    return fingerprint(photo), _examine(photo, board)


def _examine(photo: Photo, board: Chessboard | CharucoBoard) -> Examined:
    corners, found, note = None, None, photo.note
    try:
        corners = find_corners(photo.grey, board, partial=True)
        lost = np.count_nonzero(np.isnan(corners[:, 0]))
        hidden = f"{lost} of {len(corners)} corners left out: they cannot be seen clearly"
        note = "; ".join(filter(None, [photo.note, hidden if lost else ""]))
    except CornersNotFound as error:
        found, note = error.found, str(error)
    return Examined(
        photo.path, photo.size, _thumbnail(photo), corners, photo.orientation != 1, note, found
    )


def _thumbnail(photo: Photo) -> npt.NDArray[np.uint8]:
    from PIL import Image

    width, height = photo.size
    shrink = min(1.0, _THUMBNAIL / max(width, height))
    small = (max(round(width * shrink), 1), max(round(height * shrink), 1))
    return np.asarray(Image.fromarray(photo.grey).resize(small, Image.Resampling.BOX))
