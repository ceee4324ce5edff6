"""Error bars from the scatter between views: do they hold where the model is not exact?"""

import numpy as np
import pytest

from cvnotes.base import CvnotesError
from cvnotes.calibration import Calibration, calibrate, prediction_std
from cvnotes.calibration.prediction import angles_seen
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import course
from cvnotes.targets import Chessboard

pytestmark = pytest.mark.filterwarnings("ignore::cvnotes.base.CalibrationWarning")

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.1)))
TRUTH = np.array([800, 804, 325, 238, -0.25, 0.1])


def twisted(by):
    """Give the board's corners, two opposite ends raised by so many mm, the others lowered."""
    W = BOARD.points.copy()
    xy = (W - W.mean(0))[:, :2]
    W[:, 2] = by * (xy / np.abs(xy).max(0)).prod(1)
    return W


def photographs(W, n_views, noise, rng):
    """Give the corners (n_views, n, 2) of boards at random places and tilts, and their poses."""
    n = 12 * n_views  # about one in five is seen whole
    turn = np.zeros((2, n, 3))
    turn[0, :, 2], turn[1, :, :2] = rng.uniform(-np.pi, np.pi, n), rng.normal(0, 0.4, (n, 2))
    R = rotation_from_vector(turn[1]) @ rotation_from_vector(turn[0])
    z = rng.uniform(350, 700, (n, 1))
    middle = np.concatenate([rng.uniform(-0.3, 0.3, (n, 2)) * z, z], axis=1)
    G = pose(R, middle - R @ BOARD.points.mean(0))
    m = CAMERA.project(W @ R.mT + G[:, None, :3, 3])
    seen = np.flatnonzero(((m > 0) & (m < CAMERA.size)).all((1, 2)))[:n_views]
    assert len(seen) == n_views
    return m[seen] + rng.normal(0, noise, (n_views, len(W), 2)), G[seen]


@pytest.mark.sampling
def test_the_scatter_of_views_covers_what_a_bent_board_does(refined):
    """400 calibrations by a twisted board: 68 % and 95 % of the true values are in the bars."""
    sets, z = 400, []
    for seed in range(sets):
        rng = np.random.default_rng(seed)
        m, poses = photographs(twisted(0.3), 20, 0.02, rng)
        found = refined(BOARD.points, m, CAMERA, poses)
        off = np.array([*found.parameters.values()]) - TRUTH
        z.append([off / [*std.values()] for std in (found.std, found.std_of_views)])
    noise, views = np.abs(z).swapaxes(0, 1)
    for within, share in ((1.0, 0.683), (1.96, 0.95)):
        covered = (views < within).mean(0)
        assert np.abs(covered - share).max() < 3.5 * np.sqrt(share * (1 - share) / sets)
    assert (noise < 1).mean() < 0.683 / 2


def test_noise_alone_gives_both_kinds_alike():
    rng = np.random.default_rng(0)
    found = [
        calibrate(BOARD.points, photographs(BOARD.points, 20, 0.2, rng)[0], CAMERA.size)
        for _ in range(20)
    ]
    both = [np.array([[*s.values()] for s in kind]) for kind in zip(*_kinds(found), strict=True)]
    ratio = np.sqrt((both[1] ** 2).mean(0) / (both[0] ** 2).mean(0))
    assert np.abs(ratio - 1).max() < 0.25
    assert not any("times what noise" in repr(one) for one in found)


def _kinds(found):
    return [(one.std, one.std_of_views) for one in found]


@pytest.mark.sampling
@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("lens", ["k1", "k1 k2", "k1 k2 p1 p2", "k1 k2 p1 p2 k3"])
def test_halves_of_real_photographs_differ_as_predicted(lens, side, refined):
    """RMS of difference over predicted deviation, of random halves: 1 if the bars hold."""
    real = course.real_corners()
    m, rng, z = np.asarray(getattr(real, side)), np.random.default_rng(0), []
    whole = calibrate(real.board.points, m, real.size, lens=lens)
    for _ in range(100):
        order, half = rng.permutation(len(m)), len(m) // 2
        a, b = (
            refined(real.board.points, m[views], whole.camera, whole.poses[views], lens=lens)
            for views in (order[:half], order[half:])
        )
        off = np.array([*a.parameters.values()]) - [*b.parameters.values()]
        kinds = zip(*_kinds([a, b]), strict=True)
        z.append([off / np.hypot(*([*s.values()] for s in kind)) for kind in kinds])
    noise, views = np.sqrt(np.mean(np.square(z), axis=(0, 2)))
    assert 0.8 < views < 1.3
    assert noise > 2


@pytest.mark.parametrize("lens", ["k1 k2", "fisheye"])
def test_one_step_is_as_good_as_a_refinement_without_each_view(lens):
    rng = np.random.default_rng(1)
    whole, _ = photographs(twisted(0.3), 8, 0.05, rng)
    boards = [BOARD.points] * 8
    boards[3], seen = BOARD.points[5:50], [m[5:50] if i == 3 else m for i, m in enumerate(whole)]
    found = calibrate(boards, seen, CAMERA.size, lens=lens, skew=True)
    estimates = []
    for i in range(8):
        keep = [j for j in range(8) if j != i]
        without = calibrate([boards[j] for j in keep], [seen[j] for j in keep], CAMERA.size,
                            lens=lens, skew=True)  # fmt: skip
        estimates.append([*without.parameters.values()])
    exact = np.std(estimates, axis=0) * np.sqrt(7)
    assert np.allclose([*found.std_of_views.values()], exact, rtol=0.15)


def test_it_is_kept_in_files_and_printed(tmp_path):
    real = course.real_corners()
    found = calibrate(real.board.points, real.left, real.size)
    assert f"± {found.std_of_views['alpha_u']:.1f} px" in repr(found)
    assert "3.0 times what noise alone would give" in repr(found)
    assert "3.0 times what noise alone would give" in found._repr_html_()
    found.save(tmp_path / "camera.json")
    again = Calibration.load(tmp_path / "camera.json")
    assert np.allclose(again.covariance_of_views, found.covariance_of_views, rtol=1e-6)
    places = [[0, 0], [320, 240]]
    noise, views = (prediction_std(found, places, of=kind) for kind in ("noise", "views"))
    assert np.array_equal(noise, prediction_std(found, places))
    assert (views > 1.5 * noise).all()
    with pytest.raises(CvnotesError, match='"noise" or "views"'):
        prediction_std(found, places, of="both")


def test_two_views_leave_nothing_to_compare():
    rng = np.random.default_rng(0)
    found = calibrate(
        BOARD.points, photographs(BOARD.points, 2, 0.1, rng)[0], CAMERA.size, lens="k1"
    )
    assert np.isinf([*found.std_of_views.values()]).all()
    assert "±: from noise alone" in repr(found)
    assert np.isinf(prediction_std(found, [320, 240], of="views"))


def moved(camera, name, by):
    return camera.with_parameters({name: camera.parameters[name] + by})


def test_what_is_predicted_is_differentiated_as_by_small_changes():
    """With a turn of the camera, found by least squares, that meets the corners best."""
    real = course.real_corners()
    found = calibrate(real.board.points, real.left, real.size, lens="k1 k2")
    places = np.array([[40.0, 30], [320, 240], [600, 420]])
    corners = np.concatenate(real.left)[:: -(-702 // 200)]
    rays, of_corners = found.camera.ray(places), found.camera.ray(corners)
    turns, columns = 1e-6 * np.eye(3), []
    for name in found.names:
        h = 1e-6 * max(1.0, abs(found.camera.parameters[name]))
        other = moved(found.camera, name, h)

        def seen(w, rays=rays, other=other):
            return other.project(rays @ rotation_from_vector(w).T)

        def off(w, other=other):
            return (other.project(of_corners @ rotation_from_vector(w).T) - corners).ravel()

        J = np.stack([(off(t) - off(-t)) / 2e-6 for t in turns], axis=1)
        best = -np.linalg.lstsq(J, off(np.zeros(3)), rcond=None)[0]
        columns.append((seen(best) - places) / h)
    J = np.stack(columns, axis=-1)
    std = np.sqrt(np.einsum("mci,ij,mcj->m", J, found.covariance, J))
    assert prediction_std(found, places, turning=True) == pytest.approx(std, rel=1e-3)


def test_the_angles_that_are_seen_are_known_as_well_as_small_changes_say():
    real = course.real_corners()
    found = calibrate(real.board.points, real.left, real.size, lens="k1 k2")
    angles, std = angles_seen(found)
    corners = np.concatenate(real.left)
    (left, top), (right, bottom), (u, v) = corners.min(0), corners.max(0), found.A[:2, 2]

    def spanned(camera):
        x, y, z = camera.ray([[left, v], [right, v], [u, top], [u, bottom]]).T
        a = np.arctan2([x[0], x[1], y[2], y[3]], z)
        return a[1::2] - a[::2]

    assert angles == pytest.approx(spanned(found.camera))
    J = []
    for name in found.names:
        h = 1e-6 * max(1.0, abs(found.camera.parameters[name]))
        J.append((spanned(moved(found.camera, name, h)) - angles) / h)
    C = found.covariance_of_views
    assert std == pytest.approx(np.sqrt(np.einsum("ic,ij,jc->c", J, C, J)), rel=1e-3)
