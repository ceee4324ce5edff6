"""What a wrong answer and a right one differ by: measured, where no mistake has a name."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError
from cvnotes.learn.checker.diagnosis import Tried
from cvnotes.learn.checker.equality import Same, tolerance, up_to_scale
from cvnotes.learn.checker.exercise import Case, Exercise

Pair = tuple[Array, Array]
Change = Callable[..., Any]


def difference(exercise: Exercise, tried: Sequence[Tried], failing: Sequence[Case]) -> str:
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
    str
        A sentence, or nothing if there is nothing simple to say.
    """
    wrong = {id(case) for case in failing}
    pairs, bound = [], 0.0
    for case, outcome in tried:
        if id(case) not in wrong:
            continue
        if outcome.value is None or not _comparable(outcome.value, case.right):
            return ""
        pairs.append((outcome.value, case.right))
        bound = max(bound, tolerance(outcome.dtype))
    if not pairs or exercise.answer == "value":  # which would give the number away
        return ""
    truths = all(np.isin(right, (0, 1)).all() for _, right in pairs)
    try:
        found = (
            tell(pairs, exercise.same, bound) for tell in (_TELLERS[-1:] if truths else _TELLERS)
        )
        return next((sentence for sentence in found if sentence), "")
    except (np.linalg.LinAlgError, CvnotesError):
        return ""


def _comparable(answer: Array, right: Array) -> bool:
    return answer.shape == right.shape and bool(np.array_equal(_finite(answer), _finite(right)))


def _finite(x: Array) -> Array:
    return np.isfinite(x)


def _flipped(axis: int) -> Change:
    return lambda a: np.flip(a, axis)


def _moved_on(axis: int, step: int) -> Change:
    return lambda a: np.roll(a, step, axis)


def _all(pairs: Sequence[Pair], same: Same, bound: float, change: Change) -> bool:
    """Tell whether the answers become right ones by one change."""
    return all(same(change(answer), right, bound) for answer, right in pairs)


def _sign(pairs: Sequence[Pair], same: Same, bound: float) -> str:
    if _all(pairs, same, bound, np.negative):
        return "Your answer is right but for its sign: it is the right one times −1."
    if _all([(np.abs(a), np.abs(r)) for a, r in pairs], same, bound, np.array):
        return f"The sizes are right, signs are wrong{_entries(pairs, same)}."
    return ""


def _order(pairs: Sequence[Pair], same: Same, bound: float) -> str:
    dimensions = {answer.ndim for answer, _ in pairs}
    if dimensions == {2} and all(a.shape[0] == a.shape[1] for a, _ in pairs):
        if _all(pairs, same, bound, np.transpose):
            return "Your answer is the transpose of the right one."
        if all(np.linalg.matrix_rank(a) == len(a) for a, _ in pairs):
            if _all(pairs, same, bound, np.linalg.inv):
                return "Your answer is the inverse of the right one."
            if _all(pairs, same, bound, lambda a: np.linalg.inv(a).T):
                return "Your answer is the inverse transpose of the right one."
    for axis, what in ((-1, "columns" if dimensions != {1} else "entries"), (0, "rows")):
        if dimensions != {0} and _all(pairs, same, bound, _flipped(axis)):
            return f"The {what} are the right ones, in the opposite order."
        for step in (1, -1):
            if dimensions != {0} and _all(pairs, same, bound, _moved_on(axis, step)):
                return f"The {what} are the right ones, moved on by one place."
    if dimensions == {2} and _all(
        [(_sorted_rows(a), _sorted_rows(r)) for a, r in pairs], same, bound, np.array
    ):
        return "The rows are the right ones, in another order."
    sorts = [(np.sort(a, None), np.sort(r, None)) for a, r in pairs if a.size > 1]
    if len(sorts) == len(pairs) and _all(sorts, same, bound, np.array):
        return "The numbers are the right ones, in another order."
    return ""


def _sorted_rows(x: Array) -> Array:
    return np.asarray(x[np.lexsort(np.round(x, 6).T)])


def _factor(pairs: Sequence[Pair], same: Same, _: float) -> str:
    if same is up_to_scale:
        return ""
    factors = [_common_factor(answer, right) for answer, right in pairs]
    if any(f is None or f == 0 for f in factors):
        return ""
    f = float(factors[0])  # type: ignore[arg-type]
    several = len(factors) > 1
    if several and np.allclose(np.array(factors, dtype=float), f, rtol=1e-5):
        return f"Your answer is the right one times {_said(f)}, in every case."
    if all(np.size(right) > 1 for _, right in pairs):
        return f"Your answer is right up to a factor, which is {_said(f)} here."
    return f"Your answer is the right one times {_said(f)} here." if _plain(f) else ""


def _common_factor(answer: Array, right: Array) -> float | None:
    """Give the one factor between two arrays; None if there is none."""
    a, r = answer[np.isfinite(right)], right[np.isfinite(right)]
    if a.size == 0 or not np.abs(r).max() > 0:
        return None
    f = float(np.vdot(a, r) / np.vdot(r, r))
    return f if np.allclose(a, f * r, rtol=0, atol=1e-6 * np.abs(a).max()) else None


_NAMED = {
    np.pi: "π", 2 * np.pi: "2π", np.sqrt(2): "√2", 1 / np.sqrt(2): "1/√2",
    180 / np.pi: "180/π: degrees for radians", np.pi / 180: "π/180: radians for degrees",
}  # fmt: skip


def _said(f: float) -> str:
    for value, name in _NAMED.items():
        if np.isclose(abs(f), value, rtol=1e-6):
            return f"−{name}" if f < 0 else name
    return f"{f:.6g}".replace("-", "−")


def _plain(f: float) -> bool:
    """Tell whether a factor is one that a slip gives, as 2, 1/3, 1000 or π."""
    named = any(np.isclose(abs(f), value, rtol=1e-6) for value in _NAMED)
    whole = any(
        np.isclose(x, round(x), rtol=1e-6) and round(x) <= 1000 for x in (abs(f), 1 / abs(f))
    )
    return named or whole


def _constant(pairs: Sequence[Pair], same: Same, _: float) -> str:
    if same is up_to_scale:
        return ""
    steps = [(a - r)[np.isfinite(r)] for a, r in pairs]
    first = float(steps[0].flat[0]) if steps[0].size else 0.0
    size = max(float(np.abs(r[np.isfinite(r)]).max(initial=0)) for _, r in pairs)
    if not abs(first) > 1e-6 * size:
        return ""
    if all(np.allclose(d, first, rtol=0, atol=1e-6 * size) for d in steps):
        enough = sum(d.size for d in steps) > 1
        return f"Your answer is the right one plus {_said(first)} everywhere." if enough else ""
    rows = [a - r for a, r in pairs if a.ndim == 2]
    if len(rows) == len(pairs) and max(map(len, rows)) > 1:
        by = rows[0][0]
        if all(np.allclose(d, by, rtol=0, atol=1e-6 * size) for d in rows):
            return f"Every row is the right one plus ({', '.join(_said(float(x)) for x in by)})."
    return ""


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


def _some(pairs: Sequence[Pair], same: Same, _: float) -> str:
    """Say which entries, columns or rows are wrong, if the others are right."""
    if same is up_to_scale or any(a.ndim == 0 for a, _ in pairs):
        return ""
    if few := _entries(pairs, same):
        return f"All is right but what stands{few}."
    places = [_wrong_entries(a, r) for a, r in pairs]
    if any(p.ndim != 2 for p in places) or len({p.shape[1] for p in places}) != 1:
        return ""
    columns = np.any([p.any(0) for p in places], axis=0)
    if 0 < columns.sum() <= len(columns) / 2:
        return (
            f"Only column {', '.join(map(str, np.flatnonzero(columns)))} of your answer is wrong."
        )
    return ""


_TELLERS = (_sign, _order, _factor, _constant, _some)
