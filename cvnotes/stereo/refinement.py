"""Maximum likelihood for two cameras: both, their relative pose and all board poses together.

The normal matrix is an arrow again. Shared are the parameters of both cameras, the relative pose
and the shape of the board, which is one for both; each pair of pictures adds the pose of its board
in the left camera's frame. The right camera's poses are no unknowns: G_right = G · G_left, so its
normal equations, as `Problem` gives them, are carried over by the chain rule.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

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
    right: Array  # shared parameters of the right camera; the board's shape, too, as in the left
    R: Array  # (3, 3) and T (3,): right ← left
    T: Array

    def some(self, views: slice) -> "StereoState":
        """Keep the poses of some of the pairs."""
        return self._replace(left=self.left.some(views))

    def of_right(self) -> State:
        """Return the state of the right camera, whose poses follow: R R_left, R T_left + T."""
        return State(self.right, self.R @ self.left.R, self.left.T @ self.R.T + self.T)


@dataclass(frozen=True, eq=False)
class StereoProblem:
    """The same boards seen by two cameras.

    Parameters
    ----------
    left, right : Problem
        Of the same views, with the same board points, and the same ways in which these may differ;
        what holds the shape of the board belongs to one of them.
    """

    left: Problem
    right: Problem

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the shared parameters that are estimated."""
        cameras = [f"left.{name}" for name in self.left.names]
        cameras += [f"right.{name}" for name in self.right.names]
        pose = ("omega_x", "omega_y", "omega_z", "T_x", "T_y", "T_z")
        return (*cameras, *pose)

    def some(self, views: slice) -> "StereoProblem":
        """Keep some of the pairs."""
        return replace(self, left=self.left.some(views), right=self.right.some(views))

    @cached_property
    def places(self) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], npt.NDArray[np.intp]]:
        """Which of all shared parameters are of the left camera, of the right one, and of G.

        Either camera's are followed by the shape of the board, which stands at the end of all.
        """
        a, b, shape = len(self.left.names), len(self.right.names), np.arange(self.left.n_shape)
        last = a + b + 6
        left, right = (
            np.append(np.arange(a), last + shape),
            np.append(a + np.arange(b), last + shape),
        )
        return left, right, np.arange(a + b, last)

    def linearise(self, x: StereoState) -> tuple[float, NormalEquations]:
        """Return the cost and the normal equations at x."""
        cost_left, left = self.left.linearise(x.left)
        cost_right, right = self.right.linearise(x.of_right())
        of_left, of_right, of_G = self.places
        of_right = np.append(of_right, of_G)
        equations = _joined((left, of_left), (_carried_over(right, x), of_right))
        return cost_left + cost_right, equations

    def take_step(self, x: StereoState, step: tuple[Array, Array]) -> StereoState:
        """Take a step: rotations from the left, everything else by addition."""
        shared, poses = step
        of_left, of_right, of_G = self.places
        G = shared[of_G]
        return StereoState(
            take_step(x.left, (shared[of_left], poses)),
            x.right + shared[of_right],
            rotation_from_vector.inside(G[:3]) @ x.R,
            x.T + G[3:],
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
        sides = (self.left, found.x.left), (self.right, found.x.of_right())
        # (a wide lens may see a board beside it)
        if any(x.T[:, 2].min() <= 0 for side, x in sides if not side.model.wide):
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


def _joined(*parts: tuple[NormalEquations, npt.NDArray[np.intp]]) -> NormalEquations:
    """Add normal equations of the same poses, whose shared parameters have these places."""
    p = 1 + max(int(places.max()) for _, places in parts)
    n = len(parts[0][0].poses)
    shared, border, g_shared = np.zeros((p, p)), np.zeros((n, 6, p)), np.zeros(p)
    for each, places in parts:
        shared[np.ix_(places, places)] += each.shared
        border[..., places] += each.border
        g_shared[places] += each.g_shared
    (left, _), (right, _) = parts
    return NormalEquations(
        shared,
        border,
        left.poses + right.poses,
        g_shared,
        left.g_poses + right.g_poses,
        left.view_costs + right.view_costs,
    )
