"""What `calibrate` has in reserve, when the plain way leads nowhere (notes 2b.4).

Of the starts, in this order:

1. other A: the full closed form, then four usual fields of view;
2. corners straightened beforehand, for lenses that bend the boards too much for homographies;
3. of many views first a few, which know the camera well enough to place all others;
4. for wide lenses, corners straightened as equidistant lenses of several fields of view would.

A flat board has two poses that look alike: mirrored across the line of sight, a small or distant
board shows nearly the same picture. A refinement that starts with a board in the wrong one seldom
leaves it, and bends the camera instead. So boards for which both poses are in question are turned
over (`best_turned`), everything is refined from there, and what fits better is kept.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, ConvergenceError, DegenerateError
from cvnotes.calibration.refinement import (
    Optimum,
    Problem,
    State,
    minimise,
    poses_follow,
    typical_cost,
)
from cvnotes.calibration.zhang import intrinsics_from_b
from cvnotes.camera import Camera, intrinsics, xy_from_px

# Strong lenses bend the boards so much that homographies mislead. In reserve, the corners are
# first straightened: x ← x (1 + bend r²), with r = 1 at the ends of the picture's longer axis.
BENDS = (0.0, 0.2, -0.2)
# Noise and strong lenses can leave no A; then fields of view from 118° to 28° are tried.
_USUAL_FOCAL_LENGTHS = (0.6, 1.0, 2.0, 4.0)
# Radians that the longer side of a wide picture may span, and the steepest ray for a homography.
_FIELDS_OF_VIEW = (1.6, 2.2, 2.8, 1.1, 3.6)
_STEEPEST = 1.4


# --- other starts


def straightened(m: Array, camera: Camera) -> Array:
    """Return where such a camera's picture would show corners m (..., 2) on the plane z = 1."""
    as_seen = xy_from_px.inside(camera.A, m)
    ideal = camera.lens.undistort(as_seen)
    xy = np.where(np.isnan(ideal), as_seen, ideal)
    if camera.lens.wide:  # rays near 90° and beyond: as far out as may be
        r = np.linalg.norm(as_seen, axis=-1, keepdims=True)
        flat = camera.lens.rays(as_seen)[..., 2:] > np.cos(_STEEPEST)
        xy = np.where(flat, xy, np.tan(_STEEPEST) / np.maximum(r, 1e-9) * as_seen)
    return np.asarray(xy)


def wide_cameras(problem: Problem) -> Iterator[Camera]:
    """Return cameras of several fields of view, with lenses that are usual for this kind."""
    w, h = problem.size
    for view in _FIELDS_OF_VIEW:
        for lens in problem.model.usual():
            # (as if it were equidistant all over, with its own scale in the middle)
            scale = lens.derivatives(np.array([0.0, 0.0, 1.0]))[1][0, 0]
            f = max(w, h) / view / scale
            yield Camera(intrinsics(f, f, (w - 1) / 2, (h - 1) / 2), lens=lens, size=problem.size)


def closed_form(V: Array, b: Array) -> Array:  # noqa: ARG001
    """Take Zhang's closed form for A."""
    return intrinsics_from_b(b)


def _usual(f: float) -> Callable[[Array, Array], Array]:
    return lambda V, b: np.diag([f, f, 1.0])  # noqa: ARG005


# Other A, after the focal lengths alone.
GUESSES = (closed_form, *map(_usual, _USUAL_FOCAL_LENGTHS))


# --- the other pose of a flat board

_POSE_STEPS = 3  # with the camera held; the other pose is then near enough to be judged
_IN_QUESTION = 4.0  # RMS of a view in its other pose over the larger of its own and a typical one
_STEPS = 25  # by which a turned board has led downhill, or it does not
_BETTER = 1e-6  # of the cost


def flipped_pose(R: Array, T: Array, normal: tuple[float, ...] | Array = (0.0, 0, 1)) -> Array:
    """Return the rotation (..., 3, 3) of the other pose of flat boards, R ← M(T) R M(normal).

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
    >>> flipped_pose(R, np.array([0.0, 0.0, 500.0])) + 0.0
    array([[ 1. ,  0. ,  0. ],
           [ 0. ,  0.8,  0.6],
           [ 0. , -0.6,  0.8]])
    """
    return np.asarray(_mirror(T) @ R @ _mirror(np.asarray(normal)))


def _mirror(n: Array) -> Array:
    n = n / np.linalg.norm(n, axis=-1, keepdims=True)
    return np.asarray(np.eye(3) - 2 * n[..., :, None] * n[..., None, :])


def best_turned(
    problem: Problem, found: Optimum, known: Sequence[tuple[Optimum, Optimum]] = ()
) -> Optimum:
    """Turn boards over as long as that leads to a lower minimum.

    Of some minima it is `known` already to which others that leads.
    """
    better: Optimum | None = found
    while better is not None:
        found = better
        for end, lowest in known:
            if _is_same(end, found):
                return lowest
        better = next(_lower_minima(problem, found), None)
    return found


def _lower_minima(problem: Problem, found: Optimum) -> Iterator[Optimum]:
    """Return the minima below this one: each board in question turned over, then all of them."""
    in_question = _in_question(problem, found)
    sets = [in_question[i : i + 1] for i in range(len(in_question))]
    for views in [*sets, in_question] if len(sets) > 1 else sets:
        R = found.x.R.copy()
        R[views] = flipped_pose(R[views], found.x.T[views])
        with suppress(ConvergenceError, DegenerateError):
            other = minimise(problem, State(found.x.shared, R, found.x.T), steps=_STEPS)
            if other.cost < found.cost * (1 - _BETTER):
                yield other if other.converged else minimise(problem, other.x)


def _in_question(problem: Problem, found: Optimum) -> npt.NDArray[np.intp]:
    """List the views that the other pose fits about as well, the likeliest first.

    The camera is held meanwhile, so that all boards are turned over in one go.
    """
    turned_R = flipped_pose(found.x.R, found.x.T)
    x = State(found.x.shared, turned_R, found.x.T)
    with np.errstate(all="ignore"):
        for _ in range(_POSE_STEPS):
            x = poses_follow(x, problem.linearise(x)[1])
        costs = problem.linearise(x)[1].view_costs / problem.n_seen_by_view
    own = found.system.view_costs / problem.n_seen_by_view
    ratio = costs / np.maximum(own, typical_cost(problem, found))
    fell_back = _distance(x.R, found.x.R) < _distance(x.R, turned_R)  # there is no other pose
    ratio = np.where(fell_back, np.inf, ratio)
    order: npt.NDArray[np.intp] = np.argsort(ratio)
    return order[ratio[order] < _IN_QUESTION**2]


def _is_same(one: Optimum, other: Optimum) -> bool:
    """Return whether two minimisations ended in the same minimum.

    Where lenses are only compared, they end a little beside it.
    """
    if not (one.converged and other.converged and np.isclose(one.cost, other.cost, 1e-6, 0)):
        return False
    pairs = [(getattr(one.x, name), getattr(other.x, name)) for name in ("shared", "R", "T")]
    return all(np.abs(a - b).max() <= 1e-3 * np.abs(a).max() for a, b in pairs)


def _distance(R: Array, S: Array) -> Array:
    return np.asarray(((R - S) ** 2).sum((-2, -1)))
