"""``cvnotes lab``: the course in JupyterLab, on this machine alone."""

import argparse
import importlib.util
import json
import os
import secrets
import signal
import socket
import subprocess
import sys
import time
import webbrowser
from collections.abc import Sequence
from contextlib import suppress
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from tempfile import TemporaryDirectory

from cvnotes.base import FileError
from cvnotes.base.material import material
from cvnotes.base.writing import printable
from cvnotes.commands.console import say
from cvnotes.commands.quiet import options
from cvnotes.commands.redirect import NAME, leading_to
from cvnotes.commands.signals import ENDING, heard
from cvnotes.commands.working_copy import FOLDER, default_folder, deliver, start_over

START = "00_start_here.ipynb"
_JUPYTER = Path(__file__).parent / "jupyter"  # what is ours in JupyterLab
_SECONDS_TO_OPEN = 60  # after which no browser still reads the page that leads to the course


def add_parser(subparsers: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command's arguments."""
    parser = subparsers.add_parser(
        "lab",
        help="open the course in JupyterLab",
        description="Open your working copy of the course in JupyterLab. New chapters come into "
        "it; what you changed is never overwritten. The server listens on this machine only "
        "(127.0.0.1); Ctrl-C ends it.",
        epilog="example: cvnotes lab --fresh 3",
    )
    add = parser.add_argument
    add("folder", nargs="?", type=Path, metavar="FOLDER",
        help=f"your working copy (default: this folder if it is one, else {FOLDER})")  # fmt: skip
    add("--fresh", metavar="CHAPTER", action="append", default=[],
        help="start one over, by its number or name; yours is kept beside it")  # fmt: skip
    add("--copy", action="store_true", help="bring the working copy up to date, and open nothing")
    add("--notebooks", type=Path, metavar="FOLDER",
        help="open the notebooks of this folder themselves, without a working copy")  # fmt: skip
    add("--port", type=_port, default=8888, help="port to try first (default 8888)")
    add("--no-browser", action="store_true", help="print the address only")


def run(args: argparse.Namespace) -> int:
    """Serve the notebooks until Ctrl-C; gives the exit code."""
    course = find_notebooks(args.notebooks)
    if args.copy:
        prepare(course, args.folder, args.fresh)
        return 0
    if importlib.util.find_spec("jupyterlab") is None:
        raise FileError('JupyterLab is not installed; install it with: pip install "cvnotes[lab]"')
    notebooks = course if args.notebooks else prepare(course, args.folder, args.fresh)
    if there := already_open(notebooks):
        say(f"This folder is open already, at\n\n    {there}\n")
        say("Ctrl-C ends it, in the terminal where it was started.")
        return 0
    token = secrets.token_hex(24)
    with TemporaryDirectory(prefix="cvnotes-tabs-") as tabs:  # those of last time do not come back
        for port in (args.port, 0, 0):
            code = _serve(notebooks, free_port(port), token, tabs, args.no_browser)
            if code is not None:
                return code
    raise FileError("JupyterLab found no port that stayed free; see its words above")


def _serve(notebooks: Path, port: int, token: str, tabs: str, no_browser: bool) -> int | None:
    """Serve until Ctrl-C, and end whatever was started.

    Returns
    -------
    int or None
        The exit code; None if another program took the port before JupyterLab could.
    """
    came: list[int] = []
    with heard(lambda number, _: came.append(number), *ENDING):
        server = start_server(notebooks, port, token, tabs)
    try:
        if came:
            raise KeyboardInterrupt
        try:
            wait_until_up(server, port, token)
        except FileError:
            if free_port(port) != port:
                return None
            raise
        address = _address(port, token)
        say(f"The course is open at\n\n    {address}\n")
        with leading_to(address, notebooks) as page:
            if not no_browser and not open_browser(page):
                say("No browser could be opened here: copy the address into one on this machine.")
            say("Ctrl-C ends it.")
            sys.stdout.flush()
            with suppress(subprocess.TimeoutExpired):
                return server.wait(timeout=_SECONDS_TO_OPEN)
        return server.wait()
    except KeyboardInterrupt:
        say("\nThe course is closed; what you saved is kept.")
        return 130
    finally:
        with heard(signal.SIG_IGN, *ENDING):  # a second Ctrl-C would leave the kernels running
            stop(server)


def _port(text: str) -> int:
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"expected a port from 0 to 65535, got {text!r}")
    return int(text)


def find_notebooks(given: Path | None) -> Path:
    """Find the folder of the notebooks: as given, else the course's own."""
    place = material("notebooks") if given is None else given
    if (place / START).is_file():
        return place.resolve()
    raise FileError(
        f"{START} is not in {printable(place)}; "
        "say where the course's notebooks are with --notebooks FOLDER"
    )


def prepare(course: Path, given: Path | None, fresh: Sequence[str]) -> Path:
    """Bring the working copy up to date and say what is new; gives its folder."""
    folder = (default_folder() if given is None else given).absolute()
    for sentence in deliver(course, folder).sentences():
        say(sentence)
    for chapter in fresh:
        name, kept = start_over(course, folder, chapter)
        say(f"{name} starts over; yours is kept as {kept}")
    say(f"Your working copy of the course: {printable(folder)}")
    return folder


def free_port(first: int) -> int:
    """Return the first port if nobody listens there, else one that is free."""
    for port in (first, 0):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            return int(probe.getsockname()[1])
    raise FileError("no port is free on 127.0.0.1")


def start_server(
    notebooks: Path, port: int, token: str, tabs: str = ""
) -> "subprocess.Popen[bytes]":
    """Start JupyterLab on loopback, quiet and without asking anybody outside.

    It keeps what is open, and where, in the folder `tabs`, if one is given.
    """
    from jupyter_core.paths import jupyter_runtime_dir

    command = [sys.executable, "-m", "cvnotes.commands.jupyterlab", "--no-browser"]
    command += options(jupyter_runtime_dir())
    command += ["--ServerApp.ip=127.0.0.1", f"--ServerApp.port={port}"]
    command += ["--ServerApp.port_retries=0", f"--ServerApp.root_dir={notebooks}"]
    for hidden in ("__pycache__", "*~", ".DS_Store", NAME):  # from the list of chapters
        command.append(f"--ContentsManager.hide_globs={hidden}")
    command += ["--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate"]
    command += ["--LabApp.extension_manager=readonly"]
    command += [f"--LabApp.extra_labextensions_path={_JUPYTER / 'labextensions'}"]
    for family in ("sans", "serif"):  # the type of the pages, which course.js asks for
        if found := importlib.util.find_spec(f"font_source_{family}_pro"):
            files = Path(found.origin or "").parent / "files"
            command.append(f"--ServerApp.extra_static_paths={files}")
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        command.append("--allow-root")
    # The token goes by the environment, which other users cannot read; the kernel is this Python.
    environment = os.environ | {"JUPYTER_TOKEN": token, "JUPYTER_PREFER_ENV_PATH": "1"}
    if tabs:
        environment["JUPYTERLAB_WORKSPACES_DIR"] = tabs
    # Our settings, beside those of the user: no question about Jupyter news on the first page.
    settings = [str(_JUPYTER), os.environ.get("JUPYTER_CONFIG_PATH", "")]
    environment["JUPYTER_CONFIG_PATH"] = os.pathsep.join(filter(None, settings))
    # In a session of its own, so that Ctrl-C reaches us and not its question whether to stop.
    return subprocess.Popen(command, env=environment, start_new_session=True)


def wait_until_up(
    server: "subprocess.Popen[bytes]", port: int, token: str, seconds: float = 60
) -> None:
    """Wait until the server answers to its token; raises FileError if it ends or never does."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if server.poll() is not None:
            raise FileError(f"JupyterLab ended with code {server.returncode}; see its words above")
        if _answers(port, token):
            return
        time.sleep(0.1)
    raise FileError(f"JupyterLab did not answer within {seconds:.0f} s")


def already_open(notebooks: Path) -> str | None:
    """Return the address at which a JupyterLab of this user serves a folder, if one does."""
    from jupyter_core.paths import jupyter_runtime_dir

    for path in sorted(Path(jupyter_runtime_dir()).glob("jpserver-*.json")):
        with suppress(OSError, ValueError, KeyError, TypeError):  # written just now, or gone
            told = json.loads(path.read_text(encoding="utf-8"))
            same = Path(told["root_dir"]).resolve() == notebooks.resolve()
            if same and _answers(told["port"], told["token"]):
                return _address(told["port"], told["token"])
    return None


def _address(port: int, token: str) -> str:
    return f"http://127.0.0.1:{port}/lab/tree/{START}?token={token}"


def _answers(port: int, token: str) -> bool:
    """Tell whether a server listens that takes the token for its own."""
    connection = HTTPConnection("127.0.0.1", port, timeout=5)
    try:
        connection.request("GET", "/api/status", headers={"Authorization": f"token {token}"})
        return connection.getresponse().status == 200
    except (HTTPException, OSError):
        return False
    finally:
        connection.close()


def open_browser(address: str) -> bool:
    """Open the address in a window, if this machine has any."""
    windows = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER", "WSL_DISTRO_NAME")
    if sys.platform.startswith("linux") and not any(map(os.environ.get, windows)):
        return False  # a text browser would take over this terminal
    try:
        return webbrowser.open(address)
    except webbrowser.Error:
        return False


def stop(server: "subprocess.Popen[bytes]") -> None:
    """End the server and its kernels, kindly at first."""
    if server.poll() is None:
        server.terminate()
        try:
            server.wait(timeout=10)
        except subprocess.TimeoutExpired:
            server.kill()
            server.wait()
