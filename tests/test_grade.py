"""Grading: right notebooks score all points, broken and hostile ones cost their own row only."""

import csv
import json
import os
import re
import signal
import time
import warnings
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import processor_time
from test_exercises_second import source_of

from cvnotes.commands.cli import main
from cvnotes.learn import EXERCISES, add_exercises
from cvnotes.learn.exercises import CHAPTERS, COURSE
from cvnotes.tutor.checker import sandbox
from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED, RIGHT_THERE_NOT_HERE
from cvnotes.tutor.checker.outcome import encode
from cvnotes.tutor.checker.sandbox import ask
from cvnotes.tutor.course import MORE, short_name
from cvnotes.tutor.grader import grading, process
from cvnotes.tutor.grader.belonging import expected_exercises
from cvnotes.tutor.grader.grading import grade_folder
from cvnotes.tutor.grader.handin import CellTimeout, _recorder
from cvnotes.tutor.grader.handin import _alarm as alarm
from cvnotes.tutor.grader.judging import ALONE, FORGED, judged
from cvnotes.tutor.grader.marks import Mark, Verdict
from cvnotes.tutor.grader.tables import marks_csv

pytestmark = pytest.mark.slow

IMPORTS = "import numpy as np\nfrom cvnotes.learn.exercises import check\n"
IMPORTS += "from cvnotes.learn.personal import personal_camera"
ASKING = [*(chapter[2:] for chapter in CHAPTERS), MORE]
PAGES = sorted(
    path
    for path in (Path(__file__).resolve().parents[1] / "notebooks").glob("*.ipynb")
    if short_name(path.name) in ASKING
)
# Every exercise is answered rightly, and each misconception judged; the course's own notebooks, and
# all misconceptions in a process of their own, take long: the DLT and the chapter that knows its
# student stand for the others.
MARKED_IN_FULL = ("06", "09")
needs_posix = pytest.mark.skipif(os.name != "posix", reason="limits as on Linux")


@pytest.fixture(autouse=True)
def all_exercises_are_placed(monkeypatch, tmp_path):
    """Expect every exercise in its notebook, whatever the course's own notebooks ask for."""
    monkeypatch.setattr(COURSE, "notebooks", tmp_path / "none")


def notebook(path, *cells):
    path.parent.mkdir(parents=True, exist_ok=True)
    cells = [{"cell_type": "code", "source": c, "outputs": [], "metadata": {}} for c in cells]
    text = [{"cell_type": "markdown", "source": ["# A title"], "metadata": {}}]
    path.write_text(json.dumps({"cells": text + cells, "metadata": {}, "nbformat": 4}))


def hand_over(name):
    variable = "my_steps" if name == "pipeline" else f"my_{name}"
    student = ', student="demo"' if name == "own_camera" else ""
    return f'check("{name}", {variable}{student})'


def answered(name, source):
    return [source, hand_over(name)]


def in_notebook(name):
    return [e for e in EXERCISES.values() if COURSE.notebook_of(e) == name]


def cells_for(exercises, sources):
    """Give the cells of a notebook, with a source for each exercise."""
    cells = [IMPORTS]
    for exercise in exercises:
        cells += answered(exercise.name, sources(exercise))
    return cells


def graded(folder, **limits):
    handed_in, marks = grade_folder(folder, COURSE, **limits)
    marks = list(marks)
    assert len(handed_in) == len(marks)
    return {m.name: m for m in sorted(marks, key=lambda m: m.name)}


def command(*arguments):
    return main(["grade", *map(str, arguments)])


def run_here_if_harmless(cells, seed, course, *others):
    """Run a notebook without a process of its own, unless it fails, ends, or writes itself."""
    if any(word in cell for cell in cells for word in ("raise", "import os", "import sys")):
        return process.run_notebook(cells, seed, course, *others)
    ran = process.Ran(finished={"finished": True, "failed": 0, "first": ""}, sealed=True)
    check = _recorder(
        course,
        process._inputs(seed, course),
        lambda line: process._keep(json.dumps(line).encode(), ran, course),
    )
    names = {}
    with ALONE, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # which are errors in tests only
        for cell in cells:
            exec(cell, names)
            names["check"] = check
    return ran


@pytest.fixture
def in_this_process(monkeypatch):
    """Start no process for notebooks: where something else is asked."""
    monkeypatch.setattr(grading, "run_notebook", run_here_if_harmless)


def mistake_in(exercise, which):
    """Give a misconception; those of the pipeline are those of its first step."""
    return (exercise.parts or (exercise,))[0].misconceptions[which]


def mistakes_of(exercise):
    return len((exercise.parts or (exercise,))[0].misconceptions)


def mistaken(exercise, which):
    """Give code that hands over a misconception."""
    if exercise.name == "pipeline":
        first = exercise.parts[0]
        wrong = mistaken(first, which)
        return source_of("pipeline").replace("my_steps", f"{wrong}\nmy_steps")
    variable = hand_over(exercise.name).split(", ")[1].rstrip(")")
    number = exercise.misconceptions.index(mistake_in(exercise, which))
    gives = f"EXERCISES['{exercise.name}'].misconceptions[{number}].gives"
    call = "()" if exercise.answer == "value" else ""
    letter = "'ABCD'[int({})]" if exercise.choices else "{}"
    source = f"{variable} = " + letter.format(gives + call)
    return f"from cvnotes.learn.exercises import EXERCISES\n{source}"


@pytest.mark.once
def test_a_solved_course_scores_all_and_an_untouched_one_nothing(tmp_path):
    others = [n for n in ASKING if n not in MARKED_IN_FULL]
    for n in others:
        solved = cells_for(in_notebook(n), lambda e: source_of(e.name))
        notebook(tmp_path / "ada" / f"{n}_chapter.ipynb", *solved)
    notebook(tmp_path / "bob" / "course.ipynb", *cells_for(EXERCISES.values(), stub))
    started = processor_time()
    marks = graded(tmp_path)
    assert 60 * len(marks) / (processor_time() - started) > 10  # notebooks a minute
    bob = marks.pop("bob/course.ipynb")
    for n in others:
        ada = marks[f"ada/{n}_chapter.ipynb"]
        assert ada.remark == ""
        assert {*ada.expected} == {e.name for e in in_notebook(n)}
        assert ada.points == len(ada.expected), ada.reports
    assert bob.expected == tuple(bob.reports) == tuple(EXERCISES)
    assert {r.verdict for r in bob.reports.values()} == {"not solved yet"}
    assert bob.points == 0


def left_behind(exercise, which):
    """Hand a misconception over in this process; give what the grader would get of it."""
    names = {}
    exec(f"{IMPORTS}\n{mistaken(exercise, which)}", names)
    student = "demo" if exercise.personal else None
    answer = names["my_steps" if exercise.parts else f"my_{exercise.name}"]
    outcomes = ask(COURSE.asked(exercise.name, student), answer, NOTEBOOK_SEED)
    return {"student": student, "outcomes": [encode(outcome).decode() for outcome in outcomes]}


@pytest.fixture(scope="module")
def judged_here(worked_out_once):  # noqa: ARG001
    """Give the verdict on each misconception, by exercise and number, without another process."""
    verdicts = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sandbox, "can_fork", lambda: False)
        for which in range(max(map(mistakes_of, EXERCISES.values()))):
            having = [e for e in EXERCISES.values() if which < mistakes_of(e)]
            given, _ = judged(
                {e.name: left_behind(e, which) for e in having}, seed=7, course=COURSE
            )
            verdicts |= {(name, which): verdict for name, verdict in given.items()}
    return verdicts


def test_every_misconception_of_the_course_is_judged_wrong_and_named(judged_here):
    every = [(e.name, which) for e in EXERCISES.values() for which in range(mistakes_of(e))]
    assert sorted(judged_here) == sorted(every)
    for (name, which), verdict in judged_here.items():
        mistake = mistake_in(EXERCISES[name], which)
        assert not verdict.passed
        assert (name, verdict.misconception) == (name, mistake.name)
        assert verdict.message.endswith(mistake.sentence)


ONCE_MORE = """from dataclasses import replace
from cvnotes.learn import EXERCISES as COURSE
EXERCISES = tuple(
    replace(COURSE[name], name=f"{{name}}_{{which}}")
    for name, n in {numbers}.items()
    for which in range(n)
)
"""


@pytest.mark.once
@pytest.mark.usefixtures("course_again")
def test_a_misconception_costs_exactly_its_exercise_and_is_judged_as_in_this_process(
    tmp_path, judged_here
):
    """One notebook answers two chapters rightly, and with each of their misconceptions.

    The last answer to an exercise counts; so there is one more of it for each misconception.
    """
    exercises = [e for n in MARKED_IN_FULL for e in in_notebook(n)]
    wrong = {f"{e.name}_{which}": (e, which) for e in exercises for which in range(mistakes_of(e))}
    numbers = {e.name: mistakes_of(e) for e in exercises}
    (tmp_path / "more.py").write_text(ONCE_MORE.format(numbers=numbers))
    assert add_exercises(tmp_path / "more.py") == tuple(wrong)
    cells = cells_for(exercises, lambda e: source_of(e.name))
    for name, (e, which) in wrong.items():
        cells += [mistaken(e, which), hand_over(e.name).replace(f'"{e.name}"', f'"{name}"')]
    notebook(tmp_path / "in" / "answers.ipynb", *cells)
    [mark] = graded(tmp_path / "in").values()
    assert mark.remark == ""
    assert [name for name in mark.expected if mark.earned(name)] == [e.name for e in exercises]
    assert [name for name in mark.expected if not mark.earned(name)] == [*wrong]
    for name, (e, which) in wrong.items():
        # Of a null vector nobody chose, an example shows digits that memory's layout decides.
        there, here = (
            replace(verdict, code="", note="", compared=(), example=())
            for verdict in (mark.reports[name], judged_here[e.name, which])
        )
        assert (name, there) == (name, here)


def stub(exercise):
    return exercise.stub


def exercise_cells(path, solved):
    """Give a course notebook's imports and exercises, with the stubs as they are or solved."""
    code = [
        "".join(cell["source"])
        for cell in json.loads(path.read_text())["cells"]
        if cell["cell_type"] == "code"
    ]
    kept = [code[0]]
    for cell in code[1:]:
        asked = re.findall(r"^check\(\"(\w+)\", (\w+)", cell, re.M)
        if asked and solved:
            [(name, variable)] = asked
            own = "my_steps" if name == "pipeline" else f"my_{name}"
            call = re.search(r"^check\(.*", cell, re.M | re.S)[0]
            source = source_of(name).replace("'demo'", "'s123456'")
            cell = f"{source}\n{variable} = {own}\n{call}".replace("your id", "s123456")
        if asked:
            kept.append(cell)
    return kept


@pytest.mark.skipif(not PAGES, reason="no notebooks yet")
def test_the_courses_own_notebooks_score_nothing_untouched_and_all_when_solved(
    tmp_path, monkeypatch
):
    monkeypatch.setattr(COURSE, "notebooks", PAGES[0].parent)
    in_full = [path for path in PAGES if short_name(path.name) in MARKED_IN_FULL]
    for path in in_full:
        for who in ("solved", "untouched"):
            cells = exercise_cells(path, who == "solved")
            notebook(tmp_path / who / path.name, IMPORTS, *cells)
    marks = graded(tmp_path)
    assert len(marks) == 2 * len(MARKED_IN_FULL)
    for path in in_full:
        solved, untouched = (marks[f"{who}/{path.name}"] for who in ("solved", "untouched"))
        assert (solved.remark, untouched.remark) == ("", "")
        assert solved.points == len(solved.expected), solved.reports
        assert untouched.points == 0
        assert {r.verdict for r in untouched.reports.values()} == {"not solved yet"}


def test_each_of_the_courses_own_notebooks_asks_for_its_exercises(monkeypatch):
    monkeypatch.setattr(COURSE, "notebooks", PAGES[0].parent)
    asked = [name for path in PAGES for name in expected_exercises(path.name, [], COURSE)]
    assert sorted(asked) == sorted(EXERCISES)


def test_the_last_answer_counts_and_cells_after_a_broken_one_still_run(tmp_path):
    notebook(
        tmp_path / "01_a.ipynb",
        IMPORTS,
        "check('lift', lambda x, k: x)",
        "raise RuntimeError('broken')",
        "this is no Python",
        "np.random.default_rng = lambda *_: np.random.Generator(np.random.PCG64(1))",
        *answered("lift", source_of("lift")),
        *answered("drop", source_of("drop")),
        "check('drop', ...)",
        EXERCISES["lift"].stub + "\n" + hand_over("lift"),
        "def check(*args): return 'right'",
    )
    [mark] = graded(tmp_path).values()
    assert mark.points == 2  # and what is no answer takes none back
    said = "2 cells failed, first: RuntimeError: broken; has a check of its own"
    assert mark.remark == said


def test_what_notebooks_do_besides_is_understood(tmp_path):
    notebook(
        tmp_path / "01_a.ipynb",
        "%matplotlib inline\n" + IMPORTS,
        "import matplotlib.pyplot as plt\nplt.plot([1, 2]); plt.show()",
        "from IPython.display import display\ndisplay(1)",
        "import ipywidgets\nipywidgets.interact(lambda x: x, x=3)",
        "import os\nassert os.getcwd().endswith('notebooks')",
        *answered("lift", source_of("lift")),
        "hasattr(1, 'x')\n_",
    )
    [mark] = graded(tmp_path).values()
    assert (mark.points, mark.remark) == (1, "")


HOSTILE = {
    "endless": "import time\nwhile True: time.sleep(0.01)",
    "exits": "import os; os._exit(0)",
    "crashes": "import ctypes; ctypes.string_at(0)",
    "greedy": "x = bytearray(10**12)",
    "patches": "import cvnotes.tutor.checker.judge as j\nj.judge = lambda *a: None\n"
    "import numpy as np\nnp.allclose = lambda *a, **k: True\nnp.array_equal = np.allclose",
    "praises": "check = lambda *a, **k: print('PASSED')",
    "forges": "import json, os\n"
    'honest = \'{"kind": "numbers", "value": "", "shape": [0], "dtype": "", \'\n'
    'honest += \'"words": "", "printed": "", "changed": [99]}\'\n'
    "lines = [{'exercise': 'drop', 'passed': True}, [1], {'exercise': [], 'outcomes': 1}]\n"
    "lines += [{'exercise': 'drop', 'student': None, 'outcomes': ['{}']}]\n"
    "lines += [{'exercise': 'meet', 'student': None, 'outcomes': [honest] * 3}]\n"
    "data = b'nonsense\\n' + b''.join(json.dumps(x).encode() + b'\\n' for x in lines)\n"
    "for fd in range(3, 20):\n"
    "    try: os.write(fd, data)\n"
    "    except OSError: pass",
    "deletes": "import shutil, pathlib\nfor p in pathlib.Path('..').resolve().iterdir():\n"
    "    p.unlink() if p.is_file() else None",
}


@pytest.mark.once
@needs_posix
def test_a_hostile_notebook_costs_its_own_row_only(tmp_path):
    for name, cell in HOSTILE.items():
        right = answered("lift", source_of("lift"))
        wrong = "check('drop', lambda x_h: x_h[:, :-1])"
        notebook(tmp_path / name / "01_a.ipynb", IMPORTS, *right, cell, wrong)
    (tmp_path / "text").mkdir()
    (tmp_path / "text" / "01_a.ipynb").write_text("this is no notebook")
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "01_a.ipynb").write_text("[" * 200_000)
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty" / "01_a.ipynb").write_text("")
    (tmp_path / "folder" / "01_a.ipynb").mkdir(parents=True)
    os.mkfifo(tmp_path / "folder" / "02_pipe.ipynb")
    notebook(tmp_path / "zoe" / "01_a.ipynb", IMPORTS, *answered("lift", source_of("lift")))
    marks = graded(tmp_path, seconds=12.0, megabytes=3000)
    assert marks["zoe/01_a.ipynb"].points == 1
    assert marks["zoe/01_a.ipynb"].remark == ""
    for name in HOSTILE:
        mark = marks[f"{name}/01_a.ipynb"]
        assert mark.earned("drop") == 0
        assert mark.earned("lift") == 1  # what was right before it stays right
    assert marks["forges/01_a.ipynb"].reports["meet"].note == FORGED
    assert "CellTimeout" in marks["endless/01_a.ipynb"].remark
    assert marks["endless/01_a.ipynb"].misconceptions == {"drop": "no division"}
    assert marks["exits/01_a.ipynb"].remark == "ended before its last cell"
    assert marks["crashes/01_a.ipynb"].remark == "ended its process (SIGSEGV)"
    assert "MemoryError" in marks["greedy/01_a.ipynb"].remark
    for name in ("text", "deep", "empty"):
        assert marks[f"{name}/01_a.ipynb"].remark == "not a notebook"
    assert marks["folder/01_a.ipynb"].remark == "not a regular file"
    assert marks["folder/02_pipe.ipynb"].remark == "not a regular file"


@needs_posix
def test_a_cell_that_never_rests_is_interrupted_too():
    def endless():
        while True:
            pass

    before = signal.getsignal(signal.SIGALRM)
    try:
        with pytest.raises(CellTimeout, match=r"stopped after 0\.05 seconds"), alarm(0.05):
            endless()
        time.sleep(0.1)  # nothing is raised afterwards
    finally:
        signal.signal(signal.SIGALRM, before)


@pytest.mark.once
@needs_posix
def test_what_cannot_be_interrupted_is_ended_and_its_first_answers_kept(tmp_path):
    stuck = "import signal, time\nsignal.signal(signal.SIGALRM, signal.SIG_IGN)\ntime.sleep(600)"
    left = "import subprocess, sys\nsubprocess.Popen([sys.executable, '-c', "
    left += f"\"import time, pathlib; time.sleep(16); pathlib.Path('{tmp_path}/late').touch()\"])"
    notebook(tmp_path / "01_a.ipynb", IMPORTS, *answered("lift", source_of("lift")), left, stuck)
    [mark] = graded(tmp_path, seconds=15.0).values()
    assert mark.remark == "stopped after 15 seconds"
    assert mark.points == 1
    time.sleep(2.5)
    assert not (tmp_path / "late").exists()


def test_no_notebook_gets_the_seed_or_sees_the_graders_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("GRADER_TOKEN", "secret")
    cell = (
        "import gc, os, sys\n"
        "assert 'GRADER_TOKEN' not in os.environ, 'seen'\n"
        "from cvnotes.tutor.grader.handin import Task\n"
        "tasks = [t for t in gc.get_objects() if type(t).__name__ == 'Task']\n"
        "assert not any('seed' in f for t in [Task, *tasks] for f in t.__dict__), 'seen'\n"
        "assert not any('seed' in argument for argument in sys.argv), sys.argv"
    )
    notebook(tmp_path / "01_x.ipynb", cell)
    [mark] = graded(tmp_path).values()
    assert mark.remark == "hands nothing to check"


@pytest.mark.usefixtures("in_this_process")
def test_an_answer_made_for_the_notebooks_own_inputs_does_not_pass(tmp_path):
    memorised = (
        "from cvnotes.learn import EXERCISES\n"
        "from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED as _SEED\n"
        "known = [(a[0].tobytes(), EXERCISES['drop'].reference(*a))"
        " for a in EXERCISES['drop'].inputs(_SEED)]\n"
        "my_drop = lambda x_h: dict(known).get(x_h.tobytes(), x_h[:, :-1])"
    )
    notebook(tmp_path / "01_a.ipynb", IMPORTS, memorised, hand_over("drop"))
    [mark] = graded(tmp_path).values()
    assert mark.earned("drop") == 0
    assert mark.reports["drop"].note.startswith(RIGHT_THERE_NOT_HERE)


@pytest.mark.usefixtures("in_this_process")
def test_the_table_and_the_class_summary(tmp_path, capsys):
    notebook(tmp_path / "ada" / "06_dlt.ipynb", IMPORTS, *answered("dlt", source_of("dlt")))
    notebook(
        tmp_path / "bob" / "06_dlt.ipynb",
        IMPORTS,
        "from cvnotes.learn.exercises import EXERCISES",
        "check('dlt', EXERCISES['dlt'].misconceptions[0].gives)",
    )
    out = tmp_path / "marks" / "marks.csv"
    assert command(tmp_path, "--out", out, "--jobs", "2") == 0
    ada, bob = csv.DictReader(out.read_text("utf-8-sig").splitlines())
    assert (ada["student"], ada["points"], ada["of"], ada["percent"]) == ("ada", "1", "5", "20")
    assert (ada["dlt"], bob["dlt"], bob["normaliser"]) == ("1", "0", "0")
    assert bob["misconceptions"] == "dlt: sign of the last block"
    said = capsys.readouterr().out
    assert "2 notebooks, 1 of 10 points" in said
    assert "1 × dlt: sign of the last block" in said
    assert "dlt                           1 of 2" in said


@pytest.mark.usefixtures("in_this_process")
def test_ids_show_who_handed_in_whose_numbers(tmp_path):
    numbers = "A = personal_camera('eve').truth().A[[0, 1, 0, 1], [0, 1, 2, 2]]"
    own, copied = (f"check('own_camera', A, student='{who}')" for who in ("eve", "bob"))
    notebook(tmp_path / "09_a.ipynb", IMPORTS, numbers, own)
    notebook(tmp_path / "bob" / "09_a.ipynb", IMPORTS, numbers, copied)
    marks = graded(tmp_path)
    assert marks["09_a.ipynb"].ids == ("eve",)
    assert marks["09_a.ipynb"].earned("own_camera") == 1
    assert marks["bob/09_a.ipynb"].ids == ("bob",)
    assert marks["bob/09_a.ipynb"].earned("own_camera") == 0


def test_a_spreadsheet_takes_no_text_for_a_formula():
    mark = Mark("=cmd()", "@x.ipynb", {}, ("dlt",), ids=("+1",), remark="-1")
    row = next(csv.DictReader(marks_csv([mark], COURSE).splitlines()))
    assert [row[k] for k in ("student", "notebook", "id", "remark")] == [
        "'=cmd()", "'@x.ipynb", "'+1", "'-1; id +1 is not the folder's",
    ]  # fmt: skip


def test_exercises_that_a_notebook_does_not_have_are_left_blank():
    one = Mark("a", "01.ipynb", {"lift": Verdict("right")}, ("lift",))
    two = Mark("a", "06.ipynb", {}, ("dlt",))
    rows = list(csv.DictReader(marks_csv([one, two], COURSE).splitlines()))
    assert [(r["lift"], r["dlt"]) for r in rows] == [("1", ""), ("", "0")]


def test_the_number_in_a_notebooks_name_says_what_belongs_to_it():
    assert "dlt" in expected_exercises("06_anything.ipynb", ["lift"], COURSE)
    assert "lift" not in expected_exercises("06_anything.ipynb", ["lift"], COURSE)
    assert expected_exercises("ada.ipynb", ["lift"], COURSE) == ("lift",)
    assert expected_exercises("ada.ipynb", [], COURSE) == ()


def test_only_what_the_course_itself_asks_for_is_expected(tmp_path, monkeypatch):
    notebook(tmp_path / "06_dlt.ipynb", 'check("dlt", my_dlt)', "check('normaliser', my_n)")
    monkeypatch.setattr(COURSE, "notebooks", tmp_path)
    assert expected_exercises("06_dlt.ipynb", [], COURSE) == ("normaliser", "dlt")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "is not a folder"),
        (["."], "holds no notebooks"),
    ],
)
def test_what_cannot_be_graded_is_said_in_a_line(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert command(*arguments, "--out", "marks.csv") == 1
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
    assert not Path("marks.csv").exists()


def test_wrong_usage_exits_with_2(tmp_path, capsys):
    for option in (["--seconds", "0"], ["--jobs", "many"], []):
        out = ["--out", "m.csv"] if option else []
        with pytest.raises(SystemExit) as ended:
            command(tmp_path, *out, *option)
        assert ended.value.code == 2
    assert "expected a number from 1" in capsys.readouterr().err
