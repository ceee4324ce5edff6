r"""A tutor for any course: answers are tried safely, judged and explained; classes are marked.

It knows nothing of cameras: the exercises are handed to it. A course of your own is a module with

>>> import numpy as np
>>> DOUBLE = Exercise(
...     name="double", chapter=1, title="Twice a vector", task="v (n,) → 2 v (n,).",
...     stub="def my_double(v):\n    ...", hints=("Add v to itself.",),
...     cases=lambda rng: [Case((rng.normal(size=3).round(1),)) for _ in range(4)],
...     properties=(Property("each number is doubled"),),
...     misconceptions=mistakes(("squared", "That is v².", lambda v: v * v)),
...     reference=lambda v: 2 * v,
... )
>>> COURSE = Course("my_course:COURSE", [DOUBLE])
>>> check, hint, solution, progress = COURSE.check, COURSE.hint, COURSE.solution, COURSE.progress

from which its notebooks import ``check``. `cvnotes.tutor.grader.grading.grade_folder` marks what is
handed in; its processes import the course by the name that it was given, here ``my_course``.

>>> check("double", lambda v: v**2).misconception
'squared'
"""

from cvnotes.tutor.checker.exercise import Case, Exercise, Misconception, Property, mistakes
from cvnotes.tutor.checker.report import Report
from cvnotes.tutor.checker.steps import edited, mistakes_in
from cvnotes.tutor.course import Course

__all__ = [
    "Course",
    "Exercise",
    "Case",
    "Property",
    "Misconception",
    "mistakes",
    "mistakes_in",
    "edited",
    "Report",
]
