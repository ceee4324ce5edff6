"""Read it off: where do the rails meet."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.pictures import rails_camera
from cvnotes.learn.cases.slips import misreadings
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import within


def where_the_rails_meet() -> Array:
    """Return the pixel (2,) in which the rails meet: the vanishing point of z."""
    u, v = rails_camera().vanishing_point([0, 0, 1])
    return np.array([u, v])


def _rail(side: int, v: float = 479.0) -> Array:
    """Return the pixel in which the rail on one side, −1 or 1, leaves the picture: below, at v."""
    end, near = where_the_rails_meet(), rails_camera().project([750.0 * side, 1600.0, 9000.0])
    return np.asarray(end + (near - end) * (v - end[1]) / (near[1] - end[1]))


_MISTAKES = (
    *mistakes_in(where_the_rails_meet,
        ("the picture of chapter 1", "That is where the rails meet in the picture of chapter 1, by "
         "the course's camera, which looks along them. Look at rails_picture().",
         "np.array([325.0, 238.0])", {"same": within(2.0)}),
        ("the middle of the picture", "That is the middle of the picture. Rails end there only if "
         "the camera looks exactly along them.",
         "np.array([319.5, 239.5])"),
        ("v without its sign", "So far from the picture's upper edge they meet, but above it: v "
         "counts downwards from there.",
         "np.array([u, -v])"),
        ("on the middle row", "The column is right. The camera is lowered: where is the horizon?",
         "np.array([u, 239.5])"),
        ("where they leave the picture", "There the rails leave the picture above, and are still "
         "apart: they meet beyond its upper edge.",
         "_rail(-1, 0)", "_rail(1, 0)", "(_rail(-1, 0) + _rail(1, 0)) / 2"),
        ("where the rails begin", "That is where a rail leaves the picture below, or the middle "
         "between both: the rails meet at their other end.",
         "_rail(-1)", "_rail(1)", "(_rail(-1) + _rail(1)) / 2"),
        ("on the middle column", "The height of the horizon is right; but the camera is turned "
         "sideways, so that the rails do not end in the middle column.",
         "np.array([319.5, v])"),
    ),
    *misreadings(where_the_rails_meet, (640, 480), 12.0),
)  # fmt: skip

EXERCISE = Exercise(
    name="where_the_rails_meet",
    chapter=2,
    title="Read it off: where do the rails meet?",
    task="Look at rails_picture(), which has 640 × 480 pixels. At which "
    "pixel (u, v), above the picture, do the rails meet? To within 12 pixels is good enough.",
    stub="my_where_the_rails_meet = ...  # (u, v)",
    hints=(
        "u counts columns from the left, v rows from the top, in pixels of the picture as the axes "
        "of imshow show them, not in those of your screen.",
        "They meet on the horizon, above the picture: v is negative. Read two points on each rail.",
        "The line through two points is their cross product, and so is the point of two lines: "
        "chapter 1.",
    ),
    cases=lambda _: [Case(())],
    properties=(Property("It is the pixel in which the rails meet, to within 12 pixels."),),
    misconceptions=_MISTAKES,
    reference=where_the_rails_meet,
    same=within(12.0),
    concepts=("1", "13", "14"),
    answer="value",
    sources=(rails_camera, where_the_rails_meet),
)
