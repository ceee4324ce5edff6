"""Mistakes that every exercise shares, by name: an answer that never came, its shape, its numbers.

They are looked at after the exercise's own. Each is measured: it is what stands between the
answers and right ones, in all cases alike.
"""

import re
from collections.abc import Sequence

from cvnotes.learn.checker.diagnosis import Found, Tried
from cvnotes.learn.checker.difference import difference
from cvnotes.learn.checker.exercise import Case, Exercise
from cvnotes.learn.checker.inputs import slipped_input
from cvnotes.learn.checker.outcome import Outcome
from cvnotes.learn.checker.shapes import misshapen


def general_mistake(
    exercise: Exercise, tried: Sequence[Tried], failing: Sequence[Case], shown: Case, why: str
) -> Found | None:
    """Name a mistake that is none of the exercise's own.

    Parameters
    ----------
    exercise : Exercise
        What was asked.
    tried : sequence of (Case, Outcome)
        All cases, with what came of them.
    failing : sequence of Case
        Those on which the answer is wrong.
    shown : Case
        The one that the student sees.
    why : str
        What is said of an answer that cannot be compared; empty if it can.

    Returns
    -------
    Found or None
        Its name, and a sentence that begins with `why` if there is something.
    """
    missing = next((o for c, o in tried if c is shown and o.value is None), None)
    if missing is not None:
        return _without_answer(exercise, missing, why)
    return (
        misshapen(exercise, tried, shown)
        or difference(exercise, tried, failing)
        or slipped_input(exercise, tried, failing)
    )


def _without_answer(exercise: Exercise, outcome: Outcome, why: str) -> Found | None:
    if outcome.kind == "raised":
        for pattern, name, sentence in _RAISED:
            if re.search(pattern, outcome.words):
                return Found(name, f"{why} {sentence}".strip())
        return None
    if outcome.kind == "other":
        name = "not called" if "not called" in outcome.words else "no array of numbers"
        return Found("complex numbers" if "complex" in outcome.words else name, why)
    if outcome.kind == "text" and exercise.choices:
        return Found("none of the choices", why)
    kinds = {"none": "nothing returned", "text": "a text for numbers", "late": "never ends"}
    return Found(kinds[outcome.kind], why) if outcome.kind in kinds else None


# What Python and NumPy say of a slip that has a name.
_RAISED: tuple[tuple[str, str, str], ...] = (
    (
        r"truth value of an array",
        "if on arrays",
        "An if decides once, for a single number; for arrays there are np.where and masks, x[x > "
        "0],"
        " and & in place of and.",
    ),
    (
        r"only (length-1|size-1|0-dimensional) arrays",
        "one number wanted, an array given",
        "Functions of math, float() and int() take a single number; those of NumPy take arrays.",
    ),
    (
        r"not positive definite",
        "not positive definite",
        "Cholesky needs a symmetric matrix with positive eigenvalues: look at its sign and order.",
    ),
    (
        r"[Ss]ingular matrix",
        "a singular system",
        "These equations have no single solution: what if they depend on each other?",
    ),
    (
        r"matmul|shapes .* not aligned|mismatch in its core dimension",
        "shapes that do not fit",
        "The last axis of the left must be as long as the first of the right: points are rows, "
        "so x @ M.T.",
    ),
    (
        r"broadcast",
        "shapes that do not fit",
        "Shapes are compared from the right: a column (n, 1) fits rows (n, d), (n,) does not.",
    ),
    (r"cannot reshape", "shapes that do not fit", "A reshape keeps how many numbers there are."),
    (
        r"must match exactly|must have same number of dimensions|inhomogeneous",
        "shapes that do not fit",
        "What is joined must have the same shape in all other axes.",
    ),
    (
        r"square|must be \(.*\) dimensional|at least two-dimensional",
        "shapes that do not fit",
        "This function needs a square matrix.",
    ),
    (
        r"only integers, slices|indices must be integers|cannot be interpreted as an integer",
        "an index that is no whole number",
        "Round it, then make it an int.",
    ),
    (
        r"IndexError",
        "an index too large",
        "Indices go from 0 to the length − 1.",
    ),
    (r"ZeroDivisionError", "division by zero", "Python's numbers raise; NumPy's give inf or nan."),
    (r"positional argument", "other arguments", "It is called with those of the stub."),
    (r"NameError", "an unknown name", "Everything that is used has to be defined or imported."),
    (
        r"(ModuleNotFound|Import)Error",
        "an import that fails",
        "NumPy is all that is needed.",
    ),
    (
        r"'list' object has no attribute|can't multiply sequence|'list' and|list indices",
        "a list for an array",
        "Lists do not calculate: np.array makes an array of one.",
    ),
    (r"math domain error", "root of a negative number", "Look at the sign under the root."),
)
