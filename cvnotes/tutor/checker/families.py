"""Families of slips: all that may slip in the steps of an exercise, made from their own source."""

import ast
import copy
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache, partial
from itertools import combinations
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.equality import AS_NEAR, TOLERANCE, Same
from cvnotes.tutor.checker.foreseen import explains
from cvnotes.tutor.checker.steps import Line, lines_of
from cvnotes.tutor.checker.switches import KINDS, Slip, Switches
from cvnotes.tutor.checker.wrong_answer import Found, WrongAnswer

# From how many of the likeliest slips pairs are made.
_PAIRED = 24
# A family is not asked about answers with more numbers, nor grows larger.
_LARGEST, _MOST = 20_000, 700


@dataclass(frozen=True, eq=False)
class Family:
    """All slips of the steps of an exercise.

    Attributes
    ----------
    lines : tuple of Line
        The steps.
    slips : tuple of Slip
        The likely ones first.
    switches : Switches
        What the function asks, which of the slips it is to make.
    function : callable
        The steps, as the switches say.
    loops : bool
        Whether there is a loop in them.
    """

    lines: tuple[Line, ...]
    slips: tuple[Slip, ...]
    switches: Switches
    function: Callable[..., Any]
    loops: bool

    def gives(self, slip: Slip) -> Callable[..., Any]:
        """Return the steps with a slip in them."""
        return partial(self._run, slip)

    def _run(self, slip: Slip, *args: Any) -> Any:
        with self.switches.set_to(slip):
            try:
                return np.asarray(self.function(*args), dtype=np.float64)
            except Exception:  # whatever a slip leads to
                return None

    @cached_property
    def pairs(self) -> tuple[Slip, ...]:
        """Two slips of the likeliest kinds, at two places; none where loops take long."""
        if self.loops:
            return ()
        likely = [s for s in self.slips if len(s.setting) == 1 and s.kind != "stopped"]
        singles = likely[:_PAIRED]
        return tuple(
            Slip(a.kind, (*a.lines, *b.lines), (*a.setting, *b.setting))
            for a, b in combinations(singles, 2)
            if a.setting[0][0] != b.setting[0][0] and a.kind == b.kind
        )

    @property
    def everywhere(self) -> tuple[Slip, ...]:
        """Those that are made in several places alike."""
        return tuple(slip for slip in self.slips if slip.everywhere)

    def found(self, slip: Slip) -> Found:
        """Put a slip into a name, a sentence without the formula, and the formula."""
        words = " and in ".join(dict.fromkeys(self.lines[i].words for i in slip.lines))
        said = KINDS[slip.kind][0].format(words)
        said = f"{said[0].upper()}{said[1:]}"
        if slip.everywhere:
            said = f"{said[:-1]}, everywhere."
        exact = "; ".join(dict.fromkeys(self.lines[i].code for i in slip.lines))
        return Found(f"{slip.kind} in {words}", said, exact=exact)


def slipped_step(answer: WrongAnswer) -> Found | None:
    """Name the one slip in the steps, or two, that gives what the student's function gave."""
    exercise = answer.exercise
    case, outcome = answer.shown
    if exercise.steps is None or outcome.value is None or outcome.value.size > _LARGEST:
        return None
    family = family_of(exercise.steps)
    ways = {"slips": exercise.same, "pairs": exercise.same}
    if any(np.isnan(case.right).any() for case, _ in answer.tried):
        ways["everywhere"] = partial(_same_where_both_answer, exercise.same)
    for which, same in ways.items():
        for slip, given in _results(family, which, _Arguments(case.args)):
            if (
                given is not None
                and given.shape == outcome.value.shape
                and not np.isnan(given).all()
                and same(outcome.value, given, AS_NEAR * TOLERANCE)
                and explains(family.gives(slip), answer, same)
            ):
                return family.found(slip)
    return None


def _same_where_both_answer(same: Same, answer: Array, given: Array, tolerance: float) -> bool:
    """Return whether two answers are equal in all numbers that both have, and these are some.

    A slip that was made everywhere may, on another road than the steps', move where answers end.
    """
    both = np.isfinite(answer) & np.isfinite(given)
    return bool(both.any()) and same(answer[both], given[both], tolerance)


class _Arguments:
    """Arguments by their values, to find again what they gave."""

    def __init__(self, args: tuple[Any, ...]) -> None:
        self.args = args
        self.key = tuple(np.asarray(x).tobytes() for x in args)

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Arguments) and self.key == other.key


@lru_cache(maxsize=256)
def _results(family: Family, which: str, given: _Arguments) -> list[tuple[Slip, Array | None]]:
    """Return some slips of a family, each with what it gives."""
    slips: tuple[Slip, ...] = getattr(family, which)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return [(slip, family.gives(slip)(*copy.deepcopy(given.args))) for slip in slips]


@cache
def family_of(steps: Callable[..., Any]) -> Family:
    """Make the family of a function of steps, once.

    Examples
    --------
    >>> family = family_of(_example)
    >>> [family.gives(slip)(2.0).item() for slip in family.slips if slip.kind == "order"]
    [-2.0, -2.0]
    """
    function, lines = lines_of(steps)
    switches = Switches()
    made = switches.switched(function)
    space = {**steps.__globals__, **switches.names}
    exec(compile(ast.Module([made], []), "<family>", "exec"), space)
    loops = any(isinstance(node, ast.For) for node in ast.walk(function))
    slips = tuple(switches.slips[:_MOST])
    return Family(tuple(lines), slips, switches, space[function.name], loops)


def _example(x: float) -> float:
    y = x - 1  # one less
    return y + 2 * y - y
