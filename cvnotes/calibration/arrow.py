"""The normal equations of many views, in the shape of an arrow, and how they are solved."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cvnotes.base import Array, DegenerateError

_UNDETERMINED = (
    "the normal equations are singular: these views do not determine every parameter; "
    "add views with the board tilted in other directions"
)


@dataclass(frozen=True, eq=False)
class Arrow:
    """The normal equations, in blocks: JᵀJ and Jᵀr."""

    shared: Array  # (q, q) border corner
    border: Array  # (n_views, 6, q)
    poses: Array  # (n_views, 6, 6)
    g_shared: Array  # (q,)
    g_poses: Array  # (n_views, 6)
    view_costs: Array  # (n_views,) rᵀr of each view

    def damped(self, damping: float) -> "Arrow":
        """Multiply the diagonal by 1 + damping."""
        if not damping:
            return self
        return replace(self, shared=_damp(self.shared, damping), poses=_damp(self.poses, damping))

    @cached_property
    def eliminated(self) -> tuple[Array, Array]:
        """V⁻¹ [W g] of each view and Σ Wᵀ V⁻¹ [W g]: pose block V, its border W, gradient g."""
        right = np.concatenate([self.border, self.g_poses[..., None]], axis=-1)
        try:
            solved = np.linalg.solve(self.poses, right)
        except np.linalg.LinAlgError:
            raise DegenerateError(_UNDETERMINED) from None
        q = len(self.shared)
        return solved, right.reshape(-1, q + 1)[:, :q].T @ solved.reshape(-1, q + 1)


def solve_arrow(system: Arrow, damping: float) -> tuple[tuple[Array, Array], float]:
    """Solve the damped normal equations; gives the step (shared, poses) and the predicted gain."""
    system = system.damped(damping)
    solved, from_poses = system.eliminated
    try:
        d_shared = np.linalg.solve(
            system.shared - from_poses[:, :-1], from_poses[:, -1] - system.g_shared
        )
    except np.linalg.LinAlgError:
        raise DegenerateError(_UNDETERMINED) from None
    d_poses = -(solved[..., -1] + solved[..., :-1] @ d_shared)
    gain = -np.vdot(system.g_shared, d_shared) - np.vdot(system.g_poses, d_poses)
    return (np.asarray(d_shared), d_poses), float(gain)


def covariance(system: Arrow) -> Array:
    """Invert the normal matrix for the shared parameters, (q, q), for noise of 1 px."""
    S = system.shared - system.eliminated[1][:, :-1]
    diagonal = np.diagonal(S)
    if not (diagonal > 0).all():
        raise DegenerateError(_UNDETERMINED)
    scale = np.sqrt(diagonal[:, None] * diagonal)
    try:
        inverse = np.linalg.inv(S / scale) / scale
    except np.linalg.LinAlgError:
        raise DegenerateError(_UNDETERMINED) from None
    return np.asarray((inverse + inverse.T) / 2)


def pose_covariance(system: Arrow, shared: Array) -> Array:
    """Invert the normal matrix for each pose (ω, T), (n_views, 6, 6), for noise of 1 px.

    The uncertainty of the shared parameters, from `covariance`, is included.
    """
    solved = system.eliminated[0][..., :-1]
    return np.asarray(np.linalg.inv(system.poses) + solved @ shared @ solved.mT)


def _damp(N: Array, damping: float) -> Array:
    N = N.copy()
    diagonal = np.einsum("...ii->...i", N)
    diagonal *= 1 + damping
    return N
