"""The same steps by an independent implementation, on data that are exact in its float32."""

import cv2
import numpy as np
import pytest

from cvnotes.calibration import LENSES, calibrate, extrinsics
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.homography import dlt, refine_homography

SIZE = (1280, 960)
TO_THE_END = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 300, 1e-16)
NO_TANGENT, NO_K3 = cv2.CALIB_ZERO_TANGENT_DIST, cv2.CALIB_FIX_K3
FLAGS = {
    "none": NO_TANGENT | NO_K3 | cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2,
    "k1": NO_TANGENT | NO_K3 | cv2.CALIB_FIX_K2,
    "k1 k2": NO_TANGENT | NO_K3,
    "k1 k2 k3": NO_TANGENT,
    "k1 k2 p1 p2": NO_K3,
    "k1 k2 p1 p2 k3": 0,
}
pytestmark = pytest.mark.filterwarnings("ignore::cvnotes.base.errors.CalibrationWarning")


def in_float32(m):
    return m.astype(np.float32).astype(float)


def opencv(function, board, m, lens, **more):
    """What calibrateCamera(Extended) gives, corners as it wants them."""
    W = board.points.astype(np.float32)
    views = [view.astype(np.float32) for view in m]
    flags = FLAGS[lens]
    return function([W] * len(m), views, SIZE, None, None, flags=flags, **more)


def predicted_by_opencv(board, A, dist, rvecs, tvecs):
    views = zip(rvecs, tvecs, strict=True)
    return np.array(
        [cv2.projectPoints(board.points, R, T, A, dist)[0].reshape(-1, 2) for R, T in views]
    )


def true_camera(lens):
    _, names = LENSES[lens]
    n_radial, tangential = sum(name[0] == "k" for name in names), "p1" in names
    k, p = (-0.2, 0.08, -0.02)[:n_radial], (0.001, -0.0005) if tangential else (0.0, 0.0)
    return Camera(intrinsics(1000, 1004, 650, 470), lens=Lens(k=k, p=p), size=SIZE)


def noisy_views(views_of, camera, n, seed):
    rng = np.random.default_rng(seed)
    m = views_of(camera, n, rng)[1]
    return in_float32(m + rng.normal(size=m.shape) * 0.3)


@pytest.mark.parametrize("n", [4, 12, 25])
@pytest.mark.parametrize("lens", [name for name in LENSES if LENSES[name][0] is Lens])
def test_the_minimum_is_the_one_that_calibrate_camera_comes_to(board, views_of, lens, n):
    m = noisy_views(views_of, true_camera(lens), n, n)
    ours = calibrate(board.points, m, SIZE, lens=lens)
    rms, A, dist, rvecs, tvecs = opencv(cv2.calibrateCamera, board, m, lens, criteria=TO_THE_END)
    theirs = predicted_by_opencv(board, A, dist, rvecs, tvecs)
    difference = theirs - [c.project(board.points) for c in ours.cameras]
    assert np.sqrt((difference**2).sum(-1).mean()) < 1e-5
    assert ours.rms == pytest.approx(rms, rel=1e-9)
    assert np.allclose(ours.A, A, rtol=0, atol=1e-4)


@pytest.mark.parametrize("lens", ["k1 k2", "k1 k2 p1 p2 k3"])
def test_the_error_bars_are_those_of_calibrate_camera_extended(board, views_of, lens):
    m = noisy_views(views_of, true_camera(lens), 12, 0)
    ours = calibrate(board.points, m, SIZE, lens=lens)
    found = opencv(cv2.calibrateCameraExtended, board, m, lens, criteria=TO_THE_END)
    std, poses_std, view_rms = (np.ravel(x) for x in found[5:8])
    order = ("alpha_u", "alpha_v", "u0", "v0", "k1", "k2", "p1", "p2", "k3")
    theirs = {name: s for name, s in zip(order, std[:9], strict=True) if s > 0}
    assert set(theirs) == set(ours.std)
    for name, s in theirs.items():
        assert ours.std[name] == pytest.approx(s, rel=2e-3), name
    T_std = np.sqrt(np.diagonal(ours.pose_covariance, axis1=1, axis2=2))[:, 3:]
    assert np.allclose(T_std, poses_std.reshape(-1, 6)[:, 3:], rtol=2e-3)
    assert np.allclose(ours.view_rms, view_rms, rtol=1e-6)


def test_refined_homographies_are_those_of_find_homography(views_of, board):
    src = board.points[:, :2]
    for m in noisy_views(views_of, true_camera("none"), 5, 1):
        H = refine_homography(dlt(src, m), src, m)
        theirs = cv2.findHomography(src, m)[0]
        x = np.c_[src, np.ones(54)]
        ours, other = (
            (x @ h.T)[:, :2] / (x @ h.T)[:, 2:] for h in (H / H[2, 2], theirs / theirs[2, 2])
        )
        assert np.abs(ours - other).max() < 1e-3
        assert np.sum((ours - m) ** 2) <= np.sum((other - m) ** 2) * (1 + 1e-9)


def test_the_pose_of_one_view_is_that_of_solve_pnp(views_of, board):
    camera = Camera(intrinsics(1000, 1004, 650, 470), size=SIZE)
    poses, m = views_of(camera, 5, np.random.default_rng(2))
    ours = extrinsics(camera.A, dlt(board.points[:, :2], m))
    for G, other, seen in zip(ours, poses, m, strict=True):
        _, rvec, tvec = cv2.solvePnP(board.points, seen, camera.A, None)
        theirs = pose(rotation_from_vector(rvec.ravel()), tvec.ravel())
        assert np.allclose(G, theirs, rtol=0, atol=1e-4)
        assert np.allclose(G, other, rtol=0, atol=1e-7)


LENS_KINDS = {
    "mild": lambda r: (r.uniform(-0.1, 0.1), r.uniform(-0.05, 0.05)),
    "barrel": lambda r: (r.uniform(-0.45, -0.25), r.uniform(0.05, 0.25)),
    "pincushion": lambda r: (r.uniform(0.1, 0.4), r.uniform(-0.1, 0.2)),
}


def random_camera(kind, rng):
    """A focal length from 400 to 1500, a principal point up to 10 % of the picture off."""
    alpha = rng.uniform(400, 1500)
    u0, v0 = 639.5 + rng.uniform(-128, 128), 479.5 + rng.uniform(-96, 96)
    lens = Lens(k=LENS_KINDS[kind](rng), p=rng.uniform(-0.002, 0.002, 2))
    return Camera(intrinsics(alpha, alpha * rng.uniform(0.97, 1.03), u0, v0), lens=lens, size=SIZE)


@pytest.mark.sampling
@pytest.mark.parametrize("n", [3, 4, 5, 8])
@pytest.mark.parametrize("kind", LENS_KINDS)
def test_from_the_corners_alone_we_are_never_worse_than_opencv(board, views_of, kind, n):
    for seed in range(12):
        rng = np.random.default_rng([seed, n, *kind.encode()])
        m = views_of(random_camera(kind, rng), n, rng)[1]
        m = in_float32(m + rng.normal(size=m.shape) * 0.3)
        ours = calibrate(board.points, m, SIZE, lens="k1 k2 p1 p2")
        theirs = opencv(cv2.calibrateCamera, board, m, "k1 k2 p1 p2", criteria=TO_THE_END)[0]
        assert ours.rms <= theirs * (1 + 1e-6), seed
