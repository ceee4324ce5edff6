"""Error bars that hold when the model is not exact: the jackknife over views.

The classical covariance believes that residuals are noise, independent from corner to corner. A
board that is bent, a lens that needs more terms or a blur that differs from view to view moves
many corners of a view together, and then it promises two or three times too much. What is nearly
independent are whole views: each is left out in turn, and the scatter of the cameras shows how well
the camera is known.
"""

from dataclasses import dataclass, replace

import numpy as np

from cvnotes.base import Array, DegenerateError, chunks, solved
from cvnotes.calibration.board_shape import BoardShape, with_shape
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.jacobian import jacobian
from cvnotes.calibration.refinement import RIDGE, Problem, State, covariance, solve_by_schur
from cvnotes.camera import Camera

_NUMBERS = 100_000  # in an array at a time: they then stay in the cache
_SINGULAR = 1e-13  # smallest squared pivot of a normal matrix with a diagonal of 1
_WHY = "a view does not determine its own pose"


def covariance_over_views(
    camera: Camera,
    names: tuple[str, ...],
    data: Correspondences,
    poses: Array,
    shape: BoardShape | None = None,
) -> Array:
    """Estimate the covariance (q, q) of a camera's parameters from the scatter between its views.

    Parameters
    ----------
    camera : Camera
        As it was estimated, together with the poses (n_views, 4, 4).
    names : tuple of str
        Names of the estimated parameters.
    data : Correspondences
        What they were estimated from.
    shape : BoardShape, optional
        The board, if its shape was estimated too; each time it is estimated anew.

    Returns
    -------
    ndarray, shape (q, q)
        Infinite on its diagonal where the other views do not determine the camera.

    Notes
    -----
    With S_i and g_i the normal matrix and the gradient of view i, its pose eliminated, the camera
    without view i is off by δ_i = (Σ S − S_i)⁻¹ g_i: one Gauss–Newton step, which differs from a
    new refinement by less than a hundredth of the deviation. The covariance is
    (n − 1)/n Σ (δ_i − δ̄)(δ_i − δ̄)ᵀ.

    References
    ----------
    .. [1] B. Efron and C. Stein, The jackknife estimate of variance, Annals of Statistics 9 (1981)
       586-596.
    """
    n, q = len(data), len(names)
    if n - 1 < (3 if "skew" in names else 2):  # so few determine no camera
        return undetermined(q)
    problem = Problem.at(camera, names, data)
    poses, W = data.pose_in_scaled_units(poses), None
    try:
        if shape is not None and data.before is not None:
            problem = with_shape(problem, data.before, shape.kind, shape.hold)
            W = (shape.points - data.centre) / data.scale
        return Influence.of(problem, problem.state(camera, poses, W)).covariance[:q, :q]
    except DegenerateError:
        return undetermined(q)


@dataclass(frozen=True, eq=False)
class Influence:
    """What each view does to what all views determine together.

    Attributes
    ----------
    known : ndarray, shape (q, q)
        Normal matrix of all views together, their poses eliminated.
    without : ndarray, shape (n_views, q)
        By how much the parameters change where a view is left out.
    more : ndarray, shape (n_views,)
        By how much the cost of this view then grows, its pose being fitted again.
    """

    known: Array
    without: Array
    more: Array

    @staticmethod
    def of(problem: Problem, x: State) -> "Influence":
        """Work out the influence of each view at a minimum.

        Where the corners of a free board are eliminated first, on the camera alone.
        """
        if problem.model.cancelling:  # whose valley would be walked along without an end
            problem = replace(problem, ridge=RIDGE)
        if problem.corners_first:
            return _one_by_one(problem, x)
        return Influence.between(*eliminated_by_view(problem, x), problem.held)

    @staticmethod
    def between(S: Array, g: Array, held: Array) -> "Influence":
        """Work out the influence of views with these normal matrices and gradients.

        S (n_views, q, q) and g (n_views, q) of each view, its pose eliminated: the others have
        their minimum at δ_i, where it costs 2 g_iᵀ δ_i + δ_iᵀ S_i δ_i more. `held` (q,), on the
        diagonal of all together, belongs to no view.
        """
        d = _without_each(S, g, held)
        S_d = (S @ d[..., None])[..., 0]  # np.matvec is younger than the NumPy of a browser
        return Influence(S.sum(0), d, 2 * np.vecdot(g, d) + np.vecdot(d, S_d))

    @property
    def covariance(self) -> Array:
        """(n − 1)/n Σ (δ_i − δ̄)(δ_i − δ̄)ᵀ, (q, q)."""
        n, d = len(self.without), self.without - self.without.mean(0)
        return np.asarray((n - 1) / n * d.T @ d)


def _one_by_one(problem: Problem, x: State) -> Influence:
    """Take a step without each view in turn, and see what that view costs where it leads."""
    q, n_views = len(problem.names), len(problem.m)
    without, more = np.empty((n_views, q)), np.empty(n_views)
    for i in range(n_views):
        others = np.delete(np.arange(n_views), i)
        _, system = problem.some(others).linearise(x.some(others), corners_first=True)
        (step, _), _ = solve_by_schur(system, 0.0)
        own = slice(i, i + 1)
        J, r = jacobian(problem.some(own), x.some(own))
        J, r = J.reshape(r.size, -1), r.ravel()
        moved = r + J[:, : len(step)] @ step
        of_pose = np.linalg.qr(J[:, len(step) :]).Q.T @ moved
        without[i], more[i] = step[:q], moved @ moved - of_pose @ of_pose - r @ r
    _, system = problem.linearise(x, corners_first=True)
    return Influence(solved(np.linalg.inv, covariance(system), why=_WHY), without, more)


def undetermined(q: int) -> Array:
    """Return the covariance of q parameters of which nothing is known."""
    return np.diag(np.full(q, np.inf))


def eliminated_by_view(problem: Problem, x: State) -> tuple[Array, Array]:
    """Return each view's normal matrix (n_views, q, q) and gradient (n_views, q), without its pose.

    S = U − Bᵀ V⁻¹ B and g = g_shared − Bᵀ V⁻¹ g_pose, where U, B and V are blocks of JᵀJ: shared by
    shared, pose by shared, pose by pose.
    """
    at_a_time = max(1, _NUMBERS // (problem.m[0].size * (len(x.shared) + 6)))
    views = chunks(len(problem.m), at_a_time)
    of_parts = [_eliminated(problem.some(part), x.some(part)) for part in views]
    S, g = (np.concatenate(each) for each in zip(*of_parts, strict=True))
    return S, g


def _eliminated(problem: Problem, x: State) -> tuple[Array, Array]:
    J, r = jacobian(problem, x)
    n, q = len(J), len(x.shared)  # with the coefficients of the board's shape, if there are any
    J, r = J.reshape(n, -1, q + 6), r.reshape(n, -1, 1)
    N, g = J.mT @ J, J.mT @ r
    B, V = N[:, q:, :q], N[:, q:, q:]
    inner = solved(np.linalg.solve, V, np.concatenate([B, g[:, q:]], axis=-1), why=_WHY)
    S = N[:, :q, :q] - B.mT @ inner[..., :-1]
    return S, (g[:, :q] - B.mT @ inner[..., -1:])[..., 0]


def _without_each(S: Array, g: Array, held: Array) -> Array:
    """Solve (Σ S − S_i) δ_i = g_i for all views; (n_views, q).

    What holds parameters near zero, on the diagonal, stays when a view goes.
    """
    whole, d = S.sum(0) + np.diag(held), np.empty_like(g)
    for part in chunks(len(S), max(1, _NUMBERS // whole.size)):
        d[part] = _without(whole - S[part], g[part])
    return d


def _without(left: Array, g: Array) -> Array:
    """Solve left_i δ_i = g_i, unless one of them is singular."""
    diagonal = np.diagonal(left, axis1=1, axis2=2)
    if not (diagonal > 0).all():
        raise DegenerateError(_WHY)
    scale = np.sqrt(diagonal)
    left = left / (scale[:, :, None] * scale[:, None])
    # (pivots, as eigenvalues of 160 unknowns for each view would take longer than all the rest)
    pivots = np.diagonal(solved(np.linalg.cholesky, left, why=_WHY), axis1=1, axis2=2) ** 2
    if not (pivots > _SINGULAR).all():
        raise DegenerateError(_WHY)
    d = solved(np.linalg.solve, left, (g / scale)[..., None], why=_WHY)[..., 0]
    return np.asarray(d / scale)
