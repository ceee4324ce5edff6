"""Something done with many items on all cores, in the order in which they were given."""

import os
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, wait
from queue import SimpleQueue
from typing import Any, TypeVar

T = TypeVar("T")
R = TypeVar("R")


def in_order(function: Callable[[T], R], items: Iterable[T], workers: int = 0) -> Iterator[R]:
    """Call a function with each item in threads, and give the results in order.

    Decoders, OpenCV and large array operations work beside each other. At most one item
    per thread is under way, so that memory does not grow with their number. The threads die with
    the process: an interruption does not wait for them. (Where there are none, as in a browser or
    under a limit of memory, it is done here, one after the other.)

    Parameters
    ----------
    function : callable
        What to do with each.
    items : iterable
        With what.
    workers : int
        How many threads; by default one per core.

    Examples
    --------
    >>> list(in_order(lambda x: x * x, range(5)))
    [0, 1, 4, 9, 16]
    """
    if sys.platform == "emscripten":
        yield from map(function, items)
        return
    workers = workers or os.cpu_count() or 1
    tasks: SimpleQueue[Any] = SimpleQueue()

    def work() -> None:
        while (task := tasks.get()) is not None:
            item, answer = task
            try:
                answer.set_result(function(item))
            except BaseException as error:  # raised where the result is asked for
                answer.set_exception(error)

    started = _start(work, workers)
    if not started:
        yield from map(function, items)
        return
    waiting: deque[Future[R]] = deque()
    try:
        for item in items:
            waiting.append(Future())
            tasks.put((item, waiting[-1]))
            if len(waiting) > started:
                yield _given(waiting.popleft())
        while waiting:
            yield _given(waiting.popleft())
    finally:
        for _ in range(started):
            tasks.put(None)


def _start(work: Callable[[], None], workers: int) -> int:
    """Start threads, as many as the system allows; gives how many there are."""
    for started in range(workers):
        try:
            threading.Thread(target=work, daemon=True).start()
        except RuntimeError:  # can't start new thread: memory or processes are limited
            return started
    return workers


def _given(answer: "Future[R]") -> R:
    while not answer.done():  # on Windows a wait without end would not see Ctrl-C
        wait([answer], timeout=0.5)
    return answer.result()
