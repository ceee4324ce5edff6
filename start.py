"""Open the course, or run every test, on a machine that has only Python.

    python start.py                 open the course in JupyterLab
    python start.py check           lint, types and unit tests: for every change, in a minute
    python start.py test            run every test, the notebooks included
    python start.py site            build the course as pages to be read in a browser

The first call makes a virtual environment in .venv and installs the course into it (about a
minute, 180 MB to download); later calls start at once. Whatever follows goes to `cvnotes lab` or
to pytest. The environment variable CVNOTES_VENV names another folder for the environment.
"""

import hashlib
import os
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent
EXTRAS = {"lab": "lab,rays", "check": "dev", "test": "dev", "site": "docs"}
RUN = {
    "lab": ["-m", "cvnotes", "lab"],
    "check": ["tools/check.py"],
    "test": ["-m", "pytest"],
    "site": ["tools/build_site.py"],
}


def environment(extras: str) -> Path:
    """Give the folder of executables of an environment that has the course installed."""
    folder = Path(os.environ.get("CVNOTES_VENV", ROOT / ".venv"))
    scripts = folder / ("Scripts" if os.name == "nt" else "bin")
    recipe = (ROOT / "pyproject.toml").read_bytes() + os.environ.get("PIP_CONSTRAINT", "").encode()
    stamp, wanted = folder / f"installed-{extras}", hashlib.sha256(recipe).hexdigest()
    if stamp.exists() and stamp.read_text() == wanted:
        return scripts
    print(f"Installing the course into {folder} …", flush=True)
    if not (scripts / "pip").exists() and not (scripts / "pip.exe").exists():
        venv.create(folder, with_pip=True)
    python = str(scripts / "python")
    install = ["-m", "pip", "install", "--quiet", "--editable", f"{ROOT}[{extras}]"]
    subprocess.run([python, *install], check=True)
    stamp.write_text(wanted)
    return scripts


def main(arguments: list[str]) -> int:
    """Install if needed, then run the command."""
    if sys.version_info < (3, 11):
        print(f"The course needs Python 3.11 or newer; this is {sys.version.split()[0]}.")
        return 1
    command, *rest = arguments or ["lab"]
    if command not in EXTRAS:
        print(__doc__)
        return 0 if command in ("-h", "--help") else 2
    try:
        scripts = environment(EXTRAS[command])
    except subprocess.CalledProcessError:
        print("pip could not install the course; its message above says why.", file=sys.stderr)
        return 1
    return subprocess.run([str(scripts / "python"), *RUN[command], *rest], cwd=ROOT).returncode


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit(130)
