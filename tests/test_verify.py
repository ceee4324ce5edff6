"""One table holds every estimate against the truth, and raises when one is off."""

import re

import numpy as np
import pytest

from cvnotes.base import CvnotesError, InputTypeError, ShapeError
from cvnotes.calibration import calibrate
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.learn import NotVerified, personal_camera, verify

CAMERA = Camera(
    intrinsics(800, 804, 325, 238),
    pose(rotation_from_vector([0.1, 0.2, 0.3]), [10, 20, 500]),
    Lens(k=(-0.25, 0.1)),
)


def test_what_is_equal_up_to_rounding_holds_and_shows_no_digits_of_rounding():
    H = np.array([[2.0, 0.5, 3.0], [0.1, 1.0, 4.0], [0.01, 0.02, 1.0]])
    first = repr(verify(H + 1e-13, H, name="H"))
    assert first == repr(verify(H - 3e-12, H, name="H"))
    assert "rounding" in first
    assert "H[1, 2]" in first
    assert "✓ holds" in first


def test_one_wrong_entry_raises_with_the_table_as_its_message():
    with pytest.raises(NotVerified) as caught:
        verify([1.0, 2.5], [1.0, 2.0], tolerance=0.1, name="x", unit="px")
    lines = str(caught.value).splitlines()
    assert lines[0] == "1 of 2 off: x[1]"
    assert re.fullmatch(r"x\[0\] \(px\) +1.00 +1.00 +\+0.00 +≤ 0.1 +✓ holds", lines[2])
    assert re.fullmatch(r"x\[1\] \(px\) +2.50 +2.00 +\+0.5 +≤ 0.1 +✗ off", lines[3])


def test_the_error_is_estimate_minus_truth():
    [row] = verify(3.0, 3.1, tolerance=0.2).rows
    assert row.error == pytest.approx(-0.1, abs=1e-12)


def test_the_tolerance_itself_still_holds():
    assert verify(1.25, 1.0, tolerance=0.25)
    with pytest.raises(NotVerified):
        verify(1.2500001, 1.0, tolerance=0.25)


def test_errors_up_to_four_standard_deviations_hold():
    assert verify(10.39, 10.0, std=0.1)
    with pytest.raises(NotVerified, match=r"± 0\.1"):
        verify(10.41, 10.0, std=0.1)


def test_a_calibration_is_held_against_its_camera_with_its_own_error_bars():
    own = personal_camera("demo")
    result = calibrate(own.board.points, own.corners, own.size)
    table = verify(result, own.truth())
    assert [row.name for row in table.rows] == ["alpha_u", "alpha_v", "u0", "v0", "k1", "k2"]
    assert [row.std for row in table.rows] == list(result.std.values())
    assert "alpha_u (px)" in repr(table)
    wrong = Camera(intrinsics(1.1 * own.truth().A[0, 0], own.truth().A[1, 1], 320, 240))
    with pytest.raises(NotVerified, match="alpha_u"):
        verify(result, wrong)
    with pytest.raises(NotVerified, match="off: alpha_u, alpha_v"):
        verify(result, own.truth(), tolerance=1e-6)


def test_a_camera_is_compared_with_its_pose_and_lens():
    moved = CAMERA.moved(pose(CAMERA.R, CAMERA.T + [0, 0, 1.0]))
    with pytest.raises(NotVerified, match="centre"):
        verify(moved, CAMERA, tolerance=0.1)
    assert len(verify(CAMERA, CAMERA).rows) == 13
    with pytest.raises(NotVerified, match="off: k2"):
        verify(Lens(k=(-0.25, 0.2)), CAMERA.lens, tolerance=0.01)


def test_a_coefficient_that_the_truth_does_not_have_is_zero_there():
    assert verify(Lens(k=(0.0, 0.0)), Lens())
    with pytest.raises(NotVerified):
        verify(Lens(k=(0.0, 0.1)), Lens(k=(0.0,)))


def test_scale_and_sign_are_left_out_only_where_asked():
    H = np.array([[2.0, 0.5, 3.0], [0.1, 1.0, 4.0], [0.01, 0.02, 1.0]])
    assert verify(-7 * H, H, up_to_scale=True)
    with pytest.raises(NotVerified):
        verify(-7 * H, H)
    with pytest.raises(NotVerified):
        verify(H.T, H, up_to_scale=True)
    with pytest.raises(CvnotesError, match="no scale"):
        verify(np.zeros((3, 3)), H, up_to_scale=True)


def test_points_without_an_image_agree_only_with_such():
    behind = CAMERA.project([[0.0, 0, -5000], [0, 0, 0]])
    assert np.isnan(behind[0]).all()
    assert "none" in repr(verify(behind, behind, name="m"))
    with pytest.raises(NotVerified):
        verify(np.nan_to_num(behind), behind)
    with pytest.raises(NotVerified):
        verify([np.nan, 1.0], [1.0, 1.0], tolerance=1e9)


def test_of_many_numbers_the_worst_is_shown():
    true = np.arange(40.0).reshape(20, 2)
    found = true + 0.01
    found[7, 1] += 0.03
    [row] = verify(found, true, tolerance=0.1, name="m").rows
    assert row.name == "m (worst of 40)"
    assert (row.truth, round(row.error, 6)) == (15.0, 0.04)
    found[3, 0] = np.nan
    with pytest.raises(NotVerified, match="worst of 40"):
        verify(found, true, tolerance=0.1, name="m")
    [exact] = verify(true, true, name="m").rows
    assert exact.name == "m (all 40)"


def test_mappings_are_compared_by_name():
    assert verify({"f": 2.0}, {"g": 7.0, "f": 2.0})
    with pytest.raises(CvnotesError, match="'f' is estimated, but the truth has only g"):
        verify({"f": 2.0}, {"g": 2.0})
    table = verify({"f": 2.0, "x": [1.0, 2.0]}, {"f": 2.1, "x": [1, 2]}, std={"f": 0.1, "x": 0.1})
    assert [row.name for row in table.rows] == ["f", "x[0]", "x[1]"]


def test_what_does_not_belong_together_is_refused_in_words():
    with pytest.raises(ShapeError, match=r"H has shape \(2,\), the truth \(3,\)"):
        verify([1.0, 2.0], [1.0, 2.0, 3.0], name="H")
    with pytest.raises(InputTypeError, match="expected numbers, got str"):
        verify("1", 1.0)
    with pytest.raises(InputTypeError, match="expected numbers, got NoneType"):
        verify(None, 1.0)


@pytest.mark.parametrize(
    ("estimate", "truth", "tolerance", "shown"),
    [
        (812.3456, 812.3, 0.1, "812.35"),
        (-0.249961, -0.25, 0.001, "-0.2500"),
        (-1e-17, 0.0, 1e-9, "0.0000"),
        (12345.678, 12345.0, 2.0, "12346"),
        (0.00123, 0.0012, 0.0001, "0.00123"),
    ],
)
def test_numbers_are_rounded_to_what_is_meant(estimate, truth, tolerance, shown):
    [row] = verify(estimate, truth, tolerance=tolerance).rows
    assert row.cells()[1] == shown


def test_the_page_says_the_verdict_in_words_and_escapes_names():
    html = verify(1.0, 1.0, name="<b>")._repr_html_()
    assert "&lt;b&gt;" in html
    assert "✓ holds" in html
    assert "<caption>verified" in html
