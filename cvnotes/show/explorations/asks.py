"""Explore the backward warp: each pixel of the new picture asks where it comes from."""

from functools import cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, intrinsics, look_at
from cvnotes.homography import dlt
from cvnotes.pictures import render_scene
from cvnotes.pictures.posters import poster_room
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, hexed
from cvnotes.warping import (
    PixelMap,
    backward_warp,
    homography_map,
    map_array,
    rotation_map,
    undistortion_map,
    zoom_map,
)

SIZE, SHRINK = (60, 45), 3  # px of the photograph; and how many old pixels a new one is wide
NAMES = "rotation", "shrinking", "homography", "lens"
_LARGER = 6  # px of the page for a pixel of the photograph
_NEAR = 4  # pixels that the enlarged piece is wide and high
_EVERY = 3  # px from one line that a lens draws to the next
_DOT = 2.5  # px of the page that a dot is wide: each new pixel has one
_MIDDLE = (np.array(SIZE) - 1) / 2
_CORNERS = np.array([[6300, -900], [8900, -900], [8900, 300], [6300, 300]])  # of the print, mm
_MARGIN, _PIXEL = 120, 2840 / SIZE[0]  # of the wall around it, and side of a new pixel, mm
_LENS = Lens(k=(-0.3,))
_HALF = (np.array([4, 4]) + _MIDDLE) / 2  # half the way from a corner to the middle


def asks_model() -> Model:
    """Make the model of a new picture, whose pixels ask the photograph of a print."""
    settings = (
        Setting("warp", "which warp", 1, 4, 1, 1, "where new pixels ask", names=NAMES),
        Setting("u", "new pixel, across", 0, SIZE[0] - 1, 1, 31, "of 60; of 20 where it is shrunk"),
        Setting("v", "new pixel, down", 0, SIZE[1] - 1, 1, 18, "of 45; of 15 where it is shrunk"),
    )
    about = """A new picture, one pixel of it framed; a line to the place in the photograph where it
    asks; and the four pixels around that place, enlarged, with their weights and their mix. Each
    new pixel has a dot where it asks, orange where the next one is over a pixel away."""
    drags = {"pixel": lambda _, at: {"u": float(at[0]), "v": float(at[1])}}
    return Model("asks", about, settings, _draw, drags)


def camera(lens: Lens | None = None) -> Camera:
    """Return the camera before the print, with or without a lens that bends."""
    A = intrinsics(58, 58, *_MIDDLE)
    there = look_at([-1500, -300, 4900], [-2980, -300, 7330])
    return Camera(A, there, size=SIZE) if lens is None else Camera(A, there, lens, SIZE)


def where_from(warp: int) -> PixelMap:
    """Return where in the photograph the pixels of the new picture ask."""
    if warp == 1:
        return rotation_map(np.radians(-20), _MIDDLE)
    if warp == 2:
        return zoom_map(SHRINK)
    if warp == 4:
        return undistortion_map(camera(_LENS))
    # The wall as a picture of its own: the print in its middle, from margin to margin.
    corner = _CORNERS[0] - _MARGIN
    corner[1] = _CORNERS[:, 1].mean() - _PIXEL * SIZE[1] / 2
    on_wall = np.column_stack([np.full(4, -2979.0), _CORNERS[:, ::-1]])
    return homography_map(dlt((_CORNERS - corner) / _PIXEL - 0.5, camera().project(on_wall)))


@cache
def photograph(bent: bool) -> Drawn:
    """Take the print from the side, with few pixels, so that each one is seen."""
    return render_scene(poster_room(), camera(_LENS if bent else None), samples=64)


@cache
def answered(warp: int) -> tuple[Drawn, Array, int]:
    """Return the new picture, where its pixels asked (h, w, 2), and how many were read there."""
    size = (SIZE[0] // SHRINK, SIZE[1] // SHRINK) if warp == 2 else SIZE
    photo, asked = photograph(warp == 4), map_array(where_from(warp), size)
    low = np.floor(asked.reshape(-1, 2))
    part = asked.reshape(-1, 2) - low
    read = np.zeros(SIZE[::-1], bool)
    for step in np.array([[0, 0], [1, 0], [0, 1], [1, 1]]):
        weight = np.prod(np.where(step, part, 1 - part), axis=1)
        u, v = (low + step).astype(int)[weight > 1e-9].T
        inside = (u >= 0) & (u < SIZE[0]) & (v >= 0) & (v < SIZE[1])
        read[v[inside], u[inside]] = True
    return backward_warp(photo, asked, fill=255).astype(np.uint8), asked, int(read.sum())


def _draw(paper: Paper, values: Values) -> Drawing:
    warp = int(values["warp"])
    new, asked, read = answered(warp)
    photo, wide = photograph(warp == 4), SIZE[0] // new.shape[1]
    u, v = int(values["u"]) // wide, int(values["v"]) // wide
    at, here = asked[v, u], wide * (np.array([u, v]) + 0.5) - 0.5
    shown = (_LARGER * SIZE[0], _LARGER * SIZE[1])
    left = paper.picture_panel(shown, SIZE, "the new picture: pull the pixel that asks")
    left.image(new, smooth=False)
    where, there = "", "dots where they ask, orange if over 1 px apart"
    if warp == 4:
        nearer = f"{np.hypot(*(at - here)):.2f} px nearer to the middle"
        where, there = f", {nearer}", f"it asks {nearer}"
    elif not ((at > -1) & (at < SIZE)).all():
        where = ", beside the photograph"
    right = paper.picture_panel(shown, SIZE, f"{NAMES[warp - 1]}: {there}")
    right.image(_pale(photo), smooth=False)  # on which dots are seen everywhere
    if warp == 4:  # from where they would ask without it
        own = map_array(lambda m: m, SIZE)
        ways = np.stack([own, asked], axis=2)[1::_EVERY, 1::_EVERY]
        right.segments(ways.reshape(-1, 2, 2), "white", 3.2)
        right.segments(ways.reshape(-1, 2, 2), LENS, 1.8)
    half = _DOT / 2 * right.pixel
    far = apart(asked)
    inks = np.where(far.max(axis=-1) > 1.000001, ESTIMATED, LENS).ravel().tolist()
    right.polygons([_square(dot - half, 2 * half)[:4] for dot in asked.reshape(-1, 2)], inks)
    if warp == 4:
        _framed(left, _HALF + 0.8 * circle(25), 1)
        _framed(right, (here, at), 4)
    else:
        _draw_connected(left, right, here + [wide / 2, 0], at)
    _framed(left, _square(here - wide / 2, wide), 2)
    _framed(right, _square(np.floor(at) - 0.5, 2), 2)
    left.grip("pixel", "a pixel of the new picture", here, wide)
    near, mix = _near(paper, photo, asked, (u, v)), _mix(paper, photo, at)
    across, down = far[v, u]
    sentence = f"""New pixel ({u}, {v}) asks at ({at[0]:.2f}, {at[1]:.2f}){where}; its neighbour in
    the row asks {across:.2f} px from there, the one in the column {down:.2f} px. All
    {new[..., 0].size} new pixels together read {read} of the photograph's {photo[..., 0].size}."""
    return Drawing(paper.join((left, right, [near, mix])), sentence)


def _draw_connected(left: Panel, right: Panel, begin: Array, at: Array) -> None:
    """Draw one line over both panels, from a new pixel to where it asks: a gap is between."""
    beside = np.array([right.sheet[0] / (right.width / 2) * SIZE[0], 0])
    end, out = np.array([np.floor(at[0]) - 0.5, at[1]]), not ((at > -1) & (at < SIZE)).all()
    if out:  # to the border of the photograph, within, and from there an arrow
        border = np.clip(at, -0.5, np.array(SIZE) - 0.5)
        end = border + 4 * np.sign(border - at)
    for panel, ends in ((left, (begin, end + beside)), (right, (begin - beside, end))):
        _framed(panel, ends, 1.6)
    if out:
        right.arrows(end, border - end, "white", 5)
        right.arrows(end, border - end, ESTIMATED, 2.4)


def _pale(photo: Drawn) -> Drawn:
    """Return a photograph as paper shines through it."""
    return np.asarray(np.rint(0.6 * photo + 102), dtype=np.uint8)


def apart(asked: Array) -> Array:
    """Return how far from where each pixel asks the next one across and down does (h, w, 2), in px.

    For the last ones it is that of the ones before them.
    """
    across, down = (np.linalg.norm(np.diff(asked, axis=k), axis=2) for k in (1, 0))
    ends = ((0, 0), (0, 1)), ((0, 1), (0, 0))
    both = [np.pad(far, end, "edge") for far, end in zip((across, down), ends, strict=True)]
    return np.stack(both, axis=-1)


def _square(corner: Array, side: float) -> Array:
    """Return the outline (5, 2) of a square."""
    return corner + side * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])


def _framed(panel: Panel, line: tuple[Array, Array] | Array, width: float) -> None:
    """Draw a line with a white rim, to be seen on dark and light."""
    panel.line(np.array(line), "white", width + 2)
    panel.line(np.array(line), ESTIMATED, width)


def weighed(photo: Drawn, at: Array) -> tuple[Array, Array]:
    """Return the weights (4,) of the pixels around a place, and their colours (4, 3).

    Beside the photograph is white paper.
    """
    (u, v), (du, dv) = np.floor(at).astype(int), at - np.floor(at)
    weight = np.array([(1 - du) * (1 - dv), du * (1 - dv), (1 - du) * dv, du * dv])
    padded = np.pad(photo, ((_NEAR, _NEAR), (_NEAR, _NEAR), (0, 0)), constant_values=255)
    u, v = np.clip([u, v], -_NEAR, np.array(SIZE) + _NEAR - 2) + _NEAR
    return weight, padded[v : v + 2, u : u + 2].reshape(4, 3).astype(float)


def _near(paper: Paper, photo: Drawn, asked: Array, pixel: tuple[int, int]) -> Panel:
    """Draw the place enlarged: the four pixels around it as they are, the others pale.

    Small crosses are where the neighbours of the framed pixel ask.
    """
    (column, line) = pixel
    at = asked[line, column]
    low = np.floor(at).astype(int)
    begin = low + 1 - _NEAR // 2
    u, v = begin.tolist()
    x, y = (u - 0.5, u + _NEAR - 0.5), (v - 0.5, v + _NEAR - 0.5)
    panel = paper.panel((180, 180), x, y, "its four; small ×: neighbours")
    padded = np.pad(photo, ((_NEAR, _NEAR), (_NEAR, _NEAR), (0, 0)), constant_values=255)
    u, v = np.clip([u, v], -_NEAR, SIZE) + _NEAR
    piece = padded[v : v + _NEAR, u : u + _NEAR].astype(float)
    lit = np.zeros((_NEAR, _NEAR, 1))
    lit[1:3, 1:3] = 1
    panel.image(np.rint(lit * piece + (1 - lit) * (0.25 * piece + 191)).astype(np.uint8))
    if not ((at > -1) & (at < SIZE)).all():
        panel.text(low + [0.5, 0.5], "beside: fill", ESTIMATED, anchor="mm", size=14)
        return panel
    # The square between the four centres, in four parts: each weighs the opposite pixel.
    (u, v), (x0, y0) = at, low
    _framed(panel, _square(low, 1), 1.6)
    panel.segments([[[u, y0], [u, y0 + 1]], [[x0, v], [x0 + 1, v]]], "white", 3)
    panel.segments([[[u, y0], [u, y0 + 1]], [[x0, v], [x0 + 1, v]]], ESTIMATED, 1.2)
    around = asked[max(line - 1, 0) : line + 2, max(column - 1, 0) : column + 2]
    panel.mark(around.reshape(-1, 2), "estimated", 4)
    panel.mark(low + np.array([[0, 0], [1, 0], [0, 1], [1, 1]]), "lens", 6)
    for k, w in enumerate(weighed(photo, at)[0]):  # above and below: the cross is between
        step = np.array([k % 2, k // 2])
        panel.text(low + step + [0, 1.6 * (step[1] - 0.5)], f"{w:.2f}", IDEAL, anchor="mm", size=14)
    panel.mark(at, "estimated", 8)
    return panel


def _mix(paper: Paper, photo: Drawn, at: Array) -> Panel:
    """Draw the four colours as wide as they weigh, above what they mix to."""
    panel = paper.panel((180, 62), (0, 1), (0, 2), "their mix: the new pixel")
    weight, colours = weighed(photo, at)
    ends = np.cumsum(weight)
    for end, w, colour in zip(ends, weight, colours, strict=True):
        panel.polygons([[[end - w, 0], [end, 0], [end, 1], [end - w, 1]]], hexed(colour))
    panel.polygons([[[0, 1], [1, 1], [1, 2], [0, 2]]], hexed(np.rint(weight @ colours)))
    return panel
