"""The rational lens and the fisheye, held against OpenCV and against themselves."""

import warnings

import cv2
import numpy as np
import pytest

from cvnotes.base import CalibrationWarning, CvnotesError, ShapeError
from cvnotes.calibration import Calibration, calibrate, choose_model, reserve
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import Problem
from cvnotes.calibration.reliability import by_radius
from cvnotes.calibration.starts import Search
from cvnotes.calibration.zhang import extrinsics, radial_distortion
from cvnotes.camera import (
    Camera,
    FisheyeLens,
    Lens,
    RationalLens,
    intrinsics,
    look_at,
    pose,
    rotation_from_vector,
)
from cvnotes.camera.model import project_with_derivative
from cvnotes.files import read_camera
from cvnotes.homography import dlt
from cvnotes.pictures import render
from cvnotes.pictures.faces import edges_in_picture
from cvnotes.targets import Chessboard, refine_edges
from cvnotes.warping import undistort_image, undistortion_map

ZERO = np.zeros(3)


def some_rational(seed):
    rng = np.random.default_rng(seed)
    k = rng.normal(0, 0.2, 6) * [1, 0.5, 0.2, 1, 0.5, 0.2]
    p, s, tilt = rng.normal(0, 1e-3, 2), rng.normal(0, 1e-3, 4), rng.normal(0, 0.02, 2)
    return RationalLens(k, p, s * (seed % 2), tilt * (seed % 3 == 0))


def some_fisheye(seed):
    return FisheyeLens(np.random.default_rng(seed).normal(0, 0.05, 4) * [1, 0.5, 0.2, 0.1])


def within(lens, rng, part=0.97):
    """Ideal points that the lens reaches."""
    xy = rng.uniform(-0.8, 0.8, (200, 2))
    return xy[np.hypot(*xy.T) < part * min(lens.max_radius, 3)]


def directions(theta, rng):
    phi = rng.uniform(0, 2 * np.pi, len(theta))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)


@pytest.mark.parametrize("seed", range(12))
def test_opencv_shows_a_rational_lens_alike(seed):
    lens, rng = some_rational(seed), np.random.default_rng(seed)
    xy = within(lens, rng)
    k = lens.k
    d = np.array([*k[:2], *lens.p, *k[2:], *lens.s, *lens.tilt])
    theirs = cv2.projectPoints(np.c_[xy, np.ones(len(xy))], ZERO, ZERO, np.eye(3), d)[0]
    assert np.allclose(lens.distort(xy), theirs.reshape(-1, 2), rtol=0, atol=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_what_a_rational_lens_shows_it_takes_back(seed):
    lens, rng = some_rational(seed), np.random.default_rng(seed)
    xy = within(lens, rng)
    assert np.allclose(lens.undistort(lens.distort(xy)), xy, rtol=0, atol=1e-11)


@pytest.mark.parametrize("seed", range(12))
def test_opencv_shows_a_fisheye_alike(seed):
    lens, rng = some_fisheye(seed), np.random.default_rng(seed)
    M = directions(rng.uniform(0, min(0.98 * lens.max_angle, 1.5), 200), rng)
    theirs = cv2.fisheye.projectPoints(M[None], ZERO, ZERO, np.eye(3), np.array(lens.k))[0][0]
    assert np.allclose(lens.of_rays(M), theirs, rtol=0, atol=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_a_fisheye_takes_rays_back_from_behind_too(seed):
    lens, rng = some_fisheye(seed), np.random.default_rng(seed)
    M = directions(rng.uniform(0, min(0.98 * lens.max_angle, 3.0), 200), rng)
    assert np.allclose(lens.rays(lens.of_rays(M)), M, rtol=0, atol=1e-8)


@pytest.mark.parametrize("lens", [some_rational(3), some_rational(4), some_fisheye(5)])
def test_derivatives_are_those_of_what_is_shown(lens):
    rng = np.random.default_rng(0)
    h, M = 1e-6, rng.uniform([-0.5, -0.5, 1], [0.5, 0.5, 2], (40, 3))
    camera = Camera(intrinsics(800, 820, 320, 240, 3.0), lens=lens)
    m, by_M = project_with_derivative(camera, M)
    moved = [(camera.project(M + h * e) - camera.project(M - h * e)) / (2 * h) for e in np.eye(3)]
    assert np.allclose(m, camera.project(M))
    assert np.allclose(by_M, np.stack(moved, axis=-1), rtol=1e-6, atol=1e-4)


@pytest.mark.parametrize("lens", [some_rational(3), some_rational(4), some_fisheye(5)])
def test_derivatives_by_the_coefficients_are_those_of_what_is_shown(lens):
    rng = np.random.default_rng(1)
    M = rng.uniform([-0.5, -0.5, 1], [0.5, 0.5, 1], (40, 3)).T
    fisheye = isinstance(lens, FisheyeLens)

    def shown(change):
        value = np.array([*lens.parameters.values()]) + change
        if fisheye:
            return FisheyeLens(value).derivatives(M)[0]
        return RationalLens(value[:6], value[6:], lens.s, lens.tilt).derivatives(M)[0]

    C = lens.derivatives(M)[2]
    for i, e in enumerate(1e-6 * np.eye(len(C))):
        assert np.allclose(C[i], (shown(e) - shown(-e)) / 2e-6, rtol=0, atol=1e-8), i


def test_a_rational_lens_without_a_quotient_is_the_lens_of_the_notes():
    rational, polynomial = RationalLens((-0.25, 0.1, 0.02), (0.001, -0.002)), Lens(
        (-0.25, 0.1, 0.02), (0.001, -0.002)
    )  # fmt: skip
    xy = np.random.default_rng(0).uniform(-0.6, 0.6, (50, 2))
    assert np.allclose(rational.distort(xy), polynomial.distort(xy), rtol=0, atol=1e-14)
    assert np.isclose(rational.max_radius, polynomial.max_radius, rtol=1e-9)


def test_a_rational_lens_ends_at_its_pole_and_at_its_fold():
    # L = 1/(1 − r²) has a pole at 1; r L = r/(1 + r²) folds at 1
    assert np.isclose(RationalLens((0, 0, 0, -1.0)).max_radius, 1)
    assert np.isclose(RationalLens((0, 0, 0, 1.0)).max_radius, 1)
    assert np.isnan(RationalLens((0, 0, 0, 1.0)).distort([1.01, 0])).all()
    assert RationalLens((0.5, 0, 0, 0.2)).max_radius == np.inf


def test_an_equidistant_fisheye_shows_the_angle():
    lens = FisheyeLens()
    assert np.allclose(lens.of_rays([[1, 0, 1], [0, 2, 0], [-1, 0, -1]]),
                       np.pi * np.array([[0.25, 0], [0, 0.5], [-0.75, 0]]))  # fmt: skip
    assert np.isnan(lens.undistort([1.6, 0])).all()  # beyond 90° there is no point on z = 1
    assert FisheyeLens((-1 / 3,)).max_angle == pytest.approx(1)


def test_a_fisheye_camera_sees_what_stands_beside_it():
    camera = Camera(intrinsics(200, 200, 320, 240), lens=FisheyeLens())
    W = np.array([[5.0, 0, 0], [0, 5, -1], [0, 0, -1]])
    m = camera.project(W)
    assert np.allclose(m[0], [320 + 100 * np.pi, 240])
    assert np.allclose(camera.ray(m[:2]), W[:2] / np.linalg.norm(W[:2], axis=1, keepdims=True))
    assert np.isnan(m[2]).all() or np.hypot(*(m[2] - [320, 240])) > 600  # behind: no one place


@pytest.mark.parametrize(
    "lens", [RationalLens((0.3, 0.05, 0, 0.9, 0.2)), FisheyeLens((-0.02, 0.003))]
)
def test_a_board_through_a_wide_lens_has_its_corners_where_the_camera_says(lens):
    board = Chessboard((9, 6), 25.0)
    camera = Camera(
        intrinsics(300, 300, 320, 240), look_at([150, 60, -190], [100, 60, 0]), lens=lens
    )
    picture = render(board, camera, blur=0.7)
    found = refine_edges(picture, camera.project(board.points))
    seen = np.isfinite(found).all(-1)
    assert seen.sum() >= 50
    assert np.abs(found - camera.project(board.points))[seen].max() < 0.05


def test_a_straightened_fisheye_picture_is_that_of_an_ideal_camera():
    board = Chessboard((9, 6), 25.0)
    G, A = look_at([120, 80, -250], [100, 60, 0]), intrinsics(300, 300, 320, 240)
    bent = render(board, Camera(A, G, FisheyeLens()), blur=0.7)
    straight = render(board, Camera(A, G), blur=0.7)
    back = undistort_image(bent, Camera(A, G, FisheyeLens()))
    middle = (slice(140, 340), slice(200, 440))
    assert np.abs(back[middle].astype(float) - straight[middle]).mean() < 4
    m = undistortion_map(Camera(A, G, FisheyeLens()))([320 + 300, 240])
    assert np.allclose(m, [320 + 300 * np.pi / 4, 240])


@pytest.mark.parametrize("make", [RationalLens, FisheyeLens])
def test_bad_coefficients_are_refused(make):
    with pytest.raises(ShapeError, match="k: expected"):
        make(np.zeros(7))
    with pytest.raises(CvnotesError, match="NaN"):
        make([np.nan])
    with pytest.raises(CvnotesError, match="no lens has such"):
        make([1e60])


# --- calibration ------------------------------------------------------------------------------


def seen_by(camera, n, seed=0, corners=(9, 6)):
    """Boards all over the picture of a wide camera, in front of it and beside it."""
    rng, board = np.random.default_rng(seed), Chessboard(corners, 25.0)
    W, size, views = board.points, np.array(camera.size), []
    while len(views) < n:
        d = camera.ray(rng.uniform(0.1 * size, 0.9 * size))
        x = np.cross([0, 1, 0], d) / np.linalg.norm(np.cross([0, 1, 0], d))
        R = np.stack([x, np.cross(d, x), d], axis=1) @ rotation_from_vector(
            rng.uniform(-0.6, 0.6, 3)
        )
        T = d * rng.uniform(120, 400) - R @ W.mean(0)
        m = camera.moved(pose(R, T)).project(W)
        if np.isfinite(m).all() and (m > 0).all() and (m < size).all():
            views.append(m)
    return W, np.array(views)


TRUE = [
    ("rational", RationalLens((0.8, 0.1, 0.01, 1.1, 0.3, 0.02), (0.0005, -0.0003)), 300),
    ("fisheye", FisheyeLens((0.02, -0.01, 0.003, -0.0005)), 180),
    ("fisheye", FisheyeLens((-0.05, 0.01)), 120),
]


@pytest.mark.parametrize(("name", "lens", "f"), TRUE)
def test_exact_corners_give_the_exact_wide_camera(name, lens, f):
    camera = Camera(intrinsics(f, 1.005 * f, 325, 238), lens=lens)
    W, m = seen_by(camera, 15)
    found = calibrate(W, m, camera.size, lens=name)
    assert np.allclose(found.A, camera.A, rtol=0, atol=1e-6)
    assert np.allclose(found.lens.k, lens.k, rtol=0, atol=1e-6)
    assert found.names[-1] == ("p2" if name == "rational" else "k4")


@pytest.mark.parametrize(("name", "lens", "f"), TRUE[:2])
def test_noisy_corners_give_the_wide_camera_within_its_error_bars(name, lens, f):
    camera = Camera(intrinsics(f, 1.005 * f, 325, 238), lens=lens)
    W, m = seen_by(camera, 15)
    found = calibrate(
        W, m + np.random.default_rng(1).normal(0, 0.1, m.shape), camera.size, lens=name
    )
    assert found.reliable
    for key in ("alpha_u", "alpha_v", "u0", "v0"):
        error = abs(found.parameters[key] - camera.parameters[key])
        assert error < 4 * found.std[key] + 0.05, key


def test_opencv_finds_nothing_better_beside_the_fisheye_minimum():
    camera = Camera(intrinsics(220, 221, 322, 241), lens=FisheyeLens((0.02, -0.01, 0.003, 0.0)))
    W, m = seen_by(camera, 20)
    m = m[[camera.ray(v)[:, 2].min() > 0.3 for v in m]]  # OpenCV goes by the plane z = 1
    m = (m + np.random.default_rng(2).normal(0, 0.2, m.shape)).astype(np.float32).astype(float)
    found = calibrate(W, m, camera.size, lens="fisheye")
    # (4 and 5 keep the flags in different places)
    where = cv2.fisheye if hasattr(cv2.fisheye, "CALIB_FIX_SKEW") else cv2
    flags = where.CALIB_FIX_SKEW | where.CALIB_USE_INTRINSIC_GUESS
    flags |= where.CALIB_RECOMPUTE_EXTRINSIC
    rms, K, *_ = cv2.fisheye.calibrate(
        [W[None]] * len(m), [v[None] for v in m], camera.size, found.A.copy(),
        np.array(found.lens.k), flags=flags,
        criteria=(cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 300, 1e-14),
    )  # fmt: skip
    assert found.rms <= rms + 1e-6
    assert np.allclose(found.A, K, rtol=0, atol=0.05)


def test_opencv_comes_to_no_better_rational_minimum():
    name, lens, f = TRUE[0]
    camera = Camera(intrinsics(f, f, 322, 241), lens=lens)
    W, m = seen_by(camera, 12)
    m = (m + np.random.default_rng(3).normal(0, 0.2, m.shape)).astype(np.float32)
    boards = [W.astype(np.float32)] * len(m)
    flags = cv2.CALIB_RATIONAL_MODEL | cv2.CALIB_USE_INTRINSIC_GUESS
    rms, *_ = cv2.calibrateCamera(
        boards, list(m), camera.size, camera.A.copy(), np.zeros(8), flags=flags
    )
    found = calibrate(W, m.astype(float), camera.size, lens=name)
    assert found.rms < rms * (1 + 1e-3)


# --- which lens? ------------------------------------------------------------------------------


@pytest.mark.slow
def test_views_left_out_choose_the_model_that_took_the_pictures():
    rng = np.random.default_rng(4)
    cameras = {
        "k1 k2": Camera(intrinsics(800, 804, 325, 238), lens=Lens((-0.25, 0.1))),
        "fisheye": Camera(intrinsics(220, 221, 325, 238), lens=FisheyeLens((-0.03, 0.005))),
    }
    for name, camera in cameras.items():
        W, m = seen_by(camera, 15)
        found = calibrate(W, m + rng.normal(0, 0.1, m.shape), camera.size, lens="auto")
        assert found.choice.lens == name
        assert isinstance(found.lens, type(camera.lens))
        # what is left out is predicted as well as its noise (0.14 px per point) allows
        assert found.choice.by_lens[name] == pytest.approx(0.1 * np.sqrt(2), rel=0.1)


def test_each_lens_is_worked_out_however_badly_it_predicts():
    rng = np.random.default_rng(6)
    W, m = seen_by(Camera(intrinsics(220, 221, 325, 238), lens=FisheyeLens((-0.03, 0.005))), 10)
    m = m + rng.normal(0, 0.1, m.shape)
    lenses = ("k1 k2", "k1 k2 p1 p2", "k1 k2 p1 p2 k3", "fisheye")
    choice = choose_model(W, m, (640, 480), lenses=lenses, boards=["flat"])
    rms = choice.by_lens
    assert list(rms) == list(lenses)
    assert choice.lens == "fisheye"
    # views left out are predicted no better than they are fitted with all of them
    for name in lenses:
        with warnings.catch_warnings(action="ignore"):
            assert rms[name] > calibrate(W, m, (640, 480), lens=name).rms


@pytest.mark.slow
def test_a_lens_that_another_beats_is_not_started_over_and_over():
    """All starts of a polynomial end alike with the picture of a fisheye: two of them say so."""
    W, m = seen_by(Camera(intrinsics(200, 200, 320, 240), lens=FisheyeLens((0.01,))), 10)
    problem = Problem.of(Correspondences.of(W, m), (640, 480), "k1 k2", skew=False)
    every, beaten = Search(problem), Search(problem, rival=0.0)
    for search in (every, beaten):
        for start in search.starts():
            with start.attempt():
                H = start.homographies(dlt)
                A = start.intrinsics(None, H)
                G = start.extrinsics(extrinsics, A, H)
                start.refine(A, G, start.distortion(radial_distortion, A, G))
    assert len(every.minima) > 6
    assert len(beaten.minima) < 4
    assert beaten.best().cost == pytest.approx(every.best().cost, rel=1e-3)


def test_wide_lenses_are_tried_first_so_that_few_starts_do_for_what_they_beat(monkeypatch):
    W, m = seen_by(Camera(intrinsics(200, 200, 320, 240), lens=FisheyeLens((0.01,))), 10)
    kept, keep = [], Search.keep

    def counted(search, found):
        kept.append(search.problem.model)
        keep(search, found)

    monkeypatch.setattr(Search, "keep", counted)
    choice = choose_model(W, m, (640, 480), lenses=("k1 k2", "fisheye"), boards=["flat"])
    assert list(choice.by_lens) == ["k1 k2", "fisheye"]
    assert kept[0] is FisheyeLens
    assert kept.count(Lens) < 4


def test_a_lens_that_is_too_small_is_never_reliable():
    camera = Camera(intrinsics(300, 300, 325, 238), lens=FisheyeLens())
    W, m = seen_by(camera, 15)
    m = m + np.random.default_rng(5).normal(0, 0.05, m.shape)
    for lens in ("k1 k2", "k1 k2 p1 p2"):
        with pytest.warns(CalibrationWarning):
            assert not calibrate(W, m, camera.size, lens=lens).reliable
    assert calibrate(W, m, camera.size, lens="fisheye").reliable


def few_corners(camera, seed):
    W, m = seen_by(camera, 10, seed, corners=(5, 4))
    m = m[[np.isfinite(camera.ideal(one)).all() for one in m]]  # before the camera
    return W, m + np.random.default_rng(seed).normal(0, 0.1, m.shape)


@pytest.mark.parametrize("lens", ["k1", "k1 k2", "k1 k2 k3", "k1 k2 p1 p2 k3"])
@pytest.mark.slow
def test_few_corners_of_a_fisheye_are_not_believed_to_be_a_pinholes(lens):
    """Boards of 5×4 corners have no long rows in which residuals could be alike."""
    camera = Camera(intrinsics(200, 200, 320, 320), lens=FisheyeLens((-0.01,)), size=(640, 640))
    for seed in range(4):
        W, m = few_corners(camera, seed)
        with pytest.warns(CalibrationWarning):
            found = calibrate(W, m, camera.size, lens=lens)
        assert 0.5 < found.rms < 2
        assert not found.reliable
        assert calibrate(W, m, camera.size, lens="fisheye").reliable


def test_starts_that_end_alike_turn_the_boards_over_once(monkeypatch):
    camera = Camera(intrinsics(200, 200, 320, 320), lens=FisheyeLens((-0.01,)), size=(640, 640))
    W, m = few_corners(camera, 0)
    ended, turned = [], []
    for name, asked in (("best_turned", ended), ("_lower_minima", turned)):
        ask = getattr(reserve, name)
        monkeypatch.setattr(
            reserve, name, lambda *a, ask=ask, asked=asked: asked.append(a) or ask(*a)
        )
    with pytest.warns(CalibrationWarning):
        calibrate(W, m, camera.size, lens="k1")
    assert np.ptp([found.cost for _, found, _ in ended]) < 1e-6
    assert len(ended) == 6  # the others would end there too
    assert len(turned) == 1


def test_by_radius_tells_what_a_lens_would_explain_from_noise():
    rng = np.random.default_rng(6)
    m = rng.uniform(0, 600, (10, 54, 2))
    noise, centre = rng.normal(0, 0.2, m.shape), np.array([320.0, 240])
    outwards = 1e-8 * ((m - centre) ** 2).sum(-1, keepdims=True) * (m - centre)
    assert by_radius(noise, m, centre) == 0
    assert by_radius(outwards, m, centre) > 0.99
    assert 0.3 < by_radius(noise + outwards, m, centre) < 1
    assert by_radius(1e-9 * outwards, m, centre) == 0  # nothing that matters


@pytest.mark.parametrize("name", ["k1 k2", "fisheye"])
def test_of_three_views_none_is_left_out_and_the_lens_is_right_all_the_same(name):
    narrow = Camera(intrinsics(800, 804, 325, 238), lens=Lens((-0.25, 0.1)))
    wide = Camera(intrinsics(220, 221, 325, 238), lens=FisheyeLens((-0.03, 0.005)))
    camera = narrow if name == "k1 k2" else wide
    W, m = seen_by(camera, 3)
    m = m + np.random.default_rng(1).normal(0, 0.1, m.shape)
    with warnings.catch_warnings(action="ignore"):
        found = calibrate(W, m, camera.size, lens="auto", board="auto")
    assert (found.choice.lens, found.choice.board) == (name, "flat")


@pytest.mark.parametrize("lens", ["rational", "fisheye"])
def test_a_wide_calibration_comes_back_from_its_file(tmp_path, lens):
    camera = Camera(intrinsics(300, 300, 325, 238), lens=FisheyeLens((-0.02, 0.003)))
    W, m = seen_by(camera, 8)
    m = m + np.random.default_rng(7).normal(0, 0.05, m.shape)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CalibrationWarning)
        found = calibrate(W, m, camera.size, lens=lens)
    found.save(tmp_path / "calibration.json")
    back = Calibration.load(tmp_path / "calibration.json")
    assert (back.lens, back.names, back.std) == (found.lens, found.names, found.std)
    assert read_camera(tmp_path / "calibration.json").lens == found.lens


def test_a_board_near_90_degrees_of_a_fisheye_has_no_more_pieces_than_its_edges_are_long():
    lens = FisheyeLens((0.02, -0.01, 0.003))
    for turn, place in (
        ((-0.712, -0.75, -0.139), (-272.6, -45.1, 39.9)),
        ((0.0, 0.5, 0.1), (-100, -60, 60)),
    ):
        camera = Camera(
            intrinsics(190, 190, 320, 240), pose(rotation_from_vector(turn), place), lens
        )
        start, end, _ = edges_in_picture(Chessboard((9, 6), 25.0), camera, step=1.0)
        lengths = np.linalg.norm(end - start, axis=1)
        assert lengths.max() < 1.2
        assert len(lengths) < 3 * lengths.sum()


def test_a_lens_that_is_beaten_where_another_of_its_kind_ended_is_not_started_again():
    W, m = seen_by(Camera(intrinsics(200, 200, 320, 240), lens=FisheyeLens((0.01,))), 10)
    data = Correspondences.of(W, m)
    found = calibrate(W, m, (640, 480), lens="fisheye")
    problem = Problem.of(data, (640, 480), "k1 k2", skew=False)
    x = problem.state(found.camera, data.pose_in_scaled_units(found.poses))
    alone, beaten = Search(problem, patience=3), Search(problem, patience=3, rival=0.0)
    for search in (alone, beaten):
        search.resume(Camera(found.A, size=(640, 480)), x)
    assert len(alone.minima) == len(beaten.minima) == 1
    assert next(alone.starts(), None) is not None
    assert next(beaten.starts(), None) is None
