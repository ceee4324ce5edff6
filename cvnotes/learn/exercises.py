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

# What each chapter asks for, in this order: the modules of its folder.
CHAPTERS = {
    "ch00": "bend",
    "ch01": "lift drop line_through meet same_points measure_along",
    "ch02": "vanishing_point focal_from_vanishing_points horizon where_the_rails_meet "
    "person_height",
    "ch03": "intrinsics_from_sensor project camera_centre cam1_from_cam2 new_intrinsics "
    "field_of_view rq",
    "ch04": "distort undistort fold_radius form_image corner_shift inverse_radius",
    "ch05": "board_points harris_measure saddle_point first_corner",
    "ch06": "design_matrix normaliser dlt four_points geometric_error ransac",
    "ch07": "v_ij nearest_rotation b_from_views a_from_b extrinsics radial_fit bad_views "
    "focal_from_turn camera_covariance levenberg_marquardt",
    "ch08": "bilinear backward_warp count_holes undistortion_map",
    "ch09": "residuals which_to_trust own_camera pipeline",
    "ch10": "depth between_rays rectifying_rotation how_far",
    "ch11": "error_bars jackknife",
}
# Asked for in the notebook of further exercises; all others in the notebook of their chapter.
FURTHER = (
    "line_through field_of_view form_image geometric_error nearest_rotation b_from_views "
    "radial_fit focal_from_turn camera_covariance bilinear which_to_trust pipeline how_far "
    "rectifying_rotation"
)


COURSE = Course(
    "cvnotes.learn.exercises:COURSE",
    (
        importlib.import_module(f"cvnotes.learn.{chapter}.{name}").EXERCISE
        for chapter, names in CHAPTERS.items()
        for name in names.split()
    ),
    further=FURTHER.split(),
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
