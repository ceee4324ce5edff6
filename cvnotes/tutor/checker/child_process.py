"""What the forked child does: limits first, then the student's function, then a line for each call.

It never returns to the notebook's code; see `cvnotes.tutor.checker.sandbox` for the parent's part.
"""

import contextlib
import faulthandler
import os
import signal
from collections.abc import Callable, Sequence
from typing import Any

from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.in_process import PATIENCE
from cvnotes.tutor.checker.outcome import encode
from cvnotes.tutor.remembered import shell


def work(
    function: Callable[..., Any],
    arguments: Sequence[tuple[Any, ...]],
    writing: int,
    seconds: float,
    megabytes: int,
) -> None:
    """Call a function with each set of arguments, and write what came of it.

    Parameters
    ----------
    function, arguments
        What to call, and with what.
    writing : int
        Descriptor of the pipe to the parent.
    seconds, megabytes : float and int
        What all calls together may use: time of the processor, and memory.
    """
    os.setpgid(0, 0)
    faulthandler.disable()  # a crash is reported by the parent, in a sentence
    _limit(seconds, megabytes)
    _show_nothing()
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    for given in arguments:
        line = encode(attempt(function, given))
        while line:
            line = line[os.write(writing, line) :]


def _show_nothing() -> None:
    """Keep the child from sending figures to the page in the notebook's name."""
    if (running := shell()) is not None:
        running.display_pub.publish = lambda *_, **__: None


def _limit(seconds: float, megabytes: int) -> None:
    """Set limits that hold even if the notebook dies before the child does."""
    import resource

    # 1. time: of the processor, so that a busy machine changes no verdict; and in all, should
    #    the parent not be there to stop what sleeps
    for name in (signal.SIGPROF, signal.SIGALRM):
        signal.signal(name, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.alarm(int(PATIENCE * seconds) + 2)
    # 2. memory: linear algebra sets some aside for each processor
    headroom = (megabytes + 64 * (os.cpu_count() or 1)) * 2**20
    with contextlib.suppress(OSError, ValueError):
        with open("/proc/self/statm", "rb") as stream:  # noqa: PTH123
            used = int(stream.read().split()[0]) * resource.getpagesize()
        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        wanted = used + headroom
        if hard == resource.RLIM_INFINITY or wanted < hard:
            resource.setrlimit(resource.RLIMIT_AS, (wanted, hard))
    # 3. no core files
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
