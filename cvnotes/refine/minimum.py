"""The minimisation itself: steps that move all poses and the camera at once."""

import numpy as np

from cvnotes.errors import Array, ConvergenceError
from cvnotes.optimise import Minimum, levenberg_marquardt
from cvnotes.refine.arrow import Arrow, solve_arrow
from cvnotes.refine.problem import Problem, State
from cvnotes.rigid import exp_so3

# Squared pixels per coordinate that rounding alone may leave.
_ROUNDING = 1e-25


def minimise(problem: Problem, start: State, *, tolerance: float = 1e-12) -> Minimum[State, Arrow]:
    """Minimise the reprojection error from a start, by Levenberg–Marquardt.

    Raises
    ------
    DegenerateError
        The views do not determine the parameters.
    ConvergenceError
        The minimum is no camera: a focal length or the depth of a board is not positive.

    References
    ----------
    .. [1] Notes 2b.4, "Refinement by non-linear optimization".
    .. [2] Triggs et al., Bundle adjustment: a modern synthesis (2000), section 6.
    """
    floor = _ROUNDING * problem.m.size
    found = levenberg_marquardt(
        start,
        problem.linearise,
        solve_arrow,
        move,
        follow=poses_follow,
        tolerance=tolerance,
        floor=floor,
    )
    if found.x.shared[:2].min() <= 0 or found.x.T[:, 2].min() <= 0:
        raise ConvergenceError(
            "the refinement left the space of cameras (a focal length or the depth of a board is "
            "not positive); the corners are probably paired with the wrong points of the board"
        )
    return found


def move(x: State, step: tuple[Array, Array]) -> State:
    """Take a step: R ← exp(ω) R, everything else by addition."""
    shared, poses = step
    return State(x.shared + shared, exp_so3(poses[:, :3]) @ x.R, x.T + poses[:, 3:])


def poses_follow(x: State, system: Arrow) -> State:
    """Take a step of the poses alone, the camera being held."""
    try:
        step = np.linalg.solve(system.poses, system.g_poses[..., None])[..., 0]
    except np.linalg.LinAlgError:  # too far away to be brought back
        return x
    return move(x, (np.zeros_like(x.shared), np.asarray(-step)))
