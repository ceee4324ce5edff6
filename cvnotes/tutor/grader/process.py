"""One handed-in notebook in a process of its own, with limits of time and memory.

See `cvnotes.tutor.grader.handin` for what the process does. Only what it writes into one pipe
comes back, and that is read as if anybody had written it.
"""

import contextlib
import json
import os
import pickle
import re
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from cvnotes.tutor.course import Course
from cvnotes.tutor.grader.handin import Arguments, Task
from cvnotes.tutor.grader.judging import ALONE
from cvnotes.tutor.grader.tracking import MARKER, alive, end

# Bytes that one notebook may hand over, with all of its answers.
_MAX_RESULTS = 64 * 2**20
INTERRUPTED = "interrupted"
_SCRATCH = "cvnotes-grade-"


@dataclass(frozen=True)
class Limits:
    """What each notebook may use: seconds, and megabytes of memory."""

    seconds: float = 120.0
    megabytes: int = 4096


@dataclass
class Ran:
    """What a notebook handed over.

    Attributes
    ----------
    answers : dict
        The last line about each exercise, by its name, an answer before a stub; nobody has
        looked at what it says.
    finished : dict
        The line it ends with, if it came that far.
    ended : str
        How it ended, if not by itself.
    sealed : bool
        Whether it ran sealed off from network, files and processes.
    """

    answers: dict[str, dict[str, Any]] = field(default_factory=dict)
    finished: dict[str, Any] = field(default_factory=dict)
    ended: str = ""
    sealed: bool = False


# The batches of notebooks that were stopped, as a set that only ever grows.
_STOPPED: set[str] = set()


def stop(batch: str) -> None:
    """End the notebooks of a batch that run in this process, and start no more of them."""
    _STOPPED.add(batch)


def clear_abandoned() -> None:
    """Remove the scratch folders of graders that were killed before they could."""
    for path in Path(tempfile.gettempdir()).glob(f"{_SCRATCH}*"):
        owner = path.name.removeprefix(_SCRATCH).split("-")[0]
        with contextlib.suppress(OSError):
            if owner.isdigit() and not alive(int(owner)) and path.stat().st_uid == os.getuid():
                shutil.rmtree(path, ignore_errors=True)


def run_notebook(
    cells: list[str],
    seed: int,
    course: Course,
    limits: Limits,
    hidden: Sequence[Path] = (),
    batch: str = "",
) -> Ran:
    """Run a notebook in a scratch folder, and give what it hands over.

    Parameters
    ----------
    cells : list of str
        Its code.
    seed : int
        Of the inputs that its answers are tried on; it stays here.
    course : Course
        Whose exercises it answers.
    limits : Limits
        What it may use.
    hidden : sequence of Path
        What it is not to find.
    batch : str
        Under which name `stop` ends it.
    """
    if batch in _STOPPED:
        return Ran(ended=INTERRUPTED)
    prefix = f"{_SCRATCH}{os.getpid()}-"
    with tempfile.TemporaryDirectory(prefix=prefix, ignore_cleanup_errors=True) as folder:
        scratch = Path(folder).resolve()
        (scratch / "notebooks").mkdir()
        if course.data is not None and course.data.is_dir():
            with contextlib.suppress(OSError):
                (scratch / "data").symlink_to(course.data, target_is_directory=True)
        cell_seconds = max(5.0, limits.seconds / 4)
        names = tuple(str(path.resolve()) for path in hidden)
        inputs = _inputs(seed, course)
        task = Task(cells, inputs, str(scratch), names, cell_seconds, limits.megabytes, course)
        return _run(task, scratch, limits.seconds, batch)


def _inputs(seed: int, course: Course) -> dict[str, list[Arguments]]:
    """Return what the answers are tried on; those with a student's own numbers have no inputs."""
    asked = {**course.exercises}
    for exercise in course.exercises.values():
        asked |= {part.name: part for part in exercise.parts}
    with ALONE:
        return {name: exercise.inputs(seed) for name, exercise in asked.items()}


def _run(task: Task, scratch: Path, seconds: float, batch: str) -> Ran:
    """Run a notebook in a folder laid out like the course."""
    token = secrets.token_hex(16)
    process = subprocess.Popen(
        [sys.executable, "-m", "cvnotes.tutor.grader.handin"],
        cwd=scratch / "notebooks",
        env=_environment(scratch, task.course) | {MARKER: token},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    ran = Ran()
    assert process.stdin is not None
    assert process.stdout is not None
    reader = threading.Thread(target=_read, args=(process.stdout, ran, task.course), daemon=True)
    try:
        reader.start()
        with contextlib.suppress(BrokenPipeError), process.stdin as stream:
            stream.write(pickle.dumps(task))
        ended = _wait(process, seconds, batch)
    finally:
        end(process, token)
        reader.join(2.0)  # whoever still holds the other end of the pipe is not waited for
        if not reader.is_alive():
            process.stdout.close()
    ran.ended = ran.ended or ended
    return ran


def _wait(process: "subprocess.Popen[bytes]", seconds: float, batch: str) -> str:
    """Wait for a notebook; says how it ended, if not by itself."""
    deadline = time.monotonic() + seconds
    while batch not in _STOPPED:
        try:
            code = process.wait(min(0.25, max(0.0, deadline - time.monotonic())))
        except subprocess.TimeoutExpired:
            if time.monotonic() > deadline:
                return f"stopped after {seconds:g} seconds"
        else:
            return "" if code == 0 else f"ended its process ({_ending(code)})"
    return INTERRUPTED


def _environment(scratch: Path, course: Course) -> dict[str, str]:
    """Return the environment of a notebook: no secrets, one thread, figures without a screen."""
    kept = ("PATH", "LANG", "LC_ALL", "SYSTEMROOT", "VIRTUAL_ENV", "LD_LIBRARY_PATH")
    environment = {name: os.environ[name] for name in kept if name in os.environ}
    package = os.pathsep.join(map(str, dict.fromkeys((_folder(__name__), _folder(course.home)))))
    threads = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    (scratch / "tmp").mkdir()
    _copy_fonts(scratch / "cache" / "matplotlib")
    own = {"HOME": "", "XDG_CACHE_HOME": "cache", "IPYTHONDIR": "ipython"}
    own |= dict.fromkeys(("TMPDIR", "TEMP", "TMP"), "tmp")
    return (
        environment
        | dict.fromkeys(threads, "1")
        | {"PYTHONPATH": package, "PYTHONUTF8": "1", "PYTHONDONTWRITEBYTECODE": "1"}
        | {"MPLBACKEND": "agg", "MPLCONFIGDIR": str(scratch / "cache" / "matplotlib")}
        | {name: str(scratch / folder) for name, folder in own.items()}
    )


def _folder(home: str) -> Path:
    """Return the folder that a module, or the package it is in, is imported from."""
    file = Path(str(sys.modules[re.split("[.:]", home)[0]].__file__)).resolve()
    return file.parents[1] if file.name == "__init__.py" else file.parent


def _copy_fonts(target: Path) -> None:
    """Copy matplotlib's list of fonts, which takes seconds to make."""
    target.mkdir(parents=True)
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser())
    folder = Path(os.environ.get("MPLCONFIGDIR") or cache / "matplotlib")
    with contextlib.suppress(OSError):
        for path in folder.glob("fontlist*.json"):
            shutil.copyfile(path, target / path.name)


def _ending(code: int) -> str:
    number = -code if code < 0 else code - 128
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"exit code {code}"


def _read(stream: IO[bytes], ran: Ran, course: Course) -> None:
    """Read lines as they come, keeping the last one about each exercise."""
    left = _MAX_RESULTS
    while left > 0 and (line := stream.readline(left)):
        left -= len(line)
        _keep(line, ran, course)
    if left <= 0:
        ran.ended = f"handed over more than {_MAX_RESULTS >> 20} MB"
        while stream.read(1 << 20):  # nobody is kept waiting who still writes
            pass


def _keep(line: bytes, ran: Ran, course: Course) -> None:
    """Sort a line, leaving out what is none of ours."""
    try:
        fields = json.loads(line)
    except (ValueError, RecursionError):
        return
    if not isinstance(fields, dict):
        return
    name = fields.get("exercise")
    if isinstance(name, str) and name in course.exercises:
        # A stub that is run after an answer takes nothing back.
        if not fields.get("open") or ran.answers.get(name, fields).get("open"):
            ran.answers[name] = fields
    elif fields.get("finished") is True:
        ran.finished = fields
    elif "sealed" in fields and not ran.answers:
        ran.sealed = fields["sealed"] is True
