"""Corners on the board and in the pictures, paired, checked and brought to one scale."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, DegenerateError, ShapeError, numbers, points
from cvnotes.base.guards import is_masked
from cvnotes.camera import skew_matrix

PointSets = npt.ArrayLike | Sequence[npt.ArrayLike]


@dataclass(frozen=True, eq=False)
class Correspondences:
    """Board points and image points of several views.

    Views with fewer points are filled up with repetitions of their first point, which `seen`
    marks as not seen.

    Attributes
    ----------
    W : ndarray, shape (n, 3) or (n_views, n, 3)
        Board points, with Z = 0 if it is flat, centred on 0 and scaled so that half their diagonal
        is 1.
    m : ndarray, shape (n_views, n, 2)
        Image points in pixels.
    seen : ndarray of bool, shape (n_views, n), or None
        Which of them were seen; None when all were.
    centre, scale : ndarray (3,) and float
        The board point that became 0, and the length that became 1.
    before : Correspondences or None
        The same with W as it was given, when these are on the board that was found.
    """

    W: Array
    m: Array
    seen: npt.NDArray[np.bool_] | None
    centre: Array
    scale: float
    before: "Correspondences | None" = None

    @staticmethod
    def of(
        board_points: PointSets,
        image_points: PointSets,
        *,
        flat: bool = True,
        name: str = "image_points",
    ) -> "Correspondences":
        """Pair what `calibrate` was given, or say what does not fit together.

        `flat` asks for Z = 0 on the board; `name` is what messages call the image points.
        """
        m, seen = _stack(image_points, name, (2,))
        W, on_board = _stack(board_points, "board_points", (2, 3))
        if len(W) == 1 and len(m) > 1 and on_board is None:
            W = W[0]
        elif len(W) != len(m):
            raise ShapeError(f"{len(W)} sets of board points but {len(m)} of {name}")
        elif on_board is None and np.array_equal(W, np.broadcast_to(W[0], W.shape)):
            W = W[0]
        on, at = _counts(W, on_board, len(m)), _counts(m, seen, len(m))
        if on != at:
            i = next(i for i in range(len(m)) if on[i] != at[i])
            raise ShapeError(
                f"view {i} has {on[i]} board points but {at[i]} image points; each corner needs "
                "its partner in the same row"
            )
        W = _in_plane(W) if flat else W
        if W.shape[-2] < 4 or (seen is not None and seen.sum(1).min() < 4):
            raise DegenerateError("every view needs at least 4 points")
        _refuse_lines(m)
        return Correspondences.in_unit_frame(W, m, seen)

    @staticmethod
    def in_unit_frame(
        W: Array, m: Array, seen: npt.NDArray[np.bool_] | None = None
    ) -> "Correspondences":
        """Centre points W on 0, and scale them so that half of their diagonal is 1."""
        low, high = W.reshape(-1, 3).min(0), W.reshape(-1, 3).max(0)
        centre, scale = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
        if scale <= 1e-12 * float(np.abs(centre).max()):
            raise DegenerateError("all board points coincide")
        return Correspondences((W - centre) / scale, m, seen, centre, scale)

    def __len__(self) -> int:
        return len(self.m)

    def views(self) -> list[tuple[Array, Array]]:
        """List the (W, m) of each view, scaled, without filling."""
        W = np.broadcast_to(self.W, (*self.m.shape[:2], 3))
        if self.seen is None:
            return list(zip(W, self.m, strict=True))
        return [(w[s], m[s]) for w, m, s in zip(W, self.m, self.seen, strict=True)]

    def given(self) -> list[tuple[Array, Array]]:
        """List the (W, m) of each view in the units that were given."""
        return [(W * self.scale + self.centre, m) for W, m in self.views()]

    def on_one_board(self) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
        """List each corner of the board once: W (N, 3), m (n_views, N, 2), seen (n_views, N).

        Corners of views that have only some of them are told by where they are on the board, and
        then come row by row.
        """
        if self.W.ndim == 2:
            return self.W, self.m, np.ones(self.m.shape[:2], dtype=bool)
        W, place = self._places
        m, seen = np.empty((len(self), len(W), 2)), np.zeros((len(self), len(W)), dtype=bool)
        given = np.ones(place.shape, dtype=bool) if self.seen is None else self.seen
        for i in range(len(self)):
            at = place[i, given[i]]
            m[i], seen[i, at] = self.m[i, 0], True
            m[i, at] = self.m[i, given[i]]
            if seen[i].sum() < len(at):
                raise CvnotesError(f"view {i}: a corner of the board is given twice")
        return W, m, seen

    def on_board(self, W: Array) -> "Correspondences":
        """Return the same with the corners of `on_one_board` elsewhere, at W (N, 3)."""
        W = W if self.W.ndim == 2 else W[self._places[1]]
        return replace(self, W=W, before=self)

    @cached_property
    def _places(self) -> tuple[Array, npt.NDArray[np.intp]]:
        """All corners that any view has, row by row, and which of them each point is."""
        W, place = np.unique(self.W[..., ::-1].reshape(-1, 3), axis=0, return_inverse=True)
        return W[:, ::-1], place.reshape(self.W.shape[:2])

    def pose_in_given_units(self, R: Array, T: Array) -> Array:
        """Return G (n_views, 4, 4) of the board as it was given: T ← s T − R c."""
        G = np.zeros((len(R), 4, 4))
        G[:, :3, :3], G[:, 3, 3] = R, 1
        G[:, :3, 3] = self.scale * T - R @ self.centre
        return G

    def pose_in_scaled_units(self, G: Array) -> Array:
        """Undo `pose_in_given_units`: the scaled board's origin is seen at (R c + T) / s."""
        G = G.copy()
        G[..., :3, 3] = (G[..., :3, :3] @ self.centre + G[..., :3, 3]) / self.scale
        return G

    def pose_jacobian(self, R: Array) -> Array:
        """Differentiate the pose in given units by the scaled one: (n_views, 6, 6)."""
        J = np.zeros((len(R), 6, 6))
        J[:, :3, :3] = np.eye(3)
        J[:, 3:, 3:] = self.scale * np.eye(3)
        # d(−R c) = −ω × (R c) = [R c]× ω
        J[:, 3:, :3] = skew_matrix(R @ self.centre)
        return J


def _stack(sets: Any, name: str, dims: tuple[int, ...]) -> tuple[Array, Any]:
    """Return all views as one array (n_views, n, d), filled up, and which points are real."""
    masked = any(is_masked(s) for s in (sets, *_list(sets)))
    try:
        one = np.asarray(sets)
        uniform = one.dtype.kind in "iuf" and not masked
    except Exception:  # ragged, or no array at all: the guard below says which
        uniform = False
    if uniform and one.size == 0:
        raise DegenerateError(f"{name}: need at least one view with points, got none")
    if uniform:
        stacked = _points(one, name, dims)
        if stacked.ndim == 4 and stacked.shape[2] == 1:  # OpenCV's (n, 1, 2)
            stacked = stacked[:, :, 0]
        if stacked.ndim == 2:
            stacked = stacked[None]
        if stacked.ndim != 3:
            raise ShapeError(f"{name}: expected (views, n, {dims[0]}), got {one.shape}")
        return stacked, None
    if not _list(sets):
        numbers(sets, name)
        raise ShapeError(f"{name}: expected an array or a list of arrays")
    each = [_points(s, f"{name}[{i}]", dims) for i, s in enumerate(sets)]
    each = [s.reshape(-1, s.shape[-1]) for s in each]
    if len({s.shape[1] for s in each}) > 1:
        raise ShapeError(f"{name}: some sets have two coordinates, others three")
    n = max(len(s) for s in each)
    if min(len(s) for s in each) == 0:
        raise DegenerateError(f"{name}: a view without points; leave it out")
    filled = np.stack([np.concatenate([s, np.repeat(s[:1], n - len(s), axis=0)]) for s in each])
    seen = np.arange(n) < np.array([len(s) for s in each])[:, None]
    return filled, None if seen.all() else seen


def _list(sets: Any) -> Sequence[Any]:
    return sets if isinstance(sets, Sequence) else ()


def _points(x: Any, name: str, dims: tuple[int, ...]) -> Array:
    """Guard points, and name the view and the corner of the first NaN."""
    try:
        return points(x, name, *dims)
    except CvnotesError:
        bad = np.argwhere(~np.isfinite(x))
        if len(bad) and bad.shape[1] > 1:
            *view, corner = bad[0][:-1].tolist()
            words = f"view {view[0]}, corner {corner}" if len(view) == 1 else f"corner {corner}"
            raise CvnotesError(
                f"{name}: {words} contains NaN or infinite values; leave it out"
            ) from None
        raise


def _counts(points: Array, real: Any, n_views: int) -> list[int]:
    """How many points each view has."""
    return [points.shape[-2]] * n_views if real is None else [int(n) for n in real.sum(1)]


def _refuse_lines(m: Array) -> None:
    """Refuse views (n_views, n, 2) in which all points lie on one line."""
    n = m.shape[1]
    d = m - (np.ones(n) @ m / n)[:, None]
    spread = d.mT @ d
    uu, vv, uv = spread[:, 0, 0], spread[:, 1, 1], spread[:, 0, 1]
    size = np.maximum(uu + vv, 1e-300)
    flat = (uu / size) * (vv / size) - (uv / size) ** 2 <= 1e-14
    if flat.any():
        raise DegenerateError(
            f"view {int(np.argmax(flat))}: all its image points coincide or lie on one line"
        )


def _in_plane(W: Array) -> Array:
    """Return board points (..., 3) in the plane Z = 0, or refuse a board that is not flat."""
    if W.shape[-1] == 2:
        return np.concatenate([W, np.zeros_like(W[..., :1])], axis=-1)
    if np.abs(W[..., 2]).max(initial=0) > 1e-9 * np.abs(W).max(initial=0):
        raise CvnotesError(
            "board_points: Z must be 0 on a flat board, whose frame lies on it; for targets that "
            "are not flat there is calibrate_one_view"
        )
    return W
