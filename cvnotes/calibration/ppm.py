"""The PPM of one picture of a target in space: by the DLT, then refined (notes 2b.4)."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, DegenerateError, ShapeError, paired, points
from cvnotes.homography.refinement import refine_projection
from cvnotes.projective import to_homogeneous
from cvnotes.projective.points import apply_similarity, inverse_similarity, normaliser

# Relative singular value, after normalisation, below which a rank is called deficient.
RANK = 1e-9


def pairs(W: npt.ArrayLike, m: npt.ArrayLike, *, at_least: int) -> tuple[Array, Array]:
    """Guard points W (n, 3) and their pixels m (n, 2)."""
    W, m = _several(W), points(m, "m", 2)
    if m.ndim != 2:
        raise ShapeError(f"m: expected pixels (n, 2) of one picture, got {m.shape}")
    paired(W, m, ("W", "m"), at_least=at_least)
    return W, m


def refuse_flat(W: Array, m: Array) -> None:
    """Refuse normalised points that span no space, or no picture, and say what they span."""
    distinct = len(np.unique(W.round(9), axis=0))
    if distinct < 6:
        raise DegenerateError(
            f"W has only {distinct} distinct points (duplicates); the PPM needs 6"
        )
    s = np.linalg.svd(W, compute_uv=False)
    if s[1] <= RANK * s[0]:
        raise DegenerateError("all points of W are collinear; the PPM needs points in space")
    if s[2] <= RANK * s[0]:
        raise DegenerateError(
            "all points of W are coplanar: one picture of a plane gives a homography but not P; "
            "use a target of two planes, or several views of the plane (calibrate)"
        )
    s = np.linalg.svd(m, compute_uv=False)
    if s[1] <= RANK * s[0]:
        raise DegenerateError("all pixels of m lie on a line: they show the target edge-on")


def _several(W: npt.ArrayLike) -> Array:
    W = points(W, "W", 3)
    if W.ndim != 2 or not len(W):
        raise ShapeError(f"W: expected points (n, 3) of one picture, got {W.shape}")
    return W


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
    N1, N2 = normaliser.inside(W), normaliser.inside(m)
    W, m = apply_similarity(N1, W), apply_similarity(N2, m)
    refuse_flat(W, m)
    _, s, Vt = np.linalg.svd(_design_matrix(W, m), full_matrices=False)
    if s[10] <= RANK * s[0]:
        raise DegenerateError(
            "these points leave P open although they are not in one plane: all but one lie in a "
            "plane, or they lie on a curve that passes through the camera; spread them in depth"
        )
    P = Vt[11].reshape(3, 4)
    P = P if P[2, 3] > 0 else -P  # the third coordinate of the centroid
    P = inverse_similarity(N2) @ P @ N1
    return np.asarray(P / np.linalg.norm(P))


def _design_matrix(W: Array, m: Array) -> Array:
    """Return D (2n, 12) of D p = 0, two rows for each point, p = the rows of P stacked.

    m̃ × P W̃ = 0 has three rows, of which two suffice, as for a homography:
    [0ᵀ, −W̃ᵀ, v W̃ᵀ] and [W̃ᵀ, 0ᵀ, −u W̃ᵀ].
    """
    W_h = to_homogeneous(W)
    D = np.zeros((len(W), 2, 3, 4))
    D[:, 0, 1], D[:, 0, 2] = -W_h, m[:, 1:] * W_h
    D[:, 1, 0], D[:, 1, 2] = W_h, -m[:, :1] * W_h
    return D.reshape(-1, 12)


def resect(W: npt.ArrayLike, m: npt.ArrayLike) -> Array:
    """Estimate P (3, 4) from points W (n, 3) and their pixels m (n, 2): DLT, then refinement.

    The refinement minimises the geometric error Σ ‖m − π(P W̃)‖².

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
    >>> from cvnotes.camera import Camera, decompose, intrinsics
    >>> from cvnotes.camera import look_at
    >>> from cvnotes.targets import TwoPlanes
    >>> target = TwoPlanes()
    >>> camera = Camera(intrinsics(800, 805, 320, 240), look_at([500, 0, -700], [100, 60, -80]))
    >>> A, R, T = decompose(resect(target.points, camera.project(target.points)))
    >>> A.round(6) + 0.0
    array([[800.,   0., 320.],
           [  0., 805., 240.],
           [  0.,   0.,   1.]])
    """
    P = ppm_dlt(W, m)
    W, m = pairs(W, m, at_least=6)
    N1, N2 = normaliser.inside(W), normaliser.inside(m)
    W_h, m = to_homogeneous.inside(apply_similarity(N1, W)), apply_similarity(N2, m)
    start = N2 @ (P / np.abs(P).max()) @ inverse_similarity(N1)
    P = inverse_similarity(N2) @ refine_projection(start, W_h, m) @ N1
    return np.asarray(P / np.linalg.norm(P))
