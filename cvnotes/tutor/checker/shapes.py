"""Answers of another shape than asked: how the numbers were laid out, measured where it can be."""

from collections.abc import Callable, Iterable, Iterator
from itertools import permutations
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.equality import Same, tolerance
from cvnotes.tutor.checker.exercise import Case, Exercise
from cvnotes.tutor.checker.remarks import other_shape
from cvnotes.tutor.checker.wrong_answer import Found, WrongAnswer

# What is compared: two arrays of one shape, equal or not.
Equal = Callable[[Array, Array], bool]
Fits = Callable[[Array, Array, Equal], bool]
Shape = tuple[int, ...]


def laid_out_otherwise(answer: WrongAnswer) -> Found | None:
    """Describe how right numbers were laid out, where that alone is wrong, in all cases.

    Nothing is said if an answer is missing, or if the shapes are right.
    """
    others = _of_another_shape(answer)
    # A value would be given away.
    if not others or answer.exercise.answer != "function":
        return None
    same = answer.exercise.same
    # Elsewhere a row of numbers may happen to have the shape that is asked.
    alike = [(v, c, bound) for v, c, bound in _all_answers(answer) if v.shape == c.right.shape]
    if not all(same(value, c.right, bound) for value, c, bound in alike):
        return None
    for name, sentence, fits in _LAYOUTS:
        if all(_fits(fits, value, c.right, same, bound) for value, c, bound in others):
            return _said(answer, others[0], name, sentence)
    return None


def misshapen(answer: WrongAnswer) -> Found | None:
    """Describe what the shapes of the answers tell, whatever their numbers are.

    Nothing is said if an answer is missing, or if the shapes are right.
    """
    others = _of_another_shape(answer)
    if not others:
        return None
    if all(np.ndim(value) == 0 and np.isnan(value) for value, *_ in others):
        name, sentence = _ONE_NAN
        return _said(answer, others[0], name, sentence.format(wanted=others[0][1].right.shape))
    for name, sentence, of_shape in _SHAPES:
        if all(of_shape(value.shape, c.right.shape) for value, c, _ in others):
            return _said(answer, others[0], name, sentence)
    return Found("another shape", other_shape(others[0][0], others[0][1].right))


Answer = tuple[Array, Case, float]


def _all_answers(answer: WrongAnswer) -> list[Answer]:
    """Return all answers with their cases and bounds; none if one is missing."""
    there = [(o.value, c, tolerance(o.dtype)) for c, o in answer.tried if o.value is not None]
    return there if len(there) == len(answer.tried) else []


def _of_another_shape(answer: WrongAnswer) -> list[Answer]:
    return [(v, c, bound) for v, c, bound in _all_answers(answer) if v.shape != c.right.shape]


def _said(answer: WrongAnswer, here: Answer, name: str, sentence: str) -> Found:
    """Describe what is wrong with an answer's shape, in words about points if it is some."""
    value, case, _ = here
    if _one_for_each_point(answer.exercise, case):
        name, sentence = _ABOUT_POINTS.get(name, (name, sentence))
    return Found(name, f"{other_shape(value, case.right).rstrip('.')}: {sentence}")


def _one_for_each_point(exercise: Exercise, case: Case) -> bool:
    """Return whether an answer has a row for each of n points that were given."""
    wanted = case.right.shape
    return "(n" in exercise.task and any(
        isinstance(x, np.ndarray) and x.shape[:1] == wanted[:1] != () for x in case.args
    )


def _fits(fits: Fits, answer: Array, right: Array, same: Same, bound: float) -> bool:
    def equal(a: Array, b: Array) -> bool:
        if a.shape == right.shape:
            return same(a, b, bound)
        size = float(np.abs(right[np.isfinite(right)]).max(initial=0.0)) or 1e-3
        alike = a.shape == b.shape
        return alike and np.allclose(a, b, rtol=0, atol=bound * size, equal_nan=True)

    with np.errstate(all="ignore"):
        return bool(answer.size and fits(answer, right, equal))


def _any_of(pairs: Callable[[Array, Array], Iterable[tuple[Array, Any]]]) -> Fits:
    """Return whether an answer, or a part of it, is a right one, or a part of that."""
    return lambda a, r, equal: any(equal(x, np.asarray(y)) for x, y in pairs(a, r))


def _reshaped(a: Array, r: Array, orders: str = "CF") -> Iterator[tuple[Array, Array]]:
    if a.size == r.size:
        yield from ((a.reshape(r.shape, order=order), r) for order in orders)  # type: ignore[call-overload]


def _dehomogenised(a: Array) -> Array:
    finite = np.abs(a[..., -1:]) > 1e-12 * np.abs(a).max()
    return np.where(finite, a[..., :-1] / a[..., -1:], np.nan)


def _within(few: Array, many: Array, equal: Equal) -> bool:
    """Return whether the rows of one are among those of the other, in the same order."""
    if not few.ndim == many.ndim > 0 or few.shape[1:] != many.shape[1:] or len(few) >= len(many):
        return False
    rows = iter(many)
    return all(any(equal(row, other) for other in rows) for row in few)


def _whole(summary: Callable[..., Any]) -> Fits:
    """Return whether one number, or one for each row or column, sums a right answer up."""
    return _any_of(
        lambda a, r: ((a, x) for x in (summary(r), *(np.apply_along_axis(summary, axis, r)
                                                     for axis in range(r.ndim))))
        if r.size > 1 and np.isfinite(r).all() else ()
    )  # fmt: skip


_SUMMARIES: tuple[tuple[str, Callable[[Array], Any]], ...] = (
    ("mean", np.mean), ("sum", np.sum), ("length", np.linalg.norm), ("largest", np.max),
    ("smallest", np.min),
)  # fmt: skip
# How the numbers are laid out, and what of an answer a is then equal to what of a right one, r.
_LAYOUTS: tuple[tuple[str, str, Fits], ...] = (
    ("transposed", "the numbers are right; an array has its rows first, so transpose it.",
     _any_of(lambda a, r: ((a.transpose(order), r) for order in permutations(range(r.ndim))
                           if a.ndim == r.ndim))),
    ("a column, not a row", "the numbers are right, each in a bracket of its own: .ravel() or [:, "
     "0] takes them out.",
     _any_of(lambda a, r: [(a[..., 0], r)] if r.ndim and a.shape == (*r.shape, 1) else ())),
    ("brackets too many", "the numbers are right, in too many brackets: take what is inside, or "
     ".reshape.", _any_of(lambda a, r: _reshaped(a, r, "C") if a.ndim > r.ndim else ())),
    ("all in one row", "the numbers are right, one after the other; see np.reshape, or leave out a "
     "ravel, or give np.append and np.concatenate an axis.",
     _any_of(lambda a, r: _reshaped(a, r) if a.ndim == 1 < r.ndim else ())),
    ("arranged otherwise", "the numbers are right, the arrangement is not.", _any_of(_reshaped)),
    ("last coordinate kept", "the numbers are right, with a 1 too many: leave it out.",
     _any_of(lambda a, r: [(a[..., :-1], r)] if a.ndim and (a[..., -1] == 1).all() else ())),
    ("still homogeneous", "still homogeneous? Divide by the last coordinate, then leave it out.",
     _any_of(lambda a, r: [(_dehomogenised(a), r)] if a.ndim else ())),
    ("columns too many", "the right numbers are among them; leave out the others.",
     _any_of(lambda a, r: ((x, r) for x in (a[..., : r.shape[-1]], a[..., -r.shape[-1] :]))
             if a.ndim and r.ndim else ())),
    ("the first only", "only the first came back; is the return inside of a loop?",
     _any_of(lambda a, r: ((a, x) for x in (r[0], r[:1])) if r.ndim and len(r) > 1 else ())),
    ("the last only", "only the last came back; does each round of a loop overwrite the one "
     "before?",
     _any_of(lambda a, r: ((a, x) for x in (r[-1], r[-1:])) if r.ndim and len(r) > 1 else ())),
    ("columns left out", "what is there is right, but numbers are missing.",
     _any_of(lambda a, r: ((a, x) for x in (r[..., : a.shape[-1]], r[..., -a.shape[-1] :]))
             if a.ndim and r.ndim else ())),
    ("rows left out", "the rows are right, but some are missing: each of them is asked.", _within),
    ("rows too many", "the right rows are among them, but there are more.",
     lambda a, r, equal: _within(r, a, equal)),
    ("the diagonal only", "that is the diagonal only.",
     _any_of(lambda a, r: [(a, np.diag(r))] if r.ndim == 2 else ())),
    ("a matrix for its diagonal", "asked is the diagonal alone: see np.diag.",
     _any_of(lambda a, r: [(np.diag(a), r)] if a.shape == r.shape * 2 and r.ndim == 1 else ())),
    *((f"the {what}", f"that is the {what} of the right numbers; all of them are asked.",
       _whole(summary)) for what, summary in _SUMMARIES),
)  # fmt: skip
_ONE_NAN = ("one NaN for all", "one NaN for all of it; np.full({wanted}, np.nan) has the shape.")
# What shapes alone tell, (given, wanted), whatever the numbers are.
_SHAPES: tuple[tuple[str, str, Callable[[Shape, Shape], bool]], ...] = (
    ("several numbers for one", "a single number is wanted.", lambda _, wanted: wanted == ()),
    ("rows and columns exchanged", "an array has its rows first, so transpose it.",
     lambda given, wanted: given == wanted[::-1]),
    ("one number for all", "one number alone.", lambda given, _: given == ()),
    ("one row of a matrix", "one row of it, or one number for each row; the whole matrix is "
     "wanted.", lambda given, wanted: len(wanted) == 2 and given == wanted[1:] == wanted[:1]),
    ("one of several", "only one row came back; is the return inside of a loop?",
     lambda given, wanted: given == wanted[1:]),
    ("one number for each row", "one number came back for each row; the whole row is wanted.",
     lambda given, wanted: len(wanted) > 1 and given == wanted[:1]),
    ("all in one row", "the values may be right, the arrangement is not; see np.reshape.",
     lambda given, wanted: len(given) == 1 < len(wanted) and np.prod(given) == np.prod(wanted)),
    ("all in one row", "one row alone; np.append and np.concatenate take an axis.",
     lambda given, wanted: len(given) == 1 < len(wanted)),
    ("arranged otherwise", "the values may be right, the arrangement is not; see np.reshape.",
     lambda given, wanted: bool(np.prod(given) == np.prod(wanted))),
    ("an axis too many", "an axis too many; is a sum, a norm or an all along axis=-1 missing?",
     lambda given, wanted: len(given) > len(wanted) and given[: len(wanted)] == wanted),
    ("numbers too few", "numbers are missing.",
     lambda given, wanted: len(given) == len(wanted) == 1 and given < wanted),
    ("numbers too many", "there are numbers too many.",
     lambda given, wanted: len(given) == len(wanted) == 1 and given > wanted),
    ("rows too few", "rows are missing.",
     lambda given, wanted: _alike_but(given, wanted, 0) and given[0] < wanted[0]),
    ("rows too many", "there are rows too many.",
     lambda given, wanted: _alike_but(given, wanted, 0) and given[0] > wanted[0]),
    ("columns too few", "numbers are missing in each row.",
     lambda given, wanted: _alike_but(given, wanted, -1) and given[-1] < wanted[-1]),
    ("columns too many", "there are numbers too many in each row.",
     lambda given, wanted: _alike_but(given, wanted, -1) and given[-1] > wanted[-1]),
)  # fmt: skip
# The same, where an answer has a row for each of n points.
_ABOUT_POINTS = {
    "transposed": ("points as columns", "the numbers are right; points are rows here, so transpose "
        "it."),
    "columns left out": ("columns left out",
        "what is there is right, but each row lacks a number."),
    "rows and columns exchanged": ("points as columns", "points are rows here, so transpose it."),
    "one number for all": ("one number for all",
        "one number for all of them; is an axis=1 missing?"),
    "one of several": ("one of several", "only one of several points came back; is the return "
        "inside of the loop?"),
    "an axis too many": ("an axis too many", "an axis too many; is a sum, a norm or an all along "
        "axis=1 missing?"),
}  # fmt: skip


def _alike_but(given: Shape, wanted: Shape, axis: int) -> bool:
    """Return whether two shapes differ along one axis alone, the first or the last."""
    if len(given) != len(wanted) or not wanted:
        return False
    return given[1:] == wanted[1:] if axis == 0 else given[:-1] == wanted[:-1]
