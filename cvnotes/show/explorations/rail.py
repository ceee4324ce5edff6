"""Explore the end of a rail: a point is pulled along it, its line of sight through the picture."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, look_at, pose
from cvnotes.pictures import course, rails, render_scene
from cvnotes.projective import from_homogeneous, to_homogeneous
from cvnotes.show.explorations.lens import camera_corners
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, LENS, WORLD
from cvnotes.warping import backward_warp, homography_map

_CAMERA = Camera(course.camera().A)
_GAUGE, _DOWN, _HALFWAY, _GLASS = 1.5, 1.6, 20.0, 3.0  # m; the last is where the picture stands
_SPACE, _BESIDE, _FINER = (590, 400), (270, 400), 2
_SHOWN = (190, 460), (80, 480)  # px of the picture that are shown beside
_SHEET = "#8CEBCB"


def _aside() -> Camera:
    """Return a camera behind the first one and to its right, in pixels of the panel."""
    A = np.array([[740, 0, 284.5], [0, 740, 199.5], [0, 0, 1]])
    return Camera(A, look_at([3.6, -1.7, -4.6], [0.7, 0.4, 4]), size=_SPACE)


_ASIDE = _aside()


def rail_model() -> Model:
    """Make the model of a point of a rail, and of its line of sight through the picture."""
    settings = (Setting("part", "how far", 0.25, 1, 0.005, 0.4, "1 is infinity, 0.5 is 20 m"),)
    about = """A railway from outside, with the camera that sees it and its picture on a glass.
    Through each rail and the camera goes a green sheet; in it an orange line of sight leads to a
    point of the rail. Beside it the picture, with both pixels and the gap between them."""
    return Model("rail", about, settings, _draw, {"rail": _pulled})


def on_rail(part: float, side: float = 1) -> Array:
    """Return a point of the right (1) or left (−1) rail as [x y z w]: no number becomes large."""
    near = (1 - part) * np.array([side * _GAUGE / 2, _DOWN, 0, 1])
    return near + [0, 0, _HALFWAY * part, 0]


def _seen(camera: Camera, place: Array) -> Array:
    """Return the pixel of a place [x y z w], also where w is 0."""
    return from_homogeneous(camera.P @ place)


def _pulled(_: Values, at: Array) -> Values:
    """Go along the rail to where it has the hand's u."""
    start, way = on_rail(0), on_rail(1) - on_rail(0)
    u = np.clip(at[0], _seen(_ASIDE, on_rail(0.1))[0], _seen(_ASIDE, on_rail(1))[0])
    row = _ASIDE.P[0] - u * _ASIDE.P[2]
    return {"part": float(-(row @ start) / (row @ way))}


def _draw(paper: Paper, values: Values) -> Drawing:
    part = values["part"]
    space = paper.picture_panel(_SPACE, (590, 400), "from outside: pull the point along its rail")
    space.image(_scene())
    for side, width in ((-1, 1.2), (1, 2.4)):
        place = on_rail(part, side)
        x, y, z, _ = place
        glass, end = _ASIDE.project(_GLASS / z * np.array([x, y, z])), _seen(_ASIDE, place)
        edge = beyond(_ASIDE.project(_corners()), glass, end)
        if edge is not None:  # else the picture hides it
            space.line([edge, end], ESTIMATED, width)
            space.mark(end, "world", 9 if side == 1 else 6)
        space.line([_ASIDE.project([0.0, 0, 0]), glass], ESTIMATED, width)
        space.mark(glass, "ideal", 8 if side == 1 else 6)
    space.grip("rail", "the point of the right rail", end, 4)
    return Drawing(paper.join((space, _picture(paper, part))), _sentence(part))


def beyond(outline: Array, start: Array, end: Array) -> Array | None:
    """Return where the way from within an outline (n, 2) to a place beyond leaves it."""
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        share, along = np.linalg.solve(np.column_stack([end - start, a - b]), a - start)
        if 0 < share <= 1 and 0 <= along <= 1:
            return np.asarray(start + share * (end - start))
    return None


def _corners() -> Array:
    """Return the corners of the picture on its glass, in m."""
    return _GLASS * to_homogeneous(camera_corners(_CAMERA))


def _finer(camera: Camera) -> Camera:
    return camera.resized((_FINER * camera.size[0], _FINER * camera.size[1]))


@lru_cache(maxsize=1)
def _photograph() -> Drawn:
    """Photograph the railway as the camera sees it, in finer pixels."""
    return render_scene(rails(), _finer(_CAMERA), samples=4)


@lru_cache(maxsize=1)
def _scene() -> Drawn:
    """Photograph the railway from outside, and lay the sheets and the picture into it."""
    aside = _finer(_ASIDE)
    eye = Camera(aside.A, pose(aside.R, 1e3 * aside.T), size=aside.size)  # the railway is in mm
    panel = Paper(_FINER).picture_panel(_SPACE, (590, 400))
    panel.image(render_scene(rails(), eye, samples=4))
    _lay_sheets(panel, [_GLASS, 1e5])
    H = aside.P @ np.vstack([_GLASS * np.linalg.inv(_finer(_CAMERA).A), [0, 0, 1]])
    panel.image(laid(panel.drawn(), _photograph(), H))
    corners, centre = _ASIDE.project(_corners()), _ASIDE.project([0.0, 0, 0])
    panel.line([*corners, corners[0]], CAMERA, 1.2)
    panel.segments([[centre, corner] for corner in corners], CAMERA, 1)
    _lay_sheets(panel, [0, _GLASS])
    for words, place in (("camera", centre + [-14, 16]), ("its picture", corners[0] + [2, -12])):
        panel.text(place, words, IDEAL, anchor="lm", size=14)
    return panel.drawn()


def laid(page: Drawn, photo: Drawn, H: Array) -> Drawn:
    """Lay a photograph over a page: H (3, 3) leads from its pixels to those of the page."""
    glass = np.dstack([photo, np.full_like(photo[..., :1], 255)])
    size = page.shape[1::-1]
    over = backward_warp(glass, homography_map(np.linalg.inv(H)), size=size).astype(float)
    both = (1 - over[..., 3:] / 255) * page + over[..., :3]
    return np.asarray(both.round().clip(0, 255).astype(np.uint8))


def _lay_sheets(panel: Panel, ends: list[float]) -> None:
    """Lay both sheets of lines of sight over what is drawn, half transparent."""
    before = panel.drawn().astype(float)
    for x in (-_GAUGE / 2, _GAUGE / 2):
        a, b = ends
        sheet = [[0, 0, a], [0, 0, b], [x, _DOWN, b], [x, _DOWN, a]]
        panel.polygons([_ASIDE.project(sheet)], _SHEET)
    panel.image(((before + panel.drawn()) / 2).round().astype(np.uint8))
    for x in (-_GAUGE / 2, _GAUGE / 2):
        panel.line(_ASIDE.project([[x, _DOWN, z] for z in ends]), WORLD, 1)


def _picture(paper: Paper, part: float) -> Panel:
    """Show the middle of the picture, with both pixels and the gap between them."""
    (left, right), (top, bottom) = _SHOWN
    shown = right - left, bottom - top
    panel = paper.picture_panel(_BESIDE, shown, "in the picture", (left, top))
    panel.image(_photograph()[_FINER * top : _FINER * bottom, _FINER * left : _FINER * right])
    ends = [_seen(_CAMERA, on_rail(part, side)) for side in (-1, 1)]
    panel.line(ends, LENS, 2)
    panel.mark(ends, "ideal", 9)
    gap = f"gap {_number(ends[1][0] - ends[0][0])} px"
    low = ends[1][1] + (20 if ends[1][1] < 425 else -42)  # within the panel
    panel.text([325, low], gap, LENS, anchor="mm", size=15)
    panel.text([325, low + 22], f"row {ends[1][1]:.1f}", IDEAL, anchor="mm", size=15)
    return panel


def _number(x: float) -> str:
    return f"{x:.0f}" if x >= 10 else f"{x:.2g}"


def _sentence(part: float) -> str:
    u, v = _seen(_CAMERA, on_rail(part))
    if part == 1:
        return f"""The point is at infinity. Its line of sight is parallel to the rails, and its
        pixel is ({u:.1f}, {v:.1f}), for both rails."""
    away = _HALFWAY * part / (1 - part)
    angle = np.degrees(np.arctan2(np.hypot(_GAUGE / 2, _DOWN), away))
    return f"""The point is {away:.0f} m ahead. Its line of sight meets the rail at {angle:.2g}°,
    and its pixel is ({u:.1f}, {v:.1f})."""
