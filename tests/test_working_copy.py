"""The student's copy of the course: new chapters arrive, what was changed is never overwritten."""

import json
import platform
import re
import shutil
import subprocess
from pathlib import Path

import nbformat
import pytest

from cvnotes.base import FileError
from cvnotes.base.material import CLONE, is_clone, material
from cvnotes.commands import lab
from cvnotes.commands.cli import main
from cvnotes.commands.working_copy import RECORD, cells_of, default_folder, deliver, start_over

pytestmark = pytest.mark.once

CHAPTERS = ["00_start_here.ipynb", "01_points.ipynb", "02_lines.ipynb", "03_camera.ipynb"]


def write(folder, name, *sources, version="3.11.0"):
    """Write a chapter as tools/build_notebooks.py leaves it."""
    notebook = nbformat.v4.new_notebook()
    notebook.metadata = nbformat.from_dict({"language_info": {"name": "python"}})
    if version:
        notebook.metadata.language_info.version = version
    for i, source in enumerate(sources):
        notebook.cells.append(nbformat.v4.new_code_cell(source, id=f"cell-{i}"))
    nbformat.write(notebook, folder / name)


@pytest.fixture(scope="module")
def run_and_save():
    """Give a function that runs a chapter and saves it, as a student does, who restarts nothing."""
    from nbclient import NotebookClient

    client = NotebookClient(nbformat.v4.new_notebook(), kernel_name="python3")

    def run(path, change=None):
        client.nb = nbformat.read(path, as_version=4)
        if change:
            client.nb.cells[0].source = change
        client.execute(cleanup_kc=False)
        nbformat.write(client.nb, path)

    yield run
    client.nb = nbformat.v4.new_notebook()
    client.execute()  # which ends the kernel


@pytest.fixture
def course(tmp_path):
    folder = tmp_path / "notebooks"
    folder.mkdir()
    for name in CHAPTERS[:3]:
        write(folder, name, f"'{name}'", "1 + 1")
    return folder


@pytest.fixture
def mine(course, tmp_path):
    deliver(course, tmp_path / "my_course")
    return tmp_path / "my_course"


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.glob("*.ipynb")}


@pytest.mark.slow
def test_three_chapters_run_and_saved_stay_when_a_changed_version_arrives(
    course, mine, run_and_save
):
    original = contents(course)
    for name in CHAPTERS[:3]:
        run_and_save(mine / name, change=f"'my own {name}'")
    work = contents(mine)
    assert contents(course) == original  # the clone is as it was
    for name in CHAPTERS[:3]:
        write(course, name, f"'{name}, corrected'", "1 + 2")
    write(course, CHAPTERS[3], "'new'")
    done = deliver(course, mine)
    after = contents(mine)
    assert {name: after[name] for name in work} == work
    assert done.new == [CHAPTERS[3]]
    assert done.beside == [(n, n.replace(".ipynb", "-new.ipynb")) for n in CHAPTERS[:3]]
    assert cells_of(after["01_points-new.ipynb"]) == cells_of(contents(course)["01_points.ipynb"])
    said = " ".join(done.sentences())
    assert (
        "01_points.ipynb is as you left it; its newer version is beside it: 01_points-new" in said
    )
    assert list(deliver(course, mine).sentences()) == []  # said once
    assert contents(mine) == after


@pytest.mark.slow
def test_running_alone_is_work_too(course, mine, run_and_save):
    run_and_save(mine / CHAPTERS[1])
    before = (mine / CHAPTERS[1]).read_bytes()
    write(course, CHAPTERS[1], "'corrected'")
    assert deliver(course, mine).beside
    assert (mine / CHAPTERS[1]).read_bytes() == before


def test_a_chapter_that_was_only_opened_is_brought_up_to_date(course, mine):
    path = mine / CHAPTERS[1]
    notebook = nbformat.read(path, as_version=4)
    notebook.metadata.language_info = {"name": "python", "version": "3.99"}  # what a server writes
    notebook.metadata.kernelspec = {"name": "python3", "display_name": "Python"}
    notebook.cells[0].metadata = {"jupyter": {"source_hidden": False}}  # its code is unfolded
    nbformat.write(notebook, path)
    assert list(deliver(course, mine).sentences()) == []
    write(course, CHAPTERS[1], "'corrected'")
    assert deliver(course, mine).updated == [CHAPTERS[1]]
    assert "corrected" in path.read_text()
    assert len(contents(mine)) == 3


@pytest.mark.slow
def test_a_newer_version_that_was_worked_in_is_not_overwritten_by_the_next(
    course, mine, run_and_save
):
    run_and_save(mine / CHAPTERS[1], change="'mine'")
    write(course, CHAPTERS[1], "'second'")
    deliver(course, mine)
    write(course, CHAPTERS[1], "'third'")
    assert deliver(course, mine).beside == [(CHAPTERS[1], "01_points-new.ipynb")]
    run_and_save(mine / "01_points-new.ipynb", change="'mine again'")
    before = contents(mine)
    write(course, CHAPTERS[1], "'fourth'")
    assert deliver(course, mine).beside == [(CHAPTERS[1], "01_points-new-2.ipynb")]
    after = contents(mine)
    assert {name: after[name] for name in before} == before


def test_without_its_record_everything_counts_as_the_students(course, mine):
    (mine / RECORD).write_text("{")
    write(course, CHAPTERS[1], "'corrected'")
    before = (mine / CHAPTERS[1]).read_bytes()
    assert deliver(course, mine).beside == [(CHAPTERS[1], "01_points-new.ipynb")]
    assert (mine / CHAPTERS[1]).read_bytes() == before


def test_a_file_that_is_no_notebook_any_more_is_left_alone(course, mine):
    (mine / CHAPTERS[1]).write_bytes(b"\xff not JSON")
    write(course, CHAPTERS[1], "'corrected'")
    assert deliver(course, mine).beside == [(CHAPTERS[1], "01_points-new.ipynb")]
    assert (mine / CHAPTERS[1]).read_bytes() == b"\xff not JSON"


@pytest.mark.slow
@pytest.mark.parametrize("asked", ["1", "01", "01_points", "01_points.ipynb"])
def test_a_chapter_starts_over_and_the_old_one_is_kept(course, mine, run_and_save, asked):
    fresh = (mine / CHAPTERS[1]).read_bytes()
    run_and_save(mine / CHAPTERS[1], change="'mine'")
    work = (mine / CHAPTERS[1]).read_bytes()
    assert start_over(course, mine, asked) == (CHAPTERS[1], "01_points-kept.ipynb")
    assert (mine / CHAPTERS[1]).read_bytes() == fresh
    assert (mine / "01_points-kept.ipynb").read_bytes() == work
    assert start_over(course, mine, asked)[1] == "01_points-kept-2.ipynb"
    assert (mine / "01_points-kept.ipynb").read_bytes() == work
    assert list(deliver(course, mine).sentences()) == []


def test_a_chapter_that_there_is_not_is_said_with_those_there_are(course, mine):
    before = contents(mine)
    with pytest.raises(FileError, match="17 is no chapter; the chapters are 00_start_here"):
        start_over(course, mine, "17")
    assert contents(mine) == before


def test_the_course_itself_is_no_working_copy(course):
    before = contents(course)
    with pytest.raises(FileError, match="holds the course itself"):
        deliver(course, course)
    assert contents(course) == before


def test_a_chapter_says_the_python_that_opens_it_so_that_opening_does_not_change_it(mine):
    notebook = json.loads((mine / CHAPTERS[0]).read_text())
    assert notebook["metadata"]["language_info"]["version"] == platform.python_version()
    # and it is laid out as Jupyter writes it
    again = nbformat.writes(nbformat.read(mine / CHAPTERS[0], as_version=4)) + "\n"
    assert (mine / CHAPTERS[0]).read_text() == again


def test_a_notebook_that_has_no_number_starts_over_by_its_name(course, mine):
    write(course, "more.ipynb", "'new'")
    assert deliver(course, mine).new == ["more.ipynb"]
    assert start_over(course, mine, "more") == ("more.ipynb", "more-kept.ipynb")
    with pytest.raises(FileError, match=r"17 is no .* 02_lines\.ipynb, more\.ipynb"):
        start_over(course, mine, "17")


@pytest.mark.parametrize("changed", [False, True])
def test_a_notebook_that_has_another_name_now_stays_as_it_is(course, mine, changed):
    old, new = course / CHAPTERS[2], course / "lines.ipynb"
    if changed:
        write(mine, old.name, "'mine'")
    before = (mine / old.name).read_bytes()
    old.rename(new)
    done = deliver(course, mine)
    assert (done.new, done.updated, done.beside) == ([new.name], [], [])
    assert (mine / old.name).read_bytes() == before
    assert (mine / new.name).is_file()


def test_the_command_makes_the_copy_and_says_where(course, tmp_path, capsys):
    folder = lab.prepare(course, tmp_path / "deep" / "copy", ["1"])
    said = capsys.readouterr().out
    assert folder == tmp_path / "deep" / "copy"
    assert "New chapters: 00_start_here.ipynb, 01_points.ipynb" in said
    assert "01_points.ipynb starts over; yours is kept as 01_points-kept.ipynb" in said
    assert f"Your working copy of the course: {folder}" in said


def test_called_inside_of_a_copy_it_opens_that_one(mine, monkeypatch):
    monkeypatch.chdir(mine.parent)
    assert default_folder() != mine
    monkeypatch.chdir(mine)
    assert default_folder() == mine  # and makes no copy within the copy


def test_the_copy_can_be_made_without_opening_anything(tmp_path, capsys):
    assert main(["lab", "--copy", str(tmp_path / "copy")]) == 0
    notebooks = [*material("notebooks").glob("*.ipynb")]
    assert len(contents(tmp_path / "copy")) == len(notebooks) > 10
    assert capsys.readouterr().out.startswith("New chapters: 00_start_here.ipynb")


def test_the_committed_notebooks_arrive_as_they_are(tmp_path):
    done = deliver(material("notebooks"), tmp_path / "copy")
    assert len(done.new) == len([*material("notebooks").glob("*.ipynb")]) > 10
    for path in material("notebooks").glob("*.ipynb"):
        source = path.read_bytes().replace(b"](../docs/", b"](docs/")
        assert cells_of(source) == cells_of((tmp_path / "copy" / path.name).read_bytes())


def test_every_link_of_a_chapter_leads_to_a_file_in_the_copy(tmp_path):
    deliver(material("notebooks"), tmp_path / "copy")
    links = 0
    for path in [*tmp_path.glob("copy/*.ipynb"), *tmp_path.glob("copy/docs/**/*.md")]:
        for target in re.findall(r"\]\(([\w./-]+\.(?:md|ipynb|svg|png))[#)]", path.read_text()):
            place = (path.parent / target).resolve()
            assert place.is_file(), (path.name, target)
            assert place.is_relative_to(tmp_path / "copy")  # JupyterLab shows nothing above it
            links += path.name.startswith("00") or path.suffix == ".md"
    assert links >= 12 + 7  # chapters and pages from notebook 0, figures from the pages
    copied = {path.name for path in tmp_path.glob("copy/docs/**/*.md")}
    sheets = {"cross_product.md", "one_point.md", "two_dlt_rows.md"}
    assert copied == {"notation.md", "errata.md", "notes.md"} | sheets


def test_a_page_comes_up_to_date_and_one_that_was_changed_is_left_alone(course, mine):
    (course.parent / "docs").mkdir()
    page, copy = course.parent / "docs" / "axes.md", mine / "docs" / "axes.md"
    page.write_text("x to the right")
    notebook = nbformat.read(course / CHAPTERS[0], as_version=4)
    notebook.cells.append(nbformat.v4.new_markdown_cell("see [axes](../docs/axes.md#x)", id="see"))
    nbformat.write(notebook, course / CHAPTERS[0])
    deliver(course, mine)
    assert copy.read_text() == "x to the right"
    assert "[axes](docs/axes.md#x)" in (mine / CHAPTERS[0]).read_text()
    page.write_text("y downwards")
    deliver(course, mine)
    assert copy.read_text() == "y downwards"
    copy.write_text("y downwards; my remark")
    page.write_text("z forwards")
    deliver(course, mine)
    assert copy.read_text() == "y downwards; my remark"


@pytest.mark.skipif(not (is_clone() and shutil.which("git")), reason="asks git about the clone")
def test_git_does_not_see_the_working_copy_in_the_clone():
    assert default_folder().parent == CLONE == Path(__file__).resolve().parents[1]
    if not (CLONE / ".git").exists():
        pytest.skip("unpacked without its history")
    ask = ["git", "check-ignore", "--quiet", str(default_folder() / CHAPTERS[0])]
    assert subprocess.run(ask, cwd=CLONE, check=False).returncode == 0
