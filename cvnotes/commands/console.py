"""Talking to whoever sits at the terminal: results on stdout, everything else on stderr."""

import os
import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

T = TypeVar("T")

EXIT_CODES = "exit codes: 0 done, 1 cannot, 2 wrong usage, 3 written but not reliable"

# For terminals and files that hold ASCII only.
_PLAIN = str.maketrans(
    {"×": "x", "±": "+-", "σ": "sigma", "–": "-", "−": "-", "°": " deg", "…": "..."}
)


def say(text: str = "") -> None:
    """Print to stdout, in whatever letters it can hold."""
    try:
        print(_fitting(text, sys.stdout.encoding))
        sys.stdout.flush()
    except BrokenPipeError:  # whoever reads has seen enough; the work goes on
        stop_printing()


def stop_printing() -> None:
    """Send what is still to be printed nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def complain(command: str, text: str) -> None:
    """Print one line of reason to stderr."""
    name = f"cvnotes {command}".strip()
    line = " ".join(f"{name}: {text}".split())
    print(_fitting(line, sys.stderr.encoding), file=sys.stderr)


def progress(items: Iterable[T], *, total: int, unit: str = "photographs") -> Iterator[T]:
    """Pass things on, with a bar on stderr where that is a terminal."""
    if not sys.stderr.isatty():
        yield from items
        return
    from tqdm import tqdm

    yield from tqdm(items, total=total, unit=f" {unit}", disable=None, leave=False)


def _fitting(text: str, encoding: str | None) -> str:
    """Replace what an encoding does not hold."""
    encoding = encoding or "utf-8"
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return text.translate(_PLAIN).encode(encoding, "backslashreplace").decode(encoding)
    return text
