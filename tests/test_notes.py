"""The notes, formula by formula in their own order, with numbers that a reader can check by hand.

Where the printed form is wrong, the corrected one stands here and its erratum beside it; that the
printed form fails is shown in test_errata.py.
"""

import numpy as np
import pytest

from cvnotes.base import CvnotesError, DegenerateError, levenberg_marquardt, solve_dense
from cvnotes.calibration import (
    calibrate,
    constraints,
    extrinsics,
    intrinsics_from_b,
    radial_distortion,
    resect,
    solve_b,
    v_ij,
)
from cvnotes.camera import (
    Camera,
    Lens,
    board_from_board,
    cam_from_cam,
    intrinsics,
    intrinsics_from_pixel_size,
    move,
    nearest_rotation,
    pose,
    rotation_from_angles,
)
from cvnotes.homography import (
    design_matrix,
    dlt,
    four_points_h9_one,
    four_points_unit_norm,
    geometric_error,
    refine_homography,
)
from cvnotes.projective import (
    PLANE_AT_INFINITY,
    apply,
    direction_to_homogeneous,
    from_homogeneous,
    line_through,
    meet_plane,
    same_up_to_scale,
    to_homogeneous,
)
from cvnotes.stereo import disparity_to_depth, rectify
from cvnotes.targets import Chessboard, TwoPlanes
from cvnotes.warping import (
    backward_warp,
    bilinear,
    forward_warp,
    homography_map,
    interpolate,
    rotation_map,
    undistortion_map,
    zoom_map,
)

QUARTER_TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])  # about z: x becomes y
# a camera that can be computed with in the head: A, a turn about z, half a metre away
A = intrinsics(800, 804, 325, 238)
CAMERA = Camera(A, pose(QUARTER_TURN, [10, 20, 500]))


def equal(a, b, atol=1e-9):
    np.testing.assert_allclose(a, b, rtol=0, atol=atol)


# 2b.1 Perspective projection matrix


def test_a_point_may_be_multiplied_by_any_k_but_zero():
    assert from_homogeneous([10, 15, 20, 5]).tolist() == [2, 3, 4]  # k = 5, erratum E1
    assert same_up_to_scale([10, 15, 20, 5], [-2, -3, -4, -1])


def test_the_origin_is_0_0_0_k_and_four_zeros_are_undefined():
    assert from_homogeneous([0, 0, 0, 7]).tolist() == [0, 0, 0]  # erratum E2
    with pytest.raises(CvnotesError, match="stands for no point"):
        same_up_to_scale([0, 0, 0, 0], [0, 0, 0, 7])


def test_parallel_lines_share_a_point_of_the_plane_at_infinity():
    lines = [line_through([x, 0, 0, 1], [x + 1, 2, 3, 1]) for x in (0, 5)]  # both along (1, 2, 3)
    ends = np.array([meet_plane(line, PLANE_AT_INFINITY) for line in lines])
    assert all(same_up_to_scale(end, [1, 2, 3, 0]) for end in ends)
    assert direction_to_homogeneous([1.0, 2, 3]).tolist() == [1, 2, 3, 0]
    assert (ends @ PLANE_AT_INFINITY == 0).all()


def test_one_coordinate_more_works_in_any_dimension():
    for d in (1, 2, 3, 7):
        x = np.arange(1.0, d + 1)
        assert from_homogeneous(3 * to_homogeneous(x)).tolist() == x.tolist()


def test_u_is_f_x_over_z_and_v_is_f_y_over_z():
    seen = Camera(intrinsics(8, 8, 0, 0)).project([30, 20, 100])
    equal(seen, [2.4, 1.6])  # 8 · 30 / 100, 8 · 20 / 100


def test_in_homogeneous_coordinates_projection_is_linear_and_k_is_z():
    P = Camera(intrinsics(8, 8, 0, 0)).P
    assert P.tolist() == [[8, 0, 0, 0], [0, 8, 0, 0], [0, 0, 1, 0]]
    km = P @ [30, 20, 100, 1]
    assert km.tolist() == [240, 160, 100]
    assert same_up_to_scale(km, [2.4, 1.6, 1])  # erratum E4: ≈, not =


def test_the_vanishing_point_is_f_a_over_c_and_f_b_over_c():
    camera = Camera(intrinsics(8, 8, 0, 0))
    assert (camera.P @ [3, -1, 4, 0]).tolist() == [24, -8, 4]
    equal(camera.vanishing_point([3, -1, 4]), [6, -2])


def test_lines_parallel_to_the_image_plane_vanish_at_infinity():
    camera = Camera(intrinsics(8, 8, 0, 0))  # erratum E6: c = 0
    assert np.isnan(camera.vanishing_point([3, -1, 0])).all()
    assert same_up_to_scale(camera.P @ [3, -1, 0, 0], [3, -1, 0])


def test_lines_parallel_to_z_vanish_in_the_piercing_point():
    cosines = np.cos([np.pi / 2, np.pi / 2, 0])
    equal(Camera(intrinsics(8, 8, 0, 0)).vanishing_point(cosines), [0, 0])
    equal(Camera(A).vanishing_point(cosines), [325, 238])  # erratum E7


def test_with_f_1_the_PPM_is_canonical():
    assert Camera(np.eye(3)).P.tolist() == [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]


def test_distance_scales_and_f_scales_once_more():
    near, far = Camera(np.eye(3)).project([[30, 20, 100], [30, 20, 200]])
    equal(near, 2 * far)
    equal(Camera(intrinsics(8, 8, 0, 0)).project([30, 20, 100]), 8 * near)


# 2b.2 A more comprehensive camera model


def test_pixels_are_counted_from_the_corner_in_pixel_sizes():
    # 8 mm lens, pixels of 0.01 × 0.02 mm: 2.4 mm / 0.01 + 320, 1.6 mm / 0.02 + 240, erratum E8
    sensor = intrinsics_from_pixel_size(8, 0.01, 0.02, 320, 240)
    equal(Camera(sensor).project([30, 20, 100]), [560, 320])


def test_alpha_is_f_in_pixel_sizes_and_P_is_A_times_the_canonical_PPM():
    sensor = intrinsics_from_pixel_size(8, 0.01, 0.02, 320, 240)
    equal(sensor, [[800, 0, 320], [0, 400, 240], [0, 0, 1]])
    equal(Camera(sensor).P, [[800, 0, 320, 0], [0, 400, 240, 0], [0, 0, 1, 0]])


def test_axes_at_an_angle_have_a_skew():
    # cot 135° = −1, sin 135° = 1/√2, erratum E9
    sensor = intrinsics_from_pixel_size(8, 0.01, 0.02, 320, 240, angle=np.radians(135))
    equal(sensor, [[800, 800, 320], [0, 400 * np.sqrt(2), 240], [0, 0, 1]])


def test_a_world_point_is_rotated_and_then_translated_into_the_camera_frame():
    # R (1, 2, 3) = (−2, 1, 3), and + T = (8, 21, 503)
    assert move(CAMERA.G, [1, 2, 3]).tolist() == [8, 21, 503]
    assert (CAMERA.G @ [1, 2, 3, 1]).tolist() == [8, 21, 503, 1]
    assert CAMERA.G.tolist() == [[0, -1, 0, 10], [1, 0, 0, 20], [0, 0, 1, 500], [0, 0, 0, 1]]


def test_three_angles_make_a_rotation():
    half = np.pi / 2
    equal(rotation_from_angles(0, 0, half), QUARTER_TURN)
    # about x, then about z: y goes to z and stays; z goes to −y and then to x
    equal(rotation_from_angles(half, 0, half), [[0, 0, 1], [1, 0, 0], [0, 1, 0]])


def test_P_is_A_times_the_canonical_PPM_times_G():
    sensor, pinhole, G = CAMERA.factors
    equal(sensor @ pinhole @ G, CAMERA.P)
    by_hand = [
        [0, -800, 325, 800 * 10 + 325 * 500],
        [804, 0, 238, 804 * 20 + 238 * 500],
        [0, 0, 1, 500],
    ]
    equal(CAMERA.P, by_hand)  # A [R|T]


def test_T_is_the_worlds_origin_and_the_camera_stands_elsewhere():
    # −Rᵀ (10, 20, 500): R maps x to y, so Rᵀ maps y to x; erratum E11
    assert move(CAMERA.G, [0, 0, 0]).tolist() == [10, 20, 500]
    assert CAMERA.centre.tolist() == [-20, 10, -500]


# 2b.3 Lens distortion


def test_L_is_1_in_the_centre_and_has_even_powers():
    lens = Lens(k=(0.5, 0.25, 0.125))
    assert lens.L([0, 2]).tolist() == [1, 15]  # 1 + 4/2 + 16/4 + 64/8
    equal(lens.L(-2), 15)


def test_the_tangential_terms_are_added():
    # r² = 0.25: 2·0.01·0.12 + 0.02·(0.25 + 0.18) and 0.01·(0.25 + 0.32) + 2·0.02·0.12
    moved = Lens(p=(0.01, 0.02)).distort([0.3, 0.4]) - [0.3, 0.4]
    equal(moved, [0.011, 0.0105], atol=1e-15)


def test_r_is_the_distance_from_the_distortion_centre():
    # (0.4, 0.5) is (0.3, 0.4) away from (0.1, 0.1): L = 1 − 0.2 · 0.25, erratum E14
    lens = Lens(k=(-0.2,), centre=(0.1, 0.1))
    equal(lens.distort([0.4, 0.5]), [0.1 + 0.95 * 0.3, 0.1 + 0.95 * 0.4])
    equal(lens.distort([0.1, 0.1]), [0.1, 0.1])


def test_an_image_is_formed_in_four_steps():
    camera = Camera(A, CAMERA.G, Lens(k=(-0.2,)))
    W = [180, -140, 0]
    M = [150, 200, 500]  # 1. R W + T = (140 + 10, 180 + 20, 0 + 500)
    xy = [0.3, 0.4]  # 2. divided by z
    xy_lens = [0.285, 0.38]  # 3. L = 1 − 0.2 · 0.25 = 0.95
    m = [800 * 0.285 + 325, 804 * 0.38 + 238]  # 4. A (x', y', 1)ᵀ, erratum E16
    equal(move(camera.G, W), M)
    equal(camera.lens.distort(xy), xy_lens)
    equal(camera.project(W), m)


# 2b.4 Calibration


def test_n_views_have_4_intrinsics_a_lens_and_6_extrinsics_each(board, views_of):
    camera = Camera(A, lens=Lens(k=(-0.25, 0.1)))
    _, m = views_of(camera, 3, np.random.default_rng(0))
    found = calibrate(board.points, m, camera.size)
    assert found.names == ("alpha_u", "alpha_v", "u0", "v0", "k1", "k2")  # erratum E17: 4 + 6n + 2
    assert found.pose_covariance.shape == (3, 6, 6)


def test_one_picture_of_two_planes_is_enough_and_one_plane_is_not():
    target = TwoPlanes(Chessboard((4, 3), 25.0))
    camera = Camera(A, pose(rotation_from_angles(0.2, 0.9, 0.1), [0, 0, 600]))
    seen = camera.project(target.points)
    assert same_up_to_scale(resect(target.points, seen), camera.P)
    with pytest.raises(DegenerateError, match="plane"):
        resect(target.points[:12], seen[:12])


def test_the_WRF_lies_on_the_board():
    points = Chessboard((3, 2), 25.0).points
    assert points.tolist() == [
        [0, 0, 0],
        [25, 0, 0],
        [50, 0, 0],
        [0, 25, 0],
        [25, 25, 0],
        [50, 25, 0],
    ]


def test_the_counts_of_corners_differ_in_parity():
    with pytest.raises(CvnotesError, match="half a turn"):
        Chessboard((8, 6), 25.0)  # erratum E18: different, and yet ambiguous


def test_views_are_chained_through_what_they_share():
    about_x = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]  # a quarter turn: y becomes z
    first, other = pose(about_x, [0, 0, 500]), pose(QUARTER_TURN, [100, 0, 700])
    W, M = [25, 50, 0], [50, 25, 700]
    equal(move(other, W), M)
    # the board moved before one camera: M − (0, 0, 500) turned back about x, erratum E20
    equal(move(board_from_board(first, other), W), [50, 200, -25])
    # the camera moved before one board: the first camera sees W at (25, 0, 50) + (0, 0, 500)
    equal(move(cam_from_cam(first, other), M), [25, 0, 550])


def test_a_plane_is_seen_through_columns_1_2_4_of_P():
    H = CAMERA.P[:, [0, 1, 3]]  # erratum E21
    by_hand = [[0, -800, 170500], [804, 0, 135080], [0, 0, 500]]
    equal(H, by_hand)
    equal(apply(H, [180, -140]), CAMERA.project([180, -140, 0]))


def test_eight_of_nine_elements_are_independent():
    H = np.array([[2.0, 0, 1], [0, 3, 0], [1, 0, 1]])
    equal(apply(-5 * H, [1, 2]), apply(H, [1, 2]))
    equal(apply(H, [1, 2]), [1.5, 3])  # (3, 6) / 2


def test_the_cross_product_gives_three_rows_of_which_two_are_independent():
    X, u, v, o = np.array([1.0, 2, 1]), 1.5, 3.0, np.zeros(3)
    rows = np.array([[*o, *-X, *(v * X)], [*X, *o, *(-u * X)], [*(-v * X), *(u * X), *o]])
    h = [2, 0, 1, 0, 3, 0, 1, 0, 1]  # maps (1, 2) to (1.5, 3)
    equal(rows @ h, 0)
    equal(rows[2], -u * rows[0] - v * rows[1])
    equal(design_matrix([[1, 2]], [[u, v]]), rows[:2])


def test_m_corners_give_2m_rows_and_the_DLT_has_norm_1():
    H = np.array([[2.0, 0, 1], [0, 3, 0], [1, 0, 1]])
    src = np.array([[0.0, 0], [1, 0], [2, 0], [0, 2], [1, 1], [2, 2]])
    dst = np.array([[1.0, 0], [1.5, 0], [5 / 3, 0], [1, 6], [1.5, 1.5], [5 / 3, 2]])
    D = design_matrix(src, dst)
    assert D.shape == (12, 9)
    assert np.linalg.norm(D @ H.ravel()) < 1e-12  # the algebraic error
    equal(dlt(src, dst), H / 4)  # ‖H‖ = √(4 + 1 + 9 + 1 + 1)


def test_the_geometric_error_is_measured_after_dividing():
    H = np.array([[2.0, 0, 1], [0, 3, 0], [1, 0, 1]])
    for scale in (1, -7):  # erratum E25
        equal(geometric_error(scale * H, [[1, 2], [1, 2]], [[1.5, 3], [4.5, 7]]), [0, 5])


def test_refining_minimises_the_geometric_error():
    src = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]])
    dst = src + [[0, 0], [0, 0], [0, 0], [0, 0], [0.1, 0]]
    start = dlt(src, dst)
    refined = refine_homography(start, src, dst)
    costs = [np.sum(geometric_error(H, src, dst) ** 2) for H in (refined, start)]
    assert costs[0] < costs[1]
    for step in 1e-3 * np.eye(9).reshape(9, 3, 3):  # and no step in any entry lowers it
        for H in (refined + step, refined - step):
            assert np.sum(geometric_error(H, src, dst) ** 2) >= costs[0]


def test_four_pairs_are_8_equations_solved_with_h9_1_or_with_norm_1():
    src = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    assert design_matrix(src, 2 * src).shape == (8, 9)
    equal(four_points_h9_one(src, 2 * src), np.diag([2, 2, 1]))
    equal(four_points_unit_norm(src, 2 * src), np.diag([2, 2, 1]) / 3)  # h9 = 1 / √(4 + 4 + 1)


def test_neither_of_the_two_finds_an_h9_of_zero():
    # (x, y) ↦ (1, y) / x: the origin is seen at infinity, erratum E27
    src = np.array([[1.0, 0], [2, 0], [2, 2], [1, 3]])
    dst = np.array([[1, 0], [0.5, 0], [0.5, 1], [1, 3]])
    for solve in (four_points_h9_one, four_points_unit_norm):
        with pytest.raises(DegenerateError, match="h9 is zero"):
            solve(src, dst)
    assert same_up_to_scale(dlt(src, dst), [[0, 0, 1], [0, 1, 0], [1, 0, 0]])


# one view for Zhang's steps, of a board tilted about x by the angle with cosine 4/5 and sine 3/5
SENSOR = np.array([[2.0, 0, 1], [0, 2, 0], [0, 0, 1]])
TILTED = np.array([[1.0, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])
H_TILTED = SENSOR @ np.column_stack([TILTED[:, :2], [0.5, 0, 5]])
# B = A⁻ᵀ A⁻¹ with A⁻¹ = [½ 0 −½; 0 ½ 0; 0 0 1]
B_SENSOR = np.array([[0.25, 0, -0.25], [0, 0.25, 0], [-0.25, 0, 1.25]])
B_SIX = np.array([0.25, 0, 0.25, -0.25, 0, 1.25])  # B11 B12 B22 B13 B23 B33


def test_H_is_A_times_r1_r2_T_and_orthonormality_gives_two_constraints():
    equal(H_TILTED, [[2, 0.6, 6], [0, 1.6, 0], [0, 0.6, 5]])
    h1, h2, _ = H_TILTED.T
    equal(h1 @ B_SENSOR @ h2, 0)
    equal(h1 @ B_SENSOR @ h1, 1)
    equal(h2 @ B_SENSOR @ h2, 1)
    equal(constraints(H_TILTED[None]) @ B_SIX, 0)


def test_v_ij_is_linear_in_the_six_entries_of_B():
    H = np.array([[1.0, 4, 0], [2, 5, 0], [3, 6, 1]])
    equal(v_ij(H, 1, 2), [4, 13, 10, 18, 27, 18])  # 1·4, 1·5+2·4, 2·5, 1·6+3·4, 2·6+3·5, 3·6
    equal(v_ij(H, 1, 2) @ B_SIX, H[:, 0] @ B_SENSOR @ H[:, 1])


def test_n_views_give_2n_equations_whose_solution_is_b():
    turned = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])  # the same tilt, about y
    H = [H_TILTED, SENSOR @ np.column_stack([turned[:, :2], [0, 0.5, 4]])]
    V = constraints(H)
    assert V.shape == (4, 6)
    b = solve_b(V)  # two views, for the skew is zero: erratum E29
    equal(b, B_SIX / np.linalg.norm(B_SIX))  # ‖b‖ = 1, and the sign of B: erratum E30


def test_A_follows_from_b_of_any_scale_in_closed_form():
    for scale in (1, 1e-6, 40):
        equal(intrinsics_from_b(scale * B_SIX), SENSOR)


def test_the_pose_follows_from_A_and_H_of_any_scale():
    for scale in (1, -0.01, 300):  # erratum E32: λ by its size and by T_z > 0
        equal(extrinsics(SENSOR, scale * H_TILTED), pose(TILTED, [0.5, 0, 5]))


def test_an_imperfect_rotation_is_replaced_by_the_nearest():
    equal(nearest_rotation([[0, -1.1, 0], [0.9, 0, 0], [0, 0, 1.05]]), QUARTER_TURN)
    # a mirror has det = −1: its weakest axis is turned round, erratum E33
    equal(nearest_rotation(np.diag([1.2, 1.1, -0.3])), np.eye(3))


def test_distortion_moves_pixels_along_their_offset_from_the_piercing_point():
    # ũ = 725 is x̃ = 0.5, r² = 0.25: u' = 725 + (−0.25·0.25 + 0.1·0.0625) · 400, erratum E44
    camera = Camera(A, lens=Lens(k=(-0.25, 0.1)))
    equal(undistortion_map(camera)([725, 238]), [725 - 22.5, 238])


def test_k_is_found_by_linear_least_squares_from_the_ideal_radius():
    # on the unit circle every row of D is x̃ or ỹ, so k1 is the mean of the radial displacements
    G = pose(np.eye(3), [0, 0, 1])
    W, seen = [[1, 0, 0], [0, 1, 0]], [[1.1, 0], [0, 1.3]]
    equal(radial_distortion(np.eye(3), G, W, seen, terms=1), [0.2])  # (DᵀD)⁻¹ Dᵀd = 0.4 / 2
    # and r is that of the ideal point: k1 = 0.1 at r² = 4, where 2 is seen at 2.8, erratum E34
    equal(radial_distortion(np.eye(3), G, [[2, 0, 0]], [[2.8, 0]], terms=1), [0.1])


def test_the_MLE_minimises_the_reprojection_error_over_everything(board, views_of):
    camera = Camera(A, lens=Lens(k=(-0.25, 0.1)))
    rng = np.random.default_rng(1)
    poses, m = views_of(camera, 4, rng)
    seen = m + rng.normal(size=m.shape) * 0.2
    found = calibrate(board.points, seen, camera.size)

    def error(A, k, poses):
        views = [Camera(A, G, Lens(k=k)) for G in poses]
        return np.sum((seen - [view.project(board.points) for view in views]) ** 2)

    smallest = error(found.A, found.lens.k, found.poses)
    assert smallest < error(A, camera.lens.k, poses)  # the truth fits the noise less well
    for sign in (1, -1):  # and a step in any of A, k, R, T fits it less well, too
        for i, j in ((0, 0), (1, 1), (0, 2), (1, 2)):
            other = found.A.copy()
            other[i, j] += 0.1 * sign
            assert error(other, found.lens.k, found.poses) > smallest
        for dk in ([0.001, 0], [0, 0.001]):
            assert error(found.A, found.lens.k + sign * np.array(dk), found.poses) > smallest
        for step in 1e-3 * sign * np.eye(3):
            turned = pose(rotation_from_angles(*step), [0, 0, 0]) @ found.poses
            shifted = pose(np.eye(3), 100 * step) @ found.poses
            assert error(found.A, found.lens.k, turned) > smallest
            assert error(found.A, found.lens.k, shifted) > smallest


def test_levenberg_marquardt_walks_downhill_to_the_minimum():
    # (x² − 2)² from x = 1: the residual x² − 2 has the derivative 2x
    def linearise(x):
        J_and_r = np.array([[2 * x[0], x[0] ** 2 - 2]])
        return float(J_and_r[0, 1] ** 2), J_and_r.T @ J_and_r

    found = levenberg_marquardt(np.array([1.0]), linearise, solve_dense, np.add)
    equal(found.x, [np.sqrt(2)])


# 2b.5 Image warping

GREY = np.array([[10.0, 20], [40, 90]])


def test_a_warp_carries_grey_values_to_new_coordinates():
    moved = forward_warp(GREY, lambda m: m + [1, 2], (4, 5)).image
    assert moved[2:4, 1:3].tolist() == GREY.tolist()  # I'(u + 1, v + 2) = I(u, v)


def test_the_rotation_example_turns_u_towards_v():
    equal(rotation_map(np.pi / 2)([[1, 0], [0, 1]]), [[0, 1], [-1, 0]])  # erratum E38
    equal(rotation_map(np.arctan2(3, 4))([5, 0]), [4, 3])


def test_perspective_is_removed_by_a_homography_that_divides_by_its_third_row():
    # s = 1·1 + 1 = 2, erratum E39
    equal(homography_map([[2, 0, 1], [0, 3, 0], [1, 0, 1]])([1, 2]), [1.5, 3])


def test_forward_mapping_rounds_and_leaves_holes_and_folds():
    stretched = forward_warp(GREY[:1], lambda m: m * [2.6, 1], (4, 1))  # 0 ↦ 0, 1 ↦ 2.6 ≈ 3
    assert stretched.hits.tolist() == [[1, 0, 0, 1]]
    shrunk = forward_warp(GREY[:1], lambda m: m * [0.4, 1], (2, 1))  # 0 ↦ 0, 1 ↦ 0.4 ≈ 0
    assert (shrunk.holes, shrunk.folds) == (1, 1)


def test_backward_mapping_asks_for_every_pixel_once():
    stretched = backward_warp(GREY[:1], lambda m: m / [2, 1], size=(3, 1))
    assert stretched.tolist() == [[10, 15, 20]]  # u = 0, ½, 1


def test_nearest_neighbour_rounds_both_coordinates():
    asked = [[0.4, 0.4], [0.6, 0.4], [0.4, 0.6], [0.6, 0.6]]  # erratum E40
    assert interpolate(GREY, asked, method="nearest").tolist() == [10, 20, 40, 90]


def test_bilinear_interpolation_weighs_four_pixels():
    # I_a = 10 + 10/4 = 12.5, I_b = 40 + 50/4 = 52.5, half-way between them 32.5
    du, dv = np.array(0.25), np.array(0.5)
    equal(bilinear(*GREY.ravel(), du, dv), 32.5)
    weights = [(1 - du) * (1 - dv), du * (1 - dv), (1 - du) * dv, du * dv]
    equal(weights @ GREY.ravel(), 32.5)
    # a Δu + b Δv + c Δu Δv + d with c = I4 − I3 − I2 + I1, erratum E42
    equal(10 * du + 30 * dv + (90 - 40 - 20 + 10) * du * dv + 10, 32.5)
    equal(interpolate(GREY, [0.25, 0.5]), 32.5)


def test_a_zoom_by_nearest_repeats_pixels_and_by_bilinear_fills_between():
    row = GREY[:1]
    asked = {"size": (4, 1), "border": "replicate"}
    back = zoom_map(1 / 2)  # target pixels 0 … 3 come from −¼, ¼, ¾, 1¼
    assert backward_warp(row, back, method="nearest", **asked).tolist() == [[10, 10, 20, 20]]
    equal(backward_warp(row, back, **asked), [[10, 12.5, 17.5, 20]])


def test_a_lens_is_compensated_by_asking_where_it_put_each_ideal_pixel():
    # f = 2 px, principal point (2, 0), k1 = −1/2: ũ = 3 is x̃ = ½, and is seen at 3 − 1/8
    camera = Camera(intrinsics(2, 2, 2, 0), lens=Lens(k=(-0.5,)), size=(5, 1))
    ramp = np.array([[0.0, 100, 200, 300, 400]])
    straight = backward_warp(ramp, undistortion_map(camera))
    equal(straight[0, 1:4], [112.5, 200, 287.5])


def test_rectified_cameras_share_rows_and_depth_is_alpha_b_over_disparity():
    left = Camera(intrinsics(800, 800, 320, 240))
    right = left.moved(pose(rotation_from_angles(0.02, -0.1, 0.03), [-100, 4, 6]))
    pair = rectify(left, right)
    W = [[0, 0, 500.0], [-60, 40, 700]]
    m_left, m_right = pair.left.project(W), pair.right.project(W)
    equal(m_left[:, 1], m_right[:, 1])
    alpha, b = pair.left.A[0, 0], np.linalg.norm([100, 4, 6])
    equal(alpha * b / (m_left - m_right)[:, 0], pair.left.depth(W), atol=1e-6)
    depth = disparity_to_depth((m_left - m_right)[:, 0], pair.left, pair.right)
    equal(depth, pair.left.depth(W), atol=1e-6)
