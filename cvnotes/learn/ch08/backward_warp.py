"""A warp without holes."""

import numpy as np
import numpy.typing as npt

from cvnotes.base import Array
from cvnotes.learn.cases.cameras import image_of_noise, pixel_centres, rounded
from cvnotes.learn.checker.exercise import Case, Exercise, Misconception, Property, Rng
from cvnotes.projective import apply


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
    shift = np.array([[1.0, 0, 1], [0, 1, 0], [0, 0, 1]])
    cases = [Case((np.array([[1.0, 2, 3], [4, 5, 6]]), shift, (4, 3)))]
    while len(cases) < 3:
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
        "Divide, round both, and look up image[v, u] if that is inside.",
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
    ),
    reference=backward_warp,
    concepts=("66", "73", "74", "E39"),
)
