import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from cvnotes.base import CvnotesError, DegenerateError, ShapeError
from cvnotes.camera import (
    board_from_board,
    cam_from_cam,
    chain,
    inverse,
    look_at,
    move,
    nearest_rotation,
    pose,
    rotation_from_angles,
    rotation_from_vector,
    skew_matrix,
    vector_from_rotation,
)

RNG = np.random.default_rng(2)
vectors = st.tuples(*[st.floats(-3, 3)] * 3)


def random_poses(count):
    return pose(rotation_from_vector(RNG.normal(size=(count, 3))), RNG.normal(size=(count, 3)))


# --- rotations -----------------------------------------------------------------------------------


def test_a_quarter_turn_about_z_carries_x_to_y():
    R = rotation_from_vector([0, 0, np.pi / 2])
    np.testing.assert_allclose(R @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(R @ [0, 1, 0], [-1, 0, 0], atol=1e-15)


def test_rodrigues_formula_is_the_matrix_exponential():
    for w in RNG.normal(size=(30, 3)):
        np.testing.assert_allclose(rotation_from_vector(w), expm(skew_matrix(w)), atol=1e-14)


@pytest.mark.parametrize(
    "angle", [0, 1e-12, 1e-9, 1e-6, 0.99e-4, 1.01e-4, 1e-3, 1, np.pi - 1e-9, np.pi]
)
def test_axis_and_angle_survive_the_way_through_a_matrix_at_every_angle(angle):
    for axis in (*np.eye(3), [0.6, 0, -0.8], [2 / 3, -1 / 3, 2 / 3]):
        w = angle * np.array(axis)
        R = rotation_from_vector(w)
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=2e-15)
        back = vector_from_rotation(R)
        if angle == np.pi:  # half a turn one way is half a turn the other way
            back = back * np.sign(back @ w)
        np.testing.assert_allclose(back, w, atol=3e-15, rtol=2e-15)


@pytest.mark.parametrize("turns", [2 * np.pi, 1e3, 1e6])
def test_many_turns_are_still_a_rotation(turns):
    axis = np.array([0.6, 0, 0.8])
    c, s = np.cos(turns), np.sin(turns)
    by_hand = c * np.eye(3) + s * skew_matrix(axis) + (1 - c) * np.outer(axis, axis)
    np.testing.assert_allclose(rotation_from_vector(turns * axis), by_hand, atol=1e-9)


@given(w=vectors)
def test_every_rotation_vector_gives_a_rotation(w):
    R = rotation_from_vector(w)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-14)
    assert np.linalg.det(R) == pytest.approx(1, abs=1e-14)
    np.testing.assert_allclose(R @ np.array(w), w, atol=1e-14)


def test_stacks_of_rotations_agree_with_opencv_and_scipy():
    w = RNG.normal(size=(4, 5, 3))
    R = rotation_from_vector(w)
    assert R.shape == (4, 5, 3, 3)
    for wi, Ri in zip(w.reshape(-1, 3), R.reshape(-1, 3, 3), strict=True):
        np.testing.assert_allclose(Ri, cv2.Rodrigues(wi)[0], atol=1e-14)
    theirs = Rotation.from_matrix(R.reshape(-1, 3, 3)).as_rotvec()
    np.testing.assert_allclose(vector_from_rotation(R).reshape(-1, 3), theirs, atol=1e-13)


def test_three_angles_turn_about_the_fixed_axes_x_then_y_then_z():
    R = rotation_from_angles(0.1, -0.2, 0.3)
    np.testing.assert_allclose(
        R, Rotation.from_euler("xyz", [0.1, -0.2, 0.3]).as_matrix(), atol=1e-15
    )
    # x first: the axis x itself is not moved by the first turn
    R = rotation_from_angles(0.5, np.pi / 2, 0)
    np.testing.assert_allclose(R @ [1, 0, 0], [0, 0, -1], atol=1e-15)


def test_the_nearest_rotation_is_nearer_than_any_other():
    R = rotation_from_vector([0.2, -0.4, 0.6])
    M = 1.3 * R + 0.1 * RNG.normal(size=(3, 3))
    nearest = nearest_rotation(M)
    distance = np.linalg.norm(M - nearest)
    for w in 0.05 * RNG.normal(size=(200, 3)):
        assert np.linalg.norm(M - rotation_from_vector(w) @ nearest) >= distance
    np.testing.assert_allclose(nearest_rotation(1e-5 * R), R, atol=1e-14)


def test_the_nearest_rotation_of_a_mirroring_matrix_is_not_a_reflection():
    M = np.diag([1.0, 0.9, -0.2])  # U Vᵀ alone would be diag(1, 1, −1): erratum E33
    np.testing.assert_allclose(nearest_rotation(M), np.eye(3), atol=1e-15)
    assert np.linalg.det(nearest_rotation(M)) == pytest.approx(1)


@pytest.mark.parametrize(
    ("M", "words"),
    [
        (np.zeros((3, 3)), "rank below 2"),
        (np.ones((3, 3)), "rank below 2"),
        (-np.eye(3), "many rotations are equally close"),
    ],
)
def test_where_no_rotation_is_nearest_none_is_given(M, words):
    with pytest.raises(DegenerateError, match=words):
        nearest_rotation(M)


# --- motions -------------------------------------------------------------------------------------


def test_G_carries_a_point_by_R_and_then_T():
    G = pose(rotation_from_vector([0, 0, np.pi / 2]), [10, 20, 30])
    np.testing.assert_allclose(move(G, [1, 2, 3]), [8, 21, 33], atol=1e-14)
    np.testing.assert_allclose(G @ [1, 2, 3, 1], [8, 21, 33, 1], atol=1e-14)


@given(w=vectors, T=vectors, W=vectors)
def test_the_inverse_motion_brings_every_point_back(w, T, W):
    G = pose(rotation_from_vector(w), T)
    np.testing.assert_allclose(move(inverse(G), move(G, W)), W, atol=1e-13)


def test_motions_are_a_group():
    a, b, c = random_poses(3)
    np.testing.assert_allclose(chain(chain(a, b), c), chain(a, chain(b, c)), atol=1e-14)
    np.testing.assert_allclose(chain(a, inverse(a)), np.eye(4), atol=1e-15)
    np.testing.assert_allclose(inverse(chain(a, b)), chain(inverse(b), inverse(a)), atol=1e-14)
    np.testing.assert_allclose(chain(a, np.eye(4)), a, atol=0)


def test_stacks_move_stacks_of_points():
    G, W = random_poses(4), RNG.normal(size=(7, 3))
    moved = move(G, W)
    assert moved.shape == (4, 7, 3)
    for i in range(4):
        np.testing.assert_allclose(moved[i], W @ G[i, :3, :3].T + G[i, :3, 3], atol=1e-15)
    np.testing.assert_allclose(inverse(G) @ G, np.broadcast_to(np.eye(4), (4, 4, 4)), atol=1e-15)


def test_a_board_that_moves_before_a_fixed_camera_is_chained_through_the_camera():
    G_1, G_i = random_poses(2)
    M = RNG.normal(size=(5, 3))  # points of the one CRF
    W_1, W_i = ((M - G[:3, 3]) @ G[:3, :3] for G in (G_1, G_i))
    np.testing.assert_allclose(move(board_from_board(G_1, G_i), W_i), W_1, atol=1e-13)


def test_a_camera_that_moves_before_a_fixed_board_is_chained_through_the_board():
    G_1, G_i = random_poses(2)
    W = RNG.normal(size=(5, 3))  # points of the one WRF
    M_1, M_i = (W @ G[:3, :3].T + G[:3, 3] for G in (G_1, G_i))
    np.testing.assert_allclose(move(cam_from_cam(G_1, G_i), M_i), M_1, atol=1e-13)


def test_the_two_readings_of_chaining_are_not_the_same_motion():
    G_1, G_i = random_poses(2)
    assert np.abs(board_from_board(G_1, G_i) - cam_from_cam(G_1, G_i)).max() > 0.1


def test_a_camera_looks_at_its_target_with_the_picture_upright():
    G = look_at([300, -400, -1200], [50, 60, 0])
    eye, target, above = move(G, [[300, -400, -1200], [50, 60, 0], [50, 40, 0]])
    np.testing.assert_allclose(eye, 0, atol=1e-12)
    np.testing.assert_allclose(target[:2], 0, atol=1e-12)
    assert target[2] == pytest.approx(np.linalg.norm([250, 460, 1200]))
    assert above[1] < 0  # y runs down
    assert above[0] == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("eye", "target", "up", "words"),
    [
        ([1, 2, 3], [1, 2, 3], [0, -1, 0], "coincide"),
        ([0, 5, 0], [0, -5, 0], [0, -1, 0], "parallel to up"),
        ([0, 0, 0], [0, 0, 1], [0, 0, 0], "parallel to up"),
    ],
)
def test_looking_nowhere_is_refused(eye, target, up, words):
    with pytest.raises(DegenerateError, match=words):
        look_at(eye, target, up)


def test_the_cross_product_as_a_matrix():
    v, w = RNG.normal(size=(2, 6, 3))
    np.testing.assert_allclose((skew_matrix(v) @ w[..., None])[..., 0], np.cross(v, w), atol=1e-15)


# --- guards --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("R", "words"),
    [
        (np.diag([1.0, 1, -1]), "det = -1: a reflection"),
        (-np.eye(3), "det = -1: a reflection"),
        (2 * np.eye(3), "not orthonormal .*deviates from I by 3"),
        (np.array([[1.0, 0.3, 0], [0, 1, 0], [0, 0, 1]]), "not orthonormal"),
        (np.zeros((3, 3)), "not orthonormal"),
        (np.ones((3, 3)), "not orthonormal"),
        (np.eye(3) + 1e-2, "nearest_rotation gives the closest"),
        (np.full((3, 3), np.nan), "R contains NaN"),
        (np.eye(2), r"expected shape \(3, 3\), got \(2, 2\)"),
    ],
)
def test_what_is_no_rotation_is_refused_in_words(R, words):
    for function in (vector_from_rotation, lambda R: pose(R, np.zeros(3))):
        with pytest.raises(CvnotesError, match=words):
            function(R)


def test_a_rotation_off_by_rounding_is_accepted():
    R = rotation_from_vector([0.1, 0.2, 0.3]) + 1e-10
    np.testing.assert_allclose(vector_from_rotation(R), [0.1, 0.2, 0.3], atol=1e-9)


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(ShapeError, match="not equally many"):
        pose(np.broadcast_to(np.eye(3), (4, 3, 3)), np.zeros((5, 3)))
    with pytest.raises(ShapeError, match="expected one point"):
        look_at(np.zeros((2, 3)), [0, 0, 1])
    with pytest.raises(ShapeError, match=r"expected shape \(\.\.\., 3\)"):
        skew_matrix([1, 2])
    with pytest.raises(CvnotesError, match="last row"):
        inverse(np.diag([1, 1, 1, 2]))
    with pytest.raises(CvnotesError, match="at least one"):
        chain()
