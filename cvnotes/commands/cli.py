"""The ``cvnotes`` command.

Exit codes: 0 done, 1 cannot, 2 wrong usage, 3 written, not reliable or not all, 130
interrupted. Reasons go to stderr, one line each; nobody is shown a traceback.
"""

import argparse
import os
import signal
import sys
import traceback
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

from cvnotes import __version__
from cvnotes.commands.console import EXIT_CODES, complain, open_streams, unprinted
from cvnotes.commands.signals import heard

_EXAMPLES = """\
examples:
  cvnotes lab
  cvnotes target --corners 9x6 --square 25 --out board.pdf
  cvnotes calibrate photos/ --corners 9x6 --square 25 --out result/
  cvnotes undistort photos/ --camera result/calibration.json --out straight/
  cvnotes stereo left/ right/ --corners 9x6 --square 25 --out rig/

"""


class _Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line."""

    def error(self, message: str) -> NoReturn:
        complain(self.prog.removeprefix("cvnotes").strip(), f"{message} (see {self.prog} --help)")
        sys.exit(2)


_SMALL_MATRICES = ("calibrate", "stereo", "undistort")
_COMMANDS = ("lab", "target", "calibrate", "undistort", "stereo", "grade", "completion")


def parser(command: str = "") -> argparse.ArgumentParser:
    """Describe the command and its sub-commands; only one of them, if it is known which."""
    alone = command in _COMMANDS and command != "completion"  # which is about all of them
    names = (command,) if alone else _COMMANDS

    top = _Parser(
        prog="cvnotes",
        description="A course on camera calibration, and its tools for your own photographs.",
        epilog=_EXAMPLES + EXIT_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    version: dict[str, Any] = {"action": "version", "version": f"cvnotes {__version__}"}
    top.add_argument("-V", "--version", **version)
    commands = top.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name in names:
        module = import_module(f"cvnotes.commands.{name}")
        module.add_parser(commands)
        commands.choices[name].set_defaults(run=module.run, commands=commands)
    for each in commands.choices.values():  # its help would repeat what the first one says
        each.add_argument("-V", "--version", help=argparse.SUPPRESS, **version)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; gives its exit code."""
    command = ""
    open_streams()
    try:
        # SIGTERM, or closing the terminal, ends the command as Ctrl-C does: cleaned up.
        with heard(signal.default_int_handler, "SIGTERM", "SIGHUP"):
            given = sys.argv[1:] if arguments is None else list(arguments)
            if given[:1] and given[0] in _SMALL_MATRICES:
                _one_thread_for_matrices()
            args = parser(*given[:1]).parse_args(given)
            command = args.command
            code: int = args.run(args)
            sys.stdout.flush()  # a full disk behind stdout shows itself here
            if failed := unprinted():
                complain(command, f"not all could be printed: {failed.strerror or failed}")
                return code or 1
            return code
    except KeyboardInterrupt:
        if arguments is None:
            _leave(130)
        return 130
    except Exception as error:
        return _cannot(command, error)


def _leave(code: int) -> NoReturn:
    """End this process at once; all that was open has been closed, and nothing half is left.

    A thread of OpenCV's that is still at work when Python takes itself apart aborts the process.
    """
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)


def _one_thread_for_matrices() -> None:
    """Keep NumPy's linear algebra from sharing out matrices that are small.

    Its threads would mostly wait for each other, at three times the processor's time.
    """
    if "numpy" not in sys.modules:  # it looks once, when it is imported
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def _cannot(command: str, error: Exception) -> int:
    """Say in one line why the command could not; gives the exit code."""
    if isinstance(error, ModuleNotFoundError) and not _is_ours(error.name):
        print(
            f"cvnotes: this Python ({sys.executable}) has no {error.name}, which the course needs; "
            "in a clone call python3 start.py, elsewhere install the course with "
            'pip install "cvnotes[lab]"',
            file=sys.stderr,
        )
        return 1
    from cvnotes.base import CvnotesError
    from cvnotes.commands.console import stop_printing

    if isinstance(error, OSError):
        stop_printing()  # perhaps it was stdout that failed; it would fail again at the end
    if isinstance(error, CvnotesError | OSError):
        complain(command, str(error))
    elif isinstance(error, MemoryError):
        complain(command, "there is not enough memory for this")
    else:
        place = traceback.extract_tb(error.__traceback__)[-1]
        where = f"{Path(place.filename).name}, line {place.lineno}"
        complain(command, f"a mistake of ours, please report it: {error!r} in {where}")
    return 1


def _is_ours(module: str | None) -> bool:
    return module is None or module.partition(".")[0] == "cvnotes"
