"""Grade handed-in notebooks: each runs in its own process, the verdict is worked out here.

The processes have limits of time and memory, and what they hand back is numbers only. That keeps
mistakes to the row of whoever made them. It is no prison: who fears bad intent grades in a
container.
"""

import contextlib
import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any

from cvnotes.base import CvnotesError, FileError
from cvnotes.files.writing import printable
from cvnotes.learn.checker.judge import judge
from cvnotes.learn.checker.outcome import clean, decode
from cvnotes.learn.checker.report import Report
from cvnotes.learn.exercises import EXERCISES, asked
from cvnotes.learn.grader.assignment import expected_exercises
from cvnotes.learn.grader.process import run_notebook

_MAX_NOTEBOOK = 100 * 2**20


@dataclass(frozen=True)
class Mark:
    """What one notebook earned.

    Attributes
    ----------
    student, notebook : str
        Its folder below the graded one, and its file name.
    reports : dict
        The verdict on each exercise that was handed in, by name.
    expected : tuple of str
        The exercises that belong to it.
    ids : tuple of str
        The student ids that it used.
    remark : str
        What went wrong with the notebook as a whole.
    """

    student: str
    notebook: str
    reports: dict[str, Report] = field(default_factory=dict)
    expected: tuple[str, ...] = ()
    ids: tuple[str, ...] = ()
    remark: str = ""

    @property
    def points(self) -> int:
        """How many of the expected exercises are right."""
        return sum(self.earned(name) for name in self.expected)

    def earned(self, name: str) -> int:
        """Give the point for one exercise."""
        return int(name in self.reports and self.reports[name].passed)

    @property
    def misconceptions(self) -> dict[str, str]:
        """The misconceptions met, by exercise."""
        return {n: r.misconception for n, r in self.reports.items() if r.misconception}


def grade_folder(
    folder: Path, *, seconds: float = 120.0, megabytes: int = 4096, jobs: int | None = None
) -> tuple[int, Iterator[Mark]]:
    """Grade all notebooks below a folder.

    Parameters
    ----------
    folder : Path
        Where they were handed in, in folders of their own or not.
    seconds, megabytes : float and int
        What each notebook may use.
    jobs : int, optional
        How many run at a time; by default one for each processor.

    Returns
    -------
    n, marks
        How many there are, and an iterator over their marks, in the order of their names.

    Raises
    ------
    FileError
        There is no such folder, or no notebook in it.
    """
    if not folder.is_dir():
        raise FileError(f"{printable(folder)} is not a folder")
    paths = sorted(p for p in folder.rglob("*.ipynb") if ".ipynb_checkpoints" not in p.parts)
    if not paths:
        raise FileError(f"{printable(folder)} holds no notebooks (*.ipynb)")
    # All are read before the first one runs: none can change another.
    contents = [_content(path) for path in paths]

    def marks() -> Iterator[Mark]:
        with ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
            yield from pool.map(
                lambda path, content: _grade(path.relative_to(folder), content, seconds, megabytes),
                paths,
                contents,
            )

    return len(paths), marks()


def _content(path: Path) -> bytes | str:
    """Read a notebook, or say why that cannot be done."""
    try:
        if not path.is_file():
            return "not a regular file"
        if path.stat().st_size > _MAX_NOTEBOOK:
            return "larger than 100 MB"
        return path.read_bytes()
    except OSError as error:
        return f"cannot be read: {error.strerror}"


def _grade(path: Path, content: bytes | str, seconds: float, megabytes: int) -> Mark:
    student, notebook = printable(path.parent), printable(path.name)
    student = "" if student == "." else student
    if isinstance(content, str):
        expected = expected_exercises(notebook, [])
        return Mark(student, notebook, expected=expected, remark=content)
    # Inputs that nobody knows before, and that are the same if the notebook is graded again.
    seed = int.from_bytes(sha256(content).digest()[:6], "big")
    lines, ended = run_notebook(content, seed, seconds, megabytes)
    reports, ids = _judged(lines, seed)
    return Mark(
        student,
        notebook,
        reports,
        expected_exercises(notebook, list(reports)),
        ids,
        _remark(lines, ended),
    )


def _judged(lines: list[dict[str, Any]], seed: int) -> tuple[dict[str, Report], tuple[str, ...]]:
    """Judge the last answer to each exercise; gives the ids that were used, too."""
    reports: dict[str, Report] = {}
    ids: list[str] = []
    for line in lines:
        name, student = line.get("exercise"), line.get("student")
        if not isinstance(name, str) or name not in EXERCISES:
            continue
        student = clean(student, 60) if isinstance(student, str) else None
        with contextlib.suppress(CvnotesError, TypeError, KeyError):
            outcomes = [decode(text) for text in line["outcomes"]]
            reports[name] = judge(asked(name, student), outcomes, seed)
            ids += [student] if student and student not in ids else []
    return reports, tuple(ids)


def _remark(lines: list[dict[str, Any]], ended: str) -> str:
    if any(line.get("unreadable") is True for line in lines):
        return "not a notebook"
    if ended:
        return ended
    last = lines[-1] if lines else {}
    if last.get("finished") is not True:
        return "ended before its last cell"
    failed = last.get("failed")
    return f"{failed} cells failed, first: {clean(last.get('first'), 120)}" if failed else ""
