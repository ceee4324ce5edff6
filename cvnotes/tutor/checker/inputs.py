"""Slips in what is put in: R transposed, src and dst exchanged, a skew that was forgotten.

A student's function often does the right thing with the wrong input. So the right function is
tried on inputs that have slipped; where its results are the student's, in every case, the slip
has a name in every exercise, without being foreseen for any.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import combinations, islice, permutations
from typing import Any, NamedTuple

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.equality import disturbed
from cvnotes.tutor.checker.foreseen import explains
from cvnotes.tutor.checker.wrong_answer import Found, Tried, WrongAnswer


class Slip(NamedTuple):
    """What may have happened to an argument, {0}: its name, what was done, and how to do it."""

    name: str
    done: str
    change: Callable[[Any], Any]


def slipped_input(answer: WrongAnswer) -> Found | None:
    """Name the input that was used otherwise than meant.

    That is the first slip that gives what the student's function gave, in every case.
    """
    exercise, tried = answer.exercise, answer.tried
    if exercise.answer != "function" or any(outcome.value is None for _, outcome in tried):
        return None
    for name, done, slip in slips_of(exercise.arguments, tried[0][0].args):
        gives = with_inputs(slip, exercise.reference)
        if explains(gives, answer, exercise.same) and _has_answers(gives, tried):
            anything = with_inputs(partial(_anything_else, slip), exercise.reference)
            if not explains(anything, answer, exercise.same):
                return Found(name, f"It looks as if you {done}; the rest is right.")
    return None


def _anything_else(slip: Callable[..., Any], *args: Any) -> tuple[Any, ...]:
    """Return inputs with other numbers in what a slip has changed: if they do, it proves nothing.

    Counts alone may come out the same from any nonsense.
    """
    return tuple(
        disturbed(new) if new is not old else new
        for new, old in zip(slip(*args), args, strict=True)
    )


def with_inputs(slip: Callable[..., Any], function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of inputs that have slipped; None where that has no answer."""

    def gives(*args: Any) -> Any:
        try:
            slipped = slip(*args)
            if not all(np.isfinite(x).all() for x in slipped):
                return None
            return function(*slipped)
        except (ValueError, IndexError, TypeError, ZeroDivisionError, FloatingPointError):
            return None

    return gives


def _has_answers(gives: Callable[..., Any], tried: Sequence[Tried]) -> bool:
    """Return whether a slip gives numbers in all cases: without, it explains too much."""
    with np.errstate(all="ignore"):
        given = (gives(*case.args) for case, _ in tried)
        return all(x is not None and not np.isnan(np.asarray(x, float)).all() for x in given)


def slips_of(
    names: Sequence[str], args: Sequence[Any], at_most: int = 99
) -> Iterator[tuple[str, str, Callable[..., tuple[Any, ...]]]]:
    """Yield slips of two arguments that are of one kind, and of each: its name, what was done, how.

    At most so many of each kind of argument, the likeliest.
    """
    for i, j in combinations(range(len(args)), 2):
        if np.shape(args[i]) == np.shape(args[j]) and not isinstance(args[i], tuple):
            a, b = names[i], names[j]
            exchanged = partial(_taken, {i: j, j: i})
            yield f"{a} and {b} exchanged", f"exchanged {a} and {b}", exchanged
            yield f"{a} for {b}", f"used {a} in place of {b}", partial(_taken, {j: i})
            yield f"{b} for {a}", f"used {b} in place of {a}", partial(_taken, {i: j})
    rows = [name for name, x in zip(names, args, strict=True) if np.ndim(x) > 1]
    for n in range(1, 5) if _in_rows(args) else ():
        what = f"the first {n if n > 1 else 'one'} of {' and '.join(rows)}"
        yield f"only {what}", f"used only {what}", partial(_first_ones, n)
    for i, (name, arg) in enumerate(zip(names, args, strict=True)):
        for slips in _changes(name, arg):
            for slip in islice(slips, at_most):
                changed = partial(_changed, i, slip.change)
                yield slip.name.format(name), slip.done.format(name), changed


def _in_rows(args: Sequence[Any]) -> bool:
    """Return whether all arrays have as many rows, one for each point, pair or view."""
    shapes = [np.shape(x) for x in args if np.ndim(x) > 1]
    return len({s[0] for s in shapes}) == 1 and (3, 3) not in shapes


def _first_ones(n: int, *args: Any) -> tuple[Any, ...]:
    return tuple(x[:n] if np.ndim(x) > 1 else x for x in args)


def _taken(sources: dict[int, int], *args: Any) -> tuple[Any, ...]:
    """Take some arguments from other places: {to: from}."""
    return tuple(args[sources.get(i, i)] for i in range(len(args)))


def _changed(i: int, change: Callable[[Any], Any], *args: Any) -> tuple[Any, ...]:
    return (*args[:i], change(args[i]), *args[i + 1 :])


def _changes(name: str, arg: Any) -> Iterator[Iterable[Slip]]:
    """Yield kinds of what may have happened to one argument."""
    if isinstance(arg, tuple):
        yield _SIZE
    elif isinstance(arg, int):
        yield _COUNT
    elif isinstance(arg, float):
        yield _NUMBER
    elif isinstance(arg, np.ndarray) and arg.ndim == 1:
        yield _VECTOR
        if arg.size <= 6:
            yield (
                Slip(f"{{0}}[{j}] left out", f"left out {{0}}[{j}], or took 0 for it",
                     partial(_without, j))
                for j in range(arg.size)
            )  # fmt: skip
            yield (
                Slip(f"{{0}}[{i}] and {{0}}[{j}] exchanged", f"exchanged {{0}}[{i}] and {{0}}[{j}]",
                     partial(_rearranged, {i: j, j: i}))
                for i, j in combinations(range(arg.size), 2)
            )  # fmt: skip
        if arg.size <= 3:
            yield (
                Slip(f"{{0}}[{i}] for {{0}}[{j}]", f"used {{0}}[{i}] in place of {{0}}[{j}]",
                     partial(_rearranged, {j: i}))
                for i, j in permutations(range(arg.size), 2)
            )  # fmt: skip
    elif isinstance(arg, np.ndarray) and arg.ndim == 2:
        if name == "A":
            yield _INTRINSICS
        if arg.shape == (4, 4):
            yield _MOTION
        if arg.shape[0] == arg.shape[1]:
            yield _SQUARE
        yield _ROWS


def _without(j: int, x: Array) -> Array:
    return np.where(np.arange(len(x)) == j, 0, x)


def _rearranged(sources: dict[int, int], x: Array) -> Array:
    return np.array(_taken(sources, *x))


def _used(name: str, instead: str, change: Callable[[Any], Any]) -> Slip:
    return Slip(name, f"used {instead} in place of {{0}}", change)


_SIZE = (
    _used("{0} the wrong way round", "{0}[::-1]", lambda x: x[::-1]),
    Slip("{0} too large by 1", "added 1 to both numbers of {0}", lambda x: tuple(n + 1 for n in x)),
    Slip("{0} too small by 1", "subtracted 1 from both numbers of {0}",
         lambda x: tuple(n - 1 for n in x)),
)  # fmt: skip
_COUNT = (
    _used("{0} too large by 1", "{0} + 1", lambda x: x + 1),
    _used("{0} too small by 1", "{0} − 1", lambda x: x - 1),
    _used("{0} too small by 2", "{0} − 2", lambda x: x - 2),
    _used("{0} doubled", "2 {0}", lambda x: 2 * x),
)
_NUMBER = (
    _used("sign of {0}", "−{0}", lambda x: -x),
    _used("{0} upside down", "1 / {0}", lambda x: 1 / x),
    Slip("1 for {0}", "left out {0}, or took 1 for it", lambda _: 1.0),
    Slip("0 for {0}", "left out {0}, or took 0 for it", lambda _: 0.0),
    _used("{0} doubled", "2 {0}", lambda x: 2 * x),
    _used("{0} halved", "{0} / 2", lambda x: x / 2),
    _used("{0} squared", "the square of {0}", lambda x: x * x),
    _used("{0} under a root", "the root of {0}", np.sqrt),
    Slip("{0} rounded", "rounded {0}", lambda x: float(np.floor(x + 0.5))),
    _used("{0} without decimals", "int({0})", lambda x: float(int(x))),
)  # fmt: skip
_VECTOR = (
    _used("sign of {0}", "−{0}", np.negative),
    Slip("{0} left out", "left out {0}, or took 0 for it", lambda x: 0 * x),
    _used("{0} the wrong way round", "{0}[::-1]", lambda x: x[::-1]),
    _used("{0} moved on", "np.roll({0}, 1)", lambda x: np.roll(x, 1)),
    _used("{0} moved back", "np.roll({0}, -1)", lambda x: np.roll(x, -1)),
    _used("absolute values of {0}", "the absolute values of {0}", np.abs),
    _used("{0} squared", "the squares of {0}", np.square),
    Slip("{0} sorted", "sorted {0}", np.sort),
    Slip("{0} scaled to length 1", "scaled {0} to length 1", lambda x: x / np.linalg.norm(x)),
    _used("{0} less its mean", "{0} − {0}.mean()", lambda x: x - x.mean()),
    Slip("{0} without decimals", "cut off the decimals of {0}", np.trunc),
)
_SQUARE = (
    _used("{0} transposed", "the transpose of {0}", np.transpose),
    _used("{0} inverted", "the inverse of {0}", np.linalg.inv),
    _used("{0} inverted and transposed", "the inverse transpose of {0}",
          lambda x: np.linalg.inv(x).T),
    Slip("{0} left out", "left out {0}, or took the identity for it", lambda x: np.eye(len(x))),
    _used("{0} made symmetric", "({0} + {0}.T) / 2", lambda x: (x + x.T) / 2),
    Slip("{0} scaled by its last number", "divided {0} by its last number {0}[-1, -1]",
         lambda x: x / x[-1, -1]),
    _used("upper triangle of {0}", "the upper triangle of {0}", np.triu),
    _used("lower triangle of {0}", "the lower triangle of {0}", np.tril),
    _used("diagonal of {0}", "the diagonal of {0} alone", lambda x: np.diag(np.diag(x))),
)  # fmt: skip
_ROWS = (
    _used("columns exchanged in {0}", "{0}[:, ::-1]", lambda x: x[:, ::-1]),
    _used("{0} in the opposite order", "{0}[::-1]", lambda x: x[::-1]),
    _used("columns moved on in {0}", "np.roll({0}, 1, axis=1)", lambda x: np.roll(x, 1, 1)),
    _used("columns moved back in {0}", "np.roll({0}, -1, axis=1)", lambda x: np.roll(x, -1, 1)),
    _used("sign of {0}", "−{0}", np.negative),
    Slip("{0} reshaped, not transposed", "reshaped {0} where it should be transposed",
         lambda x: x.reshape(x.shape[::-1]).T),
    _used("{0} transposed by a reshape", "{0}.T.reshape({0}.shape)",
          lambda x: x.T.reshape(x.shape)),
    _used("the first row only of {0}", "the first row of {0} alone", lambda x: x[:1]),
    _used("the last row only of {0}", "the last row of {0} alone", lambda x: x[-1:]),
    _used("the first row left out of {0}", "{0}[1:]", lambda x: x[1:]),
    _used("the last row left out of {0}", "{0}[:-1]", lambda x: x[:-1]),
    _used("every other row of {0}", "{0}[::2]", lambda x: x[::2]),
    Slip("the first row for all of {0}", "used the first row of {0} for all of its rows",
         lambda x: 0 * x + x[:1]),
    Slip("the last row for all of {0}", "used the last row of {0} for all of its rows",
         lambda x: 0 * x + x[-1:]),
    Slip("sign of the second column of {0}", "changed the sign of the second column of {0}",
         lambda x: x * np.where(np.arange(x.shape[1]) == 1, -1.0, 1.0)),
    _used("{0} about its mean", "{0} − {0}.mean(axis=0)", lambda x: x - x.mean(0)),
    _used("{0} less the mean of all its numbers", "{0} − {0}.mean()", lambda x: x - x.mean()),
    Slip("{0} without decimals", "cut off the decimals of {0}", np.trunc),
    Slip("{0} as bytes", "turned {0} into bytes, np.uint8",
         lambda x: x.astype(np.uint8).astype(float)),
    _used("{0} moved by half a pixel", "{0} + ½", lambda x: x + 0.5),
    _used("{0} moved back by half a pixel", "{0} − ½", lambda x: x - 0.5),
    _used("{0} moved by 1", "{0} + 1", lambda x: x + 1),
    _used("{0} moved back by 1", "{0} − 1", lambda x: x - 1),
    Slip("rows scaled to length 1 in {0}", "scaled each row of {0} to length 1",
         lambda x: x / np.linalg.norm(x, axis=1, keepdims=True)),
    Slip("{0} divided by its last column", "divided {0} by its last column, {0}[:, -1:]",
         lambda x: x / x[:, -1:]),
)  # fmt: skip


ENTRIES_OF_A = {"α_u": (0, 0), "α_v": (1, 1), "u0": (0, 2), "v0": (1, 2), "γ": (0, 1)}


def _put(**places: Callable[[Array], float]) -> Callable[[Array], Array]:
    """Make a change of A that puts something in the place of its entries, by their names."""

    def change(A: Array) -> Array:
        B = np.array(A)
        for place, value in places.items():
            B[ENTRIES_OF_A[place]] = value(A)
        return B

    return change


_INTRINSICS = (
    Slip("{0} without its skew", "left out the skew {0}[0, 1]", _put(γ=lambda _: 0.0)),
    Slip("{0} with α_u for both", "used α_u in place of α_v", _put(α_v=lambda A: A[0, 0])),
    Slip("{0} with α_v for both", "used α_v in place of α_u", _put(α_u=lambda A: A[1, 1])),
    Slip("{0} with the mean focal length", "used the mean of α_u and α_v for both",
         _put(α_u=lambda A: (A[0, 0] + A[1, 1]) / 2, α_v=lambda A: (A[0, 0] + A[1, 1]) / 2)),
    Slip("{0} with one focal length and no skew",
         "used α_u for both focal lengths, and left out the skew",
         _put(α_v=lambda A: A[0, 0], γ=lambda _: 0.0)),
    Slip("{0} with α_u and α_v exchanged", "exchanged α_u and α_v",
         _put(α_u=lambda A: A[1, 1], α_v=lambda A: A[0, 0])),
    Slip("{0} with u0 and v0 exchanged", "exchanged u0 and v0",
         _put(u0=lambda A: A[1, 2], v0=lambda A: A[0, 2])),
    Slip("{0} without its principal point", "left out u0 and v0",
         _put(u0=lambda _: 0.0, v0=lambda _: 0.0)),
    Slip("{0} with the principal point subtracted", "used −u0 and −v0 in place of u0 and v0",
         _put(u0=lambda A: -A[0, 2], v0=lambda A: -A[1, 2])),
    Slip("{0} with v upwards", "used −α_v in place of α_v", _put(α_v=lambda A: -A[1, 1])),
    Slip("{0} with u0 for both", "used u0 in place of v0", _put(v0=lambda A: A[0, 2])),
    Slip("{0} with α_v and v0 for α_u and u0", "used α_v and v0 in place of α_u and u0",
         _put(α_u=lambda A: A[1, 1], u0=lambda A: A[1, 2])),
    Slip("{0} without focal lengths", "left out α_u and α_v, or took 1 for both",
         _put(α_u=lambda _: 1.0, α_v=lambda _: 1.0)),
    Slip("{0} with the sign of the skew", "used −γ in place of the skew γ",
         _put(γ=lambda A: -A[0, 1])),
)  # fmt: skip


def _moved(turn: Callable[[Array], Array], shift: Callable[[Array], Array]) -> Any:
    def change(G: Array) -> Array:
        M = np.array(G)
        M[:3, :3], M[:3, 3] = turn(G[:3, :3]), shift(G)
        return M

    return change


_MOTION = (
    Slip("{0} with Rᵀ for R", "used Rᵀ in place of the R of {0}",
         _moved(np.transpose, lambda G: G[:3, 3])),
    Slip("{0} with −T for T", "used −T in place of the T of {0}",
         _moved(np.array, lambda G: -G[:3, 3])),
    Slip("{0} without T", "left out the T of {0}", _moved(np.array, lambda G: 0 * G[:3, 3])),
    Slip("{0} without R", "left out the R of {0}",
         _moved(lambda R: np.eye(len(R)), lambda G: G[:3, 3])),
    Slip("{0} with T for the camera's position", "took the T of {0} for the place where the camera "
         "stands, as in R (W − T)", _moved(np.array, lambda G: -G[:3, :3] @ G[:3, 3])),
    Slip("{0} with T turned before", "turned the T of {0}, too, as in R (W + T)",
         _moved(np.array, lambda G: G[:3, :3] @ G[:3, 3])),
)  # fmt: skip
