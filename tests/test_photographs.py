"""What is measured in real photographs; `conftest.py` says when these tests are collected.

OpenCV's 26 stereo example pictures: 13 of each camera, a board of 9 × 6 corners of 30 mm; and
photographs through a wide lens and a fisheye.
"""

import json
from dataclasses import replace
from itertools import chain

import cv2
import numpy as np
import pytest
from conftest import PHOTOGRAPHS
from opencv_finders import find_classic, find_sb
from test_stereo import (
    photographed_rig,  # noqa: F401
    test_rectified_rows_of_the_photographs_agree,  # noqa: F401
    test_the_published_rig_is_found_in_its_photographs,  # noqa: F401
    test_triangulated_squares_of_the_photographs_have_their_true_side,  # noqa: F401
)

from cvnotes.commands.cli import main
from cvnotes.files import read_camera, read_photo
from cvnotes.photographs import calibrate_photographs
from cvnotes.photographs.driver import calibrate_detected, chessboard, detect_photographs
from cvnotes.photographs.reasons import Exchanged
from cvnotes.pictures import course
from cvnotes.targets import Chessboard, find_corners
from cvnotes.targets.finding import count_corners
from cvnotes.targets.lattice import handedness, measured

pytestmark = pytest.mark.slow

BOARD = Chessboard((9, 6), 30.0)
SIDES = ("left", "right")


def corners_of(kept, find):
    """Measure the corners (2, 13, 54, 2) in the photographs."""
    return np.array(
        [
            [find(read_photo(PHOTOGRAPHS / f"{side}{n}.jpg").image) for n in kept.names]
            for side in SIDES
        ]
    )


@pytest.fixture(scope="module")
def photographed():
    """Corners (2, 13, 54, 2), measured now; the tests of `test_stereo` above are given these."""
    kept = course.real_corners()
    assert kept.board == BOARD
    return corners_of(kept, lambda image: find_corners(image, BOARD))


def test_the_committed_corners_are_those_measured_in_the_photographs():
    kept = course.real_corners()

    def from_where_opencv_leads(image):
        return measured(image, find_sb(image, BOARD.corners).reshape(6, 9, 2))

    corners = corners_of(kept, from_where_opencv_leads)
    np.testing.assert_allclose(corners, [kept.left, kept.right], atol=5e-3)


def test_who_led_to_a_corner_hardly_matters(photographed):
    # Half-way between two pixels, the window may be laid around the one or the other.
    kept = course.real_corners()
    apart = np.abs(photographed - [kept.left, kept.right]).max(-1)
    assert apart.max() < 0.1
    assert np.quantile(apart, 0.97) < 5e-3


@pytest.mark.parametrize(
    ("side", "alpha_u", "alpha_v"), [("left", 533.004, 533.153), ("right", 536.983, 536.569)]
)
def test_thirteen_of_thirteen_calibrate_as_published(photographed, side, alpha_u, alpha_v):
    m = photographed[SIDES.index(side)]
    assert len(m) == 13
    rms_per_point, A, *_ = cv2.calibrateCamera(
        [BOARD.points.astype(np.float32)] * 13,
        [x.astype(np.float32) for x in m],
        (640, 480),
        None,
        None,
        flags=cv2.CALIB_FIX_K3,
    )
    assert rms_per_point < 0.17
    assert abs(A[0, 0] - alpha_u) < 0.5
    assert abs(A[1, 1] - alpha_v) < 0.5


def test_the_origin_stays_on_the_same_corner_of_the_board(photographed):
    # The board is held upright or turned to its left, never upside down.
    for side, corners in zip(SIDES, photographed, strict=True):
        for n, m in zip(course.real_corners().names, corners.reshape(-1, 6, 9, 2), strict=True):
            image = read_photo(PHOTOGRAPHS / f"{side}{n}.jpg").image
            assert handedness(m) > 0
            outside = np.rint(m[0, 0] + 0.2 * (2 * m[0, 0] - m[0, 1] - m[1, 0])).astype(int)
            beside = np.rint(m[0, 0] + 0.2 * (m[0, 1] - m[1, 0])).astype(int)
            assert image[tuple(outside[::-1])] < image[tuple(beside[::-1])] - 50


def test_the_command_finds_the_published_camera(tmp_path):
    photos = sorted(PHOTOGRAPHS.glob("left*.jpg"))
    options = ["--corners", "9x6", "--square", "30", "--out", str(tmp_path)]
    options += ["--board-shape", "flat"]  # as for whoever published it
    assert main(["calibrate", *map(str, photos), *options]) == 0
    keys = json.loads((tmp_path / "calibration.json").read_text())
    assert (len(keys["views"]), keys["rejected"]) == (13, [])
    assert keys["camera_matrix"][0][0] == pytest.approx(533.00, abs=0.5)
    assert keys["camera_matrix"][1][1] == pytest.approx(533.15, abs=0.5)
    assert keys["rms"] <= 0.19


def test_opencvs_own_example_is_read():
    camera = read_camera(PHOTOGRAPHS / "left_intrinsics.yml")
    assert camera.A[0, 0] == 5.3591573396163199e02
    assert camera.lens.k[2] == 2.3839153080878486e-01
    assert camera.lens.p == (1.7831947042852964e-03, -2.8122100441115472e-04)
    assert camera.size == (640, 480)


@pytest.mark.parametrize("n", range(1, 14, 3))
def test_the_count_is_seen_though_eight_corners_are_hidden(n):
    path = sorted(PHOTOGRAPHS.glob("left*.jpg"))[n - 1]
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    m = find_corners(image, BOARD)
    radius = int(0.35 * np.linalg.norm(m[1] - m[0]))
    for u, v in np.rint(np.random.default_rng(n).choice(m, 8, replace=False)).astype(int).tolist():
        cv2.circle(image, (u, v), radius, 150, -1, cv2.LINE_AA)
    assert count_corners(image) == BOARD.corners


@pytest.mark.parametrize(
    ("name", "corners", "found"),
    [
        ("wide", (8, 6), 17),
        ("fisheye", (6, 4), 13),
        ("sony", (6, 4), 13),
        ("depth", (9, 6), 21),
        ("left_right", (9, 6), 26),
    ],
)
def test_every_photograph_in_which_one_of_opencvs_finders_finds_the_board(name, corners, found):
    files = sorted((PHOTOGRAPHS.parent / name).glob("*.[jp][pn]g"))
    board, n = Chessboard(corners, 30.0, half_turn_symmetric=True), 0
    for file in files:
        image = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
        looks = (find(image, corners) for find in (find_classic, find_sb))  # asked if needed
        near = (m for m in looks if m is not None)
        if (first := next(near, None)) is None:
            continue
        m = find_corners(image, board)
        # the classic finder may be off by that much itself
        assert any(
            np.linalg.norm(m[:, None] - other, axis=-1).min(1).max() < 5.0
            for other in chain([first], near)
        )
        n += 1
    assert n == found


def test_the_one_steep_photograph_of_a_set_is_honest():
    found = calibrate_photographs(PHOTOGRAPHS.parent / "sony", chessboard((6, 4), 30.0))
    assert len(found.photographs.used) == 13
    assert found.reliable
    assert abs(found.camera.A[0, 2] - 308.5) < 5


@pytest.mark.parametrize("which", [(2, 3, 5, 8, 11, 13, 14, 15), (4, 5, 6, 8, 11, 14, 18)], ids=str)
def test_another_kind_of_lens_is_not_hidden_by_the_board(which):
    """A flat board spoke for k1 k2, 0.34 px from photographs left out; or for a lens that folds."""
    folder = PHOTOGRAPHS.parent / "depth"
    photos = [folder / f"left{i}.png" for i in which]
    found = calibrate_photographs(photos, chessboard((9, 6), 25.0))
    assert (found.calibration.choice.lens, found.calibration.choice.board) == ("fisheye", "free")
    assert found.camera.is_invertible


@pytest.mark.parametrize("mirrored", [(2, 8, 10), (8, 9, 10, 11, 12)])
def test_a_telephone_nearly_its_own_mirror_accuses_no_honest_photograph(mirrored):
    board = chessboard((6, 4), 30.0)
    seen = detect_photographs(PHOTOGRAPHS.parent / "sony", board)
    photos = list(seen.looked_at)
    for i in mirrored:
        m = photos[i].corners.reshape(4, 6, 2)[::-1].reshape(-1, 2)
        photos[i] = replace(photos[i], corners=m * [-1, 1] + [seen.size[0] - 1, 0])
    found = calibrate_detected(replace(seen, looked_at=photos))
    assert not found.reliable
    accused = [i for i, x in enumerate(found.photographs.looked_at) if x.reason == Exchanged()]
    assert {*accused} <= {*mirrored}
