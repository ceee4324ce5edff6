"""Nothing of anybody else's is replaced: what the commands write beside, over and after."""

import csv
import itertools
import json
import shutil

import numpy as np
import pytest
from PIL import Image

from cvnotes.camera import Camera, Lens, intrinsics, rotation_from_vector
from cvnotes.commands.cli import main
from cvnotes.files import read_camera, write_camera
from cvnotes.files.ownership import maker, marked

SIZE = (320, 240)
CAMERA = Camera(intrinsics(420, 424, 161, 118), lens=Lens(k=(-0.25, 0.1)), size=SIZE)
RNG = np.random.default_rng(5)


def noise():
    """Make a picture unlike any other."""
    return Image.fromarray(RNG.integers(0, 255, SIZE[::-1], dtype=np.uint8))


@pytest.fixture
def photos(tmp_path):
    """Two photographs of one name, and the camera, all in the folder that is also --out."""
    folder = tmp_path / "photos"
    folder.mkdir()
    noise().save(folder / "a.jpg")
    noise().save(folder / "a.png")
    write_camera(CAMERA, folder / "camera.json")
    return folder


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def undistort(folder):
    camera = folder / "camera.json"
    return main(["undistort", str(folder), "--camera", str(camera), "--out", str(folder)])


def test_undistorting_a_folder_into_itself_replaces_neither_photographs_nor_camera(photos, capsys):
    before = contents(photos)
    assert undistort(photos) == 0
    after = contents(photos)
    assert {name: after[name] for name in before} == before
    new = ["a-straight.png", "a.jpg.png", "camera-straight.json"]
    assert sorted(after.keys() - before.keys()) == new
    said = capsys.readouterr().out
    assert all(name in said for name in new)
    assert read_camera(photos / "camera-straight.json").lens == Lens()


def test_doing_it_again_straightens_nothing_twice_and_replaces_its_own(photos, capsys):
    undistort(photos)
    before = contents(photos)
    capsys.readouterr()
    assert undistort(photos) == 0
    assert contents(photos) == before
    assert capsys.readouterr().out.count("the lens is out of it already") == 2


@pytest.mark.parametrize("name", ["a.png", "A.PNG"])
def test_a_file_of_the_users_in_the_folder_of_results_stays(photos, tmp_path, name):
    out = tmp_path / "out"
    out.mkdir()
    (out / name).write_bytes(b"precious")
    (out / "camera.json").write_bytes(b"precious too")
    arguments = ["--camera", str(photos / "camera.json"), "--out", str(out)]
    assert main(["undistort", str(photos / "a.png"), *arguments]) == 0
    assert (out / name).read_bytes() == b"precious"
    assert (out / "camera.json").read_bytes() == b"precious too"
    assert maker(out / "camera-straight.json") == "undistort"


def test_names_that_differ_in_case_only_are_one_name(photos, tmp_path):
    noise().save(photos / "A.bmp")
    arguments = ["--camera", str(photos / "camera.json"), "--out", str(tmp_path / "out")]
    assert main(["undistort", str(photos), *arguments]) == 0
    names = [path.name.casefold() for path in (tmp_path / "out").glob("*.png")]
    assert len(names) == len(set(names)) == 3


def test_the_mark_in_a_png_changes_no_pixel(tmp_path):
    picture = noise()
    picture.save(tmp_path / "plain.png")
    assert maker(tmp_path / "plain.png") == ""
    path = tmp_path / "marked.png"
    path.write_bytes(marked((tmp_path / "plain.png").read_bytes(), "undistort"))
    with Image.open(path) as read:
        read.verify()
    with Image.open(path) as read:
        assert np.array_equal(np.asarray(read), np.asarray(picture))
        assert read.text["Comment"] == "made by cvnotes undistort"
    assert maker(path) == "undistort"


# --- calibrate ------------------------------------------------------------------------------

TILTS = [(0.5, 0.1, 0.05), (-0.5, 0.1, -0.1), (0.1, 0.55, 0.1), (0, -0.55, 0), (0.4, 0.4, 0.2)]


@pytest.fixture(scope="module")
def boards(tmp_path_factory):
    """Five photographs of a board through an ideal lens, each pixel the mean of 25 rays."""
    folder = tmp_path_factory.mktemp("boards")
    axis = [np.add.outer(np.arange(n), (np.arange(5) - 2) / 5).ravel() for n in SIZE]
    rays = np.stack([*(grid.ravel() for grid in np.meshgrid(*axis)), np.ones(25 * 320 * 240)])
    for i, tilt in enumerate(TILTS):
        R = rotation_from_vector(tilt)
        T = np.array([0, 0, 520.0]) - R @ (np.array([4, 2.5, 0]) * 20)
        x, y, w = np.linalg.inv(CAMERA.A @ np.column_stack([R[:, 0], R[:, 1], T])) @ rays
        x, y = np.floor(x / w / 20) + 1, np.floor(y / w / 20) + 1
        dark = ((x + y) % 2 == 0) & (x >= 0) & (x <= 9) & (y >= 0) & (y <= 6)
        grey = np.where(dark, 30.0, 220.0).reshape(240, 5, 320, 5).mean(axis=(1, 3))
        Image.fromarray(grey.round().astype(np.uint8)).save(folder / f"view {i}.png")
    return folder


def calibrate(photos, out):
    board = ["--corners", "9x6", "--square", "20", "--lens", "none"]
    return main(["calibrate", str(photos), *board, "--out", str(out)])


@pytest.mark.parametrize("name", ["calibration.json", "calibration.yml", "report.html"])
def test_a_file_that_is_named_like_a_result_is_refused_before_the_work(
    boards, tmp_path, capsys, name
):
    (tmp_path / name).write_bytes(b"precious")
    assert calibrate(boards, tmp_path) == 1
    said = capsys.readouterr()
    assert f"{name} was not made by cvnotes calibrate, which would replace it" in said.err
    assert said.out == ""
    assert contents(tmp_path) == {name: b"precious"}


def test_results_go_over_those_of_an_earlier_run(boards, tmp_path):
    assert calibrate(boards, tmp_path) == 0
    made = sorted(contents(tmp_path))
    for name in made:
        assert maker(tmp_path / name) == "calibrate"
    (tmp_path / "report.html").write_text("<!-- made by cvnotes calibrate --> earlier")
    (tmp_path / "notes.txt").write_text("mine")
    assert calibrate(boards, tmp_path) == 0
    assert sorted(contents(tmp_path)) == sorted([*made, "notes.txt"])
    assert "earlier" not in (tmp_path / "report.html").read_text()


def test_pictures_of_results_among_the_photographs_are_no_photographs(boards, tmp_path, capsys):
    for path in boards.iterdir():
        shutil.copy(path, tmp_path)
    (tmp_path / "mine.png").write_bytes(marked((tmp_path / "view 0.png").read_bytes(), "calibrate"))
    assert calibrate(tmp_path, tmp_path) == 0
    assert "mine.png" in capsys.readouterr().out
    keys = json.loads((tmp_path / "calibration.json").read_text())
    assert [r["file"] for r in keys["rejected"]] == ["mine.png"]
    assert len(keys["views"]) == 5


def test_straightened_pictures_are_calibrated_alone_but_never_with_the_originals(boards, tmp_path):
    write_camera(Camera(CAMERA.A, size=SIZE), tmp_path / "ideal.json")
    straight = tmp_path / "straight"
    camera = ["--camera", str(tmp_path / "ideal.json")]
    assert main(["undistort", str(boards), *camera, "--out", str(straight)]) == 0
    assert calibrate(straight, tmp_path / "alone") == 0
    for path in itertools.islice(boards.iterdir(), 4):
        shutil.copy(path, straight / f"bent {path.name}")
    calibrate(straight, tmp_path / "both")
    keys = json.loads((tmp_path / "both" / "calibration.json").read_text())
    assert len(keys["views"]) == 4
    assert sum("out of it already" in r["reason"] for r in keys["rejected"]) == 5


def test_the_table_of_photographs_is_a_file(boards, tmp_path):
    photos = tmp_path / "=photos"
    photos.mkdir()
    for path in boards.iterdir():
        shutil.copy(path, photos)
    Image.fromarray(np.zeros((5, 5), np.uint8)).save(photos / "=small.png")
    assert calibrate(photos, tmp_path / "out") == 0
    with (tmp_path / "out" / "photographs.csv").open(newline="") as stream:
        header, *rows = csv.reader(stream)
    assert header == ["photograph", "rms_px", "note"]
    assert [row[0] for row in rows] == [*(f"view {i}.png" for i in range(5)), "'=small.png"]
    result = json.loads((tmp_path / "out" / "calibration.json").read_text())
    assert [float(row[1]) for row in rows[:5]] == pytest.approx(
        [view["rms"] for view in result["views"]], abs=6e-5
    )
    assert rows[5][1:] == ["", "5×5 pixels where most photographs have 320×240"]
