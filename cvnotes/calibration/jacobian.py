"""The derivative of the refinement, line for line as one derives it (notes 2b.4, "Refinement").

The refinement itself has it in `Problem.linearise`, four times as fast, with its arrays turned
round and its products shared; this is what that is tested against.
"""

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration.refinement import Problem, State
from cvnotes.camera.rigid import skew_matrix


def jacobian(problem: Problem, x: State) -> tuple[Array, Array]:
    """Differentiate the residuals, predicted minus observed pixels, by all that is estimated.

    Parameters
    ----------
    problem : Problem
    x : State
        Where to differentiate.

    Returns
    -------
    J : ndarray, shape (n_views, n, 2, q + 6)
        Of each view's residuals: by the shared parameters, in the order of ``x.shared``, then by
        its own ω and T. 0 in the rows of points that were not seen.
    r : ndarray, shape (n_views, n, 2)
        The residuals in pixels, 0 where none was seen.

    References
    ----------
    .. [1] Notes 2b.4, "Refinement by non-linear optimization".

    Examples
    --------
    A point in the middle of the picture, 10 away: when the board moves by dT to the right, the
    point moves by 800/10 px.

    >>> problem = Problem(np.zeros((1, 3)), np.array([[[320.0, 240]]]), coefficients=())
    >>> x = State(np.array([800.0, 800, 320, 240]), np.eye(3)[None], np.array([[0.0, 0, 10]]))
    >>> J, r = jacobian(problem, x)
    >>> J[0, 0, 0]  # u by alpha_u, alpha_v, u0, v0, then by ω and T
    array([ 0.,  0.,  1.,  0.,  0.,  0.,  0., 80.,  0.,  0.])
    """
    camera, names = problem.camera_of(x.shared), problem.names
    q = len(x.shared)

    # Into the CRF: M = R W + T. A small turn is R ← exp(ω) R = (I + [ω]×) R, so that
    #     dM = R dW + ω × R W + dT,    where ω × R W = −[R W]× ω.
    RW = problem.board(x.shared) @ x.R.mT
    M = RW + x.T[:, None]
    M_by_W, M_by_omega, M_by_T = x.R[:, None], -skew_matrix(RW), np.eye(3)

    # Through the lens: x' = lens(M), by M and by its coefficients c.
    of_lens = camera.lens.derivatives(np.moveaxis(M, -1, 0), problem.coefficients)
    x_lens = np.moveaxis(of_lens[0], 0, -1)
    x_by_M = np.moveaxis(of_lens[1], (0, 1), (-2, -1))
    x_by_c = np.moveaxis(of_lens[2], (1, 0), (-2, -1))

    # Onto the sensor: u = α_u x' + s y' + u0, v = α_v y' + v0, so m = S x' + (u0, v0).
    S, centre = camera.A[:2, :2], camera.A[:2, 2]
    m_by_M = S @ x_by_M
    J = np.zeros((*M.shape[:2], 2, q + 6))
    by = dict(zip(names, np.moveaxis(J, -1, 0), strict=False))
    by["alpha_u"][..., 0], by["alpha_v"][..., 1] = x_lens[..., 0], x_lens[..., 1]
    by["u0"][..., 0] = by["v0"][..., 1] = 1
    if problem.skew:
        by["skew"][..., 0] = x_lens[..., 1]
    J[..., len(names) - len(problem.coefficients) : len(names)] = S @ x_by_c
    J[..., q : q + 3] = m_by_M @ M_by_omega
    J[..., q + 3 :] = m_by_M @ M_by_T

    # The board's own shape moves its points, by Σ c_s shape_s.
    if problem.shape is not None:
        m_by_W = m_by_M @ M_by_W
        J[..., len(names) : q] = np.einsum("vnci,sni->vncs", m_by_W, problem.shape, optimize=True)

    r = x_lens @ S.T + centre - problem.m
    if problem.seen is not None:
        J[~problem.seen] = r[~problem.seen] = 0
    return J, r
