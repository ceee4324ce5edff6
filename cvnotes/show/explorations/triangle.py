"""Explore the triangle: three vanishing points of a box, and the camera that they would mean."""

from functools import lru_cache

import numpy as np
from PIL import Image as Bitmap
from PIL import ImageDraw

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.pictures import blocks, render_scene
from cvnotes.projective import from_homogeneous, to_homogeneous
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values, placed
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, FAINT, IDEAL, MUTED

_SHOWN = ((-1120.0, 1220.0), (-520.0, 1668.0))  # px of the photograph, u and v
_SIZE, _SPACE = (450, 420), (400, 420)  # both panels have one scale
_SHEET = ((-1210.0, 1210.0), (-775.0, 1766.0))  # on which space is drawn
_EDGES = [1, 0, 3, 5]  # the box's nearest corner, and the next one along X, Y and Z
_MIDDLE = np.array([75.0, 0, 50])  # (u, v, w) about which the view of space turns
_ABOVE = np.radians(15)  # from where it is seen
_RING, _LOW = 560.0, 1440.0  # px: radius of the ring by which it is turned, and its v
_BEHIND = 1.25  # times as far from the eye as the glass: where the box stands
_ASIDE = 55  # degrees: from there on the triangle of H, eye and Y is drawn
_CLEAR = 128  # of 255: how much of its ink the glass lays over what is behind it
_AROUND = (0, 45, -45, 90, -90, 135, -135, 180)  # degrees: where a letter may stand
_PANE, _CORE, _FACES = "#D5EAF7", "#FFFFFF", ("#E6DCD6", "#F4EFEB", "#D8CBC3")


def triangle_model() -> Model:
    """Make the model of the chapter's box, photographed with square pixels."""
    pose = look_at([1200, -8000, 2000], [700, -1000, 12800])
    camera = Camera(intrinsics(800, 800, 325, 238), pose, size=(640, 480))
    W = blocks().vertices[_EDGES]
    nearest, *ends = camera.project(W)
    start = camera.vanishing_point(W[1:] - W[0]).round()
    # How far along each edge its end is seen, of the way to the vanishing point.
    part = np.linalg.norm(ends - nearest, axis=1) / np.linalg.norm(start - nearest, axis=1)
    settings = (
        *(Setting(f"{name}_{axis}", f"{name}: {axis} (px)", low + 70, high - 70, 1, float(at),
                  f"where the edges along {name} vanish")
          for name, point in zip("XYZ", start, strict=True)
          for axis, at, (low, high) in zip("uv", point, _SHOWN, strict=True)),
        Setting("turn", "turn (°)", -90, 90, 1, 60,
                "from where space is seen: 0 from before the glass, 90 from its side"),
    )  # fmt: skip
    about = """The photograph of a box, and far around it the triangle of three vanishing points
    with its altitudes; beside it the photograph in space as a pane of glass, and before it the eye,
    from which three rods at right angles go to the three points."""

    @lru_cache(maxsize=1)
    def photo() -> Bitmap.Image:
        """Return the photograph, pale for the lines that are drawn over it."""
        pale = 0.6 * render_scene(blocks(), camera, samples=4) + 102
        return Bitmap.fromarray(pale.astype(np.uint8))

    @lru_cache(maxsize=2)
    def sheet(sharpness: int) -> Drawn:
        """Put the photograph on white paper, once for all values."""
        paper = Bitmap.new("RGB", (sharpness * _SIZE[0], sharpness * _SIZE[1]), "white")
        scale = paper.width / np.ptp(_SHOWN[0])
        corner = (round(-scale * _SHOWN[0][0]), round(-scale * _SHOWN[1][0]))
        paper.paste(photo().resize((round(scale * 640), round(scale * 480))), corner)
        return np.asarray(paper)

    def draw(paper: Paper, values: Values) -> Drawing:
        v = np.array([[values[f"{name}_u"], values[f"{name}_v"]] for name in "XYZ"])
        sky = paper.panel(_SIZE, *_SHOWN, "the photograph, and where the edges of its box lead")
        space = paper.panel(_SPACE, *_SHEET, "in space: pull the plus to turn it")
        sky.image(sheet(paper.sharpness))
        c, square = camera_of(v)
        eye, turn = np.array([*c, np.sqrt(max(square, 0))]), values["turn"]
        _draw_box(sky, v, c, square, nearest, nearest + part[:, None] * (v - nearest))
        corner = eye + _BEHIND * (in_space(nearest) - eye)
        edges = _BEHIND * (part / (1 - part))[:, None] * (in_space(v) - eye)
        box = _seen(corner, edges, turn) if square > 0 else np.empty((0, 4, 2))
        _draw_glass(space, turn, v, photo(), box)
        _draw_rods(space, turn, v, eye, square, box)
        return Drawing(paper.join((sky, space)), _sentence(v, c, square))

    drags = {name: placed(f"{name}_u", f"{name}_v") for name in "XYZ"}
    drags["turn"] = lambda _, at: {"turn": np.degrees(np.arcsin(np.clip(-at[0] / _RING, -1, 1)))}
    return Model("triangle", about, settings, draw, drags)


def camera_of(v: Array) -> tuple[Array, float]:
    """Return the orthocentre c (2,) of vanishing points (3, 2), and f²; NaN where they line up."""
    X, Y, Z = v
    sides = np.array([Y - Z, Z - X])
    if abs(np.linalg.det(sides)) < 0.5:  # twice the area, in px²
        return np.full(2, np.nan), np.nan
    c = np.linalg.solve(sides, [(Y - Z) @ X, (Z - X) @ Y])
    return c, float(-(X - c) @ (Y - c))


def _feet(v: Array) -> Array:
    """Return the feet (3, 2) of the altitudes of a triangle (3, 2)."""
    a, way = np.roll(v, 1, axis=0), np.roll(v, -1, axis=0) - np.roll(v, 1, axis=0)
    part = ((v - a) * way).sum(axis=1) / (way * way).sum(axis=1)
    return np.asarray(a + part[:, None] * way)


def _square_at(H: Array, v: Array) -> Array:
    """Return the mark (3, 2) of the right angle at H, between the altitude to Y and the side."""
    X, Y, Z = v
    ways = np.array([Y - H, (Z if np.dot(Z - H, Z - H) > np.dot(X - H, X - H) else X) - H])
    long = np.linalg.norm(ways, axis=1, keepdims=True)
    a, b = ways / long * min(90, 0.3 * long.min())
    return np.asarray(H + np.array([a, a + b, b]))


def _draw_box(panel: Panel, v: Array, c: Array, square: float, nearest: Array, ends: Array) -> None:
    """Draw the box that would have these vanishing points, its edges extended, and the triangle.

    Where no camera sees a box so, its edges are grey and dashed.
    """
    look = (ESTIMATED, 0) if square > 0 else (MUTED, 4)
    sides = np.stack([v, np.roll(v, 1, axis=0)], axis=1)
    lines, names = [*sides], [(name, at, ESTIMATED) for name, at in zip("XYZ", v, strict=True)]
    if np.isfinite(square):
        for corner, foot in zip(v, _feet(v), strict=True):
            # The whole altitude, of which c may lie outside.
            along = np.array([corner, foot, c])
            along = along[np.argsort(along @ (foot - corner))][[0, -1]]
            panel.line(along, IDEAL, 0.9, dash=5)
            lines += [along]
        H = _feet(v)[1]
        panel.line(_square_at(H, v), IDEAL, 1.2)
        names += [("c", c, ESTIMATED), ("H", H, MUTED)]
    e, n = to_homogeneous(ends), to_homogeneous(v)
    # Between the ends of two edges lies the corner in which the edges parallel to them meet.
    along = np.cross(e, np.roll(n, -1, axis=0)), np.cross(np.roll(e, -1, axis=0), n)
    far = from_homogeneous(np.cross(*along))
    for k, name in enumerate("XYZ"):
        for begin, end in ((nearest, ends[k]), (ends[k - 2], far[k]), (ends[k - 1], far[k - 1])):
            panel.line([begin, end], look[0], 1.5, look[1])
            panel.line([begin, v[k]], ESTIMATED, 0.6, dash=3)
        panel.grip(name, f"the vanishing point {name}", v[k], 2)
    panel.segments(sides, ESTIMATED, 1.8)
    panel.mark([*v, c], "estimated", 7)
    _letters(panel, names, lines)


def in_space(uv: Array, w: Array | float = 0) -> Array:
    """Return places (..., 3): over pixels (..., 2), w px before the glass."""
    return np.concatenate([uv, np.broadcast_to(w, uv.shape[:-1])[..., None]], axis=-1)


def on_sheet(place: Array, turn: float) -> Array:
    """Project places (..., 3) in parallel onto the sheet (..., 2)."""
    t = np.radians(turn)
    aside = [np.cos(t), 0, -np.sin(t)]
    down = [np.sin(t) * np.sin(_ABOVE), np.cos(_ABOVE), np.cos(t) * np.sin(_ABOVE)]
    return np.asarray((place - _MIDDLE) @ np.transpose([aside, down]))


def _seen(corner: Array, edges: Array, turn: float) -> Array:
    """Return the three faces (3, 4, 2) of a box that are seen on the sheet, of its edges (3, 3)."""
    t = np.radians(turn)
    towards = [np.sin(t) * np.cos(_ABOVE), -np.sin(_ABOVE), np.cos(t) * np.cos(_ABOVE)]
    a, b = np.roll(edges, 1, axis=0), np.roll(edges, 2, axis=0)
    begin = corner + np.where((edges @ towards > 0)[:, None], edges, 0)
    return on_sheet(begin[:, None] + np.stack([0 * a, a, a + b, b], axis=1), turn)


def _draw_glass(panel: Panel, turn: float, v: Array, photo: Bitmap.Image, box: Array) -> None:
    """Draw the box (3, 4, 2), and before it the glass with the photograph on it."""
    whole = Bitmap.new("RGB", (panel.width, panel.height), "white")
    pen = ImageDraw.Draw(whole)
    held = np.concatenate([v, [[0, 0], photo.size]])
    (u0, v0), (u1, v1) = held.min(0) - 70, held.max(0) + 70
    pane = on_sheet(in_space(np.array([[u0, v0], [u1, v0], [u1, v1], [u0, v1]])), turn)
    for face, fill in zip(box, _FACES, strict=False):
        pen.polygon(panel.place(face).ravel().tolist(), fill, ESTIMATED, panel.scale)
    glass = Bitmap.new("L", whole.size)
    ImageDraw.Draw(glass).polygon(panel.place(pane).ravel().tolist(), _CLEAR)
    whole.paste(_PANE, mask=glass)
    pen.polygon(panel.place(pane).ravel().tolist(), None, FAINT, panel.scale)
    corners = np.array([[0, 0], [1, 0], [0, 1]]) - 0.5 / np.array(photo.size)
    o, *ways = panel.place(on_sheet(in_space(corners * photo.size), turn))
    M = (np.array(ways) - o).T / photo.size
    if abs(np.linalg.det(M)) > 1e-3:  # not seen from its side
        back = np.linalg.inv(M)
        rows = np.column_stack([back, -back @ o]).ravel().tolist()
        how = (whole.size, Bitmap.Transform.AFFINE, rows, Bitmap.Resampling.BILINEAR)
        mask = Bitmap.new("L", photo.size, 255).transform(*how)
        whole.paste(photo.transform(*how), mask=mask)
    panel.image(np.asarray(whole))
    ring = np.radians(np.arange(0, 361.0, 5))
    sides = _MIDDLE[[0, 2]] + _RING * np.column_stack([np.sin(ring), np.cos(ring)])
    panel.line(on_sheet(np.insert(sides, 1, _LOW, axis=1), 0), FAINT, 1.2)
    t = np.radians(turn)
    at = on_sheet(_MIDDLE * [1, 0, 1] + [-_RING * np.sin(t), _LOW, _RING * np.cos(t)], 0)
    panel.grip("turn", "the ring that turns the view", at, 4, "ideal", 8)


def _draw_rods(panel: Panel, turn: float, v: Array, eye: Array, square: float, box: Array) -> None:
    """Draw the triangle on the glass, the eye before it, and the rods from there to its corners.

    From aside, grey is the half circle over the altitude from Y to H; on it the eye is, if any.
    Letters stay away from the box (3, 4, 2).
    """
    m, c, top = (on_sheet(place, turn) for place in (in_space(v), eye * [1, 1, 0], eye))
    names = [(name, at, ESTIMATED) for name, at in zip("XYZ", m, strict=True)]
    sides, rods = np.stack([m, np.roll(m, 1, axis=0)], axis=1), np.stack([m, 0 * m + top], axis=1)
    lines = [*sides, *rods] if square > 0 else [*sides]
    ends = (0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3)
    lines += [face[[*pair]] for face in box for pair in ends]
    panel.segments(sides, ESTIMATED, 1.5)
    from_aside = abs(turn) > _ASIDE  # from where the half circle is seen well
    if np.isfinite(square) and from_aside:
        phi, foot = np.radians(np.arange(0, 181.0, 3)), _feet(v)[1]
        half = (v[1] - foot) / 2
        along = foot + half + np.cos(phi)[:, None] * half
        arc = on_sheet(in_space(along, np.linalg.norm(half) * np.sin(phi)), turn)
        panel.line(arc, MUTED, 0.9)
        panel.line(arc[[0, -1]], MUTED, 0.9, dash=4)
        lines += [arc[[0, -1]], *np.stack([arc[:-1], arc[1:]], axis=1)]
        H = on_sheet(in_space(foot), turn)
        panel.line(on_sheet(in_space(_square_at(foot, v)), turn), IDEAL, 1.2)
        names += [("H", H, MUTED)]
    if square > 0:
        if from_aside:
            panel.line([top, H], MUTED, 1.2)  # at right angles to the rod to Y
            lines += [np.array([top, H])]
        panel.line([top, c], IDEAL, 1.6)
        lines += [np.array([top, c])]
        names += [("eye", top, CAMERA)]
        if (long := np.linalg.norm(c - top)) > 220:
            names += [("c", c, ESTIMATED)]
        if long > 450:
            names += [("f", 0.6 * c + 0.4 * top, IDEAL)]
        ways = in_space(v) - eye
        lengths = np.linalg.norm(ways, axis=1, keepdims=True)
        short = ways / lengths * min(150, 0.5 * lengths.min())
        for a, b in zip(short, np.roll(short, 1, axis=0), strict=True):
            panel.line(on_sheet(eye + np.array([a, a + b, b]), turn), IDEAL, 1.2)
        panel.segments(rods, CAMERA, 5)
        panel.segments(rods, _CORE, 1.3)
    elif np.isfinite(square):
        names += [("c", c, ESTIMATED)]
    panel.mark([*m, c], "estimated", 6)
    if square > 0:
        panel.mark(top, "camera", 9, looks=tuple(c - top))
    _letters(panel, names, lines)
    if not square > 0:
        low, high = np.subtract(_SHEET[1][1], [150, 20])
        panel.polygons([[[-500, low], [500, low], [500, high], [-500, high]]], "white")
        said = "no camera" if np.isfinite(square) else "no triangle, no camera"
        panel.text([0, (low + high) / 2], said, "#333333", anchor="mm", size=16)


def _letters(panel: Panel, names: list[tuple[str, Array, str]], lines: list[Array]) -> None:
    """Write names beside their points, where lines (2, 2) and other names leave room."""
    middle, ends = np.mean([at for _, at, _ in names[:3]], axis=0), np.array([panel.x, panel.y])
    inside = [one for one in names if (ends[:, 0] < one[1]).all() and (one[1] < ends[:, 1]).all()]
    for name, at, ink in inside:
        away, wide = np.arctan2(*(at - middle)[::-1]) + np.radians(_AROUND), 36 * len(name)
        around = 1.4 * np.column_stack([np.cos(away), np.sin(away)])
        places = (at + around.clip(-1, 1) * [60 + wide, 116]).clip(ends[:, 0] + 60, ends[:, 1] - 60)
        a, way = np.array(lines)[:, 0], np.diff(lines, axis=1)[:, 0]
        by = places[:, None] - a
        part = ((by * way).sum(-1) / np.maximum((way * way).sum(-1), 1)).clip(0, 1)
        room = np.linalg.norm(by - part[..., None] * way, axis=-1).min(axis=1)
        place = places[room.clip(None, 65).argmax()]
        panel.text(place, name, ink, anchor="mm", size=14)
        lines += [place + np.array([[-wide, 0], [wide, 0]])]


def _sentence(v: Array, c: Array, square: float) -> str:
    if np.isnan(square):
        return "There is no triangle: the three points lie on one line. So there is no camera."
    ways = np.roll(v, -1, axis=0) - v  # from each corner to the next
    ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    angles = np.degrees(np.arccos(-(ways * np.roll(ways, 1, axis=0)).sum(axis=1)))
    said = f"The widest angle, at {'XYZ'[angles.argmax()]}, is {angles.max():.1f}°"
    if square > 0:
        said += f"; the altitudes meet in c = ({c[0]:.0f}, {c[1]:.0f}) px"
        return f"{said}, and f = {np.sqrt(square):.0f} px."
    if square == 0:
        return f"{said}: c has come to this corner, and f = 0."
    return f"{said}: c is outside, and f² = {square:,.0f} px² is negative. No camera sees a box so."
