"""The course's data are what tools/make_data.py makes, and what their README says."""

import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from cvnotes.base import FileError
from cvnotes.calibration import calibrate
from cvnotes.learn import personal_camera
from cvnotes.pictures import course, good_views, render
from cvnotes.targets import find_corners

LENS = "k1 k2 p1 p2"
ROOT = Path(__file__).resolve().parents[1]


def test_the_poses_and_corners_are_those_of_the_tool():
    rng = np.random.default_rng(2026)
    poses = good_views(course.board(), course.camera(), 12, rng=rng)
    np.testing.assert_allclose(course.poses(), poses, atol=1e-9)
    views = [course.camera().moved(G) for G in poses]
    exact = [view.project(course.board().points) for view in views]
    np.testing.assert_allclose(course.exact_corners(), exact, atol=1e-8)
    first = render(course.board(), views[0], blur=0.7, noise=2.0, rng=rng)
    assert (np.abs(first.astype(int) - course.photos()[0]) <= 1).all()


def test_the_corners_of_chapter_0_are_near_its_true_ones():
    """That they are its own is held there: see tests/undone/00.toml."""
    board, camera, m = course.board(), course.camera(), course.first_corners()
    assert calibrate(board.points, m, camera.size).rms == pytest.approx(0.0142, abs=5e-5)


def test_measured_corners_are_what_the_finder_measures():
    for i in (0, 7):
        found = find_corners(course.photos()[i], course.board())
        np.testing.assert_allclose(found, course.measured_corners()[i], atol=2e-3)


# the lens of these cameras has a little more in it than four coefficients
@pytest.mark.filterwarnings("ignore::cvnotes.base.errors.CalibrationWarning")
@pytest.mark.parametrize(
    ("side", "alpha_u", "alpha_v"), [("left", 533.004, 533.153), ("right", 536.983, 536.569)]
)
def test_corners_measured_in_photographs_calibrate_as_published(side, alpha_u, alpha_v):
    # J.-Y. Bouguet's toolbox, from the same thirteen photographs of each camera
    real = course.real_corners()
    found = calibrate(real.board.points, getattr(real, side), (640, 480), lens=LENS)
    assert abs(found.A[0, 0] - alpha_u) < 0.5
    assert abs(found.A[1, 1] - alpha_v) < 0.5
    assert found.rms < 0.19


def test_from_pixels_to_the_camera_within_its_own_error_bars():
    rng = np.random.default_rng(77)
    camera, board = course.camera(), course.board()
    poses = good_views(board, camera, 12, rng=rng)
    photos = [render(board, camera.moved(G), blur=0.7, noise=2, rng=rng) for G in poses]
    found = calibrate(board.points, [find_corners(p, board) for p in photos], camera.size)
    true = {"alpha_u": 800, "alpha_v": 804, "u0": 325, "v0": 238, "k1": -0.25, "k2": 0.10}
    for name, value in true.items():
        assert abs(found.parameters[name] - value) < 3 * found.std[name], name
    assert abs(found.A[0, 0] / 800 - 1) < 5e-4
    assert found.reliable
    assert not found.warnings


def test_personal_cameras_stay_the_same():
    stored = json.loads((ROOT / "data" / "personal.json").read_text())
    for student in ("ada", "grace", "emmy"):
        A = personal_camera(student).truth().A
        np.testing.assert_allclose(A[[0, 1, 0, 1], [0, 1, 2, 2]], stored[student], atol=1e-8)


def test_the_data_are_small_and_contain_no_photograph_of_others():
    files = [p for p in (ROOT / "data").rglob("*") if p.is_file()]
    assert sum(p.stat().st_size for p in files) < 10_000_000
    assert {p.suffix for p in files} == {".json", ".png", ".md", ".glb"}
    for path in (ROOT / "data" / "meshes").glob("*.glb"):
        assert path.read_bytes()[:4] == b"glTF"
        assert b"http" not in path.read_bytes()


def test_a_missing_file_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(course, "DATA", tmp_path)
    with pytest.raises(FileError, match=r"data/camera.json is missing"):
        course.camera()


@pytest.mark.sampling
def test_the_tool_finds_nothing_to_change(monkeypatch, capsys):
    if np.__version__ < "2.3":
        pytest.skip("pictures are compared with those of current versions")
    monkeypatch.syspath_prepend(ROOT / "tools")
    monkeypatch.setattr(sys, "argv", ["make_data.py", "--check"])
    code, said = importlib.import_module("make_data").main(), capsys.readouterr().out
    assert code in (0, 1)
    differs = [line for line in said.splitlines() if "meshes" not in line]
    assert not [line for line in differs if line.endswith("differs")], said
