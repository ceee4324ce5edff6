"""Rules in place of lists: nearly, the step that is missing, and families of slips."""

# Wrong answers leave arguments out.
# ruff: noqa: ARG001, ARG005

import ast
import inspect
import sys
import time
from dataclasses import replace
from importlib.util import find_spec, module_from_spec
from itertools import count

import numpy as np
import pytest
import test_exercises_second

from cvnotes.base import CvnotesError
from cvnotes.learn import EXERCISES, check
from cvnotes.learn.exercises import COURSE
from cvnotes.tutor import Case, edited, mistakes
from cvnotes.tutor.checker import repairs, steps
from cvnotes.tutor.checker.attempt import attempt
from cvnotes.tutor.checker.difference import VAGUE
from cvnotes.tutor.checker.families import family_of
from cvnotes.tutor.checker.judge import holds, judge
from cvnotes.tutor.checker.outcome import outcome_of
from cvnotes.tutor.checker.probes import probed
from cvnotes.tutor.checker.repairs import pointed, repaired
from cvnotes.tutor.checker.soundness import judged
from cvnotes.tutor.checker.steps import lines_of, located
from cvnotes.tutor.course import Session

pytestmark = pytest.mark.once

SEED = 2024
FUNCTIONS = [e for e in EXERCISES.values() if e.answer == "function"]
WITH_STEPS = [e for e in FUNCTIONS if e.steps is not None]
each_with_steps = pytest.mark.parametrize("exercise", WITH_STEPS, ids=lambda e: e.name)


@pytest.fixture
def time_enough(monkeypatch):
    monkeypatch.setattr(repairs, "_PATIENCE", 9.0)


@pytest.fixture(autouse=True)
def first_day(monkeypatch):
    monkeypatch.setattr(COURSE, "session", Session())


@each_with_steps
def test_the_steps_are_lines_with_words(exercise):
    function, lines = lines_of(exercise.steps)
    assert isinstance(function.body[-1], ast.Return)
    assert not any(isinstance(n, ast.While) for n in ast.walk(function))
    for line in lines[:-1]:
        unpacked = "," in line.code.partition(" = ")[0]
        assert unpacked or "`" not in line.words, f"say in a comment what it is: {line.code}"


@each_with_steps
def test_the_second_answer_is_not_said_to_leave_the_way(exercise):
    found = located(getattr(test_exercises_second, f"my_{exercise.name}"), exercise)
    assert found is None or found.missing is None


# Wrong answers as students write them, and what is said of the step.


def error_bars_of_n(J, r):
    n = len(r)
    var = (r**2).sum() / n
    N = J.T @ J
    cov = var * np.linalg.inv(N)
    return [cov[i, i] ** 0.5 for i in range(len(N))]


def error_bars_of_reciprocals(J, r):
    n, p = J.shape
    s2 = (r * r).sum() / (n - p)
    N = J.T @ J
    Q = np.zeros((p, p))
    for i in range(p):
        Q[i] = 1 / N[i]
    return np.sqrt(s2 * np.diag(Q))


def project_from_a_frame_of_its_own(A, R, T, W):
    out = []
    for w in W:
        M = R.T @ (w - T)
        m = A @ M
        out.append(m[:2] / m[2])
    return np.array(out)


def distort_with_odd_powers(xy, k, p):
    x, y = xy[:, 0], xy[:, 1]
    r = np.sqrt(x**2 + y**2)
    radial = 1 + k[0] * r**2 + k[1] * r**3
    u = x * radial + 2 * p[0] * x * y + p[1] * (r**2 + 2 * x**2)
    v = y * radial + p[0] * (r**2 + 2 * y**2) + 2 * p[1] * x * y
    return np.column_stack([u, v])


def A_from_b_without_the_scale(b):
    b11, b12, b22, b13, b23, b33 = b * np.sign(b[0])
    v = (b12 * b13 - b11 * b23) / (b11 * b22 - b12**2)
    lam = b33 - b13**2 / b11
    fu = np.sqrt(lam / b11)
    fv = np.sqrt(lam * b11 / (b11 * b22 - b12**2))
    skew = -b12 * fu**2 * fv / lam
    u = skew * v / fv - b13 * fu**2 / lam
    return np.array([[fu, skew, u], [0, fv, v], [0, 0, 1]])


def covariance_of_fixed_poses(Jc, Jp):
    S = 0
    for C, P in zip(Jc, Jp, strict=True):
        mixed = C.T @ P
        share = mixed @ P.T @ C
        S = S + C.T @ C - share
    return np.linalg.inv(S)


def normaliser_of_squares(x):
    c = x.mean(axis=0)
    d = np.sqrt(((x - c) ** 2).sum(axis=1).mean())
    s = np.sqrt(2) / d
    return np.array([[s, 0, -s * c[0]], [0, s, -s * c[1]], [0, 0, 1]])


def crop_without_half_a_pixel(A, corner, s):
    centre = A[:2, 2] - corner
    u, v = centre * s
    return np.array([[s * A[0, 0], s * A[0, 1], u], [0, s * A[1, 1], v], [0, 0, 1]])


def mapped(H, points):
    lifted = np.hstack([points, np.ones((len(points), 1))])
    m = lifted @ H
    return m[:, :2] / m[:, 2:]


def error_by_a_function_of_my_own(H, src, dst):
    return np.linalg.norm(mapped(H, src) - dst, axis=1)


def four_pixels_of_two_rows(image, u, v):
    i, j = int(u), int(v)
    du, dv = u - i, v - j
    i2 = min(i + 1, image.shape[1] - 1)
    j2 = min(j + 1, image.shape[0] - 1)
    top = image[j, i] * (1 - du) + image[j, i2] * du
    bottom = image[j2, i] * (1 - du) + image[j, i2] * du
    return top * (1 - dv) + bottom * dv


def warp_pixel_by_pixel(image, H, size):
    out = np.zeros((size[1], size[0]))
    for v in range(size[1]):
        for u in range(size[0]):
            p = np.linalg.inv(H) @ [u, v, 1]
            x, y = p[:2] / p[2]
            i, j = int(x), int(y)
            if 0 <= i < image.shape[1] and 0 <= j < image.shape[0]:
                out[v, u] = image[j, i]
    return out


def holes_one_by_one(m, size):
    hit = np.zeros((size[1], size[0]))
    for u, v in m:
        i, j = int(u), int(v)
        if 0 <= i < size[0] and 0 <= j < size[1]:
            hit[j, i] = 1
    return (hit == 0).sum()


def bilinear_with_one_index_for_both(image, u, v):
    i, j = int(u), int(v)
    du, dv = u - i, v - i
    i2 = min(i + 1, image.shape[1] - 1)
    j2 = min(j + 1, image.shape[0] - 1)
    top = image[j, i] * (1 - du) + image[j, i2] * du
    bottom = image[j2, i] * (1 - du) + image[j2, i2] * du
    return top * (1 - dv) + bottom * dv


LOCATED = [
    ("bilinear", bilinear_with_one_index_for_both, "v - i", "what is left of v"),
    ("bilinear", four_pixels_of_two_rows, "image[j2, i] * (1 - du) + image[j, i2] * du",
     "the grey level in the lower row"),
    ("backward_warp", warp_pixel_by_pixel, "int(x), int(y)", "the nearest pixels"),
    ("count_holes", holes_one_by_one, "int(u), int(v)", "the nearest pixels"),
    ("error_bars", error_bars_of_n, "(r**2).sum() / n", "σ², the variance of the residuals"),
    ("error_bars", error_bars_of_reciprocals, "1 / N[i]", "(JᵀJ)⁻¹"),
    ("project", project_from_a_frame_of_its_own, "R.T @ (w - T)", "the points in the camera's"),
    ("distort", distort_with_odd_powers, "1 + k[0] * r**2 + k[1] * r**3", "the radial factor L"),
    ("A_from_b", A_from_b_without_the_scale, "b33 - b13**2 / b11", "the scale λ of B"),
    ("camera_covariance", covariance_of_fixed_poses, "mixed @ P.T @ C", "what each pose takes"),
    ("normaliser", normaliser_of_squares, "np.sqrt(((x - c) ** 2).sum(axis=1).mean())",
     "the mean distance"),
    ("new_intrinsics", crop_without_half_a_pixel, "centre * s", "the principal point, scaled"),
    ("geometric_error", error_by_a_function_of_my_own, "lifted @ H", "where H takes src, homog"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "function", "place", "words"), LOCATED)
def test_the_first_wrong_step_is_named_in_the_students_own_expression(name, function, place, words):
    found = located(function, EXERCISES[name])
    assert found is not None
    assert found.missing is not None, found.sentence
    assert found.first
    assert "First wrong: " in found.sentence
    assert (found.place, found.missing.words[: len(words)]) == (place, words)
    for said, _ in found.agreed:
        assert said != found.missing.words


def test_what_is_right_so_far_is_said_in_the_students_own_expressions():
    found = located(error_bars_of_reciprocals, EXERCISES["error_bars"])
    assert found.sentence == (
        "Right so far: σ², the variance of the residuals (`s2`), JᵀJ (`J.T @ J`). First wrong: "
        "`1 / N[i]`; there belongs (JᵀJ)⁻¹."
    )


def test_where_nothing_is_proven_nothing_is_claimed():
    def another_way(J, r):
        n, p = J.shape
        s2 = r @ r / (n - p)
        return np.sqrt(s2) * np.abs(np.linalg.pinv(J)).sum(axis=1)

    found = located(another_way, EXERCISES["error_bars"])
    assert found.missing is None
    assert found.sentence == "Up to here it agrees: σ², the variance of the residuals (`s2`)."
    assert located(np.linalg.inv, EXERCISES["error_bars"]) is None
    assert located(lambda J, r: np.zeros(J.shape[1]), EXERCISES["error_bars"]) is None
    exec("def nowhere(J, r): return r", names := {})
    assert located(names["nowhere"], EXERCISES["error_bars"]) is None


def test_where_no_input_changes_with_the_seed_the_largest_stand_for_them():
    def steps(c, r):
        n = c + r  # all corners of a row and a column
        return (n % 2 == 1) * 1.0

    boards = Case((np.array([9, 8, 7, 5]), np.array([6, 6, 7, 4])))
    same = EXERCISES["same_points"]
    exercise = replace(same, cases=lambda _: [boards], steps=steps, reference=steps)
    assert located(lambda c, r: (c - 2.5 * r) % 2 == 1, exercise) is None


def test_a_function_that_ends_everything_is_located_without_harm():
    def ends(J, r):
        s2 = r @ r / len(r)
        import os

        os._exit(3)
        return s2

    assert located(ends, EXERCISES["error_bars"]) is None


def test_a_slow_function_is_not_run_again_and_again():
    runs = []

    def slow(J, r):
        runs.append(sum(i for i in range(1_500_000)))
        return np.sqrt(np.diag(np.linalg.inv(J.T @ J))) * r.std()

    found = located(slow, EXERCISES["error_bars"])
    assert found is None
    assert runs == []  # it ran in a process of its own


def test_the_search_ends_when_the_time_is_over(monkeypatch):
    assert located(error_bars_of_n, EXERCISES["error_bars"]) is not None
    ticks = count()
    monkeypatch.setattr(steps, "clock", lambda: float(next(ticks)))
    assert located(error_bars_of_n, EXERCISES["error_bars"]) is None


def test_in_a_browser_the_clock_is_one_that_moves(monkeypatch):
    monkeypatch.setattr(sys, "platform", "emscripten")
    spec = find_spec("cvnotes.tutor.checker.in_process")
    there = module_from_spec(spec)
    spec.loader.exec_module(there)
    assert there.clock is time.perf_counter


def test_the_formula_comes_with_the_second_refusal():
    first = check("error_bars", error_bars_of_n)
    again = check("error_bars", error_bars_of_n)
    assert first.misconception == again.misconception == "n for n − p"
    assert "First wrong: `(r**2).sum() / n`" in repr(first)
    assert "r @ r / (n - p)" not in repr(first)
    assert "It is s2 = r @ r / (n - p)." in repr(again)
    assert "It is s2 = r @ r / (n - p)." in again._repr_html_()


def test_what_reads_wrong_numbers_is_not_called_the_first_that_is_wrong():
    def by_least_squares(row):
        u, v = row.T
        m, t = np.polyfit(u, v, 1)
        return np.max(np.abs(m * u - v + t) / np.sqrt(m**2 + 1))

    found = located(by_least_squares, EXERCISES["bend"])
    assert not found.first  # m and t are wrong already
    assert found.sentence.startswith("Wrong by then: `np.abs(m * u - v + t)")


# What it hangs on that an answer is wrong.


def shifted_after_the_division(A, R, T, W):
    M = W @ R.T
    return ((M / M[:, 2:] + T) @ A.T)[:, :2] / (M[:, 2:] / M[:, 2:] + T[2])


def ratio(A, width):
    return np.arctan(width / A[0, 0])


def axes_of_any_length(R, left, right):
    x = R @ (right - left)
    y = np.cross([0, 0, 1], x)
    return np.stack([x, y, np.cross(x, y)]) / np.linalg.norm(x)


def factor_without_the_second_power(A, k, G, W, m):
    M = W @ G[:3, :3].T + G[:3, 3]
    x, y = (M[:, :2] / M[:, 2:]).T
    L = 1 + k[0] * (x**2 + y**2)
    return (m - np.stack([A[0, 0] * L * x + A[0, 2], A[1, 1] * L * y + A[1, 2]], axis=1)) ** 2


def rows_alone(horizon, v, post, h, person):
    tall, high = (x[0, 1] - x[1, 1] for x in (person, post))
    return h / high * post[0, 1] / person[0, 1] * tall


PROBED = [
    ("project", shifted_after_the_division, "right with T left out",
     "Were the input simpler, with T left out, your answer would be right: that is where to look."),
    ("field_of_view", ratio, "independent of u0 of A",
     "Your answer does not depend on u0 of A; the right one does."),
    ("residuals", factor_without_the_second_power, "independent of γ of A and k[1]",
     "Your answer does not depend on γ of A and k[1]; the right one does."),
    ("person_height", rows_alone, "independent of horizon and v",
     "Your answer does not depend on horizon and v; the right one does."),
    ("rectifying_rotation", axes_of_any_length, "another with R scaled by its last number",
     "The right answer stays the same with R scaled by its last number; yours does not."),
]  # fmt: skip


@pytest.mark.parametrize(("name", "function", "called", "sentence"), PROBED)
def test_what_nothing_explains_is_asked_what_it_hangs_on(name, function, called, sentence):
    found = probed(function, EXERCISES[name])
    assert (found.name, found.sentence) == (called, sentence)


@each_with_steps
def test_of_what_is_right_nothing_is_said_to_hang_on_an_input(exercise):
    assert probed(getattr(test_exercises_second, f"my_{exercise.name}"), exercise) is None


@pytest.mark.parametrize(("name", "function"), [
    ("same_points", lambda a, b: a[:, 0] == b[:, 0]), ("count_holes", lambda m, size: size[0]),
    ("ransac", lambda src, dst, draws, t: (4, 9)),
])  # fmt: skip
def test_counts_and_yes_or_no_may_be_the_same_by_chance(name, function):
    assert probed(function, EXERCISES[name]) is None


def test_what_an_answer_hangs_on_is_its_name_if_it_has_no_other():
    report = check("field_of_view", lambda A, width: np.rad2deg(ratio(A, width)))
    assert report.misconception == "independent of u0 of A"
    assert report.located == "Your answer does not depend on u0 of A; the right one does."


# What puts a student's own code right, whatever its road.


def angle_by_the_lengths(A, width):
    left, right = (np.linalg.solve(A, [u, A[1, 2], 1]) for u in (-0.5, width - 0.5))
    return np.arccos(left @ right / np.linalg.norm(left) * np.linalg.norm(right))


def products_subtracted(H, i, j):
    a, b = H[:, i - 1], H[:, j - 1]
    M = np.outer(a, b) - np.outer(b, a)
    return [M[0, 0] / 2, M[0, 1], M[1, 1] / 2, M[0, 2], M[1, 2], M[2, 2] / 2]


def a_hill_for_a_saddle(patch):
    v, u = np.indices(patch.shape).reshape(2, -1)
    D = np.stack([u * u, u * v, v * v, u, v, 0 * u + 1], axis=1)
    a, b, c, d, e, _ = np.linalg.pinv(D) @ patch.ravel()
    if b**2 - 4 * a * c > 0:
        return [np.nan, np.nan]
    return np.linalg.solve([[2 * a, b], [b, 2 * c]], [-d, -e])


def joined(a, b):
    return np.cross([*a, 1], [*b, 2])


def a_line_by_a_function_of_its_own(p, q):
    return joined(p, q)


def weights_of_one_pixel(image, u, v):
    total = 0
    for row, column in np.ndindex(image.shape):
        total += max(0, abs(u - column)) * max(0, 1 - abs(v - row)) * image[row, column]
    return total


REPAIRED = [
    ("field_of_view", angle_by_the_lengths, "a product divided, or a fraction upside down,",
     "left @ right / np.linalg.norm(left) / np.linalg.norm(right)"),
    ("v_ij", products_subtracted, "another sign", "np.outer(a, b) + np.outer(b, a)"),
    ("saddle_point", a_hill_for_a_saddle, "another comparison", "b ** 2 - 4 * a * c < 0"),
    ("line_through", a_line_by_a_function_of_its_own, "another number", "[*b, 1]"),
    ("bilinear", weights_of_one_pixel, "1 less what is there,", "1 - abs(u - column)"),
]  # fmt: skip


@pytest.mark.usefixtures("time_enough")
@pytest.mark.parametrize(("name", "function", "what", "exact"), REPAIRED)
def test_what_puts_the_students_own_code_right_is_said_whatever_its_road(
    name, function, what, exact
):
    found = repaired(function, EXERCISES[name])
    assert found.sentence.startswith(f"It comes out right with {what} in `")
    assert found.exact == exact
    assert exact not in found.sentence  # the formula is for the second refusal


@pytest.mark.usefixtures("time_enough")
def test_where_nothing_was_named_the_repair_is_said_behind_what_agrees():
    bilinear = EXERCISES["bilinear"]
    found = pointed(weights_of_one_pixel, bilinear)
    assert found.name == "from 1 in `abs(u - column)`"
    assert found.sentence == "It comes out right with 1 less what is there, in `abs(u - column)`."
    assert found.exact == "1 - abs(u - column)"
    named = pointed(weights_of_one_pixel, bilinear, "its own name")
    assert (named.name, named.sentence) == ("", "")


@each_with_steps
def test_what_is_right_is_not_put_right(exercise):
    assert repaired(getattr(test_exercises_second, f"my_{exercise.name}"), exercise) is None


def test_searches_end_after_so_many_tries(monkeypatch):
    bilinear = EXERCISES["bilinear"]
    assert repaired(weights_of_one_pixel, bilinear) is not None
    assert located(four_pixels_of_two_rows, bilinear).missing is not None
    monkeypatch.setattr(repairs, "_TRIES", 1)
    monkeypatch.setattr(steps, "_TRIES", 1)
    assert repaired(weights_of_one_pixel, bilinear) is None
    assert located(four_pixels_of_two_rows, bilinear).missing is None


def test_a_loop_that_may_never_end_is_left_alone():
    def halves(s, k):
        while s.max() > 1e9:
            s = s / 2
        return s - 1

    assert repaired(halves, EXERCISES["inverse_radius"]) is None


def test_a_step_is_not_named_where_any_number_does():
    found = located(a_hill_for_a_saddle, EXERCISES["saddle_point"])
    assert found.missing is None  # 4 a c decides about yes or no, as many numbers do


@pytest.mark.usefixtures("time_enough")
def test_a_part_of_a_step_is_named_to_whoever_has_parts():
    def by_coordinates(A, R, T, k, W):
        M = R @ W.T + T[:, None]
        x, y = M[0] / M[2], M[1] / M[1]
        L = 1 + k[0] * (x * x + y * y) + k[1] * (x * x + y * y) ** 2
        return (A @ np.array([L * x, L * y, np.ones_like(x)]))[:2].T

    found = located(by_coordinates, EXERCISES["form_image"])
    assert (found.place, found.missing.words[:19]) == ("M[1] / M[1]", "its part of the ide")


def without_skew_and_turned_back(A, R, T, W):
    M = W @ R + T
    return M[:, :2] / M[:, 2:] * np.diag(A)[:2] + A[:2, 2]


def rows_by_H_and_a_sum(H, src, dst):
    m = np.column_stack([src, np.ones(len(src))]) @ H
    return np.abs(m[:, :2] / m[:, 2:] - dst).sum(axis=1)


TWICE = [
    ("project", without_skew_and_turned_back, "A without its skew, and R transposed"),
    ("geometric_error", rows_by_H_and_a_sum, "H transposed, and no distance"),
    ("lift", lambda x, w: np.insert(np.asarray(x, float), 0, w, axis=1),
     "w appended only, and moved on"),
    ("rectifying_rotation", lambda R, left, right: axes_in_columns(R, left, right),
     "z axis kept, and transposed"),
]  # fmt: skip


def axes_in_columns(R, left, right):
    x = (right - left) / np.linalg.norm(right - left)
    y = np.cross(R[2], x)
    return np.array([x, y / np.linalg.norm(y), R[2]]).T


@pytest.mark.usefixtures("time_enough")
@pytest.mark.parametrize(("name", "function", "called"), TWICE)
def test_two_mistakes_at_once_have_both_names(name, function, called):
    report = said_of(EXERCISES[name], function)
    assert report.misconception == called
    assert report.message.startswith("Two things: ")


def test_what_explains_alone_is_not_called_two_things():
    right = EXERCISES["dlt"].reference
    for seed in (SEED, 11, 12):
        report = judged(EXERCISES["dlt"], lambda *args: np.square(right(*args)), seed)
        assert report.misconception == "squared"


def test_counts_are_not_explained_by_nonsense_that_gives_the_same():
    def all_four_agree(src, dst, draws, t):
        return 4, np.ceil(np.log(0.001) / np.log(1 - (4 / len(src)) ** 4))

    report = said_of(EXERCISES["ransac"], all_four_agree)
    assert "src" not in (report.misconception or "")


def bare(name):
    return replace(EXERCISES[name], misconceptions=())


def said_of(exercise, function):
    outcomes = [attempt(function, args) for args in exercise.inputs(SEED)]
    return judge(exercise, outcomes, SEED)


@pytest.mark.parametrize(
    ("name", "change", "called"),
    [
        ("A_from_b", ("-B12 * au**2", "B12 * au**2"), "sign in the skew γ"),
        ("A_from_b", ("what is not there", "0"), None),
        ("distort", ("k[1] * r2**2", "k[1] * r2**3"), "power in the radial factor L"),
        ("error_bars", ("r @ r / (n - p)", "r @ r / n"), "left out in σ², the variance of the"),
        ("extrinsics", ("U @ Vt", "U @ Vt.T"), "transposition in the nearest rotation"),
        ("new_intrinsics", ("s * (c + 0.5) - 0.5", "s * c + 0.5 - 0.5"), "brackets in the princ"),
        ("geometric_error", ("axis=1", "axis=0"), "axis in what is returned"),
        ("undistortion_map", ("(u - A[0, 2])", "(v - A[0, 2])"), "name in the ideal x"),
        ("residuals", ("k[1] * r2**2", "k[1] * r2"), "left out in the radial factor L"),
        ("undistort", ("k1 * r**3", "k1 * r**2"), "power in the radius"),
        (
            "inverse_radius",
            ("r + k1 * r**3 + k2", "r - k1 * r**3 + k2"),
            "sign in the radii, halved",
        ),
        ("residuals", ("m - seen", "seen"), "stopped in the predicted pixels"),
        ("saddle_point", ("np.linalg.solve(M, -g)", "g"), "stopped in the derivatives at (0, 0)"),
    ],
)
def test_a_slip_is_named_by_its_place(name, change, called):
    if change[0] not in inspect.getsource(EXERCISES[name].steps):
        with pytest.raises(CvnotesError, match="does not stand in these steps"):
            edited(EXERCISES[name].steps, *change)(1)
        return
    report = said_of(bare(name), edited(EXERCISES[name].steps, *change))
    assert report.misconception.startswith(called), report.misconception
    assert report.exact


def test_a_slip_is_named_though_noise_was_not_cured_either():
    steps = EXERCISES["extrinsics"].steps
    not_cured = ("R = U @ Vt", "R = np.column_stack([r1, r2, r3])")
    report = said_of(bare("extrinsics"), edited(steps, "(r1, r2)", "(r2, r1)", *not_cured))
    assert report.misconception == "order in r3"


@pytest.mark.parametrize(("name", "n", "what"), [
    ("dlt", 4, "the first 4 of src and dst"), ("radial_fit", 2, "the first 2 of xy and xy_lens"),
    ("camera_covariance", 1, "the first one of Jc and Jp"),
])  # fmt: skip
def test_whoever_used_the_first_rows_only_is_told(name, n, what):
    right = EXERCISES[name].reference
    report = said_of(bare(name), lambda *args: right(*(x[:n] for x in args)))
    assert report.misconception == f"only {what}"
    assert f"used only {what}" in report.message


def with_a_sorted_scale(t, m, q):
    return EXERCISES["measure_along"].reference(np.sort(t), m, q)


def by_the_rows(A, width):
    return np.arctan((A[1, 2] + 0.5) / A[1, 1]) + np.arctan((width - 0.5 - A[1, 2]) / A[1, 1])


@pytest.mark.parametrize(("name", "function", "called"), [
    ("measure_along", with_a_sorted_scale, "t sorted"),
    ("field_of_view", by_the_rows, "A with α_v and v0 for α_u and u0"),
    ("v_ij", lambda H, i, j: EXERCISES["v_ij"].reference(np.roll(H, -1, axis=1), i, j),
     "columns moved back in H"),
    ("A_from_b", lambda b: EXERCISES["A_from_b"].reference(b[[0, 1, 3, 2, 4, 5]]),
     "b[2] and b[3] exchanged"),
])  # fmt: skip
def test_an_input_that_slipped_is_named(name, function, called):
    assert said_of(EXERCISES[name], function).misconception == called


def test_what_was_done_to_usual_answers_is_said_where_special_inputs_hide_it():
    def counted_from_1_and_never_nothing(patch):
        v, u = np.indices(patch.shape).reshape(2, -1) + 1
        D = np.stack([u * u, u * v, v * v, u, v, 0 * u + 1], axis=1)
        a, b, c, d, e, _ = np.linalg.pinv(D) @ patch.ravel()
        return np.linalg.solve([[2 * a, b], [b, 2 * c]], [-d, -e])

    report = said_of(EXERCISES["saddle_point"], counted_from_1_and_never_nothing)
    assert report.misconception == "a constant added"
    assert report.message.startswith("Special inputs aside: Your answer is the right one plus 1 ")
    # NaN that was meant is no accident
    assert said_of(EXERCISES["saddle_point"], a_hill_for_a_saddle).misconception is None


# How many slips of the steps are right answers, and why; no other is accepted.
EQUIVALENT = {
    "bend": (4, "a chord has two directions, and a distance no sign"),
    "line_through": (16, "a line has any scale; the last coordinates of both points are 1"),
    "meet": (2, "a point has any sign"),
    "same_points": (12, "nearly 0 by any small bound; a and b may be exchanged"),
    "measure_along": (18, "along any direction but the one across; m[0] is counted from itself"),
    "focal_from_vanishing_points": (2, "a dot product of two differences, in any order and sign"),
    "person_height": (7, "the same factor or sign in both heights, of which the quotient is taken"),
    "nearest_rotation": (6, "det U Vᵀ in other words; F is a diagonal"),
    "rq": (3, "A is divided by its last number; a dot product the other way round"),
    "undistort": (15, "any start of the iteration, and any slope that settles in the same place"),
    "inverse_radius": (10, "any lower bound below 0 of the bisection"),
    "harris_measure": (1, "uv is squared"),
    "saddle_point": (6, "the column of ones times any number"),
    "design_matrix": (1, "equations in any order"),
    "normaliser": (1, "a distance has no sign"),
    "dlt": (2, "the scale and centre of the other picture normalise, too"),
    "four_points": (4, "±0, and equations in any order"),
    "geometric_error": (1, "a distance has no sign"),
    "ransac": (2, "a distance has no sign, nor has q⁴"),
    "v_ij": (2, "B is symmetric"),
    "b_from_views": (17, "equations in any order, of any sign and weight"),
    "A_from_b": (11, "B of either sign; a product divided in another order"),
    "extrinsics": (6, "‖h1‖ = ‖h2‖; the last row of A⁻¹; the nearest rotation evens lengths out"),
    "focal_from_turn": (2, "lengths of two entries in any order"),
    "levenberg_marquardt": (14, "any damping that grows and shrinks leads to the minimum"),
    "camera_covariance": (1, "a symmetric matrix transposed"),
    "bilinear": (4, "min in any order; int cuts off what is positive as floor does"),
    "backward_warp": (1, "ones of the same shape"),
    "count_holes": (1, "width × height in any order"),
    "rectifying_rotation": (1, "the base line has the direction of x"),
    "between_rays": (7, "dot products in any order; all cross products the other way round"),
    "depth": (1, "a product divided in another order"),
    "error_bars": (1, "r @ r in any order"),
    "jackknife": (7, "a standard deviation has no sign, nor what is squared"),
}
# Right on some seeds: steps by μ D − N lead downhill, too, and now and then as far as the minimum.
LUCKY = {"levenberg_marquardt": 1}


@each_with_steps
@pytest.mark.slow
@pytest.mark.once
def test_every_slip_is_an_answer_that_is_refused_on_all_seeds_or_right_on_all(exercise):
    family, seeds = family_of(exercise.steps), range(20)
    cases = [sorted(exercise.solved_cases(seed), key=lambda case: case.size) for seed in seeds]
    right = lucky = 0
    assert len(family.slips) >= 10
    for slip in family.slips:
        gives = family.gives(slip)
        accepted = {
            all(holds(exercise, case, attempt(gives, case.args)) for case in each) for each in cases
        }
        line = family.lines[slip.lines[0]].code
        lucky += len(accepted) > 1
        assert lucky <= LUCKY.get(exercise.name, 0), ("right on some seeds", slip, line)
        right += accepted == {True}
    assert right == EQUIVALENT.get(exercise.name, (0,))[0]


@each_with_steps
@pytest.mark.slow
@pytest.mark.once
def test_every_pair_of_slips_is_refused_on_all_seeds_or_right_on_all(exercise):
    family = family_of(exercise.steps)
    assert family.pairs or family.loops
    cases = [sorted(exercise.solved_cases(seed), key=lambda case: case.size) for seed in range(20)]
    for pair in family.pairs:
        gives = family.gives(pair)
        accepted = {
            all(holds(exercise, case, attempt(gives, case.args)) for case in each) for each in cases
        }
        assert len(accepted) == 1, [family.lines[i].code for i in pair.lines]


def test_a_family_is_made_once_and_its_results_are_kept():
    family = family_of(EXERCISES["distort"].steps)
    assert family_of(EXERCISES["distort"].steps) is family
    assert all(place == 0 for place in family.switches.places)


SIZES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2)


def noise(x):
    return np.random.default_rng(7).normal(size=x.shape)


def largest(x):
    return np.abs(x[np.isfinite(x)]).max()


def to_digits(x, n):
    """Round to n significant digits."""
    return np.array([float(f"{value:.{n}g}") for value in x.ravel()]).reshape(x.shape)


DISTURBED = {
    **{f"{n} decimals": lambda x, n=n: np.round(x, n) for n in range(3, 9)},
    **{f"{n} decimals, cut off": lambda x, n=n: np.trunc(x * 10**n) / 10**n for n in range(3, 9)},
    **{f"{n} digits": lambda x, n=n: to_digits(x, n) for n in range(3, 9)},
    "float16": lambda x: x.astype(np.float16),
    "float32": lambda x: x.astype(np.float32),
    **{f"noise of {s:g}": lambda x, s=s: x * (1 + s * noise(x)) for s in SIZES},
    **{f"noise of {s:g} of the largest": lambda x, s=s: x + s * largest(x) * noise(x)
       for s in SIZES},
}  # fmt: skip
# What may be said of numbers that differ in their digits; float16 ends at 65,504.
TRUE = {"nearly", "few decimals", "rounded", "a few numbers", "infinity too often",
        "neither True nor False", None}  # fmt: skip


@pytest.mark.parametrize("exercise", FUNCTIONS, ids=lambda e: e.name)
def test_what_differs_in_its_digits_gets_no_false_name(exercise):
    for what, change in DISTURBED.items():
        report = said_of(
            exercise, lambda *args, c=change: c(np.asarray(exercise.reference(*args), dtype=float))
        )
        if not report.passed:
            assert report.misconception in TRUE, (what, report)


def test_r_for_its_transpose_is_not_nearly_right_though_t_is_long():
    def turned(A, H):
        G = np.array(EXERCISES["extrinsics"].reference(A, H))
        G[:3, :3] = G[:3, :3].T
        return G

    assert said_of(bare("extrinsics"), turned).misconception != "nearly"


def test_single_precision_in_a_list_of_mixed_numbers_is_single_precision():
    def of_singles(A, corner, s):
        A = A.astype(np.float32)
        u0, v0 = s * (A[:2, 2] - corner.astype(np.float32) + np.float32(0.5)) - np.float32(0.5)
        return np.array([[s * A[0, 0], s * A[0, 1], u0], [0, s * A[1, 1], v0], [0, 0, 1]])

    assert said_of(EXERCISES["new_intrinsics"], of_singles).passed
    assert outcome_of([0.1, np.float32(0.1)]).dtype == "float64"
    assert outcome_of([0.25, 383163.0, np.inf]).dtype == "float64"  # short, and rounded


def test_whole_numbers_at_any_scale_are_told_as_such_on_every_seed():
    exercise = EXERCISES["b_from_views"]
    for seed in (SEED, 11):
        report = judged(exercise, lambda H: np.round(exercise.reference(H)), seed)
        assert report.misconception == "few decimals"
        assert "rounded to no decimals" in report.message


def test_what_is_nearly_0_is_not_taken_for_0():
    report = said_of(EXERCISES["person_height"], lambda *args: 1e-12 * args[-1][0, 0])
    assert report.misconception is None, report


def test_rounded_numbers_are_nearly_right():
    for name in ("dlt", "four_points", "normaliser", "horizon"):
        right = EXERCISES[name].reference
        noise = np.random.default_rng(1).normal(size=9)

        def nearly(*args, f=right, n=noise):
            x = np.asarray(f(*args))
            return x * (1 + 1e-4 * n[: x.size].reshape(x.shape))

        report = said_of(EXERCISES[name], nearly)
        assert report.misconception == "nearly", (name, report)
        assert "nearly" in VAGUE


def test_a_row_is_a_misconception():
    [one] = mistakes(("twice", "That is twice the answer.", lambda x: 2 * x, lambda x: x + x))
    assert (one.name, one.gives(3), one.variants[0](3)) == ("twice", 6, 6)


# Answers that were right on some seeds, or on all, until a case was there that closes it.


def nothing_where_the_world_is_level(A, R, d):
    if d[2] == 0:
        return np.full(2, np.nan)
    m = A @ R @ d
    return m[:2] / m[2]


def horizon_without_skew(A, R, n):
    B = A.copy()
    B[0, 1] = 0
    return np.linalg.inv(B).T @ R @ n


HOLES = [
    ("vanishing_point", nothing_where_the_world_is_level, "divided by the world's Z"),
    ("same_points", lambda a, b: (np.cross(a, b) == 0).all(axis=1), "exactly 0"),
    ("same_points", lambda a, b: np.linalg.norm(np.cross(a, b), axis=1) == 0, "exactly 0"),
    ("horizon", horizon_without_skew, "A without its skew"),
]


@pytest.mark.parametrize(("name", "function", "called"), HOLES)
def test_what_passed_on_some_seeds_is_refused_on_all(name, function, called):
    for seed in range(20):
        report = judged(EXERCISES[name], function, seed)
        assert not report.passed
        assert report.misconception == called
