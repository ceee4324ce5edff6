"""The checks for every change: lint, format, types, unit tests and doctests, side by side.

    python3 start.py check                  in less than a minute on two cores
    python3 start.py check -k lens          whatever follows goes to pytest

Notebooks, browser, site, the grader and long experiments are left to ``python3 start.py test``.
"""

import os
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TOOLS = {
    "types": ["mypy"],
    "lint": ["ruff", "check"],
    "format": ["ruff", "format", "--check"],
}
TESTS = ["pytest", "-m", "not slow and not sampling", "-q", "tests", "cvnotes"]


def without_notebooks() -> list[str]:
    """Return the options by which pytest, and what it starts, loads nothing that runs notebooks."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    options = settings["tool"]["pytest"]["ini_options"]["addopts"]
    kept = " ".join(option for option in options if not option.startswith("--nbval"))
    return ["-p", "xdist", "-p", "hypothesispytest", "-o", f"addopts={kept}"]


def main(arguments: list[str]) -> int:
    started = time.monotonic()
    failed = []
    with tempfile.TemporaryDirectory() as folder:
        running = {}
        for name, tool in TOOLS.items():
            said = Path(folder) / name
            with said.open("wb") as stream:
                command = [sys.executable, "-m", *tool]
                running[name] = subprocess.Popen(command, cwd=ROOT, stdout=stream, stderr=stream)
        try:
            command = [sys.executable, "-m", *TESTS, *without_notebooks(), *arguments]
            asked_for = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
            tests = subprocess.run(command, cwd=ROOT, env=asked_for).returncode
            for name, process in running.items():
                if process.wait() != 0:
                    failed.append(name)
                    print(f"\n== {name} ==\n{(Path(folder) / name).read_text()}")
        finally:
            for process in running.values():
                process.kill()
                process.wait()
    if tests != 0:
        failed.append("tests")
    seconds = time.monotonic() - started
    print(f"\n{'Not right: ' + ', '.join(failed) if failed else 'All right'}, in {seconds:.0f} s")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
