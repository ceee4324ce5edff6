"""A check that passes when its step is left out is no check: each is run with its step undone.

The tables are `tests/undone/NN.toml`; `tests/undoing.py` says what a row is, and runs them.
"""

import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from cvnotes.tutor.course import short_name

pytestmark = [pytest.mark.slow, pytest.mark.once]

HERE = Path(__file__).parent
NOTEBOOKS = sorted((HERE.parent / "notebooks").glob("*.ipynb"))
TABLES = sorted((HERE / "undone").glob("*.toml"))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are copied by fork")
@pytest.mark.parametrize("table", TABLES, ids=lambda path: path.stem)
def test_every_check_of_a_chapter_notices_that_its_step_is_undone(table):
    notebook = next(path for path in NOTEBOOKS if short_name(path.name) == table.stem)
    done = subprocess.run(
        [sys.executable, HERE / "undoing.py", notebook], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    rows = tomllib.loads(table.read_text())["row"]
    passed = [
        (row["step"], row["undone"], result)
        for row, result in zip(rows, said["results"], strict=True)
        if result != "noticed"
    ]
    assert passed == []
    assert said["unasked"] == [], "these cells check something, and no row undoes a step of theirs"
