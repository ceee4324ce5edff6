"""The exercise's own misconceptions, each recognised by what it gives."""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.tutor.checker.equality import AS_NEAR, TOLERANCE, Same, close, tolerance, up_to_scale
from cvnotes.tutor.checker.exercise import Case
from cvnotes.tutor.checker.wrong_answer import Found, WrongAnswer

# What is 0 in a slip is 0, but for rounding, relative to the right answer's largest number.
_ZERO = 1e-13


def foreseen(answer: WrongAnswer) -> Found | None:
    """Find the misconception that gives what the student's function gave.

    That is the first that agrees with every outcome, and is wrong where the student is.
    """
    for mistake in answer.exercise.misconceptions:
        same = mistake.same or answer.exercise.same
        ways = (mistake.gives, *mistake.variants)
        if any(explains(gives, answer, same) for gives in ways) or (
            mistake.seen is not None and _is_seen(mistake.seen, answer)
        ):
            return Found(mistake.name, mistake.sentence, enough=True)
    return None


def _is_seen(seen: Callable[[Array, Case], bool], answer: WrongAnswer) -> bool:
    """Return whether all wrong answers look like a mistake that has many results."""
    try:
        return all(
            outcome.value is not None
            and outcome.value.shape == case.right.shape
            and bool(np.isfinite(outcome.value).all())
            and seen(outcome.value, case)
            for case, outcome in answer.failing
        )
    except (np.linalg.LinAlgError, CvnotesError):
        return False


def explains(gives: Callable[..., Any], answer: WrongAnswer, same: Same) -> bool:
    """Return whether a mistake gives the same as the student's function, and is wrong where it is.

    Where the mistake gives no numbers, neither must the function: what it gave instead, an
    exception, NaN or infinity, depends on how it was written.
    """
    compared = 0
    for i, (case, outcome) in enumerate(answer.tried):
        given = what_it_gives(gives, case.args)
        # Of a single number nothing is left without its scale.
        equal = close if given is not None and given.size == 1 and same is up_to_scale else same
        if given is None:
            if outcome.value is not None and np.isfinite(outcome.value).all():
                return False
            continue
        bound = AS_NEAR * tolerance(outcome.dtype)
        if outcome.value is None or not equal(outcome.value, given, bound):
            return False
        size = float(np.abs(case.right).max(initial=0)) or 1e-3
        if not given.any() and np.abs(outcome.value).max(initial=0) > _ZERO * size:
            return False
        if i < answer.wrong and answer.exercise.same(given, case.right, TOLERANCE):
            return False
        compared += 1
    return compared > 0


def what_it_gives(function: Callable[..., Any], args: tuple[Any, ...]) -> Array | None:
    """Return the result of a mistake as numbers; None where it has none.

    Examples
    --------
    >>> what_it_gives(np.linalg.inv, (np.zeros((2, 2)),)) is None
    True
    """
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            given = function(*(np.array(x) if isinstance(x, np.ndarray) else x for x in args))
        except (np.linalg.LinAlgError, CvnotesError, IndexError):
            return None
    return None if given is None else np.asarray(given, dtype=np.float64)


def if_it_gives(function: Callable[..., Any], args: tuple[Any, ...]) -> Array | None:
    """Return the same of a function that may raise whatever it wants; None then.

    Examples
    --------
    >>> if_it_gives(lambda x: x.nothing, (np.zeros(2),)) is None
    True
    """
    try:
        return what_it_gives(function, args)
    except Exception:
        return None
