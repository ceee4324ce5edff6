"""Photographs that come one by one, as they are dropped on a page."""

import json
import sys
from pathlib import Path

import pytest
from PIL import Image

from cvnotes.base import CvnotesError
from cvnotes.commands.cli import main
from cvnotes.commands.dropped import Dropped
from cvnotes.photographs import calibrate_photographs
from cvnotes.photographs.driver import chessboard

ROOT = Path(__file__).resolve().parents[1]
VIEWS = sorted((ROOT / "data" / "views").glob("*.png"))
FISHEYE = sorted((ROOT.parent / "shared/data/fisheye").glob("*.jpg"))
where_it_is = pytest.mark.skipif(not FISHEYE, reason="photographs that are not in the repository")


@pytest.fixture
def dropped():
    return Dropped(9, 6, 25.0)


def test_what_comes_out_is_what_the_command_writes(dropped, tmp_path, capsys):
    for path in VIEWS[:6]:
        shown = dropped.look(str(path))
        assert shown["used"]
        assert (len(shown["corners"]), shown["size"]) == (108, [640, 480])
    found = dropped.calibrate("k1 k2")
    options = ["--corners", "9x6", "--square", "25", "--lens", "k1 k2", "--out", str(tmp_path)]
    assert main(["calibrate", *map(str, VIEWS[:6]), *options]) == 0
    assert found["report"] in capsys.readouterr().out
    assert found["reliable"]
    assert set(found["files"]) == {path.name for path in tmp_path.iterdir()}
    theirs, ours = (
        json.loads(text)
        for text in (
            (tmp_path / "calibration.json").read_text(),
            found["files"]["calibration.json"],
        )
    )
    assert ours["camera_matrix"] == theirs["camera_matrix"]
    assert ours["standard_deviations"] == theirs["standard_deviations"]


@pytest.mark.slow
def test_without_opencv_the_camera_is_the_same_within_its_error_bars(dropped, monkeypatch):
    for path in VIEWS[:6]:
        dropped.look(str(path))
    expected = dropped.calibrate("k1 k2")["parameters"]
    monkeypatch.setitem(sys.modules, "cv2", None)
    other = Dropped(9, 6, 25.0)
    for path in VIEWS[:6]:
        other.look(str(path))
    for (name, value, std, _), (same, found, _, _) in zip(
        expected, other.calibrate("k1 k2")["parameters"], strict=True
    ):
        assert name == same
        assert abs(value - found) < std


@pytest.mark.parametrize(
    ("photographs", "corners", "square"),
    [
        pytest.param(VIEWS[:5], (9, 6), 25.0, id="rendered"),
        pytest.param(FISHEYE, (6, 4), 30.0, id="fisheye", marks=[pytest.mark.slow, where_it_is]),
    ],
)
def test_page_command_and_library_use_the_same_photographs_to_the_same_digits(
    photographs, corners, square, tmp_path
):
    page = Dropped(*corners, square)
    for path in photographs:
        page.look(str(path))
    found = page.calibrate()
    options = ["--corners", "{}x{}".format(*corners), "--square", str(square)]
    main(["calibrate", *map(str, photographs), *options, "--out", str(tmp_path)])
    for name in ("calibration.json", "photographs.csv", "calibration.yml", "ost.yaml"):
        assert found["files"][name] == (tmp_path / name).read_bytes()
    library = calibrate_photographs(photographs, chessboard(corners, square))
    assert found["used"] == [path.name for path in photographs]
    assert [photo.path.name for photo in library.photographs.used] == found["used"]
    assert [list(row) for row in library.calibration.table()] == found["parameters"]


def test_each_photograph_that_cannot_be_used_says_why(dropped, tmp_path):
    foreign, large = tmp_path / "foreign.jpg", tmp_path / "large.png"
    foreign.write_text("no picture")
    assert dropped.look(str(foreign))["words"] == "not a picture, or in a format that is not read"
    Image.new("L", (900, 700), 90).save(large)
    assert "no board of 9×6 inner corners found" in dropped.look(str(large))["words"]
    for path in VIEWS[:4]:
        dropped.look(str(path))
    copy = tmp_path / "copy.png"
    copy.write_bytes(VIEWS[0].read_bytes())
    assert dropped.look(str(copy)) == {
        "name": "copy.png", "used": False, "words": "the same picture as view_00.png",
    }  # fmt: skip
    Image.open(VIEWS[4]).resize((1280, 960)).save(large)
    assert dropped.look(str(large))["used"]
    answer = dropped.calibrate("k1")
    assert answer["used"] == [path.name for path in VIEWS[:4]]
    assert set(answer["unlike"]) == {"large.png"}
    table = answer["table"]
    assert "1280×960 pixels where most photographs have 640×480" in table
    assert "foreign.jpg" in table


def test_a_photograph_that_is_left_out_is_forgotten(dropped):
    for path in VIEWS[:4]:
        dropped.look(str(path))
    dropped.forget(VIEWS[3].name)
    assert VIEWS[3].name not in dropped.calibrate("k1")["table"]
    assert dropped.look(str(VIEWS[3]))["used"]  # and may come again


def test_without_a_photograph_there_is_no_camera_and_without_corners_no_board(dropped):
    with pytest.raises(CvnotesError, match="0 usable photographs; a board of 9×6 inner corners"):
        dropped.calibrate()
    with pytest.raises(CvnotesError):
        Dropped(9, 6, -1.0)
