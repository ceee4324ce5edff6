"""A notebook's process sealed off, where Linux lets an ordinary user do so.

In namespaces of its own a process has no network, sees no other process, may write into its
scratch folder only, and does not find the class's notebooks; and when its first process ends,
the kernel ends all the others with it. Nothing has to be installed for that, but many containers
and some distributions forbid it; then the notebook runs as it is, and the grader says so.
"""

import ctypes
import os
import struct
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

_NEW = 0x00020000 | 0x08000000 | 0x10000000 | 0x20000000 | 0x40000000  # mounts IPC user PID net
_READ_ONLY, _NOSUID, _BIND, _RECURSIVE, _PRIVATE = 1, 2, 1 << 12, 1 << 14, 1 << 18
_MOUNT_SETATTR, _HERE, _ALL_BELOW = 442, -100, 0x8000
_DEATH_SIGNAL, _NO_NEW_PRIVILEGES, _SUBREAPER = 1, 38, 36
_CAPABILITIES = 0x20080522
_SIGKILL = 9


def end_with_parent() -> None:
    """Ask the kernel to end this process when the one that started it is gone."""
    if sys.platform == "linux":
        _libc().prctl(_DEATH_SIGNAL, _SIGKILL, 0, 0, 0)


def adopt_orphans() -> None:
    """Stay the parent of whatever is started below, also when it leaves its own parent."""
    if sys.platform == "linux":
        _libc().prctl(_SUBREAPER, 1, 0, 0, 0)


def sealed(scratch: Path, hidden: Sequence[Path]) -> bool:
    """Go on in a process that is sealed off; tells whether the system let it.

    Parameters
    ----------
    scratch : Path
        The only folder that may be written to.
    hidden : sequence of Path
        Folders and files that are not to be found.

    Returns
    -------
    bool
        True in the sealed process, which has a process of its own waiting above it; False where
        this is not to be had, in the process as it was.
    """
    if sys.platform != "linux":
        return False
    reading, writing = os.pipe()
    if child := os.fork():  # what fails halfway fails over there
        os.close(writing)
        entered = os.read(reading, 1)
        os.close(reading)
        if entered:
            _wait(child)
        os.waitpid(child, 0)
        return False
    try:
        end_with_parent()
        _enter()
        _arrange(scratch.resolve(), hidden)
        os.chdir(Path.cwd())  # the same folder, by way of the new mounts
        os.write(writing, b"1")
    except OSError:
        os._exit(1)
    os.close(writing)
    os.close(reading)
    _descend()
    return True


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def _did(result: int) -> None:
    if result != 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))


def _enter() -> None:
    """Enter new namespaces, as the same user."""
    user, group = os.getuid(), os.getgid()
    _did(_libc().unshare(_NEW))
    Path("/proc/self/setgroups").write_text("deny")
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1")


def _arrange(scratch: Path, hidden: Sequence[Path]) -> None:
    """Hide what is not a notebook's business, and make all but its scratch folder read-only."""
    _mount("none", "/", "", _RECURSIVE | _PRIVATE)
    _mount(str(scratch), str(scratch), "", _BIND)
    if Path("/dev/shm").is_dir():
        _mount("tmpfs", "/dev/shm", "tmpfs", _NOSUID)
    needed = [scratch, Path(sys.prefix), Path(sys.base_prefix), Path(__file__).parents[3]]
    for path in (p.resolve() for p in hidden):
        if not path.exists() or path in Path("/").parents:
            continue
        if path.is_file():
            _mount("/dev/null", str(path), "", _BIND)
        elif path.is_dir() and not any(p.resolve().is_relative_to(path) for p in needed):
            _mount("tmpfs", str(path), "tmpfs", _READ_ONLY | _NOSUID)
    _read_only("/", _ALL_BELOW, to_set=_READ_ONLY, to_clear=0)
    for path in (scratch, Path("/dev/shm")):
        if path.is_dir():
            _read_only(str(path), 0, to_set=0, to_clear=_READ_ONLY)


def _mount(source: str, target: str, kind: str, flags: int) -> None:
    names = (os.fsencode(source), os.fsencode(target), kind.encode() or None)
    _did(_libc().mount(*names, ctypes.c_ulong(flags), None))


def _read_only(target: str, below: int, *, to_set: int, to_clear: int) -> None:
    attributes = struct.pack("QQQQ", to_set, to_clear, 0, 0)
    call = _libc().syscall
    path, n = os.fsencode(target), ctypes.c_size_t(len(attributes))
    _did(call(_MOUNT_SETATTR, _HERE, path, below, attributes, n))


def _descend() -> None:
    """Go on in the second process of the new PID namespace; those above only wait for it."""
    end_with_parent()  # entering the namespaces had undone it
    if child := os.fork():
        _wait(child)  # outside of the namespace: the process that the grader knows
    end_with_parent()
    if child := os.fork():
        _wait(child)  # process 1, with which all the others end
    end_with_parent()
    header = struct.pack("Ii", _CAPABILITIES, 0)
    _did(_libc().capset(header, bytes(24)))
    _did(_libc().prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0))


def _wait(child: int) -> NoReturn:
    """Wait for one child, and end as it did; hold nothing open meanwhile."""
    os.closerange(0, 64)
    while True:
        ended, status = os.wait()
        if ended == child:
            code = os.waitstatus_to_exitcode(status)
            os._exit(code if code >= 0 else 128 - code)
