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


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are copied by fork")
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_check_of_a_chapter_notices_that_its_step_is_undone(notebook):
    done = subprocess.run(
        [sys.executable, HERE / "undoing.py", notebook], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    rows = tomllib.loads((HERE / f"undone/{short_name(notebook.name)}.toml").read_text())["row"]
    passed = [
        (row["step"], row["undone"], result)
        for row, result in zip(rows, said["results"], strict=True)
        if result != row.get("expected", "noticed")
    ]
    assert passed == []
    assert said["unasked"] == [], "these cells check something, and no row undoes a step of theirs"
