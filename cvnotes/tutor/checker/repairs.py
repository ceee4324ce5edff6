"""What puts a student's own code right: another sign, index or number in one of its places.

Whoever takes another road than the reference's steps makes the same slips on it. So what may slip
in the steps is tried on the student's own code, and more; what makes it right on all usual inputs
is proven, whatever the road.
"""

import ast
from collections.abc import Callable, Sequence
from types import FunctionType
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.base.text import clipped
from cvnotes.tutor.checker.difference import VAGUE
from cvnotes.tutor.checker.exercise import Case, Exercise
from cvnotes.tutor.checker.in_process import clock
from cvnotes.tutor.checker.instrumented import Instrumented
from cvnotes.tutor.checker.judge import holds
from cvnotes.tutor.checker.outcome import Outcome
from cvnotes.tutor.checker.probes import probed, usual_first
from cvnotes.tutor.checker.sandbox import run
from cvnotes.tutor.checker.steps import located
from cvnotes.tutor.checker.switches import KINDS, Slip, Switches
from cvnotes.tutor.checker.wrong_answer import Found

# How many slips are tried; and what all of it may take, in seconds of the processor.
_TRIES, _PATIENCE = 2000, 0.4
# A function that takes longer than that for one case is not tried.
_SLOW = 0.01
_LONGEST = 60  # characters of code that is quoted


class _Switched(Instrumented):
    """A student's function with a switch at each place of its expressions."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.switches = Switches(own=True)
        super().__init__(function)

    @property
    def _known(self) -> dict[str, Any]:
        return self.switches.names

    def _marked(self, function: ast.FunctionDef, _: str) -> ast.FunctionDef:
        if any(isinstance(node, ast.While) for node in ast.walk(function)):
            raise ValueError("with another sign it may never end")
        return self.switches.switched(function)


def pointed(answer: Any, exercise: Exercise, misconception: str | None = None) -> Found:
    """Say where an answer leaves the way, and what belongs there exactly; empty if that is unknown.

    Parameters
    ----------
    answer : any
        What was handed over.
    exercise : Exercise
        What was asked.
    misconception : str or None
        What it was called. If that says what was done, no other way to put it right is sought; and
        what other inputs tell, only if it has no name.
    """
    place = located(answer, exercise)
    said = place.sentence if place is not None else ""
    if place is not None and place.missing is not None:
        return Found(f"wrong in {place.missing.words}", said, exact=place.missing.code)
    found = repaired(answer, exercise) if misconception in (None, *VAGUE) else None
    if found is None and misconception is None:
        found = probed(answer, exercise)
    return (
        Found("", said)
        if found is None
        else found._replace(sentence=f"{said} {found.sentence}".strip())
    )


def repaired(function: Any, exercise: Exercise) -> Found | None:
    """Find the one place of a student's function that, put right, makes all usual inputs right.

    The function runs where it can do no harm.

    Examples
    --------
    >>> from cvnotes.learn import EXERCISES
    >>> print(repaired(lambda x, k: np.hstack([k * x, np.ones((len(x), 1))]), EXERCISES["lift"]))
    None
    """
    if not isinstance(function, FunctionType):
        return None
    try:
        own = _Switched(function)
    except (OSError, TypeError, ValueError, SyntaxError, RecursionError):
        return None
    slips, cases = own.switches.slips, usual_first(exercise)
    [found] = run(lambda: _found(own, slips, exercise, cases), [()], seconds=_PATIENCE)
    if found.value is None or found.value < 0:
        return None
    slip = slips[int(found.value)]
    before, after = (clipped(text, _LONGEST) for text in own.switches.text(slip))
    where = f"in `{before}`{', everywhere' * slip.everywhere}"
    sentence = f"It comes out right with {KINDS[slip.kind][1]} {where}."
    return Found(f"{slip.kind} {where}", sentence, exact=after)


def _found(
    own: _Switched, slips: Sequence[Slip], exercise: Exercise, cases: Sequence[Case]
) -> Array:
    """Return the number of the slip that puts all usual cases right, or −1."""
    started = clock()

    def right(case: Case) -> bool:
        try:
            value = np.asarray(own(case.args), dtype=np.float64)
        except (ValueError, TypeError):
            return False
        return holds(exercise, case, Outcome("numbers", value, dtype="float64"))

    wrong = next((case for case in cases if not right(case)), None)
    if wrong is None or clock() - started > _SLOW * len(cases):
        return np.array(-1.0)
    usual = [case for case in cases if case is not wrong and (not case.about or wrong.about)]
    for number, slip in enumerate(slips[:_TRIES]):
        with own.switches.set_to(slip):
            if right(wrong) and all(map(right, usual)):
                return np.array(float(number))
    return np.array(-1.0)
