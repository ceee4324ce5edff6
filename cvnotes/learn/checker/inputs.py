"""Slips in what is put in: R transposed, src and dst exchanged, a skew that was forgotten.

A student's function often does the right thing with the wrong input. So the right function is
tried on inputs that have slipped; where its results are the student's, in every case, the slip
has a name in every exercise, without being foreseen for any.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.checker.diagnosis import Found, Tried, explains
from cvnotes.learn.checker.exercise import Case, Exercise

# What happened to an argument: a name, what stood in its place, and how to make that of it.
Slip = tuple[str, str, Callable[[Any], Any]]


def slipped_input(
    exercise: Exercise, tried: Sequence[Tried], failing: Sequence[Case]
) -> Found | None:
    """Name the input that was used otherwise than meant.

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
    Found or None
        The first slip that gives what the student's function gave, in every case.
    """
    if exercise.answer != "function" or any(outcome.value is None for _, outcome in tried):
        return None
    wrong = {id(case) for case in failing}
    # The shortest wrong case decides about most slips; the others confirm what is left.
    first = sorted(tried, key=lambda one: (id(one[0]) not in wrong, one[0].size))
    for name, sentence, slip in _slips(exercise, tried):

        def gives(*args: Any, slip: Callable[..., Any] = slip) -> Any:
            try:
                slipped = slip(*args)
                if not all(np.isfinite(x).all() for x in slipped):
                    return None
                return exercise.reference(*slipped)
            except (ValueError, IndexError, TypeError, ZeroDivisionError, FloatingPointError):
                return None

        if explains(exercise, gives, exercise.same, first, wrong) and _has_answers(gives, tried):
            return Found(name, sentence)
    return None


def _has_answers(gives: Callable[..., Any], tried: Sequence[Tried]) -> bool:
    """Tell whether a slip gives numbers in all cases: without, it explains too much."""
    with np.errstate(all="ignore"):
        return all(gives(*case.args) is not None for case, _ in tried)


def _slips(
    exercise: Exercise, tried: Sequence[Tried]
) -> Iterator[tuple[str, str, Callable[..., tuple[Any, ...]]]]:
    """Give all slips of one argument, and of two that are of one kind."""
    names, args = exercise.arguments, tried[0][0].args
    for i, j in combinations(range(len(args)), 2):
        if np.shape(args[i]) == np.shape(args[j]) and not isinstance(args[i], tuple):
            a, b = names[i], names[j]
            yield (
                f"{a} and {b} exchanged",
                f"That is the right answer with {a} and {b} exchanged.",
                partial(_exchanged, i, j),
            )
            yield f"{a} for {b}", f"You used {a} in place of {b}.", partial(_copied, i, j)
            yield f"{b} for {a}", f"You used {b} in place of {a}.", partial(_copied, j, i)
    for i, (name, arg) in enumerate(zip(names, args, strict=True)):
        for what, instead, change in _changes(name, arg):
            yield (
                what.format(name),
                f"That is the right answer with {instead.format(name)} in place of {name}.",
                partial(_changed, i, change),
            )


def _exchanged(i: int, j: int, *args: Any) -> tuple[Any, ...]:
    given = list(args)
    given[i], given[j] = given[j], given[i]
    return tuple(given)


def _copied(source: int, target: int, *args: Any) -> tuple[Any, ...]:
    given = list(args)
    given[target] = given[source]
    return tuple(given)


def _changed(i: int, change: Callable[[Any], Any], *args: Any) -> tuple[Any, ...]:
    return (*args[:i], change(args[i]), *args[i + 1 :])


def _changes(name: str, arg: Any) -> Iterator[Slip]:
    """Give what may have happened to one argument."""
    if isinstance(arg, tuple):
        yield "{0} the wrong way round", "{0}[::-1]", lambda x: x[::-1]
        yield "{0} one too many", "1 more in both numbers of {0}", lambda x: tuple(n + 1 for n in x)
        yield "{0} one too few", "1 less in both numbers of {0}", lambda x: tuple(n - 1 for n in x)
    elif isinstance(arg, int):
        yield "{0} one too many", "{0} + 1", lambda x: x + 1
        yield "{0} one too few", "{0} − 1", lambda x: x - 1
        yield "{0} one too few, then one too many", "{0} − 2", lambda x: x - 2
        yield "{0} doubled", "2 {0}", lambda x: 2 * x
    elif isinstance(arg, float):
        yield from _NUMBER
    elif isinstance(arg, np.ndarray) and arg.ndim == 1:
        yield from _VECTOR
        if arg.size <= 6:
            yield from (_one_left_out(j) for j in range(arg.size))
    elif isinstance(arg, np.ndarray) and arg.ndim == 2:
        if name == "A":
            yield from _INTRINSICS
        if arg.shape == (4, 4):
            yield from _MOTION
        if arg.shape[0] == arg.shape[1]:
            yield from _SQUARE
        yield from _ROWS


_NUMBER: tuple[Slip, ...] = (
    ("sign of {0}", "−{0}", lambda x: -x),
    ("{0} upside down", "1 / {0}", lambda x: 1 / x),
    ("{0} left out", "1", lambda _: 1.0),
    ("{0} for 0", "0", lambda _: 0.0),
    ("{0} doubled", "2 {0}", lambda x: 2 * x),
    ("{0} halved", "{0} / 2", lambda x: x / 2),
    ("{0} squared", "the square of {0}", lambda x: x * x),
    ("{0} under a root", "the root of {0}", np.sqrt),
    ("{0} rounded", "a rounded {0}", lambda x: float(np.floor(x + 0.5))),
    ("{0} without decimals", "int({0})", lambda x: float(int(x))),
)
_VECTOR: tuple[Slip, ...] = (
    ("sign of {0}", "−{0}", np.negative),
    ("{0} left out", "0", lambda x: 0 * x),
    ("{0} the wrong way round", "{0}[::-1]", lambda x: x[::-1]),
    ("{0} moved on", "np.roll({0}, 1)", lambda x: np.roll(x, 1)),
    ("{0} moved back", "np.roll({0}, -1)", lambda x: np.roll(x, -1)),
    ("absolute values of {0}", "the absolute values of {0}", np.abs),
    ("{0} squared", "the squares of {0}", np.square),
    ("{0} scaled to length 1", "{0}, scaled to length 1,", lambda x: x / np.linalg.norm(x)),
    ("{0} less its mean", "{0} − {0}.mean()", lambda x: x - x.mean()),
    ("{0} without decimals", "{0} without its decimals", np.trunc),
)
_SQUARE: tuple[Slip, ...] = (
    ("{0} transposed", "the transpose of {0}", np.transpose),
    ("{0} inverted", "the inverse of {0}", np.linalg.inv),
    ("{0} inverted and transposed", "the inverse transpose of {0}", lambda x: np.linalg.inv(x).T),
    ("{0} left out", "the identity", lambda x: np.eye(len(x))),
    ("sign of {0}", "−{0}", np.negative),
    ("{0} by columns", "{0}, its columns in the opposite order,", lambda x: x[:, ::-1]),
    ("{0} by rows", "{0}, its rows in the opposite order,", lambda x: x[::-1]),
    ("{0} made symmetric", "({0} + its transpose) / 2", lambda x: (x + x.T) / 2),
    ("{0} scaled by its last number", "{0} / {0}[-1, -1]", lambda x: x / x[-1, -1]),
    ("upper triangle of {0}", "the upper triangle of {0}", np.triu),
    ("lower triangle of {0}", "the lower triangle of {0}", np.tril),
    ("diagonal of {0}", "the diagonal of {0} alone", lambda x: np.diag(np.diag(x))),
)
_ROWS: tuple[Slip, ...] = (
    ("columns exchanged in {0}", "{0}[:, ::-1]", lambda x: x[:, ::-1]),
    ("{0} in the opposite order", "{0}[::-1]", lambda x: x[::-1]),
    (
        "{0} reshaped, not transposed",
        "{0}, reshaped where it should be transposed,",
        lambda x: x.reshape(x.shape[::-1]).T,
    ),
    ("{0} transposed by a reshape", "{0}.T.reshape", lambda x: x.T.reshape(x.shape)),
    ("the first row only of {0}", "the first row of {0} alone", lambda x: x[:1]),
    ("the last row only of {0}", "the last row of {0} alone", lambda x: x[-1:]),
    ("the first row left out of {0}", "{0}[1:]", lambda x: x[1:]),
    ("the last row left out of {0}", "{0}[:-1]", lambda x: x[:-1]),
    ("every other row of {0}", "{0}[::2]", lambda x: x[::2]),
    ("the first row for all of {0}", "the first row of {0} for all", lambda x: 0 * x + x[:1]),
    ("the last row for all of {0}", "the last row of {0} for all", lambda x: 0 * x + x[-1:]),
    ("sign of {0}", "−{0}", np.negative),
    (
        "second column's sign of {0}",
        "{0}, the sign of its second column changed,",
        lambda x: _flip(x),
    ),
    ("{0} about its mean", "{0} − {0}.mean(axis=0)", lambda x: x - x.mean(0)),
    ("{0} less the mean of all its numbers", "{0} − {0}.mean()", lambda x: x - x.mean()),
    ("{0} without decimals", "{0} without its decimals, as whole numbers,", np.trunc),
    ("{0} as bytes", "{0} as np.uint8", lambda x: x.astype(np.uint8).astype(float)),
    ("{0} moved by half a pixel", "{0} + ½", lambda x: x + 0.5),
    ("{0} moved back by half a pixel", "{0} − ½", lambda x: x - 0.5),
    ("{0} counted from one", "{0} + 1", lambda x: x + 1),
    ("{0} counted from one less", "{0} − 1", lambda x: x - 1),
    (
        "rows scaled to length 1 in {0}",
        "{0}, each row scaled to length 1,",
        lambda x: _rows_unit(x),
    ),
    ("{0} divided by its last column", "{0} / {0}[:, -1:]", lambda x: x / x[:, -1:]),
)


def _flip(x: Array) -> Array:
    signs = np.ones(x.shape[1])
    signs[1:2] = -1
    return np.asarray(x * signs)


def _rows_unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x, axis=1, keepdims=True))


def _one_left_out(j: int) -> Slip:
    def change(x: Array) -> Array:
        x = np.array(x)
        x[j] = 0
        return x

    return f"{{0}}[{j}] left out", f"{{0}} with 0 for {{0}}[{j}]", change


def _put(**places: Callable[[Array], float]) -> Callable[[Array], Array]:
    """Make a change of A that puts something in the place of its entries, by their names."""
    where = {"au": (0, 0), "av": (1, 1), "u0": (0, 2), "v0": (1, 2), "skew": (0, 1)}

    def change(A: Array) -> Array:
        B = np.array(A)
        for place, value in places.items():
            B[where[place]] = value(A)
        return B

    return change


_INTRINSICS: tuple[Slip, ...] = (
    ("{0} without its skew", "{0} without its skew {0}[0, 1]", _put(skew=lambda _: 0.0)),
    ("{0} with α_u for both", "{0} with α_u for α_v", _put(av=lambda A: A[0, 0])),
    ("{0} with α_v for both", "{0} with α_v for α_u", _put(au=lambda A: A[1, 1])),
    (
        "{0} with the mean focal length",
        "{0} with the mean of α_u and α_v for both",
        _put(au=lambda A: (A[0, 0] + A[1, 1]) / 2, av=lambda A: (A[0, 0] + A[1, 1]) / 2),
    ),
    (
        "{0} with α_u and α_v exchanged",
        "{0} with α_u and α_v exchanged",
        _put(au=lambda A: A[1, 1], av=lambda A: A[0, 0]),
    ),
    (
        "{0} with u0 and v0 exchanged",
        "{0} with u0 and v0 exchanged",
        _put(u0=lambda A: A[1, 2], v0=lambda A: A[0, 2]),
    ),
    (
        "{0} without its principal point",
        "{0} without u0 and v0",
        _put(u0=lambda _: 0.0, v0=lambda _: 0.0),
    ),
    (
        "{0} with the principal point subtracted",
        "{0} with −u0 and −v0",
        _put(u0=lambda A: -A[0, 2], v0=lambda A: -A[1, 2]),
    ),
    ("{0} with v upwards", "{0} with −α_v", _put(av=lambda A: -A[1, 1])),
    ("{0} with u0 for both", "{0} with u0 for v0", _put(v0=lambda A: A[0, 2])),
    (
        "{0} without focal lengths",
        "{0} with 1 for α_u and α_v",
        _put(au=lambda _: 1.0, av=lambda _: 1.0),
    ),
    ("{0} with the sign of the skew", "{0} with −γ for its skew", _put(skew=lambda A: -A[0, 1])),
)


def _moved(turn: Callable[[Array], Array], shift: Callable[[Array], Array]) -> Any:
    def change(G: Array) -> Array:
        M = np.array(G)
        M[:3, :3], M[:3, 3] = turn(G[:3, :3]), shift(G)
        return M

    return change


_MOTION: tuple[Slip, ...] = (
    ("{0} with Rᵀ for R", "{0} with Rᵀ for R", _moved(np.transpose, lambda G: G[:3, 3])),
    ("{0} with −T for T", "{0} with −T for T", _moved(np.array, lambda G: -G[:3, 3])),
    ("{0} without T", "{0} without T", _moved(np.array, lambda G: 0 * G[:3, 3])),
    ("{0} without R", "{0} without R", _moved(lambda R: np.eye(len(R)), lambda G: G[:3, 3])),
    (
        "{0} with T for the camera's position",
        "{0} with −R T for T, as for a camera that stands at T,",
        _moved(np.array, lambda G: -G[:3, :3] @ G[:3, 3]),
    ),
    (
        "{0} with T turned before",
        "{0} with R T for T, as in R (W + T),",
        _moved(np.array, lambda G: G[:3, :3] @ G[:3, 3]),
    ),
)
