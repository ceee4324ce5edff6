"""Explore why the plain DLT errs: but for its origin, a far board slides along the rays.

That the answer depends on the coordinates: R. Hartley, "In defense of the eight-point algorithm",
*PAMI* 19 (1997).
"""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.homography import design_matrix, normaliser
from cvnotes.pictures import course
from cvnotes.projective import apply, to_homogeneous
from cvnotes.show.explorations.boards import draw_net, draw_squares
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.style import COLOURS, ESTIMATED, FAINT, IDEAL, LENS, MUTED, mixed

_BOARD, _NOISE, _TIMES = course.board(), 0.5, 10  # px; shifts are drawn so many times
_FARTHEST = 540  # mm, of the origin from the board's middle
_ALONG = np.array([-0.741, -0.6715])  # that way on the board: up and to the left, of length 1
_WIDE, _NARROW, _HALF = (754, 300), (374, 230), (374, 210)  # px
_AWAY, _HIGH = (2100.0, 3750.0), -530.0  # mm of depth; of height, the upper end of the picture
_SEEN = (190.0, 269.0), (161.8, 206.16)  # px, u and v
_PALE, _SIDE = "#E4E4E4", "#F3F5F6"


def origin_model() -> Model:
    """Make the model of a far board, and of the origin from which its corners are measured."""
    settings = (
        Setting("out", "origin from the board's middle (mm)", -_FARTHEST, _FARTHEST, 10, _FARTHEST,
                "along the board, upwards and to the left"),
    )  # fmt: skip
    about = """A far board from the side, over a scale of depths: where it is, and where the plain
    DLT believes it, swung about the origin of its coordinates. Below, two nets over its corners,
    their shifts enlarged: of the plain DLT, and of the normalised one."""

    def pulled(_: Values, at: Array) -> Values:
        start, end = _in_camera(np.array([place(0.0), place(1.0)]))[:, [2, 1]]
        return {"out": float((at - start) @ (end - start) / ((end - start) @ (end - start)))}

    return Model("origin", about, settings, _draw, {"hinge": pulled})


def place(out: float) -> Array:
    """Return the origin (2,) in mm from the board's first corner."""
    return np.asarray(corners()[0].mean(axis=0) + out * _ALONG)


@lru_cache(maxsize=1)
def far_camera() -> Camera:
    """Return the camera that sees the board from six times as far away."""
    G = course.poses()[6].copy()
    G[:3, 3] *= 6
    return Camera(course.camera().A, G)


@lru_cache(maxsize=1)
def corners() -> tuple[Array, Array]:
    """Return a board's corners (54, 2) in mm, and their pixels from six times as far away."""
    return _BOARD.points[:, :2], far_camera().project(_BOARD.points)


def _in_camera(xy: Array) -> Array:
    """Return places of the board's plane (n, 2) in the camera's frame (n, 3)."""
    G = far_camera().G
    return np.asarray(np.insert(xy, 2, 0, axis=1) @ G[:3, :3].T + G[:3, 3])


def _dlt_of_many(W: Array, m: Array, noise: float) -> Array:
    """Return H (3, 3) of the DLT, h9 = 1, from many photographs with noise of so many px.

    A noise e of a pixel multiplies X, Y and 1 in D. In the mean of many measurements DᵀD grows by
    the squares of e X, e Y and e, as it would by rows of their own.
    """
    rows = np.zeros((2 * len(W), 9))
    rows[:, 6:] = noise * to_homogeneous(W).repeat(2, axis=0)
    D = np.vstack([design_matrix(W, m), rows])
    H = np.linalg.svd(D, full_matrices=False)[2][-1].reshape(3, 3)
    return np.asarray(H / H[2, 2])


def plain(at: Array) -> Array:
    """Return H of the plain DLT, of corners measured from an origin, whose depth w is 1."""
    W, m = corners()
    return _dlt_of_many(W - at, m, _NOISE)


def normalised() -> Array:
    """Return where the normalised DLT puts the corners (54, 2), from whatever origin."""
    W, m = corners()
    N1, N2 = normaliser(W), normaliser(m)
    H = _dlt_of_many(apply(N1, W), apply(N2, m), _NOISE * float(N2[0, 0]))
    return np.asarray(apply(np.linalg.inv(N2) @ H @ N1, W))


def rms(net: Array) -> float:
    """Return how far a net (54, 2) is off, as RMS in pixels."""
    return float(np.sqrt(((net - corners()[1]) ** 2).sum(axis=-1).mean()))


def believed(at: Array) -> tuple[Array, Array, Array]:
    """Return the origin (3,), and the corners (54, 3) as they are and as the plain DLT has them.

    In mm of the camera's frame; the origin has the same depth for both.
    """
    origin, *true = _in_camera(np.vstack([at, corners()[0]]))
    seen = to_homogeneous(corners()[0] - at) @ plain(at).T
    return origin, np.array(true), origin[2] * seen @ np.linalg.inv(far_camera().A).T


def _draw(paper: Paper, values: Values) -> Drawing:
    at = place(values["out"])
    net, cured = apply(plain(at), corners()[0] - at), normalised()
    side, ratios = _side(paper, at)
    sentence = f"""The origin is {abs(values["out"]):.0f} mm from the board's middle, which the
    plain DLT believes {ratios[1]:.2f} times as far away as the origin (true: {ratios[0]:.2f}). Its
    net is {rms(net):.2f} px off, the normalised one's {rms(cured):.2f} px."""
    nets = _net(paper, net, "the DLT", LENS), _net(paper, cured, "points moved first", ESTIMATED)
    return Drawing(paper.join((side,), nets), sentence)


def _side(paper: Paper, at: Array) -> tuple[Panel, list[float]]:
    """Draw the board from the side; return with it how far its middle is, in the origin's depth."""
    width, height = _NARROW if paper.narrow else _WIDE
    low = _HIGH + (_AWAY[1] - _AWAY[0]) * height / width
    title = "from the side; below, the depth (that of the origin is 1)"
    panel = paper.panel((width, height), _AWAY, (_HIGH, low), title)
    hinge, *boards = (one[..., [2, 1]] for one in believed(at))
    middles = [board.mean(axis=0) for board in boards]
    floor = low - 36 * panel.pixel  # where the scale of depths begins
    panel.polygons([[[0, _HIGH], [9e3, _HIGH], [9e3, floor], [0, floor]]], _SIDE)
    for tenth in range(5, 13):
        depth = tenth / 10 * hinge[0]
        if not _AWAY[0] + 14 * panel.pixel < depth < _AWAY[1] - 14 * panel.pixel:
            continue
        panel.line([[depth, floor], [depth, floor + 6 * panel.pixel]], MUTED, 1)
        panel.text([depth, floor + 18 * panel.pixel], f"{tenth / 10:.1f}", MUTED, anchor="mm")
    panel.line([[0, 0], middles[0]], FAINT, 1)
    panel.polygons([[hinge, *middles]], mixed("#FFFFFF", LENS, 0.15))
    named: list[float] = []
    points = zip((hinge, *middles), ("world", "ideal", "lens"), strict=True)
    for (x, y), what in points:
        panel.line([[x, y], [x, floor]], COLOURS[what], 1, dash=3)
        panel.mark([x, floor], what, 5)
        if all(abs(x - other) > 46 * panel.pixel for other in named):
            words = {"world": "origin", "ideal": "true", "lens": "the DLT's"}[what]
            side, anchor = (-6, "rm") if what == "lens" else (6, "lm")
            beside = [x + side * panel.pixel, floor - 12 * panel.pixel]
            panel.text(beside, words, COLOURS[what], anchor=anchor, size=13, rim=_SIDE)
            named.append(x)
    for board, middle, colour in zip(boards, middles, (IDEAL, LENS), strict=True):
        panel.line([hinge, middle], colour, 1.4, dash=4)
        draw_squares(panel, board, _BOARD, colour)
        draw_net(panel, board, _BOARD, colour, 1)
    ray = middles[0][1] * _AWAY[0] / middles[0][0]
    panel.text([_AWAY[0] + 8 * panel.pixel, ray + 16 * panel.pixel], "← camera", rim=_SIDE)
    panel.grip("hinge", "the origin, whose depth is fixed", hinge, 10, "world", 6)
    return panel, [float(middle[0] / hinge[0]) for middle in middles]


def _net(paper: Paper, net: Array, name: str, colour: str) -> Panel:
    """Draw a net over the corners as they are seen, its shifts enlarged."""
    panel = paper.panel(_HALF, *_SEEN, f"{name}: {rms(net):.2f} px off (shifts × {_TIMES})")
    m = corners()[1]
    draw_squares(panel, m, _BOARD, _PALE)
    draw_net(panel, m + _TIMES * (net - m), _BOARD, colour, 2)
    panel.polygons(m[:, None] + 2.6 * panel.pixel * circle(17), IDEAL)
    return panel
