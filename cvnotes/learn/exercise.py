"""What an exercise is made of: cases, properties, misconceptions; and when answers are equal."""

import ast
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from cvnotes.errors import Array

Rng = np.random.Generator
Same = Callable[[Array, Array, float], bool]


@dataclass(frozen=True, eq=False)
class Case:
    """One input that a student's function is tried on.

    Attributes
    ----------
    args : tuple
        What the function is called with.
    truth : any
        What only the checker knows: the camera behind the numbers, for example.
    about : str
        What is special about this case; properties with the same word look at it.
    right : ndarray
        One right answer, worked out after the student's.
    """

    args: tuple[Any, ...]
    truth: Any = None
    about: str = ""
    right: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def size(self) -> int:
        """How many numbers a reader of this case would have to look at."""
        return sum(np.size(x) for x in self.args)


@dataclass(frozen=True, eq=False)
class Property:
    """A sentence about right answers, and how to see whether an answer has it.

    Attributes
    ----------
    sentence : str
        What must be true.
    holds : callable or None
        (answer, case) → bool; None compares with the right answer of the case.
    about : str
        Which cases it looks at.
    """

    sentence: str
    holds: Callable[[Array, Case], bool] | None = None
    about: str = ""


@dataclass(frozen=True, eq=False)
class Misconception:
    """A classic mistake: its name, a sentence that helps, and what it gives.

    `gives` takes what the student's function takes; None where the mistake gives nothing
    definite. `variants` make the same mistake on other ways. `same` tells when two results of
    it are equal, if that is not what the exercise calls equal.
    """

    name: str
    sentence: str
    gives: Callable[..., Any]
    variants: tuple[Callable[..., Any], ...] = ()
    same: Same | None = None


def close(answer: Array, right: Array, tolerance: float) -> bool:
    """Tell whether two answers are equal, relative to their largest entry; NaN equals NaN.

    Examples
    --------
    >>> close(np.array([1.0, np.nan]), np.array([1.0, np.nan]), 1e-6)
    True
    """
    finite = np.isfinite(right)
    if answer.shape != right.shape or not np.array_equal(np.isfinite(answer), finite):
        return False
    if not np.array_equal(answer[~finite], right[~finite], equal_nan=True):
        return False
    scale = float(np.abs(right[finite]).max(initial=0.0)) or 1e-3
    return bool((np.abs(answer[finite] - right[finite]) <= tolerance * scale).all())


def up_to_scale(answer: Array, right: Array, tolerance: float) -> bool:
    """Tell whether two arrays differ only by a factor.

    Examples
    --------
    >>> up_to_scale(np.array([2.0, 4.0]), np.array([-1.0, -2.0]), 1e-6)
    True
    """
    if answer.shape != right.shape or not (np.isfinite(answer).all() and np.isfinite(right).all()):
        return False
    norms = np.linalg.norm(answer), np.linalg.norm(right)
    if min(norms) == 0:
        return bool(max(norms) == 0)
    a, b = answer / norms[0], right / norms[1]
    return bool(min(np.abs(a - b).max(), np.abs(a + b).max()) <= tolerance)


def up_to_signs(answer: Array, right: Array, tolerance: float) -> bool:
    """Tell whether two arrays differ only by a factor and by the signs of their entries.

    Each singular vector has a sign of its own, so a column that cuts across them has many.

    Examples
    --------
    >>> up_to_signs(np.array([2.0, -4.0]), np.array([1.0, 2.0]), 1e-6)
    True
    """
    return up_to_scale(np.abs(answer), np.abs(right), tolerance)


def rows_up_to_scale(answer: Array, right: Array, tolerance: float) -> bool:
    """Tell whether the rows of two arrays differ only by a factor each.

    Examples
    --------
    >>> rows_up_to_scale(np.array([[2.0, 0], [0, 3]]), np.eye(2), 1e-6)
    True
    """
    if answer.shape != right.shape or answer.ndim != 2:
        return False
    return all(up_to_scale(a, b, tolerance) for a, b in zip(answer, right, strict=True))


def within(distance: float) -> Same:
    """Compare numbers that were read off: equal if no farther apart than a distance.

    Examples
    --------
    >>> within(10.0)(np.array([320.0, 96.0]), np.array([325.0, 92.0]), 1e-6)
    True
    """

    def same(answer: Array, right: Array, _: float) -> bool:
        return answer.shape == right.shape and bool(np.linalg.norm(answer - right) <= distance)

    return same


@dataclass(frozen=True, eq=False)
class Exercise:
    """An exercise: what is asked, how an answer is tried, and what goes wrong typically.

    Attributes
    ----------
    name, chapter, title, task, stub
        What the student sees; the stub is the source of a function that does nothing yet.
    hints : tuple of str
        One more each time.
    cases : callable
        (rng) → list of `Case`, the shortest to read first.
    properties, misconceptions : tuple
        What must be true, and what is typically wrong.
    reference : callable
        The library's own function, or one made of its functions.
    same : callable
        (answer, right, tolerance) → whether they are equal as mathematics has it.
    concepts : tuple of str
        The rows of the list of concepts it practises.
    sources : tuple
        What `solution` shows: by default the reference.
    answer : {"function", "value", "steps"}
        What is handed over.
    assemble : callable or None
        Makes one function of several steps that are handed over together.
    choices : tuple of str
        What a choice is made from; the value is the number of the choice.
    parts : tuple of Exercise
        Exercises that the steps are tried on first, each by itself.
    personal : callable or None
        (student id) → this exercise with numbers of the student's own.
    """

    name: str
    chapter: int
    title: str
    task: str
    stub: str
    hints: tuple[str, ...]
    cases: Callable[[Rng], list[Case]]
    properties: tuple[Property, ...]
    misconceptions: tuple[Misconception, ...]
    reference: Callable[..., Any]
    same: Same = close
    concepts: tuple[str, ...] = ()
    sources: tuple[Any, ...] = ()
    answer: Literal["function", "value", "steps"] = "function"
    assemble: Callable[[Any], Callable[..., Any]] | None = None
    choices: tuple[str, ...] = ()
    parts: "tuple[Exercise, ...]" = ()
    personal: "Callable[[str], Exercise] | None" = None

    @property
    def arguments(self) -> tuple[str, ...]:
        """Names of the arguments, as the stub has them."""
        for node in ast.walk(ast.parse(self.stub)):
            if isinstance(node, ast.FunctionDef):
                return tuple(argument.arg for argument in node.args.args)
        return ()

    def number_of(self, answer: str) -> Any:
        """Give the number of a choice; what is no choice comes back as it is."""
        letter = answer.strip().upper()
        return self.choices.index(letter) if letter in self.choices else answer

    def inputs(self, seed: int) -> list[tuple[Any, ...]]:
        """Give the arguments of all cases, without anything that gives the answer away."""
        return [case.args for case in self.cases(np.random.default_rng(seed))]

    def solved_cases(self, seed: int) -> Iterator[Case]:
        """Give the same cases with one right answer each."""
        for case in self.cases(np.random.default_rng(seed)):
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                right = np.asarray(self.reference(*case.args), dtype=np.float64)
            yield replace(case, right=right)

    def __repr__(self) -> str:
        return f"{self.name}: {self.title}\n\n{self.task}\n\n{self.stub}"
