from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from cvnotes.base import ConvergenceError, DegenerateError
from cvnotes.calibration import LENSES as ALL_LENSES
from cvnotes.calibration.jacobian import jacobian
from cvnotes.calibration.refinement import (
    Problem,
    State,
    covariance,
    minimise,
    pose_covariance,
    solve_by_schur,
    take_step,
)
from cvnotes.camera import Camera, Lens, intrinsics, pose

# Those of the package; tests may have made others.
LENSES = {name: x for name, x in ALL_LENSES.items() if x[0].__module__.startswith("cvnotes.")}
MODELS = list(product([False, True], [0, 1, 2, 3], [False, True]))  # skew, radial, tangential


def of_lens(n_radial=2, tangential=True):
    """The names of a polynomial's coefficients."""
    return (*(f"k{i + 1}" for i in range(n_radial)), *["p1", "p2"] * tangential)


def model(problem, shared, omega, R, T):
    """The image formation flow, written for complex numbers too: pixels of one view.

    The pose is turned by exp(ω) to first order, which is exact for the infinitesimal ω of a
    complex step.
    """
    value = dict(zip(problem.names, shared, strict=True))
    x, y, z = omega
    turn = np.eye(3) + np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    X, Y, Z = turn @ R @ problem.W.T + T[:, None]
    X, Y = X / Z, Y / Z
    r2 = X * X + Y * Y
    L = 1 + sum(value.get(f"k{i}", 0) * r2**i for i in (1, 2, 3))
    p1, p2 = value.get("p1", 0), value.get("p2", 0)
    X, Y = (
        L * X + 2 * p1 * X * Y + p2 * (r2 + 2 * X * X),
        L * Y + 2 * p2 * X * Y + p1 * (r2 + 2 * Y * Y),
    )
    u = value["alpha_u"] * X + value.get("skew", 0) * Y + value["u0"]
    return np.stack([u, value["alpha_v"] * Y + value["v0"]], -1)


def some_state(problem, rng):
    value = {"alpha_u": 800, "alpha_v": 810, "skew": 3, "u0": 325, "v0": 238, "k1": -0.2}
    value |= {"k2": 0.1, "k3": -0.03, "p1": 0.002, "p2": -0.001, "k4": 0.01, "k5": 0.02, "k6": 0.03}
    n = len(problem.m)
    R = Rotation.from_rotvec(rng.normal(size=(n, 3)) * 0.4).as_matrix()
    return State(
        np.array([value[name] for name in problem.names], float),
        R,
        rng.normal(size=(n, 3)) * [0.3, 0.3, 0.5] + [0, 0, 4],
    )


def flat(n, rng):
    return np.c_[rng.uniform(-1, 1, (n, 2)), np.zeros(n)]


def some_problem(rng, skew=False, n_radial=2, tangential=True, n_views=3, n=12, **more):
    m = rng.uniform(0, 640, (n_views, n, 2))
    return Problem(flat(n, rng), m, None, skew, of_lens(n_radial, tangential), **more)


@pytest.mark.parametrize(("skew", "n_radial", "tangential"), MODELS)
def test_the_jacobian_is_the_derivative_by_the_complex_step(skew, n_radial, tangential):
    rng = np.random.default_rng(0)
    problem = some_problem(rng, skew, n_radial, tangential)
    x = some_state(problem, rng)
    J, r = jacobian(problem, x)  # the answer key: the fast one is held against it below
    q, h = len(x.shared), 1e-40
    assert J.shape == (3, 12, 2, q + 6)
    for i in range(3):
        at_x = model(problem, x.shared, np.zeros(3), x.R[i], x.T[i])
        assert np.allclose(r[i], at_x - problem.m[i], atol=1e-9)
        for c in range(q + 6):
            step = np.zeros(q + 6, complex)
            step[c] = 1j * h
            stepped = model(
                problem, x.shared + step[:q], step[q : q + 3], x.R[i], x.T[i] + step[q + 3 :]
            )
            column = stepped.imag / h
            assert np.abs(J[i, :, :, c] - column).max() <= 1e-12 * np.abs(column).max()


@pytest.mark.parametrize("lens", LENSES)
def test_the_jacobian_of_every_lens_is_that_of_differences(lens):
    rng = np.random.default_rng(8)
    model, coefficients = LENSES[lens]
    m = rng.uniform(0, 640, (2, 12, 2))
    problem = Problem(flat(12, rng), m, None, True, coefficients, model=model)
    x = some_state(problem, rng)
    J, r = jacobian(problem, x)
    q = len(x.shared)

    def residuals(step):
        turn = Rotation.from_rotvec(step[q : q + 3]).as_matrix()
        there = State(x.shared + step[:q], turn @ x.R, x.T + step[q + 3 :])
        return -problem.residuals(problem.camera_of(there.shared), there)

    assert np.allclose(residuals(np.zeros(q + 6)), r, atol=1e-9)
    for c, step in enumerate(1e-5 * np.eye(q + 6)):
        column = (residuals(step) - residuals(-step)) / 2e-5
        assert np.abs(J[..., c] - column).max() <= 1e-6 * max(1, np.abs(column).max())


def test_the_model_that_the_jacobian_is_held_against_is_the_camera():
    rng = np.random.default_rng(1)
    problem = some_problem(rng, True, 3, True)
    x = some_state(problem, rng)
    found = problem.camera_of(x.shared)
    assert np.allclose(found.A, intrinsics(800, 810, 325, 238, skew=3), atol=0)
    assert found.lens == Lens(k=(-0.2, 0.1, -0.03), p=(0.002, -0.001))
    residuals = problem.residuals(found, x)
    for i in range(3):
        written_out = model(problem, x.shared, np.zeros(3), x.R[i], x.T[i])
        camera = found.moved(pose(x.R[i], x.T[i]))
        assert np.allclose(camera.project(problem.W), written_out, atol=1e-9)
        assert np.allclose(residuals[i], problem.m[i] - written_out, atol=1e-9)


def test_state_and_camera_are_two_ways_to_say_the_same():
    rng = np.random.default_rng(2)
    problem = some_problem(rng, True, 3, True)
    assert problem.names == (
        *("alpha_u", "alpha_v", "skew", "u0", "v0"),
        *("k1", "k2", "k3", "p1", "p2"),
    )
    x = some_state(problem, rng)
    again = problem.state(problem.camera_of(x.shared), pose(x.R, x.T))
    assert np.allclose(again.shared, x.shared, atol=0)
    assert np.allclose(again.R, x.R, atol=0)
    assert np.allclose(again.T, x.T, atol=0)


def dense(problem, x):
    """J and r of all views as one matrix and one vector: shared, then ω and T view by view."""
    J, r = jacobian(problem, x)
    n_views, n, _, columns = J.shape
    q = columns - 6
    whole = np.zeros((n_views, 2 * n, q + 6 * n_views))
    whole[:, :, :q] = J[..., :q].reshape(n_views, 2 * n, q)
    for i in range(n_views):
        whole[i, :, q + 6 * i : q + 6 * i + 6] = J[i, ..., q:].reshape(2 * n, 6)
    return whole.reshape(-1, q + 6 * n_views), r.ravel()


def with_holes(problem, rng):
    """The same problem with a third of the points not seen, and garbage in their place."""
    seen = rng.uniform(size=problem.m.shape[:2]) > 0.3
    m = np.where(seen[..., None], problem.m, 1e5)
    return replace(problem, m=m, seen=seen)


def by_view(problem, rng):
    """The same problem with other board points in every view."""
    W = np.stack([flat(problem.m.shape[1], rng) for _ in problem.m])
    return replace(problem, W=W)


def as_it_is(problem, rng):  # noqa: ARG001
    return problem


# one chunk of views, and more than one; the shape of the board: tests/test_board_shape.py
@pytest.mark.parametrize("variant", [as_it_is, with_holes, by_view])
@pytest.mark.parametrize(
    ("lens", "skew", "n_views"),
    [("k1 k2 p1 p2", False, 140), *((lens, skew, 3) for lens in LENSES for skew in (False, True))],
)
def test_the_normal_equations_are_those_of_the_whole_jacobian(variant, lens, skew, n_views):
    rng = np.random.default_rng(3)
    model, coefficients = LENSES[lens]
    m = rng.uniform(0, 640, (n_views, 12, 2))
    problem = variant(Problem(flat(12, rng), m, None, skew, coefficients, model=model), rng)
    x = some_state(problem, rng)
    J, r = dense(problem, x)
    cost, equations = problem.linearise(x)
    q = len(x.shared)
    N, g = J.T @ J, J.T @ r
    scale = np.abs(N).max()
    assert cost == pytest.approx(r @ r, rel=1e-12)
    assert equations.view_costs.sum() == pytest.approx(cost, rel=1e-12)
    assert np.allclose(equations.shared, N[:q, :q], atol=1e-12 * scale)
    assert np.allclose(equations.g_shared, g[:q], atol=1e-12 * np.abs(g).max())
    for i in range(n_views):
        own = slice(q + 6 * i, q + 6 * i + 6)
        assert np.allclose(equations.poses[i], N[own, own], atol=1e-12 * scale)
        assert np.allclose(equations.border[i], N[own, :q], atol=1e-12 * scale)
        assert np.allclose(equations.g_poses[i], g[own], atol=1e-12 * np.abs(g).max())


def test_points_that_were_not_seen_count_for_nothing():
    rng = np.random.default_rng(4)
    problem = with_holes(some_problem(rng), rng)
    x = some_state(problem, rng)
    J, r = jacobian(problem, x)
    assert (J[~problem.seen] == 0).all()
    assert (r[~problem.seen] == 0).all()
    assert problem.n_seen == problem.seen.sum()
    assert problem.n_seen_by_view.tolist() == problem.seen.sum(1).tolist()
    kept = problem.some(np.array([2, 0]))
    assert (kept.seen == problem.seen[[2, 0]]).all()
    assert (kept.m == problem.m[[2, 0]]).all()


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_eliminating_the_poses_gives_the_step_of_the_whole_system(damping):
    rng = np.random.default_rng(5)
    problem = some_problem(rng, n_views=5)
    x = some_state(problem, rng)
    J, r = dense(problem, x)
    N, g = J.T @ J, J.T @ r
    step = -np.linalg.solve(N + damping * np.diag(np.diag(N)), g)
    (shared, poses), gain = solve_by_schur(problem.linearise(x)[1], damping)
    q = len(x.shared)
    assert np.allclose(shared, step[:q], rtol=1e-8, atol=0)
    assert np.allclose(poses.ravel(), step[q:], rtol=1e-7, atol=1e-9)
    assert gain == pytest.approx(-g @ step, rel=1e-9)


def test_the_covariance_is_the_inverse_of_the_whole_normal_matrix():
    rng = np.random.default_rng(6)
    problem = some_problem(rng, n_views=4)
    x = some_state(problem, rng)
    J, _ = dense(problem, x)
    scale = np.linalg.norm(J, axis=0)
    whole = np.linalg.inv((J / scale).T @ (J / scale)) / np.outer(scale, scale)
    equations = problem.linearise(x)[1]
    q = len(x.shared)
    shared = covariance(equations)
    assert np.allclose(shared, shared.T, atol=0)
    deviation = np.sqrt(np.diag(whole))
    assert np.abs((shared - whole[:q, :q]) / np.outer(deviation[:q], deviation[:q])).max() < 1e-7
    for i, block in enumerate(pose_covariance(equations, shared)):
        own = slice(q + 6 * i, q + 6 * i + 6)
        unit = np.outer(deviation[own], deviation[own])
        assert np.abs((block - whole[own, own]) / unit).max() < 1e-7


def test_a_rotation_moves_by_exp_omega_from_the_left():
    rng = np.random.default_rng(7)
    x = some_state(some_problem(rng), rng)
    d_shared, d_poses = rng.normal(size=len(x.shared)), rng.normal(size=(3, 6))
    moved = take_step(x, (d_shared, d_poses))
    turn = Rotation.from_rotvec(d_poses[:, :3]).as_matrix()
    assert np.allclose(moved.R, turn @ x.R, atol=1e-12)
    assert np.allclose(moved.T, x.T + d_poses[:, 3:], atol=0)
    assert np.allclose(moved.shared, x.shared + d_shared, atol=0)


TRUTH = Camera(intrinsics(800, 804, 325, 238), lens=Lens(k=(-0.25, 0.1), p=(0.002, -0.001)))


def scaled(board, m, **model):
    W = (board.points - board.points.mean(0)) / 100
    return Problem(W, m, **model)


def in_scaled_board(board, G):
    G = G.copy()
    G[:, :3, 3] = (G[:, :3, 3] + G[:, :3, :3] @ board.points.mean(0)) / 100
    return G


def test_scipy_finds_the_same_minimum_of_residuals_made_by_the_camera(board, views_of):
    rng = np.random.default_rng(8)
    G, m = views_of(TRUTH, 4, rng)
    m = m + rng.normal(size=m.shape) * 0.3
    m[1, 50:] = np.nan  # not seen
    seen = np.isfinite(m[..., 0])
    problem = scaled(board, np.nan_to_num(m), seen=seen, coefficients=of_lens())
    G = in_scaled_board(board, G)
    found = minimise(problem, problem.state(TRUTH, G))
    assert found.converged

    def residuals(p):
        A, lens = intrinsics(*p[:4]), Lens(k=p[4:6], p=p[6:8])
        turns = Rotation.from_rotvec(p[8:].reshape(4, 6)[:, :3]).as_matrix()
        each = zip(turns, p[8:].reshape(4, 6)[:, 3:], m, seen, strict=True)
        return np.concatenate(
            [
                (Camera(A, pose(R, T), lens).project(problem.W) - seen_m)[s]
                for R, T, seen_m, s in each
            ]
        ).ravel()

    vectors = Rotation.from_matrix(G[:, :3, :3]).as_rotvec()
    start = np.r_[800, 804, 325, 238, -0.25, 0.1, 0, 0, np.c_[vectors, G[:, :3, 3]].ravel()]
    best = least_squares(
        residuals, start, x_scale="jac", jac="3-point", xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    assert found.cost == pytest.approx(2 * best.cost, rel=1e-9)
    std = np.sqrt(np.diag(covariance(found.system)))
    assert np.abs((found.x.shared - best.x[:8]) / std).max() < 1e-4


def test_exact_corners_bring_back_every_parameter(board, views_of):
    G, m = views_of(TRUTH, 5, np.random.default_rng(9))
    problem = scaled(board, m, skew=True, coefficients=of_lens(3))
    G = in_scaled_board(board, G)
    start = problem.state(Camera(intrinsics(760, 770, 320, 240)), G)
    found = minimise(problem, start)
    expected = [800, 804, 0, 325, 238, -0.25, 0.1, 0, 0.002, -0.001]
    assert np.allclose(found.x.shared, expected, rtol=1e-9, atol=1e-8)
    assert np.allclose(found.x.R, G[:, :3, :3], atol=1e-11)
    assert np.allclose(found.x.T, G[:, :3, 3], rtol=1e-10, atol=1e-11)


@pytest.mark.parametrize("seed", [5, 6, 7])
def test_a_curved_valley_is_left_because_the_poses_follow(board, views_of, seed):
    # A strong lens, and a start that is 1.4 times too far away and too long: without poses that
    # follow, 100 iterations creep along the valley and do not reach its end.
    camera = Camera(intrinsics(540, 545, 660, 470), lens=Lens(k=(-0.42, 0.11)), size=(1280, 960))
    G, m = views_of(camera, 4, np.random.default_rng(seed), tilt=30)
    problem = scaled(board, m)
    G = in_scaled_board(board, G)
    G[:, 2, 3] *= 1.4
    lens = Lens(k=(-0.42 * 1.4**2, 0.11 * 1.4**4))
    found = minimise(
        problem, problem.state(Camera(intrinsics(756, 763, 639.5, 479.5), lens=lens), G)
    )
    assert found.converged
    assert found.iterations < 60
    assert np.allclose(problem.camera_of(found.x.shared).A, camera.A, atol=1e-6)


def test_parameters_that_the_views_say_nothing_about_are_refused(views_of):
    _, m = views_of(TRUTH, 3, np.random.default_rng(11), tilt=0, roll=0)
    pose_of_none = np.tile(pose(np.eye(3), [0, 0, 4.0]), (3, 1, 1))
    one_row = Problem(np.c_[np.linspace(-1, 1, 9), np.zeros((9, 2))], m[:, :9])
    with pytest.raises(DegenerateError, match=r"these views do not determine every parameter"):
        minimise(one_row, one_row.state(TRUTH, pose_of_none))


# The same pixels of flat boards come from cameras that do not exist: (α, side of the board).
IMPOSSIBLE = {
    "boards behind the camera": (1, np.diag([-1.0, -1, -1]), np.diag([1.0, 1, -1])),
    "negative focal lengths": (-1, np.diag([-1.0, -1, 1]), np.eye(3)),
}


@pytest.mark.parametrize("name", IMPOSSIBLE)
def test_a_minimum_that_is_no_camera_is_refused(board, views_of, name):
    sign, of_cam, of_board = IMPOSSIBLE[name]
    G, m = views_of(TRUTH, 3, np.random.default_rng(12))
    problem = scaled(board, m, coefficients=of_lens())
    G = in_scaled_board(board, G)
    shared = np.array([sign * 800, sign * 804, 325, 238, -0.25, 0.1, 0.002 * sign, -0.001 * sign])
    x = State(shared, of_cam @ G[:, :3, :3] @ of_board, G[:, :3, 3] @ of_cam)
    assert np.allclose(np.linalg.det(x.R), 1, atol=1e-12)
    assert problem.linearise(x)[0] < 1e-15
    with pytest.raises(ConvergenceError, match="left the space of cameras"):
        minimise(problem, x)
