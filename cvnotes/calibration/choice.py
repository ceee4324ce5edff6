"""Which lens do the views speak for? Views that were left out decide.

More coefficients always fit the corners better from which they were estimated. What counts is how
well a camera predicts views that it has not seen (cross-validation). Views are few, so the choice
is uncertain too: the error bars contain every lens that predicts as well.

Between boards nothing is chosen: one that is free contains a flat and a bent one, and is held near
them as far as the views say. Of few views left-out error does not tell boards apart, as those
without one know a board far worse than all do; and whatever of a shape is not in the model, is in
the camera.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from cvnotes.base import Array, ConvergenceError, CvnotesError, DegenerateError, image_size, student
from cvnotes.calibration.board_shape import is_board, shaped
from cvnotes.calibration.correspondences import Correspondences, PointSets
from cvnotes.calibration.jackknife import Influence, undetermined
from cvnotes.calibration.refinement import Optimum, Problem
from cvnotes.calibration.refinement import covariance as covariance_by_noise
from cvnotes.calibration.starts import Search
from cvnotes.calibration.thresholds import ALIKE_LEFT_OUT, AS_WELL, HOPELESS, SURE
from cvnotes.calibration.zhang import extrinsics, radial_distortion
from cvnotes.camera import Camera
from cvnotes.camera.any_lens import LENSES
from cvnotes.camera.model import SENSOR
from cvnotes.homography import dlt

# Kind by kind, and in each from the fewest coefficients to the most. (A quotient takes longer than
# all of them together, and predicts no real camera better; it is there for who asks for it.)
CANDIDATES = ("none", "k1 k2", "k1 k2 p1 p2", "k1 k2 p1 p2 k3", "fisheye")
_ENOUGH = 4  # views; of fewer, none can be left out
_CLOSE, _PATIENCE = 1e-8, 3  # tolerance and patience with minima that are only compared
_UNDETERMINED = 10.0  # times the RMS of all views, of corners that others predict so badly
_ROUNDING = 1e-6  # px, more than is left of exact corners


@dataclass(frozen=True, eq=False)
class Candidate:
    """A lens and a board, estimated from all views.

    Attributes
    ----------
    lens, board : str
        Names that `calibrate` knows.
    camera : Camera
        As these views determine it.
    names : tuple of str
        Of its estimated parameters.
    costs : ndarray, shape (n_views,)
        Squared distance, summed over the corners of each view, from where a camera puts them that
        was estimated without this view.
    covariance : ndarray, shape (q, q)
        Of its parameters, from the scatter between views, and no less than noise alone gives.
    n_points, variance : int, float
        Corners of all views, and what residuals leave for the noise of one coordinate.
    determined : bool
        Whether the camera is still known where any one view is left out; else `costs` are those of
        all views, enlarged by what the parameters took from them.
    hold : ndarray or None
        What held each coefficient of the board's shape back; see `BoardShape`.
    """

    lens: str
    board: str
    camera: Camera
    names: tuple[str, ...]
    costs: Array
    covariance: Array
    n_points: int
    variance: float
    determined: bool = True
    hold: Array | None = field(default=None, repr=False)

    @property
    def rms(self) -> float:
        """Root mean square distance of corners of views that were left out, in pixels."""
        return float(np.sqrt(self.costs.sum() / self.n_points))

    def predicts_as_well_as(self, other: "Candidate") -> bool:
        """Return whether the other is not surely better at views left out.

        Pairs of errors of the same view tell more than their sums. What leaves no less noise than
        its further parameters take by chance (Akaike) is no better: without one view of a few, the
        others may not know a camera that all of them know.
        """
        by_chance = (len(other.names) - len(self.names)) / (2 * self.n_points)
        if self.rms <= _ROUNDING or self.variance < np.exp(by_chance) * other.variance:
            return True
        if self.rms > AS_WELL * other.rms:
            return False
        n, d = len(self.costs), self.costs - other.costs
        return n < _ENOUGH or bool(d.sum() <= student(SURE, n - 1) * np.sqrt(n) * d.std(ddof=1))


@dataclass(frozen=True, eq=False)
class Choice:
    """The lens that views left out speak for, with its board, and what else they allow.

    Attributes
    ----------
    chosen : Candidate
        The simplest that predicts views left out as well as any.
    candidates : tuple of Candidate
        All that were tried and came to a camera.
    """

    chosen: Candidate
    candidates: tuple[Candidate, ...] = field(repr=False)

    @property
    def lens(self) -> str:
        """Name of the chosen lens."""
        return self.chosen.lens

    @property
    def board(self) -> str:
        """What the board is: "flat", "bent" or "free"."""
        return self.chosen.board

    @property
    def rms(self) -> float:
        """RMS over views left out of the model that is chosen, in pixels."""
        return self.chosen.rms

    @property
    def least(self) -> float:
        """Least RMS over views left out of any lens with the same board, in pixels."""
        return min(c.rms for c in self.candidates if c.board == self.board)

    @property
    def by_lens(self) -> Mapping[str, float]:
        """RMS over views left out (px) of each lens: with the chosen board, if it was tried so."""
        of_any = {c.lens: c.rms for c in self.candidates}
        return of_any | {c.lens: c.rms for c in self.candidates if c.board == self.board}

    @property
    def by_board(self) -> Mapping[str, float]:
        """RMS over views left out (px) of each board, with the chosen lens."""
        return {c.board: c.rms for c in self.candidates if c.lens == self.lens}

    @property
    def close(self) -> tuple[Candidate, ...]:
        """The models not to be told apart: the chosen one, and lenses as good as the best."""
        same = [c for c in self.candidates if c.board == self.board]
        return tuple(c for c in same if c is self.chosen or c.rms <= ALIKE_LEFT_OUT * self.least)

    @property
    def covariance(self) -> Array:
        """Covariance of the chosen camera's parameters, the choice being uncertain.

        Notes
        -----
        Any of the models that are `close` may be the true one. The deviation of a parameter is the
        largest √(C_ii + δ_i²) of them, δ being by how much the parameters differ; correlations are
        those of the chosen model. A parameter that a model has not is 0 in it, and known; those of
        another kind of lens are not to be compared.

        References
        ----------
        .. [1] S. T. Buckland, K. P. Burnham and N. H. Augustin, Model selection: an integral part
           of inference, Biometrics 53 (1997) 603-618, whose mean over models is here their largest.
        """
        chosen, of_chosen = self.chosen, self.chosen.covariance
        variance = np.diag(of_chosen).copy()
        if not np.isfinite(variance).all():
            return of_chosen
        here = chosen.camera.parameters
        for other in self.close:
            same = LENSES[other.lens][0] is LENSES[chosen.lens][0]
            there, own = other.camera.parameters, np.diag(other.covariance)
            for i, name in enumerate(chosen.names):
                if same or name in SENSOR:
                    known = own[other.names.index(name)] if name in other.names else 0.0
                    off = there.get(name, 0.0) - here.get(name, 0.0)
                    variance[i] = max(variance[i], known + off**2)
        wider = np.sqrt(variance / np.diag(of_chosen))
        return np.asarray(of_chosen * np.outer(wider, wider))

    def close_by(self) -> tuple[Candidate, str, float] | None:
        """Return the model that fits as well and differs most: the parameter, and by how many px.

        None where no other is close and differs by more than the deviation of the one chosen.
        """
        names = [name for name in self.chosen.names if name in SENSOR]
        std = np.sqrt(np.diag(self.chosen.covariance)[: len(names)])
        here, far = self.chosen.camera.parameters, []
        for other in self.close:
            there = other.camera.parameters
            off = np.abs([there[name] - here[name] for name in names])
            most = int((off / std).argmax())
            if (times := off[most] / std[most]) > 1:
                far.append((times, other, names[most], float(off[most])))
        return max(far, key=lambda each: each[0])[1:] if far else None


def choose_model(
    board_points: PointSets,
    image_points: PointSets,
    size: tuple[int, int],
    *,
    lenses: Sequence[str] = CANDIDATES,
    boards: Sequence[str] = ("flat", "free"),
    skew: bool = False,
) -> Choice:
    """Choose a lens and a board by how well they predict views that were left out.

    Parameters
    ----------
    board_points, image_points, size, skew
        As for `calibrate`.
    lenses, boards : sequence of str
        Names that `calibrate` knows, the simplest first.

    Returns
    -------
    Choice
        Of fewer than 4 views none can be left out: boards are then flat, and residuals count,
        enlarged by what the parameters took from them.

    Raises
    ------
    ConvergenceError
        No lens leads to a camera.

    Notes
    -----
    All lenses are tried on the first board; those that predict views left out within half as much
    again as the best are compared on the last one. It contains the boards before it, and is held
    near them as far as the views say (see `shaped`), so between boards there is nothing to choose:
    of the first ones it is only told how they predict, where no other is determined they count.

    A lens is kept against one with more coefficients while it predicts views left out within
    10 %, and the other is not better in enough of them (one-sided t of the paired differences,
    95 %); or while the other leaves no less noise. Against a lens of another kind 10 % alone
    decide: nearly all programs know a polynomial. So they do for a lens that reaches every pixel
    against one that folds within the picture.

    Examples
    --------
    >>> from cvnotes.pictures import course
    >>> real = course.real_corners()
    >>> choice = choose_model(real.board.points, real.left, real.size, lenses=["none", "k1 k2"])
    >>> choice.lens, choice.board
    ('k1 k2', 'free')
    """
    size, data = image_size(size), Correspondences.of(board_points, image_points)
    boards = [is_board(board) for board in boards if board == "flat" or len(data) >= _ENOUGH]
    tried = _Tried(data, size, skew, lenses)
    first = tried.choice(lenses, boards[0])
    if first.rms <= _ROUNDING:  # exact corners of a board that is as it was given
        return first
    lenses = [c.lens for c in first.candidates if c.rms <= HOPELESS * first.least]
    for board in boards[:0:-1]:
        with suppress(ConvergenceError):  # these views do not determine so much
            return tried.choice(lenses, board)
    return first


@dataclass(eq=False)
class _Tried:
    """Models that were tried so far."""

    data: Correspondences
    size: tuple[int, int]
    skew: bool
    lenses: Sequence[str]
    flat: dict[str, tuple[Problem, Optimum] | None] = field(default_factory=dict)
    known: list[Candidate] = field(default_factory=list)

    def choice(self, lenses: Sequence[str], board: str) -> Choice:
        """Choose among lenses with a board.

        Wide lenses are first: few starts do for them, and then for whatever they beat by far. A
        lens without coefficients is last, as it may start where others ended.
        """
        order = sorted(lenses, key=lambda lens: (not LENSES[lens][0].wide, not LENSES[lens][1]))
        tried = {lens: self._candidate(lens, board) for lens in order}
        found = [c for lens in lenses if (c := tried[lens])]
        if not any(c.determined for c in found) and (self.known or not found):
            raise ConvergenceError(
                "no lens leads to a camera: the corners are probably paired with the wrong points "
                "of the board, or the views do not determine the camera"
            )
        found = [c for c in found if c.determined] or found
        self.known += found
        return Choice(_simplest(found, self.lenses), tuple(self.known))

    def _candidate(self, lens: str, board: str) -> Candidate | None:
        try:
            if lens not in self.flat:
                self.flat[lens] = None
                problem = Problem.of(self.data, self.size, lens, self.skew)
                self.flat[lens] = problem, self._estimated(problem)
            of_flat = self.flat[lens]
            if of_flat is None:
                return None
            problem, best = of_flat
            if board != "flat":
                problem, best = shaped(problem, self.data, board, best, tolerance=_CLOSE)
                camera = problem.camera_of(best.x.shared)
                if np.isnan(problem.residuals(camera, best.x)).any():  # the lens folds there
                    return None
            return _judged(lens, board, problem, best)
        except CvnotesError:  # this model has no camera here
            return None

    def _estimated(self, problem: Problem) -> Optimum:
        """Estimate a camera from all views of a flat board, as `calibrate` does by itself."""
        fitted = [of_flat[1].cost for of_flat in self.flat.values() if of_flat]
        search = Search(
            problem, tolerance=_CLOSE, patience=_PATIENCE, rival=min(fitted, default=np.inf)
        )
        for near, end in filter(None, self.flat.values()):
            if near.model is problem.model and not search.resumes:
                search.resume(near.camera_of(end.x.shared), end.x)
        for start in search.starts():
            with start.attempt():
                H = start.homographies(dlt)
                A = start.intrinsics(None, H)
                G = start.extrinsics(extrinsics, A, H)
                start.refine(A, G, start.distortion(radial_distortion, A, G))
        return search.best()


def _judged(lens: str, board: str, problem: Problem, best: Optimum) -> Candidate:
    """Return the candidate: how it predicts views left out, and how well they determine it."""
    if not best.converged:
        raise ConvergenceError(f"the refinement with lens {lens!r} did not converge")
    q, variance, fitted = len(problem.names), best.cost / problem.freedom, best.system.view_costs
    costs, covariance, determined = fitted * (1 + 2 * q / problem.freedom), undetermined(q), False
    if len(problem.m) >= _ENOUGH:  # else Akaike's final prediction error stays
        try:
            influence = Influence.of(problem, best.x)
            left_out = fitted + influence.more
            if left_out.sum() <= _UNDETERMINED**2 * best.cost:
                noise = variance * np.diag(covariance_by_noise(best.system))[:q]
                costs, determined = left_out, True
                covariance = _at_least(influence.covariance[:q, :q], noise)
        except DegenerateError:
            pass
    camera = problem.camera_of(best.x.shared)
    return Candidate(
        lens,
        board,
        camera,
        problem.names,
        costs,
        covariance,
        problem.n_seen,
        variance,
        determined,
        problem.hold,
    )


def _at_least(C: Array, variance: Array) -> Array:
    """Widen a covariance of views (q, q) to the variances (q,) that noise alone would give.

    A scatter between few views is by chance too small in half of the cases; the noise of so many
    corners is known, and nothing is known better than it allows (Cramér and Rao).
    """
    wider = np.sqrt(np.maximum(variance / np.diag(C), 1))
    return np.asarray(C * np.outer(wider, wider))


def _simplest(found: Sequence[Candidate], lenses: Sequence[str]) -> Candidate:
    """Return the simplest model of the simplest kind that predicts as well as any."""
    least = min(c.rms for c in found)
    whole = [c for c in found if c.camera.is_invertible]
    if whole and min(c.rms for c in whole) <= AS_WELL * least:
        found, least = whole, min(c.rms for c in whole)
    for of_kind in _by_kind(found, lenses):
        best = min(of_kind, key=lambda c: c.rms)
        if best.rms <= max(AS_WELL * least, _ROUNDING):
            return next(c for c in of_kind if c is best or c.predicts_as_well_as(best))
    raise AssertionError("one of the kinds has the least error")


def _by_kind(found: Sequence[Candidate], lenses: Sequence[str]) -> list[list[Candidate]]:
    """Sort candidates, the simplest lens first, and put those of a kind together."""
    ranked = sorted(found, key=lambda c: lenses.index(c.lens))
    kinds: dict[type, list[Candidate]] = {}
    for c in ranked:
        kinds.setdefault(LENSES[c.lens][0], []).append(c)
    return list(kinds.values())
