"""Picture files down to pixels, or a reason in words; nothing in a file is trusted."""

import io
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import IO, TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import FileError

if TYPE_CHECKING:
    from PIL.Image import Image

MAX_PIXELS = 80_000_000
MAX_BYTES = 6 * MAX_PIXELS + 1_000_000  # as large as so many pixels can be, uncompressed

_FORMATS = ("JPEG", "PNG", "TIFF", "WEBP", "BMP", "PPM", "GIF")
_CLUTTER = ("thumbs.db", "desktop.ini", "ehthumbs.db")
VIDEOS = (".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".mts", ".3gp")
_HEIF = (".heic", ".heif", ".hif")
_FOREIGN = {
    "AVIF is not read; save it as JPEG or PNG": ".avif",
    "a camera's raw format; save it as TIFF, PNG or JPEG, without lens corrections": (
        ".arw .cr2 .cr3 .dng .nef .orf .pef .raf .raw .rw2 .srw"
    ),
    "a video; name it by itself, and frames of it are taken": " ".join(VIDEOS),
}
_WIDTH, _HEIGHT, _ORIENTATION = 256, 257, 274  # TIFF and EXIF tags


def header_size(path: Path) -> tuple[int, int]:
    """Return (width, height) by a picture's header; raises FileError with the reason alone."""
    _refuse_unopened(path)
    try:
        with path.open("rb") as stream, _opened(stream) as picture:
            return _stored_size(picture)
    except OSError as error:
        raise FileError(f"cannot be opened: {error.strerror or error}") from error


def decode(path: Path, *, grey: bool = False) -> tuple[npt.NDArray[Any], int, list[str]]:
    """Return pixels as stored, EXIF orientation and notes; raises FileError with the reason alone.

    A JPEG holds its grey levels beside its colours: for `grey`, the colours are not decoded.
    """
    _refuse_unopened(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise FileError(f"cannot be opened: {error.strerror or error}") from error
    with _opened(io.BytesIO(data)) as picture:
        if grey:
            picture.draft("L", None)
        upright, orientation = _load(picture)
        image, notes = _pixels(upright)
        if _has_second(picture):
            notes.append("the first of several pictures in the file")
    return image, orientation, notes


def refuse_irregular(path: Path) -> int:
    """Refuse what is no file with something in it; gives its size in bytes.

    Opening a pipe would wait for ever.
    """
    try:
        info = path.stat()
    except FileNotFoundError as error:
        reason = "a link that leads nowhere" if path.is_symlink() else "there is no such file"
        raise FileError(reason) from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise FileError(f"cannot be opened: {reason}") from error
    if S_ISDIR(info.st_mode):
        raise FileError("a folder inside a folder; name it to have its photographs read")
    if not S_ISREG(info.st_mode):
        raise FileError("not a regular file")
    return info.st_size


def _refuse_unopened(path: Path) -> None:
    """Refuse what need not or must not be opened."""
    size = refuse_irregular(path)
    name, suffix = path.name.lower(), path.suffix.lower()
    if name.startswith(".") or name in _CLUTTER:
        raise FileError("a hidden file of the system")
    if suffix in _HEIF and not _reads_heif():
        raise FileError(
            "HEIF is read where pillow-heif is installed (pip install pillow-heif); or save it as "
            "JPEG or PNG"
        )
    for reason, suffixes in _FOREIGN.items():
        if suffix in suffixes.split():
            raise FileError(reason)
    if size == 0:
        raise FileError("the file is empty")
    if size > MAX_BYTES:
        raise FileError(f"{size / 1e6:.0f} MB is larger than any photograph that is read")


@cache
def _reads_heif() -> bool:
    """Let Pillow read the pictures of telephones, if there is who knows them."""
    try:
        from pillow_heif import register_heif_opener
    except ImportError:
        return False
    register_heif_opener()
    return True


@contextmanager
def _opened(stream: IO[bytes]) -> "Iterator[Image]":
    """Open a picture by its header, with a decoder's errors in words and its warnings silenced."""
    from PIL import Image, UnidentifiedImageError

    too_large = f"more than {MAX_PIXELS // 10**6} million pixels by its header"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            formats = _FORMATS + ("HEIF",) * _reads_heif()
            with Image.open(stream, formats=formats) as picture:
                if np.prod(picture.size, dtype=float) > MAX_PIXELS:
                    width, height = picture.size
                    raise FileError(f"{width}×{height}: {too_large}")
                yield picture
        except FileError:
            raise
        except UnidentifiedImageError as error:
            raise FileError("not a picture, or in a format that is not read") from error
        except Image.DecompressionBombError as error:
            raise FileError(too_large) from error
        except Exception as error:  # whatever a decoder makes of a broken file
            raise FileError(f"damaged or cut off ({error})") from error


def _stored_size(picture: "Image") -> tuple[int, int]:
    """Return the size of what is stored: for TIFF, Pillow's own is that after rotation."""
    tags = getattr(picture, "tag_v2", None)
    if tags is None:
        return picture.size
    return int(tags[_WIDTH]), int(tags[_HEIGHT])


def _load(picture: "Image") -> "tuple[Image, int]":
    """Decode; gives the picture as stored and its EXIF orientation, 1 if it has none."""
    from PIL.Image import Transpose

    tags = getattr(picture, "tag_v2", {})
    tiff = tags.get(_ORIENTATION, 1)
    picture.load()
    if _ORIENTATION in tags or tiff == 1:
        orientation = picture.getexif().get(_ORIENTATION, 1)
        return picture, orientation if orientation in range(1, 9) else 1
    # Pillow turns TIFF upright while decoding, and only TIFF: turn it back.
    aside, up, turn = Transpose.FLIP_LEFT_RIGHT, Transpose.FLIP_TOP_BOTTOM, Transpose.ROTATE_180
    undo = {2: aside, 3: turn, 4: up, 5: Transpose.TRANSPOSE, 7: Transpose.TRANSVERSE}
    undo |= {6: Transpose.ROTATE_90, 8: Transpose.ROTATE_270}
    return (picture.transpose(undo[tiff]), tiff) if tiff in undo else (picture, 1)


def _pixels(picture: "Image") -> tuple[npt.NDArray[Any], list[str]]:
    """Turn any mode into grey or RGB, uint8 or uint16."""
    notes = []
    if picture.has_transparency_data:
        notes.append("alpha dropped")
    if picture.mode == "F":
        raise FileError("pixels are floating-point numbers; save it with 8 or 16 bits")
    if picture.mode.startswith("I"):
        values = np.asarray(picture)
        if values.min() < 0 or values.max() > 65535:
            raise FileError("pixels have more than 16 bits; save it with 8 or 16 bits")
        return values.astype(np.uint16), [*notes, "16 bit"]
    mode = "L" if picture.mode in ("1", "L", "LA") else "RGB"
    return np.array(picture if picture.mode == mode else picture.convert(mode)), notes


def _has_second(picture: "Image") -> bool:
    try:
        picture.seek(1)
    except Exception:
        return False
    return True
