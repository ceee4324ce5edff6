"""Read it off: where do the rails meet."""

import numpy as np

from cvnotes.errors import Array
from cvnotes.learn.equality import within
from cvnotes.learn.exercise import Case, Exercise, Misconception, Property
from cvnotes.learn.pictures import rails_camera


def where_the_rails_meet() -> Array:
    """Give the pixel (2,) in which the rails meet: the vanishing point of z."""
    return rails_camera().vanishing_point([0, 0, 1])


def _mistaken(change: tuple[float, float], offset: tuple[float, float]) -> Array:
    return np.array(change) * where_the_rails_meet() + offset


RAILS = Exercise(
    name="where_the_rails_meet",
    chapter=2,
    title="Read it off: where do the rails meet?",
    task="Look at rails_picture(), which has 640 × 480 pixels. At which "
    "pixel (u, v) do the rails meet? To within 12 pixels is good enough.",
    stub="my_where_the_rails_meet = ...  # (u, v)",
    hints=(
        "u counts columns from the left, v rows from the top.",
        "They meet on the horizon. Lay a ruler along both rails.",
        "Draw the picture with a grid, or compute it: rails_camera().vanishing_point([0, 0, 1]).",
    ),
    cases=lambda _: [Case(())],
    properties=(Property("It is the pixel in which the rails meet, to within 12 pixels."),),
    misconceptions=(
        Misconception(
            "v before u",
            "You gave row before column: pixels are (u, v).",
            lambda: where_the_rails_meet()[::-1],
        ),
        Misconception(
            "the middle of the picture",
            "That is the middle of the picture. Rails end there only if the camera looks exactly "
            "along them.",
            lambda: np.array([319.5, 239.5]),
        ),
        Misconception(
            "v counted from below",
            "v counts from the top of the picture downwards.",
            lambda: _mistaken((1, -1), (0, 479)),
        ),
        Misconception(
            "u counted from the right",
            "u counts from the left.",
            lambda: _mistaken((-1, 1), (639, 0)),
        ),
        Misconception(
            "measured from the middle",
            "You measured from the middle of the picture; pixel (0, 0) is at its top left.",
            lambda: _mistaken((1, 1), (-319.5, -239.5)),
        ),
        Misconception(
            "on the middle column",
            "The height of the horizon is right; but the camera is turned sideways, so that the "
            "rails do not end in the middle column.",
            lambda: _mistaken((0, 1), (319.5, 0)),
        ),
    ),
    reference=where_the_rails_meet,
    same=within(12.0),
    concepts=("1", "13", "14"),
    answer="value",
    sources=(rails_camera, where_the_rails_meet),
)
