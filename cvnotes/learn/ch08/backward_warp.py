"""A warp without holes."""

# A mistake is often an argument that was left out.

from typing import Any

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import image_of_noise, pixel_centres, rounded
from cvnotes.projective import apply
from cvnotes.tutor.checker.exercise import Case, Exercise, Property, Rng, mistakes
from cvnotes.tutor.checker.steps import edited
from cvnotes.warping import backward_warp as library_warp
from cvnotes.warping import homography_map


def backward_warp(image: Array, H: Array, size: tuple[int, int]) -> Array:
    """Warp an image by H, target ≈ H source, to a picture of size (width, height).

    `cvnotes.warping.backward_warp` does so tile by tile, with any map and method.
    """
    (height, width), (columns, rows) = image.shape, size
    u, v = np.meshgrid(np.arange(columns), np.arange(rows))
    m_h = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(H).T
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = np.rint(m_h[..., 0] / m_h[..., 2]), np.rint(m_h[..., 1] / m_h[..., 2])
    inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
    warped = np.zeros((rows, columns))
    warped[inside] = image[v[inside].astype(int), u[inside].astype(int)]
    return warped


def _sources(M: npt.ArrayLike, size: tuple[int, int]) -> Array:
    return np.asarray(np.nan_to_num(apply(M, pixel_centres(size)), nan=-1e6))


def _warps(rng: Rng) -> list[Case]:
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


def _steps(image: Array, H: Array, size: tuple[int, int]) -> Any:
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


_MISTAKES = mistakes(
    ("H for its inverse", "You looked up with H itself, which leads from source to target: "
     "backwards takes the way back.",
     edited(_steps, "np.linalg.inv(H).T", "H.T")),
    ("forward", "You sent source pixels to the target: some target pixels get none (holes), others "
     "several (folds). Go backwards: one look-up for each target pixel.",
     _forward, lambda image, H, size: _forward(image, np.linalg.inv(H), size)),
    ("u and v exchanged", "You applied H to (v, u): u counts columns and comes first.",
     lambda image, H, size: backward_warp(image.T, H, size[::-1]).T),
    ("border repeated", "Outside of the source you repeated its border; the task asks for 0 there.",
     edited(_steps, "np.rint(m)", "np.clip(np.rint(m), 0, [width - 1, height - 1])")),
    ("wrapped around", "Outside of the source you went on at its other side, as % does; the task "
     "asks for 0 there.",
     edited(_steps, "np.rint(m)", "np.rint(m) % [width, height]")),
    ("negative indices that wrap", "A negative index does not fail in Python: it counts from the "
     "end, so that the other side of the picture shows up. Is each position inside at the left "
     "and above as well?",
     edited(_steps, "(k >= 0) & ", "")),
    ("truncated, not rounded", "int() cuts the decimals off, towards 0; which pixel is nearest?",
     edited(_steps, "np.rint(m)", "np.trunc(m + 1e-9)")),
    ("half-pixel centres", "You took pixel centres at halves. Here whole numbers are the centres.",
     edited(_steps, "target @", "(target + [0.5, 0.5, 0]) @", "np.rint(m)", "np.floor(m + 1e-9)"),
     edited(_steps, "target @", "(target + [0.5, 0.5, 0]) @"),
     edited(_steps, "target @", "(target + [0.5, 0.5, 0]) @", "np.rint(m)", "np.rint(m - 0.5)")),
    ("first row and column left out", "Row 0 and column 0 of the source count too.",
     edited(_steps, "k >= 0", "k > 0")),
    ("last row and column left out", "The last row and column of the source count too.",
     edited(_steps, "[width, height]", "[width - 1, height - 1]")),
    ("bilinear", "You interpolated between four pixels; asked is the nearest one.", _interpolated),
    ("rows and columns exchanged at the look-up", "In an image rows come first: which index "
     "counts rows?",
     lambda image, H, size: _steps(image.T, H, size),
     edited(_steps, "k = np.rint(m)", "k = np.rint(m)[..., ::-1]")),
    ("value outside", "Outside of the source the task asks for 0; you have another value there.",
     edited(_steps, "image[j, i], 0)", "image[j, i], 255.0)"),
     edited(_steps, "image[j, i], 0)", "image[j, i], -1.0)"),
     edited(_steps, "image[j, i], 0)", "image[j, i], image.mean())")),
)  # fmt: skip

BACKWARD = Exercise(
    name="backward_warp",
    chapter=8,
    title="A warp without holes",
    task="Warp an image, shape (height, width), by a homography H with target ≈ H source: give "
    "the target of `size` = (width, height), shape (height, width). Each target pixel shows the "
    "nearest pixel of the source it comes from, or 0 if that is outside.",
    stub='''def my_backward_warp(image, H, size):
    """Return the warped picture, shape (size[1], size[0])."""
    ...''',
    hints=(
        "Go through the pixels of the target, not of the source: then none is left out.",
        "Where does target pixel (u', v') come from? (u, v, 1) ≈ H⁻¹ (u', v', 1).",
        "Divide, round both, and look up image[v, u] if the rounded pixel is one of the source: "
        "0 ≤ u ≤ width − 1. (No position lies halfway between two pixels.)",
    ),
    cases=_warps,
    properties=(Property("Each target pixel shows the source pixel that H takes nearest to it."),),
    misconceptions=_MISTAKES,
    reference=backward_warp,
    steps=_steps,
    concepts=("66", "73", "74", "E39"),
)
