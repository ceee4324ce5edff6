"""Explore the tilt: one board's picture by a long lens, and the best a lens half as long can do."""

from functools import lru_cache, partial

import numpy as np

from cvnotes.base import Array
from cvnotes.calibration import pose_from_view
from cvnotes.camera import Camera, intrinsics, pose, rotation_from_vector
from cvnotes.show.explorations.boards import draw_arrows, draw_net
from cvnotes.show.explorations.finding import rms
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.style import ESTIMATED, FAINT, IDEAL, LENS, MUTED
from cvnotes.targets import Chessboard

_PICTURE, _CURVE = (440, 330), (410, 330)
_STEEPEST = 60  # degrees
_FAR = 2.1625  # of the board's diagonal, to the long lens
_MAGNIFIED = 6
_PALE = "#A6CEE4"  # the blue of a lens, for what lies under arrows


class _Lenses:
    """A lens and one half as long; before it the board is turned and placed anew.

    Its pose is the one whose picture is most like that of the long lens.
    """

    def __init__(self, camera: Camera, board: Chessboard) -> None:
        w, h = camera.size
        alpha, middle = float(camera.A[0, 0]), ((w - 1) / 2, (h - 1) / 2)
        self.board = board
        self.long = Camera(intrinsics(alpha, alpha, *middle), size=camera.size)
        self.short = Camera(intrinsics(alpha / 2, alpha / 2, *middle), size=camera.size)
        self.away = _FAR * float(np.linalg.norm(board.points[-1]))
        self.seen = lru_cache(maxsize=None)(self._seen)

    def _seen(self, tilt: float) -> tuple[Array, Array, float, float]:
        """Return the corners (n, 2) by either lens; how far from the short one, and how tilted."""
        R = rotation_from_vector([np.radians(tilt), 0, 0])
        W, middle = self.board.points, self.board.points.mean(axis=0)
        m = self.long.moved(pose(R, [0, 0, self.away] - R @ middle)).project(W)
        G = pose_from_view(self.short, W, m)
        near = float(G[2, :3] @ middle + G[2, 3])
        turned = float(np.degrees(np.arctan2(G[2, 1], G[2, 2])))
        return m, self.short.moved(G).project(W), near, turned

    def misfit(self, tilt: float) -> float:
        """Return the RMS of the distances between the corners of both pictures, in pixels."""
        one, other, *_ = self.seen(tilt)
        return rms(one - other)


def tilt_model(camera: Camera, board: Chessboard) -> Model:
    """Make the model of `board`, tilted before the lens of `camera` and before one half as long."""
    lenses = _Lenses(camera, board)
    settings = (
        Setting("tilt", "tilt (°)", 0, _STEEPEST, 1, 30, "turns the board about its x axis"),
    )
    about = (
        "One tilted board through two lenses. Before the second, half as long, it is turned and "
        "placed so that the pictures are most alike; below, both cameras from the side; beside it "
        "how far the pictures differ, against tilt."
    )

    drags = {"tilt": lambda _, at: {"tilt": float(at[0])}}
    return Model("tilt", about, settings, partial(_draw, lenses), drags)


def _draw(lenses: _Lenses, paper: Paper, values: Values) -> Drawing:
    tilt = values["tilt"]
    one, other, near, turned = lenses.seen(tilt)
    w, h = lenses.long.size
    title = f"one board, two lenses (arrows × {_MAGNIFIED}); below, from the side"
    picture = paper.panel(_PICTURE, (-0.5, w - 0.5), (0.18 * h, 1.18 * h), title)
    draw_net(picture, one, lenses.board, _PALE, 2)
    draw_net(picture, other, lenses.board, ESTIMATED, 1, 3)
    some = np.arange(len(one)).reshape(lenses.board.corners[::-1])[[0, -1], ::2]  # all would crowd
    draw_arrows(picture, one[some.ravel()], _MAGNIFIED * (other - one)[some.ravel()])
    picture.line([[0, 0.74 * h], [w, 0.74 * h]], FAINT, 0.8)
    _draw_side(picture, lenses, (lenses.away, tilt), (near, turned))
    misfit = lenses.misfit(tilt)
    sentence = (
        f"Tilted by {tilt:.0f}° the two pictures differ by {misfit:.1f} px (RMS of a corner): "
    )
    if not tilt:
        sentence += "no picture of this board tells the one lens from the other."
    else:
        times = misfit / (np.sqrt(2) * 0.1)
        sentence += f"{times:.2g} times what noise of 0.1 px along each axis makes of one."
    return Drawing(paper.join((picture, _curve(lenses, paper, tilt))), sentence)


def _draw_side(
    picture: Panel, lenses: _Lenses, far: tuple[float, float], near: tuple[float, float]
) -> None:
    """Draw both cameras on their axis, each (distance, tilt) with its board, to one scale."""
    w, h = lenses.long.size
    middle, a_mm = np.array([0.86 * w, 0.96 * h]), 0.8 * w / lenses.away
    half = a_mm * np.ptp(lenses.board.points[:, 1]) / 2
    for camera, (away, tilt), colour, dash, name_at in (
        (lenses.long, far, LENS, 0, 0.8 * h),
        (lenses.short, near, ESTIMATED, 4, 1.13 * h),
    ):
        end = half * np.array([np.sin(np.radians(tilt)), np.cos(np.radians(tilt))])
        eye = middle - [a_mm * away, 0]
        picture.line([eye, middle - end, middle + end, eye], colour, 1.2, dash)
        picture.line([middle - end, middle + end], colour, 2.4, dash)
        name = f"α = {camera.A[0, 0]:.0f} px from {away:.0f} mm, tilted {abs(tilt):.0f}°"
        picture.text([0.04 * w, name_at], name, colour)
        picture.mark(eye, "camera", 7, (1, 0))


def _curve(lenses: _Lenses, paper: Paper, tilt: float) -> Panel:
    """Draw the misfit up to the tilt, which the hand carries on."""
    highest = 1.15 * lenses.misfit(_STEEPEST)
    panel = paper.panel(
        _CURVE,
        (-6, _STEEPEST + 4),
        (highest, -0.12 * highest),
        "how far they differ (px) against tilt (°)",
    )
    panel.ticks(x=(0, 15, 30, 45, 60), y=np.arange(2, highest, 2), size=12)
    at = np.arange(0, tilt + 1)
    way = np.array([[t, lenses.misfit(float(t))] for t in at])
    if len(way) > 1:
        panel.line(way, ESTIMATED, 2.4)
    panel.line([[-6, 0], [_STEEPEST + 4, 0]], MUTED, 0.8)
    panel.mark(way[-1], "estimated", 8)
    panel.text(
        way[-1] + np.array([-1.5, 0.05 * highest] if tilt > 45 else [1.5, -0.03 * highest]),
        f"{way[-1, 1]:.1f} px",
        IDEAL,
        anchor="rm" if tilt > 45 else "lm",
        size=13,
    )
    panel.grip("tilt", "the board's tilt", way[-1], 4)
    return panel
