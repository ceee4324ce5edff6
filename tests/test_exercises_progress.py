"""What was solved is remembered over kernels and days, beside the notebook and nowhere else."""

# Functions that give a wrong answer need none of their arguments.
# ruff: noqa: ARG001

import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from cvnotes.base import CvnotesError
from cvnotes.learn import EXERCISES, check, exercises, personal_camera, progress
from cvnotes.learn.exercises import COURSE
from cvnotes.tutor import course
from cvnotes.tutor.course import Session
from cvnotes.tutor.remembered import FILE, VARIABLE, place, remember, solved_before

LIFT = EXERCISES["lift"].reference
DROP = EXERCISES["drop"].reference


@pytest.fixture
def file(tmp_path, monkeypatch):
    path = tmp_path / FILE
    monkeypatch.setenv(VARIABLE, str(path))
    new_kernel(monkeypatch)
    return path


def new_kernel(monkeypatch):
    monkeypatch.setattr(COURSE, "session", Session())


def test_the_next_kernel_knows_what_was_solved(file, monkeypatch):
    check("lift", LIFT)
    new_kernel(monkeypatch)
    assert progress().title == f"1 of {len(EXERCISES)} exercises solved"
    assert check("drop", lambda x_h: x_h).progress == "Chapter 1: 1 of 5 solved; next: drop."
    assert list(json.loads(file.read_text())["solved"]) == ["lift"]


def test_two_notebooks_do_not_overwrite_each_other(file, monkeypatch):
    check("lift", LIFT)
    first = COURSE.session
    new_kernel(monkeypatch)
    check("drop", DROP)
    monkeypatch.setattr(COURSE, "session", first)
    check("lift", LIFT)
    assert sorted(solved_before()) == ["drop", "lift"]
    assert [p.name for p in file.parent.iterdir()] == [FILE]


def test_the_first_day_stays(file):
    file.write_text('{"solved": {"lift": "2020-01-31"}}')
    remember({"lift", "drop"})
    assert solved_before()["lift"] == "2020-01-31"
    assert solved_before()["drop"] > "2020-01-31"


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "null", '{"solved": 3}', '{"solved": ["lift"]}', "\x00", "[" * 50_000]
)
def test_a_broken_file_is_no_trouble(file, text):
    file.write_text(text)
    assert progress().title.startswith("0 of")
    assert check("lift", LIFT).passed
    assert list(solved_before()) == ["lift"]


def test_what_is_not_an_exercise_any_more_does_not_count(file):
    file.write_text('{"solved": {"lift": "2020-01-31", "gone": "2020-01-31"}}')
    assert progress().title.startswith("1 of")


def test_a_place_that_cannot_be_written_is_no_trouble(tmp_path, monkeypatch):
    new_kernel(monkeypatch)
    (tmp_path / "no_folder").write_text("")
    monkeypatch.setenv(VARIABLE, str(tmp_path / "no_folder" / FILE))
    assert check("lift", LIFT).passed
    assert progress().title.startswith("1 of")


def test_scripts_and_whoever_wants_none_leave_no_file(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    assert place() is None
    script = (
        "from cvnotes.learn import EXERCISES, check; check('lift', EXERCISES['lift'].reference)"
    )
    environment = {k: v for k, v in os.environ.items() if k != VARIABLE}
    package = str(Path(exercises.__file__).resolve().parents[2])
    subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, check=True,
        env=environment | {"PYTHONPATH": package},
    )  # fmt: skip
    assert list(tmp_path.iterdir()) == []


def test_what_a_report_names_is_at_hand_in_the_notebook(monkeypatch):
    mine = object()
    running = SimpleNamespace(user_ns={"progress": mine})
    monkeypatch.setattr(course, "shell", lambda: running)
    assert 'hint("lift")' in check("lift", ...).message
    assert running.user_ns == {"hint": COURSE.hint, "solution": COURSE.solution, "progress": mine}


@pytest.mark.usefixtures("file")
def test_whoever_puts_the_answer_first_is_told_so_and_an_id_may_be_a_number():
    with pytest.raises(CvnotesError, match=r'comes first: check\("lift", my_lift\)'):
        check(abs, "lift")
    numbers = personal_camera(123456).truth().A[[0, 1, 0, 1], [0, 1, 2, 2]]
    assert check("own_camera", numbers, student=123456).passed
    assert check("own_camera", numbers, student="123456").passed


@pytest.mark.usefixtures("file")
def test_the_hint_after_a_refusal_gives_the_step_that_is_missing():
    def my_error_bars(J, r):
        s2 = r @ r / len(r)
        return np.sqrt(s2 * np.diag(np.linalg.inv(J.T @ J)))

    assert "The step" not in repr(COURSE.hint("error_bars"))
    assert "r @ r / (n - p)" not in repr(check("error_bars", my_error_bars))
    said, hint = COURSE.hint("error_bars").lines
    assert said == "The step that is missing first is s2 = r @ r / (n - p)."
    assert hint == EXERCISES["error_bars"].hints[1]
    check("error_bars", EXERCISES["error_bars"].reference)
    assert len(COURSE.hint("error_bars").lines) == 1


def test_what_is_too_long_to_show_is_named_so_that_it_can_be_had():
    def my_backward_warp(image, H, size):
        return np.zeros((300, 300))

    report = check("backward_warp", my_backward_warp)
    [line] = [line for line in report.compared() if line.startswith("yours")]
    assert line == 'yours = check("backward_warp", my_backward_warp).yours  # (300, 300)'
    names = {"check": check, "my_backward_warp": my_backward_warp}
    exec(line, names)
    assert names["yours"].shape == (300, 300)
