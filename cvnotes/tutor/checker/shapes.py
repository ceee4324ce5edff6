"""Answers of another shape than asked: how the numbers were laid out, measured where it can be."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.equality import Same, tolerance
from cvnotes.tutor.checker.exercise import Case, Exercise
from cvnotes.tutor.checker.remarks import other_shape
from cvnotes.tutor.checker.wrong_answer import Found, WrongAnswer

# What is compared: two arrays of one shape, equal or not.
Equal = Callable[[Array, Array], bool]
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


def _fits(
    fits: Callable[[Array, Array, Equal], bool],
    answer: Array,
    right: Array,
    same: Same,
    bound: float,
) -> bool:
    def equal(a: Array, b: Array) -> bool:
        if a.shape == right.shape:
            return same(a, b, bound)
        if a.shape != b.shape or not np.array_equal(np.isnan(a), np.isnan(b)):
            return False
        size = float(np.abs(right[np.isfinite(right)]).max(initial=0.0)) or 1e-3
        return np.allclose(a, b, rtol=0, atol=bound * size, equal_nan=True)

    with np.errstate(all="ignore"):
        return bool(answer.size and fits(answer, right, equal))


def _turned(a: Array, right: Array, equal: Equal) -> bool:
    """Return whether the axes are in another order."""
    if a.ndim != right.ndim or a.ndim < 2:
        return False
    orders = [(1, 0)] if a.ndim == 2 else [(1, 0, 2), (2, 1, 0), (2, 0, 1), (1, 2, 0), (0, 2, 1)]
    turned = (np.transpose(a, order) for order in orders if len(order) == a.ndim)
    return any(x.shape == right.shape and equal(x, right) for x in turned)


def _column(a: Array, right: Array, equal: Equal) -> bool:
    return a.shape == (*right.shape, 1) and right.ndim > 0 and equal(a[..., 0], right)


def _in_brackets(a: Array, right: Array, equal: Equal) -> bool:
    return a.size == right.size and a.ndim > right.ndim and equal(a.reshape(right.shape), right)


def _flat(a: Array, right: Array, equal: Equal) -> bool:
    if a.ndim != 1 or a.size != right.size or right.ndim < 2:
        return False
    return any(equal(a.reshape(right.shape, order=order), right) for order in ("C", "F"))


def _rearranged(a: Array, right: Array, equal: Equal) -> bool:
    return a.size == right.size and any(
        equal(a.reshape(right.shape, order=order), right) for order in ("C", "F", "A")
    )


def _homogeneous(a: Array, right: Array, equal: Equal) -> bool:
    if not _wider(a, right):
        return False
    finite = np.abs(a[..., -1:]) > 1e-12 * np.abs(a).max()
    return equal(np.where(finite, a[..., :-1] / a[..., -1:], np.nan), right)


def _lifted(a: Array, right: Array, equal: Equal) -> bool:
    return _wider(a, right) and bool((a[..., -1] == 1).all()) and equal(a[..., :-1], right)


def _wider(a: Array, right: Array) -> bool:
    return a.ndim == right.ndim > 0 and a.shape == (*right.shape[:-1], right.shape[-1] + 1)


def _too_wide(a: Array, right: Array, equal: Equal) -> bool:
    if a.ndim != right.ndim or right.ndim == 0 or a.shape[:-1] != right.shape[:-1]:
        return False
    n = right.shape[-1]
    return a.shape[-1] > n and (equal(a[..., :n], right) or equal(a[..., -n:], right))


def _too_narrow(a: Array, right: Array, equal: Equal) -> bool:
    if a.ndim != right.ndim or right.ndim == 0 or a.shape[:-1] != right.shape[:-1]:
        return False
    n = a.shape[-1]
    return n < right.shape[-1] and (equal(a, right[..., :n]) or equal(a, right[..., -n:]))


def _first(a: Array, right: Array, equal: Equal) -> bool:
    return _one_of(a, right, equal, 0)


def _last(a: Array, right: Array, equal: Equal) -> bool:
    return _one_of(a, right, equal, -1)


def _one_of(a: Array, right: Array, equal: Equal, i: int) -> bool:
    if right.ndim == 0 or len(right) < 2:
        return False
    one = right[i]
    return a.shape in (one.shape, (1, *one.shape)) and equal(a.reshape(one.shape), one)


def _rows_left_out(a: Array, right: Array, equal: Equal) -> bool:
    return a.ndim == right.ndim > 0 and len(a) < len(right) and _within(a, right, equal)


def _rows_too_many(a: Array, right: Array, equal: Equal) -> bool:
    return a.ndim == right.ndim > 0 and len(a) > len(right) and _within(right, a, equal)


def _within(few: Array, many: Array, equal: Equal) -> bool:
    """Return whether the rows of one are among those of the other, in the same order."""
    if few.shape[1:] != many.shape[1:]:
        return False
    rows = iter(many)
    return all(any(equal(row, other) for other in rows) for row in few)


def _diagonal(a: Array, right: Array, equal: Equal) -> bool:
    return right.ndim == 2 and a.ndim == 1 and equal(a, np.diag(right))


def _on_diagonal(a: Array, right: Array, equal: Equal) -> bool:
    return right.ndim == 1 and a.shape == (len(right),) * 2 and equal(np.diag(a), right)


def _whole(summary: Callable[[Array], Any]) -> Callable[[Array, Array, Equal], bool]:
    def fits(a: Array, right: Array, equal: Equal) -> bool:
        if right.size < 2 or not np.isfinite(right).all():
            return False
        return any(
            np.shape(one) == a.shape and equal(a, np.asarray(one)) for one in _along(summary, right)
        )

    return fits


def _along(summary: Callable[..., Any], right: Array) -> Iterator[Any]:
    """Summarise everything, and each axis by itself."""
    yield summary(right)
    for axis in range(right.ndim):
        yield np.apply_along_axis(summary, axis, right)


_SUMMARIES: tuple[tuple[str, Callable[[Array], Any]], ...] = (
    ("mean", np.mean), ("sum", np.sum), ("length", np.linalg.norm), ("largest", np.max),
    ("smallest", np.min),
)  # fmt: skip
_LAYOUTS: tuple[tuple[str, str, Callable[[Array, Array, Equal], bool]], ...] = (
    ("transposed", "the numbers are right; an array has its rows first, so transpose it.", _turned),
    ("a column, not a row", "the numbers are right, each in a bracket of its own: .ravel() or [:, "
     "0] takes them out.", _column),
    ("brackets too many", "the numbers are right, in too many brackets: take what is inside, or "
     ".reshape.", _in_brackets),
    ("all in one row", "the numbers are right, one after the other; see np.reshape, or leave out a "
     "ravel, or give np.append and np.concatenate an axis.", _flat),
    ("arranged otherwise", "the numbers are right, the arrangement is not.", _rearranged),
    ("last coordinate kept", "the numbers are right, with a 1 too many: leave it out.", _lifted),
    ("still homogeneous", "still homogeneous? Divide by the last coordinate, then leave it out.",
     _homogeneous),
    ("columns too many", "the right numbers are among them; leave out the others.", _too_wide),
    ("the first only", "only the first came back; is the return inside of a loop?", _first),
    ("the last only", "only the last came back; does each round of a loop overwrite the one "
     "before?", _last),
    ("columns left out", "what is there is right, but numbers are missing.", _too_narrow),
    ("rows left out", "the rows are right, but some are missing: each of them is asked.",
     _rows_left_out),
    ("rows too many", "the right rows are among them, but there are more.", _rows_too_many),
    ("the diagonal only", "that is the diagonal only.", _diagonal),
    ("a matrix for its diagonal", "asked is the diagonal alone: see np.diag.", _on_diagonal),
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
