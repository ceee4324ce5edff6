"""From what a student's function gave to a report: the answer is worked out here, afterwards."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.tutor.checker.diagnosis import diagnosis
from cvnotes.tutor.checker.difference import NOT_A_NUMBER
from cvnotes.tutor.checker.equality import of_size_one, slack, tolerance, up_to_scale
from cvnotes.tutor.checker.exercise import Case, Exercise, Property
from cvnotes.tutor.checker.outcome import Outcome
from cvnotes.tutor.checker.remarks import other_shape, remarks, trouble
from cvnotes.tutor.checker.report import OPEN, RIGHT, WRONG, Report
from cvnotes.tutor.checker.wrong_answer import Tried, WrongAnswer


@np.errstate(all="ignore")
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
        return _not_solved_yet(exercise, outcomes, seed)
    if any(outcome.kind == "result" for outcome in outcomes):
        what = "no steps by name" if exercise.answer == "steps" else "a result, not the function"
        return Report(exercise.name, WRONG, _not_a_function(exercise), misconception=what)
    if exercise.refusal:
        return Report(exercise.name, WRONG, exercise.refusal)
    by_part, rest = _by_part(exercise, outcomes, seed)
    for part, own in by_part:
        report = judge(part, own, seed)
        if not report.passed:
            return replace(
                report, exercise=exercise.name, message=f"Step {part.name}: {report.message}"
            )
    cases = list(exercise.solved_cases(seed))
    if len(rest) != len(cases):
        raise CvnotesError(f"{exercise.name}: {len(rest)} outcomes for {len(cases)} cases")
    tried = [
        (replace(case, slack=slack(outcome.dtype)), outcome)
        for case, outcome in zip(cases, rest, strict=True)
    ]
    holding, failing = _sorted(exercise, tried)
    if not failing:
        sentences = tuple(p.sentence for p in exercise.properties)
        return Report(exercise.name, RIGHT, "Well done.", holds=sentences)
    return _wrong(exercise, tried, holding, failing)


def _by_part(
    exercise: Exercise, outcomes: Sequence[Outcome], seed: int
) -> tuple[list[tuple[Exercise, list[Outcome]]], list[Outcome]]:
    """Sort outcomes into those of each part, and those of the whole."""
    rest, by_part = list(outcomes), []
    for part in exercise.parts:
        n = len(part.inputs(seed))
        by_part.append((part, rest[:n]))
        del rest[:n]
    return by_part, rest


def _not_solved_yet(exercise: Exercise, outcomes: Sequence[Outcome], seed: int) -> Report:
    """Say where help is; and of several steps, which are missing, or have other names.

    What is asked stands above the answer, and is not repeated.
    """
    by_part, rest = _by_part(exercise, outcomes, seed)
    missing = [p.name for p, own in by_part if any(o.kind == "unfinished" for o in own)]
    said, name = "", None
    others = next((o.words for o in outcomes if o.kind == "unfinished" and o.words), "")
    if rest and others:
        names = ", ".join(part.name for part, _ in by_part)
        said += f"Steps go by the names of their exercises, {names}; yours: {others}. "
        name = "steps by other names"
    if rest and 0 < len(missing) < len(by_part):
        steps = f"{', '.join(missing[:-1])} and {missing[-1]}" if missing[1:] else missing[0]
        said += f"{'These steps are' if missing[1:] else 'This step is'} missing: {steps}. "
        name = name or "steps missing"
    return Report(exercise.name, OPEN, said + hint_at(exercise), misconception=name)


def hint_at(exercise: Exercise) -> str:
    """Describe where help is to be had."""
    return f'hint("{exercise.name}") helps.'


def holds(exercise: Exercise, case: Case, outcome: Outcome) -> bool:
    """Return whether all that is asked of one case is true of what came of it."""
    case = replace(case, slack=slack(outcome.dtype))
    if _unusable(exercise, case, outcome):
        return False
    asked = [p for p in exercise.properties if p.about == case.about]
    return all(_holds(exercise, p, case, outcome) for p in asked)


Failing = list[tuple[str, str, Case, Outcome]]


def _sorted(exercise: Exercise, tried: list[Tried]) -> tuple[tuple[str, ...], Failing]:
    """Sort properties into those that hold, and what fails: (property, why, case, outcome)."""
    failing: Failing = [
        ("", why, case, outcome)
        for case, outcome in tried
        if (why := _unusable(exercise, case, outcome))
    ]
    # What raised an exception comes before what has another shape.
    nothing = [x for x in failing if x[3].value is None]
    failing = nothing or failing
    holding: list[str] = []
    for p in exercise.properties:
        bad = [(c, o) for c, o in tried if c.about == p.about and not _holds(exercise, p, c, o)]
        if bad:
            failing += [(p.sentence, "", case, outcome) for case, outcome in bad]
        else:
            holding.append(p.sentence)
    return tuple(holding), failing


def _unusable(exercise: Exercise, case: Case, outcome: Outcome) -> str:
    """Describe what keeps an outcome from being compared; empty if nothing does."""
    if outcome.value is None:
        return trouble(outcome, exercise)
    if outcome.value.shape != case.right.shape:
        return other_shape(outcome.value, case.right)
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
    if not np.isfinite(answer[np.isfinite(case.right)]).all():
        return False
    if p.holds is None:
        return exercise.same(answer, case.right, tolerance(outcome.dtype))
    try:
        free = exercise.same is up_to_scale
        return bool(p.holds(of_size_one(answer) if free else answer, case))
    except (np.linalg.LinAlgError, CvnotesError):  # NaN where there should be none
        return False


def _wrong(
    exercise: Exercise, tried: list[Tried], holding: tuple[str, ...], failing: Failing
) -> Report:
    answer = _wrong_answer(exercise, tried, failing)
    case, outcome = answer.shown
    found = diagnosis(answer)
    if found is None:
        message = answer.why or f"Look at what does not hold; {hint_at(exercise)}"
    elif found.enough or answer.why:
        message = found.sentence
    else:
        message = f"{found.sentence} {hint_at(exercise)}"
    said_all = found is not None and (found.enough or found == NOT_A_NUMBER)
    sentences = [sentence for sentence, *_ in failing if sentence]
    wanted = _scaled(exercise, case.right, outcome)
    shown = exercise.answer == "function"
    compared = shown and not outcome.changed
    came = any(outcome.value is not None for _, outcome in tried)
    return Report(
        exercise.name,
        WRONG,
        message,
        misconception=found.name if found else None,
        holds=holding,
        fails=sentences[0] if sentences and came else "",
        counterexample=dict(zip(exercise.arguments, case.args, strict=True)) if shown else {},
        yours=_as_given(outcome.value, outcome) if compared else None,
        wanted=_as_given(wanted, outcome) if compared else None,
        remarks=() if said_all else remarks(exercise, outcome, case, wanted),
        printed=outcome.printed,
        exact=found.exact if found else "",
    )


def _wrong_answer(exercise: Exercise, tried: list[Tried], failing: Failing) -> WrongAnswer:
    """Gather what is wrong; of what fails first the student sees the shortest case."""
    alike = [x for x in failing if x[0] == failing[0][0]]
    _, why, shown, _ = min(alike, key=lambda x: x[2].size)
    wrong = {id(case) for _, _, case, _ in failing}

    def first_shown_then_short(one: Tried) -> tuple[bool, bool, int]:
        return one[0] is not shown, id(one[0]) not in wrong, one[0].size

    return WrongAnswer(exercise, tuple(sorted(tried, key=first_shown_then_short)), len(wrong), why)


def _as_given(x: Any, outcome: Outcome) -> Any:
    """Show truth values as such, where the student gave such."""
    return x.astype(bool) if outcome.dtype == "bool" and np.isin(x, (0, 1)).all() else x


def _scaled(exercise: Exercise, right: Array, outcome: Outcome) -> Array:
    """Return a right answer of the student's own scale and sign where these are free."""
    given = outcome.value
    if exercise.same is not up_to_scale or given is None or given.shape != right.shape:
        return right
    if np.isclose(given.flat[-1], 1, rtol=0, atol=1e-9) and not np.isclose(right.flat[-1], 0):
        return right / right.flat[-1]
    sign = 1 if np.vdot(given, right) >= 0 else -1
    factor = sign * np.linalg.norm(given) / np.linalg.norm(right)
    return right * factor if np.isfinite(factor) and factor != 0 else right


def _not_a_function(exercise: Exercise) -> str:
    if exercise.answer == "steps":
        names = ", ".join(f'"{part.name}": my_{part.name}' for part in exercise.parts)
        return f"Hand over your steps by name: {{{names}}}."
    return (
        "Hand over the function itself, without brackets, so that it can be tried on other "
        f'inputs: check("{exercise.name}", my_{exercise.name}).'
    )
