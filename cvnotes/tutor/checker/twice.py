"""Two mistakes at once, neither of which explains an answer alone."""

from collections.abc import Callable, Iterator
from itertools import combinations, product
from typing import Any, NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.equality import AS_NEAR, TOLERANCE
from cvnotes.tutor.checker.exercise import Exercise
from cvnotes.tutor.checker.families import family_of
from cvnotes.tutor.checker.foreseen import explains, if_it_gives
from cvnotes.tutor.checker.inputs import slips_of, with_inputs
from cvnotes.tutor.checker.wrong_answer import Found, WrongAnswer

# How many slips of each argument are likely enough to come with another mistake.
_OF_EACH = 4
# An answer says enough if it has that many numbers at least that are no counts.
_ENOUGH = 4


class _Way(NamedTuple):
    """One mistake: its name, a sentence or what follows "you" in one, and what it gives."""

    name: str
    said: str
    gives: Callable[..., Any]


# What may have been done to an answer besides.
_BESIDES = (
    _Way("sign", "changed the sign of what you return", np.negative),
    _Way("transposed", "transposed what you return", np.transpose),
    _Way("in the opposite order", "return it in the opposite order", lambda x: np.flip(x, -1)),
    _Way("squared", "squared what you return", np.square),
    _Way("a root", "took the root of what you return", np.sqrt),
    _Way("sizes only", "took absolute values", np.abs),
    _Way("twice", "doubled what you return", lambda x: 2 * x),
    _Way("degrees", "give degrees in place of radians", np.rad2deg),
    _Way("moved on", "return it moved on by one place", lambda x: np.roll(x, 1, -1)),
    _Way("rows in the opposite order", "return it the other way round", lambda x: np.flip(x, 0)),
    _Way("half", "halved what you return", lambda x: x / 2),
)


def two_mistakes(answer: WrongAnswer) -> Found | None:
    """Name the two mistakes that together give what the student's function gave, in every case."""
    exercise, (case, outcome) = answer.exercise, answer.shown
    if exercise.answer != "function" or outcome.value is None or not _says_enough(answer):
        return None
    bound = AS_NEAR * TOLERANCE
    for first, second, gives, given in _pairs(exercise, case.args):
        if (
            given is not None
            and given.shape == outcome.value.shape
            and exercise.same(outcome.value, given, bound)
            and explains(gives, answer, exercise.same)
        ):
            if first is None:
                return Found(second.name, _sentence(second.said))
            said = f"Two things: {_sentence(first.said)} {_sentence(second.said)}"
            return Found(f"{first.name}, and {second.name}", said)
    return None


def _sentence(said: str) -> str:
    return said if said.endswith((".", "?", ")")) else f"You {said}."


def _says_enough(answer: WrongAnswer) -> bool:
    """Return whether an answer has numbers enough that it cannot be explained by chance."""
    values = [outcome.value for _, outcome in answer.tried if outcome.value is not None]
    numbers = np.concatenate([value[np.isfinite(value)] for value in values] or [np.zeros(0)])
    return len(np.unique(numbers[numbers != np.rint(numbers)])) >= _ENOUGH


def _pairs(
    exercise: Exercise, args: tuple[Any, ...]
) -> Iterator[tuple[_Way | None, _Way, Callable[..., Any], Array | None]]:
    """Yield pairs of mistakes, with what does both and what that gives; first what explains alone.

    Of one mistake and what may have been done besides it is enough to work out the one once.
    """
    listed = [
        _Way(mistake.name, mistake.sentence, gives)
        for mistake in exercise.misconceptions
        for gives in (mistake.gives, *mistake.variants)
    ]
    # A count that is off by one, and another thing, is too easily something else.
    slips = [
        _Way(*slip)
        for slip in slips_of(exercise.arguments, args, _OF_EACH)
        if not any(isinstance(x, int) for x in args)
    ]
    alone = [slip._replace(gives=with_inputs(slip.gives, exercise.reference)) for slip in slips]
    for first in (None, *listed, *alone):
        does = exercise.reference if first is None else first.gives
        given = if_it_gives(does, args)
        for change in _BESIDES if given is not None else ():
            yield first, change, _changed(change.gives, does), if_it_gives(change.gives, (given,))
    if exercise.steps is not None and family_of(exercise.steps).loops:  # they take too long
        return
    for other, slip in product(listed, slips):
        gives = with_inputs(slip.gives, other.gives)
        yield slip, other, gives, if_it_gives(gives, args)
    for one, second in combinations(slips, 2):
        gives = with_inputs(second.gives, with_inputs(one.gives, exercise.reference))
        yield one, second, gives, if_it_gives(gives, args)


def _changed(change: Callable[..., Any], gives: Callable[..., Any]) -> Callable[..., Any]:
    def changed(*args: Any) -> Any:
        given = gives(*args)
        return None if given is None else change(np.asarray(given, dtype=np.float64))

    return changed
