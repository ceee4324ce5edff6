"""Explore the board we believed: one sheet of paper, as each of two real cameras finds it."""

import warnings
from functools import partial

import numpy as np

from cvnotes.base import Array, CalibrationWarning
from cvnotes.calibration import calibrate
from cvnotes.calibration.jacobian import jacobian
from cvnotes.calibration.refinement import Problem
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import squares_between
from cvnotes.show.explorations.finding import rms
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, LENS, MUTED, hexed, mixed, rgb

_LENS = "k1 k2 p1 p2"
_MAGNIFIED, _LIFTED = 100, 45.0  # times; mm by which the sheet hangs over its shadow
_SHEET, _BAR, _SHOWN = (340, 240), (150, 240), ((-165.0, 165.0), (-116.5, 116.5))
_HIGHEST = 0.19  # px, of the bar
_PARTS = {"all of it": (0, 1, 2), "its shifts": (0, 1), "its heights": (2,)}
_ROUNDING = 1e-9  # smaller singular values are those of moving or scaling the whole board
_MOST, _HELD = 2.0, 29  # of the other camera's sheet; the corner that is pulled
_EYE = Camera(intrinsics(750, 750, 0, 0), look_at([120, 560, -560], [120, 82, -20], up=(0, 0, -1)))
_LIGHT = np.array([-0.55, -0.30, -0.78])
_WHITE, _SHADOW = "#F4F1EA", "#E4E4E4"


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
        U, s, _ = np.linalg.svd(taken / np.linalg.norm(taken, axis=0), full_matrices=False)
        Q = U[:, s > _ROUNDING * s[0]]
        missed = -r.reshape(rows)
        self._missed = missed - Q @ (Q.T @ missed)
        self._board = D.reshape(rows, -1)
        self._board -= Q @ (Q.T @ self._board)
        self._shape = m.shape
        self.off = {part: self._off(axes) for part, axes in _PARTS.items()}

    def _off(self, axes: tuple[int, ...]) -> Array:
        """Find how far each corner (n, 3) lies beside its place along some axes, in mm."""
        off = np.zeros((self._shape[1], 3))
        some = self._board.reshape(-1, *off.shape)[..., list(axes)]
        found = np.linalg.lstsq(some.reshape(len(some), -1), self._missed, rcond=_ROUNDING)[0]
        off[:, list(axes)] = found.reshape(len(off), -1)
        return off

    def misses(self, off: Array) -> Array:
        """Return observed minus predicted pixels (views, n, 2) on a board with moved corners.

        The camera and the poses are the best ones for this board.
        """
        left = self._missed - self._board @ np.ravel(off)
        return np.asarray(left.reshape(self._shape))


def sheets_model() -> Model:
    """Make the model of a real sheet of paper, as each of two cameras finds it."""
    real = course.real_corners()
    left, right = Believed(real.left), Believed(real.right)
    said = "how much of the right camera's sheet the left camera is given"
    amount = Setting("amount", "right camera's sheet ×", 0, _MOST, 0.05, 1, said)
    said = "along which axes corners may leave their places: within the sheet, or up and down"
    part = Setting("part", "use", 1, 3, 1, 1, said, names=tuple(_PARTS))
    about = """A printed sheet in space, its faults drawn a hundred times as large: blue as the left
    camera of a real pair finds it, orange so much of what the right one finds; and the RMS of the
    left camera on the orange sheet."""

    def pulled(values: Values, at: Array) -> Values:
        off = right.off[_part(values)]
        flat, whole = (_EYE.project(_in_space(a * off))[_HELD] for a in (0, 1))
        way = whole - flat
        return {"amount": float((at - flat) @ way / (way @ way))}

    return Model("sheets", about, (amount, part), partial(_draw, left, right), {"corner": pulled})


def _part(values: Values) -> str:
    return [*_PARTS][int(values["part"]) - 1]


def _draw(left: Believed, right: Believed, paper: Paper, values: Values) -> Drawing:
    amount = values["amount"]
    own_off, given = left.off[_part(values)], amount * right.off[_part(values)]
    before, own, after = (rms(left.misses(off)) for off in (0 * given, own_off, given))
    blue = paper.panel(_SHEET, *_SHOWN, "the left camera's own sheet")
    name = f"the right camera's sheet × {amount:g}" if amount else "a flat sheet"
    orange = paper.panel(_SHEET, *_SHOWN, name)
    _put(blue, own_off, LENS)
    _put(orange, given, ESTIMATED)
    held = _EYE.project(_in_space(given))[_HELD]
    orange.grip("corner", "a corner of the orange sheet, to be pulled up", held, 1.3)
    bar = paper.panel(_BAR, (0, 1), (1.1 * _HIGHEST, -0.04 * _HIGHEST), "left camera's RMS (px)")
    bar.polygons([[[0.1, 0], [0.42, 0], [0.42, after], [0.1, after]]], ESTIMATED)
    for height, name in ((before, "flat"), (own, "its own")):
        bar.line([[0.04, height], [0.5, height]], MUTED, 1, dash=3)
        bar.text([0.54, height], name, MUTED, size=13)
    bar.text([0.26, 0.03], f"{after:.3f}", "white", anchor="mm", size=15, rim=ESTIMATED)
    said = f"On a flat sheet the left camera misses its corners by {before:.3f} px"
    if amount:
        said += f", on the right camera's sheet × {amount:g} by {after:.3f}"
    return Drawing(paper.join((blue, orange, bar)), f"{said}; on its own sheet by {own:.3f}.")


def _in_space(off: Array) -> Array:
    """Return the corners of the sheet (54, 3) with their faults magnified, over its shadow."""
    return course.real_corners().board.points + _MAGNIFIED * off - [0, 0, _LIFTED]


def _put(panel: Panel, off: Array, ink: str) -> None:
    """Draw the sheet in the light, the far squares first, and its shadow as if it were flat."""
    W = course.real_corners().board.points
    panel.polygons([_EYE.project(W[[0, 8, 53, 45]])], _SHADOW)
    for square, dark in zip(*squares_between(_in_space(off).reshape(6, 9, 3)), strict=True):
        across = np.cross(square[2] - square[0], square[3] - square[1])
        bright = abs(across @ _LIGHT) / np.linalg.norm(across)
        full = rgb(mixed(ink, "#FFFFFF", 0.12) if dark else _WHITE)
        shade = hexed(255 * min(1.0, 0.40 + 0.68 * bright**1.5) * np.array(full))
        panel.polygons([_EYE.project(square)], shade)
