"""Read it off: how far away is the block."""

from functools import cache

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.pictures import nearest_edge, stereo_cameras
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.tutor.checker.equality import within_part


def how_far() -> float:
    """Return the depth in millimetres of the block's nearest edge."""
    left, right = (camera.project(nearest_edge())[0] for camera in stereo_cameras())
    d = left - right
    return float(640 * 800 / d)


@cache
def _edges() -> Array:
    """Return the depths of the upright edges: four of the red block, then those of the others."""
    from cvnotes.pictures import blocks

    tops = blocks().vertices.reshape(-1, 4, 3)[:6].reshape(-1, 3)
    upper = tops[tops[:, 1] < 1000]
    return np.asarray(stereo_cameras()[0].depth(upper))


def _of_an_edge(answer: Array, _: Case) -> bool:
    """Return whether a depth is that of something else in the picture."""
    return bool(9500 < answer < 25_000)


def _nearly(answer: Array, case: Case) -> bool:
    return bool(abs(answer - case.right) < 0.2 * case.right)


_MISTAKES = mistakes_in(how_far,
    ("in another unit", "Right, in metres or in centimetres; asked are millimetres.",
     "0.64 * 800 / d", "64 * 800 / d"),
    ("α or b left out", "Asked are mm: how long is the baseline, and what else is in pixels?",
     "640 / d", "800 / d"),
    ("half-way", "That is the disparity, or α b. Which depth goes with both?",
     "d", "640 * 800"),
    ("one picture only", "You took the column of one picture, or added both. One picture knows no "
     "depths: what differs between the two?",
     *(f"640 * 800 / {other}" for other in ("(left - 319.5)", "left", "right", "(left + right)"))),
    ("sign of the disparity", "A negative depth? In which picture is the edge further right?",
     "640 * 800 / -d"),
    ("half the baseline", "You measured from the middle between the cameras; the full baseline "
     "goes with the full disparity.",
     "640 * 400 / d"),
    ("upside down", "Your fraction is upside down: larger disparities mean nearer points.",
     "d * 800 / 640", "d * 640 / 800", "d / 640 / 800", "d * 640 * 800", "800 / (640 * d)",
     "640 / (800 * d)"),
    ("another edge of the red block", "That is an edge of the red block, but not the nearest "
     "one: where do its light and its dark side meet?",
     "_edges()[0]", "_edges()[3]", "_edges()[2]", {"same": within_part(0.011)}),
    ("an edge of another block", "That is an edge of one of the lower blocks.",
     *(f"_edges()[{i}]" for i in (8, 5, 6, 7, 10)), {"same": within_part(0.011)}),
    ("twice the baseline", "You took the baseline twice: the cameras are 800 mm apart.",
     "640 * 1600 / d", {"same": within_part(0.011)}),
    ("columns not exact enough", "That is near: each pixel of the disparity counts 2 %. Enlarge "
     "both pictures, and read the edge at the same height.",
     "1.1 * 640 * 800 / d", {"seen": _nearly}),
    ("something else in the picture", "That is the depth of something else, or one of the columns "
     "is: the edge must be the same in both pictures.",
     "1.9 * 640 * 800 / d", {"seen": _of_an_edge}),
)  # fmt: skip

EXERCISE = Exercise(
    name="how_far",
    chapter=10,
    title="Read it off: how far away is the block?",
    task="Look at stereo_pictures(), a left and a right picture by two cameras side by side: both "
    "have α = 640 pixels and look the same way, and the right one stands 800 mm to the right. How "
    "many millimetres away is the nearest upright edge of the red block? To within 6 % is good "
    "enough.",
    stub="my_how_far = ...  # mm",
    hints=(
        "It is the edge at which the light and the dark side of the red block meet.",
        "In which column is it in the left picture, in which in the right one? Columns are those "
        "of the pictures, as the axes of imshow count them, not of your screen.",
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
