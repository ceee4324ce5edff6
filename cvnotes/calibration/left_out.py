"""Which lens do the views speak for, and is the board flat? Views that were left out decide.

More coefficients always fit the corners better from which they were estimated, and corners that
may go anywhere fit better than those of a flat board. What counts is how well camera and board
predict corners that they have not seen.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from cvnotes.base import ConvergenceError, CvnotesError, DegenerateError, Minimum, image_size
from cvnotes.calibration.board_shape import (
    BOARDS,
    is_board,
    released,
    released_start,
    with_shape,
)
from cvnotes.calibration.correspondences import Correspondences, PointSets
from cvnotes.calibration.refinement import (
    Arrow,
    Problem,
    State,
    minimise,
    poses_at_rest,
    solve_arrow,
)
from cvnotes.calibration.starts import Search
from cvnotes.calibration.zhang import extrinsics, radial_distortion
from cvnotes.camera import Camera, RationalLens
from cvnotes.homography import dlt

# From the fewest coefficients to the most: 2, 4, 4, 5 and 8.
CANDIDATES = ("k1 k2", "k1 k2 p1 p2", "fisheye", "k1 k2 p1 p2 k3", "rational")
# A lens, or a board, with more coefficients has to be better by this much.
_BETTER_LENS, _BETTER_BOARD = 1.03, 1.05
_PARTS = 5  # the views are left out a part at a time
_STEPS = 10  # of a pose that follows a camera; it starts close
_CLOSE, _PATIENCE = 1e-8, 3  # tolerance and patience with minima that are only compared
_COARSE = 1e-4  # tolerance of a minimum from which the parts go on
# A lens that fits so many times worse than another predicts speaks for those that it contains, too.
_HOPELESS = 2.0
_BEATEN = 1.1  # so many times worse than another, a lens need not be followed to the end
_CHANCE = 1.5  # F up to which the shape of a board is noise
_ROUNDING = 1e-6  # px, more than is left of exact corners


class AtLeast(float):
    """What a root mean square is not below, where that was enough to know."""


def left_out_rms(
    board_points: PointSets,
    image_points: PointSets,
    size: tuple[int, int],
    *,
    lenses: Sequence[str] = CANDIDATES,
    skew: bool = False,
    to_the_end: bool = True,
) -> dict[str, float]:
    """Predict the corners of views that were left out, with each of several lenses.

    Parameters
    ----------
    board_points, image_points, size, skew
        As for `calibrate`; at least 4 views.
    lenses : sequence of str
        Names that `calibrate` knows.
    to_the_end : bool
        If false, a lens is left as soon as it cannot be chosen any more, and what is given for it
        is an `AtLeast`.

    Returns
    -------
    dict
        For each lens the root mean square distance, in pixels per point, of the corners of views
        left out; infinite where the lens does not come to a camera. The rational lens is not tried
        where a polynomial did better than the fisheye.

    Raises
    ------
    DegenerateError
        There are fewer than 4 views.

    Notes
    -----
    The views are dealt into five parts. A camera is estimated without one of them, then held
    while the poses of the views left out are fitted; what remains in these counts.

    No view is fitted better by the others than by all: with θ the best camera of all views and θ'
    that without view i, Σ c(θ) ≤ Σ c(θ') while Σ' c(θ') ≤ Σ' c(θ), where Σ' leaves out the cost of
    view i, and so c_i(θ') ≥ c_i(θ). What all views leave is therefore a lower bound from the start;
    each part that is left out raises it.

    References
    ----------
    .. [1] M. Stone, Cross-validatory choice and assessment of statistical predictions, J. R.
       Statist. Soc. B 36 (1974) 111-147.

    Examples
    --------
    >>> from cvnotes.pictures import course
    >>> m = course.measured_corners()
    >>> out = left_out_rms(course.board().points, m, (640, 480), lenses=("none", "k1 k2"))
    >>> out["none"] > 3 * out["k1 k2"]
    True
    """
    size, data = image_size(size), enough_views(board_points, image_points)
    compared = Comparison(to_the_end)
    found: dict[str, float] = {}
    # (the fisheye first: it fits narrow lenses nearly as well, and wide ones as nothing else does;
    # then the polynomial that contains the others)
    first = ("fisheye", "k1 k2 p1 p2 k3")
    for name in sorted(lenses, key=lambda name: (*first, name).index(name)):
        if name == "rational" and _is_narrow(found):
            continue
        found[name] = compared.add(name, Problem.of(data, size, name, skew))
    return {name: found[name] for name in lenses if name in found}


@dataclass(eq=False)
class Comparison:
    """Lenses that were compared so far.

    Parameters
    ----------
    to_the_end : bool
        Whether a lens that cannot be chosen any more is worked out all the same.
    """

    to_the_end: bool
    best: float = np.inf  # RMS over views left out
    rival: float = np.inf  # cost of all views
    fisheye: Camera | None = None
    polynomial: float = 0.0  # RMS of all views, with the polynomial that contains the others

    def add(self, name: str, problem: Problem) -> float:
        """Give the RMS over views left out of one more lens, or what it is not below."""
        # (the quotient, which takes longest, has nothing to add once it is not the best)
        limit = self.best if name == "rational" else _BEATEN * self.best
        if self.to_the_end:
            limit = np.inf
        if name.startswith("k") and self.polynomial > _HOPELESS * limit:
            return AtLeast(self.polynomial)
        try:
            # (from the bottom of a quotient's valley, the parts have less far to go)
            close = self.to_the_end or problem.model is RationalLens
            tolerance = _CLOSE if close else _COARSE
            whole = estimated(problem, self.rival, self.fisheye, tolerance)
            rms = rms_of_parts(problem, whole, limit)
        except CvnotesError:  # this lens has no camera here
            return np.inf
        self.best, self.rival = min(self.best, rms), min(self.rival, whole.cost)
        if name == "fisheye":
            self.fisheye = problem.camera_of(whole.x.shared)
        if name == "k1 k2 p1 p2 k3":
            self.polynomial = float(np.sqrt(whole.cost / problem.n_seen))
        return rms


def _is_narrow(found: dict[str, float]) -> bool:
    """Tell whether polynomials beat the fisheye, as they do where no wide lens is needed.

    The quotient, which takes longer than all others together, then has nothing to add.
    """
    polynomials = [rms for name, rms in found.items() if name.startswith("k")]
    return min(polynomials, default=np.inf) <= found.get("fisheye", 0.0)


def choose_lens(by_lens: dict[str, float]) -> str:
    """Name the lens with the fewest coefficients that predicts as well as any.

    Examples
    --------
    >>> choose_lens({"k1 k2": 0.170, "k1 k2 p1 p2": 0.169, "rational": 0.168})
    'k1 k2'
    >>> choose_lens({"k1 k2": 1.67, "fisheye": 0.42, "rational": 0.43})
    'fisheye'
    """
    return next(
        name for name, rms in by_lens.items() if rms <= _BETTER_LENS * least(by_lens, "lens")
    )


# --- boards


def left_out_rms_of_boards(
    board_points: PointSets,
    image_points: PointSets,
    size: tuple[int, int],
    *,
    lens: str = "k1 k2",
    boards: Sequence[str] = BOARDS,
    skew: bool = False,
    to_the_end: bool = True,
) -> dict[str, float]:
    """Predict the corners of views that were left out, with a flat board, a bent and a free one.

    Parameters
    ----------
    board_points, image_points, size, skew
        As for `calibrate`; at least 4 views.
    lens : str
        A name that `calibrate` knows, but "auto".
    boards : sequence of {"flat", "bent", "free"}
        What the board may be.
    to_the_end : bool
        If false, a board is left as soon as it cannot be chosen any more, and what is given for it
        is an `AtLeast`. The free board is tried before the bent one.

    Returns
    -------
    dict
        For each board the root mean square distance, in pixels per point, of the corners of views
        left out; infinite where the views do not determine such a board. A free board is not tried
        where the residuals of a flat one are no more than noise.

    Raises
    ------
    DegenerateError
        There are fewer than 4 views.

    Notes
    -----
    As `left_out_rms` does for lenses: the views are dealt into five parts, camera and board are
    estimated without one of them, and held while the poses of the views left out are fitted.

    Examples
    --------
    >>> from cvnotes.pictures import course
    >>> real = course.real_corners()
    >>> out = left_out_rms_of_boards(real.board.points, real.left, real.size)
    >>> out["free"] < out["bent"] < out["flat"]
    True
    """
    size, data = image_size(size), enough_views(board_points, image_points)
    problem = Problem.of(data, size, lens, skew)
    flat = estimated(problem)
    found: dict[str, float] = {}
    # (where a free board is the better one, a glance at the bent one is then enough)
    for board in sorted(boards, key=lambda board: ("flat", "free", "bent").index(is_board(board))):
        if board == "free" and "flat" in found and _is_flat(problem, data, flat):
            continue
        limit = np.inf if to_the_end else _chosen_up_to(min(found.values(), default=np.inf))
        found[board] = _one(problem, data, board, flat, limit)
    return {board: found[board] for board in boards if board in found}


def _one(
    problem: Problem,
    data: Correspondences,
    board: str,
    flat: Minimum[State, Arrow],
    limit: float,
) -> float:
    """RMS over views left out, of one kind of board."""
    try:
        if board == "flat":
            return rms_of_parts(problem, flat)
        free = with_shape(problem, data, board)
        return rms_of_parts(free, released(free, flat), limit)
    except CvnotesError:  # the views do not determine such a board
        return np.inf


def _is_flat(problem: Problem, data: Correspondences, flat: Minimum[State, Arrow]) -> bool:
    """Tell whether corners that may go anywhere would gain no more than noise gives them.

    From one linear step: what each of their coefficients takes from the cost, over what each
    coordinate that was measured leaves there (the F of the coefficients together).
    """
    try:
        free = with_shape(problem, data, "free")
        x = released_start(free, flat)
        cost, system = free.linearise(x)
        _, gain = solve_arrow(system, 0.0)
    except CvnotesError:
        return False  # which is said by trying it
    of_shape = len(x.shared) - len(flat.x.shared)
    return gain / of_shape < _CHANCE * max(cost - gain, 0.0) / free.freedom


def choose_board(by_board: dict[str, float]) -> str:
    """Name the simplest board that predicts about as well as any.

    Examples
    --------
    >>> choose_board({"flat": 0.156, "bent": 0.153, "free": 0.152})
    'flat'
    >>> choose_board({"flat": 0.171, "bent": 0.150, "free": 0.110})
    'free'
    """
    limit = _chosen_up_to(least(by_board, "board"))
    return next(name for name, rms in by_board.items() if rms <= limit)


def _chosen_up_to(best: float) -> float:
    """Give the RMS up to which a board predicts about as well as the best."""
    return max(_BETTER_BOARD * best, _ROUNDING)


# --- views left out


def least(by_name: dict[str, float], what: str) -> float:
    """Give the smallest RMS, of any lens or any board, or refuse if none came to a camera."""
    best = min(by_name.values())
    if not np.isfinite(best):
        raise ConvergenceError(
            f"no {what} leads to a camera: the corners are probably paired with the wrong points "
            "of the board, or the views do not determine the camera"
        )
    return best


def enough_views(board_points: PointSets, image_points: PointSets) -> Correspondences:
    """Pair points of enough views for some of them to be left out."""
    data = Correspondences.of(board_points, image_points)
    if len(data) < 4:
        raise DegenerateError(f"to leave views out takes at least 4 of them, got {len(data)}")
    return data


def estimated(
    problem: Problem,
    rival: float = np.inf,
    fisheye: Camera | None = None,
    tolerance: float = _CLOSE,
) -> Minimum[State, Arrow]:
    """Estimate a camera from all views, as `calibrate` does by itself, to compare it with others.

    `rival` is the least cost of a lens so far; a quotient may start from a fisheye.
    """
    search = Search(problem, tolerance=tolerance, patience=_PATIENCE, rival=rival, fisheye=fisheye)
    for start in search.starts():
        with start.attempt():
            H = start.homographies(dlt)
            A = start.intrinsics(None, H)
            G = start.extrinsics(extrinsics, A, H)
            start.refine(A, G, start.distortion(radial_distortion, A, G))
    return search.best()


def rms_of_parts(problem: Problem, whole: Minimum[State, Arrow], limit: float = np.inf) -> float:
    """RMS over views left out a part at a time, of what starts at the minimum of them all.

    Beyond the limit it is not worked out to the end, see `left_out_rms`.
    """
    n_views, n = len(problem.m), problem.n_seen
    squares, to_come = 0.0, whole.system.view_costs.copy()
    for out in _parts(n_views):
        at_least = float(np.sqrt((squares + to_come.sum()) / n))
        if at_least > limit:
            return AtLeast(at_least)
        kept = np.delete(np.arange(n_views), out)
        start = whole.x.some(kept)
        without = minimise(problem.some(kept), start, tolerance=_CLOSE, patience=_PATIENCE)
        squares += _follow(problem.some(out), whole.x.some(out), without)
        to_come[out] = 0
    return float(np.sqrt(squares / n)) if np.isfinite(squares) else np.inf


def _parts(n_views: int) -> Iterator[npt.NDArray[np.intp]]:
    """Deal the views into parts; neighbours, which are often alike, into different ones."""
    for i in range(min(_PARTS, n_views)):
        yield np.arange(i, n_views, _PARTS)


def _follow(problem: Problem, x: State, camera: Minimum[State, Arrow]) -> float:
    """Fit the poses of views to a camera that does not know them; gives the sum of squares."""
    shared, q = camera.x.shared, len(problem.names)
    problem = replace(problem, W=problem.board(shared), shape=None, hold=0.0)  # it is known now
    _, costs = poses_at_rest(problem, State(shared[:q], x.R, x.T), _STEPS)
    return float(costs.sum())
