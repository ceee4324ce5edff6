"""The drawings of ideas show what they say: incidence, maps, similar triangles."""

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

from cvnotes.base import CvnotesError
from cvnotes.show import draw_meanings, draw_pinhole, draw_rays
from cvnotes.show.style import COLOURS, ESTIMATED


def squares(ax):
    return [line.get_xydata()[0] for line in ax.lines if line.get_marker() == "s"]


def line_on_the_plane(ax):
    orange = [line.get_xydata() for line in ax.lines if line.get_color() == ESTIMATED]
    (ends,) = (xy for xy in orange if len(xy) == 2)
    return ends


def test_every_colour_has_its_meaning_in_the_legend():
    ax = draw_meanings()
    shown = {to_hex(line.get_color()).upper() for line in ax.figure.findobj(Line2D)}
    assert shown >= {colour.upper() for colour in COLOURS.values()}
    assert len([text for text in ax.texts if text.get_text()]) == len(COLOURS)


def test_points_on_a_line_lie_on_its_plane_in_the_drawing():
    a, b = np.array([-1.0, -0.5, 1]), np.array([0.8, 0.6, 1])
    ax = draw_rays([3 * a, -b], [np.cross(a, b)])
    start, end = line_on_the_plane(ax)
    for x in squares(ax):
        along, to = end - start, x - start
        assert abs(along[0] * to[1] - along[1] * to[0]) < 1e-9
    assert len(squares(ax)) == 2


def test_a_point_at_infinity_has_no_dot_and_the_line_at_infinity_no_line_on_the_plane():
    ax = draw_rays([[1, 0, 0]], [[0, 0, 1]], names=["d", "l"])
    assert squares(ax) == []
    assert [text.get_text() for text in ax.texts] == ["w = 1", "d", "", "l"]


def test_the_ray_of_the_pinhole_passes_through_the_image_and_the_film():
    ray = draw_pinhole().lines[0].get_xydata()
    assert np.allclose(ray, [[-1.5, -0.5625], [1.5, 0.5625], [4, 1.5]])


def test_what_cannot_be_drawn_is_refused_in_words():
    with pytest.raises(CvnotesError, match="neither a point nor a line"):
        draw_rays([[0, 0, 0]])
