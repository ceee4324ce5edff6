"""From what a notebook handed over to verdicts: nothing in it is believed."""

import threading
import time
from collections.abc import Mapping
from typing import Any

from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED, RIGHT_THERE_NOT_HERE, verdict
from cvnotes.tutor.checker.exercise import Exercise
from cvnotes.tutor.checker.outcome import Outcome, clean, decode
from cvnotes.tutor.checker.report import WRONG
from cvnotes.tutor.course import Course
from cvnotes.tutor.grader.marks import Verdict, verdict_of

# Judging the answers of a whole course takes less than two seconds.
_SECONDS = 60.0
# Python has one list of warnings to ignore for all threads: each that restores it undoes what
# another, whose exercise's own mathematics may warn, has just set.
ALONE = threading.Lock()
FORGED = "its results are none that an answer gives"


def judged(
    answers: Mapping[str, Mapping[str, Any]], seed: int, course: Course
) -> tuple[dict[str, Verdict], tuple[str, ...]]:
    """Judge the last answer to each exercise.

    Parameters
    ----------
    answers : mapping
        What `run_notebook` gave, by the name of the exercise.
    seed : int
        Of the inputs.
    course : Course
        Whose exercises are answered.

    Returns
    -------
    verdicts : dict
        By the name of the exercise, in the order of the course.
    ids : tuple of str
        The student ids that were used.
    """
    with ALONE:
        return _judged(answers, seed, course)


def _judged(
    answers: Mapping[str, Mapping[str, Any]], seed: int, course: Course
) -> tuple[dict[str, Verdict], tuple[str, ...]]:
    verdicts: dict[str, Verdict] = {}
    ids: list[str] = []
    deadline = time.monotonic() + _SECONDS
    for name in (name for name in course.exercises if name in answers):
        given = answers[name].get("student")
        student = clean(given, 60) if isinstance(given, str | int) else None
        if time.monotonic() > deadline:
            verdicts[name] = Verdict(WRONG, "Not judged.", note="judging took too long")
            continue
        try:
            verdicts[name] = _verdict(course.asked(name, student), answers[name], seed)
        except Exception:  # whatever forged results lead to is their own affair
            verdicts[name] = Verdict(WRONG, "The results cannot be judged.", note=FORGED)
        if student and student not in ids and not verdicts[name].is_open:
            ids.append(student)
    return verdicts, tuple(ids)


def _verdict(exercise: Exercise, line: Mapping[str, Any], seed: int) -> Verdict:
    """Judge an answer on the notebook's inputs, as the student saw it, and then on others."""
    outcomes = {NOTEBOOK_SEED: _outcomes(exercise, line["outcomes"], NOTEBOOK_SEED)}
    report = verdict(exercise, outcomes)
    if not report.passed:
        return verdict_of(report)
    outcomes[seed] = _outcomes(exercise, line["again"], seed)
    report = verdict(exercise, outcomes)
    return verdict_of(report, _borrowed(line) if report.passed else RIGHT_THERE_NOT_HERE)


def _borrowed(line: Mapping[str, Any]) -> str:
    name = line.get("borrowed")
    named = isinstance(name, str) and len(name) <= 60 and name.isidentifier()
    return f"uses the library's own {name}" if named else ""


def _outcomes(exercise: Exercise, lines: Any, seed: int) -> list[Outcome]:
    if not isinstance(lines, list) or len(lines) > _most(exercise, seed):
        raise ValueError("more outcomes than inputs")
    return [_outcome(line, exercise) for line in lines]


def _most(exercise: Exercise, seed: int) -> int:
    return len(exercise.inputs(seed)) + sum(_most(part, seed) for part in exercise.parts)


def _outcome(line: Any, exercise: Exercise) -> Outcome:
    outcome = decode(line)
    most = max(len(e.arguments) for e in (exercise, *exercise.parts))
    if any(not 0 <= i < most for i in outcome.changed):
        raise ValueError("a change of an argument that there is not")
    return outcome
