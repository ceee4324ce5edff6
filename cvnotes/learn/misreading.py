"""The mistakes that are made when a pixel is read off a picture."""

from collections.abc import Callable

import numpy as np

from cvnotes.errors import Array
from cvnotes.learn.exercise import Misconception


def misreadings(pixel: Callable[[], Array], size: tuple[int, int]) -> tuple[Misconception, ...]:
    """Give what comes out if a pixel (2,) of a picture of size (width, height) is misread.

    Examples
    --------
    >>> slips = misreadings(lambda: np.array([600.0, 20.0]), (640, 480))
    >>> {slip.name: slip.gives().tolist() for slip in slips}["v counted from below"]
    [600.0, 459.0]
    """
    last = np.array(size) - 1.0
    return (
        Misconception(
            "v before u",
            "You gave row before column: pixels are (u, v).",
            lambda: pixel()[::-1],
        ),
        Misconception(
            "v counted from below",
            "v counts from the top of the picture downwards.",
            lambda: np.array([pixel()[0], last[1] - pixel()[1]]),
        ),
        Misconception(
            "u counted from the right",
            "u counts from the left.",
            lambda: np.array([last[0] - pixel()[0], pixel()[1]]),
        ),
        Misconception(
            "measured from the middle",
            "You measured from the middle of the picture; pixel (0, 0) is at its top left.",
            lambda: pixel() - last / 2,
        ),
    )
