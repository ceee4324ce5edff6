"""Words as pixels, written once and kept: stamps for a panel, and its title."""

import math
import re
from functools import lru_cache
from itertools import groupby

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from cvnotes.show.typeface import enlargement, font_file

# All that explorations write: Latin, Greek, and a little mathematics.
LETTERS = (
    "".join(
        map(chr, (*range(32, 127), *range(160, 256), *range(0x391, 0x3A2), *range(0x3A3, 0x3CA)))
    )
    + "ĥ–—…′″√∞≈≤≥≠±−·×←→↑↓"
)
# Larger than the type's own, to be read at a drawing's size; and it has neither ᵥ nor ᵀ.
SMALL = str.maketrans("₀₁₂₃₄₅₆₇₈₉ᵤᵥ⁻¹²³ᵀ", "0123456789uv−123T")
_SMALLER = 0.75  # than the letter before it


def with_minus(words: str) -> str:
    """Return words whose negative numbers have a true minus.

    Examples
    --------
    >>> with_minus("k1 = -0.2, a plain-spoken lens")
    'k1 = −0.2, a plain-spoken lens'
    """
    return re.sub(r"-(?=\d)", "−", words)


@lru_cache(maxsize=512)
def stamp(
    words: str, anchor: str, size: int, stroke: int
) -> tuple[Image.Image, Image.Image, tuple[int, int]]:
    """Write words once: masks of their white rim and of their ink, and where these begin."""
    runs = _runs(with_minus(words) or " ", size)
    (last, _), part, font = runs[-1]
    ascent, descent = _font(size).getmetrics()
    x = -(last + font.getlength(part)) * "lmr".index(anchor[0]) / 2
    y = {"a": ascent, "m": (ascent - descent) / 2, "s": 0, "d": -descent}[anchor[1]]
    boxes = np.array([
        np.add(font.getbbox(part, anchor="ls", stroke_width=stroke), (*at, *at))
        for at, part, font in runs
    ]) + (x, y, x, y)  # fmt: skip
    left, top = (math.floor(side) for side in boxes[:, :2].min(axis=0).tolist())
    right, bottom = (math.ceil(side) for side in boxes[:, 2:].max(axis=0).tolist())
    masks = [Image.new("L", (right - left + 1, bottom - top + 1)) for _ in range(2)]
    for mask, rim in zip(masks, (stroke, 0), strict=True):
        pen = ImageDraw.Draw(mask)
        for (ahead, below), part, font in runs:
            place = (x + ahead - left, y + below - top)
            pen.text(place, part, 255, font, "ls", stroke_width=rim)
    return masks[0], masks[1], (left, top)


@lru_cache(maxsize=64)
def title_strip(words: str, size: tuple[int, int], left: int, scale: int) -> npt.NDArray[np.uint8]:
    """Write a panel's title, from `left` on, into a strip of (width, height) px."""
    strip = Image.new("RGB", (2 * size[0], 2 * size[1]), "white")
    _, ink, (ahead, above) = stamp(words, "lm", 13 * scale, 0)
    strip.paste("#333333", (left + ahead, size[1] + above), ink)
    return np.asarray(strip.reduce(2))


def _runs(words: str, size: int) -> list[tuple[tuple[float, float], str, ImageFont.FreeTypeFont]]:
    """Part words at indices and exponents: where each part begins, right and down, and its font."""
    runs: list[tuple[tuple[float, float], str, ImageFont.FreeTypeFont]] = []
    x = 0.0
    for lower, letters in groupby(words, _lower):
        part = "".join(letters).translate(SMALL)
        font = _font(round(_SMALLER * size) if lower else size)
        runs.append(((x, lower * size), part, font))
        x += font.getlength(part)
    return runs


def _lower(letter: str) -> float:
    """Return by how much, in its size, a letter stands below the line: an exponent above it."""
    return 0.2 if letter in "₀₁₂₃₄₅₆₇₈₉ᵤᵥ" else -0.3 if letter in "⁻¹²³ᵀ" else 0.0


@lru_cache(maxsize=16)
def _font(size: int) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(font_file(), round(enlargement() * size))
