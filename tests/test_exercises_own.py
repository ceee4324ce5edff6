"""A teacher's own exercises: made from the page that explains them, tried, asked and graded."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from cvnotes.base import CvnotesError
from cvnotes.commands.cli import main
from cvnotes.learn import EXERCISES, add_exercises, check, hint, progress, solution
from cvnotes.learn.exercises import COURSE
from cvnotes.tutor.checker.soundness import faults
from cvnotes.tutor.course import Session

pytestmark = pytest.mark.once

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "docs" / "exercises.md").read_text(encoding="utf-8")
CODE = re.search(r"```python\n(.*?)```", PAGE, re.S)[1]
RIGHT = (
    "def my_distance(line, p):\n"
    "    return abs(line[0] * p[0] + line[1] * p[1] + line[2]) / (line[:2] @ line[:2]) ** 0.5\n"
)


@pytest.fixture
def own(tmp_path, monkeypatch, course_again):  # noqa: ARG001
    """Give the file of the page."""
    monkeypatch.setattr(COURSE, "session", Session())
    path = tmp_path / "my_exercises.py"
    path.write_text(CODE, encoding="utf-8")
    return path


def _right():
    names = {}
    exec(RIGHT, names)
    return names["my_distance"]


def test_the_page_explains_an_exercise_that_is_sound(own):
    done = subprocess.run(
        [sys.executable, "-m", "cvnotes.learn.try", "distance", "--with", str(own)],
        capture_output=True, text=True, timeout=60, cwd=ROOT, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "distance: sound, 2 mistakes known by name\n"


def test_it_is_asked_in_a_notebook_like_any_other(own):
    assert add_exercises(own) == ("distance",)
    assert add_exercises(own) == ("distance",)  # a cell that is run again
    assert check("distance", _right()).passed
    assert check("distance", lambda line, p: abs(line[:2] @ p + line[2])).misconception
    assert hint("distance").lines[-1] == "The normal of the line is (a, b)."
    assert "def distance(line, p):" in solution("distance").code
    assert progress().lines[-1] == "Added exercises: 1 of 1 solved."
    assert progress().title == f"1 of {len(EXERCISES)} exercises solved"


def test_what_is_wrong_with_a_file_is_said_in_a_sentence(own):
    for text, words in (
        ("EXERCISES = ()", "with one at least"),
        ("x = 1 /", "SyntaxError"),
        ("x = 1", "has no attribute 'EXERCISES'"),
        (CODE.replace('name="distance"', 'name="dlt"'), "there is an exercise 'dlt' already"),
    ):
        own.write_text(text, encoding="utf-8")
        with pytest.raises(CvnotesError, match=words):
            add_exercises(own)
    assert "distance" not in EXERCISES


def test_an_unsound_exercise_is_found_out(own):
    bent = CODE.replace("np.linalg.norm(line[:2] / line[2] - p)", "distance(line, p)")
    own.write_text(bent, encoding="utf-8")
    add_exercises(own)
    [said] = faults(EXERCISES["distance"])
    assert said.startswith("the mistake 'a point for a line' passes for seed 2024: a case is miss")


def test_it_is_graded_with_the_class(own, tmp_path):
    cells = [
        "from cvnotes.learn import add_exercises, check\nadd_exercises('my_exercises.py')",
        RIGHT,
    ]
    cells.append("check('distance', my_distance)")
    notebook = {"cells": [{"cell_type": "code", "source": cell} for cell in cells]}
    (tmp_path / "in" / "ada").mkdir(parents=True)
    (tmp_path / "in" / "ada" / "homework.ipynb").write_text(json.dumps(notebook))
    out = tmp_path / "marks.csv"
    assert main(["grade", str(tmp_path / "in"), "--out", str(out), "--with", str(own)]) == 0
    header, row = out.read_text(encoding="utf-8-sig").splitlines()[:2]
    separator = ";" if ";" in header else ","
    marks = dict(zip(header.split(separator), row.split(separator), strict=True))
    assert (marks["student"], marks["distance"]) == ("ada", "1")


def test_how_many_exercises_there_are_is_counted_and_never_typed():
    pages = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("*.md"))]
    for path in pages:
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"\b\d+\s+(exercises|misconceptions)\b", text), path.name
