"""The builder keeps what a page can show, drops what it cannot, and gives the same file twice."""

import contextlib
import io
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import nbformat
import pytest

pytestmark = [pytest.mark.slow, pytest.mark.once]

SCRIPT = Path(__file__).resolve().parents[1] / "tools" / "build_notebooks.py"
# The script, without what conftest.py spares these processes too.
RUN = (
    "import runpy, sys; sys.modules['rfc3987_syntax'] = None; del sys.argv[0];"
    "runpy.run_path(sys.argv[0], run_name='__main__')"
)
VIEW = "application/vnd.jupyter.widget-view+json"


def write(path, *cells):
    """Write a notebook; a cell is its source, or its source and a tag."""
    notebook = nbformat.v4.new_notebook()
    for source, *tags in ([cell] if isinstance(cell, str) else cell for cell in cells):
        metadata = {"tags": tags, "collapsed": True}
        notebook.cells.append(nbformat.v4.new_code_cell(source, metadata=metadata))
    nbformat.write(notebook, path)
    return path


def run(*arguments):
    """Call the script here, where what it imports is loaded."""
    said = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stdout(said):
        patch.syspath_prepend(SCRIPT.parent)
        patch.setattr(sys, "argv", [SCRIPT.name, *map(str, arguments)])
        from build_notebooks import main

        code = main()
    return SimpleNamespace(returncode=code, stdout=said.getvalue())


def built(path):
    """Call the script as its users do, to hear what the kernels say."""
    command = [sys.executable, "-c", RUN, SCRIPT, path]
    result = subprocess.run(command, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr
    assert "eavesdropping" not in result.stderr
    return nbformat.read(path, as_version=4).cells


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """Build one notebook with everything that is not kept as it comes."""
    path = write(
        tmp_path_factory.mktemp("page") / "page.ipynb",
        ("from cvnotes.show.explorations import explore\nexplore('lens')", "nbval-ignore-output"),
        ("'a large viewer'", "no-save-output"),
        "import ipywidgets\nipywidgets.IntSlider()",
        "'a value'",
        "from IPython.display import display\nwidget = explore('lens')\ndisplay(widget, 5)",
        ("# What is drawn: nothing.\n6", "hide-input"),
    )
    return path, built(path)


def test_of_an_exploration_the_still_remains_with_its_text_and_nothing_of_the_widget(page):
    from cvnotes.show.explorations import model

    for cell in (page[1][0], page[1][4]):
        data = cell.outputs[0].data
        assert data.keys() == {"text/html", "text/plain"}
        assert data["text/html"].startswith(model("lens").still()._repr_html_())
    assert page[1][4].outputs[1].data == {"text/plain": "5"}


def test_a_widget_without_a_still_and_a_viewer_leave_nothing(page):
    assert page[1][1].outputs == []
    assert page[1][2].outputs == []
    assert all(cell.execution_count for cell in page[1])


def test_everything_else_is_kept(page):
    assert page[1][3].outputs[0].data == {"text/plain": "'a value'"}


def test_a_cell_of_plumbing_is_folded_in_jupyterlab_and_on_the_site(page):
    folded = {"tags": ["hide-input"], "jupyter": {"source_hidden": True}}
    assert [dict(cell.metadata) for cell in page[1][-2:]] == [{}, folded]


def test_built_twice_it_is_the_same_file_and_the_check_agrees(page):
    path, _ = page
    before = path.read_bytes()
    assert run("--check", path).returncode == 0
    assert run(path).returncode == 0
    assert path.read_bytes() == before


def test_a_widget_saved_by_jupyterlab_is_not_as_built(page, tmp_path):
    notebook = nbformat.read(page[0], as_version=4)
    notebook.cells[0].outputs[0].data[VIEW] = {"model_id": "1", "version_major": 2}
    nbformat.write(notebook, tmp_path / "saved.ipynb")
    result = run("--check", tmp_path / "saved.ipynb")
    assert result.returncode == 1
    assert "not those of tools/build_notebooks.py" in result.stdout


def test_where_a_page_would_show_nothing_it_is_told(tmp_path):
    hidden = ("from cvnotes.show.explorations import explore\nexplore('lens');", "explore")
    path = write(tmp_path / "empty.ipynb", hidden, "1", ("'a viewer'", "no-save-output"), "2")
    result = run(path)
    assert result.returncode == 1
    assert "cell-00 shows no still of its exploration" in result.stdout
    assert "cell-02 has no picture beside its viewer" in result.stdout
    assert run("--check", path).stdout == result.stdout


def test_an_error_and_words_on_stderr_are_told_and_leave_the_exit_code_one(tmp_path):
    path = write(tmp_path / "loud.ipynb", "import sys\nprint('careful', file=sys.stderr)")
    result = run(path)
    assert result.returncode == 1
    assert "cell-00 writes to stderr: careful" in result.stdout
    before = write(tmp_path / "wrong.ipynb", "1 / 0").read_bytes()
    result = run(tmp_path / "wrong.ipynb")
    assert result.returncode == 1
    assert "ZeroDivisionError" in result.stdout
    assert (tmp_path / "wrong.ipynb").read_bytes() == before
