"""Explore two ways to measure corners: how far off they are, in five pictures of one board."""

from functools import lru_cache

import numpy as np

from cvnotes.base import Array, Image, luma
from cvnotes.camera import Camera
from cvnotes.pictures import course, expose, render_scene, room_with
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper, circle
from cvnotes.show.explorations.rings import blurred
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED, mixed
from cvnotes.targets import refine_edges, refine_subpixel

_VIEW, _CORNER = 6, 22  # which photograph of the course, and which of its corners is shown
_PICTURES = "as computed", "sharpened", "JPEG, quality 30", "5 px shake", "rays, no blur"
_INKS = LENS, ESTIMATED  # of the gradients, and of the edge model
_WINDOW = 8  # px, from the middle to the border
_REACH, _SHOWN = 0.1, 14  # px, of the clouds, all alike, and of the pictures
_CLOUD = (596, 360)
_SIDE, _GAP = 4 * (2 * _SHOWN + 1), 4  # px of the page, of each picture and between two


def clouds_model() -> Model:
    """Make the model of 54 corners, measured in two ways in five pictures."""
    settings = (Setting("picture", "picture", 1, 5, 1, 3, "how it was made", names=_PICTURES),)
    about = """The errors of 54 corners by the gradients, blue, and by the model of two blurred
    edges, orange, with rings as large as the RMS of a point; below, one of the corners in five
    pictures."""
    return Model(
        "clouds", about, settings, _draw, {"picture": lambda _, at: {"picture": at[0] // 1 + 1}}
    )


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
    """Return measured minus true corners, by both methods: (2, 54, 2)."""
    truth, photo = course.exact_corners()[_VIEW], changed(which)
    start = np.rint(truth)
    edges = refine_edges(photo, start, grid=(9, 6), window=_WINDOW)
    return np.asarray([refine_subpixel(photo, start, window=_WINDOW), edges] - truth)


def _draw(paper: Paper, values: Values) -> Drawing:
    which = round(values["picture"])
    off = errors(which)
    rms = np.sqrt(2 * np.mean(off**2, axis=(1, 2)))  # of a point
    (gradients, edges), name = rms, _PICTURES[which - 1]
    larger = "blue" if gradients > edges else "orange"
    said = f"""In the picture {name} the gradients are off by {gradients:.3f} px and the edge model
    by {edges:.3f}: the {larger} cloud is {max(rms) / min(rms):.1f} times as large."""
    return Drawing(paper.join(([_cloud(paper, off, rms), _strip(paper, which)],)), said)


def _strip(paper: Paper, which: int) -> Panel:
    """Draw the same corner in all five pictures, side by side; the one that is measured, framed."""
    wide, size, names = _SIDE + _GAP, (_CLOUD[0], _SIDE + 22), _SIDE + 11
    title = "pull the cross along the pictures"
    panel = paper.panel(size, (0, size[0] / wide), (0, size[1]), title)
    row = np.full((5, size[1], wide), 255, np.uint8)
    row[:, :_SIDE, :_SIDE] = cutouts().repeat(4, axis=1).repeat(4, axis=2)
    panel.image(np.concatenate(row, axis=1)[:, : size[0]])
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) / 2
    for k, name in enumerate(_PICTURES):
        middle, chosen = np.array([k + _SIDE / wide / 2, _SIDE / 2]), k == which - 1
        box = middle + 4 * (2 * _WINDOW + 1) * square * [1 / wide, 1]
        for colour, width in (("#FFFFFF", 3), (ESTIMATED, 1.4)):
            panel.line(box, colour, width)
        panel.text([middle[0], names], name, IDEAL if chosen else MUTED, anchor="mm", size=13)
        if chosen:
            panel.line(middle + (_SIDE - 3) * square * [1 / wide, 1], ESTIMATED, 3)
    held = [which - 0.17, 0.14 * _SIDE]
    panel.mark(held, "estimated", 8)
    panel.grip("picture", "which picture is measured", held, wide)
    return panel


def _cloud(paper: Paper, off: Array, rms: Array) -> Panel:
    """Draw the errors, and rings as large as the RMS of a point; the smaller cloud on top."""
    reach, aside = _REACH, _REACH * _CLOUD[0] / _CLOUD[1]
    title = "errors of 54 corners: gradients blue, edge model orange"
    panel = paper.panel(_CLOUD, (-aside, aside), (-reach, reach), title)
    dot, ring = 2.5 * panel.pixel * circle(13), circle(91)
    order = np.argsort(-rms)
    for k in order:
        panel.polygons([rms[k] * ring], mixed("#FFFFFF", _INKS[k], 0.15))
    for k in order:
        panel.polygons(off[k][:, None] + dot, mixed("#FFFFFF", _INKS[k], 0.7))
    for k in order:
        panel.line(rms[k] * ring, _INKS[k], 2)
    panel.mark([0, 0], "ideal", 7)
    bar = reach / 2  # px, as long as the scale in the corner
    panel.line([[0.95 * aside - bar, 0.86 * reach], [0.95 * aside, 0.86 * reach]], IDEAL, 2)
    panel.text([0.95 * aside - bar / 2, 0.77 * reach], f"{bar:g} px", IDEAL, anchor="ms", size=13)
    outside = int((np.abs(off) > [aside, reach]).any(axis=(0, 2)).sum())
    if outside:
        place = [-0.97 * aside, 0.92 * reach]
        panel.text(place, f"{outside} of 54 go beyond", IDEAL, anchor="lm", size=13)
    return panel
