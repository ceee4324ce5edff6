"""Between the pixels."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import image_of_noise, rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.warping import bilinear as library_bilinear
from cvnotes.warping import interpolate


def bilinear(image: Array, u: float, v: float) -> float:
    """Give the grey level of an image (height, width) at (u, v), between its pixels."""
    return float(interpolate(image, [u, v]))


def _four(image: Array, i: int, j: int) -> tuple[float, float, float, float]:
    """Give I1 to I4 around (i, j), column and row; what is outside has no say."""
    padded = np.pad(image, ((1, 2), (1, 2)), mode="edge")
    i, j = i + 1, j + 1
    return padded[j, i], padded[j, i + 1], padded[j + 1, i], padded[j + 1, i + 1]


def _blend(I1: float, I2: float, I3: float, I4: float, du: float, dv: float) -> float:
    return (1 - du) * (1 - dv) * I1 + du * (1 - dv) * I2 + (1 - du) * dv * I3 + du * dv * I4


def _positions(rng: Rng) -> list[Case]:
    by_hand = np.array([[10.0, 20, 40], [50, 90, 60]])
    cases = [Case((by_hand, 0.5, 0.25)), Case((by_hand, 1.0, 0.0), about="centre")]
    for _ in range(3):
        u, v = rounded(rng.uniform([0.2, 0.2], [5.8, 3.8])).tolist()
        cases.append(Case((image_of_noise(rng, 7, 5), u + 0.003, v + 0.004)))
    border = [(2.0, 0.25), (0.5, 1.0), (2.0, 1.0)]
    return cases + [Case((by_hand, u, v), about="border") for u, v in border]


def _split(u: float, v: float) -> tuple[int, int, float, float]:
    i, j = int(np.floor(u)), int(np.floor(v))
    return i, j, u - i, v - j


def _slipped(image: Array, u: float, v: float) -> float:
    """Follow the notes' expanded form with its slip of a sign."""
    i, j, du, dv = _split(u, v)
    I1, I2, I3, I4 = _four(image, i, j)
    return (I2 - I1) * du + (I3 - I1) * dv + (I4 - I3 - I2 - I1) * du * dv + I1


def _weighted(image: Array, u: float, v: float, *, order: tuple[int, ...] = (0, 1, 2, 3)) -> float:
    i, j, du, dv = _split(u, v)
    values = _four(image, i, j)
    I1, I2, I3, I4 = (values[n] for n in order)
    return _blend(I1, I2, I3, I4, du, dv)


def _from_rounded(image: Array, u: float, v: float) -> float:
    i, j = round(u), round(v)
    return _blend(*_four(image, i, j), u - i, v - j)


def _along_v(image: Array, u: float, v: float) -> float:
    i, j, _, dv = _split(u, v)
    I1, _, I3, _ = _four(image, i, j)
    return (1 - dv) * I1 + dv * I3


def _without_mixed(image: Array, u: float, v: float) -> float:
    i, j, du, dv = _split(u, v)
    I1, I2, I3, _ = _four(image, i, j)
    return I1 + du * (I2 - I1) + dv * (I3 - I1)


def _inwards(image: Array, u: float, v: float) -> float:
    i, j, du, dv = _split(u, v)
    i, j = min(i, image.shape[1] - 2), min(j, image.shape[0] - 2)
    return _blend(*_four(image, i, j), du, dv)


def _blend_two(image: Array, u: float, v: float) -> float:
    i, j, du, dv = _split(u, v)
    I1, _, _, I4 = _four(image, i, j)
    return (1 - du * dv) * I1 + du * dv * I4


def _by_distance(image: Array, u: float, v: float) -> float:
    i, j, du, dv = _split(u, v)
    far = np.hypot([du, 1 - du, du, 1 - du], [dv, dv, 1 - dv, 1 - dv])
    weights = 1 / np.maximum(far, 1e-12)
    return float(weights @ np.array(_four(image, i, j)) / weights.sum())


def _in_bytes(image: Array, u: float, v: float) -> float:
    """Interpolate along u, then along v, with differences of bytes."""
    i, j, du, dv = _split(u, v)
    I1, I2, I3, I4 = np.array(_four(image, i, j)).astype(np.uint8)
    above, below = I1 + (I2 - I1) * du, I3 + (I4 - I3) * du
    return float(above + (below - above) * dv)


BILINEAR = Exercise(
    name="bilinear",
    chapter=8,
    title="Between the pixels",
    task="Give the grey level of an image, shape (height, width), at the position (u, v) inside of "
    "it, its last row and column included, interpolated between the four pixels around it. Whole "
    "numbers are pixel centres.",
    stub='''def my_bilinear(image, u, v):
    """Give the grey level at (u, v), bilinearly interpolated."""
    ...''',
    hints=(
        "u_k = floor(u) and v_k = floor(v); Δu and Δv are what is left, from 0 to 1.",
        "Rows come first: I1 = image[v_k, u_k], I2 = image[v_k, u_k + 1] to its right.",
        "(1−Δu)(1−Δv) I1 + Δu(1−Δv) I2 + (1−Δu)Δv I3 + ΔuΔv I4. At the last column or row the "
        "neighbour beyond has weight 0.",
    ),
    cases=_positions,
    properties=(
        Property("At a pixel's centre it is that pixel.", about="centre"),
        Property("In between, each of the four counts by how near it is."),
        Property("In the last column and row there is an answer too.", about="border"),
    ),
    misconceptions=(
        Misconception(
            "sign of I1 in the expanded form",
            "You followed the notes' last but one line, which has a wrong sign: the factor of "
            "Δu Δv is I4 − I3 − I2 + I1.",
            _slipped,
        ),
        Misconception(
            "rows and columns exchanged",
            "image[u, v] reads row u: rows come first, image[v, u].",
            lambda image, u, v: _weighted(image.T, u, v),
        ),
        Misconception(
            "Δu and Δv exchanged",
            "Δu and Δv are exchanged: I2, to the right, goes with Δu.",
            lambda image, u, v: _weighted(image, u, v, order=(0, 2, 1, 3)),
        ),
        Misconception(
            "weights the wrong way round",
            "Near I1, where Δu and Δv are small, I1 must count most: its weight is (1−Δu)(1−Δv).",
            lambda image, u, v: _weighted(image, u, v, order=(3, 2, 1, 0)),
        ),
        Misconception(
            "nearest pixel",
            "That is the nearest pixel; the other three count too.",
            lambda image, u, v: image[round(v), round(u)],
            variants=(
                lambda image, u, v: image[int(np.floor(v + 0.5)), int(np.floor(u + 0.5))],
                lambda image, u, v: image[int(np.ceil(v - 0.5)), int(np.ceil(u - 0.5))],
            ),
        ),
        Misconception(
            "pixel at the left and above",
            "That is I1 alone, the pixel at (⌊u⌋, ⌊v⌋).",
            lambda image, u, v: image[int(v), int(u)],
        ),
        Misconception(
            "rounded, not floored",
            "You rounded to find the first pixel. Then Δ may be negative and the four pixels are "
            "not those around the position: take the floor of both.",
            _from_rounded,
        ),
        Misconception(
            "mean of the four",
            "That is the mean of the four pixels, wherever the position is between them.",
            lambda image, u, v: np.mean(_four(image, *_split(u, v)[:2])),
        ),
        Misconception(
            "neighbour beyond the border",
            (
                "Right inside. In the last column or row there is no pixel beyond: its weight is "
                "0, so use the last one twice, min(u_k + 1, width − 1)."
            ),
            lambda image, u, v: (
                bilinear(image, u, v) if u < image.shape[1] - 1 and v < image.shape[0] - 1 else None
            ),
        ),
        Misconception(
            "border left out",
            (
                "Right inside. In the last column or row you gave 0; there are still two pixels "
                "to interpolate, or one."
            ),
            lambda image, u, v: (
                bilinear(image, u, v) if u < image.shape[1] - 1 and v < image.shape[0] - 1 else 0.0
            ),
        ),
        Misconception(
            "along u only",
            "You interpolated along the row only: Δv counts as well.",
            lambda image, u, v: _weighted(image, u, v, order=(0, 1, 0, 1)),
        ),
        Misconception(
            "along v only",
            "You interpolated along the column only: Δu counts as well.",
            lambda image, u, v: _along_v(image, u, v),
        ),
        Misconception(
            "Δ for 1 − Δ in u",
            "Δu and 1 − Δu are exchanged: the pixel on the left counts by 1 − Δu.",
            lambda image, u, v: _weighted(image, u, v, order=(1, 0, 3, 2)),
        ),
        Misconception(
            "Δ for 1 − Δ in v",
            "Δv and 1 − Δv are exchanged: the pixel above counts by 1 − Δv.",
            lambda image, u, v: _weighted(image, u, v, order=(2, 3, 0, 1)),
        ),
        Misconception(
            "the last weight left out",
            "The fourth pixel is missing: ΔuΔv I4.",
            lambda image, u, v: _blend(
                *_four(image, *_split(u, v)[:2])[:3], 0.0, *_split(u, v)[2:]
            ),
        ),
        Misconception(
            "ceil for floor",
            "You took the ceiling: the first pixel is at (⌊u⌋, ⌊v⌋).",
            lambda image, u, v: image[int(np.ceil(v)), int(np.ceil(u))],
        ),
        Misconception(
            "mixed term left out",
            "You added what changes along u and along v; the term with ΔuΔv is missing: I4 − I3 − "
            "I2 + I1.",
            lambda image, u, v: _without_mixed(image, u, v),
        ),
        Misconception(
            "border moved inwards",
            "In the last column or row you took the pixel before it: at whole numbers Δ is 0, and "
            "the pixel itself counts.",
            lambda image, u, v: _inwards(image, u, v),
        ),
        Misconception(
            "sum of the four",
            "You added the four pixels without weights.",
            lambda image, u, v: np.sum(_four(image, *_split(u, v)[:2])),
        ),
        Misconception(
            "diagonal pixels only",
            "You interpolated between I1 and I4 only: I2 and I3 count too.",
            lambda image, u, v: _blend_two(image, u, v),
        ),
        Misconception(
            "weights of the distance",
            "You weighted by the inverse of the distance; bilinear weights are products of 1 − Δ "
            "and Δ.",
            lambda image, u, v: _by_distance(image, u, v),
        ),
        Misconception(
            "half-pixel centres",
            "You took pixel centres at halves. Here whole numbers are the centres.",
            lambda image, u, v: bilinear(image, max(u - 0.5, 0.0), max(v - 0.5, 0.0)),
        ),
        Misconception(
            "bytes that wrap around",
            "You calculated with bytes: 50 − 90 is 216 there. Convert the image to float first.",
            lambda image, u, v: _in_bytes(image, u, v),
        ),
    ),
    reference=bilinear,
    concepts=("75", "E40", "E42", "E43"),
    sources=(library_bilinear,),
)
