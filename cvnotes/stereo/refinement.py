"""Maximum likelihood for two cameras: both, their relative pose and all board poses together.

The normal matrix is an arrow again. Shared are the parameters of both cameras and the relative
pose; each pair of pictures adds the pose of its board in the left camera's frame. The right
camera's poses are no unknowns: G_right = G · G_left, so its normal equations, as `Problem` gives
them, are carried over by the chain rule.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from cvnotes.base import Array, DegenerateError, Minimum, levenberg_marquardt
from cvnotes.calibration.refinement import (
    NormalEquations,
    Problem,
    State,
    solve_by_schur,
    take_step,
)
from cvnotes.camera import rotation_from_vector, skew_matrix

# Squared pixels per coordinate that rounding alone may leave.
_ROUNDING = 1e-25


class StereoState(NamedTuple):
    """Where the optimiser stands: the left camera and its poses, the right camera, and G."""

    left: State
    right: Array  # shared parameters of the right camera
    R: Array  # (3, 3) and T (3,): right ← left
    T: Array

    def of_right(self) -> State:
        """Return the state of the right camera, whose poses follow: R R_left, R T_left + T."""
        return State(self.right, self.R @ self.left.R, self.left.T @ self.R.T + self.T)


@dataclass(frozen=True, eq=False)
class StereoProblem:
    """The same boards seen by two cameras.

    Parameters
    ----------
    left, right : Problem
        Of the same views, with the same board points.
    cameras_known : bool
        Hold A and lens of both cameras; only the relative pose and the boards are then sought.
    """

    left: Problem
    right: Problem
    cameras_known: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the shared parameters that are estimated."""
        cameras = [f"left.{name}" for name in self.left.names]
        cameras += [f"right.{name}" for name in self.right.names]
        pose = ("omega_x", "omega_y", "omega_z", "T_x", "T_y", "T_z")
        return pose if self.cameras_known else (*cameras, *pose)

    def linearise(self, x: StereoState) -> tuple[float, NormalEquations]:
        """Return the cost and the normal equations at x."""
        cost_left, left = self.left.linearise(x.left)
        cost_right, right = self.right.linearise(x.of_right())
        equations = _joined(left, _carried_over(right, x))
        if self.cameras_known:
            equations = replace(
                equations,
                shared=equations.shared[-6:, -6:],
                border=equations.border[..., -6:],
                g_shared=equations.g_shared[-6:],
            )
        return cost_left + cost_right, equations

    def take_step(self, x: StereoState, step: tuple[Array, Array]) -> StereoState:
        """Take a step: rotations from the left, everything else by addition."""
        shared, poses = step
        q = len(x.left.shared)
        cameras = np.zeros(q + len(x.right)) if self.cameras_known else shared[:-6]
        return StereoState(
            take_step(x.left, (cameras[:q], poses)),
            x.right + cameras[q:],
            rotation_from_vector.inside(shared[-6:-3]) @ x.R,
            x.T + shared[-3:],
        )

    def minimise(self, start: StereoState) -> Minimum[StereoState, NormalEquations]:
        """Minimise the reprojection error in both pictures, by Levenberg–Marquardt.

        Raises
        ------
        DegenerateError
            The pairs do not determine the parameters.
        """
        floor = _ROUNDING * (self.left.m.size + self.right.m.size)
        found = levenberg_marquardt(
            start, self.linearise, solve_by_schur, self.take_step, floor=floor
        )
        depths = np.concatenate([found.x.left.T[:, 2], found.x.of_right().T[:, 2]])
        if depths.min() <= 0:
            raise DegenerateError(
                "the pairs do not fit two cameras on one rig: a board would be behind a camera. "
                "Do left and right pictures belong together, numbered from the same corner?"
            )
        return found


def _carried_over(right: NormalEquations, x: StereoState) -> NormalEquations:
    """Write the right camera's normal equations in terms of G and of the left camera's poses.

    With R ← exp(ω) R and T ← T + dT for each of the poses,

        [ω_right; dT_right] = C [ω; dT] + D [ω_left; dT_left],
        C = [I 0; −[R T_left]× I],  D = diag(R, R).
    """
    n = len(right.poses)
    C = np.tile(np.eye(6), (n, 1, 1))
    C[:, 3:, :3] = -skew_matrix(x.left.T @ x.R.T)
    D = np.kron(np.eye(2), x.R)
    q = len(right.shared)
    shared = np.zeros((q + 6, q + 6))
    shared[:q, :q] = right.shared
    shared[q:, q:] = (C.mT @ right.poses @ C).sum(0)
    shared[q:, :q] = (C.mT @ right.border).sum(0)
    shared[:q, q:] = shared[q:, :q].T
    by_G = right.poses @ C  # how each pose of the right camera is tied to G
    return NormalEquations(
        shared,
        D.T @ np.concatenate([right.border, by_G], axis=-1),
        D.T @ right.poses @ D,
        np.append(right.g_shared, (C.mT @ right.g_poses[..., None]).sum(0)),
        right.g_poses @ D,
        right.view_costs,
    )


def _joined(left: NormalEquations, right: NormalEquations) -> NormalEquations:
    """Add normal equations that have the poses in common but none of the shared parameters."""
    q = len(left.shared)
    p = q + len(right.shared)
    shared = np.zeros((p, p))
    shared[:q, :q], shared[q:, q:] = left.shared, right.shared
    return NormalEquations(
        shared,
        np.concatenate([left.border, right.border], axis=-1),
        left.poses + right.poses,
        np.append(left.g_shared, right.g_shared),
        left.g_poses + right.g_poses,
        left.view_costs + right.view_costs,
    )
