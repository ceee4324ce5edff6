"""Time several ways to do one thing in turns, so that a machine that drifts drifts for all."""

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cvnotes.base import Array


def all_in_turns(
    ways: Mapping[str, Callable[[], Any]],
    repeats: int = 15,
    clock: Callable[[], float] = time.perf_counter,
) -> dict[str, Array]:
    """Return the times (repeats,) in seconds of each way, after one round that is not counted.

    With `time.process_time` as the clock they are those of the processor, in all threads.
    """
    spent: dict[str, list[float]] = {name: [] for name in ways}
    for turn in range(repeats + 1):
        for name, way in ways.items():
            start = clock()
            way()
            if turn:
                spent[name].append(clock() - start)
    return {name: np.array(times) for name, times in spent.items()}


def in_turns(
    ways: Mapping[str, Callable[[], Any]],
    repeats: int = 15,
    clock: Callable[[], float] = time.perf_counter,
) -> dict[str, float]:
    """Return the median time in seconds of each way."""
    spent = all_in_turns(ways, repeats, clock)
    return {name: float(np.median(times)) for name, times in spent.items()}
