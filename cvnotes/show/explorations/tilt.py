"""Explore the tilt: one board's picture by a long lens, and the best another lens can do."""

from functools import lru_cache, partial

import numpy as np
from numpy.polynomial import Polynomial

from cvnotes.base import Array
from cvnotes.calibration import pose_from_view
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_vector
from cvnotes.show.explorations.boards import draw_net
from cvnotes.show.explorations.finding import rms
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, LENS, MUTED
from cvnotes.targets import Chessboard

_PICTURE, _VALLEY = (440, 330), (410, 330)
_STEEPEST = 60  # degrees
_SHORTEST, _LONGEST = 300, 1000  # px, of the other lens
_NODES = np.array([300, 350, 425, 540, 660, 800, 1000])
_FAR = 2.1625  # of the board's diagonal, to the long lens
_MAGNIFIED = 6
_HIGHEST = 10  # px, of the valley's sides
_GRID = "#E6E6E6"
_BESIDE = (10, 20, 45)  # degrees: the valleys of these tilts lie beside it
_NOISE = 0.1 * np.sqrt(2)  # px, what noise of 0.1 px along each axis makes of a corner
_THEIRS = "#E3C3B0"  # the orange of those
_PALE = "#A6CEE4"  # the blue of a lens, for what lies under arrows
_SIDE = (0.86, 0.96, 0.64)  # where the boards stand, in widths and heights; how far the long lens


class _Lenses:
    """A lens and another one, before which the board is turned and placed anew.

    Its pose is the one whose picture is most like that of the first.
    """

    def __init__(self, camera: Camera, board: Chessboard) -> None:
        w, h = self.size = camera.size
        self.alpha, self.middle = float(camera.A[0, 0]), ((w - 1) / 2, (h - 1) / 2)
        self.board = board
        self.away = _FAR * float(np.linalg.norm(board.points[-1]))
        self.seen = lru_cache(maxsize=None)(self._seen)
        self.valley = lru_cache(maxsize=None)(self._valley)

    def camera(self, alpha: float) -> Camera:
        return Camera(intrinsics(alpha, alpha, *self.middle), size=self.size)

    def _seen(self, tilt: float, alpha: float) -> tuple[Array, Array, float, float]:
        """Return the corners (n, 2) by either lens; how far from the other, and how tilted."""
        R, other = rotation_from_vector([np.radians(tilt), 0, 0]), self.camera(alpha)
        W, middle = self.board.points, self.board.points.mean(axis=0)
        held = pose(R, [0, 0, self.away] - R @ middle)
        m = self.camera(self.alpha).moved(held).project(W)
        G = pose_from_view(other, W, m)
        near = float(G[2, :3] @ middle + G[2, 3])
        turned = float(np.degrees(np.arctan2(G[2, 1], G[2, 2])))
        return m, other.moved(G).project(W), near, turned

    def misfit(self, tilt: float, alpha: float) -> float:
        """Return the RMS of the distances between the corners of both pictures, in pixels."""
        one, other, *_ = self.seen(tilt, alpha)
        return rms(one - other)

    def _valley(self, tilt: float) -> Polynomial:
        """Return the misfit, with a sign, by how many times the other lens is shorter."""
        misfit = [self.misfit(tilt, float(alpha)) for alpha in _NODES]
        return Polynomial.fit(self.alpha / _NODES, np.sign(self.alpha - _NODES) * misfit, 6)


def tilt_model(camera: Camera, board: Chessboard) -> Model:
    """Make the model of `board`, tilted before the lens of `camera` and before another one."""
    lenses = _Lenses(camera, board)
    settings = (
        Setting("tilt", "tilt (°)", 0, _STEEPEST, 1, 30, "turns the board about its x axis"),
        Setting("alpha", "other lens, α (px)", _SHORTEST, _LONGEST, 5, 400, "how long it is"),
    )
    about = """One tilted board through two lenses. Before the second it is turned and placed so
    that the pictures are most alike; below, both cameras from the side; beside it how far the
    pictures differ, against the length of the second lens."""

    def tilted(_: Values, at: Array) -> Values:
        x, y = np.array([_SIDE[0] * camera.size[0], _SIDE[1] * camera.size[1]]) - at
        return {"tilt": float(np.degrees(np.arctan2(x, max(y, 0))))}

    drags = {"board": tilted, "lens": placed("alpha")}
    return Model("tilt", about, settings, partial(_draw, lenses), drags)


def _draw(lenses: _Lenses, paper: Paper, values: Values) -> Drawing:
    tilt, alpha = values["tilt"], values["alpha"]
    one, other, near, turned = lenses.seen(tilt, alpha)
    w, h = lenses.size
    title = f"one board, two lenses (arrows × {_MAGNIFIED}); below, from the side"
    picture = paper.panel(_PICTURE, (-0.5, w - 0.5), (0.18 * h, 1.18 * h), title)
    draw_net(picture, one, lenses.board, _PALE, 2)
    draw_net(picture, other, lenses.board, ESTIMATED, 1, 3)
    some = np.arange(len(one)).reshape(lenses.board.corners[::-1])[[0, -1], ::2]  # all would crowd
    bent = _MAGNIFIED * (other - one)
    picture.arrows(one[some.ravel()], bent[some.ravel()], ESTIMATED, 1.2)
    picture.line([[0, 0.74 * h], [w, 0.74 * h]], FAINT, 0.8)
    _draw_side(picture, lenses, (lenses.alpha, lenses.away, tilt), (alpha, near, turned))
    misfit = lenses.misfit(tilt, alpha)
    sentence = f"""Tilted by {tilt:.0f}° the pictures of α = {lenses.alpha:.0f} and {alpha:.0f} px
    differ by {misfit:.1f} px (RMS of a corner): """
    if alpha == lenses.alpha:
        sentence += "it is the same lens."
    elif not tilt:
        sentence += "no picture of this board tells the one lens from the other."
    else:
        times = misfit / _NOISE
        sentence += f"{times:.2g} times the {_NOISE:.2f} px of noise, 0.1 px along each axis."
    return Drawing(paper.join((picture, _draw_valley(lenses, paper, tilt, alpha))), sentence)


def _draw_side(
    picture: Panel, lenses: _Lenses, far: tuple[float, ...], near: tuple[float, ...]
) -> None:
    """Draw both cameras on their axis, each (α, distance, tilt) with its board, to one scale."""
    w, h = lenses.size
    middle, a_mm = np.array([_SIDE[0] * w, _SIDE[1] * h]), _SIDE[2] * w / lenses.away
    half = a_mm * np.ptp(lenses.board.points[:, 1]) / 2
    both = (far, LENS, 0, 0.8 * h), (near, ESTIMATED, 4, 1.13 * h)
    for (alpha, away, tilt), colour, dash, name_at in both:
        end = half * np.array([np.sin(np.radians(tilt)), np.cos(np.radians(tilt))])
        eye = middle - [a_mm * away, 0]
        picture.line([eye, middle - end, middle + end, eye], colour, 1.2, dash)
        picture.line([middle - end, middle + end], colour, 2.4, dash)
        name = f"α = {alpha:.0f} px from {away:.0f} mm, tilted {abs(tilt):.0f}°"
        picture.text([0.04 * w, name_at], name, colour)
        wedge = 7 * picture.pixel * np.array([[1, 0], [-0.8, 0.6], [-0.8, -0.6]])
        picture.polygons([eye + wedge], colour)
    end = half * np.array([np.sin(np.radians(far[2])), np.cos(np.radians(far[2]))])
    picture.grip("board", "the board's upper edge, to tilt it", middle - end, 4)


def _draw_valley(lenses: _Lenses, paper: Paper, tilt: float, alpha: float) -> Panel:
    """Draw the misfit against the other lens: where it is not above the noise, any lens will do."""
    ends = _SHORTEST - 70, _LONGEST + 90
    title = "how far they differ (px) against the other lens, α (px)"
    panel = paper.panel(_VALLEY, ends, (_HIGHEST, -0.15 * _HIGHEST), title)
    panel.polygons([[[ends[0], 0], [ends[1], 0], [ends[1], _NOISE], [ends[0], _NOISE]]], FAINT)
    panel.ticks(x=(400, 600, 800, 1000), size=12)
    for px in (2, 4, 6, 8):  # on the right, apart from the angles on the left
        panel.line([[ends[0], px], [ends[1], px]], _GRID, 0.5)
        panel.text([ends[1] - 8, px], f"{px} px", MUTED, anchor="rm", size=12)
    panel.line([[ends[0], 0], [ends[1], 0]], MUTED, 0.8)
    panel.line([[lenses.alpha, 0], [lenses.alpha, _HIGHEST]], LENS, 1, dash=4)
    panel.text([lenses.alpha - 10, 9.5], "the same lens", LENS, anchor="rm", size=13)
    panel.text([ends[0] + 8, -0.7], "noise", MUTED, size=12)
    at = np.linspace(_SHORTEST, _LONGEST, 71)
    for other, colour, width in (*((t, _THEIRS, 1.2) for t in _BESIDE), (tilt, ESTIMATED, 2.4)):
        way = np.column_stack([at, np.abs(lenses.valley(float(other))(lenses.alpha / at))])
        panel.line(way, colour, width)
        if other != tilt:
            panel.text([_SHORTEST - 8, way[0, 1]], f"{other}°", MUTED, anchor="rm", size=12)
    panel.text([_LONGEST + 20, way[-1, 1]], f"{tilt:.0f}°", ESTIMATED, size=13)
    x, y = alpha, lenses.misfit(tilt, alpha)
    panel.mark([x, y], "estimated", 8)
    above = x > lenses.alpha or y < 1
    beside, anchor = ([14, 0.35], "lm") if alpha < 380 else ([-14, 0.6 if above else -0.5], "rm")
    if y < 0.1:  # above it the other tilts' curves run together
        beside, anchor = ([34, -0.5], "lm") if alpha < 900 else ([-24, -0.5], "rm")
    panel.text(np.add([x, y], beside), f"{y:.1f} px", IDEAL, anchor=anchor, size=13)
    panel.grip("lens", "the other lens, longer or shorter", [x, y], 4)
    return panel
