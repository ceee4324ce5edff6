"""Explore why the plain DLT errs: a board that turns about its origin, like a door on its hinge."""

import numpy as np

from cvnotes.base import Array
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import draw_net
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.origin import corners, far_camera, seen_from
from cvnotes.show.explorations.paper import Paper
from cvnotes.show.style import IDEAL, LENS, MUTED, WORLD, mixed

_BOARD = course.board()
_FARTHEST = 540  # mm, of the origin from the board's middle
_ALONG = np.array([-0.741, -0.6715])  # that way on the board: up and to the left, of length 1
_WIDE, _NARROW = (754, 210), (374, 150)  # px
_AWAY, _MIDDLE = (-130.0, 4000.0), -200.0  # mm of depth; of height, in the middle of the picture


def door_model() -> Model:
    """Make the model of a far board from the side, and of the origin it seems to hang on."""
    settings = (
        Setting("out", "origin from the board's middle (mm)", -_FARTHEST, _FARTHEST, 10, _FARTHEST,
                "along the board, upwards and to the left"),
    )  # fmt: skip
    about = (
        "A camera and a far board from the side: where the board is, and where the plain DLT "
        "believes it, turned about the origin of its coordinates."
    )

    def pulled(_: Values, at: Array) -> Values:
        start, end = _in_camera(np.array([place(0.0), place(1.0)]))[:, [2, 1]]
        return {"out": float((at - start) @ (end - start) / ((end - start) @ (end - start)))}

    return Model("door", about, settings, _draw, {"hinge": pulled})


def place(out: float) -> Array:
    """Return the origin (2,) in mm from the board's first corner."""
    return np.asarray(corners()[0].mean(axis=0) + out * _ALONG)


def _in_camera(xy: Array) -> Array:
    """Return places of the board's plane (n, 2) in the camera's frame (n, 3)."""
    G = far_camera().G
    return np.asarray(np.insert(xy, 2, 0, axis=1) @ G[:3, :3].T + G[:3, 3])


def believed(at: Array) -> tuple[Array, Array, Array]:
    """Return the origin (3,), and the corners (54, 3) as they are and as the plain DLT has them.

    In mm of the camera's frame; the origin has the same depth for both.
    """
    origin, *true = _in_camera(np.vstack([at, corners()[0]]))
    rays = seen_from(at) @ np.linalg.inv(far_camera().A).T
    return origin, np.array(true), origin[2] * rays


def _draw(paper: Paper, values: Values) -> Drawing:
    width, height = _NARROW if paper.narrow else _WIDE
    half = (_AWAY[1] - _AWAY[0]) * height / width / 2
    high, low = _MIDDLE - half, _MIDDLE + half
    title = "the camera and the board, from the side"
    panel = paper.panel((width, height), _AWAY, (high, low), title)
    hinge, *boards = (one[..., [2, 1]] for one in believed(place(values["out"])))
    middles = [board.mean(axis=0) for board in boards]
    panel.polygons([[hinge, *middles]], mixed("#FFFFFF", LENS, 0.15))
    panel.line([[0, 0], middles[0]], MUTED, 0.8)
    ratios = [float(middle[0] / hinge[0]) for middle in middles]
    rows = zip(boards, middles, ratios, (IDEAL, LENS), ("true", "blue"), (28, 11), strict=True)
    for board, middle, ratio, colour, name, up in rows:
        panel.line([hinge, middle], colour, 1.4, dash=4)
        draw_net(panel, board, _BOARD, colour, 1)
        below = [middle[0], low - up * panel.pixel]
        panel.text(below, f"{name} {ratio:.2f}", colour, anchor="mm")
    panel.mark([0, 0], "camera", 9, looks=(1, 0))
    panel.text([0, low - 11 * panel.pixel], "camera", MUTED, anchor="lm")
    panel.mark(hinge, "world", 6)
    panel.text([hinge[0], low - 45 * panel.pixel], "origin 1.00", WORLD, anchor="mm")
    panel.grip("hinge", "the origin, which is the hinge", hinge, 10)
    return Drawing(
        paper.join((panel,)),
        f"The origin is {abs(values['out']):.0f} mm from the board's middle. This middle is "
        f"{ratios[0]:.2f} times as far away as the origin; the plain DLT believes {ratios[1]:.2f}.",
    )
