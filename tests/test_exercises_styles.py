"""Right is right on any inputs and in any style: who passes in the notebook passes in the class."""

import os

import numpy as np
import pytest
from test_exercises_second import solution_of

from cvnotes.learn import EXERCISES
from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED, RIGHT_THERE_NOT_HERE, verdict
from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.equality import up_to_scale
from cvnotes.tutor.checker.judge import judge

pytestmark = pytest.mark.usefixtures("worked_out_once")

FUNCTIONS = [name for name, e in EXERCISES.items() if e.answer == "function"]
# All 60 with CVNOTES_SEEDS=60; the usual run tries some.
SEEDS = range(int(os.environ.get("CVNOTES_SEEDS", "3")))


STYLES = {
    "as it is": lambda answer: answer,
    "a list": lambda answer: np.asarray(answer).tolist(),
    "single precision": lambda answer: np.asarray(answer).astype(np.float32),
    "Fortran order": lambda answer: np.array(answer, order="F"),
    "complex": lambda answer: np.asarray(answer) + 0j,
}


def _written(exercise, function):
    """Give a right function in all styles that are right."""
    for style, dressed in STYLES.items():
        yield style, lambda *args, d=dressed: d(function(*args))
    if exercise.same is up_to_scale:
        yield "another scale", lambda *args: -1e-5 * np.asarray(function(*args))
        yield "single, another scale", lambda *args: np.float32(3e4) * np.float32(function(*args))


def _outcomes(exercise, function, seed):
    return [attempt(function, args) for args in exercise.inputs(seed)]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_what_is_right_is_right_for_every_seed_and_in_every_style(name):
    exercise = EXERCISES[name]
    for function in (exercise.reference, solution_of(name)):
        for style, written in _written(exercise, function):
            for seed in SEEDS:
                report = judge(exercise, _outcomes(exercise, written, seed), seed)
                assert report.passed, (style, seed, report)


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.slow
def test_the_class_says_what_the_notebook_said(name):
    exercise = EXERCISES[name]
    for function in (exercise.reference, *(m.gives for m in exercise.misconceptions)):
        seen = {seed: _outcomes(exercise, function, seed) for seed in (7, NOTEBOOK_SEED)}
        there = judge(exercise, seen[NOTEBOOK_SEED], NOTEBOOK_SEED)
        assert repr(verdict(exercise, seen)) == repr(there)


def test_right_in_the_notebook_alone_is_said_to_be_so():
    exercise = EXERCISES["drop"]
    right = _outcomes(exercise, exercise.reference, NOTEBOOK_SEED)
    wrong = _outcomes(exercise, lambda x_h: x_h[:, :-1], 7)
    report = verdict(exercise, {7: wrong, NOTEBOOK_SEED: right})
    assert not report.passed
    assert report.remarks[0] == RIGHT_THERE_NOT_HERE
    assert report.misconception == "no division"
    assert RIGHT_THERE_NOT_HERE not in verdict(exercise, {7: wrong}).remarks
