"""What pip installs is the course: notebooks, data and commands, without a clone."""

import os
import subprocess
import sys
import sysconfig
import textwrap
import zipfile
from pathlib import Path

import nbformat
import pytest

from cvnotes.base.material import is_clone
from cvnotes.commands.working_copy import pages

ROOT = Path(__file__).resolve().parents[1]
EXECUTE = """
    import sys
    sys.modules["rfc3987_syntax"] = None  # see conftest.py
    import nbformat
    from nbclient import NotebookClient
    notebook = nbformat.read(sys.argv[1], as_version=4)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    notebook.cells = cells + cells[::-1]
    NotebookClient(notebook, kernel_name="python3", timeout=300).execute()
"""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.once,
    pytest.mark.skipif(not is_clone(), reason="builds the package from a clone"),
]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    pytest.importorskip("hatchling")
    folder = tmp_path_factory.mktemp("wheel")
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*pip, "--wheel-dir", folder, ROOT], check=True)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def elsewhere(wheel, tmp_path_factory):
    """Install the wheel into an environment of its own; gives what runs its Python, far from here.

    What the course depends on is taken from this environment, without the clone installed in it.
    """
    folder = tmp_path_factory.mktemp("elsewhere")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder / "env"], check=True)
    scripts = folder / "env" / ("Scripts" if os.name == "nt" else "bin")
    (packages,) = (folder / "env").glob("Lib/site-packages" if os.name == "nt" else "lib/*/site-*")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(packages)
    # A path named in a .pth file is searched, but the .pth files in it are not followed: the
    # clone, installed here as editable, is not there.
    (packages / "others.pth").write_text(sysconfig.get_path("purelib"))
    outside = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}

    def run(*arguments, **options):
        return subprocess.run(
            [scripts / "python", *map(str, arguments)],
            cwd=folder, env=outside, text=True, capture_output=True, check=True, **options,
        )  # fmt: skip

    where = run("-c", "import cvnotes; print(cvnotes.__file__)").stdout.strip()
    assert Path(where).is_relative_to(packages)
    run.folder = folder
    return run


def test_notebooks_and_data_are_in_the_wheel_and_nothing_else_of_the_clone(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    for folder, pattern in [("notebooks", "*.ipynb"), ("data", "**/*")]:
        for path in (ROOT / folder).glob(pattern):
            if path.is_file():
                assert f"cvnotes/course/{path.relative_to(ROOT).as_posix()}" in names
    assert {name.split("/")[0].split("-")[0] for name in names} == {"cvnotes"}
    ours = "share/jupyter/labextensions/cvnotes-course/package.json"
    assert any(name.endswith(ours) for name in names)
    docs = {name.removeprefix("cvnotes/course/") for name in names if "/docs/" in name}
    assert docs == set(pages(ROOT / "notebooks"))  # those to which notebooks lead, and no others


def test_the_data_of_the_course_are_found(elsewhere):
    say = "from cvnotes.pictures import course as c; "
    say += "print(len(c.photos()), c.real_corners().left.shape, c.camera().A[0, 0])"
    assert elsewhere("-c", say).stdout.split("\n")[0] == "12 (13, 54, 2) 800.0"


def test_lab_makes_a_working_copy_where_it_is_called(elsewhere):
    said = elsewhere("-m", "cvnotes", "lab", "--copy").stdout
    assert f"Your working copy of the course: {elsewhere.folder / 'my_course'}" in said
    made = {path.name for path in (elsewhere.folder / "my_course").glob("*.ipynb")}
    assert made == {path.name for path in (ROOT / "notebooks").glob("*.ipynb")}
    assert (elsewhere.folder / "my_course" / "docs" / "notation.md").is_file()


def test_photographs_are_calibrated(elsewhere):
    board = ["--corners", "9x6", "--square", "25", "--lens", "k1 k2"]
    said = elsewhere("-m", "cvnotes", "calibrate", ROOT / "data" / "views", *board, "--out", "out")
    assert "Camera of 640×480 pixels" in said.stdout
    assert (elsewhere.folder / "out" / "calibration.json").is_file()


def test_a_class_is_graded(elsewhere):
    handed_in = elsewhere.folder / "handed_in"
    handed_in.mkdir()
    notebook = nbformat.v4.new_notebook()
    source = """
        import numpy as np
        from cvnotes.learn import check
        check("meet", lambda a, b: np.cross(a, b))
    """
    notebook.cells.append(nbformat.v4.new_code_cell(textwrap.dedent(source)))
    nbformat.write(notebook, handed_in / "01_projective_space.ipynb")
    elsewhere("-m", "cvnotes", "grade", handed_in, "--out", "marks.csv", "--jobs", "1")
    header, row = (elsewhere.folder / "marks.csv").read_text().splitlines()
    assert "meet" in header
    assert row.split(",")[2] == "1"


def test_a_notebook_runs_and_then_backwards(elsewhere):
    code = "from cvnotes.base.material import material; print(material('notebooks'))"
    notebooks = Path(elsewhere("-c", code).stdout.strip())
    assert not notebooks.is_relative_to(ROOT)
    elsewhere("-c", textwrap.dedent(EXECUTE), notebooks / "02_vanishing_points.ipynb")
