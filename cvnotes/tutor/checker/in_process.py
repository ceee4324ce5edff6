"""Running a student's function in this very process, for systems that cannot fork.

A second thread watches the clock and, when the time is over, raises an exception in the thread
that runs the function, again and again until it listens. That ends every endless loop written in
Python. It cannot end what blocks inside of compiled code, bound memory or survive a crash.
"""

import contextlib
import ctypes
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.outcome import Outcome

# The time that this process has calculated; in a browser that clock stands still.
clock = time.perf_counter if sys.platform == "emscripten" else time.process_time
# How many times its limit a function may take on a machine that is busy with other things.
PATIENCE = 12


class TimeIsOver(BaseException):
    """Raised in the thread of a function that takes too long."""


def run_here(
    function: Callable[..., Any], arguments: Sequence[tuple[Any, ...]], seconds: float
) -> list[Outcome]:
    """Call a function with each of several sets of arguments, within `seconds` together.

    Examples
    --------
    >>> run_here(abs, [(-1.0,)], 5.0)[0].value
    array(1.)
    """
    outcomes: list[Outcome] = []
    limit, late = sys.getrecursionlimit(), Outcome("late", words=f"{seconds:g}")
    try:
        with _clock(seconds):
            for given in arguments:
                outcome = attempt(function, given)
                outcomes.append(late if outcome.words == TimeIsOver.__name__ else outcome)
    except TimeIsOver:  # between two calls
        pass
    finally:
        sys.setrecursionlimit(limit)
    return outcomes + [late] * (len(arguments) - len(outcomes))


@contextlib.contextmanager
def _clock(seconds: float) -> Iterator[None]:
    """Raise `TimeIsOver` in this thread when the time is over; without threads there is none."""
    thread, lock = threading.get_ident(), threading.Lock()
    late, done = threading.Event(), threading.Event()
    used, patience = _time_used_by(thread), time.monotonic() + PATIENCE * seconds

    def watch() -> None:
        pause = seconds
        while not done.wait(pause):
            pause = max(0.05, seconds - used())
            if pause > 0.05 and time.monotonic() < patience:
                continue  # the machine was busy with something else
            with lock:
                if not done.is_set():
                    late.set()
                    _raise_in(thread, TimeIsOver)

    watcher = threading.Thread(target=watch, daemon=True)
    try:
        watcher.start()
    except RuntimeError:  # a browser
        yield
        return
    try:
        yield
    finally:
        while not done.is_set():
            # What was raised may arrive here as well as anywhere else.
            with contextlib.suppress(TimeIsOver):
                with lock:
                    done.set()
                if late.is_set():
                    # It must arrive: taken back, it would leave Python looking for it for ever,
                    # slowly, and under a profiler or a debugger without an end.
                    _raise_in(thread, TimeIsOver)
                    while True:
                        time.sleep(0)


def _time_used_by(thread: int) -> Callable[[], float]:
    """Return a function that tells how long a thread has calculated from now on."""
    try:
        clock = time.pthread_getcpuclockid(thread)
    except (AttributeError, OSError):  # not on every system; in a browser it is only a name
        started = time.monotonic()
        return lambda: time.monotonic() - started
    before = time.clock_gettime(clock)
    return lambda: time.clock_gettime(clock) - before


def _raise_in(thread: int, what: type[BaseException]) -> None:
    """Raise an exception in a thread, in the place of one that has not arrived yet."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(what))
