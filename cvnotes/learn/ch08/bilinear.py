"""Between the pixels."""

import numpy as np

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import image_of_noise, rounded
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.warping import bilinear as library_bilinear


def _positions(rng: np.random.Generator) -> list[Case]:
    by_hand = np.array([[10.0, 20, 40], [50, 90, 60]])
    cases = [Case((by_hand, 0.5, 0.25)), Case((by_hand, 1.0, 0.0), about="centre")]
    cases.append(Case((by_hand, 1.7, 0.6)))  # between the last two columns
    for _ in range(3):
        u, v = rounded(rng.uniform([3.2, 1.2], [5.8, 2.8])).tolist()
        cases.append(Case((image_of_noise(rng, 7, 5), u + 0.003, v + 0.004)))
    border = [(2.0, 0.25), (0.5, 1.0), (2.0, 1.0)]
    return cases + [Case((by_hand, u, v), about="border") for u, v in border]


def bilinear(image: Array, u: float, v: float) -> float:
    """Return the grey level at (u, v), bilinearly interpolated."""
    height, width = image.shape
    i, j = int(np.floor(u)), int(np.floor(v))
    du = u - i  # what is left of u
    dv = v - j  # what is left of v
    right = min(i + 1, width - 1)  # the column on the right
    below = min(j + 1, height - 1)  # the row below
    I1, I2 = image[j, i], image[j, right]
    I3, I4 = image[below, i], image[below, right]
    upper = (1 - du) * I1 + du * I2  # the grey level in the upper row
    lower = (1 - du) * I3 + du * I4  # the grey level in the lower row
    return (1 - dv) * upper + dv * lower


_MISTAKES = mistakes_in(bilinear,
    ("sign of I1 in the expanded form", "You followed the notes' last but one line, which has a "
     "wrong sign in the factor of Δu Δv.",
     "I1 + (I2 - I1) * du + (I3 - I1) * dv + (I4 - I3 - I2 - I1) * du * dv"),
    ("mixed term left out", "You added the changes along u and v; the term with Δu Δv is missing.",
     "I1 + (I2 - I1) * du + (I3 - I1) * dv"),
    ("rows and columns exchanged", "You read image[u, v]: in an image rows come first.",
     lambda image, u, v: bilinear(image.T, u, v)),
    ("Δu and Δv exchanged", "Δu and Δv are exchanged: which of them leads to the right?",
     ("du = u - i", "du = v - j", "dv = v - j", "dv = u - i")),
    ("weights the wrong way round", "Δ and 1 − Δ are exchanged, along u, along v or both: near "
     "I1, where Δu and Δv are small, it must count most.",
     ("du = u - i", "du = 1 - u + i", "dv = v - j", "dv = 1 - v + j"),
     ("du = u - i", "du = 1 - u + i"), ("dv = v - j", "dv = 1 - v + j")),
    ("nearest pixel", "That is the nearest pixel; the other three count too.",
     "image[round(v), round(u)]", "image[int(np.floor(v + 0.5)), int(np.floor(u + 0.5))]",
     "image[int(np.ceil(v - 0.5)), int(np.ceil(u - 0.5))]"),
    ("mean of the four", "That is the mean of four pixels: the nearer ones count more.",
     "(I1 + I2 + I3 + I4) / 4"),
    ("neighbour beyond the border", "Right inside. In the last column or row there is no pixel "
     "beyond; but what would its weight be?",
     ("min(i + 1, width - 1)", "i + 1", "min(j + 1, height - 1)", "j + 1")),
    ("border left out", "Right inside. In the last column or row you gave 0; there are still two "
     "pixels to interpolate, or one.",
     "((1 - dv) * upper + dv * lower) * (i < width - 1) * (j < height - 1)"),
    ("border moved inwards", "In the last column or row you took the pixel before it: at whole "
     "numbers the pixel itself counts.",
     ("right = min(i + 1, width - 1)", "i = min(i, width - 2); right = i + 1",
      "below = min(j + 1, height - 1)", "j = min(j, height - 2); below = j + 1")),
    ("half-pixel centres", "You took pixel centres at halves. Here whole numbers are the centres.",
     lambda image, u, v: bilinear(image, max(u - 0.5, 0.0), max(v - 0.5, 0.0))),
    ("bytes that wrap around", "In bytes 50 − 90 is 216: convert the image to float first.",
     ("    I1, I2 =", "    image = image.astype(np.uint8); I1, I2 =",
      "(1 - du) * I1 + du * I2", "I1 + (I2 - I1) * du",
      "(1 - du) * I3 + du * I4", "I3 + (I4 - I3) * du", "upper + (lower - upper) * dv")),
)  # fmt: skip

EXERCISE = Exercise(
    name="bilinear",
    chapter=8,
    title="Between the pixels",
    task="Give the grey level of an image, shape (height, width), at the position (u, v) inside of "
    "it, its last row and column included, interpolated between the four pixels around it. Whole "
    "numbers are pixel centres.",
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
    misconceptions=_MISTAKES,
    steps=bilinear,
    concepts=("75", "E40", "E42", "E43"),
    sources=(library_bilinear,),
)
