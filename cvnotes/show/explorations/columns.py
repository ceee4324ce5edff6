"""Explore the board we believed: a real sheet whose corners are not quite where they were drawn."""

import warnings
from functools import partial

import numpy as np

from cvnotes.base import Array, CalibrationWarning
from cvnotes.calibration import calibrate
from cvnotes.calibration.jacobian import jacobian
from cvnotes.calibration.refinement import Problem
from cvnotes.pictures import course
from cvnotes.show.explorations.finding import rms
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, LENS, MUTED

_LENS = "k1 k2 p1 p2"
_MAGNIFIED = 100
_SHEET, _BAR = (560, 420), (250, 420)
_PALE = "#EDEDED"
_HIGHEST = 0.18  # px, of the bar
_ROUNDING = 1e-9  # smaller singular values are those of moving or scaling the whole board
_HELD = 2  # the column that is pulled, by the middle between two of its corners
_AT = 2.5


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
        columns, lines = real.board.corners
        along_x, missed = of_corners[..., 0], -r.reshape(m.shape)
        shifts = (along_x * missed).sum(axis=(0, 2)) / (along_x**2).sum(axis=(0, 2))
        self.shifts = shifts.reshape(lines, columns)  # of each corner along x, mm
        Q = _basis(taken)
        board = _without(Q, D.reshape(rows, -1))
        self._missed = _without(Q, missed.ravel())
        left = _without(_basis(board), self._missed)
        self.least = rms(left.reshape(m.shape))  # px, if every corner may move
        by_column = board.reshape(rows, lines, columns, 3)[..., 0]
        self._along_x = by_column.sum(axis=1)

    @property
    def columns(self) -> Array:
        """How far each column of corners lies beside its place, along x, in mm."""
        return np.asarray(self.shifts.mean(axis=0))

    def misses(self, columns: Array) -> Array:
        """Return observed minus predicted pixels (views, n, 2) on a board with moved columns.

        The camera and the poses are the best ones for this board.
        """
        left = self._missed - self._along_x @ columns
        return np.asarray(left.reshape(self._shape))


def _basis(columns: Array) -> Array:
    """Return an orthonormal basis of what the columns of a matrix span."""
    lengths = np.linalg.norm(columns, axis=0)
    U, s, _ = np.linalg.svd(columns / lengths, full_matrices=False)
    return np.asarray(U[:, s > _ROUNDING * s[0]])


def _without(Q: Array, x: Array) -> Array:
    """Take from x (of one column or more) what an orthonormal basis Q can explain."""
    return np.asarray(x - Q @ (Q.T @ x))


def columns_model() -> Model:
    """Make the model of the nine columns of a real sheet, as each of two cameras finds them."""
    real = course.real_corners()
    left, right = Believed(real.left), Believed(real.right)
    said = "how much of the right camera's nine shifts is put into the left camera's board"
    amount = Setting("amount", "nine numbers ×", 0, 2.5, 0.05, 1, said)
    about = (
        "A printed sheet with its nine columns of corners: blue as the left camera of a real pair "
        "finds them, orange with so much of the right camera's nine shifts; and the RMS of the "
        "left camera on a sheet with the orange columns."
    )

    def pulled(_: Values, at: Array) -> Values:
        printed = _HELD * real.board.square
        return {"amount": float((at[0] - printed) / (_MAGNIFIED * right.columns[_HELD]))}

    before = rms(left.misses(0 * right.columns))
    draw = partial(_draw, left, right, before)
    return Model("columns", about, (amount,), draw, {"nine": pulled})


def _draw(left: Believed, right: Believed, before: float, paper: Paper, values: Values) -> Drawing:
    amount = values["amount"]
    after = rms(left.misses(amount * right.columns))
    panels = _sheet(paper, left, right, amount), _bar(paper, after, before, left.least)
    if not amount:
        said = f"With the columns as they were drawn, the left camera misses by {before:.3f} px."
    else:
        gone = 1 - (after / before) ** 2
        said = (
            f"With the right camera's nine shifts × {amount:g}, the left camera misses its corners "
            f"by {after:.3f} px instead of {before:.3f}"
            + (f": {gone:.0%} of the squared misses are gone." if gone > 0 else ".")
        )
    return Drawing(paper.join(panels), said)


def _sheet(paper: Paper, left: Believed, right: Believed, amount: float) -> Panel:
    """Draw the squares, and both cameras' columns over them."""
    square = course.real_corners().board.square
    lines, columns = left.shifts.shape
    reach = square * np.array([columns - 1, lines - 1])
    across = -1.25 * square, reach[0] + 0.75 * square
    down = -1.7 * square, reach[1] + 1.7 * square
    title = f"nine columns of the sheet, shifts × {_MAGNIFIED}"
    panel = paper.panel(_SHEET, across, down, title)
    dark = [np.array([i, j]) for i in range(columns - 1) for j in range(lines - 1) if (i + j) % 2]
    corner = square * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    panel.polygons([square * at + corner for at in dark], _PALE)
    x, y = square * np.arange(columns), square * np.arange(lines)
    pulled = x + _MAGNIFIED * amount * right.columns
    found = np.stack(np.broadcast_arrays(x + _MAGNIFIED * left.shifts, y[:, None]), axis=-1)
    ends = np.array([-0.35, lines - 0.65]) * square
    for k in range(columns):
        panel.line(found[:, k], LENS, 3)
        panel.mark(found[:, k], "lens", 4)
        panel.line(np.stack([[pulled[k]] * 2, ends], axis=-1), ESTIMATED, 2)
        panel.text([pulled[k], -0.75 * square], f"{k + 1}", ESTIMATED, anchor="mm", size=14)
        panel.text([*found[-1, k] + [0, 0.75 * square]], f"{k + 1}", LENS, anchor="mm", size=14)
    held = [pulled[_HELD], _AT * square]
    panel.mark(held, "estimated", 6)
    panel.grip("nine", "the right camera's nine shifts, to be pulled aside", held, 3)
    right_of = f"by the right camera × {amount:g}" if amount else "as drawn"
    panel.text([0, -1.4 * square], f"orange, {right_of}", ESTIMATED, size=13)
    panel.text([0, reach[1] + 1.4 * square], "blue, by the left camera", LENS, size=13)
    return panel


def _bar(paper: Paper, now: float, before: float, least: float) -> Panel:
    """Draw the RMS as a bar; beside it that of the sheet as drawn, and of one of free corners."""
    panel = paper.panel(_BAR, (0, 1), (1.16 * _HIGHEST, -0.04 * _HIGHEST), "RMS, left camera (px)")
    panel.line([[0, 0], [1, 0]], MUTED, 0.8)
    panel.polygons([[[0.12, 0], [0.4, 0], [0.4, now], [0.12, now]]], ESTIMATED)
    for height, name in ((before, "as drawn"), (least, "all corners free")):
        panel.line([[0.06, height], [0.46, height]], MUTED, 1, dash=3)
        panel.text([0.49, height], name, MUTED, size=13)
    panel.text([0.26, 0.03], f"{now:.3f}", "white", anchor="mm", size=15, rim=ESTIMATED)
    return panel
