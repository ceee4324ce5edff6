"""What a function does with other inputs: where it is right, and what it does not depend on.

An answer that nothing explains can still be asked what its mistake hangs on. Inputs are changed,
and the student's function and the right one are called with both.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.equality import TOLERANCE, close, disturbed
from cvnotes.tutor.checker.exercise import Case, Exercise
from cvnotes.tutor.checker.foreseen import if_it_gives
from cvnotes.tutor.checker.inputs import ENTRIES_OF_A, slips_of, with_inputs
from cvnotes.tutor.checker.sandbox import run
from cvnotes.tutor.checker.wrong_answer import Found

_SEEDS = (9001, 9002, 9003)
# So many inputs are asked about, the shortest; so many different numbers exclude chance.
_INPUTS, _ENOUGH = 4, 3
_FEW = 6  # numbers that are asked about one by one
_NAMED = 3  # parts that are said
# What all of it may take, in seconds of the processor, where it can be ended.
_PATIENCE = 0.5
# What is unchanged is so to the last digits.
_UNCHANGED = 1e-12
# What is said of changes, {0}.
_SAID = (
    ("right with {0}", "Were the input simpler, with {0}, your answer would be right: that is "
     "where to look."),
    ("independent of {0}", "Your answer does not depend on {0}; the right one does."),
    ("another with {0}", "The right answer stays the same with {0}; yours does not."),
)  # fmt: skip

Change = Callable[..., tuple[Any, ...]]


class _Asked(NamedTuple):
    """An input, changed in argument i by so many numbers; what both gave before and give then."""

    i: int
    args: tuple[Any, ...]
    size: int
    mine: tuple[Array, Array]
    right: tuple[Array, Array]


@lru_cache(maxsize=64)
def usual_first(exercise: Exercise) -> tuple[Case, ...]:
    """Return cases with a right answer each: the usual ones first, and short ones before long."""
    found = [case for seed in _SEEDS for case in exercise.solved_cases(seed)]
    return tuple(sorted(found, key=lambda case: (case.about, case.size)))


def probed(function: Any, exercise: Exercise) -> Found | None:
    """Say with which input a function is right, or what it does not depend on.

    The function runs where it can do no harm.

    Examples
    --------
    >>> from cvnotes.learn import EXERCISES
    >>> probed(lambda A, width: np.arctan(width / A[0, 0]), EXERCISES["field_of_view"]).name
    'independent of u0 of A'
    """
    if exercise.answer != "function" or not callable(function):
        return None
    cases = usual_first(exercise)
    slips = [*slips_of(exercise.arguments, cases[0].args)]
    parts = [*_parts(exercise.arguments, cases[0].args)]
    changes = [change for *_, change in slips], [(i, place) for _, i, place in parts]
    [found] = run(lambda: _found(function, exercise, cases, *changes), [()], seconds=_PATIENCE)
    if found.value is None or not found.value.size:
        return None
    said, *numbers = found.value.astype(int).tolist()
    what = " and ".join((parts if said == 1 else slips)[i][0] for i in numbers[:_NAMED])
    what = what.replace("sign of", "the other sign of")
    name, sentence = (text.format(what) for text in _SAID[said])
    return Found(name, sentence)


def _found(
    function: Callable[..., Any],
    exercise: Exercise,
    cases: Sequence[Case],
    slips: Sequence[Change],
    parts: Sequence[tuple[int, Any]],
) -> Array:
    """Return the numbers of what can be said and of the changes; empty if nothing can."""
    same = exercise.same
    answers = [(case, if_it_gives(function, case.args)) for case in cases]
    wrong = [
        (case, mine)
        for case, mine in answers
        if mine is not None and not same(mine, case.right, TOLERANCE)
    ]
    usual = ([one for one in wrong if not one[0].about] or wrong)[:_INPUTS]
    slipped = [_asked(function, slip, exercise, usual) for slip in slips]
    simpler = [
        (sum(one.size for one in asked), i)
        for i, asked in enumerate(slipped)
        if all(same(one.mine[1], one.right[1], TOLERANCE) and one.size for one in asked)
        and all(np.array_equal(slips[i](*one.args)[one.i], one.args[one.i]) for one in asked)
        and asked
    ]
    if simpler:
        return np.array([0.0, min(simpler)[1]])
    free: list[int] = []
    for number, (i, place) in enumerate(parts):
        asked = _asked(function, partial(_with_others, i, place), exercise, usual)
        if (
            asked
            and not any(parts[n] == (i, ...) for n in free)  # nor is any part of it
            and all(close(*one.mine[::-1], _UNCHANGED) for one in asked)
            and not any(same(*one.right[::-1], TOLERANCE) for one in asked)
        ):
            free.append(number)
    if free:
        return np.array([1, *free], dtype=float)
    for i, asked in enumerate(slipped):
        if asked and all(
            same(*one.right[::-1], TOLERANCE) and not same(*one.mine[::-1], 1e3 * TOLERANCE)
            for one in asked
        ):
            return np.array([2.0, i])
    return np.zeros(0)


def _asked(
    function: Callable[..., Any],
    change: Change,
    exercise: Exercise,
    wrong: Sequence[tuple[Case, Array]],
) -> list[_Asked]:
    """Ask both functions about changed inputs; empty if that proves nothing."""
    found = []
    for case, mine in wrong:
        try:
            args = change(*case.args)
        except (ValueError, IndexError, TypeError, ZeroDivisionError):
            return []
        apart = [i for i, x in enumerate(args) if not np.array_equal(x, case.args[i])]
        if not apart:
            continue
        right = if_it_gives(with_inputs(change, exercise.reference), case.args)
        new, i = if_it_gives(function, args), apart[0]
        if apart[1:] or any(np.array_equal(args[i], old) for old in case.args):
            return []  # one for another is no simpler input
        if right is None or new is None or not np.isfinite([*right.flat, *mine.flat]).all():
            return []
        size = np.size(args[i]) - int(np.isin(args[i], case.args[i]).sum())
        found.append(_Asked(i, args, size, (mine, new), (case.right, right)))
    numbers = np.unique([x for one in found for x in one.right[1].round(9).flat])
    return found if len(found) > 1 and (numbers != np.rint(numbers)).sum() >= _ENOUGH else []


def _parts(names: Sequence[str], args: Sequence[Any]) -> Iterator[tuple[str, int, Any]]:
    """Yield parts of the input: what each is called, and where it is; an argument before parts."""
    for i, (name, arg) in enumerate(zip(names, args, strict=True)):
        if isinstance(arg, tuple | int):
            continue
        yield name, i, ...
        if name == "A":
            yield from ((f"{entry} of A", i, place) for entry, place in ENTRIES_OF_A.items())
        elif np.shape(arg) == (4, 4):
            yield f"the R of {name}", i, np.s_[:3, :3]
            yield f"the T of {name}", i, np.s_[:3, 3]
        elif np.ndim(arg) == 1 and np.size(arg) <= _FEW:
            yield from ((f"{name}[{j}]", i, j) for j in range(len(arg)))
        elif np.ndim(arg) > 1 and np.shape(arg) != (3, 3):
            yield f"all of {name} but the first", i, np.s_[1:]
            yield from ((f"the last of {name}", i, -1),) * (len(arg) > 2)


def _with_others(i: int, place: Any, *args: Any) -> tuple[Any, ...]:
    new = np.array(args[i])
    new[place] = disturbed(new[place])
    return (*args[:i], new if new.ndim else new.item(), *args[i + 1 :])
