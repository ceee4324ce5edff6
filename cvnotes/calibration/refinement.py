"""Step 5, the refinement: what is sought, how the corners depend on it, and the best of it.

In this order: the parameters; the Jacobian; the normal equations, whose matrix is an
arrow, as each view meets the others only in the camera that they share; Levenberg–Marquardt.
"""

from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    ConvergenceError,
    CvnotesError,
    DegenerateError,
    Minimum,
    chunks,
    flag,
    levenberg_marquardt,
    solved,
)
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.camera import AnyLens, Camera, Lens, rotation_from_vector
from cvnotes.camera.any_lens import LENSES
from cvnotes.camera.model import SENSOR, with_values

# Views worked on at a time: their arrays of one number per point then stay in the cache. (All at
# once, the normal equations of 1,000 views take twice as long; those of 100 do not notice.)
_CHUNK = 128


class State(NamedTuple):
    """Where the optimiser stands: the shared parameters and the pose of each view."""

    shared: Array  # (q,), in the order of Problem.names, then the coefficients of the shape
    R: Array  # (n_views, 3, 3)
    T: Array  # (n_views, 3)

    def some(self, views: npt.NDArray[np.intp] | slice) -> "State":
        """Keep the poses of some of the views."""
        return State(self.shared, self.R[views], self.T[views])


@dataclass(frozen=True, eq=False)
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
    coefficients : tuple of str
        Those of the lens that are to be estimated, one of its ``choices``; the others are zero.
    size : (width, height)
        Size of the pictures.
    model : type
        The class of the lens.
    ridge : float
        Pixels that each coefficient that another may cancel adds to the residuals, per unit; holds
        them near zero.
    shape : ndarray, shape (s, n, 3), or None
        Ways in which the board may differ from W, which then is one (n, 3) for all views: their
        coefficients are estimated with the camera. See `board_shape`.
    bends : int
        How many of these ways, the first ones, are bends; the others are each corner by itself.
    hold : ndarray, shape (s,)
        Pixels that each coefficient of the shape adds, per unit; of all that are no bends alike.
    determined : float, optional
        How many of these coefficients the views determine, and not `hold`; else all.
    """

    W: Array
    m: Array
    seen: npt.NDArray[np.bool_] | None = None
    skew: bool = False
    coefficients: tuple[str, ...] = ("k1", "k2")
    size: tuple[int, int] = (640, 480)
    model: type[AnyLens] = Lens
    ridge: float = 0.0
    shape: Array | None = None
    bends: int = 0
    hold: Array | None = None
    determined: float | None = None
    names: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        names = ["alpha_u", "alpha_v", *["skew"] * self.skew, "u0", "v0"]
        object.__setattr__(self, "names", (*names, *self.coefficients))

    @staticmethod
    def of(data: Correspondences, size: tuple[int, int], lens: Any, skew: bool) -> "Problem":
        """Make the problem of corners, the lens being one of `LENSES`."""
        if not isinstance(lens, str) or lens not in LENSES:
            known = ", ".join(map(repr, LENSES))
            raise CvnotesError(f"lens: expected one of {known}, got {lens!r}")
        model, coefficients = LENSES[lens]
        return Problem(data.W, data.m, data.seen, flag(skew, "skew"), coefficients, size, model)

    @staticmethod
    def at(camera: Camera, names: tuple[str, ...], data: Correspondences) -> "Problem":
        """Make the problem of corners of which such parameters were the answer."""
        coefficients = tuple(name for name in names if name not in SENSOR)
        skew, model = "skew" in names, type(camera.lens)
        return Problem(data.W, data.m, data.seen, skew, coefficients, camera.size, model)

    @property
    def n_seen(self) -> int:
        """How many points were seen, over all views."""
        return self.m[..., 0].size if self.seen is None else int(self.seen.sum())

    @property
    def n_seen_by_view(self) -> Array:
        """How many points were seen in each view."""
        n_views, n = self.m.shape[:2]
        return np.full(n_views, float(n)) if self.seen is None else self.seen.sum(1, dtype=float)

    def some(self, views: npt.NDArray[np.intp] | slice) -> "Problem":
        """Keep some of the views."""
        W = self.W if self.W.ndim == 2 else self.W[views]
        seen = None if self.seen is None else self.seen[views]
        return replace(self, W=W, m=self.m[views], seen=seen)

    @property
    def n_shape(self) -> int:
        """How many coefficients the shape of the board has."""
        return 0 if self.shape is None else len(self.shape)

    @property
    def freedom(self) -> float:
        """How many coordinates were measured beyond those that the parameters need."""
        of_shape = self.n_shape if self.determined is None else self.determined
        return 2 * self.n_seen - len(self.names) - of_shape - 6 * len(self.m)

    def state(self, camera: Camera, poses: Array, W: Array | None = None) -> State:
        """Return the state that stands for a camera, its poses (n_views, 4, 4), and a board."""
        value = camera.parameters
        shared = np.array([value.get(name, 0.0) for name in self.names])
        if self.shape is not None:
            offsets = np.zeros_like(self.W) if W is None else W - self.W
            shared = np.concatenate([shared, np.tensordot(self.shape, offsets, 2)])
        return State(shared, poses[:, :3, :3], poses[:, :3, 3])

    def camera_of(self, shared: Array) -> Camera:
        """Return the camera that the shared parameters stand for; what is not sought is zero."""
        sought = dict(zip(self.names, shared.tolist(), strict=self.shape is None))
        A, lens = with_values(np.eye(3), self.model(), sought)
        return Camera(A, lens=lens, size=self.size)

    @property
    def held(self) -> Array:
        """What holds each shared parameter near zero: squared pixels per unit squared."""
        ridge = [self.ridge**2 * (name in self.model.cancelling) for name in self.names]
        hold = np.zeros(self.n_shape) if self.hold is None else self.hold**2
        return np.concatenate([ridge, hold])

    def board(self, shared: Array) -> Array:
        """Return the board's points: W, and what the coefficients of its shape add."""
        if self.shape is None:
            return self.W
        return self.W + np.tensordot(shared[len(self.names) :], self.shape, 1)

    @property
    def corners_first(self) -> bool:
        """Whether to eliminate the corners of a free board is less work than to eliminate poses."""
        return self.n_shape > 3 * (self.bends + 6 * len(self.m))

    def linearise(
        self, x: State, *, corners_first: bool = False
    ) -> "tuple[float, NormalEquations]":
        """Return the cost and the normal equations at x.

        With the shape's coefficients beside the parameters of the camera; or with the corners kept
        by themselves, where these are free.
        """
        q, n_views = len(self.names), len(self.m)
        normal, costs = np.empty((n_views, q + 7, q + 6)), np.empty(n_views)
        corners = None if self.shape is None else CornerSums(self.shape, q)
        for part in chunks(n_views, _CHUNK):
            J = self._jacobian(x, part)
            if corners:
                corners.add(J, x.R[part])
            u, v = J.transpose(1, 2, 0, 3)
            # Two factors of different shape: for J Jᵀ with itself NumPy takes a slower road.
            np.matmul(u, u[:, :-1].mT, out=normal[part])
            normal[part] += v @ v[:, :-1].mT
            costs[part] = np.vecdot(u[:, -1], u[:, -1]) + np.vecdot(v[:, -1], v[:, -1])
        by_shared = normal[..., :q].sum(0)
        equations = NormalEquations(
            by_shared[:q],
            normal[:, q:-1, :q],
            normal[:, q:-1, q:],
            by_shared[-1],
            normal[:, -1, q:],
            costs,
        )
        cost, held = float(costs.sum()), self.held
        if corners and not corners_first:
            equations = corners.joined(equations)
        if self.ridge or self.shape is not None:
            known = len(equations.g_shared)
            equations.g_shared[:] += (held * x.shared)[:known]
            diagonal = np.einsum("ii->i", equations.shared)
            diagonal += held[:known]
            cost += float(held @ x.shared**2)
        if corners and corners_first:
            equations = corners.first(
                equations, motions(self.W), x.shared[q:], held[q:], self.bends
            )
        return cost, equations

    def residuals(self, camera: Camera, x: State) -> Array:
        """Observed minus predicted pixels (n_views, n, 2): 0 where none was seen.

        NaN where the lens folds.
        """
        W = self.board(x.shared)
        r = self.m - Camera.project.inside(camera, W @ x.R.mT + x.T[:, None])
        return r if self.seen is None else np.where(self.seen[..., None], r, 0.0)

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
        """Return [J r]ᵀ of some views, (q + 7, 2, views, n), until it is asked for others.

        One row for each parameter, then r. `jacobian.jacobian` has the same to be read.

        The residual is m̂ − m. The pose moves as R ← exp(ω) R, T ← T + dT, so a point moves by
        dM = ω × (R W) + dT. Coordinates stand before views and points, so that each operation
        below runs through one piece of memory.
        """
        q, first = len(self.names), 4 + self.skew  # where the pose and the lens begin
        alpha, centre = x.shared[:2, None, None], x.shared[first - 2 : first, None, None]
        skew = x.shared[2] if self.skew else 0.0
        W, m = self._by_coordinate
        if self.shape is not None:
            W = np.ascontiguousarray(self.board(x.shared).T)
        m = m[:, part]
        J = self._workspace[:, :, : m.shape[1]]
        by_lens, by_omega, by_T, residual = J[first:q], J[q : q + 3], J[q + 3 : -1], J[-1]

        # 1. into the CRF
        R, T = x.R[part], x.T[part].T[..., None]
        RW = R.transpose(1, 0, 2) @ W if W.ndim == 2 else (R @ W[part]).transpose(1, 0, 2).copy()
        M = RW + T

        # 2. through the lens
        values = dict(zip(self.coefficients, x.shared[first:q].tolist(), strict=True))
        lens = self.model.unchecked(values)
        xy_lens = lens.derivatives(M, self.coefficients, (by_T.swapaxes(0, 1), by_lens))[0]

        # 3. onto the sensor, which turns x', y' and all their derivatives into pixels
        J[0, 0], J[1, 1] = xy_lens
        np.multiply(alpha, xy_lens, out=residual)
        residual += centre
        residual -= m
        if self.skew:
            J[2, 0] = xy_lens[1]
            residual[0] += skew * xy_lens[1]
            by_lens[:, 0] += skew / alpha[0] * by_lens[:, 1]
            by_T[:, 0] += skew / alpha[0] * by_T[:, 1]
        by_lens *= alpha
        by_T *= alpha

        # and the pose: by T, where dM = dT, and by ω, where dM = ω × R W
        by_X, by_Y, by_Z = by_T
        np.subtract(RW[1] * by_Z, RW[2] * by_Y, out=by_omega[0])
        np.subtract(RW[2] * by_X, RW[0] * by_Z, out=by_omega[1])
        np.subtract(RW[0] * by_Y, RW[1] * by_X, out=by_omega[2])
        return J if self.seen is None else J * self.seen[part]


# Correlation of neighbouring residuals from which on they are no noise; photographs with a lens
# that fits reach 0.3.
CORRELATED = 0.4
_ONLY_ROUNDING = 1e-6  # px, more than rounding leaves


def autocorrelation(residuals: Array, freedom: float) -> float:
    """Return the autocorrelation of residuals (n_views, n, 2) at lag 1: corner and next corner.

    0 where that tells nothing: when there are hardly more measured coordinates than unknowns (the
    difference is `freedom`), or when only rounding errors are left.

    Examples
    --------
    >>> drift = np.linspace(-1, 1, 50).reshape(1, 25, 2)
    >>> autocorrelation(drift, 40) > 0.8
    True
    >>> autocorrelation(drift, 10), autocorrelation(1e-12 * drift, 40)
    (0.0, 0.0)
    """
    r = residuals if np.isfinite(residuals.sum()) else np.nan_to_num(residuals)
    squares = float((r * r).sum())
    if 2 * freedom < r.size or squares < r.size * _ONLY_ROUNDING**2:
        return 0.0
    return float((r[:, 1:] * r[:, :-1]).sum()) / squares


@dataclass(eq=False)
class CornerSums:
    """The part of the normal equations that belongs to the shape of the board.

    A corner that moves by dW on the board moves by R dW before the camera, and no other corner
    does. So sums are taken for each corner by itself, and only then for the ways in which the board
    may differ, `shape` (s, n, 3).
    """

    shape: Array
    q: int  # parameters of the camera
    own: Array | float = 0.0  # (n, 3, 3) corner by corner
    with_camera: Array | float = 0.0  # (q, n, 3)
    gradient: Array | float = 0.0  # (n, 3)
    with_poses: list[Array] = field(default_factory=list)  # (views, 6, n, 3) of each chunk

    def add(self, J: Array, R: Array) -> None:
        """Add views, from the [J r]ᵀ (q + 7, 2, views, n) of their poses."""
        by_corner = np.einsum("tcvn,vtj->jcvn", J[-4:-1], R)
        both = np.einsum("acvn,jcvn->vanj", J, by_corner)
        self.own += np.einsum("icvn,jcvn->nij", by_corner, by_corner)
        self.with_camera += both[:, : self.q].sum(0)
        self.gradient += both[:, -1].sum(0)
        self.with_poses.append(both[:, self.q : -1])

    def joined(self, equations: "NormalEquations") -> "NormalEquations":
        """Put the coefficients of the shape beside the parameters of the camera."""
        s = len(self.shape)
        ways = self.shape.reshape(s, -1).T
        with_camera = np.reshape(self.with_camera, (self.q, -1)) @ ways
        moved = self.shape.transpose(1, 0, 2) @ self.own  # (einsum takes ten times as long)
        own = moved.transpose(1, 0, 2).reshape(s, -1) @ ways
        by_pose = np.concatenate(self.with_poses)
        border = by_pose.reshape(*by_pose.shape[:2], -1) @ ways
        return replace(
            equations,
            shared=np.block([[equations.shared, with_camera], [with_camera.T, own]]),
            border=np.concatenate([equations.border, border], axis=-1),
            g_shared=np.concatenate([equations.g_shared, np.ravel(self.gradient) @ ways]),
        )

    def first(
        self, equations: "NormalEquations", fixed: Array, s: Array, held: Array, bends: int
    ) -> "CornersFirst":
        """Make an arrow whose blocks are the corners; camera, bends and poses are what they share.

        The offset of a corner beside the bends may have no part of the bends, nor of what is
        `fixed` (7, n, 3): each such condition has a multiplier, after the bends. `s` are the
        coefficients of the shape, held back by `held`.
        """
        by_pose = np.concatenate(self.with_poses)
        n, own = len(self.shape[0]), np.asarray(self.own)
        bent, free = self.shape[:bends], self.shape[bends:]
        moved = np.einsum("nij,snj->sni", own, bent)
        conditions = np.concatenate([bent, fixed])
        border = np.concatenate(
            [self.with_camera, moved, conditions, by_pose.reshape(-1, n, 3)]
        ).transpose(1, 2, 0)
        # camera, bends, multipliers, poses: the first and the last are known already
        a, b = self.q + bends, self.q + bends + len(conditions)
        shared = np.zeros((border.shape[-1],) * 2)
        shared[: self.q, : self.q] = equations.shared
        shared[self.q : a] = np.tensordot(bent, border, 2)
        shared[self.q : a, self.q : a] += np.diag(held[:bends])
        shared[self.q : a, a:b] = 0
        for i, (block, with_camera) in enumerate(
            zip(equations.poses, equations.border, strict=True)
        ):
            at = slice(b + 6 * i, b + 6 * i + 6)
            shared[at, at], shared[at, : self.q] = block, with_camera
            shared[: self.q, at] = with_camera.T
        shared[:, self.q : a] = shared[self.q : a].T
        g_bends = np.tensordot(bent, self.gradient, 2) + held[:bends] * s[:bends]
        g = [equations.g_shared, g_bends, np.zeros(len(conditions)), equations.g_poses.ravel()]
        arrow = NormalEquations(
            shared,
            border,
            own + held[-1] * np.eye(3),
            np.concatenate(g),
            self.gradient + held[-1] * np.tensordot(s[bends:], free, 1),
            equations.view_costs,
        )
        blocks = {each.name: getattr(equations, each.name) for each in fields(equations)}
        return CornersFirst(**blocks, arrow=arrow, shape=self.shape, bends=bends)


def motions(W: Array) -> Array:
    """Return the small motions of a board W (n, 3), and its growth, which no view shows: (7, n, 3).

    Shifts, turns, and the scale.
    """
    e = np.eye(3)
    shifts = np.broadcast_to(e[:, None], (3, *W.shape))
    return np.concatenate([shifts, np.cross(e[:, None], W), W[None]])


_UNDETERMINED = (
    "the normal equations are singular: these views do not determine every parameter; "
    "add views with the board tilted in other directions"
)


@dataclass(frozen=True, eq=False)
class NormalEquations:
    """JᵀJ and Jᵀr in blocks: the poses' on the diagonal, bordered by the shared parameters."""

    shared: Array  # (q, q) border corner
    border: Array  # (n_views, 6, q)
    poses: Array  # (n_views, 6, 6)
    g_shared: Array  # (q,)
    g_poses: Array  # (n_views, 6)
    view_costs: Array  # (n_views,) rᵀr of each view

    def damped(self, damping: float) -> "NormalEquations":
        """Multiply the diagonal by 1 + damping."""
        if not damping:
            return self
        return replace(self, shared=_damp(self.shared, damping), poses=_damp(self.poses, damping))

    @cached_property
    def eliminated(self) -> tuple[Array, Array]:
        """V⁻¹ [W g] of each view and Σ Wᵀ V⁻¹ [W g]: pose block V, its border W, gradient g."""
        right = np.concatenate([self.border, self.g_poses[..., None]], axis=-1)
        inner = solved(np.linalg.solve, self.poses, right, why=_UNDETERMINED)
        q = len(self.shared)
        # (in parts, for which OpenBLAS does not call on threads)
        total = sum(
            right[part].reshape(-1, q + 1)[:, :q].T @ inner[part].reshape(-1, q + 1)
            for part in chunks(len(inner), _CHUNK)
        )
        return inner, np.asarray(total)


@dataclass(frozen=True, eq=False)
class CornersFirst(NormalEquations):
    """The same of a board whose corners are free, each of which is a block of an arrow.

    A board of 450 corners has 1,343 coefficients, but camera and poses of 13 views are 90 numbers.
    """

    arrow: NormalEquations
    shape: Array  # (s, n, 3)
    bends: int

    @property
    def _of_bends(self) -> slice:
        return slice(len(self.shared), len(self.shared) + self.bends)

    def step(self, step: tuple[Array, Array], gain: float) -> tuple[tuple[Array, Array], float]:
        """Return the step (shared, poses) that a step of the arrow stands for, and its gain."""
        shared, corners = step
        free = np.tensordot(self.shape[self.bends :], corners, 2)
        of_poses = shared[-self.poses[..., 0].size :].reshape(-1, 6)
        return (np.concatenate([shared[: self._of_bends.stop], free]), of_poses), gain

    @cached_property
    def inverse(self) -> Array:
        """The part of the inverse that belongs to camera, bends, multipliers and poses."""
        S = self.arrow.shared - self.arrow.eliminated[1][:, :-1]
        size = np.abs(np.diagonal(S))  # (of multipliers it is negative, or 0)
        scale = np.sqrt(np.where(size > 0, size, 1.0))
        inverse = solved(np.linalg.inv, S / np.outer(scale, scale), why=_UNDETERMINED)
        return np.asarray((inverse + inverse.T) / 2 / np.outer(scale, scale))

    @cached_property
    def of_shape(self) -> tuple[Array, Array]:
        """What `shape_variances` returns."""
        T, at = -self.arrow.eliminated[0][..., :-1], self._of_bends
        alone = np.diagonal(np.linalg.inv(self.arrow.poses), axis1=1, axis2=2)
        free = alone + np.vecdot(T @ self.inverse, T)
        T[..., at] += self.shape[: self.bends].transpose(1, 2, 0)
        corners = alone + np.vecdot(T @ self.inverse, T)
        n_free = len(self.shape) - self.bends
        mean = np.full(n_free, free.sum() / n_free)
        return np.concatenate([np.diagonal(self.inverse)[at], mean]), corners


# Where a minimisation ended: the state, its cost and its normal equations.
Optimum = Minimum[State, NormalEquations]


def solve_by_schur(system: NormalEquations, damping: float) -> tuple[tuple[Array, Array], float]:
    """Solve the damped normal equations, the poses eliminated by the Schur complement S.

    Gives the step (shared, poses) and the predicted gain.
    """
    if isinstance(system, CornersFirst):
        return system.step(*solve_by_schur(system.arrow, damping))
    system = system.damped(damping)
    inner, from_poses = system.eliminated
    S, g = system.shared - from_poses[:, :-1], from_poses[:, -1] - system.g_shared
    d_shared = solved(np.linalg.solve, S, g, why=_UNDETERMINED)
    d_poses = -(inner[..., -1] + inner[..., :-1] @ d_shared)
    gain = -np.vdot(system.g_shared, d_shared) - np.vdot(system.g_poses, d_poses)
    return (d_shared, d_poses), float(gain)


def covariance(system: NormalEquations) -> Array:
    """Invert the normal matrix for the shared parameters, (q, q), for noise of 1 px.

    Of a board whose corners are kept by themselves, for those of the camera alone.
    """
    if isinstance(system, CornersFirst):
        return system.inverse[: len(system.shared), : len(system.shared)]
    S = system.shared - system.eliminated[1][:, :-1]
    diagonal = np.diagonal(S)
    if not (diagonal > 0).all():
        raise DegenerateError(_UNDETERMINED)
    scale = np.sqrt(diagonal[:, None] * diagonal)
    inverse = solved(np.linalg.inv, S / scale, why=_UNDETERMINED)
    if not (np.diagonal(inverse) > 0).all():  # singular but for rounding: as large as that leaves
        w, V = np.linalg.eigh(S / scale)
        inverse = V / np.maximum(w, np.finfo(float).eps * w.max()) @ V.T
    inverse = inverse / scale
    return np.asarray((inverse + inverse.T) / 2)


def pose_covariance(system: NormalEquations, shared: Array) -> Array:
    """Invert the normal matrix for each pose (ω, T), (n_views, 6, 6), for noise of 1 px.

    The uncertainty of the shared parameters, from `covariance`, is included.
    """
    if isinstance(system, CornersFirst):
        n = 6 * len(system.poses)
        blocks = system.inverse[-n:, -n:].reshape(-1, 6, n // 6, 6)
        return np.moveaxis(np.diagonal(blocks, axis1=0, axis2=2), -1, 0)
    inner = system.eliminated[0][..., :-1]
    alone = solved(np.linalg.inv, system.poses, why=_UNDETERMINED)
    return np.asarray(alone + inner @ shared @ inner.mT)


def shape_variances(problem: Problem, system: NormalEquations) -> tuple[Array, Array]:
    """Variances of the coefficients (s,) of a board's shape, and of its corners (n, 3).

    For noise of 1 px; of free corners each coefficient has the mean of all.
    """
    if isinstance(system, CornersFirst):
        return system.of_shape
    if problem.shape is None:
        return np.zeros(0), np.zeros_like(problem.W)
    first, ways = len(problem.names), problem.shape.reshape(problem.n_shape, -1)
    C = covariance(system)[first:, first:]
    return np.diagonal(C), np.vecdot(ways.T, ways.T @ C).reshape(problem.W.shape)


def _damp(N: Array, damping: float) -> Array:
    N = N.copy()
    diagonal = np.einsum("...ii->...i", N)
    diagonal *= 1 + damping
    return N


# Pixels that a coefficient which another may cancel costs per unit, and how far that sum is
# brought down.
RIDGE, _WITH_RIDGE, _PATIENCE = 0.1, 1e-6, 20
# Squared pixels per coordinate that rounding alone may leave.
_ROUNDING = 1e-25


def minimise(
    problem: Problem,
    start: State,
    *,
    tolerance: float = 1e-12,
    steps: int = 100,
    patience: int | None = None,
) -> Optimum:
    """Minimise the reprojection error from a start, by Levenberg–Marquardt.

    For the numbers see `levenberg_marquardt`; of a lens that has a valley in place of a minimum,
    `patience` says how often its bottom is felt for.

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
    if problem.model.cancelling:
        found = _minimise_in_valley(problem, start, tolerance, patience)
    else:
        found = _descend(problem, start, tolerance, steps=steps)
    # (a wide lens may see a board beside it, and shows it elsewhere than one behind)
    behind = not problem.model.wide and found.x.T[:, 2].min() <= 0
    if found.x.shared[:2].min() <= 0 or behind:
        raise ConvergenceError(
            "the refinement left the space of cameras (a focal length or the depth of a board is "
            "not positive); the corners are probably paired with the wrong points of the board"
        )
    return found


def _descend(
    problem: Problem,
    start: State,
    tolerance: float,
    *,
    steps: int = 100,
    patience: int | None = None,
) -> Optimum:
    return levenberg_marquardt(
        start,
        partial(problem.linearise, corners_first=problem.corners_first),
        solve_by_schur,
        take_step,
        follow=poses_follow,
        max_iterations=steps,
        tolerance=tolerance,
        floor=_ROUNDING * problem.m.size,
        patience=patience,
    )


def _minimise_in_valley(
    problem: Problem, start: State, tolerance: float, patience: int | None
) -> Optimum:
    """Minimise where coefficients nearly cancel each other, as in a quotient.

    Along the valley where they do, noise would carry the coefficients away for ever. A ridge,
    which holds them near zero as if each had been measured with an uncertainty of 1/`RIDGE`, keeps
    them; from there the few steps are taken that lead to the exact answer, if the data have one.
    """
    held = _descend(
        replace(problem, ridge=RIDGE),
        start,
        max(0.1 * tolerance, _WITH_RIDGE),
        steps=400,
        patience=_PATIENCE if patience is None else patience,
    )
    return _descend(problem, held.x, tolerance, patience=patience)


# Of few views, a single wrong pose may bend the camera until it fits; among many it stands out.
FEW_VIEWS = 8


def typical_cost(problem: Problem, found: Optimum) -> float:
    """Return the mean squared distance (px²) of corners from their places.

    Of many views that of the median one: a few may show something else, in no pose at all.
    """
    by_view = found.system.view_costs / problem.n_seen_by_view
    return float(np.median(by_view) if len(by_view) > FEW_VIEWS else found.cost / problem.n_seen)


def take_step(x: State, step: tuple[Array, Array]) -> State:
    """Take a step: R ← exp(ω) R, everything else by addition."""
    shared, poses = step
    return State(
        x.shared + shared, rotation_from_vector.inside(poses[:, :3]) @ x.R, x.T + poses[:, 3:]
    )


def poses_follow(x: State, system: NormalEquations) -> State:
    """Take a step of the poses alone, the camera being held."""
    try:
        step = solved(np.linalg.solve, system.poses, system.g_poses[..., None], why=_UNDETERMINED)
    except DegenerateError:  # too far away to be brought back
        return x
    return take_step(x, (np.zeros_like(x.shared), -step[..., 0]))


def refit_poses(problem: Problem, x: State, steps: int = 10) -> tuple[State, Array]:
    """Fit the poses of views, that are close already, to a camera that is held.

    Gives the sum of squares of each view (n_views,) beside the state.
    """
    _, system = problem.linearise(x)
    with np.errstate(all="ignore"):
        for _ in range(steps):
            tried = poses_follow(x, system)
            _, new = problem.linearise(tried)
            better = new.view_costs < system.view_costs * (1 - 1e-9)
            if not better.any():
                break
            x = State(x.shared, _taken(better, tried.R, x.R), _taken(better, tried.T, x.T))
            blocks = {
                name: _taken(better, getattr(new, name), getattr(system, name))
                for name in ("poses", "g_poses", "view_costs")
            }
            system = replace(system, **blocks)
    return x, system.view_costs


def _taken(views: npt.NDArray[np.bool_], new: Array, old: Array) -> Array:
    return np.where(views.reshape(-1, *[1] * (new.ndim - 1)), new, old)


def refuse_too_few(measured: int, unknowns: int, remedy: str) -> None:
    """Refuse fewer measured coordinates than there are unknowns, or as many."""
    if measured <= unknowns:
        raise DegenerateError(
            f"{measured} measured coordinates cannot determine {unknowns} parameters; {remedy}"
        )
