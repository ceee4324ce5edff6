"""P by the direct linear transform: k m̃ = P W̃ is linear in the entries of P."""

import numpy as np
import numpy.typing as npt

from cvnotes import homography
from cvnotes.errors import Array, DegenerateError
from cvnotes.projective import apply, to_homogeneous
from cvnotes.resection.ppm.given import RANK, normaliser, pairs, refuse_flat


def ppm_design_matrix(W: npt.ArrayLike, m: npt.ArrayLike) -> Array:
    """Give D (2n, 12) of D p = 0, two rows for each point, p = the rows of P stacked.

    m̃ × P W̃ = 0 has three rows, of which two suffice, as for a homography:
    [0ᵀ, −W̃ᵀ, v W̃ᵀ] and [W̃ᵀ, 0ᵀ, −u W̃ᵀ].

    Examples
    --------
    >>> ppm_design_matrix([[1, 2, 3]], [[4, 5]]).astype(int)
    array([[ 0,  0,  0,  0, -1, -2, -3, -1,  5, 10, 15,  5],
           [ 1,  2,  3,  1,  0,  0,  0,  0, -4, -8, -12, -4]])
    """
    W, m = pairs(W, m, at_least=1)
    W_h = to_homogeneous(W)
    D = np.zeros((len(W), 2, 3, 4))
    D[:, 0, 1], D[:, 0, 2] = -W_h, m[:, 1:] * W_h
    D[:, 1, 0], D[:, 1, 2] = W_h, -m[:, :1] * W_h
    return D.reshape(-1, 12)


def ppm_dlt(W: npt.ArrayLike, m: npt.ArrayLike) -> Array:
    """Estimate P with m ≈ P W by the direct linear transform.

    Parameters
    ----------
    W : array_like, shape (n, 3)
        At least 6 points in the WRF, not all in one plane.
    m : array_like, shape (n, 2)
        The same points in the picture, in pixels.

    Returns
    -------
    ndarray, shape (3, 4)
        P with ‖P‖ = 1 and the sign that gives the points positive third coordinates, as points
        in front of a camera have.

    Raises
    ------
    DegenerateError
        The points leave P open; the message names the configuration.

    Notes
    -----
    Minimises the algebraic error ‖D p‖ with ‖p‖ = 1 in normalised coordinates: p is the right
    singular vector of D of the smallest singular value, P = N₂⁻¹ P̂ N₁.

    References
    ----------
    .. [1] Notes 2b.4, "Calibration Targets".
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), algorithm 7.1.

    Examples
    --------
    >>> from cvnotes.targets import Chessboard, TwoPlanes
    >>> W = TwoPlanes(Chessboard((3, 2), 10.0)).points
    >>> truth = np.array([[8, 0, 3, 400], [0, 8, 2, 300], [0, 0, 0.01, 1]])
    >>> m_h = W @ truth[:, :3].T + truth[:, 3]
    >>> P = ppm_dlt(W, m_h[:, :2] / m_h[:, 2:])
    >>> (P / P[2, 3]).round(9) + 0.0
    array([[8.e+00, 0.e+00, 3.e+00, 4.e+02],
           [0.e+00, 8.e+00, 2.e+00, 3.e+02],
           [0.e+00, 0.e+00, 1.e-02, 1.e+00]])
    """
    W, m = pairs(W, m, at_least=6)
    N1, N2 = normaliser(W), homography.normaliser(m)
    W, m = apply(N1, W), apply(N2, m)
    refuse_flat(W, m)
    _, s, Vt = np.linalg.svd(ppm_design_matrix(W, m), full_matrices=False)
    if s[10] <= RANK * s[0]:
        raise DegenerateError(
            "these points leave P open although they are not in one plane: all but one lie in a "
            "plane, or they lie on a curve that passes through the camera; spread them in depth"
        )
    P = Vt[11].reshape(3, 4)
    P = P if P[2, 3] > 0 else -P  # the third coordinate of the centroid
    P = np.linalg.solve(N2, P @ N1)
    return np.asarray(P / np.linalg.norm(P))
