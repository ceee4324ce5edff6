"""The parts of Python for the browser: what was published or nothing, and a lock that knows all."""

import hashlib
import json
import shutil
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))

import browser_parts  # noqa: E402
from browser_parts import PartsMissingError, gather, lay_out, missing, pack  # noqa: E402

pytestmark = pytest.mark.once

WHEEL = b"numpy, as it was published"


@pytest.fixture
def published(tmp_path, monkeypatch):
    """Give a folder with a small Pyodide of our own, which is taken for the published one."""
    monkeypatch.delenv("CVNOTES_PYODIDE", raising=False)
    monkeypatch.setenv("CVNOTES_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "published"
    folder.mkdir()
    depends = {"numpy": ["Odd_Name"], "odd-name": []}
    packages = {
        name: {
            "name": name,
            "file_name": f"{name}.whl",
            "depends": needs,
            "sha256": hashlib.sha256(WHEEL).hexdigest(),
        }
        for name, needs in depends.items()
    }
    lock = json.dumps({"info": {}, "packages": packages | {"unused": {}}}).encode()
    files = {"pyodide.js": b"runtime", "pyodide-lock.json": lock}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    for name in depends:
        (folder / f"{name}.whl").write_bytes(WHEEL)
    digests = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
    monkeypatch.setattr(browser_parts, "RUNTIME", digests)
    monkeypatch.setattr(browser_parts, "PACKAGES", ("numpy",))
    return folder


def test_a_named_folder_that_has_everything_is_taken(published, monkeypatch):
    assert gather(published, network=False) == published
    monkeypatch.setenv("CVNOTES_PYODIDE", str(published))
    assert gather(network=False) == published


@pytest.mark.parametrize("name", ["pyodide.js", "pyodide-lock.json", "odd-name.whl"])
def test_a_part_that_is_not_what_was_published_counts_as_missing(published, name):
    with (published / name).open("ab") as file:
        file.write(b" ")
    assert missing(published) == [name]
    with pytest.raises(PartsMissingError, match=rf"lacks parts of Pyodide [\d.]+: {name}"):
        gather(published)


@pytest.mark.usefixtures("published")
def test_without_any_part_one_sentence_says_so(tmp_path):
    with pytest.raises(PartsMissingError, match=r"^the parts of Pyodide [\d.]+ are not in "):
        gather(network=False)
    with pytest.raises(PartsMissingError, match="is no folder"):
        gather(tmp_path / "nowhere")


def test_the_cache_answers_without_a_network(published, tmp_path, monkeypatch):
    cache = tmp_path / "cache" / f"pyodide-{browser_parts.VERSION}"
    shutil.copytree(published, cache)
    monkeypatch.setattr(browser_parts, "_read", lambda address: pytest.fail(address))
    assert gather() == cache


def test_what_the_network_sends_is_kept_only_if_it_is_what_was_published(
    published, tmp_path, monkeypatch
):
    cache = tmp_path / "cache" / f"pyodide-{browser_parts.VERSION}"
    cache.mkdir(parents=True)
    for name in browser_parts.RUNTIME:
        shutil.copy(published / name, cache)
    sent = {"numpy.whl": WHEEL, "odd-name.whl": b"something else"}
    monkeypatch.setattr(browser_parts, "_read", lambda address: sent[address.rsplit("/", 1)[1]])
    monkeypatch.setattr(browser_parts, "_fetch_copies", id)
    with pytest.raises(PartsMissingError, match=r"from the network: odd-name\.whl; name a folder"):
        gather()
    assert sorted(path.name for path in cache.iterdir()) == [
        "numpy.whl", "pyodide-lock.json", "pyodide.js",
    ]  # fmt: skip


@pytest.mark.slow
def test_the_folder_for_pages_has_the_course_and_a_lock_that_agrees_with_it(published, tmp_path):
    folder = lay_out(published, tmp_path / "python")
    packages = json.loads((folder / "pyodide-lock.json").read_text())["packages"]
    assert {"numpy", "odd-name", "cvnotes", "cvnotes-data", "trimesh", "pyyaml"} <= set(packages)
    assert "unused" not in packages
    for entry in packages.values():
        content = (folder / entry["file_name"]).read_bytes()
        assert hashlib.sha256(content).hexdigest() == entry["sha256"]
    listed = json.loads((folder / "parts.json").read_text())
    with zipfile.ZipFile(folder / listed["cvnotes"]) as wheel:
        inside = set(wheel.namelist())
    code = {path.relative_to(ROOT).as_posix() for path in (ROOT / "cvnotes").rglob("*.py")}
    assert code <= inside
    with zipfile.ZipFile(folder / listed["data"]) as wheel:
        assert "cvnotes/course/data/views/view_00.png" in wheel.namelist()
    assert listed["bytes"]["pyodide.js"] == len(b"runtime")


def test_a_wheel_is_packed_to_the_same_bytes_each_time(tmp_path):
    source = tmp_path / "module.py"
    source.write_text("x = 1\n")
    first, second = (
        pack(folder, "Some_Thing", "1.2", iter([("module.py", source)]), [], [])
        for folder in (tmp_path, tmp_path)
    )
    assert first["sha256"] == second["sha256"]
    assert (first["name"], first["file_name"]) == ("some-thing", "Some_Thing-1.2-py3-none-any.whl")
