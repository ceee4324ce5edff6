import cv2
import numpy as np
import pytest
from differences import numerical_jacobian
from scipy.special import erf
from supersampled import eight_bits, picture

from cvnotes.base import (
    CvnotesError,
    DegenerateError,
    InputTypeError,
    ShapeError,
)
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.targets import Chessboard, harris, local_maxima, refine_edges, refine_subpixel
from cvnotes.targets.subpixel import (
    Window,
    crossing,
    crossing_jacobian,
    fit_edges,
    jacobian,
)

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.10)), size=(640, 480))
TURNS = [
    ((0.4, -0.3, 0.1), (-5, 10, 520)),
    ((-0.5, 0.2, -0.4), (15, -5, 560)),
    ((0.1, 0.6, 0.7), (-20, 0, 600)),
    ((-0.3, -0.5, 3.0), (10, 15, 500)),
    ((0.7, 0.1, -0.2), (0, -10, 640)),
    ((0.05, 0.02, 0.3), (20, 5, 480)),
]


def view(turn, centre):
    R = rotation_from_vector(turn)
    return CAMERA.moved(pose(R, np.array(centre) - R @ BOARD.points.mean(0)))


@pytest.fixture(scope="module")
def blurred():
    return [picture(BOARD, view(*t), blur=0.7) for t in TURNS]


def cross(m=(20.3, 19.8), angles=(0.2, 1.6), blur=0.8, contrast=80.0, slope=(0.0, 0.0), size=41):
    """Two blurred edges drawn by hand; the quadrant between both angles is light."""
    v, u = np.indices((size, size))
    x, y = u - m[0], v - m[1]
    d1 = np.cos(angles[0]) * y - np.sin(angles[0]) * x
    d2 = np.sin(angles[1]) * x - np.cos(angles[1]) * y
    steps = erf(d1 / (np.sqrt(2) * blur)) * erf(d2 / (np.sqrt(2) * blur))
    return (1 + slope[0] * x + slope[1] * y) * (120 + contrast * steps)


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


class TestHarris:
    def test_a_ramp_has_one_gradient_and_answers_minus_k(self):
        response = harris(np.tile(np.arange(60.0), (50, 1)), k=0.05)
        np.testing.assert_allclose(response[15:-15, 15:-15], -0.05, atol=1e-9)

    def test_a_slanting_ramp_has_one_gradient_too(self):
        v, u = np.indices((50, 60), dtype=float)
        response = harris(3 * u - 4 * v)
        np.testing.assert_allclose(response[15:-15, 15:-15], -0.04 * 25**2, atol=1e-6)

    def test_it_is_positive_at_corners_negative_on_edges_and_zero_where_flat(self):
        image = np.zeros((60, 60))
        image[:30, :30] = image[30:, 30:] = 200
        response = harris(image)
        assert response[30, 30] > 0 > response[30, 10]
        assert abs(response[10, 10]) < 1e-9 * response[30, 30]

    def test_it_does_not_know_which_way_is_up(self):
        image = np.random.default_rng(1).random((40, 30))
        turned = np.rot90(harris(np.rot90(image).copy()), -1)
        np.testing.assert_allclose(turned, harris(image), atol=1e-12)

    @pytest.mark.slow
    def test_it_finds_every_corner_of_a_board_to_a_pixel(self, blurred):
        image, m = blurred[5]
        found = local_maxima(harris(eight_bits(image)), radius=8)
        nearest = np.linalg.norm(found[None] - m[:, None], axis=-1).min(1)
        assert nearest.max() < 1.5

    def test_one_row_of_pixels_has_no_corner(self):
        assert not harris(np.ones((1, 9))).any()

    def test_it_refuses_what_is_no_width(self):
        with pytest.raises(CvnotesError, match="sigma must be positive, got 0"):
            harris(np.zeros((9, 9)), sigma=0)


class TestLocalMaxima:
    def test_the_strongest_comes_first_and_silences_its_surroundings(self):
        response = np.zeros((40, 40))
        response[10, 10], response[10, 14], response[30, 20] = 5, 4, 9
        assert local_maxima(response, radius=5).tolist() == [[20, 30], [10, 10]]
        assert local_maxima(response, radius=3).tolist() == [[20, 30], [10, 10], [14, 10]]

    def test_equal_neighbours_count_once(self):
        response = np.zeros((30, 30))
        response[10:12, 10:12] = 7
        assert local_maxima(response).tolist() == [[10, 10]]

    def test_weak_ones_are_dropped_and_so_are_those_beyond_the_count(self):
        response = np.zeros((60, 60))
        response[10, 10], response[30, 30], response[50, 50] = 100, 50, 0.5
        assert len(local_maxima(response)) == 2
        assert local_maxima(response, count=1).tolist() == [[10, 10]]

    def test_nothing_is_no_maximum(self):
        assert local_maxima(np.zeros((9, 9))).shape == (0, 2)
        assert local_maxima(-np.ones((9, 9))).shape == (0, 2)

    def test_it_wants_one_value_per_pixel(self):
        with pytest.raises(ShapeError, match=r"one value per pixel, got shape \(3, 3, 3\)"):
            local_maxima(np.zeros((3, 3, 3)))


class TestRefineSubpixel:
    def test_it_finds_a_crossing_drawn_by_hand(self):
        m = refine_subpixel(cross((20.3, 19.8)), [[21.4, 19.0]])
        np.testing.assert_allclose(m, [[20.3, 19.8]], atol=5e-3)

    @pytest.mark.slow
    def test_it_is_closer_to_the_truth_than_opencv(self, blurred):
        ours, theirs = [], []
        for image, m in blurred:
            pixels, start = eight_bits(image), (m + 0.2).astype(np.float32)
            ours.append(refine_subpixel(pixels, start) - m)
            criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4)
            found = cv2.cornerSubPix(pixels, start, (5, 5), (-1, -1), criteria)
            theirs.append(found.reshape(-1, 2) - m)
        assert rms(ours) < 0.008
        assert rms(ours) < 0.5 * rms(theirs)

    def test_a_flat_place_and_a_single_edge_have_no_crossing(self):
        edge = np.zeros((40, 40))
        edge[:, 20:] = 200
        assert np.isnan(refine_subpixel(np.full((40, 40), 9.0), [[20.0, 20.0]])).all()
        assert np.isnan(refine_subpixel(edge, [[19.5, 20.0]])).all()

    def test_a_lost_corner_does_not_disturb_its_neighbours(self):
        image = cross((20.3, 19.8), size=80)
        m = refine_subpixel(image, [[70.0, 70.0], [20.0, 20.0]], window=4)
        assert np.isnan(m[0]).all() or np.abs(m[0] - 70).max() < 4
        np.testing.assert_allclose(m[1], [20.3, 19.8], atol=5e-3)

    def test_it_takes_one_corner_or_many_and_leaves_them_alone(self):
        start = np.array([20.0, 20.0])
        one = refine_subpixel(cross(), start)
        assert one.shape == (2,)
        assert start.tolist() == [20, 20]

    @pytest.mark.parametrize("window", [0, 2.5, -1])
    def test_half_a_window_is_a_whole_number(self, window):
        with pytest.raises(CvnotesError, match="window: expected a whole number from 1"):
            refine_subpixel(cross(), [[20.0, 20.0]], window=window)


class TestModel:
    def test_its_jacobian_is_its_derivative(self):
        rng = np.random.default_rng(2)
        p = np.array([0.1, 0.9, -0.3, 0.8, -0.2, 0.25, 60.0, 120.0, 0.004, -0.003])
        y, x = np.indices((13, 13)).reshape(2, -1) - 6.0
        place = np.stack([x, y, np.ones_like(x)]).astype(np.float32)
        weight = (rng.random((1, 169)) > 0.2).astype(np.float32)
        window = Window(place, np.zeros_like(weight), weight)

        def model(q):
            t1 = q[0] * x + q[1] * y + q[2]
            t2 = q[3] * x + q[4] * y + q[5]
            return weight[0] * (1 + q[8] * x + q[9] * y) * (q[7] + q[6] * erf(t1) * erf(t2))

        J = jacobian(p[None], window)[0]
        np.testing.assert_allclose(J[:10].T, numerical_jacobian(model, p), atol=2e-3)
        np.testing.assert_allclose(J[10], -model(p), atol=1e-3)

    def test_the_crossing_moves_as_its_jacobian_says(self):
        p = np.array([0.1, 0.9, -0.3, 0.8, -0.2, 0.25, 60.0, 120.0, 0.004, -0.003])
        expected = numerical_jacobian(lambda q: crossing(q[None])[0], p)
        np.testing.assert_allclose(crossing_jacobian(p[None])[0], expected, atol=1e-8)

    def test_parallel_edges_cross_nowhere(self):
        assert not np.isfinite(crossing(np.array([[1.0, 0, 1, 1, 0, 2, 1, 1, 0, 0]]))).any()


class TestRefineEdges:
    @pytest.mark.parametrize("angles", [(0.2, 1.6), (0.0, np.pi / 2), (1.0, 1.9), (2.0, 0.5)])
    @pytest.mark.parametrize("slope", [(0.0, 0.0), (0.006, -0.004)])
    def test_a_picture_of_the_model_gives_the_model(self, angles, slope):
        fit = fit_edges(cross(angles=angles, slope=slope), [[20.9, 19.2]])
        np.testing.assert_allclose(fit.m, [[20.3, 19.8]], atol=1e-4)
        # Contrast and level are those in the middle of the window, half a pixel away.
        np.testing.assert_allclose(np.abs(fit.contrast), 80, atol=0.3)
        np.testing.assert_allclose(fit.level, 120, atol=0.5)
        np.testing.assert_allclose(fit.blur, 0.8, atol=1e-3)

    def test_without_noise_it_reaches_thousandths_of_a_pixel(self, blurred):
        errors = [refine_edges(eight_bits(i), m + 0.3, grid=(9, 6)) - m for i, m in blurred]
        assert rms(errors) < 0.004
        assert np.abs(errors).max() < 0.03

    @pytest.mark.slow
    def test_without_any_blur_it_stays_below_a_twentieth_of_a_pixel(self):
        errors = []
        for turn in TURNS[:2]:
            image, m = picture(BOARD, view(*turn))
            errors.append(refine_edges(eight_bits(image), m + 0.3, grid=(9, 6)) - m)
        assert rms(errors) < 0.05

    def test_under_noise_it_reaches_its_bound_and_beats_opencv(self, blurred):
        rng = np.random.default_rng(3)
        ours, theirs, bound = [], [], []
        for image, m in blurred * 2:
            pixels, start = eight_bits(image, 5.0, rng), (m + 0.2).astype(np.float32)
            fit = fit_edges(pixels, start, grid=(9, 6))
            ours.append(fit.m - m)
            bound.append(25 * np.diagonal(fit.covariance, axis1=1, axis2=2))
            criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4)
            found = cv2.cornerSubPix(pixels, start, (5, 5), (-1, -1), criteria)
            theirs.append(found.reshape(-1, 2) - m)
        assert 0.85 < rms(ours) / np.sqrt(np.mean(bound)) < 1.15
        assert rms(theirs) > 2.5 * rms(ours)
        assert rms(ours) < 0.018

    def test_the_bound_is_that_of_the_jacobian(self):
        # For orthogonal edges along the axes, far from the corner of the window, only pixels on
        # one edge tell where it is: its information is Σ (dI/du)² when nothing else is unknown.
        blur, contrast = 0.8, 80.0
        fit = fit_edges(cross((20.0, 20.0), (0.0, np.pi / 2), blur, contrast), [[20.0, 20.0]])
        x = np.arange(-8, 9)
        step, slope = erf(x / (np.sqrt(2) * blur)), np.sqrt(2 / np.pi) / blur
        alone = ((contrast * slope * np.exp(-((x / blur) ** 2) / 2)) ** 2).sum() * (step**2).sum()
        assert 1.0 < fit.covariance[0, 0, 0] * alone < 1.5

    def test_where_it_starts_does_not_matter(self, blurred):
        image, m = blurred[0]
        rng = np.random.default_rng(4)
        near = refine_edges(eight_bits(image), m, grid=(9, 6))
        far = refine_edges(eight_bits(image), m + rng.uniform(-1, 1, m.shape), grid=(9, 6))
        np.testing.assert_allclose(far, near, atol=5e-3)

    def test_neighbouring_corners_stay_out_of_the_window(self):
        board = Chessboard((9, 6), 6.0)
        R = rotation_from_vector((0.2, -0.3, 0.1))
        camera = CAMERA.moved(pose(R, [0, 0, 650] - R @ board.points.mean(0)))
        image, m = picture(board, camera, blur=0.7)
        squares = np.linalg.norm(np.diff(m.reshape(6, 9, 2), axis=1), axis=-1)
        assert squares.max() < 8
        errors = refine_edges(eight_bits(image), m + 0.2, grid=(9, 6)) - m
        assert rms(errors) < 0.02

    def test_strong_blur_costs_little(self):
        image, m = picture(BOARD, view(*TURNS[0]), blur=3.5)
        pixels = eight_bits(image, 2.0, np.random.default_rng(5))
        assert rms(refine_edges(pixels, m + 0.2, grid=(9, 6)) - m) < 0.04

    @pytest.mark.parametrize("seed", range(4))
    def test_in_noise_alone_hardly_any_crossing_is_fitted(self, seed):
        image = eight_bits(np.full((200, 200), 128.0), 20.0, np.random.default_rng(seed))
        v, u = np.mgrid[28:173:18, 28:173:18]
        fitted = refine_edges(image, np.stack([u, v], -1).reshape(-1, 2).astype(float))
        assert np.isfinite(fitted).all(axis=1).sum() <= 3  # of 81

    @pytest.mark.parametrize(
        "response",
        [lambda x: 255 * (x / 255) ** 0.45, lambda x: 255 * (x / 255) ** 2.2, lambda x: 1.7 * x],
        ids=["gamma 0.45", "gamma 2.2", "overexposed"],
    )
    def test_an_unknown_response_curve_does_not_move_the_crossing(self, response):
        image = eight_bits(response(cross((20.3, 19.8), (0.3, 1.7))))
        np.testing.assert_allclose(refine_edges(image, [[20, 20]]), [[20.3, 19.8]], atol=0.02)

    def test_a_slope_of_the_lighting_does_not_move_it_either(self, blurred):
        image, m = blurred[1]
        v, u = np.indices(image.shape)
        errors = refine_edges(
            eight_bits(image * (0.5 + 0.4 * u / 640 + 0.2 * v / 480)), m, grid=(9, 6)
        )
        assert rms(errors - m) < 0.006

    def test_the_contrast_tells_which_quadrant_is_light(self, blurred):
        image, m = blurred[2]
        contrast = fit_edges(eight_bits(image), m, grid=(9, 6)).contrast.reshape(6, 9)
        i, j = np.indices(contrast.shape)
        # The square towards −x, −y of the origin is dark, and so is the one opposite.
        np.testing.assert_allclose(contrast * (-1.0) ** (i + j), -95, atol=4)

    def test_where_no_two_edges_are_the_row_is_nan(self):
        image = np.full((90, 90), 100.0)
        image[:41, :41] = cross()
        image[60:, :] = 200
        m = refine_edges(image, [[20, 20], [70, 30], [60, 59.5], [-30, 500], [20, 20]])
        assert np.isnan(m[1:4]).all()
        np.testing.assert_allclose(m[[0, 4]], [[20.3, 19.8]] * 2, atol=1e-3)

    def test_colour_depth_and_range_do_not_matter(self):
        grey = eight_bits(cross())
        same = [
            np.dstack([grey] * 3),
            np.dstack([grey] * 3 + [grey * 0]),
            grey[..., None],
            grey.astype(np.uint16) * 257,
            grey / np.float32(255),
        ]
        m = refine_edges(grey, [[20, 20]])
        for image in same:
            np.testing.assert_allclose(refine_edges(image, [[20, 20]]), m, atol=1e-4)

    def test_no_corners_are_no_problem(self):
        assert refine_edges(cross(), np.zeros((0, 2))).shape == (0, 2)

    def test_it_says_what_is_wrong_with_the_corners(self):
        corners = np.random.default_rng(0).random((53, 2))
        with pytest.raises(ShapeError, match="9×6 corners cannot be 53 points"):
            refine_edges(cross(), corners, grid=(9, 6))
        with pytest.raises(DegenerateError, match="lie on a line; are the corners row by row"):
            refine_edges(cross(), np.arange(108.0).reshape(54, 2), grid=(9, 6))
        with pytest.raises(ShapeError, match=r"expected corners \(n, 2\), got \(2,\)"):
            refine_edges(cross(), [20.0, 20.0])
        with pytest.raises(CvnotesError, match="m contains NaN"):
            refine_edges(cross(), [[np.nan, 20.0]])

    def test_it_says_what_is_wrong_with_the_picture(self):
        with pytest.raises(InputTypeError, match="expected uint8, uint16"):
            refine_edges(cross() > 100, [[20, 20]])
        with pytest.raises(ShapeError, match="expected grey, RGB or RGBA"):
            refine_edges(np.zeros((9, 9, 2)), [[4, 4]])
        with pytest.raises(CvnotesError, match="NaN or infinite grey levels"):
            refine_edges(np.full((9, 9), np.nan), [[4, 4]])
