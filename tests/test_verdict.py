"""A verdict tells good pictures from bad ones, in words, where nobody knows the truth."""

import warnings

import numpy as np
import pytest

from cvnotes.base import CvnotesError
from cvnotes.calibration import calibrate
from cvnotes.camera import Camera, intrinsics, rotation_from_vector
from cvnotes.learn import verdict
from cvnotes.pictures import course, fronto_parallel_views, good_views, hold_at

BOARD = course.board()
CAMERA = Camera(intrinsics(800, 804, 325, 238), size=(640, 480))


def in_corner(u, v):
    """Hold the board in a corner of the picture, its outer edge towards the camera."""
    R = rotation_from_vector([0.4 * (240 - v) / 240, 0.4 * (u - 320) / 240, 0])
    return hold_at(BOARD, CAMERA, R, (u, v))


IN_CORNERS = [in_corner(u, v) for u in (80, 560) for v in (60, 420)]
GOOD = [*good_views(BOARD, CAMERA, 8, rng=np.random.default_rng(5)), *IN_CORNERS]


def seen(poses, sigma=0.1):
    m = np.array([CAMERA.moved(G).project(BOARD.points) for G in poses])
    return m + np.random.default_rng(7).normal(0, sigma, m.shape)


def judged(m):
    with warnings.catch_warnings(action="ignore"):
        return verdict(calibrate(BOARD.points, m, CAMERA.size))


def bad_lines(m):
    return [words for good, words in judged(m).lines if not good]


def test_good_pictures_pass_in_every_line():
    result = judged(seen(GOOD))
    assert result
    assert len(result.lines) == 8
    assert repr(result).count("✓") == result._repr_html_().count("✓") == 8


def test_without_pictures_in_the_corners_only_that_is_said():
    [words] = bad_lines(seen(GOOD[:8]))
    assert words.startswith("no board in any of the picture")


def test_boards_that_face_the_camera_are_called_flat_and_undetermined_whatever_the_rms():
    m = seen(fronto_parallel_views(BOARD, CAMERA, 12, rng=np.random.default_rng(1)))
    lines = bad_lines(m)
    assert any("tilt the board by 30° to 45°" in words for words in lines)
    assert any("nearly parallel" in words for words in lines)
    assert not any("RMS" in words for words in lines)


def test_few_pictures_and_a_bad_one_are_named():
    m = seen(GOOD)[[0, 1, 4, 5, 8, 10]]
    m[4, 7] += 4
    lines = bad_lines(m)
    assert any(words.startswith("6 pictures only") for words in lines)
    assert any(words.startswith("the worst picture, 4,") for words in lines)


def test_a_picture_that_stands_out_is_to_be_looked_at_and_one_that_does_not_is_not():
    m = seen(GOOD)
    advised = ": look at it, or leave it out"
    assert sum(words.endswith(advised) for _, words in judged(m).lines) == 0
    m[7] += np.random.default_rng(3).normal(0, 0.4, m[7].shape)
    [words] = [words for words in bad_lines(m) if "worst" in words]
    assert words.startswith("the worst picture, 7, has ")
    assert words.endswith(f" times the usual RMS{advised}")


def test_noise_of_a_thousandth_of_the_width_is_not_normal():
    assert any("look at the residuals" in words for words in bad_lines(seen(GOOD, sigma=0.5)))


def test_the_real_bent_board_is_suspected_from_the_scatter_between_pictures():
    real = course.real_corners()
    with warnings.catch_warnings(action="ignore"):
        found = calibrate(real.board.points, real.left, real.size, lens="k1 k2 p1 p2")
    assert [words for good, words in verdict(found).lines if not good][-1].startswith(
        "the scatter between pictures is 2."
    )
    # What the result itself doubts is said as well, and then no RMS is called normal.
    assert found.reliable
    assert len(found.warnings) > 0
    assert {(False, doubt) for doubt in found.warnings} <= set(verdict(found).lines)
    assert not any("normal or better" in words for _, words in verdict(found).lines)


def test_a_result_without_corners_cannot_be_judged():
    with pytest.raises(CvnotesError, match="with its corners, got int"):
        verdict(3)
