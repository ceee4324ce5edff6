"""Photographs that come one by one, as they are dropped on a page."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from cvnotes.base import CornersNotFound, CvnotesError
from cvnotes.commands.cli import main
from cvnotes.commands.dropped import Dropped, Unknown, sheet
from cvnotes.files.reasons import Copy, OtherSize, Rejected, Unreadable, together
from cvnotes.photographs import calibrate_photographs, detect_photographs
from cvnotes.photographs.driver import chessboard
from cvnotes.photographs.reasons import Misfit, NoBoard

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
    assert found["title"] in capsys.readouterr().out
    assert found["words"] in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert found["words"].startswith("<p>The photographs determine this camera.</p>")
    assert found["rms"] == [f"{rms:.3f} px" for rms in dropped.found.calibration.view_rms]
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
    reasons = " ".join(answer["reasons"])
    assert "large.png: 1280×960 pixels where most photographs have 640×480" in reasons
    assert "foreign.jpg: not a picture" in reasons


def test_a_photograph_that_is_left_out_is_forgotten(dropped):
    for path in VIEWS[:4]:
        dropped.look(str(path))
    dropped.forget(VIEWS[3].name)
    assert dropped.calibrate("k1")["used"] == [path.name for path in VIEWS[:3]]
    assert dropped.look(str(VIEWS[3]))["used"]  # and may come again


def test_without_a_photograph_there_is_no_camera_and_without_corners_no_board(dropped):
    answer = dropped.calibrate()
    assert "0 usable photographs; a board of 9×6 inner corners was found in none" in answer["error"]
    assert (answer["instead"], answer["reasons"]) == (None, [])
    with pytest.raises(CvnotesError, match="there is no camera yet"):
        dropped.straighten(str(VIEWS[0]))
    with pytest.raises(CvnotesError):
        Dropped(9, 6, -1.0)


def test_another_board_than_asked_for_is_named_once_for_all_and_offered(tmp_path):
    page = Dropped(8, 5, 25.0)
    for path in VIEWS[:6]:
        shown = page.look(str(path))
        assert shown["words"].endswith("640×480 pixels: 9×6 corners are there")
    (tmp_path / "foreign.jpg").write_text("no picture")
    page.look(str(tmp_path / "foreign.jpg"))
    answer = page.calibrate()
    assert answer["error"].endswith("but 6 photographs show one of 9×6")
    assert answer["instead"] == (9, 6)
    board, foreign = answer["reasons"]
    assert board.startswith(
        "view_00.png, view_01.png, view_02.png, view_03.png, view_04.png … (6 in"
    )
    assert board.endswith(
        "a board of 9×6 inner corners is there: were all of its inner corners counted?"
    )
    assert foreign == "foreign.jpg: not a picture, or in a format that is not read"


def test_corners_are_counted_as_the_library_counts_them(tmp_path):
    unknown = Unknown()
    (tmp_path / "foreign.jpg").write_text("no picture")
    Image.new("L", (640, 480), 90).save(tmp_path / "grey.png")
    for name, words in (("foreign.jpg", "not a picture"), ("grey.png", "no chessboard found")):
        answer = unknown.count(str(tmp_path / name))
        assert answer["corners"] is None
        assert answer["words"].startswith(words)
    with pytest.raises(CvnotesError, match="found in any"):
        unknown.counting.most  # noqa: B018
    told = [unknown.count(str(path))["corners"] for path in VIEWS[:3]]
    assert told == [None, None, (9, 6)]
    assert unknown.counting.most == detect_photographs(VIEWS[:3], 25.0).board.corners


def test_the_machines_own_camera_counts_boards_that_it_sees_whole():
    unknown = Unknown()
    frame = np.asarray(Image.open(VIEWS[0]).convert("L"))
    u, _ = np.reshape(Dropped(9, 6, 25.0).look(str(VIEWS[0]))["corners"], (-1, 2)).T * 640 / 480
    cut_off = np.roll(frame, 645 - int(u.max()), axis=1)  # its last corners are in no picture
    cut_off[:, : 645 - int(u.max())] = 90
    for picture in (np.full_like(frame, 90), cut_off):
        seen = unknown.see(picture.tobytes(), (640, 480))
        assert (seen["words"], seen["counted"]) == ("the board is not seen whole", None)
    answers = [unknown.see(frame.tobytes(), (640, 480)) for _ in range(3)]
    assert [answer["counted"] for answer in answers] == [None, None, (9, 6)]
    assert len(answers[0]["corners"]) == 108
    assert not any(answer["take"] for answer in answers)


def test_a_straightened_photograph_and_the_sheet_are_those_of_the_commands(dropped, tmp_path):
    for path in VIEWS[:5]:
        dropped.look(str(path))
    (tmp_path / "calibration.json").write_bytes(
        dropped.calibrate("k1 k2")["files"]["calibration.json"]
    )
    options = ["--camera", str(tmp_path / "calibration.json"), "--out", str(tmp_path)]
    assert main(["undistort", str(VIEWS[7]), *options]) == 0
    assert dropped.straighten(str(VIEWS[7]))["png"] == (tmp_path / VIEWS[7].name).read_bytes()
    Image.new("L", (900, 700), 90).save(tmp_path / "large.png")
    with pytest.raises(CvnotesError, match="the camera's pictures are 640 × 480"):
        dropped.straighten(str(tmp_path / "large.png"))
    board = tmp_path / "board.pdf"
    main(["target", "--corners", "8x5", "--square", "30", "--paper", "A3", "--out", str(board)])
    assert sheet(8, 5, 30.0, "A3") == board.read_bytes()


def test_what_photographs_miss_alike_is_said_once_though_their_numbers_differ():
    rejected = [Rejected(f"{i}.png", Misfit(rms, 0.1)) for i, rms in enumerate((3.1, 2.2))]
    rejected += [Rejected("a.png", OtherSize((3, 4), (4, 3))), Rejected("b.png", Copy("0.png"))]
    moved, turned, copy = together(rejected)
    assert moved.startswith("0.png, 1.png: was it moved, ")
    assert (
        turned == "a.png: 3×4 pixels where most photographs have 4×3; was it turned by an editor?"
    )
    assert copy == "b.png: the same picture as 0.png"


def test_what_is_there_instead_of_the_board_is_never_cut_off():
    start = "no ChArUco board of 30×15 inner corners with markers 4x4_250 found in a picture of 9×9"
    error = CornersNotFound(
        "all that was tried", brief=f"{start} pixels: not one marker can be read"
    )
    assert NoBoard(error).brief.endswith("not one marker can be read")
    assert len(Unreadable("the file is damaged " * 9).brief) <= 80
