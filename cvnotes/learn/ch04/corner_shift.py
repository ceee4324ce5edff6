"""How far does the corner move."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.learn.checker.equality import within
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property

_LENS = Lens((-0.25, 0.1))
_CAMERA = Camera(intrinsics(800, 800, 319.5, 239.5), lens=_LENS, size=(640, 480))
_OFFSET = np.array([319.5, 239.5])


def corner_shift() -> float:
    """Give by how many pixels the lens moves the picture's first pixel, outwards positive."""
    xy = _OFFSET / 800
    return float(800 * (np.linalg.norm(_CAMERA.lens.distort(xy)) - np.linalg.norm(xy)))


def _shift(k: tuple[float, ...], r: float) -> float:
    return 800 * (float(Lens(k).L(r)) - 1) * r


_R = float(np.hypot(*_OFFSET) / 800)


def _nearly(answer: Array, case: Case) -> bool:
    """Tell whether a number was read or rounded too coarsely."""
    return bool(abs(answer - case.right) < 0.6)


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
            same=within(0.003),
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
        Misconception(
            "L − 1",
            "That is L − 1, a factor: times r it is a length on the plane z = 1, and times 800 "
            "one in pixels.",
            lambda: float(_LENS.L(_R)) - 1,
            same=within(0.003),
        ),
        Misconception(
            "L itself",
            "That is the factor L(r); the shift is (L − 1) r, in pixels.",
            lambda: float(_LENS.L(_R)),
            same=within(0.003),
        ),
        Misconception(
            "L − 1 times 800",
            "You multiplied L − 1 by 800; the shift is (L − 1) r, and r is not 1.",
            lambda: 800 * (float(_LENS.L(_R)) - 1),
        ),
        Misconception(
            "L − 1 without its sign",
            "That is 1 − L, a factor: times r it is a length on the plane z = 1, and times 800 "
            "one in pixels.",
            lambda: 1 - float(_LENS.L(_R)),
            same=within(0.003),
        ),
        Misconception(
            "in percent",
            "That is by how many per cent the corner moves; asked are pixels.",
            lambda: 100 * (float(_LENS.L(_R)) - 1),
        ),
        Misconception(
            "distance of the corner",
            "That is how far the corner is from the principal point without a lens.",
            lambda: 800 * _R,
            same=within(0.6),
        ),
        Misconception(
            "where the column is seen",
            "That is the column, or the row, at which the corner is seen; asked is by how much it "
            "has moved.",
            lambda: 319.5 * (1 - float(_LENS.L(_R))),
            variants=(lambda: 239.5 * (1 - float(_LENS.L(_R))),),
        ),
        Misconception(
            "horizontal and vertical part added",
            "You added both parts; the shift is the root of the sum of their squares.",
            lambda: corner_shift() * _OFFSET.sum() / np.hypot(*_OFFSET),
        ),
        Misconception(
            "r for r²",
            "You used r and r² where L has r² and r⁴.",
            lambda: 800 * (-0.25 * _R + 0.1 * _R**2) * _R,
        ),
        Misconception(
            "r of the column alone",
            "You took r from the column alone: r² = x² + y².",
            lambda: _shift((-0.25, 0.1), 319.5 / 800),
            variants=(lambda: _shift((-0.25, 0.1), 239.5 / 800),),
        ),
        Misconception(
            "signs of k",
            "You have one of k1 and k2 with the wrong sign: k1 is negative, k2 is positive.",
            lambda: _shift((-0.25, -0.1), _R),
            variants=(lambda: _shift((0.25, 0.1), _R),),
        ),
        Misconception(
            "k1 and k2 exchanged",
            "k1 = −0.25 goes with r², k2 = 0.1 with r⁴.",
            lambda: _shift((0.1, -0.25), _R),
        ),
        Misconception(
            "half of it, or twice",
            "That is half of the shift, or twice the shift, which is 800 (L − 1) r pixels.",
            lambda: corner_shift() / 2,
            variants=(lambda: 2 * corner_shift(),),
        ),
        Misconception(
            "not exact enough",
            "Nearly: one decimal is asked. Do not round r or L before the end.",
            lambda: corner_shift() + 0.3,
            variants=(lambda: corner_shift() - 0.3,),
            seen=_nearly,
        ),
    ),
    reference=corner_shift,
    same=within(0.06),
    concepts=("30", "31", "33"),
    answer="value",
)
