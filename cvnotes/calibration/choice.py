"""Which lens do the views speak for, and is the board flat? Views that were left out decide.

More coefficients always fit the corners better from which they were estimated, and corners that
may go anywhere fit better than those of a flat board. What counts is how well camera and board
predict views that they have not seen (cross-validation). Views are few, so the choice is uncertain
too: the error bars contain every model that predicts as well.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from cvnotes.base import (
    Array,
    ConvergenceError,
    CvnotesError,
    DegenerateError,
    Minimum,
    image_size,
    student,
)
from cvnotes.calibration.board_shape import BOARDS, is_board, shaped
from cvnotes.calibration.correspondences import Correspondences, PointSets
from cvnotes.calibration.jackknife import Influence, undetermined
from cvnotes.calibration.refinement import NormalEquations, Problem, State
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

        Pairs of errors of the same view tell more than their sums.
        """
        if self.rms <= _ROUNDING:
            return True
        if self.rms > AS_WELL * other.rms:
            return False
        n, d = len(self.costs), self.costs - other.costs
        return n < _ENOUGH or bool(d.sum() <= student(SURE, n - 1) * np.sqrt(n) * d.std(ddof=1))


@dataclass(frozen=True, eq=False)
class Choice:
    """The lens and the board that views left out speak for, and what else they allow.

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
        """Least RMS over views left out, in pixels."""
        return min(c.rms for c in self.candidates)

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
        """The models not to be told apart: the chosen one, and those as good as the best."""
        return tuple(
            c for c in self.candidates if c is self.chosen or c.rms <= ALIKE_LEFT_OUT * self.least
        )

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
        """Return the model that fits as well and differs most: the parameter, and by how many σ.

        None where no other is close, or differs by more than the deviation.
        """
        names = [name for name in self.chosen.names if name in SENSOR]
        std = np.sqrt(np.diag(self.chosen.covariance)[: len(names)])
        here, far = self.chosen.camera.parameters, []
        for other in self.close:
            there = other.camera.parameters
            off = np.abs([there[name] - here[name] for name in names]) / std
            if off.max() > 1:
                far.append((other, names[int(off.argmax())], float(off.max())))
        return max(far, key=lambda each: each[2], default=None)


def choose_model(
    board_points: PointSets,
    image_points: PointSets,
    size: tuple[int, int],
    *,
    lenses: Sequence[str] = CANDIDATES,
    boards: Sequence[str] = BOARDS,
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
    First the lenses are compared on the simplest board, then boards with the lens chosen, and with
    the fullest lens of each other kind, then the lenses again on that board, until both stay or
    come back.

    A model is kept against one with more coefficients while it predicts views left out within
    10 %, and the other is not better in enough of them (one-sided t of the paired differences,
    95 %). Against a lens of another kind 10 % alone decide: nearly all programs know a polynomial.
    So they do for a lens that reaches every pixel against one that folds within the picture. A
    board that predicts within 10 % is taken where its residuals leave 10 % less noise: with few
    views left-out error does not tell boards apart, and what there is of a shape is then lost.

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
    board, before = boards[0], set[str]()
    while board not in before:  # two boards may each have a lens that speaks for the other
        before.add(board)
        of_lenses = tried.choice([(lens, board) for lens in lenses])
        lenses = [c.lens for c in of_lenses.candidates if c.rms <= HOPELESS * of_lenses.least]
        # (a lens of another kind may be hidden by a board that is not as it is taken to be)
        fullest = {LENSES[lens][0]: (lens, boards[-1]) for lens in lenses}
        fullest.pop(LENSES[of_lenses.lens][0])
        of_boards = [(of_lenses.lens, board) for board in boards]
        board = tried.choice([*of_boards, *fullest.values()]).board
    return tried.choice(tried.known, new=False)


@dataclass(eq=False)
class _Tried:
    """Models that were tried so far."""

    data: Correspondences
    size: tuple[int, int]
    skew: bool
    lenses: Sequence[str]
    flat: dict[str, tuple[Problem, Minimum[State, NormalEquations]] | None] = field(
        default_factory=dict
    )
    known: dict[tuple[str, str], Candidate | None] = field(default_factory=dict)

    def choice(self, models: Iterable[tuple[str, str]], *, new: bool = True) -> Choice:
        """Choose among models; those that are not known yet are tried, if new ones may be.

        Wide lenses are first: few starts do for them, and then for whatever they beat by far.
        """
        models = list(models)
        unknown = [model for model in models if model not in self.known] if new else []
        self.known |= dict.fromkeys(unknown)  # in the order in which they are told
        for model in sorted(unknown, key=lambda model: not LENSES[model[0]][0].wide):
            self.known[model] = self._candidate(*model)
        found = [c for model in models if (c := self.known.get(model))]
        if not found:
            raise ConvergenceError(
                "no lens leads to a camera: the corners are probably paired with the wrong points "
                "of the board, or the views do not determine the camera"
            )
        found = [c for c in found if c.determined] or found
        chosen = _simplest(found, self.lenses)
        # (a lens that folds may show what the board is, on which a simpler one then does not)
        fit = [c for c in found if new or c.camera.is_invertible >= chosen.camera.is_invertible]
        return Choice(_shaped(chosen, fit), tuple(found))

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
                problem, best = shaped(problem, self.data, board, best)
            return _judged(lens, board, problem, best)
        except CvnotesError:  # this model has no camera here
            return None

    def _estimated(self, problem: Problem) -> Minimum[State, NormalEquations]:
        """Estimate a camera from all views of a flat board, as `calibrate` does by itself."""
        fitted = [of_flat[1].cost for of_flat in self.flat.values() if of_flat]
        search = Search(
            problem,
            tolerance=_CLOSE,
            patience=_PATIENCE,
            rival=min(fitted, default=np.inf),
        )
        for start in search.starts():
            with start.attempt():
                H = start.homographies(dlt)
                A = start.intrinsics(None, H)
                G = start.extrinsics(extrinsics, A, H)
                start.refine(A, G, start.distortion(radial_distortion, A, G))
        return search.best()


def _judged(
    lens: str, board: str, problem: Problem, best: Minimum[State, NormalEquations]
) -> Candidate:
    """Return the candidate: how it predicts views left out, and how well they determine it."""
    if not best.converged:
        raise ConvergenceError(f"the refinement with lens {lens!r} did not converge")
    q, variance, fitted = len(problem.names), best.cost / problem.freedom, best.system.view_costs
    costs, covariance, determined = fitted * (1 + 2 * q / problem.freedom), undetermined(q), False
    if len(problem.m) >= _ENOUGH:  # else Akaike's final prediction error stays
        try:
            influence = Influence.of(problem, best.x)
            left_out = influence.costs_left_out(fitted)
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


def _shaped(chosen: Candidate, found: Sequence[Candidate]) -> Candidate:
    """Return the same lens with the board of least noise.

    Of few views, those without one know a board far worse than all do, and left-out error does
    not tell. Corners that are free are held by what the views say of their size: what noise alone
    would move stays in its place, and leaves no less noise.
    """
    best = min((c for c in found if c.lens == chosen.lens), key=lambda c: c.variance)
    return best if AS_WELL**2 * best.variance < chosen.variance else chosen


def _by_kind(found: Sequence[Candidate], lenses: Sequence[str]) -> list[list[Candidate]]:
    """Sort candidates by lens and board, the simplest first, and put those of a kind together."""
    ranked = sorted(found, key=lambda c: (lenses.index(c.lens), BOARDS.index(c.board)))
    kinds: dict[type, list[Candidate]] = {}
    for c in ranked:
        kinds.setdefault(LENSES[c.lens][0], []).append(c)
    return list(kinds.values())
