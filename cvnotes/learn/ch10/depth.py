"""Depth from two pictures."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import rounded
from cvnotes.stereo import disparity_to_depth
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _columns(rng: np.random.Generator) -> list[Case]:
    Z = rng.uniform(400, 3000, 5)
    u = rounded(rng.uniform(200, 600, 5), 1)
    return [
        Case((500.0, 100.0, np.array([300.0, 320.0]), np.array([250.0, 220.0]))),
        Case((800.0, 120.0, u, rounded(u - 800 * 120 / Z, 1))),
        Case((500.0, 100.0, np.array([300.0]), np.array([300.0])), about="infinity"),
        # far away, and no infinity yet
        Case((250.0, 100.0, np.array([300.0, 301.5]), np.array([299.5, 300.0]))),
    ]


def depth(alpha: float, b: float, u_left: Array, u_right: Array) -> Array:
    """Return the depths (n,) in millimetres."""
    d = u_left - u_right  # the disparity
    return alpha * b / d


_MISTAKES = mistakes_in(depth,
    ("no answer at infinity", "Right, but without disparity you have no answer: how far is that?",
     "alpha * b / d if d.all() else None"),
    ("infinity too early", "Right, but not far away: a small disparity is not 0.",
     "np.where(d < 2, np.inf, alpha * b / d)", "np.where(d <= 1, np.inf, alpha * b / d)"),
    ("one picture only", "You divided by the column of one picture: what differs between the two?",
     ("u_left - u_right", "u_left"), ("u_left - u_right", "u_right")),
    ("one pixel off", "Your disparity is one pixel off.",
     ("u_left - u_right", "u_left - u_right + 1"), ("u_left - u_right", "u_left - u_right - 1")),
    ("proportional to the disparity", "Your depth grows with the disparity, or does not depend on "
     "it: which points have large disparities?",
     ("/ d", "* d"), ("/ d", "+ 0 * d"), "d * b / alpha", "-d"),
    ("square of the disparity", "Depth falls with the disparity itself, not with its square.",
     ("/ d", "/ d**2")),
    ("half the baseline", "You measured from the middle between the cameras; the full baseline "
     "goes with the full disparity.",
     ("b / d", "b / 2 / d")),
    ("in metres", "Right, in metres; asked are millimetres.",
     ("b / d", "b / d / 1000")),
)  # fmt: skip

EXERCISE = Exercise(
    name="depth",
    chapter=10,
    title="Depth from two pictures",
    task="Two rectified cameras with the focal length alpha, in pixels, stand b millimetres "
    "apart. Give the depth (n,) in millimetres of points seen in columns u_left and u_right, "
    "shape (n,) each; np.inf where both columns are the same.",
    hints=(
        "The disparity d = u_left − u_right is never negative: nearer points lie more to the left "
        "in the right picture.",
        "Similar triangles: d / alpha = b / Z.",
        "With NumPy arrays x / 0 is inf, by itself.",
    ),
    cases=_columns,
    properties=(
        Property("Near points have large disparities: Z d = α b."),
        Property("Without disparity a point is infinitely far.", about="infinity"),
    ),
    misconceptions=_MISTAKES,
    steps=depth,
    concepts=("70", "j"),
    sources=(disparity_to_depth,),
)
