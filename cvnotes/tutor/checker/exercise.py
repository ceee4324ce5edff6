"""What an exercise is made of: cases, properties, misconceptions; and when answers are equal."""

import ast
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from inspect import signature
from typing import Any, Literal

import numpy as np

# By a name of our own: a notebook may put something else in its place.
from numpy.random import default_rng

from cvnotes.base import Array
from cvnotes.tutor.checker.equality import Same, close
from cvnotes.tutor.checker.parsing import parsed

Rng = np.random.Generator


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
    slack : float
        How many times wider bounds are for this answer: 1, and more in single precision.
    """

    args: tuple[Any, ...]
    truth: Any = None
    about: str = ""
    right: Array = field(default_factory=lambda: np.zeros(0))
    slack: float = 1.0

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
        (answer, case) → bool; None compares with the right answer of the case. It is asked only
        about answers of the right shape that are finite where the right one is, and its bounds
        take the factor ``case.slack``.
    about : str
        Which cases it looks at.
    """

    sentence: str
    holds: Callable[[Array, Case], bool] | None = None
    about: str = ""


@dataclass(frozen=True, eq=False)
class Misconception:
    """A classic mistake: its name, a sentence that helps, and what it gives.

    `gives` takes what the student's function takes; None where the mistake gives no numbers:
    an exception, NaN or infinity, as it happens. `variants` make the same mistake on other ways.
    `same` tells when two results of it are equal, if that is not what the exercise calls equal.
    `seen`, (answer, case) → bool, recognises a mistake with many results by what all of them have
    in common, and right answers have not; it is asked about each wrong answer.
    """

    name: str
    sentence: str
    gives: Callable[..., Any]
    variants: tuple[Callable[..., Any], ...] = ()
    same: Same | None = None
    seen: Callable[[Array, Case], bool] | None = None


def mistakes(*rows: tuple[Any, ...]) -> tuple[Misconception, ...]:
    """Make misconceptions of rows: name, sentence, and one or more functions that make the mistake.

    A dictionary at the end of a row says how it is recognised, if not by being equal: ``same``, or
    ``seen``, as `Misconception` has them.

    Examples
    --------
    >>> [squared] = mistakes(("squared", "That is x².", lambda x: x * x, lambda x: x**2))
    >>> squared.name, len(squared.variants)
    ('squared', 1)
    >>> mistakes(("far", "Far off.", lambda x: 9 * x, {"seen": lambda y, _: y > 5}))[0].variants
    ()
    """
    return tuple(_of_a_row(*row) for row in rows)


def _of_a_row(name: str, sentence: str, *ways: Any) -> Misconception:
    recognised = ways[-1] if isinstance(ways[-1], dict) else {}
    gives, *variants = (way for way in ways if way is not recognised)
    return Misconception(name, sentence, gives, tuple(variants), **recognised)


def _as_the_steps_say(*_: Any) -> Any:
    """Stand for the steps of an exercise that has no other reference."""


@dataclass(frozen=True, eq=False)
class Exercise:
    """An exercise: what is asked, how an answer is tried, and what goes wrong typically.

    Attributes
    ----------
    name, chapter, title, task
        What the student sees.
    hints : tuple of str
        One more each time.
    cases : callable
        (rng) → list of `Case`, the shortest to read first.
    properties, misconceptions : tuple
        What must be true, and what is typically wrong.
    reference : callable
        A right answer: the steps, if it is no other.
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
    refusal : str
        Why no answer counts, if none does.
    steps : callable or None
        The way to the answer in about six lines, as a student might write it, with a comment on
        each that says in words what it is; see `cvnotes.tutor.checker.steps`.
    stub : str
        The source of a function that does nothing yet; by default with the arguments of the steps
        and the first line of their docstring.
    """

    name: str
    chapter: int
    title: str
    task: str
    hints: tuple[str, ...]
    cases: Callable[[Rng], list[Case]]
    properties: tuple[Property, ...]
    misconceptions: tuple[Misconception, ...] = ()
    reference: Callable[..., Any] = _as_the_steps_say
    same: Same = close
    concepts: tuple[str, ...] = ()
    sources: tuple[Any, ...] = ()
    answer: Literal["function", "value", "steps"] = "function"
    assemble: Callable[[Any], Callable[..., Any]] | None = None
    choices: tuple[str, ...] = ()
    parts: "tuple[Exercise, ...]" = ()
    personal: "Callable[[str], Exercise] | None" = None
    refusal: str = ""
    steps: Callable[..., Any] | None = None
    stub: str = ""

    def __post_init__(self) -> None:
        way = self.steps or self.reference
        if self.reference is _as_the_steps_say:
            object.__setattr__(self, "reference", way)
        if not self.stub:
            said, _, _ = (way.__doc__ or "").partition("\n")
            first = f"def my_{self.name}({', '.join(signature(way).parameters)}):"
            object.__setattr__(self, "stub", f'{first}\n    """{said}"""\n    ...')

    @cached_property
    def variable(self) -> str:
        """What the stub calls the answer: ``my_drop``."""
        for node in ast.walk(parsed(self.stub)):
            if isinstance(node, ast.FunctionDef):
                return node.name
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                return node.targets[0].id
        return f"my_{self.name}"

    @cached_property
    def arguments(self) -> tuple[str, ...]:
        """Names of the arguments, as the stub has them."""
        for node in ast.walk(parsed(self.stub)):
            if isinstance(node, ast.FunctionDef):
                return tuple(argument.arg for argument in node.args.args)
        return ()

    def number_of(self, answer: Any) -> Any:
        """Return the number of a choice; what is no choice comes back, in words, as it is."""
        if not self.choices or answer is None or answer is ...:
            return answer
        letter = str(answer).strip().upper()
        return self.choices.index(letter) if letter in self.choices else str(answer)

    def inputs(self, seed: int) -> list[tuple[Any, ...]]:
        """Return the arguments of all cases, without anything that gives the answer away."""
        return [case.args for case in self.cases(default_rng(seed))]

    def solved_cases(self, seed: int) -> Iterator[Case]:
        """Return the same cases with one right answer each."""
        for case in self.cases(default_rng(seed)):
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                right = np.asarray(self.reference(*case.args), dtype=np.float64)
            yield replace(case, right=right)

    def __repr__(self) -> str:
        return f"{self.name}: {self.title}\n\n{self.task}\n\n{self.stub}"
