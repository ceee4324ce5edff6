"""Explore the warp: the same map forward, with its holes, and backward, without."""

from functools import partial

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, pose, rotation_from_vector
from cvnotes.pictures import render
from cvnotes.show.explorations.boards import pinhole
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Paper
from cvnotes.show.style import ESTIMATED, LENS, rgb
from cvnotes.targets import Chessboard
from cvnotes.warping import backward_warp, compose, forward_warp, rotation_map, zoom_map

_WIDTH = 105  # px of the source: few enough to see each one, and odd as its height of 79, so that
#             quarter turns about the middle take pixels to pixels
_LARGER = 4  # px of the page for a pixel
_MOST = 3  # times as large
_ARM = 0.12  # of the width, from the middle to where the picture is taken hold of: in the frame
_LIGHT = "#7CC9F5"  # the blue of a fold on white
_PAPER = 255  # grey level where the source has nothing to show


def warp_model(camera: Camera, board: Chessboard) -> Model:
    """Make the model of a small picture of `board` by `camera`, turned and zoomed."""
    settings = (
        Setting("angle", "rotation (°)", -180, 180, 1, 20, "clockwise on the screen: v runs down"),
        Setting("zoom", "zoom", 0.25, _MOST, 0.05, 1.2, "by how much distances grow"),
        Setting("bilinear", "bilinear", 0, 1, 1, 0, "backward: bilinear, else nearest neighbour"),
    )
    about = (
        "A small picture turned and zoomed twice by the same map: forward, where pixels that "
        "receive nothing are orange holes, and those hit twice blue, and backward, without any."
    )
    source = _source(camera, board)
    height, width = source.shape
    middle = np.array([width - 1, height - 1]) / 2

    def pulled(_: Values, at: Array) -> Values:
        x, y = at - middle
        zoom = np.hypot(x, y) / (_ARM * width)
        return {"angle": float(np.degrees(np.arctan2(y, x))), "zoom": float(zoom)}

    return Model("warp", about, settings, partial(_draw, source), {"right side": pulled})


def _draw(source: Drawn, paper: Paper, values: Values) -> Drawing:
    height, width = source.shape
    middle = (width - 1) / 2, (height - 1) / 2
    angle, zoom = np.radians(values["angle"]), values["zoom"]
    forward = forward_warp(
        source, compose(zoom_map(zoom, middle), rotation_map(angle, middle)), fill=_PAPER
    )
    where_from = compose(rotation_map(-angle, middle), zoom_map(1 / zoom, middle))
    backward = backward_warp(
        source, where_from, method="bilinear" if values["bilinear"] else "nearest",
        border="replicate" if values["bilinear"] else "constant", fill=_PAPER,
    )  # fmt: skip
    covered = backward_warp(np.ones_like(source), where_from, method="nearest") > 0
    backward[~covered] = _PAPER
    holes, folds = covered & (forward.hits == 0), covered & (forward.hits > 1)
    size = (_LARGER * width, _LARGER * height)
    left = paper.picture_panel(size, (width, height), "sent: orange never hit, blue twice or more")
    left.image(_coloured(forward.image.astype(np.uint8), holes, folds), smooth=False)
    right = paper.picture_panel(
        size, (width, height), "backward: each pixel asks (+ to turn and zoom)"
    )
    right.image(backward.astype(np.uint8), smooth=False)
    arm = zoom * _ARM * width * np.array([np.cos(angle), np.sin(angle)])
    right.mark(middle + arm, "ideal", 6)
    right.grip("right side", "a point of the picture, to turn and zoom it", middle + arm, 4)
    return Drawing(paper.join((left, right)), _sentence(holes, covered, folds))


def _sentence(
    holes: npt.NDArray[np.bool_], covered: npt.NDArray[np.bool_], folds: npt.NDArray[np.bool_]
) -> str:
    return (
        f"Forward: {holes.sum()} of {covered.sum()} pixels are holes, and {folds.sum()} were hit "
        "more than once. Backward: each new pixel asks exactly once, no holes, no folds."
    )


def _coloured(image: Drawn, holes: npt.NDArray[np.bool_], folds: npt.NDArray[np.bool_]) -> Drawn:
    """Colour holes orange and folds blue: a darker blue where the board is dark."""
    coloured = np.repeat(image[..., None], 3, axis=2)
    coloured[holes] = np.rint(255 * np.array(rgb(ESTIMATED)))
    dark, light = 255 * np.array([rgb(LENS), rgb(_LIGHT)])
    coloured[folds] = np.rint(dark + (light - dark) * (image[folds, None] / 255))
    return coloured


def _source(camera: Camera, board: Chessboard) -> Drawn:
    """Photograph the board with a sensor of few pixels."""
    scale = _WIDTH / camera.size[0]
    A = np.diag([scale, scale, 1]) @ pinhole(camera).A
    R = rotation_from_vector([-0.4, 0.3, 0.15])
    far = 1.45 * float(np.linalg.norm(board.points[-1] + 2 * board.square))
    T = [0, 0, far] - R @ board.points.mean(axis=0)
    small = Camera(A, pose(R, T), size=(_WIDTH, round(camera.size[1] * scale)))
    return render(board, small, blur=0.4).astype(np.uint8)
