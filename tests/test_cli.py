"""The command: photographs in, a camera out, and one clear line whenever that cannot be."""

import json
import os
import re
import shutil
import signal
import socket
import stat
import subprocess
import sys
import textwrap
import urllib.request
from functools import cache
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import serving, wait_for
from PIL import Image

from cvnotes import __version__
from cvnotes.base import FileError
from cvnotes.camera import Camera, Lens, intrinsics, rotation_from_vector
from cvnotes.commands import lab
from cvnotes.commands.cli import _COMMANDS, main
from cvnotes.files import read_camera, write_camera, write_whole
from cvnotes.photographs import Detection

posix = pytest.mark.skipif(os.name == "nt", reason="signals, pipes and devices of POSIX")

A = intrinsics(420.0, 424.0, 161.0, 118.0)
SIZE = (320, 240)
TILTS = [(0.5, 0.1, 0.05), (-0.5, 0.1, -0.1), (0.1, 0.55, 0.1), (0, -0.55, 0), (0.4, 0.4, 0.2)]
TILTS += [(-0.4, -0.3, -0.2), (0.45, -0.35, 0.1), (-0.2, 0.5, 0.0)]


def photograph(R, T, corners=(9, 6), square=20.0):
    """Photograph a chessboard with an ideal lens: each pixel is the mean of 5 × 5 rays."""
    return exposed((*map(tuple, R),), tuple(T), corners, square).copy()


@cache  # many tests calibrate from the same photographs
def exposed(R, T, corners, square):
    R = np.array(R)
    columns, rows = corners
    part, band = (np.arange(5) - 2) / 5, 4  # so few rows at a time stay in the cache
    u = (np.arange(SIZE[0])[:, None] + part).ravel()
    H = A @ np.column_stack([R[:, 0], R[:, 1], T])
    (x_u, y_u, w_u), (x_v, y_v, w_v), (x_1, y_1, w_1) = np.linalg.inv(H).T
    grey = np.empty((SIZE[1], SIZE[0]))
    for top in range(0, SIZE[1], band):
        v = (np.arange(top, top + band)[:, None] + part).reshape(-1, 1)
        w = (w_u * u + w_1 + w_v * v) * square
        x = np.floor((x_u * u + x_1 + x_v * v) / w) + 1
        y = np.floor((y_u * u + y_1 + y_v * v) / w) + 1
        dark = (x >= 0) & (x <= columns) & (y >= 0) & (y <= rows) & ((x + y) % 2 == 0)
        rays = np.where(dark, 30.0, 220.0).reshape(band, 5, SIZE[0], 5)
        grey[top : top + band] = rays.mean(axis=(1, 3))
    return grey.round().astype(np.uint8)


def board_pose(tilt, depth=520.0, corners=(9, 6), square=20.0):
    """Place the middle of the board on the optical axis."""
    R = rotation_from_vector(tilt)
    middle = np.array([(corners[0] - 1) / 2, (corners[1] - 1) / 2, 0]) * square
    return R, np.array([0, 0, depth]) - R @ middle


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("photos")
    for i, tilt in enumerate(TILTS):
        Image.fromarray(photograph(*board_pose(tilt))).save(folder / f"view {i}.png")
    return folder


def calibrate(*arguments, corners="9x6"):
    return main(["calibrate", *map(str, arguments), "--corners", corners, "--square", "20"])


def process(*arguments, **options):
    """Run the command in a process of its own."""
    # What other packages deprecate is no mistake of the command's.
    run = [sys.executable, "-W", "error", "-W", "ignore::DeprecationWarning", "-m", "cvnotes"]
    options = {"capture_output": True, "text": True, "check": False} | options
    return subprocess.run([*run, *map(str, arguments)], **options)


def one_line(text):
    """Tell whether a text is one line, and no traceback."""
    return text.count("\n") == 1 and text.endswith("\n") and "Traceback" not in text


# --- calibrate ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def calibrated(photos, tmp_path_factory):
    """Calibrate once, with files of all sorts among the photographs."""
    folder = tmp_path_factory.mktemp("mixed")
    for path in photos.iterdir():
        shutil.copy(path, folder)
    (folder / "notes.txt").write_text("tilt more")
    (folder / "empty.jpg").write_bytes(b"")
    whole = (folder / "view 0.png").read_bytes()
    (folder / "cut.png").write_bytes(whole[: len(whole) // 2])
    shutil.copy(folder / "view 3.png", folder / "view 3z.png")
    Image.fromarray(np.full((240, 320), 128, np.uint8)).save(folder / "wall.png")
    Image.fromarray(photograph(*board_pose(TILTS[0]))[:, :300]).save(folder / "cropped.png")
    out = tmp_path_factory.mktemp("result") / "new"
    done = process("calibrate", folder, "--corners", "9x6", "--square", "20", "--out", out)
    return done, out


@pytest.mark.slow
def test_photographs_become_a_camera_within_its_error_bars(calibrated):
    done, out = calibrated
    assert done.returncode == 3, done.stderr  # empty.jpg and cut.png; notes.txt nobody asked for
    keys = json.loads((out / "calibration.json").read_text())
    assert keys["image_size"] == [320, 240]
    assert len(keys["views"]) == 8
    assert keys["rms"] < 0.1
    found = read_camera(out / "calibration.json")
    for i, j, name in ((0, 0, "alpha_u"), (1, 1, "alpha_v"), (0, 2, "u0"), (1, 2, "v0")):
        assert abs(found.A[i, j] - A[i, j]) < 4 * keys["standard_deviations"][name] + 0.05
    assert np.allclose(read_camera(out / "calibration.yml").A, found.A, rtol=0, atol=0)
    assert keys["lens"] == "none"  # views left out chose it


@pytest.mark.slow
def test_every_photograph_is_listed_and_those_not_used_have_their_reasons(calibrated):
    done, out = calibrated
    reasons = {
        "notes.txt": "not a picture, or in a format that is not read",
        "empty.jpg": "the file is empty",
        "cut.png": "damaged or cut off",
        "view 3z.png": "the same picture as",
        "cropped.png": "300×240 pixels where most photographs have 320×240",
        "wall.png": "no board of 9×6 inner corners found in a picture of 320×240 pixels",
    }
    listed = json.loads((out / "calibration.json").read_text())["rejected"]
    rejected = {view["file"]: view["reason"] for view in listed}
    assert rejected.keys() == reasons.keys()
    for name, reason in reasons.items():
        assert reason in rejected[name]
        assert re.search(rf"^{re.escape(name)} +–  {re.escape(reason)}", done.stdout, re.M)
    assert f"\n! wall.png: {rejected['wall.png']}\n" in done.stdout  # too long for the table
    for i in range(8):
        assert re.search(rf"^view {i}\.png +0\.\d\d\d", done.stdout, re.M)


@pytest.mark.slow
def test_the_report_has_error_bars_and_what_the_result_rests_on(calibrated):
    said = calibrated[0].stdout
    assert re.search(r"^alpha_u +4\d\d\.\d+ +0\.\d\d+  px$", said, re.M)
    assert re.search(r"^RMS +0\.\d+ px per point, of 432 corners in 8 photographs$", said, re.M)
    assert re.search(r"^Tilt +boards differ by up to [56]\d°$", said, re.M)
    assert re.search(r"^Coverage +corners in \d+ of 48 cells of the picture$", said, re.M)
    assert "± 1 σ" in said
    assert re.search(
        r"^Next photograph: .* cm away, .*: a pixel is then known to \S+ px", said, re.M
    )
    # No bar where nobody watches.
    assert calibrated[0].stderr == (
        "cvnotes calibrate: 2 of 10 photographs could not be read; the table says why\n"
    )


@pytest.mark.slow
def test_a_report_is_left_beside_the_numbers_and_nothing_else(calibrated):
    names = ["calibration.json", "calibration.yml", "ost.yaml", "photographs.csv", "report.html"]
    assert sorted(path.name for path in calibrated[1].iterdir()) == names
    assert "view 0.png" in (calibrated[1] / "report.html").read_text(encoding="utf-8")


def test_corners_lie_on_the_thumbnail_where_they_lie_on_the_photograph():
    corners = np.array([[-0.5, -0.5], [0.5, 0.5], [639.5, 479.5], [320.5, 2.5]])
    thumbnail = np.zeros((240, 320), np.uint8)
    view = Detection(Path("a.png"), (640, 480), thumbnail, corners)
    expected = [[-0.5, -0.5], [0, 0], [319.5, 239.5], [160, 1]]
    assert np.allclose(view.on_thumbnail(corners), expected, atol=1e-12)


@pytest.mark.slow
def test_lens_and_skew_are_estimated_as_asked(photos, tmp_path, capsys):
    assert calibrate(photos, "--out", tmp_path, "--lens", "k1,k2", "--skew") == 0
    std = json.loads((tmp_path / "calibration.json").read_text())["standard_deviations"]
    assert set(std) == {"alpha_u", "alpha_v", "skew", "u0", "v0", "k1", "k2"}
    assert "OpenCV keeps the skew in calibration.yml but does not use it" in capsys.readouterr().out


def test_too_few_photographs_are_refused_with_the_reasons_and_nothing_is_written(
    photos, tmp_path, capsys
):
    wall = tmp_path / "wall.png"
    Image.fromarray(np.full((240, 320), 128, np.uint8)).save(wall)
    out = tmp_path / "out"
    assert calibrate(photos / "view 0.png", wall, tmp_path / "gone.jpg", "--out", out) == 1
    said = capsys.readouterr()
    assert "there is no such file" in said.out
    assert re.search(r"wall\.png +–  \w+", said.out)
    assert one_line(said.err)
    assert said.err.startswith("cvnotes calibrate: 1 usable photograph; need at least 2 views")
    assert not out.exists()


@pytest.mark.parametrize("name", ["missing", "empty"])
def test_a_missing_or_empty_folder_is_said_in_one_line(tmp_path, capsys, name):
    (tmp_path / "empty").mkdir()
    assert calibrate(tmp_path / name, "--out", tmp_path / "out") == 1
    said = capsys.readouterr()
    assert one_line(said.err)
    assert ("no photographs in" in said.err) or "there is no such file" in said.out
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_board_that_was_counted_wrongly_is_not_found(photos, tmp_path, capsys):
    four = sorted(photos.iterdir())[::2]
    assert calibrate(*four, "--out", tmp_path / "out", corners="10x7") == 1
    said = capsys.readouterr().err
    assert "of 10×7 inner corners was asked for, but 4 photographs show one of 9×6" in said
    assert "try --corners 9x6" in said
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_views_that_do_not_determine_the_camera_are_written_and_marked(tmp_path, capsys):
    folder, out = tmp_path / "flat", tmp_path / "out"
    folder.mkdir()
    for i, roll in enumerate((0.0, 0.2, -0.3, 0.5)):
        picture = photograph(*board_pose((0, 0, roll), depth=500 + 20 * i))
        Image.fromarray(picture).save(folder / f"{i}.png")
    assert calibrate(folder, "--out", out) == 3
    said = capsys.readouterr()
    keys = json.loads((out / "calibration.json").read_text())
    assert keys["reliable"] is False
    assert keys["warnings"]
    assert f"! {keys['warnings'][0]}" in said.out
    assert one_line(said.err)
    assert said.err.startswith("cvnotes calibrate: written, but not reliable: ")


@pytest.mark.slow
def test_a_half_turn_symmetric_board_is_accepted_and_that_is_said(tmp_path, capsys):
    for i, tilt in enumerate(TILTS[:5]):
        made = photograph(*board_pose(tilt, corners=(8, 6)), corners=(8, 6))
        Image.fromarray(made).save(tmp_path / f"{i}.png")
    assert calibrate(tmp_path, "--out", tmp_path / "out", corners="8x6") == 0
    assert "this board looks the same after half a turn" in capsys.readouterr().out


@pytest.mark.slow
def test_an_exif_rotation_is_pointed_out(tmp_path, capsys):
    exif = Image.Exif()
    exif[274] = 6
    for i, tilt in enumerate(TILTS):
        made = Image.fromarray(photograph(*board_pose(tilt)))
        made.save(tmp_path / f"{i}.png", **({"exif": exif} if i % 2 else {}))
    assert calibrate(tmp_path, "--out", tmp_path / "out") == 0
    said = capsys.readouterr().out
    assert said.count("EXIF orientation 6 not applied: sensor frame") == 4
    assert "cv2.IMREAD_IGNORE_ORIENTATION" in said
    assert read_camera(tmp_path / "out" / "calibration.json").A[0, 2] == pytest.approx(161, abs=2)


def test_photographs_of_two_folders_are_told_apart(photos, tmp_path):
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
    for i, path in enumerate(sorted(photos.iterdir())):
        shutil.copy(path, tmp_path / "ab"[i % 2] / f"{i // 2}.png")
    assert calibrate(tmp_path / "a", tmp_path / "b", "--out", tmp_path / "out") == 0
    views = json.loads((tmp_path / "out" / "calibration.json").read_text())["views"]
    assert [view["file"] for view in views][::4] == [str(Path("a/0.png")), str(Path("b/0.png"))]


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda out: out.write_bytes(b"old"), "out is a file"),
        (lambda out: (out / "calibration.json").mkdir(parents=True), "it is a folder"),
    ],
    ids=["a file for the folder", "a folder for the file"],
)
def test_results_that_cannot_be_written_are_one_line_and_exit_code_1(
    photos, tmp_path, capsys, make, reason
):
    out = tmp_path / "out"
    make(out)
    assert calibrate(photos, "--out", out) == 1
    error = capsys.readouterr().err
    assert one_line(error)
    assert reason in error
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert not list(tmp_path.rglob("*.tmp"))


def test_a_read_only_folder_is_refused_before_the_work(photos, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_: False)  # for root everything is writable
    assert calibrate(photos, "--out", tmp_path / "out") == 1
    said = capsys.readouterr()
    assert "is read-only" in said.err
    assert said.out == ""


# --- usage ----------------------------------------------------------------------------------

GOOD = ["calibrate", "photos", "--corners", "9x6", "--square", "25", "--out", "out"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "required: COMMAND"),
        (["nonsense"], "invalid choice: 'nonsense'"),
        (["calibrate"], "required: PHOTO, --corners, --square, --out"),
        ([*GOOD, "--bogus"], "unrecognized arguments: --bogus"),
        ([*GOOD, "--corners", "9by6"], "expected inner corners such as 9x6, got '9by6'"),
        ([*GOOD, "--corners", "0x0"], "two positive whole numbers"),
        ([*GOOD, "--corners", "9x1"], "at least 2×2 inner corners"),
        ([*GOOD, "--square", "0"], "expected a length such as 25, got '0'"),
        ([*GOOD, "--square", "-1"], "expected a length such as 25, got '-1'"),
        ([*GOOD, "--square", "nan"], "expected a length such as 25, got 'nan'"),
        ([*GOOD, "--square", "0,025"], "write a point for the comma"),
        ([*GOOD, "--lens", "k9"], 'expected one of "none", "k1", "k1 k2"'),
        (["undistort", "photos", "--out", "out"], "required: --camera"),
        (["lab", "--port", "many"], "expected a port from 0 to 65535, got 'many'"),
        (["lab", "--port", "99999"], "expected a port from 0 to 65535, got '99999'"),
    ],
)
def test_wrong_usage_is_one_line_and_exit_code_2(arguments, words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    try:
        code = main(arguments)
    except SystemExit as ended:
        code = ended.code
    assert code == 2
    said = capsys.readouterr()
    assert one_line(said.err)
    assert words in said.err
    assert said.out == ""
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", [[], ["calibrate"], ["undistort"], ["lab"], ["target"]])
def test_help_reads_well(command, capsys):
    with pytest.raises(SystemExit, match="0"):
        main([*command, "--help"])
    said = capsys.readouterr().out
    assert said.startswith(f"usage: {' '.join(['cvnotes', *command])}")
    assert max(map(len, said.splitlines())) <= 80
    if command in ([], ["calibrate"], ["undistort"]):
        assert "example" in said


def test_the_version_is_told(capsys):
    with pytest.raises(SystemExit, match="0"):
        main(["--version"])
    assert capsys.readouterr().out == f"cvnotes {__version__}\n"


# --- whatever happens -----------------------------------------------------------------------


@pytest.mark.parametrize("command", _COMMANDS)
def test_every_sub_command_tells_the_version(command, capsys):
    with pytest.raises(SystemExit) as ended:
        main([command, "--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out == f"cvnotes {__version__}\n"


@posix
def test_a_current_folder_that_was_deleted_is_said(tmp_path):
    (tmp_path / "gone").mkdir()
    code = "import os, sys; from cvnotes.commands.cli import main; os.rmdir(os.getcwd()); "
    code += "sys.exit(main(['target', '--corners', '9x6', '--square', '25', '--out', 'a.pdf']))"
    ran = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path / "gone", capture_output=True, text=True,
        env=os.environ | {"PYTHONPATH": str(Path(lab.__file__).parents[2])},
    )  # fmt: skip
    assert ran.returncode == 1
    assert one_line(ran.stderr)
    assert "the current folder has been deleted; go to another" in ran.stderr


def test_a_very_long_name_does_not_push_the_table_aside(photos, tmp_path, capsys):
    folder = shutil.copytree(photos, tmp_path / "photos")
    first = min(folder.iterdir())
    long = first.rename(folder / f"{'a' * 120}{'b' * 100}_001{first.suffix}")
    assert calibrate(folder, "--out", tmp_path / "out", "--lens", "k1 k2") == 0
    table = capsys.readouterr().out.partition("\n\n")[0]
    assert max(map(len, table.splitlines())) < 130
    assert re.search(r"^a{36}…b+_001", table, re.M)
    assert long.name in (tmp_path / "out" / "photographs.csv").read_text()


def test_a_mistake_of_ours_is_one_line_too(photos, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("cvnotes.photographs.detection.find_corners", lambda *_, **__: 1 / 0)
    assert calibrate(photos, "--out", tmp_path / "out") == 1
    error = capsys.readouterr().err
    assert one_line(error)
    assert "a mistake of ours, please report it: ZeroDivisionError" in error
    assert "test_cli.py, line" in error


def test_memory_that_runs_out_is_said(photos, tmp_path, capsys, monkeypatch):
    def look(*_, **__):
        raise MemoryError

    monkeypatch.setattr("cvnotes.photographs.detection.find_corners", look)
    assert calibrate(photos, "--out", tmp_path / "out") == 1
    assert capsys.readouterr().err == "cvnotes calibrate: there is not enough memory for this\n"


SLOW = """
    import signal, sys, time
    from pathlib import Path
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # under nohup a child is born deaf
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    PATCH
    from cvnotes.commands.cli import _COMMANDS, main
    sys.exit(main())
"""
PATCHES = {
    "while looking for corners": """
    import cv2, numpy
    import cvnotes.photographs.detection as detection
    picture = numpy.zeros((1000, 1000), "u1")
    def slow(*_, **__):
        Path("ready").touch()
        while True:  # a thread in OpenCV aborts a process that Python takes apart around it
            cv2.GaussianBlur(picture, (0, 0), 9)
    detection.find_corners = slow
    """,
    "while writing": """
    import os
    synced = os.fsync
    def slow(handle):
        synced(handle)
        Path("ready").touch()
        time.sleep(900)
    os.fsync = slow
    """,
}


@pytest.mark.slow
@posix
@pytest.mark.parametrize("kind", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("when", PATCHES)
def test_an_interruption_leaves_the_old_result_whole_and_nothing_else(photos, tmp_path, when, kind):
    old = tmp_path / "out" / "calibration.json"
    old.parent.mkdir()
    old.write_text("old, made by cvnotes calibrate")
    code = textwrap.dedent(SLOW).replace("PATCH", textwrap.dedent(PATCHES[when]))
    arguments = ["calibrate", photos, "--corners", "9x6", "--square", "20", "--out", "out"]
    arguments += ["--lens", "k1 k2"]
    running = subprocess.Popen(
        [sys.executable, "-c", code, *map(str, arguments)],
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    wait_for((tmp_path / "ready").exists)
    running.send_signal(kind)
    _, error = running.communicate(timeout=300)
    assert running.returncode == 130
    assert "Traceback" not in error
    assert old.read_text() == "old, made by cvnotes calibrate"
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["calibration.json", "out", "ready"]


@pytest.mark.slow
@posix
def test_output_that_cannot_be_printed_is_a_failure_but_a_closed_pipe_is_not(photos, tmp_path):
    out = tmp_path / "out"
    arguments = ["calibrate", photos, "--corners", "9x6", "--square", "20", "--out", out]
    arguments += ["--lens", "k1 k2"]
    with Path("/dev/full").open("w") as full:
        done = process(*arguments, capture_output=False, stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 1
    assert done.stderr == "cvnotes calibrate: not all could be printed: No space left on device\n"
    assert (out / "calibration.json").exists()
    shutil.rmtree(out)
    closed = [sys.executable, "-m", "cvnotes", *map(str, arguments)]
    done = subprocess.run(
        ["sh", "-c", '"$@" >&-', "sh", *closed], stderr=subprocess.PIPE, text=True, check=False
    )
    assert done.returncode == 1
    assert done.stderr == "cvnotes calibrate: not all could be printed: Bad file descriptor\n"
    assert json.loads((out / "calibration.json").read_text())["rms"] < 1
    shutil.rmtree(out)
    reader, writer = os.pipe()
    os.close(reader)
    done = process(*arguments, capture_output=False, stdout=writer, stderr=subprocess.PIPE)
    os.close(writer)
    assert (done.returncode, done.stderr) == (0, "")
    assert (out / "calibration.json").exists()


@pytest.mark.slow
@posix
def test_any_locale_any_name_and_no_home_give_the_same_camera(calibrated, photos, tmp_path):
    folder, out = tmp_path / "-ö\n%s", tmp_path / "out"
    shutil.copytree(photos, folder)
    (folder / os.fsdecode(b"caf\xe9.png")).write_bytes(b"")
    done = process(
        "calibrate", "--corners", "9x6", "--square", "20", "--out", out, "--", folder,
        env={"PATH": os.environ["PATH"], "LC_ALL": "C", "PYTHONIOENCODING": "ascii"},
    )  # fmt: skip
    assert done.returncode == 3, done.stderr  # café.png is empty
    assert r"caf\xe9.png" in done.stdout
    assert "+- 1 sigma" in done.stdout
    here, there = (read_camera(o / "calibration.json").A for o in (out, calibrated[1]))
    assert np.allclose(here, there, rtol=1e-8, atol=0)


# --- undistort ------------------------------------------------------------------------------

CAMERA = Camera(A, lens=Lens(k=(-0.25, 0.1)), size=SIZE)


def grid_through(camera):
    """Photograph a ruled wall at z = 1 through the lens: an exact picture of smooth waves."""
    u, v = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    return waves(camera.ideal(np.stack([u, v], -1)))


def waves(xy):
    return (128 + 60 * np.sin(25 * xy[..., 0]) + 50 * np.cos(30 * xy[..., 1])).astype(np.uint8)


@pytest.fixture
def bent(tmp_path):
    """A photograph through the lens, the camera's file, and what an ideal lens would show."""
    Image.fromarray(grid_through(CAMERA)).save(tmp_path / "bent.png")
    write_camera(CAMERA, tmp_path / "camera.json")
    return tmp_path / "bent.png", tmp_path / "camera.json", grid_through(Camera(A, size=SIZE))


def undistort(*arguments):
    return main(["undistort", *map(str, arguments)])


def test_photographs_come_out_as_an_ideal_lens_takes_them(bent, tmp_path, capsys):
    photo, camera, straight = bent
    assert undistort(photo, "--camera", camera, "--out", tmp_path / "out") == 0
    with Image.open(tmp_path / "out" / "bent.png") as picture:
        found = np.asarray(picture).astype(float)
    middle = (slice(20, -20), slice(20, -20))
    assert np.abs(found[middle] - straight[middle]).max() <= 4  # grey levels, interpolated
    kept = read_camera(tmp_path / "out" / "camera.json")
    assert np.array_equal(kept.A, A)
    assert (kept.lens, kept.size) == (Lens(), SIZE)
    assert re.search(r"bent\.png +bent\.png", capsys.readouterr().out)


def test_zoom_size_and_all_of_a_photograph_may_be_asked_for(bent, tmp_path):
    out = tmp_path / "out"
    assert undistort(bent[0], "--camera", bent[1], "--out", out, "--size", "480x480",
                     "--zoom", "0.8", "--keep-all") == 0  # fmt: skip
    ideal = read_camera(out / "camera.json")
    assert ideal.size == (480, 480)
    assert ideal.A[0, 0] == ideal.A[1, 1]
    with Image.open(out / "bent.png") as picture:
        found = np.asarray(picture).astype(float)
    u, v = np.meshgrid(np.arange(480), np.arange(480))
    shown = np.isfinite(at := CAMERA.project(ideal.ray(np.stack([u, v], -1)))).all(-1)
    shown &= ((at > 1) & (at < np.array(SIZE) - 2)).all(-1)
    rays = ideal.ray(np.stack([u, v], -1))
    assert np.abs(found - waves(rays[..., :2] / rays[..., 2:]))[shown].max() <= 6
    border = ideal.project(CAMERA.ray([[0, 120], [319, 120], [160, 0], [160, 239]]))
    # 479 px of the picture's longer side, four fifths of which are filled
    assert border[1, 0] - border[0, 0] == pytest.approx(0.8 * 479, abs=30)
    assert np.ptp(border[:, 0]) < 0.8 * 479 + 0.01
    assert undistort(bent[0], "--camera", bent[1], "--out", tmp_path / "half", "--zoom", "2",
                     "--size", "160x120") == 0  # fmt: skip
    half = read_camera(tmp_path / "half" / "camera.json")
    np.testing.assert_allclose(half.A[:2, :2], A[:2, :2])
    np.testing.assert_allclose(half.A[:2, 2], A[:2, 2] - [80, 60])
    with pytest.raises(SystemExit):
        undistort(bent[0], "--camera", bent[1], "--out", out, "--size", "480")


@pytest.mark.parametrize("suffix", [".yml", ".json"])
def test_any_form_of_camera_does(bent, tmp_path, suffix):
    write_camera(CAMERA, tmp_path / f"other{suffix}")
    camera = tmp_path / f"other{suffix}"
    assert undistort(bent[0], "--camera", camera, "--out", tmp_path / "out") == 0


def test_colour_depth_and_orientation_are_kept(bent, tmp_path):
    grey = grid_through(CAMERA)
    exif = Image.Exif()
    exif[274] = 8
    colour = np.stack([grey, grey // 2, 255 - grey], -1)
    Image.fromarray(colour).save(tmp_path / "colour.tif", exif=exif)
    Image.fromarray(grey.astype(np.uint16) * 200).save(tmp_path / "deep.png")
    photos = [tmp_path / "colour.tif", tmp_path / "deep.png"]
    assert undistort(*photos, "--camera", bent[1], "--out", tmp_path / "out") == 0
    with Image.open(tmp_path / "out" / "colour.png") as picture:
        assert picture.mode == "RGB"
        assert picture.getexif()[274] == 8
    with Image.open(tmp_path / "out" / "deep.png") as picture:
        assert np.asarray(picture).max() > 40_000


def test_what_cannot_be_undistorted_has_its_reason(bent, tmp_path, capsys):
    Image.fromarray(np.zeros((50, 60), np.uint8)).save(tmp_path / "small.png")
    (tmp_path / "text.jpg").write_text("x")
    out = tmp_path / "out"
    assert undistort(tmp_path, "--camera", bent[1], "--out", out) == 3
    said, complaint = capsys.readouterr()
    assert "2 of 3 photographs were not undistorted" in complaint
    assert "60×50 pixels where the camera has 320×240" in said
    assert "not a picture" in said
    assert sorted(path.name for path in out.iterdir()) == ["bent.png", "camera.json"]
    assert undistort(tmp_path / "small.png", "--camera", bent[1], "--out", tmp_path / "none") == 1
    assert one_line(capsys.readouterr().err)
    assert not (tmp_path / "none").exists()


def test_a_disk_that_is_full_after_some_photographs_is_no_success(
    bent, tmp_path, capsys, monkeypatch
):
    def write(contents):
        if any(path.name == "bent.png" for path in contents):
            raise FileError("bent.png cannot be written: No space left on device")
        write_whole(contents)

    Image.fromarray(255 - grid_through(CAMERA)).save(tmp_path / "other.png")
    monkeypatch.setattr("cvnotes.commands.undistort.write_whole", write)
    assert undistort(tmp_path, "--camera", bent[1], "--out", tmp_path / "out") == 3
    said, complaint = capsys.readouterr()
    assert "No space left" in said
    assert "1 of 2 photographs were not undistorted" in complaint
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["camera.json", "other.png"]


def test_a_lens_that_folds_inside_the_picture_is_pointed_out(bent, tmp_path, capsys):
    folding = Camera(A, lens=Lens(k=(-4.0,)), size=SIZE)
    write_camera(folding, tmp_path / "folding.json")
    assert undistort(bent[0], "--camera", tmp_path / "folding.json", "--out", tmp_path / "o") == 0
    said = capsys.readouterr()
    assert re.search(r"bent\.png +bent\.png  the lens model folds inside", said.out)
    assert said.err == ""


def test_two_photographs_of_one_name_give_two_results(bent, tmp_path):
    Image.fromarray(255 - grid_through(CAMERA)).save(tmp_path / "bent.bmp")
    photos = [bent[0], tmp_path / "bent.bmp"]
    assert undistort(*photos, "--camera", bent[1], "--out", tmp_path / "out") == 0
    names = ["bent.bmp.png", "bent.png", "camera.json"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == names


def test_a_camera_file_that_is_none_is_one_line(bent, tmp_path, capsys):
    bent[1].write_text('{"camera_matrix": NaN}')
    assert undistort(bent[0], "--camera", bent[1], "--out", tmp_path / "out") == 1
    error = capsys.readouterr().err
    assert one_line(error)
    assert "camera_matrix: expected a finite number, got nan" in error


# --- lab ------------------------------------------------------------------------------------


@pytest.fixture
def notebooks(tmp_path):
    """A folder that holds a first notebook."""
    nbformat = pytest.importorskip("nbformat")
    folder = tmp_path / "note books"
    folder.mkdir()
    nbformat.write(nbformat.v4.new_notebook(), folder / lab.START)
    return folder


def test_without_notebooks_or_jupyterlab_it_says_what_to_do(
    notebooks, tmp_path, capsys, monkeypatch
):
    assert main(["lab", "--notebooks", str(tmp_path)]) == 1
    error = capsys.readouterr().err
    assert one_line(error)
    assert "say where the course's notebooks are with --notebooks FOLDER" in error
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    assert main(["lab", "--notebooks", str(notebooks)]) == 1
    assert 'pip install "cvnotes[lab]"' in capsys.readouterr().err


def test_another_port_is_taken_where_somebody_listens_already():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert lab.free_port(port) not in (0, port)
    assert lab.free_port(port) == port


def test_a_machine_without_windows_opens_no_browser(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER", "WSL_DISTRO_NAME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr("webbrowser.open", lambda _: pytest.fail("a browser was opened"))
    assert lab.open_browser("http://127.0.0.1:1") is False
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr("webbrowser.open", lambda _: True)
    assert lab.open_browser("http://127.0.0.1:1") is True


def test_a_server_that_ends_at_once_is_said():
    server = subprocess.Popen([sys.executable, "-c", "raise SystemExit(7)"])
    with pytest.raises(FileError, match="JupyterLab ended with code 7"):
        lab.wait_until_up(server, lab.free_port(0), "token")


class Jupyter(BaseHTTPRequestHandler):
    """As much of a Jupyter server as tells whether a token is its own."""

    def do_GET(self):
        """Answer to the token alone."""
        own = self.headers["Authorization"] == "token of-this-server"
        self.send_response(200 if own and self.path == "/api/status" else 403)
        self.end_headers()

    def log_message(self, *_):
        """Say nothing."""


def test_a_server_that_does_not_know_the_token_is_somebody_elses(tmp_path, monkeypatch):
    """The port was free when it was asked for, and another start was quicker."""
    waits = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(300)"])
    try:
        with serving(Jupyter) as address:
            port = int(address.rpartition(":")[2])
            lab.wait_until_up(waits, port, "of-this-server")
            with pytest.raises(FileError, match="did not answer within 1 s"):
                lab.wait_until_up(waits, port, "of-another", seconds=1)
            ends = [sys.executable, "-c", "raise SystemExit(1)"]  # as JupyterLab: it cannot listen
            monkeypatch.setattr(lab, "start_server", lambda *_: subprocess.Popen(ends))
            assert lab._serve(tmp_path, port, "of-another", "", True) is None
    finally:
        waits.kill()
        waits.wait()


def test_a_second_start_says_that_the_folder_is_open_and_where(notebooks, tmp_path, monkeypatch):
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path))
    (tmp_path / "jpserver-1.json").write_text("not written to its end")
    with serving(Jupyter) as address:
        port = int(address.rpartition(":")[2])
        told = {"root_dir": str(notebooks), "port": port, "token": "of-this-server"}
        for number, changed in enumerate(({"token": "old"}, {"root_dir": "elsewhere"}, {}), 2):
            assert lab.already_open(notebooks) is None
            (tmp_path / f"jpserver-{number}.json").write_text(json.dumps(told | changed))
        run = subprocess.run(
            [sys.executable, "-m", "cvnotes", "lab", "--notebooks", notebooks],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
    assert f"open already, at\n\n    {address}/lab/tree/{lab.START}?token=of-this" in run.stdout
    assert lab.already_open(notebooks) is None  # it has ended, and left its file behind


@pytest.mark.slow
@posix
def test_a_browser_is_started_with_a_page_of_its_owners_and_not_with_the_token(tmp_path):
    from cvnotes.commands.redirect import leading_to

    secret = "http://127.0.0.1:8888/lab/tree/a.ipynb?token=SECRET&x=1"
    with leading_to(secret, tmp_path) as page:
        assert "SECRET" not in page
        path = Path(urllib.request.url2pathname(page.removeprefix("file://")))
        assert path.parent == tmp_path
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        assert 'content="0; url=http://127.0.0.1:8888/lab/tree/a.ipynb?token=SECRET&amp;x=1"' in (
            path.read_text()
        )
    assert not list(tmp_path.iterdir())
    with leading_to(secret, tmp_path / "missing") as page:  # it goes where temporary files go
        assert "SECRET" not in page
        path = Path(urllib.request.url2pathname(page.removeprefix("file://")))
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert not path.exists()


def test_jupyterlab_does_not_wait_for_a_grammar_that_none_of_its_settings_needs(monkeypatch):
    from cvnotes.commands import jupyterlab

    loaded = {}
    app = SimpleNamespace(main=lambda: loaded.update(sys.modules))
    monkeypatch.setitem(sys.modules, "jupyterlab.labapp", app)
    monkeypatch.delitem(sys.modules, "rfc3987_syntax", raising=False)
    jupyterlab.main()
    assert loaded["rfc3987_syntax"] is None
    monkeypatch.delitem(sys.modules, "rfc3987_syntax")


def ended(server):
    """Leave nothing of a server to the tests that follow, whatever has gone wrong."""
    server.terminate()  # which it answers by ending JupyterLab too
    server.communicate()


@posix
@pytest.mark.slow
def test_the_token_is_in_no_command_line(notebooks, tmp_path):
    pytest.importorskip("jupyterlab")
    browser = tmp_path / "browser"
    browser.write_text(f"#!/bin/sh\necho \"$@\" > {tmp_path}/called.part\n"
                       f"mv {tmp_path}/called.part {tmp_path}/called\n")  # fmt: skip
    browser.chmod(0o700)
    running = subprocess.Popen(
        [sys.executable, "-m", "cvnotes", "lab", "--notebooks", str(notebooks)],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
        env=os.environ | {"BROWSER": f"{browser} %s"},
    )  # fmt: skip
    try:
        said = [running.stdout.readline() for _ in range(5)]
        token = re.search(r"token=(\S+)", said[2])[1]
        wait_for((tmp_path / "called").exists)
        given = (tmp_path / "called").read_text()
        assert token not in given
        page = Path(urllib.request.url2pathname(given.strip().removeprefix("file://")))
        assert token in page.read_text()
        running.send_signal(signal.SIGINT)
        running.communicate(timeout=300)
    finally:
        ended(running)
    assert not page.exists()


@posix
@pytest.mark.slow
def test_the_course_is_served_on_loopback_until_ctrl_c(notebooks, tmp_path):
    pytest.importorskip("jupyterlab")
    environment = os.environ | {"JUPYTER_CONFIG_DIR": str(tmp_path / "config")}
    environment.pop("DISPLAY", None)
    running = subprocess.Popen(
        [sys.executable, "-m", "cvnotes", "lab", "--notebooks", str(notebooks)],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=environment,
    )  # fmt: skip
    try:
        said = [running.stdout.readline() for _ in range(5)]
        address = re.search(r"http://127\.0\.0\.1:\d+/lab/tree/(\S+)\?token=(\S{40,})", said[2])
        assert address, said
        assert address[1] == lab.START
        assert "No browser could be opened here" in said[4]
        with urllib.request.urlopen(address[0], timeout=300) as page:
            html = page.read().decode()
        assert "JupyterLab" in html
        assert "apputils-extension:announcements" in html  # switched off: it asks about news
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(f"{address[0].split('/lab')[0]}/api/contents?token=guess")
        running.send_signal(signal.SIGINT)
        assert "The course is closed" in running.communicate(timeout=300)[0]
        assert running.returncode == 130
        with pytest.raises(urllib.error.URLError):
            urllib.request.urlopen(address[0], timeout=5)
    finally:
        ended(running)


@pytest.mark.slow
def test_matrices_are_not_shared_out_to_threads_that_wait():
    """Unless whoever calls the command has said otherwise."""
    ask = "import os, sys; from cvnotes.commands import cli; sys.argv[1:] = ['calibrate', '-h']\n"
    ask += "try: cli.main()\nexcept SystemExit: print(os.environ['OPENBLAS_NUM_THREADS'])"
    for given, told in (({}, "1"), ({"OPENBLAS_NUM_THREADS": "7"}, "7")):
        clean = {k: v for k, v in os.environ.items() if k != "OPENBLAS_NUM_THREADS"}
        run = subprocess.run(
            [sys.executable, "-c", ask], env=clean | given, capture_output=True, text=True
        )
        assert run.stdout.splitlines()[-1] == told, run.stderr
