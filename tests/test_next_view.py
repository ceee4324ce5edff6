"""The view that is proposed next: seen whole, better than others, and said in words."""

import warnings

import numpy as np
import pytest

from cvnotes.base import CvnotesError, DegenerateError
from cvnotes.calibration import (
    Calibration,
    calibrate,
    next_view,
    prediction_std,
)
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.next_view import _where_to_hold
from cvnotes.calibration.prediction import pixel_jacobian
from cvnotes.calibration.refinement import Problem, covariance
from cvnotes.camera import Camera, FisheyeLens, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.pictures import course, good_views, hold_at
from cvnotes.targets import Chessboard

pytestmark = pytest.mark.filterwarnings("ignore::cvnotes.base.CalibrationWarning")

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.1)))
SIZE = CAMERA.size
PIXELS = np.stack(np.meshgrid(np.linspace(0, 639, 9), np.linspace(0, 479, 7)), -1).reshape(-1, 2)


def seen(poses, rng, noise=0.1):
    m = np.stack([CAMERA.moved(G).project(BOARD.points) for G in poses])
    return m + rng.normal(0, noise, m.shape)


def of_noise(found):
    """Give the same calibration as if views scattered by no more than noise alone."""
    kept = found.as_mapping() | {"_covariance_of_views": found.covariance}
    return Calibration(**kept)


def over_picture(found, std):
    """How far off a pixel may be, from the deviations of its camera's parameters."""
    scaled = found.covariance * np.outer(*[np.divide([*std.values()], [*found.std.values()])] * 2)
    made = Calibration(**found.as_mapping() | {"covariance": scaled})
    return np.sqrt(np.mean(prediction_std(made, PIXELS, turning=True) ** 2))


def few_views(seed=0, n=4):
    rng = np.random.default_rng(seed)
    m = seen(good_views(BOARD, CAMERA, n, rng=rng), rng)
    return of_noise(calibrate(BOARD.points, m, SIZE)), m, rng


def test_the_promise_is_kept():
    """A calibration with the view has the uncertainty that was promised, and the noise alone."""
    found, m, rng = few_views()
    view = next_view(found)
    assert view.before == pytest.approx(
        np.sqrt(np.mean(prediction_std(found, PIXELS, turning=True) ** 2)), 1e-6
    )
    more = np.concatenate([m, seen([view.G], rng)])
    again = calibrate(BOARD.points, more, SIZE)
    after = (
        np.sqrt(np.mean(prediction_std(again, PIXELS, turning=True) ** 2)) * found.rms / again.rms
    )
    assert view.after == pytest.approx(after, rel=0.1)
    assert view.after < 0.8 * view.before


@pytest.mark.slow
def test_no_other_view_is_better():
    found, _, rng = few_views()
    view = next_view(found)
    others = good_views(BOARD, CAMERA, 200, rng=rng, tilt=(0.0, np.radians(50)))
    nearest = distances(found.poses).min()
    assert distances(view.G) > 0.8 * nearest - 1e-6  # the lens is not focused any nearer
    others = others[distances(others) > 0.8 * nearest]
    assert len(others) > 50
    made = Calibration(**found.as_mapping() | {"covariance": covariance_with(found, view.G)})
    after = np.sqrt(np.mean(prediction_std(made, PIXELS, turning=True) ** 2))
    assert view.after == pytest.approx(after, rel=1e-6)
    J = pixel_jacobian(found, PIXELS)  # the same for all of them
    N = np.einsum("mci,mcj->ij", J, J) / len(PIXELS)
    assert after == pytest.approx(np.sqrt(np.trace(N @ covariance_with(found, view.G))))
    assert after < min(np.sqrt(np.trace(N @ covariance_with(found, G))) for G in others)


def distances(G):
    return np.linalg.norm(G[..., :3, :3] @ BOARD.points.mean(0) + G[..., :3, 3], axis=-1)


def covariance_with(found, G):
    """The camera's covariance with a view more: from a calibration of all its equations."""
    before, after = (covariance_at(found, p) for p in (found.poses, [*found.poses, G]))
    return found.covariance[0, 0] / before[0, 0] * after


def covariance_at(found, poses):
    anywhere = np.zeros((len(poses), len(BOARD.points), 2))  # does not change the Jacobian
    data = Correspondences.in_unit_frame(BOARD.points, anywhere)
    problem = Problem.at(found.camera, found.names, data)
    state = problem.state(found.camera, data.pose_in_scaled_units(np.array(poses)))
    return covariance(problem.linearise(state)[1])


@pytest.mark.slow
def test_cameras_become_better_than_with_views_at_random():
    """15 cameras from 3 views and 3 more, proposed or at random: how far off pixels truly are."""
    errors = []
    for seed in range(15):  # the quotient scatters by 0.075 around 0.59
        rng = np.random.default_rng(seed)
        proposed = seen(good_views(BOARD, CAMERA, 3, rng=rng), rng)
        at_random = np.concatenate([proposed, seen(good_views(BOARD, CAMERA, 3, rng=rng), rng)])
        for _ in range(3):
            view = next_view(of_noise(calibrate(BOARD.points, proposed, SIZE)))
            proposed = np.concatenate([proposed, seen([view.G], rng)])
        both = [calibrate(BOARD.points, m, SIZE).camera for m in (proposed, at_random)]
        rays = np.c_[CAMERA.ideal(PIXELS), np.ones(len(PIXELS))]
        off = [np.mean((c.project(rays) - PIXELS) ** 2) for c in both]
        errors.append(off)
    rms = np.sqrt(np.mean(errors, axis=0))
    assert rms[0] < 0.8 * rms[1]


def test_the_whole_board_is_in_the_picture_and_before_the_camera():
    for camera in (CAMERA, Camera(intrinsics(260, 260, 320, 240), lens=FisheyeLens((0.02, 0.01)))):
        rng = np.random.default_rng(1)
        poses = good_views(BOARD, CAMERA, 5, rng=rng)
        m = np.stack([camera.moved(G).project(BOARD.points) for G in poses])
        lens = "fisheye" if camera is not CAMERA else "k1 k2"
        found = calibrate(BOARD.points, m + rng.normal(0, 0.1, m.shape), SIZE, lens=lens)
        view = next_view(found)
        inside = np.concatenate([view.outline, view.image_points])
        assert (inside >= 5.9).all()
        assert (inside <= np.array(SIZE) - 6.9).all()
        in_camera = BOARD.points @ view.G[:3, :3].T + view.G[:3, 3]
        assert (in_camera[:, 2] > 0).all()
        np.testing.assert_allclose(found.camera.project(in_camera), view.image_points, atol=1e-9)
        # seen from the front, and not too steeply
        assert -view.G[:3, 2] @ in_camera.mean(0) / np.linalg.norm(in_camera.mean(0)) < -0.64


def test_after_views_in_the_middle_the_border_is_asked_for():
    """Views that keep a small board in the middle leave the lens open at the border."""
    rng = np.random.default_rng(2)
    tilted = good_views(BOARD, CAMERA, 8, rng=rng)[:, :3, :3]
    middle = [hold_at(BOARD, CAMERA, R, [319.5, 239.5], 2.2) for R in tilted]
    m = seen(np.stack(middle), rng)
    view = next_view(of_noise(calibrate(BOARD.points, m, SIZE)))
    reach = np.linalg.norm(view.image_points - [325, 238], axis=1).max()
    assert reach > np.linalg.norm(m - [325, 238], axis=-1).max() + 80
    assert view.after < 0.5 * view.before


def test_of_two_views_it_is_said_that_noise_alone_is_known():
    m = seen(good_views(BOARD, CAMERA, 5, rng=np.random.default_rng(1)), np.random.default_rng(2))
    for n, alone in ((2, True), (5, False)):
        said = repr(next_view(calibrate(BOARD.points, m[:n], SIZE)))
        assert said.endswith("), were there noise alone") is alone


W = np.array([[x, y, 0.0] for y in (0, 100) for x in (0, 200)])
PINHOLE = Camera(intrinsics(800, 800, 320, 240))


@pytest.mark.parametrize(
    ("turn", "middle", "words"),
    [
        ([0, 0, 0], [0, 0, 400], "middle of the picture, 40 cm away, facing the camera"),
        ([0, 0, 0], [-150, 110, 600],
         "lower left corner of the picture, 63 cm away, tilted by 17° with its lower left corner"),
        ([0.6, 0, 0], [0, 0, 400], "tilted by 34° with its lower side farther away"),
        ([-0.6, 0, 0], [0, 0, 400], "tilted by 34° with its upper side farther away"),
        ([0, 0.6, 0], [0, 0, 400], "tilted by 34° with its left side farther away"),
        ([0, -0.6, 0], [0, 0, 400], "tilted by 34° with its right side farther away"),
        ([0, 0, 0.5], [0, 0, 400], "facing the camera, turned by 29° clockwise"),
        ([0, 0, -1.5], [0, 0, 400], "facing the camera, turned by 86° anticlockwise"),
        ([0, 0, 0], [150, 0, 600], "right in the picture, 62 cm away"),
        ([0, 0, 0], [0, -120, 600], "at the top of the picture, 61 cm away"),
        ([0, 0, 0], [0, 120, 600], "at the bottom of the picture, 61 cm away"),
        ([0, 0, 0], [150, -110, 600], "upper right corner of the picture"),
    ],
)  # fmt: skip
def test_where_to_hold_the_board_is_said_as_one_sees_it(turn, middle, words):
    R = rotation_from_vector(turn)
    T = np.array(middle) - R @ W.mean(0)
    assert words in _where_to_hold(PINHOLE, pose(R, T), W)
    # and the side that is said to be farther away is
    for name, edge in (("right", [1, 3]), ("left", [0, 2]), ("upper", [0, 1]), ("lower", [2, 3])):
        if f"its {name} side farther" in words:
            depth = (W @ R.T + T)[:, 2]
            assert depth[edge].min() > np.delete(depth, edge).max()


def test_real_photographs_have_a_proposal_with_and_without_a_flat_board():
    real = course.real_corners()
    for board in ("flat", "free"):
        found = calibrate(real.board.points, real.left, real.size, lens="k1 k2 p1 p2", board=board)
        view = next_view(found)
        assert 0.2 * view.before < view.after < 0.95 * view.before
        assert "cm away" in repr(view)
    part = [np.sort(np.random.default_rng(i).permutation(54)[:40]) for i in range(13)]
    found = calibrate(
        [real.board.points[k] for k in part], [m[k] for m, k in zip(real.left, part, strict=True)],
        real.size,
    )  # fmt: skip
    assert len(next_view(found).image_points) == 54


def test_what_cannot_be_proposed_is_refused_in_words(tmp_path):
    found, *_ = few_views()
    with pytest.raises(DegenerateError, match="the board cannot be seen whole by this camera"):
        next_view(found, outline=BOARD.points * 1e4)
    found.save(tmp_path / "found.json")
    again = next_view(Calibration.load(tmp_path / "found.json"))
    assert again.words == next_view(found).words
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        none = Calibration(**found.as_mapping() | {"_data": None})
    with pytest.raises(CvnotesError, match="the views must come with their corners"):
        next_view(none)
