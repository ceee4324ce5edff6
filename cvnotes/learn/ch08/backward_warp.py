"""A warp without holes."""

# A mistake is often an argument that was left out.
# ruff: noqa: ARG005

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import image_of_noise, pixel_centres, rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import apply
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


def _looked_up(image: Array, m: Array, size: tuple[int, int]) -> Array:
    """Give the pixels nearest to m (n, 2), 0 outside, as a picture."""
    u, v = np.round(np.clip(m, -1e6, 1e6)).astype(int).T
    height, width = image.shape
    inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
    found = np.where(inside, image[np.clip(v, 0, height - 1), np.clip(u, 0, width - 1)], 0.0)
    return found.reshape(size[1], size[0])


def _warps(rng: Rng) -> list[Case]:
    shift = np.array([[1.0, 0, 1], [0, 1, 1], [0, 0, 1]])
    cases = [Case((np.array([[1.0, 2, 3], [4, 5, 6], [7, 8, 9], [10, 11, 12]]), shift, (4, 3)))]
    # smaller than the source, and from its far corner
    cases.append(Case((cases[0].args[0], shift * [[1, 1, -1], [1, 1, -1], [1, 1, 1]], (2, 2))))
    while len(cases) < 4:
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


def _undivided(image: Array, H: Array, size: tuple[int, int]) -> Array:
    M = np.linalg.inv(H)
    return _looked_up(image, pixel_centres(size) @ M[:2, :2].T + M[:2, 2], size)


def _floored(image: Array, H: Array, size: tuple[int, int]) -> Array:
    return _looked_up(image, np.floor(_sources(np.linalg.inv(H), size) + 1e-9), size)


def _repeated(image: Array, H: Array, size: tuple[int, int]) -> Array:
    height, width = image.shape
    m = np.clip(_sources(np.linalg.inv(H), size), 0, [width - 1, height - 1])
    return _looked_up(image, m, size)


def _wrapped_around(image: Array, H: Array, size: tuple[int, int]) -> Array | None:
    """Look up without asking for u ≥ 0 and v ≥ 0; None where that raises an IndexError."""
    u, v = np.round(_sources(np.linalg.inv(H), size)).astype(int).T
    height, width = image.shape
    inside = (u < width) & (v < height)
    if (u[inside] < -width).any() or (v[inside] < -height).any():
        return None
    found = np.where(inside, image[np.where(inside, v, 0), np.where(inside, u, 0)], 0.0)
    return found.reshape(size[::-1])


def _half_pixels(image: Array, H: Array, size: tuple[int, int]) -> Array:
    sources = np.nan_to_num(apply(np.linalg.inv(H), pixel_centres(size) + 0.5), nan=-1e6)
    return _looked_up(image, np.floor(sources + 1e-9), size)


def _inside_only(image: Array, H: Array, size: tuple[int, int], first: int, last: int) -> Array:
    framed = np.array(image)
    framed[:first], framed[:, :first] = 0, 0
    framed[len(framed) - last :], framed[:, framed.shape[1] - last :] = 0, 0
    return _looked_up(framed, _sources(np.linalg.inv(H), size), size)


def _interpolated(image: Array, H: Array, size: tuple[int, int]) -> Array:
    to_source = homography_map(np.linalg.inv(H))
    return np.asarray(library_warp(image, to_source, size=size, method="bilinear"), dtype=float)


def _outside_nan(image: Array, H: Array, size: tuple[int, int]) -> Array:
    inside = backward_warp(np.ones_like(image), H, size)
    return np.where(inside > 0, backward_warp(image, H, size), np.nan)


def _inside_of(image: Array, H: Array, size: tuple[int, int]) -> Array:
    """Leave out what lies outside of the target, in place of the source."""
    sources = np.round(_sources(np.linalg.inv(H), size))
    inside = ((sources >= 0) & (sources < size)).all(1).reshape(size[::-1])
    return np.where(inside, backward_warp(image, H, size), 0.0)


def _outside(image: Array, H: Array, size: tuple[int, int], value: float) -> Array:
    inside = backward_warp(np.ones_like(image), H, size)
    return np.where(inside > 0, backward_warp(image, H, size), value)


def _modulo(image: Array, H: Array, size: tuple[int, int]) -> Array:
    u, v = np.round(_sources(np.linalg.inv(H), size)).astype(int).T
    return np.asarray(image[v % image.shape[0], u % image.shape[1]].reshape(size[::-1]))


BACKWARD = Exercise(
    name="backward_warp",
    chapter=8,
    title="A warp without holes",
    task="Warp an image, shape (height, width), by a homography H with target ≈ H source: give "
    "the target of `size` = (width, height), shape (height, width). Each target pixel shows the "
    "nearest pixel of the source it comes from, or 0 if that is outside.",
    stub='''def my_backward_warp(image, H, size):
    """Give the warped picture, shape (size[1], size[0])."""
    ...''',
    hints=(
        "Go through the pixels of the target, not of the source: then none is left out.",
        "Where does target pixel (u', v') come from? (u, v, 1) ≈ H⁻¹ (u', v', 1).",
        "Divide, round both, and look up image[v, u] if the rounded pixel is one of the source: "
        "0 ≤ u ≤ width − 1. (No position lies halfway between two pixels.)",
    ),
    cases=_warps,
    properties=(Property("Each target pixel shows the source pixel that H takes nearest to it."),),
    misconceptions=(
        Misconception(
            "H for its inverse",
            "You looked up at H (u', v'). H leads from source to target; backwards takes H⁻¹.",
            lambda image, H, size: _looked_up(image, _sources(H, size), size),
        ),
        Misconception(
            "forward",
            "You sent source pixels to the target: some target pixels get none (holes), others "
            "several (folds). Go backwards: one look-up for each target pixel.",
            _forward,
        ),
        Misconception(
            "size exchanged",
            "Your picture is as high as it should be wide: size is (width, height), but an array "
            "has its rows first, shape (height, width).",
            lambda image, H, size: backward_warp(image, H, size[::-1]),
        ),
        Misconception(
            "u and v exchanged",
            "You applied H to (v, u): u counts columns and comes first.",
            lambda image, H, size: backward_warp(image.T, H, size[::-1]).T,
        ),
        Misconception(
            "no division",
            "You did not divide by the third coordinate of H⁻¹ (u', v', 1).",
            _undivided,
        ),
        Misconception(
            "floored, not rounded",
            "You cut the decimals off; the nearest pixel is found by rounding both coordinates.",
            _floored,
        ),
        Misconception(
            "border repeated",
            "Outside of the source you repeated its border; the task asks for 0 there.",
            _repeated,
        ),
        Misconception(
            "negative indices that wrap",
            (
                "A negative index does not fail in Python: it counts from the end, so that the "
                "other side of the picture shows up. Ask for u ≥ 0 and v ≥ 0 as well."
            ),
            _wrapped_around,
        ),
        Misconception(
            "truncated, not rounded",
            (
                "int() cuts the decimals off, towards 0; the nearest pixel is found by rounding "
                "both coordinates."
            ),
            lambda image, H, size: _looked_up(
                image, np.trunc(_sources(np.linalg.inv(H), size) + 1e-9), size
            ),
        ),
        Misconception(
            "half-pixel centres",
            (
                "You took pixel centres at halves. Here whole numbers are the centres, so nothing "
                "is added before H⁻¹."
            ),
            lambda image, H, size: _half_pixels(image, H, size),
            variants=(
                lambda image, H, size: _looked_up(
                    image, apply(np.linalg.inv(H), pixel_centres(size) + 0.5), size
                ),
                lambda image, H, size: _looked_up(
                    image, apply(np.linalg.inv(H), pixel_centres(size) + 0.5) - 0.5, size
                ),
            ),
        ),
        Misconception(
            "rounded upwards",
            "You took the ceiling; the nearest pixel is found by rounding both coordinates.",
            lambda image, H, size: _looked_up(
                image, np.ceil(_sources(np.linalg.inv(H), size) - 1e-9), size
            ),
        ),
        Misconception(
            "first row and column left out",
            "Pixels in row 0 and column 0 of the source count too: u ≥ 0, not u > 0.",
            lambda image, H, size: _inside_only(image, H, size, 1, 0),
        ),
        Misconception(
            "last row and column left out",
            "Pixels in the last row and column of the source count too: u ≤ width − 1.",
            lambda image, H, size: _inside_only(image, H, size, 0, 1),
        ),
        Misconception(
            "H transposed",
            (
                "You used the transpose of H⁻¹: rows of points are multiplied by its transpose "
                "from the right."
            ),
            lambda image, H, size: _looked_up(image, _sources(np.linalg.inv(H).T, size), size),
        ),
        Misconception(
            "NaN outside",
            "Outside of the source the task asks for 0; you have NaN there.",
            lambda image, H, size: _outside_nan(image, H, size),
        ),
        Misconception(
            "nothing warped",
            "That is the source itself, cut to the size of the target.",
            lambda image, H, size: _looked_up(image, pixel_centres(size), size),
        ),
        Misconception(
            "bilinear",
            "You interpolated between four pixels; asked is the nearest one.",
            _interpolated,
        ),
        Misconception(
            "rows and columns exchanged at the look-up",
            "image[u, v] reads row u: rows come first, image[v, u].",
            lambda image, H, size: _looked_up(image.T, _sources(np.linalg.inv(H), size), size),
            variants=(
                lambda image, H, size: _looked_up(
                    image, _sources(np.linalg.inv(H), size)[:, ::-1], size
                ),
            ),
        ),
        Misconception(
            "u and v exchanged in the target",
            "You went through the target with (v, u): u counts its columns.",
            lambda image, H, size: backward_warp(image, H, size[::-1]).T,
        ),
        Misconception(
            "forward with H⁻¹",
            "You sent source pixels to the target, and with H⁻¹: go through the target's pixels, "
            "and look up at H⁻¹.",
            lambda image, H, size: _forward(image, np.linalg.inv(H), size),
        ),
        Misconception(
            "border of the target's size",
            "You asked whether the position lies inside of the target; it is looked up in the "
            "source.",
            lambda image, H, size: _inside_of(image, H, size),
        ),
        Misconception(
            "value outside",
            "Outside of the source the task asks for 0; you have another value there.",
            lambda image, H, size: _outside(image, H, size, 255.0),
            variants=(
                lambda image, H, size: _outside(image, H, size, -1.0),
                lambda image, H, size: _outside(image, H, size, image.mean()),
            ),
        ),
        Misconception(
            "wrapped around",
            "Outside of the source you went on at its other side, as % does; the task asks for 0 "
            "there.",
            lambda image, H, size: _modulo(image, H, size),
        ),
        Misconception(
            "upside down",
            "Your picture stands on its head: rows count downwards.",
            lambda image, H, size: backward_warp(image, H, size)[::-1],
            variants=(lambda image, H, size: backward_warp(image[::-1], H, size),),
        ),
    ),
    reference=backward_warp,
    concepts=("66", "73", "74", "E39"),
)
