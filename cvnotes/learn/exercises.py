"""Exercises that answer: ``check``, ``hint``, ``solution`` and ``progress``.

What was solved is remembered in a small file beside the notebook (see `cvnotes.tutor.remembered`),
how many hints were given for as long as the notebook runs. Nothing is sent.
"""

import importlib
from pathlib import Path
from typing import Any

from cvnotes.base.material import material
from cvnotes.tutor.checker.report import Report, Source, Words
from cvnotes.tutor.course import Course

CHAPTERS = tuple(sorted(p.name for p in Path(__file__).parent.glob("ch[0-9][0-9]")))
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


COURSE = Course(
    "cvnotes.learn.exercises:COURSE",
    (
        exercise
        for chapter in CHAPTERS
        for exercise in importlib.import_module(f"cvnotes.learn.{chapter}").EXERCISES
    ),
    further=FURTHER,
    faces=("cvnotes.learn", "cvnotes.learn.exercises"),
    notebooks=material("notebooks"),
    data=material("data"),
)
EXERCISES = COURSE.exercises


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
    return COURSE.add_exercises(path)


def check(name: str, answer: Any, *, student: str | int | None = None) -> Report:
    """Try an answer, and say what holds, what does not, and why.

    Parameters
    ----------
    name : str
        Which exercise; `EXERCISES` lists them.
    answer : any
        The function you wrote, without brackets; for some exercises a number, a letter, or
        several functions by name.
    student : str or int, optional
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
    return COURSE.check(name, answer, student=student)


def hint(name: str) -> Words:
    """Return a hint; the next one each time, and the last again.

    Examples
    --------
    >>> hint("lift")
    lift, hint 1 of 3
      For w = 1 the point (x, y) becomes (x, y, 1).
    """
    return COURSE.hint(name)


def solution(name: str) -> Source:
    """Show one right answer: the library's own source.

    Examples
    --------
    >>> print(solution("drop").code.splitlines()[2])
    def from_homogeneous(x_h: Array) -> Array:
    """
    return COURSE.solution(name)


def progress() -> Words:
    """Return how far you are, notebook by notebook, today and on the days before.

    Examples
    --------
    >>> progress().title.endswith(f" of {len(EXERCISES)} exercises solved")
    True
    """
    return COURSE.progress()
