"""Slips that several exercises share, as functions."""

from cvnotes.base import Array


def centre_divided_too(A: Array, M: Array) -> Array:
    """Add (u0, v0) before the division by z, to points M (..., 3) of the camera's frame.

    Examples
    --------
    >>> import numpy as np
    >>> centre_divided_too(np.array([[2.0, 0, 10], [0, 2, 20], [0, 0, 1]]), np.array([1.0, 1, 2]))
    array([ 6., 11.])
    """
    return (M[..., :2] @ A[:2, :2].T + A[:2, 2]) / M[..., 2:]
