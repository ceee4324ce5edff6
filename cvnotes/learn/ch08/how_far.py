"""Read it off: how far away is the block."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.pictures import nearest_edge, stereo_cameras
from cvnotes.learn.checker.equality import within_part
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property


def how_far() -> float:
    """Give the depth in millimetres of the block's nearest edge."""
    return float(stereo_cameras()[0].depth(nearest_edge()))


def _seen(W: Array) -> tuple[float, float]:
    """Give the columns of a point in both pictures."""
    left, right = (camera.project(W)[0] for camera in stereo_cameras())
    return left, right


_ALPHA, _BASELINE, _U0 = 640.0, 800.0, 319.5
_D = float(np.subtract(*_seen(nearest_edge())))


FAR = Exercise(
    name="how_far",
    chapter=8,
    title="Read it off: how far away is the block?",
    task="Look at stereo_pictures(), a left and a right picture by two cameras side by side: both "
    "have α = 640 pixels and look the same way, and the right one stands 800 mm to the right. How "
    "many millimetres away is the nearest upright edge of the tall block? To within 6 % is good "
    "enough, which is three pixels.",
    stub="my_how_far = ...  # mm",
    hints=(
        "It is the edge at which the light and the dark side of the tall block meet.",
        "In which column is it in the left picture, in which in the right one?",
        "The difference of the two columns is the disparity d, and Z = α b / d.",
    ),
    cases=lambda _: [Case(())],
    properties=(Property("It is the depth of that edge, to within 6 %."),),
    misconceptions=(
        Misconception(
            "in metres",
            "Right, in metres; asked are millimetres.",
            lambda: how_far() / 1000,
        ),
        Misconception(
            "baseline left out",
            "α / d is the depth in baselines: multiply by 800 mm.",
            lambda: _ALPHA / _D,
        ),
        Misconception(
            "focal length left out",
            "b / d has the unit mm per pixel: multiply by α, which is in pixels.",
            lambda: _BASELINE / _D,
        ),
        Misconception(
            "the disparity itself",
            "That is the disparity in pixels. The depth is α b divided by it.",
            lambda: _D,
        ),
        Misconception(
            "one picture only",
            "You measured from the middle of the left picture. One picture knows no depths: take "
            "the difference of both columns.",
            lambda: _ALPHA * _BASELINE / (_seen(nearest_edge())[0] - _U0),
        ),
        Misconception(
            "sum of the columns",
            "You added the two columns; the disparity is their difference.",
            lambda: _ALPHA * _BASELINE / sum(_seen(nearest_edge())),
        ),
        Misconception(
            "half the baseline",
            (
                "You measured from the middle between the cameras; the full baseline goes with "
                "the full disparity."
            ),
            lambda: how_far() / 2,
        ),
        Misconception(
            "in centimetres",
            "Right, in centimetres; asked are millimetres.",
            lambda: how_far() / 10,
        ),
        Misconception(
            "sign of the disparity",
            (
                "Your depth is negative: the disparity is the column on the left minus that on "
                "the right."
            ),
            lambda: -how_far(),
        ),
    ),
    reference=how_far,
    same=within_part(0.06),
    concepts=("38", "70"),
    answer="value",
    sources=(stereo_cameras, how_far),
)
