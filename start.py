"""Open the course, or check it, on a machine that has only Python 3.11 or newer.

    python3 start.py                open the course in JupyterLab (options go to `cvnotes lab`)
    python3 start.py check          lint, types and unit tests: for every change, in a minute
    python3 start.py test           run every test, the notebooks included
    python3 start.py slides         make slides of the notebooks; --serve: explorations move
    python3 start.py site           build the course as pages; --without-python: to be read only

On Windows write `py` for `python3`. The first call makes a virtual environment in .venv and
installs the course into it, by uv where that is installed and else by pip: about 190 MB to download
and 770 MB on disk to read the course, 250 MB and 1.2 GB to test it; later calls start at once.
Whatever follows the command goes to it, as in `start.py test tests/test_lens.py`. CVNOTES_VENV
names another folder for the environment.
"""

from __future__ import annotations  # an older Python reads on, to say that it is too old

import hashlib
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent
WINDOWS = os.name == "nt"
EXTRAS = {"lab": "lab", "check": "dev", "test": "dev", "site": "docs", "slides": "docs"}
RUN = {
    "lab": ["-m", "cvnotes", "lab"],
    "check": ["tools/check.py"],
    "test": ["-m", "pytest"],
    "site": ["tools/build_site.py"],
    "slides": ["tools/build_slides.py"],
}
UV = shutil.which("uv")  # which installs in a fifth of pip's time
UNREACHABLE = re.compile(
    "Name or service not known|name resolution|nodename nor servname|getaddrinfo failed"
    "|Failed to establish a new connection|ConnectTimeout|Connection refused|ProxyError"
    "|Network is unreachable|Connection to .* timed out|Max retries exceeded"
)
# What an environment says of itself; -I keeps it from looking here or where PYTHONPATH points.
PROBE = """
import importlib.util, json, sys
found = importlib.util.find_spec("cvnotes")
print(json.dumps({
    "version": list(sys.version_info[:2]),
    "own": sys.prefix != sys.base_prefix,
    "pip": importlib.util.find_spec("pip") is not None,
    "ensurepip": importlib.util.find_spec("ensurepip") is not None,
    "cvnotes": found.origin if found else None,
    "missing": [name for name in sys.argv[1:] if importlib.util.find_spec(name) is None],
}))
"""
MADE_HERE = "made-by-start.py"  # in an environment that may be deleted when it is broken
# What is not there any more if files of an environment were lost; pip would believe its lists.
NEEDED = (
    "numpy", "scipy", "matplotlib", "cv2", "trimesh", "ipywidgets", "font_source_sans_pro", "PIL",
    "yaml", "tqdm",
)  # fmt: skip


class CannotError(Exception):
    """What keeps the course from starting, in a sentence."""


def main(arguments: list[str]) -> int:
    """Install if needed, then become the command."""
    if sys.version_info < (3, 11):
        print(
            f"The course needs Python 3.11 or newer; this is {sys.version.split()[0]}.",
            file=sys.stderr,
        )
        return 1
    if arguments[:1] in (["-h"], ["--help"]):
        print(__doc__)
        return 0
    command, *rest = arguments if arguments and arguments[0][:1] != "-" else ["lab", *arguments]
    if command not in RUN:
        print(
            f"start.py knows no command {command!r}; there are {', '.join(RUN)}: "
            "see start.py --help",
            file=sys.stderr,
        )
        return 2
    try:
        python = environment(EXTRAS[command])
    except CannotError as error:
        print(f"start.py: {error}", file=sys.stderr)
        return 1
    return become([str(python), *RUN[command], *rest])


def become(command: list[str]) -> int:
    """Go on as another program, which then gets Ctrl-C and every other signal itself."""
    os.chdir(ROOT)
    sys.stdout.flush()
    sys.stderr.flush()
    if not WINDOWS:
        os.execv(command[0], command)
    child = subprocess.Popen(command)
    while True:
        try:
            return child.wait()
        except KeyboardInterrupt:
            pass  # the child got it too, and ends what it has begun


# --- The environment -----------------------------------------------------------------------------


def environment(extra: str) -> Path:
    """Give the Python of an environment that has this clone of the course installed."""
    given = Path(os.environ.get("CVNOTES_VENV") or ROOT / ".venv").expanduser()
    folder = Path.cwd() / given  # not resolved: the environment's own scripts name it as it is
    python = folder / ("Scripts/python.exe" if WINDOWS else "bin/python")
    wanted = recipe(folder)
    found = probe(python)
    complete = found is not None and is_ours(found) and installed(folder, extra) == wanted
    lost: list[str] = found["missing"] if complete and found else []  # type: ignore[assignment]
    if complete and not lost:
        return python
    ran_before = found is not None and is_ours(found) and installed(folder, extra) is not None
    ran_before = ran_before and not lost
    try:
        usable = reusable(folder, found, lost)
        if not UV and (usable is None or not (usable["pip"] or usable["ensurepip"])):
            check_whole()  # before anything is promised or written
        size = "what has changed since" if ran_before else f"about {SIZE[extra]}, once"
        print(f"Installing the course into {folder}: {size}.", flush=True)
        found = usable or create(folder, python)
        try:
            install(python, found, ["--editable", f"{ROOT}[{extra}]"])
        except CannotError as error:
            if not ran_before:
                raise
            print(f"  {error}\n  The course goes on with the packages that it had.", flush=True)
            return python
        (folder / f"installed-{extra}").write_text(wanted, encoding="utf-8")
    except OSError as error:
        raise CannotError(
            f"{folder} cannot be written ({error.strerror or error}); "
            "set CVNOTES_VENV to a folder where you may write"
        ) from None
    return python


SIZE = {
    "lab": "190 MB to download, 770 MB on disk",
    "docs": "210 MB to download, 850 MB on disk",
    "dev": "250 MB to download, 1.2 GB on disk",
}


def recipe(folder: Path) -> str:
    """Give a name for all that an installation depends on; another one is made anew."""
    constraint = os.environ.get("PIP_CONSTRAINT", "")
    parts = [(ROOT / "pyproject.toml").read_bytes(), str(ROOT).encode(), str(folder).encode()]
    parts.append(constraint.encode())
    if constraint and Path(constraint).is_file():
        parts.append(Path(constraint).read_bytes())
    return hashlib.sha256(b"\0".join(parts)).hexdigest()


def installed(folder: Path, extra: str) -> str | None:
    """Give the recipe after which an extra was installed, or None; `dev` contains the others."""
    for name in (extra, "dev"):
        stamp = folder / f"installed-{name}"
        try:
            return stamp.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError):
            continue
    return None


def probe(python: Path) -> dict[str, object] | None:
    """Ask an environment's Python about it; None if there is none that answers."""
    try:
        said = subprocess.run(
            [str(python), "-I", "-c", PROBE, *NEEDED], capture_output=True, text=True, timeout=60
        )
        found: dict[str, object] = json.loads(said.stdout)
    except (OSError, ValueError, subprocess.TimeoutExpired):
        return None
    return found if found["own"] else None


def is_ours(found: dict[str, object]) -> bool:
    """Tell if an environment's course is this clone, not one that was copied or has moved."""
    origin = found["cvnotes"]
    return isinstance(origin, str) and Path(origin).resolve() == ROOT / "cvnotes" / "__init__.py"


def reusable(
    folder: Path, found: dict[str, object] | None, lost: list[str]
) -> dict[str, object] | None:
    """Give what an environment says of itself if it can be kept, or None if it is made anew."""
    made_here = any(folder.glob("installed-*")) if folder.is_dir() else False
    if folder.exists() and not folder.is_dir():
        raise CannotError(f"{folder} is no folder; set CVNOTES_VENV to one for the environment")
    foreign = folder.is_dir() and any(folder.iterdir()) and not made_here
    if foreign and not (folder / "pyvenv.cfg").is_file():
        raise CannotError(
            f"{folder} holds something else than an environment; "
            "set CVNOTES_VENV to a new folder, or to an empty one"
        )
    if foreign and found is not None and tuple(found["version"]) < (3, 11):  # type: ignore[arg-type]
        raise CannotError(
            f"the environment in {folder} has a Python older than 3.11; delete that folder, "
            "or set CVNOTES_VENV to another"
        )
    kept = foreign or (found is not None and is_ours(found) and scripts_start(folder))
    if found is not None and kept and not lost:
        return found
    mine = folder == ROOT / ".venv" or (folder / MADE_HERE).is_file()
    if not mine and folder.is_dir() and any(folder.iterdir()):  # it may hold more than the course
        reason = "was made for another clone" if found else "does not start"
        reason = f"has lost {lost[0]}" if lost else reason
        raise CannotError(
            f"the environment in {folder} {reason}; "
            "delete that folder, or set CVNOTES_VENV to another"
        )
    return None


def create(folder: Path, python: Path) -> dict[str, object]:
    """Make the environment; gives what it says of itself."""
    import venv

    pip_too = "" if UV else "; to put pip into it takes some ten seconds …"
    print(f"  a new environment with Python {sys.version.split()[0]}{pip_too}", flush=True)
    try:
        venv.create(folder, with_pip=not UV, clear=folder.is_dir())
    except subprocess.CalledProcessError as error:
        words = (error.output or b"").decode(errors="replace").strip().splitlines()
        raise CannotError(
            f"no environment could be made in {folder}: {words[-1] if words else error}"
        ) from None
    (folder / MADE_HERE).touch()
    found = probe(python)
    if found is None:
        raise CannotError(f"the new Python in {folder} does not start; delete that folder")
    return found


def check_whole() -> None:
    """Refuse a Python that lacks what makes environments."""
    if importlib.util.find_spec("ensurepip") is None or importlib.util.find_spec("venv") is None:
        minor = f"{sys.version_info[0]}.{sys.version_info[1]}"
        raise CannotError(
            "this Python comes without venv and ensurepip, which Debian and Ubuntu keep apart; "
            f"install them with: sudo apt install python3-venv   (or python{minor}-venv)"
        )


def scripts_start(folder: Path) -> bool:
    """Tell if the commands of an environment name this Python: they do not once it has moved."""
    config = folder / ("Scripts/activate" if WINDOWS else "bin/activate")
    try:
        return str(folder) in config.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False


def install(python: Path, found: dict[str, object], what: list[str]) -> None:
    """Install with uv where there is one, in a fifth of the time; else, or if it fails, by pip."""
    print("  asking which packages that takes …", flush=True)
    if UV:
        own = {"PIP_CONSTRAINT": "UV_CONSTRAINT", "PIP_INDEX_URL": "UV_DEFAULT_INDEX"}
        given = {uvs: os.environ[pips] for pips, uvs in own.items() if pips in os.environ}
        command = [UV, "pip", "install", "--python", str(python), *what]
        code, said = run_and_tell(command, given | dict(os.environ))
        if code == 0:
            return
        reason = next((line for line in reversed(said) if line), f"it ends with code {code}")
        print(f"  (uv could not: {reason}; pip is asked)", flush=True)
    pip(python, found, what)


def pip(python: Path, found: dict[str, object], what: list[str]) -> None:
    """Install with pip, naming what is loaded; raises CannotError with the reason if it fails."""
    if not found["pip"]:  # uv makes environments without
        subprocess.run([str(python), "-m", "ensurepip"], capture_output=True)
        if not (probe(python) or {}).get("pip"):
            check_whole()  # what `python3 -m venv` leaves without them
            raise CannotError(
                f"the environment in {python.parents[1]} has no pip and cannot get one; "
                "delete that folder"
            )
        found["pip"] = True
    command = [str(python), "-m", "pip", "install", "--progress-bar", "off"]
    command += ["--disable-pip-version-check", *what]
    # pip asks an index that does not answer for minutes, once for each package.
    patience = {"PIP_RETRIES": "1"}
    if "PIP_DEFAULT_TIMEOUT" not in os.environ:
        patience["PIP_TIMEOUT"] = "15"
    environment = patience | dict(os.environ) | {"PYTHONUNBUFFERED": "1"}
    code, said = run_and_tell(command, environment)
    if code == 0:
        return
    whole = "\n".join(said)
    if UNREACHABLE.search(whole):
        raise CannotError("the packages cannot be reached: is this machine connected to a network?")
    if re.search(r"No space left|Errno 28", whole):
        raise CannotError(f"the disk is full; the course takes {SIZE['lab'].split(', ')[1]}")
    reasons = [line for line in said if line.startswith("ERROR")] or said[-3:]
    raise CannotError("pip could not install the course:\n  " + "\n  ".join(reasons))


def run_and_tell(command: list[str], environment: dict[str, str]) -> tuple[int, list[str]]:
    """Run what installs, and print how far it is; gives its exit code and all that it printed."""
    said = []
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env=environment,
    ) as running:
        for line in running.stdout or ():
            said.append(line.strip())
            told = progress(line.strip())
            if told:
                print(f"  {told}", flush=True)
    return running.returncode, said


def progress(line: str) -> str | None:
    """Give what is worth telling of a line that pip or uv prints."""
    loaded = re.match(r"Downloading (?:\S*/)?([\w.]+)-([\w.]+?)-\S+ \(([\d.]+ [MG]B)\)", line)
    if loaded:
        return f"{loaded[1]} {loaded[2]}, {loaded[3]}"
    loaded = re.match(r"Downloading (\S+) \(([\d.]+)([MG])iB\)", line)
    if loaded:
        return f"{loaded[1]}, {loaded[2]} {loaded[3]}B"
    if line.startswith("Installing collected packages"):
        return f"putting {line.count(',') + 1} packages in place …"
    return None


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit(130)
