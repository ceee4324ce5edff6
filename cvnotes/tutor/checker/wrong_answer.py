"""A wrong answer, as those look at it who say what went wrong: what was tried, what came of it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from cvnotes.tutor.checker.exercise import Case, Exercise
from cvnotes.tutor.checker.outcome import Outcome

Tried = tuple[Case, Outcome]


@dataclass(frozen=True, eq=False)
class WrongAnswer:
    """What a student's function gave, where that is not right.

    Attributes
    ----------
    exercise : Exercise
        What was asked.
    tried : tuple of (Case, Outcome)
        All cases, with what came of them: first the one that the student sees, then the others on
        which the answer is wrong, the shortest first, then the rest.
    wrong : int
        On how many of them the answer is wrong.
    why : str
        What is said of an answer that cannot be compared; empty if it can.
    """

    exercise: Exercise
    tried: tuple[Tried, ...]
    wrong: int
    why: str = ""

    @property
    def failing(self) -> tuple[Tried, ...]:
        """The cases on which the answer is wrong, with what came of them."""
        return self.tried[: self.wrong]

    @property
    def shown(self) -> Tried:
        """The case that the student sees."""
        return self.tried[0]

    @property
    def on_usual_inputs(self) -> "WrongAnswer":
        """The same without special cases, and without those that gave no numbers."""
        usual = [not case.about and outcome.value is not None for case, outcome in self.tried]
        tried = tuple(one for one, is_usual in zip(self.tried, usual, strict=True) if is_usual)
        return WrongAnswer(self.exercise, tried, sum(usual[: self.wrong]), self.why)

    def found_by(self, seek: "Callable[[WrongAnswer], Found | None]") -> "Found | None":
        """Return what is found in all cases, or else in all usual ones, two of them wrong at least.

        Whoever made another slip with what is special, a point at infinity or the last row, has
        made this one too.
        """
        found, usual = seek(self), self.on_usual_inputs
        if found is None and usual.wrong > 1 and len(usual.tried) < len(self.tried):
            found = seek(usual)
        return found


class Found(NamedTuple):
    """A mistake that was recognised: its name, a sentence that helps, and whether that is all.

    A sentence of the exercise's own says `enough`; to the others belong a hint and remarks. What
    is `exact`, the formula, is for whoever was refused before.
    """

    name: str
    sentence: str
    enough: bool = False
    exact: str = ""
