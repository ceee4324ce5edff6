"""One call of a student's function, whatever it does: the part that runs beside it."""

import builtins
import contextlib
import copy
import dis
import io
import linecache
import traceback
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from cvnotes.tutor.checker.outcome import MAX_PRINTED, Outcome, clean, outcome_of


class Printed(io.TextIOBase):
    """A stream that keeps the beginning of what is printed and forgets the rest."""

    def __init__(self) -> None:
        self.text = ""

    def writable(self) -> bool:
        """Tell ``print`` that it may."""
        return True

    def write(self, text: str) -> int:
        """Keep what still fits."""
        if len(self.text) < MAX_PRINTED:
            self.text += str(text)[: MAX_PRINTED - len(self.text)]
        return len(text)


def attempt(function: Callable[..., Any], given: tuple[Any, ...]) -> Outcome:
    """Call a function with copies of what is given, and tell what came of it.

    Examples
    --------
    >>> attempt(lambda x: 1 / x, (0,)).kind
    'raised'
    """
    copies = tuple(copy.deepcopy(x) for x in given)
    printed = Printed()
    try:
        with _quiet(printed):
            answer = function(*copies)
            outcome = outcome_of(answer)
            shares = any(_shares(answer, x) for x in copies)
            del answer  # a coroutine complains when it goes
    except BaseException as error:
        return replace(_failure(error), printed=printed.text)
    changed = tuple(i for i, pair in enumerate(zip(copies, given, strict=True)) if _differ(*pair))
    if outcome.kind == "none" and is_empty(function):
        outcome = Outcome("unfinished")
    return replace(outcome, changed=changed, shares=shares, printed=printed.text)


def is_empty(function: Callable[..., Any]) -> bool:
    """Return whether a function does nothing: a stub, with or without a docstring.

    Examples
    --------
    >>> def stub(x): ...
    >>> is_empty(stub), is_empty(abs)
    (True, False)
    """
    code = getattr(function, "__code__", None)
    if code is None:
        return False
    # Whoever does something names something, or combines its arguments.
    idle = {"RESUME", "LOAD_CONST", "RETURN_CONST", "RETURN_VALUE", "NOP", "COPY_FREE_VARS"}
    return all(step.opname in idle for step in dis.get_instructions(code))


@contextlib.contextmanager
def _quiet(printed: Printed) -> Iterator[None]:
    """Catch what is printed, warn of nothing, and have nobody at the keyboard."""

    def nobody(*_: Any) -> str:
        raise EOFError("nobody can answer input() during a check")

    asked = builtins.input
    with contextlib.ExitStack() as stack:
        stack.enter_context(np.errstate(all="ignore"))
        stack.enter_context(warnings.catch_warnings())
        warnings.simplefilter("ignore")
        stack.enter_context(contextlib.redirect_stdout(printed))
        stack.enter_context(contextlib.redirect_stderr(printed))
        builtins.input = nobody
        try:
            yield
        finally:
            builtins.input = asked


def _failure(error: BaseException) -> Outcome:
    """Put what was raised into words."""
    if isinstance(error, NotImplementedError):
        return Outcome("unfinished")
    if isinstance(error, MemoryError):
        return Outcome("memory")
    try:
        words = clean(error)
    except BaseException:
        words = "(its message cannot be read)"
    name = clean(type(error).__name__, 60)
    return Outcome("raised", words=f"{name}: {words}{_where(error)}" if words else name)


def _where(error: BaseException) -> str:
    """Quote the student's own line in which it happened."""
    try:
        _, *steps = traceback.walk_tb(error.__traceback__)  # the first is `attempt`
        path = steps[0][0].f_code.co_filename
        line = [line for frame, line in steps if frame.f_code.co_filename == path][-1]
        text = clean(linecache.getline(path, line), 80)
    except BaseException:
        return ""
    return f", in the line `{text}`" if text else ""


def _shares(answer: Any, given: Any) -> bool:
    both = isinstance(answer, np.ndarray) and isinstance(given, np.ndarray)
    return both and bool(np.may_share_memory(answer, given))


def _differ(after: Any, before: Any) -> bool:
    """Return whether an argument was changed."""
    try:
        if isinstance(before, np.ndarray):
            return not (
                after.shape == before.shape and np.array_equal(after, before, equal_nan=True)
            )
        return bool(after != before)
    except BaseException:
        return True
