"""Is the estimator right? 200 simulated calibrations against their Cramér–Rao bound.

The bound comes from a Jacobian of its own: central differences of `Camera.project` at the truth,
all parameters in one dense matrix. A calibration is right when its errors are as small as the
bound allows, unbiased, and as large as it says itself.
"""

import numpy as np
import pytest

from cvnotes.base import levenberg_marquardt
from cvnotes.calibration import calibrate
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import Problem, solve_by_schur, take_step
from cvnotes.camera import Camera, Lens, intrinsics, pose, rotation_from_vector

pytestmark = pytest.mark.sampling

SIGMA, N_VIEWS, N_SETS = 0.3, 15, 200
NAMES = ("alpha_u", "alpha_v", "u0", "v0", "k1", "k2", "k3", "p1", "p2")
TRUTH = np.array([1000, 1004, 650, 470, -0.2, 0.08, -0.02, 0.001, -0.0005])
SIZE = (1280, 960)


def camera_of(shared, G):
    return Camera(intrinsics(*shared[:4]), G, Lens(k=shared[4:7], p=shared[7:]), SIZE)


@pytest.fixture(scope="module")
def views(views_of):
    return views_of(camera_of(TRUTH, np.eye(4)), N_VIEWS, np.random.default_rng(2026))


@pytest.fixture(scope="module")
def bound(board, views):
    """Covariance of the shared parameters that no unbiased estimator can fall below, (9, 9)."""
    poses, _ = views
    columns = len(TRUTH) + 6 * N_VIEWS
    J = np.zeros((N_VIEWS, 2 * len(board.points), columns))
    for i, G in enumerate(poses):

        def project(p, G=G):
            moved = pose(rotation_from_vector(p[9:12]) @ G[:3, :3], G[:3, 3] + p[12:])
            return camera_of(p[:9], moved).project(board.points).ravel()

        at, own = np.r_[TRUTH, np.zeros(6)], slice(9 + 6 * i, 15 + 6 * i)
        steps = np.r_[0.1, 0.1, 0.1, 0.1, 1e-4, 1e-4, 1e-4, 1e-5, 1e-5, [1e-5] * 3, [1e-2] * 3]
        for c, h in enumerate(steps):
            e = np.zeros(15)
            e[c] = h
            derivative = (project(at + e) - project(at - e)) / (2 * h)
            J[i, :, c if c < 9 else own.start + c - 9] = derivative
    J = J.reshape(-1, columns)
    scale = np.linalg.norm(J, axis=0)
    whole = np.linalg.inv((J / scale).T @ (J / scale)) / np.outer(scale, scale)
    return SIGMA**2 * whole[:9, :9]


def simulated(views, sets=N_SETS, change=None):
    """The corners of each set with noise of its own: seeds 0, 1, 2, …"""
    _, m = views
    for seed in range(sets):
        noisy = m + np.random.default_rng(seed).normal(size=m.shape) * SIGMA
        yield noisy if change is None else change(noisy)


ALL = "k1 k2 p1 p2 k3"


@pytest.fixture(scope="module")
def at_the_minimum(board, views, refined):
    """Give a function that calibrates from the truth: which minimum is found is not asked there."""

    def found(m, lens=ALL):
        return refined(board.points, m, camera_of(TRUTH, np.eye(4)), views[0], lens=lens)

    return found


def errors(results):
    return np.array([[r.parameters[name] for name in NAMES] for r in results]) - TRUTH


@pytest.fixture(scope="module")
def results(board, views):
    return [calibrate(board.points, m, SIZE, lens=ALL) for m in simulated(views)]


def mahalanobis(d, bound):
    """Mean squared distance per parameter, 1 for an efficient estimator."""
    return float(np.einsum("ni,ij,nj->", d, np.linalg.inv(bound), d) / d.size)


def bias(d):
    """Mean error in standard errors of the mean, the largest of all parameters."""
    return float(np.abs(d.mean(0) / (d.std(0, ddof=1) / np.sqrt(len(d)))).max())


def test_errors_are_as_small_as_the_bound_allows(results, bound):
    assert mahalanobis(errors(results), bound) == pytest.approx(1, abs=0.11)


def test_each_variance_is_its_bound(results, bound):
    ratio = errors(results).var(0, ddof=1) / np.diag(bound)
    assert (ratio > 0.70).all()
    assert (ratio < 1.36).all()


def test_no_parameter_is_biased(results):
    assert bias(errors(results)) < 4.2


def test_the_rms_follows_its_law(results):
    measured, unknowns = 2 * 54 * N_VIEWS, 9 + 6 * N_VIEWS
    law = SIGMA * np.sqrt(2) * np.sqrt(1 - unknowns / measured)
    assert np.mean([r.rms for r in results]) == pytest.approx(law, rel=0.005)


def test_the_error_bars_are_the_bound(results, bound):
    said = np.array([[r.std[name] for name in NAMES] for r in results])
    ratio = np.sqrt((said**2).mean(0)) / np.sqrt(np.diag(bound))
    assert (ratio > 0.97).all()
    assert (ratio < 1.03).all()


def test_every_calibration_is_believed(results):
    assert all(r.reliable and r.converged for r in results)


# The same bands refuse estimators that read well and are wrong.


def refused(d, bound):
    ratio = d.var(0, ddof=1) / np.diag(bound)
    return (
        (ratio <= 0.70).any()
        or (ratio >= 1.36).any()
        or abs(mahalanobis(d, bound) - 1) > 0.11
        or bias(d) >= 4.2
    )


def usual_field_of_view(H):  # noqa: ARG001
    return np.diag([2.0, 2.0, 1.0])


@pytest.mark.parametrize(
    ("iterations", "intrinsics"),
    [(0, None), (1, None), (2, None), (3, usual_field_of_view)],
)
def test_the_bands_refuse_what_is_not_refined_to_the_end(
    board, views, bound, first_start, iterations, intrinsics
):
    d = []
    for m in simulated(views):
        data = Correspondences.of(board.points, m)
        problem = Problem(data.W, data.m, coefficients=("k1", "k2", "k3", "p1", "p2"), size=SIZE)
        x = first_start(problem, intrinsics)
        if iterations:
            x = levenberg_marquardt(
                x, problem.linearise, solve_by_schur, take_step, max_iterations=iterations
            ).x
        d.append(x.shared - TRUTH)
    assert refused(np.array(d), bound)


def test_the_bands_refuse_p1_and_p2_exchanged(results, bound):
    d = errors(results) + TRUTH
    assert refused(d[:, [0, 1, 2, 3, 4, 5, 6, 8, 7]] - TRUTH, bound)
    assert not refused(d - TRUTH, bound)


def test_the_bands_refuse_tangential_terms_left_out(views, bound, at_the_minimum):
    dropped = [at_the_minimum(m, "k1 k2 k3") for m in simulated(views)]
    d = np.array([[{"p1": 0, "p2": 0, **r.parameters}[name] for name in NAMES] for r in dropped])
    assert refused(d - TRUTH, bound)


@pytest.mark.parametrize(
    "change",
    [
        lambda m: m + 0.5,  # a half-pixel slip of the centre
        lambda m: np.round(2 * m) / 2,  # corners rounded to half a pixel
        lambda m: m + np.random.default_rng(0).normal(size=m.shape) * 0.15,
    ],
    ids=["half-pixel slip", "rounded corners", "a little more noise"],
)
def test_the_bands_refuse_corners_that_are_not_what_they_are_taken_for(
    views, bound, change, results, at_the_minimum
):
    same = at_the_minimum(next(simulated(views))).parameters
    assert same == pytest.approx(results[0].parameters, rel=1e-4)
    other = [at_the_minimum(m) for m in simulated(views, change=change)]
    assert refused(errors(other), bound)


def test_noise_of_one_pixel_scales_the_errors_and_the_error_bars_alike(
    views, bound, at_the_minimum
):
    _, m = views
    d, said = [], []
    for seed in range(50):
        noisy = m + np.random.default_rng(seed).normal(size=m.shape)
        r = at_the_minimum(noisy)
        d.append(errors([r])[0])
        said.append([r.std[name] for name in NAMES])
    assert mahalanobis(np.array(d), bound / SIGMA**2) == pytest.approx(1, abs=0.25)
    ratio = np.mean(said, axis=0) / np.sqrt(np.diag(bound / SIGMA**2))
    assert np.allclose(ratio, 1, atol=0.04)
