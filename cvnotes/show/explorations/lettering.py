"""Words as pixels, written once and kept: stamps for a panel, and its title."""

import math
import os
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from cvnotes.base import FileError

# All that explorations write: Latin, Greek, and a little mathematics.
LETTERS = "".join(map(chr, (*range(32, 127), *range(160, 256), *range(0x391, 0x3CA)))) + (
    "ĥ–—…′″√∞∝≈≤≥≠±−·×ᵀ⁻¹₀₁₂₃₄ᵤᵥ←→↑↓²³"
)


@lru_cache(maxsize=512)
def stamp(
    words: str, anchor: str, size: int, stroke: int
) -> tuple[Image.Image, Image.Image, tuple[int, int]]:
    """Write words once: masks of their white rim and of their ink, and where these begin."""
    font = _font(size)
    box = font.getbbox(words, anchor=anchor, stroke_width=stroke)
    left, top = (math.floor(side) for side in box[:2])
    size_of_both = (math.ceil(box[2]) - left + 1, math.ceil(box[3]) - top + 1)
    masks = [Image.new("L", size_of_both) for _ in range(2)]
    for mask, width in zip(masks, (stroke, 0), strict=True):
        ImageDraw.Draw(mask).text((-left, -top), words, 255, font, anchor, stroke_width=width)
    return masks[0], masks[1], (left, top)


@lru_cache(maxsize=64)
def title_strip(words: str, size: tuple[int, int], left: int, scale: int) -> npt.NDArray[np.uint8]:
    """Write a panel's title, from `left` on, into a strip of (width, height) px."""
    strip = Image.new("RGB", (2 * size[0], 2 * size[1]), "white")
    ImageDraw.Draw(strip).text((left, size[1]), words, "#333333", _font(13 * scale), "lm")
    return np.asarray(strip.reduce(2))


@lru_cache(maxsize=16)
def _font(size: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(font_file(), size)


def font_file() -> Path:
    """Find matplotlib's own type: drawings and figures look alike, and there are Greek letters.

    Matplotlib is not loaded for it. On a page it is not there either; whoever runs the
    explorations there names a file with the letters of `LETTERS` in CVNOTES_FONT.

    Examples
    --------
    >>> font_file().name
    'DejaVuSans.ttf'
    """
    if given := os.environ.get("CVNOTES_FONT"):
        return Path(given)
    found = find_spec("matplotlib")
    if found is None or found.origin is None:
        raise FileError("there is no type to write with: matplotlib, which brings it, is missing")
    return Path(found.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf"
