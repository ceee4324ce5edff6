"""`start.py`: whatever state `.venv` is in, the course starts or one sentence says what to do."""

import ast
import importlib.util
import inspect
import json
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import textwrap
import time
import urllib.request
import venv
from pathlib import Path

import pytest

from cvnotes.commands.quiet import transport

pytestmark = pytest.mark.once

START = Path(__file__).resolve().parents[1] / "start.py"
posix = pytest.mark.skipif(os.name == "nt", reason="signals and terminals of POSIX")
BIN = "Scripts/python.exe" if os.name == "nt" else "bin/python"


def load(path):
    spec = importlib.util.spec_from_file_location("start_of_the_course", path)
    start = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(start)
    return start


@pytest.fixture
def start():
    return load(START)


@pytest.fixture(autouse=True)
def no_environment_of_ours(monkeypatch):
    for name in ("CVNOTES_VENV", "PIP_CONSTRAINT", "PYTHONPATH"):
        monkeypatch.delenv(name, raising=False)
    create, which = venv.create, shutil.which
    monkeypatch.setattr("shutil.which", lambda name: None if name == "uv" else which(name))

    def without_pip(folder, with_pip=False, clear=False):  # pip would take seconds, for nothing
        assert with_pip or load(START).UV
        create(folder, clear=clear, symlinks=True)

    monkeypatch.setattr("venv.create", without_pip)


class Clone:
    """A folder that looks like a clone; what pip would do to its environment is written down."""

    def __init__(self, root):
        self.root, self.asked = root, []
        if not root.exists():
            (root / "cvnotes").mkdir(parents=True)
            (root / "cvnotes" / "__init__.py").touch()
            (root / "pyproject.toml").write_text("[project]")
            shutil.copy(START, root)
        self.start = load(root / "start.py")
        self.start.pip = self.pip
        self.start.NEEDED = ()  # nothing is really installed

    def pip(self, python, _, what):
        """Install in editable form: leave a path in the environment."""
        self.asked.append(what)
        if what[0] == "--editable":
            [packages] = python.parents[1].glob("lib/python*/site-packages")
            (packages / "course.pth").write_text(what[1].split("[")[0])

    def python(self, extra="lab"):
        return self.start.environment(extra)

    def imports(self, python):
        """Give the folder of the course that an environment's Python imports."""
        ask = [python, "-I", "-c", "import cvnotes; print(cvnotes.__file__)"]
        return Path(subprocess.check_output(ask, text=True).strip()).parents[1]


@pytest.fixture
def clone(tmp_path):
    return Clone(tmp_path / "course")


# --- What is typed ------------------------------------------------------------------------------


def test_an_older_python_is_told_so(start, monkeypatch, capsys):
    monkeypatch.setattr("sys.version_info", (3, 8, 10))
    assert start.main([]) == 1
    assert "needs Python 3.11 or newer" in capsys.readouterr().err


def test_an_older_python_can_read_so_far(start):
    ast.parse(START.read_text(encoding="utf-8"), feature_version=(3, 8))
    functions = [value for value in vars(start).values() if inspect.isfunction(value)]
    annotations = [each for f in functions for each in f.__annotations__.values()]
    assert len(annotations) > 20
    assert {type(each) for each in annotations} == {str}  # not evaluated: 3.9 has no `X | None`


def test_the_command_without_its_packages_says_how_to_get_them():
    code = "import sys; sys.modules['numpy'] = None; from cvnotes.commands.cli import main; "
    code += "sys.exit(main(['lab', '--copy']))"
    command, env = [sys.executable, "-c", code], os.environ | {"PYTHONPATH": str(START.parent)}
    ran = subprocess.run(command, capture_output=True, text=True, env=env)
    assert ran.returncode == 1
    assert "has no numpy, which the course needs; in a clone call python3 start.py" in ran.stderr
    assert len(ran.stderr.splitlines()) == 1


@pytest.fixture
def becomes(start, monkeypatch):
    monkeypatch.setattr(start, "environment", lambda extra: Path(extra))
    monkeypatch.setattr(start, "become", lambda command: command)
    return start.main


def test_options_without_a_command_go_to_the_course(becomes):
    assert becomes([]) == ["lab", "-m", "cvnotes", "lab"]
    assert becomes(["--no-browser"]) == ["lab", "-m", "cvnotes", "lab", "--no-browser"]
    assert becomes(["lab", "--port", "9"]) == ["lab", "-m", "cvnotes", "lab", "--port", "9"]
    assert becomes(["test", "-k", "lens"]) == ["dev", "-m", "pytest", "-k", "lens"]
    assert becomes(["check"]) == ["dev", "tools/check.py"]


def test_a_wrong_command_is_named_and_help_is_the_docstring(becomes, start, capsys):
    assert becomes(["foo"]) == 2
    said = capsys.readouterr()
    assert said.err.startswith("start.py knows no command 'foo'; there are lab, check, test, site")
    assert said.err.count("\n") == 1
    assert becomes(["--help"]) == 0
    assert capsys.readouterr().out.strip() == start.__doc__.strip()


def test_what_is_installed_is_declared(start):
    text = (START.parent / "pyproject.toml").read_text()
    for extra in start.EXTRAS.values():
        assert re.search(rf"^{extra} = \[", text, re.M), extra
        assert extra in start.SIZE


# --- The environment ----------------------------------------------------------------------------


@posix
class TestEnvironment:
    def test_it_is_made_once_and_again_when_the_recipe_changes(self, clone, capsys):
        python = clone.python()
        assert "190 MB to download" in capsys.readouterr().out
        assert python == clone.root / ".venv" / BIN
        assert clone.imports(python) == clone.root
        assert len(clone.asked) == 1
        clone.python()
        assert len(clone.asked) == 1
        (clone.root / "pyproject.toml").write_text("[project]\nname = 'other'")
        clone.python()
        assert len(clone.asked) == 2
        assert "what has changed since" in capsys.readouterr().out
        clone.python("dev")
        assert clone.asked[-1] == ["--editable", f"{clone.root}[dev]"]

    def test_what_tests_need_contains_what_readers_need(self, clone):
        clone.python("dev")
        clone.python("lab")
        assert len(clone.asked) == 1

    def test_a_moved_clone_gets_a_new_one(self, clone, tmp_path):
        clone.python()
        (clone.root / ".venv" / "old").touch()
        moved = Clone(clone.root.rename(tmp_path / "elsewhere"))
        python = moved.python()
        assert moved.imports(python) == tmp_path / "elsewhere"
        assert str(tmp_path / "elsewhere") in (moved.root / ".venv/bin/activate").read_text()
        assert not (moved.root / ".venv" / "old").exists()

    def test_a_copied_clone_does_not_import_the_original(self, clone, tmp_path):
        clone.python()
        shutil.copytree(clone.root, tmp_path / "copy", symlinks=True)
        copy = Clone(tmp_path / "copy")
        assert clone.imports(copy.root / ".venv" / BIN) == clone.root  # silently, today
        assert copy.imports(copy.python()) == copy.root
        assert clone.imports(clone.python()) == clone.root

    def test_an_interpreter_that_is_gone_is_replaced(self, clone):
        python = clone.python()
        python.unlink()
        python.symlink_to("/nowhere/python3")
        assert clone.imports(clone.python()) == clone.root

    def test_one_that_has_lost_packages_is_made_anew(self, clone):
        python = clone.python()
        clone.start.NEEDED = ("json", "a_package_that_was_deleted")
        clone.python()
        assert len(clone.asked) == 2
        assert clone.imports(python) == clone.root
        clone.start.NEEDED = ("json",)
        clone.python()
        assert len(clone.asked) == 2

    def test_a_relative_folder_is_meant_from_here(self, clone, tmp_path, monkeypatch):
        (tmp_path / "here").mkdir()
        monkeypatch.chdir(tmp_path / "here")
        monkeypatch.setenv("CVNOTES_VENV", "envs/one")
        assert clone.python() == tmp_path / "here" / "envs" / "one" / BIN
        assert not (clone.root / ".venv").exists()

    def test_an_environment_made_by_others_is_used_and_kept(self, clone):
        venv.EnvBuilder(symlinks=True).create(clone.root / ".venv")
        (clone.root / ".venv" / "theirs").touch()
        assert clone.imports(clone.python()) == clone.root
        assert (clone.root / ".venv" / "theirs").exists()

    def test_a_broken_one_elsewhere_is_not_deleted(self, clone, tmp_path, monkeypatch):
        other = tmp_path / "other"
        venv.EnvBuilder(symlinks=True).create(other)
        (other / BIN).unlink()
        monkeypatch.setenv("CVNOTES_VENV", str(other))
        with pytest.raises(clone.start.CannotError, match="does not start; delete that folder"):
            clone.python()
        assert (other / "pyvenv.cfg").exists()

    def test_nor_is_one_of_theirs_in_which_the_course_was_installed(
        self, clone, tmp_path, monkeypatch
    ):
        theirs, own = tmp_path / "theirs", tmp_path / "own"
        venv.EnvBuilder(symlinks=True).create(theirs)
        for folder in (theirs, own):
            monkeypatch.setenv("CVNOTES_VENV", str(folder))
            clone.python()
            (folder / "notes").touch()
        clone.start.NEEDED = ("a_package_that_was_deleted",)
        clone.python()  # made here, and made anew
        assert not (own / "notes").exists()
        monkeypatch.setenv("CVNOTES_VENV", str(theirs))
        with pytest.raises(clone.start.CannotError, match="lost a_package_that_was_deleted; del"):
            clone.python()
        (theirs / BIN).unlink()
        with pytest.raises(clone.start.CannotError, match="does not start"):
            clone.python()
        assert (theirs / "notes").exists()

    def test_a_folder_of_other_things_is_left_alone(self, clone, tmp_path, monkeypatch):
        (tmp_path / "letters").mkdir()
        (tmp_path / "letters" / "to_ada.txt").write_text("Dear Ada")
        monkeypatch.setenv("CVNOTES_VENV", str(tmp_path / "letters"))
        with pytest.raises(clone.start.CannotError, match="holds something else"):
            clone.python()
        assert [path.name for path in (tmp_path / "letters").iterdir()] == ["to_ada.txt"]

    def test_where_nothing_can_be_written_that_is_said(self, clone, tmp_path, monkeypatch):
        (tmp_path / "file").touch()
        monkeypatch.setenv("CVNOTES_VENV", str(tmp_path / "file" / "venv"))
        with pytest.raises(clone.start.CannotError, match=r"cannot be written .* set CVNOTES_VENV"):
            clone.python()
        monkeypatch.setenv("CVNOTES_VENV", str(tmp_path / "file"))
        with pytest.raises(clone.start.CannotError, match="is no folder"):
            clone.python()

    def test_so_it_does_where_venv_left_an_environment_without_pip(self, start, monkeypatch):
        found = importlib.util.find_spec
        monkeypatch.setattr(
            "importlib.util.find_spec", lambda name: None if name == "ensurepip" else found(name)
        )
        start.probe = lambda _: {"pip": False}
        monkeypatch.setattr(
            "subprocess.run", lambda command, **_: subprocess.CompletedProcess(command, 1)
        )
        with pytest.raises(start.CannotError, match="sudo apt install python3-venv"):
            start.pip(Path("somewhere/bin/python"), {"pip": False}, ["course"])

    def test_without_ensurepip_it_names_the_package_before_all_else(
        self, clone, monkeypatch, capsys
    ):
        found = importlib.util.find_spec
        monkeypatch.setattr(
            "importlib.util.find_spec", lambda name: None if name == "ensurepip" else found(name)
        )
        with pytest.raises(clone.start.CannotError, match="sudo apt install python3-venv"):
            clone.python()
        assert not (clone.root / ".venv").exists()
        # What Debian's `python3 -m venv` leaves behind when it refuses.
        venv.EnvBuilder(symlinks=True).create(clone.root / ".venv")
        found_there = clone.start.probe(clone.root / ".venv" / BIN)
        assert found_there["ensurepip"]
        clone.start.probe = lambda _: found_there | {"ensurepip": False}
        with pytest.raises(clone.start.CannotError, match="sudo apt install python3-venv"):
            clone.python()
        assert capsys.readouterr().out == ""  # no download is announced that does not come

    def test_without_a_network_what_was_installed_before_goes_on(self, clone, capsys):
        python = clone.python()

        def pip(*_):
            raise clone.start.CannotError("the packages cannot be reached")

        clone.start.pip = pip
        (clone.root / "pyproject.toml").write_text("[project]\nname = 'newer'")
        assert clone.python() == python
        assert "goes on with the packages that it had" in capsys.readouterr().out
        with pytest.raises(clone.start.CannotError, match="cannot be reached"):
            clone.python("docs")


@pytest.mark.slow
def test_without_a_network_the_reason_is_told_soon(start, monkeypatch, tmp_path):
    for name in [name for name in os.environ if name.startswith("PIP_")]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("PIP_CONFIG_FILE", os.devnull)
    monkeypatch.setenv("PIP_TARGET", str(tmp_path))
    monkeypatch.setenv("PIP_INDEX_URL", "http://127.0.0.1:9/simple")  # nobody listens there
    lines = []
    monkeypatch.setattr(start, "progress", lines.append)
    with pytest.raises(start.CannotError, match="is this machine connected to a network"):
        start.pip(Path(sys.executable), {"pip": True}, ["cvnotes-asks-for-nothing"])
    # Where nothing answers at all each costs 15 s. By itself, pip tries again five times.
    assert sum("Retrying" in line for line in lines) == 1


@pytest.mark.slow
@posix
def test_an_environment_of_uv_gets_pip(start, tmp_path):
    venv.EnvBuilder(symlinks=True).create(tmp_path / "env")
    found = start.probe(tmp_path / "env" / BIN)
    assert found["pip"] is False
    start.pip(tmp_path / "env" / BIN, found, ["--help"])
    assert start.probe(tmp_path / "env" / BIN)["pip"] is True


@posix
class TestUv:
    """A program in place of uv: it notes what it is asked, and succeeds or not."""

    @pytest.fixture
    def uv(self, tmp_path, monkeypatch):
        def made(code):
            path = tmp_path / "uv"
            path.write_text(
                "#!/bin/sh\n"
                f'echo "$@ constraint=$UV_CONSTRAINT" >> {tmp_path}/asked\n'
                f"echo 'Downloading numpy (16.0MiB)'\necho 'error: no such index'\nexit {code}\n"
            )
            path.chmod(0o700)
            monkeypatch.setattr("shutil.which", lambda name: str(path) if name == "uv" else None)

        return made

    def test_it_installs_where_it_is_and_pip_is_not_needed(self, uv, tmp_path, monkeypatch, capsys):
        uv(0)
        monkeypatch.setenv("PIP_CONSTRAINT", "oldest.txt")
        clone = Clone(tmp_path / "course")
        clone.start.check_whole = lambda: pytest.fail("venv and ensurepip are not needed")
        python = clone.python()
        assert not clone.start.probe(python)["pip"]
        [course] = (tmp_path / "asked").read_text().splitlines()
        assert course == (
            f"pip install --python {python} --editable {clone.root}[lab] constraint=oldest.txt"
        )
        assert clone.asked == []
        assert "numpy, 16.0 MB" in capsys.readouterr().out

    def test_where_it_fails_pip_goes_on(self, uv, tmp_path, capsys):
        uv(2)
        clone = Clone(tmp_path / "course")
        clone.python()
        assert len(clone.asked) == 1
        assert "(uv could not: error: no such index; pip is asked)" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("Downloading opencv-python-headless (51.2MiB)", "opencv-python-headless, 51.2 MB"),
        ("Downloading numpy-2.3.5-cp311-cp311-x.whl (16.9 MB)", "numpy 2.3.5, 16.9 MB"),
        ("Downloading https://a/b/scipy-1.16-cp311-x.whl (35 MB)", "scipy 1.16, 35 MB"),
        ("Downloading idna-3.11-py3-none-any.whl (71 kB)", None),
        ("Installing collected packages: a, b, c", "putting 3 packages in place …"),
        ("Requirement already satisfied: pip", None),
    ],
)
def test_what_is_loaded_is_told_if_it_takes_a_while(start, line, told):
    assert start.progress(line) == told


@posix
def test_kernels_are_spoken_to_by_files_where_their_names_are_short_enough():
    assert transport("/run/user/1000/jupyter/runtime") == "ipc"
    assert transport("/disk/" + 60 * "a") == "tcp"
    assert transport("/disk/" + 30 * "ö") == "tcp"  # bytes count


# --- Ctrl-C -------------------------------------------------------------------------------------

# What `cvnotes lab` is to a terminal: it has a server, and takes its time to end it.
STAND_IN = """
    import signal, subprocess, sys, time
    def end(*_): raise KeyboardInterrupt
    signal.signal(signal.SIGTERM, end)
    signal.signal(signal.SIGINT, end)
    wait = [sys.executable, "-c", "import time; time.sleep(600)"]
    server = subprocess.Popen(wait, start_new_session=True)
    try:
        print("server", server.pid, "up", flush=True)
        while True:  # no lock is held when Ctrl-C comes, as `wait` may hold one; and a signal that
            time.sleep(0.1)  # comes just before a sleep begins ends only the next
    except KeyboardInterrupt:
        time.sleep(0.4)
        server.terminate()
        server.wait()
        print("closed", flush=True)
        sys.exit(130)
"""
# start.py with this Python for its environment, and perhaps another program behind a command.
DRIVER = """
    import importlib.util, sys
    from pathlib import Path
    spec = importlib.util.spec_from_file_location("start", {path!r})
    start = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(start)
    start.environment = lambda extra: Path(sys.executable)
    start.RUN.update({run!r})
    try:
        sys.exit(start.main(sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit(130)
"""


class Terminal:
    """A program in a pseudo-terminal, where Ctrl-C is a key."""

    def __init__(self, folder, run, *arguments):
        code = textwrap.dedent(DRIVER).format(path=str(START), run=run)
        self.said = ""
        self.keyboard, self.screen = os.openpty()
        self.pid = os.fork()
        if self.pid == 0:
            os.login_tty(self.screen)
            os.environ["PYTHONPATH"] = str(START.parent)
            signal.signal(signal.SIGINT, signal.default_int_handler)
            os.chdir(folder)
            os.execv(sys.executable, [sys.executable, "-c", code, *arguments])

    def read(self, pattern, seconds=300):
        """Read until a pattern has come; gives the match, or None after so many seconds."""
        end = time.monotonic() + seconds
        while not (found := re.search(pattern, self.said)) and time.monotonic() < end:
            self.take()
        return found

    def take(self):
        """Read what has come; tells if anything has."""
        came = bool(select.select([self.keyboard], [], [], 0.1)[0])
        if came:
            self.said += os.read(self.keyboard, 4096).decode()
        return came

    def press_ctrl_c(self):
        os.write(self.keyboard, b"\x03")

    def ends(self):
        """Read to the end; gives the exit code.

        This end of the screen stays open until then: when the last one closes, a system may drop
        words that were not read yet.
        """
        end = time.monotonic() + 300
        pid = 0
        while not pid and time.monotonic() < end:
            self.take()
            pid, status = os.waitpid(self.pid, os.WNOHANG)
        assert pid, f"it still runs, and said {self.said!r}"
        while self.take():
            pass
        os.close(self.keyboard)
        os.close(self.screen)
        return os.waitstatus_to_exitcode(status)


def processes():
    """Give the words by which each process was called; a bare Debian has no `ps`."""
    if Path("/proc/self/cmdline").exists():
        folders = [path for path in Path("/proc").iterdir() if path.name.isdecimal()]
        return {int(path.name): _words(path / "cmdline") for path in folders}
    lines = subprocess.check_output(["ps", "-wweo", "pid,stat,args"], text=True).splitlines()[1:]
    words = [line.split(maxsplit=2) for line in lines]
    return {int(pid): "" if "Z" in state else called for pid, state, called in words}


def _words(path):
    """Read what a process was called by: nothing if it has ended, or waits to be buried."""
    try:
        return path.read_bytes().replace(b"\0", b" ").decode(errors="replace")
    except OSError:
        return ""


def runs(pid):
    return bool(processes().get(pid))


@posix
@pytest.mark.slow
@pytest.mark.parametrize("kind", [signal.SIGINT] * 8 + [signal.SIGTERM])
def test_stopped_in_a_terminal_it_leaves_nothing_running(kind, tmp_path):
    (tmp_path / "lab.py").write_text(textwrap.dedent(STAND_IN))
    terminal = Terminal(tmp_path, {"lab": [str(tmp_path / "lab.py")]})
    server = int(terminal.read(r"server (\d+) up")[1])
    if kind == signal.SIGINT:
        terminal.press_ctrl_c()
    else:
        os.kill(terminal.pid, kind)
    assert terminal.ends() == 130
    assert "closed" in terminal.said
    assert not runs(server)


@posix
@pytest.mark.slow
def test_jupyterlab_and_its_kernels_end_with_ctrl_c_without_a_word_too_much(tmp_path, monkeypatch):
    pytest.importorskip("jupyterlab")
    monkeypatch.setenv("JUPYTER_CONFIG_DIR", str(tmp_path / "config"))
    folder = str(tmp_path / "mine")
    terminal = Terminal(tmp_path, {}, "lab", folder, "--no-browser", "--port", "0")
    address = terminal.read(r"(http://127\.0\.0\.1:\d+)/lab\S+token=(\S+)\s")
    terminal.read("Ctrl-C ends it")
    url = f"{address[1]}/api/kernels?token={address[2]}"
    with urllib.request.urlopen(url, data=b'{"name": "python3"}', timeout=30) as answer:
        kernel = json.load(answer)["id"]
    terminal.read("eavesdropping", seconds=4)  # time for a kernel to say so
    ours = [
        pid
        for pid, words in processes().items()
        if kernel in words or (folder in words and "jupyterlab" in words)
    ]
    assert len(ours) >= 2
    terminal.press_ctrl_c()
    terminal.press_ctrl_c()  # nobody presses it once only
    assert terminal.ends() == 130
    assert not any(map(runs, ours))
    assert "The course is closed; what you saved is kept." in terminal.said
    assert "eavesdropping" not in terminal.said
    assert "\x1b" not in terminal.said


@posix
@pytest.mark.slow
def test_interrupted_tests_tell_how_far_they_came(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")  # which take seconds to load
    (tmp_path / "pytest.ini").write_text("[pytest]")
    (tmp_path / "test_it.py").write_text(
        "import time\ndef test_a(): pass\ndef test_b():\n    print('asleep')\n    time.sleep(600)\n"
    )
    run = ["-m", "pytest", "-s", "-c", str(tmp_path / "pytest.ini"), str(tmp_path / "test_it.py")]
    terminal = Terminal(tmp_path, {"test": run}, "test")
    terminal.read("asleep")
    for _ in range(3):  # as a hand would, where the first was lost between two lines
        terminal.press_ctrl_c()
        if terminal.read("KeyboardInterrupt", seconds=20):
            break
    assert terminal.ends() == 2
    assert "KeyboardInterrupt" in terminal.said
    assert "1 passed" in re.sub(r"\x1b\[\d*m", "", terminal.said)
