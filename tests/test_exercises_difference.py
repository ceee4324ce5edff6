"""Where no mistake has a name, the report says what differs, and says it truly."""

import numpy as np
import pytest

from cvnotes.learn import EXERCISES
from cvnotes.learn.checker.attempt import attempt
from cvnotes.learn.checker.judge import judge

SEED = 2024


def said(name, change):
    """Give the report's message for a right answer that was changed."""
    exercise = EXERCISES[name]
    outcomes = [
        attempt(lambda *given: change(np.asarray(exercise.reference(*given))), args)
        for args in exercise.inputs(SEED)
    ]
    report = judge(exercise, outcomes, SEED)
    assert not report.passed
    assert report.misconception is None
    return report.message


@pytest.mark.parametrize(
    ("name", "change", "sentence"),
    [
        ("project", lambda x: -x, "Your answer is right but for its sign"),
        ("error_bars", lambda x: 2 * x, "the right one times 2, in every case."),
        ("field_of_view", lambda x: x * np.pi, "the right one times π, in every case."),
        ("v_ij", lambda x: x / 3, "the right one times 0.333333, in every case."),
        ("project", lambda x: x + 0.5, "the right one plus 0.5 everywhere."),
        ("project", lambda x: x + [1, 2], "Every row is the right one plus (1, 2)."),
        ("camera_centre", lambda x: x[::-1], "The entries are the right ones, in the opposite"),
        ("v_ij", lambda x: np.roll(x, 1), "The entries are the right ones, moved on by one place."),
        ("distort", lambda x: x[[1, 0, *range(2, len(x))]], "The rows are the right ones, in"),
        ("horizon", lambda x: x[[1, 0, 2]], "The numbers are the right ones, in another order."),
        ("nearest_rotation", lambda R: R * [1, -1, 1], "sizes are right, signs are wrong in [0, 1"),
        ("A_from_b", lambda A: A + [[0, 0, 0], [0, 0, 3.0], [0, 0, 0]],
         "All is right but what stands in [1, 2]."),
        ("residuals", lambda r: r * [1, 1.5], "Only column 1 of your answer is wrong."),
    ],
)  # fmt: skip
def test_what_differs_is_measured(name, change, sentence):
    assert sentence in said(name, change)


def test_a_factor_of_one_case_alone_is_no_factor():
    rng = np.random.default_rng(0)
    message = said("field_of_view", lambda x: x * rng.uniform(1.1, 1.4))
    assert "times" not in message
    assert message == 'Look at what does not hold; hint("field_of_view") helps.'


def test_a_number_that_was_read_off_is_not_given_away():
    for name, exercise in EXERCISES.items():
        if exercise.answer == "value" and not exercise.choices:
            assert "times" not in said(name, lambda x: 3.3 * x)


def test_truth_values_have_no_sign_or_order():
    assert "order" not in said("same_points", lambda x: np.roll(x, 1))
