"""Holes in a forward warp."""

# A mistake is often an argument that was left out.

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import pixel_centres, rounded
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes
from cvnotes.tutor.checker.steps import edited


def count_holes(m: Array, size: tuple[int, int]) -> int:
    """Count the target pixels to which no source pixel is sent, m (n, 2) being where they land."""
    pixels = np.rint(m)
    inside = (pixels >= 0).all(axis=1) & (pixels < size).all(axis=1)
    return size[0] * size[1] - len(np.unique(pixels[inside], axis=0))


def _hit(m: Array, size: tuple[int, int], rounding: np.ufunc = np.rint) -> Array:
    """Return the target pixels (k, 2) that are hit, each once."""
    pixels = np.unique(rounding(m), axis=0)
    inside = (pixels >= 0).all(1) & (pixels < size).all(1)
    return np.asarray(pixels[inside])


def _landings(rng: Rng) -> list[Case]:
    by_hand = np.array(
        [
            [0.2, 0.1],
            [0.9, 0.0],
            [1.1, 0.2],
            [2.6, 0.3],
            [3.7, 1.2],
            [0.8, 1.1],
            [4.2, 0.8],
            [-0.7, 1.4],
            [1.2, -0.8],
            [1.4, 0.4],
            [0.6, 0.7],
            [4.8, 0.9],
            [2.1, -1.6],
        ]
    )
    grid, size = pixel_centres((8, 6)) * 1.3 - 1.0, (10, 7)
    first = Case((by_hand, (4, 2)))
    while True:  # no two mistakes give the same numbers, nor does one give the right ones
        moved = rounded(grid + rng.uniform(-0.9, 0.9, grid.shape))
        moved[np.abs(moved % 1 - 0.5) < 0.02] += 0.05
        ways = (_steps, *_wrong_counts())
        counts = {(gives(*first.args), gives(moved, size)) for gives in ways}
        if len(counts) == len(ways):
            return [first, Case((moved, size))]


def _wrong_counts() -> Iterator[Callable[[Array, tuple[int, int]], Any]]:
    for mistake in _MISTAKES:
        yield from (mistake.gives, *mistake.variants)


def _landed_inside(m: Array, size: tuple[int, int]) -> int:
    pixels = np.rint(m)
    return int(((pixels >= 0).all(1) & (pixels < size).all(1)).sum())


def _steps(m: Array, size: tuple[int, int]) -> Any:
    width, height = size
    pixels = np.rint(m)  # the nearest pixels
    inside = (pixels >= 0).all(axis=1) & (pixels < size).all(axis=1)  # which the target has
    hit = np.unique(pixels[inside], axis=0)  # the pixels that are hit, each once
    return width * height - len(hit)


_MISTAKES = mistakes(
    ("pixels hit", "That is how many pixels are coloured; the holes are the others.",
     lambda m, size: len(_hit(m, size))),
    ("folds not considered", "You subtracted the number of source pixels that land inside. Several "
     "of them may land on one pixel (a fold), which is then coloured once.",
     lambda m, size: size[0] * size[1] - _landed_inside(m, size)),
    ("folds counted", "That is how many source pixels land where another one has landed already: "
     "folds, not holes.",
     lambda m, size: _landed_inside(m, size) - len(_hit(m, size))),
    ("floored, not rounded", "You cut the decimals off: is that the nearest pixel?",
     edited(_steps, "np.rint(m)", "np.floor(m)")),
    ("rounded upwards", "You took the ceiling: is that the nearest pixel?",
     edited(_steps, "np.rint(m)", "np.ceil(m)")),
    ("positions outside counted", "You counted positions outside of the target as if they coloured "
     "a pixel of it.",
     edited(_steps, "pixels[inside]", "pixels")),
    ("n subtracted", "Pixels of the target minus pixels of the source: but some land outside, and "
     "some on the same pixel.",
     lambda m, size: size[0] * size[1] - len(m)),
    ("size exchanged", "size is (width, height): with which of both does u go?",
     edited(_steps, "< size", "< (height, width)")),
    ("negative indices that wrap", "A negative index does not fail in Python: it counts from the "
     "end, and colours the other side. Is each position inside at the left and above as well?",
     edited(_steps, "(pixels >= 0)", "(pixels >= -np.array(size))",
            "pixels[inside]", "pixels[inside] % size")),
    ("positions that land inside", "That is how many positions land inside; the holes are pixels "
     "on which none does.",
     _landed_inside),
    ("tested before rounding", "You asked whether a position is inside before rounding: −0.4 is "
     "rounded to pixel 0, and colours it.",
     edited(_steps, "(pixels >= 0)", "(m >= 0)", "pixels < size", "m <= np.array(size) - 1"),
     edited(_steps, "(pixels >= 0)", "(m >= 0)")),
    ("columns and rows one by one", "You counted columns and rows that are hit, one by one: a "
     "pixel is hit if one position has both.",
     lambda m, size: size[0] * size[1] - np.prod([len(np.unique(x)) for x in _hit(m, size).T])),
    ("border repeated", "You moved positions outside to the border; they colour nothing.",
     edited(_steps, "pixels[inside]", "np.clip(pixels, 0, np.array(size) - 1)")),
    ("pixel 0 left out", "Row 0 and column 0 are inside too.",
     edited(_steps, ">= 0", "> 0")),
)  # fmt: skip

HOLES = Exercise(
    name="count_holes",
    chapter=8,
    title="Holes in a forward warp",
    task="A forward warp sends source pixels to positions m (n, 2) in the target, where each "
    "colours the nearest pixel. Count the pixels of the target, of size (width, height), that "
    "stay empty. Positions outside of the target colour nothing.",
    stub='''def my_count_holes(m, size):
    """Count the target pixels that receive no source pixel."""
    ...''',
    hints=(
        "Round both coordinates first, then keep pixels of the target: −0.4 is rounded to pixel 0, "
        "which is inside. (No position lies halfway between two pixels.)",
        "Make an array of zeros, shape (height, width), and set the pixels that are hit to 1.",
        "Several may hit the same pixel: count what is still 0 at the end.",
    ),
    cases=_landings,
    properties=(Property("It is the number of target pixels that none is nearest to."),),
    misconceptions=_MISTAKES,
    reference=count_holes,
    steps=_steps,
    concepts=("71", "72"),
)
