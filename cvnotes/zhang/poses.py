"""The pose of each view, from A and its homography."""

import numpy as np
import numpy.typing as npt

from cvnotes.errors import Array, intrinsic_matrix, matrix
from cvnotes.rigid import nearest_rotation, skew_matrix
from cvnotes.zhang.b import scaled


def extrinsics(A: npt.ArrayLike, H: npt.ArrayLike) -> Array:
    """Give the pose G (..., 4, 4) of each view, CRF ← board, from A and H (..., 3, 3).

    λ r1 = A⁻¹ h1 and λ r2 = A⁻¹ h2 with two sizes of λ when there is noise; their mean is
    taken (erratum E32), with the sign that puts the board in front of the camera (T_z > 0).
    r3 = r1 × r2, and the SVD gives the rotation nearest to [r1 r2 r3] (erratum E33).

    Raises
    ------
    DegenerateError
        A homography is singular.

    References
    ----------
    .. [1] Notes 2b.4, "Estimation of extrinsic parameters".

    Examples
    --------
    >>> extrinsics(np.eye(3), -7 * np.diag([1.0, 1, 2]))[:3, 3] + 0.0
    array([0., 0., 2.])
    """
    return poses_of(intrinsic_matrix(A), scaled(matrix(H, "H", 3, 3)))


def poses_of(A: Array, H: Array) -> Array:
    """Give what `extrinsics` gives, without a guard: for use inside."""
    rays = np.linalg.inv(A) @ H  # λ [r1 r2 T]
    lengths = np.sqrt(np.vecdot(rays.mT, rays.mT))
    scale = (lengths[..., 0] + lengths[..., 1]) / 2
    scale = np.where(rays[..., 2, 2] < 0, -scale, scale)
    rays = rays / scale[..., None, None]
    r1, r2 = rays[..., :, 0], rays[..., :, 1]
    G = np.zeros((*H.shape[:-2], 4, 4))
    r3 = (skew_matrix(r1) @ r2[..., None])[..., 0]
    G[..., :3, :3] = nearest_rotation(np.stack([r1, r2, r3], axis=-1))
    G[..., :3, 3], G[..., 3, 3] = rays[..., :, 2], 1
    return G
