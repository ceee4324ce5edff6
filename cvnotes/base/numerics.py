"""Arrays in parts, matrices that may be singular, one Levenberg–Marquardt loop (notes 2b.4).

The loop is the same for all who refine. The cost is a sum of squares rᵀr with Jacobian J. A step
solves (JᵀJ + μ D) δ = −Jᵀr with D = diag(JᵀJ). Who refines says how to linearise, how to solve and
how to move; the loop only decides how far to trust the linear model.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from cvnotes.base.errors import ConvergenceError, DegenerateError
from cvnotes.base.guards import Array

# Gains may fall at a stroke while the residuals still matter, but at the end, next to what noise
# leaves of them, at a steady rate: no step is expected to gain less than this much of the last.
_SHRINKS = 1e-3

X = TypeVar("X")
System = TypeVar("System")
Step = TypeVar("Step")


def chunks(n: int, size: int) -> Iterator[slice]:
    """Cut n rows into slices of at most `size`.

    Examples
    --------
    >>> list(chunks(5, 2))
    [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    return (slice(first, min(first + size, n)) for first in range(0, n, size))


def solved(operation: Callable[..., Any], *arguments: Array, why: str) -> Array:
    """Return what an operation of `numpy.linalg` gives, or refuse a singular matrix.

    Where the machine has no flags of floating-point errors (WebAssembly), NumPy cannot raise and
    gives NaN instead, so both are looked for.

    Raises
    ------
    DegenerateError
        The matrix is singular; `why` says what that means.

    Examples
    --------
    >>> solved(np.linalg.inv, np.diag([2.0, 4.0]), why="two axes coincide")
    array([[0.5 , 0.  ],
           [0.  , 0.25]])
    """
    try:
        answer = np.asarray(operation(*arguments))
    except np.linalg.LinAlgError:
        raise DegenerateError(why) from None
    if not np.isfinite(answer).all():
        raise DegenerateError(why)
    return answer


@dataclass(frozen=True, eq=False)
class Minimum(Generic[X, System]):
    """Where a minimisation ended, its cost, and the linear system that led there.

    After a converged last step, cost and system are what the linear model says of its end.
    """

    x: X
    cost: float
    system: System
    iterations: int
    converged: bool


def levenberg_marquardt(
    x: X,
    linearise: Callable[[X], tuple[float, System]],
    solve: Callable[[System, float], tuple[Step, float]],
    take_step: Callable[[X, Step], X],
    *,
    follow: Callable[[X, System], X] | None = None,
    max_iterations: int = 100,
    tolerance: float = 1e-12,
    floor: float = 0.0,
    patience: int | None = None,
) -> Minimum[X, System]:
    """Minimise a sum of squares, starting from `x`.

    Parameters
    ----------
    x : any
        The start.
    linearise : callable
        x → (cost, system): the sum of squares at x and whatever `solve` needs.
    solve : callable
        (system, damping μ) → (step, predicted decrease of the cost).
    take_step : callable
        (x, step) → the new x.
    follow : callable, optional
        (x, system) → x with some of its parameters brought to their best, the others held.
    max_iterations : int
        Steps tried before giving up; the result then says ``converged=False``.
    tolerance, floor : float
        Stop when the next step would gain less than ``tolerance * cost + floor``, if it shrinks
        as much as this one did. The floor is the cost that rounding alone causes.

    patience : int, optional
        How often an end that was reached by damped steps is left again without damping, before it
        is taken for the minimum; as long as there are steps, unless given.

    Raises
    ------
    ConvergenceError
        The cost at the start is not finite.

    Notes
    -----
    The first steps are Gauss–Newton steps (μ = 0). When a step goes uphill, `follow` may first
    bring it back into a curved valley, along which damped steps only creep; if that does not
    help, damping begins.

    References
    ----------
    .. [1] Notes 2b.4, "Refinement by non-linear optimization".
    .. [2] D. W. Marquardt, J. SIAM 11 (1963) 431-441.

    Examples
    --------
    >>> def line(x):  # one parameter, r = x − 3
    ...     return float((x[0] - 3) ** 2), np.array([[1.0, x[0] - 3], [x[0] - 3, 0.0]])
    >>> levenberg_marquardt(np.zeros(1), line, solve_dense, np.add).x
    array([3.])
    """
    cost, system = linearise(x)
    if not np.isfinite(cost):
        raise ConvergenceError("the cost at the start is not finite: start closer to the answer")
    damping, previous, returns = 0.0, 0.0, 0
    for iteration in range(1, max_iterations + 1):
        step, predicted = solve(system, damping)
        shrinks = max(_SHRINKS, predicted / previous) if previous > 0 else 1.0
        # (a decrease below 0 is no decrease: it comes from rounding where J is nearly singular)
        close = abs(predicted) * min(1.0, shrinks) <= tolerance * cost + floor
        with np.errstate(all="ignore"):  # a step too far may leave the model; it is then refused
            x_new = take_step(x, step)
            if close and damping == 0:  # too short a step to look where it ends
                return Minimum(x_new, max(cost - predicted, 0.0), system, iteration, True)
            cost_new, system_new = linearise(x_new)
            if follow and np.isfinite(cost_new) and cost_new >= cost:
                x_new = follow(x_new, system_new)
                cost_new, system_new = linearise(x_new)
        downhill = cost_new < cost
        if downhill:
            x, cost, system = x_new, cost_new, system_new
        if close:  # perhaps only because damping keeps the step short
            if returns == patience:  # no: whenever it is let go, the step leads uphill
                return Minimum(x, cost, system, iteration, True)
            damping, previous, returns = 0.0, 0.0, returns + 1
        elif downhill:
            previous, returns = (predicted, 0) if damping == 0 else (0.0, returns)
            damping = 0.1 * damping if damping > 1e-6 else 0.0
        elif damping > 1e9:
            break
        else:
            damping, previous = max(10 * damping, 1e-3), 0.0
    return Minimum(x, cost, system, iteration, False)


def solve_dense(system: Array, damping: float) -> tuple[Array, float]:
    """Solve one dense system, given as [J r]ᵀ [J r] of shape (p + 1, p + 1).

    Raises
    ------
    DegenerateError
        The normal equations are singular: some parameter changes nothing.
    """
    normal, gradient = system[:-1, :-1], system[:-1, -1]
    damped = normal + damping * np.diag(np.diagonal(normal))
    why = "the normal equations are singular: the data do not determine every parameter"
    step = -solved(np.linalg.solve, damped, gradient, why=why)
    return step, float(-gradient @ step)


def clipped_segments(ends: Array, depth: Array) -> Array:
    """Cut segments to a convex region: (m, 2, d), without those that lie outside of it.

    Parameters
    ----------
    ends : ndarray, shape (n, 2, d)
        Both ends of each; NaN where there is none.
    depth : ndarray, shape (n, 2, k)
        How deep each end lies inside of each of the k half-spaces whose intersection the region
        is; negative outside, in any unit.

    References
    ----------
    .. [1] Y.-D. Liang and B. Barsky, A new concept and method for line clipping, ACM Trans.
       Graphics 3 (1984) 1-22.

    Examples
    --------
    >>> ends = np.array([[[-1.0, 0], [3, 0]], [[-1, 0], [-2, 0]]])
    >>> clipped_segments(ends, ends[..., :1])  # where x is positive
    array([[[0., 0.],
            [3., 0.]]])
    """
    slope = depth[:, 1] - depth[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = -depth[:, 0] / slope
    enter = np.where(slope > 0, t, 0.0).max(axis=1, initial=0.0)
    leave = np.where(slope < 0, t, 1.0).min(axis=1, initial=1.0)
    beside = ((slope == 0) & (depth[:, 0] < 0)).any(axis=1)  # parallel to a border, and outside
    kept = (enter < leave) & ~beside & np.isfinite(slope).all(axis=1)
    start, way = ends[kept, :1], ends[kept, 1:] - ends[kept, :1]
    return np.asarray(start + np.stack([enter, leave], axis=1)[kept, :, None] * way)


def student(z: float, freedom: float) -> float:
    """Return the quantile of Student's t that has the same probability as z has among normal ones.

    References
    ----------
    .. [1] M. Abramowitz and I. Stegun, Handbook of Mathematical Functions (1964), 26.7.5.

    Examples
    --------
    >>> [round(student(1.96, n), 2) for n in (4, 14, 1000)]
    [2.77, 2.14, 1.96]
    """
    terms = (z**3 + z, 5 * z**5 + 16 * z**3 + 3 * z, 3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z)
    scaled = zip(terms, (4, 96, 384), strict=True)
    return z + sum(t / (w * freedom**i) for i, (t, w) in enumerate(scaled, 1))
