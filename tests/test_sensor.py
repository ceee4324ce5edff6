"""What the sensor does to a picture, each step against numbers worked out by hand."""

import numpy as np
import pytest

from cvnotes.base import CvnotesError, InputTypeError, ShapeError, number
from cvnotes.pictures import compress, expose, gaussian_blur
from cvnotes.pictures.exposure import _smeared


def test_values_are_rounded_to_the_nearest_and_clipped():
    image = expose([[-3.0, 0.4, 0.6, 254.4, 254.6, 999.0]])
    assert image.dtype == np.uint8
    np.testing.assert_array_equal(image, [[0, 0, 1, 254, 255, 255]])


def test_the_given_light_is_left_as_it_was():
    light = np.full((4, 5), 100.25)
    expose(light, blur=1.0, motion=(2, 1), noise=3, gain=2, rng=np.random.default_rng(0))
    assert (light == 100.25).all()


def test_noise_has_the_given_spread_no_bias_and_no_memory():
    image = expose(np.full((300, 400), 127.3), noise=5.0, rng=np.random.default_rng(2))
    noise = image - 127.3
    n = noise.size
    assert abs(noise.mean()) < 4 * 5 / np.sqrt(n)
    assert noise.std() == pytest.approx(np.sqrt(25 + 1 / 12), rel=4 / np.sqrt(2 * n))
    for shifted in (noise[:, 1:] * noise[:, :-1], noise[1:] * noise[:-1]):
        assert abs(shifted.mean()) < 4 * 25 / np.sqrt(n)


def test_a_seed_stands_for_one_picture():
    def shoot():
        return expose(np.full((1, 6), 100.0), noise=10.0, rng=np.random.default_rng(1998))

    np.testing.assert_array_equal(shoot(), shoot())
    np.testing.assert_array_equal(shoot(), [[104, 100, 107, 95, 91, 106]])


def test_gain_comes_before_the_noise():
    bright = expose(np.full((200, 200), 60.0), gain=2.0, noise=4.0, rng=np.random.default_rng(0))
    assert bright.mean() == pytest.approx(120, abs=0.1)
    assert bright.std() == pytest.approx(4, rel=0.03)


def test_a_point_blurs_to_a_gaussian_of_the_same_sum():
    point = np.zeros((41, 41))
    point[20, 20] = 1000.0
    spread = gaussian_blur(point, 2.0)
    assert spread.sum() == pytest.approx(1000, abs=1e-9)
    u = np.arange(41) - 20
    np.testing.assert_allclose(spread.sum(axis=0) @ u**2 / 1000, 4.0, rtol=1e-3)
    np.testing.assert_allclose(spread[20, 24] / spread[20, 20], np.exp(-2), rtol=1e-9)
    np.testing.assert_allclose(spread, spread.T, atol=1e-12)


@pytest.mark.parametrize("motion", [(6.0, 0.0), (0.0, -3.0), (2.5, 4.25), (0.2, 0.1)])
def test_motion_spreads_a_point_along_the_way_and_leaves_its_middle(motion):
    point = np.zeros((31, 31))
    point[15, 15] = 1.0
    spread = _smeared(point, np.array(motion))
    u = np.arange(31) - 15
    weights_u, weights_v = spread.sum(axis=0), spread.sum(axis=1)
    assert spread.sum() == pytest.approx(1, abs=1e-12)
    np.testing.assert_allclose([weights_u @ u, weights_v @ u], 0, atol=1e-12)
    # An even movement over d has the variance d²/12; interpolation adds at most 1/4.
    for weights, d in ((weights_u, motion[0]), (weights_v, motion[1])):
        assert -1e-3 <= weights @ u**2 - d**2 / 12 <= 0.25
    # The way from the upper left to the lower right, if du and dv have one sign.
    covariance = u @ spread @ u
    assert covariance == pytest.approx(motion[0] * motion[1] / 12, abs=0.02)


def test_colours_stay_apart_in_all_steps():
    light = np.zeros((9, 9, 3))
    light[4, 4, 1] = 200.0
    image = expose(light, blur=0.8, motion=(2, 0))
    assert image[..., 1].max() > 10
    assert not image[..., [0, 2]].any()


def test_jpeg_keeps_shape_and_loses_more_at_lower_quality():
    rng = np.random.default_rng(0)
    for shape in ((40, 48), (40, 48, 3)):
        image = rng.integers(0, 256, shape).astype(np.uint8)
        loss = [np.std(compress(image, q) - image.astype(float)) for q in (99, 60, 10)]
        assert compress(image, 60).shape == shape
        assert loss[0] < loss[1] < loss[2]


def test_a_picture_of_one_pixel_works():
    assert expose([[7.0]], blur=2.0, motion=(3, 3)).tolist() == [[7]]


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ({"radiance": np.zeros(5)}, ShapeError, r"expected a picture \(height, width\)"),
        ({"radiance": np.zeros((5, 5, 4))}, ShapeError, r"got \(5, 5, 4\)"),
        ({"radiance": np.zeros((0, 5))}, ShapeError, "at least one pixel"),
        ({"radiance": [[np.nan]]}, CvnotesError, "radiance contains NaN"),
        ({"radiance": None}, InputTypeError, "radiance: expected numbers, got None"),
        ({"blur": -0.1}, CvnotesError, "blur = -0.1 but must be at least 0"),
        ({"blur": [1, 2]}, ShapeError, "blur: expected one number"),
        ({"motion": (1, 2, 3)}, ShapeError, r"motion: expected \(du, dv\)"),
        ({"noise": 1}, CvnotesError, r"pass rng=numpy\.random\.default_rng"),
        ({"noise": 1, "rng": 42}, InputTypeError, r"expected a numpy\.random\.Generator, got int"),
        ({"gain": -1}, CvnotesError, "gain = -1"),
        ({"jpeg": 101}, CvnotesError, "whole number from 1 to 100, got 101"),
        ({"jpeg": 50.5}, CvnotesError, "whole number from 1 to 100"),
    ],
)
def test_a_wrong_argument_is_refused_in_words(arguments, error, words):
    given = {"radiance": np.zeros((4, 4))} | arguments
    with pytest.raises(error, match=words):
        expose(given.pop("radiance"), **given)


def test_a_number_is_a_single_finite_one():
    assert number(3, "x") == 3.0
    with pytest.raises(InputTypeError, match="x: expected a numeric array"):
        number("3", "x")


@pytest.mark.parametrize("level", [0.5, -1.0, 256.0, np.nan])
def test_only_grey_levels_of_eight_bits_are_compressed(level):
    picture = np.full((8, 8), 100.0)
    picture[3, 4] = level
    with pytest.raises(CvnotesError, match="image"):
        compress(picture, 90)
