"""Finished rows in a file, line by line, so that no interruption takes one away.

Each line has the notebook's hash and the version that graded it; ``--resume`` runs only those
notebooks again that have no such line.
"""

import contextlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, astuple
from hashlib import sha256
from pathlib import Path
from typing import IO, Self

from cvnotes import __version__
from cvnotes.base import FileError
from cvnotes.base.writing import printable, write_whole
from cvnotes.tutor.course import Course
from cvnotes.tutor.grader.marks import Mark, from_fields
from cvnotes.tutor.grader.process import Limits

Known = dict[tuple[str, str, str], Mark]
_LARGEST = 500 * 2**20


class Records:
    """A file to which finished rows are added.

    Parameters
    ----------
    path : Path
        Which file.
    known : mapping
        The rows that it begins with.
    limits : Limits
        With which it is graded.
    course : Course
        By whose exercises.

    Raises
    ------
    FileError
        It cannot be written.
    """

    def __init__(
        self, path: Path, known: Mapping[tuple[str, str, str], Mark], limits: Limits, course: Course
    ) -> None:
        self.path, self._limits, self._version = path, limits, _version(course)
        self._marks = dict(known)
        self._write()
        self._stream: IO[bytes] = path.open("ab")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self._stream.close()
        if kind is None:  # whatever a notebook wrote into it does not stay
            self._write()

    def add(self, mark: Mark) -> None:
        """Add a row; when this returns, it is on the disk."""
        key = (mark.student, mark.notebook, mark.content)
        if self._marks.get(key) == mark:
            return
        self._marks[key] = mark
        try:
            self._stream.write(self._line(mark))
            self._stream.flush()
            os.fsync(self._stream.fileno())
        except OSError as error:
            reason = error.strerror or str(error)
            raise FileError(f"{printable(self.path)} cannot be written: {reason}") from error

    def _line(self, mark: Mark) -> bytes:
        graded = {"version": self._version, "limits": astuple(self._limits)}
        fields = {**graded, "mark": asdict(mark)}
        return json.dumps(fields, ensure_ascii=True, allow_nan=False).encode() + b"\n"

    def _write(self) -> None:
        rows = sorted(self._marks.values(), key=lambda mark: mark.name)
        write_whole({self.path: b"".join(self._line(mark) for mark in rows)})


def read_records(path: Path, limits: Limits, course: Course) -> Known:
    """Read the rows that were finished by this version, with the same limits.

    Without a file there are none; a line that was cut off, or is none of ours, is left out.

    Parameters
    ----------
    path : Path
        Which file.
    limits, course : Limits and Course
        With which it is graded now, and by whose exercises.
    """
    known: Known = {}
    try:
        if path.stat().st_size > _LARGEST:
            raise FileError(f"{printable(path)} is larger than 500 MB: none of our records")
        lines = path.read_bytes().splitlines()
    except FileNotFoundError:
        return known
    except OSError as error:
        raise FileError(f"{printable(path)} cannot be read: {error.strerror}") from error
    for line in lines:
        with contextlib.suppress(ValueError, TypeError, KeyError, AttributeError, RecursionError):
            fields = json.loads(line)
            if fields["version"] == _version(course) and fields["limits"] == [*astuple(limits)]:
                mark = from_fields(fields["mark"])
                if mark.content:  # what had no file is looked at again
                    known[mark.student, mark.notebook, mark.content] = mark
    return known


def _version(course: Course) -> str:
    """Return the version of all that decides a mark, exercises that were added among it."""
    added = (sha256(path.read_bytes()).hexdigest()[:12] for path in course.added_files())
    return "+".join([__version__, *added])
