"""Flat boards have two poses that look alike: which one is found."""

import numpy as np
import pytest

from benchmarks.convergence import two_poses
from cvnotes.calibration import calibrate, pose_from_view
from cvnotes.calibration.reserve import flipped_pose
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.targets import Chessboard

pytestmark = pytest.mark.filterwarnings("ignore::cvnotes.base.CalibrationWarning")

BOARD = Chessboard((9, 6), 25.0)
SIZE = (640, 480)
# The refinement ends at a focal length of 1823 px here when it starts in the wrong pose.
TILTS = [(0.2, -0.2, -0.3), (0.2, -0.4, 0.3), (0.4, 0.1, 0), (-0.1, -0.2, 0.3)]
PLACES = [(-190, -130, 1060), (-140, -60, 930), (-140, 0, 1200), (-40, -120, 1090)]


def test_the_other_pose_shows_a_distant_board_alike():
    R, T = rotation_from_vector([0.5, 0.3, 0.1]), np.array([100.0, -50.0, 1e7])
    other = flipped_pose(R, T)
    assert np.allclose(other @ other.T, np.eye(3))
    assert np.linalg.det(other) > 0
    camera = Camera(intrinsics(1e8, 1e8, 320, 240))
    shown = [camera.moved(pose(r, T)).project(BOARD.points) for r in (R, other)]
    assert np.abs(shown[0] - shown[1]).max() < 0.1 < np.ptp(shown[0])
    assert np.abs(other - R).max() > 0.5
    assert np.allclose(flipped_pose(other, T), R)


def test_four_boards_with_one_in_the_wrong_pose():
    camera = Camera(intrinsics(1400, 1400, 320, 240), lens=Lens(k=(-2.3,)))
    poses = [pose(rotation_from_vector(w), T) for w, T in zip(TILTS, PLACES, strict=True)]
    seen = [camera.moved(G).project(BOARD.points) for G in poses]
    found = calibrate(BOARD.points, seen, SIZE, lens="k1")
    assert np.allclose(found.A, camera.A, atol=1e-5)
    assert np.allclose(found.poses, poses, atol=1e-5)
    rng = np.random.default_rng(0)
    noisy = calibrate(BOARD.points, seen + rng.normal(0, 0.05, np.shape(seen)), SIZE, lens="k1")
    assert abs(noisy.A[0, 0] - 1400) < 4 * noisy.std["alpha_u"]


@pytest.mark.parametrize("n_views", [3, 4, 5])
@pytest.mark.slow
def test_exact_corners_give_the_exact_camera(n_views):
    missed = 0
    for seed in range(100):
        f, seen = two_poses(n_views, np.random.default_rng([seed, n_views]))
        missed += abs(calibrate(BOARD.points, seen, SIZE, lens="k1").A[0, 0] - f) > 1e-5 * f
    assert missed == 0


@pytest.mark.parametrize(("n_views", "seed"), [(9, 50), (15, 245)])
def test_many_boards_in_wrong_poses_are_told_by_a_lens_that_folds(n_views, seed):
    """One start in 750 ended so, with residuals that are no noise."""
    f, seen = two_poses(n_views, np.random.default_rng([n_views, seed]))
    assert abs(calibrate(BOARD.points, seen, SIZE, lens="k1").A[0, 0] - f) < 1e-5 * f


@pytest.mark.parametrize("bow", [0.1, 1.0, 5.0])
def test_pose_of_a_bowed_board_is_not_mirrored(bow):
    """A bow of 0.1 mm over 200 mm: its PPM sees noise only, and puts half of the boards behind."""
    camera, rng = Camera(intrinsics(1000, 1000, 320, 240)), np.random.default_rng(1)
    W = BOARD.points - BOARD.points.mean(0)
    r2 = (W**2).sum(1)
    W[:, 2] = bow * (1 - r2 / r2.max())
    for _ in range(50):
        G = pose(rotation_from_vector(rng.uniform(-0.6, 0.6, 3)), [*rng.uniform(-50, 50, 2), 700])
        exact = camera.moved(G).project(W)
        m = exact + rng.normal(0, 0.2, exact.shape)
        shown = camera.moved(pose_from_view(camera, W, m)).project(W)
        assert ((shown - m) ** 2).sum() <= ((exact - m) ** 2).sum()


def test_pose_of_a_flat_board_in_another_frame_in_single_precision():
    camera, rng = Camera(intrinsics(1000, 1000, 320, 240)), np.random.default_rng(1)
    F = pose(rotation_from_vector([0.8, -0.5, 0.3]), [300, 200, -400])
    W = (BOARD.points @ F[:3, :3].T + F[:3, 3]).astype(np.float32)
    for _ in range(50):
        G = pose(rotation_from_vector(rng.uniform(-0.6, 0.6, 3)), [-90, -60, 700])
        exact = camera.moved(G).project(BOARD.points)
        m = exact + rng.normal(0, 0.2, exact.shape)
        shown = camera.moved(pose_from_view(camera, W, m)).project(W)
        assert ((shown - m) ** 2).sum() <= ((exact - m) ** 2).sum() + 1e-3
