"""Explore normalisation: pull the origin of a board, and see where the plain DLT puts its net.

That the answer depends on the coordinates: R. Hartley, "In defense of the eight-point algorithm",
*PAMI* 19 (1997).
"""

from functools import lru_cache

import numpy as np
from PIL import Image as Bitmap

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.homography import design_matrix, normaliser
from cvnotes.pictures import course
from cvnotes.projective import apply, to_homogeneous
from cvnotes.show.explorations.boards import draw_net, draw_squares
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.explorations.strokes import circle, contours
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, WORLD, mixed, rgb

_BOARD, _NOISE, _TIMES = course.board(), 0.5, 10  # px; shifts are drawn so many times
_SIZE = (374, 320)
_SEEN = (190.0, 269.0), (150.2, 217.8)  # px, u and v
_PLANE = (-500.0, 700.0), (-450.9, 575.9)  # mm around the board's middle
_LEVELS = (0.05, 0.1, 0.2, 0.3)  # px
_CELLS = 28, 24  # of the coarse map, along X and Y
_PALE = "#E4E4E4"


def origin_model() -> Model:
    """Make the model of a far board, and of the origin from which its corners are measured."""
    settings = tuple(
        Setting(axis, f"origin {axis} (mm)", *ends, 5, start, "from the board's first corner")
        for axis, ends, start in (("x", (-470, 670), -300), ("y", (-420, 545), -300))
    )
    about = (
        "A board that is far away, and two nets through its corners, their shifts enlarged: of the "
        "plain DLT, and of the normalised one. Beside it the board's plane with the origin of its "
        "coordinates, and lines that say how far off the plain DLT is from each origin."
    )
    drags = {"origin": lambda _, at: {"x": float(at[0]), "y": float(at[1])}}
    return Model("origin", about, settings, _draw, drags)


def far_camera() -> Camera:
    """Return the camera that sees the board from six times as far away."""
    G = course.poses()[6].copy()
    G[:3, 3] *= 6
    return Camera(course.camera().A, G)


@lru_cache(maxsize=1)
def corners() -> tuple[Array, Array]:
    """Return a board's corners (54, 2) in mm, and their pixels from six times as far away."""
    return _BOARD.points[:, :2], far_camera().project(_BOARD.points)


@lru_cache(maxsize=2)
def _measured(scaled: bool) -> tuple[Array, Array, Array]:
    """Return all that many measurements say of H between normalised points: (9, 9), N₁ and N₂.

    A noise e of a pixel multiplies X, Y and 1 in D. In the mean of many measurements DᵀD grows by
    the squares of e X, e Y and e, as it would by rows of their own.
    """
    W, m = corners()
    N1, N2 = normaliser(W), normaliser(m) if scaled else np.eye(3)
    x = apply(N1, W)
    noise = np.zeros((2 * len(W), 9))
    noise[:, 6:] = _NOISE * N2[0, 0] * to_homogeneous(x).repeat(2, axis=0)
    return np.linalg.qr(np.vstack([design_matrix(x, apply(N2, m)), noise]))[1], N1, N2


def plain(origins: Array) -> Array:
    """Return where the plain DLT puts the corners (…, 54, 2), if they are measured from origins."""
    x = seen_from(origins)
    return np.asarray(x[..., :2] / x[..., 2:])


def seen_from(origins: Array) -> Array:
    """Return H times the corners (…, 54, 3), H of the plain DLT with h9 = 1: w is 1 at the origin.

    The equations are those of normalised points, and ‖h‖ = 1 is of the coordinates in use.
    """
    R, N1, _ = _measured(scaled=False)
    back = np.broadcast_to(np.linalg.inv(N1), (*origins.shape[:-1], 3, 3)).copy()
    back[..., :2, 2] -= origins
    D = R.reshape(9, 3, 3) @ back[..., None, :, :].swapaxes(-1, -2)
    H = np.linalg.svd(D.reshape(*origins.shape[:-1], 9, 9))[2][..., -1, :]
    H = H.reshape(*origins.shape[:-1], 3, 3) / H[..., -1:, None]
    x = to_homogeneous(corners()[0] - origins[..., None, :]) @ H.swapaxes(-1, -2)
    return np.asarray(x)


def normalised() -> Array:
    """Return where the normalised DLT puts the corners (54, 2), from whatever origin."""
    R, N1, N2 = _measured(scaled=True)
    H = np.linalg.inv(N2) @ np.linalg.svd(R)[2][-1].reshape(3, 3) @ N1
    return np.asarray(apply(H, corners()[0]))


def rms(net: Array) -> Array:
    """Return how far a net (…, 54, 2) is off, as RMS in pixels."""
    return np.asarray(np.sqrt(((net - corners()[1]) ** 2).sum(axis=-1).mean(axis=-1)))


@lru_cache(maxsize=2)
def _map(sharpness: int) -> Drawn:
    """Paint how far the plain DLT is off from each origin: paler is better."""
    x, y = (  # the middles of cells, two of them outside on each side
        low + (high - low) * (np.arange(-2, n + 2) + 0.5) / n
        for (low, high), n in zip(_PLANE, _CELLS, strict=True)
    )
    X, Y = np.meshgrid(x, y)
    coarse = np.log(rms(plain(np.stack([X, Y], axis=-1)))).astype(np.float32)
    size = (sharpness * _SIZE[0], sharpness * _SIZE[1])
    inside = (2, 2, 2 + _CELLS[0], 2 + _CELLS[1])
    fine = Bitmap.fromarray(coarse).resize(size, Bitmap.Resampling.BICUBIC, box=inside)
    height = np.asarray(fine)
    part = np.interp(height, np.log([0.02, 1.2]), [0, 0.6])[..., None]
    tint = 1 - part * (1 - np.array(rgb(LENS)))
    ink = contours(height, np.log(_LEVELS), 0.5 + 0.5 * sharpness)[..., None]
    return np.asarray((255 * (tint + ink * (1 - tint))).round(), dtype=np.uint8)


def _draw(paper: Paper, values: Values) -> Drawing:
    at = np.array([values["x"], values["y"]])
    nets, m = (plain(at), normalised()), corners()[1]
    panel = paper.panel(_SIZE, *_SEEN, f"blue: plain; orange: normalised; shifts × {_TIMES}")
    draw_squares(panel, m, _BOARD, _PALE)
    for net, colour in zip(nets, (LENS, ESTIMATED), strict=True):
        draw_net(panel, m + _TIMES * (net - m), _BOARD, colour, 1.6)
    panel.polygons(m[:, None] + 2.6 * panel.pixel * circle(17), IDEAL)
    off = [float(rms(net)) for net in nets]
    return Drawing(
        paper.join((panel, _plane(paper, at))),
        f"Origin at ({at[0]:.0f}, {at[1]:.0f}) mm: the plain DLT is {off[0]:.2f} px off, the "
        f"normalised one {off[1]:.2f} px.",
    )


def _plane(paper: Paper, at: Array) -> Panel:
    """Draw the board from above, the origin of its coordinates, and how far off each would be."""
    panel = paper.panel(_SIZE, *_PLANE, "the board from above; pull the green origin")
    panel.image(_map(paper.sharpness))
    W, middle = corners()[0], corners()[0].mean(axis=0)
    draw_squares(panel, W, _BOARD, mixed("#FFFFFF", IDEAL, 0.5))
    ray = middle + np.linspace(0, 600, 61)[:, None] * [-0.6, 0.8]
    for level, place in zip(_LEVELS, np.searchsorted(rms(plain(ray)), _LEVELS), strict=True):
        if 9 < place < len(ray):
            panel.text(ray[place], f"{level:g} px", LENS, anchor="mm", size=12)
    for way, name in ((np.array([130, 0]), "X"), (np.array([0, 130]), "Y")):
        panel.line([at, at + way], WORLD, 2.5)
        panel.text(at + 1.25 * way, name, WORLD, anchor="mm", size=13)
    panel.mark(at, "world", 9)
    panel.grip("origin", "the origin of the board's coordinates", at, 5)
    return panel
