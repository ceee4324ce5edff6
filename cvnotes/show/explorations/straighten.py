"""Explore what a lens does: a photograph from which more or less of its bending is taken."""

from functools import lru_cache

import numpy as np
from PIL import Image

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, intrinsics, rotation_from_vector
from cvnotes.pictures import course, hold_at, radiance, room_with
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import ESTIMATED, LENS, MUTED

_PICTURE, _ROW = (440, 330), (410, 330)
_ALPHA, _SIZE, _MIDDLE = 540, (640, 480), np.array([319.5, 239.5])
_FINE = 4  # so many times the photograph is enlarged, smoothly, before pixels are looked up
_K1 = -0.2  # of the lens that took the photograph: not the lens of the course
_LOWEST, _HIGHEST, _STEP = -0.4, 0.1, 0.005
_BOW = (-9.5, 9.5)  # px below and above the straight line that are shown


def straighten_model() -> Model:
    """Make the model of a board in a room, photographed through a lens that bends much."""
    A = intrinsics(_ALPHA, _ALPHA, *_MIDDLE)
    camera = Camera(A, lens=Lens(k=(_K1,)), size=_SIZE)
    board = course.board()
    G = hold_at(board, camera, rotation_from_vector([0.2, 0.15, 0.0]), aim=[320, 235], farther=1.12)
    corners = (camera.moved(G).project(board.points) - _MIDDLE) / _ALPHA
    rows = corners.reshape(*board.corners[::-1], 2)
    settings = (Setting("k1", "k₁", _LOWEST, _HIGHEST, _STEP, 0, "how much bending is removed"),)
    about = """The photograph of a chessboard in a room, with as much bending removed as k₁ says;
    beside it the uppermost row of corners, and how far it is from a straight line."""

    @lru_cache(maxsize=1)
    def photograph() -> Drawn:
        taken = radiance(room_with(board, G), camera)
        photo = Image.fromarray(taken.clip(0, 255).astype(np.uint8))
        return np.asarray(photo.resize((_FINE * _SIZE[0], _FINE * _SIZE[1])))

    def draw(paper: Paper, values: Values) -> Drawing:
        lens = Lens(k=(values["k1"],))
        bow = _bow(lens, rows[0])
        panel = paper.picture_panel(_PICTURE, _SIZE, f"the photograph, {_taken(lens)} removed")
        panel.image(_without(lens, photograph(), paper.sharpness))
        net = _ALPHA * lens.undistort(rows) + _MIDDLE
        m = net[0]
        for line in (*net, *net.swapaxes(0, 1)):
            panel.line(line[[0, -1]], ESTIMATED, 1.2)
        panel.mark(m, "lens", 4)
        return Drawing(paper.join((panel, _row_panel(paper, m, bow))), _sentence(lens, bow))

    def pulled(_: Values, at: Array) -> Values:
        tried = np.arange(_LOWEST, _HIGHEST + _STEP, _STEP)
        middle = [_bow(Lens(k=(k1,)), rows[0])[len(rows[0]) // 2] for k1 in tried]
        return {"k1": float(tried[np.abs(np.array(middle) - at[1]).argmin()])}

    return Model("straighten", about, settings, draw, {"row": pulled})


def _bow(lens: Lens, row: Array) -> Array:
    """Return how far points of the plane z = 1 lie above the line through first and last, in px."""
    m = _ALPHA * lens.undistort(row)
    along = (m[-1] - m[0]) / np.linalg.norm(m[-1] - m[0])
    return np.asarray((m - m[0]) @ [along[1], -along[0]])


def _without(lens: Lens, photo: Drawn, sharpness: int) -> Drawn:
    """Take a lens off a photograph: each pixel is looked up where that lens would show it."""
    w, h = sharpness * _PICTURE[0], sharpness * _PICTURE[1]
    u, v = (np.linspace(-0.5, n - 0.5, 2 * k + 1)[1::2] for n, k in zip(_SIZE, (w, h), strict=True))
    xy = (np.stack(np.meshgrid(u, v), -1) - _MIDDLE) / _ALPHA
    at = np.rint(_FINE * (_ALPHA * lens.distort(xy) + _MIDDLE + 0.5) - 0.5)
    seen = ((at >= 0) & (at < photo.shape[1::-1])).all(axis=-1)[..., None]  # NaN is not
    column, line = np.where(seen, at, 0).astype(int).transpose(2, 0, 1)
    return np.where(seen, photo[line, column], np.uint8(255))


def _row_panel(paper: Paper, m: Array, bow: Array) -> Panel:
    title = "the uppermost row, px above its line: pull its middle dot"
    panel = paper.panel(_ROW, (-0.5, _SIZE[0] - 0.5), _BOW[::-1], title)
    panel.ticks(y=(-5, 0, 5), size=12)
    panel.line([[40, 0], [_SIZE[0], 0]], MUTED, 0.8)
    at = np.column_stack([m[:, 0], bow])
    panel.line(at[[0, -1]], ESTIMATED, 1.5)
    panel.line(at, LENS, 1.2)
    panel.mark(at, "lens", 6)
    panel.mark(at[len(at) // 2], "lens", 12)
    panel.grip("row", "the middle of the row, to be pulled straight", at[len(at) // 2], 4)
    return panel


def _taken(lens: Lens) -> str:
    k1 = lens.k[0]
    return f"the bending of k₁ = {k1:.3f}" if k1 else "no bending"


def _sentence(lens: Lens, bow: Array) -> str:
    most = float(bow[np.abs(bow).argmax()])
    said = f"With {_taken(lens)} removed, the uppermost row of corners "
    if abs(most) < 0.05:
        return f"{said}is straight, and so are the sides of the paper."
    return f"{said}bends {'up' if most > 0 else 'down'} by {abs(most):.1f} px."
