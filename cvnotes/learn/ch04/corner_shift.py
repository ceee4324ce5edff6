"""How far does the corner move."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, Lens, intrinsics
from cvnotes.tutor.checker.equality import within
from cvnotes.tutor.checker.exercise import Case, Exercise, Misconception, Property, mistakes

_LENS = Lens((-0.25, 0.1))
_CAMERA = Camera(intrinsics(800, 800, 319.5, 239.5), lens=_LENS, size=(640, 480))
_OFFSET = np.array([319.5, 239.5])


def corner_shift() -> float:
    """Return by how many pixels the lens moves the picture's first pixel, outwards positive."""
    xy = _OFFSET / 800
    return float(800 * (np.linalg.norm(_CAMERA.lens.distort(xy)) - np.linalg.norm(xy)))


def _shift(k: tuple[float, ...], r: float) -> float:
    return 800 * (float(Lens(k).L(r)) - 1) * r


_R = float(np.hypot(*_OFFSET) / 800)


def _nearly(answer: Array, case: Case) -> bool:
    """Return whether a number was read or rounded too coarsely."""
    return bool(abs(answer - case.right) < 0.6)


MISTAKES = mistakes(
    ("sign lost", "The length is right; with k1 < 0 the corner moves inwards (barrel).",
     lambda: -corner_shift()),
    ("another L", "Your L is another: are both k1 and k2 in it, with their signs, and which "
     "powers of r belong to them?",
     lambda: _shift((-0.25,), _R), lambda: -_shift((-0.25,), _R), lambda: _shift((-0.15,), _R),
     lambda: 800 * (-0.25 * _R + 0.1 * _R ** 2) * _R, lambda: _shift((-0.25, -0.1), _R),
     lambda: _shift((0.25, 0.1), _R), lambda: _shift((0.1, -0.25), _R)),
    ("r in pixels", "r = 1 is 800 pixels: k1 and k2 belong to the r of the plane z = 1.",
     lambda: _shift((-0.25, 0.1), 800 * _R) * 1.0),
    ("L − 1 times 800",
     "You multiplied L − 1 by a number, and not by the length r, which is not 1.",
     lambda: 800 * (float(_LENS.L(_R)) - 1), lambda: 100 * (float(_LENS.L(_R)) - 1)),
    ("one part only", "The corner moves horizontally and vertically at once, and r has both "
     "parts: one alone, or the sum of both, is not how far.",
     lambda: corner_shift() * 319.5 / np.hypot(*_OFFSET),
     lambda: corner_shift() * 239.5 / np.hypot(*_OFFSET),
     lambda: corner_shift() * _OFFSET.sum() / np.hypot(*_OFFSET),
     lambda: _shift((-0.25, 0.1), 319.5 / 800), lambda: _shift((-0.25, 0.1), 239.5 / 800)),
    ("the way back",
     "That is how correction moves the pixel: from where it is seen to where it belongs. "
     "Asked is what the lens does.",
     lambda: 800 * float(np.linalg.norm(_CAMERA.lens.undistort(_OFFSET / 800)) - _R)),
    ("where the corner is seen",
     "That is where something is seen, not by how much it has moved.",
     lambda: 800 * _R + corner_shift(), lambda: 319.5 * (1 - float(_LENS.L(_R))),
     lambda: 239.5 * (1 - float(_LENS.L(_R)))),
    ("half of it, or twice",
     "That is half of the shift, or twice the shift: how many pixels is r, and how many L r?",
     lambda: corner_shift() / 2, lambda: 2 * corner_shift()),
)  # fmt: skip


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
        *MISTAKES,
        Misconception(
            "not in pixels",
            "That is the length on the plane z = 1: α turns it into pixels.",
            lambda: corner_shift() / 800,
            same=within(0.003),
        ),
        Misconception(
            "a factor for a length",
            "That is a factor, L or L − 1; the shift is a length.",
            lambda: float(_LENS.L(_R)) - 1,
            variants=(
                lambda: float(_LENS.L(_R)),
                lambda: 1 - float(_LENS.L(_R)),
            ),
            same=within(0.003),
        ),
        Misconception(
            "distance of the corner",
            "That is how far the corner is from the principal point without a lens.",
            lambda: 800 * _R,
            same=within(0.6),
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
