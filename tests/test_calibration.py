import re
import tracemalloc
import warnings

import numpy as np
import pytest

from cvnotes.base import (
    CalibrationWarning,
    ConvergenceError,
    CvnotesError,
    DegenerateError,
    InputTypeError,
    ShapeError,
)
from cvnotes.calibration import (
    LENSES,
    Calibration,
    calibrate,
    constraints,
    extrinsics,
    intrinsics_from_b,
    radial_distortion,
    reserve,
    solve_b,
    starts,
)
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import Problem, State, solve_by_schur
from cvnotes.calibration.starts import Search, resumed
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector
from cvnotes.homography import dlt

SIZE = (1280, 960)
FULL = "k1 k2 p1 p2 k3"
TRUTH = Camera(
    intrinsics(1000, 1004, 650, 470),
    lens=Lens(k=(-0.2, 0.08, -0.02), p=(0.001, -0.0005)),
    size=SIZE,
)
RADIAL = Camera(TRUTH.A, lens=Lens(k=(-0.2, 0.08)), size=SIZE)


def quietly(*args, **options):
    """Calibrate; what is warned of is what the result keeps."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", CalibrationWarning)
        result = calibrate(*args, **options)
    assert tuple(str(w.message) for w in caught) == result.warnings
    return result


def noise(m, rng, sigma=0.3):
    return m + rng.normal(size=m.shape) * sigma


@pytest.fixture(scope="module")
def exact(views_of):
    """15 poses and exact corners through the radial lens."""
    return views_of(RADIAL, 15, np.random.default_rng(0))


@pytest.fixture(scope="module")
def noisy(exact):
    return noise(exact[1], np.random.default_rng(1))


# What is exact comes back exactly.


@pytest.mark.parametrize("n", [2, 3, 5, 15, 25, 45])
def test_exact_corners_give_back_the_camera_and_the_poses(board, views_of, n):
    poses, m = views_of(RADIAL, n, np.random.default_rng(n))
    result = quietly(board.points, m, SIZE)
    assert np.allclose(result.A, TRUTH.A, rtol=1e-9, atol=1e-8)
    assert np.allclose(result.lens.k, RADIAL.lens.k, rtol=0, atol=1e-9)
    assert np.allclose(result.poses, poses, rtol=1e-9, atol=1e-8)
    assert result.rms < 1e-9
    assert result.converged


@pytest.mark.parametrize("skew", [False, True])
@pytest.mark.parametrize("lens", [name for name in LENSES if LENSES[name][0] is Lens])
def test_every_lens_model_comes_back_with_and_without_skew(board, views_of, lens, skew):
    _, names = LENSES[lens]
    n_radial, tangential = sum(name[0] == "k" for name in names), "p1" in names
    camera = Camera(
        intrinsics(1000, 1004, 650, 470, skew=2.5 * skew),
        lens=Lens(k=TRUTH.lens.k[:n_radial], p=TRUTH.lens.p if tangential else (0, 0)),
        size=SIZE,
    )
    _, m = views_of(camera, 8, np.random.default_rng(2))
    result = calibrate(board.points, m, SIZE, lens=lens, skew=skew)
    assert np.allclose(result.A, camera.A, rtol=1e-9, atol=1e-8)
    assert np.allclose(result.lens.k, camera.lens.k, rtol=0, atol=1e-8)
    assert np.allclose(result.lens.p, camera.lens.p, rtol=0, atol=1e-9)
    assert ("skew" in result.names) == skew
    assert len(result.names) == 4 + skew + n_radial + 2 * tangential


def test_views_that_show_parts_of_the_board_give_the_same_camera(board, views_of):
    poses, m = views_of(RADIAL, 6, np.random.default_rng(3))
    rng = np.random.default_rng(4)
    kept = [rng.permutation(54)[: rng.integers(20, 54)] for _ in m]
    result = calibrate([board.points[k] for k in kept], [a[k] for a, k in zip(m, kept)], SIZE)  # noqa: B905
    assert np.allclose(result.A, TRUTH.A, rtol=1e-9, atol=1e-8)
    assert np.allclose(result.poses, poses, rtol=1e-9, atol=1e-8)
    assert [len(r) for r in result.residuals] == [len(k) for k in kept]


def test_points_left_out_are_as_if_they_had_not_been_there(board, noisy):
    shorter = calibrate(board.points[:40], noisy[:, :40], SIZE)
    lists = calibrate([board.points[:40]] * 15, list(noisy[:, :40]), SIZE)
    ragged_points = [board.points[:40]] * 14 + [board.points]
    ragged = calibrate(ragged_points, [*noisy[:14, :40], noisy[14]], SIZE)
    assert np.allclose(lists.A, shorter.A, atol=1e-9)
    assert np.abs(ragged.A - shorter.A).max() < 3
    assert ragged.std["alpha_u"] < shorter.std["alpha_u"]


# The steps that lead to the start.


def problem_of(board, m, **model):
    data = Correspondences.of(board.points, m)
    return Problem(data.W, data.m, data.seen, size=SIZE, **model)


def test_the_first_start_has_its_piercing_point_in_the_middle_of_the_picture(
    board, views_of, first_start
):
    found = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        m = noise(views_of(RADIAL, 3, rng)[1], rng)
        start = first_start(problem_of(board, m, coefficients=()))
        assert np.allclose(start.shared[2:], [639.5, 479.5], atol=1e-9)
        found.append(start.shared[:2])
    assert np.abs(np.median(found, axis=0) / 1000 - 1).max() < 0.15


@pytest.mark.parametrize(("seed", "tilt"), [(181, 30), (171, 45)])
def test_a_strong_lens_is_straightened_where_no_other_start_leads_to_it(
    board, views_of, seed, tilt
):
    rng = np.random.default_rng([seed, 12, tilt])
    alpha = rng.uniform(400, 560)
    A = intrinsics(alpha, alpha, 639.5 + rng.uniform(-128, 128), 479.5 + rng.uniform(-96, 96))
    lens = Lens(k=(rng.uniform(-0.45, -0.3), rng.uniform(0.08, 0.15)))
    _, m = views_of(Camera(A, lens=lens, size=SIZE), 12, rng, tilt=tilt, fill=(0.3, 0.95))
    result = quietly(board.points, noise(m, rng), SIZE)
    assert result.rms < 0.5
    assert abs(result.A[0, 0] - alpha) < 4.5 * result.std["alpha_u"]


def test_a_lens_that_folds_before_some_corners_does_not_keep_the_others_from_a_start(board, exact):
    problem = problem_of(board, exact[1])
    folding = Camera(TRUTH.A, lens=Lens(k=(-1.2,)), size=SIZE)  # beyond a radius of 0.53
    start = resumed(Search(problem), folding)
    H = start.homographies(dlt)
    A = start.intrinsics(None, H)
    state = start.state(A, start.extrinsics(extrinsics, A, H), folding.lens)
    assert np.isnan(Lens(k=(-1.2,)).undistort((exact[1][0] - 600) / 1000)).any()
    assert np.isfinite(state.T).all()
    assert (state.T[:, 2] > 0).all()


def test_many_views_are_started_from_a_few_of_them_and_end_where_all_would_have_led(
    board, views_of, monkeypatch
):
    rng = np.random.default_rng(4)
    m = noise(views_of(RADIAL, 160, rng)[1], rng)
    went_on = []

    def watched(search, camera):
        went_on.append((len(search.problem.m), camera))
        return resumed(search, camera)

    monkeypatch.setattr(starts, "resumed", watched)
    quietly(board.points, m[:150], SIZE)
    assert not went_on
    result = quietly(board.points, m, SIZE)
    [(n_views, camera)] = went_on
    assert n_views == 160
    # 16 views already know the camera to some of their error bars, which are √10 times as long
    off = [camera.parameters[name] - TRUTH.parameters[name] for name in result.names[:4]]
    assert np.abs(off / np.array(list(result.std.values())[:4])).max() < 15
    # and the refinement ends where the derivatives of the cost, with respect to all, vanish
    problem = problem_of(board, m)
    data = Correspondences.of(board.points, m)
    T = (result.poses[:, :3, 3] + result.poses[:, :3, :3] @ data.centre) / data.scale
    end = State(np.array(list(result.parameters.values())), result.poses[:, :3, :3], T)
    (step, _), gain = solve_by_schur(problem.linearise(end)[1], 0.0)
    assert np.abs(step / list(result.std.values())).max() < 1e-3
    assert gain < 1e-9 * problem.linearise(end)[0]


@pytest.mark.parametrize(("n_views", "at_most"), [(8, 110), (12, 60)])
@pytest.mark.parametrize("wrong", ["a row is shifted", "two corners are exchanged"])
def test_wrong_corners_of_one_view_are_not_searched_for_a_better_start(
    wrong, n_views, at_most, board, views_of, monkeypatch
):
    """No pose and no lens explains them: it took up to 400 minimisations to say so."""
    _, m = views_of(RADIAL, n_views, np.random.default_rng(1))
    m = noise(m, np.random.default_rng(2))
    if wrong == "a row is shifted":
        row = m[4].reshape(6, 9, 2)[2]
        row[:-1], row[-1] = row[1:].copy(), 2 * row[-1] - row[-2]
    else:
        m[4, [3, 40]] = m[4, [40, 3]]
    counts = []
    for module in (starts, reserve):
        minimise = module.minimise
        monkeypatch.setattr(
            module, "minimise", lambda *a, f=minimise, **k: (counts.append(1), f(*a, **k))[1]
        )
    result = quietly(board.points, m, SIZE, lens="auto", board="auto")
    assert not result.reliable
    assert any("views 4 do not fit the others" in sentence for sentence in result.warnings)
    assert len(counts) < at_most, len(counts)


def test_whatever_the_start_the_same_minimum_is_reached_to_a_fraction_of_the_error_bars(
    board, views_of
):
    for seed in range(30):
        rng = np.random.default_rng(seed)
        m = noise(views_of(RADIAL, 10, rng, tilt=30)[1], rng)
        one = quietly(board.points, m, SIZE, lens="k1 k2 p1 p2")
        other = quietly(
            board.points, m, SIZE, lens="k1 k2 p1 p2", intrinsics=lambda _: np.diag([2.0, 2, 1])
        )
        off = np.subtract(list(one.parameters.values()), list(other.parameters.values()))
        assert np.abs(off / list(one.std.values())).max() < 1e-4


# What does not matter, does not matter.


@pytest.mark.parametrize("unit", [1e-3, 1e3, 1e6])
def test_the_unit_of_the_board_does_not_matter(board, noisy, unit):
    plain, other = (calibrate(board.points * u, noisy, SIZE, lens=FULL) for u in (1, unit))
    assert np.allclose(other.A, plain.A, rtol=0, atol=1e-5)
    assert np.allclose(other.lens.k, plain.lens.k, rtol=0, atol=1e-7)
    assert np.allclose(other.poses[:, :3, 3], plain.poses[:, :3, 3] * unit, rtol=1e-7, atol=0)
    assert other.std["alpha_u"] == pytest.approx(plain.std["alpha_u"], rel=1e-6)


@pytest.mark.parametrize("squares", [30, 300, 30_000])
def test_the_origin_of_the_board_does_not_matter(board, noisy, squares):
    away = np.array([squares, -squares, 0]) * 25.0
    plain, other = (calibrate(board.points + s, noisy, SIZE, lens=FULL) for s in (0, away))
    assert np.allclose(other.A, plain.A, rtol=0, atol=1e-5)
    seen = [
        c.project(board.points + s) for r, s in ((plain, 0), (other, away)) for c in r.cameras[:3]
    ]
    assert np.allclose(seen[:3], seen[3:], rtol=0, atol=1e-5)


def test_the_order_of_views_and_points_does_not_matter(board, noisy):
    rng = np.random.default_rng(5)
    views, points = rng.permutation(15), rng.permutation(54)
    plain = calibrate(board.points, noisy, SIZE, lens=FULL)
    other = calibrate(board.points[points], noisy[views][:, points], SIZE, lens=FULL)
    assert np.allclose(other.A, plain.A, rtol=0, atol=1e-5)
    assert np.allclose(other.poses, plain.poses[views], rtol=0, atol=1e-5)
    assert np.allclose(other.view_rms, plain.view_rms[views], rtol=0, atol=1e-7)


def test_boards_numbered_from_the_other_end_do_not_matter(board, noisy):
    other = noisy.copy()
    other[::2] = noisy[::2, ::-1]  # half a turn of the labels
    plain = calibrate(board.points, noisy, SIZE, lens=FULL)
    turned = calibrate(board.points, other, SIZE, lens=FULL)
    assert np.allclose(turned.A, plain.A, rtol=0, atol=1e-5)
    assert turned.reliable


def changed_picture(name, W, m):
    """The board, the corners and the size after a change of the picture, and what A becomes."""
    w, h = SIZE
    u, v = m[..., 0], m[..., 1]
    x, y, z = W.T
    if name == "flipped":  # and the labels with it, so that the board is seen from the front
        return np.c_[-x, y, z], np.stack([w - 1 - u, v], -1), SIZE, (1, 0, w - 1, -1, 0, 1)
    if name == "turned by 180°":
        return W, [w - 1, h - 1] - m, SIZE, (1, 0, w - 1, -1, h - 1, -1)
    if name == "cropped":
        return W, m - [200, 100], (1080, 860), (1, 0, -200, 1, -100, 1)
    if name == "scaled twice":  # pixel centres are integers: the corner of the picture is at −½
        return W, 2 * m + 0.5, (2 * w, 2 * h), (2, 0, 0.5, 2, 0.5, 2)
    raise ValueError(name)


@pytest.mark.parametrize("name", ["flipped", "turned by 180°", "cropped", "scaled twice"])
def test_changing_the_picture_changes_the_camera_as_theory_says(board, noisy, name):
    W, m, size, (scale, _, du, su, dv, sv) = changed_picture(name, board.points, noisy)
    plain = calibrate(board.points, noisy, SIZE, lens=FULL)
    other = quietly(W, m, size, lens=FULL)
    A = plain.A
    expected = intrinsics(scale * A[0, 0], scale * A[1, 1], su * A[0, 2] + du, sv * A[1, 2] + dv)
    assert np.allclose(other.A, expected, rtol=0, atol=1e-5)
    assert np.allclose(other.lens.k, plain.lens.k, rtol=0, atol=1e-7)
    p1, p2 = plain.lens.p
    mirrored = (np.sign(sv) * p1, np.sign(su) * p2)
    assert np.allclose(other.lens.p, mirrored, rtol=0, atol=1e-8)
    assert other.rms == pytest.approx(scale * plain.rms, rel=1e-6)


def test_exchanging_the_axes_of_board_and_picture_exchanges_the_parameters(board, noisy):
    plain = calibrate(board.points, noisy, SIZE, lens=FULL)
    other = calibrate(board.points[:, [1, 0]], noisy[..., ::-1], SIZE[::-1], lens=FULL)
    assert other.reliable
    expected = plain.A[[1, 0, 2]][:, [1, 0, 2]]
    assert np.allclose(other.A, expected, rtol=0, atol=1e-5)
    assert np.allclose(other.lens.p, plain.lens.p[::-1], rtol=0, atol=1e-8)


# What the result says of itself.


def test_rms_and_residuals_are_per_point_of_observed_minus_predicted(board, noisy):
    result = calibrate(board.points, noisy, SIZE)
    cameras = [Camera(result.A, G, result.lens, SIZE) for G in result.poses]
    residuals = noisy - [c.project(board.points) for c in cameras]
    squared = (residuals**2).sum(-1)
    assert np.allclose(result.residuals, residuals, atol=1e-9)
    assert result.rms == pytest.approx(np.sqrt(squared.mean()), rel=1e-9)
    assert np.allclose(result.view_rms, np.sqrt(squared.mean(1)), rtol=1e-6)
    assert np.array_equal(result.image_points, noisy)
    assert np.allclose(result.board_points, [board.points] * 15, atol=1e-9)


def test_parameters_and_their_deviations_go_by_name(board, noisy):
    result = calibrate(board.points, noisy, SIZE, lens=FULL, skew=True)
    A, (k1, k2, k3), (p1, p2) = result.A, result.lens.k, result.lens.p
    assert result.parameters == {
        **{"alpha_u": A[0, 0], "alpha_v": A[1, 1], "skew": A[0, 1], "u0": A[0, 2], "v0": A[1, 2]},
        **{"k1": k1, "k2": k2, "k3": k3, "p1": p1, "p2": p2},
    }
    assert list(result.std) == list(result.names) == list(result.parameters)
    assert np.allclose(list(result.std.values()), np.sqrt(np.diag(result.covariance)), atol=0)
    for name, value in (("alpha_u", 1000), ("v0", 470), ("k1", -0.2), ("p1", 0), ("skew", 0)):
        assert abs(result.parameters[name] - value) < 4.5 * result.std[name]


def test_the_result_reads_well_in_a_terminal_and_in_a_notebook(board, noisy):
    result = calibrate(board.points, noisy, SIZE)
    text, html = repr(result), result._repr_html_()
    assert text.startswith("Calibration from 15 views, 1280×960 px\n  alpha_u ")
    # two digits of each standard deviation, and the value to the same place
    assert f"{result.A[0, 0]:.2f} ± {result.std_of_views['alpha_u']:.2f} px" in text
    assert f"{result.lens.k[0]:.4f} ± {result.std_of_views['k1']:.4f}" in text
    assert f"RMS {result.rms:.4f} px per point; worst view {result.view_rms.argmax()}" in text
    assert "NOT RELIABLE" not in text
    assert f"<td>{result.A[0, 0]:.2f}</td>" in html
    assert "Not reliable" not in html
    doubtful = quietly(board.points, noisy[..., ::-1], SIZE[::-1])
    assert "NOT RELIABLE:\n  ! every board is seen from behind" in repr(doubtful)
    assert "<strong>Not reliable.</strong><ul><li>every board" in doubtful._repr_html_()


def test_cameras_stand_where_the_boards_are_seen_from(board, exact):
    poses, m = exact
    result = calibrate(board.points, m, SIZE)
    for camera, G, seen in zip(result.cameras, poses, m, strict=True):
        assert np.allclose(camera.project(board.points), seen, atol=1e-8)
        assert np.allclose(camera.centre, -G[:3, :3].T @ G[:3, 3], atol=1e-6)
    assert np.array_equal(result.camera.G, np.eye(4))


def test_what_a_file_does_not_keep_is_not_made_up():
    bare = Calibration(TRUTH.A, TRUTH.lens, SIZE, np.eye(4)[None], 0.3, np.array([0.3]), (), None)
    assert bare.residuals == ()
    with pytest.raises(CvnotesError, match="the uncertainty of the poses is not kept"):
        bare.pose_covariance  # noqa: B018


@pytest.mark.sampling
def test_the_covariance_of_the_poses_is_their_scatter(board, views_of, refined):
    poses, m = views_of(RADIAL, 6, np.random.default_rng(6))
    R, n, scatter, claimed = poses[:, :3, :3], 300, 0.0, 0.0
    for seed in range(n):
        result = refined(board.points, noise(m, np.random.default_rng(seed)), RADIAL, poses)
        dR = result.poses[:, :3, :3] @ R.mT
        omega = 0.5 * np.stack(
            [dR[:, 2, 1] - dR[:, 1, 2], dR[:, 0, 2] - dR[:, 2, 0], dR[:, 1, 0] - dR[:, 0, 1]], -1
        )
        d = np.c_[omega, result.poses[:, :3, 3] - poses[:, :3, 3]]
        scatter = scatter + d[:, :, None] * d[:, None, :] / n
        claimed = claimed + result.pose_covariance / n
    deviation = np.sqrt(np.diagonal(claimed, axis1=1, axis2=2))
    unit = deviation[:, :, None] * deviation[:, None, :]
    ratio = np.diagonal(scatter / unit, axis1=1, axis2=2)
    assert (ratio > 0.75).all()  # χ² with 300 degrees of freedom: ± 8 %, 36 of them
    assert (ratio < 1.3).all()
    correlation = np.abs((scatter - claimed) / unit)
    assert correlation.max() < 0.3


# The student's own functions.


def my_dlt(src, dst):
    rows = []
    for (x, y), (u, v) in zip(src, dst, strict=True):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y, -u], [0, 0, 0, x, y, 1, -v * x, -v * y, -v]]
    return np.linalg.svd(np.array(rows), full_matrices=False)[2][-1].reshape(3, 3)


def my_intrinsics(H):
    return intrinsics_from_b(solve_b(constraints(np.array([h / h[2, 2] for h in H]))))


def my_extrinsics(A, H):
    G = []
    for h in H:
        r1, r2, T = (np.linalg.inv(A) @ h).T
        scale = np.linalg.norm(r1) * np.sign(T[2])
        U, _, Vt = np.linalg.svd(np.stack([r1, r2, np.cross(r1, r2) / scale], -1) / scale)
        G.append(pose(U @ Vt, T / scale))
    return np.array(G)


def my_distortion(A, G, W, m, terms):  # noqa: ARG001
    return np.zeros(terms)


@pytest.mark.parametrize(
    "own",
    [
        {"homography": my_dlt},
        {"intrinsics": my_intrinsics},
        {"extrinsics": my_extrinsics},
        {"distortion": my_distortion},
        {
            "homography": my_dlt,
            "intrinsics": my_intrinsics,
            "extrinsics": my_extrinsics,
            "distortion": my_distortion,
        },
    ],
    ids=lambda own: " ".join(own),
)
@pytest.mark.parametrize("n", [5, 25])
def test_the_students_own_steps_lead_to_the_same_camera(board, views_of, own, n):
    m = noise(views_of(RADIAL, n, np.random.default_rng(7))[1], np.random.default_rng(8))
    ours, theirs = calibrate(board.points, m, SIZE), calibrate(board.points, m, SIZE, **own)
    assert np.allclose(theirs.A, ours.A, rtol=0, atol=1e-4)


def test_the_students_steps_are_really_used(board, noisy):
    asked = []

    def spy(name, step):
        def called(*args, **options):
            asked.append(name)
            return step(*args, **options)

        return called

    calibrate(
        board.points,
        noisy[:5],
        SIZE,
        homography=spy("homography", dlt),
        intrinsics=spy("intrinsics", my_intrinsics),
        extrinsics=spy("extrinsics", extrinsics),
        distortion=spy("distortion", radial_distortion),
    )
    assert asked == ["homography"] * 5 + ["intrinsics", "extrinsics", "distortion"]


def test_what_a_students_step_does_to_its_input_stays_with_it(board, exact):
    def untidy(step):
        def called(*args, **options):
            answer = step(*args, **options)
            for array in args:
                array[...] = 0
            return answer

        return called

    m = exact[1][:5]
    result = calibrate(
        board.points,
        m,
        SIZE,
        homography=untidy(my_dlt),
        intrinsics=untidy(my_intrinsics),
        extrinsics=untidy(my_extrinsics),
        distortion=untidy(radial_distortion),
    )
    assert np.allclose(result.A, TRUTH.A, atol=1e-7)
    assert m.any()


FAR = "puts the corners far from where they were seen.*transposed, or the inverse"


@pytest.mark.parametrize(
    ("own", "error", "words"),
    [
        ({"homography": "dlt"}, InputTypeError, "homography: expected a function, got str"),
        ({"homography": lambda *_: None}, InputTypeError, "homography of view 0: .*got None"),
        ({"homography": lambda s, d: dlt(s, d).ravel()}, ShapeError, r"\(3, 3\), got \(9,\)"),
        ({"homography": lambda s, d: dlt(s, d).T}, CvnotesError, FAR),
        ({"homography": lambda s, d: dlt(d, s)}, CvnotesError, FAR),
        ({"homography": lambda *_: np.eye(3)}, CvnotesError, FAR),
        ({"homography": lambda *_: np.zeros((3, 3))}, CvnotesError, FAR),
        ({"homography": lambda *_: np.full((3, 3), np.nan)}, CvnotesError, "view 0 contains NaN"),
        ({"intrinsics": lambda _: None}, InputTypeError, "A of your intrinsics: .*got None"),
        ({"intrinsics": lambda H: my_intrinsics(H).T}, CvnotesError, r"upper triangular \(transp"),
        ({"intrinsics": lambda H: 2 * my_intrinsics(H)}, CvnotesError, "must be 1; divide"),
        ({"intrinsics": lambda H: my_intrinsics(H)[0]}, ShapeError, r"\(3, 3\), got \(3,\)"),
        (
            {"intrinsics": lambda _: np.diag([1e-3, 1e3, 1])},
            ConvergenceError,
            "no start leads to a camera.*or your intrinsics start far from it",
        ),
        ({"extrinsics": lambda *_: None}, InputTypeError, "poses of your extrinsics: .*got None"),
        (
            {"extrinsics": lambda A, H: extrinsics(A, H)[:, :3]},
            ShapeError,
            r"poses of your extrinsics: expected shape \(4, 4\), got \(5, 3, 4\)",
        ),
        (
            {"extrinsics": lambda A, H: extrinsics(A, H)[:3]},
            ShapeError,
            r"poses of your extrinsics: expected shape \(5, 4, 4\), got \(3, 4, 4\)",
        ),
        (
            {"extrinsics": lambda A, H: extrinsics(A, H) * [1, 1, -1, 1]},
            CvnotesError,
            "poses of your extrinsics has det = -1: a reflection",
        ),
        (
            {"extrinsics": lambda A, H: extrinsics(A, H) * [[1], [1], [1], [2]]},
            CvnotesError,
            r"the last row of a rigid motion is \(0, 0, 0, 1\)",
        ),
        (
            {"extrinsics": lambda A, H: extrinsics(A, H) * [[-1], [1], [-1], [1]]},
            CvnotesError,
            "put the board of view . behind the camera.*take the sign that gives T_z > 0",
        ),
        ({"distortion": lambda *_, terms: None}, InputTypeError, "k of your distortion: .*None"),  # noqa: ARG005
        (
            {"distortion": lambda *_, terms: np.zeros(terms + 1)},
            ShapeError,
            r"k of your distortion: expected shape \(2,\), got \(3,\)",
        ),
        ({"distortion": lambda *_, terms: 0.1}, ShapeError, r"got \(\)"),  # noqa: ARG005
        ({"distortion": lambda *_, terms: np.full(terms, 1e60)}, CvnotesError, "no lens has such"),
    ],
)
def test_a_students_mistake_is_named(board, noisy, own, error, words):
    with pytest.raises(error, match=words):
        calibrate(board.points, noisy[:5], SIZE, **own)


def test_what_a_students_step_raises_is_the_students_to_read(board, noisy):
    def unfinished(src, dst):
        raise NotImplementedError("step 1")

    with pytest.raises(NotImplementedError, match="step 1"):
        calibrate(board.points, noisy[:5], SIZE, homography=unfinished)


# What cannot be calibrated is refused in words, and what should not be believed says so.


@pytest.mark.parametrize(
    ("change", "options", "error", "words"),
    [
        (lambda W, m: (W, m[:0]), {}, DegenerateError, "need at least one view"),
        (lambda W, m: (W, m[:1]), {}, DegenerateError, "at least 2 views of the board, got 1"),
        (lambda W, m: (W, m[0]), {}, DegenerateError, "at least 2 views of the board, got 1"),
        (lambda W, m: (W, m[:2]), {"skew": True}, DegenerateError, "at least 3 views .* got 2"),
        (lambda W, m: (W[:3], m[:, :3]), {}, DegenerateError, "at least 4 points"),
        (
            lambda W, m: (W[[0, 8, 45, 53]], m[:3][:, [0, 8, 45, 53]]),
            {},
            DegenerateError,
            "24 measured coordinates cannot determine 24 parameters",
        ),
        (lambda W, m: (W, m * 0 + 300), {}, DegenerateError, "view 0: all its image points coin"),
        (lambda W, m: (W[:9], m[:, :9]), {}, DegenerateError, "view 0: all points of src are col"),
        (
            lambda W, m: (np.r_[W[:9], W[9:10]], m[:, :10]),
            {},
            DegenerateError,
            "view 0: all but one of the points lie on a line",
        ),
        (lambda W, m: (W, np.repeat(m[:1], 15, 0)), {}, DegenerateError, "rank of V too low"),
        (
            lambda W, m: (W, np.random.default_rng(0).uniform(0, 900, m.shape)),
            {},
            ConvergenceError,
            "no start leads to a camera: the corners are probably paired with the wrong points",
        ),
        (lambda W, m: (W, m), {"lens": "k4"}, CvnotesError, "lens: expected one of 'none', 'k1'"),
        (lambda W, m: (W, m), {"lens": Lens()}, CvnotesError, "lens: expected one of"),
        (lambda W, m: (W, m), {"lens": ["k1"]}, CvnotesError, "lens: expected one of"),
    ],
)
def test_what_cannot_be_calibrated_is_refused_in_words(board, noisy, change, options, error, words):
    W, m = change(board.points, noisy)
    with pytest.raises(error, match=words):
        calibrate(W, m, SIZE, **options)


@pytest.mark.parametrize("size", [None, "1280x960", (1280,), (0, 960), (1280.5, 960), (960, -1)])
def test_the_size_is_width_and_height(board, noisy, size):
    with pytest.raises(CvnotesError, match=r"size: expected \(width, height\)"):
        calibrate(board.points, noisy, size)


@pytest.mark.parametrize("n", [5, 25])
@pytest.mark.parametrize("bad", [0, 3, 4, -1])
def test_a_view_that_shows_no_plane_is_named(board, views_of, n, bad):
    m = views_of(RADIAL, n, np.random.default_rng(9))[1]
    m[bad] = np.c_[np.arange(54), 2 * np.arange(54)]
    with pytest.raises(DegenerateError, match=f"^view {bad % n}: .*lie on one line"):
        calibrate(board.points, m, SIZE)


def spoilt(change):
    """Corners, board and size with something wrong about them."""

    def make(board, views_of, m):
        W, m, rng = board.points, m.copy(), np.random.default_rng(10)
        if change == "one outlier":
            m[4, 17] += [60, 40]
        elif change == "one bad view":
            m[4] = noise(m[4], rng, 15)
        elif change in ("noise of 30 px", "noise of 100 px"):
            m = noise(m, rng, float(change.split()[2]))
        elif change == "rows and columns swapped":
            W = np.stack(np.meshgrid(np.arange(6.0), np.arange(9.0)), -1).reshape(-1, 2) * 25
        elif change == "squares 2:1":
            W = W * [2, 1, 1]
        elif change == "(v, u)":
            return W, m[..., ::-1], SIZE[::-1]
        elif change == "mirrored":
            m = np.stack([SIZE[0] - 1 - m[..., 0], m[..., 1]], -1)
        elif change == "labels of one view mirrored":
            m[3] = m[3].reshape(6, 9, 2)[:, ::-1].reshape(54, 2)
        elif change == "two resolutions":
            m[::2] /= 2
        elif change == "portrait and landscape":
            m[::3] = np.stack([SIZE[1] - 1 - m[::3, :, 1], m[::3, :, 0]], -1)
        elif change in ("zoom of 1.3", "zoom of 1.1"):
            A = np.diag([float(change[-3:])] * 2 + [1]) @ TRUTH.A
            A[:2, 2] = TRUTH.A[:2, 2]
            zoomed = Camera(A, lens=RADIAL.lens, size=SIZE)
            m[8:] = noise(views_of(zoomed, 7, rng)[1], rng)
        return W, m, SIZE

    return make


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("one outlier", r"view 4, corner 17 \(6\d\.\d px\)"),
        ("one bad view", "views 4 do not fit the others"),
        ("noise of 30 px", "px away from where the model puts them"),
        ("noise of 100 px", "px away from where the model puts them"),
        ("rows and columns swapped", "px away from where the model puts them"),
        ("squares 2:1", "px away from where the model puts them"),
        ("(v, u)", r"every board is seen from behind: .*\(v, u\) given for \(u, v\)"),
        ("mirrored", "every board is seen from behind: are the pictures mirrored"),
        ("labels of one view mirrored", "boards seen from behind in views 3: mirrored labels"),
        ("two resolutions", "did zoom, focus or orientation change"),
        ("portrait and landscape", "did zoom, focus or orientation change"),
        ("zoom of 1.3", "did zoom, focus or orientation change"),
        ("zoom of 1.1", "did zoom, focus or orientation change"),
    ],
)
@pytest.mark.slow
def test_what_should_not_be_believed_says_so(board, views_of, noisy, change, words):
    W, m, size = spoilt(change)(board, views_of, noisy)
    result = quietly(W, m, size)
    assert not result.reliable
    assert any(re.search(words, sentence) for sentence in result.warnings), result.warnings
    assert np.isfinite(result.A).all()


@pytest.mark.parametrize("size", [(960, 1280), (640, 480)])
def test_corners_outside_of_the_picture_are_said(board, noisy, size):
    assert quietly(board.points, noisy, size).warnings[0].startswith("corners lie outside of the")


def test_warnings_point_to_whoever_called_calibrate(board):
    G = pose(rotation_from_vector([[0.6, 0, 0], [0, 0.6, 0]]), np.tile([-100, -62, 400], (2, 1)))
    m = noise(
        np.array([RADIAL.moved(g).project(board.points) for g in G]), np.random.default_rng(0)
    )
    with pytest.warns(CalibrationWarning, match="two views give as many constraints") as caught:
        result = calibrate(board.points, m, SIZE)
    assert len(result.warnings) == 1
    assert result.reliable
    assert caught[0].filename == __file__


@pytest.mark.parametrize(
    "camera",
    [
        Camera(intrinsics(1000, 1400, 650, 470), lens=RADIAL.lens, size=SIZE),  # oblong pixels
        Camera(intrinsics(1000, 1004, 1250, 100), lens=RADIAL.lens, size=SIZE),  # cut out
        Camera(intrinsics(20_000, 20_000, 650, 470), size=SIZE),  # telephoto
    ],
    ids=["oblong", "cropped", "telephoto"],
)
def test_unusual_cameras_are_believed(board, views_of, camera):
    m = noise(views_of(camera, 15, np.random.default_rng(11))[1], np.random.default_rng(12))
    result = quietly(board.points, m, SIZE)
    assert result.reliable
    assert abs(result.A[0, 0] - camera.A[0, 0]) < 4.5 * result.std["alpha_u"]


def test_exact_data_have_finite_error_bars_of_nothing(board, exact):
    result = calibrate(board.points, exact[1], SIZE, lens=FULL)
    assert np.isfinite(result.covariance).all()
    assert max(result.std.values()) < 1e-6
    assert np.isfinite(result.pose_covariance).all()


def test_a_few_views_that_say_nothing_do_not_hide_what_all_of_them_say(board, views_of):
    # the views among which the start is sought first all show the board in one pose
    poses, m = views_of(RADIAL, 31, np.random.default_rng(13))
    asked = np.linspace(0, 30, 10).astype(int)
    m[asked] = m[0]
    result = calibrate(board.points, m, SIZE)
    assert np.allclose(result.A, TRUTH.A, rtol=1e-8, atol=1e-6)
    assert np.allclose(result.poses[29], poses[29], atol=1e-6)


def test_memory_grows_with_the_number_of_views_and_no_faster(board, views_of):
    m = views_of(RADIAL, 100, np.random.default_rng(14))[1]
    peaks = []
    for times in (2, 4):
        many = noise(np.concatenate([m] * times), np.random.default_rng(15))
        tracemalloc.start()
        calibrate(board.points, many, SIZE)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 2.2 * peaks[0]


def test_a_rotation_by_hand_leads_to_the_pose_that_is_found(board):
    # one number a human can check: the board 500 in front, turned by 0.5 rad about x or y
    tilts = ([0.5, 0, 0], [0, 0.5, 0], [-0.3, 0.4, 0])
    G = pose(rotation_from_vector(np.array(tilts)), np.tile([-100, -62, 500], (3, 1)))
    m = [RADIAL.moved(g).project(board.points) for g in G]
    result = calibrate(board.points, m, SIZE)
    assert np.allclose(result.poses[0, :3, 1], [0, np.cos(0.5), np.sin(0.5)], atol=1e-9)
    assert np.allclose(result.poses[:, :3, 3], [-100, -62, 500], atol=1e-6)
