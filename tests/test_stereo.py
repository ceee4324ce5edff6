import cv2
import numpy as np
import pytest
from differences import numerical_jacobian
from scipy.optimize import least_squares

from cvnotes.base import (
    CalibrationWarning,
    CvnotesError,
    DegenerateError,
    InputTypeError,
    ShapeError,
)
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import Problem
from cvnotes.camera import (
    Camera,
    FisheyeLens,
    Lens,
    chain,
    intrinsics,
    inverse,
    look_at,
    move,
    pose,
    px_from_xy,
    rotation_from_vector,
    vector_from_rotation,
)
from cvnotes.pictures import course
from cvnotes.stereo import (
    baseline,
    calibrate_stereo,
    disparity_to_depth,
    epipole,
    rectified_baseline,
    rectify,
    relative_pose,
    triangulate,
)
from cvnotes.stereo.calibration import refined
from cvnotes.stereo.refinement import StereoProblem, StereoState
from cvnotes.targets import Chessboard

SIZE = (640, 480)
BOARD = Chessboard((9, 6), 30.0)
LEFT = Camera(intrinsics(535, 533, 330, 238), lens=Lens(k=(-0.28, 0.08), p=(0.001, -0.0005)))
RIGHT = Camera(
    intrinsics(540, 541, 318, 247),
    pose(rotation_from_vector([0.02, -0.06, 0.01]), [-99.8, 2.1, 4.0]),
    Lens(k=(-0.27, 0.07), p=(-0.0004, 0.0007)),
)
SIDEWAYS = pose(np.eye(3), [-100, 0, 0])
IDEAL = Camera(intrinsics(800, 800, 320, 240))


def _scene(n=200, seed=0):
    """Points in front of the rig, most of them in both pictures."""
    rng = np.random.default_rng(seed)
    return rng.uniform([-250, -180, 500], [250, 180, 1200], (n, 3))


def _in_another_world(*cameras):
    G = pose(rotation_from_vector([0.5, -1.0, 2.0]), [1000, -300, 50])
    return [camera.moved(chain(camera.G, G)) for camera in cameras]


def _opencv_lens(camera):
    return np.array([*camera.lens.k, *camera.lens.p, 0.0])


# --- Epipolar geometry -------------------------------------------------------------------------


def test_the_relative_pose_takes_points_from_the_left_frame_to_the_right_one():
    left, right = _in_another_world(LEFT, RIGHT)
    W = _scene()
    M_left, M_right = move(left.G, W), move(right.G, W)
    np.testing.assert_allclose(move(relative_pose(left, right), M_left), M_right, atol=1e-9)
    np.testing.assert_allclose(relative_pose(left, right), RIGHT.G, atol=1e-10)


def test_the_baseline_leads_from_the_left_centre_to_the_right_one():
    np.testing.assert_allclose(baseline(IDEAL, IDEAL.moved(SIDEWAYS)), [100, 0, 0], atol=1e-12)
    left, right = _in_another_world(LEFT, RIGHT)
    np.testing.assert_allclose(left.centre + baseline(left, right), right.centre, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(baseline(left, right)), 99.9022, atol=1e-4)


def test_a_camera_ahead_is_seen_in_the_principal_point():
    forward = IDEAL.moved(pose(np.eye(3), [0, 0, -100]))
    np.testing.assert_allclose(epipole(IDEAL, forward), [320, 240, 1], atol=1e-12)


def test_cameras_side_by_side_have_their_epipole_at_infinity():
    e = epipole(IDEAL, IDEAL.moved(SIDEWAYS))
    assert e[2] == 0
    np.testing.assert_allclose(e[1] / e[0], 0, atol=1e-15)


@pytest.mark.parametrize("f", [epipole, baseline, rectify])
def test_a_baseline_of_zero_is_refused(f):
    left, turned = _in_another_world(
        LEFT, LEFT.moved(pose(rotation_from_vector([0, 1, 0]), [0, 0, 0]))
    )
    with pytest.raises(DegenerateError, match="baseline is zero"):
        f(left, turned)


# --- Triangulation -----------------------------------------------------------------------------


@pytest.mark.parametrize("refine", [True, False])
def test_exact_pixels_give_back_the_points(refine):
    cameras = _in_another_world(LEFT, RIGHT)
    W = _scene() @ cameras[0].R + cameras[0].centre
    m = np.stack([c.project(W) for c in cameras])
    np.testing.assert_allclose(triangulate(cameras, m, refine=refine), W, atol=1e-7)


def test_three_cameras_and_any_shape_of_points():
    above = LEFT.moved(look_at([0, -300, 0], [0, 0, 800]))
    W = _scene(24).reshape(4, 6, 3)
    cameras = [LEFT, RIGHT, above]
    m = np.stack([c.project(W) for c in cameras])
    np.testing.assert_allclose(triangulate(cameras, m), W, atol=1e-8)
    one = triangulate(cameras, m[:, 0, 0])
    np.testing.assert_allclose(one, W[0, 0], atol=1e-8)


def test_a_world_origin_far_away_costs_no_more_than_its_digits():
    far = pose(np.eye(3), [1e7, -2e7, 3e7])
    cameras = [c.moved(chain(c.G, far)) for c in (LEFT, RIGHT)]
    W = _scene() - [1e7, -2e7, 3e7]
    m = np.stack([c.project(W) for c in cameras])
    np.testing.assert_allclose(triangulate(cameras, m), W, atol=1e-4)


def test_refined_points_have_the_smallest_reprojection_error():
    rng = np.random.default_rng(0)
    W = _scene(20)
    cameras = [LEFT, RIGHT]
    m = np.stack([c.project(W) for c in cameras]) + rng.normal(0, 0.5, (2, 20, 2))
    refined, linear = triangulate(cameras, m), triangulate(cameras, m, refine=False)

    def residuals(X, i):
        return np.concatenate([c.project(X) - seen[i] for c, seen in zip(cameras, m, strict=True)])

    for i in range(len(W)):
        other = least_squares(
            residuals, linear[i], args=(i,), xtol=1e-15, ftol=1e-15, x_scale="jac"
        )
        np.testing.assert_allclose(refined[i], other.x, atol=2e-3)
        cost = (residuals(refined[i], i) ** 2).sum()
        assert cost <= (residuals(linear[i], i) ** 2).sum() + 1e-12
        assert cost <= 2 * other.cost + 1e-9


def test_opencv_triangulates_exact_points_alike():
    W = _scene()
    P = [np.hstack([np.eye(3), np.zeros((3, 1))]), RIGHT.G[:3]]
    xy = [c.ideal(c.project(W)) for c in (LEFT, RIGHT)]
    X = cv2.triangulatePoints(P[0], P[1], xy[0].T.copy(), xy[1].T.copy())
    m = np.stack([LEFT.project(W), RIGHT.project(W)])
    np.testing.assert_allclose(triangulate([LEFT, RIGHT], m), (X[:3] / X[3]).T, atol=1e-6)


def test_what_cannot_be_there_is_nan_and_leaves_the_others_alone():
    right = IDEAL.moved(SIDEWAYS)
    W = np.array([[30, 40, 500.0], [0, 0, 700]])
    m = np.stack([IDEAL.project(W), right.project(W)])
    parallel = [[[300, 200]], [[300, 200]]]
    behind = [[[300, 200]], [[310, 200]]]  # the rays diverge: they meet behind the cameras
    m = np.concatenate([m, parallel, behind], axis=1)
    X = triangulate([IDEAL, right], m)
    np.testing.assert_allclose(X[:2], W, atol=1e-8)
    assert np.isnan(X[2:]).all()


def test_points_very_far_away_keep_their_direction_and_their_digits():
    right = IDEAL.moved(SIDEWAYS)
    for depth in (1e5, 1e7, 1e9):  # up to ten million baselines
        W = np.array([[depth / 10, -depth / 20, depth], [0.2 * depth, 0, depth]])
        X = triangulate([IDEAL, right], np.stack([IDEAL.project(W), right.project(W)]))
        np.testing.assert_allclose(X / depth, W / depth, atol=1e-9 * depth / 100)


def test_noise_on_points_almost_at_infinity_leaves_the_best_point_or_none():
    right = IDEAL.moved(SIDEWAYS)
    rng = np.random.default_rng(0)
    W = 1e9 * rng.uniform([-0.3, -0.3, 0.5], [0.3, 0.3, 1], (300, 3))
    m = np.stack([IDEAL.project(W), right.project(W)])
    m += rng.normal(0, 1e-4, m.shape)
    X = triangulate([IDEAL, right], m)
    found = np.isfinite(X).all(-1)
    assert 0.5 < found.mean() < 0.9  # of the others the rays diverge
    cost = sum(
        ((c.project(X[found]) - m_i[found]) ** 2).sum(-1)
        for c, m_i in zip((IDEAL, right), m, strict=True)
    )
    # by hand: with equal rows, u fits exactly and the mean of the two v is the best
    smallest = (m[0, found, 1] - m[1, found, 1]) ** 2 / 2
    np.testing.assert_allclose(cost, smallest, atol=1e-14)


def test_a_pixel_out_of_the_lens_models_reach_gives_nan():
    camera = Camera(IDEAL.A, lens=Lens(k=(-0.5,)))
    m = np.array([[[300.0, 200], [5000, 200]], [[290, 200], [290, 200]]])
    X = triangulate([camera, camera.moved(SIDEWAYS)], m)
    assert np.isfinite(X[0]).all()
    assert np.isnan(X[1]).all()


def test_what_cannot_be_triangulated_is_refused_in_words():
    right = IDEAL.moved(SIDEWAYS)
    m = np.zeros((2, 5, 2))
    with pytest.raises(DegenerateError, match="baseline is zero"):
        triangulate([IDEAL, IDEAL], m)
    with pytest.raises(DegenerateError, match="at least 2 cameras, got 1"):
        triangulate([IDEAL], m[:1])
    with pytest.raises(ShapeError, match=r"expected \(2, ..., 2\).*got \(3, 5, 2\)"):
        triangulate([IDEAL, right], np.zeros((3, 5, 2)))
    with pytest.raises(InputTypeError, match=r"cameras\[0\]: expected a Camera, got ndarray"):
        triangulate([IDEAL.P, right.P], m)
    with pytest.raises(InputTypeError, match="several cameras"):
        triangulate(None, m)
    m[0, 3] = np.nan
    with pytest.raises(CvnotesError, match="NaN"):
        triangulate([IDEAL, right], m)


# --- Rectification -----------------------------------------------------------------------------


@pytest.mark.parametrize("keep", ["valid", "all"])
def test_rectified_partners_share_their_row(keep):
    left, right = _in_another_world(LEFT, RIGHT)
    W = _scene() @ left.R + left.centre
    pair = rectify(left, right, keep=keep)
    m_left, m_right = pair.left.project(W), pair.right.project(W)
    np.testing.assert_allclose(m_left[:, 1], m_right[:, 1], atol=1e-9)
    assert (m_left[:, 0] > m_right[:, 0]).all()
    assert pair.axis == 0
    assert pair.baseline == pytest.approx(np.linalg.norm(baseline(LEFT, RIGHT)))


def test_rectified_cameras_stand_where_the_given_ones_do_and_share_everything_else():
    pair = rectify(LEFT, RIGHT)
    np.testing.assert_allclose(pair.left.centre, LEFT.centre, atol=1e-10)
    np.testing.assert_allclose(pair.right.centre, RIGHT.centre, atol=1e-10)
    np.testing.assert_array_equal(pair.left.A, pair.right.A)
    np.testing.assert_array_equal(pair.left.R, pair.right.R)
    assert pair.left.lens.is_ideal
    assert pair.left.A[0, 0] == pair.left.A[1, 1]


def test_the_rotations_are_those_of_opencv():
    pair = rectify(LEFT, RIGHT)
    R1, R2 = cv2.stereoRectify(
        LEFT.A, _opencv_lens(LEFT), RIGHT.A, _opencv_lens(RIGHT), SIZE, RIGHT.R, RIGHT.T[:, None]
    )[:2]
    np.testing.assert_allclose(pair.left.R @ LEFT.R.T, R1, atol=1e-12)
    np.testing.assert_allclose(pair.right.R @ RIGHT.R.T, R2, atol=1e-12)


def test_both_cameras_are_turned_by_the_same_angle_where_the_baseline_allows_it():
    # cameras that converge symmetrically: each turns back by half of the angle between them
    toe_in = np.deg2rad(10)
    left = IDEAL.moved(
        look_at([-50, 0, 0], [-50 + 1000 * np.sin(toe_in), 0, 1000 * np.cos(toe_in)])
    )
    right = IDEAL.moved(look_at([50, 0, 0], [50 - 1000 * np.sin(toe_in), 0, 1000 * np.cos(toe_in)]))
    pair = rectify(left, right)
    np.testing.assert_allclose(pair.left.R, np.eye(3), atol=1e-12)


@pytest.mark.parametrize("keep", ["valid", "all"])
def test_the_maps_are_those_of_opencv(keep):
    pair = rectify(LEFT, RIGHT, keep=keep)
    both = ((LEFT, pair.left, pair.left_map), (RIGHT, pair.right, pair.right_map))
    for old, new, ours in both:
        theirs = cv2.initUndistortRectifyMap(
            old.A, _opencv_lens(old), new.R @ old.R.T, new.A, SIZE, cv2.CV_32FC1
        )
        assert ours.shape == (480, 640, 2)
        inside = np.isfinite(ours).all(-1)
        assert inside.mean() > 0.95
        np.testing.assert_allclose(ours[inside], np.stack(theirs, -1)[inside], atol=1e-4)


def test_a_rectified_pixel_shows_what_the_map_points_to():
    pair = rectify(LEFT, RIGHT)
    W = _scene(40)
    for new, old, table in (
        (pair.left, LEFT, pair.left_map),
        (pair.right, RIGHT, pair.right_map),
    ):
        m = new.project(W)
        inside = ((m >= 0) & (m <= [638, 478])).all(-1)
        assert inside.sum() > 10
        u, v = m[inside].astype(int).T
        du, dv = (m[inside] - np.stack([u, v], -1)).T[..., None]
        looked_up = (1 - dv) * ((1 - du) * table[v, u] + du * table[v, u + 1]) + dv * (
            (1 - du) * table[v + 1, u] + du * table[v + 1, u + 1]
        )
        np.testing.assert_allclose(looked_up, old.project(W)[inside], atol=1e-3)


def test_keep_valid_fills_both_pictures_and_touches_a_border():
    pair = rectify(LEFT, RIGHT)
    tables = np.stack([pair.left_map, pair.right_map])
    assert (tables >= 0).all()
    assert (tables <= [639, 479]).all()
    gap = np.min([tables.min((0, 1, 2)), [639, 479] - tables.max((0, 1, 2))])
    assert 0 < gap < 0.02


def test_keep_all_loses_nothing_of_either_photograph():
    pair = rectify(LEFT, RIGHT, keep="all")
    closest = np.inf
    for new, old in ((pair.left, LEFT), (pair.right, RIGHT)):
        u, v = np.meshgrid(np.arange(640), np.arange(480))
        rays = old.ray(np.stack([u, v], -1))
        m = px_from_xy(new.A, (rays @ new.R.T)[..., :2] / (rays @ new.R.T)[..., 2:])
        assert (m >= 0).all()
        assert (m <= [639, 479]).all()
        closest = min(closest, m.min(), ([639, 479] - m).min())
    assert 0 < closest < 0.02


def test_the_rectified_size_may_be_chosen():
    pair = rectify(LEFT, RIGHT, size=(320, 200))
    assert pair.left.size == pair.right.size == (320, 200)
    assert pair.left_map.shape == (200, 320, 2)
    assert (pair.left_map >= 0).all()
    assert (pair.left_map <= [639, 479]).all()


@pytest.mark.parametrize("size", [(0, 5), (1, 100), (10**6, 10**6), "640x480", (640.5, 480)])
def test_impossible_sizes_are_refused_before_anything_is_allocated(size):
    with pytest.raises(CvnotesError, match="size"):
        rectify(LEFT, RIGHT, size=size)


def test_left_and_right_exchanged_is_said_but_rows_stay_equal_and_pictures_upright():
    with pytest.warns(CalibrationWarning, match="left stands to the right.*negative"):
        pair = rectify(RIGHT, LEFT)
    W = _scene()
    m_left, m_right = pair.left.project(W), pair.right.project(W)
    np.testing.assert_allclose(m_left[:, 1], m_right[:, 1], atol=1e-9)
    assert (m_left[:, 0] < m_right[:, 0]).all()
    assert pair.baseline < 0
    assert np.trace(pair.left.R @ RIGHT.R.T) > 2.9  # hardly turned
    disparity = m_left[:, 0] - m_right[:, 0]
    depth = disparity_to_depth(disparity, pair.left, pair.right)
    np.testing.assert_allclose(depth, pair.left.depth(W), atol=1e-6)


def test_cameras_one_above_the_other_share_their_columns():
    below = LEFT.moved(pose(rotation_from_vector([0.02, 0.03, -0.01]), [2, -100, 3]))
    pair = rectify(LEFT, below)
    W = _scene()
    m_top, m_bottom = pair.left.project(W), pair.right.project(W)
    np.testing.assert_allclose(m_top[:, 0], m_bottom[:, 0], atol=1e-9)
    assert pair.axis == 1
    assert np.trace(pair.left.R) > 2.9
    R1 = cv2.stereoRectify(
        LEFT.A, _opencv_lens(LEFT), below.A, _opencv_lens(below), SIZE, below.R, below.T[:, None]
    )[0]
    np.testing.assert_allclose(pair.left.R, R1, atol=1e-12)
    depth = disparity_to_depth(m_top[:, 1] - m_bottom[:, 1], pair.left, pair.right)
    np.testing.assert_allclose(depth, pair.left.depth(W), atol=1e-6)
    with pytest.warns(CalibrationWarning, match="left stands below"):
        rectify(below, LEFT)


@pytest.mark.parametrize("T", [[0, 0, -100], [-10, 0, -100], [0, 5, 100], [-60, 0, -100]])
def test_one_camera_behind_the_other_is_refused(T):
    with pytest.raises(DegenerateError, match=r"one behind the other.*sideways"):
        rectify(LEFT, LEFT.moved(pose(np.eye(3), T)))


def test_cameras_that_see_all_that_is_before_them_are_rectified_as_far_as_a_flat_picture_shows():
    left = Camera(intrinsics(200, 200, 320, 240), lens=FisheyeLens(k=(0.01,)), size=SIZE)
    right = left.moved(RIGHT.G)
    pair = rectify(left, right)
    assert np.isfinite(pair.left_map).all()
    assert np.isfinite(pair.right_map).all()
    assert 100 < np.degrees(pair.left.field_of_view[0]) < 140
    W = _scene()
    rows = [camera.project(W)[:, 1] for camera in (pair.left, pair.right)]
    np.testing.assert_allclose(*rows, atol=1e-9)
    at = pair.left.project(W).round().astype(int)  # and the map leads to where the lens shows it
    seen = left.project(W)
    shown = pair.left_map[at[:, 1].clip(0, 479), at[:, 0].clip(0, 639)]
    inside = ((at >= 0) & (at < SIZE)).all(-1)
    assert inside.sum() > 150
    assert np.abs(shown - seen)[inside].max() < 1


def test_cameras_back_to_back_or_upside_down_to_each_other_are_not_rectified_in_silence():
    back = LEFT.moved(pose(rotation_from_vector([0, np.pi - 0.01, 0]), [-100, 0, 0]))
    with pytest.raises(DegenerateError):
        rectify(LEFT, back)


def test_strongly_converging_cameras_keep_a_part_or_everything():
    right = LEFT.moved(look_at([600, 0, 0], [0, 0, 600]))
    left = LEFT.moved(look_at([-600, 0, 0], [0, 0, 600]))
    with pytest.raises(DegenerateError, match="keep='all'"):
        rectify(left, right)
    pair = rectify(left, right, keep="all")
    W = _scene() * [0.3, 0.3, 0.2] + [0, 0, 400]
    np.testing.assert_allclose(pair.left.project(W)[:, 1], pair.right.project(W)[:, 1], atol=1e-9)


@pytest.mark.parametrize("keep", ["valid", "all"])
@pytest.mark.slow
def test_where_the_lens_model_ends_before_the_corner_the_pictures_end_too(keep):
    lens = Lens(k=(-0.5,))  # ends at a radius of 0.82, which is seen at 0.54
    wide = Camera(intrinsics(500, 500, 320, 240), lens=lens)
    assert np.isnan(wide.ideal([[0, 240], [0, 0]])).all()
    assert np.isfinite(wide.ideal([320, 0])).all()
    pair = rectify(wide, wide.moved(SIDEWAYS), keep=keep)
    assert np.isfinite(pair.left_map[240, 320]).all()
    assert np.isfinite(pair.left_map).all() == (keep == "valid")


@pytest.mark.parametrize("f", [relative_pose, baseline, epipole, rectify])
def test_what_is_no_camera_is_refused_by_its_name(f):
    with pytest.raises(InputTypeError, match="right: expected a Camera, got ndarray"):
        f(LEFT, RIGHT.P)
    with pytest.raises(InputTypeError, match="left: expected a Camera, got NoneType"):
        f(None, RIGHT)


def test_bad_rigs_are_refused_in_words():
    with pytest.raises(CvnotesError, match="keep: expected 'valid' or 'all', got 'most'"):
        rectify(LEFT, RIGHT, keep="most")
    for R, words in ((-np.eye(3), "det = -1"), (2 * np.eye(3), "not orthonormal")):
        G = np.eye(4)
        G[:3, :3], G[0, 3] = R, -100
        with pytest.raises(CvnotesError, match=words):
            rectify(LEFT, LEFT.moved(G))
    with pytest.raises(CvnotesError, match="NaN"):
        rectify(LEFT, LEFT.moved(pose(np.eye(3), [np.nan, 0, 0])))


# --- Disparity ---------------------------------------------------------------------------------


def test_disparity_gives_the_depth_in_the_unit_of_the_baseline():
    pair = rectify(LEFT, RIGHT)
    W = _scene()
    d = pair.left.project(W)[:, 0] - pair.right.project(W)[:, 0]
    depth = disparity_to_depth(d, pair.left, pair.right)
    np.testing.assert_allclose(depth, pair.left.depth(W), atol=1e-6)


def test_disparity_by_hand():
    # α = 800, b = 100: a point at 500 is displaced by 160 px
    right = IDEAL.moved(SIDEWAYS)
    np.testing.assert_allclose(disparity_to_depth([[160.0], [80]], IDEAL, right), [[500], [1000]])
    assert disparity_to_depth(0, IDEAL, right) == np.inf
    assert np.isnan(disparity_to_depth(-5, IDEAL, right))
    assert rectified_baseline(IDEAL, right) == (0, 100)


def test_only_a_rectified_pair_has_disparities():
    for right in (
        IDEAL.moved(pose(rotation_from_vector([0, 0.01, 0]), [-100, 0, 0])),
        IDEAL.moved(pose(np.eye(3), [-100, 5, 0])),
        IDEAL.moved(pose(np.eye(3), [0, 0, -100])),
        IDEAL,
        Camera(intrinsics(801, 800, 320, 240), SIDEWAYS),
        Camera(IDEAL.A, SIDEWAYS, Lens(k=(0.1,))),
    ):
        with pytest.raises(CvnotesError, match="not a rectified pair"):
            disparity_to_depth(3.0, IDEAL, right)
    with pytest.raises(CvnotesError, match="disparity contains NaN"):
        disparity_to_depth([1.0, np.nan], IDEAL, IDEAL.moved(SIDEWAYS))


# --- Stereo calibration ------------------------------------------------------------------------


def _boards(n=12, seed=3):
    """Poses of the board that both cameras see whole, and the exact corners in either picture."""
    rng = np.random.default_rng(seed)
    poses = []
    while len(poses) < n:
        G = pose(
            rotation_from_vector(rng.uniform(-0.6, 0.6, 3)),
            rng.uniform([-220, -160, 380], [60, 20, 700]),
        )
        seen = np.stack([c.moved(chain(c.G, G)).project(BOARD.points) for c in (LEFT, RIGHT)])
        if ((seen > 0) & (seen < SIZE)).all():
            poses.append(G)
    poses = np.array(poses)
    return poses, *(_seen(camera, poses) for camera in (LEFT, RIGHT))


def _seen(camera, poses):
    return np.stack([camera.moved(chain(camera.G, G)).project(BOARD.points) for G in poses])


POSES, SEEN_LEFT, SEEN_RIGHT = _boards()
LENS = "k1 k2 p1 p2"


def _noisy(sigma, rng):
    return [m + rng.normal(0, sigma, m.shape) for m in (SEEN_LEFT, SEEN_RIGHT)]


def test_exact_corners_give_back_the_whole_rig():
    rig = calibrate_stereo(BOARD.points, SEEN_LEFT, SEEN_RIGHT, SIZE, lens=LENS)
    for found, truth in zip(rig.cameras, (LEFT, RIGHT), strict=True):
        np.testing.assert_allclose(found.A, truth.A, atol=1e-6)
        np.testing.assert_allclose(found.lens.k, truth.lens.k, atol=1e-8)
        np.testing.assert_allclose(found.lens.p, truth.lens.p, atol=1e-9)
        np.testing.assert_allclose(found.G, truth.G, atol=1e-6)
    np.testing.assert_allclose(rig.poses, POSES, atol=1e-6)
    np.testing.assert_allclose(rig.G, RIGHT.G, atol=1e-6)
    assert rig.rms < 1e-8
    assert rig.reliable
    assert rig.warnings == ()


def _state(problem):
    def state(camera, p):
        return p.state(camera, POSES)

    return StereoState(
        state(LEFT, problem.left), state(RIGHT, problem.right).shared, RIGHT.R, RIGHT.T
    )


@pytest.mark.parametrize("what", ["cameras and G", "cameras, G and board"])
def test_the_joint_gradient_and_normal_matrix_are_those_of_the_residuals(what):
    few = slice(0, 2)
    rng = np.random.default_rng(0)
    W = BOARD.points[[0, 5, 20, 33, 53]]
    at = [0, 5, 20, 33, 53]
    names = ("k1", "k2", "p1", "p2")
    shape = rng.normal(0, 10, (3, 5, 3)) if "board" in what else None
    problem = StereoProblem(
        *(
            Problem(W, m[few, at] + rng.normal(0, 1, (2, 5, 2)), coefficients=names, shape=shape)
            for m in (SEEN_LEFT, SEEN_RIGHT)
        ),
    )
    x = _state(problem)
    x = x._replace(left=x.left._replace(R=x.left.R[few], T=x.left.T[few]))
    n_shared = len(problem.names) + problem.left.n_shape

    def residuals(step):
        y = problem.take_step(x, (step[:n_shared], step[n_shared:].reshape(2, 6)))
        parts = []
        for p, state in ((problem.left, y.left), (problem.right, y.of_right())):
            parts.append(-p.residuals(p.camera_of(state.shared), state).ravel())
        return np.concatenate(parts)

    J = numerical_jacobian(residuals, np.zeros(n_shared + 12), step=1e-5)
    r = residuals(np.zeros(n_shared + 12))
    cost, equations = problem.linearise(x)
    assert cost == pytest.approx(r @ r, rel=1e-12)
    N = J.T @ J
    scale = np.sqrt(np.outer(np.diag(N), np.diag(N)))
    dense = np.zeros_like(N)
    dense[:n_shared, :n_shared] = equations.shared
    for i in range(2):
        rows = slice(n_shared + 6 * i, n_shared + 6 * i + 6)
        dense[rows, rows] = equations.poses[i]
        dense[rows, :n_shared] = equations.border[i]
        dense[:n_shared, rows] = equations.border[i].T
    np.testing.assert_allclose(dense / scale, N / scale, atol=1e-6)
    gradient = np.concatenate([equations.g_shared, equations.g_poses.ravel()])
    np.testing.assert_allclose(
        gradient / np.sqrt(np.diag(N)), (J.T @ r) / np.sqrt(np.diag(N)), atol=1e-5
    )


def test_opencv_ends_at_the_same_rig():
    rng = np.random.default_rng(1)
    left, right = (m.astype(np.float32) for m in _noisy(0.3, rng))
    rig = calibrate_stereo(BOARD.points, left, right, SIZE, lens=LENS)
    rms, K1, d1, K2, d2, R, T = cv2.stereoCalibrate(
        [BOARD.points.astype(np.float32)] * len(left),
        list(left),
        list(right),
        rig.left.A.copy(),
        _opencv_lens(rig.left),
        rig.right.A.copy(),
        _opencv_lens(rig.right),
        SIZE,
        flags=cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_K3,
        criteria=(cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 300, 1e-15),
    )[:7]
    assert rig.rms == pytest.approx(rms, abs=1e-8)
    # 5.0 stops a little early: 1e-3 is 1/300 of the standard deviation
    np.testing.assert_allclose(rig.T, T.ravel(), atol=1e-3)
    np.testing.assert_allclose(rig.R, R, atol=1e-5)
    np.testing.assert_allclose(rig.left.A, K1, atol=5e-3)
    np.testing.assert_allclose(rig.right.A, K2, atol=5e-3)
    np.testing.assert_allclose(_opencv_lens(rig.left), d1.ravel()[:5], atol=1e-5)
    np.testing.assert_allclose(_opencv_lens(rig.right), d2.ravel()[:5], atol=1e-5)


@pytest.mark.sampling
def test_the_error_bars_are_honest():
    rng = np.random.default_rng(9)
    truth = np.concatenate(
        [[c.A[0, 0], c.A[1, 1], c.A[0, 2], c.A[1, 2], *c.lens.k, *c.lens.p] for c in (LEFT, RIGHT)]
    )
    z, d2 = [], []
    for _ in range(100):
        corners = _noisy(0.3, rng)
        pairs = tuple(Correspondences.of(BOARD.points, m) for m in corners)
        problem = StereoProblem(*(Problem.of(data, SIZE, LENS, skew=False) for data in pairs))
        rig = refined(problem, pairs, [LEFT, RIGHT])  # only the start is not asked about
        found = np.concatenate(
            [
                [c.A[0, 0], c.A[1, 1], c.A[0, 2], c.A[1, 2], *c.lens.k, *c.lens.p]
                for c in rig.cameras
            ]
        )
        off = np.concatenate([found - truth, _pose_error(rig)])
        z.append(off / np.array([*rig.std.values()]))
        d2.append(off @ np.linalg.solve(rig.covariance, off) / len(off))
    # standard error of the mean: √(2/22/100) = 0.030; four of those
    assert abs(np.mean(d2) - 1) < 0.12
    np.testing.assert_allclose(np.mean(z, axis=0), 0, atol=0.42)
    np.testing.assert_allclose(np.std(z, axis=0), 1, atol=0.29)


def _pose_error(rig):
    return np.concatenate([vector_from_rotation(rig.R @ RIGHT.R.T), rig.T - RIGHT.T])


def test_both_pictures_together_know_the_cameras_better_than_either_alone():
    from cvnotes.calibration import calibrate

    corners = _noisy(0.3, np.random.default_rng(4))
    rig = calibrate_stereo(BOARD.points, *corners, SIZE, lens=LENS)
    alone = calibrate(BOARD.points, corners[0], SIZE, lens=LENS)
    assert rig.std["left.alpha_u"] < alone.std["alpha_u"]


def test_centimetres_and_a_moved_board_frame_are_the_same_rig():
    corners = _noisy(0.3, np.random.default_rng(5))
    mm = calibrate_stereo(BOARD.points, *corners, SIZE, lens=LENS)
    cm = calibrate_stereo(0.1 * BOARD.points + [70, -30, 0], *corners, SIZE, lens=LENS)
    np.testing.assert_allclose(cm.left.A, mm.left.A, atol=1e-5)
    np.testing.assert_allclose(10 * cm.T, mm.T, atol=1e-5)
    assert 10 * cm.std["T_x"] == pytest.approx(mm.std["T_x"], rel=1e-6)
    assert cm.std["omega_x"] == pytest.approx(mm.std["omega_x"], rel=1e-6)


def test_boards_of_which_some_corners_are_hidden():
    kept = [np.arange(54)[i % 5 :] for i in range(len(POSES))]
    W = [BOARD.points[k] for k in kept]
    left = [m[k] for m, k in zip(SEEN_LEFT, kept, strict=True)]
    right = [m[k] for m, k in zip(SEEN_RIGHT, kept, strict=True)]
    rig = calibrate_stereo(W, left, right, SIZE, lens=LENS)
    np.testing.assert_allclose(rig.G, RIGHT.G, atol=1e-6)
    np.testing.assert_allclose(rig.poses, POSES, atol=1e-6)


def test_the_result_says_what_was_found():
    rig = calibrate_stereo(BOARD.points, *_noisy(0.3, np.random.default_rng(5)), SIZE, lens="k1 k2")
    text, html = repr(rig), rig._repr_html_()
    assert "12 pairs of views, 640×480 px" in text
    assert "T right ← left: -99." in text
    assert f"± {rig.std['T_x']:.2f}" in text  # two digits: 0.13
    assert "<table>" in html
    assert f"{rig.left.A[0, 0]:.1f}" in html
    assert rig.names[:4] == ("left.alpha_u", "left.alpha_v", "left.u0", "left.v0")
    assert rig.names[-6:] == ("omega_x", "omega_y", "omega_z", "T_x", "T_y", "T_z")
    total = np.sqrt((rig.view_rms**2).mean())
    assert rig.rms == pytest.approx(total, rel=1e-9)


def test_a_pair_numbered_from_the_other_end_in_one_picture_is_named():
    right = SEEN_RIGHT.copy()
    right[3] = right[3, ::-1]
    with pytest.warns(CalibrationWarning) as caught:
        rig = calibrate_stereo(BOARD.points, SEEN_LEFT, right, SIZE, lens="k1 k2")
    assert not rig.reliable
    assert rig.warnings[0].startswith("views 3 show the cameras turned by more than 10°")
    assert "numbered from the same corner" in str(caught[0].message)


def test_pictures_of_different_moments_are_noticed():
    with pytest.warns(CalibrationWarning):
        rig = calibrate_stereo(
            BOARD.points, SEEN_LEFT, np.roll(SEEN_RIGHT, 1, 0), SIZE, lens="k1 k2"
        )
    assert not rig.reliable


@pytest.mark.slow
def test_boards_that_are_all_parallel_are_not_believed():
    tilt = rotation_from_vector([0.3, 0.1, 0])
    poses = np.array([pose(tilt, [x, y, 600]) for x in (-150, -100) for y in (-100, -50)])
    seen = [_seen(c, poses) for c in (LEFT, RIGHT)]
    rng = np.random.default_rng(0)
    seen = [m + rng.normal(0, 0.2, m.shape) for m in seen]
    with pytest.warns(CalibrationWarning):
        rig = calibrate_stereo(BOARD.points, *seen, SIZE, lens="none")
    assert not rig.reliable
    for side in ("left", "right"):
        told = f"{side} camera: all boards are nearly parallel"
        assert any(sentence.startswith(told) for sentence in rig.warnings)


def test_what_is_no_set_of_pairs_is_refused_in_words():
    W = BOARD.points
    with pytest.raises(ShapeError, match="12 views but right_points has 11"):
        calibrate_stereo(W, SEEN_LEFT, SEEN_RIGHT[1:], SIZE)
    with pytest.raises(ShapeError, match="54 board points but 53"):
        calibrate_stereo(W, SEEN_LEFT, SEEN_RIGHT[:, 1:], SIZE)
    with pytest.raises(CvnotesError, match="lens: expected one of"):
        calibrate_stereo(W, SEEN_LEFT, SEEN_RIGHT, SIZE, lens="k9")
    with pytest.raises(CvnotesError, match=r"\(width, height\)"):
        calibrate_stereo(W, SEEN_LEFT, SEEN_RIGHT, (480,))
    with pytest.raises(DegenerateError, match="left camera: need at least 2 views"):
        calibrate_stereo(W, SEEN_LEFT[:1], SEEN_RIGHT[:1], SIZE)
    spoilt = SEEN_RIGHT.copy()
    spoilt[2, 7, 0] = np.nan
    with pytest.raises(CvnotesError, match="view 2, corner 7"):
        calibrate_stereo(W, SEEN_LEFT, spoilt, SIZE)


def test_a_calibrated_rig_measures_a_square():
    corners = _noisy(0.1, np.random.default_rng(6))
    rig = calibrate_stereo(BOARD.points, *corners, SIZE, lens=LENS)
    grid = triangulate(rig.cameras, np.stack(corners)).reshape(-1, 6, 9, 3)
    sides = np.linalg.norm(np.diff(grid, axis=2), axis=-1)
    assert sides.mean() == pytest.approx(30, abs=0.1)
    pair = rectify(*rig.cameras)
    to_world = inverse(pair.left.G)
    np.testing.assert_allclose(to_world[:3, 3], 0, atol=1e-9)


# --- Photographs -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def photographed():
    """Corners (2, 13, 54, 2) of a 9 × 6 board of 30 mm, measured in 13 pairs of photographs."""
    kept = course.real_corners()
    return np.array([kept.left, kept.right])


@pytest.fixture(scope="module")
def photographed_rig(photographed):
    return calibrate_stereo(BOARD.points, *photographed, SIZE, lens=LENS)


def test_the_published_rig_is_found_in_its_photographs(photographed_rig):
    rig = photographed_rig
    assert rig.reliable
    assert rig.rms < 0.2
    # J.-Y. Bouguet's toolbox, whose error bars are three standard deviations of 0.05, 0.04, 0.17
    assert (np.abs(rig.T - [-99.80, 1.12, 0.05]) < [0.15, 0.15, 0.5]).all()
    omega = vector_from_rotation(rig.R)
    np.testing.assert_allclose(omega, [0.00669, 0.00452, -0.00350], atol=0.003)
    assert rig.left.A[0, 0] == pytest.approx(533.0, abs=1.5)
    assert rig.right.A[0, 0] == pytest.approx(537.0, abs=1.5)
    np.testing.assert_allclose(
        [rig.std[f"T_{axis}"] for axis in "xyz"], [0.045, 0.036, 0.16], atol=0.02
    )


def test_a_board_that_is_not_flat_is_one_for_both_cameras(photographed, photographed_rig):
    free = calibrate_stereo(BOARD.points, *photographed, SIZE, lens=LENS, board="free")
    assert free.rms < 0.6 * photographed_rig.rms
    # 0.2 mm of a flat board are missing in depth; the published T_z is 0.05
    assert abs(free.T[2] - 0.05) < abs(photographed_rig.T[2] - 0.05)
    # what noise alone would allow differs by how free the board is, the scatter of pairs hardly
    honest = [rig.honest_std["baseline"] for rig in (free, photographed_rig)]
    assert 0.5 < honest[0] / honest[1] < 1
    assert honest[0] > 2 * free.std["T_x"]


def test_rectified_rows_of_the_photographs_agree(photographed, photographed_rig):
    pair = rectify(*photographed_rig.cameras)
    rows = []
    for new, old, m in zip(pair[:2], photographed_rig.cameras, photographed, strict=True):
        d = old.ray(m) @ new.R.T
        rows.append(px_from_xy(new.A, d[..., :2] / d[..., 2:])[..., 1])
    assert np.sqrt(((rows[0] - rows[1]) ** 2).mean()) < 0.15


def test_triangulated_squares_of_the_photographs_have_their_true_side(
    photographed, photographed_rig
):
    grid = triangulate(photographed_rig.cameras, photographed).reshape(-1, 6, 9, 3)
    sides = np.concatenate(
        [np.linalg.norm(np.diff(grid, axis=axis), axis=-1).ravel() for axis in (1, 2)]
    )
    assert sides.mean() == pytest.approx(30.0, abs=0.02)
    assert np.std(sides) < 0.2
