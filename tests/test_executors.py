"""A study and a class give the same on threads, processes and clusters: on those installed."""

import contextlib
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from test_exercises_second import source_of
from test_grade import IMPORTS, answered, notebook

import cvnotes
from benchmarks.convergence import LENSES, counted, one
from cvnotes.base import InputTypeError
from cvnotes.commands.cli import main
from cvnotes.learn.exercises import COURSE
from cvnotes.tutor.grader.grading import grade_folder
from cvnotes.tutor.grader.process import Limits
from cvnotes.tutor.grader.records import Records, read_records
from cvnotes.tutor.grader.tables import marks_csv

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture
def threads():
    with ThreadPoolExecutor(2) as pool:
        yield pool


@pytest.fixture(scope="module")
def processes():
    import multiprocessing

    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        yield pool


@pytest.fixture
def loky():
    from joblib.externals.loky import get_reusable_executor

    pool = get_reusable_executor(2)
    yield pool
    pool.shutdown(kill_workers=True)


@pytest.fixture
def dask(scheduler):
    from distributed import Client

    with Client(scheduler) as connected:
        yield connected.get_executor()


@pytest.fixture(scope="module")
def scheduler():
    """Give the address of a scheduler with two workers, to whom one client after another comes."""
    from distributed import LocalCluster

    options = {"dashboard_address": None, "host": "127.0.0.1", "threads_per_worker": 1}
    with LocalCluster(n_workers=2, **options) as cluster:
        yield cluster.scheduler_address


@pytest.fixture
def ipyparallel():
    import ipyparallel

    with ipyparallel.Cluster(n=2, log_level=40) as workers:
        yield workers.load_balanced_view().executor


NEEDS = {
    "threads": "",
    "processes": "",
    "loky": "joblib",
    "dask": "distributed",
    "ipyparallel": "ipyparallel",
}
INSTALLED = [name for name, module in NEEDS.items() if not module or find_spec(module)]
# What the libraries of others complain of is theirs.
pytestmark = [pytest.mark.filterwarnings("ignore"), pytest.mark.slow, pytest.mark.once]


@pytest.fixture(autouse=True, scope="module")
def workers_find_us():
    """Let workers that are started as commands import the tests' modules."""
    path = os.pathsep.join([str(ROOT), str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")])
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", path)
        yield


@pytest.fixture(scope="module")
def class_of_four(tmp_path_factory):
    """Give four notebooks, of which one ends its process and one is none, and their marks."""
    folder = tmp_path_factory.mktemp("class")
    notebook(folder / "ada" / "01_a.ipynb", IMPORTS, *answered("lift", source_of("lift")))
    notebook(folder / "bob" / "01_a.ipynb", IMPORTS, "check('drop', lambda x_h: x_h[:, :-1])")
    notebook(folder / "eve" / "01_a.ipynb", "import os; os._exit(3)")
    (folder / "sam").mkdir()
    (folder / "sam" / "01_a.ipynb").write_text("no notebook")
    return folder, in_order(grade_folder(folder, COURSE)[1])


def in_order(marks):
    return sorted(marks, key=lambda mark: mark.name)


def test_a_class_is_graded_one_after_the_other_unless_asked(class_of_four):
    _, plain = class_of_four
    assert [mark.points for mark in plain] == [1, 0, 0, 0]
    assert [mark.remark for mark in plain][2:] == [
        "ended its process (exit code 3)",
        "not a notebook",
    ]


@pytest.mark.parametrize("name", INSTALLED)
def test_a_study_and_a_class_are_the_same_everywhere(name, request, class_of_four):
    folder, plain = class_of_four
    k, f = LENSES["barrel"]
    executor = request.getfixturevalue(name)
    found = cvnotes.study(partial(one, n=4, k=k, f=f), range(4), executor)
    handed_in, marks = grade_folder(folder, COURSE, executor=executor)
    table = marks_csv(in_order(marks), COURSE)
    assert found == cvnotes.study(partial(one, n=4, k=k, f=f), range(4))
    assert len(handed_in) == 4
    assert table == marks_csv(plain, COURSE)


@pytest.mark.skipif(not find_spec("distributed"), reason="Dask is not installed")
def test_the_command_grades_on_a_scheduler(scheduler, tmp_path, capsys):
    notebook(tmp_path / "in" / "ada" / "01_a.ipynb", IMPORTS, *answered("lift", source_of("lift")))
    arguments = ["grade", str(tmp_path / "in"), "--out", str(tmp_path / "marks.csv")]
    assert main([*arguments, "--cluster", scheduler]) == 0
    assert "ada/01_a.ipynb: 1 of 5" in capsys.readouterr().out


def test_without_dask_one_sentence_says_what_is_missing(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    notebook(tmp_path / "01_a.ipynb", "1")
    arguments = ["grade", str(tmp_path), "--out", str(tmp_path / "marks.csv")]
    assert main([*arguments, "--cluster", "tcp://nowhere:1"]) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "pip install distributed" in said
    assert not (tmp_path / "marks.csv").exists()


@pytest.mark.parametrize("pooled", [False, True])
def test_a_failing_run_names_its_seed_and_ends_the_others(pooled):
    ran = []

    def fails(seed):
        ran.append(seed)
        time.sleep(0.002)
        if seed == 2:
            raise ZeroDivisionError("so")
        return seed

    executor = ThreadPoolExecutor(1) if pooled else contextlib.nullcontext()
    with executor as pool, pytest.raises(ZeroDivisionError) as raised:
        cvnotes.study(fails, range(10_000 if pooled else 10), pool)
    assert raised.value.__notes__ == ["in the run with the seed 2"]
    assert len(ran) < 10_000


def test_results_come_in_the_order_of_the_seeds():
    def slow_first(seed):
        time.sleep(0.05 * (seed == 0))
        return np.random.default_rng(seed).integers(1000)

    with ThreadPoolExecutor(4) as pool:
        assert cvnotes.study(slow_first, range(20), pool) == cvnotes.study(slow_first, range(20))


def test_what_is_no_function_or_executor_is_refused_in_a_sentence():
    with pytest.raises(InputTypeError, match="expected a function of a seed, got 3"):
        cvnotes.study(3, range(2))
    with pytest.raises(InputTypeError, match="of a Dask client"):
        cvnotes.study(abs, range(2), object())
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = cvnotes.nothing


def test_the_convergence_study_counts_every_set():
    k, f = LENSES["mild"]
    assert counted(k, f, 5, 3).total() == 3


def test_exercises_that_were_added_are_known_to_other_processes(processes, tmp_path, monkeypatch):
    monkeypatch.setattr(COURSE, "added", {})
    source = (
        "from dataclasses import replace\n"
        "from cvnotes.learn.ch01.lift import EXERCISE\n"
        "EXERCISES = (replace(EXERCISE, name='raise_points'),)\n"
    )
    (tmp_path / "own.py").write_text(source)
    lift = source_of("lift").replace("my_lift", "mine")
    notebook(tmp_path / "in" / "ada" / "a.ipynb", IMPORTS, lift, "check('raise_points', mine)")
    try:
        COURSE.add_exercises(tmp_path / "own.py")
        [mark] = grade_folder(tmp_path / "in", COURSE, executor=processes)[1]
        assert mark.earned("raise_points") == 1
        rows = Records(tmp_path / "rows.jsonl", {}, Limits(), COURSE)
        rows.add(mark)
        rows.__exit__(None, None, None)
        assert len(read_records(tmp_path / "rows.jsonl", Limits(), COURSE)) == 1
        (tmp_path / "own.py").write_text(source + "# changed")
        assert read_records(tmp_path / "rows.jsonl", Limits(), COURSE) == {}
    finally:
        COURSE.exercises.pop("raise_points", None)
