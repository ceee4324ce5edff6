"""Explore the triangle: three vanishing points of a box, and the camera that they would mean."""

from functools import lru_cache

import numpy as np
from PIL import Image as Bitmap

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, look_at
from cvnotes.pictures import blocks, render_scene
from cvnotes.projective import from_homogeneous, to_homogeneous
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import CAMERA, ESTIMATED, IDEAL, MUTED

_SHOWN = ((-1200.0, 1300.0), (-520.0, 1668.0))  # px of the photograph, u and v
_SIZE, _SIDE = (480, 420), (360, 420)  # both panels have one scale
_APART = 90.0  # px of the photograph between two letters
_EDGES = [1, 0, 3, 5]  # the box's nearest corner, and the next one along X, Y and Z


def triangle_model() -> Model:
    """Make the model of the chapter's box, photographed with square pixels."""
    pose = look_at([1200, -8000, 2000], [700, -1000, 12800])
    camera = Camera(intrinsics(800, 800, 325, 238), pose, size=(640, 480))
    W = blocks().vertices[_EDGES]
    nearest, *ends = camera.project(W)
    start = camera.vanishing_point(W[1:] - W[0]).round()
    # How far along each edge its end is seen, of the way to the vanishing point.
    part = np.linalg.norm(ends - nearest, axis=1) / np.linalg.norm(start - nearest, axis=1)
    settings = tuple(
        Setting(f"{name}_{axis}", f"{name}: {axis} (px)", low + 30, high - 30, 1, float(at),
                f"where the edges along {name} vanish")
        for name, point in zip("XYZ", start, strict=True)
        for axis, at, (low, high) in zip("uv", point, _SHOWN, strict=True)
    )  # fmt: skip
    about = (
        "The photograph of a box, and far around it the triangle of three vanishing points with "
        "its altitudes; beside it the altitude from Y, seen from the side, with a half circle."
    )

    @lru_cache(maxsize=2)
    def sheet(sharpness: int) -> Drawn:
        """Put the photograph on white paper, once for all values."""
        pale = 0.6 * render_scene(blocks(), camera, samples=4) + 102  # for the lines drawn over it
        photo = Bitmap.fromarray(pale.astype(np.uint8))
        paper = Bitmap.new("RGB", (sharpness * _SIZE[0], sharpness * _SIZE[1]), "white")
        scale = paper.width / np.ptp(_SHOWN[0])
        corner = (round(-scale * _SHOWN[0][0]), round(-scale * _SHOWN[1][0]))
        paper.paste(photo.resize((round(scale * 640), round(scale * 480))), corner)
        return np.asarray(paper)

    def draw(paper: Paper, values: Values) -> Drawing:
        v = np.array([[values[f"{name}_u"], values[f"{name}_v"]] for name in "XYZ"])
        sky = paper.panel(_SIZE, *_SHOWN, "the photograph, and where the edges of its box lead")
        side = paper.panel(
            _SIDE, (-1500, 375), _SHOWN[1], "from the side: the altitude from Y, and the eye"
        )
        sky.image(sheet(paper.sharpness))
        c, square = camera_of(v)
        if np.isfinite(square):
            a, way = np.roll(v, 1, axis=0), np.roll(v, -1, axis=0) - np.roll(v, 1, axis=0)
            feet = (
                a + ((v - a) * way).sum(1, keepdims=True) / (way * way).sum(1, keepdims=True) * way
            )
            for corner, foot in zip(v, feet, strict=True):
                # The whole altitude, of which c may lie outside.
                along = np.array([corner, foot, c])
                along = along[np.argsort(along @ (foot - corner))]
                sky.line(along[[0, -1]], IDEAL, 0.9, dash=5)
        _draw_box(sky, v, nearest, nearest + part[:, None] * (v - nearest))
        if np.isfinite(square):
            sky.mark(c, "estimated", 6)
            # The letter of c gives way to that of a corner to which c has come.
            corner = v[np.linalg.norm(v - c, axis=1).argmin()]
            near = np.linalg.norm(corner - c) < 2 * _APART
            left, below = near and corner[0] > v[:, 0].mean(), near and c[1] > corner[1]
            at = c + [-40 if left else 40, 50 if below else -50]
            sky.text(at, "c", ESTIMATED, anchor="rm" if left else "lm", size=14)
            _draw_side(side, v[1], feet[1], c, square)
        return Drawing(paper.join((sky, side)), _sentence(v, c, square))

    drags = {
        name: lambda _, at, name=name: {f"{name}_u": float(at[0]), f"{name}_v": float(at[1])}
        for name in "XYZ"
    }
    return Model("triangle", about, settings, draw, drags)


def camera_of(v: Array) -> tuple[Array, float]:
    """Return the orthocentre c (2,) of vanishing points (3, 2), and f²; NaN where they line up."""
    X, Y, Z = v
    sides = np.array([Y - Z, Z - X])
    if abs(np.linalg.det(sides)) < 0.5:  # twice the area, in px²
        return np.full(2, np.nan), np.nan
    c = np.linalg.solve(sides, [(Y - Z) @ X, (Z - X) @ Y])
    return c, float(-(X - c) @ (Y - c))


def _draw_box(panel: Panel, v: Array, nearest: Array, ends: Array) -> None:
    """Draw the box that would have these vanishing points, its edges drawn on, and the triangle.

    Where no camera sees a box so, its edges are grey and dashed.
    """
    _, square = camera_of(v)
    look = (ESTIMATED, 0) if square > 0 else (MUTED, 4)
    e, n = to_homogeneous(ends), to_homogeneous(v)
    # Between the ends of two edges lies the corner in which the edges parallel to them meet.
    far = from_homogeneous(
        np.cross(np.cross(e, np.roll(n, -1, axis=0)), np.cross(np.roll(e, -1, axis=0), n))
    )
    for k, name in enumerate("XYZ"):
        edges = [[nearest, ends[k]], [ends[k - 2], far[k]], [ends[k - 1], far[k - 1]]]
        for edge in edges:
            panel.line(edge, look[0], 1.5, look[1])
        for begin, _ in edges:
            panel.line([begin, v[k]], ESTIMATED, 0.6, dash=3)
        panel.line(v[[k, k - 1]], ESTIMATED, 1.8)
        panel.mark(v[k], "estimated", 7)
        panel.grip(name, f"the vanishing point {name}", v[k], 2)
        away = v[k] + 60 * np.sign(v[k] - v.mean(0))
        inside = away.clip(*np.array([[1, -1]]).T * 45 + np.transpose(_SHOWN))
        panel.text(inside, name, ESTIMATED, anchor="mm", size=14)


def _draw_side(panel: Panel, Y: Array, foot: Array, c: Array, square: float) -> None:
    """Draw an altitude upright, with c at its height; the eye is f to the left of it."""
    long = float(np.linalg.norm(Y - foot))
    down = (Y - foot) / long * (1 if Y[1] >= foot[1] else -1)
    top, middle, bottom = (c[1] + (at - c) @ down for at in (foot, (foot + Y) / 2, Y))
    phi = np.radians(np.arange(0, 180.5, 0.5))
    panel.line(np.stack([-np.sin(phi), np.cos(phi)], -1) * long / 2 + [0, middle], IDEAL, 1.2)
    panel.line([[0, top], [0, bottom]], CAMERA, 3)
    if square >= 0:
        f = float(np.sqrt(square))
        panel.line([[0, top], [-f, c[1]], [0, bottom]], ESTIMATED, 1.5)
        panel.line([[-f, c[1]], [0, c[1]]], MUTED, 1.2, dash=4)
        panel.mark([-f, c[1]], "camera", 9, looks=(1, 0))
        at, anchor = ([-f / 2, c[1] - 24], "ms") if f > 400 else ([-f - 60, c[1]], "rm")
        panel.text(at, f"f = {f:.0f}", MUTED, anchor=anchor, size=12)
    # The letter of c gives way to that of an end to which c has come.
    away = min((c[1] - end for end in (bottom, top)), key=abs)
    beside = c[1] - away + np.copysign(max(abs(away), _APART), away)
    for words, at, row in (("c", c[1], beside), ("Y", bottom, bottom), ("line X Z", top, top)):
        panel.mark([0, at], "estimated", 6)
        panel.text([60, row], words, ESTIMATED, size=13)


def _sentence(v: Array, c: Array, square: float) -> str:
    if np.isnan(square):
        return "The three points lie on one line: there is no triangle, and no camera."
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
