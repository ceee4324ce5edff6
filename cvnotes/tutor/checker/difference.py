"""What a wrong answer and a right one differ by: measured, and named, in every exercise."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.tutor.checker.equality import AS_NEAR, Same, close, same_motion, tolerance, up_to_scale
from cvnotes.tutor.checker.wrong_answer import Found, Tried, WrongAnswer

Pair = tuple[Array, Array]
Change = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class _Wrong:
    """What is compared: the wrong answers beside right ones, that of the case shown first.

    Attributes
    ----------
    pairs : tuple of (answer, right)
        Of the same shape, for each case on which the answer is wrong.
    same : callable
        When the exercise calls two of them equal.
    bound : float
        How far they may be apart.
    always : bool
        Whether the answer is wrong in all cases.
    """

    pairs: tuple[Pair, ...]
    same: Same
    bound: float
    always: bool

    @property
    def up_to_scale(self) -> bool:
        """Whether a factor, and so the size of a number, is free."""
        return self.same is up_to_scale

    @property
    def aligned(self) -> tuple[Pair, ...]:
        """The pairs without a factor that is free: that which most entries have in common."""
        if not self.up_to_scale:
            return self.pairs
        return tuple((answer / _usual_factor(answer, right), right) for answer, right in self.pairs)

    def right_after(self, change: Change) -> bool:
        """Return whether one change makes all answers right."""
        return all(self.same(change(a), right, self.bound) for a, right in self.pairs)

    def equal(self, change: Change) -> bool:
        """Return whether answers and right ones are equal in what a function makes of both."""
        return all(self.same(change(a), change(right), self.bound) for a, right in self.pairs)


def difference(answer: WrongAnswer) -> Found | None:
    """Describe by what the answers differ from right ones, in the same way in all failing cases.

    Nothing is said if there is nothing simple to say, or if that gave a number away.
    """
    exercise, tried = answer.exercise, answer.tried
    if exercise.answer == "value":
        return None
    pairs = []
    for case, outcome in tried:
        if outcome.value is None or outcome.value.shape != case.right.shape:
            return None
        pairs.append((outcome.value, case.right))
    bound = max(tolerance(outcome.dtype) for _, outcome in answer.failing)
    always = answer.wrong == len(tried)
    wrong = _Wrong(tuple(pairs[: answer.wrong]), exercise.same, bound, always)
    if len(tried) > 1 and (found := _same_for_all(tried, exercise.same)):
        return _each_number(wrong) or _few_decimals(wrong) or found
    if all(np.isin(right, (0, 1)).all() and right.ndim for _, right in pairs):
        return _truths(wrong.pairs)
    # What a few of several cases have in common may be chance, where it is a single number.
    lonely = answer.wrong == 1 and wrong.pairs[0][1].size == 1
    alike = all(_alike_finite(*pair) for pair in wrong.pairs)
    if alike and (off := _off(wrong)) is not None:
        found = _each_number(wrong) or _few_decimals(wrong)
        if sum(right.size for _, right in wrong.pairs) > 3:  # fewer may be rounded by the same
            found = found or _factor(wrong) or _constant(wrong)
        return found or _nearly(wrong, off)
    if all(wrong.same(answer, right, bound) for answer, right in wrong.pairs):
        return None  # after a change of sign, too
    tellers = (_not_finite, *_TELLERS) if alike else (_not_finite,)
    # Pictures of several sizes have no entries and columns in common.
    tellers += (_some,) * (len({right.shape[-1:] for _, right in pairs}) == 1)
    tellers += (_each_up_to_a_factor,) * alike
    try:
        found = next((one for tell in tellers if (one := tell(wrong))), None)
    except (np.linalg.LinAlgError, CvnotesError):
        return None
    return None if lonely and found and found.name not in _CERTAIN_ALONE else found


# Answers this near to right ones, relative to their largest numbers, differ in their digits only.
_NEARLY = 5e-3


def _off(wrong: _Wrong) -> float | None:
    """Return how far nearly right numbers are from right ones; None if they differ otherwise.

    What has a size of its own, R and T of a pose, is near by that.
    """
    off = 0.0
    for answer, right in wrong.aligned:
        for i in _parts(wrong, right):
            there = np.isfinite(right[i])
            r, apart = right[i][there], np.abs(answer - right)[i][there]
            size = float(np.abs(r).max(initial=0.0))
            if not size or not _in_digits(answer[i][there], r, apart, wrong.up_to_scale):
                return None
            off = max(off, float(apart.max()) / size)
    return off if 0 < off <= _NEARLY else None


def _parts(wrong: _Wrong, right: Array) -> Sequence[Any]:
    if wrong.same is same_motion:
        return list(_POSE.values())
    return range(len(right)) if right.ndim > 2 else [...]


def _in_digits(a: Array, r: Array, apart: Array, any_scale: bool) -> bool:
    """Return whether numbers, some of them right, may differ from right ones in their digits only.

    Noise leaves no number as it is, and rounding none but short ones. Where it does, all others
    are near by their own size, or have as few decimals.
    """
    size = np.abs(r).max()
    exact = (apart <= 1e-11 * size) & (np.abs(r) > 1e-9 * size)
    # 18.7 is a short number, whatever the arithmetic has left at its end.
    long = np.abs(r - np.round(r, 6)) > 1e-9 * size
    if any_scale:  # the factor is that of one of them, or of a few
        return bool((exact & long).sum() <= max(1, long.sum() // 2))
    if not exact.any():
        return True
    if (exact & long).any():
        return False
    near = (apart <= np.maximum(_NEARLY * np.abs(r), 1e-11 * size)).all()
    return bool(near) or any(
        (apart <= 10.0**-n).all() and (a == np.round(a, n)).all() for n in range(10)
    )


def _nearly(wrong: _Wrong, off: float) -> Found:
    """Say that only digits differ, and by how much: without a factor that is free, in numbers."""
    if not wrong.up_to_scale:
        off = max(float(np.nanmax(np.abs(a - r)[np.isfinite(r)])) for a, r in wrong.pairs)
    power = 10.0 ** np.ceil(np.log10(off))
    return Found(
        "nearly",
        f"Nearly: no number is off by more than {power:g}{' of the largest' * wrong.up_to_scale}. "
        "Rounded, cut off, in single precision, or stopped too early?",
    )


def _alike_finite(answer: Array, right: Array) -> bool:
    return bool(np.array_equal(np.isfinite(answer), np.isfinite(right)))


def _same_for_all(tried: Sequence[Tried], same: Same) -> Found | None:
    """Return whether one answer was given to all cases, which have different right ones."""
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
    """Return how yes and no are wrong."""
    answers = np.concatenate([answer.ravel() for answer, _ in pairs])
    rights = np.concatenate([right.ravel() for _, right in pairs])
    if not np.isin(answers, (0, 1)).all():
        said = "True or False is asked, or 1 and 0 for them; yours are other numbers."
        return Found("neither True nor False", said) if np.isfinite(answers).all() else None
    for name, said, is_so in (
        ("the other way round", "True where it is False, and False for True", answers != rights),
        ("always True", "True always", answers == 1),
        ("always False", "False always", answers == 0),
        ("True too often", f"True too often: {_where(pairs)} is False", answers >= rights),
        ("False too often", f"False too often: {_where(pairs)} is True", answers <= rights),
    ):
        if is_so.all():
            return Found(name, f"You say {said}.")
    return None


def _where(pairs: Sequence[Pair]) -> str:
    answer, right = pairs[0]
    return f"entry [{int(np.flatnonzero(answer.ravel() != right.ravel())[0])}], counted from 0,"


def _sign(wrong: _Wrong) -> Found | None:
    # Sizes where signs belong are right where a right answer has none.
    sizes = not wrong.always and all((answer >= 0).all() for answer, _ in wrong.pairs)
    if wrong.right_after(np.negative) and not sizes:
        return Found("sign", "Your answer is right but for its sign: it is the right one times −1.")
    if all(right.size > 1 for _, right in wrong.pairs) and wrong.equal(np.abs):
        return Found(
            "signs of some numbers", f"The sizes are right, but signs are wrong{_entries(wrong)}."
        )
    return None


def _order(wrong: _Wrong) -> Found | None:
    dimensions = {answer.ndim for answer, _ in wrong.pairs}
    for name, sentence, *changes in _other_ways_round(wrong, dimensions):
        if any(wrong.right_after(change) for change in changes):
            return Found(name, sentence)
    if dimensions == {2} and wrong.equal(lambda a: a[np.lexsort(np.round(a, 6).T)]):
        return Found("rows in another order", "The rows are the right ones, in another order.")
    if all(answer.size > 1 for answer, _ in wrong.pairs) and wrong.equal(
        lambda a: np.sort(a, None)
    ):
        return Found("another order", "The numbers are the right ones, in another order.")
    return None


def _other_ways_round(wrong: _Wrong, dimensions: set[int]) -> Iterator[tuple[Any, ...]]:
    """Yield what may have happened to an answer as a whole: name, sentence, and what undoes it."""
    answers = [answer for answer, _ in wrong.pairs]
    if dimensions == {2} and all(a.shape[0] == a.shape[1] for a in answers):
        yield "transposed", "Your answer is the transpose of the right one.", np.transpose
        if all(np.linalg.matrix_rank(a) == len(a) for a in answers):
            yield "the inverse", "Your answer is the inverse of the right one.", np.linalg.inv
            sentence = "Your answer is the inverse transpose of the right one."
            yield "the inverse transposed", sentence, lambda a: np.linalg.inv(a).T
    if dimensions == {0}:
        return
    for axis, what in ((-1, "columns" if dimensions != {1} else "entries"), (0, "rows")):
        right = f"The {what} are the right ones"
        flip, roll = partial(np.flip, axis=axis), partial(np.roll, axis=axis)
        yield f"{what} in the opposite order", f"{right}, in the opposite order.", flip
        steps = partial(roll, shift=1), partial(roll, shift=-1)
        yield f"{what} moved on", f"{right}, moved on by one place.", *steps
    sentence = (
        "The numbers are right, but in the wrong places: reshape fills row by row, it does not "
        "transpose. Take .T."
    )
    yield "reshaped for transposed", sentence, _refilled


def _refilled(a: Array) -> Array:
    """Undo a reshape that stands where a transposition should."""
    return a.ravel().reshape(a.shape[::-1]).T if a.ndim == 2 else a


def _factor(wrong: _Wrong) -> Found | None:
    if wrong.up_to_scale:
        return None
    factors = [_common_factor(answer, right) for answer, right in wrong.pairs]
    if any(f is None or f == 0 or abs(f - 1) < 1e-4 for f in factors) or _few_counts(wrong):
        return None
    f = float(factors[0])  # type: ignore[arg-type]
    several = len(factors) > 1
    if several and np.allclose(np.array(factors, dtype=float), f, rtol=1e-5, atol=0):
        name = _said(f).partition(": ")[2] or "a factor"
        where = "in every case" if wrong.always else "wherever it is wrong"
        return Found(name, f"Your answer is the right one times {_said(f)}, {where}.")
    if all(right.size > 1 for _, right in wrong.pairs):
        return Found(
            "up to a factor", f"Your answer is right up to a factor, which is {_said(f)} here."
        )
    return None


def _common_factor(answer: Array, right: Array) -> float | None:
    """Return the one factor between two arrays; None if there is none."""
    a, r = answer[np.isfinite(right)], right[np.isfinite(right)]
    if a.size == 0 or not np.abs(r).max() > 0:
        return None
    f = float(np.vdot(a, r) / np.vdot(r, r))
    return f if np.allclose(a, f * r, rtol=0, atol=1e-6 * np.abs(a).max()) else None


def _usual_factor(answer: Array, right: Array) -> float:
    """Return the factor between two arrays that more than half of their entries share, or None."""
    there = np.abs(right) > 1e-9 * np.abs(right).max(initial=0.0)
    factors = np.sort(answer[there] / right[there])
    f = float(factors[len(factors) // 2]) if factors.size else 1.0
    return f if np.isfinite(f) and f != 0 else 1.0


def _each_up_to_a_factor(wrong: _Wrong) -> Found | None:
    """Return whether each row, or each column, has a factor of its own."""
    if wrong.up_to_scale or any(a.ndim != 2 or min(a.shape) < 1 for a, _ in wrong.pairs):
        return None
    for what, turn in (("row", np.asarray), ("column", np.transpose)):
        lines = [turn(x) for pair in wrong.pairs for x in pair]
        if max(map(len, lines)) < 2 or min(x.shape[1] for x in lines) < 2:
            continue
        factors = [
            _common_factor(a, r)
            for answer, right in zip(lines[::2], lines[1::2], strict=True)
            for a, r in zip(answer, right, strict=True)
        ]
        if all(factors):  # neither none nor 0
            return Found(
                f"each {what} up to a factor",
                f"Each {what} of your answer is right up to a factor of its own.",
            )
    return None


def _few_counts(wrong: _Wrong) -> bool:
    """Return whether these are one or two counts, which may differ by 1, or by half, by chance."""
    return len(wrong.pairs) < 3 and all(r.ndim == 0 and r == np.round(r) for _, r in wrong.pairs)


_NAMED = {
    np.pi: "π", 2 * np.pi: "2π", np.sqrt(2): "√2", 1 / np.sqrt(2): "1/√2",
    180 / np.pi: "180/π: degrees for radians", np.pi / 180: "π/180: radians for degrees",
}  # fmt: skip


def _said(f: float) -> str:
    for value, name in _NAMED.items():
        if np.isclose(abs(f), value, rtol=1e-6):
            return f"−{name}" if f < 0 else name
    return f"{f:.6g}".replace("-", "−")


def _constant(wrong: _Wrong) -> Found | None:
    if wrong.up_to_scale:
        return None
    pairs = wrong.pairs
    steps = [(a - r)[np.isfinite(r)] for a, r in pairs]
    first = float(steps[0].flat[0]) if steps[0].size else 0.0
    size = max(float(np.abs(r[np.isfinite(r)]).max(initial=0)) for _, r in pairs)
    if not abs(first) > 1e-4 * size:
        return None
    if all(np.allclose(d, first, rtol=0, atol=1e-6 * size) for d in steps):
        if sum(d.size for d in steps) == 1 or _few_counts(wrong):
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


def _each_number(wrong: _Wrong) -> Found | None:
    """Describe what was done to every number of a right answer."""
    if wrong.up_to_scale:
        return None
    bound = AS_NEAR * wrong.bound
    for name, sentence, done in _DONE:
        made = [(a, r, done(r)) for a, r in wrong.pairs]
        if all(
            _alike_finite(m, r) and not close(m, r, wrong.bound) and close(a, m, bound)
            for a, r, m in made
        ):
            return Found(name, sentence)
    return None


def _few_decimals(wrong: _Wrong) -> Found | None:
    """Return whether answers of any scale were rounded, each at the scale it has."""
    if not wrong.up_to_scale:
        return None
    for n in range(6):
        for a, r in wrong.pairs:
            f = np.vdot(a, r) / np.vdot(r, r)
            near = np.abs(a - f * r).max() <= 0.6 / 10**n
            if not (near and a.any() and (a == np.round(a, n)).all()):
                break
        else:
            return Found("few decimals", f"These are the right numbers, rounded to {n or 'no'} "
                         "decimals: leave them as they are.")  # fmt: skip
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
    *(("few decimals", f"These are the right numbers, rounded to {n} decimal{'s' * (i > 1)}: leave "
       "them as they are.", lambda r, i=i: np.round(r, i))
      for i, n in enumerate(("one", "two", "three", "four"), 1)),
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


def _not_finite(wrong: _Wrong) -> Found | None:
    """Describe where NaN and infinity are mistaken, if all that both have as numbers is right."""
    places = [(a, r, np.isfinite(a) & np.isfinite(r)) for a, r in wrong.pairs]
    if not all(close(a[both], r[both], wrong.bound) for a, r, both in places if both.any()):
        return None
    a = np.concatenate([a[~both] for a, _, both in places])
    r = np.concatenate([r[~both] for _, r, both in places])
    a, r = (x[~((a == r) | (np.isnan(a) & np.isnan(r)))] for x in (a, r))
    if not any(both.any() for *_, both in places) and np.isfinite(r).all():
        if np.isnan(a).all():
            return NOT_A_NUMBER
        return None
    for name, sentence, mine, wanted in _NO_NUMBERS:
        if a.size and mine(a).all() and wanted(r).all():
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


# The blocks of a pose.
_POSE = {"R": np.s_[:3, :3], "T": np.s_[:3, 3:]}


def _entries(wrong: _Wrong) -> str:
    """Name the entries that are wrong in every case, if it is a few."""
    if block := _block(wrong):
        return f" in {block}" * (block in ("R", "T"))
    shapes = {right.shape for _, right in wrong.pairs}
    if len(shapes) != 1 or shapes == {()}:
        return ""
    places = np.any([_wrong_entries(*pair) for pair in wrong.aligned], axis=0)
    if places.ndim > 2 or not 0 < places.sum() <= max(1, places.size // 3):
        return ""
    named = (f"[{', '.join(map(str, i))}]" for i in np.argwhere(places).tolist())
    return f" in {', '.join(named)}"


def _block(wrong: _Wrong) -> str:
    """Name what is wrong of a pose: R, T or both; empty if this is no pose."""
    if wrong.same is not same_motion:
        return ""
    off = [
        name
        for name, i in _POSE.items()
        if not all(close(a[i], right[i], wrong.bound) for a, right in wrong.pairs)
    ]
    return " and ".join(off)


def _wrong_entries(answer: Array, right: Array) -> Array:
    scale = 1e-6 * float(np.abs(right[np.isfinite(right)]).max(initial=0)) or 1e-9
    return ~np.asarray(
        (np.abs(answer - right) <= scale) | (np.isnan(answer) & np.isnan(right)) | (answer == right)
    )


def _some(wrong: _Wrong) -> Found | None:
    """Describe which entries, columns or rows are wrong, if the others are right."""
    pairs = wrong.aligned
    if any(a.ndim == 0 for a, _ in pairs):
        return None
    if block := _block(wrong):
        other = {"R": "T", "T": "R"}.get(block)
        return Found("a few numbers", f"{other} is right, {block} is not.") if other else None
    places = [_wrong_entries(*pair) for pair in pairs]
    if few := _entries(wrong):
        return Found("a few numbers", f"All is right but what stands{few}.")
    if any(p.ndim != 2 for p in places):
        return None
    several = max(len(p) for p in places) > 1
    if len({p.shape[1] for p in places}) == 1:
        columns = np.any([p.any(0) for p in places], axis=0)
        if 0 < columns.sum() <= len(columns) / 2 and several:
            named = ", ".join(map(str, np.flatnonzero(columns)))
            return Found("one column", f"Only column {named} of your answer is wrong.")
    rows = [np.flatnonzero(p.any(1)) for p in places]
    for name, i in (("the first row", 0), ("the last row", -1)):
        if all(
            len(p) > 2 and len(bad) == 1 and bad[0] == range(len(p))[i]
            for p, bad in zip(places, rows, strict=True)
        ):
            return Found(name, f"Only {name} of your answer is wrong.")
    if all(_one_row(a) and not _one_row(right) for a, right in pairs):
        return Found(
            "one row for all",
            "All rows of your answer are the same row; those of the right one are not.",
        )
    return None


def _one_row(a: Array) -> bool:
    return len(a) > 1 and bool(np.isfinite(a).all() and np.allclose(a, a[:1]))


_TELLERS: tuple[Callable[..., Found | None], ...] = (
    _few_decimals,
    _sign,
    _order,
    _each_number,
    _factor,
    _constant,
)
# These say something even if it is a single number of a single case.
_CERTAIN_ALONE = {name for name, *_ in _NO_NUMBERS} | {"NaN"}
# These say where an answer is wrong, or how little: a slip of an input, if it is one, says why.
VAGUE = {
    "a few numbers", "one column", "the first row", "the last row", "another order",
    "rows in another order", "signs of some numbers", "up to a factor",
    "each row up to a factor", "each column up to a factor", "nearly",
}  # fmt: skip
