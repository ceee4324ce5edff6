"""Whether an exercise is sound: right answers pass, wrong ones are refused by their own names."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.difference import VAGUE
from cvnotes.tutor.checker.equality import TOLERANCE
from cvnotes.tutor.checker.exercise import Exercise
from cvnotes.tutor.checker.in_process import clock
from cvnotes.tutor.checker.judge import judge
from cvnotes.tutor.checker.outcome import Outcome
from cvnotes.tutor.checker.report import OPEN, Report

SEEDS = (2024, 1, 2, 3, 4, 5)
# What a check may take, in seconds of the processor.
_LONGEST = 1.0


def faults(exercise: Exercise, seeds: Sequence[int] = SEEDS) -> Iterator[str]:
    """Return what is wrong with an exercise, in sentences; nothing if it is sound.

    Parameters
    ----------
    exercise : Exercise
        Of the course, or of a teacher's own.
    seeds : sequence of int
        Of the random cases that it is tried on.

    Examples
    --------
    >>> from cvnotes.learn import EXERCISES
    >>> list(faults(EXERCISES["lift"]))
    []
    """
    yield from _of_the_text(exercise)
    started = clock()
    judged(exercise, exercise.reference, seeds[0])
    if clock() - started > _LONGEST:
        yield f"one check takes more than {_LONGEST:g} s: make the cases smaller"
    for seed in seeds:
        report = judged(exercise, exercise.reference, seed)
        if not report.passed:
            yield f"the reference is not right for seed {seed}: {report.message}"
    for mistake in exercise.misconceptions:
        for i, gives in enumerate((mistake.gives, *mistake.variants)):
            what = f"{mistake.name!r}" + f", variant {i}" * (i > 0)
            yield from _of_a_mistake(exercise, what, mistake.name, gives, seeds)
    yield from _of_slips(exercise, seeds[0])


def by_rules(exercise: Exercise, seed: int = SEEDS[0]) -> Iterator[tuple[str, str]]:
    """Yield each mistake of the list with what the rules say of it if there is no list.

    Nothing is said where they name nothing; what they name vaguely, by where the answer is wrong,
    stands in brackets.
    """
    bare = replace(exercise, misconceptions=())
    for mistake in exercise.misconceptions:
        said = []
        for gives in (mistake.gives, *mistake.variants):
            name = judged(bare, gives, seed).misconception or "—"
            said.append(f"({name})" if name in VAGUE else name)
        yield mistake.name, " | ".join(said)


def judged(exercise: Exercise, function: Callable[..., Any], seed: int) -> Report:
    """Judge a function of our own, in this process; of steps the references stand for the rest."""
    outcomes: list[Outcome] = []
    for part in exercise.parts:
        outcomes += [attempt(part.reference, given) for given in part.inputs(seed)]
    outcomes += [attempt(function, given) for given in exercise.inputs(seed)]
    return judge(exercise, outcomes, seed)


def _of_the_text(exercise: Exercise) -> Iterator[str]:
    names: dict[str, Any] = {}
    exec(exercise.stub, names)
    stub = names[exercise.variable]
    if exercise.answer == "function":
        if judged(exercise, stub, SEEDS[0]).verdict != OPEN:
            yield "the stub does not count as unsolved: let it do nothing (...)"
        for given in exercise.inputs(SEEDS[0]):
            if len(given) != len(exercise.arguments):
                yield f"a case has {len(given)} arguments, the stub takes {exercise.arguments}"
                break
    if not 2 <= len(set(exercise.hints)) <= 3:
        yield "two or three different hints are wanted"
    listed = exercise.misconceptions
    for what in ("name", "sentence"):
        if len({getattr(mistake, what) for mistake in listed}) < len(listed):
            yield f"two mistakes have the same {what}"
    for text in [exercise.task, *(mistake.sentence for mistake in listed)]:
        if not text.endswith((".", "?", ".)", "”")):
            yield f"no sentence: {text[-40:]!r}"


def _of_a_mistake(
    exercise: Exercise, what: str, name: str, gives: Callable[..., Any], seeds: Sequence[int]
) -> Iterator[str]:
    for seed in seeds:
        report = judged(exercise, gives, seed)
        if report.passed:
            yield f"the mistake {what} passes for seed {seed}: a case is missing that refuses it"
            return
        if report.misconception != name:
            found = report.misconception or "none"
            yield f"the mistake {what} is taken for {found!r} with seed {seed}"
            return


def _of_slips(exercise: Exercise, seed: int) -> Iterator[str]:
    """Try small slips of the right answers, which no exercise may let pass."""
    for slip, change in SLIPS.items():
        cases = list(exercise.solved_cases(seed))
        outcomes, same = [], True
        for case in cases:
            wrong = change(case.right)
            same = same and (
                wrong.shape == case.right.shape and exercise.same(wrong, case.right, TOLERANCE)
            )
            outcomes.append(Outcome("numbers", np.asarray(wrong, dtype=float), "float64"))
        if not same and not exercise.parts and judge(exercise, outcomes, seed).passed:
            yield f"{slip} passes"


# Slips of an answer as a whole, by what they do to it.
SLIPS: dict[str, Callable[[Array], Array]] = {
    "the right answer times −1": np.negative,
    "the right answer times 1.01": lambda x: 1.01 * x,
    "twice the right answer": lambda x: 2 * x,
    "the right answer plus 1": lambda x: x + 1,
    "the transpose of the right answer": np.transpose,
    "the right answer in reverse": lambda x: np.flip(x),
    "the right answer moved on by one place": lambda x: np.roll(x, 1),
    "the sizes of the right answer without signs": np.abs,
    "the right answer without its last column": lambda x: x[..., :-1] if x.ndim else x * 2,
    "the right answer with one entry 1 % larger": lambda x: _one_larger(x),
}


def _one_larger(x: Array) -> Array:
    y = np.array(x)
    if y.size:
        largest = np.unravel_index(np.nanargmax(np.abs(np.nan_to_num(y, posinf=0))), y.shape)
        y[largest] = y[largest] * 1.01 + (y[largest] == 0)
    return y
