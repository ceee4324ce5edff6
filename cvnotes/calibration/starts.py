"""Where the refinement starts: the steps 1 to 4 as `calibrate` takes them, and how they are tried.

The plain way is the first start, and nearly always enough: corners as they were seen, and the
focal lengths alone for an A. What is tried when that leads nowhere, and when boards may be in the
wrong one of two poses, is in `reserve`.

Steps see the board centred and scaled to unit size and the picture centred and scaled to [−1, 1].
A student's step gets copies, and what it gives back is looked at before it is used.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cvnotes.base import (
    Array,
    ConvergenceError,
    CvnotesError,
    DegenerateError,
    InputTypeError,
    ShapeError,
    intrinsic_matrix,
    matrix,
    numbers,
    rigid_motion,
)
from cvnotes.calibration import reserve
from cvnotes.calibration.refinement import (
    CORRELATED,
    FEW_VIEWS,
    Optimum,
    Problem,
    State,
    autocorrelation,
    minimise,
    typical_cost,
)
from cvnotes.calibration.zhang import (
    constraints,
    extrinsics,
    focal_lengths_from_v,
    radial_distortion,
    solve_b,
)
from cvnotes.camera import AnyLens, Camera, Lens
from cvnotes.homography import dlt, geometric_error

# Of many views, some say where the camera is; the others only sharpen it.
_MANY_VIEWS, _VIEWS_FOR_START = 150, 16
# RMS over the picture's longer side: a start that leaves more than this is not trusted before the
# others were tried.
_SUSPICIOUS = 0.002
# The same, when the residuals of few views are no noise.
_SYSTEMATIC = 0.0003
# Starts that ended in one minimum, the lowest so far: the others would only find it again. (Three
# agree on a wrong one in 2 of 1,000 sets of exact corners with boards of two poses, four in 1.)
_AGREED, _ONE = 6, 1e-6
# Minima are nearly alike that differ by this part of the cost; where lenses are only compared, one
# is beaten by another that leaves this part of its cost.
_ALIKE, _BEATEN = 1e-3, 0.25
_STANDS_OUT = 2.0  # RMS of a view over that of a typical one
_STRANGE = 10.0  # the same, of a view with wrong corners; in its wrong pose it is less than half
_NOISELESS = 1e-6  # px; what fits so well needs no other pose
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
    """

    problem: Problem
    tolerance: float = 1e-12
    patience: int | None = None
    rival: float | None = None
    minima: list[Optimum] = field(default_factory=list)
    own: list[str] = field(default_factory=list)  # the steps that are the student's
    resumes: bool = False  # where another lens ended
    # before boards were turned
    ends: list[Optimum] = field(default_factory=list)

    def starts(self) -> "Iterator[Start]":
        """Return the starts, the most robust first, until one has led to a good minimum."""
        if self._is_done():
            return
        for start in self._all_starts():
            yield start
            if self._is_done():
                break

    def resume(self, camera: Camera, x: State) -> None:
        """Start where a lens with more or fewer coefficients of the same kind ended."""
        shared = self.problem.state(camera, np.empty((0, 4, 4))).shared
        with suppress(ConvergenceError, DegenerateError):
            found = self.minimise(x._replace(shared=shared))
            self.resumes = True
            self.keep(found)

    def minimise(self, start: State) -> Optimum:
        """Minimise from a start, as closely as is asked for."""
        return minimise(self.problem, start, tolerance=self.tolerance, patience=self.patience)

    def _is_done(self) -> bool:
        return bool(self.minima) and (self._is_good(self.minima[-1]) or self._is_decided())

    def _all_starts(self) -> "Iterator[Start]":
        if len(self.problem.m) > _MANY_VIEWS:
            some = np.linspace(0, len(self.problem.m) - 1, _VIEWS_FOR_START).astype(np.intp)
            few = Search(self.problem.some(some), tolerance=1e-6)
            for start in few.starts():
                start.may_fail = True
                yield start
            if few.minima:
                yield resumed(self, few.problem.camera_of(few.best().x.shared))
        model = self.problem.model
        if model.wide:  # homographies know the plane z = 1 only
            yield from self._straightened()
            return
        to_px = _px_from_normalised(self.problem.size)
        m = (self.problem.m - to_px[:2, 2]) / to_px[0, 0]
        for bend in reserve.BENDS if self.problem.coefficients else (0.0,):
            straight = m * (1 + bend * (m * m).sum(-1, keepdims=True)) if bend else m
            for guess in (_focal_lengths_alone, *reserve.GUESSES):
                yield Start(self, straight, to_px, guess)
                if "intrinsics" in self.own:  # there is no other A
                    break
                if model.usual():
                    yield from self._straightened()
                    return

    def _straightened(self) -> "Iterator[Start]":
        for camera in reserve.wide_cameras(self.problem):
            yield resumed(self, camera)

    def keep(self, found: Optimum) -> None:
        """Note where a start led, with no board in the wrong pose; from the same end, to the same.

        Where no start is good, many of them end alike, and to turn boards over takes longest.
        """
        known = list(zip(self.ends + self.minima, self.minima + self.minima, strict=True))
        self.ends.append(found)
        if self._may_be_turned(found):
            found = reserve.best_turned(self.problem, found, known)
        self.minima.append(found)

    def _may_be_turned(self, found: Optimum) -> bool:
        """Return whether a board may be in its other pose: from what is known already."""
        if found.cost <= _NOISELESS**2 * self.problem.n_seen:
            return False
        if self.resumes and self._is_beaten(found.cost):
            return False
        by_view = found.system.view_costs / self.problem.n_seen_by_view
        if not self._has_many_views:
            return True
        stands_out = by_view.max() / _STANDS_OUT**2
        return bool(stands_out > by_view.min() and stands_out > np.median(by_view))

    @property
    def _has_many_views(self) -> bool:
        return len(self.problem.m) > FEW_VIEWS

    def _is_good(self, minimum: Optimum) -> bool:
        allowed = (_SUSPICIOUS * max(self.problem.size)) ** 2
        if not minimum.converged or typical_cost(self.problem, minimum) >= allowed:
            return False
        if not self._is_systematic(minimum):
            return True
        # Many views bend a wrong camera only so far that its lens folds within the picture.
        return self._has_many_views and self.problem.camera_of(minimum.x.shared).is_invertible

    def _is_decided(self) -> bool:
        """Return whether another start would end where others did.

        Six ended in the lowest minimum, or two nearly there where no start is at fault: in a
        valley; for a lens that is only compared with others, whose rival is far below; and where
        one of many views shows something else. Of such a lens one does where another lens ended.
        """
        if self.resumes and self._is_beaten(self.minima[0].cost):
            return True
        if len(self.minima) < 2:
            return False
        lowest, second = sorted(minimum.cost for minimum in self.minima)[:2]
        same = (m.converged and m.cost <= (1 + _ONE) * lowest for m in self.minima)
        if sum(same) >= _AGREED:
            return True
        no_start_helps = self._is_beaten(lowest) or self._has_stranger()
        no_start_helps |= bool(self.problem.model.cancelling)
        return no_start_helps and second < (1 + _ALIKE) * lowest

    def _is_beaten(self, cost: float) -> bool:
        return self.rival is not None and self.rival < _BEATEN * cost

    def _has_stranger(self) -> bool:
        """Return whether one of many views misses so much more that no pose explains it."""
        by_view = self.minima[-1].system.view_costs / self.problem.n_seen_by_view
        return bool(self._has_many_views and by_view.max() > _STRANGE**2 * np.median(by_view))

    def _is_systematic(self, minimum: Optimum) -> bool:
        """Return whether more than noise is left: few views bend a wrong camera until it fits."""
        if minimum.cost < (_SYSTEMATIC * max(self.problem.size)) ** 2 * self.problem.n_seen:
            return False
        r = self.problem.residuals(self.problem.camera_of(minimum.x.shared), minimum.x)
        return autocorrelation(r, self.problem.freedom) > CORRELATED

    def best(self) -> Optimum:
        """Return the lowest minimum that was found."""
        if not self.minima:
            yours = f", or your {' and '.join(self.own)} start far from it" if self.own else ""
            raise ConvergenceError(
                "no start leads to a camera: the corners are probably paired with the wrong points "
                f"of the board, or the views do not determine the camera{yours}"
            )
        best = min(self.minima, key=lambda minimum: minimum.cost)
        # A valley has no bottom that noise would let one find; all starts were tried.
        return replace(best, converged=True) if self.problem.model.cancelling else best


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
        problem = self.problem
        radial = [name for name in problem.coefficients if name[0] == "k"]
        terms = min(len(radial), problem.model.linear_terms)
        k: Array = np.zeros(0)
        if self._is_own(step, radial_distortion, "distortion") and terms:
            copies = (x.copy() for x in (self.to_px @ A, G, problem.W, problem.m))
            k = numbers(step(*copies, terms=terms), "the k of your distortion")
        elif terms:
            k = radial_distortion.inside(self.to_px @ A, G, problem.W, problem.m, terms=terms)
        if k.shape != (terms,):
            raise ShapeError(f"the k of your distortion: expected shape {(terms,)}, got {k.shape}")
        return Lens(k=tuple(k))

    def state(self, A: Array, G: Array, lens: AnyLens) -> State:
        """Return the state that the refinement starts from."""
        return self.problem.state(Camera(self.to_px @ A, lens=lens, size=self.problem.size), G)

    def refine(self, A: Array, G: Array, lens: AnyLens) -> None:
        """5. Minimise from here, with no board in the wrong pose, and keep what is found."""
        self.search.keep(self.search.minimise(self.state(A, G, lens)))

    def _is_own(self, step: Any, library: Any, name: str) -> bool:
        """Return whether a step is the student's, and take note of it."""
        if step is library:
            return False
        if not callable(step):
            raise InputTypeError(f"{name}: expected a function, got {type(step).__name__}")
        if name not in self.search.own:
            self.search.own.append(name)
        return True


def resumed(search: Search, camera: Camera) -> Start:
    """Start all views from what a few of them say about the camera."""
    m = reserve.straightened(search.problem.m, camera)
    return Start(search, m, camera.A, reserve.closed_form, camera.lens, may_fail=True)


def _focal_lengths_alone(V: Array, b: Array) -> Array:  # noqa: ARG001
    return np.diag([*focal_lengths_from_v.inside(V), 1.0])


def _px_from_normalised(size: tuple[int, int]) -> Array:
    """Similarity that takes 0 to the picture's middle and [−1, 1] to its longer side."""
    w, h = size
    s = max(w, h) / 2
    return np.array([[s, 0, (w - 1) / 2], [0, s, (h - 1) / 2], [0, 0, 1]])
