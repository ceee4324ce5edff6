"""Functions that give no numbers: what Python said has a name, and a sentence that helps."""

# Functions that go wrong need none of their arguments, and use names that are not there.
# ruff: noqa: ARG005, F821

import math

import numpy as np
import pytest

from cvnotes.learn import EXERCISES
from cvnotes.tutor.checker import raised
from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.judge import judge
from cvnotes.tutor.checker.sandbox import run

pytestmark = pytest.mark.once

SEED = 2024


def tried(name, function):
    """Give the report on a function."""
    exercise = EXERCISES[name]
    return judge(exercise, [attempt(function, args) for args in exercise.inputs(SEED)], SEED)


@pytest.mark.parametrize(
    ("name", "function", "called"),
    [
        ("depth", lambda a, b, u, v: np.inf if u == v else a * b / (u - v), "if on arrays"),
        ("project", lambda A, R, T, W: A @ (R @ W + T), "shapes that do not fit"),
        ("lift", lambda x, _: x[len(x)], "an index too large"),
        ("drop", lambda x_h: undefined / x_h, "an unknown name"),
        ("drop", lambda x_h: print(x_h), "nothing returned"),
        ("lift", lambda x: x, "other arguments"),
        ("drop", lambda x_h: x_h.tolist().T, "a list for an array"),
    ],
)
def test_what_was_raised_is_named_and_explained(name, function, called):
    report = tried(name, function)
    assert report.misconception == called
    assert "None" in report.message or "raised" in report.message


def _before_it_is_set():
    value = later + 1
    later = 2
    return value + later


def _into_whole_numbers():
    x = np.array([1, 2])
    x += 0.5
    return x


def _import_what_is_not_there():
    import no_such_library

    return no_such_library


def _import_a_name_that_is_not_there():
    from numpy import no_such_name

    return no_such_name


def _two_names_for_three_values():
    u, v = np.ones(3)
    return u + v


nothing, none, one, row, wide = [1, 2], None, 1, np.ones(3), np.ones((2, 3))
RAISES = [
    (lambda: 1 if row else 0, "if on arrays", "np.where"),
    (lambda: (row > 0) & row, "& or | between numbers", "need brackets"),
    (lambda: math.sqrt(row), "one number wanted, an array given", "those of NumPy take arrays"),
    (lambda: np.linalg.cholesky(-np.eye(2)), "not positive definite", "positive eigenvalues"),
    (lambda: np.linalg.inv(np.zeros((2, 2))), "a singular system", "depend on each other"),
    (lambda: wide @ wide, "shapes that do not fit", "In A @ B each row of A"),
    (lambda: np.dot(wide, wide), "shapes that do not fit", "In A @ B each row of A"),
    (lambda: wide * np.ones(2), "shapes that do not fit", "compared from the right"),
    (lambda: wide.reshape(2, 2), "shapes that do not fit", "how many numbers there are"),
    (lambda: np.linalg.solve(np.eye(2), row), "shapes that do not fit", "on its right"),
    (lambda: np.linalg.lstsq(wide, row, rcond=None), "shapes that do not fit", "on its right"),
    (lambda: np.hstack([wide, np.eye(3)]), "shapes that do not fit", "joined"),
    (lambda: np.hstack([wide, row]), "shapes that do not fit", "joined"),
    (lambda: np.stack([row, np.ones(2)]), "shapes that do not fit", "joined"),
    (lambda: np.array([[1, 2], [3]]), "shapes that do not fit", "joined"),
    (lambda: np.linalg.det(wide), "shapes that do not fit", "a square matrix"),
    (lambda: np.linalg.inv(row), "shapes that do not fit", "with rows and columns"),
    (lambda: np.cross(np.ones(4), np.ones(4)), "shapes that do not fit", "vectors of three"),
    (lambda: np.zeros(3, 3), "a shape without brackets", "np.zeros((3, 3))"),
    (_two_names_for_three_values, "unpacked into too few or too many names", "as many names"),
    (lambda: row(0), "round brackets after a value", "x[0]"),
    (_into_whole_numbers, "decimals into an integer array", "dtype=float"),
    (lambda: int(np.nan), "NaN or infinity made an integer", "leave them out"),
    (lambda: none + 1, "None used as a value", "is a return missing"),
    (lambda: none.T, "None used as a value", "is a return missing"),
    (lambda: nothing.T, "a list for an array", "np.array makes"),
    (lambda: nothing * 1.5, "a list for an array", "np.array makes"),
    (lambda: nothing / 2, "a list for an array", "np.array makes"),
    (lambda: nothing[0, 1], "a list for an array", "np.array makes"),
    (lambda: nothing[1.0], "an index that is no whole number", "round it"),
    (lambda: row[1.0], "an index that is no whole number", "round it"),
    (lambda: range(2.5), "an index that is no whole number", "round it"),
    (lambda: row.sum(axis=1), "an axis that is not there", "fewer axes"),
    (lambda: row[1, 2], "too many indices", "fewer axes than the brackets"),
    (lambda: row[3], "an index too large", "the length − 1"),
    (lambda: one / 0, "division by zero", "inf or nan"),
    (lambda: (lambda x: x)(1, 2), "other arguments", "those of the stub"),
    (lambda: undefined, "an unknown name", "defined or imported"),
    (_before_it_is_set, "an unknown name", "defined or imported"),
    (_import_what_is_not_there, "an import that fails", "NumPy is all"),
    (_import_a_name_that_is_not_there, "an import that fails", "NumPy is all"),
    (lambda: np.no_such_function, "no such function", "spelling"),
    (lambda: math.sqrt(-1), "math domain error", "look at the sign"),
]


def named(function):
    """Give the name for what a function raises, and what is said behind the line of code."""
    report = tried("lift", lambda x, w: function())
    return report.misconception, report.message.rpartition("`. ")[2]


@pytest.mark.parametrize(("function", "called", "words"), RAISES)
def test_what_python_says_of_a_slip_has_a_name_and_a_sentence(function, called, words):
    name, message = named(function)
    assert name == called
    assert words in message
    assert message.endswith((".", "?", ".)"))


def test_every_pattern_is_needed(monkeypatch):
    """Without an entry, and without one of its alternatives, some name or sentence is another."""
    for entry in raised.RAISED:
        for pattern in {"(?!)", *_with_one_alternative_less(entry[0])}:
            less = [(pattern, *e[1:]) if e is entry else e for e in raised.RAISED]
            monkeypatch.setattr(raised, "RAISED", less)
            assert any(
                name != called or words not in message
                for function, called, words in RAISES
                for name, message in [named(function)]
            ), pattern
            monkeypatch.undo()


def _with_one_alternative_less(pattern):
    """Give a pattern without each of the alternatives that it has at its top."""
    alternatives = [] if "(" in pattern else pattern.split("|")
    for left_out in alternatives[1:] and alternatives:
        yield "|".join(one for one in alternatives if one != left_out)


def test_the_students_own_line_is_not_what_was_raised():
    report = tried("lift", lambda x, w: undefined / np.square(x) @ np.broadcast_to(w, 3))
    assert "np.square" in report.message
    assert report.misconception == "an unknown name"


def test_a_quoted_line_is_never_cut_without_its_closing_sign():
    def my_lift(x, w):
        raise ValueError(
            "a long story " * 40 + str(x) + str(w)
        )  # and a long line of code behind it

    [outcome] = run(my_lift, EXERCISES["lift"].inputs(SEED)[:1])
    assert "…, in the line `raise ValueError(" in outcome.words
    assert outcome.words.endswith("`")
