"""Figures of warps, walls, clouds and lenses: everything stands where it was worked out by hand."""

import numpy as np
import pytest

from cvnotes.base import CvnotesError
from cvnotes.calibration import calibrate, prediction_std
from cvnotes.pictures import course
from cvnotes.show import (
    draw_prediction_error,
    draw_wall,
)


def test_a_wall_fills_rows_from_the_left_with_every_fourth_pixel():
    shades = [np.full((8, 16), grey, np.uint8) for grey in (10, 20, 30)]
    wall = draw_wall(shades, columns=2).images[0].get_array()
    assert wall.shape == (8, 12)  # two rows of 2 px, two columns of 4 px, and a gap of 4 px
    assert [wall[0, 0], wall[0, 8], wall[6, 0], wall[6, 8]] == [10, 20, 30, 255]


def test_maps_of_the_uncertainty_share_their_colours_where_they_are_to_be_compared():
    course_board, m = course.board(), course.measured_corners()
    colours = []
    for n in (6, 12):
        found = calibrate(course_board.points, m[:n], (640, 480))
        ax = draw_prediction_error(found, between=(0.0, 0.05))
        colours.append(ax.images[0].get_clim())
        assert ax.figure.axes == [ax]
        middle = prediction_std(found, [319.5, 239.5])
        assert float(ax.texts[2].get_text().removesuffix(" in the middle")) == pytest.approx(
            middle, rel=0.06
        )
    assert colours[0] == colours[1]
    with pytest.raises(CvnotesError, match=r"between: expected \(least, most\), got \(2, 1\)"):
        draw_prediction_error(found, between=(2, 1))
