import numpy as np
import pytest
from differences import numerical_jacobian

from cvnotes.base import (
    ConvergenceError,
    DegenerateError,
    levenberg_marquardt,
    solve_dense,
)


def least_squares(residuals, jacobian):
    """What the loop wants to know, from r(x) and J(x)."""

    def linearise(x):
        both = np.c_[jacobian(x), residuals(x)]
        system = both.T @ both
        return float(system[-1, -1]), system

    return linearise


def rosenbrock(x):
    return np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]])


def rosenbrock_jacobian(x):
    return np.array([[-20 * x[0], 10], [-1, 0]])


def powell(x):
    """Powell's singular function: at the minimum the Jacobian has rank 2 of 4."""
    a, b, c, d = x
    return np.array([a + 10 * b, 5**0.5 * (c - d), (b - 2 * c) ** 2, 10**0.5 * (a - d) ** 2])


def powell_jacobian(x):
    a, b, c, d = x
    e, f = 2 * (b - 2 * c), 2 * 10**0.5 * (a - d)
    return np.array([[1, 10, 0, 0], [0, 0, 5**0.5, -(5**0.5)], [0, e, -2 * e, 0], [f, 0, 0, -f]])


def minimise(residuals, jacobian, start, **options):
    linearise = least_squares(residuals, jacobian)
    return levenberg_marquardt(np.array(start, float), linearise, solve_dense, np.add, **options)


def test_a_linear_problem_takes_one_step_to_the_normal_equations_solution():
    rng = np.random.default_rng(0)
    J, y = rng.normal(size=(10, 3)), rng.normal(size=10)
    found = minimise(lambda x: J @ x - y, lambda _: J, [5, 5, 5])
    assert np.allclose(found.x, np.linalg.solve(J.T @ J, J.T @ y), atol=1e-12)
    assert found.converged
    assert found.iterations <= 3


def test_a_curved_valley_is_followed_to_its_end():
    found = minimise(rosenbrock, rosenbrock_jacobian, [-1.2, 1])
    assert found.converged
    assert np.allclose(found.x, [1, 1], atol=1e-9)


def test_a_minimum_with_a_singular_jacobian_is_approached():
    found = minimise(powell, powell_jacobian, [3, -1, 0, 1], floor=1e-20)
    assert found.cost < 1e-12
    assert found.converged


def test_steps_that_go_uphill_are_not_taken():
    costs = []
    inner = least_squares(rosenbrock, rosenbrock_jacobian)

    def accepted(x, step):
        costs.append(inner(x)[0])
        return x + step

    levenberg_marquardt(np.array([-1.2, 1.0]), inner, solve_dense, accepted)
    assert (np.diff(costs) <= 0).all()


def test_the_floor_stops_where_only_rounding_is_left():
    early, late = (minimise(powell, powell_jacobian, [3, -1, 0, 1], floor=f) for f in (1e-4, 1e-12))
    assert early.converged
    assert late.converged
    assert early.iterations < late.iterations
    assert 1e-8 < powell(early.x) @ powell(early.x) < 1e-3
    assert powell(late.x) @ powell(late.x) < 1e-10
    assert early.cost < 1e-4


def test_what_does_not_converge_says_so():
    found = minimise(rosenbrock, rosenbrock_jacobian, [-1.2, 1], max_iterations=3)
    assert not found.converged
    assert found.iterations == 3


@pytest.mark.parametrize("tolerance", [1e-12, 1e-3])
def test_a_step_that_is_short_only_because_it_is_damped_is_no_convergence(tolerance):
    # a gradient with the wrong sign: every step goes uphill, however short
    found = minimise(rosenbrock, lambda x: -rosenbrock_jacobian(x), [-1.2, 1], tolerance=tolerance)
    assert not found.converged
    assert found.cost == pytest.approx(rosenbrock([-1.2, 1]) @ rosenbrock([-1.2, 1]), abs=1e-9)


def test_no_cost_is_below_0():
    for seed in range(50):
        rng = np.random.default_rng(seed)
        J = rng.normal(size=(6, 3))
        found = minimise(lambda x, J=J: J @ x, lambda _, J=J: J, rng.normal(size=3), floor=1e3)
        assert 0 <= found.cost < 1e-12


def test_a_start_without_a_finite_cost_is_refused():
    with pytest.raises(ConvergenceError, match="the cost at the start is not finite"):
        minimise(lambda x: x / 0.0 if x[0] < 0 else np.full(1, np.nan), np.diag, [1.0])


def test_a_step_out_of_the_model_is_taken_back():
    def root(x):  # no real value below 0, where the first Gauss–Newton step leads
        with np.errstate(invalid="ignore"):
            return np.sqrt(x) - 1

    found = minimise(root, lambda x: np.diag(0.5 / np.sqrt(x)), [9.0])
    assert np.allclose(found.x, 1, atol=1e-9)


def test_a_parameter_that_changes_nothing_is_refused():
    with pytest.raises(DegenerateError, match="do not determine every parameter"):
        minimise(lambda x: x[:1], lambda _: np.array([[1.0, 0]]), [1, 1])


def test_damping_adds_its_multiple_of_the_diagonal():
    rng = np.random.default_rng(1)
    J, r = rng.normal(size=(8, 3)), rng.normal(size=8)
    both = np.c_[J, r]
    step, predicted = solve_dense(both.T @ both, 0.7)
    N = J.T @ J
    expected = -np.linalg.solve(N + 0.7 * np.diag(np.diag(N)), J.T @ r)
    assert np.allclose(step, expected, atol=1e-12)
    assert predicted == pytest.approx(-(J.T @ r) @ expected, abs=1e-12)
    undamped, gain = solve_dense(both.T @ both, 0.0)
    assert gain == pytest.approx(r @ r - np.sum((r + J @ undamped) ** 2), abs=1e-12)


def test_parameters_that_follow_bring_an_uphill_step_back_into_the_valley():
    # r = (10 (y − x²), 1 − x) with y held to its best: one step along the valley's floor
    def follow(x, _):
        return np.array([x[0], x[0] ** 2])

    plain = minimise(rosenbrock, rosenbrock_jacobian, [-1.2, 1])
    followed = minimise(rosenbrock, rosenbrock_jacobian, [-1.2, 1], follow=follow)
    assert followed.iterations <= 3 < plain.iterations
    assert np.allclose(followed.x, [1, 1], atol=1e-9)


def test_the_numerical_jacobian_agrees_with_one_derived_by_hand():
    x = np.array([-1.2, 300.0])
    assert np.allclose(numerical_jacobian(rosenbrock, x), rosenbrock_jacobian(x), atol=1e-6)
    x = np.array([3.0, -1, 0.5, 1])
    assert np.allclose(numerical_jacobian(powell, x), powell_jacobian(x), atol=1e-8)
