"""Each student has a camera of their own, the same on every system and with every version."""

import hashlib

import numpy as np
import pytest

from cvnotes.base import CvnotesError
from cvnotes.calibration import calibrate
from cvnotes.camera import Camera
from cvnotes.learn import check, personal_camera
from cvnotes.learn.personal import normals, uniforms

pytestmark = pytest.mark.once


def test_these_numbers_never_change():
    own = personal_camera("s123456")
    assert own.truth().A[[0, 1, 0, 1], [0, 1, 2, 2]].tolist() == [894.0, 926.7, 305.5, 257.9]
    assert own.truth().lens.k == (-0.24, 0.05)
    assert own.board.square == 23.2
    assert own.corners[3, 7].tolist() == [403.3993, 149.9644]
    assert own.poses[9, :3, 3].tolist() == [-65.682016407, -12.888781610, 531.098322403]


def test_uniform_numbers_are_the_first_six_bytes_of_a_digest():
    digest = hashlib.sha256(b"ada/camera/1").digest()
    assert uniforms("ada", "camera", 2)[1] == int(digest.hex()[:12], 16) / 16**12


def test_the_pictures_are_the_same_each_time_and_show_the_board():
    own = personal_camera("Ada")
    photos, again = own.photos(), personal_camera("ada ").photos()
    assert all(np.array_equal(a, b) for a, b in zip(photos, again, strict=True))
    assert {photo.shape for photo in photos} == {(480, 640)}
    assert [round(float(p.mean()), 1) for p in photos[:3]] == [130.6, 126.8, 127.2]
    camera = own.truth().moved(own.poses[0])
    square = own.board.square
    dark, light = camera.project([[-square / 2, -square / 2, 0], [square / 2, -square / 2, 0]])
    grey = photos[0].astype(int)
    assert grey[tuple(np.rint(dark[::-1]).astype(int))] < 60
    assert grey[tuple(np.rint(light[::-1]).astype(int))] > 180


def test_two_ids_give_two_cameras():
    cameras = [personal_camera(f"s{i}").truth() for i in range(200)]
    values = np.array([[c.A[0, 0], c.A[1, 1], c.A[0, 2], c.A[1, 2], *c.lens.k] for c in cameras])
    assert len(np.unique(values, axis=0)) == 200
    assert (values[:, 0] >= 700).all()
    assert (values[:, 0] <= 950).all()
    assert np.ptp(values[:, 0]) > 200


def test_spelling_and_spaces_do_not_matter():
    assert personal_camera("Zoë").student == personal_camera(" ZOE\u0308 ").student
    assert personal_camera("zoe").student != personal_camera("zoë").student


def test_every_board_is_whole_in_every_picture():
    for i in range(60):
        own = personal_camera(f"student {i}")
        columns, rows = own.board.corners
        outline = np.array([[-1, -1, 0], [columns, -1, 0], [-1, rows, 0], [columns, rows, 0]])
        for G in own.poses:
            m = own.truth().moved(G).project(own.board.square * outline)
            assert (m > 3).all()
            assert (m < [636, 476]).all()


def test_the_corners_calibrate_to_the_camera_and_answer_the_exercise():
    own = personal_camera("grace")
    result = calibrate(own.board.points, own.corners, own.size)
    assert result.reliable
    assert result.A[0, 0] == pytest.approx(own.truth().A[0, 0], rel=0.01)
    assert result.rms == pytest.approx(0.2 * np.sqrt(2), rel=0.1)
    found = result.A[[0, 1, 0, 1], [0, 1, 2, 2]]
    assert check("own_camera", found, student="grace").passed
    assert not check("own_camera", found, student="ada").passed
    exchanged = check("own_camera", found[[1, 0, 2, 3]], student="Grace ")
    assert exchanged.misconception == "α_u and α_v exchanged"


def test_the_numbers_of_one_student_seldom_pass_for_another():
    A = [personal_camera(f"s{i}").truth().A[[0, 1, 0, 1], [0, 1, 2, 2]] for i in range(150)]
    near = np.abs(np.array(A)[:, None] - A).max(-1) <= 10
    assert (near.sum() - 150) / (150 * 149) < 0.02


def test_looking_at_the_object_does_not_tell_the_answer():
    own = personal_camera("ada")
    public = {name: getattr(own, name) for name in dir(own) if not name.startswith("_")}
    assert not any(isinstance(value, Camera) for value in public.values())
    assert not any(hasattr(value, "A") for value in public.values())
    assert f"{own.truth().A[0, 0]:g}" not in repr(own)
    assert own.size == own.truth().size


def test_noise_is_normal():
    noise = normals("ada", "test", 4000)
    assert noise.mean() == pytest.approx(0, abs=0.05)
    assert noise.std() == pytest.approx(1, abs=0.04)
    assert (np.abs(noise) < 1.96).mean() == pytest.approx(0.95, abs=0.012)


@pytest.mark.parametrize("student", ["", "  ", None, 7.0])
def test_an_id_is_a_text_or_a_number(student):
    with pytest.raises(CvnotesError, match="expected your id"):
        personal_camera(student)


@pytest.mark.parametrize("student", ["your id", " Your ID", "student id"])
def test_an_id_left_as_it_stands_counts_for_nothing(student):
    found = personal_camera(student).truth().A[[0, 1, 0, 1], [0, 1, 2, 2]]
    report = check("own_camera", found, student=student)
    assert not report.passed
    assert "Put your own id" in report.message
    assert check("own_camera", ..., student=student).verdict == "not solved yet"
