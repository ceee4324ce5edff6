"""Explore depth: shift one picture of a pair until a thing has no fringe; read how far it is."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array, Image, luma
from cvnotes.camera import Camera, intrinsics, pose
from cvnotes.pictures import depth_map, pixel_centres, radiance, room
from cvnotes.pictures.meshes import from_above
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, MUTED, hexed, rgb
from cvnotes.warping import backward_warp

_PICTURE, _PLAN = (440, 330), (300, 330)
_ALPHA, _BASE, _SIZE = 520, 400, (640, 480)  # px, mm, px
_NEAREST, _FARTHEST = 2500, 10_500  # mm
_SAME, _AGREES = 120, 0.3  # mm of depth, and px of disparity, that are drawn as one
_NAMES = {"wall": (0, 10_400), "cupboard": (900, 9100), "box": (650, 6800), "table": (-2100, 5900)}

_LEFT, _RIGHT = "#D92B2B", "#0A8F96"  # red and cyan, as dark as lines must be
_WALLS = [[-3000, -600], [-3000, 10_000], [3000, 10_000], [3000, -600]]


def pair() -> tuple[Camera, Camera]:
    """Return two cameras that look the same way, the right one beside the left one."""
    A = intrinsics(_ALPHA, _ALPHA, (_SIZE[0] - 1) / 2, (_SIZE[1] - 1) / 2)
    left = Camera(A, size=_SIZE)
    return left, left.moved(pose(np.eye(3), [-_BASE, 0, 0]))


def in_two_colours(left: Image, right: Image, d: float) -> Drawn:
    """Lay two grey pictures over each other, in red and cyan, the right one d px to the right."""
    moved = backward_warp(right, lambda m: m - [d, 0], border="replicate")
    return np.stack([left, moved, moved], axis=-1).clip(0, 255).astype(np.uint8)


def depth_model() -> Model:
    """Make the model of the room, seen by two cameras side by side."""
    settings = (
        Setting("depth", "depth (mm)", _NEAREST, _FARTHEST, 50, 4000,
                "what is so far away lies upon itself in both pictures"),
        Setting("row", "row (px)", 0, _SIZE[1] - 1, 1, 225, "the row whose grey values are drawn"),
    )  # fmt: skip
    about = (
        "A room by two cameras side by side, one picture in red and the other in cyan, shifted "
        "until what lies at one depth, orange, has no fringes; beside it the room from above. "
        "Below, the grey values of one row in both pictures, two curves that meet at this depth."
    )

    @lru_cache(maxsize=1)
    def depths() -> Array:
        return depth_map(room(), pair()[0])

    @lru_cache(maxsize=1)
    def photographs() -> tuple[Image, Image]:
        left, right = (luma(radiance(room(), camera, samples=4)) for camera in pair())
        return left, right

    def draw(paper: Paper, values: Values) -> Drawing:
        Z, row = values["depth"], round(values["row"])
        d = _ALPHA * _BASE / Z
        panel = paper.picture_panel(_PICTURE, _SIZE, "left in red, right in cyan and shifted")
        picture = in_two_colours(*photographs(), d)
        there = np.abs(_ALPHA * _BASE / depths() - d) < _AGREES
        picture[there] = (picture[there] + 255 * np.array(rgb(ESTIMATED))) / 2
        panel.image(picture)
        panel.line([[-1, row], [_SIZE[0], row]], IDEAL, 1, dash=5)
        panel.mark([24, row], "ideal", 8)
        panel.grip("row", "the row whose grey values are drawn", [24, row], 4)
        curves = _row(paper, row, d, *photographs(), there[row])
        drawn = paper.join((panel, _plan(paper, Z)), curves)
        return Drawing(drawn, _sentence(Z, d, row, int(there[row].sum())))

    drags = {
        "depth": lambda _, at: {"depth": float(at[1])},
        "row": lambda _, at: {"row": float(at[1])},
    }
    return Model("depth", about, settings, draw, drags)


def _row(
    paper: Paper, row: int, d: float, left: Image, right: Image, there: Array
) -> tuple[Panel, Panel]:
    """Draw the grey values of a row of both pictures, orange where the depth is the chosen one."""
    curves = paper.panel((_PICTURE[0], 104), (-0.5, _SIZE[0] - 0.5), (262, -8), "their grey values")
    legend = paper.panel((_PLAN[0], 104), (0, 1), (1, 0))
    u = np.arange(_SIZE[0])
    for height, x, grey, colour, width, words in (
        (0.8, u, np.where(there, left[row], np.nan), ESTIMATED, 7, "both, as far away as the line"),
        (0.5, u + d, right[row], _RIGHT, 1.4, f"right picture, {d:.1f} px to the right"),
        (0.2, u, left[row], _LEFT, 1.4, f"left picture, row {row}"),
    ):
        curves.line(np.column_stack([x, grey]), colour, width)
        legend.line([[0.04, height], [0.12, height]], colour, width)
        legend.text([0.16, height], words, colour, size=12)
    return curves, legend


def _sentence(Z: float, d: float, row: int, there: int) -> str:
    wall = seen_from_above()[:, 1].max()
    fringe = abs(d - _ALPHA * _BASE / wall)
    said = f"Shifted by {d:.1f} px: what is {Z / 1000:.2f} m away has no fringes. "
    if fringe < 0.2:
        said += "That is the wall behind."
    else:
        said += f"Those of the wall behind are {fringe:.1f} px wide."
    return f"{said} In row {row} {there} of {_SIZE[0]} pixels have this shift."


@lru_cache(maxsize=1)
def seen_from_above() -> Array:
    """Return the places (n, 2), x and z in mm, of what the left camera sees of walls and things."""
    camera, _ = pair()
    some = np.s_[::6, ::3]
    z = depth_map(room(), camera)[some][..., None]
    M = z * np.concatenate([camera.ideal(pixel_centres(_SIZE)[some]), np.ones_like(z)], axis=-1)
    upright = np.abs(M[..., 1]) < 1590  # neither floor nor ceiling, which are 1600 mm away
    return np.asarray(M[upright][:, [0, 2]])


def _plan(paper: Paper, Z: float) -> Panel:
    """Draw the room from above, with the depth at which nothing has a fringe."""
    panel = paper.panel(_PLAN, (-4700, 5500), (10_900, -320), "from above: pull the line")
    for corners, colour in zip(*from_above(room(), -1500), strict=True):
        panel.polygons([corners], hexed(np.rint(255 * colour)))
    panel.line(_WALLS, MUTED, 2)
    for metres in (2, 4, 6, 8, 10):
        panel.text([-3250, 1000 * metres], f"{metres} m", MUTED, anchor="rm", size=10)
    for thing, at in _NAMES.items():
        panel.text(at, thing, "#333333", anchor="mm", size=11)
    panel.line([[-3000, Z], [4200, Z]], ESTIMATED, 1, dash=5)
    places = seen_from_above()
    there = places[np.abs(places[:, 1] - Z) < _SAME]
    panel.segments(there[:, None] + [[-25, 0], [25, 0]], ESTIMATED, 3)
    panel.mark([[0, 0], [_BASE, 0]], "camera", 7)
    panel.mark([4200, Z], "estimated", 8)
    panel.text([4200, Z - 480], f"{Z / 1000:.2f} m", IDEAL, anchor="mm", size=12)
    panel.grip("depth", "how far away things have no fringe", [4200, Z], 4)
    return panel
