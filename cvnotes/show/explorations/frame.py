"""Explore what leaves the frame: a new camera shows a part of a straightened picture."""

from functools import cache

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, intrinsics, look_at
from cvnotes.pictures import blocks, render_scene
from cvnotes.show.explorations.model import Drawing, Model, Setting, Values
from cvnotes.show.explorations.paper import Drawn, Panel, Paper
from cvnotes.show.style import ESTIMATED, IDEAL, LENS, MUTED
from cvnotes.warping import undistort_image
from cvnotes.warping.framing import border

_PLANE, _NEW, _CURVES = (480, 440), (384, 288), (384, 124)  # px of the page
_X, _Y = 1.38, 1.38 * 440 / 480  # of the plane z = 1, from its middle
_SIZE = (640, 480)
_LAST = np.array(_SIZE) - 1.0  # the last pixel; the first is (0, 0)
_OLD, _NEAR, _FAR = 400, 260, 430  # px: focal lengths
_LOW, _HIGH = -20, 58  # %, of the curves
_C = _LAST / 2  # the principal point
_A = intrinsics(_OLD, _OLD, *_C)
_CAMERA = Camera(_A, look_at([-600, 0, 6200], [-600, -900, 14_000]), Lens((-0.25, 0.05)), _SIZE)
_FINE = (2 * _SIZE[0], 2 * _SIZE[1])  # of the photograph that is looked up


def frame_model() -> Model:
    """Make the model of the chapter's street, straightened, and of a new camera's picture of it."""
    settings = (Setting("f", "focal length f (px)", _NEAR, _FAR, 1, 318, "of the new camera"),)
    about = """A street on the plane z = 1 as the lens saw it, undistorted, with its curved border
    and the frame of a new camera; beside it this camera's picture, black where the frame leaves the
    border, and below it how much is black and how much is lost, over f."""
    drags = {"corner": lambda _, at: {"f": _C @ _C / max(_C @ at, 1.0)}}
    return Model("frame", about, settings, _draw, drags)


def _draw(paper: Paper, values: Values) -> Drawing:
    f = values["f"]
    new = paper.panel(_NEW, (0, 1), (0, 1), "the new picture")
    size = 2 * _NEW[0], 2 * _NEW[1]
    A = Camera(intrinsics(f, f, *_C), size=_SIZE).resized(size).A
    new.image(undistort_image(*_photograph(), A, size=size).astype(np.uint8))
    filled, lost = shares()
    drawn = paper.join((_plane(paper, f), [new, _curves(paper, f, filled, lost)]))
    return Drawing(drawn, _sentence(f, (filled > f).mean(), (lost < f).mean()))


def _sentence(f: float, black: float, lost: float) -> str:
    every, full = ends()
    wide = 2 * np.degrees(np.arctan(_C / f))[0]
    gaps = "nothing" if f >= full else _percent(black)
    gone = "nothing" if f <= every else f"{_percent(lost)} of the old pixels"
    return f"""f = {f:g} px: the new camera sees {wide:.0f}° from left to right. Of its picture
    {gaps} is black; {gone} is lost."""


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if share >= 0.0005 else "less than 0.1 %"


@cache
def _photograph() -> tuple[Drawn, Camera]:
    """Photograph the street once, and return the camera that did so."""
    camera = _CAMERA.resized(_FINE)
    return render_scene(blocks(), camera, samples=4), camera


@cache
def _undistorted() -> tuple[Drawn, Drawn]:
    """Show the plane z = 1 twice: black where nothing was seen; and pale, white there."""
    w, h = 2 * _PLANE[0], 2 * _PLANE[1]
    A = intrinsics(w / 2 / _X, w / 2 / _X, (w - 1) / 2, (h - 1) / 2)
    full = undistort_image(*_photograph(), A, size=(w, h)).astype(np.uint8)
    pale = (255 - 0.4 * (255.0 - full)).astype(np.uint8)
    pale[(full == 0).all(axis=-1)] = 255
    return full, pale


@cache
def _seen() -> tuple[Array, Array, Array]:
    """Return the middles (n, 2) of squares of 4 × 4 pixels, and what the lens saw in them.

    The third is the border of all that it saw. Both are points of the plane z = 1.
    """
    middles = np.stack(np.meshgrid(*(np.arange(1.5, n, 4) for n in _SIZE)), -1).reshape(-1, 2)
    left, right, top, bottom = border(_CAMERA, np.eye(3))
    return middles, _CAMERA.ideal(middles), np.concatenate([top, right, bottom[::-1], left[::-1]])


def _leaves(xy: Array) -> Array:
    """Return the focal length from which on points of the plane z = 1 are outside of the frame."""
    return np.asarray((_C / np.abs(xy)).min(axis=1))


def ends() -> tuple[float, float]:
    """Return the focal lengths up to which all is seen, and from which on nothing is black."""
    at = _leaves(_seen()[2])
    return float(at.min()), float(at.max())


@cache
def shares() -> tuple[Array, Array]:
    """Return from which f on the new picture's parts are filled, and what was seen is lost.

    A part is filled as soon as its ray is nearer to the middle than the border is that way.
    """
    middles, seen, rim = _seen()
    angle, around = (np.arctan2(*xy.T[::-1]) for xy in (middles - _C, rim))
    far = np.interp(angle, around, np.linalg.norm(rim, axis=1), period=2 * np.pi)
    return np.linalg.norm(middles - _C, axis=1) / far, _leaves(seen)


def _plane(paper: Paper, f: float) -> Panel:
    """Draw the plane z = 1: full colours in the frame, pale what it leaves out, black its gaps."""
    panel = paper.panel(_PLANE, (-_X, _X), (-_Y, _Y), "what the lens saw: pull the frame's corner")
    full, pale = _undistorted()
    shown, frame = pale.copy(), np.array([-_C, _C]) / f
    (a, b), (r, d) = np.rint(panel.place(frame) * 2 / panel.scale).astype(int).clip(0).tolist()
    shown[b:d, a:r] = full[b:d, a:r]
    panel.image(shown)
    panel.line(_seen()[2], LENS, 1.4)
    old = np.array([-_C, _C]) / _OLD
    for corners, ink, width, dash in ((old, IDEAL, 1.4, 6.0), (frame, ESTIMATED, 2.6, 0.0)):
        around = corners[[0, 1, 1, 0, 0], 0], corners[[0, 0, 1, 1, 0], 1]
        panel.line(np.transpose(around), ink, width, dash, rim=2)
    panel.text(old[0] + [8 * panel.pixel, 8 * panel.pixel], f"the old A: {_OLD} px", size=13)
    panel.grip("corner", "the corner of the new frame", frame[1], 3, "ideal", 9)
    return panel


def _curves(paper: Paper, f: float, filled: Array, lost: Array) -> Panel:
    """Draw how much of the new picture is black, and of what was seen is lost, over f."""
    title = "how much is black, and how much lost (%), over f (px)"
    panel = paper.panel(_CURVES, (_NEAR - 18, _FAR + 6), (_HIGH, _LOW), title)
    panel.ticks(x=(260, 300, 340, 380, 420), y=(0, 20, 40), size=12)
    for at, words in zip(ends(), ("nothing lost", "nothing black"), strict=True):
        if _NEAR <= at <= _FAR:
            panel.line([[at, 0], [at, _HIGH]], MUTED, 1, dash=3)
            panel.text([at, _HIGH - 7], words, MUTED, anchor="mm", size=12)
    panel.line([[f, 0], [f, _HIGH]], ESTIMATED, 2)
    over = np.arange(_NEAR, _FAR + 1)
    for part, ink, words, place, anchor in (
        ([(filled > one).mean() for one in over], IDEAL, "black (of the new)", 0, "ld"),
        ([(lost < one).mean() for one in over], LENS, "lost (of the old pixels)", -8, "rd"),
    ):
        curve = np.column_stack([over, 100 * np.array(part)])
        panel.line(curve, ink, 2)
        panel.text(curve[place] + [0, 2], words, ink, anchor=anchor, size=12)
    return panel
