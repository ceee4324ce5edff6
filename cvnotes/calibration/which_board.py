"""Is the board flat? Views that were left out decide, as they do about the lens.

Corners that may go anywhere always fit better than those of a flat board. What counts is whether
the board that some views speak of is the board that the others see.
"""

from collections.abc import Sequence

import numpy as np

from cvnotes.base import ConvergenceError, CvnotesError, DegenerateError, Minimum, image_size
from cvnotes.calibration.board_shape import (
    BOARDS,
    is_board,
    released,
    released_start,
    with_shape,
)
from cvnotes.calibration.correspondences import Correspondences, PointSets
from cvnotes.calibration.refinement import Arrow, Problem, State, solve_arrow
from cvnotes.calibration.which_lens import enough_views, estimated, least, rms_of_parts

# A board with more coefficients has to be better by this much.
_BETTER = 1.05
_CHANCE = 1.5  # F up to which the shape of a board is noise
_ROUNDING = 1e-6  # px, more than is left of exact corners


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
        If false, a bent board that a free one beat is left as soon as it cannot be chosen any more,
        and what is given for it is an `AtLeast`.

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
    # (the free board before the bent one, which seldom is worth its time beside it)
    for board in sorted(boards, key=lambda board: ("flat", "free", "bent").index(is_board(board))):
        if board == "free" and "flat" in found and _is_flat(problem, data, flat):
            continue
        limit = np.inf if to_the_end else _chosen_up_to(min(found.values(), default=np.inf))
        found[board] = _one(problem, data, board, flat, limit)
    return {board: found[board] for board in boards if board in found}


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
    return max(_BETTER * best, _ROUNDING)


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
    except (DegenerateError, CvnotesError):
        return False  # which is said by trying it
    of_shape = len(x.shared) - len(flat.x.shared)
    return gain / of_shape < _CHANCE * max(cost - gain, 0.0) / free.freedom


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
    except (ConvergenceError, DegenerateError, CvnotesError):
        return np.inf
