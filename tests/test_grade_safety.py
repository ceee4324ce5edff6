"""No mark is lost and none is touched: interruptions, killed parents, leftovers, neighbours."""

import csv
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from conftest import processor_time, wait_for
from test_exercises_second import source_of
from test_grade import IMPORTS, answered, command, graded, notebook, run_here_if_harmless
from test_grade import in_this_process as in_this_process

from cvnotes.learn.exercises import COURSE, EXERCISES
from cvnotes.tutor.checker.agreement import NOTEBOOK_SEED
from cvnotes.tutor.checker.outcome import Outcome, encode
from cvnotes.tutor.grader import grading
from cvnotes.tutor.grader.judging import FORGED, judged
from cvnotes.tutor.grader.marks import Mark, Verdict
from cvnotes.tutor.grader.process import Limits
from cvnotes.tutor.grader.records import Records, read_records

linux = pytest.mark.skipif(sys.platform != "linux", reason="looks at processes as on Linux")
pytestmark = [pytest.mark.slow, pytest.mark.once]
LIFT = (IMPORTS, *answered("lift", source_of("lift")))


def rows(path):
    return list(csv.DictReader(path.read_text("utf-8-sig").splitlines()))


def started(folder, out, *options, scratch=None):
    """Start the command in a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "cvnotes", "grade", str(folder), "--out", str(out), *options],
        env=os.environ | {"TMPDIR": str(scratch or tempfile.gettempdir())},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def finished_rows(path, n):
    """Wait until a table has so many rows."""
    wait_for(lambda: path.exists() and len(path.read_text("utf-8-sig").splitlines()) > n)


def sleepers(word):
    """Give the processes whose command line holds a word."""
    found = []
    for path in Path("/proc").iterdir():
        try:
            if path.name.isdigit() and word.encode() in (path / "cmdline").read_bytes():
                found.append(int(path.name))
        except OSError:
            continue
    return found


SLEEPER = (
    "import subprocess, sys\n"
    "subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(999)', {!r}],"
    " start_new_session=True)"
)


@linux
def test_an_interruption_leaves_rows_and_nothing_else(tmp_path):
    for name in "abc":
        notebook(tmp_path / "in" / name / "01_x.ipynb", *LIFT)
    word = f"left-{tmp_path.name}-{os.getpid()}"
    slow = "import time\ntime.sleep(900)"
    for name in ("slow1", "slow2"):
        notebook(tmp_path / "in" / name / "01_x.ipynb", *LIFT, SLEEPER.format(word), slow)
    scratch, out = tmp_path / "scratch", tmp_path / "marks.csv"
    scratch.mkdir()
    process = started(tmp_path / "in", out, "--jobs", "3", scratch=scratch)
    finished_rows(out, 3)
    wait_for(lambda: len(sleepers(word)) == 2)
    process.send_signal(signal.SIGINT)
    said, reason = process.communicate(timeout=300)  # not the 900 seconds that notebooks sleep
    assert process.returncode == 130
    assert reason.count("\n") == 1
    assert "3 finished rows of 5 are kept, --resume" in reason
    assert "Traceback" not in said
    assert sleepers(word) == []
    assert list(scratch.iterdir()) == []
    assert [(r["student"], r["points"]) for r in rows(out)] == [("a", "1"), ("b", "1"), ("c", "1")]


@linux
def test_a_killed_grader_leaves_its_rows_and_no_process(tmp_path):
    for name in ("a", "z"):
        notebook(tmp_path / "in" / name / "01_x.ipynb", *LIFT)
    word = f"left-{tmp_path.name}-{os.getpid()}"
    slow = "import time\ntime.sleep(900)"
    notebook(tmp_path / "in" / "m" / "01_x.ipynb", SLEEPER.format(word), slow)
    scratch, out = tmp_path / "scratch", tmp_path / "marks.csv"
    scratch.mkdir()
    process = started(tmp_path / "in", out, "--jobs", "1", scratch=scratch)
    finished_rows(out, 1)
    wait_for(lambda: sleepers(word))
    process.kill()
    process.communicate()
    wait_for(lambda: not sleepers(word))
    assert [row["student"] for row in rows(out)] == ["a"]
    [line] = (tmp_path / "marks.rows.jsonl").read_text().splitlines()
    assert json.loads(line)["mark"]["reports"]["lift"]["verdict"] == "right"
    assert len(list(scratch.iterdir())) == 1
    process = started(tmp_path / "in", out, "--jobs", "1", "--seconds", "3", scratch=scratch)
    finished_rows(out, 3)
    process.communicate()
    assert list(scratch.iterdir()) == []  # what the killed one could not clear away, the next did


def test_resuming_runs_only_what_is_new_or_changed(tmp_path, capsys, monkeypatch):
    for name in ("ada", "bob"):
        notebook(tmp_path / "in" / name / "01_x.ipynb", *LIFT)
    out = tmp_path / "marks.csv"
    monkeypatch.setattr(grading, "run_notebook", run_here_if_harmless)
    assert command(tmp_path / "in", "--out", out) == 0
    first = out.read_bytes()
    ran = []
    monkeypatch.setattr(grading, "run_notebook", lambda cells, *_: ran.append(cells))
    assert command(tmp_path / "in", "--out", out, "--resume") == 0
    assert ran == []
    assert out.read_bytes() == first
    notebook(tmp_path / "in" / "bob" / "01_x.ipynb", "1 + 1")
    command(tmp_path / "in", "--out", out, "--resume")
    assert ran == [["1 + 1"]]
    command(tmp_path / "in", "--out", out)
    assert len(ran) == 3
    command(tmp_path / "in", "--out", out, "--resume", "--seconds", "99")
    assert len(ran) == 5  # other limits may give other marks
    capsys.readouterr()


def test_a_class_interrupted_at_random_gives_the_same_table(tmp_path):
    rng = random.Random(16)
    for i in range(4):
        cells = LIFT if i % 2 else (IMPORTS, "check('drop', lambda x_h: x_h[:, :-1])")
        notebook(tmp_path / "in" / f"s{i}" / "01_x.ipynb", *cells)
    whole, pieces = tmp_path / "whole.csv", tmp_path / "pieces.csv"
    assert command(tmp_path / "in", "--out", whole) == 0
    signals = [signal.SIGINT, signal.SIGTERM, signal.SIGKILL]
    rng.shuffle(signals)
    for kept, number in enumerate(signals):
        process = started(tmp_path / "in", pieces, "--resume", "--jobs", "2", scratch=tmp_path)
        finished_rows(pieces, kept + 1)
        time.sleep(rng.uniform(0, 0.3))
        process.send_signal(number)
        process.communicate()
    assert command(tmp_path / "in", "--out", pieces, "--resume") == 0
    assert pieces.read_bytes() == whole.read_bytes()


def test_a_line_that_was_cut_off_or_is_none_of_ours_is_no_row(tmp_path):
    path, limits = tmp_path / "rows.jsonl", Limits()
    mark = Mark("ada", "06.ipynb", {"dlt": Verdict("right")}, ("dlt",), content="c0")
    with Records(path, {}, limits, COURSE) as records:
        records.add(mark)
    whole = path.read_bytes()
    key = ("ada", "06.ipynb", "c0")
    assert read_records(path, limits, COURSE) == {key: mark}
    foreign = [b"[]", b"{}", b"\xff\xfe", b"[" * 100_000, whole.replace(b'"reports"', b'"report"')]
    path.write_bytes(b"\n".join([*foreign, whole.strip(), whole[:-20]]))
    assert read_records(path, limits, COURSE) == {key: mark}
    path.write_bytes(whole.replace(b'"version": "', b'"version": "9.'))
    assert read_records(path, limits, COURSE) == {}
    assert read_records(tmp_path / "none", limits, COURSE) == {}


def test_what_a_notebook_writes_into_the_records_does_not_stay(tmp_path):
    path = tmp_path / "rows.jsonl"
    with Records(path, {}, Limits(), COURSE) as records:
        records.add(Mark("ada", "a.ipynb", content="c0"))
        with path.open("ab") as stream:
            stream.write(b'{"forged": 1}\n')
    assert len(path.read_bytes().splitlines()) == 1


@pytest.mark.parametrize("option", ["--out", "--feedback", "--summary"])
def test_what_cannot_be_written_is_said_before_the_first_notebook(
    option, tmp_path, capsys, monkeypatch
):
    notebook(tmp_path / "in" / "ada" / "01_x.ipynb", *LIFT)
    monkeypatch.setattr(grading, "run_notebook", lambda *_: pytest.fail("it ran"))
    (tmp_path / "file").touch()
    bad = {option: tmp_path / "file" / "x"}
    options = {"--out": tmp_path / "marks.csv"} | bad
    assert command(tmp_path / "in", *[x for pair in options.items() for x in pair]) == 1
    assert "file is a file" in capsys.readouterr().err
    assert command(tmp_path / "in", "--out", tmp_path / "in") == 1
    assert "it is a folder" in capsys.readouterr().err


def test_any_exception_stays_in_its_row(tmp_path, monkeypatch):
    for name in "ab":
        notebook(tmp_path / name / "01_x.ipynb", f"# {name}")

    def failing(cells, *others):
        if "a" in cells[0]:
            raise RuntimeError("a\nsurprise")
        return run_here_if_harmless(cells, *others)

    monkeypatch.setattr(grading, "run_notebook", failing)
    marks = graded(tmp_path)
    assert marks["a/01_x.ipynb"].remark == "could not be graded: RuntimeError: a surprise"
    assert marks["b/01_x.ipynb"].remark == "hands nothing to check"


@pytest.mark.usefixtures("in_this_process")
def test_the_table_opens_in_spreadsheets_with_its_umlauts(tmp_path, capsys):
    notebook(tmp_path / "in" / "Jürgen" / "01_x.ipynb", "1")
    assert command(tmp_path / "in", "--out", tmp_path / "m.csv") == 0
    assert (tmp_path / "m.csv").read_bytes().startswith(b"\xef\xbb\xbfstudent,")
    assert "Jürgen" in (tmp_path / "m.csv").read_text("utf-8-sig")
    capsys.readouterr()


def numbers(value, **fields):
    return encode(Outcome("numbers", value, "float64", **fields)).decode()


@pytest.mark.parametrize("lines", [["{}"], "text", None, [1], [[]], ["[" * 100_000], ["1"] * 9])
def test_forged_results_are_a_remark(lines):
    verdicts, _ = judged({"lift": {"outcomes": lines, "again": lines}}, 7, COURSE)
    assert not verdicts["lift"].passed
    assert verdicts["lift"].note == FORGED


@pytest.mark.parametrize("which", [99, -1])
def test_a_forged_change_of_no_argument_is_a_remark(which):
    right = [case.right for case in EXERCISES["lift"].solved_cases(NOTEBOOK_SEED)]
    honest = [numbers(x) for x in right]
    forged = [numbers(x, changed=(which,)) for x in right]
    again = [numbers(case.right) for case in EXERCISES["lift"].solved_cases(7)]
    assert judged({"lift": {"outcomes": honest, "again": again}}, 7, COURSE)[0]["lift"].passed
    assert (
        judged({"lift": {"outcomes": forged, "again": again}}, 7, COURSE)[0]["lift"].note == FORGED
    )


def test_thousands_of_forged_lines_cost_no_more_than_one(tmp_path):
    flood = (
        "import json, os\n"
        "line = json.dumps({'exercise': 'pipeline', 'student': None, 'outcomes': ['{}'] * 9})\n"
        "for fd in range(3, 20):\n"
        "    try:\n"
        "        with os.fdopen(os.dup(fd), 'wb') as f: f.write((line + '\\n').encode() * 5000)\n"
        "    except OSError: pass"
    )
    notebook(tmp_path / "01_x.ipynb", *LIFT, flood)
    notebook(tmp_path / "01_y.ipynb", *LIFT)
    before = processor_time()
    marks = graded(tmp_path)
    assert marks["01_y.ipynb"].points == 1
    mark = marks["01_x.ipynb"]
    assert mark.reports["pipeline"].note == FORGED
    assert mark.earned("lift") == 1
    assert processor_time() - before < 12


def test_a_flood_of_results_is_ended(tmp_path, monkeypatch):
    from cvnotes.tutor.grader import process

    monkeypatch.setattr(process, "_MAX_RESULTS", 100_000)
    flood = (
        "import os\n"
        "for fd in range(3, 20):\n"
        "    try:\n"
        "        with os.fdopen(os.dup(fd), 'wb') as f: f.write(b'x' * 1_000_000)\n"
        "    except OSError: pass"
    )
    notebook(tmp_path / "01_x.ipynb", *LIFT, flood)
    [mark] = graded(tmp_path).values()
    assert mark.remark.startswith("handed over more than")
    assert mark.earned("lift") == 1


LOOK = """
import os, pathlib, socket
seen = []
try: socket.create_connection(("127.0.0.1", {port}), 2); seen.append("network")
except OSError: pass
if list(pathlib.Path({folder!r}).rglob("*.ipynb")): seen.append("neighbours")
for target in (pathlib.Path({folder!r}).parent / "marks.csv", pathlib.Path("/tmp/cvnotes-planted")):
    try: target.write_text("forged"); seen.append("files")
    except OSError: pass
for name in os.listdir("/proc"):
    try:
        if name.isdigit() and b"pytest" in open(f"/proc/{{name}}/cmdline", "rb").read():
            open(f"/proc/{{name}}/environ").read(); seen.append("processes")
    except OSError: pass
pathlib.Path("mine").write_text("a notebook may write where it runs")
assert not seen, seen
"""


@linux
def test_a_sealed_notebook_finds_no_network_no_neighbour_and_no_process(tmp_path):
    import socket

    with socket.create_server(("127.0.0.1", 0)) as server:
        cell = LOOK.format(port=server.getsockname()[1], folder=str(tmp_path / "in"))
        notebook(tmp_path / "in" / "eve" / "01_x.ipynb", *LIFT, cell)
        [mark] = graded(tmp_path / "in").values()
    if not mark.sealed:
        pytest.skip("this system seals nothing off")
    assert (mark.remark, mark.points) == ("", 1)


@linux
@pytest.mark.parametrize("interrupted", [False, True])
def test_where_nothing_can_be_sealed_leftovers_are_found_all_the_same(
    interrupted, tmp_path, monkeypatch
):
    from cvnotes.tutor.grader import process

    word = f"left-{tmp_path.name}-{os.getpid()}"
    cells = [*LIFT, SLEEPER.format(word)]
    if interrupted:
        cells += ["import time\ntime.sleep(900)"]
    run = subprocess.Popen

    def unsealed(arguments, **options):
        blocked = (
            "import runpy; import cvnotes.tutor.grader.seal as s; s.sealed = lambda *_: False;"
            "runpy.run_module('cvnotes.tutor.grader.handin', run_name='__main__')"
        )
        return run([arguments[0], "-c", blocked], **options)

    monkeypatch.setattr(process.subprocess, "Popen", unsealed)
    with ThreadPoolExecutor() as pool:
        future = pool.submit(process.run_notebook, cells, 7, COURSE, Limits(900.0), (), word)
        if interrupted:
            wait_for(lambda: sleepers(word))
            process.stop(word)
        ran = future.result()
    assert bool(ran.finished) != interrupted
    if interrupted:
        assert ran.ended == process.INTERRUPTED
    assert not ran.sealed
    assert sleepers(word) == []


def test_no_two_threads_parse_at_once(monkeypatch):
    """In Python 3.11 a second one makes the first fail, and a student lost the marks."""
    from cvnotes.tutor.checker import parsing

    inside, most = [], []

    def slow(source):
        inside.append(source)
        most.append(len(inside))
        time.sleep(0.01)
        inside.pop()
        return source

    monkeypatch.setattr(parsing.ast, "parse", slow)
    threads = [threading.Thread(target=parsing.parsed, args=(str(i),)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1] * 8
