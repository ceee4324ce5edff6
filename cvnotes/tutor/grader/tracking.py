"""All processes that a notebook started, found and ended."""

import contextlib
import os
import signal
import subprocess
import time
from pathlib import Path

MARKER = "CVNOTES_NOTEBOOK"  # an environment variable with which a notebook's processes begin
_SECONDS = 2.0
_PROC = Path("/proc")


def end(process: "subprocess.Popen[bytes]", token: str) -> None:
    """End a notebook's process and whatever it started, also what left its group and session.

    Parameters
    ----------
    process : Popen
        The notebook's process, in a session of its own.
    token : str
        The value of `MARKER` in its environment.

    Notes
    -----
    Where there is ``/proc``, a process is known by its parents or by its environment, and the
    search goes on until it finds nobody. Elsewhere only the process group is ended.
    """
    deadline = time.monotonic() + _SECONDS
    found = {process.pid} if _PROC.is_dir() and process.poll() is None else set()
    while found:
        # First they are stopped, so that none starts another while they are ended.
        _send(found, signal.SIGSTOP)
        more = found | _below(found)
        if more == found or time.monotonic() > deadline:
            break
        found = more
    if found:
        _send(found, signal.SIGKILL)
    if hasattr(os, "killpg"):
        with contextlib.suppress(OSError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()
    while (left := marked(token)) and time.monotonic() < deadline:
        _send(left, signal.SIGKILL)
        time.sleep(0.01)
    while any(map(alive, found)) and time.monotonic() < deadline:
        time.sleep(0.01)


def marked(token: str) -> set[int]:
    """Return the processes that began with a token in their environment, as far as can be seen.

    Examples
    --------
    >>> marked("a token that nobody has")
    set()
    """
    wanted = f"{MARKER}={token}".encode()
    found = set()
    for folder in _processes():
        with contextlib.suppress(OSError):
            begun_with = (folder / "environ").read_bytes().split(b"\0")
            if wanted in begun_with and alive(int(folder.name)):
                found.add(int(folder.name))
    return found


def _below(ancestors: set[int]) -> set[int]:
    """Return the processes that descend from some."""
    parents: dict[int, int] = {}
    for folder in _processes():
        with contextlib.suppress(OSError, ValueError, IndexError):
            parents[int(folder.name)] = int(_status(folder)[1])
    below, more = set(ancestors), set(ancestors)
    while more:
        more = {child for child, parent in parents.items() if parent in below} - below
        below |= more
    return below


def alive(number: int) -> bool:
    """Return whether a process is there and has not ended; where there is no ``/proc``, it may be.

    Examples
    --------
    >>> alive(os.getpid())
    True
    """
    if not _PROC.is_dir():
        return True
    try:
        return _status(_PROC / str(number))[0] not in ("Z", "X")
    except (OSError, IndexError):
        return False


def _processes() -> list[Path]:
    return [p for p in _PROC.iterdir() if p.name.isdigit()] if _PROC.is_dir() else []


def _status(folder: Path) -> list[str]:
    """Return state, parent and so on: what follows the name, which may hold anything."""
    text = (folder / "stat").read_text(errors="replace")
    return text.rpartition(")")[2].split()


def _send(processes: set[int], which: signal.Signals) -> None:
    for number in processes:
        with contextlib.suppress(OSError):
            os.kill(number, which)
