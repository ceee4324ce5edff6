"""Whatever a student's function does, the checker answers kindly and the notebook lives on."""

# Hostile functions need none of their arguments.
# ruff: noqa: ARG001, ARG005

import functools
import os
import re
import signal
import stat
import subprocess
import sys
import textwrap
import threading
import time
import warnings
from multiprocessing import resource_tracker
from pathlib import Path

import numpy as np
import pytest
from conftest import processor_time

from cvnotes.learn import check
from cvnotes.tutor.checker import sandbox
from cvnotes.tutor.checker.attempt import is_empty
from cvnotes.tutor.checker.in_process import TimeIsOver, run_here
from cvnotes.tutor.checker.outcome import Outcome, decode, encode
from cvnotes.tutor.checker.report import RIGHT
from cvnotes.tutor.checker.sandbox import run

pytestmark = pytest.mark.once

X = np.arange(6.0).reshape(3, 2)
needs_fork = pytest.mark.skipif(not sandbox.can_fork(), reason="no fork on this system")


def right_drop(x_h):
    with np.errstate(all="ignore"):
        return np.where(x_h[:, -1:] == 0, np.nan, x_h[:, :-1] / x_h[:, -1:])


# --- functions that misbehave ---------------------------------------------------------------


class Unprintable(Exception):
    def __str__(self):
        raise RuntimeError("not even this")


class AlwaysEqual(np.ndarray):
    def __eq__(self, other):
        return True

    def __sub__(self, other):
        return np.zeros(1)


class NoArray:
    def __array__(self, *args, **kwargs):
        raise KeyboardInterrupt


def endless(x_h):
    while True:
        pass


def stubborn(x_h):
    while True:
        try:
            x_h = x_h + 1
        except BaseException:
            x_h = 0 * x_h


def sleepy(x_h):
    time.sleep(1000)


def backtracking(x_h):
    return re.match(r"(a+)+$", "a" * 40 + "b")  # holds the interpreter's lock


def recursive(x_h):
    return recursive(x_h)


def too_deep(x_h):
    sys.setrecursionlimit(10**9)
    return recursive(x_h)


def raising(error):
    def function(x_h):
        raise error

    return function


def crash(x_h):
    import ctypes

    ctypes.string_at(0)


def kill(x_h):
    os.kill(os.getpid(), signal.SIGKILL)


def leave(x_h):
    os._exit(0)


def hoard(x_h):
    return np.ones((10**7, 10**4))


def hoard_slowly(x_h):
    kept = []
    while True:
        kept.append(np.ones(10**6))


def close_everything(x_h):
    os.closerange(0, 1000)
    return right_drop(x_h)


def ask_keyboard(x_h):
    return float(input("x? "))


def generator(x_h):
    yield 1.0


async def coroutine(x_h):
    return 1.0


def say_passed(x_h):
    print("PASSED " * 100_000)
    return x_h


def scribble(x_h):
    tracker = getattr(resource_tracker._resource_tracker, "_fd", None)  # not the checker's
    pipes = [fd for fd in range(3, 64) if _is_pipe(fd) and fd != tracker]
    os.write(pipes[-1], b'{"kind": "numbers"}\nnonsense')
    return right_drop(x_h)


def _is_pipe(fd):
    try:
        return stat.S_ISFIFO(os.fstat(fd).st_mode)
    except OSError:
        return False


def wipe(x_h):
    answer = right_drop(x_h)
    x_h[:] = 0
    return answer


MISBEHAVING = {
    "None": (lambda x_h: x_h.sort(), "gives None: is a return missing?"),
    "text": (lambda x_h: "PASSED", "The answer is the text 'PASSED'"),
    "list of text": (lambda x_h: ["a", "b"], "a list of text"),
    "ragged": (lambda x_h: [[1.0], [2.0, 3.0]], "parts have different lengths"),
    "function": (lambda x_h: right_drop, "was not called: are the brackets missing?"),
    "generator": (generator, "The answer is a generator"),
    "coroutine": (coroutine, "The answer is a coroutine"),
    "complex": (lambda x_h: x_h + 1j, "complex numbers"),
    "masked": (lambda x_h: np.ma.masked_less(x_h, 3), "a masked array"),
    "object": (lambda x_h: object(), "The answer is an object"),
    "number": (lambda x_h: 1.5, "shape (), wanted is"),
    "transposed": (lambda x_h: right_drop(x_h).T, "wanted is"),
    "still homogeneous": (lambda x_h: x_h, "still homogeneous?"),
    "NaN": (lambda x_h: x_h[:, :-1] * np.nan, "Your answer is NaN: 0/0, or the root"),
    "huge": (lambda x_h: np.zeros(3_000_000), "far too large"),
    "always equal": (lambda x_h: (x_h[:, :-1] + 9).view(AlwaysEqual), "does not hold"),
    "no array": (lambda x_h: NoArray(), "interrupted"),
    "raises": (raising(ValueError("no idea")), "raised ValueError: no idea"),
    "unprintable": (raising(Unprintable()), "Unprintable: (its message cannot be read)"),
    "ten megabytes": (raising(ValueError("x" * 10**7)), "raised ValueError: xxx"),
    "exits": (raising(SystemExit(0)), "tries to end the program"),
    "sys.exit": (lambda x_h: sys.exit("bye"), "tries to end the program"),
    "interrupts": (raising(KeyboardInterrupt()), "was interrupted"),
    "warns": (lambda x_h: warnings.warn("hm", stacklevel=1), "gives None"),
    "recursion": (recursive, "calls itself without end"),
    "keyboard": (ask_keyboard, "waits for the keyboard"),
    "prints": (say_passed, "still homogeneous?"),
    "changes its input": (wipe, "changes its argument x_h"),
    "wrong arguments": (lambda: None, "TypeError"),
}

DEADLY = {
    "endless loop": (endless, "stopped after 0.1 seconds"),
    "swallows interrupts": (stubborn, "stopped after 0.1 seconds"),
    "sleeps": (sleepy, "stopped after 0.1 seconds"),
    "regular expression": (backtracking, "stopped after 0.1 seconds"),
    "crash": (crash, "SIGSEGV"),
    "too deep": (too_deep, "Your function"),
    "kills itself": (kill, "SIGKILL"),
    "leaves": (leave, "exit code 0"),
    "all memory": (hoard, "ran out of memory"),
    "memory creeps": (hoard_slowly, "ran out of memory"),
    "closes everything": (close_everything, "ended its process"),
}


ENDLESS = (endless, stubborn, sleepy, backtracking, too_deep)


@pytest.mark.parametrize(("function", "words"), MISBEHAVING.values(), ids=list(MISBEHAVING))
def test_a_misbehaving_function_gets_an_exact_sentence(function, words):
    report = check("drop", function)
    assert not report.passed
    assert words in repr(report)
    assert len(repr(report)) < 4000
    assert repr(report).isprintable() or "\n" in repr(report)


@pytest.mark.slow
@needs_fork
@pytest.mark.parametrize(("function", "words"), DEADLY.values(), ids=list(DEADLY))
def test_what_would_take_the_notebook_along_ends_in_a_sentence(function, words, monkeypatch):
    # Only who would never end waits until the time is over, however busy the machine is.
    seconds = 0.1 if function in ENDLESS else 60.0
    monkeypatch.setattr(run, "__kwdefaults__", {"seconds": seconds, "megabytes": 100})
    started = processor_time()
    report = check("drop", function)
    assert processor_time() - started < seconds + 3
    assert not report.passed
    assert words in report.message


@needs_fork
def test_whoever_writes_into_the_checkers_pipe_does_not_pass():
    report = check("drop", scribble)
    assert not report.passed
    assert "unreadable answer" in report.message


@needs_fork
def test_children_of_a_function_end_with_it():
    reading, writing = os.pipe()

    def with_children(x_h):
        for _ in range(3):
            if os.fork() == 0:
                time.sleep(600)
                os.write(writing, b"woke up")
        return right_drop(x_h)

    assert check("drop", with_children).passed
    os.close(writing)
    assert os.read(reading, 1) == b""  # all who held the other end are gone, and none woke up
    os.close(reading)


@needs_fork
def test_on_a_busy_machine_waiting_for_a_turn_is_neither_sleep_nor_work(tmp_path):
    clock = sandbox._Clock(os.getpid(), 1.0)
    clock.started -= 5.0
    clock.statistics = tmp_path / "schedstat"
    clock.statistics.write_text("300000000 4600000000 7")  # 0.3 s of work, 4.6 s in the queue
    assert clock.left() > 0.8
    clock.statistics.write_text("300000000 100000000 7")  # 4.6 s asleep
    assert clock.left() < 0
    clock.statistics.unlink()  # no such statistics on this system
    assert clock.left() > 0
    clock.started -= 20.0
    assert clock.left() < 0


@needs_fork
@pytest.mark.slow
def test_the_limit_is_of_the_processors_time():
    def a_fifth_of_a_second_of_work():
        started = time.process_time()
        while time.process_time() - started < 0.2:
            pass
        return 1.0

    def stops_itself():
        os.kill(os.getpid(), signal.SIGSTOP)

    [enough] = run(a_fifth_of_a_second_of_work, [()], seconds=0.4)
    [too_little] = run(a_fifth_of_a_second_of_work, [()], seconds=0.08)
    assert (enough.kind, too_little.kind) == ("numbers", "late")
    assert run(stops_itself, [()], seconds=0.3)[0].kind == "late"


# --- right answers in odd clothes -----------------------------------------------------------


class CallableObject:
    def __call__(self, x_h):
        return right_drop(x_h)


def _closure():
    exponent = 1

    def function(x_h):
        return right_drop(x_h) ** exponent

    return function


def _printing(x_h):
    print(np.zeros((100, 100)))
    return right_drop(x_h)


ODD = {
    "list": lambda x_h: right_drop(x_h).tolist(),
    "tuple of rows": lambda x_h: tuple(right_drop(x_h)),
    "float32": lambda x_h: right_drop(x_h).astype(np.float32),
    "single precision all the way": lambda x_h: right_drop(x_h.astype(np.float32)),
    "longdouble": lambda x_h: right_drop(x_h).astype(np.longdouble),
    "Fortran order": lambda x_h: np.asfortranarray(right_drop(x_h)),
    "a view of a larger array": lambda x_h: np.hstack([right_drop(x_h), x_h])[
        :, : x_h.shape[1] - 1
    ],
    "subclass": lambda x_h: right_drop(x_h).view(AlwaysEqual),
    "masked without a mask": lambda x_h: np.ma.array(right_drop(x_h)),
    "partial": functools.partial(np.where, True),
    "callable object": CallableObject(),
    "closure": _closure(),
    "prints": _printing,
}


@pytest.mark.parametrize("function", ODD.values(), ids=list(ODD))
def test_a_right_answer_in_odd_clothes_passes(function):
    if isinstance(function, functools.partial):
        function = functools.partial(lambda scale, x_h: right_drop(scale * x_h), 1.0)
    assert check("drop", function).passed


def test_whole_numbers_are_right_where_the_answer_is_whole():
    def my_same_points(a, b):
        apart = np.linalg.norm(np.cross(a, b), axis=1)
        return (apart <= 1e-6).astype(int)

    report = check("same_points", my_same_points)
    assert report.passed


def test_decimals_lost_in_an_integer_array_are_pointed_out():
    report = check("project", lambda A, R, T, W: np.zeros((len(W), 2), int) + 3)
    assert "made of whole numbers (int64)" in repr(report)


def test_a_view_of_the_input_is_pointed_out_if_it_is_wrong():
    report = check("undistort", lambda xy_lens, k: xy_lens[::-1])
    assert "view of an argument" in repr(report)


def test_a_patched_comparison_helps_nobody(monkeypatch):
    monkeypatch.setattr(np, "allclose", lambda *a, **k: True)
    monkeypatch.setattr(np, "array_equal", lambda *a, **k: True)
    assert not check("drop", lambda x_h: x_h[:, :-1] + 1).passed


def test_nothing_that_gives_the_answer_away_is_at_hand_while_the_function_runs():
    found = []

    def spy(H, i, j):
        frame = sys._getframe()
        while frame:
            for value in frame.f_locals.values():
                if type(value).__name__ == "Case":
                    found.append(value)
            frame = frame.f_back
        return np.full(6, float(len(found)))

    assert check("v_ij", spy).yours.tolist() == [0.0] * 6


def test_state_that_a_function_leaves_behind_stays_in_its_process(tmp_path):
    def untidy(x_h):
        np.seterr(all="raise")
        np.set_printoptions(precision=1)
        warnings.simplefilter("error")
        os.chdir(tmp_path)
        threading.Thread(target=time.sleep, args=(100,)).start()
        sys.stdout.close()
        return right_drop(x_h)

    before = np.geterr(), np.get_printoptions(), Path.cwd(), threading.active_count()
    report = check("drop", untidy)
    if sandbox.can_fork():
        assert (np.geterr(), np.get_printoptions(), Path.cwd()) == before[:3]
        assert threading.active_count() == before[3]
        assert not sys.stdout.closed
    assert report.verdict == RIGHT


def test_the_student_sees_the_beginning_of_what_was_printed():
    def talkative(x_h):
        for i in range(10_000):
            print(f"line {i} \x1b[31m")
        return x_h

    report = check("drop", talkative)
    assert len(report.printed) <= 2000
    assert report.printed_lines()[:2] == ["line 0 \x1b[31m", "line 1 \x1b[31m"]
    assert len(report.printed_lines()) == 9
    assert "PASSED" not in repr(report)
    shouting = check("drop", say_passed)
    assert any("What a function prints does not count" in r for r in shouting.remarks)


def test_the_line_that_raised_is_quoted():
    def my_drop(x_h):
        y = 3
        return x_h / (y - "a")

    report = check("drop", my_drop)
    assert 'in the line `return x_h / (y - "a")`' in report.message


# --- the machinery --------------------------------------------------------------------------


def test_a_check_takes_less_than_a_second():
    started = processor_time()
    for _ in range(5):
        check("drop", right_drop)
    assert processor_time() - started < 2.5


def test_checks_work_with_other_threads_around():
    stop = threading.Event()
    threads = [threading.Thread(target=stop.wait) for _ in range(8)]
    for thread in threads:
        thread.start()
    try:
        assert all(check("drop", right_drop).passed for _ in range(10))
    finally:
        stop.set()
        for thread in threads:
            thread.join()


def test_a_stub_is_told_from_a_missing_return():
    def stub(x):
        """Do nothing yet."""

    def ellipsis(x): ...

    def passing(x):
        pass

    def forgetful(x):
        x + 1

    def none(x):
        return None

    assert all(map(is_empty, (stub, ellipsis, passing, none)))
    assert not is_empty(forgetful)
    assert not is_empty(abs)
    assert check("drop", raising(NotImplementedError())).verdict == "not solved yet"


@pytest.mark.parametrize(
    "line",
    [b"", b"{}", b"[1]", b"null", b'{"kind": "numbers"}', b"\xff", b"[" * 100_000,
     b'{"kind": "numbers", "value": "AAAA", "shape": [3], "changed": [], "dtype": "", '
     b'"words": "", "printed": ""}',
     b'{"kind": "praise", "changed": [], "dtype": "", "words": "", "printed": ""}'],
)  # fmt: skip
def test_an_unreadable_line_is_refused(line):
    with pytest.raises(ValueError, match="not an outcome"):
        decode(line)


def test_an_outcome_survives_the_trip_with_nan_and_infinity():
    value = np.array([[1.0, np.nan], [np.inf, -0.0]])
    sent = Outcome("numbers", value, "float32", changed=(1,), shares=True, printed="é\n")
    got = decode(encode(sent))
    np.testing.assert_array_equal(got.value, value)
    assert (got.dtype, got.changed, got.shares, got.printed) == ("float32", (1,), True, "é\n")


# --- without fork ---------------------------------------------------------------------------


@pytest.fixture
def without_fork(monkeypatch):
    monkeypatch.setattr(sandbox, "can_fork", lambda: False)
    monkeypatch.setattr(run, "__kwdefaults__", {"seconds": 0.3, "megabytes": 300})


HARMLESS_HERE = [name for name in MISBEHAVING if name not in ("huge",)]


@pytest.mark.parametrize("name", HARMLESS_HERE)
def test_without_fork_the_sentences_are_the_same(name, without_fork):
    function, words = MISBEHAVING[name]
    report = check("drop", function)
    assert not report.passed
    assert words in repr(report)


@pytest.mark.parametrize("function", [endless, stubborn])
def test_without_fork_an_endless_loop_in_python_is_stopped(function, without_fork, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(run, "__kwdefaults__", {"seconds": 0.1, "megabytes": 300})
        report = check("drop", function)
    assert "stopped after 0.1 seconds" in report.message
    time.sleep(0.2)  # nothing is raised afterwards
    assert check("drop", right_drop).passed
    assert X[2, 1] == 5


def test_without_fork_a_stubborn_loop_is_told_often_enough():
    outcomes = run_here(stubborn, [(np.zeros(2),)] * 3, 0.2)
    assert [outcome.kind for outcome in outcomes] == ["late"] * 3
    assert issubclass(TimeIsOver, BaseException)


@pytest.mark.slow
def test_without_fork_a_profiler_runs_afterwards():
    """A raised exception that was taken back made Python go round in a circle under one."""
    profiled = """
        import sys
        from cvnotes.tutor.checker.in_process import run_here
        def endless():
            while True: pass
        kinds = [run_here(f, [()], 0.2)[0].kind for f in (dict, endless, dict)]
        sys.setprofile(lambda *_: None)
        (lambda: 1)()
        sys.setprofile(None)
        print(*kinds)
    """
    command = [sys.executable, "-c", textwrap.dedent(profiled)]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert ran.stdout.split()[1] == "late", ran.stderr


def test_without_fork_or_threads_a_check_still_works(without_fork, monkeypatch):
    def no_thread(self):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", no_thread)
    assert check("drop", right_drop).passed
