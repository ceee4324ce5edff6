"""P refined until the pixels are as close as they can be, and the whole way to it."""

import numpy as np
import numpy.typing as npt

from cvnotes import homography
from cvnotes.errors import Array, DegenerateError, matrix
from cvnotes.optimise import levenberg_marquardt, solve_dense
from cvnotes.projective import apply, drop, to_homogeneous
from cvnotes.resection.ppm.given import normaliser, pairs, refuse_flat
from cvnotes.resection.ppm.linear import ppm_dlt


def refine_ppm(P: npt.ArrayLike, W: npt.ArrayLike, m: npt.ArrayLike) -> Array:
    """Refine P by minimising the geometric error Σ ‖m − π(P W̃)‖².

    Parameters
    ----------
    P : array_like, shape (3, 4)
        The start, for example from `ppm_dlt`; of any scale.
    W, m : array_like, shape (n, 3) and (n, 2)
        At least 6 points and their pixels.

    Returns
    -------
    ndarray, shape (3, 4)
        The refined P, ‖P‖ = 1, with the sign of the start.

    Raises
    ------
    DegenerateError
        The points leave P open.

    Notes
    -----
    Levenberg–Marquardt on all twelve entries, in normalised coordinates. P itself is a direction
    in which nothing changes, so p pᵀ is added to JᵀJ and the step stays perpendicular to p. The
    pixels' normalisation only scales the error, so the minimum is the one in pixels.

    References
    ----------
    .. [1] Notes 2b.4, "Refinement by non-linear optimization".
    .. [2] Hartley and Zisserman, Multiple View Geometry, 2nd ed. (2004), 7.2.

    Examples
    --------
    >>> from cvnotes.targets import Chessboard, TwoPlanes
    >>> W = TwoPlanes(Chessboard((3, 2), 10.0)).points
    >>> truth = np.array([[8, 0, 3, 400], [0, 8, 2, 300], [0, 0, 0.01, 1]])
    >>> m_h = W @ truth[:, :3].T + truth[:, 3]
    >>> P = refine_ppm(truth + 0.001, W, m_h[:, :2] / m_h[:, 2:])
    >>> np.allclose(P / P[2, 3], truth, atol=1e-9)
    True
    """
    P = matrix(P, "P", 3, 4)
    W, m = pairs(W, m, at_least=6)
    if P.ndim != 2 or not P.any():
        raise DegenerateError("P must be one non-zero (3, 4) matrix")
    N1, N2 = normaliser(W), homography.normaliser(m)
    W_h, m = to_homogeneous(apply(N1, W)), apply(N2, m)
    refuse_flat(W_h[:, :3], m)
    n = len(W_h)

    def linearise(p: Array) -> tuple[float, Array]:
        m_h = W_h @ p.reshape(3, 4).T
        predicted = drop(m_h)
        J = np.zeros((n, 2, 13))
        J[:, 0, 0:4] = J[:, 1, 4:8] = W_h / m_h[:, 2:]
        J[:, :, 8:12] = -predicted[:, :, None] * J[:, :1, 0:4]
        J[:, :, 12] = predicted - m
        J = J.reshape(2 * n, 13)
        system = J.T @ J
        cost = float(system[12, 12])
        system[:12, :12] += np.outer(p, p)
        return cost, system

    def move(p: Array, step: Array) -> Array:
        return np.asarray((p + step) / np.linalg.norm(p + step))

    start = (N2 @ (P / np.abs(P).max()) @ np.linalg.inv(N1)).ravel()
    start /= np.linalg.norm(start)
    with np.errstate(all="ignore"):  # from a senseless start; no step is then found
        p = levenberg_marquardt(start, linearise, solve_dense, move, floor=1e-28 * n).x
    P = np.linalg.solve(N2, p.reshape(3, 4) @ N1)
    return np.asarray(P / np.linalg.norm(P))


def resect(W: npt.ArrayLike, m: npt.ArrayLike) -> Array:
    """Estimate P (3, 4) from points W (n, 3) and their pixels m (n, 2): DLT, then refinement.

    Examples
    --------
    >>> from cvnotes.camera import Camera, decompose, intrinsics
    >>> from cvnotes.rigid import look_at
    >>> from cvnotes.targets import TwoPlanes
    >>> target = TwoPlanes()
    >>> camera = Camera(intrinsics(800, 805, 320, 240), look_at([500, 0, -700], [100, 60, -80]))
    >>> A, R, T = decompose(resect(target.points, camera.project(target.points)))
    >>> A.round(6) + 0.0
    array([[800.,   0., 320.],
           [  0., 805., 240.],
           [  0.,   0.,   1.]])
    """
    return refine_ppm(ppm_dlt(W, m), W, m)
