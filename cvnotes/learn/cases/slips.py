"""Slips that several exercises share, in reading a pixel off a picture."""

from collections.abc import Callable

import numpy as np

from cvnotes.base import Array
from cvnotes.tutor.checker.exercise import Misconception, mistakes


def misreadings(
    pixel: Callable[[], Array], size: tuple[int, int], near: float
) -> tuple[Misconception, ...]:
    """Return what comes out if a pixel (2,) of a picture of size (width, height) is misread.

    What is nearer than `near` to the pixel is right. The last ones are general: they go behind the
    exercise's own.

    Examples
    --------
    >>> slips = misreadings(lambda: np.array([600.0, 20.0]), (640, 480), 5.0)
    >>> {slip.name: slip.gives().tolist() for slip in slips}["counted from elsewhere"]
    [600.0, 459.0]
    """
    last = np.array(size) - 1.0
    return mistakes(
        ("v before u", "You gave row before column: pixels are (u, v).", lambda: pixel()[::-1]),
        ("counted from elsewhere", "u counts from the left and v from the top downwards: pixel "
         "(0, 0) is at the top left of the picture.",
         lambda: np.array([pixel()[0], last[1] - pixel()[1]]),
         lambda: np.array([last[0] - pixel()[0], pixel()[1]]), lambda: pixel() - last / 2),
        ("read on another scale", "Both numbers are too large, or too small, by one factor: count "
         "pixels of the picture, as the axes of imshow do, not those of your screen.",
         lambda: 1.5 * pixel(), lambda: 2 * pixel(), lambda: pixel() / 2,
         {"seen": lambda answer, _: _on_another_scale(answer, pixel(), near)}),
        ("the column alone", "The column u is right; look at the row v again.",
         lambda: pixel() - [0.0, 7 * near],
         {"seen": lambda answer, _: bool(abs(answer[0] - pixel()[0]) < near)}),
        ("the row alone", "The row v is right; look at the column u again.",
         lambda: pixel() - [7 * near, 0.0],
         {"seen": lambda answer, _: bool(abs(answer[1] - pixel()[1]) < near)}),
        ("near, not near enough", "That is near, and not yet near enough: enlarge the picture.",
         lambda: pixel() + 1.5 * near,
         {"seen": lambda answer, _: bool(np.linalg.norm(answer - pixel()) < 4 * near)}),
    )  # fmt: skip


def _on_another_scale(answer: Array, pixel: Array, near: float) -> bool:
    """Return whether a pixel was read in a picture that was shown larger or smaller."""
    scale = float(answer @ pixel / (pixel @ pixel))
    return (
        0.2 < scale < 6
        and abs(scale - 1) > 0.15
        and bool(np.linalg.norm(answer / scale - pixel) < near / 2)
    )
