"""Photographs in, a camera out: one function of the library, with reasons that are objects."""

from dataclasses import replace

import numpy as np
import pytest

from cvnotes.base import DegenerateError, FileError
from cvnotes.files import Photo
from cvnotes.files.reasons import Copy, OtherSize
from cvnotes.photographs import (
    Exchanged,
    LeftOut,
    Misfit,
    Model,
    NoBoard,
    NoCamera,
    calibrate_detected,
    calibrate_photographs,
    detect_photographs,
)
from cvnotes.pictures import course

BOARD = course.board()


@pytest.fixture(scope="module")
def photos():
    return course.photos()


def reasons(found):
    """Return the reasons by name."""
    return {r.file: r.reason for r in found.photographs.rejected}


@pytest.mark.slow
def test_each_reason_is_an_object_with_its_numbers(photos):
    zoomed = np.kron(photos[6][120:360, 160:480], np.ones((2, 2), np.uint8))
    given = [
        *photos[:6],
        photos[2],
        photos[7][:, :600],
        np.full_like(photos[0], 128),
        np.ascontiguousarray(photos[8][:, ::-1]),
        zoomed,
        photos[9],
    ]
    options = {"lens": "k1 k2", "board_shape": "flat", "leave_out": ["photograph 11"]}
    found = calibrate_photographs(given, BOARD, **options)
    why = reasons(found)
    assert why["photograph 6"] == Copy("photograph 2")
    assert why["photograph 7"] == OtherSize((600, 480), (640, 480))
    assert isinstance(why["photograph 8"], NoBoard)
    assert why["photograph 9"] == Exchanged()
    assert why["photograph 11"] == LeftOut()
    if "photograph 10" in why:  # a board that fills the picture may not be found at all
        assert isinstance(why["photograph 10"], Misfit | NoBoard)
    assert len(found.photographs.used) == 6
    alone = calibrate_photographs(photos[:6], BOARD, lens="k1 k2", board_shape="flat")
    np.testing.assert_array_equal(found.calibration.A, alone.calibration.A)
    assert "photograph 9: left and right seem exchanged, so" in " ".join(found.doubts)
    assert found.reliable
    assert found.next_view.after < found.next_view.before


def test_a_view_that_does_not_fit_is_left_out_with_its_numbers(photos):
    seen = detect_photographs(photos[:7], BOARD)
    last, rng = seen.looked_at[6], np.random.default_rng(0)
    badly_found = replace(last, corners=last.corners + rng.normal(0, 2, last.corners.shape))
    seen = replace(seen, looked_at=[*seen.looked_at[:6], badly_found])
    model = Model(lens="k1 k2", board_shape="flat")
    kept = calibrate_detected(seen, model, keep_all=True).calibration.view_rms
    found = calibrate_detected(seen, model)
    assert reasons(found) == {"photograph 6": Misfit(kept[6], np.median(kept))}
    assert found.photographs.looked_at[6].found is badly_found.corners
    assert found.calibration.view_rms.max() < 0.1 < 0.5 < kept[6]
    assert "does not fit the others: 2." in str(reasons(found)["photograph 6"])


def test_arrays_photographs_and_a_side_alone_do_as_well(photos):
    given = [Photo(f"{i}.png", photo) for i, photo in enumerate(photos[:3])]
    found = calibrate_photographs([*given, photos[3]], 25.0, lens="k1")
    assert found.photographs.counted
    assert found.photographs.board.corners == (9, 6)
    assert found.photographs.named()[0] == ["0.png", "1.png", "2.png", "photograph 3"]
    assert "not used" not in repr(found)


def test_what_cannot_be_says_what_was_seen(photos, tmp_path):
    wall = np.full_like(photos[0], 128)
    with pytest.raises(NoCamera, match="1 usable photographs; need at least 2 views") as error:
        calibrate_photographs([photos[0], wall], BOARD)
    assert len(error.value.photographs.used) == 1
    assert isinstance(error.value.photographs.rejected[0].reason, NoBoard)
    with pytest.raises(DegenerateError, match="no chessboard"):
        calibrate_photographs([wall], 25.0)
    with pytest.raises(FileError, match="no photographs in"):
        calibrate_photographs(tmp_path, BOARD)
    with pytest.raises(FileError, match=r"leave out b\.png: none"):
        calibrate_photographs(photos[:2], BOARD, leave_out=["b.png"])
