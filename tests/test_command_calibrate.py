"""What `cvnotes calibrate` says of boards that are hidden, miscounted, copied or left out."""

import json
import re
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image
from test_cli import SIZE, TILTS, A, board_pose, photograph

from cvnotes.commands.cli import main
from cvnotes.commands.parallel import in_order
from cvnotes.commands.report import named

pytestmark = pytest.mark.usefixtures("undrawn")


@pytest.fixture
def undrawn(monkeypatch):
    monkeypatch.setattr("cvnotes.commands.pictures.pictures", lambda *_: {})


@pytest.fixture
def photos(tmp_path):
    folder = tmp_path / "photos"
    folder.mkdir()
    for i, tilt in enumerate(TILTS):
        Image.fromarray(photograph(*board_pose(tilt))).save(folder / f"view {i}.png")
    return folder


def calibrate(photos, corners="9x6", square=20):
    out = photos.parent / "out"
    arguments = ["calibrate", photos, "--corners", corners, "--square", square, "--out", out]
    return main([*map(str, arguments)]), out


def with_coin(tilt, column, row):
    """Photograph a board with a grey coin on one of its corners."""
    R, T = board_pose(tilt)
    image = photograph(R, T)
    x, y, z = A @ (R @ np.array([column * 20.0, row * 20.0, 0]) + T)
    v, u = np.indices(image.shape)
    image[np.hypot(u - x / z, v - y / z) < 10] = 125
    return image


def test_one_covered_corner_does_not_lose_the_board(photos, capsys):
    Image.fromarray(with_coin(TILTS[2], 4, 3)).save(photos / "view 2.png")
    code, out = calibrate(photos)
    said = capsys.readouterr().out
    assert code == 0
    assert re.search(r"^view 2\.png +0\.\d+  1 of 54 corners left out: they cannot be", said, re.M)
    assert "of 431 corners in 8 photographs" in said
    keys = json.loads((out / "calibration.json").read_text())
    assert abs(keys["camera_matrix"][0][0] - A[0, 0]) < 1.0
    assert keys["rms"] < 0.1


def test_the_count_is_found_in_the_photographs_and_said(photos, capsys):
    wall = Image.fromarray(np.full(SIZE[::-1], 128, np.uint8))
    wall.save(photos / "a wall.png")
    code, _ = calibrate(photos, corners="auto")
    assert code == 0
    assert capsys.readouterr().out.startswith(
        "A board of 9×6 inner corners, as counted in the photographs\n"
    )


def test_a_count_that_is_nowhere_is_said(tmp_path, capsys):
    (tmp_path / "photos").mkdir()
    wall = Image.fromarray(np.full(SIZE[::-1], 128, np.uint8))
    wall.save(tmp_path / "photos" / "a wall.png")
    code, out = calibrate(tmp_path / "photos", corners="auto")
    assert code == 1
    said = "cvnotes calibrate: no chessboard with 3×3 inner corners or more was found in any\n"
    assert capsys.readouterr().err == said
    assert not out.exists()


def test_the_count_that_is_there_stands_beside_the_photograph(photos, capsys):
    assert calibrate(photos, corners="8x5")[0] == 1
    assert re.search(r"^view 0\.png +–  .*: 9×6 corners are there$", capsys.readouterr().out, re.M)


def test_every_photograph_that_is_not_used_has_a_reason_of_its_own(photos, capsys):
    larger = photograph(*board_pose(TILTS[1], corners=(9, 8)), corners=(9, 8))
    Image.fromarray(larger).save(photos / "larger.png")
    Image.fromarray(np.full(SIZE[::-1], 128, np.uint8)).save(photos / "wall.png")
    assert calibrate(photos)[0] == 0
    said = capsys.readouterr().out
    assert re.search(
        r"^larger\.png +–  .*: (9×8 corners are there|squares go on bey.*)$", said, re.M
    )
    assert re.search(r"^wall\.png +–  .* of 320×240 pixels$", said, re.M)


def test_many_photographs_without_the_board_are_a_doubt(photos, capsys):
    for i in range(9):
        wall = np.full(SIZE[::-1], 120 + i, np.uint8)
        Image.fromarray(wall).save(photos / f"wall {i}.png")
    assert calibrate(photos)[0] == 0
    words = "! 9 of 17 photographs were left out, because the board was not found in them"
    assert words in capsys.readouterr().out


def test_the_same_view_several_times_over_is_said(photos, capsys):
    again = photograph(*board_pose(TILTS[3])).astype(int)
    again += np.random.default_rng(0).integers(-1, 2, again.shape)
    Image.fromarray(again.clip(0, 255).astype(np.uint8)).save(photos / "view 3b.png")
    (photos / "copy.png").write_bytes((photos / "view 0.png").read_bytes())
    assert calibrate(photos)[0] == 0
    said = capsys.readouterr().out
    assert "! the board and the camera did not move between view 3.png and view 3b.png" in said
    assert "! 1 of 10 photographs are copies of others" in said


def test_a_rotation_asked_for_by_a_photograph_that_is_not_used_is_no_matter(photos, capsys):
    exif = Image.Exif()
    exif[274] = 6
    Image.fromarray(np.full(SIZE[::-1], 128, np.uint8)).save(photos / "wall.png", exif=exif)
    assert calibrate(photos)[0] == 0
    assert "EXIF" not in capsys.readouterr().out.split("Camera of")[1]


def test_doubts_name_files_and_places():
    m = [np.array([[20.0, 460.0], [320.0, 240.0], [600.0, 230.0], [300.0, 10.0]])] * 3
    result = SimpleNamespace(image_points=m, size=(640, 480))
    files = ["a.jpg", "b.jpg", "c.jpg"]
    said = named("corners far: view 2, corner 0 (3.1 px), view 1, corner 2 (2 px)", result, files)
    assert said == (
        "corners far: in the lower left corner of c.jpg (3.1 px), at the right edge of b.jpg (2 px)"
    )
    assert named("views 0, 2 do not fit (view 2: 1 px)", result, files) == (
        "a.jpg, c.jpg do not fit (c.jpg: 1 px)"
    )
    assert named("two views give 4 numbers", result, files) == "two views give 4 numbers"
    assert named("view 0, corner 1", result, files) == "in the middle of a.jpg"
    assert named("view 0, corner 3", result, files) == "at the upper edge of a.jpg"


def test_results_come_in_order_and_few_at_a_time():
    under_way, most, lock = [], [], threading.Lock()

    def work(i):
        with lock:
            under_way.append(i)
            most.append(len(under_way))
        time.sleep(0.002 * (5 - i % 5))
        with lock:
            under_way.remove(i)
        return i * i

    assert list(in_order(work, range(30), workers=3)) == [i * i for i in range(30)]
    assert 1 < max(most) <= 3


def test_an_error_is_raised_where_its_result_is_asked_for():
    results = in_order(lambda i: 1 // (3 - i), range(9), workers=2)
    assert [next(results) for _ in range(3)] == [0, 0, 1]
    with pytest.raises(ZeroDivisionError):
        next(results)
