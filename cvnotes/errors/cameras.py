"""Guards of what a camera is made of: its pose, its intrinsic matrix, the size of its picture."""

from typing import Any

import numpy as np

from cvnotes.errors.arrays import LARGEST, Array, is_masked, matrix
from cvnotes.errors.kinds import CvnotesError, ShapeError

# Four times what a photograph may have; more is a slip, and would hardly fit into the memory.
MOST_PIXELS = 2**28


def rotation(x: Any, name: str = "R") -> Array:
    """Guard a rotation (..., 3, 3): orthonormal to 1e-6 and with determinant +1."""
    R = matrix(x, name, 3, 3)
    deviation = float(np.abs(R @ R.mT - np.eye(3)).max(initial=0.0))
    if deviation > 1e-6:
        raise CvnotesError(
            f"{name} is not orthonormal (R Rᵀ deviates from I by {deviation:.2g}); "
            "rigid.nearest_rotation gives the closest rotation"
        )
    if (np.linalg.det(R) < 0).any():
        raise CvnotesError(f"{name} has det = -1: a reflection, not a rotation")
    return R


def rigid_motion(x: Any, name: str = "G") -> Array:
    """Guard a rigid motion (..., 4, 4) = [R T; 0 1]."""
    G = matrix(x, name, 4, 4)
    if not (G[..., 3, :] == [0, 0, 0, 1]).all():
        raise CvnotesError(f"{name}: the last row of a rigid motion is (0, 0, 0, 1)")
    rotation(G[..., :3, :3], f"the rotation in {name}")
    return G


def intrinsic_matrix(x: Any, name: str = "A") -> Array:
    """Guard an intrinsic matrix: upper triangular, α_u and α_v positive, last entry 1."""
    A = matrix(x, name, 3, 3)
    if A.ndim != 2:
        raise ShapeError(f"{name}: expected one (3, 3) matrix, got {A.shape}")
    for i, j in ((1, 0), (2, 0), (2, 1)):
        if A[i, j] != 0:
            raise CvnotesError(
                f"{name}[{i}, {j}] = {A[i, j]:g} but an intrinsic matrix is upper triangular "
                "(transposed?)"
            )
    if A[2, 2] != 1:
        raise CvnotesError(f"{name}[2, 2] = {A[2, 2]:g} but must be 1; divide {name} by it")
    for i, letter in ((0, "alpha_u"), (1, "alpha_v")):
        if A[i, i] < 1 / LARGEST:
            small = " and not so small" if A[i, i] > 0 else ""
            raise CvnotesError(
                f"{name}[{i}, {i}] = {letter} = {A[i, i]:g} but must be positive{small}"
            )
    return A


def image_size(x: Any, name: str = "size") -> tuple[int, int]:
    """Guard a size in pixels, (width, height), two positive integers.

    Examples
    --------
    >>> image_size([640, 480])
    (640, 480)
    """
    wanted = f"{name}: expected (width, height), two positive whole numbers, got {x!r}"
    if not isinstance(x, list | tuple | np.ndarray) or is_masked(x):
        raise CvnotesError(wanted)
    try:
        width, height = x
        whole = (int(width), int(height))
        exact = whole == (width, height) and not isinstance(width, str | bytes | bool)
    except (TypeError, ValueError, OverflowError):
        raise CvnotesError(wanted) from None
    if not exact or min(whole) < 1 or max(whole) >= 2**31:
        raise CvnotesError(wanted)
    return whole


def target_size(x: Any, name: str = "size") -> tuple[int, int]:
    """Guard the size of a picture that is to be made, and that has to fit into the memory.

    Examples
    --------
    >>> target_size([640, 480])
    (640, 480)
    """
    width, height = image_size(x, name)
    if width * height > MOST_PIXELS:
        raise CvnotesError(f"{name}: a picture of {width} × {height} pixels would be too large")
    return width, height
