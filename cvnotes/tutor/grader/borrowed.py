"""Whether a right answer is the library's own function, by whatever road it came.

The text of a notebook shows few roads: an alias, ``getattr`` or a loop over ``EXERCISES`` looks
like anything else. So it is looked at what runs. That shows nothing of whoever hides it; all that
is made of it is a remark.
"""

import dis
import inspect
import sys
from collections.abc import Callable
from functools import cache
from types import CodeType, FrameType
from typing import Any

from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED
from cvnotes.tutor.checker.exercise import Exercise
from cvnotes.tutor.checker.sandbox import run
from cvnotes.tutor.course import function_behind

# Functions with fewer instructions are equal by nature, unless they were written in no cell.
_SHORTEST = 60
_INPUTS, _SECONDS = 3, 1.0


def borrowed(answer: Any, exercise: Exercise) -> str:
    """Name the library's own function that an answer runs, or is; empty if none shows.

    Examples
    --------
    >>> from cvnotes.learn import EXERCISES
    >>> from cvnotes.homography import dlt
    >>> borrowed(lambda src, dst: -dlt(src, dst), EXERCISES["dlt"])
    'dlt'
    """
    if exercise.parts and isinstance(answer, dict):
        steps = (borrowed(answer.get(part.name), part) for part in exercise.parts)
        return next(filter(None, steps), "")
    if exercise.answer != "function" or not callable(answer):
        return ""
    theirs = _theirs(exercise)
    inputs = exercise.inputs(NOTEBOOK_SEED)[:_INPUTS]
    outcomes = run(lambda *given: _met(answer, given, theirs), inputs, seconds=_SECONDS)
    met = [int(outcome.value) for outcome in outcomes if outcome.value is not None]
    name = theirs[max(met)].co_name.strip("_") if met and max(met) >= 0 else ""
    return "reference" if "<" in name else name


@cache
def _theirs(exercise: Exercise) -> list[CodeType]:
    """Return the code of the library's functions that answer an exercise."""
    codes = []
    for source in (exercise.reference, *exercise.sources, exercise.steps):
        function = function_behind(source)
        code = getattr(inspect.unwrap(function), "__code__", None) if function else None
        codes += [code] if isinstance(code, CodeType) else []
    return codes[::-1]  # what stands first, the greatest number has


def _met(answer: Callable[..., Any], given: tuple[Any, ...], theirs: list[CodeType]) -> int:
    """Return the number of the function that runs when the answer does; −1 if none does."""
    ran: dict[int, CodeType] = {}

    def look(frame: FrameType, event: str, _: Any) -> None:
        if event == "call":
            ran.setdefault(id(frame.f_code), frame.f_code)

    sys.setprofile(look)
    try:
        answer(*given)
    finally:
        sys.setprofile(None)
    met = [i for i, code in enumerate(theirs) if any(_is_it(own, code) for own in ran.values())]
    return max(met, default=-1)


def _is_it(own: CodeType, theirs: CodeType) -> bool:
    """Return whether a function is another, or a copy of its source."""
    if own is theirs:
        return True
    if own.co_varnames != theirs.co_varnames or {*own.co_names} != {*theirs.co_names}:
        return False
    done = _instructions(own)
    long = len(done) >= _SHORTEST or own.co_filename == "<string>"
    return long and done == _instructions(theirs)


def _instructions(code: CodeType) -> list[tuple[str, Any]]:
    """Return what a function does, without its name, its place and what it says of itself.

    How a name's attribute is called depends on whether the name was imported in the same file, and
    with it how far a jump leads.
    """
    jumps = {*dis.hasjrel, *dis.hasjabs}
    return [
        (
            one.opname.replace("METHOD", "ATTR"),
            "" if inspect.iscode(one.argval) or one.opcode in jumps else one.argval,
        )
        for one in dis.get_instructions(code)
        if one.opname != "PUSH_NULL"
    ]
