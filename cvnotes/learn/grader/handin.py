"""Run one handed-in notebook in a process of its own, and write down what its answers give.

This is the grader's other half: ``python -m cvnotes.learn.grader.handin``. It judges nothing.
Whatever the notebook does to this process, the verdict is worked out elsewhere, by
`cvnotes.learn.grader.grading`.
"""

import argparse
import contextlib
import json
import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from cvnotes import learn
from cvnotes.learn import exercises
from cvnotes.learn.checker.judge import judge
from cvnotes.learn.checker.outcome import clean, encode
from cvnotes.learn.checker.report import Report
from cvnotes.learn.checker.sandbox import ask

# Bytes that a notebook may write into one file.
_FILE_SIZE = 200 * 2**20


class CellTimeout(Exception):
    """A cell takes too long; the next ones still run."""


def main(arguments: list[str] | None = None) -> int:
    """Run the notebook; gives the exit code."""
    parser = argparse.ArgumentParser(description="Run one handed-in notebook for the grader.")
    parser.add_argument("notebook", type=Path)
    parser.add_argument("results", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--cell-seconds", type=float, required=True)
    parser.add_argument("--megabytes", type=int, required=True)
    args = parser.parse_args(arguments)
    _limit(args.megabytes)
    with args.results.open("ab", buffering=0) as stream:

        def write(line: dict[str, Any]) -> None:
            stream.write(json.dumps(line).encode() + b"\n")

        try:
            cells = code_cells(args.notebook.read_bytes())
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            write({"unreadable": True})
            return 1
        exercises.check = learn.check = _recorder(args.seed, write)
        failed = [why for why in run_cells(cells, args.cell_seconds) if why]
        write({"finished": True, "failed": len(failed), "first": failed[0] if failed else ""})
    return 0


def code_cells(data: bytes) -> list[str]:
    """Give the source of a notebook's code cells.

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


def _recorder(seed: int, write: Callable[[dict[str, Any]], None]) -> Callable[..., Report]:
    """Make a ``check`` that writes down what the answer gives, and answers as always."""

    def check(name: str, answer: Any, *, student: str | None = None) -> Report:
        exercise = exercises.asked(name, student)
        outcomes = ask(exercise, answer, seed)
        lines = [encode(outcome).decode() for outcome in outcomes]
        write({"exercise": name, "student": student, "outcomes": lines})
        return judge(exercise, outcomes, seed)

    return check


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
