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
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED
from cvnotes.targets import Chessboard

_PICTURE, _CURVE = (440, 330), (410, 330)
_STEEPEST = 60  # degrees
_FAR = 2.1625  # of the board's diagonal, to the long lens
_MAGNIFIED = 10


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
        "placed so that the pictures are most alike; beside it how far they differ, against tilt."
    )

    drags = {"tilt": lambda _, at: {"tilt": float(at[0])}}
    return Model("tilt", about, settings, partial(_draw, lenses), drags)


def _draw(lenses: _Lenses, paper: Paper, values: Values) -> Drawing:
    tilt = values["tilt"]
    one, other, near, turned = lenses.seen(tilt)
    alpha, short = lenses.long.A[0, 0], lenses.short.A[0, 0]
    picture = paper.picture_panel(
        _PICTURE, lenses.long.size, f"one board, two lenses (arrows × {_MAGNIFIED})"
    )
    for m, colour, width in ((one, LENS, 2.4), (other, ESTIMATED, 1.2)):
        draw_net(picture, m, lenses.board, colour, width)
    draw_arrows(picture, one, _MAGNIFIED * (other - one))
    w, h = lenses.long.size
    picture.text(
        [0.03 * w, 0.88 * h],
        f"blue: α = {alpha:.0f} px, from {lenses.away:.0f} mm, tilted {tilt:.0f}°",
        LENS,
    )
    picture.text(
        [0.03 * w, 0.94 * h],
        f"orange: α = {short:.0f} px, from {near:.0f} mm, tilted {turned:.0f}°",
        ESTIMATED,
    )
    misfit = lenses.misfit(tilt)
    sentence = f"Tilted by {tilt:.0f}° the two pictures differ by {misfit:.1f} px (RMS): "
    if misfit < 0.05:
        sentence += "no picture of this board tells the one lens from the other."
    else:
        sentence += f"with corners good to 0.1 px that is {misfit / 0.1:.0f} times the noise."
    return Drawing(paper.join((picture, _curve(lenses, paper, tilt))), sentence)


def _curve(lenses: _Lenses, paper: Paper, tilt: float) -> Panel:
    """Draw the misfit up to the tilt, which the hand carries on."""
    highest = 1.15 * lenses.misfit(_STEEPEST)
    panel = paper.panel(
        _CURVE,
        (-6, _STEEPEST + 4),
        (highest, -0.12 * highest),
        "how far they differ (px) against tilt (°)",
    )
    panel.ticks(x=(0, 15, 30, 45, 60), y=np.arange(1, np.floor(highest) + 1), size=12)
    at = np.arange(0, tilt + 1)
    way = np.array([[t, lenses.misfit(float(t))] for t in at])
    if len(way) > 1:
        panel.line(way, ESTIMATED, 2.4)
    panel.line([[-6, 0], [_STEEPEST + 4, 0]], MUTED, 0.8)
    panel.mark(way[-1], "estimated", 8)
    panel.text(
        way[-1] + [1.5, -0.03 * highest], f"{way[-1, 1]:.1f} px", IDEAL, anchor="lm", size=13
    )
    panel.grip("tilt", "the board's tilt", way[-1], 4)
    return panel
