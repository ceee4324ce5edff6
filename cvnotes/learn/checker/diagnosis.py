"""Recognising a mistake by what it gives; the mistakes that reading a pixel off invites."""

import warnings
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.learn.checker.equality import TOLERANCE, Same, close, tolerance, up_to_scale
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception
from cvnotes.learn.checker.outcome import Outcome

# A slip repeats a mistake to the last digits; what merely comes near is another one.
_AS_NEAR = 0.01

Tried = tuple[Case, Outcome]


class Found(NamedTuple):
    """A mistake that was recognised: its name, and a sentence that helps."""

    name: str
    sentence: str


def mistake_behind(
    exercise: Exercise, tried: Sequence[Tried], failing: Sequence[Case]
) -> Misconception | None:
    """Find the mistake that gives what the student's function gave.

    Parameters
    ----------
    exercise : Exercise
        What was asked.
    tried : sequence of (Case, Outcome)
        All cases, with what came of them.
    failing : sequence of Case
        Those on which the answer is wrong.

    Returns
    -------
    Misconception or None
        The first that agrees with every outcome, and is wrong where the student is. Without one,
        the first that agrees with all usual inputs, two of them at least: whoever made another
        slip with what is special, a point at infinity or the last row, has made this one too.
    """
    usual = [one for one in tried if not one[0].about and one[1].value is not None]
    some = {id(case) for case, _ in usual} & {id(case) for case in failing}
    found = _first_behind(exercise, tried, {id(case) for case in failing})
    if found is None and len(some) > 1 and len(usual) < len(tried):
        found = _first_behind(exercise, usual, some)
    return found


def _first_behind(
    exercise: Exercise, tried: Sequence[Tried], wrong: set[int]
) -> Misconception | None:
    for mistake in exercise.misconceptions:
        same = mistake.same or exercise.same
        for gives in (mistake.gives, *mistake.variants):
            if explains(exercise, gives, same, tried, wrong):
                return mistake
        if mistake.seen is not None and _is_seen(mistake.seen, tried, wrong):
            return mistake
    return None


def _is_seen(seen: Callable[[Array, Case], bool], tried: Sequence[Tried], wrong: set[int]) -> bool:
    """Tell whether all wrong answers look like a mistake that has many results."""
    try:
        return all(
            outcome.value is not None
            and outcome.value.shape == case.right.shape
            and bool(np.isfinite(outcome.value).all())
            and seen(outcome.value, case)
            for case, outcome in tried
            if id(case) in wrong
        )
    except (np.linalg.LinAlgError, CvnotesError):
        return False


def explains(
    exercise: Exercise,
    gives: Callable[..., Any],
    same: Same,
    tried: Sequence[Tried],
    wrong: set[int],
) -> bool:
    """Tell whether a mistake gives the same as the student's function, and is wrong where it is.

    Where the mistake gives no numbers, neither must the function: what it gave instead, an
    exception, NaN or infinity, depends on how it was written.
    """
    compared = 0
    for case, outcome in tried:
        given = what_it_gives(gives, case.args)
        # Of a single number nothing is left without its scale.
        equal = close if given is not None and given.size == 1 and same is up_to_scale else same
        if given is None:
            if outcome.value is not None and np.isfinite(outcome.value).all():
                return False
            continue
        if outcome.value is None or not equal(
            outcome.value, given, _AS_NEAR * tolerance(outcome.dtype)
        ):
            return False
        if id(case) in wrong and exercise.same(given, case.right, TOLERANCE):
            return False
        compared += 1
    return compared > 0


def what_it_gives(function: Callable[..., Any], args: tuple[Any, ...]) -> Array | None:
    """Give the result of a mistake as numbers; None where it has none.

    Examples
    --------
    >>> what_it_gives(np.linalg.inv, (np.zeros((2, 2)),)) is None
    True
    """
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            given = function(*(np.array(x) if isinstance(x, np.ndarray) else x for x in args))
        except (np.linalg.LinAlgError, CvnotesError):
            return None
    return None if given is None else np.asarray(given, dtype=np.float64)


def misreadings(
    pixel: Callable[[], Array], size: tuple[int, int], near: float
) -> tuple[Misconception, ...]:
    """Give what comes out if a pixel (2,) of a picture of size (width, height) is misread.

    What is nearer than `near` to the pixel is right. The last ones are general: they go behind the
    exercise's own.

    Examples
    --------
    >>> slips = misreadings(lambda: np.array([600.0, 20.0]), (640, 480), 5.0)
    >>> {slip.name: slip.gives().tolist() for slip in slips}["v counted from below"]
    [600.0, 459.0]
    """
    last = np.array(size) - 1.0
    return (
        Misconception(
            "v before u",
            "You gave row before column: pixels are (u, v).",
            lambda: pixel()[::-1],
        ),
        Misconception(
            "v counted from below",
            "v counts from the top of the picture downwards.",
            lambda: np.array([pixel()[0], last[1] - pixel()[1]]),
        ),
        Misconception(
            "u counted from the right",
            "u counts from the left.",
            lambda: np.array([last[0] - pixel()[0], pixel()[1]]),
        ),
        Misconception(
            "measured from the middle",
            "You measured from the middle of the picture; pixel (0, 0) is at its top left.",
            lambda: pixel() - last / 2,
        ),
        Misconception(
            "read on another scale",
            "Both numbers are too large, or too small, by one factor: you measured in the pixels "
            "of your screen. Count in those of the picture, as the axes of imshow do.",
            lambda: 1.5 * pixel(),
            variants=(lambda: 2 * pixel(), lambda: pixel() / 2),
            seen=lambda answer, _: _on_another_scale(answer, pixel(), near),
        ),
        Misconception(
            "the column alone",
            "The column u is right; look at the row v again.",
            lambda: pixel() - [0.0, 7 * near],
            seen=lambda answer, _: bool(abs(answer[0] - pixel()[0]) < near),
        ),
        Misconception(
            "the row alone",
            "The row v is right; look at the column u again.",
            lambda: pixel() - [7 * near, 0.0],
            seen=lambda answer, _: bool(abs(answer[1] - pixel()[1]) < near),
        ),
        Misconception(
            "near, not near enough",
            "That is near, and not yet near enough: enlarge the picture.",
            lambda: pixel() + 1.5 * near,
            seen=lambda answer, _: bool(np.linalg.norm(answer - pixel()) < 4 * near),
        ),
    )


def _on_another_scale(answer: Array, pixel: Array, near: float) -> bool:
    """Tell whether a pixel was read in a picture that was shown larger or smaller."""
    scale = float(answer @ pixel / (pixel @ pixel))
    return 0.2 < scale < 6 and bool(np.linalg.norm(answer / scale - pixel) < near / 2)
