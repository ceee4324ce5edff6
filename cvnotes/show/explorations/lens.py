"""Explore the lens: what k1 and k2 do to a room, and where the model folds."""

from functools import cache, lru_cache, partial

import numpy as np
from PIL import Image

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.camera.lens import radial_factor
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, Range, circle
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, MUTED
from cvnotes.targets import Chessboard
from cvnotes.warping import backward_warp

_EXTENT = 0.6  # of what is to be seen on the plane z = 1, in x and y
_EDGE = np.array([[x, 1600, 3500] for x in np.linspace(-2500, 2500, 51)])  # of the tiles, mm
_END = _EDGE[-1, :2] / 3500  # where it is taken hold of, as an ideal lens shows it
_ARROWS = np.array([[0.8, 0], [0.65, 0.26], [0.65, -0.26], [0.72, -0.52], [0.4, -0.5], [0.4, 0.56]])
_ARROWS = np.concatenate([_ARROWS, _ARROWS * [-1, 1], [[-0.714, 0.457], [0, 0.7], [0, -0.7]]])
_GUESSED = _ARROWS[0]  # how far it is moved is what the chapter lets one guess
_HELD = float(np.linalg.norm(_END))  # the same point, where the curve is taken hold of
_RADIUS = 1.3  # of the curve r L(r)
_SIZE = (430, 360)
_DETAIL = 450  # px of the photograph of the room for a length of 1 on the plane z = 1
_COARSE = 4  # px between which the way back through the lens, which takes long, is linear


def lens_model(camera: Camera, _: Chessboard) -> Model:
    """Make the model; it starts with the lens of `camera`, whose frame is drawn into the grid.

    Of the lens its first two radial coefficients are taken.
    """
    k1, k2 = (*camera.lens.k, 0.0, 0.0)[:2]
    what = "radial: bends the borders inwards (negative) or outwards"
    settings = (
        _around("k1", 1.5, 0.01, k1, what),
        _around("k2", 2.0, 0.01, k2, "radial, of the fourth power of r"),
    )
    about = """A room seen through a lens, with arrows from where an ideal lens shows its points,
    and an edge of its tiles beside a ruler; beside it the observed radius r L(r) against the ideal
    radius r, with the same arrows and the edge's end, and the fold where the model ends."""

    def pulled(values: Values, at: Array) -> Values:
        """Choose the k1 whose curve has a height over the ideal radius of the edge's end."""
        r2 = _HELD**2
        return {"k1": float((at[1] / _HELD - 1 - values["k2"] * r2**2) / r2)}

    def along_the_ray(values: Values, at: Array) -> Values:
        """Choose the k1 that shows the end of the edge where the hand is, along its ray."""
        r2 = float(_END @ _END)
        return {"k1": (float(at @ _END) / r2 - 1 - values["k2"] * r2**2) / r2}

    drags = {"curve": pulled, "edge": along_the_ray}
    return Model("lens", about, settings, partial(_draw, camera), drags)


def _around(name: str, reach: float, step: float, value: float, about: str) -> Setting:
    """Make a setting from −reach to reach, or as far as a camera's own value asks for."""
    reach = max(reach, abs(value))
    label = name.translate(str.maketrans("12", "₁₂"))
    return Setting(name, label, -reach, reach, step, value, about)


def _draw(camera: Camera, paper: Paper, values: Values) -> Drawing:
    lens = Lens((values["k1"], values["k2"]))
    reach = 1.4 * _EXTENT
    x = reach * _SIZE[0] / _SIZE[1]
    title = "a room through the lens: pull the edge's end"
    grid = paper.panel(_SIZE, (-x, x), (-reach, reach), title)
    grid.image(bent_room(lens, grid.x, grid.y, _SIZE, paper.sharpness, 1))
    _draw_edge(grid, lens)
    draw_fold(grid, lens)
    title = "observed over ideal radius, in focal lengths"
    curve = paper.panel(_SIZE, (0, _RADIUS), (1.2, -0.2), title)
    corners = camera_corners(camera)[[0, 1, 2, 3, 0]]
    grid.line(corners, CAMERA, 2, rim=1.5)
    grid.text(corners[3] + [7 * grid.pixel, -6 * grid.pixel], "picture", CAMERA, anchor="ld")
    moved = _draw_arrows(grid, lens)
    grid.text(_GUESSED + [7 * grid.pixel, 0], "?", IDEAL, anchor="lm", size=18)
    end = polynomial(lens, _END)
    grid.grip("edge", "the end of the edge of the tiles", end, 2, "lens", 8)
    _draw_curve(curve, lens, moved)
    return Drawing(paper.join((grid, curve)), _sentence(camera, lens))


@cache
def _room() -> Drawn:
    """Photograph the room of the course once, through an ideal lens, wider than is shown."""
    from cvnotes.pictures import render_scene, room

    w, h = 3 * _DETAIL, 5 * _DETAIL // 2
    camera = Camera(intrinsics(_DETAIL, _DETAIL, (w - 1) / 2, (h - 1) / 2), size=(w, h))
    picture: Drawn = render_scene(room(), camera, samples=4)
    return picture


@lru_cache(maxsize=4)  # it stays while something else is pulled
def bent_room(
    lens: Lens, x: Range, y: Range, panel: tuple[int, int], sharpness: int, part: float = 0.75
) -> Drawn:
    """Show the room through a lens, from x to x and from y to y of the plane z = 1.

    It is light, so that a grid can lie over it: only a `part` of its ink is left. A little beyond
    the fold it goes on: that is for `draw_fold` to cover.
    """
    room = _room()
    h, w = room.shape[:2]
    size = sharpness * panel[0], sharpness * panel[1]
    cells = zip((x, y), np.array(panel) // _COARSE, strict=True)
    columns, rows = (low + (high - low) * (np.arange(n) + 0.5) / n for (low, high), n in cells)
    ideal = _continued(lens.undistort(np.stack(np.meshgrid(columns, rows), axis=-1)))
    sides = (_DETAIL * ideal + np.array([w - 1, h - 1]) / 2).astype(np.float32)
    m = [
        np.asarray(Image.fromarray(side).resize(size, Image.Resampling.BILINEAR))
        for side in np.moveaxis(sides, -1, 0)
    ]
    seen = backward_warp(room, np.stack(m, axis=-1), fill=255)
    return np.asarray(255 - part * (255.0 - seen)).astype(np.uint8)


def _continued(x: Array) -> Array:
    """Carry values (h, w, 2) on by two cells into NaN, so that no line between two lacks an end."""
    for _ in range(2):
        framed = np.pad(x, ((1, 1), (1, 1), (0, 0)), constant_values=np.nan)
        rows, columns = framed[:, 1:-1], framed[1:-1]
        around = np.stack([rows[:-2], rows[2:], columns[:, :-2], columns[:, 2:]])
        known = np.isfinite(around)
        mean = np.where(known, around, 0).sum(axis=0) / known.sum(axis=0).clip(1)
        x = np.where(np.isnan(x) & known.any(axis=0), mean, x)
    return x


def draw_fold(panel: Panel, lens: Lens) -> None:
    """Cover what lies beyond the fold, where the lens shows nothing, up to a smooth border."""
    fold = polynomial(lens, min(lens.max_radius, 9.0) * circle(181))
    if lens.max_radius < 9:
        far = 9 * np.array([[1, 0], [1, 1], [-1, 1], [-1, -1], [1, -1], [1, 0]])
        panel.polygons([np.concatenate([fold, far[::-1]])], "#FFFFFF")
        panel.line(fold, ESTIMATED, 1.8)
    if lens.max_radius < 2 * _EXTENT:
        top = fold[:, 1].min()
        over = top > panel.y[0] + 22 * panel.pixel  # else there is room within the circle alone
        y = top - 0.02 if over else max(top, panel.y[0]) + 0.02
        panel.text([0, y], "the fold", ESTIMATED, anchor="md" if over else "ma")


def _draw_edge(panel: Panel, lens: Lens) -> None:
    """Draw an edge of the tiles as the lens shows it, and a ruler from end to end."""
    edge = lens.distort(_EDGE[:, :2] / _EDGE[:, 2:])  # NaN beyond the fold
    shown = edge[np.isfinite(edge[:, 0])]
    if len(shown):
        panel.line(shown[[0, -1]], IDEAL, 1.5)
    panel.line(edge, LENS, 3)
    middle, ruled = edge[25], edge[[0, -1]].mean(axis=0)
    side = 1 if middle[1] >= ruled[1] else -1  # in a barrel the edge is below
    for at, words, ink, way in ((middle, "edge", LENS, side), (ruled, "ruler", IDEAL, -side)):
        beside = at + [0, 7 * way * panel.pixel]
        panel.text(beside, words, ink, anchor="ma" if way > 0 else "md", size=13)


def _draw_arrows(panel: Panel, lens: Lens) -> Array:
    """Draw arrows from ideal points to where the lens shows them; returns the points (n, 2)."""
    xy = np.array([*_ARROWS, _END])
    xy = xy[np.linalg.norm(xy, axis=1) < lens.max_radius]
    if len(xy):
        panel.arrows(xy, lens.distort(xy) - xy, IDEAL, 1.2)
    panel.mark([0, 0], "ideal")
    return np.asarray(xy)


def _draw_curve(panel: Panel, lens: Lens, moved: Array) -> None:
    panel.ticks((0.4, 0.8, 1.2), (0.4, 0.8), size=11)
    panel.line([[0.0, 0.0], [_RADIUS, 0.0]], MUTED, 0.8)
    panel.line([[0.0, 0.0], [1.2, 1.2]], IDEAL, 1, dash=4)
    panel.text([0.99, 0.95], "ideal", IDEAL)
    fold = min(lens.max_radius, _RADIUS)
    good, beyond = np.linspace(0, fold, 61), np.linspace(fold, _RADIUS, 61)
    panel.line(np.stack([beyond, seen_radius(lens, beyond)], -1), ESTIMATED, 1.8, dash=5)
    panel.line(np.stack([good, seen_radius(lens, good)], -1), LENS, 2.2)
    for r in np.unique(np.linalg.norm(moved, axis=1).round(9)):
        panel.arrows([r, r], [0, float(seen_radius(lens, r)) - r], IDEAL, 1.2)
    panel.text([_GUESSED[0] - 7 * panel.pixel, 0.72], "?", IDEAL, anchor="rm", size=18)
    held = [_HELD, float(seen_radius(lens, np.array(_HELD)))]
    panel.mark(held, "lens", 8)
    side = 1 if held[1] <= _HELD else -1  # of the curve, away from the dashed line
    beside = np.array(held) + 12 * side * panel.pixel * np.array([1, -1])
    panel.text(beside, "the edge's end", LENS, anchor="la" if side > 0 else "rd", size=13)
    panel.grip("curve", "the end of the edge, on the curve", held, 2)
    if lens.max_radius < _RADIUS:
        panel.line([[lens.max_radius, 1.2], [lens.max_radius, -0.2]], ESTIMATED, 1)
        near = lens.max_radius < 0.6  # then there is room above the curves, else below
        shift, height, anchor = (0.015, 1.12, "lm") if near else (-0.015, 0.06, "rm")
        words = f"the fold, r = {lens.max_radius:.3f}"
        panel.text([lens.max_radius + shift, height], words, ESTIMATED, anchor=anchor)


def _sentence(camera: Camera, lens: Lens) -> str:
    corners = camera_corners(camera)
    r = float(np.linalg.norm(corners, axis=-1).max())
    ideal = lens.undistort(corners)
    if np.isnan(ideal).any():
        seen = seen_radius(lens, np.array(lens.max_radius))
        black = np.isnan(ideal).any(axis=-1).sum()
        return f"""The model folds at r = {lens.max_radius:.3f}, which is seen at r' = {seen:.3f}.
        The picture's corners are at r' up to {r:.3f}: in {black} of them nothing is seen. Orange is
        no lens."""
    fold = f"The model folds at r = {lens.max_radius:.3f}, beyond the picture. "
    ends = "" if np.isinf(lens.max_radius) else fold
    away = np.linalg.norm(camera.A[:2, :2] @ (ideal - corners).T, axis=0)
    far, farthest = away.max(), away.argmax()
    side = "out" if np.linalg.norm(ideal[farthest]) >= np.linalg.norm(corners[farthest]) else "in"
    return f"""{ends}{_of_the_end(camera, lens)}What is seen in the picture's corners comes from up
    to {far:.1f} px farther {side}."""


def _of_the_end(camera: Camera, lens: Lens) -> str:
    """Tell how far the end of the edge is moved, if the lens shows it."""
    px = camera.A[:2, :2]
    ideal, seen = (float(np.linalg.norm(px @ xy)) for xy in (_END, lens.distort(_END)))
    if np.isnan(seen):
        return ""
    moved = f"{abs(seen - ideal):.1f} px {'nearer' if seen < ideal else 'farther out'}"
    where = moved if abs(seen - ideal) >= 0.05 else "there too"
    return f"An ideal lens shows the edge's end {ideal:.0f} px from the centre, this one {where}. "


def camera_corners(camera: Camera) -> Array:
    """Return the corners (4, 2) of a camera's picture on the plane z = 1, through an ideal lens."""
    w, h = camera.size
    corners = [[-0.5, -0.5], [w - 0.5, -0.5], [w - 0.5, h - 0.5], [-0.5, h - 0.5]]
    return Camera(camera.A, size=camera.size).ideal(corners)


def seen_radius(lens: Lens, r: Array) -> Array:
    """Return the observed radius r L(r), beyond the fold too, to show how the model folds."""
    return np.asarray(r * radial_factor(lens.k, r * r))


def polynomial(lens: Lens, xy: Array) -> Array:
    """Move points (..., 2) by the factor L(r), beyond the fold too."""
    return np.asarray(xy * radial_factor(lens.k, (xy * xy).sum(axis=-1, keepdims=True)))
