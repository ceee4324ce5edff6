"""Explore a calibrated camera: a tower stands on a photographed board, wherever it is pulled."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFilter

from cvnotes.base import Array
from cvnotes.calibration import pose_from_view
from cvnotes.camera import Camera, Lens, intrinsics, look_at
from cvnotes.pictures import course, desk, render_scene
from cvnotes.pictures.scenes import DESK_LIGHT
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, hexed
from cvnotes.targets import refine_subpixel

_BOARD = course.board()
_SQUARE, _SIDE = _BOARD.square, 2 * _BOARD.square  # mm
_CAMERA = Camera(
    intrinsics(1150, 1150, 639.5, 479.5),
    look_at([165, 400, -300], [95, 70, -22]),
    lens=Lens(k=(-0.25, 0.1)),
    size=(1280, 960),
)
_LIGHT = np.array(DESK_LIGHT) / np.linalg.norm(DESK_LIGHT)
_WINDOW = "#4A2E18"
_PAINT = np.array([[246, 150, 60], [236, 134, 46]])  # two tints of the tower's tiles
_EDGES = [(i, (i + 1) % 4 + i // 4 * 4) for i in range(8)] + [(i, i + 4) for i in range(4)]
_SHADED, _SOFT = 0.42, 6  # what a shadow leaves of the light; px of its edge
_CLOSE, _NEAR = 210, 14  # of 255, how dark it is under a foot; px that this reaches


class _Found(NamedTuple):
    """The photograph, lit and in the shade; cameras with the pose found from it: no lens, lens."""

    photo: Image.Image
    dark: Image.Image
    cameras: tuple[Camera, Camera]


@lru_cache(maxsize=1)
def _found() -> _Found:
    photo = render_scene(desk(_BOARD), _CAMERA)
    # On a page there is no OpenCV, and so no finder of boards: whole pixels are its start.
    m = refine_subpixel(photo.mean(axis=2), _CAMERA.project(_BOARD.points).round())
    bare = (
        Camera(_CAMERA.A, size=_CAMERA.size),
        Camera(_CAMERA.A, lens=_CAMERA.lens, size=_CAMERA.size),
    )
    without, with_lens = (one.moved(pose_from_view(one, _BOARD.points, m)) for one in bare)
    dark = Image.fromarray((photo * _SHADED).astype(np.uint8))
    return _Found(Image.fromarray(photo), dark, (without, with_lens))


def cube_model() -> Model:
    """Make the model of a desk with a board, and a tower on it."""
    columns, rows = _BOARD.corners
    settings = (
        Setting("x", "x (mm)", -50, columns * _SQUARE + 25, 1, 100, "where the tower stands"),
        Setting("y", "y (mm)", -50, rows * _SQUARE + 25, 1, 50, "where the tower stands"),
        Setting("height", "height (mm)", 20, 150, 1, 100, "how high the tower is"),
        Setting("turn", "turn (°)", -45, 45, 1, 0, "how far it is turned on the board"),
        Setting("lens", "with the lens", 0, 1, 1, 1, "whether the camera's lens is used"),
    )
    about = (
        "A photograph of a desk with a board, and a tower that stands on the board, drawn by the "
        "camera that was found from the board's corners. Beside it the board from above."
    )

    def draw(paper: Paper, values: Values) -> Drawing:
        found = _found()
        camera = found.cameras[int(values["lens"])]
        foot, h = np.array([values["x"], values["y"]]), values["height"]
        base = foot + _turned(values["turn"]) * _SIDE / 2
        panel = paper.picture_panel((540, 405), _CAMERA.size, "a tower: pull its foot or its top")
        panel.image(_in_the_shade(found, camera, base, h))
        corners = _draw_tower(panel, camera, base, h)
        if not values["lens"]:
            for i, j in _EDGES:  # where it belongs
                edge = corners[i] + np.linspace(0, 1, 9)[:, None] * (corners[j] - corners[i])
                panel.line(_CAMERA.project(edge), IDEAL, 1.2, dash=4)
        at = camera.project([*foot, 0])
        panel.grip("foot", "the foot of the tower", at, 5)
        panel.grip("top", "the top of the tower", camera.project([*foot, -h]), 12)
        plan = paper.panel((400, 405), (-155, 349), (-88, 422), "the same from above")
        _draw_plan(plan, base, h)
        off = np.linalg.norm(camera.project(corners) - _CAMERA.project(corners), axis=1)
        return Drawing(paper.join((panel, plan)), _sentence(foot, at, h, off, bool(values["lens"])))

    def carried(values: Values, at: Array) -> Values:
        x, y = on_board(_found().cameras[int(values["lens"])], at)
        return {"x": float(x), "y": float(y)}

    def stretched(values: Values, at: Array) -> Values:
        """Make the tower as high as the place over its foot that is level with the hand."""
        h = np.arange(20, 151.0)
        over = np.column_stack([np.full_like(h, values["x"]), np.full_like(h, values["y"]), -h])
        seen = _found().cameras[int(values["lens"])].project(over)
        return {"height": float(h[np.abs(seen[:, 1] - at[1]).argmin()])}

    return Model("cube", about, settings, draw, {"foot": carried, "top": stretched})


def on_board(camera: Camera, m: Array) -> Array:
    """Return the place (2,) of the board that a pixel shows: undo sensor and lens, then Z = 0."""
    H = camera.G[:3, [0, 1, 3]]
    x, y, w = np.linalg.solve(H, [*camera.ideal(m), 1])
    return np.array([x / w, y / w])


def _turned(angle: float) -> Array:
    """Return the corners (4, 2) of a square of side 2 about the origin, turned."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ [[c, s], [-s, c]]


def _shadow(base: Array, h: float) -> Array:
    """Return polygons (5, 4, 2) of the board that together are in the tower's shadow."""
    fallen = base + h * _LIGHT[:2] / _LIGHT[2]
    swept = [[base[i - 1], base[i], fallen[i], fallen[i - 1]] for i in range(4)]
    return np.array([*swept, fallen])


def _in_the_shade(found: _Found, camera: Camera, base: Array, h: float) -> Drawn:
    """Darken what lies in the tower's shadow, and, softer, what lies close round its foot."""
    seen = camera.project(np.insert(_shadow(base, h), 2, 0, axis=-1))
    w, height = _CAMERA.size
    mask = Image.new("L", (w // 2, height // 2))
    for corners in seen / 2:
        ImageDraw.Draw(mask).polygon(corners.ravel().tolist(), 255)
    soft = mask.filter(ImageFilter.GaussianBlur(_SOFT / 2))
    foot, round_it = camera.project(np.insert(base, 2, 0, axis=-1)) / 2, Image.new("L", mask.size)
    ImageDraw.Draw(round_it).polygon(foot.ravel().tolist(), _CLOSE)
    round_it = ImageChops.lighter(soft, round_it.filter(ImageFilter.GaussianBlur(_NEAR / 2)))
    return np.asarray(Image.composite(found.dark, found.photo, round_it.resize(_CAMERA.size)))


def _draw_tower(panel: Panel, camera: Camera, base: Array, h: float) -> Array:
    """Draw the tower's faces that are seen, in tiles; returns its corners (8, 3)."""
    low, high = np.insert(base, 2, 0, axis=1), np.insert(base, 2, -h, axis=1)
    faces = [high, *(np.array([high[i - 1], high[i], low[i], low[i - 1]]) for i in range(4))]
    middle = (low[0] + high[2]) / 2
    for a, b, c, d in faces:
        outside = (a + c) / 2 - middle
        outside = outside / np.linalg.norm(outside)
        if outside @ (camera.centre - a) <= 0:
            continue
        light = 0.55 + 0.5 * max(float(outside @ _LIGHT), 0)
        n, k = (round(float(np.linalg.norm(side)) / _SQUARE + 0.1) for side in (b - a, d - a))
        s, t = np.meshgrid(np.arange(n + 1) / n, np.arange(k + 1) / k)
        grid = camera.project(a + s[..., None] * (b - a) + t[..., None] * (d - a))
        for i in range(k):
            for j in range(n):
                tile = grid[[i, i, i + 1, i + 1], [j, j + 1, j + 1, j]]
                panel.polygons(tile[None], hexed(light * _PAINT[(i + j) % 2]))
                if outside[2] > -0.5:  # not on the roof
                    middle_of = tile.mean(axis=0)
                    panel.polygons((middle_of + 0.55 * (tile - middle_of))[None], _WINDOW)
    return np.concatenate([low, high])


def _draw_plan(panel: Panel, base: Array, h: float) -> None:
    columns, rows = _BOARD.corners
    rest = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    panel.polygons(((rest - 0.5) * 2000)[None], "#E4C7A3")
    panel.polygons(((rest * [columns + 3, rows + 3] - 2) * _SQUARE)[None], "#FFFFFF")
    panel.polygons(_shadow(base, h), "#8C8277")
    dark = [(i, j) for i in range(-1, columns) for j in range(-1, rows) if (i + j) % 2 == 0]
    panel.polygons((np.array(dark)[:, None] + rest) * _SQUARE, "#333333")
    eye = _CAMERA.centre[:2]
    panel.line([eye, base.mean(axis=0)], ESTIMATED, 0.9, dash=5)
    panel.polygons(base[None], ESTIMATED)
    panel.line(base[[0, 1, 2, 3, 0]], "#FFFFFF", 1.5)
    panel.mark(eye, "camera", 10, tuple(base.mean(axis=0) - eye))
    panel.text(eye - [14, 0], "camera", CAMERA, anchor="rm", size=12)


def _sentence(foot: Array, at: Array, h: float, off: Array, lens: bool) -> str:
    (x, y), (u, v) = foot, at
    said = (
        f"A tower {h:.0f} mm high at ({x:.0f}, {y:.0f}) mm: the middle of its foot would "
        f"be seen at ({u:.0f}, {v:.0f}) px. "
    )
    if lens:
        return (
            f"{said}Its corners are within {off.max():.2f} px of where the true camera sees them."
        )
    return (
        f"{said}Without the lens, and with the best pose that is left, it is up to "
        f"{off[:4].max():.1f} px off at its foot and {off[4:].max():.1f} px at its top."
    )
