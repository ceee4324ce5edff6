"""Exercises on a page: a box answers as the cell of a notebook would."""

import json

import pytest

from cvnotes.learn import EXERCISES, check
from cvnotes.learn.exercises import COURSE
from cvnotes.learn.page import answered, helped, late, solved
from cvnotes.tutor.course import Session

RIGHT = """def my_drop(x_h):
    with np.errstate(all="ignore"):
        return np.where(x_h[:, -1:] == 0, np.nan, x_h[:, :-1] / x_h[:, -1:])"""


@pytest.fixture(autouse=True)
def nothing_solved(monkeypatch):
    monkeypatch.setattr(COURSE, "session", Session())


def asked(exercise, box, **more):
    question = {"exercise": exercise, "cell": f'{box}\n\n\ncheck("{exercise}", my_{exercise})'}
    return json.loads(answered(json.dumps({**question, **more})))


def test_a_right_answer_is_right_and_what_was_solved_elsewhere_counts():
    cells = ["import numpy as np\nfrom cvnotes.no_such_thing import nothing\nprint(1 / 0)"]
    said = asked("drop", RIGHT, cells=cells, solved=["lift", "no exercise"])
    assert said["passed"]
    assert "drop: ✓ right." in said["html"]
    assert "Chapter 1: 2 of 5 solved" in said["html"]
    assert said["solved"] == ["drop", "lift"]


def test_a_misconception_is_named_with_the_notebooks_own_report():
    def my_drop(x_h):
        return x_h[:, :-1]

    said = asked("drop", "def my_drop(x_h):\n    return x_h[:, :-1]")
    report = check("drop", my_drop)
    assert report.misconception
    assert not said["passed"]
    assert (
        said["html"].partition("<p>Chapter")[0] == report._repr_html_().partition("<p>Chapter")[0]
    )


@pytest.mark.slow
def test_a_stub_is_not_solved_yet_for_every_exercise():
    for name, exercise in EXERCISES.items():
        student = ', student="me"' if exercise.personal else ""
        cell = f'{exercise.stub}\n\ncheck("{name}", {exercise.variable}{student})'
        said = json.loads(answered(json.dumps({"exercise": name, "cell": cell})))
        assert f"{name}: not solved yet." in said["html"], said["html"]


def test_functions_of_the_boxes_above_are_at_hand():
    above = ["def my_lift(x, k):\n    return x / 0\ncheck('lift', my_lift)", "def broken(", RIGHT]
    box = "import numpy as np\nmy_own = my_drop\ndef my_drop(x_h):\n    return my_own(x_h)"
    assert asked("drop", box, before=above, cells=["import numpy as np"])["passed"]


@pytest.mark.parametrize(
    ("box", "said"),
    [
        ("def my_drop(x_h:\n    pass", "Line 1, `def my_drop(x_h:`, cannot be read: "),
        ("my_drop = 1\nx = y", "Line 2, `x = y`, raised NameError: name &#x27;y&#x27;"),
        ("raise SystemExit(3)", "Line 1, `raise SystemExit(3)`, raised SystemExit: 3."),
        ("", "raised NameError: name &#x27;my_drop&#x27; is not defined."),
        ("print('<b>')\nmy_drop = ...", "<p>The cell printed:</p><pre>&lt;b&gt;"),
        ("def my_drop(x_h):\n    return x_h.nothing", "in the line `return x_h.nothing`"),
        ("display(missing)\nmy_drop = ...", "drop: not solved yet."),
    ],
)
def test_whatever_is_written_is_answered_in_a_sentence(box, said):
    assert said in asked("drop", box)["html"]


def test_hints_come_one_by_one_and_the_solution_as_source():
    shown = [helped("lift", n) for n in range(4)]
    assert [f"hint {min(n, 3)} of 3" in html for n, html in enumerate(shown, 1)] == [True] * 4
    assert "def lift" in solved("lift")


def test_a_cell_that_is_stopped_is_told_in_the_notebooks_words():
    assert "drop: ✗ not yet right." in late("drop", 10)
    assert "Your function was stopped after 10 seconds: does a loop never end?" in late("drop", 10)
