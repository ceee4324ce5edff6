"""Photographs, and the board that was detected in each of them, or the reason why not."""

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CornersNotFound, DegenerateError, FileError
from cvnotes.base.parallel import in_order
from cvnotes.base.writing import PathLike, printable
from cvnotes.calibration.thresholds import OTHER_BOARDS
from cvnotes.files import Photo, Reason, Rejected
from cvnotes.files.decoding import VIDEOS, header_size
from cvnotes.files.ownership import photographs as listed_photographs
from cvnotes.files.photos import fingerprint, open_photo, usual_size
from cvnotes.files.reasons import Copy, OtherSize, Unreadable
from cvnotes.files.video import Progress, frames_of, unseen
from cvnotes.photographs.reasons import FramesTaken, LeftOut, NoBoard
from cvnotes.targets import CharucoBoard, Chessboard, find_corners
from cvnotes.targets.finding import count_corners
from cvnotes.targets.grey import grey_picture
from cvnotes.targets.markers import find_numbered, one_thread_each

Board = Chessboard | CharucoBoard
Given = PathLike | Photo | npt.ArrayLike  # one photograph, or a folder of them

_THUMBNAIL = 480  # px wide
_WORTH_THREADS = 500_000  # pixels; of smaller pictures threads mostly wait for the interpreter
_AT_ONCE, _PIXELS_AT_ONCE = 8, 80_000_000  # a pixel takes about 12 bytes while it is looked at
_SURE = 3  # photographs that agree on the board's count


@dataclass(frozen=True, eq=False)
class Detection:
    """A photograph in which the board was looked for; its pixels are not kept.

    Parameters
    ----------
    path : Path
        Where it is, or what it is called.
    size : (width, height)
        Its size in pixels.
    thumbnail : ndarray of uint8, shape (h, w)
        A small copy.
    corners : ndarray, shape (n, 2), or None
        Where the board's corners are in the photograph, NaN for those that cannot be seen; None
        if it is not used.
    turned : bool
        Whether its EXIF data ask for a rotation (which is not carried out).
    note : str
        What was done to it when it was read.
    reason : Reason or None
        Why it is not used.
    found : ndarray, shape (n, 2), or None
        What was taken for the board where it is not to be trusted.
    pixels : bytes
        What its pixels are known by.
    astray : tuple of float
        Of corners that were left out, by how many pixels each missed its place.
    """

    path: Path
    size: tuple[int, int]
    thumbnail: npt.NDArray[np.uint8]
    corners: Array | None
    turned: bool = False
    note: str = ""
    reason: Reason | None = None
    found: Array | None = None
    pixels: bytes = b""
    astray: tuple[float, ...] = ()

    @property
    def seen(self) -> npt.NDArray[np.bool_]:
        """Which corners (n,) can be seen."""
        corners = np.zeros((0, 2)) if self.corners is None else self.corners
        return np.asarray(np.isfinite(corners).all(-1))

    def on_thumbnail(self, m: Array) -> Array:
        """Return where pixels (n, 2) of the photograph lie on the thumbnail."""
        # Pixel centres are integers, so the picture's edge lies at −½ in both.
        return np.asarray((m + 0.5) * self.thumbnail.shape[1] / self.size[0] - 0.5)

    def without(self, reason: Reason) -> "Detection":
        """Return the same, not to be used; what was found is still known."""
        return replace(self, corners=None, found=self.corners, reason=reason)

    def without_corners(self, astray: npt.NDArray[np.bool_], distances: Array) -> "Detection":
        """Return the same without some (n,) of its corners, which miss their places so far."""
        if self.corners is None or not astray.any():
            return self
        corners = np.where(astray[:, None], np.nan, self.corners)
        return replace(self, corners=corners, astray=(*self.astray, *distances[astray].tolist()))


@dataclass(frozen=True, eq=False)
class Photographs:
    """All photographs of one calibration.

    Parameters
    ----------
    board : Chessboard or CharucoBoard
        What was photographed.
    looked_at : sequence of Detection
        Those in which the board was looked for, found or not.
    rejected : sequence of Rejected
        All that are not used, with their reasons.
    counted : bool
        Whether the board's corners were counted in them.
    """

    board: Board
    looked_at: Sequence[Detection]
    rejected: Sequence[Rejected] = ()
    counted: bool = False

    @property
    def used(self) -> list[Detection]:
        """Those that show the board."""
        return [photo for photo in self.looked_at if photo.corners is not None]

    @property
    def size(self) -> tuple[int, int]:
        """Their (width, height)."""
        return self.looked_at[0].size

    @property
    def counts(self) -> Counter[tuple[int, int]]:
        """Inner corners of the boards that are there, (more, fewer): in how many photographs."""
        without = [photo.reason for photo in self.looked_at if isinstance(photo.reason, NoBoard)]
        there = Counter({self._asked: len(self.looked_at) - len(without)})
        there.update(reason.error.count for reason in without if reason.error.count)
        return there

    @property
    def instead(self) -> tuple[int, int] | None:
        """Inner corners of another board, which half as many photographs show as the one asked for.

        A smaller one does not count where that was found: it is the same, cut off. Nor does what
        one of many shows.
        """
        counts, asked = self.counts, self._asked
        found = counts.pop(asked)
        others = [c for c in counts if not found or c[0] > asked[0] or c[1] > asked[1]]
        other = max(others, key=lambda each: counts[each], default=asked)
        told = counts[other] > OTHER_BOARDS * found and counts[other] >= min(2, len(self.looked_at))
        return other if told else None

    @property
    def markers(self) -> str:
        """Which markers stand on another board that is there, or ""."""
        reasons = [photo.reason for photo in self.looked_at]
        return max((r.error.markers for r in reasons if isinstance(r, NoBoard)), default="")

    @property
    def _asked(self) -> tuple[int, int]:
        columns, rows = self.board.corners
        if isinstance(self.board, CharucoBoard):  # which stands one way only
            return columns, rows
        return max(columns, rows), min(columns, rows)

    def correspondences(self) -> tuple[Array | list[Array], list[Array]]:
        """Return the points of the board and their pixels, of those that are used.

        One set of points (n, 3) if all of them can be seen in all photographs, else one for each.
        """
        used = [(photo.corners, photo.seen) for photo in self.used if photo.corners is not None]
        m = [corners[seen] for corners, seen in used]
        if all(seen.all() for _, seen in used):
            return self.board.points, m
        return [self.board.points[seen] for _, seen in used], m

    def without(self, reasons: dict[int, Reason]) -> "Photographs":
        """Return them without some of the used ones: reasons by their number among these."""
        if not reasons:
            return self
        lost = {self.used[i].path: reason for i, reason in reasons.items()}
        return replace(
            self,
            looked_at=[
                photo.without(lost[photo.path]) if photo.path in lost else photo
                for photo in self.looked_at
            ],
            rejected=[*self.rejected, *(_no(path, reason) for path, reason in lost.items())],
        )

    def without_corners(self, astray: npt.NDArray[np.bool_], distances: Array) -> "Photographs":
        """Return them without some corners of the used ones; both arrays are (n_used, n)."""
        if not astray.any():
            return self
        far = zip(self.used, astray, distances, strict=True)
        changed = {photo.path: photo.without_corners(a, d) for photo, a, d in far}
        return replace(self, looked_at=[changed.get(p.path, p) for p in self.looked_at])

    def named(self) -> tuple[list[str], list[Rejected]]:
        """Return the names of the used ones, and the rejected, without their common folder."""
        used = [printable(photo.path) for photo in self.used]
        every = [*used, *(r.file for r in self.rejected)]
        try:
            common = os.path.commonpath([Path(file).parent for file in every])
        except ValueError:  # some are absolute and some are not
            return used, list(self.rejected)
        short = [str(Path(file).relative_to(common)) for file in every]
        lost = zip(short[len(used) :], self.rejected, strict=True)
        return short[: len(used)], [Rejected(name, r.reason) for name, r in lost]


# --- which photographs ---------------------------------------------------------------------------


def listed(
    given: Iterable[Given] | PathLike,
    leave_out: Iterable[PathLike] = (),
    progress: Progress = unseen,
) -> tuple[list[Path | Photo], list[Rejected]]:
    """List photographs that were given as files, folders or arrays, without those to leave out.

    Of a video that is named, frames are taken.

    Raises
    ------
    FileError
        There are none, or none with the name of one to leave out.
    """
    given = [given] if isinstance(given, str | os.PathLike) else list(given)
    paths = [item for item in given if isinstance(item, str | os.PathLike)]
    videos = [path for path in map(Path, paths) if path.suffix.lower() in VIDEOS]
    frames, rejected = _taken_from(videos, progress)
    files, not_read = listed_photographs(
        [str(path) for path in paths if Path(path) not in videos], straightened=True
    )
    rejected += not_read
    arrays = [
        item if isinstance(item, Photo) else Photo(Path(name), grey_picture(item, name))
        for name, item in ((f"photograph {i}", item) for i, item in enumerate(given))
        if not isinstance(item, str | os.PathLike)
    ]
    arrays += frames
    if not files and not rejected and not arrays:
        raise FileError(f"no photographs in {', '.join(map(printable, paths))}")
    every: list[Path | Photo] = [*files, *arrays]
    unwanted = {path for name in leave_out for path in _called(name, map(_path, every))}
    rejected += [_no(_path(item), LeftOut()) for item in every if _path(item) in unwanted]
    return [item for item in every if _path(item) not in unwanted], rejected


def _taken_from(videos: Sequence[Path], progress: Progress) -> tuple[list[Photo], list[Rejected]]:
    """Take the frames of videos, and say how many."""
    frames: list[Photo] = []
    said = []
    for path in videos:
        try:
            taken, n = frames_of(path, progress)
        except FileError as error:
            said.append(_no(path, Unreadable(str(error))))
        else:
            frames += taken
            said.append(_no(path, FramesTaken(len(taken), n)))
    return frames, said


def _called(name: PathLike, paths: Iterable[Path]) -> list[Path]:
    """List the photographs that go by a name, of which there must be one."""
    paths = list(paths)
    exact = [path for path in paths if path.resolve() == Path(name).resolve()]
    found = exact or [path for path in paths if path.name == str(name)]
    if not found:
        raise FileError(f"leave out {printable(name)}: none of the photographs has this name")
    return found


def _path(item: Path | Photo) -> Path:
    return item.path if isinstance(item, Photo) else item


def _no(path: Path, reason: Reason) -> Rejected:
    return Rejected(printable(path), reason)


# --- the board in each of them -------------------------------------------------------------------


def count(photos: Sequence[Path | Photo], rejected: Sequence[Rejected] = ()) -> tuple[int, int]:
    """Count the inner corners (columns, rows) of the board in photographs: as most of them show.

    Raises
    ------
    DegenerateError
        There is no board in any of them; or none can be read, as all that are `rejected` could not.
    """
    counting = Counting()
    for found in in_order(count_in, photos, workers=_workers(photos)):
        if counting.add(found):
            return counting.most
    try:
        return counting.most
    except DegenerateError:
        opened = [item if isinstance(item, Photo) else open_photo(item) for item in photos]
        unread = [*rejected, *(photo for photo in opened if isinstance(photo, Rejected))]
        if len(unread) < len(rejected) + len(photos):
            raise
        raise DegenerateError(f"{unread[0].file}: {unread[0].reason}") from None


class Counting:
    """Counts the inner corners of a board, in one photograph after the other.

    Examples
    --------
    >>> counting = Counting()
    >>> [counting.add(found) for found in ((9, 6), None, (8, 6), (9, 6), (9, 6))]
    [False, False, False, False, True]
    >>> counting.most
    (9, 6)
    """

    def __init__(self) -> None:
        self._seen: Counter[tuple[int, int]] = Counter()

    def add(self, found: tuple[int, int] | None) -> bool:
        """Add what one of them shows, if anything; tell whether enough of them agree."""
        self._seen.update([found] if found else [])
        return found is not None and self._seen[found] == _SURE

    @property
    def most(self) -> tuple[int, int]:
        """Inner corners (columns, rows), as most of them show.

        Raises
        ------
        DegenerateError
            There is no board in any of them.
        """
        if not self._seen:
            raise DegenerateError("no chessboard with 3×3 inner corners or more was found in any")
        return self._seen.most_common(1)[0][0]


def count_in(item: Path | Photo) -> tuple[int, int] | None:
    """Count the inner corners of the board in one photograph, if there is one."""
    photo = item if isinstance(item, Photo) else open_photo(item, grey=True)
    return None if isinstance(photo, Rejected) else count_corners(photo.grey)


def probed(photos: Sequence[Path | Photo], board: CharucoBoard) -> CharucoBoard:
    """Return the board with the pattern that the first photograph shows in which it can be told.

    Raises
    ------
    DegenerateError
        The first two photographs that have markers have those of another dictionary.
    """
    other = ""
    for item in photos:
        photo = item if isinstance(item, Photo) else open_photo(item, grey=True)
        if isinstance(photo, Rejected):
            continue
        seen = find_numbered(photo.grey, *board.read_by)
        if other and seen.other == other:
            raise DegenerateError(
                f"the first photographs have markers of {other}, not {board.dictionary}: "
                "was the board made with these?"
            )
        other = seen.other
        if seen.legacy is not None:
            return replace(board, legacy=seen.legacy)
    return board


def detect_all(photos: Sequence[Path | Photo], board: Board) -> Iterator[Detection | Rejected]:
    """Look for the board in all photographs, on all cores."""
    with one_thread_each():
        yield from in_order(lambda item: detect(item, board), photos, workers=_workers(photos))


def detect(item: Path | Photo, board: Board) -> Detection | Rejected:
    """Look for the board in one photograph; those that cannot be read are rejected."""
    photo = item if isinstance(item, Photo) else open_photo(item, grey=True)
    if isinstance(photo, Rejected):
        return photo
    corners, found, reason = None, None, None
    try:
        corners = find_corners(photo.grey, board, partial=True)
    except CornersNotFound as error:
        found, reason = error.found, NoBoard(error)
    return Detection(
        path=photo.path,
        size=photo.size,
        thumbnail=_thumbnail(photo),
        corners=corners,
        turned=photo.orientation != 1,
        note=photo.note,
        reason=reason,
        found=found,
        pixels=fingerprint(photo),
    )


def _thumbnail(photo: Photo) -> npt.NDArray[np.uint8]:
    from PIL import Image

    width, height = photo.size
    shrink = min(1.0, _THUMBNAIL / max(width, height))
    small = (max(round(width * shrink), 1), max(round(height * shrink), 1))
    return np.asarray(Image.fromarray(photo.grey).resize(small, Image.Resampling.BOX))


def _workers(photos: Sequence[Path | Photo]) -> int:
    """Return how many photographs to look at at once: as many as cores, or as memory holds.

    Small ones come one after the other: two threads save a twentieth of the time, and cost as much
    of the processor's.
    """
    if not photos:
        return 1
    first = photos[0]
    width, height = first.size if isinstance(first, Photo) else header_size(first)
    if width * height < _WORTH_THREADS:
        return 1
    return max(1, min(os.cpu_count() or 1, _AT_ONCE, _PIXELS_AT_ONCE // (width * height)))


# --- those of one camera -------------------------------------------------------------------------


def sorted_out(
    board: Board,
    seen: Iterable[Detection | Rejected],
    rejected: Sequence[Rejected] = (),
    *,
    counted: bool = False,
) -> Photographs:
    """Put photographs together: of the size that most have, none twice, each other with a reason.

    Parameters
    ----------
    board : Chessboard or CharucoBoard
        What was photographed.
    seen : iterable of Detection or Rejected
        What came out for each photograph, in order.
    rejected : sequence of Rejected
        Those that are out already.
    counted : bool
        Whether the board's corners were counted in them.
    """
    seen, rejected = list(seen), list(rejected)
    looked_at: list[Detection] = []
    first: dict[bytes, Path] = {}
    usual = usual_size([item.size for item in seen if isinstance(item, Detection)])
    for item in seen:
        if isinstance(item, Rejected):
            rejected.append(item)
        elif (same := first.setdefault(item.pixels, item.path)) != item.path:
            rejected.append(_no(item.path, Copy(printable(same))))
        elif item.size != usual:
            rejected.append(_no(item.path, OtherSize(item.size, usual)))
        else:
            looked_at.append(item)
            if item.reason is not None:
                rejected.append(_no(item.path, item.reason))
    return Photographs(board, looked_at, rejected, counted)
