"""What next? The view of the board that would teach most about the camera.

Whoever takes photographs can hold the board in six ways at once: three numbers say where it is and
three how it is turned. Where the corners would then be seen is known, and so is how much they would
say; only their noise is not, and it does not matter.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array, CvnotesError, DegenerateError, ShapeError, points, rigid_motion
from cvnotes.calibration.board_shape import deformations
from cvnotes.calibration.correspondences import Correspondences
from cvnotes.calibration.jackknife import eliminated_by_view
from cvnotes.calibration.prediction import pixel_jacobian
from cvnotes.calibration.refinement import Problem
from cvnotes.calibration.result import Calibration
from cvnotes.camera import Camera, rotation_from_vector

_STEEPEST = float(np.radians(50))  # tilt at which corners are still found well
_FARTHER = 2.5  # times the nearest distance at which the board fits into the picture
_NEARER = 0.8  # times the nearest distance so far: the lens is not focused any nearer
_ROOM = 6.0  # px kept free along the border of the picture
_FIRST, _BEST, _AROUND, _ROUNDS = 512, 4, 48, 5  # views tried
_HALVINGS = 9  # of the interval in which the nearest distance lies: to 1 % of it
_WIDEST = 0.25  # of the range of each number, in the first round; halved from round to round
_GRID = (9, 7)  # pixels for which the camera is wanted
_SIDES = ("right side", "lower right corner", "lower side", "lower left corner",
          "left side", "upper left corner", "upper side", "upper right corner")  # fmt: skip


@dataclass(frozen=True, eq=False)
class NextView:
    """A view of the board that is proposed.

    Attributes
    ----------
    G : ndarray, shape (4, 4)
        Pose of the board, CRF ← board.
    image_points : ndarray, shape (n, 2)
        Where its corners would be seen, px.
    outline : ndarray, shape (k, 2)
        Where the board's own corners would be seen, px.
    before, after : float
        How far off a pixel of the picture may be, the camera being free to turn (see
        `prediction_std`), root mean square over the whole picture, px: now, and with such a view.
    words : str
        Where to hold the board, lengths being millimetres.
    noise_alone : bool
        Whether `before` and `after` know of noise alone, as views are too few to differ.
    """

    G: Array
    image_points: Array
    outline: Array
    before: float
    after: float
    words: str
    noise_alone: bool = False

    def __repr__(self) -> str:
        known = f"a pixel is then known to {self.after:.2g} px (now {self.before:.2g})"
        return f"{self.words}: {known}{', were there noise alone' * self.noise_alone}"


def next_view(calibration: Calibration, *, outline: npt.ArrayLike | None = None) -> NextView:
    """Propose the view of the board that makes the picture best known.

    Parameters
    ----------
    calibration : Calibration
        With its corners.
    outline : array_like, shape (k, 3), optional
        Points of the board that must be in the picture too, in order around it; by default the
        rectangle around its corners, one square larger.

    Returns
    -------
    NextView
        Of all poses in which the whole board is in the picture, tilted by at most 50° and hardly
        nearer than any before (the focus must not be touched), the one that leaves the smallest
        uncertainty of a pixel, averaged over the picture.

    Raises
    ------
    DegenerateError
        The board cannot be seen whole.

    Notes
    -----
    The view adds S to the normal matrix N of the parameters, its pose eliminated. What is known of
    them then is D (N + S)⁻¹ D, where D takes deviations of noise to those of the scatter between
    views, as in `Calibration.std_of_views`; and of a pixel, trace(J D (N + S)⁻¹ D Jᵀ), J being
    without what a turn of the camera absorbs. Five
    hundred poses are tried all over, then as many and more around the best. The board's shape,
    if it was estimated, is taken for known.

    References
    ----------
    .. [1] A. Richardson, J. Strom and E. Olson, AprilCal: assisted and repeatable camera
       calibration, IROS 2013, 1814-1821.

    Examples
    --------
    >>> from cvnotes.calibration import calibrate
    >>> from cvnotes.pictures import course
    >>> few = calibrate(course.board().points, course.measured_corners()[:6], (640, 480))
    >>> view = next_view(few)
    >>> bool(view.after < 0.8 * view.before)
    True
    """
    W = _board(calibration)
    border = _around(W) if outline is None else points(outline, "outline", 3)
    if border.ndim != 2 or len(border) < 3:
        raise ShapeError(f"outline: expected at least three points (k, 3), got {border.shape}")
    search = _Search.of(calibration, W, border)
    p = _low_discrepancy(_FIRST)
    p, score = search.best(p)
    for i in range(_ROUNDS):
        step = 2 * (_low_discrepancy(_BEST * _AROUND, skip=_FIRST * (i + 1)) - 0.5)
        around = np.repeat(p, _AROUND, axis=0) + _WIDEST / 2**i * step
        around[:, _TURNS] %= 1  # a direction goes round
        p, score = search.best(np.concatenate([p, around.clip(0, 1)]))
    if not np.isfinite(score[0]):
        raise DegenerateError("the board cannot be seen whole by this camera, tilted or not")
    G = search.poses(p[:1])[0]
    camera = calibration.camera.moved(G)
    return NextView(
        G,
        camera.project(W),
        camera.project(border),
        search.now,
        float(score[0]),
        _where_to_hold(calibration.camera, G, W),
        calibration.honest_std == calibration.std,
    )


def left_with(calibration: Calibration, G: npt.ArrayLike) -> float:
    """Describe how far off a pixel may be, px, with one more view of the board.

    Parameters
    ----------
    calibration : Calibration
        With its corners.
    G : array_like, shape (4, 4)
        Pose of the board, CRF ← board, wherever it is; see `NextView.after`.

    Examples
    --------
    >>> from cvnotes.calibration import calibrate
    >>> from cvnotes.pictures import course
    >>> few = calibrate(course.board().points, course.measured_corners()[:6], (640, 480))
    >>> view = next_view(few)
    >>> bool(np.isclose(left_with(few, view.G), view.after))
    True
    >>> bool(left_with(few, few.poses[0]) > view.after)
    True
    """
    G, W = rigid_motion(G), _board(calibration)
    if G.ndim != 2:
        raise ShapeError(f"G: expected one pose (4, 4), got {G.shape}")
    search = _Search.of(calibration, W, _around(W))
    scaled = search.data.pose_in_scaled_units(G[None])
    return float(search._left(scaled[:, :3, :3], scaled[:, :3, 3])[0])


def _where_to_hold(camera: Camera, G: Array, W: Array) -> str:
    """Say in words where a board of corners W (n, 3) is, as who holds it needs to know."""
    R, middle = G[:3, :3], G[:3, :3] @ W.mean(0) + G[:3, 3]
    distance = float(np.linalg.norm(middle))
    to_sight = _facing((middle / distance)[None])[0].T
    normal = -(to_sight @ R[:, 2])
    normal *= np.sign(-normal[2]) or 1.0
    tilt = float(np.degrees(np.arccos(min(1.0, -normal[2]))))
    roll = to_sight @ R[:, 0]
    roll = float(np.degrees(np.arctan2(roll[1], roll[0])))
    seen = camera.moved(G).project(W).mean(0)
    where = _place(seen, camera.size)
    words = f"{where}, {distance / 10:.0f} cm away, "
    if tilt < 5:
        words += "facing the camera"
    else:
        side = _SIDES[round(np.degrees(np.arctan2(normal[1], normal[0])) / 45) % 8]
        words += f"tilted by {tilt:.0f}° with its {side} farther away"
    if abs(roll) >= 8:
        words += f", turned by {abs(roll):.0f}° {'clockwise' if roll > 0 else 'anticlockwise'}"
    return words


def _place(m: Array, size: tuple[int, int]) -> str:
    """Describe in which part of the picture a board is, by its middle."""
    fifth = np.floor(5 * (m + 0.5) / size).clip(0, 4).astype(int)
    across, down = (fifth > 1).astype(int) + (fifth > 2)
    height, side = ("upper", "", "lower")[down], ("left", "", "right")[across]
    if height and side:
        return f"{height} {side} corner of the picture"
    if height:
        return "at the top of the picture" if down == 0 else "at the bottom of the picture"
    return f"{side} in the picture" if side else "middle of the picture"


def _board(calibration: Calibration) -> Array:
    """Return all corners of the board, (n, 3), row by row."""
    if not calibration.board_points:
        raise CvnotesError("the views must come with their corners")
    if calibration.shape is not None:
        return calibration.shape.points
    W = np.concatenate(calibration.board_points)
    return np.unique(W[:, ::-1], axis=0)[:, ::-1]


def _variance(calibration: Calibration, W: Array) -> float:
    """Variance of the noise per coordinate, as the calibration found it."""
    n = sum(map(len, calibration.image_points))
    shape = calibration.shape
    of_shape = 0 if shape is None else len(deformations(shape.kind, W - W.mean(0)))
    freedom = 2 * n - len(calibration.names) - 6 * len(calibration.poses) - of_shape
    return calibration.rms**2 * n / freedom


def _around(W: Array) -> Array:
    """Rectangle (8, 3) around corners, larger by the distance between neighbours."""
    low, high = W.min(0), W.max(0)
    square = np.linalg.norm((W[1:] - W[0])[:, :2], axis=1).min()
    (x0, y0), (x1, y1) = low[:2] - square, high[:2] + square
    x, y = (x0 + x1) / 2, (y0 + y1) / 2
    around = [(x0, y0), (x, y0), (x1, y0), (x1, y), (x1, y1), (x, y1), (x0, y1), (x0, y)]
    return np.array([(*xy, 0.0) for xy in around])


_TURNS = 3  # which of the six numbers is the direction of the tilt


@dataclass(frozen=True, eq=False)
class _Search:
    """What a view is judged by. Six numbers from 0 to 1 are a view.

    They are the place of the board's middle in the picture (2), how far it tilts and to which side,
    how it is turned in the picture, and how far away it is.
    """

    camera: Camera
    data: Correspondences  # of one view; where it was seen does not matter
    names: tuple[str, ...]
    outline: Array  # in the scaled units of data
    normal: Array  # (q, q), in units in which the covariance of views is its inverse
    wanted: Array  # (q, q), mean JᵀJ of the picture's pixels
    scale: Array  # (q,) parameters per such unit
    focused: float  # the least distance, scaled

    @staticmethod
    def of(calibration: Calibration, W: Array, outline: Array) -> "_Search":
        """Prepare a search; noise is scaled to what views scatter by, parameter by parameter."""
        names = calibration.names
        noise = np.sqrt(np.diag(calibration.covariance))
        data = Correspondences.in_unit_frame(W, np.zeros((1, len(W), 2)))
        u, v = (np.linspace(0, n - 1, k) for n, k in zip(calibration.size, _GRID, strict=True))
        m = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
        J = pixel_jacobian(calibration, m) * np.array([*calibration.honest_std.values()])
        J = J[np.isfinite(J).all((1, 2))]
        correlation = calibration.covariance / np.outer(noise, noise)
        so_far = data.pose_in_scaled_units(calibration.poses)[:, :3, 3]
        residual = np.sqrt(_variance(calibration, W))
        return _Search(
            calibration.camera,
            data,
            names,
            (outline - data.centre) / data.scale,
            np.linalg.inv(correlation),
            np.einsum("mci,mcj->ij", J, J) / max(len(J), 1),
            noise / max(residual, np.finfo(float).tiny),
            _NEARER * float(np.linalg.norm(so_far, axis=-1).min()),
        )

    @property
    def now(self) -> float:
        """How far off a pixel may be without another view, px."""
        return float(np.sqrt(np.trace(self.wanted @ np.linalg.inv(self.normal))))

    def poses(self, p: Array) -> Array:
        """Poses (k, 4, 4) in the units of the board."""
        R, T, _ = self._placed(p)
        return self.data.pose_in_given_units(R, T)

    def best(self, p: Array) -> tuple[Array, Array]:
        """Return the best of many views (k, 6), and what they leave of the uncertainty, px."""
        R, T, seen = self._placed(p)
        left = np.full(len(p), np.inf)
        if seen.any():
            left[seen] = self._left(R[seen], T[seen])
        order = np.argsort(left, kind="stable")[:_BEST]
        return p[order], left[order]

    def _left(self, R: Array, T: Array) -> Array:
        """How far off a pixel may be with each of the views added, px."""
        data = self.data
        many = Correspondences(
            data.W, np.zeros((len(R), len(data.W), 2)), None, data.centre, data.scale
        )
        problem = Problem.at(self.camera, self.names, many)
        G = np.concatenate([R, T[..., None]], axis=-1)
        S, _ = eliminated_by_view(problem, problem.state(self.camera, G))
        after = np.linalg.inv(self.normal + S * np.outer(self.scale, self.scale))
        return np.asarray(np.sqrt(np.einsum("ij,kji->k", self.wanted, after)))

    def _placed(self, p: Array) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
        """Rotations, translations (scaled), and which of the boards are whole in the picture."""
        size = np.array(self.camera.size)
        xy = self.camera.ideal(p[:, :2] * size - 0.5)
        sight = np.concatenate([xy, np.ones((len(p), 1))], axis=1)
        known = np.isfinite(xy).all(1)
        sight = np.where(known[:, None], sight, [0.0, 0.0, 1.0])
        sight /= np.linalg.norm(sight, axis=1, keepdims=True)
        tilt, side = _STEEPEST * p[:, 2], 2 * np.pi * p[:, _TURNS]
        axis = np.stack([np.cos(side), np.sin(side), np.zeros_like(side)], axis=1)
        upright = np.zeros((len(p), 3))
        upright[:, 2] = np.pi * (p[:, 4] - 0.5)
        R = _facing(sight) @ rotation_from_vector(tilt[:, None] * axis)
        R = R @ rotation_from_vector(upright)
        nearest, fits = self._nearest(R, sight)
        far = np.maximum(nearest, self.focused) * (1 + (_FARTHER - 1) * p[:, 5])
        T = far[:, None] * sight
        return R, T, known & fits & self._inside(R, T)

    def _nearest(self, R: Array, sight: Array) -> tuple[Array, npt.NDArray[np.bool_]]:
        """Return the least distances at which boards are whole in the picture, by bisection."""
        low, high = np.full(len(R), 0.1), np.full(len(R), 30.0)  # of half the board's diagonal
        fits = self._inside(R, high[:, None] * sight)
        for _ in range(_HALVINGS):
            middle = np.sqrt(low * high)
            inside = self._inside(R, middle[:, None] * sight)
            low, high = np.where(inside, low, middle), np.where(inside, middle, high)
        return high, fits

    def _inside(self, R: Array, T: Array) -> npt.NDArray[np.bool_]:
        """Return which boards (k,) have their outline in the picture, and before the camera."""
        M = self.outline @ R.mT + T[:, None]
        with np.errstate(all="ignore"):
            m = Camera.project.inside(self.camera, M)
            room = np.array(self.camera.size) - 1 - _ROOM
            inside = ((m >= _ROOM) & (m <= room)).all((1, 2))
        return np.asarray(inside & (M[..., 2] > 0).all(1))


def _facing(sight: Array) -> Array:
    """Rotations (k, 3, 3) that take the optical axis to lines of sight (k, 3), without a roll."""
    x = np.stack([sight[:, 2], np.zeros(len(sight)), -sight[:, 0]], axis=1)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x, np.cross(sight, x), sight], axis=-1)


def _low_discrepancy(n: int, skip: int = 0) -> Array:
    """Points (n, 6) that fill the unit cube evenly: multiples of powers of a golden ratio.

    With φ⁷ = φ + 1, no two of the six coordinates ever fall into step.
    """
    golden = 1.0
    for _ in range(40):
        golden = (1 + golden) ** (1 / 7)
    alpha = golden ** -np.arange(1.0, 7)
    return np.asarray((0.5 + np.arange(skip + 1, skip + n + 1)[:, None] * alpha) % 1)
