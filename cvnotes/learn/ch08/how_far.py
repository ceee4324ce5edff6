"""Read it off: how far away is the block."""

from functools import cache

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.pictures import nearest_edge, stereo_cameras
from cvnotes.tutor.checker.equality import within_part
from cvnotes.tutor.checker.exercise import Case, Exercise, Misconception, Property, mistakes


def how_far() -> float:
    """Return the depth in millimetres of the block's nearest edge."""
    return float(stereo_cameras()[0].depth(nearest_edge()))


def _seen(W: Array) -> tuple[float, float]:
    """Return the columns of a point in both pictures."""
    left, right = (camera.project(W)[0] for camera in stereo_cameras())
    return left, right


_ALPHA, _BASELINE, _U0 = 640.0, 800.0, 319.5


@cache
def _disparity() -> float:
    return float(np.subtract(*_seen(nearest_edge())))


@cache
def _edges() -> Array:
    """Return the depths of the upright edges: four of the tall block, then those of the others."""
    from cvnotes.pictures import blocks

    tops = blocks().vertices.reshape(-1, 4, 3)[:6].reshape(-1, 3)
    upper = tops[tops[:, 1] < 1000]
    return np.asarray(stereo_cameras()[0].depth(upper))


def _edge(i: int) -> float:
    return float(_edges()[i])


def _of_an_edge(answer: Array, _: Case) -> bool:
    """Return whether a depth is that of something else in the picture."""
    return bool(9500 < answer < 25_000)


def _nearly(answer: Array, case: Case) -> bool:
    return bool(abs(answer - case.right) < 0.2 * case.right)


_AB = _ALPHA * _BASELINE
_MISTAKES = (
    *mistakes(
        ("in another unit", "Right, in metres or in centimetres; asked are millimetres.",
         lambda: how_far() / 1000, lambda: how_far() / 10),
        ("α or b left out", "Which unit has that? It is to be mm: how long is the baseline, and "
         "what else is in pixels?",
         lambda: _ALPHA / _disparity(), lambda: _BASELINE / _disparity()),
        ("half-way", "That is the disparity, or α b. Which depth goes with both?",
         lambda: _disparity(), lambda: _AB),
        ("one picture only", "You took the column of one picture, or added both. One picture "
         "knows no depths: what differs between the two?",
         lambda: _AB / (_seen(nearest_edge())[0] - _U0), lambda: _AB / _seen(nearest_edge())[0],
         lambda: _AB / _seen(nearest_edge())[1], lambda: _AB / sum(_seen(nearest_edge()))),
        ("sign of the disparity", "Your depth is negative: in which picture is the edge further to "
         "the right?",
         lambda: -how_far()),
        ("half the baseline", "You measured from the middle between the cameras; the full baseline "
         "goes with the full disparity.",
         lambda: how_far() / 2),
        ("upside down", "Your fraction is upside down: larger disparities mean nearer points.",
         lambda: _disparity() * _BASELINE / _ALPHA, lambda: _disparity() * _ALPHA / _BASELINE,
         lambda: _disparity() / _AB, lambda: _AB * _disparity(),
         lambda: _BASELINE / (_ALPHA * _disparity()), lambda: _ALPHA / (_BASELINE * _disparity())),
    ),
    Misconception(
        "another edge of the tall block",
        "That is an edge of the tall block, but not the nearest one: where do its light and its "
        "dark side meet?",
        lambda: _edge(0), (lambda: _edge(3), lambda: _edge(2)), within_part(0.011),
    ),
    Misconception(
        "an edge of another block", "That is an edge of one of the lower blocks.",
        lambda: _edge(8), tuple(lambda i=i: _edge(i) for i in (5, 6, 7, 10)), within_part(0.011),
    ),
    Misconception(
        "twice the baseline", "You took the baseline twice: the cameras are 800 mm apart.",
        lambda: 2 * how_far(), (), within_part(0.011),
    ),
    Misconception(
        "columns not exact enough", "That is near: each pixel of the disparity counts 2 %. Enlarge "
        "both pictures, and read the edge at the same height.",
        lambda: 1.1 * how_far(), seen=_nearly,
    ),
    Misconception(
        "something else in the picture", "That is the depth of something else, or one of the "
        "columns is: the edge must be the same in both pictures.",
        lambda: 1.9 * how_far(), seen=_of_an_edge,
    ),
)  # fmt: skip

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
    misconceptions=_MISTAKES,
    reference=how_far,
    same=within_part(0.06),
    concepts=("38", "70"),
    answer="value",
    sources=(stereo_cameras, how_far),
)
