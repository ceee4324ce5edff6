"""What `cvnotes calibrate` says of boards that are hidden, miscounted, copied or left out."""

import json
import pickle
import re
import threading
import time
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from PIL import Image
from test_cli import SIZE, TILTS, A, board_pose, photograph

from cvnotes.base.parallel import in_order
from cvnotes.calibration import calibrate as calibration
from cvnotes.calibration.doubts import Corner, Doubt, View, Views
from cvnotes.commands.cli import main
from cvnotes.commands.report import as_text, camera_report
from cvnotes.files import read_camera_info
from cvnotes.photographs.judging import naming
from cvnotes.pictures import course
from cvnotes.targets import Chessboard

BOARD = Chessboard((9, 6), 20.0)
CHOSEN = ("9x6", 20, "--lens", "k1 k2", "--board-shape", "flat")  # so that neither is looked for


@pytest.fixture
def photos(tmp_path):
    """Save photographs."""
    folder = tmp_path / "photos"
    folder.mkdir()
    for i, tilt in enumerate(TILTS):
        Image.fromarray(photograph(*board_pose(tilt))).save(folder / f"view {i}.png")
    return folder


def calibrate(photos, corners="9x6", square=20, *more):
    out = photos.parent / "out"
    arguments = ["calibrate", photos, "--corners", corners, "--square", square, "--out", out, *more]
    return main([*map(str, arguments)]), out


def test_a_clip_becomes_a_file_of_ros_in_one_command(tmp_path, capsys):
    rng, held = np.random.default_rng(0), []
    video = cv2.VideoWriter(
        str(tmp_path / "clip.avi"), cv2.VideoWriter.fourcc(*"MJPG"), 10.0, SIZE, isColor=False
    )
    video.set(cv2.VIDEOWRITER_PROP_QUALITY, 98)
    still = [photograph(*board_pose(tilt)).astype(float) for tilt in TILTS]
    number = 0
    for here, there in zip(still, [*still[1:], still[0]], strict=True):
        for part in (0, 0, 0, 0, 0, 0.3, 0.7):  # held, then on its way to the next place
            shown = (1 - part) * here + part * there + rng.normal(0, 1, here.shape)
            video.write(shown.clip(0, 255).astype(np.uint8))
            held += [number] * (part == 0)
            number += 1
    video.release()
    code, out = calibrate(tmp_path / "clip.avi", "auto", 20, "--lens", "none")
    said = capsys.readouterr().out
    assert code == 0, said
    assert re.search(r"clip\.avi +–  a video: of 56 frames \d+ that are", said)
    taken = [int(n) for n in re.findall(r"^clip frame (\d+) +0\.", said, re.M)]
    assert set(taken) <= set(held)
    assert {number // 7 for number in taken} == set(range(8))  # each place, and none twice
    assert len(taken) == 8
    info = read_camera_info(out / "ost.yaml")
    np.testing.assert_allclose(info.camera.A, A, atol=2)
    assert (info.camera.size, info.camera.lens.is_ideal) == (SIZE, True)

    (tmp_path / "cut.mp4").write_bytes(b"no video")
    assert calibrate(tmp_path / "cut.mp4")[0] == 1
    assert "not a video that OpenCV can read" in capsys.readouterr().out


def with_coin(tilt, column, row):
    """Photograph a board with a grey coin on one of its corners."""
    R, T = board_pose(tilt)
    image = photograph(R, T)
    x, y, z = A @ (R @ np.array([column * 20.0, row * 20.0, 0]) + T)
    v, u = np.indices(image.shape)
    image[np.hypot(u - x / z, v - y / z) < 10] = 125
    return image


@pytest.mark.slow
def test_mirrored_beside_upright_photographs_are_named_and_left_out(tmp_path, capsys):
    folder = tmp_path / "photos"
    folder.mkdir()
    for i, photo in enumerate(course.photos()):
        photo = photo[:, ::-1] if i in (3, 8) else photo
        Image.fromarray(np.ascontiguousarray(photo)).save(folder / f"{i:02}.png")
    options = ("--lens", "k1 k2", "--board-shape", "flat")
    code, _ = calibrate(folder, "9x6", 25, *options)
    said = capsys.readouterr().out
    assert re.search(r"^! 03\.png, 08\.png: left and right seem exchanged", said, re.M)
    for name in ("03", "08"):
        assert re.search(rf"^{name}\.png +–  left and right seem exchanged", said, re.M)
    assert code == 0

    # kept, they spoil the camera: no camera shows both kinds
    code, out = calibrate(folder, "9x6", 25, *options, "--keep-all")
    said = capsys.readouterr()
    words = "03.png, 08.png: left and right seem exchanged"
    assert re.search(rf"^! {re.escape(words)}", said.out, re.M)
    assert f"written, but not reliable: {words}" in said.err
    assert code == 3
    assert json.loads((out / "calibration.json").read_text())["reliable"] is False


@pytest.mark.slow
def test_one_covered_corner_does_not_lose_the_board(photos, capsys):
    Image.fromarray(with_coin(TILTS[2], 4, 3)).save(photos / "view 2.png")
    code, out = calibrate(photos, *CHOSEN)
    said = capsys.readouterr().out
    assert code == 0
    assert re.search(r"^view 2\.png +0\.\d+  1 of 54 corners left out: they cannot be", said, re.M)
    assert "of 431 corners in 8 photographs" in said
    keys = json.loads((out / "calibration.json").read_text())
    assert abs(keys["camera_matrix"][0][0] - A[0, 0]) < 1.0
    assert keys["rms"] < 0.1


@pytest.mark.slow
def test_the_count_is_found_in_the_photographs_and_said(photos, capsys):
    wall = Image.fromarray(np.full(SIZE[::-1], 128, np.uint8))
    wall.save(photos / "a wall.png")
    for other in sorted(photos.iterdir())[5:]:  # four and the wall
        other.unlink()
    code, _ = calibrate(photos, "auto", *CHOSEN[1:])
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


@pytest.mark.slow
def test_the_count_that_is_there_stands_beside_the_photograph(photos, capsys):
    for other in sorted(photos.iterdir())[1:]:  # in each of them they would be counted anew
        other.unlink()
    assert calibrate(photos, corners="8x5")[0] == 1
    assert re.search(r"^view 0\.png +–  .*: 9×6 corners are there$", capsys.readouterr().out, re.M)


@pytest.mark.slow
def test_every_photograph_that_is_not_used_has_a_reason_of_its_own(photos, capsys):
    larger = photograph(*board_pose(TILTS[1], corners=(9, 8)), corners=(9, 8))
    Image.fromarray(larger).save(photos / "larger.png")
    Image.fromarray(np.full(SIZE[::-1], 128, np.uint8)).save(photos / "wall.png")
    assert calibrate(photos, *CHOSEN)[0] == 0
    said = capsys.readouterr().out
    assert re.search(
        r"^larger\.png +–  .*: (9×8 corners are there|squares go on bey.*)$", said, re.M
    )
    assert re.search(r"^wall\.png +–  .* of 320×240 pixels$", said, re.M)


@pytest.mark.slow
def test_many_photographs_without_the_board_are_a_doubt(photos, capsys):
    for i in range(9):
        wall = np.full(SIZE[::-1], 120 + i, np.uint8)
        Image.fromarray(wall).save(photos / f"wall {i}.png")
    assert calibrate(photos, *CHOSEN)[0] == 0
    words = "! 9 of 17 photographs were left out, because the board was not found in them"
    assert words in capsys.readouterr().out


@pytest.mark.slow
def test_the_same_view_several_times_over_is_said(photos, capsys):
    again = photograph(*board_pose(TILTS[3])).astype(int)
    again += np.random.default_rng(0).integers(-1, 2, again.shape)
    Image.fromarray(again.clip(0, 255).astype(np.uint8)).save(photos / "view 3b.png")
    (photos / "copy.png").write_bytes((photos / "view 0.png").read_bytes())
    assert calibrate(photos, *CHOSEN)[0] == 0
    said = capsys.readouterr().out
    assert "! the board and the camera did not move between view 3.png and view 3b.png" in said
    assert "! 1 of 10 photographs are copies of others" in said


@pytest.mark.slow
def test_a_rotation_asked_for_by_a_photograph_that_is_not_used_is_no_matter(photos, capsys):
    exif = Image.Exif()
    exif[274] = 6
    Image.fromarray(np.full(SIZE[::-1], 128, np.uint8)).save(photos / "wall.png", exif=exif)
    assert calibrate(photos, *CHOSEN)[0] == 0
    assert "EXIF" not in capsys.readouterr().out.split("Camera of")[1]


@pytest.mark.filterwarnings("ignore::cvnotes.base.CalibrationWarning")
def test_whether_the_board_is_flat_is_said_with_the_table():
    real = course.real_corners()
    found = calibration(real.board.points, real.left, real.size, lens="k1 k2 p1 p2", board="auto")
    said = as_text(camera_report(found))
    assert re.search(r"^Board +-0\.2[012] to 0\.[23]\d mm out of its plane \(± 0\.03\), "
                     r"corners up to 0\.2[45] mm beside their places$", said, re.M)  # fmt: skip
    assert re.search(r"^Board +px off in photographs left out", said, re.M)
    assert re.search(r"^flat +0\.168\nfree +0\.096  chosen$", said, re.M)
    assert "out of its plane" not in as_text(
        camera_report(calibration(real.board.points, real.left, real.size))
    )


@pytest.mark.slow
def test_the_shape_of_the_board_is_estimated_as_asked(photos, capsys):
    code, out = calibrate(photos)
    said = capsys.readouterr().out
    assert code == 0
    assert re.search(r"^free +0\.\d+  chosen$", said, re.M)
    assert re.search(r"^Board +(?!-0\.00)-?0\.0[0-5] to 0\.0[0-5] mm out of its plane", said, re.M)
    assert json.loads((out / "calibration.json").read_text())["board_shape"]["kind"] == "free"
    code, out = calibrate(photos, "9x6", 20, "--board-shape", "bent")
    said = capsys.readouterr().out
    assert re.search(r"^Board +-?0\.\d\d to 0\.\d\d mm out of its plane", said, re.M)
    assert json.loads((out / "calibration.json").read_text())["board_shape"]["kind"] == "bent"


def zoomed(image, by=2.0):
    h, w = image.shape
    larger = np.asarray(Image.fromarray(image).resize((int(by * w), int(by * h)), Image.BICUBIC))
    return larger[h // 2 : h // 2 + h, w // 2 : w // 2 + w]


@pytest.mark.slow
def test_a_photograph_that_does_not_fit_is_left_out_and_that_is_said(photos, capsys):
    good = calibrate(photos, *CHOSEN)[1]
    without = json.loads((good / "calibration.json").read_text())
    grey = photograph(*board_pose(TILTS[1], depth=900))
    Image.fromarray(zoomed(grey)).save(photos / "view zoomed.png")
    capsys.readouterr()
    code, out = calibrate(photos, *CHOSEN)
    said = capsys.readouterr().out
    assert code == 0
    row = re.search(
        r"^view zoomed\.png +– +does not fit the others: (\S+) px, a typical photograph", said, re.M
    )
    assert float(row[1]) > 0.5
    made = json.loads((out / "calibration.json").read_text())
    assert made["rms"] == without["rms"]
    (rejected,) = made["rejected"]
    assert rejected["file"] == "view zoomed.png"
    assert "--keep-all uses it" in rejected["reason"]
    code, out = calibrate(photos, *CHOSEN, "--keep-all")
    assert json.loads((out / "calibration.json").read_text())["rms"] > 3 * without["rms"]
    assert re.search(r"^view zoomed\.png +\d", capsys.readouterr().out, re.M)


@pytest.mark.slow
def test_of_views_that_all_disagree_none_is_left_out(tmp_path, capsys):
    """Half of the photographs are zoomed: which of them are wrong, nobody can tell."""
    folder = tmp_path / "photos"
    folder.mkdir()
    for i, tilt in enumerate(TILTS):
        grey = photograph(*board_pose(tilt, depth=900 if i % 2 else 520))
        Image.fromarray(zoomed(grey) if i % 2 else grey).save(folder / f"view {i}.png")
    code, _ = calibrate(folder, *CHOSEN)
    assert code == 3
    assert "does not fit" not in capsys.readouterr().out


@pytest.mark.slow
def test_photographs_are_left_out_as_asked_by_name_or_path(photos, capsys):
    more = ("--leave-out", "view 1.png", photos / "view 2.png")
    code, out = calibrate(photos, *CHOSEN, *more)
    said = capsys.readouterr().out
    assert code == 0
    for i in range(len(TILTS)):
        row = rf"^view {i}\.png +– +left out, as asked$" if i in (1, 2) else rf"^view {i}\.png +0\."
        assert re.search(row, said, re.M)
    table = (out / "photographs.csv").read_text()
    assert 'view 1.png,,"left out, as asked"' in table
    assert calibrate(photos, "9x6", 20, "--leave-out", "view 99.png")[0] == 1
    words = "leave out view 99.png: none of the photographs has this name"
    assert words in capsys.readouterr().err


def test_doubts_name_files_and_places():
    m = [np.array([[20.0, 460.0], [320.0, 240.0], [600.0, 230.0], [300.0, 10.0]])] * 3
    result = SimpleNamespace(image_points=m, size=(640, 480))
    files = ["a.jpg", "b.jpg", "c.jpg"]
    far = Doubt("corners far: {} (3.1 px), {} (2 px)", Corner(2, 0), Corner(1, 2))
    assert far == "corners far: view 2, corner 0 (3.1 px), view 1, corner 2 (2 px)"
    assert naming(far, result, files) == (
        "corners far: in the lower left corner of c.jpg (3.1 px), at the right edge of b.jpg (2 px)"
    )
    bad = Doubt("{} do not fit ({}: 1 px)", Views((0, 2)), View(2))
    assert bad == "views 0, 2 do not fit (view 2: 1 px)"
    assert naming(bad, result, files) == "a.jpg, c.jpg do not fit (c.jpg: 1 px)"
    for plain in ("two views give 4 numbers", Doubt("{ view 3 }")):  # such as a file may hold
        assert naming(plain, result, files) == plain
    assert naming(Doubt("{}", Corner(0, 1)), result, files) == "in the middle of a.jpg"
    assert naming(Doubt("{}", Corner(0, 3)), result, files) == "at the upper edge of a.jpg"
    many = Doubt("{}!", Views(tuple(range(21))))
    assert many.startswith("views 0, 1, 2,")
    assert many.endswith(" 18, 19 …!")
    letters = "abcdefghijklmnopqrstu"
    assert naming(many, result, letters) == f"{', '.join(letters[:20])} …!"
    some = Doubt("{}!", Views(tuple(range(20))))
    assert naming(some, result, letters) == f"{', '.join(letters[:20])}!"
    again = pickle.loads(pickle.dumps(bad))
    assert naming(again, result, files) == naming(bad, result, files)


@pytest.mark.parametrize("allowed", [0, 1])
def test_where_no_thread_can_be_started_the_work_is_done_all_the_same(monkeypatch, allowed):
    start, started = threading.Thread.start, []

    def refusing(thread):
        if len(started) >= allowed:
            raise RuntimeError("can't start new thread")
        started.append(thread)
        start(thread)

    monkeypatch.setattr(threading.Thread, "start", refusing)
    assert list(in_order(lambda i: i * i, range(30), workers=4)) == [i * i for i in range(30)]
    assert len(started) == allowed


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
