"""One table holds every estimate against the truth, and raises when one is off."""

import re

import pytest

from cvnotes.base import CvnotesError, InputTypeError
from cvnotes.calibration import calibrate
from cvnotes.learn import NotVerified, personal_camera, verify


def one(estimate, truth, std):
    return verify({"f": estimate}, {"f": truth}, std={"f": std})


def test_one_wrong_number_raises_with_the_table_as_its_message():
    with pytest.raises(NotVerified) as caught:
        verify({"u0": 1.0, "x": 2.5}, {"u0": 1, "x": 2}, std={"u0": 0.1, "x": 0.1})
    lines = str(caught.value).splitlines()
    assert lines[0] == "1 of 2 off: x"
    assert re.fullmatch(r"u0 \(px\) +1.00 +1.00 +\+?0.00 +± 0.1 +✓ holds", lines[2])
    assert re.fullmatch(r"x +2.50 +2.00 +\+0.5 +± 0.1 +✗ off", lines[3])


def test_the_error_is_estimate_minus_truth():
    [row] = one(3.0, 3.1, 0.1).rows
    assert row.error == pytest.approx(-0.1, abs=1e-12)


def test_errors_up_to_four_standard_deviations_hold():
    assert one(1.5, 1.0, 0.125)
    with pytest.raises(NotVerified, match=r"± 0\.12"):
        one(1.5000001, 1.0, 0.125)
    assert one(1.0, 1.0, 0.0)


def test_a_calibration_is_held_against_its_camera():
    own = personal_camera("demo")
    result = calibrate(own.board.points, own.corners, own.size)
    table = verify(result.parameters, own.truth().parameters, std=result.std)
    assert [row.name for row in table.rows] == ["alpha_u", "alpha_v", "u0", "v0", "k1", "k2"]
    assert [row.std for row in table.rows] == list(result.std.values())
    assert "alpha_u (px)" in repr(table)
    wrong = own.truth().parameters | {"alpha_u": 1.1 * own.truth().A[0, 0]}
    with pytest.raises(NotVerified, match="off: alpha_u"):
        verify(result.parameters, wrong, std=result.std)


def test_what_does_not_belong_together_is_refused_in_words():
    assert verify({"f": 2.0}, {"g": 7.0, "f": 2.0}, std={"f": 0.1})
    with pytest.raises(CvnotesError, match="truth: expected 'f' too, got only g"):
        verify({"f": 2.0}, {"g": 2.0}, std={"f": 0.1})
    with pytest.raises(CvnotesError, match="std: expected 'f' too"):
        verify({"f": 2.0}, {"f": 2.0}, std={})
    with pytest.raises(InputTypeError, match=r"estimated: expected numbers by name.*got float"):
        verify(1.0, 1.0, std=0.1)
    with pytest.raises(InputTypeError, match="f: expected"):
        one("1", 1.0, 0.1)


@pytest.mark.parametrize(
    ("estimate", "truth", "std", "shown"),
    [
        (812.3456, 812.3, 0.1, "812.35"),
        (-0.249961, -0.25, 0.001, "-0.2500"),
        (-1e-17, 0.0, 1e-4, "0.00000"),
        (12345.678, 12345.0, 2.0, "12345.7"),
        (0.00123, 0.0012, 0.0001, "0.00123"),
    ],
)
def test_numbers_are_rounded_to_what_is_meant(estimate, truth, std, shown):
    [row] = one(estimate, truth, std).rows
    assert row.cells()[1] == shown


def test_the_page_says_the_verdict_in_words_and_escapes_names():
    html = verify({"<b>": 1.0}, {"<b>": 1.0}, std={"<b>": 0.1})._repr_html_()
    assert "&lt;b&gt;" in html
    assert "✓ holds" in html
    assert "<caption>verified" in html
