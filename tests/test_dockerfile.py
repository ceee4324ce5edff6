"""The image that `docs/teaching.md` builds: what can be seen of it without an engine."""

import json
import re
import tomllib
from pathlib import Path

import pytest

pytestmark = pytest.mark.once

ROOT = Path(__file__).resolve().parents[1]


def instructions():
    """Give the Dockerfile's instructions: (name, rest)."""
    text = re.sub(r"\\\n", " ", (ROOT / "Dockerfile").read_text())
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return [tuple(line.split(maxsplit=1)) for line in lines]


def test_it_is_made_of_known_instructions_and_begins_with_a_python_we_support():
    names = [name for name, _ in instructions()]
    assert names[0] == "FROM"
    assert set(names) <= {"FROM", "WORKDIR", "COPY", "RUN", "ENV", "ENTRYPOINT"}
    version = re.fullmatch(r"python:(\d+\.\d+)-slim", instructions()[0][1])[1]
    wanted = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["requires-python"]
    assert tuple(map(int, version.split("."))) >= tuple(map(int, wanted.strip(">=").split(".")))


def test_what_it_copies_is_there_and_holds_what_the_installation_needs():
    copied = set()
    for name, rest in instructions():
        if name == "COPY":
            *sources, _ = rest.split()
            assert all((ROOT / source).exists() for source in sources), rest
            copied |= set(sources)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert copied >= {"pyproject.toml", "cvnotes", "notebooks", "data", "README.md"}
    assert copied >= set(project["license-files"])


def test_it_installs_the_package_and_runs_its_command():
    [install] = [rest for name, rest in instructions() if name == "RUN"]
    assert install == "pip install --no-cache-dir --editable ."
    [entry] = [json.loads(rest) for name, rest in instructions() if name == "ENTRYPOINT"]
    scripts = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
    assert entry == ["cvnotes"]
    assert "cvnotes" in scripts
