"""Figures of estimates: each panel says of each set of views what its calibration says."""

from dataclasses import replace

import numpy as np
import pytest
from public_face import RESULT, W

from cvnotes.base import InputTypeError
from cvnotes.show import ESTIMATED, LENS, draw_plane_error, draw_view_families

ALPHA = float(RESULT.A[0, 0])


def medians(ax):
    """Return the thick lines: of each family its dots, their median and the promise are drawn."""
    return ax.lines[1::3]


def colours(ax):
    return [line.get_color() for line in medians(ax)]


def test_families_stand_side_by_side_with_all_their_repetitions_and_the_error_to_be_expected():
    A = RESULT.A.copy()
    A[0, 0] *= 1.2
    doubtful = replace(RESULT, A=A, reliable=False, rms=2 * RESULT.rms)
    assert RESULT.reliable
    results = {"good": [RESULT, RESULT], "bad": [doubtful, doubtful, RESULT]}
    boards, right = axes = draw_view_families(results, W, truth=ALPHA / 1.25)
    rms = f"{RESULT.rms:.2f}", f"{2 * RESULT.rms:.2f}"
    names = [f"{name}\nRMS {x} px" for name, x in zip(("good", "bad"), rms, strict=True)]
    assert [t.get_text() for t in boards.get_yticklabels()] == names
    frame, first = boards.patches[0].get_xy(), boards.patches[1].get_xy()[:-1:16]
    corners = W[[np.lexsort((b * W[:, 1], a * W[:, 0]))[0] for a, b in ((1, 1), (-1, 1))]]
    seen = RESULT.camera.moved(RESULT.poses[0]).project(corners)
    assert np.allclose(first[:2], frame[0] + (seen + 0.5) * 0.9 / 480)
    axes[0].figure.draw_without_rendering()
    words, strip = right.texts[2].get_window_extent(), right.get_window_extent()
    assert strip.x0 < words.x0 < words.x1 < strip.x1
    assert [t.get_text() for t in right.get_xticklabels()][1:-1:3] == ["0.001", "1", "1000"]
    assert len(boards.patches) == 2 * (1 + len(RESULT.poses))
    assert boards.yaxis_inverted()  # the first family on top
    shown = [line.get_xdata() for line in medians(right)]
    assert np.allclose(shown, [[25.0, 25.0], [50.0, 50.0]], atol=0.01)
    assert colours(right) == [ESTIMATED, ESTIMATED]  # such errors were never promised
    assert [t.get_text() for t in right.texts] == [
        " median", "promised ", "25.00 %,\nnot as promised",
        "", "", "50.00 %,\nnot as promised",
    ]  # fmt: skip
    std = RESULT.std["alpha_u"]
    near = draw_view_families({"kept": [RESULT]}, W, truth=RESULT.A[0, 0] - 1.9 * std)[1]
    far = draw_view_families({"broken": [RESULT]}, W, truth=RESULT.A[0, 0] - 2.1 * std)[1]
    assert (colours(near), colours(far)) == ([LENS], [ESTIMATED])
    dots, _, promise = right.lines[:3]
    assert np.allclose(dots.get_xdata(), 25)
    assert np.allclose(promise.get_xdata(), 0.674 * 125 * RESULT.std["alpha_u"] / ALPHA)
    assert right.get_xscale() == "log"
    assert right.get_xlabel() == "error of the focal length (%)"


def test_what_is_no_calibration_is_refused_by_its_name():
    with pytest.raises(InputTypeError, match=r"results: expected a Mapping, got list"):
        draw_view_families([RESULT], W, truth=800)
    with pytest.raises(InputTypeError, match=r"results\['a'\]: expected a list of calibrations"):
        draw_view_families({"a": RESULT}, W, truth=800)
    with pytest.raises(InputTypeError, match=r"results\['a'\]: expected a Calibration, got str"):
        draw_view_families({"a": ["left.json"]}, W, truth=800)


def test_an_arrow_leads_from_the_truth_to_the_prediction_ten_times_as_long():
    ax = draw_plane_error([[10.0, 20], [30, 5]], [[10.5, 20], [30, 4]])
    (arrows,) = ax.collections
    assert arrows.get_offsets().tolist() == [[10, 20], [30, 5]]
    assert (arrows.U.tolist(), arrows.V.tolist()) == ([5, 0], [0, -10])
    assert not arrows.get_clip_on()
    assert ax.get_title() == "(arrows × 10)"
