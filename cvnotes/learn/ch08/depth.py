"""Depth from two pictures."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.camera import Camera, intrinsics, pose
from cvnotes.learn.cases.cameras import rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.stereo import disparity_to_depth


def depth(alpha: float, b: float, u_left: Array, u_right: Array) -> Array:
    """Give the depths (n,) from columns in the rectified left and right pictures."""
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
    ]


DEPTH = Exercise(
    name="depth",
    chapter=8,
    title="Depth from two pictures",
    task="Two rectified cameras with the focal length alpha, in pixels, stand b millimetres "
    "apart. Give the depth (n,) in millimetres of points seen in columns u_left and u_right, "
    "shape (n,) each; np.inf where both columns are the same.",
    stub='''def my_depth(alpha, b, u_left, u_right):
    """Give the depths (n,) in millimetres."""
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
    misconceptions=(
        Misconception(
            "sign of the disparity",
            "Your depths are negative: d = u_left − u_right.",
            lambda alpha, b, left, right: alpha * b / (right - left),
        ),
        Misconception(
            "upside down",
            "You gave d / (α b): larger disparities mean nearer points, Z = α b / d.",
            lambda alpha, b, left, right: (left - right) / (alpha * b),
        ),
        Misconception(
            "focal length left out",
            "b / d has no unit of length yet: the disparity is in pixels, and so is α.",
            lambda alpha, b, left, right: b / (left - right),
        ),
        Misconception(
            "baseline left out",
            "α / d is the depth in baselines: multiply by b.",
            lambda alpha, b, left, right: alpha / (left - right),
        ),
        Misconception(
            "half the baseline",
            "You measured from the middle between the cameras; the full baseline goes with the "
            "full disparity.",
            lambda alpha, b, left, right: alpha * b / 2 / (left - right),
        ),
        Misconception(
            "proportional to the disparity",
            "You have α b d: depth falls with the disparity.",
            lambda alpha, b, left, right: alpha * b * (left - right),
        ),
        Misconception(
            "0 for infinity",
            (
                "Right, except where the disparity is 0: you gave the depth 0, which is at the "
                "camera itself. The task asks for np.inf."
            ),
            lambda alpha, b, left, right: np.where(
                left == right, 0.0, depth(alpha, b, left, right)
            ),
        ),
        Misconception(
            "no answer at infinity",
            (
                "Right, except where the disparity is 0 and you have no answer: the point is "
                "infinitely far, np.inf."
            ),
            lambda alpha, b, left, right: (
                depth(alpha, b, left, right) if (left != right).all() else None
            ),
        ),
        Misconception(
            "sum of the columns",
            "You added the two columns; the disparity is their difference.",
            lambda alpha, b, left, right: alpha * b / (left + right),
        ),
        Misconception(
            "divided by the focal length",
            "You have b / (α d): Z = α b / d.",
            lambda alpha, b, left, right: b / (alpha * (left - right)),
        ),
        Misconception(
            "one picture only",
            (
                "You divided by the column of the left picture; the disparity is the difference "
                "of both."
            ),
            lambda alpha, b, left, right: alpha * b / left,
        ),
        Misconception(
            "in metres",
            "Right, in metres; asked are millimetres.",
            lambda alpha, b, left, right: alpha * b / (left - right) / 1000,
        ),
        Misconception(
            "twice the baseline",
            "You took the baseline twice.",
            lambda alpha, b, left, right: 2 * alpha * b / (left - right),
        ),
        Misconception(
            "distance in pixels",
            "That is the disparity; the depth is α b divided by it.",
            lambda alpha, b, left, right: left - right,
            variants=(lambda alpha, b, left, right: right - left,),
        ),
        Misconception(
            "a small number added",
            "You added a small number to the disparity so as not to divide by 0; np.inf is asked "
            "there, and NumPy gives it by itself.",
            lambda alpha, b, left, right: alpha * b / (left - right + 1e-9),
            variants=(
                lambda alpha, b, left, right: alpha * b / np.maximum(left - right, 1e-9),
                lambda alpha, b, left, right: alpha * b / (left - right + 1e-6),
                lambda alpha, b, left, right: alpha * b / (left - right + 1e-12),
            ),
        ),
        Misconception(
            "the other picture only",
            "You divided by the column of the right picture; the disparity is the difference of "
            "both.",
            lambda alpha, b, left, right: alpha * b / right,
        ),
        Misconception(
            "square of the disparity",
            "Depth falls with the disparity itself, not with its square.",
            lambda alpha, b, left, right: alpha * b / (left - right) ** 2,
        ),
        Misconception(
            "one depth for all",
            "You gave one depth for all points: each has its own.",
            lambda alpha, b, left, right: float(np.mean(alpha * b / (left - right))),
            variants=(lambda alpha, b, left, right: float(alpha * b / np.mean(left - right)),),
        ),
        Misconception(
            "α divided by b",
            "You divided the focal length by the baseline: Z = α b / d.",
            lambda alpha, b, left, right: alpha / (b * (left - right)),
        ),
        Misconception(
            "one pixel off",
            "You added 1 to the disparity, or subtracted it: d = u_left − u_right.",
            lambda alpha, b, left, right: alpha * b / (left - right + 1),
            variants=(lambda alpha, b, left, right: alpha * b / (left - right - 1),),
        ),
        Misconception(
            "points at infinity left out",
            "Right, but points at infinity are missing: np.inf in their place.",
            lambda alpha, b, left, right: (alpha * b / (left - right))[left != right],
        ),
    ),
    reference=depth,
    concepts=("70",),
    sources=(disparity_to_depth,),
)
