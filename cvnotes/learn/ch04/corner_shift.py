"""How far does the corner move."""

import numpy as np

from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.learn.checker.equality import within
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property

_CAMERA = Camera(intrinsics(800, 800, 319.5, 239.5), lens=Lens((-0.25, 0.1)), size=(640, 480))
_OFFSET = np.array([319.5, 239.5])


def corner_shift() -> float:
    """Give by how many pixels the lens moves the picture's first pixel, outwards positive."""
    xy = _OFFSET / 800
    return float(800 * (np.linalg.norm(_CAMERA.lens.distort(xy)) - np.linalg.norm(xy)))


def _shift(k: tuple[float, ...], r: float) -> float:
    return 800 * (float(Lens(k).L(r)) - 1) * r


_R = float(np.hypot(*_OFFSET) / 800)


SHIFT = Exercise(
    name="corner_shift",
    chapter=4,
    title="How far does the corner move?",
    task="A camera has α_u = α_v = 800, u0 = 319.5, v0 = 239.5 and k = (−0.25, 0.1). By how many "
    "pixels does its lens move what an ideal lens would show at pixel (0, 0)? Outwards counts as "
    "positive. One decimal is enough.",
    stub="my_corner_shift = ...",
    hints=(
        "Go to the plane z = 1 first: x = (0 − u0) / α_u, y = (0 − v0) / α_v.",
        "There the point moves from r to r L(r), along its radius.",
        "A length on the plane z = 1 times 800 is a length in pixels.",
    ),
    cases=lambda _: [Case(())],
    properties=(Property("It is how far the lens moves that pixel, to a tenth of a pixel."),),
    misconceptions=(
        Misconception(
            "sign lost",
            "The length is right; with k1 < 0 the corner moves inwards (barrel).",
            lambda: -corner_shift(),
        ),
        Misconception(
            "k2 left out",
            "That is what k1 does alone; k2 r⁴ brings some of it back.",
            lambda: _shift((-0.25,), _R),
        ),
        Misconception(
            "not in pixels",
            "That is the length on the plane z = 1: α turns it into pixels.",
            lambda: corner_shift() / 800,
        ),
        Misconception(
            "horizontal part only",
            "That is the horizontal part of the shift; the corner also moves vertically.",
            lambda: corner_shift() * 319.5 / np.hypot(*_OFFSET),
        ),
        Misconception(
            "vertical part only",
            "That is the vertical part of the shift; the corner also moves horizontally.",
            lambda: corner_shift() * 239.5 / np.hypot(*_OFFSET),
        ),
        Misconception(
            "the way back",
            "That is how correction moves the pixel: from where it is seen to where it belongs. "
            "Asked is what the lens does.",
            lambda: 800 * float(np.linalg.norm(_CAMERA.lens.undistort(_OFFSET / 800)) - _R),
        ),
        Misconception(
            "where the corner is seen",
            (
                "That is the distance from the principal point at which the corner is seen; by how "
                "much it has moved is the difference to 400."
            ),
            lambda: 800 * _R + corner_shift(),
        ),
        Misconception(
            "r² for r⁴", "k2 belongs to r⁴; you used r² for both.", lambda: _shift((-0.15,), _R)
        ),
        Misconception(
            "r in pixels",
            "r = 1 is 800 pixels: k1 and k2 belong to the r of the plane z = 1.",
            lambda: _shift((-0.25, 0.1), 800 * _R) * 1.0,
        ),
        Misconception(
            "sign lost and k2 left out",
            "That is what k1 does alone, and without its sign.",
            lambda: -_shift((-0.25,), _R),
        ),
    ),
    reference=corner_shift,
    same=within(0.06),
    concepts=("30", "31", "33"),
    answer="value",
)
