"""Where the refinement starts: the steps 1 to 4 as `calibrate` takes them, and what is in reserve.

The plain way is the first start, and nearly always enough: corners as they were seen, and the
focal lengths alone for an A. In reserve, when that leads nowhere, are

1. other A: the full closed form, then four usual fields of view;
2. corners straightened beforehand, for lenses that bend the boards too much for homographies;
3. of many views first a few, which know the camera well enough to place all others;
4. for wide lenses, corners straightened as equidistant lenses of several fields of view would.

A flat board has two poses that look alike: mirrored across the line of sight, a small or distant
board shows nearly the same picture. A refinement that starts with a board in the wrong one seldom
leaves it, and bends the camera instead. So boards for which both poses are in question are turned
over (`best_turned`), everything is refined from there, and what fits better is kept.

Steps see the board centred and scaled to unit size and the picture centred and scaled to [−1, 1].
A student's step gets copies, and what it gives back is looked at before it is used.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import (
    Array,
    ConvergenceError,
    CvnotesError,
    DegenerateError,
    InputTypeError,
    Minimum,
    ShapeError,
    intrinsic_matrix,
    matrix,
    numbers,
    rigid_motion,
)
from cvnotes.calibration.refinement import (
    ALIKE,
    Arrow,
    Problem,
    State,
    likeness,
    minimise,
    poses_follow,
)
from cvnotes.calibration.zhang import (
    constraints,
    extrinsics,
    focal_lengths_from_v,
    intrinsics_from_b,
    radial_distortion,
    solve_b,
)
from cvnotes.camera import Camera, FisheyeLens, Lens, RationalLens, intrinsics, xy_from_px
from cvnotes.camera.model import AnyLens
from cvnotes.homography import dlt, geometric_error

# Strong lenses bend the boards so much that homographies mislead. In reserve, the corners are
# first straightened: x ← x (1 + bend r²), with r = 1 at the ends of the picture's longer axis.
_BENDS = (0.0, 0.2, -0.2)
# Noise and strong lenses can leave no A; then fields of view from 118° to 28° are tried.
_USUAL_FOCAL_LENGTHS = (0.6, 1.0, 2.0, 4.0)
# Radians that the longer side of a wide picture may span, and the steepest ray for a homography.
_FIELDS_OF_VIEW = (1.6, 2.2, 2.8, 1.1, 3.6)
_STEEPEST = 1.4
# The quotient that shows rays up to 75° where an equidistant lens does, to 0.001 of its radius.
_LIKE_EQUIDISTANT = (0.693219, 0.077366, 0.000712, 1.02607, 0.221729, 0.007531)
# Of many views, some say where the camera is; the others only sharpen it.
_MANY_VIEWS, _VIEWS_FOR_START = 150, 16
# RMS over the picture's longer side: a start that leaves more than this is not trusted before the
# others were tried.
_SUSPICIOUS = 0.002
# The same, when the residuals of few views are no noise.
_SYSTEMATIC = 0.0003
# Where lenses are only compared: minima are alike that differ by this part of the cost, and a
# lens is beaten by another that leaves this part of its cost.
_ALIKE, _BEATEN = 1e-3, 0.25
# A student's H is wrong when it puts half of the corners this far off; the picture's width is 2.
_WRONG = 0.25


@dataclass(eq=False)
class Search:
    """The search for the best minimum: the starts one after the other, until one is good.

    Parameters
    ----------
    problem : Problem
        Whose minimum is sought.
    tolerance, patience : float, int
        Of each minimisation, see `levenberg_marquardt`.
    rival : float, optional
        Cost that another lens leaves of the same corners, where lenses are only compared; fewer
        starts then do for a lens that does not fit.
    fisheye : Camera, optional
        What the same views say of a camera with a `FisheyeLens`, for a quotient to start from.
    """

    problem: Problem
    tolerance: float = 1e-12
    patience: int | None = None
    rival: float | None = None
    fisheye: Camera | None = None
    minima: list[Minimum[State, Arrow]] = field(default_factory=list)
    own: list[str] = field(default_factory=list)  # the steps that are the student's
    ends: list[Minimum[State, Arrow]] = field(default_factory=list)  # before boards were turned

    def starts(self) -> "Iterator[Start]":
        """Give the starts, the most robust first, until one has led to a good minimum."""
        for start in self._all_starts():
            yield start
            if self.minima and (self._is_good(self.minima[-1]) or self._is_decided()):
                break

    def _all_starts(self) -> "Iterator[Start]":
        if len(self.problem.m) > _MANY_VIEWS:
            some = np.linspace(0, len(self.problem.m) - 1, _VIEWS_FOR_START).astype(np.intp)
            few = Search(self.problem.some(some), tolerance=1e-6)
            for start in few.starts():
                start.may_fail = True
                yield start
            if few.minima:
                yield resumed(self, few.problem.camera_of(few.best().x.shared))
        if self.problem.model is FisheyeLens:
            yield from (resumed(self, camera) for camera in _wide_cameras(self.problem))
            return
        if self.problem.model is RationalLens and self.fisheye is not None:
            yield resumed(self, as_quotient(self.fisheye, self.problem.m))
        to_px = _px_from_normalised(self.problem.size)
        m = (self.problem.m - to_px[:2, 2]) / to_px[0, 0]
        for bend in _BENDS if self.problem.n_radial else _BENDS[:1]:
            straight = m * (1 + bend * (m * m).sum(-1, keepdims=True)) if bend else m
            for guess in (_focal_lengths_alone, _closed_form, *map(_usual, _USUAL_FOCAL_LENGTHS)):
                yield Start(self, straight, to_px, guess)
                if "intrinsics" in self.own:  # there is no other A
                    break
                if self.problem.model is RationalLens:
                    yield from (resumed(self, camera) for camera in _wide_cameras(self.problem))
                    return

    def keep(self, found: Minimum[State, Arrow]) -> None:
        """Note where a start led, with no board in the wrong pose; from the same end, to the same.

        Where no start is good, many of them end alike, and to turn boards over takes longest.
        """
        known = list(zip(self.ends + self.minima, self.minima + self.minima, strict=True))
        self.ends.append(found)
        self.minima.append(best_turned(self.problem, found, known))

    def _is_good(self, minimum: Minimum[State, Arrow]) -> bool:
        allowed = (_SUSPICIOUS * max(self.problem.size)) ** 2 * self.problem.n_seen
        if not minimum.converged or minimum.cost >= allowed:
            return False
        return len(self.problem.m) > _FEW_VIEWS or not self._is_systematic(minimum)

    def _is_decided(self) -> bool:
        """Tell whether two starts ended alike, where a third would end there too.

        Either in the valley of a quotient, or, for a lens that is only compared with others, where
        its rival is far below: what is left is then the lens's fault, and not that of the start.
        """
        if len(self.minima) < 2:
            return False
        lower, higher = sorted(minimum.cost for minimum in self.minima[-2:])
        beaten = self.rival is not None and self.rival < _BEATEN * lower
        return higher < (1 + _ALIKE) * lower and (beaten or self.problem.model is RationalLens)

    def _is_systematic(self, minimum: Minimum[State, Arrow]) -> bool:
        """Tell whether more than noise is left: few views bend a wrong camera until it fits."""
        if minimum.cost < (_SYSTEMATIC * max(self.problem.size)) ** 2 * self.problem.n_seen:
            return False
        r = self.problem.residuals(self.problem.camera_of(minimum.x.shared), minimum.x)
        return likeness(r, self.problem.freedom) > ALIKE

    def best(self) -> Minimum[State, Arrow]:
        """Give the lowest minimum that was found."""
        if not self.minima:
            yours = f", or your {' and '.join(self.own)} start far from it" if self.own else ""
            raise ConvergenceError(
                "no start leads to a camera: the corners are probably paired with the wrong points "
                f"of the board, or the views do not determine the camera{yours}"
            )
        best = min(self.minima, key=lambda minimum: minimum.cost)
        # A quotient's valley has no bottom that noise would let one find; all starts were tried.
        return replace(best, converged=True) if self.problem.model is RationalLens else best


@dataclass(eq=False)
class Start:
    """One way to start: how the corners are seen, and what the library takes for A.

    Parameters
    ----------
    search : Search
        To which it belongs.
    m : ndarray, shape (n_views, n, 2)
        The corners as steps 1 to 3 see them.
    to_px : ndarray, shape (3, 3)
        Pixels ← where they see them.
    guess : callable
        Step 2 of the library: (V (2n, 6), b (6,)) → A (3, 3).
    lens : Lens, optional
        When it is known already, step 4 is left out, and step 2 too.
    """

    search: Search
    m: Array
    to_px: Array
    guess: Callable[[Array, Array], Array]
    lens: AnyLens | None = None
    may_fail: bool = False

    @property
    def problem(self) -> Problem:
        """What is to be refined."""
        return self.search.problem

    @contextmanager
    def attempt(self) -> Iterator[None]:
        """Pass over errors that only say that this start leads nowhere.

        Views without a homography, or that do not determine the camera, are no matter of the
        start: such errors are raised.
        """
        try:
            yield
        except (ConvergenceError, DegenerateError):
            if not self.may_fail:
                raise

    def homographies(self, step: Callable[..., Any]) -> Array:
        """1. One homography for each view, (n_views, 3, 3)."""
        own = self._is_own(step, dlt, "homography")
        if not own and self.problem.seen is None:
            with suppress(DegenerateError):  # one by one, so that the message names the view
                return dlt.inside(self.problem.W[..., :2], self.m)
        return np.array([self._homography(step, own, i) for i in range(len(self.m))])

    def _homography(self, step: Callable[..., Any], own: bool, i: int) -> Array:
        """Ask for one homography, and look whether it can be one."""
        W, seen = self.problem.W, self.problem.seen
        W = W if W.ndim == 2 else W[i]
        src, dst = (W[:, :2], self.m[i]) if seen is None else (W[seen[i], :2], self.m[i, seen[i]])
        try:
            H = matrix(step(src.copy(), dst.copy()), f"the homography of view {i}", 3, 3)
        except DegenerateError as error:
            raise DegenerateError(f"view {i}: {error}") from error
        if own and not np.median(geometric_error(H, src, dst)) < _WRONG:
            raise CvnotesError(
                f"the homography of view {i} puts the corners far from where they were seen; it "
                "must map the board to the picture, dst ≈ H src: is it transposed, or the inverse?"
            )
        return H

    def intrinsics(self, step: Callable[..., Any] | None, H: Array) -> Array:
        """2. The A (3, 3) that all views share."""
        if self.lens is not None:
            return np.eye(3)
        if self._is_own(step, None, "intrinsics") and step:
            A = intrinsic_matrix(step(H.copy()), "the A of your intrinsics")
            self.may_fail = True
            return A
        V = (constraints if "homography" in self.search.own else constraints.inside)(H)
        b = solve_b.inside(V, skew=self.problem.skew)
        self.may_fail = True
        return self.guess(V, b)

    def extrinsics(self, step: Callable[..., Any], A: Array, H: Array) -> Array:
        """3. The pose of each view, (n_views, 4, 4)."""
        if not self._is_own(step, extrinsics, "extrinsics") and "homography" not in self.search.own:
            return extrinsics.inside(A, H)
        G = rigid_motion(step(A.copy(), H.copy()), "the poses of your extrinsics")
        if G.shape != (len(H), 4, 4):
            raise ShapeError(
                f"the poses of your extrinsics: expected shape {(len(H), 4, 4)}, got {G.shape}"
            )
        if G[:, 2, 3].min() <= 0:
            i = int(G[:, 2, 3].argmin())
            raise CvnotesError(
                f"your extrinsics put the board of view {i} behind the camera; H and −H show the "
                "same picture: take the sign that gives T_z > 0"
            )
        return G

    def distortion(self, step: Callable[..., Any], A: Array, G: Array) -> AnyLens:
        """4. The lens, by linear least squares."""
        if self.lens is not None:
            return self.lens
        # (what is linear in them: of a quotient the first of its coefficients)
        problem, terms = self.problem, min(self.problem.n_radial, 3 if self._is_polynomial else 2)
        k: Array = np.zeros(0)
        if self._is_own(step, radial_distortion, "distortion") and terms:
            copies = (x.copy() for x in (self.to_px @ A, G, problem.W, problem.m))
            k = numbers(step(*copies, terms=terms), "the k of your distortion")
        elif terms:
            k = radial_distortion.inside(self.to_px @ A, G, problem.W, problem.m, terms=terms)
        if k.shape != (terms,):
            raise ShapeError(f"the k of your distortion: expected shape {(terms,)}, got {k.shape}")
        return Lens(k=tuple(k))

    @property
    def _is_polynomial(self) -> bool:
        return self.problem.model is Lens

    def state(self, A: Array, G: Array, lens: AnyLens) -> State:
        """Give the state that the refinement starts from."""
        return self.problem.state(Camera(self.to_px @ A, lens=lens, size=self.problem.size), G)

    def refine(self, A: Array, G: Array, lens: AnyLens) -> None:
        """5. Minimise from here, with no board in the wrong pose, and keep what is found."""
        search = self.search
        found = minimise(
            self.problem,
            self.state(A, G, lens),
            tolerance=search.tolerance,
            patience=search.patience,
        )
        search.keep(found)

    def _is_own(self, step: Any, library: Any, name: str) -> bool:
        """Tell whether a step is the student's, and take note of it."""
        if step is library:
            return False
        if not callable(step):
            raise InputTypeError(f"{name}: expected a function, got {type(step).__name__}")
        if name not in self.search.own:
            self.search.own.append(name)
        return True


def resumed(search: Search, camera: Camera) -> Start:
    """Start all views from what a few of them say about the camera."""
    as_seen = xy_from_px.inside(camera.A, search.problem.m)
    ideal = camera.lens.undistort(as_seen)
    m = np.where(np.isnan(ideal), as_seen, ideal)
    if isinstance(camera.lens, FisheyeLens):  # rays near 90° and beyond: as far out as may be
        r = np.linalg.norm(as_seen, axis=-1, keepdims=True)
        m = np.where(r < _STEEPEST, m, np.tan(_STEEPEST) / np.maximum(r, 1e-9) * as_seen)
    return Start(search, m, camera.A, _closed_form, camera.lens, may_fail=True)


def _wide_cameras(problem: Problem) -> Iterator[Camera]:
    """Give equidistant cameras of several fields of view, for a quotient turned into such."""
    w, h = problem.size
    for view in _FIELDS_OF_VIEW:
        f = max(w, h) / view
        lens: AnyLens = FisheyeLens()
        if problem.model is RationalLens:
            lens = RationalLens(_LIKE_EQUIDISTANT)
        yield Camera(intrinsics(f, f, (w - 1) / 2, (h - 1) / 2), lens=lens, size=problem.size)


def as_quotient(camera: Camera, m: Array) -> Camera:
    """Give the camera with a quotient for a lens that shows rays up to 80° as a fisheye does.

    Where pixels m were seen: r' (1 + k4 r² + k5 r⁴ + k6 r⁶) = r (1 + k1 r² + k2 r⁴ + k3 r⁶) is
    linear in its coefficients, with r = tan θ and r' the fisheye's radius.
    """
    farthest = np.linalg.norm(xy_from_px.inside(camera.A, m), axis=-1).max()
    theta = np.linspace(0, _STEEPEST, 100)[1:]
    rays = np.stack([np.sin(theta), np.zeros_like(theta), np.cos(theta)], axis=-1)
    lens = FisheyeLens(tuple(camera.lens.parameters.values()))
    shown, r = lens.of_rays(rays)[:, 0], np.tan(theta)
    powers = r[:, None] ** [2, 4, 6]
    weight = 1 / (r * (1 + r**2) ** 3)
    sides = np.concatenate([r[:, None] * powers, -shown[:, None] * powers], axis=1)
    seen = shown <= farthest
    sides, missing = weight[:, None] * sides, weight * (shown - r)
    k = np.linalg.lstsq(sides[seen], missing[seen], rcond=None)[0]
    return Camera(camera.A, lens=RationalLens(tuple(k)), size=camera.size)


def _focal_lengths_alone(V: Array, b: Array) -> Array:  # noqa: ARG001
    return np.diag([*focal_lengths_from_v.inside(V), 1.0])


def _closed_form(V: Array, b: Array) -> Array:  # noqa: ARG001
    return intrinsics_from_b(b)


def _usual(f: float) -> Callable[[Array, Array], Array]:
    return lambda V, b: np.diag([f, f, 1.0])  # noqa: ARG005


def _px_from_normalised(size: tuple[int, int]) -> Array:
    """Similarity that takes 0 to the picture's middle and [−1, 1] to its longer side."""
    w, h = size
    s = max(w, h) / 2
    return np.array([[s, 0, (w - 1) / 2], [0, s, (h - 1) / 2], [0, 0, 1]])


# --- the other pose of a flat board

# Of few views, a single wrong pose may bend the camera until it fits; among many it stands out.
_FEW_VIEWS = 8
_STANDS_OUT = 2.0  # RMS of a view over that of a typical one
_POSE_STEPS = 3  # with the camera held; the other pose is then near enough to be judged
_IN_QUESTION = 4.0  # RMS of a view in its other pose over the larger of its own and that of all
_STEPS = 25  # by which a turned board has led downhill, or it does not
_NOISELESS = 1e-6  # px; what fits so well needs no other pose
_BETTER = 1e-6  # of the cost


def turned_over(R: Array, T: Array, normal: tuple[float, ...] | Array = (0.0, 0, 1)) -> Array:
    """Give the rotation (..., 3, 3) of the other pose of flat boards, R ← M(T) R M(normal).

    A mirror is M(n) = I − 2 n nᵀ. The one across the line of sight T leaves the picture of a
    distant board as it is; the one along the board's normal moves no point of the board, and makes
    the product a rotation.

    References
    ----------
    .. [1] G. Schweighofer and A. Pinz, Robust pose estimation from a planar target, PAMI 28
       (2006) 2024-2030.

    Examples
    --------
    >>> R = np.array([[1, 0, 0], [0, 0.8, -0.6], [0, 0.6, 0.8]])
    >>> turned_over(R, np.array([0.0, 0.0, 500.0])) + 0.0
    array([[ 1. ,  0. ,  0. ],
           [ 0. ,  0.8,  0.6],
           [ 0. , -0.6,  0.8]])
    """
    return np.asarray(_mirror(T) @ R @ _mirror(np.asarray(normal)))


def _mirror(n: Array) -> Array:
    n = n / np.linalg.norm(n, axis=-1, keepdims=True)
    return np.asarray(np.eye(3) - 2 * n[..., :, None] * n[..., None, :])


def best_turned(
    problem: Problem,
    found: Minimum[State, Arrow],
    known: Sequence[tuple[Minimum[State, Arrow], Minimum[State, Arrow]]] = (),
) -> Minimum[State, Arrow]:
    """Turn boards over as long as that leads to a lower minimum.

    Of some minima it is `known` already to which others that leads.
    """
    if not _worth_it(problem, found):
        return found
    better: Minimum[State, Arrow] | None = found
    while better is not None:
        found = better
        for end, lowest in known:
            if _is_same(end, found):
                return lowest
        better = next(_lower_minima(problem, found), None)
    return found


def _worth_it(problem: Problem, found: Minimum[State, Arrow]) -> bool:
    """Tell whether a board may be in its other pose: from what is known already."""
    if found.cost <= _NOISELESS**2 * problem.n_seen:
        return False
    by_view = found.system.view_costs / problem.n_seen_by_view
    if len(by_view) <= _FEW_VIEWS:
        return True
    stands_out = by_view.max() / _STANDS_OUT**2
    return bool(stands_out > by_view.min() and stands_out > np.median(by_view))


def _lower_minima(
    problem: Problem, found: Minimum[State, Arrow]
) -> Iterator[Minimum[State, Arrow]]:
    """Give the minima below this one: each board in question turned over, then all of them."""
    in_question = _in_question(problem, found)
    sets = [in_question[i : i + 1] for i in range(len(in_question))]
    for views in [*sets, in_question] if len(sets) > 1 else sets:
        R = found.x.R.copy()
        R[views] = turned_over(R[views], found.x.T[views])
        with suppress(ConvergenceError, DegenerateError):
            other = minimise(problem, State(found.x.shared, R, found.x.T), steps=_STEPS)
            if other.cost < found.cost * (1 - _BETTER):
                yield other if other.converged else minimise(problem, other.x)


def _in_question(problem: Problem, found: Minimum[State, Arrow]) -> npt.NDArray[np.intp]:
    """List the views that the other pose fits about as well, the likeliest first.

    The camera is held meanwhile, so that all boards are turned over in one go.
    """
    turned_R = turned_over(found.x.R, found.x.T)
    x = State(found.x.shared, turned_R, found.x.T)
    with np.errstate(all="ignore"):
        for _ in range(_POSE_STEPS):
            x = poses_follow(x, problem.linearise(x)[1])
        costs = problem.linearise(x)[1].view_costs / problem.n_seen_by_view
    own = found.system.view_costs / problem.n_seen_by_view
    ratio = costs / np.maximum(own, found.cost / problem.n_seen)
    fell_back = _distance(x.R, found.x.R) < _distance(x.R, turned_R)  # there is no other pose
    ratio = np.where(fell_back, np.inf, ratio)
    order: npt.NDArray[np.intp] = np.argsort(ratio)
    return order[ratio[order] < _IN_QUESTION**2]


def _is_same(one: Minimum[State, Arrow], other: Minimum[State, Arrow]) -> bool:
    """Tell whether two minimisations ended in the same minimum, up to rounding."""
    if not (one.converged and other.converged and np.isclose(one.cost, other.cost, 1e-9, 0)):
        return False
    pairs = [(getattr(one.x, name), getattr(other.x, name)) for name in ("shared", "R", "T")]
    return all(np.abs(a - b).max() <= 1e-6 * np.abs(a).max() for a, b in pairs)


def _distance(R: Array, S: Array) -> Array:
    return np.asarray(((R - S) ** 2).sum((-2, -1)))
