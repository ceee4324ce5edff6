"""For whoever publishes the course: metadata, release notes, workflows."""

import json
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))
import badges  # noqa: E402
import release  # noqa: E402

pytestmark = pytest.mark.once

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


@pytest.fixture
def ready(tmp_path):
    """Copy what a release looks at, with everything filled in."""
    (tmp_path / "cvnotes").mkdir()
    for name in ("pyproject.toml", "CITATION.cff", "CHANGELOG.md", "cvnotes/__init__.py"):
        text = (ROOT / name).read_text().replace(release.PLACEHOLDER, "example.org")
        (tmp_path / name).write_text(text.replace("(unreleased)", "(2030-01-01)"))
    made = badges.badges("https://github.com/Somebody/course")
    (tmp_path / "README.md").write_text(f"# cvnotes\n\n{made}\n")
    return tmp_path


def test_a_release_is_refused_while_the_repository_is_a_placeholder(ready):
    assert release.missing(ready) == []
    shutil.copy(ROOT / "pyproject.toml", ready)
    if release.PLACEHOLDER in (ROOT / "pyproject.toml").read_text():
        (said,) = release.missing(ready)
        assert "put the address of the repository there" in said
        run = subprocess.run(
            [sys.executable, ROOT / "tools" / "release.py"], capture_output=True, text=True
        )
        assert run.returncode == 1
        assert "pyproject.toml names repository.invalid" in run.stderr


def test_a_release_needs_its_badges(ready):
    shutil.copy(ROOT / "README.md", ready)
    if "/actions/workflows/tests.yml" not in (ROOT / "README.md").read_text():
        (said,) = release.missing(ready)
        assert "README.md has no badges: tools/badges.py --write puts them there" in said


def test_a_release_needs_its_notes_and_its_day(ready):
    (ready / "CHANGELOG.md").write_text("# Changelog\n\n## 0.0.1 (2020-01-01)\n\n* Old.\n")
    assert "no notes of version" in release.missing(ready)[0]
    (ready / "CHANGELOG.md").write_text(f"## {release.version(ready)} (unreleased)\n\n* New.\n")
    assert "unreleased" in release.missing(ready)[0]


def test_release_notes_are_those_of_one_version(ready):
    name = release.version(ready)
    text = f"# Changelog\n\n## {name} (2030-01-01)\n\n* New.\n\n## 0.0.1 (2020-01-01)\n\n* Old.\n"
    (ready / "CHANGELOG.md").write_text(text)
    assert release.notes(ready) == (f"{name} (2030-01-01)", "* New.")


def test_every_link_of_the_package_page_names_its_place():
    pytest.importorskip("hatchling")
    from package_page import package_page

    page = package_page((ROOT / "README.md").read_text(), "https://example.org/cvnotes")
    links = re.findall(r"\]\(([^)]+)\)", page)
    assert len(links) > 12
    assert all(link.startswith(("https://", "#")) for link in links), links
    pictures = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", page)
    assert pictures
    assert all("/raw/main/docs/figures/" in picture for picture in pictures)
    for link in links:
        path = re.sub(r"^https://example.org/cvnotes/(blob|raw)/main/", "", link)
        assert path.startswith(("https:", "#")) or (ROOT / path.partition("#")[0]).is_file(), link


def test_the_project_says_where_it_lives_and_what_it_runs_on():
    assert {"Repository", "Issues", "Changelog", "Documentation"} <= PROJECT["urls"].keys()
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert citation["repository-code"] == PROJECT["urls"]["Repository"]
    classifiers = set(PROJECT["classifiers"])
    for version in pythons():
        assert f"Programming Language :: Python :: {version}" in classifiers


def pythons():
    """Give the versions of Python that the workflow tests."""
    jobs = yaml.safe_load((ROOT / ".github/workflows/tests.yml").read_text())["jobs"]
    return jobs["everywhere"]["strategy"]["matrix"]["python"]


def test_the_workflow_tests_every_system_every_python_and_the_oldest_versions():
    workflow = yaml.safe_load((ROOT / ".github/workflows/tests.yml").read_text())
    jobs = workflow["jobs"]
    systems = {name.split("-")[0] for name in jobs["everywhere"]["strategy"]["matrix"]["os"]}
    assert systems == {"ubuntu", "macos", "windows"}
    assert pythons() == ["3.11", "3.12", "3.13", "3.14"]
    assert PROJECT["requires-python"] == f">={pythons()[0]}"
    assert jobs["oldest"]["env"]["PIP_CONSTRAINT"].endswith("/tests/oldest.txt")
    # on a push the newest and the oldest; all of them once a week, and by hand
    (newest,) = (step["with"]["python-version"] for step in jobs["newest"]["steps"][1:2])
    assert newest == pythons()[-1]
    assert {name for name, job in jobs.items() if "if" not in job} == {"newest", "oldest"}
    when = workflow[True]  # YAML reads `on` as yes
    assert {"push", "pull_request", "schedule", "workflow_dispatch"} <= {*when}
    assert re.fullmatch(r"\d+ \d+ \* \* [0-6]", when["schedule"][0]["cron"])
    for job in jobs.values():
        for step in job["steps"]:
            assert len({"uses", "run"} & step.keys()) == 1, step
    for name in re.findall(r"--ignore=([\w./]+)", str(jobs)):
        assert (ROOT / name).is_file(), name
    assert workflow["permissions"] == {"contents": "read"}


def test_the_site_is_published_by_a_workflow_that_may_do_no_more_than_that():
    workflow = yaml.safe_load((ROOT / ".github/workflows/pages.yml").read_text())
    build, deploy = workflow["jobs"]["build"], workflow["jobs"]["deploy"]
    assert workflow["permissions"] == {"contents": "read"}
    assert deploy["permissions"] == {"pages": "write", "id-token": "write"}
    runs = [step["run"] for step in build["steps"] if "run" in step]
    assert runs == ['python start.py site --address "$ADDRESS"']
    uploaded = next(s["with"]["path"] for s in build["steps"] if "upload" in s.get("uses", ""))
    assert (
        f'ROOT / "{uploaded.replace("/", chr(34) + " / " + chr(34))}"'
        in (ROOT / "tools" / "build_site.py").read_text()
    )
    for name in re.findall(r"'([\w/]+\.py)'", str(build)):
        assert (ROOT / name).is_file(), name


def test_a_development_container_installs_the_course_by_its_own_command():
    container = json.loads((ROOT / ".devcontainer" / "devcontainer.json").read_text())
    assert "python start.py check" in container["postCreateCommand"]
    version = container["image"].rpartition(":")[2]
    assert f"{version}" in pythons()


def test_badges_lead_to_the_repository_and_are_refused_without_one():
    made = badges.badges("https://github.com/Somebody/course")
    parts = (
        "Somebody/course/actions/workflows/tests.yml",
        "somebody.github.io/course/",
        "mybinder.org/v2/gh/Somebody/course/main",
        "colab.research.google.com/github/Somebody/course/",
    )
    for part in parts:
        assert part in made
    assert (ROOT / badges.FIRST).is_file()
    for address in (f"https://{release.PLACEHOLDER}/cvnotes", "https://example.org/a/b"):
        with pytest.raises(ValueError, match="is no repository on GitHub"):
            badges.badges(address)


def test_the_script_of_the_tests_is_valid_and_takes_nobody_for_root():
    script = (ROOT / ".ci" / "run").read_text()
    if bash := shutil.which("bash"):
        assert subprocess.run([bash, "-n", ROOT / ".ci" / "run"], check=False).returncode == 0
    assert re.search(r"id -u.*sudo", script, re.S)
