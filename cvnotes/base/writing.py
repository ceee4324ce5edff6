"""Files written whole or not at all."""

import csv
import io
import os
import secrets
import time
from collections.abc import Iterable, Mapping
from contextlib import ExitStack, suppress
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

from cvnotes.base import FileError, InputTypeError

PathLike = str | os.PathLike[str]

_PREFIX, _SUFFIX = ".cvnotes-", ".tmp"
_HOUR = 3600  # s; no writing takes so long


def _locks() -> Any:
    """Return the module that locks files; None on Windows, and where it is empty (a browser)."""
    try:
        module = import_module("fcntl")
    except ImportError:
        return None
    return module if hasattr(module, "flock") else None


fcntl = _locks()


def path_of(path: PathLike) -> Path:
    """Take what is given for a file as a path.

    Raises
    ------
    InputTypeError
        It is neither a text nor a path.

    Examples
    --------
    >>> path_of("board.pdf").suffix
    '.pdf'
    """
    try:
        return Path(path)
    except TypeError:
        raise InputTypeError(
            f"expected a file's path, as a text or pathlib.Path, got {type(path).__name__}"
        ) from None


def printable(path: PathLike) -> str:
    r"""Spell a path so that any terminal and any JSON file can hold it.

    Line breaks, control characters and bytes that are no UTF-8 become escapes.

    Examples
    --------
    >>> print(printable("two\nlines.jpg"))
    two\nlines.jpg
    """
    text = os.fspath(path).encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def harmless(text: str) -> str:
    """Keep a spreadsheet from taking a text for a formula.

    Examples
    --------
    >>> harmless("=1+1")
    "'=1+1"
    """
    return f"'{text}" if text[:1] in ("=", "+", "-", "@", "\t", "\r") else text


def as_csv(rows: Iterable[Iterable[str]]) -> str:
    r"""Write a table for spreadsheets and other programs, its texts kept `harmless`.

    Examples
    --------
    >>> as_csv([["file", "note"], ["=1+1.png", "a, b"]])
    'file,note\n\'=1+1.png,"a, b"\n'
    """
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(map(harmless, row) for row in rows)
    return text.getvalue()


def write_whole(contents: Mapping[Path, bytes]) -> None:
    """Write files so that each is complete or, if anything goes wrong, as it was before.

    All contents go to temporary files beside their targets, flushed to the disk; only when
    every one of them is there, they take their targets' names. No temporary file stays behind,
    whatever interrupts; what a killed process could not clear away, the next call in that folder
    does. Missing folders are made.

    Parameters
    ----------
    contents : mapping of Path to bytes
        What to write, and where. An existing regular file is replaced.

    Raises
    ------
    FileError
        A file cannot be written there: with the reason in words.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     target = Path(folder, "new", "note.txt")
    ...     write_whole({target: b"hello"})
    ...     target.read_text()
    'hello'
    """
    staged: list[tuple[Path, Path]] = []
    locks = ExitStack()
    target = Path()
    try:
        for target, data in contents.items():
            final = _checked(target)
            _clear_abandoned(final.parent)
            # The name is noted before the file exists: an interruption in between leaves nothing.
            staged.append((final.with_name(f"{_PREFIX}{secrets.token_hex(8)}{_SUFFIX}"), final))
            _write_and_sync(staged[-1][0], data, locks)
        for temporary, target in staged:
            temporary.replace(target)
    except OSError as error:
        reason = error.strerror or str(error)
        raise FileError(f"{printable(target)} cannot be written: {reason}") from error
    finally:
        locks.close()
        for temporary, _ in staged:
            temporary.unlink(missing_ok=True)


def check_folder(folder: Path) -> None:
    """Refuse a folder in which nothing could be written, before the work and not after it.

    What a killed process left in it is cleared away.

    Raises
    ------
    FileError
        A file is in its place, or it or where it would be made is read-only.
    """
    there = folder.resolve()
    while not there.exists():
        there = there.parent
    if not there.is_dir():
        raise FileError(f"{printable(folder)} cannot be a folder: {printable(there)} is a file")
    if not os.access(there, os.W_OK):
        raise FileError(f"{printable(folder)} cannot be written: {printable(there)} is read-only")
    _clear_abandoned(folder)


def _checked(target: Path) -> Path:
    """Follow links, make the folder, and refuse what must not be replaced."""
    final = target.resolve()
    if final.is_dir():
        raise FileError(f"{printable(target)} cannot be written: it is a folder")
    if final.exists() and not final.is_file():
        raise FileError(f"{printable(target)} cannot be written: it is not a regular file")
    if final.exists() and not os.access(final, os.W_OK):
        raise FileError(f"{printable(target)} cannot be written: it is read-only")
    final.parent.mkdir(parents=True, exist_ok=True)
    return final


def _write_and_sync(path: Path, data: bytes, locks: ExitStack) -> None:
    """Write a new file, and hold a lock on it that ends with `locks` or with this process."""
    with ExitStack() as mine:
        stream = mine.enter_context(path.open("xb"))
        while not _locked(stream, path):  # cleared away before its lock was there
            stream = mine.enter_context(path.open("xb"))
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())
        if fcntl is not None:  # Windows renames no file that is open
            locks.push(mine.pop_all())


def _locked(stream: BinaryIO, path: Path) -> bool:
    """Lock a new file if that can be; tell whether it is still the one of its name."""
    if fcntl is None:
        return True
    with suppress(OSError):  # some network folders have no locks
        fcntl.flock(stream, fcntl.LOCK_EX)
    try:
        return os.path.samestat(path.stat(), os.fstat(stream.fileno()))
    except FileNotFoundError:
        return False


def _clear_abandoned(folder: Path) -> None:
    """Remove the temporary files of processes that were killed while they wrote."""
    with suppress(OSError):  # whatever cannot be cleared away is no reason not to write
        for path in folder.glob(f"{_PREFIX}*{_SUFFIX}"):
            if _is_abandoned(path):
                path.unlink(missing_ok=True)


def _is_abandoned(path: Path) -> bool:
    """Return whether a temporary file is nobody's: its lock went with the process that held it."""
    info = path.stat()
    age = time.time() - info.st_mtime
    if fcntl is None:
        return age > _HOUR
    with path.open("rb") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:
            return age > _HOUR
    return True
