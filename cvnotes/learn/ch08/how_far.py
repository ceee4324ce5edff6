"""Read it off: how far away is the block."""

from functools import cache

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


@cache
def _disparity() -> float:
    return float(np.subtract(*_seen(nearest_edge())))


@cache
def _edges() -> Array:
    """Give the depths of the upright edges: four of the tall block, then those of the others."""
    from cvnotes.pictures import blocks

    tops = blocks().vertices.reshape(-1, 4, 3)[:6].reshape(-1, 3)
    upper = tops[tops[:, 1] < 1000]
    return np.asarray(stereo_cameras()[0].depth(upper))


def _edge(i: int) -> float:
    return float(_edges()[i])


def _of_an_edge(answer: Array, _: Case) -> bool:
    """Tell whether a depth is that of something else in the picture."""
    return bool(9500 < answer < 25_000)


def _nearly(answer: Array, case: Case) -> bool:
    return bool(abs(answer - case.right) < 0.2 * case.right)


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
        "In which column is it in the left picture, in which in the right one? Columns are those "
        "of "
        "the pictures, as the axes of imshow count them, not of your screen.",
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
            lambda: _ALPHA / _disparity(),
        ),
        Misconception(
            "focal length left out",
            "b / d has the unit mm per pixel: multiply by α, which is in pixels.",
            lambda: _BASELINE / _disparity(),
        ),
        Misconception(
            "the disparity itself",
            "That is the disparity in pixels. The depth is α b divided by it.",
            lambda: _disparity(),
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
        Misconception(
            "another edge of the tall block",
            "That is an edge of the tall block, but not the nearest one: it is the one in the "
            "middle, where the light and the dark side meet.",
            lambda: _edge(0),
            variants=(
                lambda: _edge(3),
                lambda: _edge(2),
            ),
            same=within_part(0.011),
        ),
        Misconception(
            "an edge of another block",
            "That is an edge of one of the lower blocks.",
            lambda: _edge(8),
            variants=(
                lambda: _edge(5),
                lambda: _edge(6),
                lambda: _edge(7),
                lambda: _edge(10),
            ),
            same=within_part(0.011),
        ),
        Misconception(
            "the column for the disparity",
            "You divided by the column of one picture; the disparity is the difference of both.",
            lambda: _ALPHA * _BASELINE / _seen(nearest_edge())[0],
            variants=(lambda: _ALPHA * _BASELINE / _seen(nearest_edge())[1],),
        ),
        Misconception(
            "the right picture only",
            "You measured from the middle of the right picture. One picture knows no depths: take "
            "the difference of both columns.",
            lambda: _ALPHA * _BASELINE / (_seen(nearest_edge())[1] - _U0),
        ),
        Misconception(
            "upside down",
            "You turned the fraction around: larger disparities mean nearer points, Z = α b / d.",
            lambda: _disparity() * _BASELINE / _ALPHA,
            variants=(
                lambda: _disparity() * _ALPHA / _BASELINE,
                lambda: _disparity() / (_ALPHA * _BASELINE),
            ),
        ),
        Misconception(
            "proportional to the disparity",
            "You multiplied by the disparity: divide, Z = α b / d.",
            lambda: _ALPHA * _BASELINE * _disparity(),
        ),
        Misconception(
            "α and b divided",
            "You divided α by b, or b by α: Z = α b / d.",
            lambda: _BASELINE / (_ALPHA * _disparity()),
            variants=(lambda: _ALPHA / (_BASELINE * _disparity()),),
        ),
        Misconception(
            "twice the baseline",
            "You took the baseline twice: the cameras are 800 mm apart.",
            lambda: 2 * how_far(),
            same=within_part(0.011),
        ),
        Misconception(
            "α b",
            "That is α b; divide it by the disparity.",
            lambda: _ALPHA * _BASELINE,
        ),
        Misconception(
            "columns not exact enough",
            "That is near: each pixel of the disparity counts 2 %. Enlarge both pictures, and "
            "read the edge at the same height.",
            lambda: 1.1 * how_far(),
            seen=_nearly,
        ),
        Misconception(
            "something else in the picture",
            "That is the depth of something else, or one of the columns is: the edge must be the "
            "same in both pictures.",
            lambda: 1.9 * how_far(),
            seen=_of_an_edge,
        ),
    ),
    reference=how_far,
    same=within_part(0.06),
    concepts=("38", "70"),
    answer="value",
    sources=(stereo_cameras, how_far),
)
