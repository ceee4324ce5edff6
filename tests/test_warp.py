import sys
import threading

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import map_coordinates

from cvnotes.base import (
    CalibrationWarning,
    CvnotesError,
    DegenerateError,
    InputTypeError,
    ShapeError,
)
from cvnotes.camera import (
    Camera,
    FisheyeLens,
    Lens,
    RationalLens,
    intrinsics,
    px_from_xy,
    rotation_from_vector,
)
from cvnotes.projective import apply
from cvnotes.warping import (
    PixelMap,
    backward_warp,
    bilinear,
    compose,
    forward_warp,
    homography_map,
    interpolate,
    map_array,
    plane_map,
    rectify_plane,
    rotation_map,
    undistort_image,
    undistortion,
    undistortion_map,
    zoom_map,
)
from cvnotes.warping.pixel_map import factored

DTYPES = [np.uint8, np.uint16, np.float32, np.float64]
SCIPY_MODES = {"constant": "grid-constant", "replicate": "nearest", "reflect": "mirror"}
TILTED = np.array([[0.9, -0.2, 40.0], [0.15, 1.1, -30.0], [4e-4, -2e-4, 1.0]])
CAMERA = Camera(
    intrinsics(300, 305, 161, 118, 0.4), lens=Lens((-0.25, 0.08), (1e-3, -2e-3)), size=(320, 240)
)


def noise(height, width, dtype=np.float64, channels=(), seed=0):
    rng = np.random.default_rng(seed)
    top = np.iinfo(dtype).max if np.dtype(dtype).kind == "u" else 1000
    return (rng.uniform(0, 1, (height, width, *channels)) * top).astype(dtype)


def smooth(height, width):
    v, u = np.indices((height, width))
    return 100 + 50 * np.sin(u / 17) + 40 * np.cos(v / 13 + u / 29)


def grid(width, height):
    return np.stack(np.meshgrid(np.arange(width), np.arange(height)), axis=-1).astype(float)


# --- between the pixels --------------------------------------------------------------------------


def test_bilinear_is_the_weighted_mean_of_the_four_pixels():
    I1, I2, I3, I4 = noise(4, 50)
    du, dv = np.random.default_rng(1).uniform(0, 1, (2, 50))
    weighted = (1 - du) * (1 - dv) * I1 + du * (1 - dv) * I2 + (1 - du) * dv * I3 + du * dv * I4
    np.testing.assert_allclose(bilinear(I1, I2, I3, I4, du, dv), weighted, atol=1e-11)


def test_bilinear_by_hand():
    image = np.array([[10.0, 20.0], [30.0, 80.0]])
    # along u: 12.5 and 42.5; along v: 12.5 + 0.5 · 30
    assert interpolate(image, [0.25, 0.5]) == 27.5
    assert interpolate(image, [[0, 0], [1, 0], [0, 1], [1, 1]]).tolist() == [10, 20, 30, 80]


def test_the_library_does_what_the_formula_says():
    image, m = noise(20, 30), np.random.default_rng(1).uniform(0, 18.9, (200, 2))
    (u, v), (u_k, v_k) = m.T, np.floor(m).astype(int).T
    four = (image[v_k + j, u_k + i] for j in (0, 1) for i in (0, 1))
    by_formula = bilinear(*four, u - u_k, v - v_k)
    np.testing.assert_allclose(interpolate(image, m), by_formula, atol=1e-11)


def test_nearest_rounds_both_coordinates_halves_to_the_right_and_down():
    image = np.arange(12).reshape(3, 4).astype(np.uint8)
    m = [[1.49, 0.51], [1.5, 0.5], [0.5, 1.5], [-0.5, -0.5], [3.49, 2.49]]
    assert interpolate(image, m, method="nearest").tolist() == [5, 6, 9, 0, 11]
    outside = [[-0.51, 0], [3.5, 0], [0, 2.5], [0, -7]]
    assert interpolate(image, outside, method="nearest", fill=99).tolist() == [99] * 4


@pytest.mark.parametrize("border", SCIPY_MODES)
@pytest.mark.parametrize("shape", [(17, 23), (1, 1), (1, 9), (9, 1), (2, 2)])
def test_scipy_interpolates_to_the_same_values_inside_and_outside(border, shape):
    image = noise(*shape)
    m = np.random.default_rng(2).uniform(-40, 60, (3000, 2))
    m[:1000] = m[:1000] / 4 + 5
    m[1000:1500] = m[1000:1500].round()
    ours = interpolate(image, m, border=border, fill=7)
    theirs = map_coordinates(image, m.T[::-1], order=1, mode=SCIPY_MODES[border], cval=7)
    np.testing.assert_allclose(ours, theirs, atol=1e-9)


@pytest.mark.parametrize(
    ("border", "theirs"),
    [
        ("constant", cv2.BORDER_CONSTANT),
        ("replicate", cv2.BORDER_REPLICATE),
        ("reflect", cv2.BORDER_REFLECT_101),
    ],
)
@pytest.mark.parametrize("channels", [(), (3,)])
def test_opencv_remaps_to_the_same_picture(border, theirs, channels):
    # OpenCV rounds positions to 1/32 pixel unless they are on that grid
    image = noise(60, 80, np.float32, channels)
    table = np.random.default_rng(3).integers(-640, 3200, (50, 70, 2)) / 32
    expected = cv2.remap(
        image, table.astype(np.float32), None, cv2.INTER_LINEAR, borderMode=theirs, borderValue=0
    )
    np.testing.assert_allclose(backward_warp(image, table, border=border), expected, atol=1e-3)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_whole_numbers_are_rounded_to_the_nearest_and_never_wrapped(dtype):
    top = np.iinfo(dtype).max
    image = np.array([[0, top], [top, 0]], dtype)
    assert interpolate(image, [[0.5, 0.0], [0.25, 0.0]]).tolist() == [
        (top + 1) // 2,
        round(top / 4),
    ]
    noisy, m = noise(40, 50, dtype), np.random.default_rng(4).uniform(0, 38, (20_000, 2))
    exact = interpolate(noisy.astype(float), m)
    ours = interpolate(noisy, m)
    assert ours.dtype == dtype
    assert np.abs(ours - exact).max() <= 0.5 + 1e-4


@given(u=st.floats(-5, 15), v=st.floats(-5, 15), seed=st.integers(0, 99))
def test_bilinear_stays_between_the_darkest_and_the_brightest_pixel(u, v, seed):
    image = noise(9, 11, np.uint8, seed=seed)
    for border in ("replicate", "reflect"):
        assert image.min() <= interpolate(image, [u, v], border=border) <= image.max()


@pytest.mark.parametrize("border", SCIPY_MODES)
@pytest.mark.parametrize("method", ["bilinear", "nearest"])
def test_nowhere_shows_the_fill_value_under_every_border(method, border):
    image = noise(5, 6, np.uint8, (3,))
    nowhere = [[np.nan, 2], [2, np.nan], [np.nan, np.nan]]
    values = interpolate(image, nowhere, method=method, border=border, fill=(1, 2, 3))
    assert values.tolist() == [[1, 2, 3]] * 3
    if border == "constant":
        far = [[np.inf, 2], [2, -np.inf], [1e308, 1e308], [-1e19, 0], [0, 6]]
        values = interpolate(image, far, method=method, fill=(1, 2, 3))
        assert values.tolist() == [[1, 2, 3]] * 5


def test_unknown_pixels_do_not_spread_further_than_they_must():
    image = noise(5, 6)
    image[2, 3] = np.nan
    whole = interpolate(image, grid(6, 5), fill=np.nan)
    np.testing.assert_array_equal(whole, image)
    between = interpolate(image, [[2.5, 2], [3, 1.5], [2, 2.5], [4, 3.5]])
    assert np.isnan(between).tolist() == [True, True, False, False]


# --- backward ------------------------------------------------------------------------------------


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("channels", [(), (1,), (3,), (4,)])
@pytest.mark.parametrize("method", ["bilinear", "nearest"])
@pytest.mark.parametrize("border", SCIPY_MODES)
def test_the_identity_gives_the_picture_back_bit_for_bit(dtype, channels, method, border):
    image = noise(13, 21, dtype, channels)
    for same in (grid(21, 13), lambda m: m, homography_map(np.eye(3)), rotation_map(0)):
        warped = backward_warp(image, same, method=method, border=border)
        assert warped.dtype == dtype
        np.testing.assert_array_equal(warped, image)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize(("du", "dv"), [(1, 0), (-3, 2), (0, -12), (40, 0)])
def test_a_shift_by_whole_pixels_moves_them_bit_for_bit_and_fills_the_rest(dtype, du, dv):
    image = noise(13, 21, dtype)
    expected = np.full((13, 21), 9, dtype)
    v, u = np.indices((13, 21))
    there = (u + du >= 0) & (u + du < 21) & (v + dv >= 0) & (v + dv < 13)
    expected[there] = image[(v + dv)[there], (u + du)[there]]
    for method in ("bilinear", "nearest"):
        shift = homography_map([[1, 0, du], [0, 1, dv], [0, 0, 1]])
        np.testing.assert_array_equal(backward_warp(image, shift, method=method, fill=9), expected)


def test_tables_functions_and_maps_say_the_same():
    image = noise(240, 320, np.uint8)
    f = homography_map(TILTED)
    expected = backward_warp(image, f)
    table = map_array(f, (320, 240))
    np.testing.assert_array_equal(backward_warp(image, table), expected)
    np.testing.assert_array_equal(backward_warp(image, lambda m: apply(TILTED, m)), expected)
    singly = np.array([[f([u, v]) for u in range(320)] for v in (0, 239)])
    np.testing.assert_allclose(table[[0, 239]], singly, atol=1e-9)


def test_opencv_warps_by_a_homography_to_the_same_picture():
    image = smooth(240, 320)
    theirs = cv2.warpPerspective(
        image, TILTED, (300, 200), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    )
    ours = backward_warp(image, homography_map(TILTED), size=(300, 200))
    inside = (map_array(homography_map(TILTED), (300, 200)) > 0).all(axis=-1)
    assert np.abs(ours - theirs)[inside].max() < 0.2  # their positions are rounded to 1/32 pixel


def test_scipy_warps_to_the_same_picture():
    image, table = noise(240, 320), map_array(homography_map(TILTED), (300, 200))
    theirs = map_coordinates(
        image, np.moveaxis(table[..., ::-1], -1, 0), order=1, mode="grid-constant"
    )
    np.testing.assert_allclose(backward_warp(image, table), theirs, atol=1e-9)


def test_there_and_back_again_gives_the_picture_back_where_it_stayed_in_sight():
    image = smooth(240, 320)
    there = backward_warp(image, homography_map(TILTED), fill=np.nan)
    back = backward_warp(there, homography_map(np.linalg.inv(TILTED)), fill=np.nan)
    seen = ~np.isnan(back)
    assert seen.mean() > 0.5
    assert np.abs(back - image)[seen].max() < 0.5


def test_a_vanishing_line_inside_the_picture_is_no_accident():
    H = np.array([[1.0, 0, 0], [0, 1, 0], [0, -0.01, 1]])  # infinite along v = 100
    image = noise(240, 320, np.uint8)
    for method in ("bilinear", "nearest"):
        for border in SCIPY_MODES:
            warped = backward_warp(image, homography_map(H), method=method, border=border, fill=7)
            assert (warped[100, 1:] == 7).all()
    moved = forward_warp(image, homography_map(H))
    assert moved.hits.sum() < image.size


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (50, 1)])
def test_the_smallest_pictures_are_warped_too(shape):
    image = noise(*shape, np.uint8)
    for border in SCIPY_MODES:
        assert backward_warp(image, zoom_map(0.5), border=border, size=(4, 4)).shape == (4, 4)
    assert forward_warp(image, zoom_map(2)).hits.shape == shape


def test_a_picture_much_wider_than_a_tile_is_warped_row_by_row():
    image = noise(3, 50_000, np.uint16)
    shift = homography_map([[1, 0, 5], [0, 1, 0], [0, 0, 1]])
    np.testing.assert_array_equal(backward_warp(image, shift)[:, :-5], image[:, 5:])


# --- forward -------------------------------------------------------------------------------------


def test_a_browser_which_has_no_threads_warps_to_the_same_picture(monkeypatch):
    image = np.random.default_rng(5).integers(0, 255, (70, 90), np.uint8)
    expected = backward_warp(image, rotation_map(0.3, centre=(40, 30)))
    monkeypatch.setattr(sys, "platform", "emscripten")
    monkeypatch.setattr(threading.Thread, "start", lambda self: pytest.fail(f"{self} starts"))
    np.testing.assert_array_equal(
        backward_warp(image, rotation_map(0.3, centre=(40, 30))), expected
    )


def test_forward_by_two_leaves_three_holes_for_every_pixel():
    image = noise(10, 12, np.uint8)
    moved = forward_warp(image, zoom_map(2, centre=(0, 0)), (24, 20), fill=5)
    np.testing.assert_array_equal(moved.image[::2, ::2], image)
    assert moved.holes == 3 * 120
    assert moved.folds == 0
    assert (moved.image[moved.hits == 0] == 5).all()


def test_forward_by_a_half_folds_four_pixels_into_one():
    image = noise(10, 12, np.uint8)
    picture, hits = forward_warp(image, zoom_map(0.5), (6, 5))
    assert (hits == 4).all()
    np.testing.assert_array_equal(picture, image[1::2, 1::2])  # the last in reading order


def test_a_rotation_forward_has_holes_and_folds_and_backward_none():
    image = noise(200, 200, np.uint8) | 1
    angle, centre = 0.3, (99.5, 99.5)
    moved = forward_warp(image, rotation_map(angle, centre))
    disc = np.hypot(*(grid(200, 200) - centre).T) < 98
    assert (moved.hits[disc] == 0).sum() > 500
    assert moved.folds > 500
    turned = backward_warp(image, rotation_map(-angle, centre), method="nearest")
    assert (turned[disc] > 0).all()
    agree = (turned == moved.image)[disc & (moved.hits == 1)]
    assert agree.mean() > 0.8


def test_every_pixel_that_arrives_is_counted_and_no_other():
    image = noise(30, 40, np.float32, (3,))
    table = np.random.default_rng(5).uniform(-10, 50, (30, 40, 2))
    table[0, 0] = np.nan
    moved = forward_warp(image, table, (20, 25))
    u, v = np.floor(table + 0.5).reshape(-1, 2).T
    arrives = (u >= 0) & (u < 20) & (v >= 0) & (v < 25)
    assert moved.hits.sum() == arrives.sum()
    for i in np.flatnonzero(arrives)[-5:]:
        assert moved.hits[int(v[i]), int(u[i])] >= 1
    assert moved.image.shape == (25, 20, 3)
    assert moved.image.dtype == np.float32


# --- the maps ------------------------------------------------------------------------------------


def test_a_positive_angle_turns_clockwise_on_the_screen_about_the_first_pixel():
    # u to the right, v down: a quarter turn carries (1, 0) to (0, 1), that is downwards (E38)
    np.testing.assert_allclose(rotation_map(np.pi / 2)([1, 0]), [0, 1], atol=1e-15)
    image = np.array([[1, 2], [3, 4]], np.uint8)
    turned = backward_warp(image, rotation_map(-np.pi / 2, (0.5, 0.5)))
    np.testing.assert_array_equal(turned, np.rot90(image, -1))


def test_zoom_about_the_corner_shows_the_same_in_a_picture_of_the_same_shape():
    image = noise(6, 8, np.uint8)
    big = backward_warp(image, zoom_map(1 / 3), size=(24, 18), method="nearest")
    np.testing.assert_array_equal(big, np.kron(image, np.ones((3, 3), np.uint8)))
    smooth_big = backward_warp(smooth(60, 80), zoom_map(0.5), size=(160, 120), border="replicate")
    theirs = cv2.resize(smooth(60, 80), (160, 120), interpolation=cv2.INTER_LINEAR)
    np.testing.assert_allclose(smooth_big, theirs, atol=1e-10)


@given(
    angle=st.floats(-7, 7),
    factor=st.floats(0.1, 10),
    m=st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)),
    centre=st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)),
)
def test_the_centre_stays_and_the_map_back_undoes_the_map(angle, factor, m, centre):
    for f, back in (
        (rotation_map(angle, centre), rotation_map(-angle, centre)),
        (zoom_map(factor, centre), zoom_map(1 / factor, centre)),
    ):
        np.testing.assert_allclose(f(centre), centre, atol=1e-9)
        np.testing.assert_allclose(back(f(m)), m, atol=1e-9)


def test_the_map_of_a_composition_is_the_composition_of_the_maps():
    f, g, h = homography_map(TILTED), rotation_map(0.4, (30, 20)), undistortion_map(CAMERA)
    m = grid(40, 30).reshape(-1, 2) * 8
    np.testing.assert_array_equal(compose(f, g, h)(m), f(g(h(m))))
    np.testing.assert_array_equal(compose(f, lambda m: g(m), h)(m), f(g(h(m))))
    np.testing.assert_allclose(compose(f, homography_map(np.linalg.inv(TILTED)))(m), m, atol=1e-10)
    image = smooth(240, 320)
    at_once = backward_warp(image, compose(f, g))
    np.testing.assert_array_equal(at_once, backward_warp(image, lambda m: f(g(m))))


def test_a_single_pixel_at_infinity_is_nan_and_its_neighbours_are_not():
    f = homography_map([[1, 0, 0], [0, 1, 0], [0.01, 0, 1]])
    assert np.isnan(f([[-100, 5], [-99, 5]])).all(axis=1).tolist() == [True, False]


def test_perspective_is_removed_from_the_picture_of_a_plane():
    # a plane painted with a known pattern, pictured by a known homography
    def pattern(X, Y):
        return 120 + 60 * np.sin(X / 9) * np.cos(Y / 7)

    H = np.array([[2.0, 0.4, 60], [-0.3, 1.8, 80], [1e-3, 8e-4, 1]])
    X, Y = np.moveaxis(homography_map(np.linalg.inv(H))(grid(320, 240)), -1, 0)
    picture = pattern(X, Y)
    flat = rectify_plane(picture, H, ((10, 5), (70, 45)), pixel=0.5)
    assert flat.shape == (80, 120)
    X, Y = np.meshgrid(10 + 0.5 * (np.arange(120) + 0.5), 5 + 0.5 * (np.arange(80) + 0.5))
    assert np.abs(flat - pattern(X, Y)).max() < 0.5


def test_the_plane_maps_corners_are_outer_corners_of_pixels():
    f = plane_map(np.eye(3), corner=(100, 50), pixel=4)
    np.testing.assert_allclose(f([[-0.5, -0.5], [9.5, 4.5]]), [[100, 50], [140, 70]], atol=1e-12)


# --- the lens ------------------------------------------------------------------------------------


def test_undistorting_is_the_closed_form_of_the_notes():
    # u' = ũ + (k1 r² + k2 r⁴)(ũ − u0) with r from the ideal pixel (E34, E44)
    camera = Camera(intrinsics(300, 305, 161, 118), lens=Lens((-0.25, 0.08)), size=(320, 240))
    u, v = np.moveaxis(grid(320, 240), -1, 0)
    r2 = ((u - 161) / 300) ** 2 + ((v - 118) / 305) ** 2
    factor = -0.25 * r2 + 0.08 * r2**2
    by_notes = np.stack([u + factor * (u - 161), v + factor * (v - 118)], axis=-1)
    np.testing.assert_allclose(
        map_array(undistortion_map(camera), (320, 240)), by_notes, atol=1e-10
    )


def test_opencv_maps_the_lens_to_the_same_pixels():
    camera = Camera(intrinsics(300, 305, 161, 118), lens=CAMERA.lens, size=(320, 240))
    new_A = intrinsics(250, 255, 180, 130)
    R = rotation_from_vector([0.05, -0.1, 0.2])
    coefficients = np.array([*camera.lens.k, *camera.lens.p])
    theirs = cv2.initUndistortRectifyMap(camera.A, coefficients, R, new_A, (350, 260), cv2.CV_32FC1)
    ours = map_array(undistortion_map(camera, new_A, R=R), (350, 260))
    np.testing.assert_allclose(ours, np.stack(theirs, axis=-1), atol=2e-4)


def test_a_rotated_ideal_camera_sees_the_same_rays():
    R = rotation_from_vector([0.05, -0.1, 0.2])
    new_A = intrinsics(250, 255, 180, 130)
    W = np.random.default_rng(6).uniform(-1, 1, (50, 3)) + [0, 0, 4]
    ideal = Camera(new_A).project(W @ R.T)
    np.testing.assert_allclose(
        undistortion_map(CAMERA, new_A, R=R)(ideal), CAMERA.project(W), atol=1e-9
    )


def test_what_is_behind_the_real_camera_has_no_image():
    R = rotation_from_vector([0, np.deg2rad(100), 0])
    assert np.isnan(undistortion_map(CAMERA, R=R)([161, 118])).all()


def test_the_undistortion_map_leads_back_from_where_a_camera_without_a_lens_sees():
    new_A = intrinsics(280, 290, 150, 110)
    m = grid(320, 240).reshape(-1, 2)[::37]
    ideal = px_from_xy(new_A, CAMERA.ideal(m))
    np.testing.assert_allclose(undistortion_map(CAMERA, new_A)(ideal), m, atol=1e-9)


def test_straight_lines_come_out_straight():
    rail = np.stack([np.linspace(-0.45, 0.45, 50), np.full(50, 0.3), np.ones(50)], axis=1)
    seen = CAMERA.project(rail)
    straight = CAMERA.ideal(seen)
    bent = np.abs(np.linalg.svd(seen - seen.mean(0))[1][1])
    assert bent > 5
    assert np.linalg.svd(straight - straight.mean(0))[1][1] < 1e-9


def test_an_undistorted_picture_is_what_a_camera_without_a_lens_would_have_taken():
    def scene(xy):
        return 120 + 50 * np.sin(25 * xy[..., 0]) + 40 * np.cos(20 * xy[..., 1])

    picture = scene(CAMERA.ideal(grid(320, 240)))
    new_A = intrinsics(260, 265, 155, 115)
    ideal = undistort_image(picture, CAMERA, new_A, size=(300, 220), fill=np.nan)
    truth = scene(Camera(new_A).ideal(grid(300, 220)))
    seen = ~np.isnan(ideal)
    assert seen.mean() > 0.8
    assert np.abs(ideal - truth)[seen].max() < 0.4
    # and back: the lens put into the ideal picture, where both show it
    again = backward_warp(
        truth, lambda m: px_from_xy(new_A, CAMERA.ideal(m)), size=(320, 240), fill=np.nan
    )
    seen = ~np.isnan(again)
    assert np.abs(again - picture)[seen].max() < 0.4


@pytest.mark.parametrize("dtype", DTYPES)
def test_a_perfect_lens_leaves_the_picture_alone_bit_for_bit(dtype):
    camera = Camera(CAMERA.A, size=(320, 240))
    image = noise(240, 320, dtype, (3,))
    np.testing.assert_array_equal(undistort_image(image, camera), image)


def test_a_lens_that_folds_inside_the_picture_gets_a_warning_and_no_garbage():
    camera = Camera(intrinsics(150, 150, 160, 120), lens=Lens((-0.4,)), size=(320, 240))
    image = np.full((240, 320), 200, np.uint8)
    with pytest.warns(CalibrationWarning, match="folds inside of the picture"):
        ideal = undistort_image(image, camera, fill=3)
    r = np.hypot(*((grid(320, 240) - [160, 120]) / 150).T).T
    np.testing.assert_array_equal(ideal == 3, r > camera.lens.max_radius)


# --- guards --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("image", "error", "words"),
    [
        (np.zeros((0, 5), np.uint8), ShapeError, r"got \(0, 5\)"),
        (np.zeros(5), ShapeError, r"expected \(height, width\) or \(height, width, channels\)"),
        (np.zeros((2, 3, 4, 5)), ShapeError, "at most four"),
        (np.zeros((3, 240, 320), np.uint8), ShapeError, "at most four channels"),
        (np.zeros((4, 5), complex), InputTypeError, "got complex128"),
        (np.zeros((4, 5), bool), InputTypeError, "got bool; convert it"),
        (np.zeros((4, 5), np.int64), InputTypeError, "got int64"),
        (np.ma.zeros((4, 5)), InputTypeError, "masked"),
        (None, InputTypeError, "got None"),
        ("image.png", InputTypeError, "numeric"),
    ],
)
def test_what_is_no_picture_is_refused_in_words(image, error, words):
    for warp in (backward_warp, forward_warp):
        with pytest.raises(error, match=words):
            warp(image, zoom_map(2))
    with pytest.raises(error, match=words):
        undistort_image(image, CAMERA)


@pytest.mark.parametrize(
    "size", [(0, 5), (-1, 5), (2.5, 5), (10**6, 10**6), "5x5", (5,), (np.nan, 5)]
)
def test_impossible_sizes_are_refused_before_anything_is_allocated(size):
    for warp in (lambda: backward_warp(np.zeros((4, 5)), zoom_map(2), size=size),
                 lambda: forward_warp(np.zeros((4, 5)), zoom_map(2), size),
                 lambda: map_array(zoom_map(2), size)):  # fmt: skip
        with pytest.raises(CvnotesError, match="size"):
            warp()


@pytest.mark.parametrize(
    ("H", "words"),
    [
        (np.zeros((3, 3)), "singular"),
        (np.ones((3, 3)), "singular"),
        (np.outer([1, 2, 3], [4, 5, 6.0]), "singular"),
        (np.diag([1.0, 1, 0]), "singular"),
        (np.full((3, 3), np.nan), "H contains NaN"),
        (np.eye(2), r"expected shape \(3, 3\)"),
        (np.stack([np.eye(3)] * 2), r"expected one \(3, 3\)"),
    ],
)
def test_what_is_no_homography_is_refused_in_words(H, words):
    with pytest.raises(CvnotesError, match=words):
        homography_map(H)


def test_homographies_of_any_scale_and_unit_are_no_degenerate_ones():
    for scale in (1e-12, -1.0, 1e12):
        f = homography_map(scale * np.diag([1e-6, 1e6, 1]) @ TILTED)
        np.testing.assert_allclose(f([5, 7]), apply(TILTED, [5, 7]) * [1e-6, 1e6], rtol=1e-12)


@pytest.mark.parametrize(
    ("mapping", "error", "words"),
    [
        (np.zeros((4, 5)), ShapeError, r"expected shape \(height, width, 2\)"),
        (np.zeros((4, 5, 3)), ShapeError, r"\(\.\.\., 2\)"),
        (np.zeros((4, 5, 2), complex), InputTypeError, "complex128"),
        (lambda _: None, InputTypeError, "what the map gives"),
        (lambda m: m[:3], ShapeError, "the map turned pixels"),
        (lambda m: m[:, 0], ShapeError, "what the map gives"),
        (5, ShapeError, "expected shape"),
    ],
)
def test_what_is_no_map_is_refused_in_words(mapping, error, words):
    with pytest.raises(error, match=words):
        backward_warp(np.zeros((4, 5)), mapping)


def test_further_slips_are_refused_in_words():
    image = np.zeros((4, 5), np.uint8)
    with pytest.raises(ShapeError, match=r"\(height, width, 2\) = \(6, 7, 2\), got \(4, 5, 2\)"):
        backward_warp(image, np.zeros((4, 5, 2)), size=(7, 6))
    with pytest.raises(CvnotesError, match='method: expected "bilinear" or "nearest"'):
        backward_warp(image, zoom_map(2), method="cubic")
    with pytest.raises(CvnotesError, match='border: expected "constant"'):
        backward_warp(image, zoom_map(2), border="wrap")
    for fill in (300, -1, 0.5, np.nan):
        with pytest.raises(CvnotesError, match="is not a value of uint8"):
            backward_warp(image, zoom_map(2), fill=fill)
    with pytest.raises(CvnotesError, match="fill: expected a number, or 1"):
        backward_warp(image, zoom_map(2), fill=(1, 2, 3))
    with pytest.raises(ShapeError, match=r"5 × 4 but the camera's pictures are 320 × 240"):
        undistort_image(image, CAMERA)
    with pytest.raises(CvnotesError, match="positive number, got 0"):
        zoom_map(0)
    with pytest.raises(CvnotesError, match="positive side"):
        plane_map(np.eye(3), (0, 0), -1)
    with pytest.raises(CvnotesError, match="X0 < X1"):
        rectify_plane(image, np.eye(3), ((10, 0), (0, 10)), 1)
    with pytest.raises(InputTypeError, match="compose functions"):
        compose(zoom_map(2), grid(5, 4))
    with pytest.raises(CvnotesError, match="at least one"):
        compose()
    with pytest.raises(DegenerateError, match="singular"):
        rectify_plane(image, np.ones((3, 3)), ((0, 0), (1, 1)), 0.1)
    with pytest.raises(TypeError, match="unexpected keyword"):
        rectify_plane(image, np.eye(3), ((0, 0), (1, 1)), 0.1, methode="nearest")


def test_pictures_in_any_memory_order_are_read_and_none_is_written_to():
    image = noise(24, 31, np.uint16)
    image.setflags(write=False)
    table = map_array(homography_map(TILTED), (31, 24))
    table.setflags(write=False)
    before = table.copy()
    expected = backward_warp(image, table)
    for dress in (
        np.asfortranarray(image),
        np.repeat(image, 2, axis=0)[::2],
        image[:, ::-1][:, ::-1],
    ):
        np.testing.assert_array_equal(backward_warp(dress, table), expected)
    for dress in (table.tolist(), np.asfortranarray(table)):
        np.testing.assert_array_equal(backward_warp(image, dress), expected)
    backward_warp(image, PixelMap(lambda m_h: m_h[:2]))
    np.testing.assert_array_equal(table, before)


@pytest.fixture(params=["by OpenCV where it is exact", "by NumPy"])
def looked_up(request, monkeypatch):
    if request.param == "by NumPy":
        monkeypatch.setattr(undistortion, "_opencv_is_exact", lambda: False)


@pytest.mark.usefixtures("looked_up")
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
@pytest.mark.parametrize("channels", [(), (1,), (2,), (3,), (4,)])
@pytest.mark.parametrize("border", ["constant", "replicate", "reflect"])
def test_a_picture_is_undistorted_as_pixel_by_pixel(dtype, channels, border):
    rng = np.random.default_rng(3)
    wide, how = np.array([[60.0, 0, 48.2], [0, 60, 30.3], [0, 0, 1]]), {"border": border, "fill": 7}
    camera = Camera(intrinsics(80, 82, 48.1, 31), lens=Lens(k=(-0.2, 0.05)), size=(96, 64))
    mapping = undistortion_map(camera, wide)
    image = rng.integers(0, 256, (64, 96, *channels)).astype(dtype)[::-1]
    for method in ("bilinear", "nearest"):
        expected = backward_warp(image, mapping, size=(101, 61), method=method, **how)
        undistorted = undistort_image(image, camera, wide, size=(101, 61), method=method, **how)
        assert undistorted.dtype == dtype
        assert undistorted.shape == expected.shape
        off = np.abs(undistorted.astype(float) - expected)
        if dtype == np.float32:
            assert off.max() < 1e-4
        else:  # halves fall to either side
            assert off.max() <= 1
            assert (off > 0).mean() < 1e-3


def test_opencv_is_asked_where_it_does_not_round_positions(monkeypatch):
    exact = undistortion._opencv_is_exact()
    assert exact == (int(cv2.__version__.split(".")[0]) >= 5)
    remapped, remap = [], cv2.remap
    monkeypatch.setattr(cv2, "remap", lambda *how: remapped.append(how) or remap(*how))
    camera = Camera(intrinsics(80, 82, 48, 31), lens=Lens(k=(-0.2, 0.05)), size=(96, 64))
    undistort_image(np.zeros((64, 96), np.uint8), camera)
    assert bool(remapped) == exact
    asked = len(remapped)
    for dtype, how in ((np.uint16, {}), (np.uint8, {"method": "nearest"})):
        undistort_image(np.zeros((64, 96), dtype), camera, **how)
    assert len(remapped) == asked


@pytest.mark.parametrize("focal", [400, 600, 1000])
@pytest.mark.parametrize(
    "lens",
    [
        Lens(k=(-0.25, 0.1), p=(0.001, -0.0005)),
        Lens(k=(-0.3, 0.1, -0.02)),
        FisheyeLens(k=(0.02, -0.01, 0.003, -0.001)),
        RationalLens(k=(0.5, 0.1, 0.01, 0.8, 0.2, 0.02)),
    ],
    ids=lambda lens: lens.model,
)
def test_a_map_in_factors_is_the_map(lens, focal):
    camera = Camera(intrinsics(focal, focal, 330.2, 239.7), lens=lens, size=(640, 480))
    mapping = undistortion_map(camera)
    rows, columns = factored(mapping, (640, 480))
    assert np.abs(np.moveaxis(rows @ columns, 0, -1) - map_array(mapping, (640, 480))).max() < 1e-6


def test_a_map_with_a_fold_or_a_step_has_no_factors():
    folded = Camera(intrinsics(300, 300, 319.5, 239.5), lens=Lens(k=(-0.3,)), size=(640, 480))
    assert factored(undistortion_map(folded), (640, 480)) is None
    step = PixelMap(lambda m_h: m_h[:2] + (m_h[:1] > 300))
    assert factored(step, (640, 480)) is None
