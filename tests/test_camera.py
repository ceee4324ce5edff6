import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cvnotes.base import CvnotesError, DegenerateError, InputTypeError, ShapeError
from cvnotes.camera import (
    Camera,
    FisheyeLens,
    Lens,
    centre_of,
    decompose,
    intrinsics,
    intrinsics_from_pixel_size,
    look_at,
    pose,
    px_from_xy,
    rotation_from_vector,
    xy_from_px,
)
from cvnotes.pictures import render
from cvnotes.targets import Chessboard

RNG = np.random.default_rng(4)
A = intrinsics(800, 805, 320, 240, 0.7)
G = look_at([300, -200, -900], [50, 40, 0])
LENS = Lens(k=(-0.25, 0.1), p=(0.001, -0.0005))
# Hartley and Zisserman, 2nd ed., Example 6.2.
EXAMPLE_6_2 = np.array(
    [
        [3.53553e2, 3.39645e2, 2.77744e2, -1.44946e6],
        [-1.03528e2, 2.33212e1, 4.59607e2, -6.32525e5],
        [7.07107e-1, -3.53553e-1, 6.12372e-1, -9.18559e2],
    ]
)


# --- sensor --------------------------------------------------------------------------------------


def test_the_intrinsic_matrix_by_hand():
    assert A.tolist() == [[800, 0.7, 320], [0, 805, 240], [0, 0, 1]]


def test_focal_lengths_are_counted_in_pixels():
    # 12 mm before pixels of 5 µm × 6 µm; both columns of E8 shifted by the principal point
    A = intrinsics_from_pixel_size(12.0, 0.005, 0.006, 640, 480)
    np.testing.assert_allclose(A, [[2400, 0, 640], [0, 2000, 480], [0, 0, 1]], rtol=1e-15)


def test_slanted_axes_skew_the_picture_and_stretch_v():
    # the point (x, y) of the sensor is u du e_u + v dv e_v, with e_v at the angle θ to e_u
    f, du, dv, angle = 8.0, 0.01, 0.02, np.deg2rad(80)
    axes = np.array([[du, dv * np.cos(angle)], [0, dv * np.sin(angle)]])
    xy = RNG.normal(size=(20, 2))
    by_hand = (np.linalg.inv(axes) @ (f * xy).T).T + [320, 240]
    A = intrinsics_from_pixel_size(f, du, dv, 320, 240, angle=angle)
    np.testing.assert_allclose(px_from_xy(A, xy), by_hand, atol=1e-10)
    assert A[0, 1] == pytest.approx(-800 / np.tan(angle))
    assert A[1, 1] == pytest.approx(400 / np.sin(angle))


def test_right_angles_have_no_skew_at_all():
    assert intrinsics_from_pixel_size(8, 0.01, 0.01, 0, 0)[0, 1] == 0


@given(u=st.floats(-1e4, 1e4), v=st.floats(-1e4, 1e4), skew=st.floats(-10, 10))
def test_pixels_and_image_coordinates_undo_each_other(u, v, skew):
    A = intrinsics(800, 700, 320, 240, skew)
    np.testing.assert_allclose(px_from_xy(A, xy_from_px(A, [u, v])), [u, v], atol=1e-11)


# --- projection ----------------------------------------------------------------------------------


def test_a_projection_by_hand():
    camera = Camera(intrinsics(100, 200, 10, 20, skew=5), pose(np.eye(3), [0, 0, 2]))
    # (1, 1, 2) in the CRF: x = y = 1/2
    assert camera.project([1, 1, 0]).tolist() == [10 + 50 + 2.5, 20 + 100]
    assert camera.depth([1, 1, 0]) == 2


def test_P_and_the_four_steps_agree_through_a_perfect_lens():
    camera = Camera(A, G)
    W = RNG.normal(scale=100, size=(50, 3))
    m_h = np.concatenate([W, np.ones((50, 1))], 1) @ camera.P.T
    np.testing.assert_allclose(camera.project(W), m_h[:, :2] / m_h[:, 2:], atol=1e-10)


def test_P_is_its_three_factors_multiplied():
    camera = Camera(A, G)
    sensor, pinhole, motion = camera.factors
    assert pinhole.tolist() == [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]
    np.testing.assert_allclose(sensor @ pinhole @ motion, camera.P, atol=0)
    assert Camera(np.eye(3)).P.tolist() == pinhole.tolist()  # the canonical PPM


def test_opencv_projects_to_the_same_pixels():
    camera = Camera(intrinsics(800, 805, 320, 240), G, LENS)  # OpenCV knows no skew
    W = RNG.normal(scale=100, size=(50, 3))
    rvec = cv2.Rodrigues(camera.R)[0]
    coefficients = np.array([*LENS.k, *LENS.p])
    theirs = cv2.projectPoints(W, rvec, camera.T, camera.A, coefficients)[0].reshape(-1, 2)
    np.testing.assert_allclose(camera.project(W), theirs, atol=1e-9)


def test_a_ray_meets_what_its_pixel_shows():
    camera = Camera(A, G, LENS)
    W = RNG.normal(scale=100, size=(50, 3))
    d = camera.ray(camera.project(W))
    along = np.linalg.norm(W - camera.centre, axis=1, keepdims=True)
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1, atol=1e-15)
    np.testing.assert_allclose(camera.centre + along * d, W, atol=1e-10)


def test_what_is_not_before_the_camera_has_no_image():
    camera = Camera(A)
    W = [[0, 0, 1], [0, 0, 0], [1, 1, 0], [0.1, 0.1, -1], [0, 0, 1e-300]]
    assert np.isnan(camera.project(W)).all(axis=1).tolist() == [False, True, True, True, False]


def test_what_the_lens_does_not_reach_has_no_image():
    camera = Camera(A, lens=Lens(k=(-4 / 3,)))  # folds at r = 0.5
    assert np.isnan(camera.project([[0.49, 0, 1], [0.51, 0, 1]])).tolist() == [[0, 0], [1, 1]]
    assert np.isnan(camera.ray([[320 + 700, 240], [321, 240]])).all(axis=1).tolist() == [1, 0]


def test_points_a_million_kilometres_away_keep_their_digits():
    camera = Camera(intrinsics(800, 800, 320, 240))
    np.testing.assert_allclose(camera.project([1e12, -2e12, 4e12]), [520, -160], atol=1e-9)


def test_the_camera_stands_where_P_has_no_image():
    camera = Camera(A, G)
    np.testing.assert_allclose(camera.centre, [300, -200, -900], atol=1e-10)
    assert np.abs(camera.centre - camera.T).max() > 100  # erratum E11
    np.testing.assert_allclose(camera.P @ [*camera.centre, 1], 0, atol=1e-9)


def test_parallel_lines_meet_on_their_vanishing_point():
    camera = Camera(A, G)
    d = np.array([0.3, -0.2, 0.9])
    starts = RNG.normal(scale=100, size=(5, 3))
    far = camera.project(starts + 1e9 * d)
    np.testing.assert_allclose(far, np.tile(camera.vanishing_point(d), (5, 1)), atol=1e-3)
    np.testing.assert_allclose(camera.vanishing_point(-2 * d), camera.vanishing_point(d), atol=1e-9)


def test_the_optical_axis_vanishes_in_the_piercing_point_and_the_image_plane_nowhere():
    camera = Camera(A)
    np.testing.assert_allclose(camera.vanishing_point([0, 0, -1]), [320, 240], atol=1e-13)
    assert np.isnan(camera.vanishing_point([[1, 0, 0], [0.6, 0.8, 0]])).all()  # erratum E6


def test_the_field_of_view_is_twice_the_arctangent_of_half_the_width_over_f():
    camera = Camera(intrinsics(5, 4, 4.5, 2.5), size=(10, 6))  # from −½ to 9½, and to 5½
    horizontal, vertical = camera.field_of_view
    assert horizontal == pytest.approx(2 * np.arctan(5 / 5))
    assert vertical == pytest.approx(2 * np.arctan(3 / 4))


def test_a_lens_that_folds_inside_the_picture_is_found_out():
    wide = Camera(intrinsics(300, 300, 319.5, 239.5), lens=Lens(k=(-0.4,)), size=(640, 480))
    tele = Camera(intrinsics(800, 800, 319.5, 239.5), lens=Lens(k=(-0.4,)), size=(640, 480))
    # the corner is at r' = 400/300 or 400/800; the lens shows nothing beyond 2/3 · 0.913 = 0.609
    assert not wide.is_invertible
    assert tele.is_invertible


def test_a_moved_camera_keeps_all_but_its_place():
    camera = Camera(A, G, LENS, (320, 200))
    moved = camera.moved(np.eye(4))
    assert moved.centre.tolist() == [0, 0, 0]
    assert (moved.A == A).all()
    assert (moved.lens, moved.size) == (LENS, (320, 200))


# --- decomposition -------------------------------------------------------------------------------


def test_hartley_and_zissermans_example_6_2():
    A, R, T = decompose(EXAMPLE_6_2)
    np.testing.assert_allclose(A, [[468.2, 91.2, 300], [0, 427.2, 200], [0, 0, 1]], atol=0.05)
    np.testing.assert_allclose(-R.T @ T, [1000, 2000, 1500], atol=0.01)
    centre = centre_of(EXAMPLE_6_2)
    np.testing.assert_allclose(centre[:3] / centre[3], [1000, 2000, 1500], atol=0.01)


@pytest.mark.parametrize("scale", [1, -1, 1e-9, -1e9, 1e100])
def test_a_projection_matrix_of_any_scale_and_sign_falls_into_its_factors(scale):
    for _ in range(20):
        alpha, v = RNG.uniform(100, 3000, 2), RNG.normal(scale=500, size=3)
        A = intrinsics(*alpha, *v)
        R, T = rotation_from_vector(RNG.normal(size=3)), RNG.normal(scale=100, size=3)
        A_, R_, T_ = decompose(scale * A @ np.column_stack([R, T]))
        np.testing.assert_allclose(A_, A, rtol=1e-11, atol=1e-9)
        np.testing.assert_allclose(R_, R, atol=1e-11)
        np.testing.assert_allclose(T_, T, atol=1e-9)
        assert np.linalg.det(R_) == pytest.approx(1)


def test_opencv_decomposes_to_the_same_where_its_signs_are_right():
    A, R, T = decompose(EXAMPLE_6_2)
    A_, R_, C_ = cv2.decomposeProjectionMatrix(EXAMPLE_6_2)[:3]
    np.testing.assert_allclose(A, A_ / A_[2, 2], atol=1e-9)
    np.testing.assert_allclose(R, R_, atol=1e-12)
    np.testing.assert_allclose(-R.T @ T, (C_[:3] / C_[3]).ravel(), atol=1e-8)


@pytest.mark.parametrize(
    ("P", "words"),
    [
        (np.zeros((3, 4)), "non-zero"),
        (np.ones((3, 4)), "singular"),
        (np.diag([1.0, 1, 0, 0])[:3] + np.eye(3, 4, 3), "singular.*at infinity"),
        (np.array([[1.0, 0, 0, 5], [0, 1, 0, 6], [0, 0, 0, 1]]), "camera is at infinity"),  # affine
    ],
)
def test_a_matrix_of_no_finite_camera_is_not_decomposed(P, words):
    with pytest.raises(DegenerateError, match=words):
        decompose(P)


def test_an_affine_camera_has_its_centre_at_infinity():
    centre = centre_of([[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 0, 1]])
    np.testing.assert_allclose(centre, [0, 0, 1, 0], atol=1e-15)


def test_a_matrix_of_too_low_rank_has_no_centre():
    with pytest.raises(DegenerateError, match="rank below 3"):
        centre_of(np.outer([1, 2, 3], [1, 2, 3, 4]))


# --- guards --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (np.zeros((3, 3)), r"A\[2, 2\] = 0 but must be 1"),
        (A.T, r"A\[1, 0\] = 0.7 .*transposed"),
        (np.diag([0, 800, 1]), r"A\[0, 0\] = alpha_u = 0 but must be positive"),
        (np.diag([800, -800, 1]), r"A\[1, 1\] = alpha_v = -800 but must be positive"),
        (A + [[0, 0, 0], [1e-3, 0, 0], [0, 0, 0]], r"A\[1, 0\] = 0.001"),
        (2.5 * A, r"A\[2, 2\] = 2.5 but must be 1; divide A by it"),
        (A[:2], r"expected shape \(3, 3\), got \(2, 3\)"),
        (np.stack([A, A]), r"expected one \(3, 3\) matrix"),
        (A * np.nan, "A contains NaN"),
        (None, "A: expected numbers, got None"),
    ],
)
def test_what_is_no_intrinsic_matrix_is_refused_naming_the_entry(matrix, words):
    for function in (Camera, lambda A: px_from_xy(A, [0, 0]), lambda A: xy_from_px(A, [0, 0])):
        with pytest.raises((CvnotesError, InputTypeError), match=words):
            function(matrix)


@pytest.mark.parametrize(
    "size",
    [None, "640x480", (640,), (640, 480, 3), (0, 480), (-640, 480), (640.5, 480), (np.nan, 1)],
)
def test_what_is_no_size_is_refused(size):
    with pytest.raises(CvnotesError, match=r"size: expected \(width, height\)"):
        Camera(A, size=size)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"G": np.stack([G, G])}, "one pose"),
        ({"G": np.diag([1, 1, -1, 1.0])}, "rotation in G has det = -1"),
        ({"G": G[:3]}, r"G: expected shape \(4, 4\), got \(3, 4\)"),
        ({"lens": (-0.1, 0.2)}, "lens: expected a Lens, got tuple"),
    ],
)
def test_what_is_no_pose_or_lens_is_refused(arguments, words):
    with pytest.raises(CvnotesError, match=words):
        Camera(A, **arguments)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((0, 0.01, 0.01), "f: expected a positive number, got 0"),
        ((8, -0.01, 0.01), "du: expected a positive"),
        ((8, 0.01, np.nan), "dv contains NaN"),
    ],
)
def test_impossible_pixels_are_refused(arguments, words):
    with pytest.raises(CvnotesError, match=words):
        intrinsics_from_pixel_size(*arguments, 320, 240)
    with pytest.raises(CvnotesError, match="degrees"):
        intrinsics_from_pixel_size(8, 0.01, 0.01, 320, 240, angle=90)


@pytest.mark.parametrize("method", ["project", "depth", "vanishing_point", "ray", "ideal"])
def test_unusable_points_are_refused_in_words(method):
    call = getattr(Camera(A, G, LENS), method)
    d = 2 if method in ("ray", "ideal") else 3
    with pytest.raises(ShapeError, match=rf"expected shape \(\.\.\., {d}\), got \(5, 4\)"):
        call(np.zeros((5, 4)))
    with pytest.raises(ShapeError, match="points are rows here, so transpose it"):
        call(np.zeros((d, 54)))
    with pytest.raises(CvnotesError, match="contains NaN"):
        call([np.nan] * d)
    with pytest.raises(InputTypeError, match="numeric"):
        call(["a"] * d)
    assert len(call(np.zeros((0, d)))) == 0


def test_a_camera_cannot_be_written_to():
    camera = Camera(A, G)
    for array in (camera.A, camera.G, camera.P):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1
    with pytest.raises(AttributeError):
        camera.size = (1, 1)


def test_integer_pixels_are_not_computed_in_integers():
    camera = Camera(A, G, LENS)
    m = np.array([[100, 200], [600, 30]], dtype=np.uint16)
    np.testing.assert_array_equal(camera.ray(m), camera.ray(m.astype(float)))


def test_a_fisheyes_field_of_view_may_be_more_than_half_of_all_directions():
    camera = Camera(intrinsics(100, 100, 199.5, 149.5), lens=FisheyeLens(), size=(400, 300))
    assert camera.field_of_view == pytest.approx((4.0, 3.0))  # r = f θ: 400 px, 100 px a radian


def test_the_field_of_view_is_the_angle_between_the_border_rays_however_the_camera_is_turned():
    camera = Camera(intrinsics(500, 400, 99.5, 239.5), G, size=(1200, 480))
    right, down = np.arctan(1100 / 500), np.arctan(240 / 400)
    assert camera.field_of_view == pytest.approx((np.arctan(100 / 500) + right, 2 * down))


# --- a part of a picture, and a picture made smaller -----------------------------------------

CROSSING = Chessboard((9, 6), 25.0)
HELD = Camera(A, look_at([150, 40, -330], [100, 62, 0]), LENS)


def test_a_part_of_a_picture_is_the_picture_of_the_cropped_camera():
    whole = render(CROSSING, HELD, blur=0.7)
    part = HELD.cropped((150, 90), (300, 200))
    cut = whole[90:290, 150:450].astype(float)
    assert np.abs(render(CROSSING, part, blur=0.7) - cut).max() <= 1  # grey level: a rounded half
    m = HELD.project(CROSSING.points)
    np.testing.assert_allclose(part.project(CROSSING.points), m - [150, 90], atol=1e-9)


@pytest.mark.parametrize("size", [(320, 240), (160, 240), (128, 96)])
def test_a_picture_averaged_to_a_smaller_one_is_the_picture_of_the_resized_camera(size):
    whole = render(CROSSING, HELD).astype(float)
    a, b = 640 // size[0], 480 // size[1]
    means = whole.reshape(size[1], b, size[0], a).mean(axis=(1, 3))
    small = render(CROSSING, HELD.resized(size)).astype(float)
    assert np.abs(means - small).max() <= 1  # grey level: both are rounded


@pytest.mark.parametrize("size", [(320, 240), (800, 480), (1280, 960)])
def test_opencv_resizes_pictures_by_the_same_rule(size):
    u, v = np.meshgrid(np.arange(640.0), np.arange(480.0))
    inner = (slice(8, -8), slice(8, -8))  # at the border it repeats the outermost pixels
    seen = [cv2.resize(x, size, interpolation=cv2.INTER_LINEAR)[inner] for x in (u, v)]
    m = np.stack(np.meshgrid(np.arange(size[0]), np.arange(size[1])), -1)[inner]
    ideal = Camera(A)
    rays = ideal.resized(size).ray(m)
    np.testing.assert_allclose(ideal.project(rays), np.stack(seen, -1), atol=2e-3)  # px; cv2: /2048


def test_a_picture_resized_and_resized_back_has_its_first_camera():
    there = HELD.resized((1000, 240))
    assert there.size == (1000, 240)
    np.testing.assert_allclose(there.resized(HELD.size).A, HELD.A, atol=1e-9)
    assert there.lens is HELD.lens
    assert there.A[0, 1] == pytest.approx(0.7 * 1000 / 640)  # the skew moves along u


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (((400, 0), (320, 240)), r"320 × 240 from pixel \(400, 0\) on is not inside .* 640 × 480"),
        (((0, -1), (320, 240)), "row before column"),
        (((0.5, 0), (320, 240)), "two whole numbers"),
        (((0, 0), (0, 240)), "two positive whole numbers"),
    ],
)
def test_a_part_that_is_no_part_is_refused(arguments, words):
    with pytest.raises(CvnotesError, match=words):
        HELD.cropped(*arguments)
