"""Run one handed-in notebook in a process of its own, and write down what its answers give.

This is the grader's other half: ``python -m cvnotes.tutor.grader.handin``. It judges nothing.
Whatever the notebook does to this process, the verdict is worked out elsewhere, by
`cvnotes.tutor.grader.grading`.
"""

import contextlib
import importlib
import json
import os
import pickle
import signal
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED
from cvnotes.tutor.checker.exercise import Case, Exercise
from cvnotes.tutor.checker.judge import judge
from cvnotes.tutor.checker.outcome import clean, encode
from cvnotes.tutor.checker.report import OPEN, Report
from cvnotes.tutor.checker.sandbox import ask
from cvnotes.tutor.course import Course
from cvnotes.tutor.grader.borrowed import borrowed
from cvnotes.tutor.grader.seal import adopt_orphans, end_with_parent, sealed

# Bytes that a notebook may write into one file.
_FILE_SIZE = 200 * 2**20


Arguments = tuple[Any, ...]


@dataclass(frozen=True)
class Task:
    """What the grader asks of this process.

    Attributes
    ----------
    cells : list of str
        The source of the notebook's code cells.
    inputs : dict
        What answers are tried on, by the name of the exercise.
    scratch, hidden : str and tuple of str
        The folder it may write to, and what it is not to find.
    cell_seconds, megabytes : float and int
        Time for one cell, and memory.
    course : Course
        Whose exercises are answered; it travels by its name.
    """

    cells: list[str]
    inputs: dict[str, list[Arguments]]
    scratch: str
    hidden: tuple[str, ...]
    cell_seconds: float
    megabytes: int
    course: Course


class CellTimeout(Exception):
    """A cell takes too long; the next ones still run."""


def main() -> int:
    """Run the notebook that stands on stdin; what its answers give goes to what was stdout."""
    end_with_parent()
    adopt_orphans()
    # The grader itself wrote this: the notebook's cells, and inputs whose seed stays where it is.
    task: Task = pickle.load(sys.stdin.buffer)
    results = os.dup(1)
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1):
        os.dup2(nowhere, stream)
    is_sealed = sealed(Path(task.scratch), [Path(path) for path in task.hidden])
    _limit(task.megabytes)

    def write(line: dict[str, Any]) -> None:
        data = json.dumps(line).encode() + b"\n"
        while data:
            data = data[os.write(results, data) :]

    write({"sealed": is_sealed})
    check = _recorder(task.course, task.inputs, write)
    for face in task.course.faces:
        setattr(importlib.import_module(face), "check", check)  # noqa: B010
    failed = [why for why in run_cells(task.cells, task.cell_seconds) if why]
    write({"finished": True, "failed": len(failed), "first": failed[0] if failed else ""})
    return 0


def code_cells(data: bytes) -> list[str]:
    """Return the source of a notebook's code cells.

    Examples
    --------
    >>> code_cells(b'{"cells": [{"cell_type": "code", "source": ["a = 1; ", "b = 2"]}]}')
    ['a = 1; b = 2']
    """
    cells = json.loads(data)["cells"]
    return ["".join(c["source"]) for c in cells if c["cell_type"] == "code"]


def run_cells(cells: list[str], seconds: float) -> Iterator[str]:
    """Run cells one after the other, as a notebook does; yields what went wrong in each."""
    from IPython.core.interactiveshell import InteractiveShell
    from traitlets.config import Config

    config = Config()
    config.HistoryManager.enabled = False
    shell = InteractiveShell.instance(config=config)
    # What %matplotlib asks for; there is no screen.
    shell.enable_gui = lambda *_: None  # type: ignore[method-assign]
    for source in cells:
        with _alarm(seconds):
            result = shell.run_cell(source, store_history=False)
        error = result.error_before_exec or result.error_in_exec
        yield "" if error is None else clean(f"{type(error).__name__}: {error}", 120)


def _recorder(
    course: Course, inputs: dict[str, list[Arguments]], write: Callable[[dict[str, Any]], None]
) -> Callable[..., Report]:
    """Make a ``check`` that writes down what the answer gives, and answers as always.

    An answer that is right on the notebook's own inputs is tried on others, too.
    """

    def check(name: str, answer: Any, *, student: str | int | None = None) -> Report:
        exercise = course.asked(name, student)
        outcomes = ask(exercise, answer, NOTEBOOK_SEED)
        report = judge(exercise, outcomes, NOTEBOOK_SEED)
        again = ask(_on(exercise, inputs), answer, NOTEBOOK_SEED) if report.passed else []
        lines = [[encode(outcome).decode() for outcome in tried] for tried in (outcomes, again)]
        of = {"exercise": name, "student": student, "open": report.verdict == OPEN}
        whose = borrowed(answer, exercise) if report.passed else ""
        write({**of, "outcomes": lines[0], "again": lines[1], "borrowed": whose})
        return report

    return check


def _on(exercise: Exercise, inputs: dict[str, list[Arguments]]) -> Exercise:
    """Return an exercise, and its steps, with the inputs of the grader."""
    parts = tuple(_on(part, inputs) for part in exercise.parts)
    given = [Case(arguments) for arguments in inputs[exercise.name]]
    return replace(exercise, cases=lambda _: given, parts=parts)


@contextlib.contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    """Interrupt what takes longer, where the system has alarms."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def interrupt(*_: Any) -> None:
        raise CellTimeout(f"stopped after {seconds:g} seconds")

    signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


def _limit(megabytes: int) -> None:
    """Bound memory and file sizes, where the system can."""
    try:
        import resource
    except ImportError:
        return
    bounds = {"RLIMIT_AS": megabytes * 2**20, "RLIMIT_FSIZE": _FILE_SIZE, "RLIMIT_CORE": 0}
    for name, bound in bounds.items():
        with contextlib.suppress(OSError, ValueError):
            resource.setrlimit(getattr(resource, name), (bound, bound))


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    os._exit(code)  # threads that a notebook left behind are not waited for
