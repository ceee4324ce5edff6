import numpy as np
import pytest

from cvnotes.base import DegenerateError, ShapeError
from cvnotes.show import (
    ESTIMATED,
    LENS,
    draw_stretched_circle,
    draw_two_errors,
)


def test_the_arrow_of_the_smallest_singular_value_ends_nearest_to_the_origin():
    D = np.array([[3.0, 1.0], [1.0, 2.0]])
    left, right = draw_stretched_circle(D)
    arrows = [text for text in right.texts if getattr(text, "arrow_patch", None)]  # not letters
    ends = {text.arrow_patch.get_edgecolor(): np.array(text.xy) for text in arrows}
    lengths = sorted(np.linalg.norm(end) for end in ends.values())
    # The product of both half axes is the determinant, the sum of squares that of all entries.
    assert np.prod(lengths) == pytest.approx(5)
    assert np.sum(np.square(lengths)) == pytest.approx(15)
    ellipse = right.lines[0].get_xydata()
    assert np.linalg.norm(ellipse, axis=1).min() == pytest.approx(lengths[0], rel=1e-3)
    assert np.linalg.norm(left.lines[0].get_xydata(), axis=1) == pytest.approx(1)


def test_the_algebraic_error_is_the_geometric_one_at_the_depth_of_the_point():
    ax = draw_two_errors([[2.0, 4.0]], [0.75])
    gaps = {
        line.get_color(): np.ptp(line.get_ydata())
        for line in ax.lines
        if line.get_linewidth() == 4 and len(line.get_xdata())
    }
    assert gaps[ESTIMATED] == pytest.approx(0.25)
    assert gaps[LENS] == pytest.approx(1.0)


def test_points_behind_the_camera_have_no_rays():
    with pytest.raises(DegenerateError, match="behind the camera"):
        draw_two_errors([[1.0, -2.0]], [0.5])
    with pytest.raises(ShapeError, match="one number for each"):
        draw_two_errors([[1.0, 2.0]], [0.5, 0.6])
