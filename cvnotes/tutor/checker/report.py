"""The checker's answer as a value, in text and HTML; and the values of hint, solution, progress."""

import re
from dataclasses import dataclass, field
from html import escape
from typing import Any

from cvnotes.base.text import clipped
from cvnotes.tutor.checker.beside import STAR, beside
from cvnotes.tutor.checker.literals import as_code

RIGHT, OPEN, WRONG = "right", "not solved yet", "not yet right"
_ON_THIS, _PRINTED = "On this input:", "Your function printed:"
# Notebooks leave out the space around paragraphs, some of them.
_APART = 'style="margin:0.6em 0"'


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
        Name of the mistake that gives the same results, if one does; or else of the place in the
        code, or of the input, that it hangs on.
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
    located : str
        What is right so far in the student's own expressions, and the first step that is not, or
        what the mistake hangs on.
    exact : str
        The formula, for whoever was refused before.
    progress : str
        How far the student is in the chapter; nothing of an exercise that was not begun.
    call : str
        The call that gives this report again: what is too long to be shown is in it.
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
    located: str = ""
    exact: str = ""
    progress: str = ""
    call: str = "report"

    @property
    def passed(self) -> bool:
        """Whether the answer is right."""
        return self.verdict == RIGHT

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        mark = {RIGHT: "✓ ", WRONG: "✗ "}.get(self.verdict, "")
        lines = [f"{self.exercise}: {mark}{self.verdict}", f"  {self.message}"]
        lines += [f"  {text}" for text in self._pointers()]
        lines += [f"    {line}" for line in self.compared()]
        lines += [f"  ✓ holds: {sentence}" for sentence in self.holds]
        lines += [f"  ✗ does not hold: {self.fails}"] * bool(self.fails)
        example = "\n".join(self.example()).splitlines()
        lines += [f"  {_ON_THIS}"] * bool(example) + [f"    {line}" for line in example]
        lines += [f"  {remark}" for remark in self.remarks]
        lines += [f"  | {line}" for line in self.printed_lines()]
        return "\n".join([*lines, *[f"  {self.progress}"] * bool(self.progress)])

    def _repr_html_(self) -> str:
        mark = {RIGHT: "✓ ", WRONG: "✗ "}.get(self.verdict, "")
        items = [f"✓ holds: {sentence}" for sentence in self.holds]
        items += [f"✗ does not hold: {self.fails}"] * bool(self.fails)
        return (
            f"<div><strong>{escape(self.exercise)}: {mark}{self.verdict}.</strong> "
            f"{escape(self.message)}"
            + "".join(f"<p {_APART}>{escape(text)}</p>" for text in self._pointers())
            + marked(_block("", self.compared()))
            + _list(items, style="list-style:none;padding-left:1em;margin:0.6em 0")
            + _block(_ON_THIS, self.example())
            + _list(self.remarks)
            + _block(_PRINTED, self.printed_lines())
            + (f"<p>{escape(self.progress)}</p>" if self.progress else "")
            + "</div>"
        )

    def _pointers(self) -> list[str]:
        exact = f"It is {self.exact}." if self.exact else ""
        return [text for text in (self.located, exact) if text]

    def example(self) -> list[str]:
        """Return the counterexample as statements that can be copied."""
        return [
            f"{name} = {as_code(value, f'{self.call}.counterexample[{name!r}]')}"
            for name, value in self.counterexample.items()
        ]

    def compared(self) -> list[str]:
        """Return the lines of the wrong answer beside a right one, a star where they differ."""
        if self.yours is None or self.wanted is None:
            return []
        return beside(self.yours, self.wanted, self.call)

    def printed_lines(self) -> list[str]:
        """Return the first lines that the function printed."""
        lines = self.printed.splitlines()
        return [clipped(line, 100) for line in lines[:8]] + ["…"] * (len(lines) > 8)


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


def _block(title: str, lines: list[str]) -> str:
    """Write lines as they are, below a title if there is one; nothing without lines."""
    text = escape("\n".join(lines))
    head = f"<p {_APART}>{title}</p>" if title else ""
    return f"{head}<pre {_APART}>{text}</pre>" if lines else ""


def marked(html: str) -> str:
    """Mark the numbers with a star, which stays for whoever does not see the mark."""
    return re.sub(rf"{re.escape(STAR)}[\w.+-]+", r"<mark>\g<0></mark>", html)


def _list(items: Any, style: str = "") -> str:
    """Write items as a list; those with a mark of their own need no bullet."""
    rows = "".join(f"<li>{escape(x)}</li>" for x in items)
    return f'<ul style="{style}">{rows}</ul>' if items else ""
