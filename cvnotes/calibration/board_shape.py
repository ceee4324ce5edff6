"""Boards that are not flat: their corners are estimated together with the camera.

A printed board is never quite what was drawn: paper arches and shrinks, glue makes bubbles. With a
few views the corners can be told apart from the camera, for all views see the same board. What no
view can tell is where the board's frame stands and how large the board is; so a shape may only
differ from the board that was given in ways that neither move it, nor turn it, nor scale it.
"""

import itertools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError, DegenerateError
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import (
    Optimum,
    Problem,
    State,
    minimise,
    motions,
    refuse_too_few,
    shape_variances,
)

BOARDS = ("flat", "bent", "free")
_DEGREE = 4  # of the heights over the board
_DEPENDENT = 1e-6  # smallest part of a power of x and y that the powers before do not contain
_AT_LEAST = 4  # views; from fewer a plane alone is known only up to its camera
_CLOSE, _PATIENCE = 1e-4, 3  # tolerance and patience while the size of a shape is sought
# The board is about 1 large: 1/1000 is some 0.5 % of a square. Where its size is sought from, what
# it is at least, and when it is found.
_EXPECTED, _SMALLEST, _FOUND = 1e-3, 2e-6, 0.05
_LEAST = 1e-3  # px per unit; holds what exact corners do not show, as of a corner in one view only
_ROUNDS = 8


@dataclass(frozen=True, eq=False)
class BoardShape:
    """The shape of a board as a calibration found it.

    Attributes
    ----------
    kind : {"bent", "free"}
        Heights that are a polynomial of degree 4 over the board, or every corner by itself.
    given, points : ndarray, shape (n, 3)
        The corners on the board, as they were given and as they are, in the same frame and units:
        the board is neither moved nor turned nor scaled.
    std : ndarray, shape (n, 3)
        Standard deviations of `points`, for noise as large as the residuals show.
    hold : ndarray or None
        By how many pixels each coefficient of the shape was held back, per unit; not kept in files.
    """

    kind: str
    given: Array
    points: Array
    std: Array
    hold: Array | None = None

    @property
    def offsets(self) -> Array:
        """How far each corner lies from its place, (n, 3)."""
        return np.asarray(self.points - self.given)

    @property
    def heights(self) -> Array:
        """How far each corner stands out of the board's plane, (n,), along its z axis."""
        return np.asarray(self.offsets[:, 2])

    def __repr__(self) -> str:
        z, aside = self.heights, np.linalg.norm(self.offsets[:, :2], axis=1)
        moved = f", corners up to {aside.max():.3g} beside their places" if aside.any() else ""
        return (
            f"{self.kind} board: heights from {z.min():.3g} to {z.max():.3g} "
            f"(± {np.median(self.std[:, 2]):.2g}){moved}"
        )


def is_board(name: Any, *more: str) -> str:
    """Guard the name of a board's shape."""
    known = (*BOARDS, *more)
    if not isinstance(name, str) or name not in known:
        raise CvnotesError(f"board: expected one of {', '.join(map(repr, known))}, got {name!r}")
    return name


def deformations(kind: str, W: Array) -> Array:
    """Return the ways in which a board W (n, 3), centred and flat, may differ: (s, n, 3).

    They are orthonormal, and orthogonal to every small motion of the board and to its scale. Those
    of a bent board come first: heights that are a polynomial over the board.

    References
    ----------
    .. [1] K. H. Strobl and G. Hirzinger, More accurate pinhole camera calibration with imperfect
       planar target, ICCV Workshops 2011, 1068-1075.

    Examples
    --------
    >>> W = np.array([[x, y, 0.0] for y in (-1, 0, 1) for x in (-1, 0, 1)])
    >>> deformations("bent", W).shape, deformations("free", W).shape
    ((6, 9, 3), (20, 9, 3))
    """
    bends = np.concatenate(_bends(W))
    if kind == "bent":
        return bends
    known = np.concatenate([motions(W), bends])
    Q: Array = np.linalg.qr(known.reshape(len(known), -1).T, mode="complete").Q
    return np.concatenate([bends, Q[:, len(known) :].T.reshape(-1, *W.shape)])


def _bends(W: Array) -> list[Array]:
    """Heights x^i y^j without those of a plane: (s, n, 3) of each degree."""
    x, y = W[:, 0], W[:, 1]
    kept: list[Array] = []
    shapes = []
    for degree in range(_DEGREE + 1):
        before = len(kept)
        for j in range(degree + 1):
            z = x ** (degree - j) * y**j
            size = np.linalg.norm(z)
            for _ in range(2):  # twice, against rounding
                z = z - sum((k * (k @ z) for k in kept), start=np.zeros(len(W)))
            # (three rows of corners cannot tell y³ from y)
            if np.linalg.norm(z) > _DEPENDENT * size:
                kept.append(z / np.linalg.norm(z))
        shape = np.zeros((len(kept) - before, *W.shape))
        shape[..., 2] = np.reshape(kept[before:], (-1, len(W)))
        shapes.append(shape)
    return shapes[2:]


def with_shape(
    problem: Problem, data: Correspondences, kind: str, hold: Array | None = None
) -> Problem:
    """Return the problem in which the shape of the board is sought too.

    Raises
    ------
    DegenerateError
        There are too few views, or corners in them.
    """
    n_views = len(data)
    if n_views < _AT_LEAST:
        raise DegenerateError(
            f"the shape of a board takes at least {_AT_LEAST} views, got {n_views}: add views, or "
            'take the board for flat (board="flat")'
        )
    W, m, seen = data.on_one_board()
    shape = deformations(kind, W)
    free = replace(
        problem,
        W=W,
        m=m,
        seen=None if seen.all() else seen,
        shape=shape,
        bends=len(np.concatenate(_bends(W))),
        hold=hold,
    )
    unknowns = len(free.names) + len(shape) + 6 * n_views
    refuse_too_few(2 * free.n_seen, unknowns, "add views, or take the board for flat")
    return free


def shaped(
    problem: Problem,
    data: Correspondences,
    kind: str,
    flat: Optimum,
    hold: Array | None = None,
    *,
    tolerance: float = 1e-12,
) -> tuple[Problem, Optimum]:
    """Go on from the minimum of a flat board to that of its shape.

    `hold` is what holds it back, if that is known already; for `tolerance` see `minimise`.

    Notes
    -----
    With noise of variance σ² and a shape whose n coefficients s have the variance τ², the sum of
    squares grows by h² Σ s², h = σ/τ. Of each coefficient the views tell the part 1 − h² C_ss,
    where C is the inverse of the normal matrix; with γ the sum of these parts, τ² = Σ s²/γ and
    σ² = cost/(freedom + n − γ), until h stays. The bends of each degree have a τ of their own: one
    for all would hold back the arch of paper that has no wiggles.

    References
    ----------
    .. [1] D. J. C. MacKay, Bayesian interpolation, Neural Computation 4 (1992) 415-447.
    """
    free, known = with_shape(problem, data, kind), hold
    q, groups = len(problem.names), _groups(free)
    if hold is None:
        hold = np.full(free.n_shape, np.sqrt(flat.cost / max(problem.freedom, 1)) / _EXPECTED)
    x = State(np.concatenate([flat.x.shared, 0 * hold]), flat.x.R, flat.x.T)
    for _ in range(_ROUNDS):
        free = replace(free, hold=hold)
        best = minimise(free, x, tolerance=_CLOSE, patience=_PATIENCE)
        x, determined = best.x, 1 - hold**2 * shape_variances(free, best.system)[0]
        before, s, free = hold, best.x.shared[q:], replace(free, determined=float(determined.sum()))
        if known is not None:
            break
        noise = (best.cost - float(hold**2 @ s**2)) / free.freedom
        hold = np.concatenate(
            [_held(noise, s[part], determined[part], before[part]) for part in groups]
        )
        if (np.abs(hold - before) < _FOUND * before).all():
            break
    best = minimise(free, x, tolerance=tolerance, patience=_PATIENCE)
    # A valley has no bottom that noise would let one find.
    return free, replace(best, converged=best.converged or bool(free.model.cancelling))


def _groups(free: Problem) -> list[slice]:
    """Return which coefficients of a shape are alike: bends of each degree, and the others."""
    ends = np.cumsum([0, *map(len, _bends(free.W))]).tolist()
    return [slice(a, b) for a, b in itertools.pairwise([*ends, free.n_shape]) if a < b]


def _held(noise: float, s: Array, determined: Array, before: Array) -> Array:
    """Return h = σ/τ for coefficients that the views determine to these parts.

    MacKay's rule, τ² ← Σ s²/γ, goes the part γ/n of the way if all are determined alike: n/γ times
    its step are taken. (Where nothing is to be seen but noise it would halve τ² for ever.)
    """
    sure = max(float(determined.sum()), 1e-3)
    held, found = noise / before[0] ** 2, float(s @ s) / sure
    size = held + len(s) / sure * (found - held)
    return np.full(len(s), max(np.sqrt(noise / max(size, _SMALLEST**2)), _LEAST))


def shape_found(
    free: Problem, data: Correspondences, kind: str, best: Optimum
) -> tuple[BoardShape, Correspondences]:
    """Return the shape in the units of the board as it was given, and the data on such a board."""
    W = free.board(best.x.shared)
    variances = shape_variances(free, best.system)[1]
    std = np.sqrt(best.cost / free.freedom * variances)
    given, points = (w * data.scale + data.centre for w in (free.W, W))
    shape = BoardShape(kind, given, points, std * data.scale, free.hold)
    return shape, data.on_board(W)
