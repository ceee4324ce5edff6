"""The checker's answer as a value, in text and HTML; and the values of hint, solution, progress."""

from dataclasses import dataclass, field
from html import escape
from typing import Any

import numpy as np

# Longer arrays are not printed; `Report.counterexample` holds them.
_LONGEST = 60

RIGHT, OPEN, WRONG = "right", "not solved yet", "not yet right"


@dataclass(frozen=True, eq=False)
class Report:
    """What a check found.

    Attributes
    ----------
    exercise : str
        Name of the exercise.
    verdict : str
        "right", "not solved yet" or "not yet right".
    message : str
        What to know or to do, in a sentence or two.
    misconception : str or None
        Name of the mistake that gives the same results, if one does.
    holds : tuple of str
        What is true of the answer.
    fails : str
        The first thing that is not.
    counterexample : dict
        The shortest input on which it fails, by argument: ``my_function(**counterexample)``.
    yours, wanted : ndarray or None
        What the student's function gave for it, and one right answer.
    remarks : tuple of str
        What else was seen.
    printed : str
        The beginning of what the function printed.
    progress : str
        How far the student is in the chapter.
    """

    exercise: str
    verdict: str
    message: str
    misconception: str | None = None
    holds: tuple[str, ...] = ()
    fails: str = ""
    counterexample: dict[str, Any] = field(default_factory=dict)
    yours: Any = None
    wanted: Any = None
    remarks: tuple[str, ...] = ()
    printed: str = ""
    progress: str = ""

    @property
    def passed(self) -> bool:
        """Whether the answer is right."""
        return self.verdict == RIGHT

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        mark = {RIGHT: "✓ ", WRONG: "✗ "}.get(self.verdict, "")
        lines = [f"{self.exercise}: {mark}{self.verdict}", f"  {self.message}"]
        lines += [f"  ✓ holds: {sentence}" for sentence in self.holds]
        lines += [f"  ✗ does not hold: {self.fails}"] * bool(self.fails)
        lines += [f"    {line}" for line in self.example()]
        lines += [f"  {remark}" for remark in self.remarks]
        lines += [f"  | {line}" for line in self.printed_lines()]
        return "\n".join([*lines, *[f"  {self.progress}"] * bool(self.progress)])

    def _repr_html_(self) -> str:
        mark = {RIGHT: "✓ ", WRONG: "✗ "}.get(self.verdict, "")
        items = [f"✓ holds: {sentence}" for sentence in self.holds]
        items += [f"✗ does not hold: {self.fails}"] * bool(self.fails)
        example = "\n".join(self.example())
        printed = "\n".join(self.printed_lines())
        return (
            f"<div><strong>{escape(self.exercise)}: {mark}{self.verdict}.</strong> "
            f"{escape(self.message)}"
            + _list(items)
            + (f"<pre>{escape(example)}</pre>" if example else "")
            + _list(self.remarks)
            + (f"<p>Your function printed:</p><pre>{escape(printed)}</pre>" if printed else "")
            + (f"<p>{escape(self.progress)}</p>" if self.progress else "")
            + "</div>"
        )

    def example(self) -> list[str]:
        """Give the counterexample as lines of code that can be copied."""
        lines = [
            f"{name} = {as_code(value, f'report.counterexample[{name!r}]')}"
            for name, value in self.counterexample.items()
        ]
        if self.yours is not None:
            lines.append(f"yours = {as_code(_short(self.yours), 'report.yours')}")
        if self.wanted is not None:
            lines.append(f"wanted = {as_code(_short(self.wanted), 'report.wanted')}")
        return lines

    def printed_lines(self) -> list[str]:
        """Give the first lines that the function printed."""
        lines = self.printed.splitlines()
        return [line[:100] for line in lines[:8]] + ["…"] * (len(lines) > 8)


def as_code(value: Any, name: str = "") -> str:
    """Write a value as code that makes it again; long arrays only by their name.

    Examples
    --------
    >>> as_code(np.array([[1.0, 0.25]]))
    'np.array([[1.0, 0.25]])'
    """
    if not isinstance(value, np.ndarray):
        return repr(value)
    if value.ndim == 0:
        return repr(value.item())
    if value.size > _LONGEST:
        return f"{name}  # {value.shape}"
    text = repr((value + 0.0).tolist())
    return f"np.array({text.replace('nan', 'np.nan').replace('inf', 'np.inf')})"


def _short(x: Any) -> Any:
    """Leave six significant digits: results are to be read, inputs to be copied."""
    return np.array([float(f"{value:.6g}") for value in np.ravel(x)]).reshape(np.shape(x))


@dataclass(frozen=True)
class Words:
    """A few lines of text for the page: a hint, or how far one is."""

    title: str
    lines: tuple[str, ...]

    def __repr__(self) -> str:
        return "\n".join([self.title, *(f"  {line}" for line in self.lines)])

    def _repr_html_(self) -> str:
        return f"<div><strong>{escape(self.title)}</strong>{_list(self.lines)}</div>"


@dataclass(frozen=True)
class Source:
    """The source of a solution."""

    title: str
    code: str

    def __repr__(self) -> str:
        return f"{self.title}\n\n{self.code}"

    def _repr_html_(self) -> str:
        return f"<div><strong>{escape(self.title)}</strong><pre>{escape(self.code)}</pre></div>"


def _list(items: Any) -> str:
    return "<ul>" + "".join(f"<li>{escape(x)}</li>" for x in items) + "</ul>" if items else ""
