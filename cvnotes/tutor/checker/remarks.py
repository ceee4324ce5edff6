"""The checker's sentences about answers that cannot be compared."""

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.equality import up_to_scale
from cvnotes.tutor.checker.exercise import Case, Exercise
from cvnotes.tutor.checker.outcome import Outcome

_RAISED = {
    "RecursionError": "Your function calls itself without end. Give it a case that ends it.",
    "SystemExit": "Your function tries to end the program. Let it return its answer instead.",
    "KeyboardInterrupt": "Your function was interrupted. Run the check again.",
    "EOFError": "Your function waits for the keyboard. Let it use its arguments only.",
}


def trouble(outcome: Outcome, exercise: Exercise) -> str:
    """Say kindly and exactly what happened instead of an answer."""
    value = exercise.answer == "value"
    match outcome.kind:
        case "none" if value:
            return "The answer is None: is a return missing in the function that worked it out?"
        case "none":
            return (
                "Your function gives None: is a return missing? Or is a function that it uses "
                "not solved yet?"
            )
        case "text" if exercise.choices:
            return f"The answer is one of {', '.join(exercise.choices)}; {outcome.words} is none."
        case "text":
            return f"The answer is the text {outcome.words}; numbers are wanted."
        case "late":
            return (
                f"Your function was stopped after {outcome.words} seconds: does a loop never end?"
            )
        case "memory":
            return "Your function ran out of memory: is an array much larger than its inputs need?"
        case "died":
            return (
                f"Your function ended its process ({outcome.words}). Nothing else was harmed; "
                "let it return its answer."
            )
        case "raised":
            name = outcome.words.split(":")[0].split(",")[0]
            return _RAISED.get(name, f"Your function raised {outcome.words}.")
        case _:
            wanted = "numbers are wanted." if value else "an array of numbers is wanted."
            if outcome.words.endswith("?"):
                return f"The answer is {outcome.words} {wanted.capitalize()}"
            return f"The answer is {outcome.words}; {wanted}"


def other_shape(answer: Array, right: Array) -> str:
    """Say that an answer has another shape than a right one."""
    return f"The answer has shape {answer.shape}, wanted is {right.shape}."


def remarks(exercise: Exercise, outcome: Outcome, case: Case, wanted: Array) -> tuple[str, ...]:
    """Describe what else is striking about an answer that is not right; wanted is what is shown."""
    found = []
    answer = outcome.value
    if answer is not None and np.isnan(answer).any() and not np.isnan(case.right).any():
        found.append("The answer contains NaN: 0/0, or the root of a negative number?")
    elif answer is not None and np.isinf(answer).any():
        found.append("The answer contains infinite values: was something divided by 0?")
    whole = outcome.dtype.startswith(("int", "uint"))
    if exercise.answer == "function" and whole and (case.right != np.round(case.right)).any():
        found.append(
            f"The answer is made of whole numbers ({outcome.dtype}): what was written into an "
            "integer array has lost its decimals."
        )
    if exercise.same is up_to_scale and not np.array_equal(wanted, case.right):
        found.append(
            "A factor of the whole answer does not matter: wanted is shown with that of yours."
        )
    if outcome.shares:
        found.append("The answer is a view of an argument: whoever changes one changes the other.")
    if "PASSED" in outcome.printed.upper():
        found.append("What a function prints does not count; what it returns does.")
    return tuple(found)
