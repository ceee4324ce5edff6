"""environment.yml, pyproject.toml and the code ask for the same things."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml

pytestmark = pytest.mark.once

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def _name(requirement):
    return re.match(r"[A-Za-z0-9_.-]+", requirement).group().lower()


def test_conda_brings_python_and_pip_and_installs_the_package():
    environment = yaml.safe_load((ROOT / "environment.yml").read_text())
    conda = [d for d in environment["dependencies"] if isinstance(d, str)]
    (pip,) = [d["pip"] for d in environment["dependencies"] if isinstance(d, dict)]
    assert [_name(d) for d in conda] == ["python", "pip"]
    assert pip == ["-e .[lab]"]  # a reader needs neither mypy nor Sphinx
    (python,) = [d for d in conda if d.startswith("python")]
    assert python.removeprefix("python=") >= PROJECT["requires-python"].removeprefix(">=")


def test_the_promised_ranges_are_declared():
    wanted = {
        "numpy": ">=2",
        "matplotlib": ">=3.9",
        "opencv-python-headless": ">=4.11,<6",
        "trimesh": ">=4.7,<6",
        "ipywidgets": ">=8",
    }
    given = {_name(d): d[len(_name(d)) :] for d in PROJECT["dependencies"]}
    assert wanted.items() <= given.items()
    assert PROJECT["requires-python"] == ">=3.11"


def test_the_oldest_versions_tested_are_the_oldest_promised():
    given = {_name(d): d for d in PROJECT["dependencies"]}
    pins = re.findall(r"^([\w-]+)==([\d.]+)\.\*$", (ROOT / "tests/oldest.txt").read_text(), re.M)
    assert {"numpy", "opencv-python-headless", "trimesh"} <= {name for name, _ in pins}
    for name, version in pins:
        if name in given:
            lowest = re.search(r">=([\d.]+)", given[name]).group(1)
            assert version.split(".")[: len(lowest.split("."))] == lowest.split("."), name


def test_versions_agree():
    from cvnotes import __version__

    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert citation["version"] == __version__


def test_no_lock_file_that_names_a_registry_is_tracked():
    ignored = (ROOT / ".gitignore").read_text().splitlines()
    assert {"uv.lock", "pylock*.toml"} <= set(ignored)
