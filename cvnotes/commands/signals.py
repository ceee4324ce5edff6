"""What happens when a command is to end: Ctrl-C, SIGTERM, a terminal that is closed."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

ENDING = ("SIGINT", "SIGTERM", "SIGHUP")


def numbers_of(*names: str) -> list[int]:
    """Return the signals that this system has (Windows has no SIGHUP) and that are not ignored.

    A command under nohup goes on without its terminal.
    """
    numbers = [getattr(signal, name) for name in names if hasattr(signal, name)]
    return [number for number in numbers if signal.getsignal(number) != signal.SIG_IGN]


@contextmanager
def heard(handler: Callable[..., Any] | signal.Handlers, *names: str) -> Iterator[None]:
    """Let a handler have signals as long as the block lasts, in the main thread, where they come.

    Examples
    --------
    >>> came = []
    >>> with heard(lambda number, _: came.append(number), "SIGINT"):
    ...     signal.raise_signal(signal.SIGINT)
    >>> len(came)
    1
    """
    here = threading.current_thread() is threading.main_thread()
    before = {number: signal.signal(number, handler) for number in numbers_of(*names) if here}
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)
