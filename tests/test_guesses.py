"""A guess is kept until the answer is shown, over kernels too, and nothing that is no guess is."""

import json

import numpy as np
import pytest

from cvnotes.base import CvnotesError
from cvnotes.learn import EXERCISES, answer, check, guess, guesses
from cvnotes.learn.exercises import COURSE
from cvnotes.tutor.course import Session
from cvnotes.tutor.remembered import FILE, VARIABLE, solved_before


@pytest.fixture(autouse=True)
def file(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path / FILE))
    monkeypatch.setattr(guesses, "_kept", {})
    monkeypatch.setattr(COURSE, "session", Session())
    return tmp_path / FILE


def test_the_dots_are_no_guess():
    assert "the column, in px" in repr(guess("rails", ..., "the column, in px"))
    assert repr(answer("rails", 320.0, "px")) == "It is 320 px. (You had not guessed.)"


def test_the_next_kernel_knows_the_guess(monkeypatch):
    guess("rails", 300)
    monkeypatch.setattr(guesses, "_kept", {})
    assert "You guessed 300 before" in repr(guess("rails"))
    assert "Off by 20 px" in repr(answer("rails", 320.0, "px"))


def test_guesses_and_solved_exercises_share_the_file(file):
    guess("rails", 300)
    check("lift", EXERCISES["lift"].reference)
    guess("poles", "the third")
    known = json.loads(file.read_text())
    assert known["guesses"] == {"poles": "the third", "rails": 300}
    assert list(solved_before()) == ["lift"]


def test_without_a_file_this_kernel_knows(monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    guess("rails", (300, 240))
    assert "Off by 25 px" in repr(answer("rails", (320, 255), "px"))


@pytest.mark.parametrize(
    ("mine", "truth", "said"),
    [
        (np.float64(2.5), 2, "Off by 0.5"),
        (np.array([3.0, 4.0]), [0, 0], "Off by 5"),
        ("Left ", "left", "Right."),
        ("left", "right", "Now you know."),
        (3, (1, 2), "Now you know."),
        (7, 7.0, "Exactly."),
    ],
)
def test_the_answer_judges_kindly(mine, truth, said):
    guess("it", mine)
    assert repr(answer("it", truth)).endswith(said if said.endswith(".") else said + ".")


@pytest.mark.parametrize("wrong", [None, 1j, np.nan, np.inf, {}, [], print, "x" * 300, [1, "a"]])
def test_what_is_no_guess_is_refused_in_words_and_not_kept(wrong, file):
    with pytest.raises(CvnotesError, match="a number, a word"):
        guess("it", wrong)
    assert not file.exists()


@pytest.mark.parametrize("text", ["{", "[]", '{"guesses": 3}', '{"guesses": [1]}', '"x"'])
def test_a_broken_file_is_no_guess(file, text):
    file.write_text(text)
    assert "had not guessed" in repr(answer("it", 1))


def test_markup_in_a_guess_is_text():
    guess("it", "<b>")
    assert "&lt;b&gt;" in answer("it", "x")._repr_html_()
