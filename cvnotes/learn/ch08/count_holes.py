"""Holes in a forward warp."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import pixel_centres, rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in


def _landings(rng: np.random.Generator) -> list[Case]:
    by_hand = np.array([
        [0.2, 0.1], [0.9, 0.0], [1.1, 0.2], [2.6, 0.3], [3.7, 1.2], [0.8, 1.1], [4.2, 0.8],
        [-0.7, 1.4], [1.2, -0.8], [1.4, 0.4], [0.6, 0.7], [4.8, 0.9], [2.1, -1.6],
    ])  # fmt: skip
    grid, size = pixel_centres((8, 6)) * 1.3 - 1.0, (10, 7)
    first = Case((by_hand, (4, 2)))
    while True:  # no two mistakes give the same numbers, nor does one give the right ones
        moved = rounded(grid + rng.uniform(-0.9, 0.9, grid.shape))
        moved[np.abs(moved % 1 - 0.5) < 0.02] += 0.05
        ways = (count_holes, *_wrong_counts())
        counts = {(gives(*first.args), gives(moved, size)) for gives in ways}
        if len(counts) == len(ways):
            return [first, Case((moved, size))]


def _wrong_counts() -> Iterator[Callable[[Array, tuple[int, int]], Any]]:
    for mistake in _MISTAKES:
        yield from (mistake.gives, *mistake.variants)


def count_holes(m: Array, size: tuple[int, int]) -> float:
    """Count the target pixels that receive no source pixel."""
    width, height = size
    pixels = np.rint(m)  # the nearest pixels
    inside = (pixels >= 0).all(axis=1) & (pixels < size).all(axis=1)  # which the target has
    hit = np.unique(pixels[inside], axis=0)  # the pixels that are hit, each once
    return width * height - len(hit)


_MISTAKES = mistakes_in(count_holes,
    ("pixels hit", "That is how many pixels are coloured, or how many positions land inside; the "
     "holes are the other pixels.",
     "len(hit)", "inside.sum()"),
    ("folds not considered", "You subtracted the number of source pixels that land inside. Several "
     "of them may land on one pixel (a fold), which is then coloured once.",
     "width * height - inside.sum()"),
    ("folds counted", "So many land where another one has landed: folds, not holes.",
     "inside.sum() - len(hit)"),
    ("another rounding", "You cut the decimals off, or rounded upwards: is that the nearest pixel?",
     ("np.rint(m)", "np.floor(m)"), ("np.rint(m)", "np.ceil(m)")),
    ("positions outside counted", "You counted positions outside: they colour no pixel.",
     ("pixels[inside]", "pixels")),
    ("n subtracted", "Some source pixels land outside, and some on the same pixel.",
     "width * height - len(m)"),
    ("size exchanged", "size is (width, height): with which of both does u go?",
     ("< size", "< (height, width)")),
    ("negative indices that wrap", "A negative index does not fail in Python: it counts from the "
     "end, and colours the other side. Is each position inside at the left and above as well?",
     ("(pixels >= 0)", "(pixels >= -np.array(size))", "pixels[inside]", "pixels[inside] % size")),
    ("tested before rounding", "You asked whether a position is inside before rounding: −0.4 is "
     "rounded to pixel 0, and colours it.",
     ("(pixels >= 0)", "(m >= 0)", "pixels < size", "m <= np.array(size) - 1"),
     ("(pixels >= 0)", "(m >= 0)")),
    ("columns and rows one by one", "You counted columns and rows that are hit, one by one: a "
     "pixel is hit if one position has both.",
     "width * height - np.prod([len(np.unique(x)) for x in hit.T])"),
    ("border repeated", "You moved positions outside to the border; they colour nothing.",
     ("pixels[inside]", "np.clip(pixels, 0, np.array(size) - 1)")),
    ("pixel 0 left out", "Row 0 and column 0 are inside too.",
     (">= 0", "> 0")),
)  # fmt: skip

EXERCISE = Exercise(
    name="count_holes",
    chapter=8,
    title="Holes in a forward warp",
    task="A forward warp sends source pixels to positions m (n, 2) in the target, where each "
    "colours the nearest pixel. Count the pixels of the target, of size (width, height), that "
    "stay empty. Positions outside of the target colour nothing.",
    hints=(
        "Round both coordinates first, then keep pixels of the target: −0.4 is rounded to pixel 0, "
        "which is inside. (No position lies halfway between two pixels.)",
        "Make an array of zeros, shape (height, width), and set the pixels that are hit to 1.",
        "Several may hit the same pixel: count what is still 0 at the end.",
    ),
    cases=_landings,
    properties=(Property("It is the number of target pixels that none is nearest to."),),
    misconceptions=_MISTAKES,
    steps=count_holes,
    concepts=("71", "72"),
)
