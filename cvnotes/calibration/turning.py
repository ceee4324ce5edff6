"""The right one of many minima: a flat board has two poses that look alike.

Mirrored across the line of sight, a small or distant board shows nearly the same picture. A
refinement that starts with a board in the wrong one of the two poses seldom leaves it, and bends
the camera instead. So boards for which both poses are in question are turned over, everything is
refined from there, and what fits better is kept.
"""

from collections.abc import Iterator
from contextlib import suppress

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, ConvergenceError, DegenerateError, Minimum
from cvnotes.calibration.refinement import Arrow, Problem, State, minimise, poses_follow

# Of few views, a single wrong pose may bend the camera until it fits; among many it stands out.
FEW_VIEWS = 8
_STANDS_OUT = 2.0  # RMS of a view over that of a typical one
_POSE_STEPS = 3  # with the camera held; the other pose is then near enough to be judged
_IN_QUESTION = 4.0  # RMS of a view in its other pose over the larger of its own and that of all
_STEPS = 25  # by which a turned board has led downhill, or it does not
_NOISELESS = 1e-6  # px; what fits so well needs no other pose
_BETTER = 1e-6  # of the cost


def turned_over(R: Array, T: Array, normal: tuple[float, ...] | Array = (0.0, 0, 1)) -> Array:
    """Give the rotation (..., 3, 3) of the other pose of flat boards, R ← M(T) R M(normal).

    A mirror is M(n) = I − 2 n nᵀ. The one across the line of sight T leaves the picture of a
    distant board as it is; the one along the board's normal moves no point of the board, and makes
    the product a rotation.

    References
    ----------
    .. [1] G. Schweighofer and A. Pinz, Robust pose estimation from a planar target, PAMI 28
       (2006) 2024-2030.

    Examples
    --------
    >>> R = np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])
    >>> turned_over(R, np.array([0.0, 0.0, 500.0])) + 0.0
    array([[ 1. ,  0. ,  0. ],
           [ 0. ,  0.8,  0.6],
           [ 0. , -0.6,  0.8]])
    """
    return np.asarray(_mirror(T) @ R @ _mirror(np.asarray(normal)))


def _mirror(n: Array) -> Array:
    n = n / np.linalg.norm(n, axis=-1, keepdims=True)
    return np.asarray(np.eye(3) - 2 * n[..., :, None] * n[..., None, :])


def best_turned(problem: Problem, found: Minimum[State, Arrow]) -> Minimum[State, Arrow]:
    """Turn boards over as long as that leads to a lower minimum."""
    if not _worth_it(problem, found):
        return found
    better: Minimum[State, Arrow] | None = found
    while better is not None:
        found = better
        better = next(_lower_minima(problem, found), None)
    return found


def _worth_it(problem: Problem, found: Minimum[State, Arrow]) -> bool:
    """Tell whether a board may be in its other pose: from what is known already."""
    if found.cost <= _NOISELESS**2 * problem.n_seen:
        return False
    by_view = found.system.view_costs / problem.n_seen_by_view
    return len(by_view) <= FEW_VIEWS or by_view.max() > _STANDS_OUT**2 * np.median(by_view)


def _lower_minima(
    problem: Problem, found: Minimum[State, Arrow]
) -> Iterator[Minimum[State, Arrow]]:
    """Give the minima below this one: each board in question turned over, then all of them."""
    in_question = _in_question(problem, found)
    sets = [in_question[i : i + 1] for i in range(len(in_question))]
    for views in [*sets, in_question] if len(sets) > 1 else sets:
        R = found.x.R.copy()
        R[views] = turned_over(R[views], found.x.T[views])
        with suppress(ConvergenceError, DegenerateError):
            other = minimise(problem, State(found.x.shared, R, found.x.T), steps=_STEPS)
            if other.cost < found.cost * (1 - _BETTER):
                yield other if other.converged else minimise(problem, other.x)


def _in_question(problem: Problem, found: Minimum[State, Arrow]) -> npt.NDArray[np.intp]:
    """List the views that the other pose fits about as well, the likeliest first.

    The camera is held meanwhile, so that all boards are turned over in one go.
    """
    turned_R = turned_over(found.x.R, found.x.T)
    x = State(found.x.shared, turned_R, found.x.T)
    with np.errstate(all="ignore"):
        for _ in range(_POSE_STEPS):
            x = poses_follow(x, problem.linearise(x)[1])
        costs = problem.linearise(x)[1].view_costs / problem.n_seen_by_view
    own = found.system.view_costs / problem.n_seen_by_view
    ratio = costs / np.maximum(own, found.cost / problem.n_seen)
    fell_back = _distance(x.R, found.x.R) < _distance(x.R, turned_R)  # there is no other pose
    ratio = np.where(fell_back, np.inf, ratio)
    order = np.argsort(ratio)
    return order[ratio[order] < _IN_QUESTION**2]


def _distance(R: Array, S: Array) -> Array:
    return np.asarray(((R - S) ** 2).sum((-2, -1)))
