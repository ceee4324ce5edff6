"""Explore why depth is needed: two boards open to one plane, and no focal length is left."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, inverse, look_at, move
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import draw_sheet, paper_and_squares
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper, circle
from cvnotes.show.space.directions import sheet
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, mixed
from cvnotes.targets import Chessboard, TwoPlanes

_BOARD, _A = Chessboard((7, 6), 25.0), course.camera().A
_VIEW = Camera(_A, look_at([470, 40, -520], [65, 62, -75]))
_SPACE, _FOUND = (520, 400), (340, 400)  # px
_OPEN, _FLAT = 90, 180  # degrees between the boards
_NOISE, _PHOTOS = 0.1, 40  # px, of each coordinate
_REACH = 60  # px, of α_u
_DEPTH = 165  # mm from the camera to its drawn picture
_SHEET = sheet((24, -56))
_SHOWN = ((-292, 278), (-106, 332))  # mm of the sheet


def on_sheet(W: Array) -> Array:
    """Project points (..., 3) onto the sheet (..., 2), all parallel."""
    return np.asarray(W @ _SHEET.T)


def hinge_model() -> Model:
    """Make the model of a photograph of two boards on a hinge, and of how well it determines α."""
    settings = (
        Setting("angle", "angle of the boards (°)", _OPEN, _FLAT, 1, 160, "180° is one plane"),
    )
    about = """A camera before two boards on a hinge. Beside it a dot for each of 40 photographs of
    them: the focal lengths that it gives, in pixels, to the right αᵤ and upwards αᵥ."""

    def turned(_: Values, at: Array) -> Values:
        nearest = np.linalg.norm(_way() - at, axis=1).argmin()
        return {"angle": float(_OPEN + nearest)}

    return Model("hinge", about, settings, _draw, {"board": turned})


@lru_cache(maxsize=1)
def gains() -> Array:
    """Return by how much α_u and α_v move with each coordinate of the corners: (90, 2, 168).

    For 90° to 179°. Least squares find (JᵀJ)⁻¹Jᵀ n for small noise n, in all u and then all v;
    J has the derivatives of u = α_u x/z + u0 and v = α_v y/z + v0 by all ten unknowns.
    """
    W = [TwoPlanes(_BOARD, np.radians(angle)).points for angle in range(_OPEN, _FLAT)]
    X, Y, z = np.moveaxis(move(_VIEW.G, np.array(W)), -1, 0)
    x, y, i, o = X / z, Y / z, 1 + 0 * z, 0 * z
    alpha_u, alpha_v = _A[[0, 1], [0, 1]]
    by_u = [x, o, i, o, *alpha_u * np.array([1 / z, o, -x / z, -x * y, 1 + x * x, -y])]
    by_v = [o, y, o, i, *alpha_v * np.array([o, 1 / z, -y / z, -1 - y * y, x * y, x])]
    J = np.concatenate(np.moveaxis(np.array([by_u, by_v]), 1, -1), axis=1)
    size = np.linalg.norm(J, axis=1, keepdims=True)  # or else much is lost to rounding
    across = (J / size).swapaxes(1, 2)
    return np.asarray(
        np.linalg.solve(across @ across.swapaxes(1, 2), across)[:, :2] / size[:, 0, :2, None]
    )


@lru_cache(maxsize=1)
def found() -> Array:
    """Return (α_u, α_v) as 40 photographs give them (angles, 40, 2), with the same noise."""
    noise = np.random.default_rng(0).normal(scale=_NOISE, size=(_PHOTOS, gains().shape[2]))
    return np.asarray(_A[[0, 1], [0, 1]] + noise @ gains().swapaxes(1, 2))


@lru_cache(maxsize=1)
def spread() -> Array:
    """Return the standard deviation of α_u for each angle, px."""
    return np.asarray(_NOISE * np.linalg.norm(gains()[:, 0], axis=1))


def _draw(paper: Paper, values: Values) -> Drawing:
    angle = round(values["angle"])
    drawn = paper.join((_space(paper, angle), _dots(paper, angle)))
    if angle == _FLAT:
        return Drawing(
            drawn, "At 180° both boards are one plane: the photograph does not determine αᵤ."
        )
    one = spread()[angle - _OPEN]
    return Drawing(
        drawn, f"At {angle}° one photograph determines αᵤ to ± {one:.{1 if one > 2 else 2}f} px."
    )


def _outer(angle: float) -> Array:
    """Return where the middle of the outer edge of the board that turns is on the sheet (2,)."""
    side, board = TwoPlanes(_BOARD, np.radians(angle)).faces[1]
    return on_sheet(move(side, paper_and_squares(board)[0][[0, 3]].mean(axis=0)))


@lru_cache(maxsize=1)
def _way() -> Array:
    return np.array([_outer(angle) for angle in range(_OPEN, _FLAT + 1)])


def _in_camera(W: Array) -> Array:
    """Return where points (..., 3) are seen on the camera's drawn picture, on the sheet."""
    M = move(_VIEW.G, W)
    return on_sheet(move(inverse(_VIEW.G), _DEPTH * M / M[..., 2:]))


def _space(paper: Paper, angle: int) -> Panel:
    eye, (w, h) = on_sheet(_VIEW.centre), _VIEW.size
    parts = [
        [move(G, part) for part in paper_and_squares(board)]
        for G, board in TwoPlanes(_BOARD, np.radians(angle)).faces
    ]
    panel = paper.panel(_SPACE, *_SHOWN, "two boards before a camera: pull the left one open")
    panel.line(_way(), mixed("#FFFFFF", ESTIMATED, 0.4), 2)
    for border, squares in parts:
        draw_sheet(panel, on_sheet(border), on_sheet(squares))
    frame = _in_camera(_VIEW.centre + _VIEW.ray([[0, 0], [w, 0], [w, h], [0, h]]))
    panel.polygons(frame[None], "#E4E4E0")
    for border, squares in parts:
        draw_sheet(panel, _in_camera(border), _in_camera(squares))
    for at, after in zip(frame, np.roll(frame, -1, axis=0), strict=True):
        panel.line([at, after, eye], CAMERA, 1.8)
    side = frame[[1, 2]].mean(axis=0) + [8 * panel.pixel, 0]
    panel.text(side, "its photograph", CAMERA, size=13)
    panel.mark(_outer(angle), "estimated", 8)
    panel.grip("board", "the outer edge of the board on the left", _outer(angle), 3)
    return panel


def _dots(paper: Paper, angle: int) -> Panel:
    """Draw what 40 photographs say of α_u and α_v, and the band α_u ± its standard deviation."""
    true, tall = _A[[0, 1], [0, 1]], _REACH * _FOUND[1] / _FOUND[0]
    x, y = (true[0] - _REACH, true[0] + _REACH), (true[1] + tall, true[1] - tall)
    panel = paper.panel(_FOUND, x, y, "αᵤ (right) and αᵥ (up) of 40 photographs")
    if angle == _FLAT:
        panel.text(true, "anything: not determined", IDEAL, anchor="mm", size=14)
        return panel
    one = min(spread()[angle - _OPEN], _REACH)
    band = np.add(true, np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [one, tall])
    panel.polygons([band], mixed("#FFFFFF", ESTIMATED, 0.2))
    panel.ticks(x=(760, 780, 800, 820, 840), y=range(740, 880, 20), size=12)
    panel.mark(true, "ideal", 9)
    places = found()[angle - _OPEN]
    panel.polygons(places[:, None] + 2.5 * panel.pixel * circle(13), ESTIMATED)
    beyond = int((np.abs(places - true) > [_REACH, tall]).any(axis=1).sum())
    if beyond:
        words = f"{beyond} of {_PHOTOS} go beyond"
        panel.text(true + [0.96, -0.84] * np.array([_REACH, tall]), words, anchor="rm", size=13)
    return panel
