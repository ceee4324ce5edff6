"""What a wrong answer and a right one differ by: measured, and named, in every exercise."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError
from cvnotes.learn.checker.diagnosis import Found, Tried
from cvnotes.learn.checker.equality import Same, close, tolerance, up_to_scale
from cvnotes.learn.checker.exercise import Case, Exercise

Pair = tuple[Array, Array]
Change = Callable[..., Any]


def difference(exercise: Exercise, tried: Sequence[Tried], failing: Sequence[Case]) -> Found | None:
    """Say by what the answers differ from right ones, in the same way in all failing cases.

    Parameters
    ----------
    exercise : Exercise
        What was asked.
    tried : sequence of (Case, Outcome)
        All cases, with what came of them.
    failing : sequence of Case
        Those on which the answer is wrong, of which the first is shown to the student.

    Returns
    -------
    Found or None
        A name and a sentence; nothing if there is nothing simple to say.
    """
    wrong = {id(case) for case in failing}
    pairs, bound = [], 0.0
    for case, outcome in tried:
        if outcome.value is None or outcome.value.shape != case.right.shape:
            return None
        if id(case) in wrong:
            pairs.append((outcome.value, case.right))
            bound = max(bound, tolerance(outcome.dtype))
    if not pairs or exercise.answer == "value":  # which would give the number away
        return None
    if len(tried) > 1 and (found := _same_for_all(tried, exercise.same)):
        return found
    if all(np.isin(case.right, (0, 1)).all() and case.right.ndim for case, _ in tried):
        return _truths(pairs)
    # What a few of several cases have in common may be chance, where it is a single number.
    lonely = all(right.size == 1 for _, right in pairs) and len(pairs) == 1
    tellers = _TELLERS if all(_both_finite(*pair) for pair in pairs) else (_not_finite,)
    # Pictures of several sizes have no entries and columns in common.
    tellers += (_some,) * (len({case.right.shape[-1:] for case, _ in tried}) == 1)
    try:
        found_ = (tell(pairs, exercise.same, bound) for tell in tellers)
        found = next((one for one in found_ if one), None)
    except (np.linalg.LinAlgError, CvnotesError):
        return None
    return None if lonely and found and found.name not in _CERTAIN_ALONE else found


def _both_finite(answer: Array, right: Array) -> bool:
    return bool(np.array_equal(np.isfinite(answer), np.isfinite(right)))


def _same_for_all(tried: Sequence[Tried], same: Same) -> Found | None:
    """Tell whether one answer was given to all cases, which have different right ones."""
    values = [outcome.value for _, outcome in tried if outcome.value is not None]
    rights = [case.right for case, _ in tried]
    if len({v.shape for v in values}) != 1 or not np.isfinite(values[0]).all():
        return None
    if not all(np.allclose(v, values[0], rtol=1e-9, atol=1e-12) for v in values[1:]):
        return None
    if all(r.shape == rights[0].shape and same(r, rights[0], 1e-6) for r in rights[1:]):
        return None
    if all(r.ndim and np.isin(r, (0, 1)).all() for r in rights):
        return None  # "always True" says more
    return Found(
        "one answer for all",
        "You give the same answer to every input: it does not depend on the arguments.",
    )


def _truths(pairs: Sequence[Pair]) -> Found | None:
    """Tell how yes and no are wrong."""
    answers = np.concatenate([answer.ravel() for answer, _ in pairs])
    rights = np.concatenate([right.ravel() for _, right in pairs])
    if not np.isin(answers, (0, 1)).all():
        return None
    if (answers == 1 - rights).all():
        return Found("the other way round", "You say True where it is False, and False for True.")
    if answers.all():
        return Found("always True", "You say True always.")
    if not answers.any():
        return Found("always False", "You say False always.")
    if (answers >= rights).all():
        return Found("True too often", f"Where it is True you say so, but {_where(pairs)} is not.")
    if (answers <= rights).all():
        return Found(
            "False too often", f"Where it is False you say so, but {_where(pairs)} is not."
        )
    return None


def _where(pairs: Sequence[Pair]) -> str:
    answer, right = min(pairs, key=lambda pair: pair[0].size)
    return f"[{int(np.flatnonzero(answer.ravel() != right.ravel())[0])}], counted from 0,"


def _flipped(axis: int) -> Change:
    return lambda a: np.flip(a, axis)


def _moved_on(axis: int, step: int) -> Change:
    return lambda a: np.roll(a, step, axis)


def _all(pairs: Sequence[Pair], same: Same, bound: float, change: Change) -> bool:
    """Tell whether the answers become right ones by one change."""
    return all(same(change(answer), right, bound) for answer, right in pairs)


def _sign(pairs: Sequence[Pair], same: Same, bound: float) -> Found | None:
    if _all(pairs, same, bound, np.negative):
        return Found("sign", "Your answer is right but for its sign: it is the right one times −1.")
    if all(np.size(r) > 1 for _, r in pairs) and _all(
        [(np.abs(a), np.abs(r)) for a, r in pairs], same, bound, np.array
    ):
        return Found(
            "signs of some numbers",
            f"The sizes are right, signs are wrong{_entries(pairs, same)}.",
        )
    return None


def _order(pairs: Sequence[Pair], same: Same, bound: float) -> Found | None:
    dimensions = {answer.ndim for answer, _ in pairs}
    if dimensions == {2} and all(a.shape[0] == a.shape[1] for a, _ in pairs):
        if _all(pairs, same, bound, np.transpose):
            return Found("transposed", "Your answer is the transpose of the right one.")
        if all(np.linalg.matrix_rank(a) == len(a) for a, _ in pairs):
            if _all(pairs, same, bound, np.linalg.inv):
                return Found("the inverse", "Your answer is the inverse of the right one.")
            if _all(pairs, same, bound, lambda a: np.linalg.inv(a).T):
                return Found(
                    "the inverse transposed",
                    "Your answer is the inverse transpose of the right one.",
                )
    for axis, what in ((-1, "columns" if dimensions != {1} else "entries"), (0, "rows")):
        if dimensions != {0} and _all(pairs, same, bound, _flipped(axis)):
            return Found(
                f"{what} in the opposite order",
                f"The {what} are the right ones, in the opposite order.",
            )
        for step in (1, -1):
            if dimensions != {0} and _all(pairs, same, bound, _moved_on(axis, step)):
                return Found(
                    f"{what} moved on",
                    f"The {what} are the right ones, moved on by one place.",
                )
    if dimensions != {0} and _all(pairs, same, bound, _refilled):
        return Found(
            "reshaped for transposed",
            "The numbers are right and in the wrong places: reshape fills row by row, it does "
            "not transpose. Take .T.",
        )
    if dimensions == {2} and _all(
        [(_sorted_rows(a), _sorted_rows(r)) for a, r in pairs], same, bound, np.array
    ):
        return Found("rows in another order", "The rows are the right ones, in another order.")
    sorts = [(np.sort(a, None), np.sort(r, None)) for a, r in pairs if a.size > 1]
    if len(sorts) == len(pairs) and _all(sorts, same, bound, np.array):
        return Found("another order", "The numbers are the right ones, in another order.")
    return None


def _refilled(a: Array) -> Array:
    """Undo a reshape that stands where a transposition should."""
    return a.ravel().reshape(a.shape[::-1]).T if a.ndim == 2 else a


def _sorted_rows(x: Array) -> Array:
    return np.asarray(x[np.lexsort(np.round(x, 6).T)])


def _factor(pairs: Sequence[Pair], same: Same, _: float) -> Found | None:
    if same is up_to_scale:
        return None
    factors = [_common_factor(answer, right) for answer, right in pairs]
    if any(f is None or f == 0 for f in factors) or _few_counts(pairs):
        return None
    f = float(factors[0])  # type: ignore[arg-type]
    several = len(factors) > 1
    if several and np.allclose(np.array(factors, dtype=float), f, rtol=1e-5):
        name = _said(f).partition(": ")[2] or "a factor"
        return Found(name, f"Your answer is the right one times {_said(f)}, in every case.")
    if all(np.size(right) > 1 for _, right in pairs):
        return Found(
            "up to a factor", f"Your answer is right up to a factor, which is {_said(f)} here."
        )
    return None


def _common_factor(answer: Array, right: Array) -> float | None:
    """Give the one factor between two arrays; None if there is none."""
    a, r = answer[np.isfinite(right)], right[np.isfinite(right)]
    if a.size == 0 or not np.abs(r).max() > 0:
        return None
    f = float(np.vdot(a, r) / np.vdot(r, r))
    return f if np.allclose(a, f * r, rtol=0, atol=1e-6 * np.abs(a).max()) else None


def _few_counts(pairs: Sequence[Pair]) -> bool:
    """Tell whether these are one or two counts, which may differ by 1, or by half, by chance."""
    return len(pairs) < 3 and all(r.ndim == 0 and r == np.round(r) for _, r in pairs)


_NAMED = {
    np.pi: "π", 2 * np.pi: "2π", np.sqrt(2): "√2", 1 / np.sqrt(2): "1/√2",
    180 / np.pi: "180/π: degrees for radians", np.pi / 180: "π/180: radians for degrees",
}  # fmt: skip


def _said(f: float) -> str:
    for value, name in _NAMED.items():
        if np.isclose(abs(f), value, rtol=1e-6):
            return f"−{name}" if f < 0 else name
    return f"{f:.6g}".replace("-", "−")


def _constant(pairs: Sequence[Pair], same: Same, _: float) -> Found | None:
    if same is up_to_scale:
        return None
    steps = [(a - r)[np.isfinite(r)] for a, r in pairs]
    first = float(steps[0].flat[0]) if steps[0].size else 0.0
    size = max(float(np.abs(r[np.isfinite(r)]).max(initial=0)) for _, r in pairs)
    if not abs(first) > 1e-6 * size:
        return None
    if all(np.allclose(d, first, rtol=0, atol=1e-6 * size) for d in steps):
        if sum(d.size for d in steps) == 1 or _few_counts(pairs):
            return None
        name = "half a pixel" if np.isclose(abs(first), 0.5) and size > 5 else "a constant added"
        return Found(name, f"Your answer is the right one plus {_said(first)} everywhere.")
    rows = [a - r for a, r in pairs if a.ndim == 2]
    if len(rows) == len(pairs) and max(map(len, rows)) > 1:
        by = rows[0][0]
        if all(np.allclose(d, by, rtol=0, atol=1e-6 * size) for d in rows):
            moved = ", ".join(_said(float(x)) for x in by)
            return Found("every row moved", f"Every row is the right one plus ({moved}).")
    return None


def _each_number(pairs: Sequence[Pair], same: Same, bound: float) -> Found | None:
    """Say what was done to every number of a right answer."""
    if same is up_to_scale:
        return None
    for name, sentence, done in _DONE:
        made = [(a, done(r)) for a, r in pairs]
        if all(
            np.isfinite(m).all() and not close(m, r, bound) and close(a, m, bound)
            for (a, m), (_, r) in zip(made, pairs, strict=True)
        ):
            return Found(name, sentence)
    return None


_DONE: tuple[tuple[str, str, Change], ...] = (
    ("squared", "These are the squares of the right numbers: take the roots.", np.square),
    ("roots", "These are the roots of the right numbers: leave the root out.", np.sqrt),
    ("upside down", "You have 1 divided by the right numbers: turn the fraction around.",
     lambda r: 1 / r),
    ("rounded", "These are the right numbers, rounded: leave them as they are.", np.rint),
    ("decimals cut off", "These are the right numbers without their decimals, as int() or an "
     "integer array cuts them off: leave them as they are.", np.trunc),
    ("decimals cut off", "These are the right numbers, rounded down: leave them as they are.",
     np.floor),
    ("rounded up", "These are the right numbers, rounded up: leave them as they are.", np.ceil),
    ("few decimals", "These are the right numbers, rounded to one decimal: leave them as they "
     "are.", lambda r: np.round(r, 1)),
    ("few decimals", "These are the right numbers, rounded to two decimals: leave them as they "
     "are.", lambda r: np.round(r, 2)),
    ("few decimals", "These are the right numbers, rounded to three decimals: leave them as "
     "they are.", lambda r: np.round(r, 3)),
    ("absolute values", "These are absolute values: the signs belong to the answer.", np.abs),
    ("scaled to length 1", "You scaled the right answer to length 1.",
     lambda r: r / np.linalg.norm(r) if r.ndim else r),
    ("rows scaled to length 1", "You scaled each row of the right answer to length 1.",
     lambda r: r / np.linalg.norm(r, axis=-1, keepdims=True) if r.ndim > 1 else r),
    ("divided by the last number", "You divided the right answer by its last number.",
     lambda r: r / r.flat[-1]),
    ("summed up", "You added the right numbers up, one after the other: leave out the cumsum, "
     "or set the sum to 0 in each round.", lambda r: np.cumsum(r, 0) if r.ndim else r),
    ("complement", "These are 1 minus the right numbers.", lambda r: 1 - r),
)  # fmt: skip


NOT_A_NUMBER = Found("NaN", "Your answer is NaN: 0/0, or the root of a negative number?")


def _not_finite(pairs: Sequence[Pair], _: Same, bound: float) -> Found | None:
    """Say where NaN and infinity are mistaken, if all that both have as numbers is right."""
    places = [(a, r, np.isfinite(a) & np.isfinite(r)) for a, r in pairs]
    if not all(close(a[both], r[both], bound) for a, r, both in places if both.any()):
        return None
    a = np.concatenate([a[~both] for a, _, both in places])
    r = np.concatenate([r[~both] for _, r, both in places])
    a, r = (x[~((a == r) | (np.isnan(a) & np.isnan(r)))] for x in (a, r))
    if not any(both.any() for *_, both in places) and np.isfinite(r).all():
        if np.isnan(a).all():
            return NOT_A_NUMBER
        return None
    for name, sentence, mine, wanted in _NO_NUMBERS:
        if mine(a).all() and wanted(r).all():
            return Found(name, sentence)
    return None


_NO_NUMBERS: tuple[tuple[str, str, Change, Change], ...] = (
    ("infinity for NaN", "Right but where there is no answer: you have infinity there, from a "
     "division by 0. NaN is asked.", np.isinf, np.isnan),
    ("NaN for infinity", "Right but where the answer is infinite: you have NaN there.",
     np.isnan, np.isinf),
    ("sign of infinity", "Right but for the sign of what is infinite.", np.isinf, np.isinf),
    ("a number for NaN", "Right but where there is no answer: you have a number there. NaN is "
     "asked.", np.isfinite, np.isnan),
    ("a number for infinity", "Right but where the answer is infinite: you have a number there.",
     np.isfinite, np.isinf),
    ("NaN too often", "What is a number is right, but you have NaN where there is an answer.",
     np.isnan, np.isfinite),
    ("infinity too often", "What is a number is right, but you have infinity where there is an "
     "answer: was something divided by 0?", np.isinf, np.isfinite),
)  # fmt: skip


def _entries(pairs: Sequence[Pair], same: Same) -> str:
    """Name the entries that are wrong in every case, if it is a few."""
    places = [_wrong_entries(a, r) for a, r in pairs]
    shapes = {r.shape for _, r in pairs}
    if same is up_to_scale or len(shapes) != 1 or shapes == {()}:
        return ""
    wrong = np.any(places, axis=0)
    if wrong.ndim > 2 or not 0 < wrong.sum() <= max(1, wrong.size // 3):
        return ""
    named = [_index(i) for i in np.argwhere(wrong)]
    return f" in {', '.join(named)}"


def _wrong_entries(answer: Array, right: Array) -> Array:
    scale = 1e-6 * float(np.abs(right[np.isfinite(right)]).max(initial=0)) or 1e-9
    return ~np.asarray(
        (np.abs(answer - right) <= scale) | (np.isnan(answer) & np.isnan(right)) | (answer == right)
    )


def _index(i: npt.NDArray[np.intp]) -> str:
    return f"[{', '.join(map(str, i.tolist()))}]"


def _some(pairs: Sequence[Pair], same: Same, _: float) -> Found | None:
    """Say which entries, columns or rows are wrong, if the others are right."""
    if same is up_to_scale or any(a.ndim == 0 for a, _ in pairs):
        return None
    places = [_wrong_entries(a, r) for a, r in pairs]
    if few := _entries(pairs, same):
        return Found("a few numbers", f"All is right but what stands{few}.")
    if any(p.ndim != 2 for p in places):
        return None
    several = max(len(p) for p in places) > 1
    if len({p.shape[1] for p in places}) == 1:
        columns = np.any([p.any(0) for p in places], axis=0)
        if 0 < columns.sum() <= len(columns) / 2 and several:
            wrong = ", ".join(map(str, np.flatnonzero(columns)))
            return Found("one column", f"Only column {wrong} of your answer is wrong.")
    rows = [np.flatnonzero(p.any(1)) for p in places]
    for name, i in (("the first row", 0), ("the last row", -1)):
        if all(
            len(p) > 2 and len(wrong) == 1 and wrong[0] == range(len(p))[i]
            for p, wrong in zip(places, rows, strict=True)
        ):
            return Found(name, f"Only {name} of your answer is wrong.")
    first = pairs[0][0]
    if all(len(a) > 1 and np.allclose(a, a[:1]) for a, _ in pairs) and np.isfinite(first).all():
        return Found("one row for all", "You give the same row for all points.")
    return None


_TELLERS: tuple[Callable[..., Found | None], ...] = (
    _sign,
    _order,
    _each_number,
    _factor,
    _constant,
)
# These say something even if it is a single number of a single case.
_CERTAIN_ALONE = {name for name, *_ in _NO_NUMBERS} | {"NaN"}
