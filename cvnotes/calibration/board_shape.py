"""Boards that are not flat: their corners are estimated together with the camera.

A printed board is never quite what was drawn: paper arches and shrinks, glue makes bubbles. With a
few views the corners can be told apart from the camera, for all views see the same board. What no
view can tell is where the board's frame stands and how large the board is; so a shape may only
differ from the board that was given in ways that neither move it, nor turn it, nor scale it.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cvnotes.base import Array, CvnotesError, DegenerateError, Minimum
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.refinement import (
    Arrow,
    Problem,
    State,
    covariance,
    minimise,
    refuse_too_few,
)

BOARDS = ("flat", "bent", "free")
_DEGREE = 4  # of the heights over the board
_DEPENDENT = 1e-6  # smallest part of a power of x and y that the powers before do not contain
_AT_LEAST = 4  # views; from fewer a plane alone is known only up to its camera
# Of fewer views than these noise makes a shape; then corners are held near the places that were
# given, as if known to 1/200 of half the board's diagonal by corners seen to 0.1 px.
_ENOUGH, _HOLD = 10, 20.0


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
    """

    kind: str
    given: Array
    points: Array
    std: Array

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
    """Give the ways in which a board W (n, 3), centred and flat, may differ: (s, n, 3).

    They are orthonormal, and orthogonal to every small motion of the board and to its scale.

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
    if kind == "bent":
        return _bends(W)
    e = np.eye(3)
    gauge = [np.broadcast_to(axis, W.shape) for axis in e]
    gauge += [np.cross(axis, W) for axis in e] + [W]
    Q: Array = np.linalg.qr(np.reshape(gauge, (7, -1)).T, mode="complete").Q
    return Q[:, 7:].T.reshape(-1, len(W), 3)


def _bends(W: Array) -> Array:
    """Heights x^i y^j up to a degree, without those of a plane."""
    x, y = W[:, 0], W[:, 1]
    kept: list[Array] = []
    for degree in range(_DEGREE + 1):
        for j in range(degree + 1):
            z = x ** (degree - j) * y**j
            size = np.linalg.norm(z)
            for _ in range(2):  # twice, against rounding
                z = z - sum((k * (k @ z) for k in kept), start=np.zeros(len(W)))
            # (three rows of corners cannot tell y³ from y)
            if np.linalg.norm(z) > _DEPENDENT * size:
                kept.append(z / np.linalg.norm(z))
    shape = np.zeros((max(len(kept) - 3, 0), *W.shape))
    shape[..., 2] = np.reshape(kept[3:], (-1, len(W)))
    return shape


def with_shape(problem: Problem, data: Correspondences, kind: str) -> Problem:
    """Give the problem in which the shape of the board is sought too.

    Raises
    ------
    DegenerateError
        There are too few views, or a corner was seen in one of them only.
    """
    n_views = len(data)
    if n_views < _AT_LEAST:
        raise DegenerateError(
            f"the shape of a board takes at least {_AT_LEAST} views, got {n_views}: add views, or "
            'take the board for flat (board="flat")'
        )
    W, m, seen = data.on_one_board()
    once = seen.sum(0) < 2
    if kind == "free" and once.any():
        x, y, _ = (W[once][0] * data.scale + data.centre).round(6) + 0.0
        raise DegenerateError(
            f"the corner at ({x:g}, {y:g}) of the board was seen in one view only, so its own "
            'place is not known: leave it out, or let the board bend smoothly (board="bent")'
        )
    hold = _HOLD if n_views < _ENOUGH else 0.0
    free = replace(
        problem,
        W=W,
        m=m,
        seen=None if seen.all() else seen,
        shape=deformations(kind, W),
        hold=hold,
    )
    unknowns = 2 * free.n_seen - free.freedom
    refuse_too_few(2 * free.n_seen, unknowns, "add views, or take the board for flat")
    return free


def released(free: Problem, flat: Minimum[State, Arrow]) -> Minimum[State, Arrow]:
    """Go on from the minimum of a flat board to that of its shape."""
    return minimise(free, released_start(free, flat))


def released_start(free: Problem, flat: Minimum[State, Arrow]) -> State:
    """Give the minimum of a flat board as a board whose shape is sought, but flat so far."""
    of_shape = 0 if free.shape is None else len(free.shape)
    shared = np.concatenate([flat.x.shared, np.zeros(of_shape)])
    return State(shared, flat.x.R, flat.x.T)


def shape_found(
    free: Problem, data: Correspondences, kind: str, best: Minimum[State, Arrow]
) -> tuple[BoardShape, Correspondences]:
    """Give the shape in the units of the board as it was given, and the data on such a board."""
    W, q = free.board(best.x.shared), len(free.names)
    C = best.cost / free.freedom * covariance(best.system)[q:, q:]
    ways = np.zeros((len(C), 0)) if free.shape is None else free.shape.reshape(len(C), -1)
    std = np.sqrt(np.vecdot(ways.T, ways.T @ C)).reshape(W.shape)
    given, points = (w * data.scale + data.centre for w in (free.W, W))
    return BoardShape(kind, given, points, std * data.scale), data.on_board(W)
