"""The exercises of the course: right answers pass, every classic mistake is called by its name."""

# Functions that give a wrong answer need none of their arguments.
# ruff: noqa: ARG001, ARG005

import ast
import inspect
import re
from pathlib import Path

import numpy as np
import pytest
from test_exercises_second import solution_of

from cvnotes.base import CvnotesError
from cvnotes.learn import EXERCISES, check, hint, progress, solution
from cvnotes.learn.exercises import CHAPTERS, COURSE
from cvnotes.tutor.checker import foreseen
from cvnotes.tutor.checker.beside import beside
from cvnotes.tutor.checker.equality import up_to_scale
from cvnotes.tutor.checker.judge import judge
from cvnotes.tutor.checker.literals import as_code
from cvnotes.tutor.checker.outcome import Outcome, outcome_of
from cvnotes.tutor.checker.sandbox import ask
from cvnotes.tutor.course import MORE, Session, short_name

pytestmark = pytest.mark.usefixtures("worked_out_once")

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
SCALE_FREE = [name for name, e in EXERCISES.items() if e.same is up_to_scale]
EACH = pytest.mark.parametrize("exercise", EXERCISES.values(), ids=list(EXERCISES))


@pytest.fixture(autouse=True)
def new_session(monkeypatch):
    """Let each test begin with nothing solved."""
    monkeypatch.setattr(COURSE, "session", Session())


def _stub_of(exercise):
    names = {}
    exec(exercise.stub, names)
    return next(value for key, value in names.items() if key.startswith("my_"))


def _tried(exercise, function, seed):
    """Give outcomes without a process: for functions of our own, which do no harm."""
    outcomes = []
    for part in exercise.parts:
        outcomes += _tried(part, part.reference, seed)
    for args in exercise.inputs(seed):
        given = foreseen.what_it_gives(function, args)
        outcomes.append(Outcome("raised") if given is None else outcome_of(given))
    return outcomes


def _mistakes():
    return [(e, m) for e in EXERCISES.values() for m in e.misconceptions]


# --- the collection -------------------------------------------------------------------------


def test_there_are_enough_exercises_and_misconceptions():
    assert {f"ch{e.chapter:02d}" for e in EXERCISES.values()} == {*CHAPTERS}
    assert len(EXERCISES) >= 30
    assert len(_mistakes()) >= max(150, 5 * len(EXERCISES))
    asked_in = [COURSE.notebook_of(e) for e in EXERCISES.values()]
    assert asked_in.count("00") == 1  # the first taste
    for chapter in [*CHAPTERS][1:]:  # a notebook has room for two to six
        assert 2 <= asked_in.count(chapter[2:]) <= 6


@EACH
def test_an_exercise_is_complete(exercise):
    assert 2 <= len(exercise.hints) <= 3
    assert len(set(exercise.hints)) == len(exercise.hints)
    assert len(exercise.task) < 700
    assert len(exercise.stub.splitlines()) <= 7
    assert exercise.properties
    assert exercise.concepts
    names = [m.name for m in exercise.misconceptions]
    sentences = [m.sentence for m in exercise.misconceptions]
    assert len(set(names)) == len(names)
    assert len(set(sentences)) == len(sentences)
    assert all(s.endswith((".", "?", ".)", "”")) for s in [*sentences, exercise.task])


def test_what_an_exercise_practises_is_named_by_its_number():
    for exercise in EXERCISES.values():
        for concept in exercise.concepts:
            number = re.fullmatch(r"(E?)(\d+)|[a-s]", concept)
            assert number, (exercise.name, concept)
            if number[2]:
                assert 1 <= int(number[2]) <= (46 if number[1] else 77)


@EACH
def test_the_stub_takes_what_the_cases_give(exercise):
    for args in exercise.inputs(0):
        assert len(args) == len(exercise.arguments) or exercise.answer != "function"


@EACH
def test_the_cases_of_a_seed_are_the_same_each_time(exercise):
    for seed in (0, 2024):
        one, other = ([c.args for c in exercise.cases(np.random.default_rng(seed))] for _ in "ab")
        assert len(one) == len(other) > 0
        for a, b in zip(one, other, strict=True):
            assert all(np.array_equal(x, y) for x, y in zip(a, b, strict=True))


@EACH
def test_the_solution_is_the_source_of_the_library(exercise):
    shown = solution(exercise.name)
    assert "def " in shown.code
    assert "cvnotes" in shown.title
    assert "lambda" not in shown.code.splitlines()[0]


# --- right answers --------------------------------------------------------------------------


@EACH
def test_the_stub_is_not_solved_yet(exercise):
    report = check(exercise.name, _stub_of(exercise), student="demo")
    assert report.verdict == "not solved yet"
    assert not report.passed
    assert report.misconception is None
    assert repr(report) == f'{exercise.name}: not solved yet\n  hint("{exercise.name}") helps.'
    assert report._repr_html_().count("<p") == 0  # nothing that stands above it, or on each


@pytest.mark.once
@pytest.mark.slow
@pytest.mark.parametrize("name", SCALE_FREE)
def test_an_answer_without_a_scale_is_right_at_a_thousand_scales_of_either_sign(name):
    exercise = EXERCISES[name]
    rng = np.random.default_rng(1)
    rights = [np.asarray(exercise.reference(*args)) for args in exercise.inputs(5)]
    for _ in range(1000):
        # each result has a scale and a sign of its own
        factors = 10.0 ** rng.uniform(-6, 6, len(rights)) * rng.choice([-1, 1], len(rights))
        outcomes = [outcome_of(f * x) for f, x in zip(factors, rights, strict=True)]
        assert judge(exercise, outcomes, 5).passed, factors


@pytest.mark.once
@pytest.mark.parametrize("name", SCALE_FREE)
def test_a_scale_for_each_entry_is_one_too_many(name):
    exercise = EXERCISES[name]
    rng = np.random.default_rng(2)
    rights = [np.asarray(exercise.reference(*args)) for args in exercise.inputs(5)]
    for _ in range(20):
        bent = [x * rng.uniform(0.99, 1.01, x.shape) for x in rights]
        assert not judge(exercise, [outcome_of(x) for x in bent], 5).passed


def test_H_and_b_and_whatever_else_has_no_scale_are_compared_without():
    assert set(SCALE_FREE) == {
        "line_through", "meet", "horizon", "normaliser", "dlt", "four_points", "b_from_views",
    }  # fmt: skip


@pytest.mark.parametrize("name", ["A_from_b", "extrinsics", "geometric_error"])
def test_the_scale_of_what_is_given_does_not_matter(name):
    # The input has scales of either sign; the reference must not depend on it, nor the checker.
    signs = {np.sign(args[-1 if name == "extrinsics" else 0]).ravel()[0] for seed in range(9)
             for args in EXERCISES[name].inputs(seed)}  # fmt: skip
    assert signs == {-1.0, 1.0}


def test_rows_of_a_design_matrix_may_come_in_any_order_and_scale():
    exercise = EXERCISES["design_matrix"]
    rng = np.random.default_rng(2)

    def shuffled(src, dst):
        D = exercise.reference(src, dst)
        return rng.permutation(D) * rng.uniform(0.5, 2, (len(D), 1)) * rng.choice([-1, 1])

    assert judge(exercise, _tried(exercise, shuffled, 3), 3).passed


# --- mistakes -------------------------------------------------------------------------------


@pytest.mark.once
@EACH
@pytest.mark.parametrize("seeds", [(2024,), pytest.param(range(1, 6), marks=pytest.mark.slow)])
def test_every_misconception_is_refused_by_its_own_name(exercise, seeds):
    made = [(m, gives) for m in exercise.misconceptions for gives in (m.gives, *m.variants)]
    for mistake, gives in made:
        for seed in seeds:
            report = judge(exercise, _tried(exercise, gives, seed), seed)
            assert not report.passed, mistake.name
            assert report.misconception == mistake.name
            assert report.message == mistake.sentence
            assert report.fails


def test_a_misconception_handed_over_like_any_function_is_named_too():
    report = check("dlt", EXERCISES["dlt"].misconceptions[0].gives)
    assert report.misconception == "sign of the last block"
    assert "So the last row of H has, too." in repr(report)


@pytest.mark.parametrize("name", ["dlt", "four_points"])
def test_a_column_of_vt_is_recognised_however_the_rows_and_signs_come(name):
    def my_dlt(src, dst):
        D = []
        for (x, y), (u, v) in zip(src, dst, strict=True):
            D += [[x, y, 1, 0, 0, 0, -u * x, -u * y, -u], [0, 0, 0, x, y, 1, -v * x, -v * y, -v]]
        return np.linalg.svd(D)[2][:, -1].reshape(3, 3)

    assert check(name, my_dlt).misconception == "a column of Vt"


@EACH
def test_nonsense_is_refused_without_a_name(exercise):
    if exercise.answer != "function":
        return
    rng = np.random.default_rng(4)

    def nonsense(*args):
        right = np.asarray(exercise.reference(*args), dtype=float)
        return np.nan_to_num(right, posinf=3.0) * rng.uniform(1.3, 2.0, right.shape) + 0.37

    report = judge(exercise, _tried(exercise, nonsense, 6), 6)
    assert not report.passed
    assert report.misconception in (None, "neither True nor False")


def test_a_mistake_right_in_all_but_one_case_is_told_from_another_slip_in_that_case():
    def my_drop(x_h):
        out = x_h[:, :-1] / np.where(x_h[:, -1:] == 0, 1e-9, x_h[:, -1:])
        return out

    report = check("drop", my_drop)
    assert not report.passed
    assert report.misconception == "a number for NaN"  # and not one of this exercise's own
    assert report.holds == ("Each point comes back, whatever its factor was, negative ones too.",)
    assert report.fails == "Rows whose last coordinate is 0 are NaN."


# --- what the report says -------------------------------------------------------------------


def test_the_counterexample_is_the_shortest_and_can_be_copied():
    report = check("project", lambda A, R, T, W: W[:, :2] + 0.1)
    names = {"np": np}
    exec("\n".join(report.example()), names)
    assert names["W"].shape == (1, 3)
    assert np.array_equal(report.yours, names["W"][:, :2] + 0.1)
    assert list(report.counterexample) == ["A", "R", "T", "W"]


def test_a_long_counterexample_is_printed_by_name_only():
    def right_on_small_pictures(image, u, v):
        return solution_of("bilinear")(image, u, v) if image.size < 9 else 5.0

    report = check("bilinear", right_on_small_pictures)
    assert len(report.counterexample["image"]) == 5
    assert "image = np.array([\n        [" in repr(report)  # 5 × 7
    wide = check("backward_warp", lambda image, H, size: np.zeros((300, 300)))
    assert 'yours = check("backward_warp", my_backward_warp).yours  # (300, 300)' in repr(wide)
    assert wide.yours.shape == (300, 300)


def test_what_holds_and_what_does_not_is_said_in_words():
    text = repr(check("intrinsics_from_sensor", lambda f, du, dv, u0, v0: np.diag([f, f, 1.0])))
    assert "not yet right" in text
    assert "✗ does not hold: The optical axis, (0, 0, 1), is seen at (u0, v0)." in text
    right = check("lift", solution_of("lift"))
    assert "✓ holds: The last coordinate of every point is w." in repr(right)
    assert "right" in repr(right)


def test_a_wide_matrix_is_shown_row_by_row_and_can_still_be_copied():
    text = as_code(np.array([[-1.25, 1e-7, np.inf], [-np.inf, np.nan, 12345.678901]]), "x")
    assert text == "np.array([[-1.25, 1e-07, np.inf], [-np.inf, np.nan, 12345.678901]])"
    wide = np.array([[-1.25, 1e-7, np.inf], [-np.inf, np.nan, 12345.678901]] * 2)
    assert as_code(wide).splitlines()[:3] == [
        "np.array([",
        "    [  -1.25,  1e-07,       np.inf],",
        "    [-np.inf, np.nan, 12345.678901],",
    ]
    for x in (wide, wide.reshape(2, 2, 3), wide.ravel(), wide[:0], np.float64(2.5)):
        assert np.array_equal(eval(as_code(np.asarray(x)), {"np": np}), x, equal_nan=True)


def test_a_right_answer_is_shown_at_the_scale_and_sign_of_the_students():
    right = EXERCISES["dlt"].reference

    def my_dlt(src, dst):
        H = -50 * right(src, dst)
        return H + [[0.01, 0, 0], [0, 0, 0], [0, 0, 0]]

    report = check("dlt", my_dlt)
    assert report.misconception == "a few numbers"
    assert "All is right but what stands in [0, 0]." in report.message
    assert np.abs(report.yours - report.wanted).max() < 0.02
    assert "A factor of the whole answer does not matter" in repr(report)
    assert "A factor of the whole" not in repr(check("lift", lambda x, k: x * 1.1))


def test_a_right_answer_has_a_last_entry_of_1_where_the_students_has():
    def my_normaliser(x):
        c, s = x.mean(axis=0), np.sqrt(2) / np.std(x)
        return np.array([[s, 0, -s * c[0]], [0, s, -s * c[1]], [0, 0, 1]])

    report = check("normaliser", my_normaliser)
    assert not report.passed
    assert report.wanted[2].tolist() == [0, 0, 1]


def test_truth_values_and_whole_numbers_are_shown_as_such():
    report = check("same_points", lambda a, b: (a == b).all(axis=1))
    assert [line.split() for line in report.compared()[:3]] == [
        ["yours", "wanted"], ["True", "True"], ["*False", "True"],
    ]  # fmt: skip


def test_one_number_for_several_is_told_from_one_of_several():
    together = check("geometric_error", lambda H, src, dst: np.linalg.norm(dst - src + 1))
    assert "one number for all of them; is an axis=1 missing?" in together.message
    first = check("drop", lambda x_h: x_h[0, :-1])
    assert "only one of several points came back" in first.message


def test_rounding_noise_is_not_shown():
    report = check("b_from_views", EXERCISES["b_from_views"].misconceptions[0].gives)
    assert [line.split()[-1] for line in report.compared()].count("0") == 3
    assert (np.abs(report.wanted) < 1e-12).sum() == 3


def test_the_answer_stands_beside_a_right_one_before_the_input_with_a_star_where_they_differ():
    right = EXERCISES["project"].reference
    report = check("project", lambda A, R, T, W: right(A, R, T, W) + [[0, 1e-3]])
    text = repr(report).splitlines()
    head = next(i for i, line in enumerate(text) if line.split() == ["yours", "wanted"])
    assert text.index("  On this input:") > head
    u, v, u_right, v_right = text[head + 1].split()
    assert (u, v[0]) == (u_right, "*")
    assert v[1:] != v_right  # as many digits as it takes
    assert len(u.replace(".", "")) <= 7
    assert f"<mark>{v}</mark>" in report._repr_html_()
    long = beside(np.arange(40.0), np.arange(40.0) + (np.arange(40) == 17))
    assert long[1:] == [" 17  *17     18", "… 1 of 40 rows differ"]
    assert beside([1.0], [[1.0]]) == ["yours = np.array([1.0])", "wanted = np.array([[1.0]])"]


@EACH
def test_no_report_says_that_something_was_divided_that_is_no_number(exercise):
    if exercise.answer != "function":
        return
    for nothing in (None, "H", np.nan):
        outcomes = [outcome_of(nothing)] * len(exercise.inputs(2024))
        report = judge(exercise, outcomes, 2024)
        assert not report.passed
        assert "divided by 0" not in repr(report)


def test_of_what_never_came_back_nothing_is_said_to_hold_or_not():
    for silent in (lambda x, k: print(k), lambda x, k: "H", lambda x, k: 1 / 0):
        report = check("lift", silent)
        assert (report.holds, report.fails) == ((), "")
        assert "On this input:\n    x = np.array([[2.0, 3.0]" in repr(report)
    some = check("same_points", lambda a, b: None if len(a) == 1 else [True] * len(a))
    assert some.fails


def test_a_number_read_off_is_not_blamed_for_being_whole():
    report = check("where_the_rails_meet", (100, 100))
    assert not report.passed
    assert "integer array" not in repr(report)
    assert "integer array" in repr(check("distort", lambda xy, k, p: (1000 * xy).astype(int)))


def test_html_is_escaped():
    def my_drop(x_h):
        print("<script>alert(1)</script>")
        raise ValueError("<b>no</b>")

    html = check("drop", my_drop)._repr_html_()
    assert "<script>" not in html
    assert "<b>" not in html
    assert "&lt;script&gt;" in html


def test_a_number_read_off_is_right_within_its_tolerance():
    u, v = EXERCISES["where_the_rails_meet"].reference()
    assert check("where_the_rails_meet", (u + 6, v - 6)).passed
    assert check("where_the_rails_meet", [round(u), round(v)]).passed
    assert not check("where_the_rails_meet", (u + 30, v)).passed
    assert check("where_the_rails_meet", (v, u)).misconception == "v before u"
    assert "shape" in check("where_the_rails_meet", 432.0).message


def test_a_choice_is_a_letter():
    assert check("bad_views", "B").passed
    assert check("bad_views", "b ").passed
    assert check("bad_views", "A").misconception == "two views thought too few"
    assert check("bad_views", ...).verdict == "not solved yet"
    assert check("bad_views", "E").message == "The answer is one of A, B, C, D; 'E' is none."


def test_a_result_in_place_of_the_function_is_explained():
    report = check("dlt", np.eye(3))
    assert "without brackets" in report.message
    assert check("dlt", None).verdict == "not solved yet"
    assert check("dlt", ...).verdict == "not solved yet"
    assert "by name" in check("pipeline", solution_of("dlt")).message


def test_progress_hints_and_unknown_names():
    assert progress().title == f"0 of {len(EXERCISES)} exercises solved"
    report = check("lift", solution_of("lift"))
    assert report.progress == "Chapter 1: 1 of 5 solved; next: drop."
    assert progress().title.startswith("1 of")
    first, second, third, again = (hint("lift") for _ in range(4))
    assert (first.lines, second.lines, third.lines) == tuple((h,) for h in EXERCISES["lift"].hints)
    assert again == third
    with pytest.raises(CvnotesError, match="there is no exercise 'dtl'; did you mean 'dlt'"):
        check("dtl", abs)
    with pytest.raises(CvnotesError, match="add student="):
        check("own_camera", 800.0)


def test_a_wrong_answer_leaves_what_was_solved_solved():
    check("lift", solution_of("lift"))
    check("lift", lambda x, k: x)
    assert progress().title.startswith("1 of")


# --- the pipeline ---------------------------------------------------------------------------


def test_the_pipeline_names_the_step_that_is_wrong():
    steps = dict(solution_of("pipeline"))
    steps["dlt"] = EXERCISES["dlt"].misconceptions[1].gives
    report = check("pipeline", steps)
    assert report.exercise == "pipeline"
    assert report.misconception == "sign of one block"
    assert report.message.startswith("Step dlt: In one of the two rows of each pair")
    del steps["dlt"]
    assert check("pipeline", steps).verdict == "not solved yet"


def test_steps_that_are_right_one_by_one_but_not_together_are_found():
    steps = dict(solution_of("pipeline"))
    A_from_b = steps["A_from_b"]

    def only_in_pixels(b):
        A = A_from_b(b)
        return A if A[0, 0] > 50 or abs(A[0, 0] - 2) < 1e-6 else A * np.nan

    steps["A_from_b"] = only_in_pixels
    report = check("pipeline", steps)
    assert not report.passed
    assert "the A of your intrinsics contains NaN" in report.message


# --- notebooks ------------------------------------------------------------------------------


def _cells(path):
    nbformat = pytest.importorskip("nbformat")
    return nbformat.read(path, as_version=4).cells


def _normal(code):
    """Give the lines of code that say something, without spaces and comments."""
    lines = (re.sub(r"\s+|#.*", "", line) for line in code.splitlines())
    return [line for line in lines if len(line) > 12 and not line.startswith(("from", "import"))]


def _functions(cells):
    """Give the exercises that a notebook asks for, with the source of the function it has."""
    code = "\n\n".join(cell.source for cell in cells if cell.cell_type == "code")
    asked = {f: name for name, f in re.findall(r"^check\(\"(\w+)\", (\w+)", code, re.M)}
    for node in ast.parse(re.sub(r"^[%!].*$", "", code, flags=re.M)).body:
        if isinstance(node, ast.FunctionDef) and node.name in asked:
            yield EXERCISES[asked[node.name]], node.name, ast.unparse(node)


@pytest.mark.skipif(not NOTEBOOKS, reason="no notebooks yet")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_no_notebook_holds_the_text_of_a_solution(path):
    cells = _cells(path)
    assert not any(re.search(r"\bsolution\(", c.source) for c in cells if c.cell_type == "code")
    for exercise, name, source in _functions(cells):
        solved = set(_normal(solution(exercise.name).code)) - set(_normal(exercise.stub))
        assert not solved & set(_normal(source)), source
        names = {}
        exec(source, names)
        report = judge(exercise, ask(exercise, names[name], 1), 1)
        assert report.verdict == "not solved yet"
        assert tuple(inspect.signature(names[name]).parameters) == exercise.arguments


@pytest.mark.skipif(not NOTEBOOKS, reason="no notebooks yet")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_the_exercises_of_a_notebook_exist_and_belong_to_its_chapter(path):
    for cell in _cells(path):
        for name in re.findall(r"^check\(\"(\w+)\"", cell.source, re.M):
            # further exercises belong to all chapters
            assert short_name(path.name) in (f"{EXERCISES[name].chapter:02d}", MORE)


@pytest.mark.skipif(not NOTEBOOKS, reason="no notebooks yet")
def test_every_exercise_is_asked_for_in_exactly_one_notebook():
    asked = [
        (name, short_name(path.name))
        for path in NOTEBOOKS
        for cell in _cells(path)
        for name in re.findall(r"^check\(\"(\w+)\"", cell.source, re.M)
    ]
    assert sorted(asked) == sorted((name, COURSE.notebook_of(e)) for name, e in EXERCISES.items())


@pytest.mark.skipif(not NOTEBOOKS, reason="no notebooks yet")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_a_question_of_a_notebook_ends_in_a_question_mark_alone(path):
    for cell in _cells(path):
        assert "?." not in cell.source
        for output in cell.get("outputs", []):
            assert "?." not in str(output.get("data", {}).get("text/plain", ""))
