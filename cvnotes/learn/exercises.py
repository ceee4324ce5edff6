"""Exercises that answer: ``check``, ``hint``, ``solution`` and ``progress``.

What was solved is remembered in a small file beside the notebook (see `cvnotes.learn.remembered`),
how many hints were given for as long as the notebook runs. Nothing is sent.
"""

import difflib
import importlib
import importlib.util
import inspect
import re
import sys
import textwrap
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cvnotes.base import CvnotesError, FileError
from cvnotes.learn.checker.agreement import NOTEBOOK_SEED, verdict
from cvnotes.learn.checker.exercise import Exercise
from cvnotes.learn.checker.report import Report, Source, Words
from cvnotes.learn.checker.sandbox import ask
from cvnotes.learn.remembered import remember, shell, solved_before

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
    "focal_from_turn",
    "camera_covariance",
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
# Exercises that a teacher has added, by name, with the file that they come from.
_ADDED: dict[str, Path] = {}


def add_exercises(path: str | Path) -> tuple[str, ...]:
    """Add a teacher's own exercises to those of the course.

    Parameters
    ----------
    path : str or Path
        A Python file that has a tuple ``EXERCISES``; ``docs/exercises.md`` explains how to make
        one. A file that is added again replaces what came from it before.

    Returns
    -------
    tuple of str
        Their names: `check`, `hint`, `solution` and `progress` know them from now on.

    Raises
    ------
    CvnotesError
        The file cannot be read or run, has no exercises, or takes a name of the course.

    Examples
    --------
    >>> add_exercises("not_there.py")
    Traceback (most recent call last):
    cvnotes.base.errors.FileError: not_there.py: there is no such file with exercises
    """
    path = Path(path).expanduser()
    before = tuple(name for name, origin in _ADDED.items() if origin.name == path.name)
    if not path.is_file():
        if before:  # a grader has added them already, from where the teacher keeps them
            return before
        raise FileError(f"{path}: there is no such file with exercises")
    new = exercises_in(path)
    for exercise in new:
        if exercise.name in EXERCISES and exercise.name not in before:
            raise CvnotesError(f"{path.name}: there is an exercise {exercise.name!r} already")
    for name in before:
        del EXERCISES[name], _ADDED[name]
    EXERCISES.update((exercise.name, exercise) for exercise in new)
    _ADDED.update((exercise.name, path.resolve()) for exercise in new)
    return tuple(exercise.name for exercise in new)


def added_files() -> tuple[Path, ...]:
    """Give the files that exercises were added from."""
    return tuple(dict.fromkeys(_ADDED.values()))


def exercises_in(path: Path) -> tuple[Exercise, ...]:
    """Run a file and give its ``EXERCISES``."""
    name = f"own_{re.sub(r'[^0-9a-zA-Z_]', '_', path.stem)}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise CvnotesError(f"{path.name}: exercises are in a Python file, my_exercises.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # where inspect finds the source of a solution
    try:
        spec.loader.exec_module(module)
        found = tuple(module.EXERCISES)
    except Exception as error:
        raise CvnotesError(f"{path.name}: {type(error).__name__}: {error}") from None
    if not found or not all(isinstance(exercise, Exercise) for exercise in found):
        raise CvnotesError(f"{path.name}: EXERCISES is a tuple of Exercise(…), with one at least")
    return found


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
    >>> check("lift", lambda x, w: x).misconception
    'columns too few'
    >>> def my_lift(x, w): ...
    >>> check("lift", my_lift).verdict
    'not solved yet'
    """
    exercise = asked(name, student)
    report = verdict(exercise, {_SEED: ask(exercise, answer, _SEED)})
    if report.passed:
        _SESSION.solved.add(name)
        remember(_SESSION.solved)
    _offer_what_reports_name()
    call = f'check("{name}", {_name_of(answer) or exercise.variable})'
    return replace(report, call=call, progress=_progress_in(notebook_of(exercise)))


def _name_of(answer: Any) -> str:
    """Give the name of a function, if it has one that can be written."""
    name = getattr(answer, "__name__", "")
    return name if isinstance(name, str) and name.isidentifier() else ""


def _offer_what_reports_name() -> None:
    """Let hint, solution and progress be at hand in the notebook, where nothing else is called so.

    Reports name them; a notebook that imported check alone would not know them.
    """
    if (running := shell()) is not None:
        for function in (hint, solution, progress):
            running.user_ns.setdefault(function.__name__, function)


def hint(name: str) -> Words:
    """Give a hint; the next one each time, and the last again.

    Examples
    --------
    >>> hint("lift")
    lift, hint 1 of 3
      For w = 1 the point (x, y) becomes (x, y, 1).
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
    """Tell how far you are, notebook by notebook, today and on the days before.

    Examples
    --------
    >>> progress().title.endswith(f" of {len(EXERCISES)} exercises solved")
    True
    """
    lines = tuple(_progress_in(n) for n in sorted({*map(notebook_of, EXERCISES.values())}))
    solved = _solved() & set(EXERCISES)
    return Words(f"{len(solved)} of {len(EXERCISES)} exercises solved", lines)


def _solved() -> set[str]:
    """Give what was solved here, and in other notebooks and on other days."""
    return _SESSION.solved | set(solved_before())


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
    if exercise.name in _ADDED:
        return CHAPTERS.stop + 1
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
    solved = _solved()
    open_ = [name for name in names if name not in solved]
    left = f"; next: {open_[0]}" if open_ else ""
    title = {CHAPTERS.stop: "Further exercises", CHAPTERS.stop + 1: "Added exercises"}.get(
        notebook, f"Chapter {notebook}"
    )
    return f"{title}: {len(names) - len(open_)} of {len(names)} solved{left}."
