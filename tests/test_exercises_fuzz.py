"""Whatever is handed over, to whatever exercise: a report comes back, and nothing wrong passes."""

# Functions that give a wrong answer need none of their arguments.
# ruff: noqa: ARG005

import warnings
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from cvnotes.learn import EXERCISES, check
from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.judge import judge
from cvnotes.tutor.checker.outcome import Outcome

pytestmark = [pytest.mark.usefixtures("worked_out_once"), pytest.mark.once]

SEED = 2024
CASES = {name: list(e.solved_cases(SEED)) for name, e in EXERCISES.items() if not e.parts}
FILLED_WITH = {
    "0": 0.0, "1": 1.0, "−1": -1.0, "half": 0.5, "NaN": np.nan, "inf": np.inf, "−inf": -np.inf,
    "1e308": 1e308, "−1e308": -1e308, "1e-308": 1e-308, "5e-324": 5e-324,
    "whole": 3, "true": True, "complex": 1j, "real complex": 2 + 0j, "single": np.float32(0.3),
    "fraction": Fraction(1, 3), "decimal": Decimal("0.5"), "text": "x", "None": None,
    "object": object(),
}  # fmt: skip
SHAPES = [(), (0,), (1,), (2,), (3,), (6,), (2, 2), (3, 3), (4, 4), (3, 2), (0, 3), (4, 3, 2)]


def _shapes(right):
    """Give shapes that have nothing to do with the right one, and those that nearly have."""
    own = right.shape
    longer = [(*own[:i], own[i] + d, *own[i + 1 :]) for i in range(len(own)) for d in (-1, 1)]
    return dict.fromkeys(
        [*SHAPES, own, own[::-1], (*own, 1), (1, *own), own[1:], own[:-1], *longer]
    )


def _judged(exercise, outcomes):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        report = judge(exercise, outcomes, SEED)
        assert repr(report)
        assert report._repr_html_()
    return report


@pytest.mark.parametrize("name", CASES)
@pytest.mark.slow
def test_arrays_of_one_thing_and_of_any_shape_get_a_report_and_do_not_pass(name):
    exercise, cases = EXERCISES[name], CASES[name]
    for filled in FILLED_WITH.values():
        # all shapes with some contents, all contents with the right shape
        usual = filled is None or (isinstance(filled, float) and filled in (0.5, np.inf))
        for shape in _shapes(cases[0].right) if usual else [cases[0].right.shape]:
            handed = np.full(shape, filled)
            handed = handed.tolist() if handed.dtype == object else handed
            # Each case would get the same: what the arguments are, it does not look at.
            report = _judged(exercise, [attempt(lambda x=handed: x, ())] * len(cases))
            if report.passed:
                assert exercise.answer == "value"
                assert exercise.same(np.asarray(handed, dtype=float), cases[0].right, 1e-6)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.slow
def test_constants_of_the_shape_of_each_case_do_not_pass(name):
    exercise, cases = EXERCISES[name], CASES[name]
    if exercise.answer == "value":
        return
    for constant in (0.0, 1.0, -1.0, 1e308, -1e308, np.nan, np.inf, -np.inf, 1e-308):
        outcomes = [Outcome("numbers", np.full(c.right.shape, constant), "float64") for c in cases]
        assert not _judged(exercise, outcomes).passed, constant


@pytest.mark.parametrize("name", CASES)
@pytest.mark.slow
def test_one_case_that_goes_wrong_is_enough(name):
    exercise, cases = EXERCISES[name], CASES[name]
    right = [Outcome("numbers", case.right, "float64") for case in cases]
    for i, case in enumerate(cases):
        spoilt = [
            Outcome("raised", words="ValueError: no"), Outcome("none"),
            Outcome("text", words="'x'"),
            Outcome("numbers", case.right * np.nan, "float64"),
            Outcome("numbers", case.right[..., None], "float64"),
            Outcome("numbers", np.zeros(0), "float64"),
        ]  # fmt: skip
        for outcome in spoilt:
            if outcome.value is None or not np.array_equal(outcome.value, case.right, True):
                report = _judged(exercise, [*right[:i], outcome, *right[i + 1 :]])
                assert not report.passed


def test_the_numbers_that_once_ended_in_a_traceback_get_a_sentence():
    assert "a single number is wanted" in check("how_far", (412, 354)).message
    roots = check("fold_radius", lambda k: np.sqrt(np.abs(np.roots([5 * k[1], 3 * k[0], 1]))))
    assert "a single number is wanted" in roots.message
    sides = check("field_of_view", lambda A, width: (0.7, 0.6))
    assert "a single number is wanted" in sides.message


def test_infinity_is_no_line_and_no_point():
    for huge in (np.inf, 1e308):
        assert not check("line_through", lambda p, q, x=huge: np.full(3, x)).passed
        assert not check("meet", lambda l1, l2, x=huge: np.full(3, x)).passed
        assert not check("horizon", lambda A, R, n, x=huge: np.full(3, x)).passed


def test_real_numbers_in_other_clothes_are_numbers():
    drop = EXERCISES["drop"].reference
    assert check("drop", lambda x_h: drop(x_h) + 0j).passed
    assert check(
        "field_of_view", lambda *x: Fraction(EXERCISES["field_of_view"].reference(*x))
    ).passed
    assert check("count_holes", lambda *x: Decimal(EXERCISES["count_holes"].reference(*x)))
    assert "complex numbers" in check("drop", lambda x_h: drop(x_h) + 1j).message


def test_an_exception_is_reported_before_a_shape():
    def my_drop(x_h):
        return x_h[0] if len(x_h) < 3 else x_h @ np.zeros(7)

    assert "raised ValueError" in check("drop", my_drop).message


def test_words_about_shapes_are_measured():
    alone = check("line_through", lambda p, q: 3.0)
    assert alone.message.endswith("wanted is (3,): one number alone.")
    assert "homogeneous" not in check("radial_fit", lambda xy, xy_lens: np.zeros(3)).message
    assert "np.full((2,), np.nan)" in check("vanishing_point", lambda A, R, d: np.nan).message
    assert (
        "an array has its rows first" in check("backward_warp", lambda i, H, s: np.zeros(s)).message
    )


def test_a_choice_is_no_number():
    assert check("bad_views", 1).message == "The answer is one of A, B, C, D; '1' is none."
    assert not check("which_to_trust", True).passed


def test_a_value_is_spoken_of_as_no_function():
    for name in ("corner_shift", "bad_views"):
        message = check(name, None).message
        assert (
            message == "The answer is None: is a return missing in the function that worked it out?"
        )
    uncalled = check("corner_shift", check).message
    assert uncalled.endswith("was not called: are the brackets missing? Numbers are wanted.")
    assert check("corner_shift", [object()]).message.endswith("; numbers are wanted.")
    words = check("drop", lambda x_h: x_h.astype(str)).message
    assert words == "The answer is an ndarray of text; an array of numbers is wanted."


def test_the_pipeline_says_which_steps_are_missing():
    steps = {part.name: part.reference for part in EXERCISES["pipeline"].parts}
    del steps["b_from_views"]
    report = check("pipeline", steps)
    assert report.verdict == "not solved yet"
    assert "This step is missing: b_from_views." in report.message
    assert report.misconception == "steps missing"

    def my_radial_fit(xy, xy_lens): ...

    report = check("pipeline", steps | {"radial_fit": my_radial_fit})
    assert "These steps are missing: b_from_views and radial_fit." in report.message
    assert "missing" not in check("pipeline", {}).message
    report = check("pipeline", {"homography": steps["dlt"], **steps})
    assert report.misconception == "steps by other names"
    assert "A_from_b, extrinsics, radial_fit; yours: homography." in report.message
