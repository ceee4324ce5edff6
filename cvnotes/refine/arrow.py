"""The normal equations of many views, in the shape of an arrow, and how they are solved."""

from typing import NamedTuple

import numpy as np

from cvnotes.errors import Array, DegenerateError

_UNDETERMINED = (
    "the normal equations are singular: these views do not determine every parameter; "
    "add views with the board tilted in other directions"
)


class Arrow(NamedTuple):
    """The normal equations, in blocks: JᵀJ and Jᵀr."""

    shared: Array  # (q, q) border corner
    border: Array  # (n_views, 6, q)
    poses: Array  # (n_views, 6, 6)
    g_shared: Array  # (q,)
    g_poses: Array  # (n_views, 6)
    view_costs: Array  # (n_views,) rᵀr of each view


def solve_arrow(system: Arrow, damping: float) -> tuple[tuple[Array, Array], float]:
    """Solve the damped normal equations; gives the step (shared, poses) and the predicted gain."""
    poses, shared = _damp(system.poses, damping), _damp(system.shared, damping)
    q = len(shared)
    try:
        # V⁻¹ [W g] for all views, V being a pose block, W its border and g its gradient
        right = np.concatenate([system.border, system.g_poses[..., None]], axis=-1)
        solved = np.linalg.solve(poses, right)
        # Σ Wᵀ V⁻¹ [W g]
        eliminated = right.reshape(-1, q + 1)[:, :q].T @ solved.reshape(-1, q + 1)
        d_shared = np.linalg.solve(shared - eliminated[:, :q], eliminated[:, q] - system.g_shared)
    except np.linalg.LinAlgError:
        raise DegenerateError(_UNDETERMINED) from None
    d_poses = -(solved[..., -1] + solved[..., :-1] @ d_shared)
    gain = -(system.g_shared @ d_shared) - float((system.g_poses * d_poses).sum())
    return (d_shared, d_poses), float(gain)


def covariance(system: Arrow) -> Array:
    """Invert the normal matrix for the shared parameters, (q, q), for noise of 1 px."""
    solved = np.linalg.solve(system.poses, system.border)
    S = system.shared - np.tensordot(system.border, solved, ([0, 1], [0, 1]))
    scale = np.sqrt(np.diagonal(S))
    if not (scale > 0).all():
        raise DegenerateError(_UNDETERMINED)
    try:
        inverse = np.linalg.inv(S / np.outer(scale, scale)) / np.outer(scale, scale)
    except np.linalg.LinAlgError:
        raise DegenerateError(_UNDETERMINED) from None
    return np.asarray((inverse + inverse.T) / 2)


def pose_covariance(system: Arrow, shared: Array) -> Array:
    """Invert the normal matrix for each pose (ω, T), (n_views, 6, 6), for noise of 1 px.

    The uncertainty of the shared parameters, from `covariance`, is included.
    """
    solved = np.linalg.solve(system.poses, system.border)
    return np.asarray(np.linalg.inv(system.poses) + solved @ shared @ solved.mT)


def _damp(N: Array, damping: float) -> Array:
    if not damping:
        return N
    N = N.copy()
    diagonal = np.einsum("...ii->...i", N)
    diagonal *= 1 + damping
    return N
