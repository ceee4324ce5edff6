"""Boards that look the same after half a turn: from which end both cameras count the corners."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import pose, vector_from_rotation


def half_turns(board: Array, left_poses: Array, right_poses: Array) -> Array:
    """Mark in which pairs one picture's corners are numbered from the other end of the board.

    Parameters
    ----------
    board : ndarray, shape (n, 3)
        The corners on the board, which half a turn about their middle maps onto each other.
    left_poses, right_poses : ndarray, shape (n_views, 4, 4)
        Pose of the board in each picture, each found by itself.

    Returns
    -------
    ndarray of bool, shape (n_views,)
        Where half a turn brings a pair to the relative pose that most pairs share.

    Notes
    -----
    Each pair shows two rotations right ← left, R₂ R₁ᵀ and R₂ Z R₁ᵀ, Z being half a turn about the
    board's normal. The right ones are all the same, since the rig is rigid; the others change with
    the tilt of the board. Of all 2n rotations that one is taken to which those of the other pairs
    come closest, in the sum of angles.
    """
    Z = pose(np.diag([-1.0, -1.0, 1.0]), 2 * board.mean(axis=0) * [1, 1, 0])
    R = np.stack([right_poses, right_poses @ Z])[..., :3, :3] @ left_poses[:, :3, :3].mT
    candidates = R.reshape(-1, 1, 1, 3, 3)
    angles = np.linalg.norm(vector_from_rotation(R @ candidates.mT), axis=-1)  # (2n, 2, n)
    best = int(angles.min(axis=1).sum(axis=-1).argmin())
    return np.asarray(angles[best].argmin(axis=0) == 1)
