"""Trying a student's answer on the cases of an exercise, without judging it."""

from typing import Any

from cvnotes.learn.exercise import Exercise
from cvnotes.learn.outcome import Outcome
from cvnotes.learn.sandbox import run


def ask(exercise: Exercise, answer: Any, seed: int, **limits: Any) -> list[Outcome]:
    """Try an answer on the cases of an exercise, without judging.

    Parameters
    ----------
    exercise : Exercise
        What is asked.
    answer : any
        The function, value or steps that the student hands over.
    seed : int
        Of the random cases.
    **limits
        Of time and memory; see `cvnotes.learn.sandbox.run`.

    Returns
    -------
    list of Outcome
        One for each case, of each part first; a single one if there was nothing to try.
    """
    if exercise.answer == "value":
        value = exercise.number_of(answer) if isinstance(answer, str) else answer
        return run(lambda: value, [()], **limits)
    if exercise.assemble is not None and isinstance(answer, dict):
        parts = [ask(part, answer.get(part.name), seed, **limits) for part in exercise.parts]
        whole = run(exercise.assemble(answer), exercise.inputs(seed), **limits)
        return [outcome for outcomes in [*parts, whole] for outcome in outcomes]
    if exercise.assemble is not None or not callable(answer):
        [given] = run(lambda: answer, [()], **limits)
        nothing = given.kind in ("none", "unfinished")
        return [Outcome("unfinished" if nothing else "result")]
    return run(answer, exercise.inputs(seed), **limits)
