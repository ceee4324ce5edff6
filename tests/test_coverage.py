"""Areas of pixels worked out by hand, and the blur of an edge in closed form."""

import numpy as np
import pytest
from scipy.special import ndtr

from cvnotes.base import CvnotesError, DegenerateError, ShapeError
from cvnotes.pictures.pixel_means import edge_means, polygon_means, subdivide


def shoelace(outline):
    x, y = np.asarray(outline, float).T
    return abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def rectangle(left, top, right, bottom):
    return [[left, top], [right, top], [right, bottom], [left, bottom]]


def test_a_rectangle_covers_the_product_of_what_it_covers_along_u_and_v():
    covered = polygon_means(rectangle(0.75, -0.25, 3.0, 1.0), (5, 3))
    np.testing.assert_allclose(covered, np.outer([0.75, 0.5, 0], [0, 0.75, 1, 0.5, 0]), atol=1e-15)


@pytest.mark.parametrize("turn", [1, -1])
def test_the_parts_of_all_pixels_add_up_to_the_area(turn):
    star = [[3.3, 2.1], [30.7, 9.9], [14.2, 12.3], [22.5, 28.8], [9.1, 17.4], [1.7, 26.6]][::turn]
    covered = polygon_means(star, (40, 32))
    assert covered.sum() == pytest.approx(shoelace(star), abs=1e-11)
    assert covered.min() == 0
    assert covered.max() == 1


def test_what_leaves_the_picture_on_any_side_is_cut_off_exactly():
    triangle = np.array([[-30.2, -7.1], [52.3, 11.8], [3.4, 61.6]])
    whole = polygon_means(triangle + 40, (120, 120))
    np.testing.assert_allclose(polygon_means(triangle, (20, 25)), whole[40:65, 40:60], atol=1e-12)


@pytest.mark.parametrize("away", [[100, 0], [-100, 0], [0, 100], [0, -100]])
def test_a_polygon_outside_of_the_picture_covers_nothing(away):
    outline = np.array(rectangle(2, 3, 7, 8)) + away
    assert not polygon_means(outline, (12, 12)).any()
    np.testing.assert_allclose(polygon_means(outline, (12, 12), blur=1.0), 0, atol=1e-12)


def test_a_polygon_around_the_picture_covers_everything():
    np.testing.assert_allclose(polygon_means(rectangle(-9, -9, 30, 30), (12, 10)), 1)
    np.testing.assert_allclose(polygon_means(rectangle(-9, -9, 30, 30), (12, 10), blur=1), 1)


def test_channels_are_kept_apart():
    start = np.array(rectangle(1, 1, 3, 3), float)[::-1]
    end = np.roll(start, -1, axis=0)
    one, two = edge_means(start, end, np.tile([1.0, -2.0], (4, 1)), (5, 5))
    assert one.sum() == pytest.approx(4)
    np.testing.assert_allclose(two, -2 * one)


def blurred_edge(x, sigma):
    """Mean over [x − ½, x + ½] of a step at 0, blurred: the integral of Φ(t/σ)."""

    def integral(t):
        return t * ndtr(t / sigma) + sigma * np.exp(-0.5 * (t / sigma) ** 2) / np.sqrt(2 * np.pi)

    return integral(x + 0.5) - integral(x - 0.5)


@pytest.mark.parametrize("sigma", [0.1, 0.4, 0.7, 1.6, 5.0])
def test_a_blurred_rectangle_is_the_product_of_two_blurred_bars(sigma):
    left, top, right, bottom = 10.3, 8.13, 27.71, 19.9
    u, v = np.arange(40), np.arange(30)
    bar_u = blurred_edge(u - left, sigma) - blurred_edge(u - right, sigma)
    bar_v = blurred_edge(v - top, sigma) - blurred_edge(v - bottom, sigma)
    covered = polygon_means(rectangle(left, top, right, bottom), (40, 30), blur=sigma)
    np.testing.assert_allclose(covered, np.outer(bar_v, bar_u), atol=2e-4)


@pytest.mark.parametrize("angle", [0.1, 0.8, 2.0])
def test_a_slanted_blurred_edge_has_the_same_profile(angle):
    # A far larger square than the picture, one side of which passes through pixel (20, 15).
    c, s = np.cos(angle), np.sin(angle)
    along, across = np.array([c, s]), np.array([-s, c])
    outline = [
        [20, 15] + a * along + b * across for a, b in ((-90, 0), (90, 0), (90, 90), (-90, 90))
    ]
    covered = polygon_means(outline, (41, 31), blur=3.0)
    offset = (np.stack(np.meshgrid(np.arange(41), np.arange(31)), -1) - [20, 15]) @ across
    # Averaging over the pixel adds 1/12 to the variance, whatever the angle.
    np.testing.assert_allclose(covered, ndtr(offset / np.sqrt(9 + 1 / 12)), atol=2e-4)


def test_pieces_are_cut_evenly_and_end_where_they_ended():
    start, end = np.array([[0.0, 0.0], [5.0, 5.0]]), np.array([[3.0, 4.0], [5.0, 5.0]])
    points, piece = subdivide(start, end, 1.5)
    assert piece.tolist() == [0, 0, 0, 0, 0, 1, 1]
    np.testing.assert_allclose(points[:5, 0], [0, 0.75, 1.5, 2.25, 3.0])
    np.testing.assert_array_equal(points[4], end[0])


@pytest.mark.parametrize(
    ("outline", "error", "words"),
    [
        ([[0, 0], [1, 1]], DegenerateError, "at least 3 corners"),
        ([[0, 0], [1, 1], [3, 3]], DegenerateError, "no area"),
        ([[0, 0, 1], [1, 1, 1], [3, 3, 1]], ShapeError, r"expected shape \(..., 2\)"),
        ([[0, 0], [1, np.inf], [3, 3]], CvnotesError, "outline contains NaN or infinite"),
    ],
)
def test_a_polygon_that_is_none_is_refused_in_words(outline, error, words):
    with pytest.raises(error, match=words):
        polygon_means(outline, (8, 8))
