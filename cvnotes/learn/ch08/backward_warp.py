"""A warp without holes."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import image_of_noise, pixel_centres, rounded
from cvnotes.projective import apply
from cvnotes.tutor import Case, Exercise, Property, mistakes_in
from cvnotes.warping import backward_warp as library_warp
from cvnotes.warping import homography_map


def _sources(M: npt.ArrayLike, size: tuple[int, int]) -> Array:
    return np.asarray(np.nan_to_num(apply(M, pixel_centres(size)), nan=-1e6))


def _warps(rng: np.random.Generator) -> list[Case]:
    shift = np.array([[1.0, 0, 1], [0, 1, 1], [0, 0, 1]])
    cases = [Case((np.array([[1.0, 2, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12]]), shift, (4, 3)))]
    # smaller than the source, and from its far corner
    cases.append(Case((cases[0].args[0], shift * [[1, 1, -1], [1, 1, -1], [1, 1, 1]], (2, 2))))
    # positions just outside of the pixels' centres, at the first and at the last
    cases.append(Case((cases[0].args[0], shift * [[1, 1, 0.3], [1, 1, 0.3], [1, 1, 1]], (4, 5))))
    while len(cases) < 5:
        H = np.eye(3) + rng.uniform(-0.25, 0.25, (3, 3)) * [[1, 1, 8], [1, 1, 8], [0.05, 0.05, 0]]
        H[:2, :2] *= 1.3
        H, size = rounded(H, 3), (14, 9)
        fractions = _sources(np.linalg.inv(H), size) % 1
        if np.abs(fractions - 0.5).min() > 1e-3:  # nothing depends on how a half is rounded
            cases.append(Case((image_of_noise(rng, 12, 8), 2 * H, size)))
    return cases


def _forward(image: Array, H: Array, size: tuple[int, int]) -> Array:
    out = np.zeros(size[::-1])
    centres = pixel_centres(image.shape[::-1])
    for (u, v), value in zip(np.round(apply(H, centres)), image.ravel(), strict=True):
        if 0 <= u < size[0] and 0 <= v < size[1]:
            out[int(v), int(u)] = value
    return out


def _interpolated(image: Array, H: Array, size: tuple[int, int]) -> Array:
    to_source = homography_map(np.linalg.inv(H))
    return np.asarray(library_warp(image, to_source, size=size, method="bilinear"), dtype=float)


def backward_warp(image: Array, H: Array, size: tuple[int, int]) -> Array:
    """Return the warped picture, shape (size[1], size[0])."""
    height, width = image.shape
    columns, rows = size
    u, v = np.meshgrid(np.arange(columns), np.arange(rows))  # the pixels of the target
    target = np.stack([u, v, np.ones_like(u)], axis=-1)  # the same, homogeneous
    source = target @ np.linalg.inv(H).T  # where they come from, homogeneous
    m = source[..., :2] / source[..., 2:]  # the positions in the source
    k = np.rint(m)  # the nearest pixels
    inside = ((k >= 0) & (k < [width, height])).all(axis=-1)  # which of them the source has
    i = np.where(inside, k[..., 0], 0).astype(int)  # the columns to look up
    j = np.where(inside, k[..., 1], 0).astype(int)  # the rows to look up
    return np.where(inside, image[j, i], 0)


_MISTAKES = mistakes_in(backward_warp,
    ("forward", "You sent source pixels to the target: some target pixels get none (holes), others "
     "several (folds). Go backwards: one look-up for each target pixel.",
     _forward, "_forward(image, np.linalg.inv(H), size)"),
    ("u and v exchanged", "You applied H to (v, u), or looked up (v, u): u counts columns and "
     "comes first in a pixel; in an image rows come first.",
     "backward_warp(image.T, H, size[::-1]).T", "backward_warp(image.T, H, size)",
     ("k = np.rint(m)", "k = np.rint(m)[..., ::-1]")),
    ("border repeated", "Outside of the source you repeated its border; the task asks for 0 there.",
     ("np.rint(m)", "np.clip(np.rint(m), 0, [width - 1, height - 1])")),
    ("wrapped around", "Outside you went on at the source's other side; 0 is asked there.",
     ("np.rint(m)", "np.rint(m) % [width, height]")),
    ("negative indices that wrap", "A negative index counts from the end, so that the other side "
     "of the picture shows up. Is each position inside at the left and above as well?",
     ("(k >= 0) & ", "")),
    ("truncated, not rounded", "int() cuts the decimals off, towards 0; which pixel is nearest?",
     ("np.rint(m)", "np.trunc(m + 1e-9)")),
    ("half-pixel centres", "You took pixel centres at halves. Here whole numbers are the centres.",
     ("target @", "(target + [0.5, 0.5, 0]) @", "np.rint(m)", "np.floor(m + 1e-9)"),
     ("target @", "(target + [0.5, 0.5, 0]) @"),
     ("target @", "(target + [0.5, 0.5, 0]) @", "np.rint(m)", "np.rint(m - 0.5)")),
    ("the border left out", "Row 0 and column 0 of the source count too, and so do its last ones.",
     ("k >= 0", "k > 0"), ("[width, height]", "[width - 1, height - 1]")),
    ("bilinear", "You interpolated between four pixels; asked is the nearest one.", _interpolated),
    ("value outside", "Outside of the source the task asks for 0; you have another value there.",
     ("image[j, i], 0)", "image[j, i], 255.0)"), ("image[j, i], 0)", "image[j, i], -1.0)"),
     ("image[j, i], 0)", "image[j, i], image.mean())")),
)  # fmt: skip

EXERCISE = Exercise(
    name="backward_warp",
    chapter=8,
    title="A warp without holes",
    task="Warp an image, shape (height, width), by a homography H with target ≈ H source: give "
    "the target of `size` = (width, height), shape (height, width). Each target pixel shows the "
    "nearest pixel of the source it comes from, or 0 if that is outside.",
    hints=(
        "Go through the pixels of the target, not of the source: then none is left out.",
        "Where does target pixel (u', v') come from? (u, v, 1) ≈ H⁻¹ (u', v', 1).",
        "Divide, round both, and look up image[v, u] if the rounded pixel is one of the source: "
        "0 ≤ u ≤ width − 1. (No position lies halfway between two pixels.)",
    ),
    cases=_warps,
    properties=(Property("Each target pixel shows the source pixel that H takes nearest to it."),),
    misconceptions=_MISTAKES,
    steps=backward_warp,
    concepts=("66", "73", "74", "E39"),
)
