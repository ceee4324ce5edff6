"""Maximum likelihood: refine A, the lens and all poses together (notes 2b.4).

Minimises Σ ‖m_ij − m̂(A, k, R_i, T_i, w_j)‖². Each view's residuals depend on the shared
parameters and on that view's own pose only, so the normal matrix has the shape of an arrow: one
6×6 block per view and one border for what is shared. The poses are eliminated block by block
(Schur complement), the small system that is left is solved, and the poses follow from it: the
cost grows linearly with the number of views.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cvnotes.camera import intrinsics
from cvnotes.errors import Array, DegenerateError
from cvnotes.lens import Lens, horner, radial_factor
from cvnotes.optimise import Minimum, levenberg_marquardt
from cvnotes.rigid import exp_so3

# Views worked on at a time: their arrays of one number per point then stay in the cache.
_CHUNK = 64
# Squared pixels per coordinate that rounding alone may leave.
_ROUNDING = 1e-25


class State(NamedTuple):
    """Where the optimiser stands: the shared parameters and the pose of each view."""

    shared: Array  # (q,), in the order of Problem.names
    R: Array  # (n_views, 3, 3)
    T: Array  # (n_views, 3)


class Arrow(NamedTuple):
    """The normal equations, in blocks: JᵀJ and Jᵀr."""

    shared: Array  # (q, q) border corner
    border: Array  # (n_views, 6, q)
    poses: Array  # (n_views, 6, 6)
    g_shared: Array  # (q,)
    g_poses: Array  # (n_views, 6)


@dataclass(frozen=True)
class Problem:
    """Corners seen in several views, and which parameters of the camera are to be estimated.

    Parameters
    ----------
    W : ndarray, shape (n_views, n, 3) or (n, 3)
        Board points. Centre and scale them to about unit size first.
    m : ndarray, shape (n_views, n, 2)
        Where they were seen, in pixels.
    seen : ndarray of bool, shape (n_views, n), or None
        False where a row of `m` is only there to fill up a view with fewer points.
    skew : bool
        Estimate the skew; otherwise it is zero.
    n_radial : int
        Radial coefficients to estimate.
    tangential : bool
        Estimate p1 and p2; otherwise they are zero.
    """

    W: Array
    m: Array
    seen: Array | None = None
    skew: bool = False
    n_radial: int = 2
    tangential: bool = False
    names: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        names = ["alpha_u", "alpha_v", *["skew"] * self.skew, "u0", "v0"]
        # the order of OpenCV, where p1 and p2 stand between k2 and k3
        names += [f"k{i}" for i in range(1, self.n_radial + 1)]
        names += ["p1", "p2"] * self.tangential
        object.__setattr__(self, "names", tuple(names))

    def state(self, A: Array, lens: Lens, poses: Array) -> State:
        """Give the state that stands for a camera and its poses (n_views, 4, 4)."""
        shared = [A[0, 0], A[1, 1], *[A[0, 1]] * self.skew, A[0, 2], A[1, 2]]
        shared += [*lens.k, *[0.0] * self.n_radial][: self.n_radial]
        shared += [*lens.p] * self.tangential
        return State(np.array(shared), poses[:, :3, :3], poses[:, :3, 3])

    def camera_of(self, shared: Array) -> tuple[Array, Lens]:
        """Give A and the lens that the shared parameters stand for."""
        value = dict(zip(self.names, shared.tolist(), strict=True))
        A = intrinsics(
            value["alpha_u"], value["alpha_v"], value["u0"], value["v0"], value.get("skew", 0.0)
        )
        k = tuple(value[f"k{i}"] for i in range(1, self.n_radial + 1))
        return A, Lens(k=k, p=(value.get("p1", 0.0), value.get("p2", 0.0)))

    def linearise(self, x: State) -> tuple[float, Arrow]:
        """Give the cost and the normal equations at x."""
        q, n_views = len(x.shared), len(self.m)
        normal, cost = np.empty((n_views, q + 7, q + 6)), 0.0
        workspace = self._workspace()
        for i in range(0, n_views, _CHUNK):
            part = slice(i, i + _CHUNK)
            J = self._jacobian(x, part, workspace)
            # Two factors of different shape: for J Jᵀ with itself NumPy takes a slower road.
            np.matmul(J, J[:, :-1].mT, out=normal[part])
            cost += float(np.vdot(J[:, -1], J[:, -1]))
        arrow = Arrow(
            normal[:, :q, :q].sum(0),
            normal[:, q:-1, :q],
            normal[:, q:-1, q:],
            normal[:, -1, :q].sum(0),
            normal[:, -1, q:],
        )
        return cost, arrow

    def jacobian(self, x: State) -> tuple[Array, Array]:
        """Give J and r (predicted minus observed) of each view, for whoever wants to check them.

        J is (n_views, 2n, q + 6): the shared parameters, then ω and T; r is (n_views, 2n). Rows
        are all u, then all v.
        """
        parts = [self._jacobian(x, slice(i, i + 1), self._workspace()) for i in range(len(self.m))]
        both = np.concatenate(parts).mT
        return both[..., :-1], both[..., -1]

    @cached_property
    def _by_coordinate(self) -> tuple[Array, Array]:
        """W and m with the coordinates before the points, so that each is one run of memory."""
        return np.ascontiguousarray(self.W.mT), np.ascontiguousarray(self.m.mT)

    def _workspace(self) -> Array:
        """Allocate [J r]ᵀ for a chunk of views, with the entries that never change."""
        J = np.zeros((min(_CHUNK, len(self.m)), len(self.names) + 7, 2, self.m.shape[1]))
        J[:, self.names.index("u0"), 0] = J[:, self.names.index("v0"), 1] = 1
        return J

    def _jacobian(self, x: State, part: slice, workspace: Array) -> Array:
        """Give [J r]ᵀ of some views, (views, q + 7, 2n): one row per parameter, then r.

        The residual is m̂ − m. The pose moves as R ← exp(ω) R, T ← T + dT, so a point moves by
        dM = ω × (R W) + dT.
        """
        W, m = self._by_coordinate
        RW = x.R[part] @ (W if W.ndim == 2 else W[part])
        Yx, Yy, Yz = RW[:, 0], RW[:, 1], RW[:, 2]
        Tx, Ty, Tz = x.T[part].T[..., None]
        over_z = 1 / (Yz + Tz)
        X, Y = (Yx + Tx) * over_z, (Yy + Ty) * over_z  # 2. ideal image point

        value = dict(zip(self.names, x.shared.tolist(), strict=True))
        alpha_u, alpha_v, skew = value["alpha_u"], value["alpha_v"], value.get("skew", 0.0)
        q = len(x.shared)
        J = workspace[: len(X)]
        row = dict(zip(self.names, range(q), strict=True))

        # 3. lens, and its derivatives by its own coefficients
        XX, XY, YY = X * X, X * Y, Y * Y
        r2 = XX + YY
        k = [value[f"k{i}"] for i in range(1, self.n_radial + 1)]
        L = radial_factor(k, r2)
        slope = horner([2 * i * ki for i, ki in enumerate(k, start=1)], r2)
        power_x, power_y = X, Y
        for i in range(1, self.n_radial + 1):
            power_x, power_y = power_x * r2, power_y * r2
            self._lens_row(J[:, row[f"k{i}"]], power_x, power_y, alpha_u, skew, alpha_v)
        x_lens, y_lens = L * X, L * Y
        J11, J12, J22 = L + slope * XX, slope * XY, L + slope * YY
        if self.tangential:
            p1, p2 = value["p1"], value["p2"]
            dx, dy, both = r2 + 2 * XX, r2 + 2 * YY, 2 * XY
            self._lens_row(J[:, row["p1"]], both, dy, alpha_u, skew, alpha_v)
            self._lens_row(J[:, row["p2"]], dx, both, alpha_u, skew, alpha_v)
            x_lens += p1 * both + p2 * dx
            y_lens += p1 * dy + p2 * both
            J11 += 6 * p2 * X + 2 * p1 * Y
            J12 += 2 * (p1 * X + p2 * Y)
            J22 += 2 * p2 * X + 6 * p1 * Y

        # 4. sensor
        J[:, row["alpha_u"], 0], J[:, row["alpha_v"], 1] = x_lens, y_lens
        J[:, -1, 0] = alpha_u * x_lens + (value["u0"] - m[part, 0])
        J[:, -1, 1] = alpha_v * y_lens + (value["v0"] - m[part, 1])
        if self.skew:
            J[:, row["skew"], 0] = y_lens
            J[:, -1, 0] += skew * y_lens

        # 1. pose: the pixel's derivatives by the point in the CRF, then by ω and T
        pixel = ((alpha_u * J11 + skew * J12, alpha_u * J12 + skew * J22),
                 (alpha_v * J12, alpha_v * J22))  # fmt: skip
        for c, (by_x, by_y) in enumerate(pixel):
            gX, gY = by_x * over_z, by_y * over_z
            gZ = X * gX + Y * gY  # minus the derivative by z
            J[:, q, c], J[:, q + 1, c] = -Yy * gZ - Yz * gY, Yz * gX + Yx * gZ
            J[:, q + 2, c] = Yx * gY - Yy * gX
            J[:, q + 3, c], J[:, q + 4, c], J[:, q + 5, c] = gX, gY, -gZ
        if self.seen is not None:
            J = J * self.seen[part, None, None, :]
        return J.reshape(len(J), q + 7, -1)

    @staticmethod
    def _lens_row(
        out: Array, by_x: Array, by_y: Array, alpha_u: float, skew: float, alpha_v: float
    ) -> None:
        """Write the derivative of the pixel by a lens coefficient, from that of (x', y')."""
        out[:, 0] = alpha_u * by_x
        if skew:
            out[:, 0] += skew * by_y
        out[:, 1] = alpha_v * by_y


def minimise(problem: Problem, start: State, *, max_iterations: int = 100) -> Minimum[State, Arrow]:
    """Minimise the reprojection error from a start, by Levenberg–Marquardt.

    Raises
    ------
    DegenerateError
        The views do not determine the parameters.

    References
    ----------
    .. [1] Notes 2b.4, "Refinement by non-linear optimization".
    .. [2] Triggs et al., Bundle adjustment: a modern synthesis (2000), section 6.
    """
    floor = _ROUNDING * problem.m.size
    return levenberg_marquardt(
        start, problem.linearise, solve_arrow, move, max_iterations=max_iterations, floor=floor
    )


def solve_arrow(system: Arrow, damping: float) -> tuple[tuple[Array, Array], float]:
    """Solve the damped normal equations; gives the step (shared, poses) and the predicted gain."""
    poses, shared = _damp(system.poses, damping), _damp(system.shared, damping)
    try:
        # poses⁻¹ [border | gradient] in one go
        right = np.concatenate([system.border, system.g_poses[..., None]], axis=-1)
        solved = np.linalg.solve(poses, right)
        S = shared - np.tensordot(system.border, solved[..., :-1], ([0, 1], [0, 1]))
        g = system.g_shared - np.tensordot(system.border, solved[..., -1], ([0, 1], [0, 1]))
        d_shared = -np.linalg.solve(S, g)
    except np.linalg.LinAlgError:
        raise DegenerateError(_UNDETERMINED) from None
    d_poses = -(solved[..., -1] + solved[..., :-1] @ d_shared)
    gain = -(system.g_shared @ d_shared) - float((system.g_poses * d_poses).sum())
    return (d_shared, d_poses), float(gain)


def move(x: State, step: tuple[Array, Array]) -> State:
    """Take a step: R ← exp(ω) R, everything else by addition."""
    shared, poses = step
    return State(x.shared + shared, exp_so3(poses[:, :3]) @ x.R, x.T + poses[:, 3:])


def covariance(system: Arrow) -> Array:
    """Invert the normal matrix for the shared parameters, (q, q), for noise of 1 px."""
    solved = np.linalg.solve(system.poses, system.border)
    S = system.shared - np.tensordot(system.border, solved, ([0, 1], [0, 1]))
    scale = np.sqrt(np.diagonal(S))
    if not (scale > 0).all():
        raise DegenerateError(_UNDETERMINED)
    try:
        inverse = np.linalg.inv(S / np.outer(scale, scale)) / np.outer(scale, scale)
    except np.linalg.LinAlgError:
        raise DegenerateError(_UNDETERMINED) from None
    return np.asarray((inverse + inverse.T) / 2)


def pose_covariance(system: Arrow, shared: Array) -> Array:
    """Invert the normal matrix for each pose (ω, T), (n_views, 6, 6), for noise of 1 px.

    The uncertainty of the shared parameters, from `covariance`, is included.
    """
    solved = np.linalg.solve(system.poses, system.border)
    return np.asarray(np.linalg.inv(system.poses) + solved @ shared @ solved.mT)


_UNDETERMINED = (
    "the normal equations are singular: these views do not determine every parameter; "
    "add views with the board tilted in other directions"
)


def _damp(N: Array, damping: float) -> Array:
    if not damping:
        return N
    N = N.copy()
    diagonal = np.einsum("...ii->...i", N)
    diagonal *= 1 + damping
    return N
