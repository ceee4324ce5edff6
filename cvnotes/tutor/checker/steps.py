"""The way to an answer in steps, and where a student's own way leaves it.

An exercise may have `steps`: a function of a few lines as a student might write it, one for each
thing to work out, with a comment that says in words what it is:

>>> import numpy as np
>>> def error_bars(J, r):
...     n, p = J.shape
...     s2 = r @ r / (n - p)  # the variance of the residuals
...     C = np.linalg.inv(J.T @ J)  # the cofactors
...     return np.sqrt(s2 * np.diag(C))

What a student's expressions give is compared with what the lines give, on inputs without round
numbers. A step is called missing only if that is proven: with the step's value in the place of one
of the student's expressions, the student's own code comes out right, on every one of the inputs.
"""

import ast
import copy
import inspect
import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import islice
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np

from cvnotes.base import Array, CvnotesError
from cvnotes.tutor.checker.equality import TOLERANCE, Same, disturbed, up_to_scale
from cvnotes.tutor.checker.exercise import Exercise, Misconception, mistakes
from cvnotes.tutor.checker.in_process import clock
from cvnotes.tutor.checker.instrumented import Instrumented, numbers_in
from cvnotes.tutor.checker.parsing import names_set, parsed
from cvnotes.tutor.checker.sandbox import run

# Two values are equal if they are nearer than that, relative to their largest entry.
_NEAR = 1e-7
_INPUTS = 3
_SEEDS = range(9001, 9007)
_SECONDS = 0.25  # what a search may take, of the processor
_TRIES = 1200
# One run that takes longer is not repeated; and what all may take where it can be ended.
_SLOW, _PATIENCE = 0.08, 1.0


class Line(NamedTuple):
    """One line of the steps: what it gives, in words and as code; and which names it reads."""

    name: str
    words: str
    code: str
    reads: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Located:
    """How far a student's way is right, and what is missing first.

    Attributes
    ----------
    agreed : tuple of (words, expression)
        The steps that the student's own expressions give.
    missing : Line or None
        The first step that, put right, makes the rest come out right; None if that is not proven.
    place : str
        The student's expression in whose place it belongs.
    first : bool
        Whether nothing is wrong before: what the expression reads is known to be right.
    """

    agreed: tuple[tuple[str, str], ...]
    missing: Line | None = None
    place: str = ""
    first: bool = True

    @property
    def sentence(self) -> str:
        """What is said at first, without the formula."""
        so_far = ", ".join(f"{words} (`{own}`)" for words, own in self.agreed)
        if self.missing is None:
            return f"Up to here it agrees: {so_far}."
        right = f"Right so far: {so_far}. " if so_far else ""
        wrong = "First wrong" if self.first else "Wrong by then"
        return f"{right}{wrong}: `{self.place}`; there belongs {self.missing.words}."


def lines_of(steps: Callable[..., Any]) -> tuple[ast.FunctionDef, list[Line]]:
    """Return the tree of a function of steps, and its lines: one for each statement."""
    source = textwrap.dedent(inspect.getsource(steps))
    function = next(n for n in ast.walk(parsed(source)) if isinstance(n, ast.FunctionDef))
    if isinstance(function.body[0], ast.Expr):  # a docstring
        del function.body[0]
    rows = source.splitlines()
    return function, [_line(statement, rows) for statement in function.body]


def _line(statement: ast.stmt, rows: Sequence[str]) -> Line:
    code = ast.unparse(statement)
    said = re.search(r"#\s*(?!noqa)(.+)$", rows[(statement.end_lineno or 1) - 1])
    if isinstance(statement, ast.Return):
        name, words = "the answer", "what is returned"
    else:
        name, words = ", ".join(names_set(statement)), ""
    names = (n for n in ast.walk(statement) if isinstance(n, ast.Name))
    reads = {n.id for n in names if not isinstance(n.ctx, ast.Store)}
    return Line(name, said[1].strip() if said else words or f"`{name}`", code, frozenset(reads))


def edited(steps: Callable[..., Any], *changes: str) -> Callable[..., Any]:
    """Return the steps with some of their code changed: a mistake, as it is written.

    Parameters
    ----------
    steps : callable
        A function of steps.
    *changes : str
        What stands there and what is to stand there instead, in turn; each wherever it occurs. If
        one is left over, the last, it is what is returned instead.

    Raises
    ------
    CvnotesError
        What is to be changed does not stand there; when the function that is given is called.

    Examples
    --------
    >>> edited(_example, "x + 1", "x - 1")(3.0)
    4.0
    >>> edited(_example, "x + 1", "x - 1", "y**2")(3.0)
    4.0
    """
    pairs, returned = changes[: len(changes) // 2 * 2], changes[len(changes) // 2 * 2 :]

    @cache
    def made() -> Callable[..., Any]:
        source = textwrap.dedent(inspect.getsource(steps))
        for old, new in zip(pairs[::2], pairs[1::2], strict=True):
            if old not in source:
                raise CvnotesError(f"{steps.__qualname__}: {old!r} does not stand in these steps")
            source = source.replace(old, new)
        for new in returned:
            source = f"{source[: source.rindex('return ')]}return {new}"
        space: dict[str, Any] = {}  # of its own: by their name the steps are what they were
        exec(compile(parsed(source), "<edited>", "exec"), dict(steps.__globals__), space)
        return space[steps.__name__]  # type: ignore[no-any-return]

    def gives(*args: Any) -> Any:
        return made()(*args)

    return gives


def mistakes_in(steps: Callable[..., Any], *rows: tuple[Any, ...]) -> tuple[Misconception, ...]:
    """Make misconceptions of rows: name, sentence, and one or more ways to make the mistake.

    A way is what the steps return instead, as code; or several changes of them, in a tuple, as
    `edited` takes them; or a function. A dictionary at the end is that of `mistakes`.

    Examples
    --------
    >>> rows = mistakes_in(_example, ("signs", "Look at the signs.", "-2 * y", ("x + 1", "x - 1")))
    >>> [gives(3.0) for gives in (rows[0].gives, *rows[0].variants)]
    [-8.0, 4.0]
    """

    def made(way: Any) -> Any:
        if callable(way) or isinstance(way, dict):
            return way
        return edited(steps, way) if isinstance(way, str) else edited(steps, *way)

    return mistakes(*((name, sentence, *map(made, ways)) for name, sentence, *ways in rows))


def _example(x: float) -> float:
    y = x + 1
    return 2 * y


class _Trace(NamedTuple):
    """One input, what each step gives for it, and a right answer."""

    args: tuple[Any, ...]
    steps: tuple[tuple[int, bool, Array], ...]  # the line, whether it is whole, what it gives
    right: Array


@lru_cache(maxsize=64)
def _traced(exercise: Exercise) -> tuple[list[Line], list[_Trace]]:
    """Work out the steps on a few inputs without round numbers."""
    assert exercise.steps is not None
    function, lines = lines_of(exercise.steps)
    code = [
        compile(ast.fix_missing_locations(ast.Module([s], [])), "<steps>", "exec")
        for s in function.body
        if not isinstance(s, ast.Return)
    ]
    names = [argument.arg for argument in function.args.args]
    traces = []
    for args in _untidy(exercise):
        space: dict[str, Any] = {
            **exercise.steps.__globals__,
            **dict(zip(names, copy.deepcopy(args), strict=True)),
        }
        found: dict[tuple[int, str, int], tuple[Array, bool]] = {}
        with np.errstate(all="ignore"):
            for i, one in enumerate(code):
                exec(one, space)
                names_set = lines[i].name.split(", ")
                values = {name: space.get(name) for name in names_set}
                if names_set[1:]:  # and all of them, as one array
                    values = {lines[i].name: list(values.values()), **values}
                for name, given in values.items():
                    value = numbers_in(given)
                    if value is None:
                        continue
                    parts = _parts(value) if "," not in name else []
                    for part, one in enumerate([value, *parts]):
                        says = one if part else given
                        found[i, name, part] = one, not _says_nothing(says, args)
            right = np.asarray(exercise.reference(*copy.deepcopy(args)), dtype=np.float64)
        traces.append((args, found, right))
    # A number may be one of the input's by chance, on one of them.
    shared = [
        key
        for key in traces[0][1]
        if all(key in found for _, found, _ in traces)
        and sum(found[key][1] for _, found, _ in traces) >= max(1, len(traces) - 1)
    ]
    return lines, [
        _Trace(args, tuple((key[0], not key[2], found[key][0]) for key in shared), right)
        for args, found, right in traces
    ]


def _parts(value: Array) -> list[Array]:
    """Return the columns, rows or numbers of a few: who works them out one by one has these."""
    few = range(2, 4)
    columns = list(value.T) if value.ndim == 2 and value.shape[1] in few else []
    return columns + (list(value) if value.ndim and len(value) in few else [])


def _untidy(exercise: Exercise) -> list[tuple[Any, ...]]:
    """Return usual inputs that change with the seed: those that do not are tidy ones.

    Where none does, the largest stand for them.
    """
    by_seed = [exercise.cases(np.random.default_rng(seed)) for seed in _SEEDS]
    found = []
    for n, cases in enumerate(by_seed):
        others = by_seed[n - 1]
        random = [
            case
            for case, other in zip(cases, others, strict=False)
            if _spelled(case.args) != _spelled(other.args)
        ]
        usual = [case for case in random if not case.about] or random
        if usual:
            found.append(max(usual, key=lambda case: min(case.size, 200)).args)
    tidy = sorted(by_seed[0], key=lambda case: -case.size)
    return (found or [case.args for case in tidy])[:_INPUTS]


def _spelled(args: Sequence[Any]) -> list[Any]:
    return [np.asarray(x).tolist() for x in args]


def _says_nothing(value: Any, args: Sequence[Any]) -> bool:
    """Return whether being equal to zeros, ones, counts, or numbers of the input proves nothing."""
    if np.isin(value, (-1, 0, 1)).all() or not np.isfinite(value).any():
        return True
    if np.asarray(value).dtype.kind in "iub":
        return True
    given = [numbers_in(x) for x in args]
    return any(x is not None and np.isin(value, x).all() for x in given)


def _equal(a: Array, b: Array, same: Same) -> bool:
    """Return whether two values are the same step, up to what the exercise forgives."""
    if a.shape != b.shape or not np.array_equal(np.isfinite(a), np.isfinite(b)):
        return False
    there = np.isfinite(b)
    size = float(np.abs(b[there]).max(initial=0)) or 1e-300
    if (np.abs(a[there] - b[there]) <= _NEAR * size).all():
        return True
    if same is up_to_scale and b.size > 2:
        return up_to_scale(a, b, _NEAR)
    return False


def _agree(a: Array, b: Array, same: Same) -> bool:
    """Return whether two values are one step, also transposed or with rows in another order."""
    if a.size != b.size:
        return False
    if _equal(a, b, same) or (a.ndim == 2 == b.ndim and _equal(a.T, b, same)):
        return True
    if a.shape != b.shape:
        return a.ndim != b.ndim and _equal(a.ravel(), b.ravel(), same)
    if a.ndim == 2 and len(a) > 2:
        return _equal(a[np.lexsort(np.round(a, 9).T)], b[np.lexsort(np.round(b, 9).T)], same)
    return False


def located(function: Callable[..., Any], exercise: Exercise) -> Located | None:
    """Find where a student's function leaves the way to an answer.

    Nothing is found where the exercise has no steps, the function no source, or it agrees with no
    step. The function runs where it can do no harm.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> located(np.linalg.inv, SimpleNamespace(steps=None)) is None
    True
    """
    if exercise.steps is None or not isinstance(function, FunctionType):
        return None
    try:
        own = Instrumented(function)
    except (OSError, TypeError, ValueError, SyntaxError, RecursionError):
        return None
    lines, traces = _traced(exercise)  # here, so that the child has it already
    [found] = run(lambda: _found(own, exercise, lines, traces), [()], seconds=_PATIENCE)
    return None if found.value is None else _worded(found.value, own, lines, traces)


def _found(
    own: Instrumented, exercise: Exercise, lines: Sequence[Line], traces: Sequence[_Trace]
) -> Array:
    """Return numbers only: the step that is missing and the expression in whose place it belongs.

    Both are −1 if that is not proven. Behind them whether nothing is wrong before, and a step and
    an expression for each that agrees.
    """
    started = clock()
    end = started + _SECONDS
    with np.errstate(all="ignore"):
        seen = [own.values(trace.args) for trace in traces[:1]]
        if clock() - started > _SLOW:
            return np.array([-1.0, -1.0, 0.0])
        seen += [own.values(trace.args) for trace in traces[1:]]
        innocent = {e for e in seen[0] if _is_innocent(e, exercise, traces, seen)}
        step, place = _proven(own, exercise, traces, seen, innocent, end)
        line = traces[0].steps[step][0] if step >= 0 else len(lines)
        agreed = [pair for pair in _agreed(own, exercise, traces, seen) if pair[0] < line]
    known = {name for i, _ in agreed for name in lines[i].name.split(", ")}
    steps = {i for i, *_ in traces[0].steps if i < line} if traces else set()
    before = {name for i in steps for name in lines[i].name.split(", ")}
    first = step >= 0 and (
        all(e in innocent or _is_read_off(seen[0].get(e), traces[0].args) for e in own.reads[place])
        or lines[line].reads & before <= known
    )
    return np.array([step, place, first, *(x for pair in agreed for x in pair)], dtype=float)


Seen = dict[int, Array]


def _agreed(
    own: Instrumented, exercise: Exercise, traces: Sequence[_Trace], seen: Sequence[Seen]
) -> Iterator[tuple[int, int]]:
    """Yield the steps that expressions give on all inputs, each with the shortest of them."""
    taken: set[int] = set()
    for k, (i, whole, _) in enumerate(traces[0].steps):
        if i in taken or not whole:
            continue
        fits = [
            e
            for e in seen[0]
            if all(
                e in values and _agree(values[e], trace.steps[k][2], exercise.same)
                for trace, values in zip(traces, seen, strict=True)
            )
        ]
        if fits:
            taken.add(i)
            yield i, min(fits, key=lambda e: (own.is_repeated(e), len(own.text[e])))


def _proven(
    own: Instrumented,
    exercise: Exercise,
    traces: Sequence[_Trace],
    seen: Sequence[Seen],
    innocent: set[int],
    end: float,
) -> tuple[int, int]:
    """Return the number of the earliest step that makes the rest right, and the expression."""

    def right(answer: Any, trace: _Trace) -> bool:
        value = numbers_in(answer)
        return value is not None and exercise.same(value, trace.right, TOLERANCE)

    if not traces or all(right(own(trace.args), trace) for trace in traces):
        return -1, -1  # it is wrong in special cases only
    steps = traces[0].steps
    answers = {line for line, _, array in steps if _agree(array, traces[0].right, exercise.same)}
    places = (
        (k, e)
        for k, (line, *_) in enumerate(steps)
        for e in (seen[0] if line not in answers else ())
        if e not in innocent
    )
    for k, e in islice(places, _TRIES):
        if clock() > end:
            break
        if all(
            e in values
            and values[e].size == trace.steps[k][2].size
            and right(own(trace.args, {e: trace.steps[k][2]}), trace)
            for trace, values in zip(traces, seen, strict=True)
        ):
            if all(right(own(t.args, {e: disturbed(t.steps[k][2])}), t) for t in traces):
                continue  # any value does
            return k, e  # where it is worked out, not where it is used
    return -1, -1


def _is_innocent(
    e: int, exercise: Exercise, traces: Sequence[_Trace], seen: Sequence[Seen]
) -> bool:
    """Return whether an expression is right as it is: an input, or one of the steps."""
    pairs = [(values[e], trace) for trace, values in zip(traces, seen, strict=True) if e in values]
    given = zip(*(trace.args for _, trace in pairs), strict=True)
    inputs = ([numbers_in(x) for x in one] for one in given)
    steps = zip(*((array for _, _, array in trace.steps) for _, trace in pairs), strict=True)
    return any(
        all(
            known is not None and _agree(value, known, exercise.same)
            for (value, _), known in zip(pairs, one, strict=True)
        )
        for one in (*inputs, *steps)
    )


def _is_read_off(value: Array | None, args: Sequence[Any]) -> bool:
    """Return whether a value is a count, or a number or a column of an input, whatever its sign."""
    if value is None:
        return False
    arrays = [np.asarray(x) for x in args if np.ndim(x)]
    if value.ndim == 0:
        return bool(value == np.rint(value)) or any(abs(value) in abs(x) for x in arrays)
    return any(np.array_equal(value, one) for x in arrays if x.ndim == 2 for one in x.T)


def _worded(
    found: Array, own: Instrumented, lines: Sequence[Line], traces: Sequence[_Trace]
) -> Located | None:
    """Put numbers into words; None if nothing was found."""
    text = own.text
    step, place, first, *pairs = found.astype(int).tolist()
    agreed = tuple(
        (lines[i].words, text[e])
        for i, e in zip(pairs[::2], pairs[1::2], strict=True)
        if lines[i].words != f"`{text[e]}`"
    )
    if step >= 0:
        line, whole, _ = traces[0].steps[step]
        missing = lines[line]
        if not whole:
            missing = missing._replace(words=f"its part of {missing.words}")
        return Located(agreed[-3:], missing, text[place], bool(first))
    return Located(agreed[-3:]) if agreed else None
