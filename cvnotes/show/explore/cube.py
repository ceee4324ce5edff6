"""Explore a tower on a desk, drawn into a photograph by the camera that photographs gave."""

import warnings
from functools import lru_cache

import numpy as np
from PIL import Image, ImageDraw

from cvnotes.base import Array, CalibrationWarning
from cvnotes.calibration import calibrate
from cvnotes.camera import Camera, Lens, intrinsics, look_at
from cvnotes.pictures import course, desk, render_scene
from cvnotes.pictures.scenes import DESK_LIGHT
from cvnotes.show.explore.model import Drawing, Model, Setting, Values
from cvnotes.show.explore.paper import Panel, Paper
from cvnotes.show.style import IDEAL, LENS
from cvnotes.targets import refine_subpixel

_TAKEN_BY = Camera(intrinsics(600, 600, 359.5, 269.5), lens=Lens(k=(-0.2,)), size=(720, 540))
# Where the photographs were taken, and what was in their middle, in mm; the first one is shown.
_PLACES = (
    ((205, 315, -235), (102, 74, -12)),
    ((-90, -110, -290), (95, 65, 0)),
    ((110, 240, -330), (100, 66, 0)),
)
_SIDE = 50.0  # mm, of the foot: two squares
_LIGHT = np.array(DESK_LIGHT) / np.linalg.norm(DESK_LIGHT)  # towards the lamp
_THROWN = np.array(DESK_LIGHT)[:2] / DESK_LIGHT[2]  # where the shadow of height 1 falls
_LAMP = 0.09 * np.array([(r * np.cos(2.4 * i), r * np.sin(2.4 * i))
                         for i, r in enumerate(np.sqrt(np.linspace(0, 1, 24)))])  # fmt: skip
_PIECES = np.linspace(0, 1, 12, endpoint=False)[:, None]  # of an edge, which a lens may bend
_WALL, _GLASS = np.array([244, 140, 41]), np.array([90, 54, 30])  # seen where all light falls
_DIM = 0.6  # where no light falls
_FLOOR = 12.5  # mm, from one row of windows to the next
_CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * _SIDE / 2


@lru_cache(maxsize=1)
def photographed() -> tuple[Image.Image, Image.Image, Camera]:
    """Photograph a desk, lit and in the shade, and find the camera from the gradients of pixels."""
    board = course.board()
    scene = desk(board)
    eyes = [_TAKEN_BY.moved(look_at(eye, at, up=(0, 0, -1))) for eye, at in _PLACES]
    photos = [render_scene(scene, eye, samples=4) for eye in eyes]
    # Marked by hand, to a whole pixel; the finder needs more than NumPy.
    marked = [np.rint(eye.project(board.points)) for eye in eyes]
    seen = np.array([refine_subpixel(*each) for each in zip(photos, marked, strict=True)])
    with warnings.catch_warnings(action="ignore", category=CalibrationWarning):
        found = calibrate(board.points, seen, _TAKEN_BY.size, lens="k1")
    dark = render_scene(scene.lit_from((0, 0, 1)), eyes[0], samples=4)
    return Image.fromarray(photos[0]), Image.fromarray(dark), found.camera.moved(found.poses[0])


def cube_model() -> Model:
    """Make the model of a tower that a hand pulls over the board on a desk."""
    settings = (
        Setting("x", "x (mm)", -25, 225, 0.5, 125, "the middle of its foot, along the board's x"),
        Setting("y", "y (mm)", -25, 150, 0.5, 75, "the middle of its foot, along the board's y"),
        Setting("turn", "turn (°)", -90, 90, 1, 0, "about its own axis"),
        Setting("height", "height (mm)", 12.5, 150, 12.5, 100, "one more row of windows each step"),
        Setting("lens", "the lens counts", 0, 1, 1, 1, "whether k1 is used"),
    )
    about = (
        "The photograph of a chessboard on a desk, and on the board an orange tower with its "
        "windows and its shadow, drawn by the camera that was found from three such photographs."
    )

    def pulled(values: Values, at: Array) -> Values:
        foot = _foot(values)
        by = on_board(_used(values), at)[:2] - foot[_nearest(foot)]
        return {"x": float(values["x"] + by[0]), "y": float(values["y"] + by[1])}

    return Model("cube", about, settings, _draw, {"foot": pulled})


def on_board(camera: Camera, m: Array) -> Array:
    """Return where a pixel's ray meets the plane Z = 0; (0, 0, 0) if the lens shows no such."""
    ray = camera.ray(m)
    down = max(float(ray[2]), 1e-9)  # above the horizon no ray comes down
    return np.asarray(np.nan_to_num(camera.centre - camera.centre[2] / down * ray))


def _used(values: Values) -> Camera:
    found = photographed()[2]
    return found if values["lens"] else Camera(found.A, found.G, size=found.size)


def _draw(paper: Paper, values: Values) -> Drawing:
    lit, dark, found = photographed()
    camera, foot, height = _used(values), _foot(values), values["height"]
    size = (380, 285) if paper.narrow else _TAKEN_BY.size
    panel = paper.picture_panel(size, _TAKEN_BY.size, "a tower on your desk")
    panel.image(np.asarray(Image.composite(dark, lit, _shadow(camera, foot, height))))
    _draw_tower(panel, camera, foot, height)
    x, y = foot[_nearest(foot)].tolist()
    edge = camera.project([[x, y, 0], [x, y, -height]])
    tall, belongs = float(np.linalg.norm(edge[1] - edge[0])), found.project([x, y, 0])
    said = (
        f"The near corner of its foot stands at ({x:.0f}, {y:.0f}) mm, in pixel "
        f"({edge[0, 0]:.0f}, {edge[0, 1]:.0f}); its {height:g} mm are {tall:.0f} px long there."
    )
    if not values["lens"]:
        panel.line(found.project(_outline(_raised(foot, 0))), LENS, 2)
        panel.text(
            belongs + panel.pixel * np.array([-16, 8]),
            "where its foot belongs",
            LENS,
            anchor="ra",
            size=12,
        )
        off = float(np.linalg.norm(edge[0] - belongs))
        said += f" Without k1 this corner misses its place by {off:.1f} px."
    beside = camera.project(np.concatenate([_raised(foot, h) for h in (0, height)]))[:, 0].max()
    beside = min(beside + 8 * panel.pixel, panel.x[1] - 50 * panel.pixel)
    panel.text([beside, edge[:, 1].mean()], f"{tall:.0f} px", IDEAL, size=13)
    panel.mark(edge[0], "estimated", 9)
    panel.grip("foot", "the tower's foot, to be pulled over the board", edge[0], 6)
    return Drawing(paper.join((panel,)), said)


def _foot(values: Values) -> Array:
    """Return the corners (4, 2) of the tower's foot on the board."""
    turn = np.radians(values["turn"])
    across = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return np.asarray([values["x"], values["y"]] + _CORNERS @ across.T)


def _nearest(foot: Array) -> int:
    """Return which corner is nearest to the camera along its axis: wherever the tower stands."""
    return int(np.argmin(photographed()[2].depth(_raised(foot, 0))))


def _raised(xy: Array, by: float) -> Array:
    """Put points (n, 2) of the board so many mm above it; z leads into the board."""
    return np.column_stack([xy, np.full(len(xy), -float(by))])


def _outline(W: Array) -> Array:
    """Return a closed polygon (n, 3) in short pieces, for a lens to bend."""
    to = np.roll(W, -1, axis=0)
    return np.concatenate([a + _PIECES * (b - a) for a, b in zip(W, to, strict=True)])


def _shadow(camera: Camera, foot: Array, height: float) -> Image.Image:
    """Return how much of the lamp is hidden: the mean over points of it, softer far from the foot.

    The shadow of a convex block is swept by its foot as that moves to where its roof's falls.
    """
    dark = np.zeros(_TAKEN_BY.size[::-1], np.float32)
    for point in _LAMP:
        by = height * (_THROWN + point)
        mask = Image.new("L", _TAKEN_BY.size)
        for a, b in zip(foot, np.roll(foot, -1, axis=0), strict=True):
            side = camera.project(_outline(_raised(np.array([a, b, b + by, a + by]), 0)))
            ImageDraw.Draw(mask).polygon(side.ravel().tolist(), fill=255)
        dark += np.asarray(mask)
    return Image.fromarray((dark / len(_LAMP)).astype(np.uint8))


def _draw_tower(panel: Panel, camera: Camera, foot: Array, height: float) -> None:
    """Fill the walls that face the camera, their windows, and the roof."""
    for a, b in zip(foot, np.roll(foot, -1, axis=0), strict=True):
        out = np.array([b[1] - a[1], a[0] - b[0], 0]) / _SIDE
        if out @ (camera.centre - [*a, 0]) > 0:
            shade = _DIM + (1 - _DIM) * max(0.0, float(out @ _LIGHT))
            wall = np.array([[*a, 0], [*b, 0], [*b, -height], [*a, -height]])
            _fill(panel, camera, wall, _WALL * shade)
            for low in np.arange(0, height, _FLOOR):
                for left in (0.1, 0.4, 0.7):
                    s = np.array([left, left + 0.2, left + 0.2, left])[:, None]
                    z = -(low + _FLOOR * np.array([0.25, 0.25, 0.8, 0.8]))
                    _fill(panel, camera, np.column_stack([a + s * (b - a), z]), _GLASS * shade)
    roof = _raised(foot, height)
    if camera.centre[2] < -height:
        _fill(panel, camera, roof, _WALL * (_DIM - (1 - _DIM) * _LIGHT[2]))
    panel.line(camera.project(_outline(roof)), "white", 1)


def _fill(panel: Panel, camera: Camera, W: Array, colour: Array) -> None:
    red, green, blue = colour.astype(int).tolist()
    panel.polygons(camera.project(_outline(W))[None], f"#{red:02X}{green:02X}{blue:02X}")
