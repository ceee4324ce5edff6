import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cvnotes.base import CvnotesError, DegenerateError, InputTypeError, ShapeError
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.targets import Chessboard

W = Chessboard((9, 6), 25.0).points
M = np.random.default_rng(0).uniform(0, 600, (3, 54, 2))
KEPT = [np.arange(54), np.arange(40), np.arange(3, 53)]  # 54, 40 and 50 corners of the board
OTHER_W = [W[k] for k in KEPT]
OTHER_M = [m[k] for m, k in zip(M, KEPT, strict=True)]


def test_the_board_is_centred_and_its_half_diagonal_becomes_1():
    data = Correspondences.of(W + [1e5, -3e4, 0], M)
    low, high = data.W.min(0), data.W.max(0)
    assert np.allclose(low, -high, atol=1e-9)
    assert np.linalg.norm(high) == pytest.approx(1, abs=1e-12)
    assert np.allclose(data.W * data.scale + data.centre, W + [1e5, -3e4, 0], atol=1e-8)
    assert np.array_equal(data.m, M)
    assert data.seen is None
    assert len(data) == 3


@pytest.mark.parametrize(
    ("board", "corners"),
    [
        (W, M),
        (W[:, :2], M),
        (W.tolist(), M.tolist()),
        ([W] * 3, list(M)),
        (np.broadcast_to(W, (3, 54, 3)), tuple(M)),
        (W, M[:, :, None]),  # as OpenCV 4 gives them
        (W, [m[:, None] for m in M]),
        ([w[:, None] for w in [W] * 3], M),
    ],
)
def test_one_board_for_all_views_may_be_said_in_many_ways(board, corners):
    data, plain = Correspondences.of(board, corners), Correspondences.of(W, M)
    assert data.W.shape == (54, 3)
    assert np.array_equal(data.W, plain.W)
    assert np.array_equal(data.m, M)


def test_whatever_numbers_are_given_float64_is_computed_with_and_the_input_stays():
    corners = M.round().astype(np.int16)
    corners.setflags(write=False)
    data = Correspondences.of(W.astype(">f4"), corners)
    assert data.m.dtype == np.float64
    assert np.array_equal(data.m, corners)
    data.m[:] = 0
    assert corners.any()


def test_views_with_fewer_points_are_filled_up_and_the_filling_is_marked():
    data = Correspondences.of(OTHER_W, OTHER_M)
    assert data.seen.sum(1).tolist() == [54, 40, 50]
    for (w, m), other_w, other_m in zip(data.given(), OTHER_W, OTHER_M, strict=True):
        assert np.allclose(w, other_w, atol=1e-9)
        assert np.array_equal(m, other_m)
    # the filling repeats a point of the same view, so that it changes no extent
    assert np.array_equal(data.m[1, 40:], np.repeat(OTHER_M[1][:1], 14, axis=0))


def test_poses_are_given_back_in_the_units_of_the_board():
    board = W * 1000 + [7e6, -5e6, 0]
    data = Correspondences.of(board, M)
    rng = np.random.default_rng(1)
    R = Rotation.from_rotvec(rng.normal(size=(3, 3))).as_matrix()
    T = rng.normal(size=(3, 3))
    G = data.pose_in_given_units(R, T)
    scaled, given = data.W @ R.mT + T[:, None], board @ G[:, :3, :3].mT + G[:, None, :3, 3]
    assert np.allclose(given, scaled * data.scale, rtol=1e-9, atol=1e-3)
    assert np.array_equal(G[:, 3], np.tile([0, 0, 0, 1], (3, 1)))


def test_the_jacobian_of_the_units_is_that_of_the_poses():
    data = Correspondences.of(W + [300, 200, 0], M)
    rng = np.random.default_rng(2)
    R = Rotation.from_rotvec(rng.normal(size=(3, 3))).as_matrix()
    T = rng.normal(size=(3, 3))
    J = data.pose_jacobian(R)
    G, h = data.pose_in_given_units(R, T), 1e-6
    for c in range(6):
        e = np.zeros(6)
        e[c] = h
        turned = Rotation.from_rotvec(e[:3]).as_matrix() @ R
        stepped = data.pose_in_given_units(turned, T + e[3:])
        omega = Rotation.from_matrix(stepped[:, :3, :3] @ G[:, :3, :3].mT).as_rotvec()
        column = np.c_[omega, stepped[:, :3, 3] - G[:, :3, 3]] / h
        assert np.allclose(J[:, :, c], column, atol=1e-3)


def nan_at(x, *place):
    x = np.array(x)
    x[place] = np.nan
    return x


@pytest.mark.parametrize(
    ("board", "corners", "error", "words"),
    [
        (W, nan_at(M, 2, 7), CvnotesError, "^image_points: view 2, corner 7 contains NaN"),
        (W, list(nan_at(M, 2, 7)), CvnotesError, "^image_points: view 2, corner 7 contains NaN"),
        (
            OTHER_W,
            [*OTHER_M[:2], nan_at(OTHER_M[2], 7)],
            CvnotesError,
            r"^image_points\[2\]: corner 7 contains NaN",
        ),
        (nan_at(W, 5), M, CvnotesError, "^board_points: corner 5 contains NaN"),
        (W, None, InputTypeError, r"image_points: .* got None \(a missing return\?\)"),
        (None, M, InputTypeError, "board_points: expected numbers, got None"),
        (W, [None, M[0]], InputTypeError, r"image_points\[0\]: expected numbers, got None"),
        (W, "corners", InputTypeError, r"image_points\[0\]: expected a numeric array, got str"),
        (W, {1: M}, InputTypeError, "image_points: .*got dict"),
        (W, (m for m in M), InputTypeError, "image_points: .*got generator"),
        (W, M + 1j, InputTypeError, "image_points: .*complex"),
        (W, [[[1, 2], [3]]], InputTypeError, r"image_points\[0\]: .*inhomogeneous"),
        (W, np.ma.array(M, mask=M > 300), InputTypeError, "masked arrays are not read"),
        (W, [np.ma.array(m, mask=m > 300) for m in M], InputTypeError, "masked arrays"),
        (W, [], DegenerateError, "image_points: need at least one view"),
        ([], M, DegenerateError, "board_points: need at least one view"),
        (W, M[:, :, :1], ShapeError, r"expected shape \(\.\.\., 2\), got \(3, 54, 1\)"),
        (W.T, M, ShapeError, "points are rows here, so transpose it"),
        (W, M[None], ShapeError, r"expected \(views, n, 2\), got \(1, 3, 54, 2\)"),
        ([W] * 2, M, ShapeError, "2 sets of board points but 3 of image_points"),
        (W[:50], M, ShapeError, "view 0 has 50 board points but 54 image points"),
        (W, OTHER_M, ShapeError, "view 1 has 54 board points but 40 image points"),
        (OTHER_W[::-1], OTHER_M, ShapeError, "view 0 has 50 board points but 54 image points"),
        ([*OTHER_W[:2], W[:50, :2]], OTHER_M, ShapeError, "some sets have two coordinates"),
        (W[:3], M[:, :3], DegenerateError, "every view needs at least 4 points"),
        (
            [*OTHER_W[:2], W[:3]],
            [*OTHER_M[:2], M[2, :3]],
            DegenerateError,
            "every view needs at least 4 points",
        ),
        ([*OTHER_W[:2], W[:0]], [*OTHER_M[:2], M[2, :0]], DegenerateError, "view without points"),
        (W + [0, 0, 1], M, CvnotesError, "Z must be 0 on a flat board"),
        (
            W + np.c_[0 * W[:, :2], 0.01 * W[:, 0]],
            M,
            CvnotesError,
            "there is calibrate_one_view",
        ),
        (np.full((54, 2), 5.0), M, DegenerateError, "all board points coincide"),
        (W * 1e200, M, CvnotesError, "beyond 1e[+]100 products overflow; choose another unit"),
    ],
)
def test_what_does_not_fit_together_is_refused_by_name(board, corners, error, words):
    with pytest.raises(error, match=words):
        Correspondences.of(board, corners)
