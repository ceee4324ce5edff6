"""Explore two ways to measure corners: how far off, for which window, in which picture."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array, Image, luma
from cvnotes.camera import Camera
from cvnotes.pictures import course, expose, render_scene, room_with
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.explorations.rings import blurred
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, mixed
from cvnotes.targets import refine_edges, refine_subpixel

_VIEW, _CORNER = 6, 22  # which photograph of the course, and which of its corners is shown
_PICTURES = "as computed", "sharpened", "JPEG, quality 30", "5 px shake", "rays, no blur"
_METHODS = ("gradients", LENS), ("edge model", ESTIMATED)
_NOISE = 2  # grey levels, of the first picture
_WINDOWS = np.arange(3, 13)  # px, from the middle to the border
_REACH, _SHOWN = 0.1, 14  # px, of the clouds, all alike, and of the pictures
_LEAST, _MOST = 0.0038, 0.25  # px, of the curves
_CLOUD, _CURVES = (596, 360), (274, 526)
_SIDE, _GAP = 4 * (2 * _SHOWN + 1), 4  # px of the page, of each picture and between two


def clouds_model() -> Model:
    """Make the model of 54 corners, measured in two ways in five pictures."""
    settings = (
        Setting("window", "half window (px)", 3, 12, 1, 8, "from its middle pixel to its border"),
        Setting("picture", "picture", 1, 5, 1, 1, "how it was made", names=_PICTURES),
    )
    about = (
        "The errors of 54 corners by the gradients, blue, and by the model of two blurred edges, "
        "orange, with rings as large as the RMS of a point (dashed: what the noise allows); below, "
        "the same corner in five pictures, with its window; beside it how large the rings are, for "
        "each window."
    )
    drags = {
        "window": lambda _, at: {"window": at[0]},
        "picture": lambda _, at: {"picture": np.floor(at[0]) + 1},
    }
    return Model("clouds", about, settings, _draw, drags)


@lru_cache(maxsize=5)
def changed(which: int) -> Image:
    """Return one of the five pictures, as in chapter 5, in grey levels."""
    light = course.photo(_VIEW).astype(float)
    if which == 2:
        soft = blurred(light.shape[0], 1.5) @ light @ blurred(light.shape[1], 1.5).T
        return np.asarray((2 * light - soft).clip(0, 255))
    if which == 3:
        return expose(light, jpeg=30)
    if which == 4:
        way = 5 * ((np.arange(320) + 0.5) / 320 - 0.5)
        wide = np.pad(light, ((0, 0), (3, 3)), mode="edge")
        parts = [np.maximum(1 - np.abs(j - way), 0).mean() for j in range(-3, 4)]  # linear between
        shaken = sum(part * wide[:, k : k + light.shape[1]] for k, part in enumerate(parts))
        return expose(np.asarray(shaken), noise=2, rng=np.random.default_rng(3))
    if which == 5:
        return _traced(course.camera())
    return light


def _traced(camera: Camera) -> Image:
    room = room_with(course.board(), course.poses()[_VIEW])
    return np.asarray(luma(render_scene(room, camera, samples=64).astype(float)))


@lru_cache(maxsize=1)
def cutouts() -> Drawn:
    """Return the same corner in all five pictures (5, 29, 29)."""
    u, v = np.rint(course.exact_corners()[_VIEW, _CORNER]).astype(int)
    around = np.s_[v - _SHOWN : v + _SHOWN + 1, u - _SHOWN : u + _SHOWN + 1]
    A, side = course.camera().A.copy(), 2 * _SHOWN + 1
    A[:2, 2] -= [u - _SHOWN, v - _SHOWN]  # a small picture takes no second
    near = Camera(A, lens=course.camera().lens, size=(side, side))
    parts = [*(changed(k)[around] for k in range(1, 5)), _traced(near)]
    return np.rint(parts).clip(0, 255).astype(np.uint8)


@lru_cache(maxsize=5)
def errors(which: int) -> Array:
    """Return measured minus true corners, by method and window: (2, 10, 54, 2)."""
    truth, photo = course.exact_corners()[_VIEW], changed(which)
    start = np.rint(truth)
    by_gradients = [refine_subpixel(photo, start, window=int(w)) for w in _WINDOWS]
    by_edges = [refine_edges(photo, start, grid=(9, 6), window=int(w)) for w in _WINDOWS]
    return np.asarray(np.array([by_gradients, by_edges]) - truth)


@lru_cache(maxsize=1)
def allowed() -> Array:
    """Return the least RMS of a point that the noise of the first picture allows, by window."""
    photo, least = course.photo(_VIEW).astype(float), []
    slopes = np.stack([_slope(photo.T).T, _slope(photo)])  # by u and by v
    for half in _WINDOWS:
        for u, v in np.rint(course.exact_corners()[_VIEW]).astype(int):
            g = slopes[:, v - half : v + half + 1, u - half : u + half + 1].reshape(2, -1)
            least.append(np.sum(_NOISE**2 / np.linalg.eigvalsh(g @ g.T)))
    return np.asarray(np.sqrt(np.mean(np.reshape(least, (len(_WINDOWS), -1)), axis=1)))


def _slope(grey: Array) -> Array:
    """Return the derivative downwards; three neighbours on each side keep steep edges steep."""
    parts = zip((1, 2, 3), (45, -9, 1), strict=True)
    differences = [w * (np.roll(grey, -k, axis=0) - np.roll(grey, k, axis=0)) for k, w in parts]
    return np.asarray(sum(differences) / 60)


def _draw(paper: Paper, values: Values) -> Drawing:
    window, which = round(values["window"]), round(values["picture"])
    off = errors(which)
    rms = np.sqrt(2 * np.nanmean(off**2, axis=(2, 3)))  # of a point
    now = int(window - _WINDOWS[0])
    least = allowed() if which == 1 else None  # the noise of the others is another one
    cloud = _cloud(paper, off[:, now], rms[:, now], None if least is None else float(least[now]))
    drawn = paper.join(([cloud, _strip(paper, window, which)], _curves(paper, rms, now, least)))
    (gradients, edges), name = rms[:, now], _PICTURES[which - 1]
    lost = int(np.isnan(off[:, now, :, 0]).any(axis=0).sum())
    larger = "blue" if gradients > edges else "orange"
    said = (
        f"In the picture {name}, with a window of {2 * window + 1} × {2 * window + 1} px, the "
        f"gradients are off by {gradients:.3f} px and the edge model by {edges:.3f}: the {larger} "
        f"cloud is {max(gradients / edges, edges / gradients):.1f} times as large."
    )
    return Drawing(drawn, f"{said} ({lost} corners were lost.)" if lost else said)


def _strip(paper: Paper, window: int, which: int) -> Panel:
    """Draw the same corner in all five pictures, side by side; the one that is measured, framed."""
    wide, size, names = _SIDE + _GAP, (_CLOUD[0], _SIDE + 22), _SIDE + 11
    panel = paper.panel(
        size, (0, size[0] / wide), (0, size[1]), "pull the cross along the pictures"
    )
    row = np.full((5, size[1], wide), 255, np.uint8)
    row[:, :_SIDE, :_SIDE] = cutouts().repeat(4, axis=1).repeat(4, axis=2)
    panel.image(np.concatenate(row, axis=1)[:, : size[0]])
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) / 2
    for k, name in enumerate(_PICTURES):
        middle, chosen = np.array([k + _SIDE / wide / 2, _SIDE / 2]), k == which - 1
        box = middle + 4 * (2 * window + 1) * square * [1 / wide, 1]
        for colour, width in (("#FFFFFF", 3), (ESTIMATED, 1.4)):
            panel.line(box, colour, width)
        panel.text([middle[0], names], name, IDEAL if chosen else MUTED, anchor="mm", size=13)
        if chosen:
            panel.line(middle + (_SIDE - 3) * square * [1 / wide, 1], ESTIMATED, 3)
    held = [which - 0.17, 0.14 * _SIDE]
    panel.mark(held, "estimated", 8)
    panel.grip("picture", "which picture is measured", held, wide)
    return panel


def _cloud(paper: Paper, off: Array, rms: Array, least: float | None) -> Panel:
    """Draw the errors, and rings as large as the RMS of a point; the smaller cloud on top."""
    reach, aside = _REACH, _REACH * _CLOUD[0] / _CLOUD[1]
    panel = paper.panel(_CLOUD, (-aside, aside), (-reach, reach), "errors of 54 corners")
    dot, ring = 2.5 * panel.pixel * circle(13), circle(91)
    order = np.argsort(-rms)
    for k in order:
        panel.polygons([rms[k] * ring], mixed("#FFFFFF", _METHODS[k][1], 0.15))
    for k in order:
        panel.polygons(off[k][:, None] + dot, mixed("#FFFFFF", _METHODS[k][1], 0.7))
    for k in order:
        panel.line(rms[k] * ring, _METHODS[k][1], 2)
    if least:
        panel.line(least * ring, IDEAL, 2, dash=4)
    panel.mark([0, 0], "ideal", 7)
    bar = reach / 2  # px, as long as the scale in the corner
    panel.line([[0.95 * aside - bar, 0.86 * reach], [0.95 * aside, 0.86 * reach]], IDEAL, 2)
    panel.text([0.95 * aside - bar / 2, 0.77 * reach], f"{bar:g} px", IDEAL, anchor="ms", size=13)
    outside = int((np.abs(off) > [aside, reach]).any(axis=(0, 2)).sum())
    if outside:
        words = f"{outside} of 54 go beyond"
        panel.text([-0.97 * aside, 0.92 * reach], words, IDEAL, anchor="lm", size=13)
    return panel


def _curves(paper: Paper, rms: Array, now: int, least: Array | None) -> Panel:
    """Draw the RMS of a point against the window, as a logarithm."""
    ends = (np.log10(_MOST), np.log10(_LEAST))
    panel = paper.panel(_CURVES, (2, 13), ends, "RMS (px), by the width of the window")
    for half in _WINDOWS[::3]:
        panel.text([half, np.log10(1.03 * _LEAST)], f"{2 * half + 1}", anchor="md", size=12)
    for value in (0.005, 0.01, 0.02, 0.05, 0.1, 0.2):
        panel.line([[0, np.log10(value)], [14, np.log10(value)]], "#DDDDDD", 0.5)
        panel.text([2.1, np.log10(value)], f"{value:g}", size=12)
    if least is not None:
        panel.line(np.column_stack([_WINDOWS, np.log10(least)]), IDEAL, 1.6, dash=4)
        panel.text([6.4, np.log10(least[3]) - 0.06], "noise", IDEAL, anchor="ra", size=13)
    for curve, (name, colour) in zip(rms, _METHODS, strict=True):
        panel.line(np.column_stack([_WINDOWS, np.log10(curve)]), colour, 2.2)
        upper = (
            curve[-1] == rms[:, -1].max() or least is not None
        )  # its name is above it, that of the lower one below
        at = np.log10(curve[-4:].max() if upper else curve[-4:].min()) + (0.03 if upper else -0.03)
        panel.text([12.8, at], name, colour, anchor="rd" if upper else "ra", size=13)
        panel.mark([_WINDOWS[now], np.log10(curve[now])], "ideal", 6)
    held = [_WINDOWS[now], np.log10(rms[0, now])]
    panel.grip("window", "how large the window is", held, 26)
    return panel
