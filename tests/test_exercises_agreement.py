"""One verdict for the notebook and for the class: who passes in the one passes in the other."""

import pytest

from cvnotes.learn import EXERCISES
from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED, RIGHT_THERE_NOT_HERE, verdict
from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.judge import judge

pytestmark = [pytest.mark.usefixtures("worked_out_once"), pytest.mark.once]

FUNCTIONS = [name for name, e in EXERCISES.items() if e.answer == "function"]


def _outcomes(exercise, function, seed):
    return [attempt(function, args) for args in exercise.inputs(seed)]


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
