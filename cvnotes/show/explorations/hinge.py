"""Explore why depth is needed: two boards open to one plane, and no focal length is left."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, inverse, look_at, move
from cvnotes.pictures import course
from cvnotes.show.explorations.boards import draw_sheet, paper_and_squares
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import GRID, Panel, Paper
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.space.directions import sheet
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, MUTED, mixed
from cvnotes.targets import Chessboard, TwoPlanes

_BOARD, _A = Chessboard((7, 6), 25.0), course.camera().A
_VIEW = Camera(_A, look_at([470, 40, -520], [65, 62, -75]))
_SPACE, _CURVE, _FOUND = (520, 400), (340, 246), (340, 126)  # px
_OPEN, _FLAT = 90, 180  # degrees between the boards
_NOISE, _PHOTOS = 0.1, 40  # px, of each coordinate
_REACH = 130  # px, of α
_LEAST, _MOST = 0.5, 180  # px: the ends of the curve's axis
_END = 0.45  # degrees: where on the logarithmic axis no bend at all stands
_DEPTH = 165  # mm from the camera to its drawn picture
_SHEET = sheet((24, -56))
_SHOWN = ((-292, 278), (-106, 332))  # mm of the sheet


def on_sheet(W: Array) -> Array:
    """Project points (..., 3) onto the sheet (..., 2), all parallel."""
    return np.asarray(W @ _SHEET.T)


def hinge_model() -> Model:
    """Make the model of a photograph of two boards on a hinge, and of how well it determines α."""
    settings = (
        Setting("angle", "angle of the boards (°)", _OPEN, _FLAT, 1, 150, "180° is one plane"),
    )
    about = (
        "A camera before two boards on a hinge. Beside it, against the angle between them, on two "
        "logarithmic axes: how exactly one photograph of both determines the focal length; and "
        "below the focal lengths that 40 of them give, as dots."
    )

    def turned(_: Values, at: Array) -> Values:
        nearest = np.linalg.norm(_way() - at, axis=1).argmin()
        return {"angle": float(_OPEN + nearest)}

    def along(_: Values, at: Array) -> Values:
        return {"angle": float(round(_FLAT - 10 ** -np.clip(at[0], -2, 1)))}

    drags = {"board": turned, "angle": along}
    return Model("hinge", about, settings, _draw, drags)


@lru_cache(maxsize=1)
def gains() -> Array:
    """Return by how much α_u moves with each coordinate of the corners, for 90° to 179°: (90, 168).

    Least squares find (JᵀJ)⁻¹Jᵀ n for small noise n, in all u and then all v, where J has the
    derivatives of u = α_u x/z + u0 and v = α_v y/z + v0 by the four intrinsics and the pose.
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
    return np.asarray(np.linalg.solve(across @ across.swapaxes(1, 2), across)[:, 0] / size[:, :, 0])


@lru_cache(maxsize=1)
def found() -> Array:
    """Return α_u as 40 photographs give it (angles, 40), the same noise for each angle."""
    noise = np.random.default_rng(0).normal(scale=_NOISE, size=(_PHOTOS, gains().shape[1]))
    return np.asarray(_A[0, 0] + gains() @ noise.T)


@lru_cache(maxsize=1)
def spread() -> Array:
    """Return the standard deviation of α_u for each angle, px."""
    return np.asarray(_NOISE * np.linalg.norm(gains(), axis=1))


def _draw(paper: Paper, values: Values) -> Drawing:
    angle = round(values["angle"])
    drawn = paper.join((_space(paper, angle), [_curve(paper, angle), _dots(paper, angle)]))
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


def _at(bend: float) -> float:
    """Return where a bend stands on the axis: the smaller, the farther to the right."""
    return -float(np.log10(max(bend, _END)))


def _curve(paper: Paper, angle: int) -> Panel:
    """Draw the standard deviation of α over the bend, 180° less the angle, both logarithmic."""
    low, high = np.log10([_LEAST, _MOST])
    left, right = _at(130), _at(0) + 0.12
    title = "± of αᵤ (px), by the angle: each line up × 10"
    panel = paper.panel(_CURVE, (left, right), (high, low), title)
    for bend in (90, 45, 20, 10, 4, 2, 1):
        panel.line([[_at(bend), low], [_at(bend), high]], GRID, 0.5)
        panel.text([_at(bend), low + 0.1], f"{_FLAT - bend}°", anchor="md", size=12)
    for px in (1, 10, 100):
        panel.line([[left, np.log10(px)], [right, np.log10(px)]], GRID, 0.5)
        panel.text([left + 0.03, np.log10(px)], f"{px}", size=12)
    bends = np.arange(_FLAT - _OPEN, 0, -1)
    panel.line(np.stack([-np.log10(bends), np.log10(spread())], axis=1), ESTIMATED, 2.2)
    held = [_at(0), np.log10(130)]
    if angle < _FLAT:
        held = [_at(_FLAT - angle), np.log10(spread()[angle - _OPEN])]
    panel.line([[held[0], low + 0.28], held], MUTED, 0.8)
    panel.mark(held, "estimated", 8)
    panel.grip("angle", "the angle between both boards", held, 3)
    return panel


def _dots(paper: Paper, angle: int) -> Panel:
    """Draw what 40 photographs say of α, and the band α ± its standard deviation."""
    alpha = _A[0, 0]
    title = "αᵤ found in 40 photographs (px)"
    panel = paper.panel(_FOUND, (alpha - _REACH, alpha + _REACH), (-1.1, 1.6), title)
    panel.ticks(x=(700, 750, 800, 850, 900), size=12)
    if angle == _FLAT:
        panel.text([alpha, 0], "anything: it is not determined", IDEAL, anchor="mm", size=14)
        return panel
    one = min(spread()[angle - _OPEN], _REACH)
    band = [alpha - one, alpha + one]
    panel.polygons(
        [[[band[0], -1], [band[1], -1], [band[1], 1], [band[0], 1]]],
        mixed("#FFFFFF", ESTIMATED, 0.2),
    )
    panel.line([[alpha, -1], [alpha, 1]], IDEAL, 1)
    places = np.stack([found()[angle - _OPEN], np.linspace(-0.9, 0.9, _PHOTOS)], axis=1)
    dot = 1.7 * circle(13) * [panel.pixel, 2.7 / _FOUND[1]]
    within = np.abs(places[:, 0] - alpha) <= _REACH
    panel.polygons(places[within, None] + dot, ESTIMATED)
    beyond = int((~within).sum())
    if beyond:
        words = f"{beyond} of {_PHOTOS} go beyond"
        panel.text([alpha + 0.97 * _REACH, -0.85], words, IDEAL, anchor="rm", size=13)
    return panel
