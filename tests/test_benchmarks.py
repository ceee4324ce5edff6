"""The benchmarks as a command: what it is asked is read before anything is measured."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.once

ROOT = Path(__file__).resolve().parents[1]


def benchmarks(*arguments):
    run = [sys.executable, "-X", "importtime", "-m", "benchmarks", *arguments]
    return subprocess.run(run, cwd=ROOT, capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize(("arguments", "code"), [(["--help"], 0), (["corner"], 2), (["--x"], 2)])
def test_help_and_mistakes_are_answered_before_a_benchmark_is_loaded(arguments, code):
    done = benchmarks(*arguments)
    assert done.returncode == code
    assert "usage: python -m benchmarks" in done.stdout + done.stderr
    assert "numpy" not in done.stderr  # the list of what was imported
    if arguments == ["corner"]:
        assert "there is no benchmark 'corner'; there are calibration, " in done.stderr


def test_every_name_that_is_told_is_a_benchmark():
    said = re.sub(r"\s+", " ", benchmarks("--help").stdout)
    names = re.search(r"NAME (\w+(?:, \w+)+) \(all\)", said)[1].split(", ")
    runs = {
        path.stem
        for path in (ROOT / "benchmarks").glob("*.py")
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef) and node.name == "main"
    }
    assert set(names) == runs - {"__main__"}
