"""A projection matrix taken apart (notes 2b.2)."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, ShapeError, matrix


def decompose(P: npt.ArrayLike) -> tuple[Array, Array, Array]:
    """Take a projection matrix apart: P ≈ A [R|T].

    Parameters
    ----------
    P : array_like, shape (3, 4)
        A projection matrix, of any scale and sign.

    Returns
    -------
    A : ndarray, shape (3, 3)
        Intrinsic matrix with positive focal lengths and A[2, 2] = 1.
    R : ndarray, shape (3, 3)
        Rotation with determinant +1.
    T : ndarray, shape (3,)
        Translation.

    Raises
    ------
    DegenerateError
        The left 3×3 block is singular: the camera is at infinity, or P has too low a rank.

    Notes
    -----
    The left block is A R up to scale. Its RQ decomposition is the QR decomposition of the
    block read backwards; signs are moved so that the diagonal of A is positive.

    References
    ----------
    .. [1] Notes 2b.2, "Rigid motion".
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 6.2.4.

    Examples
    --------
    >>> from cvnotes.camera import Camera, intrinsics
    >>> camera = Camera(intrinsics(800, 805, 320, 240))
    >>> np.allclose(decompose(-3 * camera.P)[0], camera.A)
    True
    """
    P = matrix(P, "P", 3, 4)
    largest = np.abs(P).max(initial=0.0)
    if P.ndim != 2 or largest == 0:
        raise DegenerateError("P must be one non-zero (3, 4) matrix")
    P = P / largest
    s = np.linalg.svd(P[:, :3], compute_uv=False)
    if s[2] <= 1e-13 * s[0]:
        raise DegenerateError(
            "the left 3×3 block of P is singular: its camera is at infinity (affine), "
            "or the rank of P is below 3"
        )
    if np.linalg.det(P[:, :3]) < 0:
        P = -P
    Q, U = np.linalg.qr(P[::-1, :3].T)
    A, R = U.T[::-1, ::-1], Q.T[::-1]
    signs = np.sign(np.diag(A))
    A, R = A * signs, signs[:, None] * R
    T = np.linalg.solve(A, P[:, 3])
    return np.triu(A / A[2, 2]), R, T


def centre_of(P: npt.ArrayLike) -> Array:
    """Return the camera centre as the null vector of P, homogeneous (4,).

    Also defined for cameras at infinity, whose centre has a zero last coordinate.

    Raises
    ------
    DegenerateError
        P has rank below 3, so that more than a point has no image.

    Examples
    --------
    >>> centre_of(np.eye(3, 4))
    array([0., 0., 0., 1.])
    """
    P = matrix(P, "P", 3, 4)
    if P.ndim != 2:
        raise ShapeError(f"P: expected one (3, 4) matrix, got {P.shape}")
    _, s, Vt = np.linalg.svd(P)
    if s[2] <= 1e-13 * s[0]:
        raise DegenerateError("P has rank below 3: it has no single centre")
    C = Vt[3]
    sign = C[3] if abs(C[3]) > 1e-14 else C[np.argmax(np.abs(C))]
    return np.asarray(C * np.sign(sign)) + 0.0
