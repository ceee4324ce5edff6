"""Explore two errors: pull one dot of a tiled floor, and see how far two homographies give way."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera
from cvnotes.homography import dlt, refine_homography
from cvnotes.pictures import course
from cvnotes.projective import apply
from cvnotes.show.explorations.model import Drag, Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Paper, circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED

_SHOWN = (115.0, 1495.0), (525.0, 1200.0)  # px, u and v: below, the sensor ends
_WIDE, _NARROW = (754, 369), (374, 240)  # px
_TIMES = 7  # as long as they are, arrows are drawn
_FAR, _DOWN = 100, 60  # px: how far a dot can be pulled; down to the sensor's end
_TONES = np.array([[255, 250, 244], [243, 231, 219]])  # of the tiles
_INKS = LENS, ESTIMATED  # of the DLT, and of the least error in pixels


def swing_model() -> Model:
    """Make the model of six rows of tiles, one dot of which is pulled."""
    settings = (
        Setting("row", "row", 1, 6, 1, 6, "of the dot that is pulled; row 1 is near"),
        Setting("column", "column", 1, 7, 1, 1, "of the dot that is pulled, from the left"),
        Setting("du", "pulled to the right (px)", -_FAR, _FAR, 1, 0, "in the picture"),
        Setting("dv", "pulled down (px)", -_FAR, _DOWN, 1, 20, "in the picture"),
    )
    about = """A tiled floor with six rows of dots, one of which is pulled away, and arrows that
    show how row 1 gives way: of the DLT, and of the homography with the least error in pixels.
    Beside each row its weight in the DLT."""

    def pulled(row: int) -> Drag:
        def drag(values: Values, at: Array) -> Values:
            du, dv = (at - _dots()[row - 1, int(values["column"]) - 1]).tolist()
            return {"row": row, "du": du, "dv": dv}

        return drag

    drags = {f"row {row}": pulled(row) for row in range(1, 7)}
    return Model("swing", about, settings, _draw, drags)


@lru_cache(maxsize=1)
def rows_of_tiles() -> tuple[Array, Array]:
    """Return the corners (42, 2) of six rows of tiles on chapter 6's floor, and their pixels.

    The sensor has 1600 × 1200 pixels, so that the nearest row is seen, too.
    """
    G = np.array([[1.0, 0, 0, 0], [0, 0, -1, 300], [0, 1, 0, 0], [0, 0, 0, 1]])
    rows, columns = (450, 600, 900, 1500, 3000, 6000), range(-300, 301, 100)
    tiles = np.array([[x, y] for y in rows for x in columns], float)
    return tiles, Camera(floor_A(), G).project(np.insert(tiles, 2, 0, axis=1))


def floor_A() -> Array:
    """Return A (3, 3) of the camera over the floor: as the course's, with a larger sensor."""
    return np.asarray(course.camera().A + [[0, 0, 480], [0, 0, 360], [0, 0, 0]])


@lru_cache(maxsize=16)
def nets(row: int, column: int, du: float, dv: float) -> tuple[Array, Array]:
    """Return where the DLT and its refinement put the dots, (6, 7, 2) each, if one is pulled."""
    tiles, exact = rows_of_tiles()
    seen = exact.copy()
    seen[7 * row + column - 8] += du, dv
    H = dlt(tiles, seen)
    both = (apply(one, tiles) for one in (H, refine_homography(H, tiles, seen)))
    first, second = (net.reshape(6, 7, 2) for net in both)
    return first, second


def weights() -> Array:
    """Return the weight (6,) of each row's squared distances in the DLT, of row 1's: its w²."""
    depth = rows_of_tiles()[0][::7, 1]
    return np.asarray((depth / depth[0]) ** 2)


def _dots() -> Array:
    return rows_of_tiles()[1].reshape(6, 7, 2)


def _draw(paper: Paper, values: Values) -> Drawing:
    row, column = int(values["row"]), int(values["column"])
    dots = _dots()
    held = dots[:, column - 1].copy()
    held[row - 1] += values["du"], values["dv"]
    size = _NARROW if paper.narrow else _WIDE
    panel = paper.panel(size, *_SHOWN, f"how row 1 gives way, × {_TIMES}: blue DLT, orange refined")
    panel.image(_ground(size, paper.sharpness))
    for line in (*dots, *dots.transpose(1, 0, 2)):
        panel.line(line, MUTED, 0.6)
    panel.line([dots[row - 1, column - 1], held[row - 1]], IDEAL, 1, dash=3)
    grips = dict(enumerate(held, start=1))
    if np.linalg.norm(held[5] - held[4]) < 26 * panel.pixel:  # both would touch
        del grips[6 if row == 5 else 5]
    others = np.array([at for i, at in grips.items() if i != row])
    pulls = np.array([*grips.values()])
    sizes = (dots.reshape(-1, 2), 2.2, IDEAL), (pulls, 5, IDEAL), (others, 3, "white")
    for at, radius, ink in sizes:
        panel.polygons(at[:, None] + radius * panel.pixel * circle(17), ink)
    moved = [(net - dots)[0] for net in nets(row, column, values["du"], values["dv"])]
    for by, colour in sorted(zip(moved, _INKS, strict=True), key=lambda one: -abs(one[0]).max()):
        panel.arrows(dots[0], _TIMES * by, colour, 2.4)  # the longer first: none hides a shorter
    tips = dots[0] + _TIMES * moved[1]
    panel.polygons(tips[:, None] + 2.8 * panel.pixel * circle(17), ESTIMATED)  # short arrows, too
    rows = zip(held, dots[:, 0, 1], weights(), strict=True)
    for i, (at, v, weight) in enumerate(rows, start=1):
        if i in grips:
            panel.grip(f"row {i}", f"the dot of row {i}", at, 1)
        panel.text([_SHOWN[0][0] + 10 * panel.pixel, v], f"{i}", IDEAL, size=13)
        words = f"weight {weight:.3g}" if i == 6 else f"{weight:.2g}"
        panel.text([_SHOWN[0][1] - 10 * panel.pixel, v], words, LENS, anchor="rm", size=13)
    aside, anchor = (-16, "rm") if held[row - 1, 0] > _SHOWN[0][0] + 200 else (16, "lm")
    lift = 18 * panel.pixel if held[row - 1, 1] > _SHOWN[1][1] - 50 else 0  # above the border
    at = held[row - 1] + [aside * panel.pixel, -lift]
    panel.text(at, "pulled", IDEAL, anchor=anchor, size=12)
    far = np.linalg.norm(moved, axis=-1).max(axis=-1)
    return Drawing(paper.join((panel,)), _sentence(values, far.tolist()))


@lru_cache(maxsize=3)
def _ground(size: tuple[int, int], sharpness: int) -> Drawn:
    """Paint tiles of 100 mm × 150 mm, 300 mm below the camera, paler towards the horizon."""
    (alpha_u, _, u0), (_, alpha_v, v0), _ = floor_A()
    sides = zip(_SHOWN, size, strict=True)
    u, v = (np.linspace(*ends, 3 * sharpness * n, endpoint=False) for ends, n in sides)
    far = alpha_v * 300 / (v - v0).clip(1e-3)  # mm
    odd = (np.floor((u - u0) / alpha_u * far[:, None] / 100) + np.floor(far / 150)[:, None]) % 2
    grey = odd.reshape(len(v) // 3, 3, len(u) // 3, 3).mean(axis=(1, 3))
    fade = np.interp(v[1::3], [v0, v0 + 62], [0, 1])[:, None]
    part = (0.5 + fade * (grey - 0.5))[..., None]
    ground = np.where(v[1::3, None, None] < v0, 255, _TONES[0] + part * (_TONES[1] - _TONES[0]))
    return np.asarray(ground.round()).astype(np.uint8)


def _sentence(values: Values, moved: list[float]) -> str:
    far = np.hypot(values["du"], values["dv"])
    if far == 0:
        return "No dot is pulled: row 1 stays where it is."
    return f"""Dot of row {values["row"]:.0f} pulled by {far:.0f} px: row 1 moves by up to
    {moved[0]:.1f} px (DLT), {moved[1]:.1f} px (refined)."""
