"""A wall of photographs: every pixel stands where it was worked out by hand."""

import numpy as np

from cvnotes.show import draw_wall


def test_a_wall_fills_rows_from_the_left_with_every_fourth_pixel():
    shades = [np.full((8, 16), grey, np.uint8) for grey in range(10, 70, 10)]
    wall = draw_wall(shades).images[0].get_array()
    assert wall.shape == (8, 36)  # two rows of 2 px, five columns of 4 px, and gaps of 4 px
    assert [wall[0, 0], wall[0, 8], wall[6, 0], wall[6, 8]] == [10, 20, 60, 255]
