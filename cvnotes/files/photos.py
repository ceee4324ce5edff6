"""Photographs, read without trust: each is a picture of known size, or has a reason why not.

Everything is in the sensor's frame: a rotation in the EXIF data is reported but not carried out,
so that pictures of one camera share one K however it was held. (``cv2.imread`` does rotate,
unless asked for ``IMREAD_IGNORE_ORIENTATION``.)
"""

import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import FileError, luma, stretched
from cvnotes.base.writing import PathLike, path_of, printable
from cvnotes.files.decoding import decode, header_size
from cvnotes.files.reasons import Copy, OtherSize, Rejected, Unreadable


@dataclass(frozen=True, eq=False)
class Photo:
    """A photograph in the sensor's frame.

    Parameters
    ----------
    path : Path
        Where it came from.
    image : ndarray of uint8 or uint16, shape (height, width) or (height, width, 3)
        Grey values or RGB, as stored; alpha is dropped, palettes and CMYK are converted.
    orientation : int
        The EXIF orientation, 1 to 8; 1 is upright. Not applied to `image`.
    note : str
        What was done to the picture on the way, or empty.

    Examples
    --------
    >>> Photo(Path("a.png"), np.zeros((480, 640), np.uint8)).size
    (640, 480)
    """

    path: Path
    image: npt.NDArray[Any]
    orientation: int = 1
    note: str = ""

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        return self.image.shape[1], self.image.shape[0]

    @cached_property
    def grey(self) -> npt.NDArray[np.uint8]:
        """Grey values (height, width), uint8: what corners are found in.

        16-bit pictures are stretched from their darkest to their brightest thousandth, because
        many hold 10 or 12 bits only.
        """
        return stretched(luma(self.image) if self.image.ndim == 3 else self.image)


def read_photo(path: PathLike) -> Photo:
    """Read one photograph.

    Raises
    ------
    FileError
        It is no regular file, empty, foreign, damaged, cut off or too large; the message says
        which. Sizes are checked before anything is decoded.
    """
    try:
        return _read(path_of(path))
    except FileError as error:
        raise FileError(f"{printable(path)}: {error}") from error


def read_photos(paths: Iterable[PathLike] | PathLike) -> tuple[list[Photo], list[Rejected]]:
    """Read photographs that can be calibrated together, all of them into memory.

    Parameters
    ----------
    paths : path, or iterable of paths
        Files, and folders, of which all files are taken in natural order (not those of their
        sub-folders).

    Returns
    -------
    photos : list of Photo
        All of one size: the size of most.
    rejected : list of Rejected
        The others, each with its reason. Nothing is dropped without one.
    """
    files, rejected = list_photos(paths)
    read = list(open_photos(files))
    photos = [item for item in read if isinstance(item, Photo)]
    return photos, rejected + [item for item in read if isinstance(item, Rejected)]


def list_photos(
    paths: Iterable[PathLike] | PathLike, *, size: tuple[int, int] | None = None
) -> tuple[list[Path], list[Rejected]]:
    """Find the photographs among files and in folders, by their headers alone.

    Gives those of a (width, height), by default that of most, and the others with their reasons.
    """
    sizes: dict[Path, tuple[int, int]] = {}
    rejected = []
    for path in dict.fromkeys(_expanded(paths)):
        try:
            sizes[path] = header_size(path)
        except FileError as error:
            rejected.append(Rejected(printable(path), Unreadable(str(error))))
    expected = size or usual_size(sizes.values())
    rejected += [
        Rejected(printable(path), OtherSize(own, expected, of_camera=size is not None))
        for path, own in sizes.items()
        if own != expected
    ]
    return [path for path in sizes if sizes[path] == expected], rejected


def usual_size(sizes: Iterable[tuple[int, int]]) -> tuple[int, int]:
    """Return the (width, height) that most photographs have."""
    return Counter(sizes or [(0, 0)]).most_common(1)[0][0]


def open_photos(files: Iterable[Path]) -> Iterator[Photo | Rejected]:
    """Read photographs one after the other; a picture seen before is rejected as a copy."""
    seen: dict[bytes, Path] = {}
    for path in files:
        photo = open_photo(path)
        first = path if isinstance(photo, Rejected) else seen.setdefault(fingerprint(photo), path)
        if first != path:
            yield Rejected(printable(path), Copy(printable(first)))
        else:
            yield photo


def open_photo(path: Path, *, grey: bool = False) -> Photo | Rejected:
    """Read a photograph, or say why not; for its `grey` alone, a JPEG in half the time."""
    try:
        return _read(path, grey=grey)
    except FileError as error:
        return Rejected(printable(path), Unreadable(str(error)))


def fingerprint(photo: Photo) -> bytes:
    """Return a few bytes by which a photograph's pixels are known, whatever its name and format."""
    return blake2b(np.ascontiguousarray(photo.image).data, digest_size=16).digest()


def _expanded(paths: Iterable[PathLike] | PathLike) -> Iterator[Path]:
    paths = [paths] if isinstance(paths, str | os.PathLike) else paths
    for path in map(path_of, paths):
        try:
            inside = sorted(path.iterdir(), key=_natural) if path.is_dir() else [path]
        except OSError:
            inside = [path]
        yield from inside


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sort left2 before left10."""
    parts = re.split(r"([0-9]+)", path.name.lower())
    return [(int(part), "") if i % 2 else (0, part) for i, part in enumerate(parts)]


def _read(path: Path, *, grey: bool = False) -> Photo:
    image, orientation, notes = decode(path, grey=grey)
    if orientation != 1:
        notes.append(f"EXIF orientation {orientation} not applied: sensor frame")
    return Photo(path, image, orientation, "; ".join(notes))
