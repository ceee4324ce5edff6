"""One handed-in notebook in a process of its own, with limits of time and memory.

See `cvnotes.learn.grader.handin` for what the process does. Only what it writes into one file
comes back, and that file is read as if anybody had written it.
"""

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from cvnotes.pictures.course import DATA

_MAX_RESULTS = 200 * 2**20


def run_notebook(
    content: bytes, seed: int, seconds: float, megabytes: int
) -> tuple[list[dict[str, Any]], str]:
    """Run a notebook in a scratch folder, and give what it hands over.

    Parameters
    ----------
    content : bytes
        The notebook's file.
    seed : int
        Of the inputs that its answers are tried on.
    seconds, megabytes : float and int
        What it may use.

    Returns
    -------
    lines : list of dict
        What the process wrote down, line by line.
    ended : str
        How it ended, if not by itself.
    """
    with tempfile.TemporaryDirectory(prefix="cvnotes-", ignore_cleanup_errors=True) as scratch:
        ended = _run(Path(scratch), content, seed, seconds, megabytes)
        return _lines(Path(scratch) / "results"), ended


def _run(scratch: Path, content: bytes, seed: int, seconds: float, megabytes: int) -> str:
    """Run a notebook in a folder laid out like the course; says how it ended, if not by itself."""
    (scratch / "notebooks").mkdir()
    (scratch / "handed_in.ipynb").write_bytes(content)
    if DATA.is_dir():
        with contextlib.suppress(OSError):
            (scratch / "data").symlink_to(DATA, target_is_directory=True)
    command = [sys.executable, "-m", "cvnotes.learn.grader.handin"]
    command += [str(scratch / "handed_in.ipynb"), str(scratch / "results"), "--seed", str(seed)]
    command += ["--cell-seconds", str(max(5.0, seconds / 4)), "--megabytes", str(megabytes)]
    process = subprocess.Popen(
        command,
        cwd=scratch / "notebooks",
        env=_environment(scratch),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        code = process.wait(seconds)
    except subprocess.TimeoutExpired:
        return f"stopped after {seconds:g} seconds"
    finally:
        _end(process)
    return "" if code in (0, 1) else f"ended its process ({_ending(code)})"


def _environment(scratch: Path) -> dict[str, str]:
    """Give a notebook's process what it needs: no secrets, one thread, figures without a screen."""
    kept = ("PATH", "LANG", "LC_ALL", "SYSTEMROOT", "TEMP", "TMP", "VIRTUAL_ENV", "LD_LIBRARY_PATH")
    environment = {name: os.environ[name] for name in kept if name in os.environ}
    package = str(Path(__file__).resolve().parents[3])
    cache = os.environ.get("XDG_CACHE_HOME") or str(Path("~/.cache").expanduser())
    threads = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    return (
        environment
        | dict.fromkeys(threads, "1")
        | {"PYTHONPATH": package, "MPLBACKEND": "agg", "XDG_CACHE_HOME": cache}
        | {"HOME": str(scratch), "IPYTHONDIR": str(scratch / "ipython"), "PYTHONUTF8": "1"}
    )


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End a notebook's process, and what it started."""
    if hasattr(os, "killpg"):
        with contextlib.suppress(OSError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()


def _ending(code: int) -> str:
    return signal.Signals(-code).name if code < 0 else f"exit code {code}"


def _lines(results: Path) -> list[dict[str, Any]]:
    """Read what the process wrote, leaving out what is no such line."""
    lines = []
    try:
        with results.open("rb") as stream:
            for line in stream.read(_MAX_RESULTS).splitlines():
                with contextlib.suppress(ValueError, RecursionError):
                    lines.append(json.loads(line))
    except OSError:
        return []
    return [line for line in lines if isinstance(line, dict)]
