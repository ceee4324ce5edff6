"""Talking to whoever sits at the terminal: results on stdout, everything else on stderr."""

import os
import sys
from collections.abc import Iterable, Iterator
from errno import EBADF
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")

EXIT_CODES = "exit codes: 0 done, 1 cannot, 2 wrong usage, 3 written, not reliable or not all"

# For terminals and files that hold ASCII only.
_PLAIN = str.maketrans(
    {"×": "x", "±": "+-", "σ": "sigma", "–": "-", "−": "-", "°": " deg", "…": "..."}
)


_failed: list[OSError] = []  # what kept words from being printed


def say(text: str = "") -> None:
    """Print to stdout, in whatever letters it can hold; where it cannot, the work goes on."""
    try:
        print(_fitting(text, sys.stdout.encoding))
        sys.stdout.flush()
    except BrokenPipeError:  # whoever reads has seen enough
        stop_printing()
    except OSError as error:
        _failed.append(error)
        stop_printing()


def open_streams() -> None:
    """Open what the caller has closed (``>&-``): else the next file would be taken for stdout."""
    _failed.clear()
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is not None:
            continue
        nowhere = os.open(os.devnull, os.O_RDWR)  # the lowest number that is free: its own
        setattr(sys, name, os.fdopen(nowhere, mode, encoding="utf-8"))
        if name == "stdout":
            _failed.append(OSError(EBADF, os.strerror(EBADF)))


def unprinted() -> OSError | None:
    """Return what kept words from being printed, if anything did."""
    return _failed[0] if _failed else None


def stop_printing() -> None:
    """Send what is still to be printed nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def complain(command: str, text: str) -> None:
    """Print one line of reason to stderr."""
    name = f"cvnotes {command}".strip()
    if not _is_somewhere():
        text = f"the current folder has been deleted; go to another: {text}"
    line = " ".join(f"{name}: {text}".split())
    print(_fitting(line, sys.stderr.encoding), file=sys.stderr)


def _is_somewhere() -> bool:
    try:
        return bool(Path.cwd())
    except OSError:
        return False


def shortfall(command: str, missing: int, asked: int, what: str) -> int:
    """Say how much of what was asked for is missing; gives the exit code: 3, or 0 if nothing."""
    if missing:
        complain(command, f"{missing} of {asked} photographs {what}; the table says why")
    return 3 if missing else 0


def progress(items: Iterable[T], total: int) -> Iterator[T]:
    """Pass things on, with a bar on stderr where that is a terminal."""
    if not sys.stderr.isatty():
        yield from items
        return
    from tqdm import tqdm

    yield from tqdm(items, total=total, unit=" photographs", disable=None, leave=False)


def _fitting(text: str, encoding: str | None) -> str:
    """Replace what an encoding does not hold."""
    encoding = encoding or "utf-8"
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return text.translate(_PLAIN).encode(encoding, "backslashreplace").decode(encoding)
    return text
