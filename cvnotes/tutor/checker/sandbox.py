"""Running a student's function where it can do no harm.

Where the system can fork, the function runs in a child process: a copy of the notebook's process
in which it is defined already, nothing has to be pickled, and whatever it breaks dies with the
child. The child has a limit of time and memory, and only numbers and words come back. Elsewhere
(Windows, browsers) the function runs in the notebook's own process, where an endless loop in
Python is interrupted but a crash is a crash; see `run`.
"""

import contextlib
import os
import select
import signal
import sys
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

from cvnotes.base import CvnotesError
from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.child_process import work
from cvnotes.tutor.checker.exercise import Exercise
from cvnotes.tutor.checker.in_process import PATIENCE, run_here
from cvnotes.tutor.checker.outcome import Outcome, clean, decode

SECONDS = 5.0
MEGABYTES = 1024
_MAX_BYTES = 200_000_000

Arguments = tuple[Any, ...]


def run(
    function: Callable[..., Any],
    arguments: Sequence[Arguments],
    *,
    seconds: float = SECONDS,
    megabytes: int = MEGABYTES,
) -> list[Outcome]:
    """Call a function with each of several sets of arguments; nothing it does gets out.

    Parameters
    ----------
    function : callable
        Anything that can be called.
    arguments : sequence of tuple
        What to call it with; it is given copies.
    seconds : float
        Time of the processor for all calls together, and the longest that they may sleep. How
        busy the machine is with other things changes nothing.
    megabytes : int
        Memory that the calls may use beyond what is used already.

    Returns
    -------
    list of Outcome
        One for each set of arguments, also after a crash or an endless loop.

    Notes
    -----
    Without fork, what blocks inside of compiled code (``time.sleep``, a huge matrix product, a
    regular expression) is waited for, memory has no limit, and a crash ends the notebook.

    Examples
    --------
    >>> [outcome.value.tolist() for outcome in run(abs, [(-1.0,), (2.0,)])]
    [1.0, 2.0]
    >>> run(lambda: sys.exit(), [()])[0].words
    'SystemExit'
    """
    if can_fork():
        return _run_in_child(function, arguments, seconds, megabytes)
    return run_here(function, arguments, seconds)


@cache
def can_fork() -> bool:
    """Return whether a forked child can calculate here, by trying it once.

    On some systems a library's threads do not survive the fork; the child then hangs or dies.
    """
    if not hasattr(os, "fork") or sys.platform in ("emscripten", "wasi", "win32"):
        return False
    # What is imported now, each child has.
    import resource  # noqa: F401

    import numpy as np

    attempt(np.linalg.norm, (np.eye(3),))
    [outcome] = _run_in_child(np.linalg.norm, [(np.eye(3),)], 5.0, MEGABYTES)
    return outcome.kind == "numbers"


def _run_in_child(
    function: Callable[..., Any], arguments: Sequence[Arguments], seconds: float, megabytes: int
) -> list[Outcome]:
    reading, writing = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that notebooks have threads is known, and considered
        child = os.fork()
    if child == 0:
        try:
            os.close(reading)
            work(function, arguments, writing, seconds, megabytes)
        finally:
            os._exit(0)
    try:
        os.close(writing)
        lines, late = _read(reading, len(arguments), _Clock(child, seconds))
    finally:
        os.close(reading)
        status = _end(child)
    outcomes = [_decoded(line) for line in lines]
    late = late or (os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGPROF)
    rest = Outcome("late", words=f"{seconds:g}") if late else Outcome("died", words=_why(status))
    return outcomes + [rest] * (len(arguments) - len(outcomes))


class _Clock:
    """Tells when a child has slept for too long; for what it calculates it has a limit itself.

    On a busy machine a child waits for its turn: that is neither sleep nor calculation, and
    counts as neither where the system tells (Linux).
    """

    def __init__(self, child: int, seconds: float) -> None:
        self.seconds, self.started = seconds, time.monotonic()
        self.statistics = f"/proc/{child}/schedstat"

    def left(self) -> float:
        """Return how many seconds the child may still sleep; 0 or less ends it."""
        passed = time.monotonic() - self.started
        at_most = PATIENCE * self.seconds - passed
        try:
            with open(self.statistics, "rb") as stream:  # noqa: PTH123
                running, waiting = stream.read().split()[:2]
        except (OSError, ValueError):
            return at_most
        return min(at_most, self.seconds - (passed - (int(running) + int(waiting)) / 1e9))


def _read(reading: int, n: int, clock: _Clock) -> tuple[list[bytes], bool]:
    """Read up to n lines until the time is over; tells whether it was."""
    buffer = bytearray()
    for chunk in _chunks(reading, clock):
        if chunk is None or len(buffer) > _MAX_BYTES:
            return bytes(buffer).split(b"\n")[:-1][:n], True
        buffer += chunk
        if b"\n" in chunk and buffer.count(b"\n") >= n:
            break
    return bytes(buffer).split(b"\n")[:-1][:n], False


def _chunks(reading: int, clock: _Clock) -> Iterator[bytes | None]:
    """Yield what arrives until the other end is closed; None when the time is over."""
    poll = select.poll()
    poll.register(reading, select.POLLIN)
    while (left := clock.left()) > 0:
        if poll.poll(1000 * left):
            chunk = os.read(reading, 1 << 16)
            if not chunk:
                return
            yield chunk
    yield None


def _end(child: int) -> int:
    """End the child and whatever it started in its group; gives its exit status."""
    with contextlib.suppress(OSError):
        os.setpgid(child, child)  # if it has not come to do so itself
    ended, status = os.waitpid(child, os.WNOHANG)
    with contextlib.suppress(OSError):
        os.killpg(child, signal.SIGKILL)
    if not ended:
        _, status = os.waitpid(child, 0)
    return status


def _why(status: int) -> str:
    if os.WIFSIGNALED(status):
        return signal.Signals(os.WTERMSIG(status)).name
    return f"exit code {os.waitstatus_to_exitcode(status)}"


def _decoded(line: bytes) -> Outcome:
    try:
        return decode(line)
    except CvnotesError:
        return Outcome("died", words="unreadable answer")


def ask(exercise: Exercise, answer: Any, seed: int, **limits: Any) -> list[Outcome]:
    """Try an answer on the cases of an exercise, without judging.

    Parameters
    ----------
    exercise : Exercise
        What is asked.
    answer : any
        The function, value or steps that the student hands over.
    seed : int
        Of the random cases.
    **limits
        Of time and memory; see `cvnotes.tutor.checker.sandbox.run`.

    Returns
    -------
    list of Outcome
        One for each case, of each part first; a single one if there was nothing to try.
    """
    if exercise.assemble is not None and isinstance(answer, dict):
        tried = []
        known = [part.name for part in exercise.parts]
        others = ", ".join(clean(name, 40) for name in answer if name not in known)
        for part in exercise.parts:
            outcomes = ask(part, answer.get(part.name), seed, **limits)
            if part.name not in answer:  # under another name, perhaps
                outcomes = [replace(outcome, words=others) for outcome in outcomes]
            # A step that is no function gives one outcome; it counts for all of the part's cases.
            tried += outcomes * (len(part.inputs(seed)) if len(outcomes) == 1 else 1)
        return tried + run(exercise.assemble(answer), exercise.inputs(seed), **limits)
    if exercise.answer == "function" and callable(answer):
        return run(answer, exercise.inputs(seed), **limits)
    if exercise.answer != "value":  # nothing that could be tried
        [given] = run(lambda: answer, [()], **limits)
        nothing = given.kind in ("none", "unfinished")
        return [Outcome("unfinished" if nothing else "result")]
    return run(lambda: exercise.number_of(answer), [()], **limits)
