"""Depth from two pictures."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, pose
from cvnotes.learn.cases.cameras import rounded
from cvnotes.stereo import disparity_to_depth
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes
from cvnotes.tutor.checker.steps import edited


def depth(alpha: float, b: float, u_left: Array, u_right: Array) -> Array:
    """Return the depths (n,) from columns in the rectified left and right pictures."""
    left = Camera(intrinsics(alpha, alpha, 0, 0))
    right = left.moved(pose(np.eye(3), [-b, 0, 0]))
    return disparity_to_depth(u_left - u_right, left, right)


def _columns(rng: Rng) -> list[Case]:
    Z = rng.uniform(400, 3000, 5)
    u = rounded(rng.uniform(200, 600, 5), 1)
    return [
        Case((500.0, 100.0, np.array([300.0, 320.0]), np.array([250.0, 220.0]))),
        Case((800.0, 120.0, u, rounded(u - 800 * 120 / Z, 1))),
        Case((500.0, 100.0, np.array([300.0]), np.array([300.0])), about="infinity"),
        # far away, and no infinity yet
        Case((250.0, 100.0, np.array([300.0, 301.5]), np.array([299.5, 300.0]))),
    ]


def _steps(alpha: float, b: float, u_left: Array, u_right: Array) -> Any:
    d = u_left - u_right  # the disparity
    return alpha * b / d


_MISTAKES = mistakes(
    ("0 for infinity", "Right, except where the disparity is 0: you gave the depth 0, which is at "
     "the camera itself. The task asks for np.inf.",
     lambda alpha, b, left, right: np.where(left == right, 0, depth(alpha, b, left, right))),
    ("no answer at infinity", "Right, except where the disparity is 0 and you have no answer: how "
     "far is such a point?",
     lambda alpha, b, left, right: (
         depth(alpha, b, left, right) if (left != right).all() else None)),
    ("infinity too early", "Right, except for points far away: a small disparity is no zero, it "
     "means a large depth.",
     lambda alpha, b, left, right: np.where(left - right < 2, np.inf,
                                            depth(alpha, b, left, right)),
     lambda alpha, b, left, right: np.where(left - right <= 1, np.inf,
                                            depth(alpha, b, left, right))),
    ("distance in pixels", "That is the disparity; which depth goes with it?",
     lambda alpha, b, left, right: left - right, lambda alpha, b, left, right: right - left),
    ("one picture only", "You divided by the column of one picture: what differs between the two?",
     edited(_steps, "u_left - u_right", "u_left"), edited(_steps, "u_left - u_right", "u_right")),
    ("one pixel off", "Your disparity is one pixel off.",
     edited(_steps, "u_left - u_right", "u_left - u_right + 1"),
     edited(_steps, "u_left - u_right", "u_left - u_right - 1")),
    ("proportional to the disparity", "Your depth grows with the disparity, or does not depend on "
     "it: which points have large disparities?",
     edited(_steps, "/ d", "* d"), edited(_steps, "/ d", "+ 0 * d"),
     edited(_steps, "alpha * b / d", "d * b / alpha")),
    ("square of the disparity", "Depth falls with the disparity itself, not with its square.",
     edited(_steps, "/ d", "/ d**2")),
    ("half the baseline", "You measured from the middle between the cameras; the full baseline "
     "goes with the full disparity.",
     edited(_steps, "b / d", "b / 2 / d")),
    ("in metres", "Right, in metres; asked are millimetres.",
     edited(_steps, "b / d", "b / d / 1000")),
)  # fmt: skip

DEPTH = Exercise(
    name="depth",
    chapter=8,
    title="Depth from two pictures",
    task="Two rectified cameras with the focal length alpha, in pixels, stand b millimetres "
    "apart. Give the depth (n,) in millimetres of points seen in columns u_left and u_right, "
    "shape (n,) each; np.inf where both columns are the same.",
    stub='''def my_depth(alpha, b, u_left, u_right):
    """Return the depths (n,) in millimetres."""
    ...''',
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
    reference=depth,
    steps=_steps,
    concepts=("70",),
    sources=(disparity_to_depth,),
)
