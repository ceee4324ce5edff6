"""What the judge says of sets of views, and of single doubts. The RMS is the same in all sets."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest

from cvnotes.base import CalibrationWarning, DegenerateError
from cvnotes.calibration import calibrate
from cvnotes.calibration.refinement import autocorrelation
from cvnotes.calibration.reliability import Diagnostics, judge, missed_together
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.targets import Chessboard

CAMERA = Camera(intrinsics(1000, 1000, 640, 480), lens=Lens(k=(-0.2, 0.1)), size=(1280, 960))


def about(angle, degrees):
    """A turn about an axis in the board's plane, by an angle in degrees."""
    return rotation_from_vector(np.radians(degrees) * np.array([np.cos(angle), np.sin(angle), 0]))


def roll(rng, reach=0.5):
    return rotation_from_vector([0, 0, rng.uniform(-reach, reach)])


def tilted_up_to(degrees):
    def turn(rng):
        return about(rng.uniform(0, 2 * np.pi), rng.uniform(0, degrees)) @ roll(rng)

    return turn


def tilted_by_sigma(degrees):
    def turn(rng):
        return rotation_from_vector(np.r_[rng.normal(size=2) * np.radians(degrees), 0]) @ roll(rng)

    return turn


def fronto_parallel(rng):
    return roll(rng, 3)


def parallel(rng):  # noqa: ARG001
    return about(0.7, 25)


def seen(board, turn, n, rng, sigma=0.3):
    """Corners of n boards turned by `turn`, somewhere in the picture, with noise."""
    W, views = board.points, []
    while len(views) < n:
        R = turn(rng)
        T = rng.uniform([-150, -110, 400], [150, 110, 800]) - R @ W.mean(0)
        m = CAMERA.moved(pose(R, T)).project(W)
        if (m > 0).all() and (m < CAMERA.size).all():
            views.append(m)
    return np.array(views) + rng.normal(size=(n, len(W), 2)) * sigma


def quietly(board, m, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)
        return calibrate(board.points, m, CAMERA.size, **options)


@pytest.mark.sampling
@pytest.mark.parametrize(
    ("turn", "n"),
    [
        (tilted_up_to(37), 15),
        (tilted_up_to(37), 6),
        (tilted_up_to(37), 3),
        (tilted_up_to(15), 10),
    ],
    ids=["15 views", "6 views", "3 views", "10 views tilted up to 15°"],
)
def test_sets_that_show_the_camera_are_believed(board, turn, n):
    for seed in range(25):
        result = quietly(board, seen(board, turn, n, np.random.default_rng(seed)))
        assert result.reliable, result.warnings
        assert 0.3 < result.rms < 0.5
        # believed means: right to what the error bars say
        off = abs(result.A[0, 0] - 1000) / result.std["alpha_u"]
        assert off < 4.5


@pytest.mark.sampling
def test_15_views_tilted_up_to_37_degrees_leave_no_doubt(board):
    for seed in range(25):
        m = seen(board, tilted_up_to(37), 15, np.random.default_rng(seed))
        assert quietly(board, m).warnings == ()


@pytest.mark.sampling
@pytest.mark.parametrize(
    "turn",
    [fronto_parallel, parallel, tilted_by_sigma(1)],
    ids=["fronto-parallel", "parallel", "tilt σ 1°"],
)
def test_sets_that_leave_the_focal_length_open_are_not_believed_though_they_fit(board, turn):
    for seed in range(12):
        result = quietly(board, seen(board, turn, 10, np.random.default_rng(seed)))
        assert result.rms < 0.5
        assert not result.reliable
        assert "tilt the board by 30 to 45 degrees" in " ".join(result.warnings)


@pytest.mark.sampling
def test_one_view_again_and_again_is_one_view(board):
    for seed in range(12):
        rng = np.random.default_rng(seed)
        copies = np.repeat(seen(board, tilted_up_to(37), 1, rng, sigma=0), 15, axis=0)
        noisy = quietly(board, copies + rng.normal(size=copies.shape) * 0.3)
        assert not noisy.reliable
        assert "all boards are nearly parallel" in " ".join(noisy.warnings)
        with pytest.raises(DegenerateError, match="rank of V too low"):
            quietly(board, copies)


@pytest.mark.sampling
def test_small_tilts_are_believed_with_a_warning(board):
    warned = [
        bool(quietly(board, seen(board, tilted_by_sigma(5), 10, np.random.default_rng(s))).warnings)
        for s in range(25)
    ]
    assert np.mean(warned) > 0.9


def good_evidence(**changes):
    """Three boards tilted by 35° in different directions, fitted to 0.4 px."""
    rng = np.random.default_rng(0)
    R = np.array([about(a, 35) for a in (0, 2, 4)])
    return replace(
        Diagnostics(
            A=CAMERA.A,
            lens=Lens(k=(-0.1,)),
            size=(1280, 960),
            poses=pose(R, np.tile([0, 0, 500.0], (3, 1))),
            std={"alpha_u": 1.0, "alpha_v": 1.0},
            view_rms=np.array([0.4, 0.41, 0.42]),
            distances=0.3 + 0.1 * rng.uniform(size=(3, 54)),
            corners=rng.uniform(100, 900, (3, 54, 2)),
            converged=True,
        ),
        **changes,
    )


def test_nothing_is_said_where_nothing_is_doubtful():
    assert judge(good_evidence()) == ((), True)


def turned(*vectors):
    R = rotation_from_vector(np.array(vectors, float))
    return pose(R, np.tile([0, 0, 500.0], (len(R), 1)))


def with_one(value, shape, *place):
    x = np.full(shape, 0.3)
    x[place] = value
    return x


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"converged": False}, "stopped before it reached a minimum"),
        (
            {"poses": turned([0.3, 0, 0], [0.33, 0, 0], [0.28, 0.05, 0])},
            "all boards are nearly parallel",
        ),
        (
            {"poses": turned([0.05, 0, 0], [-0.05, 0, 0], [0, 0.05, 1])},
            r"do not determine the camera \(V is singular to 0\.00",
        ),
        ({"std": {"alpha_u": 200.0, "alpha_v": 1.0}}, "the focal length is known to 20% only"),
        ({"A": intrinsics(1000, 2100, 640, 480)}, "pixels 2.1 times as high as wide"),
        ({"A": intrinsics(1000, 450, 640, 480)}, "rows and columns of the board swapped"),
        (
            {"poses": turned([3.0, 0, 0.1], [3.1, 0.5, 0], [2.8, -0.4, 0])},
            r"every board is seen from behind: .* \(v, u\) given for \(u, v\)",
        ),
        (
            {"poses": turned([0.5, 0, 0], [3.1, 0.5, 0], [-0.4, 0.4, 0])},
            "boards seen from behind in views 1: mirrored labels",
        ),
        ({"view_rms": np.array([8.0, 9, 10])}, "9.0 px away from where the model puts them"),
        (
            {"view_rms": np.array([0.4, 0.4, 3.0])},
            r"views 2 do not fit the others \(view 2: 3.00 px, typical 0.40 px\)",
        ),
        (
            {"autocorrelation": 0.6, "view_rms": np.array([0.9, 1.0, 1.1])},
            "neighbouring corners miss their places in the same direction",
        ),
        (
            {"together": 0.9, "view_rms": np.array([0.9, 1.0, 1.1])},
            "neighbouring corners miss their places in the same direction",
        ),
        ({"distances": with_one(np.nan, (3, 54), 0, 0)}, "where the estimated lens folds over"),
    ],
)
def test_doubts_that_the_error_bars_do_not_cover_make_it_unreliable(changes, words):
    sentences, reliable = judge(good_evidence(**changes))
    assert not reliable
    assert re.search(words, sentences[0]), sentences


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"poses": turned([0.1, 0, 0], [-0.1, 0, 0], [0, 0.1, 0.3])},
            r"tilts \(at most 11° between two\) determine the focal length only weakly",
        ),
        (
            {"std": {"alpha_u": 1.0, "alpha_v": 30.0}},
            "the focal length has a standard deviation of 3.0%: add views",
        ),
        (
            {"poses": turned([0.6, 0, 0], [0, 0.6, 0]), "view_rms": np.array([0.4, 0.4])},
            "two views give as many constraints as A has unknowns",
        ),
        (
            {"distances": with_one(7.0, (3, 54), 1, 17)},
            r"corners far from their place: view 1, corner 17 \(7.0 px\)",
        ),
        ({"size": (900, 900)}, "corners lie outside of the 900×900 picture"),
        (
            {"autocorrelation": 0.6},
            "so this is no noise: .*error is then larger than noise alone would make it",
        ),
        ({"lens": Lens(k=(-0.8,))}, "folds over before it reaches the corners of the picture"),
    ],
)
def test_other_doubts_are_said_and_the_result_is_believed(changes, words):
    evidence = good_evidence(**changes)
    if "size" in changes:
        evidence = replace(evidence, corners=np.array([[[100.0, 100], [950, 200]]] * 3))
    sentences, reliable = judge(evidence)
    assert reliable
    assert len(sentences) == 1
    assert re.search(words, sentences[0]), sentences


def test_more_than_a_few_views_are_summed_up():
    poses = turned(*[[0.1 * i, 0.5 * (-1) ** i, 0] for i in range(9)])
    distances = np.full((9, 54), 0.3)
    distances[:, 5] = 7.0
    evidence = good_evidence(poses=poses, view_rms=np.full(9, 0.4), distances=distances)
    assert judge(evidence)[0][0].endswith("view 2, corner 5 (7.0 px) and 6 more")
    evidence = replace(evidence, view_rms=np.r_[np.full(3, 0.3), np.full(6, 9.0)] * 0.5)
    evidence = replace(evidence, view_rms=np.r_[np.full(12, 0.3), np.full(6, 9.0)])
    assert judge(evidence)[0][0].startswith("views 12, 13, 14, 15, 16, 17 do not fit")


def test_the_focal_length_is_open_between_parallel_boards_and_fixed_by_tilted_ones():
    tilted, flat = good_evidence(), good_evidence(poses=turned([0, 0, 0], [0, 0, 1], [0, 0, 2]))
    assert tilted.tilt_between == pytest.approx(np.degrees(np.arccos(tilted_cosine())), abs=1e-6)
    assert tilted.determinacy > 0.02
    assert flat.tilt_between == pytest.approx(0, abs=1e-5)
    assert flat.determinacy < 1e-12
    assert tilted.focal_uncertainty == pytest.approx(0.001, abs=1e-12)


def test_the_determinacy_is_that_of_zhangs_constraints_in_a_picture_scaled_to_1():
    e = good_evidence(A=intrinsics(1000, 1100, 300, 200))
    V = []
    for G in e.poses:
        # x = (u − 640)/640, y = (v − 480)/640
        h1, h2 = (np.array([[1000, 0, 300 - 640], [0, 1100, 200 - 480], [0, 0, 640]]) @ G[:3, :2]).T
        s = np.sqrt(np.linalg.norm(h1) * np.linalg.norm(h2))
        (a, b, c), (d, f, g) = h1 / s, h2 / s
        V.append([a * d, b * f, a * g + c * d, b * g + c * f, c * g])
        V.append([a * a - d * d, b * b - f * f, 2 * (a * c - d * g), 2 * (b * c - f * g), 0])
        V[-1][-1] = c * c - g * g
    sv = np.linalg.svd(V, compute_uv=False)
    assert e.determinacy == pytest.approx(sv[3] / sv[0], rel=1e-9)


def tilted_cosine():
    """Smallest |cos| between normals tilted by 35° towards azimuths 2 rad apart."""
    s, c = np.sin(np.radians(35)), np.cos(np.radians(35))
    return min(abs(c * c + s * s * np.cos(a)) for a in (2, 4, 2))


def test_autocorrelation_is_0_for_noise_and_1_for_drift():
    rng = np.random.default_rng(1)
    noise = rng.normal(size=(20, 54, 2))
    assert abs(autocorrelation(noise, 2000)) < 0.1
    drift = np.ones((20, 54, 2)) + 0.1 * noise
    assert autocorrelation(drift, 2000) > 0.9
    assert autocorrelation(noise + drift, 2000) == pytest.approx(0.47, abs=0.07)
    some_unseen = np.where(rng.uniform(size=(20, 54, 1)) < 0.01, np.nan, drift)
    assert autocorrelation(some_unseen, 2000) > 0.9


def test_autocorrelation_tells_nothing_of_rounding_errors_or_without_spare_measurements():
    assert autocorrelation(np.full((3, 54, 2), 1e-9), 300) == 0
    assert autocorrelation(np.ones((15, 4, 2)), 20) == 0


def test_what_corners_miss_together_is_told_from_noise_in_any_part_of_a_board():
    rng, W = np.random.default_rng(2), Chessboard((9, 6), 25.0).points
    noise = rng.normal(0, 1.0, (9, 54, 2))
    x, y = (W / 100)[:, :2].T
    slow = np.stack([x**3 - x, x * y], axis=-1)[None] * rng.normal(0, 3, (9, 1, 2))
    rms = np.median(np.sqrt((slow**2).sum((1, 2)) / 54))
    assert missed_together(noise, W) < 0.3
    assert missed_together(slow + 0.2 * noise, W) == pytest.approx(rms, rel=0.1)
    part = rng.uniform(size=(9, 54)) < 0.8
    part[0] = False
    partly = np.where(part[..., None], slow + 0.2 * noise, rng.choice([0, np.nan], (9, 54, 1)))
    assert missed_together(partly, W) == pytest.approx(rms, rel=0.2)
    one = noise.copy()
    one[4] += 100 * slow[4]
    assert missed_together(one, W) < 0.3  # one view does not decide
    assert missed_together(slow[:, :8], W[:8]) == 0.0
