"""Guess before you look: what is written down at the start of a chapter is shown at its end."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from math import hypot, isfinite
from numbers import Real
from typing import Any

from cvnotes.base import CvnotesError
from cvnotes.tutor.remembered import guessed_before, remember_guess

_kept: dict[str, Any] = {}  # of this kernel, where nothing is remembered on disk


@dataclass(frozen=True)
class Said:
    """A sentence that a notebook shows."""

    sentence: str

    def __repr__(self) -> str:
        return self.sentence

    def _repr_html_(self) -> str:
        return f"<p><em>{escape(self.sentence)}</em></p>"


def guess(name: str, value: Any = ..., question: str = "") -> Said:
    """Keep a guess, to be shown beside the answer at the end of the chapter.

    Parameters
    ----------
    name : str
        What the guess is called; :func:`answer` asks for it by this name.
    value : number, str or sequence of numbers
        The guess; the dots ``...`` that stand there at first are none.
    question : str
        What is asked, repeated as long as nothing is guessed.

    Returns
    -------
    Said
        A sentence. The guess outlives the kernel where progress does (`cvnotes.tutor.remembered`).

    Raises
    ------
    CvnotesError
        If the guess is neither a number, nor a word, nor a few numbers.

    Examples
    --------
    >>> guess("rails", ..., "the column where the rails meet, in px")
    Your guess? Write the column where the rails meet, in px, in place of the dots.
    >>> guess("rails", 300)
    Kept: 300. The answer comes at the end of the chapter.
    """
    if value is ...:
        known = guessed_before() | _kept
        if name in known:
            return Said(f"You guessed {_spelt(known[name])} before. The answer comes at the end.")
        return Said(f"Your guess? Write {question or 'it'}, in place of the dots.")
    _kept[name] = _plain(value)
    remember_guess(name, _kept[name])
    return Said(f"Kept: {_spelt(_kept[name])}. The answer comes at the end of the chapter.")


def answer(name: str, truth: Any, unit: str = "") -> Said:
    """Show the answer, beside what was guessed at the start of the chapter.

    Parameters
    ----------
    name : str
        What the guess was called.
    truth : number, str or sequence of numbers
        The answer, rounded as it shall be read.
    unit : str
        Its unit.

    Examples
    --------
    >>> _ = guess("meeting", 300)
    >>> answer("meeting", 320, "px")
    You guessed 300 px; it is 320 px. Off by 20 px.
    >>> answer("poles", "the third")
    It is the third. (You had not guessed.)
    """
    known = guessed_before() | _kept
    spelt = f"{_spelt(_plain(truth))} {unit}".strip()
    if name not in known:
        return Said(f"It is {spelt}. (You had not guessed.)")
    mine = f"{_spelt(known[name])} {unit}".strip()
    return Said(f"You guessed {mine}; it is {spelt}. {_verdict(known[name], truth, unit)}")


def _verdict(mine: Any, truth: Any, unit: str) -> str:
    if isinstance(truth, str) or isinstance(mine, str):
        same = str(mine).strip().casefold() == str(truth).strip().casefold()
        return "Right." if same else "Now you know."
    mine, truth = _numbers(mine), _numbers(truth)
    if len(mine) != len(truth):
        return "Now you know."
    off = hypot(*(a - b for a, b in zip(mine, truth, strict=True)))
    return f"Off by {off:.3g} {unit}".strip() + "." if off else "Exactly."


def _numbers(value: Any) -> list[float]:
    return [float(x) for x in (value if isinstance(value, Sequence) else [value])]


def _plain(value: Any) -> Any:
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, str) and len(value) <= 200:
        return value
    few = list(value) if isinstance(value, tuple | list) else [value]
    if 0 < len(few) <= 20 and all(isinstance(x, Real) and isfinite(x) for x in few):
        return few if isinstance(value, tuple | list) else value
    raise CvnotesError(
        "guess: expected a number, a word, or a few numbers in brackets, "
        f"got {type(value).__name__}; write it in place of the dots, as in 300 or (320, 240)"
    )


def _spelt(value: Any) -> str:
    if isinstance(value, list):
        return "(" + ", ".join(_spelt(x) for x in value) + ")"
    return value if isinstance(value, str) else f"{value:.6g}"
