"""Explore two ways to measure corners: how far off, for which window, in which picture."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array, Image, luma
from cvnotes.pictures import course, expose, render_scene, room_with
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Panel, Paper
from cvnotes.show.explorations.rings import blurred
from cvnotes.show.explorations.strokes import circle
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, mixed
from cvnotes.targets import refine_edges, refine_subpixel

_VIEW, _CORNER = 6, 22  # which photograph of the course, and which of its corners is shown
_PICTURES = "as computed", "sharpened", "JPEG of quality 30", "5 px shake", "rays, no blur"
_METHODS = ("gradients", LENS), ("edge model", ESTIMATED)
_WINDOWS = np.arange(3, 13)  # px, from the middle to the border
_REACHES, _SHOWN = (0.07, 0.15), 14  # px, of the clouds and of the picture
_LEAST, _MOST = 0.003, 0.2  # px, of the curves


def clouds_model() -> Model:
    """Make the model of 54 corners, measured in two ways in five pictures."""
    settings = (
        Setting("window", "half window (px)", 3, 12, 1, 4, "from its middle pixel to its border"),
        Setting("picture", "picture", 1, 5, 1, 1, "; ".join(_PICTURES)),
    )
    about = (
        "A corner and the window about it; the errors of 54 corners by the gradients, blue, and by "
        "the model of two blurred edges, orange; and how large they are, for each window."
    )
    return Model("clouds", about, settings, _draw, {"window": lambda _, at: {"window": at[0]}})


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
        shaken = light @ np.mean([_moved(light.shape[1], s) for s in way], axis=0).T
        return expose(shaken, noise=2, rng=np.random.default_rng(3))
    if which == 5:
        room = room_with(course.board(), course.poses()[_VIEW])
        return luma(render_scene(room, course.camera(), samples=64).astype(float))
    return light


def _moved(n: int, by: float) -> Array:
    """Return the matrix (n, n) of a shift along rows, linear between pixels."""
    at = np.arange(n)
    return np.asarray(np.maximum(1 - np.abs((at[:, None] - by).clip(0, n - 1) - at), 0))


@lru_cache(maxsize=5)
def errors(which: int) -> Array:
    """Return measured minus true corners, by method and window: (2, 10, 54, 2)."""
    truth, photo = course.exact_corners()[_VIEW], changed(which)
    start = np.rint(truth)
    by_gradients = [refine_subpixel(photo, start, window=int(w)) for w in _WINDOWS]
    by_edges = [refine_edges(photo, start, grid=(9, 6), window=int(w)) for w in _WINDOWS]
    return np.asarray(np.array([by_gradients, by_edges]) - truth)


def _draw(paper: Paper, values: Values) -> Drawing:
    window, which = round(values["window"]), round(values["picture"])
    off = errors(which)
    rms = np.sqrt(np.nanmean(off**2, axis=(2, 3)))
    now = int(window - _WINDOWS[0])
    reach = _REACHES[int(which > 2)]  # one for all windows, for the clouds to be compared
    cloud = _cloud(paper, off[:, now], reach)
    panels = _picture(paper, window, which), cloud, _curves(paper, rms, now)
    (gradients, edges), name = rms[:, now], _PICTURES[which - 1]
    lost = int(np.isnan(off[:, now, :, 0]).any(axis=0).sum())
    larger = "blue" if gradients > edges else "orange"
    said = (
        f"In the picture {name}, with a window of {2 * window + 1} × {2 * window + 1} px, the "
        f"gradients are off by {gradients:.3f} px and the edge model by {edges:.3f}: the {larger} "
        f"cloud is {max(gradients / edges, edges / gradients):.1f} times as large."
    )
    return Drawing(paper.join(panels), f"{said} ({lost} corners were lost.)" if lost else said)


def _picture(paper: Paper, window: int, which: int) -> Panel:
    u, v = np.rint(course.exact_corners()[_VIEW, _CORNER]).astype(int)
    panel = paper.panel(
        (285, 285), (u - _SHOWN - 0.5, u + _SHOWN + 0.5), (v - _SHOWN - 0.5, v + _SHOWN + 0.5),
        f"{_PICTURES[which - 1]}, and the window",
    )  # fmt: skip
    part = changed(which)[v - _SHOWN : v + _SHOWN + 1, u - _SHOWN : u + _SHOWN + 1]
    panel.image(np.rint(part).clip(0, 255).astype(np.uint8), smooth=False)
    box = (window + 0.5) * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    for colour, width in (("#FFFFFF", 3.5), (ESTIMATED, 1.8)):
        panel.line(box + [u, v], colour, width)
    return panel


def _cloud(paper: Paper, off: Array, reach: float) -> Panel:
    """Draw the errors, and a ring as large as the RMS of a point."""
    panel = paper.panel(
        (285, 285), (-reach, reach), (-reach, reach), f"54 errors; {2 * reach:g} px wide"
    )
    ring = circle(91)
    dot = 2 * panel.pixel * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for cloud, (_, colour) in zip(off, _METHODS, strict=True):
        pale = mixed("#FFFFFF", colour, 0.55)  # the ring stands out
        panel.polygons(cloud[:, None] + dot, pale)
    for cloud, (_, colour) in zip(off, _METHODS, strict=True):
        panel.line(np.sqrt(2 * np.nanmean(cloud**2)) * ring, colour, 1.8)
    panel.mark([0, 0], "ideal", 6)
    outside = int((np.abs(off) > reach).any(axis=(0, 2)).sum())
    if outside:
        words = f"{outside} of 54 go beyond"
        panel.text([-0.94 * reach, 0.92 * reach], words, IDEAL, anchor="lm", size=12)
    return panel


def _curves(paper: Paper, rms: Array, now: int) -> Panel:
    """Draw the RMS of one coordinate against the window, as a logarithm."""
    panel = paper.panel(
        (285, 285),
        (2, 13),
        (np.log10(_MOST), np.log10(_LEAST)),
        "RMS (px) against the window's side (px)",
    )
    for half in _WINDOWS[::3]:
        panel.text([half, np.log10(1.06 * _LEAST)], f"{2 * half + 1}", anchor="md", size=12)
    for value in (0.005, 0.01, 0.02, 0.05, 0.1):
        panel.line([[0, np.log10(value)], [14, np.log10(value)]], "#DDDDDD", 0.5)
        panel.text([2.1, np.log10(value)], f"{value:g}", size=12)
    for curve, (name, colour) in zip(rms, _METHODS, strict=True):
        panel.line(np.column_stack([_WINDOWS, np.log10(curve)]), colour, 2)
        upper = curve[-1] == rms[:, -1].max()  # its name is above it, that of the lower one below
        at = np.log10(curve[-4:].max() if upper else curve[-4:].min()) + (0.05 if upper else -0.05)
        panel.text([12.8, at], name, colour, anchor="rd" if upper else "ra", size=12)
        panel.mark([_WINDOWS[now], np.log10(curve[now])], "ideal", 6)
    panel.grip("window", "how large the window is", [_WINDOWS[now], np.log10(rms[0, now])], 26)
    return panel
