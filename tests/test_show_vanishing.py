import numpy as np
import pytest

from cvnotes.base import DegenerateError, ShapeError
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.show import draw_altitudes


def ends(line):
    return np.array(line.get_xydata(), dtype=float)


def crosses(ax):
    return np.concatenate([c.get_offsets() for c in ax.collections])


# The triangle.


def test_the_altitudes_meet_in_the_piercing_point_of_the_camera_that_saw_a_box():
    camera = Camera(intrinsics(800, 800, 333, 222), look_at([9, -7, -8], [0, 0, 0]))
    ax = draw_altitudes(camera.vanishing_point(np.eye(3)))
    assert np.allclose(crosses(ax)[0], [333, 222], atol=1e-6)


def test_the_feet_of_a_triangle_worked_out_by_hand():
    ax = draw_altitudes([[0, 0], [4, 0], [1, 3]])
    dashed = np.array([ends(line) for line in ax.lines if line.get_linestyle() == "--"])
    assert np.allclose(dashed[:, 1], [[2, 2], [0.4, 1.2], [1, 0]])
    assert np.allclose(crosses(ax)[0], [1, 1])


def test_the_corners_carry_their_names():
    texts = draw_altitudes([[0, 0], [900, 0], [400, 700]]).texts
    assert [text.get_text() for text in texts] == ["c", "X", "Y", "Z"]


def test_points_on_a_line_are_no_triangle():
    with pytest.raises(DegenerateError, match="there is no triangle"):
        draw_altitudes([[0, 0], [1, 1], [2, 2]])
    with pytest.raises(DegenerateError, match="there is no triangle"):
        draw_altitudes([[0, 0], [0, 0], [2, 2]])


# What cannot be drawn.


def test_the_wrong_shape_is_named():
    with pytest.raises(ShapeError, match="three points"):
        draw_altitudes([[[0, 0], [4, 0], [1, 3]]])


@pytest.mark.parametrize("v", [[2000, 100], [-900, 240], [300, 3000], [300, -50]])
def test_the_axes_grow_towards_a_vanishing_point_outside_of_the_picture(v):
    ax = draw_altitudes([v, [0, 0], [900, 700]])
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    assert left < v[0] < right
    assert top < v[1] < bottom
    assert left <= -0.5 < 639.5 <= right
    assert top <= -0.5 < 479.5 <= bottom
