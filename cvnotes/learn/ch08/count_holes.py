"""Holes in a forward warp."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import pixel_centres, rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng


def count_holes(m: Array, size: tuple[int, int]) -> int:
    """Count the target pixels to which no source pixel is sent, m (n, 2) being where they land."""
    pixels = np.rint(m)
    inside = (pixels >= 0).all(axis=1) & (pixels < size).all(axis=1)
    return size[0] * size[1] - len(np.unique(pixels[inside], axis=0))


def _hit(m: Array, size: tuple[int, int], rounding: np.ufunc = np.rint) -> Array:
    """Give the target pixels (k, 2) that are hit, each once."""
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
    grid = pixel_centres((8, 6)) * 1.3 - 1.0
    moved = rounded(grid + rng.uniform(-0.9, 0.9, grid.shape))
    moved[np.abs(moved % 1 - 0.5) < 0.02] += 0.05
    return [Case((by_hand, (4, 2))), Case((moved, (10, 7)))]


def _landed_inside(m: Array, size: tuple[int, int]) -> int:
    pixels = np.rint(m)
    return int(((pixels >= 0).all(1) & (pixels < size).all(1)).sum())


def _wrapped_around(m: Array, size: tuple[int, int]) -> int | None:
    """Colour without asking for u ≥ 0 and v ≥ 0; None where that raises an IndexError."""
    pixels = np.rint(m).astype(int)
    pixels = pixels[(pixels < size).all(1)]
    if (pixels < -np.array(size)).any():
        return None
    return size[0] * size[1] - len(np.unique(pixels % size, axis=0))


def _tested_first(m: Array, size: tuple[int, int], beyond: float) -> int:
    """Leave out what is outside of the pixel centres, or of pixels from 0 to width."""
    inside = (m >= 0).all(1) & (m <= np.array(size) - 1 + beyond).all(1)
    return size[0] * size[1] - len(_hit(m[inside], size))


def _picture(m: Array, size: tuple[int, int]) -> Array:
    picture = np.zeros(size[::-1])
    u, v = _hit(m, size).astype(int).T
    picture[v, u] = 1
    return picture


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
    misconceptions=(
        Misconception(
            "pixels hit",
            "That is how many pixels are coloured; the holes are the others.",
            lambda m, size: len(_hit(m, size)),
        ),
        Misconception(
            "folds not considered",
            "You subtracted the number of source pixels that land inside. Several of them may "
            "land on one pixel (a fold), which is then coloured once.",
            lambda m, size: size[0] * size[1] - _landed_inside(m, size),
        ),
        Misconception(
            "folds counted",
            "That is how many source pixels land where another one has landed already: folds, "
            "not holes.",
            lambda m, size: _landed_inside(m, size) - len(_hit(m, size)),
        ),
        Misconception(
            "floored, not rounded",
            "You cut the decimals off; the nearest pixel is found by rounding.",
            lambda m, size: size[0] * size[1] - len(_hit(m, size, np.floor)),
        ),
        Misconception(
            "positions outside counted",
            "You counted positions outside of the target as if they coloured a pixel of it.",
            lambda m, size: size[0] * size[1] - len(np.unique(np.rint(m), axis=0)),
        ),
        Misconception(
            "n subtracted",
            "Pixels of the target minus pixels of the source: but some land outside, and some on "
            "the same pixel.",
            lambda m, size: size[0] * size[1] - len(m),
        ),
        Misconception(
            "size exchanged",
            "size is (width, height): u goes with the width, size[0].",
            lambda m, size: count_holes(m, size[::-1]),
        ),
        Misconception(
            "truncated, not rounded",
            "int() cuts the decimals off, towards 0; the nearest pixel is found by rounding.",
            lambda m, size: size[0] * size[1] - len(_hit(m, size, np.trunc)),
        ),
        Misconception(
            "rounded upwards",
            "You took the ceiling; the nearest pixel is found by rounding.",
            lambda m, size: size[0] * size[1] - len(_hit(m, size, np.ceil)),
        ),
        Misconception(
            "negative indices that wrap",
            (
                "A negative index does not fail in Python: it counts from the end, and colours "
                "the other side. Ask for u ≥ 0 and v ≥ 0 as well."
            ),
            _wrapped_around,
        ),
        Misconception(
            "pixels of the target",
            "That is how many pixels the target has.",
            lambda m, size: size[0] * size[1],
        ),
        Misconception(
            "pixels outside",
            "That is how many positions lie outside of the target.",
            lambda m, size: len(m) - _landed_inside(m, size),
        ),
        Misconception(
            "positions that land inside",
            "That is how many positions land inside; the holes are pixels on which none does.",
            _landed_inside,
        ),
        Misconception(
            "tested before rounding",
            "You asked whether a position lies between the outermost pixel centres before "
            "rounding: −0.4 is rounded to pixel 0, and colours it.",
            lambda m, size: _tested_first(m, size, 0.0),
            variants=(lambda m, size: _tested_first(m, size, 1.0),),
        ),
        Misconception(
            "not rounded",
            "You compared positions as they are: several within one pixel colour it once.",
            lambda m, size: (
                size[0] * size[1] - len(np.unique(m[((m >= 0) & (m < size)).all(1)], axis=0))
            ),
        ),
        Misconception(
            "columns and rows one by one",
            "You counted columns and rows that are hit, one by one: a pixel is hit if one "
            "position has both.",
            lambda m, size: (
                size[0] * size[1]
                - len(np.unique(_hit(m, size)[:, 0])) * len(np.unique(_hit(m, size)[:, 1]))
            ),
            variants=(lambda m, size: size[0] * size[1] - len(np.unique(_hit(m, size))),),
        ),
        Misconception(
            "one row and column too few",
            "The target has width × height pixels, from 0 to width − 1 and height − 1.",
            lambda m, size: (
                (size[0] - 1) * (size[1] - 1) - len(_hit(m, (size[0] - 1, size[1] - 1)))
            ),
            variants=(lambda m, size: (size[0] - 1) * (size[1] - 1) - len(_hit(m, size)),),
        ),
        Misconception(
            "one row and column too many",
            "The target has width × height pixels, from 0 to width − 1: position width is outside.",
            lambda m, size: (
                (size[0] + 1) * (size[1] + 1) - len(_hit(m, (size[0] + 1, size[1] + 1)))
            ),
        ),
        Misconception(
            "border repeated",
            "You moved positions outside to the border; they colour nothing.",
            lambda m, size: (
                size[0] * size[1]
                - len(np.unique(np.clip(np.rint(m), 0, np.array(size) - 1), axis=0))
            ),
        ),
        Misconception(
            "pixel 0 left out",
            "Row 0 and column 0 are inside: u ≥ 0, not u > 0.",
            lambda m, size: size[0] * size[1] - int((_hit(m, size) > 0).all(1).sum()),
        ),
        Misconception(
            "source pixels without a target",
            "That is how many source pixels colour nothing, or nothing new; holes are pixels of "
            "the target.",
            lambda m, size: len(m) - len(_hit(m, size)),
        ),
        Misconception(
            "where the holes are",
            "You gave the picture, or a list; asked is how many holes there are.",
            lambda m, size: _picture(m, size),
            variants=(lambda m, size: 1 - _picture(m, size),),
        ),
    ),
    reference=count_holes,
    concepts=("71", "72"),
)
