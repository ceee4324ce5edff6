import numpy as np
import pytest

from cvnotes.base import CvnotesError, ShapeError
from cvnotes.show import (
    WORLD,
    draw_image,
    draw_lines,
    draw_segments,
)


def ends(line):
    return np.array(line.get_xydata(), dtype=float)


def two_points(axline):
    return np.array([axline.get_xy1(), axline.get_xy2()])


# Whole lines.


@pytest.mark.parametrize("line", [[0, 1, -240], [2, 0, -640], [3, 4, -2000], [-3, -4, 2000]])
def test_a_line_is_drawn_through_points_that_lie_on_it(line):
    (drawn,) = draw_lines([line]).lines
    p, q = two_points(drawn)
    assert np.allclose([*p, 1] @ np.array(line), 0, atol=1e-9)
    assert np.allclose([*q, 1] @ np.array(line), 0, atol=1e-9)
    assert np.linalg.norm(p - q) > 1


def test_the_factor_of_a_line_does_not_change_its_picture():
    ax = draw_lines([[3, 4, -2000], [-3e-9, -4e-9, 2e-6]])
    first, second = (two_points(line)[0] for line in ax.lines)
    assert np.allclose(first, second, atol=1e-9)


def test_the_line_at_infinity_is_not_drawn_and_the_others_are():
    assert len(draw_lines([[0, 0, 1], [1, 0, -5], [0, 0, -2]]).lines) == 1


def test_lines_leave_the_limits_of_a_picture_as_they_are():
    ax = draw_image(np.zeros((48, 64), np.uint8))
    draw_lines([[1, 0, -500], [0, 1, -24]], ax=ax)
    assert (*ax.get_xlim(), *ax.get_ylim()) == (-0.5, 63.5, 47.5, -0.5)


def test_many_lines_have_the_colour_of_their_meaning():
    ax = draw_lines([[1, 0, -5], [1, 0, -9]], meaning="world")
    assert {line.get_color() for line in ax.lines} == {WORLD}
    assert draw_lines([1, 0, -5], linewidth=3).lines[0].get_linewidth() == 3


# Segments.


def test_segments_are_drawn_from_end_to_end():
    segments = [[[0, 1], [10, 20]], [[30, 40], [50, 60]]]
    ax = draw_segments(segments, meaning="ideal", label="edges")
    assert np.allclose([ends(line) for line in ax.lines], segments)
    assert ax.get_legend_handles_labels()[1] == ["edges"]


# What cannot be drawn.


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda: draw_lines([[1, 2]]), r"lines: expected shape \(\.\.\., 3\)"),
        (lambda: draw_segments([[1, 2], [3, 4], [5, 6]]), "two ends each"),
    ],
)
def test_the_wrong_shape_is_named(draw, message):
    with pytest.raises(ShapeError, match=message):
        draw()


def test_an_unknown_meaning_is_refused_with_the_known_ones():
    with pytest.raises(CvnotesError, match="world, camera, ideal, lens, estimated"):
        draw_lines([1, 0, 0], meaning="mine")
