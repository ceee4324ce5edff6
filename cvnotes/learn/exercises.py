"""Exercises that answer: ``check``, ``hint``, ``solution`` and ``progress``.

What was solved and how many hints were given is remembered for as long as the notebook runs, and
nowhere else: nothing is written to a file, nothing is sent.
"""

import difflib
import importlib
import inspect
import textwrap
from collections import Counter
from dataclasses import dataclass, field, replace
from typing import Any

from cvnotes.base import CvnotesError
from cvnotes.learn.checker.agreement import NOTEBOOK_SEED, verdict
from cvnotes.learn.checker.exercise import Exercise
from cvnotes.learn.checker.report import Report, Source, Words
from cvnotes.learn.checker.sandbox import ask

CHAPTERS = range(1, 10)
# Asked for in the notebook of further exercises; all others in the notebook of their chapter.
FURTHER = (
    "line_through",
    "field_of_view",
    "nearest_rotation",
    "form_image",
    "knows_its_origin",
    "geometric_error",
    "radial_fit",
    "b_from_views",
    "bilinear",
    "rectifying_rotation",
    "how_far",
    "which_to_trust",
)
_SEED = NOTEBOOK_SEED


def _collect() -> dict[str, Exercise]:
    modules = (importlib.import_module(f"cvnotes.learn.ch{n:02d}") for n in CHAPTERS)
    return {exercise.name: exercise for module in modules for exercise in module.EXERCISES}


EXERCISES = _collect()


@dataclass
class _Session:
    """What one student did in one notebook."""

    solved: set[str] = field(default_factory=set)
    hints: Counter[str] = field(default_factory=Counter)


_SESSION = _Session()


def check(name: str, answer: Any, *, student: str | None = None) -> Report:
    """Try an answer, and say what holds, what does not, and why.

    Parameters
    ----------
    name : str
        Which exercise; `EXERCISES` lists them.
    answer : any
        The function you wrote, without brackets; for some exercises a number, a letter, or
        several functions by name.
    student : str, optional
        Your id, for exercises on `personal_camera`.

    Returns
    -------
    Report
        With ``passed``, ``misconception`` and ``message``. Whatever the function does, nothing
        but the report comes out.

    Raises
    ------
    CvnotesError
        There is no such exercise, or your id is missing.

    Examples
    --------
    >>> check("lift", lambda x, k: x).misconception
    >>> def my_lift(x, k): ...
    >>> check("lift", my_lift).verdict
    'not solved yet'
    """
    exercise = asked(name, student)
    report = verdict(exercise, {_SEED: ask(exercise, answer, _SEED)})
    if report.passed:
        _SESSION.solved.add(name)
    return replace(report, progress=_progress_in(notebook_of(exercise)))


def hint(name: str) -> Words:
    """Give a hint; the next one each time, and the last again.

    Examples
    --------
    >>> hint("lift")
    lift, hint 1 of 3
      For k = 1 the point (x, y) becomes (x, y, 1).
    """
    exercise = find(name)
    number = min(_SESSION.hints[name], len(exercise.hints) - 1)
    _SESSION.hints[name] += 1
    return Words(f"{name}, hint {number + 1} of {len(exercise.hints)}", (exercise.hints[number],))


def solution(name: str) -> Source:
    """Show one right answer: the library's own source.

    Examples
    --------
    >>> print(solution("drop").code.splitlines()[2])
    def from_homogeneous(x_h: Array) -> Array:
    """
    exercise = find(name)
    sources = [_function(source) for source in exercise.sources or (exercise.reference,)]
    code = "\n\n".join(textwrap.dedent(inspect.getsource(source)) for source in sources)
    places = sorted({source.__module__ for source in sources})
    return Source(f"{name}: one solution, from {' and '.join(places)}", code)


def progress() -> Words:
    """Tell how far you are, notebook by notebook.

    Examples
    --------
    >>> progress().title.split()[2:]
    ['48', 'exercises', 'solved']
    """
    lines = tuple(_progress_in(n) for n in sorted({*map(notebook_of, EXERCISES.values())}))
    return Words(f"{len(_SESSION.solved)} of {len(EXERCISES)} exercises solved", lines)


def find(name: str) -> Exercise:
    """Give an exercise by name.

    Raises
    ------
    CvnotesError
        There is no such exercise; the message names those that sound like it.
    """
    exercise = EXERCISES.get(name)
    if exercise is None:
        near = difflib.get_close_matches(str(name), EXERCISES, n=3, cutoff=0.3)
        meant = f"; did you mean {' or '.join(map(repr, near))}?" if near else ""
        raise CvnotesError(f"there is no exercise {name!r}{meant}")
    return exercise


def notebook_of(exercise: Exercise) -> int:
    """Give the number of the notebook that asks for an exercise.

    Examples
    --------
    >>> notebook_of(EXERCISES["dlt"]), notebook_of(EXERCISES["bilinear"])
    (6, 10)
    """
    return CHAPTERS.stop if exercise.name in FURTHER else exercise.chapter


def asked(name: str, student: str | None) -> Exercise:
    """Give an exercise as one student gets it: some have numbers of the student's own.

    Raises
    ------
    CvnotesError
        There is no such exercise, or it needs the student's id.
    """
    exercise = find(name)
    if exercise.personal is None:
        return exercise
    if student is None:
        raise CvnotesError(f'{name} has other numbers for each student: add student="your id"')
    return exercise.personal(student)


def _function(source: Any) -> Any:
    """Give the function behind a property."""
    return getattr(source, "fget", None) or getattr(source, "func", None) or source


def _progress_in(notebook: int) -> str:
    names = [e.name for e in EXERCISES.values() if notebook_of(e) == notebook]
    open_ = [name for name in names if name not in _SESSION.solved]
    left = f"; next: {open_[0]}" if open_ else ""
    title = f"Chapter {notebook}" if notebook in CHAPTERS else "Further exercises"
    return f"{title}: {len(names) - len(open_)} of {len(names)} solved{left}."
