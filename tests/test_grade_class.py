"""A class with every oddity planted: marks, remarks and pages are those of the plan."""

import csv
import io
import re
import shutil
from dataclasses import dataclass, replace

import numpy as np
import pytest
from conftest import wait_for
from test_exercises_second import solution_of, source_of
from test_grade import IMPORTS, command, hand_over, notebook, run_here_if_harmless

from cvnotes.base import FileError
from cvnotes.learn import EXERCISES
from cvnotes.learn.exercises import COURSE
from cvnotes.tutor.grader import grading
from cvnotes.tutor.grader.assignment import read_assignment
from cvnotes.tutor.grader.borrowed import borrowed
from cvnotes.tutor.grader.feedback import class_picture
from cvnotes.tutor.grader.grading import grade_folder
from cvnotes.tutor.grader.handed_in import listed
from cvnotes.tutor.grader.marks import Mark, Verdict
from cvnotes.tutor.grader.source import fingerprint, own_code
from cvnotes.tutor.grader.totals import remarked, totals

pytestmark = [pytest.mark.slow, pytest.mark.once]
ASSIGNMENT = """
title = "Homework 1"
students = "students.csv"
[exercises]
lift = 1
drop = { points = 3, parts = [1, 2] }
dlt = 4
own_camera = 2
"""
LIFT, DLT = source_of("lift"), source_of("dlt")
DROP = (
    "def my_drop(x_h):\n    w = x_h[:, -1:]\n    return np.where(w == 0, np.nan, x_h[:, :-1] / w)"
)
HALF = "def my_drop(x_h):\n    w = x_h[:, -1:]\n    return np.where(w == 0, 7, x_h[:, :-1] / w)"
RENAMED = re.sub(r"\bN1\b", "first", re.sub(r"\bN2\b", "second", DLT)).replace("rows", "lines")
FORGED = (
    "import os\nfor fd in range(3, 20):\n    try: os.write(fd, b'"
    '{"exercise": "dlt", "student": null, "outcomes": ["{}"]}\\n\')\n    except OSError: pass'
)
MEMORY = (
    "from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED\n"
    "from cvnotes.learn import EXERCISES\n"
    "cases = EXERCISES['drop'].inputs(NOTEBOOK_SEED)\n"
    "answers = [np.where(x[:, -1:] == 0, np.nan, x[:, :-1] / x[:, -1:]) for x, in cases]\n"
    "known = {x.tobytes(): a for (x,), a in zip(cases, answers)}\n"
    "my_drop = lambda x_h: known.get(x_h.tobytes(), 0 * x_h[:, :-1])"
)


def done(*names, dlt=DLT, drop=DROP, student="your id"):
    """Give the cells of a notebook that answers some exercises."""
    sources = {"lift": LIFT, "dlt": dlt, "drop": drop}
    cells = [IMPORTS]
    for name in names:
        if name == "own_camera":
            numbers = f"personal_camera('{student}').truth().A[[0, 1, 0, 1], [0, 1, 2, 2]]"
            cells += [f"check('own_camera', {numbers}, student='{student}')"]
        else:
            cells += [sources[name], hand_over(name)]
    return cells


@dataclass
class Planned:
    """What a student hands in, and what must come of it."""

    files: dict
    points: float = 0.0
    remarks: tuple = ()


NAME = "06_homography_dlt.ipynb"
CLASS = {
    "ada": Planned({NAME: done("lift", "drop", "own_camera", student="ada")}, 6),
    "bob": Planned({NAME: [IMPORTS, "check('drop', lambda x_h: x_h[:, :-1])"]}),
    "cid": Planned({NAME: [IMPORTS, EXERCISES["lift"].stub, hand_over("lift")]}),
    "dora": Planned({}, 0, ("nothing handed in",)),
    "emil": Planned({".hidden": ""}, 0, ("nothing handed in",)),
    "fay": Planned({"report.docx": "x"}, 0, ("wrong file type: report.docx is no notebook",)),
    "gus": Planned(
        {"a.py": "x", "b.py": "y"}, 0, ("wrong file type: a.py, b.py are no notebooks",)
    ),
    "hal": Planned(
        {"06_a.ipynb": done("lift"), "06_b.ipynb": done("lift")},
        1,
        ("two copies: 06_a.ipynb and 06_b.ipynb, the same file",),
    ),
    "ida": Planned(
        {"06_a.ipynb": done("lift", "drop", drop="my_drop = abs"), "06_b.ipynb": done("drop")},
        4,
        ("two copies: 06_a.ipynb and 06_b.ipynb, the better answers count",),
    ),
    "jan": Planned(
        {NAME: [*done("lift"), source_of("meet"), hand_over("meet")]},
        1,
        ("other exercises answered: meet",),
    ),
    "kim": Planned({NAME: done("own_camera", student="ada")}, 2, ("id ada is not the folder's",)),
    "leo": Planned({NAME: done("dlt")}, 4, (f"the same functions as mia/{NAME}: dlt",)),
    "mia": Planned(
        {NAME: done("dlt", dlt=RENAMED)}, 4, (f"the same functions as leo/{NAME}: dlt",)
    ),
    "nat": Planned(
        {NAME: [IMPORTS, "from cvnotes.homography import dlt", "check('dlt', dlt)"]},
        4,
        ("dlt: uses the library's own dlt",),
    ),
    "oto": Planned(
        {
            NAME: [
                IMPORTS,
                "from cvnotes.learn import EXERCISES",
                "my_lift = EXERCISES['lift'].reference",
            ]
            + ["check('lift', my_lift)"]
        },
        1,
        ("lift: uses the library's own lift",),
    ),
    "pia": Planned({"homework1.ipynb": done("lift", "drop")}, 4),
    "quin": Planned({"07_quin_06_homography_dlt.ipynb": done("lift")}, 1),
    "rob": Planned({NAME: done("drop", drop=HALF)}, 1),
    "sam": Planned({NAME: "this is no notebook"}, 0, ("not a notebook",)),
    "tom": Planned(
        {NAME: [*done("lift"), "raise RuntimeError('broken')"]},
        1,
        ("1 cells failed, first: RuntimeError: broken",),
    ),
    "vic": Planned(
        {NAME: [*done("lift"), "import os; os._exit(0)"]}, 1, ("ended before its last cell",)
    ),
    "wes": Planned(
        {NAME: [*done("lift"), FORGED]}, 1, ("dlt: its results are none that an answer gives",)
    ),
    "xia": Planned(
        {NAME: done("drop", drop=MEMORY)}, 2, ("drop: right in the notebook, not here",)
    ),
    "Jürgen": Planned({NAME: done("lift")}, 1),
    "yan": Planned({NAME: None}, 0, ("not a regular file",)),
    "zoe": Planned({NAME: done("lift")}, 1),
    "alf": Planned({NAME: done("lift")}, 1),
    "una": Planned(
        {NAME: [*done("lift"), "import sys; sys.exit()", "1 / 1"]},
        1,
        ("1 cells failed, first: SystemExit:",),
    ),
    "val": Planned({NAME: [IMPORTS, "check('lift', [1, 2])"]}),
    "zed": Planned({NAME: done("lift")}, 1, ("not on the list of students",)),
}
# Those whose folder is not called by their name: as Moodle makes it, and no folder at all.
ELSEWHERE = {"zoe": f"Zoe Quist_123456_assignsubmission_file_/{NAME}", "alf": f"07_alf_{NAME}"}


def planted(folder):
    """Write what the class hands in, with its assignment."""
    for student, plan in CLASS.items():
        if plan.files:
            (folder / "in").mkdir(parents=True, exist_ok=True)
        for name, cells in plan.files.items():
            path = folder / "in" / ELSEWHERE.get(student, f"{student}/{name}")
            path.parent.mkdir(parents=True, exist_ok=True)
            if isinstance(cells, list):
                notebook(path, *cells)
            elif cells is None:
                path.mkdir()
            else:
                path.write_text(cells)
    (folder / "homework1.toml").write_text(ASSIGNMENT)
    lines = ["student,name,id,email"]
    lines += [f"{s},,,{s}@example.org" for s in CLASS if s not in ("zed", "zoe")]
    lines += ["zoe,Zoe Quist,s77,zoe@example.org"]
    (folder / "students.csv").write_text("\n".join(lines), encoding="utf-8-sig")


@pytest.fixture(scope="module")
def graded_class(tmp_path_factory):
    """Give the folder of a class that was graded, with all that can be written."""
    folder = tmp_path_factory.mktemp("class")
    planted(folder)
    options = ["--assignment", folder / "homework1.toml", "--feedback", folder / "pages"]
    options += ["--summary", folder / "class.html", "--format", "moodle", "--seconds", "60"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(grading, "run_notebook", run_here_if_harmless)
        assert command(folder / "in", "--out", folder / "marks.csv", *options) == 0
    return folder


def rows(path):
    return list(csv.DictReader(io.StringIO(path.read_text("utf-8-sig"))))


def test_marks_and_remarks_are_those_of_the_plan(graded_class):
    found = {row["student"]: row for row in rows(graded_class / "marks.csv")}
    assert len(found) == len(CLASS) == 30
    for student, plan in CLASS.items():
        row = found[student]
        remarks = "; ".join(plan.remarks)
        assert (student, float(row["points"]), row["remark"]) == (student, plan.points, remarks)
        assert row["of"] == "10"
    assert found["rob"]["drop"] == "1"
    assert found["bob"]["misconceptions"] == "drop: no division"


def test_each_student_has_a_page_without_what_is_the_teachers(graded_class):
    pages = {path.stem: path.read_text() for path in (graded_class / "pages").glob("*.html")}
    assert set(pages) == set(CLASS)
    for student, plan in CLASS.items():
        page = pages[student]
        assert f"<strong>{plan.points:g}</strong> of 10 points" in page
        assert page.count("<section>") == 4
        for private in ("the same functions", "is not the folder", "library's own", "not on the"):
            assert private not in page
        assert 'name="viewport"' in page
        assert "<script" not in page
    bob, rob, cid = pages["bob"], pages["rob"], pages["cid"]
    assert "Next: You left the last coordinate out" in bob
    assert "x_h = np.array(" in bob
    assert "✗ Each point comes back" in bob
    assert "✓ Each point comes back" in rob
    assert "1 of 3" in rob
    assert f"Next: {EXERCISES['lift'].hints[0]}" in cid.replace("&#x27;", "'")
    assert "Nothing was handed in" in pages["dora"]


def test_the_class_has_a_page_and_a_picture(graded_class):
    page, picture = (graded_class / name for name in ("class.html", "class.svg"))
    assert "30 students, " in page.read_text()
    assert "the same functions as mia" in page.read_text()
    right = sum(
        "✓ Right" in path.read_text().split("<code>lift</code>")[1].split("</section>")[0]
        for path in (graded_class / "pages").glob("*.html")
    )
    assert f">{right} of 30</text>" in picture.read_text()
    assert picture.read_text() in page.read_text()


def test_moodle_gets_its_participant_and_the_points(graded_class):
    zoe = next(r for r in rows(graded_class / "marks.moodle.csv") if r["Full name"] == "Zoe Quist")
    assert zoe["Identifier"] == "Participant 123456"
    assert (zoe["ID number"], zoe["Email address"]) == ("s77", "zoe@example.org")
    assert (zoe["Grade"], zoe["Maximum Grade"]) == ("1", "10")
    bob = next(r for r in rows(graded_class / "marks.moodle.csv") if r["Full name"] == "bob")
    assert "drop: 0 of 3. You left the last coordinate out" in bob["Feedback comments: Homework 1"]


def test_a_resumed_class_is_the_same_in_every_file(graded_class, tmp_path, capsys):
    for name in ("in", "homework1.toml", "students.csv"):
        source = graded_class / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, tmp_path / name)
    lines = (graded_class / "marks.rows.jsonl").read_bytes().splitlines(keepends=True)
    cut = b"".join(line for i, line in enumerate(lines) if i % 8) + lines[0][:100]
    (tmp_path / "marks.rows.jsonl").write_bytes(cut)
    options = ["--assignment", tmp_path / "homework1.toml", "--feedback", tmp_path / "pages"]
    options += ["--summary", tmp_path / "class.html", "--format", "moodle", "--seconds", "60"]
    assert command(tmp_path / "in", "--out", tmp_path / "marks.csv", "--resume", *options) == 0
    capsys.readouterr()
    written = [p for p in tmp_path.rglob("*") if p.is_file() and "in" not in p.parts[-3:-1]]
    assert len(written) > 35
    for path in written:
        other = graded_class / path.relative_to(tmp_path)
        assert path.read_bytes() == other.read_bytes(), path.name


def test_canvas_gets_two_rows_before_the_first_student():
    from cvnotes.tutor.grader.tables import for_canvas

    marks = [Mark("", "lovelaceada_77_88_06_x.ipynb", {"dlt": Verdict("right")}, ("dlt",))]
    header, possible, ada = csv.reader(
        io.StringIO(for_canvas(totals(marks, COURSE), "Homework (12)"))
    )
    assert header == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "Homework (12)"]
    assert possible == ["    Points Possible", "", "", "", "", "1"]
    assert (ada[1], ada[-1]) == ("77", "1")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x = ", "is no TOML"),
        ("title = 'a'", 'expected [exercises] with lines such as "dlt = 2"'),
        ("[exercises]\ndltt = 1", "there is no exercise 'dltt'; did you mean 'dlt'"),
        ("[exercises]\ndlt = 'two'", "dlt: expected points from 0, got 'two'"),
        ("[exercises]\ndlt = -1", "dlt: expected points from 0, got -1"),
        ("[exercises]\ndlt = {parts = [1]}", "dlt: expected 3 parts, one for each property"),
        ("[exercises]\ndrop = {points = 4, parts = [1, 2]}", "make 3 points, not 4"),
        ("[exercises]\ndrop = {parts = 'all'}", "parts is true, or a list of points"),
        ("[exercises]\ndrop = {weight = 1}", "drop: 'weight' is none of points, parts"),
        ("exams = 1\n[exercises]\ndlt = 1", "'exams' is none of title, students, [exercises]"),
        ("students = 3\n[exercises]\ndlt = 1", "students: expected a list of names"),
        ("students = ['a', 'A']\n[exercises]\ndlt = 1", "students: 'a' is there twice"),
        ("students = 'none.csv'\n[exercises]\ndlt = 1", "none.csv cannot be read"),
        ("students = 'a.toml'\n[exercises]\ndlt = 1", "a column with the head student"),
        ("title = 3\n[exercises]\ndlt = 1", "title: expected a text in quotes, got 3"),
    ],
)
def test_what_is_no_assignment_is_said_in_a_sentence(text, words, tmp_path):
    path = tmp_path / "a.toml"
    path.write_text(text)
    with pytest.raises(FileError, match=re.escape(words)):
        read_assignment(path, COURSE)


def test_lists_of_students_come_with_semicolons_too(tmp_path):
    (tmp_path / "s.csv").write_text("Student;Name;Id\nada;Ada L.;s1\n;;\n", encoding="utf-8-sig")
    (tmp_path / "a.toml").write_text("students = 's.csv'\n[exercises]\ndlt = 1")
    [ada] = read_assignment(tmp_path / "a.toml", COURSE).students
    assert (ada.student, ada.name, ada.id) == ("ada", "Ada L.", "s1")


def test_equal_parts_make_the_points(tmp_path):
    (tmp_path / "a.toml").write_text("[exercises]\ndrop = { points = 3, parts = true }")
    item = read_assignment(tmp_path / "a.toml", COURSE).items["drop"]
    first = EXERCISES["drop"].properties[0].sentence
    assert item.earned(Verdict("not yet right", holds=(first,))) == 1.5
    assert item.earned(Verdict("right")) == 3
    assert item.earned(None) == 0


def test_a_collection_counts_what_it_answers_and_a_group_is_no_chapter():
    from cvnotes.tutor.grader.belonging import expected_exercises

    names = ["lift", "project", "dlt"]
    assert expected_exercises("homework1.ipynb", names, COURSE) == ("lift", "project", "dlt")
    chapter = expected_exercises("06_homography_dlt.ipynb", [], COURSE)
    assert expected_exercises("07_ada_06_homography_dlt.ipynb", [], COURSE) == chapter
    assert expected_exercises("06_ada_07_calibration.ipynb", ["dlt"], COURSE) == chapter


BORROWED = """
from cvnotes.learn import EXERCISES
import cvnotes.homography, inspect, sys
alias = cvnotes.homography.dlt
def wrapped(src, dst): return -2 * alias(src, dst)
got = getattr(sys.modules["cvnotes.homography"], "d" + "lt")
for looped in [e.reference for e in EXERCISES.values() if e.name == "dlt"]: pass
there = dict(vars(sys.modules[alias.__module__]))
exec(inspect.getsource(alias), there); sourced = there["dlt"]
steps = EXERCISES['lift'].steps
"""


def test_the_librarys_own_function_is_seen_by_whatever_road_it_came():
    names = {"np": np}
    exec(BORROWED, names)
    for road in ("alias", "wrapped", "got", "looped", "sourced"):
        assert (road, borrowed(names[road], EXERCISES["dlt"])) == (road, "dlt")
    assert borrowed(names["steps"], EXERCISES["lift"]) == "lift"
    assert borrowed({"radial_fit": EXERCISES["radial_fit"].reference}, EXERCISES["pipeline"])


def test_an_answer_of_ones_own_is_not_borrowed():
    for name, exercise in EXERCISES.items():
        if exercise.answer == "function":
            assert (name, borrowed(solution_of(name), exercise)) == (name, "")
    assert borrowed(lambda *_: 1 / 0, EXERCISES["dlt"]) == ""
    assert borrowed(..., EXERCISES["dlt"]) == borrowed(3.0, EXERCISES["how_far"]) == ""


def test_equal_functions_are_one_clause():
    marks = [
        Mark(who, "a.ipynb", {name: Verdict("right", code=name) for name in names}, names)
        for who, names in {"ada": ("dlt", "meet"), "bob": ("dlt",), "cid": ("meet",)}.items()
    ]
    same = {"v_ij": Verdict("right", code="1")}
    marks += [Mark(f"s{i}", "a.ipynb", same, ("v_ij",)) for i in range(9)]
    ada, bob, cid, first, *_ = remarked(marks)
    assert ada == ["the same functions as bob/a.ipynb: dlt, as cid/a.ipynb: meet"]
    assert (bob, cid) == (
        ["the same functions as ada/a.ipynb: dlt"],
        ["the same functions as ada/a.ipynb: meet"],
    )
    assert first == ["the same functions as s1/a.ipynb, s2/a.ipynb and 6 more: v_ij"]


def test_nobody_is_worse_off_for_a_stub_in_another_notebook():
    verdicts = [Verdict("not solved yet"), Verdict("not yet right", misconception="no division")]
    for both in (verdicts, verdicts[::-1]):
        marks = [Mark("ada", f"{i}.ipynb", {"drop": v}, ("drop",)) for i, v in enumerate(both)]
        [ada] = totals(marks, COURSE)
        assert ada.verdicts["drop"].misconception == "no division"


def test_who_was_not_run_yet_has_not_handed_in_nothing(tmp_path, capsys):
    for name in ("ada", "bob"):
        notebook(tmp_path / "in" / name / NAME, IMPORTS, LIFT, hand_over("lift"))
    (tmp_path / "a.toml").write_text("students = ['ada', 'bob', 'cid']\n[exercises]\nlift = 1")
    out, ran = tmp_path / "marks.csv", []

    def interrupted(cells, *others):
        ran.append(cells)
        if len(ran) == 1:
            return run_here_if_harmless(cells, *others)
        wait_for(out.exists)  # with ada's row
        raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(grading, "run_notebook", interrupted)
        options = ["--assignment", tmp_path / "a.toml", "--jobs", "1"]
        assert command(tmp_path / "in", "--out", out, *options) == 130
    assert "1 finished rows of 2 are kept" in capsys.readouterr().err
    said = {row["student"]: (row["points"], row["remark"]) for row in rows(out)}
    assert said == {
        "ada": ("1", ""),
        "bob": ("0", "not run yet"),
        "cid": ("0", "nothing handed in"),
    }


def test_short_functions_are_not_compared_and_renamed_ones_are_equal():
    def code(name, source):
        return fingerprint(name, own_code([source, hand_over(name)]), COURSE.notebooks)

    assert code("lift", LIFT) == ""
    assert code("dlt", DLT) == code("dlt", RENAMED) != ""
    assert code("dlt", DLT) != code("dlt", DLT.replace("-5 *", "-4 *"))


def test_ids_of_the_list_are_the_folders_own(tmp_path):
    (tmp_path / "s.csv").write_text("student,id\nada,s77\n")
    (tmp_path / "a.toml").write_text("students = 's.csv'\n[exercises]\ndlt = 1")
    assignment = read_assignment(tmp_path / "a.toml", COURSE)
    mark = Mark("ada", "a.ipynb", ids=("S77", "your id"))
    assert remarked([mark], assignment) == [["id your id is not the folder's"]]


def test_our_own_files_are_not_handed_in(tmp_path):
    notebook(tmp_path / "ada" / "a.ipynb", "1")
    (tmp_path / "marks").mkdir()
    (tmp_path / "marks" / "marks.csv").touch()
    (tmp_path / "notes.txt").touch()
    names = [
        (one.student, one.notebook) for one in listed(tmp_path, [tmp_path / "marks" / "x.csv"])
    ]
    assert names == [("ada", "a.ipynb"), ("", "notes.txt")]


@pytest.mark.parametrize("name", ["marks.csv", "marks.moodle.csv", "class.html", "pages/ada.html"])
def test_no_file_of_anybody_else_is_replaced(name, tmp_path, capsys):
    notebook(tmp_path / "in" / "ada" / "a.ipynb", "1")
    (tmp_path / "pages").mkdir()
    (tmp_path / name).write_text("a list of my own")
    options = ["--summary", tmp_path / "class.html", "--feedback", tmp_path / "pages"]
    options += ["--format", "moodle"]
    assert command(tmp_path / "in", "--out", tmp_path / "marks.csv", *options) == 1
    assert "was not made by cvnotes grade" in capsys.readouterr().err
    assert (tmp_path / name).read_text() == "a list of my own"


def test_two_copies_are_remarked_without_an_assignment_too():
    marks = [
        Mark("ada", f"06_{x}.ipynb", {"dlt": Verdict("right")}, ("dlt",), content=x) for x in "ab"
    ]
    said = "two copies: 06_a.ipynb and 06_b.ipynb, the better answers count"
    assert remarked(marks) == [[], [said]]
    [ada] = totals(marks, COURSE)
    assert (ada.points, ada.of) == (1, 1)
    assert sum(said in text for text in ada.remarks) == 1
    assert remarked([replace(mark, student="") for mark in marks]) == [[], []]


def test_an_untouched_notebook_used_no_id(tmp_path):
    stub = EXERCISES["own_camera"].stub
    notebook(tmp_path / "ada" / "09_a.ipynb", IMPORTS, stub, hand_over("own_camera"))
    [mark] = grade_folder(tmp_path, COURSE)[1]
    assert mark.reports["own_camera"].is_open
    assert (mark.ids, remarked([mark])) == ((), [[]])


def test_the_longest_name_has_room_in_the_picture():
    marks = [Mark("ada", "a.ipynb", {}, tuple(EXERCISES))]
    picture = class_picture(totals(marks, COURSE), COURSE)
    longest = max(EXERCISES, key=len)
    right_edge = int(re.search(rf'<text x="(\d+)"[^>]*>{longest}<', picture)[1])
    assert right_edge > 6.6 * len(longest)  # px of a usual font of 13 px
    assert picture.count("<rect") == 4 + len(EXERCISES)
