"""Boards that are not flat: their shape, estimated with the camera."""

import warnings

import numpy as np
import pytest

from cvnotes.base import CvnotesError, DegenerateError
from cvnotes.calibration import LENSES, Calibration, board_shape, calibrate, choose_model
from cvnotes.calibration.board_shape import deformations, with_shape
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.jackknife import Influence, eliminated_by_view
from cvnotes.calibration.jacobian import jacobian
from cvnotes.calibration.refinement import (
    Problem,
    State,
    covariance,
    minimise,
    pose_covariance,
    shape_variances,
    solve_by_schur,
)
from cvnotes.camera import Camera, Lens, intrinsics, rotation_from_vector
from cvnotes.pictures import course, good_views
from cvnotes.targets import Chessboard, find_corners

pytestmark = pytest.mark.filterwarnings("ignore::cvnotes.base.CalibrationWarning")

BOARD = Chessboard((9, 6), 25.0)
CAMERA = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.1)))
TRUTH = np.array([800, 804, 325, 238, -0.25, 0.1])
MIDDLE = np.append(BOARD.points.mean(0)[:2], 0)


def arched(by):
    """Give the board's corners on an arch, highest along the middle of its length."""
    W = BOARD.points.copy()
    along = (W[:, 0] - MIDDLE[0]) / MIDDLE[0]
    W[:, 2] = by * (1 - along**2)
    return W


def heights_of(W):
    """Give the heights of a board over the plane that they are counted from: no view tells it."""
    plane = np.stack([np.ones(54), *BOARD.points[:, :2].T], axis=1)
    return W[:, 2] - plane @ np.linalg.lstsq(plane, W[:, 2])[0]


def seen(W, n_views, noise=0.0, seed=0):
    rng = np.random.default_rng(seed)
    poses = good_views(BOARD, CAMERA, n_views, rng=rng)
    m = np.stack([CAMERA.moved(G).project(W) for G in poses])
    return m + rng.normal(0, noise, m.shape) if noise else m


@pytest.mark.parametrize("board", ["bent", "free"])
def test_exact_corners_of_a_flat_board_give_a_flat_board(board):
    found = calibrate(BOARD.points, seen(BOARD.points, 10), CAMERA.size, board=board)
    assert found.rms < 1e-9
    assert np.abs(found.shape.offsets).max() < 1e-8
    np.testing.assert_allclose([*found.parameters.values()], TRUTH, rtol=1e-8)


def test_a_board_that_changed_between_pictures_is_told_from_one_that_is_bent():
    rng = np.random.default_rng(3)
    poses = good_views(BOARD, CAMERA, 12, rng=rng)

    def doubts(bends, board):
        m = [CAMERA.moved(G).project(arched(by)) for G, by in zip(poses, bends, strict=True)]
        m = np.stack(m) + rng.normal(0, 0.05, (12, 54, 2))
        return " ".join(calibrate(BOARD.points, m, CAMERA.size, board=board).warnings)

    always, changing = [3.0] * 12, [3.0, -3.0] * 6
    for bends in (always, changing):
        assert "or did it change its shape between the pictures" in doubts(bends, "flat")
    for board in ("bent", "auto"):
        assert "did it bend differently from picture to picture" in doubts(changing, board)
        assert "where they should be" not in doubts(changing, board)
        assert "no noise" not in doubts(always, board)


def test_exact_corners_of_an_arched_board_give_its_heights():
    found = calibrate(BOARD.points, seen(arched(1.0), 10), CAMERA.size, board="bent")
    np.testing.assert_allclose([*found.parameters.values()], TRUTH, rtol=1e-8)
    np.testing.assert_allclose(found.shape.heights, heights_of(arched(1.0)), atol=1e-8)
    assert np.abs(found.shape.offsets[:, :2]).max() == 0


def test_exact_corners_of_a_crumpled_board_give_each_of_them():
    W = BOARD.points + np.random.default_rng(1).normal(0, 0.5, (54, 3))
    found = calibrate(BOARD.points, seen(W, 10), CAMERA.size, board="free")
    np.testing.assert_allclose([*found.parameters.values()], TRUTH, rtol=1e-7)
    # the same board but for a motion and a scale: all its distances are alike
    i, j = np.triu_indices(54, 1)
    ratio = np.linalg.norm(W[i] - W[j], axis=1) / np.linalg.norm(
        found.shape.points[i] - found.shape.points[j], axis=1
    )
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-7)


def test_an_optimum_is_that_of_opencv():
    cv2 = pytest.importorskip("cv2")
    m = seen(arched(1.0), 12, noise=0.1)
    data = Correspondences.of(BOARD.points, m)
    flat = Problem.of(data, CAMERA.size, "k1 k2 p1 p2", False)
    free = with_shape(flat, data, "free")  # which nothing holds back
    found = calibrate(BOARD.points, m, CAMERA.size, lens="k1 k2 p1 p2")
    start = flat.state(found.camera, data.pose_in_scaled_units(found.poses))
    best = minimise(free, State(np.append(start.shared, np.zeros(free.n_shape)), start.R, start.T))
    camera = free.camera_of(best.x.shared)
    rms, A, dist, *_ = cv2.calibrateCameraRO(
        [BOARD.points.astype(np.float32)] * 12,
        list(m.astype(np.float32)),
        CAMERA.size,
        8,  # the corner that holds the board together with the first and the last but one
        None,
        None,
        flags=cv2.CALIB_FIX_K3 | cv2.CALIB_USE_LU,
        criteria=(cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 300, 1e-14),
    )
    assert np.sqrt(best.cost / free.n_seen) == pytest.approx(rms, rel=1e-6)
    np.testing.assert_allclose(camera.A, A, rtol=2e-5)
    np.testing.assert_allclose([*camera.lens.k, *camera.lens.p], dist.ravel()[:4], atol=2e-4)


@pytest.mark.parametrize("lens", ["k1 k2 p1 p2 k3", "rational", "fisheye"])
@pytest.mark.parametrize("kind", ["bent", "free"])
def test_the_normal_equations_are_those_of_the_residuals(lens, kind):
    rng = np.random.default_rng(3)
    W = (BOARD.points - MIDDLE) / 120
    model = LENSES[lens]
    shape = deformations(kind, W)
    m = rng.uniform(0, 480, (3, 54, 2))
    problem = Problem(
        W, m, rng.random((3, 54)) < 0.8, True, model[1], (640, 480), model[0], shape=shape
    )
    q = len(problem.names)
    start = [810.0, 790, 2, 310, 250, *([0.01] * (q - 5))]
    x = State(
        np.array([*start, *rng.normal(0, 0.01, len(shape))]),
        rotation_from_vector(rng.normal(0, 0.3, (3, 3))),
        rng.normal(0, 0.1, (3, 3)) + [0, 0, 4],
    )
    J, r = jacobian(problem, x)
    way = rng.normal(0, 1, len(x.shared))

    def residuals(h):
        there = State(x.shared + h * way, x.R, x.T)
        return -problem.residuals(problem.camera_of(there.shared), there)

    np.testing.assert_allclose(residuals(0), r, atol=1e-9)
    numeric = (residuals(1e-6) - residuals(-1e-6)) / 2e-6
    np.testing.assert_allclose(J[..., :-6] @ way, numeric, rtol=1e-5, atol=1e-4)
    cost, equations = problem.linearise(x)
    J, r = J.reshape(3, 108, -1), r.reshape(3, 108)
    shared, pose = J[..., :-6], J[..., -6:]
    assert cost == pytest.approx((r**2).sum())
    np.testing.assert_allclose(equations.shared, (shared.mT @ shared).sum(0), rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(equations.border, pose.mT @ shared, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(
        equations.g_shared, (shared.mT @ r[..., None]).sum(0)[:, 0], rtol=1e-9, atol=1e-6
    )


def test_whether_corners_or_poses_are_eliminated_first_is_the_same():
    m = seen(arched(1.0), 5, noise=0.1)
    data = Correspondences.of(BOARD.points, m)
    flat = Problem.of(data, CAMERA.size, "k1 k2", False)
    found = calibrate(BOARD.points, m, CAMERA.size)
    start = flat.state(found.camera, data.pose_in_scaled_units(found.poses))
    hold = np.repeat([30.0, 200.0], [12, 143])  # of bends, and of corners
    free = with_shape(flat, data, "free", hold)
    assert free.corners_first
    s = np.random.default_rng(0).normal(0, 1e-3, 155)
    x = State(np.append(start.shared, s), start.R, start.T)
    (cost, poses), (same, corners) = (free.linearise(x, corners_first=c) for c in (False, True))
    assert cost == same
    for a, b in zip(solve_by_schur(poses, 0)[0], solve_by_schur(corners, 0)[0], strict=True):
        np.testing.assert_allclose(a, b, atol=1e-8 * np.abs(a).max())
    C = covariance(poses)
    np.testing.assert_allclose(covariance(corners), C[:6, :6], rtol=1e-6)
    of_poses = pose_covariance(poses, C)
    np.testing.assert_allclose(pose_covariance(corners, C), of_poses, atol=1e-6 * of_poses.max())
    (a, of_corners), (b, again) = (shape_variances(free, each) for each in (poses, corners))
    np.testing.assert_allclose(a[:12], b[:12], rtol=1e-6)
    np.testing.assert_allclose(a[12:].sum(), b[12:].sum(), rtol=1e-6)
    np.testing.assert_allclose(of_corners, again, rtol=1e-6)
    end = minimise(free, x).x
    influence = Influence.of(free, end)
    by_views = Influence.between(*eliminated_by_view(free, end), free.held)
    std = np.sqrt(np.diag(by_views.covariance)[:6])
    assert (np.abs(influence.without - by_views.without[:, :6]) < 1e-3 * std).all()
    np.testing.assert_allclose(influence.more, by_views.more, rtol=1e-3)
    C = np.linalg.inv(by_views.known + np.diag(free.held))[:6, :6]
    np.testing.assert_allclose(np.linalg.inv(influence.known), C, atol=1e-6 * std.max() ** 2)


def test_ways_to_differ_neither_move_nor_scale_the_board():
    W = (BOARD.points - MIDDLE) / 120
    for kind in ("bent", "free"):
        shape = deformations(kind, W).reshape(-1, 162)
        np.testing.assert_allclose(shape @ shape.T, np.eye(len(shape)), atol=1e-12)
        motions = [np.tile(e, (54, 1)) for e in np.eye(3)] + [np.cross(e, W) for e in np.eye(3)]
        assert np.abs(shape @ np.reshape([*motions, W], (7, -1)).T).max() < 1e-12
    assert len(deformations("bent", W)) == 12
    assert len(deformations("free", W)) == 3 * 54 - 7


PER_PIXEL = 4  # rays along each side of a pixel


def photograph(G, xy, by):
    """Photograph an arched board with rays xy (h, k, w, k, 2), and a blur of 0.7 px."""
    import cv2

    R, T = G[:3, :3], G[:3, 3]
    # all around the board is as bright as its paper
    around = CAMERA.moved(G).project(MIDDLE + 1.5 * (arched(by) - MIDDLE))
    low, high = np.nanmin(around, axis=0).clip(0), np.nanmax(around, axis=0)
    (left, top), (right, bottom) = (x.astype(int) for x in (low, high + 1))
    grey = np.full((xy.shape[0], xy.shape[2]), 215.0)
    centre = -R.T @ T
    for row in range(top, bottom):  # one after the other they stay in the cache
        ray_x, ray_y = np.moveaxis(xy[row, :, left:right], -1, 0)
        x, y, z = (R[0, i] * ray_x + R[1, i] * ray_y + R[2, i] for i in range(3))
        x, y, height = x / z, y / z, 0.0
        for _ in range(4):  # the height where the ray meets the board changes where it meets it
            along = centre[0] + (height - centre[2]) * x
            height = by * (1 - (along / MIDDLE[0] - 1) ** 2)
        j, i = np.floor(along / 25) + 1, np.floor((centre[1] + (height - centre[2]) * y) / 25) + 1
        dark = (j >= 0) & (j <= 9) & (i >= 0) & (i <= 6) & ((i + j) % 2 == 0)
        grey[row, left:right] = np.where(dark, 40.0, 215.0).mean(axis=(0, 2))
    return cv2.GaussianBlur(grey, (0, 0), 0.7)


@pytest.mark.slow
def test_photographs_of_a_board_that_is_bent_by_a_millimetre():
    w, h = CAMERA.size
    part = (np.arange(PER_PIXEL) - (PER_PIXEL - 1) / 2) / PER_PIXEL
    u, v = ((np.arange(n)[:, None] + part).ravel() for n in (w, h))
    rng = np.random.default_rng(4)
    m = np.stack(np.meshgrid(u, v), axis=-1)
    m += rng.uniform(-0.5, 0.5, m.shape) / PER_PIXEL  # or edges along columns would jump
    xy = CAMERA.ideal(m).reshape(h, PER_PIXEL, w, PER_PIXEL, 2)
    found = []
    for G in good_views(BOARD, CAMERA, 12, rng=rng):
        grey = photograph(G, xy, 1.0) + rng.normal(0, 2, (h, w))
        found.append(find_corners(grey.clip(0, 255).round().astype(np.uint8), BOARD))
        exact = CAMERA.moved(G).project(arched(1.0))
        assert np.abs(found[-1] - exact).max() < 0.1
    result = calibrate(BOARD.points, found, CAMERA.size, board="auto")
    off = np.array([*result.parameters.values()]) - TRUTH
    assert np.abs(off / [*result.std_of_views.values()]).max() < 3
    assert np.abs(result.shape.heights - heights_of(arched(1.0))).max() < 0.1
    assert result.rms < 0.5 * calibrate(BOARD.points, found, CAMERA.size).rms


def test_two_cameras_find_the_same_board():
    real = course.real_corners()
    W, heights = real.board.points, []
    for m, flat_rms, free_rms in ((real.left, 0.168, 0.096), (real.right, 0.168, 0.081)):
        found = calibrate(W, m, real.size, lens="k1 k2 p1 p2", board="auto")
        assert found.choice.by_board["flat"] == pytest.approx(flat_rms, abs=0.002)
        assert found.choice.by_board["free"] == pytest.approx(free_rms, abs=0.002)
        assert found.shape.kind == "free"
        assert found.rms < 0.085
        (note,) = found.notes_on_deviations
        assert "from the scatter between views" in note
        heights.append(found.shape.heights)
    assert np.corrcoef(heights)[0, 1] > 0.95
    # and how far they differ is what each says of itself
    assert np.std(heights[0] - heights[1]) < 0.05 < 0.1 < np.std(heights[0])


@pytest.mark.slow
def test_error_bars_hold_for_heights():
    """Of an arched board, seen with noise: heights over their deviations scatter by about 1."""
    z = []
    for seed in range(12):
        m = seen(arched(1.0), 12, noise=0.1, seed=seed)
        found = calibrate(BOARD.points, m, CAMERA.size, board="bent")
        z.append((found.shape.heights - heights_of(arched(1.0))) / found.shape.std[:, 2])
    assert 0.7 < np.sqrt(np.mean(np.square(z))) < 1.4


def test_an_arch_is_not_held_back_because_there_are_no_wiggles():
    """0.15 mm with noise of 0.3 px: of one size for all degrees the arch would keep a third."""
    W = arched(0.15)
    z = heights_of(W)
    kept = []
    for seed in range(6):
        m = seen(W, 12, noise=0.3, seed=seed)
        found = calibrate(BOARD.points, m, CAMERA.size, board="bent").shape.heights
        kept.append(found @ z / (z @ z))
    assert 0.55 < np.mean(kept) < 1


@pytest.mark.parametrize("seed", range(3))
def test_the_camera_is_within_its_error_bars_where_a_flat_board_misleads(seed):
    m = seen(arched(1.0), 14, noise=0.05, seed=seed)
    for board in ("bent", "free"):
        found = calibrate(BOARD.points, m, CAMERA.size, board=board)
        off = np.array([*found.parameters.values()]) - TRUTH
        assert np.abs(off / [*found.std_of_views.values()]).max() < 3.5
    flat = calibrate(BOARD.points, m, CAMERA.size)
    assert np.abs((np.array([*flat.parameters.values()]) - TRUTH) / [*flat.std.values()]).max() > 5


def test_what_a_board_is_need_not_be_known():
    """One that is free is as good as the one that is true: the views say how far it may go."""
    crumpled = BOARD.points + np.random.default_rng(1).normal(0, 0.3, (54, 3))
    for W, true in ((BOARD.points, "flat"), (arched(1.0), "bent"), (crumpled, "free")):
        off = {true: [], "auto": []}
        for seed in range(6):
            m = seen(W, 8, noise=0.1, seed=seed)
            for board, errors in off.items():
                found = calibrate(BOARD.points, m, CAMERA.size, board=board)
                errors.append(found.A[[0, 1, 0, 1], [0, 1, 2, 2]] - TRUTH[:4])
            assert found.choice.board == found.shape.kind == "free"
        rms = {board: np.sqrt(np.mean(np.square(errors))) for board, errors in off.items()}
        assert rms["auto"] < 1.1 * rms[true]
    exact = calibrate(BOARD.points, seen(BOARD.points, 6), CAMERA.size, board="auto")
    assert exact.shape is None


@pytest.mark.parametrize(("n_views", "seed"), [(4, 1), (4, 3), (5, 0), (7, 0)])
def test_few_views_of_a_flat_board_are_held_near_it(n_views, seed):
    """Corners that noise alone moved by a millimetre, of four views, stay near their places."""
    m = seen(BOARD.points, n_views, noise=0.1, seed=seed)
    found = calibrate(BOARD.points, m, CAMERA.size, board="free")
    assert np.abs(found.shape.offsets).max() < 0.3
    assert abs(found.A[0, 0] - 800) < 5
    flat = calibrate(BOARD.points, m, CAMERA.size)
    assert found.rms < flat.rms
    assert found.view_rms @ found.view_rms / n_views == pytest.approx(found.rms**2)
    chosen = calibrate(BOARD.points, m, CAMERA.size, board="auto")
    assert abs(chosen.A[0, 0] - 800) < 5


def test_the_bent_board_of_photographs_lies_between_the_flat_one_and_the_free_one():
    real = course.real_corners()
    given = real.board.points, real.left, real.size
    bent = choose_model(*given, lenses=["k1 k2 p1 p2"], boards=["bent"])
    choice = choose_model(*given, lenses=["k1 k2 p1 p2"])
    assert list(choice.by_board) == ["flat", "free"]
    assert 1.05 * choice.by_board["free"] < bent.rms < choice.by_board["flat"]
    assert choice.board == "free"


def test_what_is_not_determined_is_refused_in_words():
    m = seen(BOARD.points, 5)
    with pytest.raises(DegenerateError, match=r"takes at least 4 views, got 3.*board=\"flat\""):
        calibrate(BOARD.points, m[:3], CAMERA.size, board="bent")
    with pytest.raises(CvnotesError, match="board: expected one of 'flat', 'bent', 'free', 'auto'"):
        calibrate(BOARD.points, m, CAMERA.size, board="round")
    twice = [np.r_[BOARD.points, BOARD.points[:1]]] * 5
    with pytest.raises(CvnotesError, match="view 0: a corner of the board is given twice"):
        calibrate([*twice[:4], BOARD.points], [*(np.r_[v, v[:1]] for v in m[:4]), m[4]],
                  CAMERA.size, board="free")  # fmt: skip


@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_a_corner_in_one_view_only_is_where_a_bend_would_have_it(noise):
    m = seen(arched(1.0), 8, noise)
    W, parts = [BOARD.points[1:]] * 7 + [BOARD.points], [*(view[1:] for view in m[:7]), m[7]]
    found = calibrate(W, parts, CAMERA.size, board="free")
    assert found.shape.std[0, 2] == pytest.approx(found.shape.std[:, 2].max())
    assert abs(found.shape.heights[0] - heights_of(arched(1.0))[0]) < (0.3 if noise else 0.02)
    assert abs(found.A[0, 0] - 800) < (3 * found.std_of_views["alpha_u"] if noise else 0.01) < 5


def test_views_with_some_corners_find_the_same_board_in_any_order():
    rng = np.random.default_rng(5)
    m = seen(arched(1.0), 12, noise=0.05)
    whole = calibrate(BOARD.points, m, CAMERA.size, board="free")
    order = rng.permutation(54)
    W = [BOARD.points, *[BOARD.points[order]] * 11]
    shuffled = calibrate(W, [m[0], *m[1:, order]], CAMERA.size, board="free")
    np.testing.assert_allclose(shuffled.shape.points, whole.shape.points, atol=1e-6)
    np.testing.assert_allclose(shuffled.residuals[1], whole.residuals[1][order], atol=1e-6)
    for a, b in zip(shuffled.std_of_views.values(), whole.std_of_views.values(), strict=True):
        assert a == pytest.approx(b, rel=1e-5)
    kept = [np.sort(rng.permutation(54)[:45]) for _ in m]
    part = calibrate(
        [BOARD.points[k] for k in kept], [v[k] for v, k in zip(m, kept, strict=True)],
        CAMERA.size, board="free",
    )  # fmt: skip
    assert [len(r) for r in part.residuals] == [45] * 12
    rms = np.sqrt(np.mean([(r**2).sum(1).mean() for r in part.residuals]))
    assert part.rms == pytest.approx(rms, rel=1e-6)
    apart = part.shape.points - whole.shape.points
    assert np.abs(apart).max() < 5 * part.shape.std.max()


def test_a_jackknife_is_what_leaving_each_view_out_gives():
    m = seen(arched(1.0), 12, noise=0.05)
    for board in ("bent", "free"):
        found = calibrate(BOARD.points, m, CAMERA.size, board=board)
        each = np.array(
            [
                [*calibrate(BOARD.points, np.delete(m, i, 0), CAMERA.size, board=board)
                 .parameters.values()]
                for i in range(12)
            ]
        )  # fmt: skip
        std = np.sqrt(11 / 12 * ((each - each.mean(0)) ** 2).sum(0))
        np.testing.assert_allclose([*found.std_of_views.values()], std, rtol=0.1)


def test_a_shape_is_kept_in_files(tmp_path):
    found = calibrate(BOARD.points, seen(arched(1.0), 10, 0.1), CAMERA.size, board="free")
    found.save(tmp_path / "bent.json")
    again = Calibration.load(tmp_path / "bent.json")
    assert again.shape.kind == "free"
    for name in ("given", "points", "std"):
        np.testing.assert_array_equal(getattr(again.shape, name), getattr(found.shape, name))
    assert again.std_of_views == pytest.approx(found.std_of_views)
    np.testing.assert_allclose(np.stack(again.residuals), np.stack(found.residuals), atol=1e-9)
    assert repr(found.shape) in repr(again)
    assert "free board" in again._repr_html_()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        flat = calibrate(BOARD.points, seen(BOARD.points, 10, 0.1), CAMERA.size)
    flat.save(tmp_path / "flat.json")
    assert Calibration.load(tmp_path / "flat.json").shape is None
    text = (tmp_path / "bent.json").read_text()
    (tmp_path / "bent.json").write_text(text.replace('"free"', '"round"'))
    with pytest.raises(CvnotesError, match=r"kind.*expected one of bent, free, got 'round'"):
        Calibration.load(tmp_path / "bent.json")


def test_what_holds_the_chosen_board_back_is_not_sought_again(monkeypatch):
    real, asked = course.real_corners(), []
    whole = board_shape.shaped

    def counted(*given, **how):
        asked.append([])
        monkeypatch.setattr(
            board_shape,
            "shape_variances",
            lambda *each: asked[-1].append(1) or shape_variances(*each),
        )
        return whole(*given, **how)

    monkeypatch.setattr("cvnotes.calibration.choice.shaped", counted)
    monkeypatch.setattr("cvnotes.calibration.driver.shaped", counted)
    calibrate(real.board.points, real.left, real.size, lens="auto", board="free")
    *lenses, chosen = map(len, asked)
    assert len(lenses) >= 3
    assert chosen - 1 == 1 < min(lenses)  # and once more for the deviations of its corners


def test_a_board_with_nothing_to_be_seen_but_noise_is_known_flat_in_a_few_rounds(monkeypatch):
    board, rounds = course.board(), []
    monkeypatch.setattr(
        board_shape, "shape_variances", lambda *each: rounds.append(1) or shape_variances(*each)
    )
    m = course.measured_corners()
    found = calibrate(board.points, m, (640, 480), board="free")
    assert np.abs(found.shape.offsets).max() < 0.02  # mm
    assert len(rounds) - 1 <= 3  # MacKay's rule alone takes all eight; one is for the deviations


@pytest.mark.slow
def test_a_quotient_takes_a_free_board_too():
    real = course.real_corners()
    found = calibrate(real.board.points, real.left, real.size, lens="rational", board="auto")
    assert found.choice.board == "free"
    assert found.converged  # a valley has no bottom
    assert found.rms < 0.09  # 0.16 on a flat one
    assert found.A[0, 0] == pytest.approx(533.9, abs=0.5)  # as with k1 k2 p1 p2
