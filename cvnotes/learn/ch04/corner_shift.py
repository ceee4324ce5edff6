"""How far does the corner move."""

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Lens
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import within, within_part


def corner_shift() -> float:
    """Return by how many pixels the lens moves the picture's first pixel, outwards positive."""
    x, y = 319.5 / 800, 239.5 / 800
    r = np.hypot(x, y)
    L = 1 - 0.25 * r**2 + 0.1 * r**4
    return 800 * (L - 1) * r


def _undone(x: float, y: float) -> Array:
    return Lens((-0.25, 0.1)).undistort([x, y])


def _nearly(answer: Array, case: Case) -> bool:
    """Return whether a number was read or rounded too coarsely."""
    return bool(abs(answer - case.right) < 0.6)


MISTAKES = mistakes_in(corner_shift,
    ("sign lost", "The length is right; with k1 < 0 the corner moves inwards (barrel).",
     "800 * (1 - L) * r"),
    ("another L", "Your L is another: are both k1 and k2 in it, with their signs, and which "
     "powers of r belong to them?",
     ("+ 0.1 * r**4", ""), ("+ 0.1 * r**4", "", "800 * (1 - L) * r"), ("0.1 * r**4", "0.1 * r**2"),
     ("r**2", "r", "r**4", "r**2"), ("+ 0.1", "- 0.1"), ("- 0.25", "+ 0.25"),
     ("r**4", "s", "r**2", "r**4", "* s", "* r**2")),
    ("r in pixels", "r = 1 is 800 pixels: k1 and k2 belong to the r of the plane z = 1.",
     ("np.hypot", "800 * np.hypot"), {"same": within_part(1e-3)}),
    ("L − 1 times 800",
     "You multiplied L − 1 by a number, and not by the length r, which is not 1.",
     "800 * (L - 1)", "100 * (L - 1)"),
    ("one part only", "The corner moves horizontally and vertically at once, and r has both "
     "parts: one alone, or the sum of both, is not how far.",
     "800 * (L - 1) * x", "800 * (L - 1) * y", "800 * (L - 1) * (x + y)",
     ("np.hypot(x, y)", "x"), ("np.hypot(x, y)", "y")),
    ("the way back", "That is how correction moves the pixel: from where it is seen to where it "
     "belongs. Asked is what the lens does.",
     "800 * (np.hypot(*_undone(x, y)) - r)"),
    ("where the corner is seen", "That is where something is seen, not by how much it has moved.",
     "800 * r * L", "319.5 * (1 - L)", "239.5 * (1 - L)"),
    ("half of it, or twice",
     "That is half of the shift, or twice the shift: how many pixels is r, and how many L r?",
     "400 * (L - 1) * r", "1600 * (L - 1) * r"),
    ("not in pixels", "That is the length on the plane z = 1: α turns it into pixels.",
     "(L - 1) * r", {"same": within(0.003)}),
    ("a factor for a length", "That is a factor, L or L − 1; the shift is a length.",
     "L - 1", "L", "1 - L", {"same": within(0.003)}),
    ("distance of the corner",
     "That is how far the corner is from the principal point without a lens.",
     "800 * r", {"same": within(0.6)}),
    ("not exact enough", "Nearly: one decimal is asked. Do not round r or L before the end.",
     "800 * (L - 1) * r + 0.3", "800 * (L - 1) * r - 0.3", {"seen": _nearly}),
)  # fmt: skip


EXERCISE = Exercise(
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
    misconceptions=MISTAKES,
    reference=corner_shift,
    same=within(0.06),
    concepts=("30", "31", "33"),
    answer="value",
)
