"""The problem: which parameters are sought, and how the corners depend on them."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, ConvergenceError, Minimum, chunks, levenberg_marquardt
from cvnotes.calibration.arrow import Arrow, solve_arrow
from cvnotes.camera import Lens, px_from_xy, rotation_from_vector
from cvnotes.camera.lens_fold import horner, radial_factor

# Views worked on at a time: their arrays of one number per point then stay in the cache.
_CHUNK = 128


class State(NamedTuple):
    """Where the optimiser stands: the shared parameters and the pose of each view."""

    shared: Array  # (q,), in the order of Problem.names
    R: Array  # (n_views, 3, 3)
    T: Array  # (n_views, 3)


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
    seen: npt.NDArray[np.bool_] | None = None
    skew: bool = False
    n_radial: int = 2
    tangential: bool = False
    names: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        names = ["alpha_u", "alpha_v", *["skew"] * self.skew, "u0", "v0"]
        names += [f"k{i}" for i in range(1, self.n_radial + 1)]
        names += ["p1", "p2"] * self.tangential
        object.__setattr__(self, "names", tuple(names))

    @property
    def n_seen(self) -> int:
        """How many points were seen, over all views."""
        return self.m[..., 0].size if self.seen is None else int(self.seen.sum())

    @property
    def n_seen_by_view(self) -> Array:
        """How many points were seen in each view."""
        n_views, n = self.m.shape[:2]
        return np.full(n_views, float(n)) if self.seen is None else self.seen.sum(1, dtype=float)

    def some(self, views: npt.NDArray[np.intp]) -> "Problem":
        """Keep some of the views."""
        W = self.W if self.W.ndim == 2 else self.W[views]
        seen = None if self.seen is None else self.seen[views]
        return replace(self, W=W, m=self.m[views], seen=seen)

    def state(self, A: Array, lens: Lens, poses: Array) -> State:
        """Give the state that stands for a camera and its poses (n_views, 4, 4)."""
        shared = [A[0, 0], A[1, 1], *[A[0, 1]] * self.skew, A[0, 2], A[1, 2]]
        shared += [*lens.k, *[0.0] * self.n_radial][: self.n_radial]
        shared += [*lens.p] * self.tangential
        return State(np.array(shared), poses[:, :3, :3], poses[:, :3, 3])

    def camera_of(self, shared: Array) -> tuple[Array, Lens]:
        """Give A and the lens that the shared parameters stand for."""
        value = dict(zip(self.names, shared.tolist(), strict=True))
        top = [value["alpha_u"], value.get("skew", 0.0), value["u0"]]
        A = np.array([top, [0, value["alpha_v"], value["v0"]], [0, 0, 1]])
        k = tuple(value[f"k{i}"] for i in range(1, self.n_radial + 1))
        return A, Lens(k=k, p=(value.get("p1", 0.0), value.get("p2", 0.0)))

    def linearise(self, x: State) -> tuple[float, Arrow]:
        """Give the cost and the normal equations at x."""
        q, n_views = len(x.shared), len(self.m)
        normal, costs = np.empty((n_views, q + 7, q + 6)), np.empty(n_views)
        for part in chunks(n_views, _CHUNK):
            u, v = self._jacobian(x, part).transpose(1, 2, 0, 3)
            # Two factors of different shape: for J Jᵀ with itself NumPy takes a slower road.
            np.matmul(u, u[:, :-1].mT, out=normal[part])
            normal[part] += v @ v[:, :-1].mT
            costs[part] = np.vecdot(u[:, -1], u[:, -1]) + np.vecdot(v[:, -1], v[:, -1])
        by_shared = normal[..., :q].sum(0)
        arrow = Arrow(
            by_shared[:q],
            normal[:, q:-1, :q],
            normal[:, q:-1, q:],
            by_shared[-1],
            normal[:, -1, q:],
            costs,
        )
        return float(costs.sum()), arrow

    def predicted(self, A: Array, lens: Lens, x: State) -> Array:
        """Where the camera shows the points, (n_views, n, 2); NaN where the lens folds."""
        M = self.W @ x.R.mT + x.T[:, None]
        return px_from_xy.inside(A, lens.distort(M[..., :2] / M[..., 2:]))

    def jacobian(self, x: State) -> tuple[Array, Array]:
        """Give J and r (predicted minus observed) of each view, for whoever wants to check them.

        J is (n_views, n, 2, q + 6): the shared parameters, then ω and T; r is (n_views, n, 2).
        """
        views = (slice(i, i + 1) for i in range(len(self.m)))
        both = np.concatenate([self._jacobian(x, i).transpose(2, 3, 1, 0).copy() for i in views])
        return both[..., :-1], both[..., -1]

    @cached_property
    def _by_coordinate(self) -> tuple[Array, Array]:
        """W and m with the coordinates before the points, so that each is one run of memory."""
        return np.ascontiguousarray(self.W.mT), np.ascontiguousarray(self.m.transpose(2, 0, 1))

    @cached_property
    def _workspace(self) -> Array:
        """Room for [J r]ᵀ of a chunk of views, with the entries that never change."""
        n_views, n = self.m.shape[:2]
        J = np.zeros((len(self.names) + 7, 2, min(_CHUNK, n_views), n))
        J[self.names.index("u0"), 0] = J[self.names.index("v0"), 1] = 1
        return J

    def _jacobian(self, x: State, part: slice) -> Array:
        """Give [J r]ᵀ of some views, (q + 7, 2, views, n), until it is asked for others.

        One row for each parameter, then r.

        The residual is m̂ − m. The pose moves as R ← exp(ω) R, T ← T + dT, so a point moves by
        dM = ω × (R W) + dT. Coordinates stand before views and points, so that each operation
        below runs through one piece of memory.
        """
        q, first = len(x.shared), 4 + self.skew  # where the pose and the lens begin
        alpha, centre = x.shared[:2, None, None], x.shared[first - 2 : first, None, None]
        skew = x.shared[2] if self.skew else 0.0
        k = x.shared[first : first + self.n_radial].tolist()
        W, m = self._by_coordinate
        m = m[:, part]
        J = self._workspace[:, :, : m.shape[1]]
        by_lens, by_omega, by_T, residual = J[first:q], J[q : q + 3], J[q + 3 : -1], J[-1]

        # 1. into the CRF, 2. divided by z
        R, T = x.R[part], x.T[part].T[..., None]
        RW = R.transpose(1, 0, 2) @ W if W.ndim == 2 else (R @ W[part]).transpose(1, 0, 2).copy()
        M = RW + T
        over_z = 1 / M[2]
        xy = M[:2] * over_z
        X, Y = xy

        # 3. the lens: d(x', y') by its coefficients, and D = d(x', y')/d(x, y), which is
        # symmetric: D11, D12, D22
        products = np.empty((3, *X.shape))
        np.multiply(xy, X, out=products[:2])
        np.multiply(Y, Y, out=products[2])
        r2 = products[0] + products[2]
        power = xy
        for i in range(self.n_radial):
            power = np.multiply(power, r2, out=by_lens[i])
        L, slope = radial_factor(k, r2), horner([2 * i * ki for i, ki in enumerate(k, 1)], r2)
        xy_lens = L * xy
        D = slope * products
        D[::2] += L
        if self.tangential:
            p1, p2 = x.shared[-2:].tolist()
            by_p1, by_p2 = by_lens[-2:]
            np.multiply(2, products[1:], out=by_p1)
            np.multiply(2, products[:2], out=by_p2)
            by_p1[1] += r2
            by_p2[0] += r2
            xy_lens += p1 * by_p1 + p2 * by_p2
            by_xy = np.array([[6 * p2, 2 * p1], [2 * p1, 2 * p2], [2 * p2, 6 * p1]])
            D += (by_xy @ xy.reshape(2, -1)).reshape(D.shape)

        # 4. the sensor turns x', y' and all their derivatives into pixels
        J[0, 0], J[1, 1] = xy_lens
        np.multiply(alpha, xy_lens, out=residual)
        residual += centre
        residual -= m
        if self.skew:
            J[2, 0] = xy_lens[1]
            residual[0] += skew * xy_lens[1]
            by_lens[:, 0] += (skew / alpha[0]) * by_lens[:, 1]
        by_lens *= alpha

        # and the pose: by T, where dT acts on x and y through 1/z, then by ω, where dM = ω × R W
        by_X, by_Y, by_Z = by_T
        alpha_over_z = alpha * over_z
        np.multiply(alpha_over_z, D[:2], out=by_X)
        np.multiply(alpha_over_z, D[1:], out=by_Y)
        if self.skew:
            by_X[0] += skew * over_z * D[1]
            by_Y[0] += skew * over_z * D[2]
        np.negative(X * by_X + Y * by_Y, out=by_Z)
        np.subtract(RW[1] * by_Z, RW[2] * by_Y, out=by_omega[0])
        np.subtract(RW[2] * by_X, RW[0] * by_Z, out=by_omega[1])
        np.subtract(RW[0] * by_Y, RW[1] * by_X, out=by_omega[2])
        return J if self.seen is None else J * self.seen[part]


# Squared pixels per coordinate that rounding alone may leave.
_ROUNDING = 1e-25


def minimise(problem: Problem, start: State, *, tolerance: float = 1e-12) -> Minimum[State, Arrow]:
    """Minimise the reprojection error from a start, by Levenberg–Marquardt.

    Raises
    ------
    DegenerateError
        The views do not determine the parameters.
    ConvergenceError
        The minimum is no camera: a focal length or the depth of a board is not positive.

    References
    ----------
    .. [1] Notes 2b.4, "Refinement by non-linear optimization".
    .. [2] Triggs et al., Bundle adjustment: a modern synthesis (2000), section 6.
    """
    floor = _ROUNDING * problem.m.size
    found = levenberg_marquardt(
        start,
        problem.linearise,
        solve_arrow,
        take_step,
        follow=poses_follow,
        tolerance=tolerance,
        floor=floor,
    )
    if found.x.shared[:2].min() <= 0 or found.x.T[:, 2].min() <= 0:
        raise ConvergenceError(
            "the refinement left the space of cameras (a focal length or the depth of a board is "
            "not positive); the corners are probably paired with the wrong points of the board"
        )
    return found


def take_step(x: State, step: tuple[Array, Array]) -> State:
    """Take a step: R ← exp(ω) R, everything else by addition."""
    shared, poses = step
    return State(
        x.shared + shared, rotation_from_vector.inside(poses[:, :3]) @ x.R, x.T + poses[:, 3:]
    )


def poses_follow(x: State, system: Arrow) -> State:
    """Take a step of the poses alone, the camera being held."""
    try:
        step = np.linalg.solve(system.poses, system.g_poses[..., None])[..., 0]
    except np.linalg.LinAlgError:  # too far away to be brought back
        return x
    return take_step(x, (np.zeros_like(x.shared), np.asarray(-step)))
