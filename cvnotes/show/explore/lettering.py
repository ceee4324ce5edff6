"""Words as pixels, written once and kept: stamps for a panel, and its title."""

import math
from functools import lru_cache
from pathlib import Path

import matplotlib
import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont


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
    ImageDraw.Draw(strip).text((left, size[1]), words, "#333333", _font(12 * scale), "lm")
    return np.asarray(strip.reduce(2))


@lru_cache(maxsize=16)
def _font(size: int) -> ImageFont.FreeTypeFont:
    """Matplotlib's own type, so that drawings and figures look alike and have Greek letters."""
    return ImageFont.truetype(Path(matplotlib.get_data_path(), "fonts/ttf/DejaVuSans.ttf"), size)
