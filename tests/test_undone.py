"""A check that passes when its step is left out is no check: each is run with its step undone.

And an answer that nobody has tried is none: each change that a page asks for is made, too. The
tables are `tests/undone/NN.toml`; `tests/undoing.py` says what a row is, and runs them.
"""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import nbformat
import pytest

from cvnotes.tutor.course import short_name

HERE = Path(__file__).parent
each_notebook = pytest.mark.parametrize(
    "notebook", sorted((HERE.parent / "notebooks").glob("*.ipynb")), ids=lambda path: path.stem
)


def _rows(notebook):
    return tomllib.loads((HERE / f"undone/{short_name(notebook.name)}.toml").read_text())["row"]


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are copied by fork")
@each_notebook
def test_every_check_notices_its_step_undone_and_every_answer_holds(notebook):
    done = subprocess.run(
        [sys.executable, HERE / "undoing.py", notebook], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    failed = [
        (row, result)
        for row, result in zip(_rows(notebook), said["results"], strict=True)
        if result != ("held" if "holds" in row else "noticed")
    ]
    assert failed == []
    assert said["unasked"] == [], "these cells check something, and no row undoes a step of theirs"


def _plain(text):
    return " ".join(text.split())


@each_notebook
def test_every_change_that_a_page_asks_for_has_an_answer_that_is_run(notebook):
    cells = nbformat.read(notebook, as_version=4).cells
    prose = _plain("\n".join(cell.source for cell in cells if cell.cell_type == "markdown"))
    promised = [_plain(row["said"]) for row in _rows(notebook) if "holds" in row]
    assert [words for words in promised if prose.count(words) != 1] == [], "once in the prose"
    answers = re.findall(r"\*\*Change this and run again.*?<details>(.*?)</details>", prose)
    assert [text for text in answers if not any(words in text for words in promised)] == []
