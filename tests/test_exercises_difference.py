"""Slips that any exercise knows: the report measures what differs, names it, and says it truly."""

# Functions that go wrong use names that are not there.

from dataclasses import replace

import numpy as np
import pytest

from cvnotes.learn import EXERCISES
from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.equality import within
from cvnotes.tutor.checker.exercise import Case, Exercise, Misconception, Property
from cvnotes.tutor.checker.judge import judge

pytestmark = pytest.mark.once

SEED = 2024


def reported(name, change):
    """Give the report on a right answer that was changed."""
    exercise = EXERCISES[name]
    outcomes = [
        attempt(lambda *given: change(np.asarray(exercise.reference(*given))), args)
        for args in exercise.inputs(SEED)
    ]
    report = judge(exercise, outcomes, SEED)
    assert not report.passed
    return report


def said(name, change):
    """Give the report's message for a right answer that was changed."""
    return reported(name, change).message


@pytest.mark.parametrize(
    ("name", "change", "called", "sentence"),
    [
        ("project", lambda x: -x, "sign", "Your answer is right but for its sign"),
        ("error_bars", lambda x: 7 * x, "a factor", "the right one times 7, in every case."),
        ("field_of_view", lambda x: x * np.pi, "a factor", "times π, in every case."),
        ("vanishing_point", np.degrees, "degrees for radians", "times 180/π: degrees"),
        ("v_ij", lambda x: x / 3, "a factor", "the right one times 0.333333, in every case."),
        ("project", lambda x: x + 0.5, "half a pixel", "the right one plus 0.5 everywhere."),
        ("project", lambda x: x + [1, 2], "every row moved", "is the right one plus (1, 2)."),
        ("camera_centre", lambda x: x[::-1], "entries in the opposite order", "right ones, in the"),
        ("v_ij", lambda x: np.roll(x, 1), "entries moved on", "moved on by one place."),
        ("distort", lambda x: x[[1, 0, *range(2, len(x))]], "rows in another order", "right ones"),
        ("horizon", lambda x: x[[1, 0, 2]], "another order", "The numbers are the right ones, in"),
        ("nearest_rotation", lambda R: R * [1, -1, 1], "signs of some numbers", "wrong in [0, 1"),
        ("A_from_b", lambda A: A + [[0, 0, 0], [0, 0, 3.0], [0, 0, 0]], "a few numbers",
         "All is right but what stands in [1, 2]."),
        ("residuals", lambda r: r * [1, 1.5], "one column", "Only column 1 of your answer is"),
        ("v_ij", lambda x: x**2, "squared", "take the roots"),
        ("camera_centre", lambda x: 1 / x, "upside down", "turn the fraction around"),
        ("error_bars", lambda x: np.round(x, 2), "few decimals", "rounded to two decimals"),
        ("project", np.rint, "rounded", "rounded: leave them as they are"),
        ("project", np.trunc, "decimals cut off", "as int() or an integer array"),
        ("camera_centre", lambda x: x / np.linalg.norm(x), "scaled to length 1", "to length 1"),
        ("form_image", lambda m: m.T.reshape(m.shape), "reshaped for transposed", "Take .T."),
        ("distort", lambda x: 0 * x + x[:1], "one row for all", "All rows of your answer are the"),
        ("same_points", lambda x: x * [0, *[1] * (len(x) - 1)], "False too often", "[0]"),
        ("drop", lambda x: np.where(x == x[0, 0], np.nan, x), "NaN too often", "is right, but"),
        ("camera_centre", lambda x: 0 * x + [1, 2, 3], "one answer for all", "to every input"),
        ("rectifying_rotation", lambda R: R * [[2], [3], [-4]], "each row up to a factor",
         "Each row of your answer is right up to a factor of its own."),
        ("distort", lambda x: x * [2, -3], "each column up to a factor", "Each column of your"),
        ("normaliser", lambda N: -3 * N * [[1, 1, 1], [1, 1, 5], [1, 1, 1]], "a few numbers",
         "All is right but what stands in [1, 2]."),
        ("horizon", lambda x: 7 * x * [1, -1, 1], "signs of some numbers", "wrong in [1]"),
        ("cam1_from_cam2", lambda G: G * [1, 1, 1, 1.5], "a few numbers", "R is right, T is not."),
        ("extrinsics", lambda G: G * [1, 1, 1, -1], "signs of some numbers", "are wrong in T."),
        ("extrinsics", lambda G: G * [1, 1.5, 1, 1], "a few numbers", "T is right, R is not."),
    ],
)  # fmt: skip
def test_what_differs_is_measured_and_named(name, change, called, sentence):
    report = reported(name, change)
    assert report.misconception == called
    assert sentence in report.message


@pytest.mark.parametrize(
    ("name", "change", "called", "sentence"),
    [
        ("project", np.transpose, "points as columns", "points are rows here, so transpose"),
        ("nearest_rotation", np.ravel, "all in one row", "one after the other"),
        ("geometric_error", lambda x: x[:, None], "a column, not a row", ".ravel()"),
        ("camera_centre", lambda x: x[None], "brackets too many", "in too many brackets"),
        ("distort", lambda x: x[-1], "the last only", "overwrite the one before?"),
        ("distort", lambda x: x[:1], "the first only", "inside of a loop?"),
        ("distort", lambda x: x[1:], "rows left out", "some are missing"),
        ("distort", lambda x: np.vstack([x[:1], x]), "rows too many", "but there are more"),
        ("distort", lambda x: np.column_stack([3 * x, 0 * x[:, 0] + 3]), "still homogeneous",
         "Divide by the last coordinate"),
        ("distort", lambda x: np.column_stack([x, 0 * x[:, 0] + 1]), "last coordinate kept",
         "with a 1 too many: leave it out."),
        ("error_bars", np.diag, "a matrix for its diagonal", "see np.diag"),
        ("nearest_rotation", np.diag, "the diagonal only", "the diagonal only"),
        ("error_bars", np.mean, "the mean", "the mean of the right numbers"),
        ("undistortion_map", lambda x: x.transpose(2, 1, 0), "transposed", "has its rows first"),
        ("undistortion_map", lambda x: 2 * x.ravel(), "all in one row", "may be right"),
        ("radial_fit", lambda x: np.append(x, 7.5), "columns too many", "among them"),
        ("same_points", lambda x: np.column_stack([x] * 3), "an axis too many", "axis=1"),
        ("how_far", lambda x: [x, x], "several numbers for one", "a single number"),
        ("distort", lambda x: 7 * x[:, 0], "one number for each row", "one number came back for"),
        ("distort", lambda x: 7 * x[0], "one of several", "only one of several points came back"),
        ("nearest_rotation", lambda R: 7 * abs(R).sum(axis=1), "one row of a matrix",
         "or one number for each row; the whole matrix"),
        ("nearest_rotation", lambda R: 7 * R[0, :2], "all in one row", "one row alone; np.append"),
        ("meet", lambda x: x[:2], "columns left out", "numbers are missing."),
        ("v_ij", lambda x: 7 * x[2:], "numbers too few", "numbers are missing."),
        ("distort", lambda x: 7 * x[2:], "rows too few", "rows are missing."),
        ("distort", lambda x: 7 * np.hstack([x, x]), "columns too many", "too many in each row."),
    ],
)  # fmt: skip
def test_another_shape_is_named_by_what_was_done(name, change, called, sentence):
    report = reported(name, change)
    assert report.misconception == called
    assert sentence in report.message


def tried(name, function):
    """Give the report on a function."""
    exercise = EXERCISES[name]
    return judge(exercise, [attempt(function, args) for args in exercise.inputs(SEED)], SEED)


def right(name):
    return EXERCISES[name].reference


@pytest.mark.parametrize(
    ("name", "function", "called"),
    [
        ("radial_fit", lambda a, b: right("radial_fit")(a, 0 * a + b[:, ::-1]),
         "columns exchanged in xy"),
        ("residuals", lambda A, k, G, W, m: right("residuals")(A, k, G, -W, m), "G with −T for T"),
        ("residuals", lambda A, k, G, W, m: right("residuals")(A, k[::-1], G, W, m),
         "k the wrong way round"),
        ("form_image", lambda A, R, T, k, W: right("form_image")(A, R, T[::-1], k, W),
         "T the wrong way round"),
        ("form_image", lambda A, R, T, k, W: right("form_image")(A, R, T, k, np.trunc(W)),
         "W without decimals"),
        ("project", lambda A, R, T, W: right("project")(A, R, T * [1, 0, 1], W), "T[1] left out"),
        ("error_bars", lambda J, r: right("error_bars")(J - J.mean(), r),
         "J less the mean of all its numbers"),
        ("dlt", lambda src, dst: right("dlt")(src[::-1], dst),
         "src in the opposite order"),
        ("geometric_error", lambda H, _, dst: right("geometric_error")(H, dst, dst), "dst for src"),
        ("harris_measure", lambda u, v, k: right("harris_measure")(u, v, 1 / k), "k upside down"),
        ("undistortion_map", lambda A, k, size: right("undistortion_map")(A, k, size[::-1]),
         "size the wrong way round"),
        ("backward_warp", lambda image, H, size: right("backward_warp")(
            image, H, (size[0] + 1, size[1] + 1)), "size too large by 1"),
        ("undistortion_map", lambda A, k, size: right("undistortion_map")(
            np.diag([A[1, 1], A[0, 0], 1]) + A * [[0, 0, 1], [0, 0, 1], [0, 0, 0]], k, size),
         "A with α_u and α_v exchanged"),
        ("project", lambda A, R, T, W: right("project")(
            np.diag([A[0, 0], A[0, 0], 1]) + A * [[0, 0, 1], [0, 0, 1], [0, 0, 0]], R, T, W),
         "A with one focal length and no skew"),
        ("distort", lambda xy, k, p: right("distort")(xy, k[[0, 0]], p), "k[0] for k[1]"),
        ("camera_centre", lambda R, T: right("camera_centre")(R, T[[0, 2, 2]]), "T[2] for T[1]"),
        ("form_image", lambda A, R, T, k, W: _by_hand(A, (W - T) @ R.T, k),
         "T taken for the camera's position"),
    ],
)  # fmt: skip
def test_a_right_function_of_a_slipped_input_is_named_by_the_slip(name, function, called):
    assert tried(name, function).misconception == called


def _by_hand(A, M, k):
    """Form an image of points that may lie behind the camera."""
    xy = M[:, :2] / M[:, 2:]
    r2 = (xy**2).sum(axis=1, keepdims=True)
    return xy * (1 + k[0] * r2 + k[1] * r2**2) @ A[:2, :2].T + A[:2, 2]


def test_a_slip_in_some_cases_alone_is_none_of_the_input():
    rights = right("form_image")

    def now_and_then(A, R, T, k, W):
        return rights(A, R, -T if len(W) == 4 else 1.1 * T, k, W)

    assert tried("form_image", now_and_then).misconception is None


def test_whoever_slips_in_a_special_case_too_is_told_of_the_mistake_in_all_the_others():
    def my_vanishing_point(A, R, d):
        m = A @ R.T @ d
        return m[:2] / m[2] if (R @ d)[2] > 0 else np.zeros(2)

    assert tried("vanishing_point", my_vanishing_point).misconception == "R transposed"

    def my_bilinear(image, u, v):  # and an IndexError at the border
        j, i = int(v), int(u)
        a, b = u - i, v - j
        top = a * image[j, i] + (1 - a) * image[j, i + 1]
        return (1 - b) * top + b * (a * image[j + 1, i] + (1 - a) * image[j + 1, i + 1])

    assert tried("bilinear", my_bilinear).misconception == "weights the wrong way round"


def test_a_mistake_with_many_results_is_seen_by_what_they_share():
    rng = np.random.default_rng(3)

    def some_solution(rows):
        """Give any b that solves the rows of V that are chosen."""

        def my_b_from_views(H):
            H = H / np.linalg.norm(H, axis=(1, 2), keepdims=True)
            V = rows([_constraints(h) for h in H])
            null = np.linalg.svd(V)[2][np.linalg.matrix_rank(V) :]
            return rng.standard_normal(len(null)) @ null

        return my_b_from_views

    def last(views):
        return views[-1]

    assert tried("b_from_views", some_solution(last)).misconception == "the last view only"
    assert tried("b_from_views", some_solution(lambda v: v[1])).misconception is None


def _constraints(h):
    def v(a, b):
        return np.array([
            a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[1] * b[1],
            a[0] * b[2] + a[2] * b[0], a[1] * b[2] + a[2] * b[1], a[2] * b[2],
        ])  # fmt: skip

    return np.array([v(h[:, 0], h[:, 1]), v(h[:, 0], h[:, 0]) - v(h[:, 1], h[:, 1])])


def bare(name, function):
    """Give the report on a function by an exercise that foresees no mistake."""
    exercise = replace(EXERCISES[name], misconceptions=())
    return judge(exercise, [attempt(function, args) for args in exercise.inputs(SEED)], SEED)


@pytest.mark.parametrize(
    ("name", "change", "called"),
    [
        ("drop", lambda x: np.where(np.isnan(x), np.inf, x), "infinity for NaN"),
        ("depth", lambda z: np.where(np.isinf(z), np.nan, z), "NaN for infinity"),
        ("depth", lambda z: np.where(np.isinf(z), -z, z), "sign of infinity"),
        ("depth", np.negative, "sign"),
        ("depth", lambda z: np.where(np.isinf(z), 0, z), "a number for infinity"),
        ("drop", lambda x: np.nan_to_num(x), "a number for NaN"),
        ("drop", np.floor, "decimals cut off"),
        ("depth", np.square, "squared"),
    ],
)
def test_nan_is_told_from_infinity(name, change, called):
    report = bare(name, lambda *given: change(EXERCISES[name].reference(*given)))
    assert report.misconception == called


def test_what_is_nearly_right_is_not_right_up_to_the_factor_1():
    for mistake in EXERCISES["extrinsics"].misconceptions:
        for gives in (mistake.gives, *mistake.variants):
            message = bare("extrinsics", gives).message
            assert "which is 1 here" not in message
            assert "times 1," not in message


def test_what_is_said_of_here_is_said_of_the_input_that_is_shown():
    report = bare("error_bars", lambda J, r: right("error_bars")(J, r) * len(r))
    assert report.misconception == "up to a factor"
    assert f"which is {len(report.counterexample['r'])} here" in report.message

    def the_last_pair_too(a, b):
        return np.maximum(right("same_points")(a, b), (a == a[-1]).all(axis=1))

    report = bare("same_points", the_last_pair_too)
    wrong = np.flatnonzero(report.yours != report.wanted)
    assert f"entry [{wrong[0]}], counted from 0, is False" in report.message


def test_a_slip_that_changes_the_shape_says_the_shape_too():
    def the_other_way_round(A, k, size):
        return right("undistortion_map")(A, k, size[::-1])

    report = tried("undistortion_map", the_other_way_round)
    shape = report.wanted.shape
    said = f"The answer has shape {(shape[1], shape[0], 2)}, wanted is {shape}. It looks as if you"
    assert report.message.startswith(said)


def test_a_factor_of_some_cases_is_not_said_of_all():
    def my_depth(alpha, b, left, right_):
        return (1.1 if len(left) > 1 else 1) * right("depth")(alpha, b, left, right_)

    def my_distort(xy, k, p):
        return (1.1 if len(xy) > 2 else 1) * right("distort")(xy, k, p)

    for name, function in (("depth", my_depth), ("distort", my_distort)):
        cases = EXERCISES[name].inputs(SEED)
        with np.errstate(divide="ignore"):  # where the depth is infinite
            given = [function(*args) for args in cases]
            wanted = [right(name)(*args) for args in cases]
        alike = [np.array_equal(g, w) for g, w in zip(given, wanted, strict=True)]
        assert any(alike)
        assert sum(alike) < len(alike) - 1
        message = bare(name, function).message
        assert "the right one times 1.1, wherever it is wrong." in message


def test_a_list_of_another_shape_is_no_argument_that_was_changed():
    def my_board(*given):
        given[-1][:] = 0
        return given[-1][0]

    report = bare("project", my_board)
    assert report.misconception != "an argument changed"
    assert "shape" in report.message


def test_a_factor_of_one_case_alone_is_no_factor():
    rng = np.random.default_rng(0)
    message = said("field_of_view", lambda x: x * rng.uniform(1.1, 1.4))
    assert "times" not in message
    assert message == 'Look at what does not hold; hint("field_of_view") helps.'


def test_a_number_that_was_read_off_is_not_given_away():
    for name, exercise in EXERCISES.items():
        if exercise.answer == "value" and not exercise.choices:
            assert "times" not in said(name, lambda x: 3.3 * x)


def test_answers_of_any_scale_are_known_to_be_rounded():
    for name, size in (("dlt", 1.0), ("dlt", 40.0), ("four_points", 1.0), ("horizon", 300.0)):
        message = said(name, lambda x, s=size: np.round(s * x, 3))
        assert "rounded to 3 decimals" in message, name


def test_numbers_for_truth_values_are_said_to_be_numbers():
    for change in (lambda x: 2 * x, lambda x: x + 1e-5, lambda x: -1.0 * x):
        assert "True or False is asked" in said("same_points", change)


def test_truth_values_have_no_sign_or_order():
    assert "order" not in said("same_points", lambda x: np.roll(x, 1))


def named(function, reference, inputs, *slips, special=()):
    """Name the mistake of a function in an exercise of one argument, x."""
    foreseen = tuple(Misconception(n, f"It is {n}.", gives, same=s) for n, gives, s in slips)
    cases = [Case((x,)) for x in inputs] + [Case((x,), about="special") for x in special]
    properties = Property("It is right."), Property("It is right there, too.", about="special")
    exercise = Exercise(
        "one", 1, "One.", "Of x.", ("",), lambda _: cases, properties, foreseen, reference,
        stub="def my_one(x): ...",
    )  # fmt: skip
    outcomes = [attempt(function, args) for args in exercise.inputs(SEED)]
    return judge(exercise, outcomes, SEED).misconception


DOUBLED = ("doubled", lambda x: 2 * x, None)


def test_a_mistake_beside_another_has_to_be_wrong_on_two_usual_inputs():
    def my_square(x):
        return 2 * x if x else 7.0

    assert named(my_square, np.square, [1.0, 2.0, 3.0], DOUBLED, special=[0.0]) == "doubled"
    assert named(my_square, np.square, [1.0, 2.0], DOUBLED, special=[0.0]) != "doubled"


def test_a_mistake_is_known_though_one_input_gave_no_numbers():
    def my_square(x):
        return 2 * x / (x != 4.0) if x != 4.0 else None

    assert named(my_square, np.square, [1.0, 3.0, 4.0], DOUBLED) == "doubled"


def test_a_mistake_that_is_right_where_the_student_is_wrong_is_another_one():
    near = ("near", np.square, within(1.0))
    assert named(lambda x: x * x + 0.5, np.square, [1.0, 3.0], near) != "near"


def test_an_input_that_slipped_has_an_answer_in_every_case():
    def inverse(x):
        if x == 0:
            raise ValueError
        return 6 / x

    assert named(lambda x: 6 / int(x), inverse, [1.5, 2.5]) == "x without decimals"
    assert named(lambda x: 6 / int(x) if x > 1 else np.nan, inverse, [0.5, 2.5]) is None


def test_a_single_number_of_a_single_case_may_be_right_but_for_its_sign_by_chance():
    assert named(lambda x: -x * x, np.square, [1.0, 2.0, 3.0]) == "sign"
    assert named(lambda x: x * x if x < 3 else -9.0, np.square, [1.0, 2.0, 3.0]) is None


def test_one_row_for_all_is_no_mistake_where_it_is_right():
    def rows(x):
        return np.full((4, 2), x)

    assert named(lambda x: rows(x) ** [2, 3], rows, [2.0, 3.0]) != "one row for all"
    different = np.arange(8.0).reshape(4, 2)
    assert named(lambda x: rows(x) ** 3, lambda x: x * different, [2.0, 3.0]) == "one row for all"


def test_numbers_are_laid_out_otherwise_only_if_all_others_are_right():
    one, three = np.array([5.0]), np.array([1.0, 2.0, 4.0])

    def my_copy(x):
        return x[:1] if len(x) > 1 else 3 * x

    assert named(lambda x: x[:1], np.copy, [one, three]) == "the first only"
    assert named(lambda x: x[:2], np.copy, [one, three]) == "columns left out"
    assert named(my_copy, np.copy, [one, three]) == "numbers too few"
