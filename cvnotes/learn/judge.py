"""From what a student's function gave to a report: the answer is worked out here, afterwards."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cvnotes.errors import Array, CvnotesError
from cvnotes.learn.equality import Same
from cvnotes.learn.exercise import Case, Exercise, Misconception, Property
from cvnotes.learn.outcome import Outcome
from cvnotes.learn.report import OPEN, RIGHT, WRONG, Report
from cvnotes.learn.wording import other_shape, remarks, trouble

TOLERANCE = 1e-6
# Single precision is a fair choice; its rounding must not count as a mistake.
SINGLE_TOLERANCE = 2e-4


def judge(exercise: Exercise, outcomes: Sequence[Outcome], seed: int) -> Report:
    """Compare what came back with what must be true.

    Parameters
    ----------
    exercise : Exercise
        What was asked.
    outcomes : sequence of Outcome
        What `ask` gave for the same seed.
    seed : int
        Of the random cases.

    Returns
    -------
    Report
        Passed only if every property holds on every case.
    """
    if any(outcome.kind == "unfinished" for outcome in outcomes):
        return Report(exercise.name, OPEN, f"{exercise.title}. {hint_at(exercise)}")
    if any(outcome.kind == "result" for outcome in outcomes):
        return Report(exercise.name, WRONG, _not_a_function(exercise))
    rest = list(outcomes)
    for part in exercise.parts:
        n = len(part.inputs(seed))
        report = judge(part, rest[:n], seed)
        if not report.passed:
            return replace(
                report, exercise=exercise.name, message=f"Step {part.name}: {report.message}"
            )
        del rest[:n]
    cases = list(exercise.solved_cases(seed))
    if len(rest) != len(cases):
        raise CvnotesError(f"{exercise.name}: {len(rest)} outcomes for {len(cases)} cases")
    tried = list(zip(cases, rest, strict=True))
    holding, failing = _sorted(exercise, tried)
    if not failing:
        sentences = tuple(p.sentence for p in exercise.properties)
        return Report(exercise.name, RIGHT, "Well done.", holds=sentences)
    return _wrong(exercise, tried, holding, failing)


def hint_at(exercise: Exercise) -> str:
    """Say where help is to be had."""
    return f'hint("{exercise.name}") helps.'


Tried = tuple[Case, Outcome]
Failing = list[tuple[str, str, Case, Outcome]]


def _sorted(exercise: Exercise, tried: list[Tried]) -> tuple[tuple[str, ...], Failing]:
    """Sort properties into those that hold, and what fails: (property, why, case, outcome)."""
    failing: Failing = [
        ("", why, case, outcome)
        for case, outcome in tried
        if (why := _unusable(exercise, case, outcome))
    ]
    holding: list[str] = []
    for p in exercise.properties:
        bad = [(c, o) for c, o in tried if c.about == p.about and not _holds(exercise, p, c, o)]
        if bad:
            failing += [(p.sentence, "", case, outcome) for case, outcome in bad]
        else:
            holding.append(p.sentence)
    return tuple(holding), failing


def _unusable(exercise: Exercise, case: Case, outcome: Outcome) -> str:
    """Say what keeps an outcome from being compared; empty if nothing does."""
    if outcome.value is None:
        return trouble(outcome)
    if outcome.value.shape != case.right.shape:
        return other_shape(outcome.value.shape, case.right.shape)
    if outcome.changed:
        name = exercise.arguments[outcome.changed[0]]
        return (
            f"Your function changes its argument {name}, which belongs to whoever calls it. "
            f"Work on a copy: {name} = np.array({name}, dtype=float)."
        )
    return ""


def _holds(exercise: Exercise, p: Property, case: Case, outcome: Outcome) -> bool:
    answer = outcome.value
    if answer is None or answer.shape != case.right.shape:
        return False
    if p.holds is None:
        return exercise.same(answer, case.right, _tolerance(outcome))
    with np.errstate(all="ignore"):
        try:
            return bool(p.holds(answer, case))
        except (np.linalg.LinAlgError, CvnotesError):  # NaN where there should be none
            return False


def _tolerance(outcome: Outcome) -> float:
    return SINGLE_TOLERANCE if outcome.dtype in ("float32", "float16") else TOLERANCE


def _wrong(
    exercise: Exercise, tried: list[Tried], holding: tuple[str, ...], failing: Failing
) -> Report:
    alike = [x for x in failing if x[0] == failing[0][0]]
    _, why, case, outcome = min(alike, key=lambda x: x[2].size)
    sentences = [sentence for sentence, *_ in failing if sentence]
    mistake = _mistake(exercise, tried, failing) if sentences else None
    if mistake is not None:
        why = mistake.sentence
    elif not why:
        why = f"Look at what does not hold, or ask for help: {hint_at(exercise)}"
    shown = exercise.answer == "function"
    return Report(
        exercise.name,
        WRONG,
        why,
        misconception=mistake.name if mistake else None,
        holds=holding,
        fails=sentences[0] if sentences else "",
        counterexample=dict(zip(exercise.arguments, case.args, strict=True)) if shown else {},
        yours=outcome.value if shown else None,
        wanted=case.right if shown else None,
        remarks=() if mistake else remarks(outcome, case),
        printed=outcome.printed,
    )


def _mistake(exercise: Exercise, tried: list[Tried], failing: Failing) -> Misconception | None:
    """Find the mistake that gives what the student's function gave."""
    wrong = {id(case) for _, _, case, _ in failing}
    for mistake in exercise.misconceptions:
        same = mistake.same or exercise.same
        for gives in (mistake.gives, *mistake.variants):
            if _explains(exercise, gives, same, tried, wrong):
                return mistake
    return None


def _explains(
    exercise: Exercise, gives: Callable[..., Any], same: Same, tried: list[Tried], wrong: set[int]
) -> bool:
    """Tell whether a mistake gives the same, wherever it gives anything, and is wrong there too."""
    compared = 0
    for case, outcome in tried:
        given = what_it_gives(gives, case.args)
        if given is None:
            continue
        if outcome.value is None or not same(outcome.value, given, _tolerance(outcome)):
            return False
        if id(case) in wrong and exercise.same(given, case.right, TOLERANCE):
            return False
        compared += 1
    return compared > 0


def what_it_gives(function: Callable[..., Any], args: tuple[Any, ...]) -> Array | None:
    """Give the result of a mistake as numbers; None where it has none."""
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            given = function(*(np.array(x) if isinstance(x, np.ndarray) else x for x in args))
        except (np.linalg.LinAlgError, CvnotesError):
            return None
    return None if given is None else np.asarray(given, dtype=np.float64)


def _not_a_function(exercise: Exercise) -> str:
    if exercise.answer == "steps":
        names = ", ".join(f'"{part.name}": my_{part.name}' for part in exercise.parts)
        return f"Hand over your steps by name: {{{names}}}."
    return (
        "Hand over the function itself, without brackets, so that it can be tried on other "
        f'inputs: check("{exercise.name}", my_{exercise.name}).'
    )
