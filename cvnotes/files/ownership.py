"""Whose a file is: what a command made carries its name, and all else is never replaced."""

import re
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import count
from pathlib import Path

from cvnotes.base import FileError
from cvnotes.base.writing import printable
from cvnotes.files.photos import list_photos
from cvnotes.files.reasons import MadeByUs, Rejected

TABLE_HEADER = ("photograph", "rms_px", "note")  # a table has no place for more words of ours

_WORDS = re.compile(rb"made by cvnotes ([a-z]+)")
_HEAD = 2000  # bytes of a file, among which the words stand
_PNG_HEADER = 8 + 25  # the signature and the chunk IHDR
_NO_PHOTOGRAPHS = ("calibrate", "stereo", "undistort")  # what these commands made


def made_by(command: str) -> str:
    """Return the words by which the files of a command are known.

    Examples
    --------
    >>> made_by("undistort")
    'made by cvnotes undistort'
    """
    return f"made by cvnotes {command}"


def marked(png: bytes, command: str) -> bytes:
    """Put the name of the command that made it into a PNG, as its comment.

    References
    ----------
    .. [1] ISO/IEC 15948, Portable Network Graphics, 11.3.4.3: tEXt.
    """
    chunk = b"tEXtComment\0" + made_by(command).encode()
    size, check = len(chunk) - 4, zlib.crc32(chunk)
    comment = size.to_bytes(4, "big") + chunk + check.to_bytes(4, "big")
    return png[:_PNG_HEADER] + comment + png[_PNG_HEADER:]


def maker(path: Path) -> str:
    """Return which command of ours made a file; empty for everybody else's."""
    try:
        with path.open("rb") as stream:
            head = stream.read(_HEAD)
    except OSError:
        return ""
    if head.startswith(",".join(TABLE_HEADER).encode()):
        return "calibrate"
    found = _WORDS.search(head)
    return found[1].decode() if found else ""


def photographs(
    paths: Iterable[str], *, size: tuple[int, int] | None = None, straightened: bool
) -> tuple[list[Path], list[Rejected]]:
    """List photographs as `list_photos` does, without the pictures that the command made itself.

    What ``cvnotes undistort`` made counts as a photograph where `straightened` is true and there
    are no others: both together would be pictures of two cameras.
    """
    files, rejected = list_photos(paths, size=size)
    makers = {path: maker(path) for path in files}
    if straightened and set(makers.values()) <= {"undistort", "calibrate"}:
        makers = {path: who for path, who in makers.items() if who != "undistort"}
    foreign = [path for path in files if makers.get(path) not in _NO_PHOTOGRAPHS]
    own = [path for path in files if path not in foreign]
    return foreign, rejected + [Rejected(printable(p), MadeByUs(makers[p])) for p in own]


def free_name(names: Iterable[str], folder: Path, command: str, taken: set[str]) -> Path:
    """Return the first name in a folder under which nothing of anybody else's would be replaced.

    Parameters
    ----------
    names : iterable of str
        The names in the order of preference; it need not end.
    folder : Path
        The folder.
    command : str
        What this command made before may be replaced,
    taken : set of str
        but not what it made in this run: these names, of which the result becomes one.
    """
    for name in names:
        path = folder / name
        there = path.exists() or path.is_symlink()
        known = name.casefold()  # some file systems do not tell a.png from A.png
        if known not in taken and (not there or maker(path) == command):
            taken.add(known)
            return path
    raise FileError(f"no name is free in {printable(folder)}")


def numbered(stem: str, suffix: str) -> Iterator[str]:
    """Return stem, stem-2, stem-3, … with the suffix, without end.

    Examples
    --------
    >>> names = numbered("a-straight", ".png")
    >>> next(names), next(names)
    ('a-straight.png', 'a-straight-2.png')
    """
    yield stem + suffix
    yield from (f"{stem}-{i}{suffix}" for i in count(2))


def earlier(folder: Path, is_ours: Callable[[str], object], command: str) -> Sequence[Path]:
    """Find what a command left in a folder before, by its names.

    Raises
    ------
    FileError
        A file of such a name was made by somebody else, and would be replaced.
    """
    if not folder.is_dir():
        return []
    found = sorted(p for p in folder.iterdir() if is_ours(p.name) and not p.is_dir())
    for path in found:
        refuse_foreign(path, command)
    return found


def refuse_foreign(path: Path, command: str) -> None:
    """Refuse to replace a file that another command, or somebody else, made."""
    if maker(path) != command:
        raise FileError(
            f"{printable(path)} was not made by cvnotes {command}, which would replace it; "
            "choose another --out"
        )
