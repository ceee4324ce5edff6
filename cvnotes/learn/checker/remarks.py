"""The checker's sentences about answers that cannot be compared."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.checker.equality import up_to_scale
from cvnotes.learn.checker.exercise import Case, Exercise
from cvnotes.learn.checker.outcome import Outcome

_RAISED = {
    "RecursionError": "Your function calls itself without end. Give it a case that ends it.",
    "SystemExit": "Your function tries to end the program. Let it return its answer instead.",
    "KeyboardInterrupt": "Your function was interrupted. Run the check again.",
    "EOFError": "Your function waits for the keyboard. Let it use its arguments only.",
}


def trouble(outcome: Outcome, exercise: Exercise) -> str:
    """Say kindly and exactly what happened instead of an answer."""
    match outcome.kind:
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
            return f"The answer is {outcome.words}; an array of numbers is wanted."


def other_shape(exercise: Exercise, answer: Array, case: Case) -> str:
    """Say what is probably wrong with a shape; what can be measured is measured."""
    given, wanted = answer.shape, case.right.shape
    text = f"The answer has shape {given}, wanted is {wanted}"
    many = one_for_each_point(exercise, case)
    if wanted == ():
        return f"{text}: a single number is wanted."
    if given == wanted[::-1]:
        rows = (
            "points are rows here" if many and len(wanted) == 2 else "an array has its rows first"
        )
        return f"{text}: {rows}, so transpose it."
    if given == () and np.isnan(answer):
        return f"{text}: one NaN for all of it; np.full({wanted}, np.nan) has the shape."
    if np.prod(given) == np.prod(wanted):
        return f"{text}: the values may be right, the arrangement is not; see np.reshape."
    if given and wanted and given[:-1] == wanted[:-1] and given[-1] == wanted[-1] + 1:
        if np.allclose(_dropped(answer), case.right, equal_nan=True):
            return f"{text}: still homogeneous? Divide by the last coordinate, then leave it out."
        return f"{text}: one number too many{' in each row' * (len(wanted) > 1)}."
    if given == () and many:
        return f"{text}: one number for all of them; is an axis=1 missing?"
    if given == ():
        return f"{text}: one number alone."
    if given == wanted[1:] and many:
        return f"{text}: only one of several points came back; is the return inside of the loop?"
    if given == wanted[1:]:
        return f"{text}: only one row came back; is the return inside of a loop?"
    if len(given) == 1 and len(wanted) > 1:
        return f"{text}: all in one row; np.append and np.concatenate take an axis."
    if len(given) > len(wanted) and given[: len(wanted)] == wanted:
        last = "axis=1" if len(given) == 2 else "axis=-1"
        return f"{text}: an axis too many; is a sum, a norm or an all along {last} missing?"
    if len(given) == len(wanted) and given[1:] == wanted[1:]:
        rows = "row" if len(wanted) > 1 else "number"
        fewer = given[0] < wanted[0]
        return f"{text}: {rows}s are missing." if fewer else f"{text}: there are {rows}s too many."
    return f"{text}."


def one_for_each_point(exercise: Exercise, case: Case) -> bool:
    """Tell whether an answer has a row for each of n points that were given."""
    wanted = case.right.shape
    return "(n" in exercise.task and any(
        isinstance(x, np.ndarray) and x.shape[:1] == wanted[:1] != () for x in case.args
    )


def _dropped(answer: Array) -> Array:
    """Divide by the last coordinate, and leave it out."""
    with np.errstate(all="ignore"):
        return np.asarray(answer[..., :-1] / answer[..., -1:])


def remarks(exercise: Exercise, outcome: Outcome, case: Case, wanted: Array) -> tuple[str, ...]:
    """Say what else is striking about an answer that is not right; wanted is what is shown."""
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
