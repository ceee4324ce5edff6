"""Explore the board we believed: a real sheet whose corners are not quite where they were drawn."""

import warnings
from functools import cached_property, partial

import numpy as np

from cvnotes.base import Array, CalibrationWarning
from cvnotes.calibration import calibrate
from cvnotes.calibration.jacobian import jacobian
from cvnotes.calibration.refinement import Problem
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import draw_arrows, draw_measured
from cvnotes.show.explorations.finding import rms
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, LENS, MUTED

_LENS = "k1 k2 p1 p2"
_MAGNIFIED = 100
_PICTURE, _BARS, _CHART = (340, 255), (200, 255), (310, 255)
_FREE = ("nothing", "heights", "shifts", "both")
_AXES: tuple[tuple[int, ...], ...] = ((), (2,), (0, 1), (0, 1, 2))  # x and y lie in the sheet
_WORDS = (
    "",
    " and each corner free to leave the plane",
    " and each corner free within the sheet",
    " and each corner free in space",
)
_HIGHEST = 0.2  # px, of the bars
_SHIFT = 0.2  # mm, of the chart
_ROUNDING = 1e-9  # smaller singular values are those of moving or scaling the whole board
_HELD = 2  # the column whose mark is a grip


class Believed:
    """One camera's photographs of the real board, and what they say of its corners.

    The corners miss their places by tenths of a millimetre half a metre away, so the pixels, and
    the camera and the poses that follow, are linear in them: r − D e, of which the camera and the
    poses take what they can.

    Parameters
    ----------
    m : ndarray, shape (views, n, 2)
        Where the corners of the course's real board were seen.
    """

    def __init__(self, m: Array) -> None:
        real = course.real_corners()
        with warnings.catch_warnings(action="ignore", category=CalibrationWarning):
            found = calibrate(real.board.points, m, real.size, lens=_LENS)
        problem = Problem(real.board.points, m, coefficients=found.names[4:], size=real.size)
        J, r = jacobian(problem, problem.state(found.camera, found.poses))
        views, n = m.shape[:2]
        of_shared, of_poses = np.split(J, [len(problem.names)], axis=-1)
        of_corners = np.einsum("vnct,vtj->vncj", of_poses[..., 3:], found.poses[:, :3, :3])
        D, P = np.zeros((views, n, 2, n, 3)), np.zeros((views, n, 2, views, 6))
        D[:, range(n), :, range(n)] = of_corners.transpose(1, 0, 2, 3)
        P[range(views), :, :, range(views)] = of_poses
        rows = 2 * views * n
        taken = np.hstack([of_shared.reshape(rows, -1), P.reshape(rows, -1)])
        self._shape = m.shape
        Q = _basis(taken)
        self._board = _without(Q, D.reshape(rows, -1)).reshape(rows, n, 3)
        self._missed = _without(Q, -r.ravel())
        within = self._board[..., _AXES[2]].reshape(rows, -1)
        shifts = np.linalg.lstsq(within, self._missed, rcond=_ROUNDING)[0].reshape(n, 2)
        columns, lines = real.board.corners
        self.shifts = shifts[:, 0].reshape(lines, columns)  # of each corner along x, mm

    @property
    def columns(self) -> Array:
        """How far each column of corners lies beside its place, along x, in mm."""
        return np.asarray(self.shifts.mean(axis=0))

    def misses(self, free: int, columns: Array) -> Array:
        """Return observed minus predicted pixels (views, n, 2), camera and poses at their best.

        The board's columns are moved by so much, and in addition its corners are as `free` as
        `_FREE` says.
        """
        along_x = self._board[..., 0].reshape(len(self._board), *self.shifts.shape).sum(axis=1)
        left = self._missed - along_x @ columns
        return _without(self._of_free[free], left).reshape(self._shape)

    @cached_property
    def _of_free(self) -> list[Array]:
        """A basis of what corners that are as free as that can explain."""
        rows = len(self._board)
        none = np.zeros((rows, 0))
        return [none, *(_basis(self._board[..., axes].reshape(rows, -1)) for axes in _AXES[1:])]


def _basis(columns: Array) -> Array:
    """Return an orthonormal basis of what the columns of a matrix span."""
    U, s, _ = np.linalg.svd(columns / np.linalg.norm(columns, axis=0), full_matrices=False)
    return np.asarray(U[:, s > _ROUNDING * s[0]])


def _without(Q: Array, x: Array) -> Array:
    """Take from x (of one column or more) what an orthonormal basis Q can explain."""
    return np.asarray(x - Q @ (Q.T @ x))


def columns_model() -> Model:
    """Make the model of the left camera's misses, and of what may move on its board."""
    real = course.real_corners()
    left, right = Believed(real.left), Believed(real.right)
    settings = (
        Setting("amount", "nine numbers ×", 0, 1.3, 0.05, 0,
                "how much of the right camera's nine shifts is put into the left camera's board"),
        Setting("free", "free to move", 0, 3, 1, 0, "0 nothing, 1 heights, 2 shifts, 3 both"),
        Setting("photograph", "photograph", 0, len(real.left) - 1, 1, 7,
                "which of the left camera's photographs"),
    )  # fmt: skip
    about = (
        "What the left camera of a real pair misses, in one photograph; how large its RMS is if "
        "corners of the board may move; and how far each column of corners is shifted."
    )

    def pulled(_: Values, at: Array) -> Values:
        return {"amount": float(at[1] / right.columns[_HELD])}

    drags = {"nine": pulled, "free": lambda _, at: {"free": float(np.floor(at[0]))}}
    return Model("columns", about, settings, partial(_draw, left, right), drags)


def _draw(left: Believed, right: Believed, paper: Paper, values: Values) -> Drawing:
    amount, free, i = values["amount"], int(values["free"]), int(values["photograph"])
    columns = amount * right.columns
    misses = left.misses(free, columns)
    real = course.real_corners()
    picture = paper.picture_panel(
        _PICTURE, real.size, f"left camera, photograph {i}: misses × {_MAGNIFIED}"
    )
    draw_measured(picture, real.left[i], real.board)
    draw_arrows(picture, real.left[i], -_MAGNIFIED * misses[i])
    bars = _bars(paper, [rms(left.misses(j, columns)) for j in range(len(_FREE))], free)
    chart = _chart(paper, left, right, amount)
    sentence = _sentence(rms(left.misses(0, 0 * columns)), rms(misses), amount, free)
    return Drawing(paper.join((picture, bars, chart)), sentence)


def _sentence(before: float, after: float, amount: float, free: int) -> str:
    given = "the board as it was drawn"
    if amount:
        given = f"the right camera's nine shifts × {amount:g} in the board"
    said = f"With {given}{_WORDS[free]}, the left camera misses its corners by {after:.3f} px"
    if not amount and not free:
        return f"{said} (RMS)."
    gone = max(1 - (after / before) ** 2, 0)
    return f"{said} instead of {before:.3f}: {gone:.0%} of the squared misses are gone."


def _bars(paper: Paper, heights: list[float], free: int) -> Panel:
    """Draw the RMS for everything that may be free; the chosen one is orange."""
    panel = paper.panel(_BARS, (0, len(_FREE)), (_HIGHEST, -0.025), "RMS (px) if these may move")
    for k, height in enumerate(heights):
        chosen = k == free
        panel.line([[k + 0.5, 0], [k + 0.5, height]], ESTIMATED if chosen else FAINT, 1.5)
        if not chosen:
            panel.polygons([[k + 0.5, height] + circle(17)[:-1] * [0.05, 0.0022]], MUTED)
        panel.text([k + 0.5, height + 0.008], f"{height:.3f}", IDEAL, anchor="ms", size=11)
        panel.text([k + 0.5, -0.013], _FREE[k], IDEAL, anchor="mm", size=10)
    panel.line([[0, 0], [len(_FREE), 0]], MUTED, 0.8)
    panel.mark([free + 0.5, heights[free]], "estimated", 6)
    panel.grip("free", "what is free to move", [free + 0.5, heights[free]], 8)
    return panel


def _chart(paper: Paper, left: Believed, right: Believed, amount: float) -> Panel:
    """Draw the shift of each column: the left camera's, and so much of the right camera's."""
    n = len(left.columns)
    panel = paper.panel(
        _CHART, (-1.4, n - 0.4), (_SHIFT + 0.02, -_SHIFT - 0.10), "shift of the nine columns (mm)"
    )
    panel.ticks(y=(-0.1, 0.1), size=12)
    panel.line([[-1.4, 0.0], [float(n), 0.0]], MUTED, 0.8)
    at = np.arange(n)
    own = np.stack([at, left.columns], axis=-1)
    for row in left.shifts:
        panel.mark(np.stack([at, row], axis=-1), "lens", 3)
    panel.line(own, LENS, 2)
    panel.mark(own, "lens", 6)
    others = np.stack([at, amount * right.columns], axis=-1)
    panel.line(others, ESTIMATED, 1, dash=3)
    panel.mark(others, "estimated", 6)
    panel.grip("nine", "the right camera's nine shifts, to be pulled up", others[_HELD], 3)
    panel.text([0.4, -0.245], "by the left camera; dots: its single corners", LENS)
    panel.text([0.4, -0.28], f"by the right camera, × {amount:g}", ESTIMATED)
    return panel
