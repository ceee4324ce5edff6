"""Cameras and calibrations as files: exact both ways, and nothing believed that was not checked."""

import errno
import inspect
import json
import os
import pickle
import re
import signal
import subprocess
import sys
import textwrap
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from cvnotes.base import CvnotesError, FileError, InputTypeError, writing
from cvnotes.calibration import Calibration, calibrate_one_view, saving
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.saving import calibration_json, read_calibration, write_calibration
from cvnotes.camera import (
    Camera,
    FisheyeLens,
    Lens,
    RationalLens,
    intrinsics,
    look_at,
    pose,
    rotation_from_vector,
)
from cvnotes.files import (
    CameraInfo,
    Rejected,
    lens_from_opencv,
    read_camera,
    read_camera_info,
    read_photo,
    read_photos,
    ros_yaml,
    write_camera,
    write_whole,
)
from cvnotes.files.strict import read_text
from cvnotes.targets import Chessboard, TwoPlanes

posix = pytest.mark.skipif(os.name == "nt", reason="pipes, devices and limits of POSIX")
G = pose(rotation_from_vector([0.1, -0.2, 0.3]), [10.0, -20.0, 500.0])
CAMERA = Camera(
    intrinsics(801.2345678901234, 799.1, 320.5, 1e-5),
    lens=Lens(k=(-0.25, 1e-7, 0.03), p=(-1e-4, 2e-3)),
    size=(640, 480),
)
BOARD = np.array([[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 30.0, 0.0], [30.0, 30.0, 0.0]])
LONGER = np.concatenate([BOARD, BOARD + np.array([60.0, 0.0, 0.0])])
CORNERS = [np.array([[100.1, 50], [130, 50], [100, 80], [130, 80.25]]) + i for i in range(2)]


def made(**changes):
    """A calibration by hand."""
    boards, corners = changes.pop("board_points", (BOARD, BOARD)), changes.pop("corners", CORNERS)
    by_hand = Calibration(
        CAMERA.A,
        CAMERA.lens,
        CAMERA.size,
        poses=np.stack([G, np.eye(4)]),
        rms=0.25,
        view_rms=np.array([0.2, 0.3]),
        names=("alpha_u", "k1", "p1"),
        covariance=np.diag([0.25, 1e-8, 1e-10]),
        warnings=("only two views",),
        reliable=False,
        _data=Correspondences.of(boards, corners) if corners else None,
    )
    return replace(by_hand, **changes).as_mapping()


FILES = ("left01.jpg", Path("left02.jpg"))
REJECTED = [Rejected("notes.txt", "not a picture")]


def same_camera(a, b):
    return (
        np.array_equal(a.A, b.A)
        and np.array_equal(a.G, b.G)
        and a.size == b.size
        and a.lens == b.lens
    )


@pytest.fixture
def saved(tmp_path):
    """Give a function that writes text or bytes to a file of that name."""

    def write(name, content):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.fixture
def camera_keys(tmp_path):
    write_camera(CAMERA, tmp_path / "good.json")
    return json.loads((tmp_path / "good.json").read_text())


# --- our JSON -------------------------------------------------------------------------------


def test_a_camera_comes_back_from_json_bit_for_bit_with_its_pose_and_distortion_centre(tmp_path):
    camera = Camera(CAMERA.A, G, replace(CAMERA.lens, centre=(0.01, -0.02)), CAMERA.size)
    write_camera(camera, tmp_path / "camera.json")
    assert same_camera(read_camera(tmp_path / "camera.json"), camera)


def test_json_has_the_keys_that_were_promised():
    keys = json.loads(calibration_json(made(), files=FILES, rejected=REJECTED))
    assert keys["format"] == "cvnotes calibration"
    assert keys["version"] == 1
    assert keys["image_size"] == [640, 480]
    assert keys["camera_matrix"][0] == [801.2345678901234, 0.0, 320.5]
    assert keys["distortion"] == {"k": [-0.25, 1e-7, 0.03], "p": [-1e-4, 2e-3]}
    assert keys["rms"] == 0.25
    assert keys["standard_deviations"] == {"alpha_u": 0.5, "k1": 1e-4, "p1": 1e-5}
    assert keys["lens"] == "k1 p1"
    assert keys["views"][1]["file"] == "left02.jpg"
    assert keys["views"][1]["rms"] == 0.3
    assert keys["views"][1]["R"] == np.eye(3).tolist()
    assert keys["views"][0]["T"] == [10.0, -20.0, 500.0]
    assert keys["rejected"] == [{"file": "notes.txt", "reason": "not a picture"}]
    assert keys["reliable"] is False
    assert keys["warnings"] == ["only two views"]


@pytest.mark.parametrize(
    "written",
    [
        made(),
        made(board_points=(BOARD, 2 * BOARD)),
        made(board_points=(LONGER, BOARD), corners=(np.tile(CORNERS[0], (2, 1)), CORNERS[1])),
        made(corners=(), warnings=(), reliable=True),
    ],
    ids=["one board", "two boards", "a partial board", "no corners"],
)
def test_a_calibration_comes_back_bit_for_bit(tmp_path, written):
    write_calibration(written, tmp_path / "calibration.json")
    back = read_calibration(tmp_path / "calibration.json")
    assert back.keys() == written.keys() - {"choice"}  # which is not kept
    for name in ("names", "lens", "size", "rms", "warnings", "reliable", "converged"):
        assert back[name] == written[name], name
    for name in ("A", "poses", "view_rms", "covariance"):
        assert np.array_equal(back[name], written[name]), name
    corners = [x["_data"].given() if x["_data"] else [] for x in (back, written)]
    for (W, m), (board, image) in zip(*corners, strict=True):
        assert np.array_equal(m, image)
        assert np.allclose(W, board, rtol=0, atol=1e-12)  # kept centred and scaled


def test_a_calibration_from_one_picture_of_a_solid_target_comes_back_too(tmp_path):
    target = TwoPlanes()
    seen = Camera(CAMERA.A, look_at([500, 0, -700], [100, 60, -80])).project(target.points)
    seen += np.random.default_rng(5).normal(0, 0.1, seen.shape)
    result = calibrate_one_view(target.points, seen, (640, 480))
    result.save(tmp_path / "calibration.json")
    back = Calibration.load(tmp_path / "calibration.json")
    assert np.array_equal(back.A, result.A)
    assert np.array_equal(back.image_points, [seen])
    assert np.allclose(back.board_points, [target.points], rtol=0, atol=1e-12)
    assert np.allclose(back.residuals, result.residuals, rtol=0, atol=1e-9)


def test_the_camera_of_a_calibration_can_be_read_alone(tmp_path):
    write_calibration(made(), tmp_path / "calibration.json")
    assert same_camera(read_camera(tmp_path / "calibration.json"), CAMERA)


def test_a_matrix_is_laid_out_a_row_per_line(tmp_path):
    write_camera(CAMERA, tmp_path / "camera.json")
    lines = (tmp_path / "camera.json").read_text().splitlines()
    assert "    [0.0, 799.1, 1e-05]," in lines


@pytest.mark.slow
def test_corners_are_left_out_rather_than_writing_a_file_that_cannot_be_read(tmp_path, monkeypatch):
    # As much is written as is read; here a twentieth of that.
    assert inspect.signature(read_text).parameters["largest"].default == saving.MAX_BYTES
    monkeypatch.setattr(saving, "MAX_BYTES", saving.MAX_BYTES // 20)
    many = np.random.default_rng(1).uniform(0, 640, (10_000, 2))
    large = made(corners=(many, many), board_points=(np.pad(many, ((0, 0), (0, 1))),) * 2)
    write_calibration(large, tmp_path / "calibration.json")
    assert (tmp_path / "calibration.json").stat().st_size <= saving.MAX_BYTES
    back = read_calibration(tmp_path / "calibration.json")
    assert back["_data"] is None
    assert back["rms"] == 0.25


@pytest.mark.parametrize("moved", [0.0, 1.0])
def test_a_board_that_all_views_share_is_written_once(tmp_path, moved):
    boards = (BOARD, BOARD + [moved, 0, 0])
    write_calibration(made(board_points=boards), tmp_path / "calibration.json")
    written = json.loads((tmp_path / "calibration.json").read_text())
    assert ["board" in view for view in written["views"]] == [moved > 0] * 2
    assert ("board" in written) == (moved == 0)
    back = read_calibration(tmp_path / "calibration.json")["_data"].given()
    for (W, _), board in zip(back, boards, strict=True):
        np.testing.assert_allclose(W, board, atol=1e-9)


@pytest.mark.slow
def test_what_is_written_of_more_than_a_thousand_photographs_is_read(tmp_path):
    rng = np.random.default_rng(1)
    poses = np.stack([pose(rotation_from_vector(r), r * 900) for r in rng.normal(size=(1500, 3))])
    found = tuple(rng.uniform(0, 640, (54, 2)) for _ in range(1500))
    written = made(
        poses=poses,
        view_rms=np.full(1500, 0.25),
        corners=found,
        board_points=(Chessboard((9, 6), 30.0).points,) * 1500,
    )
    names = [f"a rather long folder/photograph number {i:05d}.jpg" for i in range(1500)]
    lost = [Rejected(name, "no chessboard of 9×6 inner corners was found") for name in names]
    text = calibration_json(written, files=names, rejected=lost)
    (tmp_path / "calibration.json").write_text(text, encoding="utf-8")
    assert (tmp_path / "calibration.json").stat().st_size > 2_000_000
    back = Calibration.load(tmp_path / "calibration.json")
    assert np.array_equal(back.poses, poses)
    assert np.array_equal(back.image_points[1499], found[1499])
    assert read_camera(tmp_path / "calibration.json").size == CAMERA.size


def test_what_could_not_be_read_is_not_written(tmp_path, monkeypatch):
    monkeypatch.setattr("cvnotes.calibration.saving.MAX_BYTES", 1000)
    with pytest.raises(CvnotesError, match=r"2 views and 0 photographs .* takes \d+ bytes"):
        write_calibration(made(), tmp_path / "calibration.json")
    assert not list(tmp_path.iterdir())


def test_as_many_names_as_views():
    with pytest.raises(CvnotesError, match="files: expected 2 names, got 1"):
        calibration_json(made(), files=["a.jpg"])


# --- JSON that must be refused --------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"camera_matrix": None}, "camera_matrix: expected a list, got nothing"),
        ({"camera_matrix": [[1, 0, 0], [0, 1, 0]]}, "camera_matrix: expected 3 values, got 2"),
        ({"camera_matrix": [[1, 0], [0, 1], [0, 0]]}, r"camera_matrix\[0\]: expected 3 values"),
        ({"camera_matrix": [[0, 0, 0], [0, 1, 0], [0, 0, 1]]}, "alpha_u = 0 but must be positive"),
        ({"camera_matrix": [[8, 0, 0], [1, 8, 0], [0, 0, 1]]}, r"camera_matrix\[1, 0\] = 1"),
        ({"camera_matrix": [["8", 0, 0], [0, 8, 0], [0, 0, 1]]}, r"\[0\]\[0\]: expected a number"),
        ({"camera_matrix": [[True, 0, 0], [0, 8, 0], [0, 0, 1]]}, "got true or false"),
        ({"image_size": [640]}, "image_size: expected 2 values, got 1"),
        ({"image_size": [640.5, 480]}, "two positive whole numbers"),
        ({"image_size": [480, -1]}, "two positive whole numbers"),
        ({"distortion": [0.1, 0.2]}, "distortion: expected keys and values, got a list"),
        ({"distortion": {"k": [0.1]}}, "distortion: the key 'p' is missing"),
        (
            {"distortion": {"k": "800,0", "p": [0, 0]}},
            r"distortion.k: expected a list, got '800,0'",
        ),
        ({"distortion": {"k": [[1]], "p": [0, 0]}}, r"distortion.k\[0\]: expected a number"),
        ({"pose": {"R": np.eye(3).tolist(), "T": [0, 0]}}, "pose.T: expected 3 values, got 2"),
        ({"pose": {"R": (2 * np.eye(3)).tolist(), "T": [0, 0, 0]}}, "not orthonormal"),
        ({"pose": {"R": np.diag([1, 1, -1]).tolist(), "T": [0, 0, 0]}}, "a reflection"),
        ({"format": "another tool"}, "format: expected a cvnotes camera or calibration"),
        ({"version": 2}, "version: this cvnotes reads version 1, the file has 2"),
    ],
)
def test_a_wrong_value_is_refused_by_its_key(saved, camera_keys, change, message):
    path = saved("camera.json", json.dumps(camera_keys | change))
    with pytest.raises(FileError, match=message) as caught:
        read_camera(path)
    assert "camera.json" in str(caught.value)


@pytest.mark.parametrize("key", ["image_size", "camera_matrix", "distortion"])
def test_a_missing_key_is_named(saved, camera_keys, key):
    del camera_keys[key]
    with pytest.raises(FileError, match=f"the key '{key}' is missing"):
        read_camera(saved("camera.json", json.dumps(camera_keys)))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "the file is empty"),
        (b" \n ", "the file is empty"),
        (bytes(500), "the file is empty|NUL bytes"),
        (b'{"a": 1\0}', "NUL bytes"),
        ('{"a": 1}'.encode("utf-16"), "byte-order mark"),
        ('{"a": 1}'.encode("utf-8-sig"), "byte-order mark"),
        ('{"ä": 1}'.encode("latin-1"), "not UTF-8 text: byte 2"),
        (b'{"rms": 1,', "not valid JSON at line 1, column 11"),
        (b"[]", "expected keys and values, got a list"),
        (b"null", "expected keys and values, got nothing"),
        (b'{"x": [1, {"y": NaN}]}', r"x\[1\]\.y: expected a finite number, got nan"),
        (b'{"x": -Infinity}', "x: expected a finite number, got -inf"),
        (b'{"x": 1e999}', "x: expected a finite number, got inf"),
        (b'{"x": ' + b"9" * 100_000 + b"}", "x: expected a finite number"),
        (b'{"x": 1, "x": 2}', "the key 'x' appears twice"),
        (b"[" * 100_000, "nested more than 16 deep at character 16"),
        (b'{"a":' * 50_000, "nested more than 16 deep"),
        (b"[" + b"1," * 9_000_000 + b"1]", "larger than 16000000 bytes"),
        (b'{"x": "' + b'\\"' * 1_000_000, "not valid JSON at line 1, column 7: Unterminated"),
        (b'{"x": ' + b'"' * 999_999, "not valid JSON"),
        (pickle.dumps({"a": 1}), "not UTF-8|NUL bytes"),
    ],
)
def test_hostile_json_is_refused_with_its_position(saved, content, message):
    with pytest.raises(FileError, match=message):
        read_camera(saved("camera.json", content))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"views": []}, "the list of views is empty"),
        ({"views": [1]}, r"views\[0\]: expected keys and values"),
        ({"rms": "small"}, "rms: expected a number, got 'small'"),
        ({"reliable": 1}, "reliable: expected true or false"),
        ({"warnings": [5]}, r"warnings\[0\]: expected a text"),
        ({"covariance": [[1.0]]}, "covariance: expected 3 values, got 1"),
        ({"standard_deviations": [1]}, "standard_deviations: expected keys and values"),
        ({"converged": None}, "converged: expected true or false, got nothing"),
        ({"board": [[0, 0, 0]]}, "board: expected 4 values, got 1"),
        ({"board": [[0, 0, 0]] * 4}, "all board points coincide"),
        ({"distortion": {"k": [], "p": [0, 0]}}, "'k1' is no parameter of this camera; the lens"),
        (
            {"standard_deviations": {"alpha_u": 0.5, "k4": 1e-4, "p1": 1e-5}},
            "'k4' is no parameter of this camera; the lens has 3 radial coefficients",
        ),
        (
            {"standard_deviations": {"focal": 0.5, "k1": 1e-4, "p1": 1e-5}},
            "standard_deviations: 'focal' is no parameter of this camera",
        ),
        (
            {"covariance": np.diag([0.25, -1e-8, 1e-10]).tolist()},
            "covariance: the variance of k1 is negative: -1e-08",
        ),
        (
            {"standard_deviations": {"alpha_u": 0.4, "k1": 1e-4, "p1": 1e-5}},
            "not the roots of the covariance's diagonal",
        ),
        (
            {"covariance": [[0.25, 1e-4, 0], [1e-4, 1e-8, 0], [0, 0, 1e-10]]},
            "larger than both variances allow",
        ),
        ({"covariance": [[0.25, 1e-6, 0], [0, 1e-8, 0], [0, 0, 1e-10]]}, "it is not symmetric"),
        ({"lens": "k1 k2"}, "lens: 'k1 k2', but what has error bars is k1 p1"),
        ({"rms": 0.4}, "rms: 0.4 does not lie between the smallest"),
        ({"rms": -0.25}, "rms: -0.25 does not lie between"),
    ],
)
def test_a_wrong_calibration_is_refused_by_its_key(saved, change, message):
    keys = json.loads(calibration_json(made(), rejected=REJECTED)) | change
    with pytest.raises(FileError, match=message):
        read_calibration(saved("calibration.json", json.dumps(keys)))


def test_a_lens_of_a_thousand_coefficients_is_refused_at_once(tmp_path):
    (tmp_path / "a.json").write_text(
        json.dumps(
            {
                "image_size": [640, 480],
                "camera_matrix": CAMERA.A.tolist(),
                "distortion": {"k": [1e-3] * 1000, "p": [0, 0]},
            }
        )
    )
    with pytest.raises(FileError, match="k: no lens has 1000 coefficients"):
        read_camera(tmp_path / "a.json")


@pytest.mark.parametrize("kind", ["unterminated", "many texts", "many lists", "many keys"])
@pytest.mark.slow
def test_hostile_json_of_any_size_takes_no_longer_than_an_honest_one(tmp_path, kind):
    size = 500_000
    hostile = {
        "unterminated": '{"x": "' + '\\"' * (size // 2),
        "many texts": "[" + '"",' * (size // 3) + '""]',
        "many lists": "[" + "[]," * (size // 3) + "[]]",
        "many keys": "{" + ",".join(f'"{i}":0' for i in range(size // 9)) + "}",
    }
    (tmp_path / "camera.json").write_text(hostile[kind])
    start = time.process_time()
    with pytest.raises(FileError):
        read_camera(tmp_path / "camera.json")
    assert time.process_time() - start < 5  # of quadratic work they would take minutes


@posix
def test_what_is_not_there_or_no_regular_file_is_said(tmp_path):
    for path in (tmp_path, tmp_path / "missing.json"):
        with pytest.raises(FileError, match=r"no such file|ends in \.json"):
            read_camera(path)
    os.mkfifo(tmp_path / "pipe.json")
    with pytest.raises(FileError, match="not a regular one"):
        read_camera(tmp_path / "pipe.json")
    with pytest.raises(FileError, match=r"ends in \.json, \.yml or \.yaml"):
        read_camera(tmp_path / "camera.pkl")


# --- OpenCV's YAML --------------------------------------------------------------------------


def test_opencv_reads_what_we_write(tmp_path):
    write_camera(CAMERA, tmp_path / "camera.yml")
    storage = cv2.FileStorage(str(tmp_path / "camera.yml"), cv2.FILE_STORAGE_READ)
    assert np.array_equal(storage.getNode("camera_matrix").mat(), CAMERA.A)
    d = storage.getNode("distortion_coefficients").mat()
    assert d.ravel().tolist() == [-0.25, 1e-7, -1e-4, 2e-3, 0.03]
    assert storage.getNode("image_width").real() == 640
    assert storage.getNode("image_height").real() == 480


def test_we_read_what_opencv_writes(tmp_path):
    path = tmp_path / "camera.yml"
    for coefficients in (
        np.array([[-0.25, 1e-7, -1e-4, 2e-3, 0.03]]),
        np.array([[-0.25], [1e-7], [-1e-4], [2e-3], [0.03]]),
        np.array([-0.25, 1e-7, -1e-4, 2e-3, 0.03]),  # OpenCV 5 writes an nd-matrix
        np.array([[-0.25, 1e-7, -1e-4, 2e-3, 0.03, 0, 0, 0]]),
    ):
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
        storage.write("image_width", 640)
        storage.write("image_height", 480)
        storage.write("camera_matrix", CAMERA.A)
        storage.write("distortion_coefficients", coefficients)
        storage.release()
        assert same_camera(read_camera(path), CAMERA)


def test_a_camera_comes_back_from_yaml_bit_for_bit(tmp_path):
    write_camera(CAMERA, tmp_path / "camera.yaml")
    assert same_camera(read_camera(tmp_path / "camera.yaml"), CAMERA)


def test_a_skew_that_opencv_ignores_is_pointed_out(tmp_path):
    camera = Camera(intrinsics(800, 800, 320, 240, skew=0.5))
    write_camera(camera, tmp_path / "camera.yml")
    assert (
        "# OpenCV keeps the skew in the matrix but does not use it."
        in (tmp_path / "camera.yml").read_text()
    )
    assert same_camera(read_camera(tmp_path / "camera.yml"), replace(camera, lens=Lens(k=(0, 0))))
    storage = cv2.FileStorage(str(tmp_path / "camera.yml"), cv2.FILE_STORAGE_READ)
    assert storage.getNode("camera_matrix").mat()[0, 1] == 0.5


def test_a_lens_that_opencv_cannot_hold_is_refused_not_shortened(tmp_path):
    for lens in (Lens(k=(0.1, 0.0, 0.0, 1e-3)), Lens(k=(0.1,), centre=(0.01, 0))):
        with pytest.raises(CvnotesError, match="keep it as JSON"):
            write_camera(replace(CAMERA, lens=lens), tmp_path / "camera.yml")
    assert not list(tmp_path.iterdir())


def test_coefficients_stand_in_opencvs_order():
    assert Lens(k=(1, 2, 3), p=(4, 5)).opencv_coefficients().tolist() == [1, 2, 4, 5, 3]
    assert lens_from_opencv([1, 2, 4, 5, 3]) == Lens(k=(1, 2, 3), p=(4, 5))
    assert lens_from_opencv([1, 2, 4, 5]) == Lens(k=(1, 2), p=(4, 5))


@pytest.mark.parametrize("count", [0, 1, 3, 6, 7, 17])
def test_any_other_number_of_coefficients_is_refused(count):
    with pytest.raises(CvnotesError, match=f"expected 4 or 5 coefficients.*got {count}"):
        lens_from_opencv(np.zeros(count))


@pytest.mark.parametrize("count", [8, 12, 14])
def test_longer_lists_make_a_rational_lens_and_come_back(count):
    d = np.arange(1, count + 1) / 100
    lens = lens_from_opencv(d)
    assert isinstance(lens, RationalLens)
    assert (lens.k, lens.p) == ((0.01, 0.02, 0.05, 0.06, 0.07, 0.08), (0.03, 0.04))
    assert lens.opencv_coefficients().tolist() == d.tolist()
    assert lens_from_opencv([0.1, 0.2, 0, 0, 0, *[0.0] * (count - 5)]) == Lens((0.1, 0.2))


WIDE = [
    RationalLens((0.3, 0.05, 0.0, 0.6, 0.1, 0.01), (0.001, -0.002)),
    RationalLens((0.3,), s=(0.001, 0.0, 0.002, 0.0), tilt=(0.01, -0.02)),
    FisheyeLens((0.05, -0.01, 0.002, 0.0)),
]


@pytest.mark.parametrize("lens", WIDE)
@pytest.mark.parametrize("name", ["camera.json", "camera.yml"])
def test_wide_lenses_come_back_bit_for_bit(tmp_path, lens, name):
    write_camera(replace(CAMERA, lens=lens), tmp_path / name)
    assert read_camera(tmp_path / name).lens == lens


@pytest.mark.parametrize("lens", WIDE)
def test_wide_lenses_have_ros_names(tmp_path, lens):
    (tmp_path / "camera.yaml").write_text(ros_yaml(CameraInfo(replace(CAMERA, lens=lens))))
    named = "equidistant" if isinstance(lens, FisheyeLens) else "rational_polynomial"
    assert f"distortion_model: {named}\n" in (tmp_path / "camera.yaml").read_text()
    assert read_camera_info(tmp_path / "camera.yaml").camera.lens == lens


def test_opencv_reads_a_rational_camera_and_sees_what_it_sees(tmp_path):
    camera = replace(CAMERA, G=np.eye(4), lens=WIDE[1])
    write_camera(camera, tmp_path / "camera.yml")
    storage = cv2.FileStorage(str(tmp_path / "camera.yml"), cv2.FILE_STORAGE_READ)
    K, d = (storage.getNode(key).mat() for key in ("camera_matrix", "distortion_coefficients"))
    storage.release()
    W = np.random.default_rng(0).uniform([-1, -1, 3], [1, 1, 4], (30, 3))
    theirs = cv2.projectPoints(W, np.zeros(3), np.zeros(3), K, d)[0].reshape(-1, 2)
    assert np.allclose(camera.project(W), theirs, rtol=0, atol=1e-9)


# --- ROS ------------------------------------------------------------------------------------


def test_ros_camera_info_comes_back_bit_for_bit(tmp_path):
    R = rotation_from_vector([0.01, 0.02, -0.03])
    P = np.array([[800.0, 0, 320, -8e4], [0, 800, 240, 0], [0, 0, 1, 0]])
    (tmp_path / "left.yaml").write_text(ros_yaml(CameraInfo(CAMERA, "narrow_stereo/left", R, P)))
    info = read_camera_info(tmp_path / "left.yaml")
    assert same_camera(info.camera, CAMERA)
    assert info.name == "narrow_stereo/left"
    assert np.array_equal(info.rectification, R)
    assert np.array_equal(info.projection, P)
    assert same_camera(read_camera(tmp_path / "left.yaml"), CAMERA)


def test_ros_tools_see_numbers_where_we_wrote_numbers(tmp_path):
    # They read with PyYAML, which takes 1e-05 for text.
    (tmp_path / "left.yaml").write_text(ros_yaml(CameraInfo(CAMERA)))
    keys = yaml.safe_load((tmp_path / "left.yaml").read_text())
    assert keys["camera_matrix"] == {"rows": 3, "cols": 3, "data": CAMERA.A.ravel().tolist()}
    assert keys["distortion_coefficients"]["data"] == [-0.25, 1e-7, -1e-4, 2e-3, 0.03]
    assert keys["rectification_matrix"]["data"] == np.eye(3).ravel().tolist()
    assert keys["projection_matrix"]["data"] == (CAMERA.A @ np.eye(3, 4)).ravel().tolist()
    assert keys["projection_matrix"]["cols"] == 4
    assert keys["distortion_model"] == "plumb_bob"
    assert keys["camera_name"] == "camera"


def test_a_ros_name_cannot_carry_more_than_a_name(tmp_path):
    with pytest.raises(CvnotesError, match="plain text without quotes"):
        (tmp_path / "left.yaml").write_text(ros_yaml(CameraInfo(CAMERA, 'x"\nevil: 1')))


ROS = """\
image_width: 640
image_height: 480
camera_name: left
camera_matrix: {rows: 3, cols: 3, data: [800, 0, 320, 0, 800, 240, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}
"""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("plumb_bob", "double_sphere", "the lens model 'double_sphere' is not one of ours"),
        ("rows: 3", "rows: 2", "camera_matrix: expected 2×3 values in data, got 9"),
        ("cols: 3", "cols: -3", "camera_matrix: expected 3×-3 values"),
        ("800, 0, 320", "800, 0, .nan", r"camera_matrix.data\[2\]: expected a number, got '.nan'"),
        ("800, 0, 320", '"800", 0, 320', r"camera_matrix.data\[0\]: expected a number"),
        ("800, 0, 320", "0, 0, 320", "alpha_u = 0 but must be positive"),
        ("cols: 5, data: [0, 0, 0, 0, 0]", "cols: 3, data: [0, 0, 0]", "4 or 5 coefficients"),
        ("image_width: 640\n", "", "the key 'image_width' is missing"),
        ("image_width: 640", "image_width: 640.5", "image_width: expected a whole number"),
        ("camera_name: left", "image_width: 3", "line 3: a key that is repeated"),
        ("camera_name: left", "camera_name: [a]", "camera_name: expected a text"),
        ("camera_name: left", "camera_name: &a left", "anchors and aliases are not read"),
        ("camera_name: left", "camera_name: *a", "anchors and aliases are not read"),
        ("camera_name: left", "camera_name: !!python/name:os.system", "the tag .* is not read"),
        ("camera_name: left", "camera_name: " + "[" * 100, "nested more than 16 deep"),
        ("camera_name: left", "camera_name: [", "not valid YAML at line"),
        ("camera_name: left", "---", "more than one document"),
        ("camera_name: left", "camera_name: \x07", "not valid YAML"),
    ],
)
def test_a_wrong_yaml_is_refused_with_key_or_line(saved, old, new, message):
    assert read_camera(saved("good.yaml", ROS)).A[0, 0] == 800
    with pytest.raises(FileError, match=message):
        read_camera(saved("camera.yaml", ROS.replace(old, new, 1)))


def test_a_python_tag_executes_nothing(saved, tmp_path):
    bait = tmp_path / "executed"
    for tag in (
        "!!python/object/apply:os.mkdir",
        "!<tag:yaml.org,2002:python/object/new:os.mkdir>",
    ):
        with pytest.raises(FileError, match="is not read"):
            read_camera(saved("camera.yml", f"camera_matrix: {tag} ['{bait}']\n"))
    assert not bait.exists()


def test_a_billion_laughs_are_refused_at_once(saved):
    lines = ["a0: &a0 [lol]"] + [
        f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 12)
    ]
    start = time.process_time()
    with pytest.raises(FileError, match="anchors and aliases are not read"):
        read_camera(saved("camera.yml", "\n".join(lines)))
    assert time.process_time() - start < 5  # expanded, they would never end


def test_xml_is_not_taken_for_yaml(saved):
    text = '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/passwd">]><x>&e;</x>'
    with pytest.raises(FileError, match=r"expected keys and values|not valid YAML"):
        read_camera(saved("camera.yml", text))


# --- whole or not at all --------------------------------------------------------------------


def test_a_set_of_files_is_written_with_its_folders(tmp_path):
    contents = {tmp_path / "ö" / "a.txt": b"1", tmp_path / "ö" / "deep" / "b.txt": b"2"}
    write_whole(contents)
    assert {path: path.read_bytes() for path in contents} == contents
    assert len(list((tmp_path / "ö").iterdir())) == 2


@posix
@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda path: path.mkdir(), "it is a folder"),
        (lambda path: os.mkfifo(path), "it is not a regular file"),
        (lambda path: path.symlink_to("/dev/full"), "it is not a regular file"),
    ],
    ids=["folder", "pipe", "device"],
)
def test_what_must_not_be_replaced_is_not(tmp_path, make, reason):
    make(tmp_path / "target")
    with pytest.raises(FileError, match=rf"target cannot be written: {reason}"):
        write_whole({tmp_path / "other": b"x", tmp_path / "target": b"x"})
    assert [path.name for path in tmp_path.iterdir()] == ["target"]


def test_a_link_is_followed_not_replaced(tmp_path):
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to("real")
    write_whole({tmp_path / "link": b"new"})
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def test_a_read_only_file_or_a_file_for_a_folder_is_said(tmp_path, monkeypatch):
    (tmp_path / "file").write_bytes(b"old")
    with pytest.raises(FileError, match=r"cannot be written: (Not a directory|File exists)"):
        write_whole({tmp_path / "file" / "x": b"new"})
    monkeypatch.setattr(os, "access", lambda *_: False)  # for root everything is writable
    with pytest.raises(FileError, match="cannot be written: it is read-only"):
        write_whole({tmp_path / "file": b"new"})
    assert (tmp_path / "file").read_bytes() == b"old"


@pytest.mark.parametrize("broken", ["fsync", "replace"])
@pytest.mark.parametrize(
    "how", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()]
)
def test_an_interrupted_write_leaves_the_old_file_and_no_other(tmp_path, monkeypatch, broken, how):
    def fail(*_):
        raise how

    target = tmp_path / "calibration.json"
    write_whole({target: b"old"})
    monkeypatch.setattr(os if broken == "fsync" else Path, broken, fail)
    expected = FileError if isinstance(how, OSError) else KeyboardInterrupt
    with pytest.raises(expected, match="No space left" if isinstance(how, OSError) else None):
        write_whole({target: b"new", tmp_path / "second": b"new"})
    assert target.read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == ["calibration.json"]


@posix
def test_a_real_full_disk_is_reported(tmp_path):
    code = """
        import resource, signal
        from pathlib import Path
        from cvnotes.files import write_whole
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
        write_whole({Path("small"): b"x"})
        write_whole({Path("large"): b"x" * 5000})
    """
    run = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert re.search(r"FileError: large cannot be written: File too large", done.stderr)
    assert [path.name for path in tmp_path.iterdir()] == ["small"]


@posix
def test_an_interrupt_in_the_middle_of_writing_leaves_no_temporary_file(tmp_path):
    code = """
        import os, signal, sys
        from pathlib import Path
        from cvnotes.files import write_whole
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's & had it ignored
        written = os.fsync
        def interrupted(handle):
            written(handle)
            os.kill(os.getpid(), signal.SIGINT)
        os.fsync = interrupted
        write_whole({Path("a"): b"x", Path("b"): b"x"})
    """
    run = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == -signal.SIGINT
    assert not list(tmp_path.iterdir())


@posix
def test_the_next_run_clears_away_what_a_killed_one_left_but_not_what_is_being_written(tmp_path):
    code = """
        import os, sys, time
        from pathlib import Path
        from cvnotes.files import write_whole
        def stuck(handle):
            print("here", flush=True)
            time.sleep(900)
        os.fsync = stuck
        write_whole({Path(sys.argv[1]): b"x"})
    """
    run = [sys.executable, "-c", textwrap.dedent(code)]
    pipe = {"cwd": tmp_path, "stdout": subprocess.PIPE, "text": True}
    with (
        subprocess.Popen([*run, "killed"], **pipe) as killed,
        subprocess.Popen([*run, "busy"], **pipe) as busy,
    ):
        assert killed.stdout.readline() == busy.stdout.readline() == "here\n"
        killed.kill()
        killed.wait()
        assert len(list(tmp_path.glob(".cvnotes-*.tmp"))) == 2
        write_whole({tmp_path / "next": b"y"})
        assert len(list(tmp_path.glob(".cvnotes-*.tmp"))) == 1
        busy.kill()
    write_whole({tmp_path / "next": b"z"})
    assert [path.name for path in tmp_path.iterdir()] == ["next"]


@pytest.mark.skipif(writing.fcntl is None, reason="there are no locks on Windows")
def test_what_was_left_empty_is_cleared_away_at_once_and_a_new_file_survives_that(
    tmp_path, monkeypatch
):
    (tmp_path / ".cvnotes-left.tmp").touch()  # killed before the first byte
    writing.check_folder(tmp_path)
    assert not list(tmp_path.iterdir())
    flock, cleared = writing.fcntl.flock, []

    def late(stream, how):  # another run looks in before the lock is there
        if not cleared:
            cleared.append(Path(stream.name))
            Path(stream.name).unlink()
        flock(stream, how)

    monkeypatch.setattr(writing.fcntl, "flock", late)
    write_whole({tmp_path / "next": b"y"})
    assert (tmp_path / "next").read_bytes() == b"y"
    assert cleared


@pytest.mark.parametrize("without", ["a module", "a folder that can"])
def test_where_nothing_locks_what_was_left_is_cleared_away_after_an_hour(
    tmp_path, monkeypatch, without
):
    class Refusing:
        LOCK_EX = LOCK_NB = 0

        @staticmethod
        def flock(*_):
            raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(writing, "fcntl", None if without == "a module" else Refusing)
    for name, minutes in (("busy", 59), ("left", 61)):
        path = tmp_path / f".cvnotes-{name}.tmp"
        path.write_bytes(b"half")
        os.utime(path, (time.time() - 60 * minutes,) * 2)
    write_whole({tmp_path / "next": b"y"})
    assert sorted(path.name for path in tmp_path.iterdir()) == [".cvnotes-busy.tmp", "next"]


@pytest.mark.parametrize("path", [None, 5, b"camera.json", ["camera.json"]])
@pytest.mark.parametrize(
    "door", [read_camera, read_photo, read_calibration, partial(write_camera, Camera(np.eye(3)))]
)
def test_what_is_no_path_is_refused_in_words(door, path):
    with pytest.raises(InputTypeError, match="expected a file's path, as a text or pathlib"):
        door(path)


def test_one_path_is_not_taken_for_the_letters_of_its_name(tmp_path):
    photos, rejected = read_photos(str(tmp_path / "nothing.png"))
    assert not photos
    assert [item.file for item in rejected] == [str(tmp_path / "nothing.png")]
