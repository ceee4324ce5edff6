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
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, WORLD, mixed

_BOARD, _NOISE, _TIMES = course.board(), 0.5, 10  # px; shifts are drawn so many times
_FARTHEST = 540  # mm, of the origin from the board's middle
_ALONG = np.array([-0.741, -0.6715])  # that way on the board: up and to the left, of length 1
_WIDE, _NARROW, _HALF = (754, 300), (374, 190), (374, 210)  # px
_AWAY, _HIGH = (2100.0, 3750.0), -500.0  # mm of depth; of height, the upper end of the picture
_SEEN = (190.0, 269.0), (161.8, 206.16)  # px, u and v
_BILL = 0.6  # px², as long as a bar can be
_PALE, _GREY = "#E4E4E4", "#A9A9A9"


def origin_model() -> Model:
    """Make the model of a far board, and of the origin from which its corners are measured."""
    settings = (
        Setting("out", "origin from the board's middle (mm)", -_FARTHEST, _FARTHEST, 10, _FARTHEST,
                "along the board, upwards and to the left"),
    )  # fmt: skip
    about = (
        "A far board from the side: where the board is, and where the plain DLT "
        "believes it: nearer, but for the origin of its coordinates. Below, two nets through its "
        "corners, their shifts enlarged: of the plain DLT, and of the normalised one; and what "
        "the misses cost, of the true homography and of the plain DLT's."
    )

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


def bill(at: Array) -> Array:
    """Return the squares (2, 2) of misses times depths, of noise and of the fit, mean.

    In px², for the board as it is and as the plain DLT has it; the origin has the depth 1.
    """
    depths = np.array([board[:, 2] for board in believed(at)[1:]]) / believed(at)[0][2]
    off = apply(plain(at), corners()[0] - at) - corners()[1]
    misses = np.stack([0 * depths[0], np.hypot(*off.T)])
    squares = 2 * (_NOISE * depths) ** 2, (misses * depths) ** 2
    return np.asarray(np.mean(squares, axis=-1).T)


def _draw(paper: Paper, values: Values) -> Drawing:
    at = place(values["out"])
    net, costs = apply(plain(at), corners()[0] - at), bill(at)
    side, ratios = _side(paper, at)
    (noise, _), (less, fit) = costs
    sentence = (
        f"The origin is {abs(values['out']):.0f} mm from the board's middle, which the plain DLT "
        f"believes {ratios[1]:.2f} times as far away as the origin (true: {ratios[0]:.2f}). Its "
        f"net is {rms(net):.2f} px off, the normalised one's {rms(normalised()):.2f} px. It pays "
        f"{less:.2f} for noise and {fit:.2f} for the fit; the true one would pay {noise:.2f}."
    )
    return Drawing(paper.join((side,), (_nets(paper, net), _bars(paper, costs))), sentence)


def _side(paper: Paper, at: Array) -> tuple[Panel, list[float]]:
    """Draw the board from the side; return with it how far its middle is, in the origin's depth."""
    width, height = _NARROW if paper.narrow else _WIDE
    high = _HIGH - 45 * paper.narrow
    low = high + (_AWAY[1] - _AWAY[0]) * height / width
    title = "the far board from the side, and depths"
    panel = paper.panel((width, height), _AWAY, (high, low), title)
    hinge, *boards = (one[..., [2, 1]] for one in believed(at))
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
    broken = np.array([_AWAY[0], middles[0][1] * _AWAY[0] / middles[0][0]])
    panel.text(broken + panel.pixel * np.array([8, 14]), "← camera, 3 m", MUTED, anchor="lm")
    panel.mark(hinge, "world", 6)
    panel.text([hinge[0], low - 45 * panel.pixel], "origin 1.00", WORLD, anchor="mm")
    panel.grip("hinge", "the origin, whose depth is fixed", hinge, 10)
    return panel, ratios


def _nets(paper: Paper, net: Array) -> Panel:
    panel = paper.panel(_HALF, *_SEEN, f"blue: the DLT; orange: its cure; shifts × {_TIMES}")
    m = corners()[1]
    draw_squares(panel, m, _BOARD, _PALE)
    for one, colour in ((net, LENS), (normalised(), ESTIMATED)):
        draw_net(panel, m + _TIMES * (one - m), _BOARD, colour, 1.6)
    panel.polygons(m[:, None] + 2.6 * panel.pixel * circle(17), IDEAL)
    return panel


def _bars(paper: Paper, costs: Array) -> Panel:
    """Draw two bills as bars, of noise in grey and of a bad fit in blue, one behind the other."""
    title = "(miss × depth)², mean: the DLT wants it small"
    panel = paper.panel(_HALF, (0, _HALF[0]), (_HALF[1], 0), title)
    long = (_HALF[0] - 30) / _BILL
    for name, ink, (noise, fit), y in zip(
        ("the true board", "the blue board"), (IDEAL, LENS), costs, (130, 42), strict=True
    ):
        ends = 15 + long * np.array([0, noise, noise + fit])
        for left, right, colour in ((*ends[:2], _GREY), (*ends[1:], LENS)):
            panel.polygons([[[left, y], [right, y], [right, y + 26], [left, y + 26]]], colour)
        panel.text([15, y + 44], f"{name} costs {noise + fit:.2f}", ink, size=13)
        panel.text([15, y - 14], f"noise {noise:.2f}", MUTED)
        if fit > 0.004:
            panel.text([max(ends[1], 95), y - 14], f"worse fit {fit:.2f}", LENS)
    return panel
