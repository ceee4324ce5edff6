from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares

from cvnotes.base import CvnotesError, DegenerateError, ShapeError
from cvnotes.camera import (
    Camera,
    focal_length,
    horizon,
    intrinsics,
    intrinsics_from_vanishing_points,
    look_at,
    rotation_from_vector,
    vanishing_point,
)
from cvnotes.projective import from_homogeneous, join, same_up_to_scale

CAMERA = Camera(intrinsics(800, 800, 322, 238), look_at([700, -500, -900], [0, 0, 0]))


def parallel_segments(camera, d, count, rng, spread=300.0):
    """Pictures (count, 2, 2) of parallel segments of different lengths."""
    d = np.array(d) / np.linalg.norm(d)
    starts = rng.uniform(-spread, spread, (count, 3))
    ends = starts + rng.uniform(100, 400, (count, 1)) * d
    return np.stack([camera.project(starts), camera.project(ends)], axis=1)


# --- vanishing points ----------------------------------------------------------------------------


@pytest.mark.parametrize("count", [2, 3, 20])
@pytest.mark.parametrize("d", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -2, 0.5)])
def test_exact_segments_meet_in_the_image_of_their_direction(count, d):
    segments = parallel_segments(CAMERA, d, count, np.random.default_rng(1))
    v = from_homogeneous(vanishing_point(segments))
    np.testing.assert_allclose(v, CAMERA.vanishing_point(d), atol=1e-6)


def test_segments_that_are_parallel_in_the_picture_too_vanish_at_infinity():
    camera = Camera(CAMERA.A)
    rng = np.random.default_rng(2)
    starts = rng.uniform(-100, 100, (6, 3)) + [0, 0, 800]
    lengths = np.array([50, 80, 120, 30, 90, 60.0])[:, None]
    d = np.array([0.6, 0.8, 0])  # parallel to the image plane
    segments = np.stack([camera.project(starts), camera.project(starts + lengths * d)], axis=1)
    v = vanishing_point(segments)
    assert same_up_to_scale(v, [0.6, 0.8, 0], atol=1e-12)


def test_the_sides_and_diagonals_of_a_board_vanish_in_the_columns_of_its_homography():
    H = CAMERA.A @ CAMERA.G[:3][:, [0, 1, 3]]
    columns = from_homogeneous([H[:, 0], H[:, 1], H[:, 0] + H[:, 1], H[:, 0] - H[:, 1]])
    d = [[1, 0, 0], [0, 1, 0], [1, 1, 0], [1, -1, 0]]
    np.testing.assert_allclose(columns, CAMERA.vanishing_point(d), rtol=1e-9)


def test_neither_the_order_of_the_ends_nor_the_place_of_the_origin_matters():
    rng = np.random.default_rng(3)
    segments = parallel_segments(CAMERA, (1, 0, 0.2), 8, rng) + rng.normal(size=(8, 2, 2))
    v = from_homogeneous(vanishing_point(segments))
    np.testing.assert_allclose(from_homogeneous(vanishing_point(segments[:, ::-1])), v, atol=1e-5)
    np.testing.assert_allclose(
        from_homogeneous(vanishing_point(10 * segments[::-1] + 5000)), 10 * v + 5000, atol=1e-4
    )


def distances(v, segments):
    """Distances of the first ends from the lines through the middles and v, written out."""
    middle = segments.mean(axis=1)
    along = (v - middle) / np.linalg.norm(v - middle, axis=1, keepdims=True)
    offset = segments[:, 0] - middle
    return offset[:, 0] * along[:, 1] - offset[:, 1] * along[:, 0]


def test_no_other_point_is_closer_to_the_end_points():
    rng = np.random.default_rng(4)
    segments = parallel_segments(CAMERA, (1, 0, 0.2), 10, rng) + rng.normal(size=(10, 2, 2))
    v = from_homogeneous(vanishing_point(segments))
    best = least_squares(distances, CAMERA.vanishing_point((1, 0, 0.2)), args=(segments,),
                         xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale=100)  # fmt: skip
    np.testing.assert_allclose(v, best.x, atol=1e-3)
    assert (distances(v, segments) ** 2).sum() <= 2 * best.cost * (1 + 1e-9)


def cramer_rao(segments, v):
    """The covariance of v per unit of noise in the ends, if their lines are unknown but for v."""
    information = np.zeros((2, 2))
    for a, b in segments:
        # parameters: v, the angle about v, the two distances along the line
        along = (a - v) / np.linalg.norm(a - v)
        across = np.array([-along[1], along[0]])
        rho = np.array([np.linalg.norm(a - v), np.linalg.norm(b - v)])
        # only moves across the line count: across·δv + ρ δangle for both ends
        J_v, J_angle = np.stack([across, across]), rho[:, None]
        P = np.eye(2) - J_angle @ np.linalg.pinv(J_angle)
        information += J_v.T @ P @ J_v
    return np.linalg.inv(information)


@pytest.mark.sampling
def test_under_noise_the_estimate_is_as_good_as_any_can_be():
    rng, d, sigma = np.random.default_rng(5), (1, 0.1, 0.3), 0.5
    segments = parallel_segments(CAMERA, d, 12, rng)
    truth = CAMERA.vanishing_point(d)
    errors = []
    for _ in range(400):
        noisy = segments + sigma * rng.normal(size=segments.shape)
        errors.append(from_homogeneous(vanishing_point(noisy)) - truth)
    errors = np.array(errors)
    information = np.linalg.inv(sigma**2 * cramer_rao(segments, truth))
    squared_mahalanobis = np.einsum("ni,ij,nj->n", errors, information, errors) / 2
    assert 0.88 < squared_mahalanobis.mean() < 1.15


@pytest.mark.parametrize(
    ("segments", "error", "words"),
    [
        ([[[0, 0], [1, 1]]], DegenerateError, "at least 2 segments, got 1"),
        ([[[0, 0], [1, 1]], [[5, 5], [5, 5]]], DegenerateError, "a segment has no length"),
        ([[[0, 0], [1, 1]], [[5, 5], [9, 9]]], DegenerateError, "all segments lie on one line"),
        (np.zeros((4, 2)), ShapeError, r"expected shape \(n, 2, 2\), got \(4, 2\)"),
        (np.zeros((4, 2, 3)), ShapeError, r"expected shape \(\.\.\., 2\)"),
        ([[[0, 0], [1, np.nan]], [[5, 5], [9, 8]]], CvnotesError, "segments contains NaN"),
    ],
)
def test_segments_that_fix_no_point_are_refused_in_words(segments, error, words):
    with pytest.raises(error, match=words):
        vanishing_point(segments)


# --- horizons ------------------------------------------------------------------------------------


def test_the_horizon_contains_the_vanishing_points_of_all_directions_in_the_plane():
    rng = np.random.default_rng(6)
    normal = rng.normal(size=3)
    line = horizon(CAMERA, normal)
    for d in np.cross(rng.normal(size=(20, 3)), normal):
        assert line @ [*CAMERA.vanishing_point(d), 1] == pytest.approx(0, abs=1e-9)


def test_the_horizon_is_as_high_as_the_camera():
    # what stands as high above the ground as the camera is seen on the horizon (y points down)
    camera = Camera(CAMERA.A, look_at([0, -1600, 0], [300, 0, 5000]))
    line = horizon(camera, [0, 1, 0])
    far_and_near = camera.project([[500, -1600, 4000], [-900, -1600, 9000]])
    np.testing.assert_allclose(far_and_near @ line[:2] + line[2], 0, atol=1e-9)


def test_a_plane_parallel_to_the_picture_has_its_horizon_at_infinity():
    assert same_up_to_scale(horizon(Camera(CAMERA.A), [0, 0, 1]), [0, 0, 1])


def test_the_vanishing_points_of_a_plane_share_its_horizon():
    d = np.array([[1, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, -2]])
    v_h = np.concatenate([CAMERA.vanishing_point(d), np.ones((4, 1))], axis=1)
    line = horizon(CAMERA, [0, 1, 0])
    for one, other in combinations(v_h, 2):
        assert same_up_to_scale(join(one, other), line)


# --- the camera ----------------------------------------------------------------------------------


@given(w=st.tuples(*[st.floats(-2, 2)] * 3), f=st.floats(200, 3000))
def test_three_orthogonal_vanishing_points_give_the_camera_away(w, f):
    A, R = intrinsics(f, f, 322, 238), rotation_from_vector(w)
    if np.abs(R[2]).min() < 0.05:  # a vanishing point near infinity
        return
    v = from_homogeneous((A @ R).T)
    found = intrinsics_from_vanishing_points(v)
    np.testing.assert_allclose(found, A, rtol=1e-9, atol=1e-6)
    for i, j in ((0, 1), (1, 2), (0, 2)):
        assert focal_length(v[i], v[j], [322, 238]) == pytest.approx(f, rel=1e-9)


def test_the_piercing_point_is_where_the_heights_of_the_triangle_meet():
    v = np.array([[0.0, 0], [1000, 0], [300, 800]])  # heights: u = 300, and through v1 ⊥ v2v3
    A = intrinsics_from_vanishing_points(v)
    assert A[0, 2] == pytest.approx(300)
    assert A[1, 2] == pytest.approx(300 * 700 / 800)
    assert A[0, 0] == A[1, 1] == pytest.approx(np.sqrt(300 * 700 - 262.5**2))


def test_a_box_in_a_noisy_picture_gives_its_camera():
    rng = np.random.default_rng(8)
    v_h = [
        vanishing_point(parallel_segments(CAMERA, d, 30, rng) + 0.2 * rng.normal(size=(30, 2, 2)))
        for d in np.eye(3)
    ]
    A = intrinsics_from_vanishing_points(from_homogeneous(v_h))
    assert A[0, 0] == pytest.approx(800, rel=0.02)
    np.testing.assert_allclose(A[:2, 2], [322, 238], atol=15)
    r = np.linalg.solve(A, np.transpose(v_h))  # the axes, seen from the camera
    turned = np.abs((r / np.linalg.norm(r, axis=0) * CAMERA.R).sum(0))  # no axis has a sign
    assert turned.min() > np.cos(np.deg2rad(1))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: focal_length([400, 240], [500, 240], [320, 240]), "less than 90° apart"),
        (lambda: focal_length([320, 240], [500, 240], [320, 240]), "less than 90° apart"),
        (
            lambda: intrinsics_from_vanishing_points(np.array([[0, 0], [1, 1], [2, np.nan]])),
            "tilt the camera",
        ),
        (lambda: intrinsics_from_vanishing_points([[0, 0], [1, 1], [2, 2]]), "lie on a line"),
        (lambda: intrinsics_from_vanishing_points([[0, 0], [0, 0], [2, 2]]), "lie on a line"),
        (lambda: intrinsics_from_vanishing_points([[0, 0], [9, 0], [-4, 3]]), "90° or more"),
        (lambda: intrinsics_from_vanishing_points([[0, 0], [9, 0], [0, 3]]), "90° or more"),
        (lambda: horizon(CAMERA, [0, 0, 0]), "not zero"),
    ],
)
def test_what_no_camera_sees_is_refused_in_words(call, words):
    with pytest.raises(CvnotesError, match=words):
        call()
