"""The tutor without a camera: another course checks and marks with it."""

import json

import pytest

from cvnotes.base import CvnotesError
from cvnotes.tutor import Case, Course, Exercise, Misconception, Property
from cvnotes.tutor.grader.grading import grade_folder
from cvnotes.tutor.grader.tables import marks_csv

MEDIAN = Exercise(
    name="middle",
    chapter=1,
    title="The number in the middle",
    task="Return the median of x (n,), n odd.",
    stub="def my_middle(x):\n    ...",
    hints=("Sort first.", "Then take the one in the middle."),
    cases=lambda rng: [Case((rng.exponential(9.0, n).round(1),)) for n in (3, 5, 9)],
    properties=(Property("as many numbers are below as above"),),
    misconceptions=(Misconception("mean", "That is the mean.", lambda x: x.mean()),),
    reference=lambda x: sorted(x)[len(x) // 2],
)
COURSE = Course("test_tutor:COURSE", [MEDIAN])
check = COURSE.check

RIGHT = "def my_middle(x):\n    return np.median(x)"
MEAN = "def my_middle(x):\n    return np.mean(x)"


def handed_in(folder, answer):
    cells = [
        "import numpy as np\nfrom test_tutor import check",
        answer,
        "check('middle', my_middle)",
    ]
    folder.mkdir()
    cells = [{"cell_type": "code", "source": c, "outputs": [], "metadata": {}} for c in cells]
    (folder / "01.ipynb").write_text(json.dumps({"cells": cells, "metadata": {}, "nbformat": 4}))


def test_answers_to_another_course_are_judged_with_its_words():
    assert COURSE.check("middle", lambda x: sorted(x)[len(x) // 2])
    report = COURSE.check("middle", lambda x: sum(x) / len(x))
    assert (report.passed, report.misconception) == (False, "mean")
    assert COURSE.hint("middle").lines == ("Sort first.",)
    assert "1 of 1" in COURSE.progress().title
    assert "sorted(x)" in COURSE.solution("middle").code
    with pytest.raises(CvnotesError, match="did you mean 'middle'"):
        COURSE.check("midle", None)


def test_a_class_of_another_course_is_marked(tmp_path):
    handed_in(tmp_path / "ada", RIGHT)
    handed_in(tmp_path / "bob", MEAN)
    handed, marks = grade_folder(tmp_path, COURSE)
    ada, bob = sorted(marks, key=lambda mark: mark.student)
    assert (len(handed), ada.points, bob.points) == (2, 1, 0)
    assert (ada.expected, bob.misconceptions) == (("middle",), {"middle": "mean"})
    assert "bob,01.ipynb,0,1,0,0,middle: mean,," in marks_csv([ada, bob], COURSE)


def test_a_course_that_its_processes_would_not_find_is_refused(tmp_path):
    with pytest.raises(CvnotesError, match="test_tutor:COURSE is another course"):
        grade_folder(tmp_path, Course("test_tutor:COURSE", [MEDIAN]))
    with pytest.raises(CvnotesError, match="expected the home of a Course"):
        grade_folder(tmp_path, Course("test_tutor:MEDIAN", [MEDIAN]))
