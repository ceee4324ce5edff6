"""Explore the warp: the same map forward, with its holes, and backward, without."""

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics
from cvnotes.pictures import render_scene, room
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Paper
from cvnotes.show.style import ESTIMATED, LENS, rgb
from cvnotes.warping import backward_warp, compose, forward_warp, rotation_map, zoom_map

# px of the source: few enough to see each one, and odd, so that quarter turns about the middle
# take pixels to pixels.
SIZE = (105, 79)
_LARGER = 4  # px of the page for a pixel
_MOST = 3  # times as large
_ARM = 0.12  # of the width, from the middle to where the picture is taken hold of: in the frame
_LIGHT = "#7CC9F5"  # the blue of a fold on white
_PAPER = 255  # grey level where the source has nothing to show
_MIDDLE = (np.array(SIZE) - 1) / 2


def warp_model() -> Model:
    """Make the model of a small photograph of the room, turned and zoomed."""
    settings = (
        Setting("angle", "rotation (°)", -180, 180, 1, 20, "clockwise on the screen: v runs down"),
        Setting("zoom", "zoom", 0.25, _MOST, 0.05, 1.3, "by how much distances grow"),
        Setting("count", "count", 0, 1, 1, 1,
                "how many are holes, and how many were hit more than once"),
    )  # fmt: skip
    about = """A small photograph of a room, turned and zoomed twice by the same map: forward, where
    pixels that receive nothing are orange holes, and those hit twice blue, and backward, without
    any."""

    def pulled(_: Values, at: Array) -> Values:
        x, y = at - _MIDDLE
        zoom = np.hypot(x, y) / (_ARM * SIZE[0])
        return {"angle": float(np.degrees(np.arctan2(y, x))), "zoom": float(zoom)}

    return Model("warp", about, settings, _draw, {"right side": pulled})


@lru_cache(maxsize=1)
def source() -> Drawn:
    """Photograph the room with a sensor of few pixels."""
    return render_scene(room(), Camera(intrinsics(85, 85, *_MIDDLE), size=SIZE), samples=64)


def _draw(paper: Paper, values: Values) -> Drawing:
    angle, zoom = np.radians(values["angle"]), values["zoom"]
    turned_and_zoomed = compose(zoom_map(zoom, _MIDDLE), rotation_map(angle, _MIDDLE))
    forward = forward_warp(source(), turned_and_zoomed, fill=_PAPER)
    where_from = compose(rotation_map(-angle, _MIDDLE), zoom_map(1 / zoom, _MIDDLE))
    backward = backward_warp(source(), where_from, border="replicate")
    covered = backward_warp(np.ones(SIZE[::-1]), where_from, method="nearest") > 0
    backward[~covered] = _PAPER
    holes, folds = covered & (forward.hits == 0), covered & (forward.hits > 1)
    size = (_LARGER * SIZE[0], _LARGER * SIZE[1])
    title = "each pixel is sent: orange never hit" + ", blue twice or more" * bool(folds.any())
    said = f"Turned by {values['angle']:g}° and {zoom:g} times as large."
    if values["count"]:
        title = f"each pixel is sent: {holes.sum()} never hit, {folds.sum()} twice or more"
        said = _sentence(holes, covered, folds)
    left = paper.picture_panel(size, SIZE, title)
    left.image(_coloured(forward.image.astype(np.uint8), holes, folds), smooth=False)
    right = paper.picture_panel(size, SIZE, "each pixel asks: pull the plus")
    right.image(backward.astype(np.uint8), smooth=False)
    arm = zoom * _ARM * SIZE[0] * np.array([np.cos(angle), np.sin(angle)])
    right.mark(_MIDDLE + arm, "ideal", 6)
    right.grip("right side", "a point of the picture, to turn and zoom it", _MIDDLE + arm, 4)
    return Drawing(paper.join((left, right)), said)


def _sentence(
    holes: npt.NDArray[np.bool_], covered: npt.NDArray[np.bool_], folds: npt.NDArray[np.bool_]
) -> str:
    return f"""Forward: {holes.sum()} of {covered.sum()} pixels are holes, and {folds.sum()} were
    hit more than once; {100 * holes.sum() / covered.sum():.0f} % stay empty. Backward: each new
    pixel asks exactly once, no holes, no folds."""


def _coloured(image: Drawn, holes: npt.NDArray[np.bool_], folds: npt.NDArray[np.bool_]) -> Drawn:
    """Colour holes orange and folds blue: a darker blue where the room is dark."""
    coloured = image.copy()
    coloured[holes] = np.rint(255 * np.array(rgb(ESTIMATED)))
    dark, light = 255 * np.array([rgb(LENS), rgb(_LIGHT)])
    coloured[folds] = np.rint(dark + (light - dark) * (image[folds].mean(axis=1)[:, None] / 255))
    return coloured
